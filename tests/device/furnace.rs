//! Constant radiance: every integrator returns the directional albedo, which no environment can hide.

use crate::compare::{Tolerance, Worst, absolute};
use crate::harness::{constant_environment, lobe_sphere, render_by_seeds, request, scene, usual_tables, with_pipeline};
use crate::methods::{radiance, sights};
use glam::DVec3;
use rayon::prelude::*;
use splitsum::brdf::{Compensation, MODELS, MaskingShadowing};
use splitsum::pipeline::RenderRequest;
use splitsum::precompute::PrecomputeSettings;
use splitsum::precompute::dfg::reference::{Dfg, dfg};
use splitsum::scene::{CameraKind, MaterialOverride};
use splitsum::shade::{Diffuse, Method};
use splitsum::spelling::Listed;

/// What each integrator may miss of the albedo. The reference is held to its own standard error.
fn tolerance(method: &str, n_dot_v: f64, alpha: f64) -> Tolerance {
    match method {
        // Half a texel of the table's edge is held constant.
        "split-sum" if alpha == 1.0 => absolute(1.7e-2),
        // Interpolation in 64 x 64 texels.
        "split-sum" => absolute(1e-3),
        // Of normals that are visible no view sees too few.
        "sampled-vndf" => absolute(1e-3),
        // 4096 points of D; at grazing views the lobe's few visible facets carry the albedo.
        _ if n_dot_v < 0.3 => absolute(2e-2),
        _ => absolute(3e-3),
    }
}

const REFERENCE_SAMPLES: u32 = 8192;

#[test]
fn every_integrator_returns_the_directional_albedo() {
    with_pipeline(|pipeline| {
        let white = constant_environment([1.0; 3]);
        for model in MODELS {
            for alpha in [0.01, 0.3, 1.0] {
                let base = RenderRequest {
                    reference_samples: REFERENCE_SAMPLES,
                    ..request(&white, lobe_sphere(alpha), CameraKind::Ortho, [11, 11]).shaded(|s| {
                        s.brdf = *model;
                        s.samples = 4096;
                        s.precompute = PrecomputeSettings {
                            dfg_size: 64,
                            prefilter_size: [32; 2],
                            prefilter_level_count: 3,
                            ..usual_tables()
                        };
                    })
                };
                // The middle row from the centre to the rim: n_dot_v from 1 down to 0.3, and the corners' grazing views.
                let sights: Vec<_> = sights(&base, 1)
                    .into_iter()
                    .filter(|sight| sight.pixel[1] == 5 && [5, 9].contains(&sight.pixel[0]) || sight.pixel == [3, 1])
                    .collect();
                let exact: Vec<Dfg> = sights
                    .par_iter()
                    .map(|sight| {
                        let surface = &sight.surface;
                        dfg(*model, MaskingShadowing::Separable, surface.n.dot(surface.v), surface.alpha)
                    })
                    .collect();
                for name in ["sampled", "sampled-vndf", "sampled-unfiltered", "split-sum", "reference"] {
                    let request = base.shaded(|s| s.method = Method::listed(name));
                    let frame = render_by_seeds(pipeline, &request);
                    for (sight, exact) in sights.iter().zip(&exact) {
                        let n_dot_v = sight.surface.n.dot(sight.surface.v);
                        let [x, y] = sight.pixel;
                        let sigma = frame.standard_error.as_ref().map(|error| f64::from(error.get(x, y)[0]));
                        let allowed = sigma.map_or(tolerance(name, n_dot_v, alpha).floor, |sigma| {
                            // The largest of a few hundred errors by 16 nets, and one environment sample: at alpha 0.01 only one in
                            // a few hundred pixels has one within the lobe, and no net of the others knows of it.
                            5.0 * sigma + 2.0 / f64::from(REFERENCE_SAMPLES)
                        });
                        let off = radiance(&frame, sight.pixel).x - exact.albedo();
                        let case = format!("{} {name} alpha {alpha} n_dot_v {n_dot_v}", model.name());
                        assert!(
                            off.abs() < allowed,
                            "{case}: off by {off:.2e}, allowed {allowed:.2e} of {}",
                            exact.albedo()
                        );
                        assert!(sigma.is_none_or(|sigma| sigma < 0.02), "{case}: sigma {sigma:?}");
                    }
                }
            }
        }
    });
}

