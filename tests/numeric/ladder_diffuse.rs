//! The radiance of the diffuse ladders' coalitions against other formulas.

use glam::{DVec2, DVec3};
use splitsum::environment::Environment;
use splitsum::environment::layout::{FilteredMap, LAYOUTS};
use splitsum::ladder::diffuse::{Irradiance, Radiance, integrals};
use splitsum::ladder::game::{Coalition, coalitions};
use splitsum::ladder::radiance::rounded;
use splitsum::ladder::{IRRADIANCE_MAP, SH9, ladder_of};
use splitsum::math::design;
use splitsum::pixels::{Pixels, RgbImage};
use splitsum::precompute::exact_quadrature;
use splitsum::precompute::sh9::reference::{project_bilinear, project_texel_centers};
use splitsum::shade::{DIFFUSE, METHODS};
use std::f64::consts::{PI, TAU};
use std::sync::Arc;

const F0: DVec3 = DVec3::new(0.04, 0.3, 0.9);
const PAIRS: [DVec2; 2] = [DVec2::new(0.7, 0.1), DVec2::new(0.71, 0.12)];

fn of(steps: &[&str], ladder: &splitsum::ladder::Ladder) -> Coalition {
    let place = |name: &&str| ladder.steps.iter().position(|step| step.name == *name).unwrap();
    steps.iter().fold(0, |all, name| all | 1 << place(name))
}

fn frames(count: u32) -> Vec<[DVec3; 2]> {
    (0..count).map(|i| design::frame(i, count)).collect()
}

fn environment(texel: impl Fn(u32, u32) -> [f32; 3]) -> Environment {
    Environment::from_image("made", RgbImage::from_fn(64, 32, texel))
}

/// A lamp in dim light: nine coefficients ring below 0.
fn lamp() -> Environment {
    environment(|x, y| [if (10..13).contains(&x) && (12..15).contains(&y) { 200.0 } else { 0.05 }; 3])
}

fn radiance<'a>(environment: &Environment, frames: &'a [[DVec3; 2]], irradiance: Irradiance) -> Radiance<'a> {
    Radiance {
        frames,
        exact: Arc::new(integrals(&exact_quadrature(&environment.image), frames)),
        irradiance,
        albedos: Some(PAIRS.map(|pair| vec![pair; frames.len()])),
        f0: F0,
        scale: DVec3::splat(0.5),
    }
}

fn sh9(environment: &Environment) -> Irradiance {
    let exact = project_bilinear(&exact_quadrature(&environment.image));
    Irradiance::Sh9(Box::new([exact, project_texel_centers(&environment.image)]))
}

/// A map of one number a texel, by layout.
fn map(value: impl Fn(DVec3) -> f64) -> FilteredMap {
    let layout = &LAYOUTS[0];
    let face = |face| {
        Pixels::from_fn(8, 8, |x, y| {
            let uv = (DVec2::new(x.into(), y.into()) + 0.5) / 8.0;
            DVec3::splat(value((layout.direction)(face, uv)))
        })
    };
    FilteredMap { layout, levels: vec![(0..layout.face_count).map(face).collect()] }
}

#[test]
fn the_first_two_rungs_are_sums_over_the_hemisphere() {
    let (environment, frames) = (lamp(), frames(40));
    let found = radiance(&environment, &frames, sh9(&environment));
    let (inside, outside) = (found.of(0), found.of(of(&["Fresnel"], &SH9)));
    for (pixel, [n, v]) in frames.iter().enumerate() {
        let (across, rest) = n.any_orthonormal_pair();
        let (mut with_fresnel, mut irradiance) = (DVec3::ZERO, DVec3::ZERO);
        let (rows, columns) = (300, 900);
        for row in 0..rows {
            // dl n·l / π = 2 cos d(cos) dφ / 2π.
            let cos = (f64::from(row) + 0.5) / f64::from(rows);
            for column in 0..columns {
                let phi = TAU * (f64::from(column) + 0.5) / f64::from(columns);
                let l = *n * cos + (across * phi.cos() + rest * phi.sin()) * (1.0 - cos * cos).sqrt();
                let light = environment.radiance(l) * 2.0 * cos / f64::from(rows * columns);
                // (v·h)² = (1 + v·l) / 2.
                let fresnel = F0 + (1.0 - F0) * (1.0 - (0.5 * (1.0 + v.dot(l))).sqrt()).powi(5);
                with_fresnel += (1.0 - fresnel) * light;
                irradiance += light;
            }
        }
        let right = [0.5 * with_fresnel, 0.5 * irradiance * (1.0 - (F0 * PAIRS[0].x + PAIRS[0].y))];
        for (own, right) in [inside[pixel], outside[pixel]].into_iter().zip(right) {
            // A lamp at the horizon leaves little light.
            assert!(((own - right) / (right + 0.01)).abs().max_element() < 3e-3, "pixel {pixel}: {own}, not {right}");
        }
    }
}

