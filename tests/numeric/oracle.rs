//! The exact shading integrals against independent answers and identities.

use crate::sheen::{lobe, over_directions};
use glam::{DQuat, DVec2, DVec3};
use rayon::prelude::*;
use splitsum::base::csv::Cell;
use splitsum::base::math::equirect::{direction_from_uv, uv_from_direction};
use splitsum::base::math::equirect_quadrature::Focus;
use splitsum::base::math::frame::Frame;
use splitsum::base::math::quadrature::Tolerance;
use splitsum::base::math::sampling::direction_from_polar;
use splitsum::base::names::Listed;
use splitsum::base::pixels::{RgbImage, exr};
use splitsum::instrument::brdf::{self, Brdf, MODELS, MaskingShadowing, SheenVisibility};
use splitsum::instrument::environment::LoadOptions;
use splitsum::instrument::precompute::dfg::reference::dfg;
use splitsum::instrument::precompute::exact_quadrature;
use splitsum::instrument::precompute::irradiance::reference::irradiance;
use splitsum::instrument::shade::reference::{self, Surface, TOLERANCE};
use splitsum::oracle::{Answers, Kind, Queries};
use std::f64::consts::{PI, TAU};
use std::path::Path;

/// `tests/golden/env_analytic.exr`: a smooth sky with a Gaussian sun, 512 x 256.
pub fn golden_environment() -> RgbImage {
    exr::read(Path::new("tests/golden/env_analytic.exr"))
        .unwrap()
        .rgb
}

fn assert_close(what: &str, actual: DVec3, expected: DVec3, relative: f64) {
    let error = (actual - expected).abs().max_element();
    assert!(
        error <= relative * expected.max_element(),
        "{what}: {actual} against {expected}, off by {error:e}"
    );
}

/// Bilinear lookup of the contract: u wraps, v clamps.
pub fn lookup(image: &RgbImage, d: DVec3) -> DVec3 {
    let size = DVec2::new(f64::from(image.width), f64::from(image.height));
    let position = uv_from_direction(d) * size - 0.5;
    let (cell, fraction) = (position.floor(), position - position.floor());
    let texel = |x: f64, y: f64| {
        let (x, y) = (
            x.rem_euclid(size.x) as u32,
            y.clamp(0.0, size.y - 1.0) as u32,
        );
        DVec3::from_array(image.get(x, y).map(f64::from))
    };
    let row = |y: f64| texel(cell.x, y).lerp(texel(cell.x + 1.0, y), fraction.x);
    row(cell.y).lerp(row(cell.y + 1.0), fraction.y)
}

/// A surface with the view at `n_dot_v`, about a normal off every axis.
fn surface(
    model: &'static dyn Brdf,
    masking: MaskingShadowing,
    alpha: f64,
    n_dot_v: f64,
) -> Surface {
    let n = DVec3::new(0.48, 0.6, -0.64);
    let v = Frame::from_normal(n).to_world(direction_from_polar(
        (1.0 - n_dot_v * n_dot_v).sqrt(),
        n_dot_v,
        0.3,
    ));
    Surface::new(model, masking, alpha, DVec3::new(0.04, 0.5, 0.9), [n, v])
}

#[test]
fn constant_environment_gives_the_directional_albedo() {
    // Two integrations that share no variables: over half vectors, and over the texels of a map.
    let radiance = [0.5, 2.0, 7e4];
    let environment = exact_quadrature(&RgbImage::filled(20, 10, radiance));
    let radiance = DVec3::from_array(radiance.map(f64::from));
    let cases = MODELS.iter().flat_map(|model| {
        MaskingShadowing::all().flat_map(move |masking| {
            [0.01, 0.05, 0.3, 1.0, 0.002, 0.048, 0.02, 0.2]
                .into_iter()
                .zip([0.5, 0.05, 0.2, 0.9, 0.0175, 0.097, 0.03, 0.01])
                .map(|(alpha, n_dot_v)| (*model, *masking, alpha, n_dot_v))
        })
    });
    cases
        .collect::<Vec<_>>()
        .par_iter()
        .for_each(|&(model, masking, alpha, n_dot_v)| {
            let surface = surface(model, masking, alpha, n_dot_v);
            let answer = reference::integrate(&environment, &surface, TOLERANCE);
            let pair = dfg(model, masking, n_dot_v, alpha);
            let what = format!(
                "{} {masking:?} alpha {alpha} n_dot_v {n_dot_v}",
                model.name()
            );
            assert_close(
                &what,
                answer.specular_white.value / radiance,
                DVec3::splat(pair.albedo()),
                1.2e-5,
            );
            let split = surface.f0 * pair.f0_scale + pair.f90_scale;
            assert_close(&what, answer.specular.value / radiance, split, 2e-5);
            assert_close(&what, answer.diffuse.value / radiance, DVec3::ONE, 1.2e-5);
        });
}

