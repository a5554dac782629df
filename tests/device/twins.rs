//! Every method and every diffuse method against its f64 twin, pixel by pixel, at few samples and
//! far from any limit.
//!
//! Every listed method is tested. The twins read the device's own g-buffer and tables, so any
//! difference comes from the method.

use crate::compare::{Tolerance, Worst};
use crate::gbuffer::draw;
use crate::harness::{
    filter_error, read_level, render_by_seeds, request, scene, with_gpu, with_pipeline,
};
use crate::layouts::{filtered_environment, read_map};
use crate::methods::{EXACT, Sight, radiance, sights_in};
use crate::tables::{coefficients, dfg_table, environment_image};
use glam::DVec3;
use rayon::prelude::*;
use splitsum::base::glsl::constants::POINTS_PER_DISPATCH;
use splitsum::base::math::sequence::{PixelPoints, SEQUENCES};
use splitsum::base::names::Listed;
use splitsum::instrument::brdf::{Brdf, MODELS, MaskingShadowing, WidthLaw};
use splitsum::instrument::environment::layout::{FilteredMap, LAYOUTS, MapLayout};
use splitsum::instrument::environment::{Environment, LoadOptions, Placement};
use splitsum::instrument::gpu::Gpu;
use splitsum::instrument::pipeline::{Frame, RenderRequest};
use splitsum::instrument::precompute::dfg::{Albedos, DfgAxes};
use splitsum::instrument::precompute::points::Points;
use splitsum::instrument::precompute::prefilter::pass::Recipe;
use splitsum::instrument::precompute::prefilter::{Kernel, LevelMapping, harmonic};
use splitsum::instrument::precompute::sh9::Projection;
use splitsum::instrument::precompute::taps::{Chain, TapCount, TapTable};
use splitsum::instrument::precompute::{
    PrecomputeSettings, PrefilterBy, exact_quadrature, irradiance, prefilter,
};
use splitsum::instrument::scene::{CameraKind, MaterialOverride, Scene};
use splitsum::instrument::shade::bend::BENDS;
use splitsum::instrument::shade::twin::{Light, Samples, Twin};
use splitsum::instrument::shade::{DIFFUSE, Diffuse, METHODS, Method};
use std::collections::BTreeMap;
use std::path::Path;
use std::sync::{Arc, Mutex};

/// Relative; directions, levels and weights in f32.
const F32: f64 = 5e-5;
/// Relative to the frame's mean: a lookup that moves by 2e-7 of the map's width moves on the edge
/// of a lamp, which may be brighter than the pixel.
const F32_EDGE: f64 = 3e-4;
/// A lookup interpolates along u, v and the level, between texels that differ by up to five times
/// the pixel or the frame's mean; in units of the filter's error.
const FILTERED: f64 = 15.0;
/// A frame of a random estimator is off by its standard error, which 16 nets know to 20 %.
const SIGMAS: f64 = 6.0;
/// A larger standard error would pass any value.
const SIGMA_MAX: f64 = 0.2;
/// Additional relative error by f32.
const F32_SUM: f64 = 1e-5;
/// Pixels per side of a random estimator's frame, and how many of them are integrated.
const MEAN_SIZE: u32 = 12;
const MEAN_COUNT: usize = 5;
pub const STEP: usize = 5;
/// At least one pixel has a smaller n_dot_v.
const GRAZING: f64 = 0.04;

/// Small tables, so that levels and texels are coarse and their choice matters.
pub fn tables(layout: &'static MapLayout) -> PrecomputeSettings {
    let size = |side: u32| {
        if layout.is_square {
            [side; 2]
        } else {
            [2 * side, side]
        }
    };
    PrecomputeSettings {
        layout,
        prefilter_size: size(32),
        prefilter_level_count: 3,
        prefilter: PrefilterBy::Sampled,
        prefilter_sample_count: 64,
        dfg_size: 32,
        dfg_sample_count: 128,
        dfg_axes: if layout.is_square {
            DfgAxes::FourthRoots
        } else {
            DfgAxes::Centres
        },
        irradiance_size: size(8),
        irradiance_sample_count: [16, 8],
        storage: splitsum::instrument::precompute::StorageFormat::F32,
        ..PrecomputeSettings::default()
    }
}

/// Lamps of several sizes, and one at a pole, where texels are narrow. A sun would turn the
/// rounding of a direction into errors of 0.1 %. Opposite to that lamp SH9 rings below 0.
pub fn environments() -> [Arc<Environment>; 2] {
    let options = LoadOptions {
        builtin_size: [128, 64],
        ..LoadOptions::default()
    };
    [
        "builtin:studio",
        "builtin:cap:elevation_deg=82,half_angle_deg=15,radiance=20,ambient=0.03",
    ]
    .map(|name| Arc::new(Environment::load(name, Path::new("."), &options).unwrap()))
}

