//! Triangle meshes.

use glam::{DVec3, Vec3};

/// An indexed triangle list with one material.
///
/// Triangles are counter-clockwise seen from the side of their normals (glTF files may disagree;
/// their winding then decides), so the raster's facing alone determines the front.
#[derive(Clone, Debug)]
pub struct Mesh {
    pub positions: Vec<[f32; 3]>,
    /// One unit normal per position.
    pub normals: Vec<[f32; 3]>,
    /// One texture coordinate per position, (0, 0) if missing; v points up as in OBJ.
    pub uvs: Vec<[f32; 2]>,
    /// One per position: unit tangent t towards growing u, and sign s of the bitangent `s n x t`
    /// towards growing v. All 0 without a normal map.
    pub tangents: Vec<[f32; 4]>,
    pub indices: Vec<u32>,
    /// Index into `Scene::materials`.
    pub material: usize,
}

/// Largest height over longest edge of a degenerate triangle, whose normal would be rounding noise.
const DEGENERATE_HEIGHT: f64 = 1e-12;

pub(super) fn is_degenerate([a, b, c]: [DVec3; 3]) -> bool {
    let longest_squared = (b - a)
        .length_squared()
        .max((c - b).length_squared())
        .max((a - c).length_squared());
    (b - a).cross(c - a).length() <= DEGENERATE_HEIGHT * longest_squared
}

impl Mesh {
    pub(super) fn empty(material: usize) -> Self {
        Self {
            positions: Vec::new(),
            normals: Vec::new(),
            uvs: Vec::new(),
            tangents: Vec::new(),
            indices: Vec::new(),
            material,
        }
    }

    pub fn corners(&self) -> impl Iterator<Item = DVec3> + '_ {
        self.indices
            .iter()
            .map(|&index| position(&self.positions, index))
    }

    pub fn triangles(&self) -> impl Iterator<Item = [u32; 3]> + '_ {
        self.indices
            .chunks_exact(3)
            .map(|triangle| [triangle[0], triangle[1], triangle[2]])
    }

    /// Winds triangles counter-clockwise seen from their normals' side.
    pub(super) fn wind_by_normals(&mut self) {
        for triangle in self.indices.chunks_exact_mut(3) {
            let [a, b, c] = [0, 1, 2].map(|k| position(&self.positions, triangle[k]));
            let normal: DVec3 = triangle
                .iter()
                .map(|&index| position(&self.normals, index))
                .sum();
            if (b - a).cross(c - a).dot(normal) < 0.0 {
                triangle.swap(1, 2);
            }
        }
    }
}

pub(super) fn position(positions: &[[f32; 3]], index: u32) -> DVec3 {
    Vec3::from_array(positions[index as usize]).as_dvec3()
}
