//! Missing normals.

use crate::instrument::scene::Mesh;
use crate::instrument::scene::mesh::position;
use glam::{DVec3, Vec3};
use std::collections::HashMap;

/// Shorter sums of unit normals have no direction.
const MIN_SUM: f64 = 1e-6;

/// Replaces normals (0, 0, 0) by the mean of the adjacent triangles' normals, weighted by angle, so
/// that triangulation does not matter. Corners at equal positions are one point if their smoothing
/// groups are equal; `groups` has the group of each vertex, by mesh. No triangle may be degenerate.
pub fn fill_missing(meshes: &mut [Mesh], groups: &[Vec<u32>]) {
    let is_missing = |mesh: &Mesh| mesh.normals.contains(&[0.0; 3]);
    if !meshes.iter().any(is_missing) {
        return;
    }
    let mut sums: HashMap<Point, Sum> = HashMap::new();
    for (mesh, groups) in meshes.iter().zip(groups) {
        for triangle in mesh.triangles() {
            let corners @ [a, b, c] = triangle.map(|index| position(&mesh.positions, index));
            let face = (b - a).cross(c - a).normalize();
            for k in 0..3 {
                let [p, next, last] = [corners[k], corners[(k + 1) % 3], corners[(k + 2) % 3]];
                let sum = sums
                    .entry(Point::of(mesh, groups, triangle[k] as usize))
                    .or_insert(Sum {
                        weighted: DVec3::ZERO,
                        any: face,
                    });
                sum.weighted += face * (next - p).angle_between(last - p);
            }
        }
    }
    for (mesh, groups) in meshes.iter_mut().zip(groups) {
        for vertex in 0..mesh.normals.len() {
            if mesh.normals[vertex] == [0.0; 3] {
                // Positions without a sum belong to dropped triangles.
                let sum = sums.get(&Point::of(mesh, groups, vertex));
                mesh.normals[vertex] = sum.map_or(Vec3::Z, Sum::normal).to_array();
            }
        }
    }
}

/// A point of a smoothing group.
#[derive(PartialEq, Eq, Hash)]
struct Point {
    /// The bits of the position; -0 equals 0.
    position: [u32; 3],
    group: u32,
}

impl Point {
    fn of(mesh: &Mesh, groups: &[u32], vertex: usize) -> Self {
        Self {
            position: mesh.positions[vertex].map(|x| (x + 0.0).to_bits()),
            group: groups[vertex],
        }
    }
}

struct Sum {
    weighted: DVec3,
    /// Normal of one of the triangles.
    any: DVec3,
}

impl Sum {
    fn normal(&self) -> Vec3 {
        let n = if self.weighted.length() < MIN_SUM {
            self.any
        } else {
            self.weighted.normalize()
        };
        n.as_vec3()
    }
}
