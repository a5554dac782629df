//! Layouts of filtered maps: mappings and their inverses, solid angles, and filtering across edges.

use crate::math::spread;
use glam::{DVec2, DVec3};
use splitsum::base::pixels::Pixels;
use splitsum::instrument::environment::layout::{FilteredMap, LAYOUTS, MapLayout};
use std::f64::consts::PI;

/// Evenly spread unit vectors, and the directions of edges, corners and poles of layouts.
fn directions(count: u32) -> Vec<DVec3> {
    let signs = [-1.0, 0.0, 1.0];
    let special = signs.iter().flat_map(|&x| {
        signs
            .iter()
            .flat_map(move |&y| signs.map(|z| DVec3::new(x, y, z)))
    });
    spread(count)
        .chain(special.filter(|d| *d != DVec3::ZERO).map(DVec3::normalize))
        .collect()
}

fn size(layout: &MapLayout, side: u32) -> [u32; 2] {
    if layout.is_square {
        [side; 2]
    } else {
        [2 * side, side]
    }
}

/// A map of one level whose texels hold a function of their directions.
fn map(
    layout: &'static MapLayout,
    [width, height]: [u32; 2],
    of: impl Fn(DVec3) -> f64,
) -> FilteredMap {
    let face = |face| {
        Pixels::from_fn(width, height, |x, y| {
            let uv =
                (DVec2::new(x.into(), y.into()) + 0.5) / DVec2::new(width.into(), height.into());
            DVec3::splat(of((layout.direction)(face, uv)))
        })
    };
    FilteredMap {
        layout,
        levels: vec![(0..layout.face_count).map(face).collect()],
    }
}

#[test]
fn places_and_directions_are_inverse() {
    for layout in LAYOUTS {
        for d in directions(2000) {
            let (face, uv) = (layout.face_uv)(d);
            assert!(
                face < layout.face_count && uv.min_element() >= 0.0 && uv.max_element() <= 1.0,
                "{d}: {face} {uv}"
            );
            let back = (layout.direction)(face, uv);
            assert!(
                back.distance(d) < 1e-7,
                "{}: {d} at {face} {uv} is {back}",
                layout.name
            );
        }
    }
}

#[test]
fn texels_cover_the_sphere_once() {
    for layout in LAYOUTS {
        // Each texel's solid angle at its centre: the midpoint rule, whose error falls with the
        // square of the side.
        let size = size(layout, 64);
        let areas = map(layout, size, |d| (layout.texel_solid_angle)(d, size, 0.0));
        let total: f64 = areas.levels[0]
            .iter()
            .flat_map(|face| &face.data)
            .map(|texel| texel.x)
            .sum();
        assert!(
            (total / (4.0 * PI) - 1.0).abs() < 3e-4,
            "{}: {total}",
            layout.name
        );
    }
}

#[test]
fn lookups_are_continuous_across_every_edge() {
    // Linear between the texels of a smooth function: the error is the square of a texel. At the
    // folds of the octahedron, where the mapping has a kink, it is a share of a texel times the
    // slope, 0.02 x 0.5.
    let smooth = |d: DVec3| 1.0 + 0.5 * d.x - 0.3 * d.y + 0.4 * d.z * d.x + 0.2 * d.y * d.z;
    for layout in LAYOUTS {
        let map = map(layout, size(layout, 128), smooth);
        for d in directions(20_000) {
            let off = map.value(d, 0.0).x - smooth(d);
            assert!(off.abs() < 1e-2, "{}: {d} is off by {off}", layout.name);
        }
    }
}
