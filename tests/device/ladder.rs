//! The steps of the split sum's error, as attributed, against frames of the methods.

use crate::compare::{Worst, relative};
use crate::harness::{golden_environment, request, scene, with_pipeline};
use splitsum::environment::Placement;
use splitsum::environment::layout::LAYOUTS;
use splitsum::ladder::{SAMPLES, STEPS, STORAGE};
use splitsum::metrics::{Comparison, HEADLINE};
use splitsum::pipeline::{Pipeline, RenderRequest};
use splitsum::precompute::{PrecomputeSettings, PrefilterBy, StorageFormat};
use splitsum::scene::{CameraKind, MaterialOverride};
use splitsum::shade::method_by_name;
use splitsum::tonemap::ToneCurve;

const DRAWN: u32 = 4096;

/// `relmse` of a method's frame against that of the reference.
fn relmse(pipeline: &mut Pipeline, method: &str, request: &RenderRequest) -> f64 {
    let mut frame = |name: &str| {
        let method = method_by_name(name).unwrap();
        pipeline.render(&RenderRequest { method, samples: DRAWN, ..request.clone() }).unwrap()
    };
    let (test, reference) = (frame(method), frame("reference"));
    let comparison =
        Comparison::new(&test.radiance, &reference.radiance, &test.mask, ToneCurve::default(), request.epsilon());
    let scores = comparison.unwrap().evaluate_linear();
    scores.into_iter().find(|(name, _)| *name == HEADLINE).unwrap().1
}

#[test]
fn rungs_have_the_error_of_the_methods_frames() {
    with_pipeline(|pipeline| {
        for (layout, prefilter, storage) in [
            (&LAYOUTS[0], PrefilterBy::Sampled, StorageFormat::F16),
            (&LAYOUTS[1], PrefilterBy::Harmonic, StorageFormat::F32),
            (&LAYOUTS[2], PrefilterBy::Sampled, StorageFormat::F32),
        ] {
            if layout.face_count == 6 && !pipeline.device().has_seamless_cubes {
                continue;
            }
            // Coarse tables, so that each step counts. Alpha is between the levels.
            let size = if layout.is_square { [32; 2] } else { [64, 32] };
            let precompute = PrecomputeSettings {
                layout,
                prefilter,
                storage,
                prefilter_size: size,
                prefilter_level_count: 3,
                prefilter_sample_count: 32,
                dfg_size: 8,
                ..PrecomputeSettings::default()
            };
            let material =
                MaterialOverride { alpha: Some(0.12), f0: Some([0.04, 0.3, 1.0]), ..MaterialOverride::default() };
            let request = RenderRequest {
                precompute,
                placement: Placement { orientation: 3, rotation_deg: 20.0 },
                environment_scale: 3.0,
                reference_samples: DRAWN,
                ..request(&golden_environment(), scene("design", material), CameraKind::Perspective, [24, 24])
            };
            let found = pipeline.attributions(&request, DRAWN, &[]).unwrap();
            let steps = &found[0].steps;
            // The drawn rungs share their points; the others differ from the frames by f32 and by the noise of both.
            for (i, step) in STEPS.iter().enumerate() {
                let made = |by: usize| i >= by;
                let precompute = PrecomputeSettings {
                    prefilter: if made(SAMPLES) { prefilter } else { PrefilterBy::Harmonic },
                    storage: if made(STORAGE) { storage } else { StorageFormat::F32 },
                    ..precompute
                };
                let request = RenderRequest { precompute, ..request.clone() };
                let right = relmse(pipeline, step.rung.name, &request);
                let mut worst = Worst::new(format!("{}, {}", step.name, layout.name), relative(5e-3));
                worst.add(steps[i].error, right, || step.rung.name.to_owned());
                worst.check();
            }
        }
    });
}
