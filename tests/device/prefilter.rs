//! The prefiltered map, by harmonics and by samples, and the irradiance map by harmonics: against their exact integrals and outside numbers.

use crate::compare::{Tolerance, Worst, relative};
use crate::harness::{golden_environment, poison_image, read_level, with_gpu};
use crate::layouts::{filtered_environment, read_map};
use crate::tables::{EXACT, environment_image, equirect, texel_direction};
use glam::{DVec2, DVec3};
use rayon::prelude::*;
use splitsum::brdf::{MODELS, MaskingShadowing};
use splitsum::environment::layout::LAYOUTS;
use splitsum::gpu::{Gpu, Image};
use splitsum::math::quadrature;
use splitsum::math::sequence::{PixelPoints, SEQUENCES};
use splitsum::pixels::Pixels;
use splitsum::precompute::irradiance::{self, reference::irradiance as exact_irradiance};
use splitsum::precompute::prefilter::{
    self, Kernel, LEVEL_MAPPINGS, WEIGHTS, harmonic, pass::Recipe, reference::prefilter,
};
use splitsum::precompute::{exact_quadrature, points::Points};
use splitsum::spelling::Listed;
use std::f64::consts::PI;

/// The levels of a prefiltered map.
fn prefiltered(
    gpu: &Gpu,
    image: &Image,
    kernel: Kernel,
    size: [u32; 2],
    levels: u32,
    sample_count: u32,
) -> Vec<Pixels<DVec3>> {
    let map = prefilter::pass::map(gpu, equirect(), size, levels).unwrap();
    poison_image(gpu, &map);
    let points = Points::upload(gpu, sample_count, &SEQUENCES[0], 0, PixelPoints::Shared).unwrap();
    let recipe = Recipe { kernel, mapping: &LEVEL_MAPPINGS[0], lod_bias: 0.0 };
    prefilter::pass::run(gpu, recipe, equirect(), image, &points, &map).unwrap();
    (0..levels).map(|level| read_level(gpu, &map, level)).collect()
}

/// Level 1 is alpha 0.25 at 64 x 32 texels, level 2 alpha 1 at 32 x 16.
const PREFILTER_SIZE: [u32; 2] = [128, 64];
const PREFILTER_LEVELS: u32 = 3;

/// Relative; f32 texels, and what the highest degree cuts off of a narrow lobe beside a lamp.
const HARMONIC: f64 = 1e-6;

#[test]
fn harmonic_levels_are_the_exact_integral_in_every_layout() {
    with_gpu(|gpu| {
        let environment = golden_environment();
        let image = environment_image(gpu, &environment.image);
        let exact = exact_quadrature(&environment.image);
        let points = Points::upload(gpu, 1, &SEQUENCES[0], 0, PixelPoints::Shared).unwrap();
        for ((layout, model), mapping) in LAYOUTS.iter().zip(MODELS).zip(LEVEL_MAPPINGS) {
            let size = if layout.is_square { [32, 32] } else { [64, 32] };
            let recipe = Recipe { kernel: Kernel::cosine(*model), mapping, lod_bias: 0.0 };
            let transform =
                harmonic::harmonics(&environment.image, harmonic::degree_of_map(mapping.alpha_from_mip(1.0, 3)));
            let filtered = filtered_environment(gpu, layout, &image);
            let map = prefilter::pass::map(gpu, layout, size, 3).unwrap();
            prefilter::pass::run_harmonic(gpu, recipe, layout, &filtered, (&points, &transform), &map).unwrap();
            let map = read_map(gpu, layout, &map);
            for (level, faces) in map.levels.iter().enumerate().skip(1) {
                let alpha = mapping.alpha_from_mip(level as f64, 3);
                let mut worst =
                    Worst::new(format!("{} {} level {level}", layout.name, model.name()), relative(HARMONIC));
                for (face, texels) in (0..).zip(faces) {
                    for i in (0..texels.data.len() as u32).step_by(53) {
                        let at = [i % texels.width, i / texels.width];
                        let uv = DVec2::new(f64::from(at[0]) + 0.5, f64::from(at[1]) + 0.5)
                            / DVec2::new(texels.width.into(), texels.height.into());
                        let r = (layout.direction)(face, uv);
                        let expected = prefilter(&exact, recipe.kernel, alpha, r, EXACT).value;
                        worst.add_rgb(texels.data[i as usize], expected, || format!("face {face} texel {at:?}"));
                    }
                }
                worst.check();
            }
        }
    });
}

