//! Sampled tables against their f64 twins, texel by texel, far from convergence.

use crate::harness::{poison_image, with_gpu};
use crate::layouts::{check_texels, filtered_environment, read_map};
use crate::tables::environment_image;
use crate::twins::{STEP, environments, lookup_tolerance, tables};
use glam::{DVec2, DVec3, DVec4};
use splitsum::base::glsl::constants::POINTS_PER_DISPATCH;
use splitsum::base::math::frame::Frame;
use splitsum::base::math::sequence::{PixelPoints, SEQUENCES};
use splitsum::instrument::brdf::{MODELS, MaskingShadowing, reflect};
use splitsum::instrument::environment::layout::{FilteredMap, LAYOUTS, lod_from_solid_angles};
use splitsum::instrument::precompute::points::Points;
use splitsum::instrument::precompute::prefilter::pass::Recipe;
use splitsum::instrument::precompute::prefilter::{Kernel, LEVEL_MAPPINGS, WEIGHTS};
use splitsum::instrument::precompute::{PrecomputeSettings, irradiance, prefilter};
use std::f64::consts::TAU;

/// Estimates prefiltered radiance as the device does, from half vectors at `points`. Each lookup
/// reads the level whose texels cover the solid angle of the sample, `1/(N p_l)`, plus `lod_bias`.
/// At least one sample must lie above the horizon.
fn estimate(
    environment: &FilteredMap,
    kernel: Kernel,
    alpha: f64,
    r: DVec3,
    points: &[DVec2],
    lod_bias: f64,
) -> DVec3 {
    let frame = Frame::from_normal(r);
    let (mut sum, mut weight_sum) = (DVec3::ZERO, 0.0);
    for point in points {
        let h = kernel.brdf.sample_d(*point, alpha);
        let l_local = reflect(DVec3::Z, h);
        let l = frame.to_world(l_local);
        let omega_s = 4.0 / (points.len() as f64 * kernel.brdf.d(h, alpha));
        let lod =
            lod_from_solid_angles(omega_s, environment.texel_solid_angle(l, omega_s)) + lod_bias;
        let weight = kernel.weight(alpha, l_local.z);
        sum += weight * environment.value(l, lod);
        weight_sum += weight;
    }
    sum / weight_sum
}

/// Far from convergence every texel is the sum over its own lookups, also at poles; 2,048 points
/// take two dispatches.
#[test]
fn prefiltered_texels_match_their_estimator() {
    // Weight and masking, mapping, levels added, points.
    let ways = [
        (0, MaskingShadowing::Separable, 0, 0.0, 16),
        (0, MaskingShadowing::Separable, 1, 1.5, 64),
        (1, MaskingShadowing::Schlick, 2, -1.5, 16),
        (
            1,
            MaskingShadowing::Correlated,
            0,
            0.0,
            2 * POINTS_PER_DISPATCH,
        ),
        (1, MaskingShadowing::SmithExact, 1, 0.0, 64),
        (2, MaskingShadowing::Separable, 2, 0.75, 16),
    ];
    let (cases, sequence) = (
        ways.into_iter()
            .flat_map(|way| MODELS.iter().map(move |&model| (way, model))),
        &SEQUENCES[0],
    );
    let lights = environments();
    let places = lights
        .iter()
        .flat_map(|environment| LAYOUTS.iter().map(move |layout| (environment, layout)))
        .cycle();
    with_gpu(|gpu| {
        for (((weight, masking, mapping, lod_bias, count), model), (environment, layout)) in
            cases.zip(places)
        {
            let kernel = Kernel::new(model, &WEIGHTS[weight], masking);
            let recipe = Recipe {
                kernel,
                mapping: &LEVEL_MAPPINGS[mapping],
                lod_bias,
            };
            let PrecomputeSettings {
                prefilter_size: size,
                prefilter_level_count: levels,
                ..
            } = tables(layout);
            let on_device =
                filtered_environment(gpu, layout, &environment_image(gpu, &environment.image));
            let map = prefilter::pass::map(gpu, layout, size, levels).unwrap();
            poison_image(gpu, &map);
            let points = Points::upload(gpu, count, sequence, 0, PixelPoints::Shared).unwrap();
            prefilter::pass::run(gpu, recipe, layout, &on_device, &points, &map).unwrap();
            let (filtered, map) = (
                read_map(gpu, layout, &on_device),
                read_map(gpu, layout, &map),
            );
            let points: Vec<DVec2> = (0..count).map(|i| (sequence.point)(i, count, 0)).collect();
            let name = format!("{} {} {recipe:?} by {count}", environment.name, layout.name);
            let texels = |[width, height]: [u32; 2]| f64::from(width * height);
            let mirror = 0.5 * (texels(filtered.size()) / texels(map.size())).log2();
            let tolerance = lookup_tolerance();
            check_texels(&name, &map, 0, STEP, tolerance, |r| {
                filtered.value(r, mirror.max(0.0))
            });
            for level in 1..levels {
                let alpha = recipe.mapping.alpha_from_mip(level.into(), levels);
                let value = |r| estimate(&filtered, kernel, alpha, r, &points, lod_bias.into());
                check_texels(&name, &map, level as usize, STEP, tolerance, value);
            }
        }
    });
}

#[test]
fn irradiance_maps_of_few_points_match_their_twin() {
    with_gpu(|gpu| {
        let lights = environments();
        let pairs = lights
            .iter()
            .flat_map(|environment| LAYOUTS.iter().map(move |layout| (environment, layout)));
        for (environment, layout) in pairs {
            let image = environment_image(gpu, &environment.image);
            let on_device = filtered_environment(gpu, layout, &image);
            let filtered = read_map(gpu, layout, &on_device);
            let radiance = |l: DVec3, omega_s: f64| {
                filtered.value(
                    l,
                    lod_from_solid_angles(omega_s, filtered.texel_solid_angle(l, omega_s)).max(0.0),
                )
            };
            let settings = tables(layout);
            let ([phi_count, theta_count], size) =
                (settings.irradiance_sample_count, settings.irradiance_size);
            let map = irradiance::pass::map(gpu, layout, size).unwrap();
            poison_image(gpu, &map);
            irradiance::pass::run(gpu, layout, &on_device, [phi_count, theta_count], &map).unwrap();
            let step = [
                TAU / f64::from(phi_count),
                0.25 * TAU / f64::from(theta_count),
            ];
            let name = format!("irradiance {} {}", layout.name, environment.name);
            check_texels(
                &name,
                &read_map(gpu, layout, &map),
                0,
                STEP,
                lookup_tolerance(),
                |n| {
                    let frame = Frame::from_normal(n);
                    let cells = (0..phi_count).flat_map(|i| (0..theta_count).map(move |j| [i, j]));
                    let terms = cells.map(|[i, j]| {
                        let (phi, theta) = (
                            step[0] * (f64::from(i) + 0.5),
                            step[1] * (f64::from(j) + 0.5),
                        );
                        let l = DVec3::new(
                            theta.sin() * phi.cos(),
                            theta.sin() * phi.sin(),
                            theta.cos(),
                        );
                        let weight = theta.sin() * theta.cos();
                        (weight * radiance(frame.to_world(l), step[0] * step[1] * theta.sin()))
                            .extend(weight)
                    });
                    let sum: DVec4 = terms.sum();
                    sum.truncate() / sum.w
                },
            );
        }
    });
}
