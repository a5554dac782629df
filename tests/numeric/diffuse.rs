//! Irradiance from spherical harmonics by the diffuse methods, and light returned by compensation.

use glam::{DMat3, DQuat, DVec2, DVec3};
use splitsum::brdf::{Compensation, MODELS, MaskingShadowing};
use splitsum::math::sampling::{direction_from_polar, hammersley};
use splitsum::math::spherical_harmonics::{COUNT, basis, irradiance};
use splitsum::precompute::dfg::reference::dfg;
use splitsum::shade::diffuse::{sh9_windowed, zh3};
use splitsum::spelling::Listed;
use std::f64::consts::PI;

type Evaluate = fn(&[DVec3; COUNT], DVec3) -> DVec3;
const METHODS: [(&str, Evaluate); 2] =
    [("sh9-windowed", sh9_windowed::irradiance_over_pi), ("zh3", zh3::irradiance_over_pi)];

/// Coefficients of lamps of one direction each, with their colours.
fn lamps(lamps: &[(DVec3, DVec3)]) -> [DVec3; COUNT] {
    std::array::from_fn(|k| lamps.iter().map(|(direction, color)| *color * basis(*direction)[k]).sum())
}

/// Coefficients of `constant + slope d`; each row of the slope is a channel.
fn linear(constant: DVec3, slope: DMat3) -> [DVec3; COUNT] {
    let [l0, l1] = [2.0 * PI.sqrt(), 2.0 * (PI / 3.0).sqrt()];
    let mut coefficients = [DVec3::ZERO; COUNT];
    coefficients[0] = l0 * constant;
    [coefficients[1], coefficients[2], coefficients[3]] = [l1 * slope.y_axis, l1 * slope.z_axis, l1 * slope.x_axis];
    coefficients
}

fn directions() -> impl Iterator<Item = DVec3> {
    (0..200).map(|i| {
        let xi = hammersley(i, 200);
        let z = 1.0 - 2.0 * xi.x;
        direction_from_polar((1.0 - z * z).sqrt(), z, xi.y)
    })
}

const COLOR: DVec3 = DVec3::new(0.7, 1.0, 2.5);

/// Light `1 + g d` has an irradiance over π of `1 + 2/3 g n`. A window scales the slope by its value at degree 1. ZH3
/// adds its guess, which has mean 0 over the sphere and the published size along the axis.
#[test]
fn linear_light_follows_the_window_and_the_guess() {
    let axis = DVec3::new(0.48, 0.6, 0.64);
    let along = DVec3::new(0.5, 0.2, 0.9);
    let light = linear(COLOR, DMat3::from_cols(along * axis.x, along * axis.y, along * axis.z));
    for n in directions() {
        let slope = 2.0 / 3.0 * along * axis.dot(n);
        let windowed = COLOR + 0.5 * (1.0 + (PI / 6.0).cos()) * slope;
        assert!((sh9_windowed::irradiance_over_pi(&light, n) - windowed).abs().max_element() < 1e-14, "{n}");
        // L1 over L00 of this light is along/(sqrt 3 constant); Y20 of the axis, A2/pi = 1/4.
        let ratio = along / (3f64.sqrt() * COLOR);
        let l00 = 2.0 * PI.sqrt() * COLOR;
        let y20 = (5.0 / (16.0 * PI)).sqrt() * (3.0 * axis.dot(n).powi(2) - 1.0);
        let guess = 0.25 * y20 * l00 * (0.08 * ratio + 0.6 * ratio * ratio);
        assert!((zh3::irradiance_over_pi(&light, n) - COLOR - slope - guess).abs().max_element() < 1e-13, "{n}");
    }
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
    for (name, evaluate) in METHODS {
        for n in directions() {
            let [still, moved] = [evaluate(&lamps(&light), n), evaluate(&lamps(&turned), turn * n)];
            assert!((still - moved).abs().max_element() < 1e-13, "{name} {n}: {still} {moved}");
        }
    }
}

/// Opposite a small lamp nine coefficients fall below 0; the window removes a part of that. ZH3 is nearer to nine
/// coefficients than four are.
#[test]
fn ringing_and_the_missing_band_are_smaller() {
    let lamp = lamps(&[(DVec3::Z, COLOR)]);
    let lowest = |evaluate: &dyn Fn(DVec3) -> DVec3| {
        let values = directions().map(|n| evaluate(n).x);
        values.fold(f64::INFINITY, f64::min) / evaluate(DVec3::Z).x
    };
    let plain = lowest(&|n| irradiance(&lamp, n));
    let windowed = lowest(&|n| sh9_windowed::irradiance_over_pi(&lamp, n));
    assert!((plain + 0.037).abs() < 1e-3 && (windowed + 0.023).abs() < 1e-3, "{plain} {windowed}");
    let mut four = lamp;
    four[4..].fill(DVec3::ZERO);
    let off = |evaluate: &dyn Fn(DVec3) -> DVec3| -> f64 {
        directions().map(|n| (evaluate(n) - irradiance(&lamp, n) / PI).length_squared()).sum()
    };
    let [guessed, missing] = [off(&|n| zh3::irradiance_over_pi(&lamp, n)), off(&|n| irradiance(&four, n) / PI)];
    assert!(guessed < 0.1 * missing, "{guessed} {missing}");
}

/// A white furnace: at f0 = 1 all lost light returns; below it, never more, and more for a higher f0.
#[test]
fn compensation_returns_the_lost_light() {
    let mean_of = |model, alpha| {
        let cosine = |i: u32| (f64::from(i) + 0.5) / 8.0;
        let at = |i| 2.0 * cosine(i) / 8.0 * dfg(model, MaskingShadowing::SmithExact, cosine(i), alpha).albedo();
        (0..8).map(at).sum::<f64>()
    };
    for model in MODELS {
        for alpha in [0.3, 1.0] {
            let mean = mean_of(*model, alpha);
            for n_dot_v in [0.1, 0.5, 1.0] {
                let exact = dfg(*model, MaskingShadowing::SmithExact, n_dot_v, alpha);
                let pair = DVec2::new(exact.f0_scale, exact.f90_scale);
                for &compensation in Compensation::all() {
                    let all = |f0: f64| compensation.reflectance(DVec3::splat(f0), pair, mean).x;
                    let single = |f0: f64| f0 * pair.x + pair.y;
                    let case = format!("{} {compensation:?} {alpha} {n_dot_v}", model.name());
                    match compensation {
                        Compensation::None => assert_eq!(all(1.0), single(1.0), "{case}"),
                        _ => assert!((all(1.0) - 1.0).abs() < 1e-12, "{case}: {}", all(1.0)),
                    }
                    let added = [0.04, 0.3, 0.7, 1.0].map(|f0| all(f0) - single(f0));
                    assert!(added.iter().all(|x| *x >= 0.0 && *x <= 1.0 - single(1.0) + 1e-12), "{case}: {added:?}");
                    assert!(added.is_sorted(), "{case}: {added:?}");
                }
            }
        }
    }
}
