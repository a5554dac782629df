//! The tables' f64 references against published numbers, identities and each other; the tables'
//! mappings.

use crate::mips_twin;
use crate::oracle::golden_environment;
use glam::{DVec2, DVec3};
use rayon::prelude::*;
use splitsum::bake::convention::TABLE_AXES;
use splitsum::bake::judge::table;
use splitsum::bake::make;
use splitsum::base::math::equirect::{direction_from_uv, texel_solid_angle};
use splitsum::base::math::quadrature::Tolerance;
use splitsum::base::math::sampling::direction_from_polar;
use splitsum::base::names::Listed;
use splitsum::base::pixels::RgbImage;
use splitsum::instrument::brdf::{self, Ggx, MODELS, MaskingShadowing};
use splitsum::instrument::precompute::dfg::reference::dfg;
use splitsum::instrument::precompute::dfg::{DfgAxes, chebyshev};
use splitsum::instrument::precompute::prefilter::reference::prefilter;
use splitsum::instrument::precompute::prefilter::{Kernel, LEVEL_MAPPINGS, Weight};
use splitsum::instrument::precompute::{
    PrecomputeSettings, PrefilterBy, exact_quadrature, mips, sh9,
};
use splitsum::instrument::shade::reference::{Surface, integrate};
use std::f64::consts::PI;
use std::sync::atomic::{AtomicUsize, Ordering};

const TOLERANCE: Tolerance = Tolerance {
    relative: 1e-6,
    max_part_count: 100_000,
};

#[test]
fn dfg_matches_published_tables() {
    // Columns n_dot_v; five digits by a 1536² point rule. Rows of roughness 0.05 and 0.10 of the
    // correlated table are left out: they miss the tail beyond 45°, of mass alpha².
    const PUBLISHED_TOLERANCE: f64 = 7e-5;
    // Masking, perceptual roughness, then the factors of f0 and of f90.
    const PUBLISHED: &str = "
        n_dot_v     0.05    0.10    0.25    0.50    0.75    1.00    0.05    0.10    0.25    0.50    0.75    1.00
        correlated 0.25 0.44925 0.50513 0.75804 0.95571 0.99234 0.99574 0.44485 0.39162 0.20354 \
        0.03264 0.00150 0.0
        correlated 0.50 0.76882 0.75193 0.75925 0.83492 0.88881 0.91578 0.16431 0.13969 0.08083 \
        0.02235 0.00272 0.00003
        correlated 1.00 0.81568 0.73634 0.58676 0.44771 0.36389 0.30682 0.03209 0.02387 0.01088 \
        0.00299 0.00063 0.00003
        schlick    0.05 0.21774 0.40118 0.75709 0.96632 0.99819 1.00000 0.73610 0.57664 0.23547 \
        0.03119 0.00098 0.0
        schlick    0.50 0.62074 0.59018 0.60941 0.72853 0.82754 0.89504 0.11505 0.09837 0.06088 \
        0.01855 0.00238 0.00002
        schlick    1.00 0.56810 0.54436 0.48348 0.40668 0.35011 0.30682 0.01638 0.01355 0.00748 \
        0.00246 0.00058 0.00003";
    let words = |line: &'static str| line.split_whitespace().collect::<Vec<_>>();
    let number = |word: &str| word.parse::<f64>().unwrap();
    let lines: Vec<Vec<&str>> = PUBLISHED.trim().lines().map(words).collect();
    let n_dot_v: Vec<f64> = lines[0][1..7].iter().copied().map(number).collect();
    lines[1..].par_iter().for_each(|line| {
        let masking = *MaskingShadowing::listed(line[0]);
        let alpha = brdf::alpha_from_perceptual_roughness(number(line[1]));
        for (k, n_dot_v) in n_dot_v.iter().enumerate() {
            let pair = dfg(&Ggx, masking, *n_dot_v, alpha);
            let off = [
                pair.f0_scale - number(line[2 + k]),
                pair.f90_scale - number(line[8 + k]),
            ];
            assert!(
                off.iter().all(|off| off.abs() < PUBLISHED_TOLERANCE),
                "{line:?} {n_dot_v}: {pair:?}"
            );
        }
    });
}

