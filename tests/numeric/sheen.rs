//! Sheen against identities, closed forms and a quadrature over directions that shares no code with
//! the program.

use crate::brdf::integrate_sphere;
use crate::chi_square::{fit_of_half_vectors, xi};
use fastrand::Rng;
use glam::DVec3;
use splitsum::base::math::sampling::direction_from_polar;
use splitsum::base::names::Listed;
use splitsum::instrument::brdf::{
    Brdf, MaskingShadowing, SHEEN_ALPHA_MIN, SheenVisibility, eval_without_fresnel,
};
use splitsum::instrument::precompute::dfg::{Albedos, reference::dfg};
use splitsum::instrument::precompute::prefilter::Kernel;
use splitsum::instrument::shade::sheen::{SHEEN_LOOKUPS, SheenLookup, SheenShares, shares};
use std::f64::consts::TAU;

const ALPHAS: [f64; 5] = [SHEEN_ALPHA_MIN, 0.04, 0.16, 0.36, 1.0];
const VIEWS: [f64; 4] = [0.05, 0.3, 0.6, 0.95];
const CORRELATED: MaskingShadowing = MaskingShadowing::Correlated;

/// The lobe times n·l about +y, as the extension's text has it: Charlie's D over its visibility.
pub fn lobe(visibility: SheenVisibility, alpha: f64, v: DVec3, l: DVec3) -> f64 {
    let lambda = |x: f64| {
        let w = (1.0 - alpha) * (1.0 - alpha);
        let of = |[rough, smooth]: [f64; 2]| w * smooth + (1.0 - w) * rough;
        let fit = |x: f64| {
            let [a, b, c] = [[21.5473, 25.3245], [3.82987, 3.32435], [0.19823, 0.16801]].map(of);
            a / (1.0 + b * x.powf(c)) + of([-1.97760, -1.27393]) * x + of([-4.32054, -4.85967])
        };
        if x < 0.5 {
            fit(x)
        } else {
            2.0 * fit(0.5) - fit(1.0 - x)
        }
        .exp()
    };
    let sin2 = 1.0 - (v + l).normalize().y.powi(2);
    let d = (2.0 + 1.0 / alpha) * sin2.max(0.0).powf(0.5 / alpha) / TAU;
    match visibility {
        SheenVisibility::Charlie => d / ((1.0 + lambda(v.y) + lambda(l.y)) * 4.0 * v.y),
        SheenVisibility::Ashikhmin => d * l.y / (4.0 * (l.y + v.y - l.y * v.y)),
    }
}

/// Sums `f` times the solid angle over directions above the horizon, closer to each other near it.
pub fn over_directions(steps: u32, mut f: impl FnMut(DVec3, f64)) {
    for (i, j) in (0..steps).flat_map(|i| (0..2 * steps).map(move |j| (i, j))) {
        let u = (f64::from(i) + 0.5) / f64::from(steps);
        let (cos, turn) = (u * u * u, (f64::from(j) + 0.5) / f64::from(2 * steps));
        let l = direction_from_polar((1.0 - cos * cos).sqrt(), cos, turn);
        f(
            DVec3::new(l.x, l.z, l.y),
            3.0 * u * u * TAU / f64::from(2 * steps * steps),
        );
    }
}

fn view(n_dot_v: f64) -> DVec3 {
    DVec3::new((1.0 - n_dot_v * n_dot_v).sqrt(), n_dot_v, 0.0)
}

#[test]
fn the_distribution_has_unit_projection_and_its_sampler_follows_it() {
    let model = &SheenVisibility::Charlie;
    for (k, alpha) in ALPHAS.into_iter().enumerate() {
        let one = integrate_sphere(1e-7, |h| model.d(h, alpha) * h.z.max(0.0));
        assert!((one - 1.0).abs() < 1e-6, "alpha {alpha}: {one}");
        let mut random = Rng::with_seed(k as u64);
        let drawn: Vec<DVec3> = (0..20_000)
            .map(|_| model.sample_d(xi(&mut random), alpha))
            .collect();
        let p = fit_of_half_vectors(1.0, |h| model.d(h, alpha) * h.z.max(0.0), &drawn);
        assert!(p > 0.01 / ALPHAS.len() as f64, "alpha {alpha}: p = {p}");
    }
}

