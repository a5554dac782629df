//! What the slips of the source documents cost: every figure that docs/estimators.md gives beside a slip.

use glam::{DVec2, DVec3};
use splitsum::brdf::{self, Beckmann, Brdf, Ggx, MaskingShadowing, Phong};
use splitsum::math::equirect::{direction_from_uv, uv_from_direction};
use splitsum::math::sampling::hammersley;
use splitsum::math::spherical_harmonics;
use splitsum::pixels::RgbImage;
use splitsum::precompute::dfg::reference::dfg;
use splitsum::precompute::exact_quadrature;
use splitsum::shade::reference::{Surface, TOLERANCE, seed0_literal};
use std::f64::consts::PI;

const SEPARABLE: MaskingShadowing = MaskingShadowing::Separable;
const N_DOT_V: [f64; 5] = [0.1, 0.25, 0.5, 0.75, 1.0];
/// Half a unit of the last printed digit of a figure of three decimals, and as much again for points and rounding.
const THREE_DECIMALS: f64 = 1e-3;

fn view(n_dot_v: f64) -> DVec3 {
    DVec3::new(((1.0 - n_dot_v) * (1.0 + n_dot_v)).sqrt(), 0.0, n_dot_v)
}

/// Mean of a function over half vectors of density `D n_dot_h`.
fn mean(model: &dyn Brdf, alpha: f64, f: impl Fn(DVec3) -> f64) -> f64 {
    const COUNT: u32 = 1 << 16;
    (0..COUNT).map(|i| f(model.sample_d(hammersley(i, COUNT), alpha))).sum::<f64>() / f64::from(COUNT)
}

fn assert_figure(what: &str, found: f64, printed: f64, tolerance: f64) {
    assert!((found - printed).abs() <= tolerance, "{what}: {found} against {printed}");
}

#[test]
fn misprinted_masking() {
    // 1 + alpha² + tan² in place of 1 + alpha² tan², at alpha = n_dot_v = 0.1.
    let (alpha, tan2) = (0.1f64, 1.0 / 0.01 - 1.0);
    assert_figure("printed", 2.0 / (1.0 + (1.0 + alpha * alpha + tan2).sqrt()), 0.18, 5e-3);
    assert_figure("right", Ggx.g1(0.1, 0.1), 0.83, 5e-3);
}

#[test]
fn fresnel_twice() {
    // F times f_cook-torrance, which holds F already.
    let f = brdf::f_schlick(DVec3::splat(0.04), 1.0).x;
    assert_figure("times too dark", f / (f * f), 25.0, 1e-9);
}

#[test]
fn missing_jacobian() {
    // Half vectors from D, weight G F / (4 n_dot_v): no v·m, no n·m. White furnace, F = 1.
    for (alpha, printed) in [(0.1, [1.236, 0.793, 0.469, 0.325, 0.247]), (0.5, [0.321, 0.277, 0.227, 0.195, 0.172])] {
        for (n_dot_v, printed) in N_DOT_V.into_iter().zip(printed) {
            let v = view(n_dot_v);
            let found = mean(&Ggx, alpha, |m| {
                brdf::g2(&Ggx, n_dot_v, brdf::reflect(v, m).z, alpha, SEPARABLE) / (4.0 * n_dot_v)
            });
            assert_figure(&format!("alpha {alpha} n_dot_v {n_dot_v}"), found, printed, THREE_DECIMALS);
        }
    }
}

#[test]
fn lobe_about_the_mirror_direction() {
    // The same sum with directions drawn about r: what `seed0-literal` converges to. White furnace, F = 1.
    let environment = exact_quadrature(&RgbImage::filled(16, 8, [1.0; 3]));
    for (alpha, printed) in [(0.1, [1.403, 0.879, 0.487, 0.331, 0.250]), (0.5, [0.305, 0.312, 0.298, 0.270, 0.239])] {
        for (n_dot_v, printed) in N_DOT_V.into_iter().zip(printed) {
            let n = DVec3::Z;
            let surface = Surface { model: &Ggx, masking: SEPARABLE, alpha, f0: DVec3::ONE, n, v: view(n_dot_v) };
            let found = seed0_literal(&environment, &surface, TOLERANCE).value.x;
            assert_figure(&format!("alpha {alpha} n_dot_v {n_dot_v}"), found, printed, THREE_DECIMALS);
        }
    }
}

#[test]
fn phong_exponent() {
    // cos = (1 - u)^(1/(e + 1)) in place of 1/(e + 2): mean sin² of the angle to the normal, 2/(e + 3) in place of 2/(e + 4).
    let mean_sin2 = |alpha: f64| mean(&Phong, alpha, |m| 1.0 - m.z * m.z);
    for alpha in [0.5, 1.0] {
        let exponent = brdf::exponent_from_alpha(alpha);
        assert_figure("right", mean_sin2(alpha), 2.0 / (exponent + 4.0), 1e-4);
        // An exponent less by one has the printed sampler.
        assert_figure("printed", mean_sin2(brdf::alpha_from_exponent(exponent - 1.0)), 2.0 / (exponent + 3.0), 1e-4);
    }
    assert_figure("alpha 1, too wide by", (2.0 / 3.0) / (2.0 / 4.0), 1.333, THREE_DECIMALS);
}

