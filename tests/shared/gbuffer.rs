//! The f64 twin of the g-buffer: a ray through each pixel's centre against exact spheres and all
//! triangles (for small test meshes).

use glam::{DVec2, DVec3, DVec4, Vec2, Vec3, Vec4, Vec4Swizzles as _};
use rayon::prelude::*;
use splitsum::base::glsl::constants::{ALPHA_MIN, COSINE_MIN, TILT_MIN};
use splitsum::base::math::frame::east;
use splitsum::base::pixels::Pixels;
use splitsum::base::pixels::lookup::trilinear;
use splitsum::instrument::gbuffer::Gbuffer;
use splitsum::instrument::scene::{Anisotropy, Camera, Material, Mesh, Scene, Sphere, Texture};

struct Hit<'a> {
    /// Distance along the ray.
    t: f64,
    position: DVec3,
    /// Unit normal of a sphere; interpolated normal of a mesh.
    n: DVec3,
    material: usize,
    mapped: Option<Mapped<'a>>,
}

/// Parameters of a mesh's map lookups.
struct Mapped<'a> {
    mesh: &'a Mesh,
    triangle: [u32; 3],
    /// Texture coordinate, v up.
    uv: DVec2,
    tangent: DVec4,
    /// 1 on the front, -1 on the back.
    side: f64,
}

pub fn gbuffer(scene: &Scene, camera: &Camera, size: [u32; 2]) -> Gbuffer<f64> {
    let [width, height] = size;
    let texels: Vec<[[f64; 4]; 4]> = (0..width * height)
        .into_par_iter()
        .map(|i| {
            let (origin, direction) = camera.ray(i % width, i / width, size);
            let spheres = scene
                .spheres
                .iter()
                .filter_map(|sphere| hit_sphere(sphere, origin, direction));
            let meshes = scene
                .meshes
                .iter()
                .filter_map(|mesh| hit_mesh(scene, mesh, origin, direction));
            let nearest = spheres.chain(meshes).min_by(|a, b| a.t.total_cmp(&b.t));
            // Differences as on the device: within quads of 2 x 2 pixels, on the plane of the
            // triangle.
            let quad =
                [(1, 0), (0, 1)].map(|(x, y)| camera.ray((i % width) ^ x, (i / width) ^ y, size));
            nearest.map_or([[0.0; 4]; 4], |hit| {
                texels(scene, &hit, camera.v_at(hit.position), quad)
            })
        })
        .collect();
    let attachment =
        |k: usize| Pixels::new(width, height, texels.iter().map(|texel| texel[k]).collect());
    [0, 1, 2, 3].map(attachment).into()
}

fn texels(scene: &Scene, hit: &Hit, v: DVec3, quad: [(DVec3, DVec3); 2]) -> [[f64; 4]; 4] {
    let material: &Material = &scene.materials[hit.material];
    let rgb = |values: [f32; 3]| Vec3::from_array(values).as_dvec3();
    let steps = hit.mapped.as_ref().map_or([DVec2::ZERO; 2], |at| {
        let uv = |(origin, direction)| {
            cross(at.mesh, at.triangle, origin, direction).uv(at.mesh, at.triangle)
        };
        quad.map(|ray| uv(ray) - at.uv)
    });
    let map = |index: Option<usize>, missing: DVec3| {
        let found = index
            .zip(hit.mapped.as_ref())
            .map(|(map, at)| texture_at(&scene.textures[map], at.uv, steps));
        found.unwrap_or(missing)
    };
    let albedo = rgb(material.albedo) * map(material.albedo_map, DVec3::ONE);
    let metallic = f64::from(material.metallic) * map(material.metallic_map, DVec3::ONE).z;
    let roughness = map(material.roughness_map, DVec3::ONE).y;
    let alpha = (f64::from(material.alpha) * roughness.powi(2)).max(f64::from(ALPHA_MIN));
    let Anisotropy {
        strength,
        turn,
        is_shown,
        ..
    } = material.anisotropy;
    // Without a tangent of its own a surface has the one of spheres.
    let own = hit.mapped.as_ref().map(|at| at.tangent).filter(|tangent| {
        let across = hit.n.cross(tangent.xyz()).length();
        !is_shown || across > f64::from(TILT_MIN) * hit.n.length() * tangent.xyz().length()
    });
    let tangent = own.unwrap_or_else(|| east(hit.n.normalize(), 0.0).extend(1.0));
    let side = hit.mapped.as_ref().map_or(1.0, |at| at.side);
    // Vectors between vertices are not unit vectors, and maps are baked for those [Mikkelsen08].
    let bitangent = tangent.w.signum() * hit.n.cross(tangent.xyz());
    let turned = |m: DVec3| side * (m.x * tangent.xyz() + m.y * bitangent + m.z * hit.n);
    let (n, alpha) = if is_shown {
        let direction = map(material.normal_map, DVec3::X);
        let unit = direction.truncate().normalize_or(DVec2::X);
        let m = DVec2::from_angle(turn.into()).rotate(unit).extend(0.0);
        (
            turned(m).normalize(),
            f64::from(strength) * direction.length(),
        )
    } else {
        let w = turned(map(material.normal_map, DVec3::Z));
        let n = if hit.mapped.is_some() {
            visible_normal(w, v)
        } else {
            w.normalize()
        };
        (n, alpha)
    };
    let dielectric = (rgb(material.f0) * map(material.f0_map, DVec3::ONE)).min(DVec3::ONE);
    let weight = f64::from(material.specular.factor) * map(material.specular.map, DVec3::ONE).x;
    let reflecting = weight + metallic * (1.0 - weight);
    let mut whole = (weight * dielectric).lerp(albedo, metallic);
    let mut alpha = alpha;
    if let Some(under) = &material.under_coat {
        let weight = f64::from(under.coat.weight) * map(under.coat.weight_map, DVec3::ONE).x;
        let roughness = map(under.coat.roughness_map, DVec3::ONE).y;
        let coat_alpha = f64::from(under.coat.alpha) * roughness.powi(2);
        whole = under.law.f0_below(whole, weight);
        alpha = under.law.alpha_below(alpha, weight, coat_alpha);
    }
    let f0 = if reflecting > 0.0 {
        whole / reflecting
    } else {
        dielectric
    };
    let with = |xyz: DVec3, w: f64| xyz.extend(w).to_array();
    [
        with(hit.position, 1.0),
        with(n, alpha),
        with(albedo, metallic),
        with(f0, hit.material as f64),
    ]
}