/// The answers to a table in which ENV is the golden map.
fn answers(text: &str, tolerance: Tolerance) -> Answers {
    let dir = tempfile::tempdir().unwrap();
    let map = std::env::current_dir()
        .unwrap()
        .join("tests/golden/env_analytic.exr");
    std::fs::write(
        dir.path().join("q.csv"),
        text.replace("ENV", &map.display().to_string()),
    )
    .unwrap();
    let queries = Queries::read(
        &dir.path().join("q.csv"),
        Kind::Shading,
        &LoadOptions::default(),
    )
    .unwrap();
    queries.answer(tolerance, || ())
}

fn answered(text: &str) -> impl Fn(usize, &str) -> f64 {
    let answers = answers(text, TOLERANCE);
    move |row: usize, name: &str| {
        let at = answers
            .columns
            .iter()
            .position(|column| column == name)
            .unwrap();
        match answers.rows[row][at] {
            Cell::Number(number) => number,
            ref other => panic!("{other:?}"),
        }
    }
}

/// Rows with a coat against a product rule over directions with GGX, Smith and Schlick typed here.
#[test]
fn the_coat_of_a_table_is_its_integral() {
    const STEPS: u32 = 700;
    let (alpha, weight) = (0.4, 0.6);
    let image = golden_environment();
    let column = answered(
        "environment,brdf,alpha,f0,nx,ny,nz,vx,vy,vz,coat,coat_alpha,coat_layering\n\
         ENV,ggx,0.5,0.3,0,1,0,0.6,0.8,0,0.6,0.4,khr\nENV,ggx,0.5,0.3,0,1,0,0.6,0.8,0,0.6,0.4,albedo\n",
    );
    let unmet = |coat_alpha: f64| {
        let row = format!("ENV,ggx,1,0.3,0,1,0,0.6,0.8,0,1,{coat_alpha},khr");
        let head = "environment,brdf,alpha,f0,nx,ny,nz,vx,vy,vz,coat,coat_alpha,coat_layering";
        answers(
            &format!("{head}\n{row}\n"),
            Tolerance {
                relative: 1e-3,
                max_part_count: 200,
            },
        )
        .unmet
    };
    assert_eq!(
        [unmet(1.0), unmet(0.02)],
        [0, 1],
        "a narrow coat needs more parts than its base"
    );
    let (v, cosine) = (DVec3::new(0.6, 0.8, 0.0), 0.8f64);
    let smith = |x: f64| 2.0 * x / (x + (alpha * alpha + (1.0 - alpha * alpha) * x * x).sqrt());
    let mut sums = [[DVec3::ZERO; 2]; 2];
    over_directions(STEPS, |l, weight| {
        let h = (v + l).normalize();
        let d = alpha * alpha / (PI * (h.y * h.y * (alpha * alpha - 1.0) + 1.0).powi(2));
        let f = d * smith(cosine) * smith(l.y) / (4.0 * cosine) * weight;
        let schlick = 0.04 + 0.96 * (1.0 - v.dot(h)).powi(5);
        for (k, radiance) in [lookup(&image, l), DVec3::ONE].into_iter().enumerate() {
            sums[0][k] += f * radiance;
            sums[1][k] += f * schlick * radiance;
        }
    });
    let fresnel = 0.04 + 0.96 * (1.0f64 - cosine).powi(5);
    let expected = [(fresnel * sums[0][0], fresnel), (sums[1][0], sums[1][1].x)];
    for (row, (coat, lost)) in expected.into_iter().enumerate() {
        let own = DVec3::new(
            column(row, "coat_r"),
            column(row, "coat_g"),
            column(row, "coat_b"),
        );
        assert_close("coat", own, weight * coat, 1e-4);
        assert!(
            (column(row, "base_share") - (1.0 - weight * lost)).abs() < 1e-5,
            "{row}"
        );
    }
}

