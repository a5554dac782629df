//! Polygons to triangles by ear clipping.

use glam::{DVec2, DVec3};
use std::f64::consts::TAU;

/// Most corners of a polygon that is not convex; clipping takes the square of their number.
pub const MAX_CONCAVE_CORNERS: usize = 4096;

/// Share of a fan's area that may overlap: what rounding to seven digits makes of a convex outline is a thousandth of it.
const OVERLAP_MAX: f64 = 1e-6;

/// The triangles of a polygon.
#[derive(Debug, PartialEq)]
pub struct Triangulation {
    /// Indices of the polygon's corners, wound as the polygon is.
    pub triangles: Vec<[usize; 3]>,
    /// Whether the triangles' areas add up to the polygon's; they do not, and some overlap, where the polygon crosses itself.
    pub is_simple: bool,
}

/// Splits a polygon, in general neither convex nor quite planar, into triangles between its corners. The sum of their areas is the
/// polygon's, projected along its mean normal. `None` if it has more than [`MAX_CONCAVE_CORNERS`] corners and the first does not see all of it.
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
        // Starting behind the last ear keeps the cuts from forming one fan, and usually finds the next at once.
        let Some(i) = (0..ring.len()).map(|k| (start + k) % ring.len()).find(|&i| is_ear(&flat, &ring, i)) else {
            triangles.extend(fan(&ring));
            return Some(Triangulation { triangles, is_simple: false });
        };
        triangles.push(neighbours(&ring, i));
        ring.remove(i);
        start = i;
    }
    // Every ear has positive area; so must what they leave.
    let [a, b, c] = neighbours(&ring, 1).map(|k| flat[k]);
    triangles.extend(fan(&ring));
    Some(Triangulation { triangles, is_simple: turn(a, b, c) >= 0.0 })
}

/// Twice the vector area of a polygon: its direction is the mean normal (Newell), its length twice the projected area.
fn double_area(polygon: &[DVec3]) -> DVec3 {
    // Relative to one corner: far from the origin the products would cancel.
    let spoke = |i: usize| polygon[i] - polygon[0];
    (2..polygon.len()).map(|i| spoke(i - 1).cross(spoke(i))).sum()
}

/// The polygon seen against its mean normal, so that it is counter-clockwise: the coordinate that the normal is longest in is left out.
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

/// Twice the signed area of a triangle, positive if counter-clockwise.
fn turn(a: DVec2, b: DVec2, c: DVec2) -> f64 {
    (b - a).perp_dot(c - a)
}

/// Every corner turns left, and so does every triangle of the fan; the second excludes stars.
fn is_convex(flat: &[DVec2]) -> bool {
    let n = flat.len();
    (0..n).all(|i| turn(flat[i], flat[(i + 1) % n], flat[(i + 2) % n]) >= 0.0)
        && (2..n).all(|i| turn(flat[0], flat[i - 1], flat[i]) >= 0.0)
}

/// Whether the fan covers the polygon, which it does where corner 0 sees all of it: its triangles lie side by side, less than once around.
/// Corners rounded off a convex outline make some of them overlap by next to nothing.
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

/// The corner before `i`, the corner, and the corner after it.
fn neighbours(ring: &[usize], i: usize) -> [usize; 3] {
    [ring[(i + ring.len() - 1) % ring.len()], ring[i], ring[(i + 1) % ring.len()]]
}

/// Whether the triangle at `ring[i]` has area and holds no other corner. Corners that coincide with one of its own do not count: a hole
/// joined to the outline by a pair of equal edges repeats them.
fn is_ear(flat: &[DVec2], ring: &[usize], i: usize) -> bool {
    let [a, b, c] = neighbours(ring, i).map(|k| flat[k]);
    if turn(a, b, c) <= 0.0 {
        return false;
    }
    let holds = |p: DVec2| turn(a, b, p) >= 0.0 && turn(b, c, p) >= 0.0 && turn(c, a, p) >= 0.0;
    !ring.iter().map(|&k| flat[k]).any(|p| p != a && p != b && p != c && holds(p))
}
