//! Every method against f64, on a few pixels of a small frame.

use crate::compare::{Worst, relative};
use crate::compensation_twins::multiple;
use crate::gbuffer_twin::gbuffer;
use crate::harness::{
    constant_environment, golden_environment, lobe_sphere, render_by_seeds, request, scene,
    usual_tables, with_gpu, with_pipeline,
};
use crate::symmetry::smooth_environment;
use crate::tables::dfg_table;
use glam::DVec3;
use rayon::prelude::*;
use splitsum::base::math::sequence::PixelPoints;
use splitsum::base::names::Listed;
use splitsum::base::pixels::Pixels;
use splitsum::instrument::brdf::Stretch;
use splitsum::instrument::brdf::{Compensation, FresnelWeight, MODELS};
use splitsum::instrument::environment::Placement;
use splitsum::instrument::environment::layout::MapLayout;
use splitsum::instrument::gbuffer::Gbuffer;
use splitsum::instrument::pipeline::{Frame, Pipeline, RenderRequest};
use splitsum::instrument::precompute::{PrecomputeSettings, exact_quadrature};
use splitsum::instrument::scene::{CameraKind, MaterialOverride, Scene};
use splitsum::instrument::shade::reference::{Answer, Surface, integrate};
use splitsum::instrument::shade::{Diffuse, Method, Shading};

use splitsum::base::math::quadrature;
use std::f64::consts::PI;

/// Far below the error of every method here.
pub const EXACT: quadrature::Tolerance = quadrature::Tolerance {
    relative: 1e-4,
    max_part_count: 100_000,
};

/// A pixel of a frame, and position, surface (in the environment's frame) and albedo that it shows.
pub struct Sight {
    pub pixel: [u32; 2],
    /// In world axes.
    pub position: DVec3,
    pub surface: Surface,
    pub albedo: DVec3,
}

/// Every `step`-th pixel that hits something.
pub fn sights(request: &RenderRequest, step: usize) -> Vec<Sight> {
    let seen = |scene: &Scene| gbuffer(scene, &request.camera, request.size);
    sights_in(
        request,
        &seen(&request.scene),
        &seen(&request.scene.tangents()),
    )
    .into_iter()
    .step_by(step)
    .collect()
}

/// Every pixel of a g-buffer, and of the one of tangents, that hits something.
pub fn sights_in<T: Copy + Into<f64>>(
    request: &RenderRequest,
    texels: &Gbuffer<T>,
    tangents: &Gbuffer<T>,
) -> Vec<Sight> {
    let turn = request.shading.placement.environment_from_world();
    let [width, height] = request.size;
    let pixels = (0..height).flat_map(|y| (0..width).map(move |x| [x, y]));
    let sight = |pixel: [u32; 2]| {
        let at = |attachment: &Pixels<[T; 4]>| {
            let [x, y, z, w] = attachment.get(pixel[0], pixel[1]).map(Into::into);
            (DVec3::new(x, y, z), w)
        };
        let ((position, mask), (n, alpha)) = (at(&texels.position_mask), at(&texels.normal_alpha));
        let (n, f0) = (n.normalize(), at(&texels.f0_material).0);
        let Shading {
            brdf,
            masking_shadowing,
            widths,
            ..
        } = request.shading;
        let v = request.camera.v_at(position);
        let mut surface = Surface::new(brdf, masking_shadowing, alpha, f0, [turn * n, turn * v]);
        if request.scene.has_anisotropy() {
            let (tangent, strength) = at(&tangents.normal_alpha);
            let tangent = turn * tangent.reject_from_normalized(n).normalize();
            surface = surface.stretched(Stretch {
                widths: widths.widths(alpha, strength),
                tangent,
            });
        }
        (mask == 1.0).then(|| Sight {
            pixel,
            position,
            surface,
            albedo: at(&texels.albedo_metallic).0,
        })
    };
    pixels.filter_map(sight).collect()
}