/// The unit normal along `w`, at most a right angle from the viewer.
fn visible_normal(w: DVec3, v: DVec3) -> DVec3 {
    let Some(n) = w.try_normalize() else { return v };
    let n_dot_v = n.dot(v);
    if n_dot_v < 0.0 {
        (n - n_dot_v * v + f64::from(COSINE_MIN) * v).normalize()
    } else {
        n
    }
}

/// Looks up the texture at `uv` (v up), trilinearly; texels of the level are as wide as the longer
/// step to a neighbour.
fn texture_at(texture: &Texture, uv: DVec2, steps: [DVec2; 2]) -> DVec3 {
    let size = DVec2::new(
        texture.levels[0].width.into(),
        texture.levels[0].height.into(),
    );
    let [across, down] = steps.map(|step| (step * size).length_squared());
    let lod = 0.5 * across.max(down).max(1.0).log2();
    let value = |texel| Vec3::from_array(texel).as_dvec3();
    trilinear(
        &texture.levels,
        DVec2::new(uv.x, 1.0 - uv.y),
        lod,
        texture.wrap,
        value,
    )
}

/// Solves `|origin + t direction - center|² = r²` for the nearer root; `direction` has unit length.
fn hit_sphere(sphere: &Sphere, origin: DVec3, direction: DVec3) -> Option<Hit<'static>> {
    let from_center = origin - sphere.center;
    let half_b = direction.dot(from_center);
    let discriminant =
        half_b * half_b - from_center.length_squared() + sphere.radius * sphere.radius;
    let t = -half_b - discriminant.max(0.0).sqrt();
    if discriminant < 0.0 || t <= 0.0 {
        return None;
    }
    let position = origin + direction * t;
    let n = (position - sphere.center).normalize();
    Some(Hit {
        t,
        position,
        n,
        material: sphere.material,
        mapped: None,
    })
}

fn hit_mesh<'a>(scene: &Scene, mesh: &'a Mesh, origin: DVec3, direction: DVec3) -> Option<Hit<'a>> {
    mesh.triangles()
        .filter_map(|triangle| hit_triangle(scene, mesh, triangle, origin, direction))
        .min_by(|a, b| a.t.total_cmp(&b.t))
}

/// Where a ray crosses the plane of a triangle.
struct Crossing {
    t: f64,
    /// Barycentric coordinates.
    weights: [f64; 3],
    /// Positive if the front (counter-clockwise) side faces the ray.
    determinant: f64,
}

impl Crossing {
    fn uv(&self, mesh: &Mesh, triangle: [u32; 3]) -> DVec2 {
        let corners = triangle.into_iter().zip(self.weights);
        corners
            .map(|(i, w)| Vec2::from_array(mesh.uvs[i as usize]).as_dvec2() * w)
            .sum()
    }
}

/// Solves `origin + t direction = a + beta (b - a) + gamma (c - a)` by Cramer's rule.
fn cross(mesh: &Mesh, triangle: [u32; 3], origin: DVec3, direction: DVec3) -> Crossing {
    let [a, b, c] =
        triangle.map(|index| Vec3::from_array(mesh.positions[index as usize]).as_dvec3());
    let (ab, ac) = (b - a, c - a);
    let determinant = ab.cross(ac).dot(-direction);
    let from_a = origin - a;
    let moment = from_a.cross(-direction);
    let beta = ac.dot(-moment) / determinant;
    let gamma = ab.dot(moment) / determinant;
    Crossing {
        t: ab.cross(ac).dot(from_a) / determinant,
        weights: [1.0 - beta - gamma, beta, gamma],
        determinant,
    }
}

fn hit_triangle<'a>(
    scene: &Scene,
    mesh: &'a Mesh,
    triangle: [u32; 3],
    origin: DVec3,
    direction: DVec3,
) -> Option<Hit<'a>> {
    let crossing = cross(mesh, triangle, origin, direction);
    let Crossing {
        t,
        weights,
        determinant,
    } = crossing;
    let is_back = determinant < 0.0 && scene.materials[mesh.material].is_one_sided;
    if determinant == 0.0 || is_back || weights.iter().any(|weight| *weight < 0.0) || t <= 0.0 {
        return None;
    }
    let uv = crossing.uv(mesh, triangle);
    let corners = triangle
        .map(|index| index as usize)
        .into_iter()
        .zip(weights);
    let n: DVec3 = corners
        .clone()
        .map(|(i, w)| Vec3::from_array(mesh.normals[i]).as_dvec3() * w)
        .sum();
    let tangent: DVec4 = corners
        .map(|(i, w)| Vec4::from_array(mesh.tangents[i]).as_dvec4() * w)
        .sum();
    let mapped = Some(Mapped {
        mesh,
        triangle,
        uv,
        tangent,
        side: determinant.signum(),
    });
    Some(Hit {
        t,
        position: origin + direction * t,
        n,
        material: mesh.material,
        mapped,
    })
}
