//! The unit of radiance: brighter light changes no relative figure, printed or scored.

use crate::harness::{golden_environment, lobe_sphere, request, with_pipeline};
use splitsum::metrics::{Comparison, METRICS, noise_floor};
use splitsum::pipeline::RenderRequest;
use splitsum::scene::CameraKind;
use splitsum::shade::Method;
use splitsum::shade::reference_pass::Convergence;
use splitsum::spelling::Listed;
use splitsum::tonemap::ToneCurve;
use std::collections::BTreeMap;

/// Scores and floors of the split sum by name, and what the reference printed.
type Figures = (BTreeMap<String, f64>, Vec<Convergence>);

#[test]
fn brighter_light_changes_no_relative_figure() {
    with_pipeline(|pipeline| {
        let mut figures = |environment_scale: f32| -> Figures {
            let base = RenderRequest {
                reference_samples: 1024,
                reference_error: Some(0.012),
                ..request(&golden_environment(), lobe_sphere(0.3), CameraKind::Perspective, [24, 24])
                    .shaded(|s| s.environment_scale = environment_scale)
            };
            let method = |name| base.shaded(|s| s.method = Method::listed(name));
            let [test, truth] = ["split-sum", "reference"].map(|name| pipeline.render(&method(name)).unwrap());
            let error = truth.standard_error.as_ref().unwrap();
            let floors = noise_floor(&truth.radiance, error, &truth.mask, base.epsilon()).unwrap();
            // What the reference prints is the root of the floor of relmse: one term, whose error is the image's.
            let floor = floors.iter().find(|(name, _)| *name == "relmse").unwrap().1.unwrap();
            let [printed] = truth.convergences[..] else { panic!("{:?}", truth.convergences) };
            let ratio = printed.relative_error / floor.sqrt();
            assert!((ratio - 1.0).abs() < 1e-5, "at {environment_scale}: {printed:?} for {}", floor.sqrt());
            let curve = ToneCurve { exposure: 1.0 / environment_scale, contrast: 1.0 };
            let comparison =
                Comparison::new(&test.radiance, &truth.radiance, &truth.mask, curve, base.epsilon()).unwrap();
            let floors = floors.into_iter().filter_map(|(name, floor)| Some((format!("{name} floor"), floor?)));
            let scores = comparison.evaluate(METRICS).into_iter().map(|(name, score)| (name.to_owned(), score));
            (scores.chain(floors).collect(), truth.convergences)
        };
        let (plain, bright) = (figures(1.0), figures(1000.0));
        for (name, score) in &plain.0 {
            let has_unit = ["rmse", "mae"].contains(&name.trim_end_matches(" floor"));
            let change = (bright.0[name] / score - 1.0).abs();
            println!("{name}: {score} moves by {change:.1e}");
            assert!(if has_unit { change > 0.02 } else { change < 1e-5 }, "{name}: {score}, {}", bright.0[name]);
        }
        // It stops at the same count, too.
        let [a, b] = [&plain.1[0], &bright.1[0]];
        assert_eq!((a.sample_count, a.is_met), (b.sample_count, b.is_met));
        assert!(a.sample_count < 1024 && (a.relative_error / b.relative_error - 1.0).abs() < 1e-5, "{a:?} {b:?}");
    });
}
