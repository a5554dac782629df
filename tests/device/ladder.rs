//! The attributed steps of the split sum's error, against frames of the methods.

use crate::compare::{Worst, relative};
use crate::harness::{filter_error, golden_environment, request, scene, with_pipeline};
use splitsum::base::names::Listed;
use splitsum::instrument::environment::Placement;
use splitsum::instrument::environment::layout::LAYOUTS;
use splitsum::instrument::ladder::{STEPS, Step};
use splitsum::instrument::metrics::{Comparison, HEADLINE};
use splitsum::instrument::pipeline::{Frame, RenderRequest};
use splitsum::instrument::precompute::{PrecomputeSettings, PrefilterBy, StorageFormat};
use splitsum::instrument::scene::{CameraKind, MaterialOverride};
use splitsum::instrument::shade::Method;
use splitsum::instrument::tonemap::ToneCurve;

const DRAWN: u32 = 4096;

fn between(test: &Frame, reference: &Frame, request: &RenderRequest) -> f64 {
    let comparison = Comparison::new(
        &test.radiance,
        &reference.radiance,
        &test.mask,
        ToneCurve::default(),
        request.epsilon(),
    );
    let scores = comparison
        .unwrap()
        .evaluate(&splitsum::instrument::metrics::linear_metrics());
    scores
        .into_iter()
        .find(|(name, _)| *name == HEADLINE)
        .unwrap()
        .1
}

#[test]
fn rungs_have_the_error_of_the_methods_frames() {
    with_pipeline(|pipeline| {
        // The frames' lookups are off by it, at errors of about a fifth of the radiance.
        let filtered = relative(5e-3 + 2.0 * filter_error());
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
                prefilter_lod_bias: 1.5,
                dfg_size: 8,
                ..PrecomputeSettings::default()
            };
            let material = MaterialOverride {
                alpha: Some(0.12),
                f0: Some([0.04, 0.3, 1.0]),
                ..MaterialOverride::default()
            };
            let request = RenderRequest {
                reference_samples: DRAWN,
                ..request(
                    &golden_environment(),
                    scene("design", material),
                    CameraKind::Perspective,
                    [24, 24],
                )
                .shaded(|s| {
                    s.precompute = precompute;
                    s.placement = Placement {
                        orientation: 3,
                        rotation_deg: 20.0,
                    };
                    s.environment_scale = 3.0;
                })
            };
            let found = pipeline.attributions(&request, DRAWN, &[]).unwrap();
            let steps = &found[0].steps;
            // The drawn rungs share their points; the others differ from the frames by f32 rounding
            // and by the noise of both.
            let mut frame = |name: &str| {
                let method = Method::listed(name);
                pipeline
                    .render(&request.shaded(|s| (s.method, s.samples) = (method, DRAWN)))
                    .unwrap()
            };
            let reference = frame("reference");
            // Methods that read no map give the same for every layout.
            let rung = |step: &Step| match step.name {
                "table" => Method::listed("split-sum"),
                name => Method::listed(&format!("ladder-{}", name.to_lowercase())),
            };
            let of_layout =
                |(_, step): &(usize, &Step)| *layout == LAYOUTS[0] || rung(step).uses_prefiltered();
            for (i, step) in STEPS.iter().enumerate().filter(of_layout) {
                let right = between(&frame(rung(step).name), &reference, &request);
                let mut worst = Worst::new(format!("{}, {}", step.name, layout.name), filtered);
                worst.add(steps[i].error, right, || rung(step).name.to_owned());
                worst.check();
            }
        }
    });
}

#[test]
fn rungs_of_the_map_differ_from_each_other() {
    with_pipeline(|pipeline| {
        let material = MaterialOverride {
            alpha: Some(0.12),
            ..MaterialOverride::default()
        };
        let base = request(
            &golden_environment(),
            scene("sphere", material),
            CameraKind::Ortho,
            [16, 16],
        );
        let mut frame = |name: &str, prefilter, storage| {
            let precompute = PrecomputeSettings {
                layout: &LAYOUTS[1],
                prefilter,
                storage,
                prefilter_size: [32; 2],
                prefilter_level_count: 3,
                prefilter_sample_count: 32,
                ..PrecomputeSettings::default()
            };
            let request =
                base.shaded(|s| (s.method, s.precompute) = (Method::listed(name), precompute));
            pipeline.render(&request).unwrap().radiance.data
        };
        let (sampled, harmonic) = (PrefilterBy::Sampled, PrefilterBy::Harmonic);
        let (half, full) = (StorageFormat::F16, StorageFormat::F32);
        let texels = frame("ladder-texels", sampled, half);
        let samples = frame("ladder-samples", sampled, half);
        let storage = frame("ladder-storage", sampled, half);
        assert!(texels != samples && samples != storage);
        assert_eq!(
            texels,
            frame("ladder-storage", harmonic, full),
            "exact texels in f32"
        );
        assert_eq!(
            samples,
            frame("ladder-storage", sampled, full),
            "texels of samples in f32"
        );
    });
}

#[test]
fn scrambles_equal_the_references() {
    with_pipeline(|pipeline| {
        let material = MaterialOverride {
            alpha: Some(0.2),
            ..MaterialOverride::default()
        };
        let base = request(
            &golden_environment(),
            scene("design", material),
            CameraKind::Perspective,
            [16, 16],
        );
        let request = RenderRequest {
            reference_samples: 512,
            ..base.shaded(|s| (s.method, s.samples) = (Method::listed("reference"), 512))
        };
        let frame = pipeline.render(&request).unwrap();
        let scrambles = pipeline.scrambles(&request).unwrap();
        let (count, standard_error) = (scrambles.len() as f64, frame.standard_error.unwrap());
        for (pixel, right) in frame.radiance.data.iter().enumerate() {
            let (own, error) = (
                scrambles.iter().map(|image| image[pixel].x),
                f64::from(standard_error.data[pixel][0]),
            );
            let mean = own.clone().sum::<f64>() / count;
            let spread: f64 = own.map(|x| (x - mean).powi(2)).sum();
            assert!(
                (mean / f64::from(right[0]) - 1.0).abs() < 1e-5,
                "pixel {pixel}: {mean}, not {}",
                right[0]
            );
            let own = (spread / (count * (count - 1.0))).sqrt();
            assert!(
                (own - error).abs() < 1e-3 * error + 1e-7 * mean,
                "pixel {pixel}: error {own:e}, not {error:e}"
            );
        }
    });
}
