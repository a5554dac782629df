use super::{SpecularOcclusion, common_solid_angle};
use crate::base::names::Listed;
use std::f64::consts::{FRAC_PI_2, PI, TAU};

const COSINES: [f64; 4] = [1e-4, 0.1, 0.5, 1.0];
const ALPHAS: [f64; 4] = [1e-3, 0.1, 0.5, 1.0];

#[test]
fn full_light_is_not_occluded() {
    for kind in SpecularOcclusion::all() {
        for (n_dot_v, alpha) in pairs() {
            assert_eq!(kind.factor(1.0, n_dot_v, alpha), 1.0, "{kind:?}");
        }
    }
}

#[test]
fn factors_grow_with_the_light_that_is_let_through() {
    for kind in SpecularOcclusion::all() {
        for (n_dot_v, alpha) in pairs() {
            let mut last = 0.0;
            for step in 0..=64 {
                let factor = kind.factor(f64::from(step) / 64.0, n_dot_v, alpha);
                assert!((last..=1.0).contains(&factor), "{kind:?}: {factor}");
                last = factor;
            }
        }
    }
}

fn pairs() -> impl Iterator<Item = (f64, f64)> {
    COSINES
        .into_iter()
        .flat_map(|cosine| ALPHAS.map(|alpha| (cosine, alpha)))
}

/// By hand: at alpha 0.5 the exponent is 2^-9, at alpha 0 it is 1/2.
#[test]
fn lagardes_factor_by_hand() {
    let factor = |ao, n_dot_v, alpha| SpecularOcclusion::Lagarde.factor(ao, n_dot_v, alpha);
    assert!(
        (factor(0.5, 0.5, 0.5) - 0.5).abs() < 1e-12,
        "1 to any power"
    );
    assert!((factor(0.25, 0.0, 0.0) - 0.0).abs() < 1e-12, "0.5 - 0.75");
    assert!((factor(0.64, 0.0, 0.0) - 0.44).abs() < 1e-12, "0.8 - 0.36");
    assert!((factor(0.5, 1.0, 0.5) - (1.5f64.powf(1.0 / 512.0) - 0.5)).abs() < 1e-12);
}

#[test]
fn cones_share_the_smaller_one_or_nothing() {
    let cap = |angle: f64| TAU * (1.0 - angle.cos());
    assert_eq!(common_solid_angle(0.3, FRAC_PI_2, 0.5), cap(0.3));
    assert_eq!(common_solid_angle(0.3, 0.4, 0.7), 0.0);
    // Half of a narrow cone is above a horizon through its axis.
    let half = common_solid_angle(0.01, FRAC_PI_2, FRAC_PI_2);
    assert!((half / cap(0.01) - 0.5).abs() < 1e-12);
    // Continuous where one is inside the other.
    let [inside, outside] = [0.1, 0.1 + 1e-9].map(|apart| common_solid_angle(0.3, 0.4, apart));
    assert!((inside / outside - 1.0).abs() < 1e-9);
}

/// A mirror sees one direction: the visible cone holds it or not.
#[test]
fn a_mirror_is_lit_inside_the_visible_cone() {
    let factor = |degrees: f64, ao: f64| {
        SpecularOcclusion::Cone.factor(ao, (degrees / 180.0 * PI).cos(), 1e-4)
    };
    // sin² 30 degrees is 0.25.
    assert_eq!([factor(29.9, 0.25), factor(30.1, 0.25)], [1.0, 0.0]);
}