#[test]
fn dfg_has_its_exact_values_and_keeps_its_error() {
    // GGX, alpha = 1, v = n: albedo 1 - ln 2 for both forms of Smith masking.
    for masking in [MaskingShadowing::Separable, MaskingShadowing::Correlated] {
        let pair = dfg(&Ggx, masking, 1.0, 1.0);
        assert!((pair.albedo() - (1.0 - 2f64.ln())).abs() < 1e-8, "{pair:?}");
    }
    // A mirror: albedo G1 -> 1, all of it Schlick's weight at the mirror angle. GTR of
    // exponent 1.5 loses 2e-4 of it at alpha 0.001.
    for model in MODELS {
        let pair = dfg(*model, MaskingShadowing::Correlated, 0.5, 1e-4);
        assert!(
            (pair.albedo() - 1.0).abs() < 1e-4 && (pair.f90_scale - 1.0 / 32.0).abs() < 1e-4,
            "{} {pair:?}",
            model.name()
        );
    }
    // The stated error is met over the whole range, at the narrow grazing corner too.
    for model in MODELS {
        for (n_dot_v, alpha) in [
            (0.01, 0.01),
            (0.01, 1.0),
            (0.3, 0.01),
            (1.0, 0.01),
            (0.6, 0.4),
        ] {
            let pair = dfg(*model, MaskingShadowing::Separable, n_dot_v, alpha);
            assert!(
                pair.error < 1e-6 && pair.error > 0.0,
                "{} {n_dot_v} {alpha}: {pair:?}",
                model.name()
            );
        }
    }
}

#[test]
fn dfg_mapping_and_its_inverse_agree() {
    let size = 32;
    assert_eq!(
        DfgAxes::Centres.parameters(DVec2::new(8.0, 16.0), size),
        DVec2::new(0.25, 0.25)
    );
    // The outermost texels are at the ends of the shaded range.
    let near = |texel, ends: DVec2| {
        (DfgAxes::FourthRoots.parameters(texel, size) / ends - 1.0).length() < 1e-6
    };
    assert!(
        near(DVec2::splat(0.5), DVec2::new(1e-6, 1e-3)) && near(DVec2::splat(31.5), DVec2::ONE)
    );
    for axes in [DfgAxes::Centres, DfgAxes::FourthRoots] {
        for texel in [
            DVec2::new(0.5, 0.5),
            DVec2::new(31.5, 0.5),
            DVec2::new(7.25, 30.0),
        ] {
            let back = axes.texel(axes.parameters(texel, size), size);
            assert!((back - texel).length() < 1e-12, "{axes:?} {texel} {back}");
        }
    }
}

#[test]
fn prefiltering_keeps_a_constant_and_sharpens_to_the_map() {
    let constant = exact_quadrature(&RgbImage::filled(16, 8, [0.25, 1.0, 7e4]));
    let image = RgbImage::from_fn(64, 32, |x, y| {
        [
            1.0 + 0.1 * (y as f32),
            2.0 + (x as f32 * 0.098_174_77).sin(),
            1.0,
        ]
    });
    let varied = exact_quadrature(&image);
    // A texel centre away from the poles: the bilinear map there is the texel.
    let (x, y) = (20, 11);
    let r = direction_from_uv(DVec2::new(
        (f64::from(x) + 0.5) / 64.0,
        (f64::from(y) + 0.5) / 32.0,
    ));
    let texel = DVec3::from_array(image.get(x, y).map(f64::from));
    for model in MODELS {
        for alpha in [0.001, 0.05, 1.0] {
            let radiance = prefilter(&constant, Kernel::cosine(*model), alpha, r, TOLERANCE).value;
            assert!(
                (radiance / DVec3::new(0.25, 1.0, 7e4) - 1.0)
                    .abs()
                    .max_element()
                    < 1e-6,
                "{} {alpha}",
                model.name()
            );
        }
        let sharp = prefilter(&varied, Kernel::cosine(*model), 0.001, r, TOLERANCE).value;
        assert!(
            ((sharp - texel) / texel).abs().max_element() < 5e-4,
            "{}: {sharp} {texel}",
            model.name()
        );
    }
}