pub fn radiance(frame: &Frame, [x, y]: [u32; 2]) -> DVec3 {
    DVec3::from_array(frame.radiance.get(x, y).map(f64::from))
}

fn method(name: &str) -> &'static splitsum::instrument::shade::Method {
    Method::listed(name)
}

fn coloured_sphere(alpha: f32) -> splitsum::instrument::scene::Scene {
    let material = MaterialOverride {
        alpha: Some(alpha),
        f0: Some([0.04, 0.5, 1.0]),
        ..MaterialOverride::default()
    };
    scene("sphere", material)
}

/// Inputs of device and f64 code: 12 x 12 pixels in perspective, so that every pixel has its own v.
fn small_request(
    environment: &std::sync::Arc<splitsum::instrument::environment::Environment>,
    alpha: f32,
) -> RenderRequest {
    request(
        environment,
        coloured_sphere(alpha),
        CameraKind::Perspective,
        [12, 12],
    )
    .shaded(|s| {
        s.placement = Placement {
            orientation: 0,
            rotation_deg: 30.0,
        }
    })
}

/// Both terms draw their own points, so their squared errors add. K^2 instead of K (K - 1) would
/// state a quarter less variance.
#[test]
fn the_standard_error_is_the_spread_over_seeds() {
    const SEEDS: u32 = 96;
    with_pipeline(|pipeline| {
        let (albedo, f0) = (Some([0.4; 3]), Some([0.5; 3]));
        let material = MaterialOverride {
            albedo,
            f0,
            alpha: Some(0.5),
            metallic: Some(0.0),
            ..MaterialOverride::default()
        };
        let both = RenderRequest {
            reference_samples: 64,
            ..request(
                &smooth_environment(),
                scene("sphere", material),
                CameraKind::Ortho,
                [24; 2],
            )
            .shaded(|s| (s.method, s.diffuse) = (method("reference"), Diffuse::listed("reference")))
        };
        // For each pixel: sum and sum of squares over seeds, and sum of the stated squared errors.
        let mut sums = vec![[0.0; 3]; 24 * 24];
        for seed in 0..SEEDS {
            let frame = pipeline
                .render(&RenderRequest {
                    seed,
                    ..both.clone()
                })
                .unwrap();
            let errors = &frame.standard_error.as_ref().unwrap().data;
            for ((x, error), sums) in frame.radiance.data.iter().zip(errors).zip(&mut sums) {
                let (x, error) = (f64::from(x[0]), f64::from(error[0]));
                [x, x * x, error * error]
                    .iter()
                    .zip(sums)
                    .for_each(|(term, sum)| *sum += term);
            }
        }
        let n = f64::from(SEEDS);
        let hit = sums.iter().filter(|[sum, ..]| *sum > 0.0);
        let ratios: Vec<f64> = hit
            .map(|[x, xx, ee]| (xx - x * x / n) / (n - 1.0) / (ee / n))
            .collect();
        let mean = ratios.iter().sum::<f64>() / ratios.len() as f64;
        // Each ratio is known to sqrt(2 / 95), their mean to 0.8 %.
        println!(
            "spread over stated error, squared: {mean} over {} pixels",
            ratios.len()
        );
        assert!((mean - 1.0).abs() < 0.03, "{mean}");
    });
}

/// Root of the mean square relative error (of the brightest channel) of a method against exact
/// values.
fn rms(
    pipeline: &mut Pipeline,
    request: &RenderRequest,
    sights: &[Sight],
    expected: &[DVec3],
) -> f64 {
    let frame = pipeline.render(request).unwrap();
    let squares = sights.iter().zip(expected).map(|(sight, expected)| {
        ((radiance(&frame, sight.pixel) - *expected)
            .abs()
            .max_element()
            / expected.max_element())
        .powi(2)
    });
    (squares.sum::<f64>() / sights.len() as f64).sqrt()
}