#[test]
fn mip_level_without_the_solid_angle() {
    // Printed minus right level: ½ log2(p_l 2π² sin θ / D(m)), since both share W H / N.
    let offset = |n_dot_v: f64, sin_theta: f64| {
        let (v, m) = (view(n_dot_v), DVec3::Z);
        let p_l = brdf::pdf_d_l(&Ggx, v, m, 0.1);
        0.5 * (p_l * 2.0 * PI * PI * sin_theta / Ggx.d(m, 0.1)).log2()
    };
    assert_figure("v = n, equator", offset(1.0, 1.0), 1.15, 5e-3);
    assert_figure("n_dot_v 0.1, equator", offset(0.1, 1.0), 2.81, 5e-3);
    assert_figure("v = n, sin 0.1", offset(1.0, 0.1), -0.51, 5e-3);
}

#[test]
fn printed_direction_of_a_texel() {
    // (cos φ sin θ, sin φ sin θ, cos θ) is no inverse of the printed uv: it turns x to y, y to z and z to x.
    let printed = |uv: DVec2| {
        let d = direction_from_uv(uv);
        DVec3::new(d.z, d.x, d.y)
    };
    for (from, to) in [(DVec3::X, DVec3::Y), (DVec3::Y, DVec3::Z), (DVec3::Z, DVec3::X)] {
        assert!(printed(uv_from_direction(from)).abs_diff_eq(to, 1e-12), "{from}");
        assert!(direction_from_uv(uv_from_direction(from)).abs_diff_eq(from, 1e-12), "{from}");
    }
    let (phi, theta) = (2.0 * PI * (0.5 - 0.3), PI * 0.6);
    let literal = DVec3::new(phi.cos() * theta.sin(), phi.sin() * theta.sin(), theta.cos());
    assert!(printed(DVec2::new(0.3, 0.6)).abs_diff_eq(literal, 1e-12));
}

#[test]
fn fresnel_in_place_of_f0() {
    // prefiltered (F A + B) with F = Schlick(n_dot_v): f0 = 0.04, alpha = 0.25, n_dot_v = 0.1, correlated masking.
    let pair = dfg(&Ggx, MaskingShadowing::Correlated, 0.1, 0.25);
    let f = brdf::f_schlick(DVec3::splat(0.04), 0.1).x;
    assert_figure("printed", f * pair.f0_scale + pair.f90_scale, 0.60, 5e-3);
    assert_figure("right", 0.04 * pair.f0_scale + pair.f90_scale, 0.17, 5e-3);
}

#[test]
fn fitted_masking() {
    // Karis' k = alpha/2 against the exact Smith G1: the directional albedo at alpha = n_dot_v = 0.1.
    let albedo = |masking| dfg(&Ggx, masking, 0.1, 0.1).albedo();
    assert_figure("k = alpha/2", albedo(MaskingShadowing::Schlick), 0.658, THREE_DECIMALS);
    assert_figure("exact", albedo(SEPARABLE), 0.873, THREE_DECIMALS);
}

#[test]
fn density_of_the_half_vector_for_that_of_the_light() {
    // The table as mean of V = G / (4 n.l n.v) alone, at alpha = 0.01, F = 1.
    for (n_dot_v, printed, right, tolerance) in [(0.1, 26.9, 0.99, 0.1), (0.5, 1.0, 1.0, 0.05), (1.0, 0.25, 1.0, 5e-3)]
    {
        let v = view(n_dot_v);
        let found = mean(&Ggx, 0.01, |m| {
            let n_dot_l = brdf::reflect(v, m).z;
            // Light along the horizon has V = 0/0.
            if n_dot_l > 1e-9 {
                brdf::g2(&Ggx, n_dot_v, n_dot_l, 0.01, SEPARABLE) / (4.0 * n_dot_l * n_dot_v)
            } else {
                0.0
            }
        });
        assert_figure(&format!("printed at {n_dot_v}"), found, printed, tolerance);
        assert_figure(&format!("right at {n_dot_v}"), dfg(&Ggx, SEPARABLE, n_dot_v, 0.01).albedo(), right, 5e-3);
    }
}

#[test]
fn rational_masking_of_phong_adds_energy() {
    let albedo = |model: &dyn Brdf, masking, n_dot_v| dfg(model, masking, n_dot_v, 1.0).albedo();
    assert_figure("phong", albedo(&Phong, SEPARABLE, 0.1), 1.141, THREE_DECIMALS);
    assert_figure("beckmann", albedo(&Beckmann, SEPARABLE, 0.1), 0.905, THREE_DECIMALS);
    assert_figure("ggx", albedo(&Ggx, SEPARABLE, 0.1), 0.558, THREE_DECIMALS);
    assert_figure("phong at 0.01", albedo(&Phong, SEPARABLE, 0.01), 1.319, THREE_DECIMALS);
    assert_figure("phong correlated", albedo(&Phong, MaskingShadowing::Correlated, 0.1), 1.306, THREE_DECIMALS);
    assert_figure(
        "phong correlated at 0.01",
        albedo(&Phong, MaskingShadowing::Correlated, 0.01),
        1.682,
        THREE_DECIMALS,
    );
    assert_figure("phong exact", albedo(&Phong, MaskingShadowing::SmithExact, 0.1), 0.558, THREE_DECIMALS);
}

#[test]
fn nine_coefficients_of_a_point_light() {
    let light = spherical_harmonics::basis(DVec3::Z).map(DVec3::splat);
    let irradiance = |cosine: f64| spherical_harmonics::irradiance(&light, view(cosine)).x;
    assert_figure("peak", irradiance(1.0), 1.0625, 1e-9);
    assert_figure("at 90 degrees", irradiance(0.0), 0.094, THREE_DECIMALS);
    let least = (0..1000).map(|i| irradiance(-f64::from(i) / 1000.0)).fold(f64::INFINITY, f64::min);
    assert_figure("least", least, -0.040, THREE_DECIMALS);
}