#[test]
fn prefilter_levels_and_alpha_agree() {
    // Maps by harmonics take no samples.
    let settings = PrecomputeSettings {
        prefilter: PrefilterBy::Harmonic,
        ..PrecomputeSettings::default()
    };
    assert_eq!(
        ["prefilter", "irradiance"].map(|table| settings.samples_of(table)),
        [None; 2]
    );
    for (mapping, roughness_of_middle) in
        LEVEL_MAPPINGS
            .iter()
            .zip([0.5, 1.0 - 0.5f64.sqrt(), (1.7 - 1.49f64.sqrt()) / 1.4])
    {
        let (alpha, mip) = (
            |mip| mapping.alpha_from_mip(mip, 5),
            |alpha| mapping.mip_from_alpha(alpha, 5),
        );
        assert_eq!(
            [alpha(0.0), alpha(4.0), mip(0.0), mip(1.0)],
            [0.0, 1.0, 0.0, 4.0],
            "{mapping:?}"
        );
        assert!(
            (alpha(2.0) - roughness_of_middle.powi(2)).abs() < 1e-15,
            "{mapping:?}: {}",
            alpha(2.0)
        );
        let levels: Vec<f64> = (0..=400).map(|k| f64::from(k) / 100.0).collect();
        assert!(
            levels.is_sorted_by(|a, b| alpha(*a) < alpha(*b)),
            "{mapping:?}"
        );
        for level in levels {
            assert!(
                (mip(alpha(level)) - level).abs() < 1e-14,
                "{mapping:?} {level}: {}",
                mip(alpha(level))
            );
        }
    }
}

/// The purpose of the weights: with `v = n` the lobe is `D G1(l)`, so the product with its albedo
/// is the integral itself.
#[test]
fn the_masking_weight_is_exact_if_the_view_is_the_normal() {
    const LOOSE: Tolerance = Tolerance {
        relative: 1e-5,
        max_part_count: 100_000,
    };
    let environment = exact_quadrature(&golden_environment());
    let n = direction_from_polar(0.8, 0.6, 0.4);
    let weight = Weight::listed("masking");
    let cases: Vec<_> = MODELS
        .iter()
        .flat_map(|m| MaskingShadowing::all().map(move |k| (*m, *k)))
        .collect();
    cases.into_par_iter().for_each(|(model, masking)| {
        for alpha in [0.1, 0.5, 1.0] {
            let surface = Surface::new(model, masking, alpha, DVec3::ONE, [n, n]);
            let truth = integrate(&environment, &surface, LOOSE).specular;
            let kernel = Kernel::new(model, weight, masking);
            let mean = prefilter(&environment, kernel, alpha, n, LOOSE);
            let split = mean.value * dfg(model, masking, 1.0, alpha).albedo();
            let off = ((split - truth.value) / truth.value).abs().max_element();
            assert!(
                off < 2e-5,
                "{} {masking:?} {alpha}: {split} against {truth:?}",
                model.name()
            );
            let cosine = prefilter(&environment, Kernel::cosine(model), alpha, n, LOOSE);
            let differs = ((cosine.value - mean.value) / mean.value)
                .abs()
                .max_element()
                > 1e-3;
            assert!(
                differs || alpha < 0.5,
                "{} {alpha}: {cosine:?} {mean:?}",
                model.name()
            );
        }
    });
}

#[test]
fn the_weights_means_of_a_cosine_have_closed_forms() {
    // At alpha 1 D is constant: means over the hemisphere of c = n·l by 1, c and GGX's G1 = 2c/(1 +
    // c). 512 rows interpolate a cosine within 5e-6; the step at the horizon is integrated within
    // 1e-4.
    let image = RgbImage::from_fn(4, 512, |_, y| {
        let up = (PI * (f64::from(y) + 0.5) / 512.0).cos();
        [up.max(0.0) as f32, up.abs() as f32, 1.0]
    });
    let environment = exact_quadrature(&image);
    let ln2 = 2f64.ln();
    for (name, expected) in [
        ("none", 0.5),
        ("cosine", 2.0 / 3.0),
        ("masking", (ln2 - 0.5) / (1.0 - ln2)),
    ] {
        let kernel = Kernel::new(&Ggx, Weight::listed(name), MaskingShadowing::Separable);
        let mean = prefilter(
            &environment,
            kernel,
            1.0,
            DVec3::Y,
            Tolerance {
                relative: 1e-4,
                ..TOLERANCE
            },
        );
        let off = mean.value - DVec3::new(expected, expected, 1.0);
        assert!(
            off.abs().max_element() < 1e-4,
            "{name}: {mean:?} against {expected}"
        );
    }
}