#[test]
fn sampled_methods_converge_to_their_integral() {
    const COUNTS: [u32; 3] = [32, 512, 16384];
    with_pipeline(|pipeline| {
        let environment = golden_environment();
        let exact = exact_quadrature(&environment.image);
        for model in MODELS {
            let base = small_request(&environment, 0.3).shaded(|s| s.brdf = *model);
            let sights = sights(&base, 13);
            let surfaces: Vec<Surface> = sights.iter().map(|sight| sight.surface).collect();
            let right: Vec<DVec3> = surfaces
                .par_iter()
                .map(|surface| integrate(&exact, surface, EXACT).specular.value)
                .collect();
            // Relative, at 16384 points: the sun of 100 times the sky is hit by a few hundred of
            // them.
            for (name, tolerance) in [
                ("sampled", 3e-3),
                ("sampled-vndf", 3e-3),
                ("sampled-unfiltered", 5e-3),
            ] {
                let errors = COUNTS.map(|samples| {
                    let request = base.shaded(|s| (s.method, s.samples) = (method(name), samples));
                    rms(pipeline, &request, &sights, &right)
                });
                println!("{} {name}: {errors:?}", model.name());
                assert!(errors[2] < tolerance, "{} {name}: {errors:?}", model.name());
                assert!(
                    errors[0] > errors[1] && errors[1] > errors[2],
                    "{} {name}: {errors:?}",
                    model.name()
                );
            }
        }
    });
}

/// What the printed sum of GGX shows of light 1 and F = 1: the mean of `G1(v) G1(l) / (4 n·v)` over
/// directions of density D cos about the mirror direction, by midpoints in both angles.
fn printed_albedo(alpha: f64, n_dot_v: f64) -> f64 {
    const STEPS: u32 = 512;
    let step = |i: u32, whole: f64| whole * (f64::from(i) + 0.5) / f64::from(STEPS);
    let masking = |x: f64| 2.0 / (1.0 + (1.0 + alpha * alpha * (1.0 / (x * x) - 1.0)).sqrt());
    let sin_v = (1.0 - n_dot_v * n_dot_v).sqrt();
    let mut sum = 0.0;
    for (theta, phi) in (0..STEPS * STEPS).map(|i| (i / STEPS, i % STEPS)) {
        let (sin, cos) = step(theta, 0.5 * PI).sin_cos();
        let d = alpha * alpha / (PI * (cos * cos * (alpha * alpha - 1.0) + 1.0).powi(2));
        let n_dot_l = cos * n_dot_v + sin * sin_v * step(phi, 2.0 * PI).cos();
        if n_dot_l > 0.0 {
            sum += d * cos * sin * masking(n_dot_v) * masking(n_dot_l) / (4.0 * n_dot_v);
        }
    }
    sum * PI * PI / f64::from(STEPS * STEPS)
}

#[test]
fn the_printed_estimator_converges_to_its_own_mean() {
    with_pipeline(|pipeline| {
        let alpha = 0.3;
        let base = request(
            &constant_environment([1.0; 3]),
            lobe_sphere(alpha),
            CameraKind::Ortho,
            [13, 13],
        );
        let request =
            base.shaded(|s| (s.method, s.samples) = (method("printed-document-0"), 16384));
        let frame = pipeline.render(&request).unwrap();
        for sight in sights(&request, 7) {
            let n_dot_v = sight.surface.n.dot(sight.surface.v);
            let expected = printed_albedo(alpha, n_dot_v);
            let found = radiance(&frame, sight.pixel).x;
            assert!(
                (found / expected - 1.0).abs() < 3e-3,
                "n·v {n_dot_v}: {found} instead of {expected}"
            );
        }
    });
}