/// The lobe as a microfacet model is the extension's, and reciprocal; albedos are its integral, and
/// with `ashikhmin` at v = n they have a closed form.
#[test]
fn the_lobe_and_its_albedo_follow_the_extension() {
    for (visibility, alpha) in SheenVisibility::all().flat_map(|v| ALPHAS.map(|alpha| (*v, alpha)))
    {
        let model = SheenVisibility::listed(Brdf::name(&visibility));
        let albedos = Albedos::new(Kernel::cosine(model), CORRELATED, alpha);
        for n_dot_v in VIEWS {
            let v = view(n_dot_v);
            let mut albedo = 0.0;
            over_directions(300, |l, weight| {
                albedo += weight * lobe(visibility, alpha, v, l)
            });
            let what = format!("{visibility:?} alpha {alpha} n_dot_v {n_dot_v}");
            let own = [
                dfg(model, CORRELATED, n_dot_v, alpha).albedo(),
                albedos.exact(n_dot_v).element_sum(),
            ];
            // The second is interpolated.
            let is_near = |own: f64, floor: f64| (own - albedo).abs() <= 1e-4 * albedo + floor;
            assert!(
                is_near(own[0], 0.0) && is_near(own[1], 2e-7),
                "{what}: {own:?} for {albedo}"
            );
            for l in [view(0.4), DVec3::new(-0.48, 0.6, 0.64)] {
                let [local_v, local_l] = [v, l].map(|w| DVec3::new(w.x, w.z, w.y));
                let f = eval_without_fresnel(model, local_v, local_l, alpha, CORRELATED);
                let back = eval_without_fresnel(model, local_l, local_v, alpha, CORRELATED);
                let expected = lobe(visibility, alpha, v, l) / l.y;
                assert!(
                    (f - expected).abs() <= 1e-9 * expected && (f - back).abs() <= 1e-12 * f,
                    "{what}: {f} {back}"
                );
            }
        }
        if visibility == SheenVisibility::Ashikhmin {
            let (own, p) = (dfg(model, CORRELATED, 1.0, alpha).albedo(), 1.0 / alpha);
            let closed = 0.5f64.powf(0.5 * p) / (p + 4.0);
            assert!(
                (own - closed).abs() <= 1e-6 * closed,
                "alpha {alpha}: {own} for {closed}"
            );
        }
    }
}

/// The direction of `moment` is the lobe's first moment within 4 degrees, and within 2 where it
/// reflects most.
#[test]
fn the_moment_is_the_mean_direction_of_the_lobe() {
    for (visibility, alpha, n_dot_v) in SheenVisibility::all().flat_map(|v| {
        ALPHAS
            .iter()
            .flat_map(move |a| VIEWS.map(|n_dot_v| (*v, *a, n_dot_v)))
    }) {
        let (v, mut moment, mut albedo) = (view(n_dot_v), DVec3::ZERO, 0.0);
        over_directions(200, |l, weight| {
            let f = weight * lobe(visibility, alpha, v, l);
            (moment, albedo) = (moment + f * l, albedo + f);
        });
        let tap = SheenLookup::listed("moment").tap([DVec3::Y, v], alpha);
        let degrees = tap.direction.angle_between(moment).to_degrees();
        let most = if albedo > 0.25 { 2.0 } else { 4.0 };
        assert!(
            degrees < most && tap.alpha == 1.0,
            "{visibility:?} {alpha} {n_dot_v}: {degrees}"
        );
        // The lobe is on the side of the viewer, and wide: the clamped cosine has 2/3.
        assert!(
            moment.x > 0.0 && (albedo < 0.1 || moment.length() / albedo < 0.72),
            "{alpha} {n_dot_v}: {moment}"
        );
    }
}

