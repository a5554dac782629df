//! Normals that a file leaves out, and triangles wound to agree with their normals.

use crate::scene::Mesh;
use crate::scene::mesh::position;
use glam::{DVec3, Vec3};
use std::collections::HashMap;

/// Sums of unit normals shorter than this have no direction: the surface folds back on itself.
const MIN_SUM: f64 = 1e-6;

/// Replaces every normal (0, 0, 0) by the mean of the triangles' normals around its position, each weighted by the triangle's angle there,
/// so that the result does not depend on how polygons are split. Corners at equal positions are one point, whatever mesh, material or
/// smoothing group they belong to: there are no creases. No triangle may be degenerate.
pub fn fill_missing(meshes: &mut [Mesh]) {
    let is_missing = |mesh: &Mesh| mesh.normals.contains(&[0.0; 3]);
    if !meshes.iter().any(is_missing) {
        return;
    }
    let mut sums: HashMap<[u32; 3], Sum> = HashMap::new();
    for mesh in meshes.iter() {
        for triangle in mesh.triangles() {
            let corners = triangle.map(|index| position(&mesh.positions, index));
            let face = face_normal(corners);
            for k in 0..3 {
                let [p, next, last] = [corners[k], corners[(k + 1) % 3], corners[(k + 2) % 3]];
                let sum = sums
                    .entry(key(mesh.positions[triangle[k] as usize]))
                    .or_insert(Sum { weighted: DVec3::ZERO, any: face });
                sum.weighted += face * (next - p).angle_between(last - p);
            }
        }
    }
    for mesh in meshes {
        for (normal, &p) in mesh.normals.iter_mut().zip(&mesh.positions) {
            if *normal == [0.0; 3] {
                // A position without a sum belongs to dropped triangles only; its normal is never read.
                *normal = sums.get(&key(p)).map_or(Vec3::Z, Sum::normal).to_array();
            }
        }
    }
}

/// Winds every triangle counter-clockwise as seen from where the sum of its normals points.
pub fn wind_by_normals(mesh: &mut Mesh) {
    for triangle in mesh.indices.chunks_exact_mut(3) {
        let corner = |k: usize| position(&mesh.positions, triangle[k]);
        let sum: DVec3 = triangle.iter().map(|&i| Vec3::from_array(mesh.normals[i as usize]).as_dvec3()).sum();
        if face_normal([corner(0), corner(1), corner(2)]).dot(sum) < 0.0 {
            triangle.swap(1, 2);
        }
    }
}

struct Sum {
    weighted: DVec3,
    /// The normal of one of the triangles.
    any: DVec3,
}

impl Sum {
    fn normal(&self) -> Vec3 {
        let n = if self.weighted.length() < MIN_SUM { self.any } else { self.weighted.normalize() };
        n.as_vec3()
    }
}

fn face_normal([a, b, c]: [DVec3; 3]) -> DVec3 {
    (b - a).cross(c - a).normalize()
}

/// The bits of a position; -0 and 0 are one place.
fn key(p: [f32; 3]) -> [u32; 3] {
    p.map(|x| (x + 0.0).to_bits())
}