/// The surfaces, and the points that shade them.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Case {
    kind: CameraKind,
    alpha: f32,
    masking: MaskingShadowing,
    /// Pixels per side.
    size: u32,
    samples: u32,
    sequence: usize,
    point_set: u32,
    pixel_points: PixelPoints,
    lod_bias: f32,
    /// Among [`LAYOUTS`].
    layout: usize,
    /// Name of a [`LevelMapping`], or the roughness of each of three levels.
    mapping: &'static str,
    anisotropy: f32,
    widths: WidthLaw,
    /// Among [`BENDS`].
    bend: usize,
}

const PLAIN: Case = Case {
    kind: CameraKind::Ortho,
    alpha: 0.3,
    masking: MaskingShadowing::Separable,
    size: 24,
    samples: 16,
    sequence: 0,
    point_set: 0,
    pixel_points: PixelPoints::Shared,
    lod_bias: 0.0,
    layout: 0,
    mapping: "linear",
    anisotropy: 0.0,
    widths: WidthLaw::Gltf,
    bend: 0,
};

const STRETCHED: [Case; 4] = [
    Case {
        anisotropy: 0.7,
        alpha: 0.2,
        ..PLAIN
    },
    Case {
        anisotropy: 0.6,
        alpha: 0.8,
        widths: WidthLaw::Kulla,
        masking: MaskingShadowing::Correlated,
        layout: 1,
        ..PLAIN
    },
    Case {
        anisotropy: 0.9,
        widths: WidthLaw::Disney,
        masking: MaskingShadowing::SmithExact,
        ..PLAIN
    },
    Case {
        anisotropy: 0.5,
        widths: WidthLaw::OpenPbr,
        kind: CameraKind::Perspective,
        ..PLAIN
    },
];

/// Each case differs from the first in a setting that could be confused; the last takes two
/// dispatches of points. The first has every model, the others one in turn: together, every model
/// has three kinds of masking.
const CASES: [Case; 10] = [
    PLAIN,
    Case {
        layout: 1,
        alpha: 0.1,
        mapping: "quadratic",
        ..PLAIN
    },
    Case {
        layout: 2,
        alpha: 0.1,
        ..PLAIN
    },
    Case {
        lod_bias: 1.5,
        masking: MaskingShadowing::Correlated,
        ..PLAIN
    },
    Case {
        lod_bias: -1.5,
        alpha: 1.0,
        masking: MaskingShadowing::Schlick,
        ..PLAIN
    },
    Case {
        kind: CameraKind::Perspective,
        alpha: 0.1,
        mapping: "0.2:0.6:1",
        masking: MaskingShadowing::Schlick,
        ..PLAIN
    },
    Case {
        alpha: 1.0,
        sequence: 1,
        point_set: 3,
        masking: MaskingShadowing::Schlick,
        ..PLAIN
    },
    Case {
        pixel_points: PixelPoints::Owen,
        point_set: 2,
        masking: MaskingShadowing::Correlated,
        ..PLAIN
    },
    Case {
        pixel_points: PixelPoints::Owen,
        samples: POINTS_PER_DISPATCH + 5,
        size: 9,
        sequence: 1,
        masking: MaskingShadowing::Correlated,
        ..PLAIN
    },
    Case {
        samples: POINTS_PER_DISPATCH + 16,
        size: 9,
        ..PLAIN
    },
];

impl Case {
    fn request(&self, environment: &Arc<Environment>, model: &'static dyn Brdf) -> RenderRequest {
        let material = MaterialOverride {
            alpha: Some(self.alpha),
            f0: Some([0.04, 0.5, 1.0]),
            anisotropy: Some(self.anisotropy),
            anisotropy_turn: Some(0.4),
            ..MaterialOverride::default()
        };
        RenderRequest {
            reference_samples: 4096,
            ..request(
                environment,
                scene("sphere", material),
                self.kind,
                [self.size; 2],
            )
            .shaded(|s| {
                s.placement = Placement {
                    orientation: 7,
                    rotation_deg: 30.0,
                };
                s.environment_scale = 0.5;
                s.brdf = model;
                s.masking_shadowing = self.masking;
                s.samples = self.samples;
                s.sequence = &SEQUENCES[self.sequence];
                s.point_set = self.point_set;
                s.pixel_points = self.pixel_points;
                s.lod_bias = self.lod_bias;
                s.widths = self.widths;
                s.bend = &BENDS[self.bend];
                s.precompute = PrecomputeSettings {
                    level_mapping: LevelMapping::checked(self.mapping),
                    ..tables(&LAYOUTS[self.layout])
                };
            })
        }
    }