/// Fits of engines at values computed by hand from their sources. MaterialX' is near the albedo of
/// `ashikhmin`, three.js' a quarter below; PlayCanvas takes the smoothness for the roughness, and
/// gives the base a constant.
#[test]
fn fits_of_engines_have_their_values() {
    let of = |name: &str, alpha: f64, n_dot_v: f64| {
        shares(
            Some(SheenLookup::listed(name)),
            DVec3::new(1.0, 0.5, 0.0),
            alpha,
            n_dot_v,
            9.0,
        )
    };
    for (name, alpha, n_dot_v, base, sheen) in [
        ("three", 0.25, 0.5, 1.0 - 0.1353144, 0.1353144),
        ("materialx", 0.25, 0.5, 1.0 - 0.2164882, 0.2164882),
        // At roughness 1 it has the roughness 0: a = -25.9 and b = 3.26.
        ("playcanvas", 1.0, 0.5, 0.843, (3.26f64 - 12.95).exp()),
    ] {
        let own = of(name, alpha, n_dot_v);
        assert!(
            (own.base.x - base).abs() < 1e-6 && (own.sheen.x - sheen).abs() < 1e-6,
            "{name}: {own:?}"
        );
    }
    for (alpha, n_dot_v) in [0.16, 0.36, 1.0]
        .into_iter()
        .flat_map(|alpha| VIEWS[..3].iter().map(move |v| (alpha, *v)))
    {
        let exact = dfg(&SheenVisibility::Ashikhmin, CORRELATED, n_dot_v, alpha).albedo();
        let off = of("materialx", alpha, n_dot_v).sheen.x / exact - 1.0;
        assert!(off.abs() < 0.09, "{alpha} {n_dot_v}: {off}");
    }
}

/// The largest channel of a white base under sheen is white if its albedo is at most 1; no base is
/// negative beyond.
#[test]
fn a_white_furnace_stays_white() {
    let color = DVec3::new(0.9, 0.4, 0.0);
    for lookup in [Some(&SHEEN_LOOKUPS[0]), None] {
        for albedo in [0.0, 0.3, 1.0, 1.2] {
            let SheenShares { base, sheen } = shares(lookup, color, 0.25, 0.3, albedo);
            let total = base + sheen * if lookup.is_some() { 1.0 } else { albedo };
            let most = (0.9 * albedo).max(1.0);
            assert!(
                (total.x - most).abs() < 1e-12 && total.y <= most && base.x >= 0.0,
                "{albedo}: {total}"
            );
        }
    }
    assert_eq!(
        shares(None, DVec3::ZERO, 0.25, 0.3, 0.7),
        SheenShares {
            base: DVec3::ONE,
            sheen: DVec3::ZERO
        }
    );
}

/// Filament's table has 4096 samples a texel, in half floats.
#[test]
fn the_albedo_is_filaments_cloth_table() {
    // n·v, perceptual roughness, blue of `cmgen -s 64 --ibl-dfg=FILE --ibl-dfg-multiscatter
    // --ibl-dfg-cloth` (1.9.25).
    let cells = [
        [0.0546875, 0.8515625, 0.570801],
        [0.4921875, 0.8515625, 0.282959],
        [0.9453125, 0.8515625, 0.130737],
        [0.3203125, 0.5390625, 0.364746],
        [0.7890625, 0.5390625, 0.105896],
        [0.4765625, 0.3046875, 0.156738],
        [0.0390625, 0.1484375, 1.6709],
        [0.7890625, 1.0, 0.19751],
    ];
    for [n_dot_v, roughness, cloth] in cells {
        let own = dfg(
            &SheenVisibility::Ashikhmin,
            CORRELATED,
            n_dot_v,
            roughness * roughness,
        )
        .albedo();
        assert!(
            (own / cloth - 1.0).abs() < 1e-3,
            "{n_dot_v}, {roughness}: {own}, not {cloth}"
        );
    }
}