#[test]
fn an_index_of_a_table_is_its_f0() {
    let by = |column: &str, value: &str| {
        let table = format!(
            "environment,brdf,alpha,{column},nx,ny,nz,vx,vy,vz\n\
             builtin:sky,ggx,0.5,{value},0,1,0,0.6,0.8,0\n"
        );
        let column = answered(&table);
        ["specular_r", "specular_g", "specular_b"].map(|name| column(0, name))
    };
    // By ((1 - n)/(1 + n))², by hand.
    let [by_index, by_f0] = [by("ior", "1.5:3:1"), by("f0", "0.04:0.25:0")];
    for (by_index, by_f0) in by_index.into_iter().zip(by_f0) {
        assert!((by_index / by_f0 - 1.0).abs() < 1e-12, "{by_index} {by_f0}");
    }
}

/// A row with anisotropy against a product rule with both widths of GGX typed here; the tangent at
/// the pole is +x, turned towards -z.
#[test]
fn the_anisotropy_of_a_table_is_its_integral() {
    const STEPS: u32 = 700;
    let column = answered(
        "environment,brdf,alpha,f0,nx,ny,nz,vx,vy,vz,anisotropy,anisotropy_rotation_deg\n\
         ENV,ggx,0.2,1,0,1,0,0.6,0.8,0,0.7,30\n",
    );
    let (x, y) = (0.2 + 0.8 * 0.49, 0.2);
    let (tangent, bitangent) = (
        DVec3::new(0.75f64.sqrt(), 0.0, -0.5),
        DVec3::new(-0.5, 0.0, -(0.75f64.sqrt())),
    );
    let squares = |w: DVec3| [w.dot(tangent), w.dot(bitangent)].map(|part| part * part);
    let g1 = |w: DVec3| {
        let [t, b] = squares(w);
        2.0 / (1.0 + (1.0 + (x * x * t + y * y * b) / (w.y * w.y)).sqrt())
    };
    let (v, image, mut sum) = (DVec3::new(0.6, 0.8, 0.0), golden_environment(), DVec3::ZERO);
    over_directions(STEPS, |l, weight| {
        let h = (v + l).normalize();
        let [t, b] = squares(h);
        let d = 1.0 / (PI * x * y * (t / (x * x) + b / (y * y) + h.y * h.y).powi(2));
        sum += d * g1(v) * g1(l) / (4.0 * v.y) * weight * lookup(&image, l);
    });
    let own = DVec3::new(
        column(0, "specular_r"),
        column(0, "specular_g"),
        column(0, "specular_b"),
    );
    assert_close("anisotropic", own, sum, 1e-4);
}

/// Rows with sheen, the first under a coat, against a rule over directions that shares no code.
#[test]
fn the_sheen_of_a_table_is_its_integral() {
    let column = answered(
        "environment,brdf,alpha,f0,nx,ny,nz,vx,vy,vz,sheen_color,sheen_alpha,sheen_visibility,coat,coat_alpha\n\
         ENV,ggx,0.5,0.3,0,1,0,0.6,0.8,0,0.2:0.6:0.4,0.3,charlie,0.5,0.1\n\
         ENV,phong,0.5,0.3,0,1,0,0.6,0.8,0,1,0.1,ashikhmin,0,0.1\n",
    );
    let image = golden_environment();
    let v = DVec3::new(0.6, 0.8, 0.0);
    let colors = [DVec3::new(0.2, 0.6, 0.4), DVec3::ONE];
    for (row, (visibility, alpha)) in [
        (SheenVisibility::Charlie, 0.3),
        (SheenVisibility::Ashikhmin, 0.1),
    ]
    .into_iter()
    .enumerate()
    {
        let (mut sum, mut albedo) = (DVec3::ZERO, 0.0);
        over_directions(1000, |l, weight| {
            let f = weight * lobe(visibility, alpha, v, l);
            (sum, albedo) = (sum + f * lookup(&image, l), albedo + f);
        });
        let own = DVec3::new(
            column(row, "sheen_r"),
            column(row, "sheen_g"),
            column(row, "sheen_b"),
        );
        assert_close("sheen", own, colors[row] * sum, 1e-4);
        let kept = 1.0 - colors[row].max_element() * albedo;
        assert!(
            (column(row, "sheen_base_share") - kept).abs() < 1e-5,
            "{row}"
        );
    }
}