    fn seen_by(self, method: &Method) -> Self {
        let reads_maps = method.uses_samples || method.uses_prefiltered();
        let or_plain = |is_used: bool, plain: Self| if is_used { self } else { plain };
        Self {
            size: or_plain(method.uses_samples, PLAIN).size,
            samples: or_plain(method.uses_samples, PLAIN).samples,
            sequence: or_plain(method.uses_point_set, PLAIN).sequence,
            point_set: or_plain(method.uses_point_set, PLAIN).point_set,
            pixel_points: or_plain(method.uses_point_set, PLAIN).pixel_points,
            lod_bias: or_plain(method.uses_lod_bias, PLAIN).lod_bias,
            layout: or_plain(reads_maps, PLAIN).layout,
            bend: or_plain(method.uses_bend, PLAIN).bend,
            mapping: or_plain(method.uses_prefiltered() || method.uses_levels, PLAIN).mapping,
            ..self
        }
    }

    fn samples(&self, sight: &Sight) -> Samples {
        let (count, sequence) = (self.samples, &SEQUENCES[self.sequence]);
        let pixel = (self.pixel_points == PixelPoints::Owen).then_some(sight.pixel);
        Samples {
            count,
            sequence,
            set: self.point_set,
            pixel,
            lod_bias: self.lod_bias.into(),
            bend: &BENDS[self.bend],
        }
    }
}

fn light(gpu: &Gpu, request: &RenderRequest) -> Light {
    let (settings, model, masking) = (
        &request.shading.precompute,
        request.shading.brdf,
        request.shading.masking_shadowing,
    );
    let layout = settings.layout;
    let image = environment_image(gpu, &request.environment.image);
    let filtered = filtered_environment(gpu, layout, &image);
    let map = irradiance::pass::map(gpu, layout, settings.irradiance_size).unwrap();
    irradiance::pass::run(
        gpu,
        layout,
        &filtered,
        settings.irradiance_sample_count,
        &map,
    )
    .unwrap();
    let levels = prefilter::pass::map(
        gpu,
        layout,
        settings.prefilter_size,
        settings.prefilter_level_count,
    )
    .unwrap();
    let points = Points::upload(
        gpu,
        settings.prefilter_sample_count,
        &SEQUENCES[0],
        0,
        PixelPoints::Shared,
    )
    .unwrap();
    prefilter::pass::run(
        gpu,
        Recipe::new(model, masking, settings),
        layout,
        &filtered,
        &points,
        &levels,
    )
    .unwrap();
    let projection = Projection::OverTexels;
    Light {
        environment: (0..image.mip_count())
            .map(|mip| read_level(gpu, &image, mip))
            .collect(),
        filtered: read_map(gpu, layout, &filtered),
        prefiltered: read_map(gpu, layout, &levels),
        level_mapping: settings.level_mapping,
        dfg: dfg_table(gpu, model, masking, settings),
        dfg_axes: settings.dfg_axes,
        albedos: albedos(model, masking, request.scene.materials[0].alpha.into()),
        one_tap: taps(model, masking, settings, TapCount::One),
        two_taps: taps(model, masking, settings, TapCount::Two),
        four_taps: taps(model, masking, settings, TapCount::Four),
        irradiance_map: read_map(gpu, layout, &map),
        sh9: coefficients(gpu, &image, projection).1,
    }
}

fn exact_prefiltered(gpu: &Gpu, request: &RenderRequest) -> FilteredMap {
    let settings = &request.shading.precompute;
    let (layout, count) = (settings.layout, settings.prefilter_level_count);
    let recipe = Recipe::new(
        request.shading.brdf,
        request.shading.masking_shadowing,
        settings,
    );
    let filtered = filtered_environment(
        gpu,
        layout,
        &environment_image(gpu, &request.environment.image),
    );
    let degree = harmonic::degree_of_map(settings.level_mapping.narrowest_alpha(count));
    let transform = harmonic::harmonics(&request.environment.image, degree);
    let levels = prefilter::pass::map(gpu, layout, settings.prefilter_size, count).unwrap();
    let points = Points::upload(gpu, 1, &SEQUENCES[0], 0, PixelPoints::Shared).unwrap();
    prefilter::pass::run_harmonic(
        gpu,
        recipe,
        layout,
        &filtered,
        (&points, &transform),
        &levels,
    )
    .unwrap();
    read_map(gpu, layout, &levels)
}