/// The reference's part of several scatterings under `kulla-conty` is the integral of its lobe: `(1
/// - E(v)) F (1 - E(l)) n·l / (π (1 - E_avg))`.
#[test]
fn the_lobe_of_several_scatterings_is_integrated() {
    with_gpu(|gpu| {
        with_pipeline(|pipeline| {
            let environment = golden_environment();
            let exact = exact_quadrature(&environment.image);
            let albedo = DVec3::new(0.9f32.into(), 0.6f32.into(), 0.3f32.into());
            let metal = MaterialOverride {
                albedo: Some([0.9, 0.6, 0.3]),
                metallic: Some(1.0),
                alpha: Some(0.8),
                ..MaterialOverride::default()
            };
            let base = RenderRequest {
                reference_samples: 4096,
                ..request(
                    &environment,
                    scene("sphere", metal),
                    CameraKind::Ortho,
                    [12, 12],
                )
                .shaded(|s| s.compensation = Compensation::KullaConty)
            };
            let with = |diffuse| base.shaded(|s| s.diffuse = Diffuse::listed(diffuse));
            let [both, single] =
                ["reference", "none"].map(|name| render_by_seeds(pipeline, &with(name)));
            let tables = &base.shading.precompute;
            let table = dfg_table(
                gpu,
                base.shading.brdf,
                base.shading.masking_shadowing,
                tables,
            );
            let pair = |cosine: f64| tables.dfg_axes.lookup(&table, cosine, 0.8);
            let node = |i: u32| (f64::from(i) + 0.5) / 64.0;
            let mean = (0..64)
                .map(|i| 2.0 * node(i) / 64.0 * pair(node(i)).element_sum())
                .sum::<f64>();
            for sight in sights(&base, 11) {
                let Surface { n, v, .. } = sight.surface;
                let lobe = |l: DVec3| {
                    let cosine = n.dot(l).max(0.0);
                    [(1.0 - pair(cosine).element_sum()) * cosine / (PI * (1.0 - mean))]
                };
                let light = exact.integrate(lobe, None, EXACT).value[0];
                let expected = multiple(
                    Compensation::KullaConty,
                    FresnelWeight::Schlick,
                    albedo,
                    pair(n.dot(v)),
                    mean,
                ) * light;
                let [x, y] = sight.pixel;
                let sigma = DVec3::from_array(
                    both.standard_error
                        .as_ref()
                        .unwrap()
                        .get(x, y)
                        .map(f64::from),
                );
                let off =
                    (radiance(&both, sight.pixel) - radiance(&single, sight.pixel) - expected)
                        .abs();
                assert!(
                    off.cmplt(6.0 * sigma + 2e-4 * expected).all(),
                    "{x} {y}: {off} of {expected}, {sigma}"
                );
                assert!(
                    sigma.cmplt(0.02 * expected).all(),
                    "{sigma} of {expected} says nothing"
                );
            }
        });
    });
}