#[test]
fn a_sun_in_one_texel_is_exact() {
    // Specular light of one hat of radiance 7e4 on a dim sky: sky times albedo plus the hat by the
    // midpoint rule.
    const SUN: f32 = 72_704.0;
    const SKY: f32 = 0.1;
    let (width, height, x, y) = (512, 256, 300, 90);
    let image = RgbImage::from_fn(width, height, |i, j| {
        [if (i, j) == (x, y) { SUN } else { SKY }; 3]
    });
    let environment = exact_quadrature(&image);
    let size = DVec2::new(f64::from(width), f64::from(height));
    let center = DVec2::new(f64::from(x), f64::from(y)) + 0.5;
    let l = direction_from_uv(center / size);
    for (model, alpha, n_dot_v, offset) in [
        ("ggx", 0.01, 0.7f64, 0.0),
        ("ggx", 0.1, 0.3, 0.2),
        ("beckmann", 0.02, 0.5, 0.01),
        ("phong", 0.4, 0.8, 0.5),
        ("ggx", 0.03, 0.08, 0.02),
    ] {
        let model = <dyn Brdf>::listed(model);
        // The view mirrors the sun, turned away by `offset`.
        let n = Frame::from_normal(l).to_world(direction_from_polar(
            (1.0 - n_dot_v * n_dot_v).sqrt(),
            n_dot_v,
            0.1,
        ));
        let v = DQuat::from_axis_angle(n, offset) * (2.0 * n.dot(l) * n - l);
        let surface = Surface::new(
            model,
            MaskingShadowing::Separable,
            alpha,
            DVec3::ONE,
            [n, v],
        );
        let frame = Frame::from_normal(n);
        let count = 300;
        let points =
            (0..count * count).map(|i| DVec2::new(f64::from(i % count), f64::from(i / count)));
        let hat: f64 = points
            .map(|p| {
                let offset = (p + 0.5) * 2.0 / f64::from(count) - 1.0;
                let uv = (center + offset) / size;
                let l = frame.to_local(direction_from_uv(uv));
                let f = brdf::eval_without_fresnel(
                    model,
                    frame.to_local(v),
                    l,
                    alpha,
                    MaskingShadowing::Separable,
                );
                let omega = 2.0 * PI * PI * (PI * uv.y).sin() / (size.x * size.y) * 4.0
                    / f64::from(count * count);
                (1.0 - offset.x.abs()) * (1.0 - offset.y.abs()) * f * l.z * omega
            })
            .sum();
        let sky = dfg(model, MaskingShadowing::Separable, n.dot(v), alpha).albedo();
        let expected = f64::from(SKY) * sky + f64::from(SUN - SKY) * hat;
        let answer = reference::integrate(&environment, &surface, TOLERANCE).specular_white;
        assert_close(
            &format!("{} {alpha} {n_dot_v}", model.name()),
            answer.value,
            DVec3::splat(expected),
            5e-5,
        );
        assert!(answer.error.x <= 1e-5 * answer.value.x);
    }
}

#[test]
fn turning_light_and_surface_together_changes_nothing() {
    let image = golden_environment();
    // 100 texels to larger u: about +y by -2π 100/512, since φ = 2π (0.5 - u).
    let shifted = RgbImage::from_fn(512, 256, |x, y| image.get((x + 412) % 512, y));
    let turn = DQuat::from_rotation_y(-TAU * 100.0 / 512.0);
    let (still, turned) = (exact_quadrature(&image), exact_quadrature(&shifted));
    for model in MODELS {
        let surface = surface(*model, MaskingShadowing::Correlated, 0.2, 0.4);
        let there = Surface {
            n: turn * surface.n,
            v: turn * surface.v,
            ..surface
        };
        let a = reference::integrate(&still, &surface, TOLERANCE);
        let b = reference::integrate(&turned, &there, TOLERANCE);
        assert_close(model.name(), a.specular.value, b.specular.value, 2e-5);
        assert_close(
            model.name(),
            a.diffuse_transmitted.value,
            b.diffuse_transmitted.value,
            2e-5,
        );
    }
}