/// Inputs that many cases share, made once.
struct Made<T>(Mutex<BTreeMap<String, T>>);

impl<T: Clone> Made<T> {
    const fn none() -> Self {
        Self(Mutex::new(BTreeMap::new()))
    }

    fn get(&self, key: String, make: impl FnOnce() -> T) -> T {
        self.0
            .lock()
            .unwrap()
            .entry(key)
            .or_insert_with(make)
            .clone()
    }
}

fn albedos(model: &'static dyn Brdf, masking: MaskingShadowing, alpha: f64) -> Albedos {
    static MADE: Made<Albedos> = Made::none();
    let make = || Albedos::new(Kernel::cosine(model), masking, alpha);
    MADE.get(format!("{} {masking:?} {alpha}", model.name()), make)
}

/// The table that the pipeline writes to the device.
fn taps(
    model: &'static dyn Brdf,
    masking: MaskingShadowing,
    settings: &PrecomputeSettings,
    count: TapCount,
) -> TapTable {
    static MADE: Made<TapTable> = Made::none();
    let PrecomputeSettings {
        level_mapping: mapping,
        prefilter_level_count: levels,
        ..
    } = *settings;
    let fit = || {
        TapTable::fit(
            &Chain::new(Kernel::cosine(model), mapping, levels),
            model,
            masking,
            count,
        )
    };
    MADE.get(
        format!(
            "{} {masking:?} {} {levels} {count:?}",
            model.name(),
            mapping.name
        ),
        fit,
    )
}

/// The contents of the device's g-buffer.
fn sights(gpu: &Gpu, request: &RenderRequest) -> Vec<Sight> {
    let seen = |scene: &Scene| draw(gpu, scene, &request.camera, request.size);
    sights_in(
        request,
        &seen(&request.scene),
        &seen(&request.scene.tangents()),
    )
}

fn n_dot_v(sight: &Sight) -> f64 {
    sight.surface.n.dot(sight.surface.v)
}

/// Compares a frame with a twin of the radiance of each surface point.
#[allow(
    clippy::too_many_arguments,
    reason = "a twin, its frame and its tolerances"
)]
fn check<E: Copy + Sync>(
    name: String,
    twin: Twin<E>,
    estimate: impl Fn(E, &Sight) -> DVec3 + Sync,
    mean_weight: impl Fn(&Sight) -> DVec3,
    request: &RenderRequest,
    sights: &[Sight],
    frame: &Frame,
    lookup: Tolerance,
) {
    let scale = f64::from(request.shading.environment_scale);
    match twin {
        Twin::Estimator(estimator) => {
            let expected: Vec<DVec3> = sights
                .par_iter()
                .map(|sight| scale * estimate(estimator, sight))
                .collect();
            let mean = expected.iter().map(|rgb| rgb.element_sum()).sum::<f64>()
                / (3 * expected.len()) as f64;
            let mut worst = Worst::new(
                name,
                Tolerance {
                    floor: lookup.floor * mean + f64::MIN_POSITIVE,
                    ..lookup
                },
            );
            for (sight, expected) in sights.iter().zip(expected) {
                let place = || format!("{:?} n_dot_v {}", sight.pixel, n_dot_v(sight));
                worst.add_rgb(radiance(frame, sight.pixel), expected, place);
            }
            worst.check();
        }
        Twin::Mean(mean) => {
            let exact = exact_quadrature(&request.environment.image);
            let some: Vec<&Sight> = sights.iter().step_by(sights.len() / MEAN_COUNT).collect();
            let means: Vec<DVec3> = some
                .par_iter()
                .map(|sight| mean(&exact, &sight.surface, &request.shading.precompute, EXACT).value)
                .collect();
            let sigmas = frame.standard_error.as_ref().unwrap();
            for (sight, mean) in some.into_iter().zip(means) {
                let (expected, [x, y]) = (scale * mean * mean_weight(sight), sight.pixel);
                let (off, sigma) = (
                    radiance(frame, sight.pixel) - expected,
                    sigmas.get(x, y).map(f64::from),
                );
                for c in 0..3 {
                    let allowed = SIGMAS * sigma[c] + F32_SUM * expected[c];
                    // At f0 = 1 nothing is transmitted: 0 is 0.
                    assert!(
                        off[c].abs() <= allowed,
                        "{name}: {off} at {x} {y}, standard error {sigma:?}"
                    );
                    assert!(
                        sigma[c] <= SIGMA_MAX * expected[c],
                        "{name}: {sigma:?} of {expected} says nothing"
                    );
                }
            }
        }
    }
}