/// Few points scrambled for each pixel are unbiased if nothing is filtered: their mean over sets is
/// the integral within its standard error. Shared points of set 0 are biased.
#[test]
fn the_mean_over_scrambles_is_the_integral() {
    const SETS: u32 = 256;
    const SIGMAS: f64 = 5.0;
    with_pipeline(|pipeline| {
        let environment = golden_environment();
        let exact = exact_quadrature(&environment.image);
        for model in MODELS {
            let base = small_request(&environment, 0.5).shaded(|s| {
                s.brdf = *model;
                s.samples = 128;
                s.pixel_points = PixelPoints::Owen;
                // The finest level of a lat-long map is the map itself.
                s.lod_bias = -16.0;
                s.precompute = PrecomputeSettings {
                    layout: MapLayout::listed("equirect"),
                    ..usual_tables()
                };
            });
            let sights = sights(&base, 29);
            let surfaces: Vec<Surface> = sights.iter().map(|sight| sight.surface).collect();
            let right: Vec<Answer> = surfaces
                .par_iter()
                .map(|surface| integrate(&exact, surface, EXACT))
                .collect();
            for name in ["sampled", "sampled-vndf"] {
                let frames: Vec<Frame> =
                    (0..SETS)
                        .map(|point_set| {
                            pipeline
                                .render(&base.shaded(|s| {
                                    (s.method, s.point_set) = (method(name), point_set)
                                }))
                                .unwrap()
                        })
                        .collect();
                for (sight, right) in sights.iter().zip(&right) {
                    let of_sets: Vec<DVec3> = frames
                        .iter()
                        .map(|frame| radiance(frame, sight.pixel))
                        .collect();
                    let count = f64::from(SETS);
                    let mean = of_sets.iter().sum::<DVec3>() / count;
                    let variance = of_sets
                        .iter()
                        .map(|x| (*x - mean) * (*x - mean))
                        .sum::<DVec3>()
                        / (count - 1.0);
                    let error = DVec3::from_array((variance / count).to_array().map(f64::sqrt));
                    let off = (mean - right.specular.value).abs();
                    let case = format!(
                        "{} {name} {:?}: {mean} +- {error}",
                        model.name(),
                        sight.pixel
                    );
                    assert!(
                        off.cmple(SIGMAS * error + 1e-4 * mean).all(),
                        "{case} is off by {off}"
                    );
                    assert!(error.cmplt(0.1 * mean).all(), "{case} says nothing");
                }
            }
        }
    });
}

#[test]
fn the_diffuse_term_gets_the_rest_of_the_light() {
    // (1 - (f0 A + B)) (1 - metallic) albedo E / pi under radiance 1, where E / pi is 1; without a
    // specular term just the albedo.
    with_gpu(|gpu| {
        with_pipeline(|pipeline| {
            let white = crate::harness::constant_environment([1.0; 3]);
            let material = MaterialOverride {
                albedo: Some([0.9, 0.5, 0.1]),
                metallic: Some(0.25),
                alpha: Some(0.4),
                f0: Some([0.04, 0.3, 0.6]),
                ..MaterialOverride::default()
            };
            let base = request(&white, scene("sphere", material), CameraKind::Ortho, [9, 9]);
            let table = dfg_table(
                gpu,
                base.shading.brdf,
                base.shading.masking_shadowing,
                &base.shading.precompute,
            );
            // The map of radiance 1 is 1 within the roundings of 4096 additions.
            let mut worst = Worst::new("diffuse beside specular", relative(1e-5));
            let albedo = DVec3::new(0.9f32.into(), 0.5f32.into(), 0.1f32.into());
            for (name, of) in [
                ("none", "none"),
                ("split-sum", "none"),
                ("split-sum", "turquin"),
            ] {
                let base = base.shaded(|s| {
                    (s.method, s.compensation) = (method(name), *Compensation::listed(of))
                });
                let with = |diffuse| base.shaded(|s| s.diffuse = Diffuse::listed(diffuse));
                let both = pipeline.render(&with("irradiance-map")).unwrap();
                let specular = pipeline.render(&with("none")).unwrap();
                for Sight { pixel, surface, .. } in sights(&base, 4) {
                    let n_dot_v = surface.n.dot(surface.v);
                    let pair =
                        base.shading
                            .precompute
                            .dfg_axes
                            .lookup(&table, n_dot_v, surface.alpha);
                    let more = if of == "none" {
                        0.0
                    } else {
                        1.0 / pair.element_sum() - 1.0
                    };
                    let specular_share = (surface.f0 * pair.x + pair.y) * (1.0 + surface.f0 * more);
                    let left = if name == "none" {
                        DVec3::ONE
                    } else {
                        1.0 - specular_share
                    };
                    let diffuse = radiance(&both, pixel) - radiance(&specular, pixel);
                    worst.add_rgb(diffuse, 0.75 * albedo * left, || {
                        format!("{name} {pixel:?}")
                    });
                }
            }
            worst.check();
        });
    });
}