#[test]
fn light_of_degree_two_has_no_step_of_truncation() {
    // Approximately: the bilinear map of a polynomial is not a polynomial. Quadrature at texel centres errs by as much.
    let environment = environment(|x, y| {
        let (u, v) = ((f64::from(x) + 0.5) / 64.0, (f64::from(y) + 0.5) / 32.0);
        let (phi, theta) = (TAU * (0.5 - u), PI * v);
        let d = DVec3::new(phi.sin() * theta.sin(), theta.cos(), phi.cos() * theta.sin());
        [(1.0 + 0.4 * d.x + 0.3 * d.y * d.z) as f32, (1.0 + 0.5 * d.y) as f32, 1.0]
    });
    let frames = frames(64);
    let found = radiance(&environment, &frames, sh9(&environment));
    let exact = found.of(0);
    for steps in [&["truncation"][..], &["truncation", "clamp"], &["truncation", "clamp", "quadrature"]] {
        for (own, right) in found.of(of(steps, &SH9)).iter().zip(&exact) {
            assert!(((own - right) / right).abs().max_element() < 5e-3, "{steps:?}: {own}, not {right}");
        }
    }
}

#[test]
fn only_the_clamp_keeps_nine_coefficients_above_zero() {
    let (environment, frames) = (lamp(), frames(200));
    let found = radiance(&environment, &frames, sh9(&environment));
    let least =
        |steps: &[&str]| found.of(of(steps, &SH9)).iter().map(|rgb| rgb.min_element()).fold(f64::INFINITY, f64::min);
    assert!(least(&["truncation"]) < -1e-2 && least(&["truncation", "quadrature"]) < -1e-2);
    assert!(least(&["truncation", "clamp"]) == 0.0 && least(&["truncation", "clamp", "quadrature"]) == 0.0);
}

#[test]
fn steps_of_a_map_are_its_texels_its_samples_and_its_format() {
    let (environment, frames) = (lamp(), frames(50));
    let [exact, made] = [map(|d| 1.0 + d.x * d.x), map(|d| 1.001 + d.x * d.x)];
    let halves = |map: &FilteredMap| FilteredMap {
        levels: vec![map.levels[0].iter().map(|face| face.map(rounded)).collect()],
        ..map.clone()
    };
    let maps = [&exact, &made].map(|map| [map.clone(), halves(map)]);
    let found = radiance(&environment, &frames, Irradiance::Map(maps));
    let ladder = &IRRADIANCE_MAP;
    let ratio = |a: &[&str], b: &[&str]| -> Vec<f64> {
        let [a, b] = [a, b].map(|steps| found.of(of(steps, ladder)));
        a.iter().zip(&b).map(|(a, b)| a.x - b.x).collect()
    };
    let entering = |pair: DVec2| 0.5 * (1.0 - (F0.x * pair.x + pair.y));
    // The change by each step with Fresnel approximated: linear filtering between texels of a convex function errs upwards.
    for by in ratio(&["Fresnel", "texels", "samples"], &["Fresnel", "texels"]) {
        assert!((by / entering(PAIRS[0]) - 1e-3).abs() < 1e-9, "samples: {by:e}");
    }
    for by in ratio(&["Fresnel", "texels", "storage"], &["Fresnel", "texels"]) {
        assert!(by.abs() < 0.5 * 2f64.powi(-10) * entering(PAIRS[0]), "storage: {by:e}");
    }
    let table = ratio(&["Fresnel", "texels", "table"], &["Fresnel", "texels"]);
    let light = found.of(of(&["Fresnel", "texels"], ladder));
    for (by, light) in table.iter().zip(&light) {
        let right = light.x * (entering(PAIRS[1]) / entering(PAIRS[0]) - 1.0);
        assert!((by - right).abs() < 1e-12, "table: {by:e}, not {right:e}");
    }
    let stored = ratio(&["texels", "storage"], &["texels"]);
    assert!(stored.iter().any(|by| by.abs() > 1e-6), "halves are rounded");
}

#[test]
fn diffuse_ladders_have_their_orders() {
    // Fresnel and its table: neither, Fresnel or both; truncation, or the map, with or without each of the other two.
    for ladder in [&SH9, &IRRADIANCE_MAP] {
        assert_eq!(coalitions(&ladder.needs()).len(), 3 * 5);
    }
    let split = METHODS.iter().find(|method| method.has_ladder).unwrap();
    for diffuse in DIFFUSE {
        let found = ladder_of(split, diffuse).unwrap().steps[1].name;
        let right = match diffuse.name {
            "sh9" => "truncation",
            "irradiance-map" => "texels",
            _ => "masking",
        };
        assert_eq!(found, right, "{}", diffuse.name);
    }
}