#[test]
fn sh9_matches_the_golden_coefficients() {
    let text = std::fs::read_to_string("tests/golden/sh9.json").unwrap();
    let json: serde_json::Value = serde_json::from_str(&text).unwrap();
    let image = golden_environment();
    let readings = [
        ("L_seed_sum", crate::sh9::project_texel_centers(&image)),
        ("L_texel_area", crate::sh9::project_texels(&image)),
        (
            "L_bilinear",
            sh9::reference::project_bilinear(&exact_quadrature(&image)),
        ),
    ];
    for (name, coefficients) in readings {
        for (k, coefficient) in coefficients.iter().enumerate() {
            for c in 0..3 {
                let number = |k: usize| json["envs"]["analytic"][name][k][c].as_f64().unwrap();
                let off = (coefficient[c] - number(k)).abs() / number(0);
                assert!(
                    off < 1e-6,
                    "{name} {k} {c}: {} against {}, {off:e} of L00",
                    coefficient[c],
                    number(k)
                );
            }
        }
    }
}

/// `∫ L dω` of a map of constant texels.
fn sphere_integral(level: &splitsum::base::pixels::Pixels<DVec3>) -> DVec3 {
    let texels = (0..level.height).flat_map(|y| (0..level.width).map(move |x| (x, y)));
    texels
        .map(|(x, y)| level.get(x, y) * texel_solid_angle(y, level.width, level.height))
        .sum()
}

#[test]
fn mips_keep_the_integral_at_every_size() {
    for size in [[16, 8], [15, 7], [33, 20], [5, 9], [1, 1]] {
        let image = RgbImage::from_fn(size[0], size[1], |x, y| {
            [
                (x * 7 + y * 13) as f32 % 5.0,
                if (x, y) == (3, 0) { 7e4 } else { 0.1 },
                1.0,
            ]
        });
        let levels = mips_twin::chain(&image);
        assert_eq!(levels.len() as u32, mips::level_count(size));
        let total = sphere_integral(&levels[0]);
        for (mip, level) in levels.iter().enumerate() {
            assert_eq!(
                [level.width, level.height],
                size.map(|side| (side >> mip).max(1))
            );
            let integral = sphere_integral(level);
            assert!(
                ((integral - total) / total).abs().max_element() < 1e-13,
                "{size:?} level {mip}: {integral} {total}"
            );
            assert!(
                level
                    .data
                    .iter()
                    .all(|radiance| (radiance.z - 1.0).abs() < 1e-14)
            );
        }
        assert_eq!(
            [
                levels[levels.len() - 1].width,
                levels[levels.len() - 1].height
            ],
            [1, 1]
        );
    }
}

#[test]
fn mips_weigh_rows_by_solid_angle() {
    // 2 x 4 to 1 x 2: the row at the pole has the solid angle 1 - cos 45°, the next cos 45°; equal
    // in u.
    let image = RgbImage::from_fn(2, 4, |_, y| [if y == 0 { 1.0 } else { 0.0 }; 3]);
    let level = &mips_twin::chain(&image)[1];
    assert!((level.get(0, 0).x - (1.0 - 0.5f64.sqrt())).abs() < 1e-15 && level.get(0, 1).x == 0.0);
    // 5 texels to 2: each gets half of the middle one.
    let shares: Vec<_> = mips_twin::overlaps(0, 2, 5).collect();
    assert_eq!(shares, [(0, 0.0, 1.0), (1, 1.0, 2.0), (2, 2.0, 2.5)]);
}

/// The polynomial changes no texel by more than a step of a half, at any view and roughness, for
/// every model and masking.
#[test]
fn a_table_by_a_polynomial_equals_its_integrals() {
    for (model, masking) in MODELS
        .iter()
        .flat_map(|m| MaskingShadowing::all().map(move |k| (m, *k)))
    {
        let table = make::dfg(*model, masking, &TABLE_AXES[0], 80);
        for i in 0..100 {
            let [x, y] = [i * 37 % 80, (i * i + 13 * i) % 80];
            let exact = table::exact(
                *model,
                masking,
                (DVec2::new(x.into(), y.into()) + 0.5) / 80.0,
                1e-2,
            );
            let [a, b, _] = table.get(x, y).map(f64::from);
            let off = (DVec2::new(a, b) - exact).abs().max_element();
            assert!(
                off < 1e-4,
                "{} {} at {x}, {y}: {off}",
                model.name(),
                masking.name()
            );
        }
    }
    let count = AtomicUsize::new(0);
    chebyshev::table(80, |at| {
        count.fetch_add(1, Ordering::Relaxed);
        table::exact(&Ggx, MaskingShadowing::Correlated, at, 1e-2)
    });
    assert!(count.into_inner() < 500);
}