#[test]
fn split_sum_is_the_reference_under_constant_radiance() {
    // Exact for every view, alpha and F0: only the tables' errors are left.
    with_pipeline(|pipeline| {
        let environment = constant_environment([0.5, 2.0, 300.0]);
        for &masking_shadowing in MaskingShadowing::all() {
            let material =
                MaterialOverride { f0: Some([0.04, 0.5, 1.0]), alpha: Some(0.35), ..MaterialOverride::default() };
            let base = request(&environment, scene("sphere", material), CameraKind::Perspective, [16, 16])
                .shaded(|s| s.masking_shadowing = masking_shadowing);
            let with = |name| base.shaded(|s| s.method = Method::listed(name));
            let split = pipeline.render(&with("split-sum")).unwrap();
            let reference = render_by_seeds(pipeline, &with("reference"));
            let sigma = reference.standard_error.as_ref().unwrap();
            let radiance_of = DVec3::new(0.5, 2.0, 300.0);
            let mut worst = Worst::new(format!("split-sum and reference {masking_shadowing:?}"), absolute(1.0));
            for (i, mask) in reference.mask.data.iter().enumerate().filter(|(_, mask)| **mask > 0.0) {
                for c in 0..3 {
                    let off = f64::from(split.radiance.data[i][c] - reference.radiance.data[i][c]) / radiance_of[c];
                    // The error of 16 nets is itself uncertain, hence 6 sigma.
                    let allowed = 6.0 * f64::from(sigma.data[i][c]) / radiance_of[c] + 5e-4;
                    worst.add(off / allowed, 0.0, || format!("pixel {i} channel {c} mask {mask} off {off}"));
                }
            }
            worst.check();
        }
    });
}

/// With F0 = 1 a compensated surface in radiance 1 shows 1, by method and reference alike, whatever alpha and view are.
#[test]
fn compensated_white_surfaces_show_all_that_arrives() {
    with_pipeline(|pipeline| {
        let white = constant_environment([1.0; 3]);
        for model in MODELS {
            let cases = [0.3, 0.8].into_iter().flat_map(|alpha| Compensation::all().map(move |of| (alpha, *of)));
            for (alpha, compensation) in cases {
                let base = RenderRequest {
                    reference_samples: REFERENCE_SAMPLES,
                    ..request(&white, lobe_sphere(alpha), CameraKind::Ortho, [11, 11]).shaded(|s| {
                        s.brdf = *model;
                        // No albedo above 1, which only the scaling could take back.
                        s.masking_shadowing = MaskingShadowing::SmithExact;
                        s.compensation = compensation;
                        s.samples = 4096;
                    })
                };
                for (method, diffuse) in
                    [("split-sum", "sh9"), ("sampled-vndf", "irradiance-map"), ("reference", "reference")]
                {
                    let request = base.shaded(|s| {
                        s.method = Method::listed(method);
                        s.diffuse = Diffuse::listed(diffuse);
                    });
                    let frame = render_by_seeds(pipeline, &request);
                    let case = format!("{} {compensation:?} {method} alpha {alpha}", model.name());
                    let (mut worst, mut lost) = (0.0f64, 0.0f64);
                    for sight in sights(&base, 1) {
                        let [x, y] = sight.pixel;
                        let sigma = frame.standard_error.as_ref().map_or(0.0, |error| f64::from(error.get(x, y)[0]));
                        let off = radiance(&frame, sight.pixel).x - 1.0;
                        // Points and the interpolation of the table, or the standard error.
                        worst = worst.max(off.abs() - 5.0 * sigma);
                        lost = lost.max(-off);
                    }
                    match compensation {
                        Compensation::None => assert!(lost > 0.02, "{case}: {lost}"),
                        _ => assert!(worst < 4e-3, "{case}: off by {worst}"),
                    }
                }
            }
        }
    });
}
