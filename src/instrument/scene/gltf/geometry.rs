//! The triangles of a primitive: its attributes, moved to world space.

use crate::base::glsl::constants::TILT_MIN;
use crate::instrument::scene::mesh::{Mesh, is_degenerate, position};
use crate::instrument::scene::tangents;
use ::gltf::mesh::Mode;
use glam::{DAffine2, DMat3, DMat4, DVec3, Vec2, Vec3};
use std::collections::BTreeMap;

/// Largest coordinate: its square is finite in f32.
const MAX_COORDINATE: f64 = 1e15;

/// The attributes of a primitive, in the space of its node. Each present one has a value for every
/// position.
pub struct Attributes {
    pub positions: Vec<[f32; 3]>,
    /// v points down.
    pub uvs: Option<Vec<[f32; 2]>>,
    pub normals: Option<Vec<[f32; 3]>>,
    /// Direction, and sign of the bitangent; only with normals.
    pub tangents: Option<Vec<[f32; 4]>>,
    /// Below the number of positions.
    pub indices: Vec<u32>,
}

/// A transform to world space, of positions and directions.
struct Placement {
    to_world: DMat4,
    /// Of tangents.
    linear: DMat3,
    /// Of normals. Cofactors are the inverse transpose times the determinant; they exist even for
    /// singular transforms.
    cofactors: DMat3,
    /// -1 if the transform mirrors, else 1.
    handedness: f64,
}

impl Placement {
    fn new(to_world: DMat4) -> Self {
        let linear = DMat3::from_mat4(to_world);
        let x = linear.x_axis;
        let y = linear.y_axis;
        let z = linear.z_axis;
        let handedness = if linear.determinant() < 0.0 {
            -1.0
        } else {
            1.0
        };
        Self {
            to_world,
            linear,
            cofactors: DMat3::from_cols(y.cross(z), z.cross(x), x.cross(y)) * handedness,
            handedness,
        }
    }

    fn is_mirroring(&self) -> bool {
        self.handedness < 0.0
    }

    fn position(&self, position: &[f32; 3]) -> Result<[f32; 3], String> {
        let position = self
            .to_world
            .transform_point3(Vec3::from_array(*position).as_dvec3());
        // Also refuses NaN.
        if !(position.abs().max_element() <= MAX_COORDINATE && position.is_finite()) {
            return Err(format!(
                "a position outside -{MAX_COORDINATE:e} to {MAX_COORDINATE:e}"
            ));
        }
        Ok(position.as_vec3().to_array())
    }

    fn normal(&self, normal: &[f32; 3]) -> [f32; 3] {
        unit(self.cofactors * Vec3::from_array(*normal).as_dvec3())
    }

    /// Returns a unit tangent with its handedness, or zeros for an unusable one.
    fn tangent(&self, [x, y, z, w]: [f32; 4], normal: &[f32; 3]) -> [f32; 4] {
        let direction = unit(self.linear * DVec3::new(x.into(), y.into(), z.into()));
        let across = Vec3::from_array(*normal).cross(Vec3::from_array(direction));
        if w.is_nan() || across.length() <= TILT_MIN {
            return [0.0; 4];
        }
        let [x, y, z] = direction;
        [x, y, z, w.signum() * self.handedness as f32]
    }
}

fn unit(v: DVec3) -> [f32; 3] {
    v.normalize_or_zero().as_vec3().to_array()
}

/// A mesh in world space, and how many triangles it lost.
pub struct Placed {
    pub mesh: Mesh,
    /// Skipped triangles without area.
    pub degenerate_count: usize,
    /// Vertices whose normal in the file is zero or not finite, and was computed.
    pub replaced_normal_count: usize,
    /// Corners whose tangent in the file is zero, not finite or along the normal.
    pub replaced_tangent_count: usize,
}

impl Attributes {
    /// Moves the primitive to world space and adds missing normals and, if `needs_tangents`,
    /// missing tangents.
    pub fn placed(
        self,
        mode: Mode,
        to_world: DMat4,
        uv_transform: DAffine2,
        slot: usize,
        needs_tangents: bool,
    ) -> Result<Placed, String> {
        let placement = Placement::new(to_world);
        let has_tangents = self.tangents.is_some();
        let triangles = triangles(mode, &self.indices);
        let mut mesh = self.in_world(&placement, uv_transform, slot)?;
        let degenerate_count = add_triangles(&mut mesh, triangles, placement.is_mirroring());

        let is_flat = mesh.normals.is_empty();
        let replaced_normal_count = if is_flat {
            0
        } else {
            replace_zero_normals(&mut mesh)
        };
        let is_unusable = |index: &&u32| mesh.tangents[**index as usize] == [0.0; 4];
        let unusable_count = mesh.indices.iter().filter(is_unusable).count();
        let lacks_tangents = needs_tangents && (is_flat || unusable_count > 0);
        if is_flat || lacks_tangents {
            mesh = tangents::corners(&mesh, is_flat);
        }
        if lacks_tangents {
            tangents::fill_missing(&mut mesh);
        }
        let replaced_tangent_count = if lacks_tangents && has_tangents && !is_flat {
            unusable_count
        } else {
            0
        };
        Ok(Placed {
            mesh,
            degenerate_count,
            replaced_normal_count,
            replaced_tangent_count,
        })
    }

