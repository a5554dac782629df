//! The f64 twin: one ray through each pixel's centre against exact spheres and every triangle of every mesh.
//!
//! Triangles are tried one after another; that is meant for the small meshes of tests.

use super::Gbuffer;
use crate::glsl::constants::ALPHA_MIN;
use crate::pixels::lookup::{Wrap, bilinear};
use crate::pixels::{Pixels, RgbImage};
use crate::scene::{Camera, Material, Mesh, Scene, Sphere};
use glam::{DVec2, DVec3, DVec4, Vec2, Vec3, Vec4, Vec4Swizzles as _};
use rayon::prelude::*;

/// What a ray hits first.
struct Hit {
    /// Distance along the ray.
    t: f64,
    position: DVec3,
    /// Unit normal; under a normal map the mapped one.
    n: DVec3,
    /// Texture coordinate, v up.
    uv: DVec2,
    material: usize,
}

/// The g-buffer of `scene` in f64.
pub fn gbuffer(scene: &Scene, camera: &Camera, size: [u32; 2]) -> Gbuffer<f64> {
    let [width, height] = size;
    let texels: Vec<[[f64; 4]; 4]> = (0..width * height)
        .into_par_iter()
        .map(|i| {
            let (origin, direction) = camera.ray(i % width, i / width, size);
            let spheres = scene.spheres.iter().filter_map(|sphere| hit_sphere(sphere, origin, direction));
            let meshes = scene.meshes.iter().filter_map(|mesh| hit_mesh(scene, mesh, origin, direction));
            let nearest = spheres.chain(meshes).min_by(|a, b| a.t.total_cmp(&b.t));
            nearest.map_or([[0.0; 4]; 4], |hit| texels(scene, &hit))
        })
        .collect();
    let attachment = |k: usize| Pixels::new(width, height, texels.iter().map(|texel| texel[k]).collect());
    [0, 1, 2, 3].map(attachment).into()
}

fn texels(scene: &Scene, hit: &Hit) -> [[f64; 4]; 4] {
    let material: &Material = &scene.materials[hit.material];
    let rgb = |values: [f32; 3]| Vec3::from_array(values).as_dvec3();
    let map = |index: Option<usize>| index.map_or(DVec3::ONE, |map| texture_at(&scene.textures[map], hit.uv));
    let albedo = rgb(material.albedo) * map(material.albedo_map);
    let metallic = f64::from(material.metallic) * map(material.metallic_map).z;
    let alpha = (f64::from(material.alpha) * map(material.roughness_map).y.powi(2)).max(f64::from(ALPHA_MIN));
    let f0 = rgb(material.f0).lerp(albedo, metallic);
    let with = |xyz: DVec3, w: f64| xyz.extend(w).to_array();
    [with(hit.position, 1.0), with(hit.n, alpha), with(albedo, metallic), with(f0, hit.material as f64)]
}

/// The texture at `uv` (v up), bilinear with repeating coordinates.
fn texture_at(texture: &RgbImage, uv: DVec2) -> DVec3 {
    bilinear(texture, DVec2::new(uv.x, 1.0 - uv.y), Wrap::RepeatBoth, |texel| Vec3::from_array(texel).as_dvec3())
}

/// `|origin + t direction - center|² = r²`, nearer root, unit `direction`.
fn hit_sphere(sphere: &Sphere, origin: DVec3, direction: DVec3) -> Option<Hit> {
    let from_center = origin - sphere.center;
    let half_b = direction.dot(from_center);
    let discriminant = half_b * half_b - from_center.length_squared() + sphere.radius * sphere.radius;
    let t = -half_b - discriminant.max(0.0).sqrt();
    if discriminant < 0.0 || t <= 0.0 {
        return None;
    }
    let position = origin + direction * t;
    let n = (position - sphere.center).normalize();
    Some(Hit { t, position, n, uv: DVec2::ZERO, material: sphere.material })
}

fn hit_mesh(scene: &Scene, mesh: &Mesh, origin: DVec3, direction: DVec3) -> Option<Hit> {
    mesh.triangles()
        .filter_map(|triangle| hit_triangle(scene, mesh, triangle, origin, direction))
        .min_by(|a, b| a.t.total_cmp(&b.t))
}

/// Solves `origin + t direction = a + beta (b - a) + gamma (c - a)` by Cramer's rule.
fn hit_triangle(scene: &Scene, mesh: &Mesh, triangle: [u32; 3], origin: DVec3, direction: DVec3) -> Option<Hit> {
    let material = &scene.materials[mesh.material];
    let [a, b, c] = triangle.map(|index| Vec3::from_array(mesh.positions[index as usize]).as_dvec3());
    let (ab, ac) = (b - a, c - a);
    // Positive where the front (counter-clockwise) side faces the ray.
    let determinant = ab.cross(ac).dot(-direction);
    if determinant == 0.0 || (determinant < 0.0 && material.is_one_sided) {
        return None;
    }
    let from_a = origin - a;
    let moment = from_a.cross(-direction);
    let beta = ac.dot(-moment) / determinant;
    let gamma = ab.dot(moment) / determinant;
    let t = ab.cross(ac).dot(from_a) / determinant;
    if beta < 0.0 || gamma < 0.0 || beta + gamma > 1.0 || t <= 0.0 {
        return None;
    }
    let weights = [1.0 - beta - gamma, beta, gamma];
    let corners = triangle.map(|index| index as usize).into_iter().zip(weights);
    let normal: DVec3 = corners.clone().map(|(i, w)| Vec3::from_array(mesh.normals[i]).as_dvec3() * w).sum();
    let uv: DVec2 = corners.clone().map(|(i, w)| Vec2::from_array(mesh.uvs[i]).as_dvec2() * w).sum();
    let tangent: DVec4 = corners.map(|(i, w)| Vec4::from_array(mesh.tangents[i]).as_dvec4() * w).sum();
    let mapped = material.normal_map.map_or(DVec3::Z, |map| texture_at(&scene.textures[map], uv));
    // Vectors between vertices are not unit vectors, and maps are baked for those [Mikkelsen08].
    let bitangent = tangent.w.signum() * normal.cross(tangent.xyz());
    let n = (mapped.x * tangent.xyz() + mapped.y * bitangent + mapped.z * normal).normalize() * determinant.signum();
    Some(Hit { t, position: origin + direction * t, n, uv, material: mesh.material })
}
