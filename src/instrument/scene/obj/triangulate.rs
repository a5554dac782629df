//! Splits polygons into triangles.

use earcut::utils3d::project3d_to_2d;
use earcut::{Earcut, deviation};
use glam::DVec3;

/// Largest share by which the areas of a polygon and of its triangles may differ: rounding to seven
/// digits causes a thousandth of it.
const DEVIATION_MAX: f64 = 1e-6;

#[derive(Debug, PartialEq)]
pub struct Triangulation {
    /// Indices of corners, wound as the polygon.
    pub triangles: Vec<[usize; 3]>,
    /// Whether the triangles' areas sum to the polygon's; false if it crosses itself.
    pub is_simple: bool,
}

/// Splits a polygon, perhaps concave and not quite planar, into triangles of its corners.
pub fn triangulate(polygon: &[DVec3]) -> Triangulation {
    let fan: Vec<[usize; 3]> = (2..polygon.len()).map(|i| [0, i - 1, i]).collect();
    // Relative to one corner, to avoid cancellation far from the origin.
    let spokes: Vec<[f64; 3]> = polygon
        .iter()
        .map(|corner| (*corner - polygon[0]).to_array())
        .collect();
    let mut flat = Vec::new();
    let has_area = project3d_to_2d(&spokes, polygon.len(), &mut flat);
    if !has_area {
        let is_flat = |[_, b, c]: &[usize; 3]| {
            DVec3::from(spokes[*b]).cross(spokes[*c].into()) == DVec3::ZERO
        };
        return Triangulation {
            is_simple: fan.iter().all(is_flat),
            triangles: fan,
        };
    }
    let mut corners: Vec<u32> = Vec::new();
    Earcut::new().earcut(flat.iter().copied(), &[], &mut corners);
    let triangles = corners
        .chunks_exact(3)
        .map(|triangle| [0, 1, 2].map(|i| triangle[i] as usize))
        .collect();
    Triangulation {
        triangles,
        is_simple: deviation(flat, &[], &corners) < DEVIATION_MAX,
    }
}
