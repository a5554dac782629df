//! The unit of radiance: brighter light does not change the relative error of the reference.

use crate::harness::{golden_environment, lobe_sphere, request, with_pipeline};
use splitsum::base::names::Listed;
use splitsum::instrument::metrics::noise_floor;
use splitsum::instrument::pipeline::RenderRequest;
use splitsum::instrument::scene::CameraKind;
use splitsum::instrument::shade::Method;

#[test]
fn brighter_light_does_not_change_relative_numbers() {
    with_pipeline(|pipeline| {
        let mut convergence = |environment_scale: f32| {
            let request = RenderRequest {
                reference_samples: 1024,
                reference_error: Some(0.012),
                ..request(
                    &golden_environment(),
                    lobe_sphere(0.3),
                    CameraKind::Perspective,
                    [24, 24],
                )
                .shaded(|s| {
                    (s.environment_scale, s.method) =
                        (environment_scale, Method::listed("reference"))
                })
            };
            let truth = pipeline.render(&request).unwrap();
            let error = truth.standard_error.as_ref().unwrap();
            let floors =
                noise_floor(&truth.radiance, error, &truth.mask, request.epsilon()).unwrap();
            // The printed error of the reference is the root of the noise floor of relmse: one
            // term, whose error is the image's.
            let floor = floors
                .iter()
                .find(|(name, _)| *name == "relmse")
                .unwrap()
                .1
                .unwrap();
            let [printed] = truth.convergences[..] else {
                panic!("{:?}", truth.convergences)
            };
            let ratio = printed.relative_error / floor.sqrt();
            assert!(
                (ratio - 1.0).abs() < 1e-5,
                "at {environment_scale}: {printed:?} for {}",
                floor.sqrt()
            );
            printed
        };
        // It stops at the same count, too.
        let [a, b] = [1.0, 1000.0].map(&mut convergence);
        assert_eq!((a.sample_count, a.is_met), (b.sample_count, b.is_met));
        assert!(
            a.sample_count < 1024 && (a.relative_error / b.relative_error - 1.0).abs() < 1e-5,
            "{a:?} {b:?}"
        );
    });
}
