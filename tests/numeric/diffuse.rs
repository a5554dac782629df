//! Irradiance from spherical harmonics by the diffuse methods, and light returned by compensation.

use crate::compensation_twins::reflectance;
use crate::math::spread;
use glam::{DQuat, DVec2, DVec3};
use splitsum::base::math::equirect::direction_from_uv;
use splitsum::base::math::spherical_harmonics::{COUNT, basis, irradiance};
use splitsum::base::names::Listed;
use splitsum::instrument::brdf::{Compensation, FresnelWeight, MODELS, MaskingShadowing};
use splitsum::instrument::precompute::dfg::reference::dfg;
use splitsum::instrument::precompute::sh9::reference::{texture, texture_lookup};
use std::f64::consts::PI;

/// Coefficients of lamps of one direction each, with their colours.
fn lamps(lamps: &[(DVec3, DVec3)]) -> [DVec3; COUNT] {
    std::array::from_fn(|k| {
        lamps
            .iter()
            .map(|(direction, color)| *color * basis(*direction)[k])
            .sum()
    })
}

#[test]
fn turning_light_and_normal_together_changes_nothing() {
    let light = [
        (DVec3::X, DVec3::new(1.0, 0.2, 0.1)),
        (DVec3::new(0.0, 0.6, 0.8), DVec3::new(0.3, 2.0, 0.4)),
        (DVec3::new(-0.8, 0.0, -0.6), DVec3::new(0.1, 0.1, 1.0)),
    ];
    let turn = DQuat::from_axis_angle(DVec3::new(0.6, -0.64, 0.48), 2.1);
    let turned = light.map(|(direction, color)| (turn * direction, color));
    for n in spread(200) {
        let [still, moved] = [
            irradiance(&lamps(&light), n),
            irradiance(&lamps(&turned), turn * n),
        ];
        assert!(
            (still - moved).abs().max_element() < 1e-12,
            "{n}: {still} {moved}"
        );
    }
}

/// The texture of 400x200 texels against the coefficients at each normal, for one lamp: the worst
/// light of degree 2. docs/source-documents.md has the numbers.
#[test]
fn the_irradiance_texture_is_close_to_its_coefficients() {
    let lamp = |direction: DVec3| lamps(&[(direction, DVec3::new(1.0, 0.5, 0.25))]);
    let mut largest = 0.0f64;
    for direction in [DVec3::Z, DVec3::Y, DVec3::new(0.6, 0.64, 0.48)] {
        let light = lamp(direction);
        let peak = irradiance(&light, direction).x / PI;
        let normals: Vec<DVec3> = spread(20_000).collect();
        let mut squares = 0.0;
        for n in &normals {
            let exact = (irradiance(&light, *n) / PI).max(DVec3::ZERO);
            let off = (texture_lookup(&light, *n) - exact).x.abs() / peak;
            largest = largest.max(off);
            squares += off * off / normals.len() as f64;
        }
        let rms = squares.sqrt();
        println!("{direction}: {rms:e} rms, largest so far {largest:e}");
        assert!(rms > 1e-5 && rms < 5e-5, "{direction}: {rms}");
    }
    assert!(largest > 5e-4 && largest < 1.2e-3, "{largest}");
    // The lookup reads the texture.
    let light = lamp(DVec3::X);
    let image = texture(&light);
    for [x, y] in [[0, 0], [399, 100], [123, 199]] {
        let uv = DVec2::new((f64::from(x) + 0.5) / 400.0, (f64::from(y) + 0.5) / 200.0);
        let off = texture_lookup(&light, direction_from_uv(uv)) - image.get(x, y);
        assert!(off.length() < 1e-9, "{x} {y}");
    }
}

/// A white furnace: at f0 = 1 all lost light returns; below it, never more, and more for a higher
/// f0.
#[test]
fn compensation_returns_the_lost_light() {
    let mean_of = |model, alpha| {
        let cosine = |i: u32| (f64::from(i) + 0.5) / 8.0;
        let at = |i| {
            2.0 * cosine(i) / 8.0
                * dfg(model, MaskingShadowing::SmithExact, cosine(i), alpha).albedo()
        };
        (0..8).map(at).sum::<f64>()
    };
    for model in MODELS {
        for alpha in [0.3, 1.0] {
            let mean = mean_of(*model, alpha);
            for n_dot_v in [0.1, 0.5, 1.0] {
                let exact = dfg(*model, MaskingShadowing::SmithExact, n_dot_v, alpha);
                let pair = DVec2::new(exact.f0_scale, exact.f90_scale);
                for &compensation in Compensation::all() {
                    let all = |f0: f64| {
                        reflectance(
                            compensation,
                            FresnelWeight::Schlick,
                            DVec3::splat(f0),
                            pair,
                            mean,
                        )
                        .x
                    };
                    let single = |f0: f64| f0 * pair.x + pair.y;
                    let case = format!("{} {compensation:?} {alpha} {n_dot_v}", model.name());
                    match compensation {
                        Compensation::None => assert_eq!(all(1.0), single(1.0), "{case}"),
                        _ => assert!((all(1.0) - 1.0).abs() < 1e-12, "{case}: {}", all(1.0)),
                    }
                    let added = [0.04, 0.3, 0.7, 1.0].map(|f0| all(f0) - single(f0));
                    assert!(
                        added
                            .iter()
                            .all(|x| *x >= 0.0 && *x <= 1.0 - single(1.0) + 1e-12),
                        "{case}: {added:?}"
                    );
                    assert!(added.is_sorted(), "{case}: {added:?}");
                }
            }
        }
    }
}