#[test]
fn a_tighter_tolerance_stays_within_the_bound() {
    let environment = exact_quadrature(&golden_environment());
    let fine = Tolerance {
        relative: 3e-7,
        ..TOLERANCE
    };
    for (model, alpha, n_dot_v) in [
        ("ggx", 0.02, 0.05),
        ("beckmann", 0.15, 0.6),
        ("phong", 0.9, 0.1),
        ("ggx", 1.0, 0.5),
    ] {
        let surface = surface(
            <dyn Brdf>::listed(model),
            MaskingShadowing::Separable,
            alpha,
            n_dot_v,
        );
        let (coarse, exact) = (
            reference::integrate(&environment, &surface, TOLERANCE),
            reference::integrate(&environment, &surface, fine),
        );
        for (a, b) in [
            (coarse.specular, exact.specular),
            (coarse.diffuse_transmitted, exact.diffuse_transmitted),
        ] {
            let off = (a.value - b.value).abs();
            assert!(
                off.cmple(a.error + b.error).all(),
                "{model} {alpha}: off by {off}, bound {}",
                a.error
            );
            assert!(b.error.cmplt(a.error).all() && off.max_element() > 0.0);
        }
    }
}

/// The narrowest accepted lobe shows the mirror image, also at a pole, where columns of texels are
/// needles. A focus narrower than rounding ends.
#[test]
fn narrow_lobes_are_mirrors_in_bounded_work() {
    let image = RgbImage::from_fn(64, 32, |_, y| [1.0, 2.0 + f32::from(y as u8), 3.0]);
    let environment = exact_quadrature(&image);
    let model = <dyn Brdf>::listed("beckmann");
    let at = |alpha: f64, n: DVec3| {
        let f0 = DVec3::ONE;
        let surface = Surface::new(model, MaskingShadowing::Separable, alpha, f0, [n, n]);
        reference::integrate(&environment, &surface, TOLERANCE).specular_white
    };
    // Rows are constant, and the lobe is a thousandth of one.
    for n in [DVec3::Y, DVec3::new(0.0, 0.6, 0.8)] {
        let mirror =
            splitsum::instrument::environment::Environment::from_image("rows", image.clone())
                .radiance(n);
        let found = at(splitsum::oracle::ALPHA_MIN, n);
        assert_close("mirror", found.value, mirror, 2e-3);
        assert!(found.error.cmple(2e-4 * mirror).all(), "{n}: {found:?}");
    }
    // The domain is covered once for any focus.
    let focus = Some(Focus {
        direction: DVec3::Z,
        radius: 0.0,
        in_widths: None,
    });
    let tolerance = Tolerance {
        max_part_count: 2000,
        ..TOLERANCE
    };
    let whole = environment
        .integrate(|_| [1.0], focus, tolerance)
        .combine([DVec3::ONE]);
    assert_close(
        "whole",
        DVec3::splat(whole.value.x),
        DVec3::splat(4.0 * PI),
        1e-9,
    );
}

/// A map of one row once took gigabytes: its tree had leaves far thinner than the row.
#[test]
fn maps_of_any_shape_have_small_trees() {
    for [width, height] in [[40_000, 1], [1, 3000], [5000, 3]] {
        let environment = exact_quadrature(&RgbImage::filled(width, height, [0.5; 3]));
        let found = irradiance(
            &environment,
            DVec3::Z,
            Tolerance {
                relative: 1e-4,
                ..TOLERANCE
            },
        );
        let off = (found.value - DVec3::splat(0.5 * PI)).abs();
        assert!(
            off.cmple(found.error + 1e-9).all(),
            "{width}x{height}: {found:?}"
        );
    }
}
