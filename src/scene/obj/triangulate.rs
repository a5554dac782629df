//! Triangulates polygons by ear clipping.

use glam::{DVec2, DVec3};
use std::f64::consts::TAU;

/// Most corners of a concave polygon; clipping takes their square.
pub const MAX_CONCAVE_CORNERS: usize = 4096;

/// Largest overlap of a fan: rounding to seven digits causes a thousandth of it.
const OVERLAP_MAX: f64 = 1e-6;

#[derive(Debug, PartialEq)]
pub struct Triangulation {
    /// Indices of corners, wound as the polygon.
    pub triangles: Vec<[usize; 3]>,
    /// Whether the triangles' areas sum to the polygon's; false if it crosses itself.
    pub is_simple: bool,
}

/// Splits a polygon, perhaps concave and not quite planar, into triangles of its corners whose projected areas sum to
/// its own. `None` above [`MAX_CONCAVE_CORNERS`] corners, unless the first corner sees everything.
pub fn triangulate(polygon: &[DVec3]) -> Option<Triangulation> {
    let fan =
        |ring: &[usize]| -> Vec<[usize; 3]> { (2..ring.len()).map(|i| [ring[0], ring[i - 1], ring[i]]).collect() };
    let all: Vec<usize> = (0..polygon.len()).collect();
    if polygon.len() <= 3 {
        return Some(Triangulation { triangles: fan(&all), is_simple: true });
    }
    let flat = flatten(polygon);
    if is_convex(&flat) {
        return Some(Triangulation { triangles: fan(&all), is_simple: true });
    }
    if polygon.len() > MAX_CONCAVE_CORNERS {
        return is_fan(&flat).then(|| Triangulation { triangles: fan(&all), is_simple: true });
    }
    let mut triangles = Vec::with_capacity(polygon.len() - 2);
    let mut ring = all;
    let mut start = 0;
    while ring.len() > 3 {
        // Starting behind the last ear avoids one large fan and usually finds the next ear at once.
        let Some(i) = (0..ring.len()).map(|k| (start + k) % ring.len()).find(|&i| is_ear(&flat, &ring, i)) else {
            triangles.extend(fan(&ring));
            return Some(Triangulation { triangles, is_simple: false });
        };
        triangles.push(neighbours(&ring, i));
        ring.remove(i);
        start = i;
    }
    // Every ear has positive area; so must the rest.
    let [a, b, c] = neighbours(&ring, 1).map(|k| flat[k]);
    triangles.extend(fan(&ring));
    Some(Triangulation { triangles, is_simple: turn(a, b, c) >= 0.0 })
}

/// Returns twice the vector area (Newell), along the mean normal.
fn double_area(polygon: &[DVec3]) -> DVec3 {
    // Relative to one corner, to avoid cancellation far from the origin.
    let spoke = |i: usize| polygon[i] - polygon[0];
    (2..polygon.len()).map(|i| spoke(i - 1).cross(spoke(i))).sum()
}

/// Projects along the dominant axis of the mean normal, counter-clockwise.
fn flatten(polygon: &[DVec3]) -> Vec<DVec2> {
    let normal = double_area(polygon);
    let size = normal.abs();
    let (axis, sign) = if size.x >= size.y && size.x >= size.z {
        (0, normal.x)
    } else if size.y >= size.z {
        (1, normal.y)
    } else {
        (2, normal.z)
    };
    let project = |p: DVec3| {
        let (a, b) = (p[(axis + 1) % 3], p[(axis + 2) % 3]);
        if sign < 0.0 { DVec2::new(b, a) } else { DVec2::new(a, b) }
    };
    polygon.iter().map(|&p| project(p - polygon[0])).collect()
}

/// Returns twice the signed area, positive if counter-clockwise.
fn turn(a: DVec2, b: DVec2, c: DVec2) -> f64 {
    (b - a).perp_dot(c - a)
}

/// Every corner turns left, and so does every triangle of the fan, which excludes stars.
fn is_convex(flat: &[DVec2]) -> bool {
    let n = flat.len();
    (0..n).all(|i| turn(flat[i], flat[(i + 1) % n], flat[(i + 2) % n]) >= 0.0)
        && (2..n).all(|i| turn(flat[0], flat[i - 1], flat[i]) >= 0.0)
}

/// Whether corner 0 sees the whole polygon: the fan's triangles overlap by next to nothing and span less than a turn.
fn is_fan(flat: &[DVec2]) -> bool {
    let (mut forward, mut backward, mut angle) = (0.0, 0.0, 0.0);
    for pair in flat[1..].windows(2) {
        let [a, b] = [pair[0] - flat[0], pair[1] - flat[0]];
        let area = a.perp_dot(b);
        if area >= 0.0 {
            forward += area
        } else {
            backward -= area
        }
        angle += area.atan2(a.dot(b));
    }
    backward <= OVERLAP_MAX * forward && angle < TAU
}

fn neighbours(ring: &[usize], i: usize) -> [usize; 3] {
    [ring[(i + ring.len() - 1) % ring.len()], ring[i], ring[(i + 1) % ring.len()]]
}

/// Whether the triangle at `ring[i]` has area and contains no other corner. Coinciding corners do not count: a hole
/// joined to the outline repeats them.
fn is_ear(flat: &[DVec2], ring: &[usize], i: usize) -> bool {
    let [a, b, c] = neighbours(ring, i).map(|k| flat[k]);
    if turn(a, b, c) <= 0.0 {
        return false;
    }
    let holds = |p: DVec2| turn(a, b, p) >= 0.0 && turn(b, c, p) >= 0.0 && turn(c, a, p) >= 0.0;
    !ring.iter().map(|&k| flat[k]).any(|p| p != a && p != b && p != c && holds(p))
}