#[test]
fn harmonic_irradiance_is_the_exact_integral_in_every_layout() {
    with_gpu(|gpu| {
        let environment = golden_environment();
        let exact = exact_quadrature(&environment.image);
        let transform = harmonic::harmonics(&environment.image, harmonic::degree(1.0));
        for layout in LAYOUTS {
            let size = layout.irradiance_size;
            let map = irradiance::pass::map(gpu, layout, size).unwrap();
            irradiance::pass::run_harmonic(gpu, layout, &transform, &map).unwrap();
            let mut worst = Worst::new(format!("{} irradiance", layout.name), relative(HARMONIC));
            for (face, texels) in (0..).zip(&read_map(gpu, layout, &map).levels[0]) {
                for i in (0..texels.data.len() as u32).step_by(31) {
                    let at = DVec2::new(f64::from(i % texels.width) + 0.5, f64::from(i / texels.width) + 0.5);
                    let n = (layout.direction)(face, at / DVec2::new(size[0].into(), size[1].into()));
                    let expected = exact_irradiance(&exact, n, EXACT).value / PI;
                    worst.add_rgb(texels.data[i as usize], expected, || format!("face {face} texel {i}"));
                }
            }
            worst.check();
        }
    });
}

#[test]
fn prefiltered_levels_converge_to_the_exact_integral() {
    // Each lookup spreads light over the trilinear footprint of its level, more than the sample's share of the lobe. Beside a sun of
    // 100 times the sky that costs up to 13 % at 256 samples, and a tenth of that at 4096.
    const SAMPLES: [(u32, Tolerance); 2] = [(256, relative(0.16)), (4096, relative(2e-2))];
    // A weight of 1 ends at the horizon with a step, which costs digits.
    const STEP: quadrature::Tolerance = quadrature::Tolerance { relative: 1e-3, max_part_count: 100_000 };
    with_gpu(|gpu| {
        let environment = golden_environment();
        let image = environment_image(gpu, &environment.image);
        let exact = exact_quadrature(&environment.image);
        let weights = WEIGHTS.iter().flat_map(|weight| {
            let maskings = MaskingShadowing::all().take(if weight.uses_masking { usize::MAX } else { 1 });
            maskings.map(move |masking| (weight, *masking))
        });
        for (model, (weight, masking)) in MODELS.iter().flat_map(|m| weights.clone().map(move |w| (m, w))) {
            let kernel = Kernel::new(*model, weight, masking);
            let is_default = *weight == WEIGHTS[0];
            let texels: Vec<(u32, u32, u32)> = (1..PREFILTER_LEVELS)
                .flat_map(|k| {
                    let [width, height] = PREFILTER_SIZE.map(|side| side >> k);
                    let rows = [0, height / 5, height / 2, height - 1];
                    rows.into_iter().flat_map(move |y| (0..width).step_by(width as usize / 4).map(move |x| (k, x, y)))
                })
                .collect();
            let expected: Vec<DVec3> = texels
                .par_iter()
                .map(|&(k, x, y)| {
                    let r = texel_direction(x, y, PREFILTER_SIZE.map(|side| side >> k));
                    let alpha = LEVEL_MAPPINGS[0].alpha_from_mip(f64::from(k), PREFILTER_LEVELS);
                    prefilter(&exact, kernel, alpha, r, if is_default { EXACT } else { STEP }).value
                })
                .collect();
            for (sample_count, tolerance) in SAMPLES.into_iter().skip(usize::from(!is_default)) {
                let levels = prefiltered(gpu, &image, kernel, PREFILTER_SIZE, PREFILTER_LEVELS, sample_count);
                let name =
                    format!("prefilter of {} by {sample_count}, weight {} {masking:?}", model.name(), weight.name);
                let mut worst = Worst::new(name, tolerance);
                for ((k, x, y), expected) in texels.iter().zip(&expected) {
                    worst.add_rgb(levels[*k as usize].get(*x, *y), *expected, || format!("level {k} texel {x} {y}"));
                }
                worst.check();
            }
        }
    });
}
