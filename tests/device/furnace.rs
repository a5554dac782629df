//! Constant radiance: a compensated surface returns all incoming light.

use crate::harness::{
    constant_environment, lobe_sphere, render_by_seeds, request, scene, with_pipeline,
};
use crate::methods::{radiance, sights};
use splitsum::base::names::Listed;
use splitsum::instrument::brdf::{Compensation, MODELS, MaskingShadowing};
use splitsum::instrument::pipeline::{Pipeline, RenderRequest};
use splitsum::instrument::scene::{CameraKind, MaterialOverride};
use splitsum::instrument::shade::bend::Bend;
use splitsum::instrument::shade::{Diffuse, METHODS, Method};

const REFERENCE_SAMPLES: u32 = 8192;

/// With F0 = 1 a compensated surface in radiance 1 shows 1, by method and reference, at every alpha
/// and view.
#[test]
fn compensated_white_surfaces_reflect_all_light() {
    with_pipeline(|pipeline| {
        let white = constant_environment([1.0; 3]);
        for model in MODELS {
            let cases = [0.3, 0.8]
                .into_iter()
                .flat_map(|alpha| Compensation::all().map(move |of| (alpha, *of)));
            for (alpha, compensation) in cases {
                let base = RenderRequest {
                    reference_samples: REFERENCE_SAMPLES,
                    ..request(&white, lobe_sphere(alpha), CameraKind::Ortho, [11, 11]).shaded(|s| {
                        s.brdf = *model;
                        // No albedo above 1, which only the scaling could correct.
                        s.masking_shadowing = MaskingShadowing::SmithExact;
                        s.compensation = compensation;
                        s.samples = 4096;
                    })
                };
                for (method, diffuse) in [
                    ("split-sum", "sh9"),
                    ("sampled-vndf", "irradiance-map"),
                    ("reference", "reference"),
                ] {
                    let request = base.shaded(|s| {
                        s.method = Method::listed(method);
                        s.diffuse = Diffuse::listed(diffuse);
                    });
                    let frame = render_by_seeds(pipeline, &request);
                    let case = format!("{} {compensation:?} {method} alpha {alpha}", model.name());
                    let (mut worst, mut lost) = (0.0f64, 0.0f64);
                    for sight in sights(&base, 1) {
                        let [x, y] = sight.pixel;
                        let sigma = frame
                            .standard_error
                            .as_ref()
                            .map_or(0.0, |error| f64::from(error.get(x, y)[0]));
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

/// A white dielectric and a white metal, both with lobes of two widths.
fn white_surfaces(
    white: &std::sync::Arc<splitsum::instrument::environment::Environment>,
) -> [RenderRequest; 2] {
    [0.0, 1.0].map(|metallic| {
        let material = MaterialOverride {
            albedo: Some([1.0; 3]),
            metallic: Some(metallic),
            f0: Some([0.04, 0.3, 0.7]),
            alpha: Some(0.3),
            anisotropy: Some(0.7),
            anisotropy_turn: Some(0.4),
            ..MaterialOverride::default()
        };
        request(white, scene("sphere", material), CameraKind::Ortho, [7, 7])
            .shaded(|s| s.diffuse = Diffuse::listed("sh9"))
    })
}

/// Checks that every pixel of the surface shows 1 in radiance 1.
fn assert_white(pipeline: &mut Pipeline, request: &RenderRequest) {
    /// The SH of a constant map, and f32.
    const ROUNDING: f64 = 2e-4;
    let frame = pipeline.render(request).unwrap();
    let shading = &request.shading;
    for sight in sights(request, 1) {
        let shown = radiance(&frame, sight.pixel);
        assert!(
            (shown - 1.0).abs().max_element() < ROUNDING,
            "{} {} {:?}: {shown}",
            shading.method.name,
            shading.bend.name,
            shading.compensation
        );
    }
}

/// Specular and diffuse term of every split sum return all light of a white dielectric under every
/// compensation, and of a white metal under every one but none: all terms read the DFG table at one
/// alpha.
#[test]
fn split_sums_return_all_light_under_every_compensation() {
    with_pipeline(|pipeline| {
        let white = constant_environment([1.0; 3]);
        let surfaces = white_surfaces(&white);
        let split_sums = METHODS.iter().filter(|method| {
            method.uses_prefiltered() && method.uses_dfg && !method.has_other_factor
        });
        for method in split_sums {
            let bends: Vec<&Bend> = Bend::all()
                .take(if method.uses_bend { usize::MAX } else { 1 })
                .collect();
            for bend in bends {
                for compensation in Compensation::all() {
                    for (metallic, surface) in surfaces.iter().enumerate() {
                        if metallic == 1 && *compensation == Compensation::None {
                            continue;
                        }
                        let request = surface.shaded(|s| {
                            s.method = method;
                            s.bend = bend;
                            s.compensation = *compensation;
                        });
                        assert_white(pipeline, &request);
                    }
                }
            }
        }
    });
}