/// Relative, with a floor in units of the frame's mean.
pub fn lookup_tolerance() -> Tolerance {
    let [relative, floor] = [F32, F32_EDGE].map(|least| least.max(FILTERED * filter_error()));
    Tolerance { relative, floor }
}

#[test]
fn every_method_matches_its_f64_twin() {
    let none: &Diffuse = Diffuse::listed("none");
    with_gpu(|gpu| {
        with_pipeline(|pipeline| {
            let mut smallest = 1.0;
            // The lamp at a pole matters to the layouts, which the first cases cover.
            let [studio, lamp] = environments();
            let in_turn = |index: usize| MODELS[index % MODELS.len()];
            let plain = MODELS.iter().map(|&model| (&studio, &CASES[0], model));
            let others = (1..CASES.len()).map(|index| (&studio, &CASES[index], in_turn(index)));
            let lamps = (0..LAYOUTS.len()).map(|index| (&lamp, &CASES[index], in_turn(index)));
            let mut seen = Vec::new();
            let stretched = STRETCHED
                .iter()
                .enumerate()
                .map(|(index, case)| (&studio, case, MODELS[index % 2]));
            let bent = |bend| {
                [0.7, 0.1].map(|anisotropy| Case {
                    bend,
                    anisotropy,
                    ..STRETCHED[0]
                })
            };
            let bent: Vec<Case> = (0..BENDS.len()).flat_map(bent).collect();
            let bent = bent.iter().map(|case| (&studio, case, MODELS[0]));
            for (environment, case, model) in plain
                .chain(others)
                .chain(lamps)
                .chain(stretched)
                .chain(bent)
            {
                let base = case.request(environment, model);
                let (light, frame_sights) = (light(gpu, &base), sights(gpu, &base));
                let exact = Light {
                    prefiltered: exact_prefiltered(gpu, &base),
                    ..light.clone()
                };
                let small = RenderRequest {
                    size: [MEAN_SIZE; 2],
                    ..base.clone()
                };
                let small_sights = sights(gpu, &small);
                smallest = frame_sights.iter().map(n_dot_v).fold(smallest, f64::min);
                for method in METHODS {
                    let asked = (
                        method.name,
                        model.name(),
                        environment.name.clone(),
                        case.seen_by(method),
                    );
                    // The ladder takes one width.
                    let is_step = case.anisotropy > 0.0 && method.name.starts_with("ladder");
                    if seen.contains(&asked) || is_step {
                        continue;
                    }
                    seen.push(asked);
                    let is_mean = matches!(method.twin, Twin::Mean(_));
                    let (base, sights) = if is_mean {
                        (&small, &small_sights)
                    } else {
                        (&base, &frame_sights)
                    };
                    let request = base.shaded(|s| (s.method, s.diffuse) = (method, none));
                    let frame = render_by_seeds(pipeline, &request);
                    let light = if method.prefilter == Some(PrefilterBy::Harmonic) {
                        &exact
                    } else {
                        &light
                    };
                    check(
                        format!(
                            "{} {} {case:?} {}",
                            method.name,
                            model.name(),
                            environment.name
                        ),
                        method.twin,
                        |twin, sight| twin(&sight.surface, light, &case.samples(sight)),
                        |_| DVec3::ONE,
                        &request,
                        sights,
                        &frame,
                        lookup_tolerance(),
                    );
                }
            }
            assert!(
                smallest < GRAZING,
                "no grazing view: n_dot_v is {smallest} or more"
            );
        });
    });
}

#[test]
fn every_diffuse_method_matches_its_f64_twin() {
    let none: &Method = Method::listed("none");
    with_gpu(|gpu| {
        with_pipeline(|pipeline| {
            let layouts = 0..LAYOUTS.len();
            for (environment, layout) in environments()
                .iter()
                .flat_map(|e| layouts.clone().map(move |layout| (e, layout)))
            {
                let base = Case { layout, ..PLAIN }.request(environment, MODELS[0]);
                let (mut light, sights) = (light(gpu, &base), sights(gpu, &base));
                let image = environment_image(gpu, &environment.image);
                for diffuse in DIFFUSE {
                    if let Some(projection) = diffuse.sh9 {
                        light.sh9 = coefficients(gpu, &image, projection).1;
                    }
                    let request = base.shaded(|s| (s.method, s.diffuse) = (none, diffuse));
                    let frame = render_by_seeds(pipeline, &request);
                    check(
                        format!("{} {}", diffuse.name, environment.name),
                        diffuse.twin,
                        |twin, sight| sight.albedo * twin(sight.surface.n, &light),
                        |sight| sight.albedo,
                        &request,
                        &sights,
                        &frame,
                        lookup_tolerance(),
                    );
                }
            }
        });
    });
}
