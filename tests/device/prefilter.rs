//! The prefiltered map, by harmonics and by samples, and the irradiance map by harmonics: against
//! their exact integrals and published numbers.

use crate::compare::{Tolerance, relative};
use crate::harness::{golden_environment, poison_image, with_gpu};
use crate::layouts::{check_texels, filtered_environment, read_map};
use crate::tables::{EXACT, environment_image, equirect};
use splitsum::base::math::quadrature;
use splitsum::base::math::sequence::{PixelPoints, SEQUENCES};
use splitsum::base::names::Listed;
use splitsum::instrument::brdf::{MODELS, MaskingShadowing};
use splitsum::instrument::environment::layout::LAYOUTS;
use splitsum::instrument::precompute::irradiance::{
    self, reference::irradiance as exact_irradiance,
};
use splitsum::instrument::precompute::prefilter::{
    self, Kernel, LEVEL_MAPPINGS, LevelMapping, WEIGHTS, harmonic, pass::Recipe,
    reference::prefilter,
};
use splitsum::instrument::precompute::{exact_quadrature, points::Points};
use std::f64::consts::PI;

/// Relative; f32 texels, and the cut of the highest degree for a narrow lobe beside a lamp.
const HARMONIC: f64 = 1e-6;

#[test]
fn harmonic_levels_are_the_exact_integral_in_every_layout() {
    with_gpu(|gpu| {
        let environment = golden_environment();
        let image = environment_image(gpu, &environment.image);
        let exact = exact_quadrature(&environment.image);
        let points = Points::upload(gpu, 1, &SEQUENCES[0], 0, PixelPoints::Shared).unwrap();
        // The list has no mirror: its first level has a width.
        let list = LevelMapping::of_list(&[0.2, 0.5, 1.0]).unwrap();
        let mappings = [&LEVEL_MAPPINGS[0], &LEVEL_MAPPINGS[1], list];
        // Each model, layout and mapping at least once, the shorter lists again and again.
        for case in 0..LAYOUTS.len().max(MODELS.len()).max(mappings.len()) {
            let layout = &LAYOUTS[case % LAYOUTS.len()];
            let model = MODELS[case % MODELS.len()];
            let mapping = mappings[case % mappings.len()];
            let size = if layout.is_square { [32, 32] } else { [64, 32] };
            let recipe = Recipe {
                kernel: Kernel::cosine(model),
                mapping,
                lod_bias: 0.0,
            };
            let transform = harmonic::harmonics(
                &environment.image,
                harmonic::degree_of_map(mapping.narrowest_alpha(3)),
            );
            let filtered = filtered_environment(gpu, layout, &image);
            let map = prefilter::pass::map(gpu, layout, size, 3).unwrap();
            prefilter::pass::run_harmonic(
                gpu,
                recipe,
                layout,
                &filtered,
                (&points, &transform),
                &map,
            )
            .unwrap();
            let map = read_map(gpu, layout, &map);
            for level in 0..map.levels.len() {
                let alpha = mapping.alpha_from_mip(level as f64, 3);
                if alpha == 0.0 {
                    continue;
                }
                let name = format!("{} {}", layout.name, model.name());
                let value = |r| prefilter(&exact, recipe.kernel, alpha, r, EXACT).value;
                check_texels(&name, &map, level, 53, relative(HARMONIC), value);
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
            let map = irradiance::pass::map(gpu, layout, layout.irradiance_size).unwrap();
            irradiance::pass::run_harmonic(gpu, layout, &transform, &map).unwrap();
            let (name, map) = (
                format!("{} irradiance", layout.name),
                read_map(gpu, layout, &map),
            );
            check_texels(&name, &map, 0, 31, relative(HARMONIC), |n| {
                exact_irradiance(&exact, n, EXACT).value / PI
            });
        }
    });
}

#[test]
fn prefiltered_levels_converge_to_the_exact_integral() {
    // Each lookup spreads light over the trilinear footprint of its level, more than the sample's
    // share of the lobe. Beside a sun of 100 times the sky this makes up to 13 % at 256 samples,
    // and a tenth of that at 4096.
    const SAMPLES: [(u32, Tolerance); 2] = [(256, relative(0.16)), (4096, relative(2e-2))];
    // A weight of 1 ends at the horizon with a step, which costs digits, of 4096 samples too.
    const STEP: quadrature::Tolerance = quadrature::Tolerance {
        relative: 1e-3,
        max_part_count: 100_000,
    };
    with_gpu(|gpu| {
        let environment = golden_environment();
        let image = environment_image(gpu, &environment.image);
        let exact = exact_quadrature(&environment.image);
        let mapping = &LEVEL_MAPPINGS[0];
        let weights = WEIGHTS.iter().flat_map(|weight| {
            let maskings =
                MaskingShadowing::all().take(if weight.uses_masking { usize::MAX } else { 1 });
            maskings.map(move |masking| (weight, *masking))
        });
        for (model, (weight, masking)) in MODELS
            .iter()
            .flat_map(|m| weights.clone().map(move |w| (m, w)))
        {
            let kernel = Kernel::new(*model, weight, masking);
            let recipe = Recipe {
                kernel,
                mapping,
                lod_bias: 0.0,
            };
            let is_default = *weight == WEIGHTS[0];
            for (sample_count, tolerance) in SAMPLES.into_iter().skip(usize::from(!is_default)) {
                // The step converges more slowly.
                let sample_count = if weight.name == "none" {
                    2 * sample_count
                } else {
                    sample_count
                };
                let map = prefilter::pass::map(gpu, equirect(), [128, 64], 3).unwrap();
                poison_image(gpu, &map);
                let points =
                    Points::upload(gpu, sample_count, &SEQUENCES[0], 0, PixelPoints::Shared)
                        .unwrap();
                prefilter::pass::run(gpu, recipe, equirect(), &image, &points, &map).unwrap();
                let map = read_map(gpu, equirect(), &map);
                let name = format!(
                    "{} by {sample_count}, weight {} {masking:?}",
                    model.name(),
                    weight.name
                );
                for level in 1..map.levels.len() {
                    let alpha = mapping.alpha_from_mip(level as f64, 3);
                    let within = if is_default { EXACT } else { STEP };
                    let value = |r| prefilter(&exact, kernel, alpha, r, within).value;
                    check_texels(&name, &map, level, 61, tolerance, value);
                }
            }
        }
    });
}