    /// Returns the vertices in world space, without triangles; a vertex without tangent has zero.
    fn in_world(
        self,
        placement: &Placement,
        uv_transform: DAffine2,
        slot: usize,
    ) -> Result<Mesh, String> {
        let count = self.positions.len();
        let mut mesh = Mesh::empty(slot);
        mesh.positions = self
            .positions
            .iter()
            .map(|position| placement.position(position))
            .collect::<Result<_, _>>()?;
        mesh.uvs = placed_uvs(self.uvs, uv_transform, count)?;
        mesh.normals = self
            .normals
            .iter()
            .flatten()
            .map(|normal| placement.normal(normal))
            .collect();
        mesh.tangents = self.tangents.map_or(vec![[0.0; 4]; count], |tangents| {
            tangents
                .into_iter()
                .zip(&mesh.normals)
                .map(|(tangent, normal)| placement.tangent(tangent, normal))
                .collect()
        });
        Ok(mesh)
    }
}

/// Replaces the normals of zero length of used vertices by the mean of their triangles', weighted by
/// area, and counts them.
fn replace_zero_normals(mesh: &mut Mesh) -> usize {
    let is_zero: Vec<bool> = mesh.normals.iter().map(|n| *n == [0.0; 3]).collect();
    if !is_zero.contains(&true) {
        return 0;
    }
    let mut sums: BTreeMap<usize, DVec3> = BTreeMap::new();
    for triangle in mesh.triangles() {
        let [a, b, c] = triangle.map(|index| position(&mesh.positions, index));
        let area = (b - a).cross(c - a);
        for vertex in triangle.map(|index| index as usize) {
            if is_zero[vertex] {
                *sums.entry(vertex).or_default() += area;
            }
        }
    }
    for (vertex, sum) in &sums {
        // Opposite triangles have no mean.
        mesh.normals[*vertex] = sum.normalize_or(DVec3::Z).as_vec3().to_array();
    }
    sums.len()
}

/// Transforms texture coordinates and lets v point up; (0, 0) without any.
fn placed_uvs(
    uvs: Option<Vec<[f32; 2]>>,
    transform: DAffine2,
    count: usize,
) -> Result<Vec<[f32; 2]>, String> {
    let placed = |uv: &[f32; 2]| {
        let uv = transform.transform_point2(Vec2::from_array(*uv).as_dvec2());
        [uv.x as f32, (1.0 - uv.y) as f32]
    };
    let uvs: Vec<[f32; 2]> = uvs.map_or(vec![[0.0; 2]; count], |uvs| {
        uvs.iter().map(placed).collect()
    });
    if uvs.iter().flatten().any(|x| !x.is_finite()) {
        return Err("a texture coordinate that is not a finite number".to_owned());
    }
    Ok(uvs)
}

/// Returns triangles counter-clockwise from their front (section 3.7.2.1).
fn triangles(mode: Mode, indices: &[u32]) -> Vec<[u32; 3]> {
    let i = |k: usize| indices[k];
    let last = indices.len().saturating_sub(2);
    match mode {
        Mode::TriangleStrip => (0..last)
            .map(|k| [i(k), i(k + 1 + k % 2), i(k + 2 - k % 2)])
            .collect(),
        Mode::TriangleFan => (1..=last).map(|k| [i(k), i(k + 1), i(0)]).collect(),
        _ => indices.as_chunks::<3>().0.to_vec(),
    }
}

/// Adds the triangles that have an area, and counts the others.
fn add_triangles(mesh: &mut Mesh, triangles: Vec<[u32; 3]>, is_mirrored: bool) -> usize {
    let mut degenerate_count = 0;
    for mut triangle in triangles {
        if is_degenerate(triangle.map(|index| position(&mesh.positions, index))) {
            degenerate_count += 1;
            continue;
        }
        if is_mirrored {
            triangle.swap(1, 2);
        }
        mesh.indices.extend(triangle);
    }
    degenerate_count
}
