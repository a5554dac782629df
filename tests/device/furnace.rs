//! Constant radiance: a compensated surface returns all incoming light.

use crate::harness::{constant_environment, lobe_sphere, render_by_seeds, request, with_pipeline};
use crate::methods::{radiance, sights};
use splitsum::base::names::Listed;
use splitsum::instrument::brdf::{Compensation, MODELS, MaskingShadowing};
use splitsum::instrument::pipeline::RenderRequest;
use splitsum::instrument::scene::CameraKind;
use splitsum::instrument::shade::{Diffuse, Method};

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
