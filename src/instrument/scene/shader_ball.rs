//! The scene `shader-ball`: a sphere whose opening shows a smaller one, in a cup. It has convex,
//! concave and grazing parts.
//!
//! Both bodies are surfaces of revolution. A profile is a list of arcs and lines in the half plane
//! (r, z).

use super::mesh::{Mesh, is_degenerate, position};
use super::{Material, Scene};
use glam::{DQuat, DVec2, DVec3};
use std::f64::consts::TAU;

const COLUMNS: u32 = 192;
/// Largest step of an arc, degrees.
const ROW_DEG: f64 = 2.5;
/// Tilt of the opening from +y towards +z, degrees.
const TILT_DEG: f64 = 42.0;
/// Polar angle of the opening's edge, degrees, and radius of its lip.
const OPENING_DEG: f64 = 40.0;
const LIP: f64 = 0.06;
const GAP: f64 = 0.03;
const ELEVATION_DEG: f64 = 16.0;

/// Returns the unit vector at `deg` degrees from +z towards +r.
fn toward(deg: f64) -> DVec2 {
    let (sin, cos) = deg.to_radians().sin_cos();
    DVec2::new(sin, cos)
}

/// A part of a profile: points with normals.
type Part = Vec<(DVec2, DVec2)>;

/// Makes an arc whose normals turn from `from` to `to` degrees; a negative radius makes it concave.
fn arc(center: DVec2, radius: f64, from: f64, to: f64) -> Part {
    let rows = ((to - from).abs() / ROW_DEG).ceil().max(1.0);
    let normal_at = |row: f64| toward(from + (to - from) * row / rows);
    (0..=rows as u32)
        .map(|row| {
            (
                center + radius * normal_at(f64::from(row)),
                normal_at(f64::from(row)),
            )
        })
        .collect()
}

/// Makes a line seen from the side at `deg` degrees.
fn line(from: DVec2, to: DVec2, deg: f64) -> Part {
    vec![(from, toward(deg)), (to, toward(deg))]
}

fn end(part: &Part) -> DVec2 {
    part.last().expect("a part has points").0
}

fn ball() -> Vec<Part> {
    let outer = arc(DVec2::ZERO, 1.0, 180.0, OPENING_DEG);
    let lip = arc((1.0 - LIP) * toward(OPENING_DEG), LIP, OPENING_DEG, -80.0);
    let inward = end(&lip) + 0.14 * toward(-80.0).perp();
    let wall = line(end(&lip), inward, -80.0);
    let core = arc(
        DVec2::ZERO,
        inward.length(),
        inward.x.atan2(inward.y).to_degrees(),
        0.0,
    );
    vec![outer, lip, wall, core]
}

fn cup() -> Vec<Part> {
    let edge_deg = 128.0;
    let lip = 0.07;
    let wall_deg = 72.0;
    let foot = 0.05;
    // Normals point to the bowl's centre, so the radius is negative.
    let bowl = arc(DVec2::ZERO, -(1.0 + GAP), 0.0, edge_deg - 180.0);
    let rim = arc(
        (1.0 + GAP + lip) * toward(edge_deg),
        lip,
        edge_deg - 180.0,
        wall_deg,
    );
    let wall_end = end(&rim) - 0.3 * toward(wall_deg).perp();
    let wall = line(end(&rim), wall_end, wall_deg);
    let base = arc(wall_end - foot * toward(wall_deg), foot, wall_deg, 180.0);
    let floor = line(end(&base), DVec2::new(0.0, end(&base).y), 180.0);
    vec![bowl, rim, wall, base, floor]
}

/// Revolves a profile around +y, then rotates it by `turn`.
fn revolved(parts: &[Part], turn: DQuat) -> Mesh {
    let mut mesh = Mesh::empty(0);
    for part in parts {
        let first = mesh.positions.len() as u32;
        for (point, normal) in part {
            for column in 0..=COLUMNS {
                let (sin, cos) = (TAU * f64::from(column) / f64::from(COLUMNS)).sin_cos();
                let revolve = |p: &DVec2| {
                    (turn * DVec3::new(p.x * sin, p.y, p.x * cos))
                        .as_vec3()
                        .to_array()
                };
                mesh.positions.push(revolve(point));
                mesh.normals.push(revolve(normal));
            }
        }
        for row in 0..part.len() as u32 - 1 {
            for column in 0..COLUMNS {
                let [a, b] = [row, row + 1].map(|row| first + row * (COLUMNS + 1) + column);
                // Two corners of a triangle at a pole coincide.
                let has_area = |triangle: &[u32; 3]| {
                    !is_degenerate(triangle.map(|i| position(&mesh.positions, i)))
                };
                mesh.indices.extend(
                    [[a, a + 1, b + 1], [a, b + 1, b]]
                        .iter()
                        .filter(|t| has_area(t))
                        .flatten(),
                );
            }
        }
    }
    mesh.wind_by_normals();
    mesh.uvs = vec![[0.0; 2]; mesh.positions.len()];
    mesh.tangents = vec![[0.0; 4]; mesh.positions.len()];
    mesh
}

pub(super) fn shader_ball() -> Scene {
    let tilt = DQuat::from_rotation_x(TILT_DEG.to_radians());
    let meshes = vec![revolved(&ball(), tilt), revolved(&cup(), DQuat::IDENTITY)];
    let mut scene = Scene::assemble("shader-ball", Vec::new(), meshes, vec![Material::default()]);
    scene.toward_viewer = super::toward(0.0, ELEVATION_DEG);
    scene.hashed()
}
