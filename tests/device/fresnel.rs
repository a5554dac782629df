//! Exact Fresnel reflectance of dielectrics: methods and reference against integrals in f64.

use crate::compensation_twins::reflectance;
use crate::harness::{
    constant_environment, golden_environment, render_by_seeds, request, scene, with_pipeline,
};
use crate::methods::{EXACT, Sight, radiance, sights};
use glam::{DVec2, DVec3};
use splitsum::base::names::Listed;
use splitsum::instrument::brdf::{Compensation, Fresnel, FresnelWeight, f0_from_ior};
use splitsum::instrument::pipeline::{PipelineError, RenderRequest};
use splitsum::instrument::precompute::dfg::reference::dfg_of;
use splitsum::instrument::precompute::exact_quadrature;
use splitsum::instrument::scene::{CameraKind, MaterialOverride};
use splitsum::instrument::shade::reference::{Surface, integrate};
use splitsum::instrument::shade::{Diffuse, Method};
use std::sync::Arc;

/// A plastic of an index under an environment.
fn plastic(
    environment: &Arc<splitsum::instrument::environment::Environment>,
    ior: f64,
) -> RenderRequest {
    let material = MaterialOverride {
        albedo: Some([0.5, 0.2, 0.1]),
        metallic: Some(0.0),
        alpha: Some(0.4),
        f0: Some([f0_from_ior(ior) as f32; 3]),
        ..MaterialOverride::default()
    };
    RenderRequest {
        reference_samples: 16384,
        ..request(
            environment,
            scene("sphere", material),
            CameraKind::Ortho,
            [9, 9],
        )
        .shaded(|s| s.fresnel = Fresnel::Exact)
    }
}

/// The surface with the exact weight of its F0.
fn exact_surface(sight: &Sight) -> Surface {
    let f0 = sight.surface.f0.x;
    Surface {
        fresnel: FresnelWeight::Dielectric { f0 },
        ..sight.surface
    }
}

/// In radiance 1 the specular term is `f0 A + B` of the exact weight, by every kind of method.
#[test]
fn methods_reflect_the_exact_albedo_of_an_index() {
    with_pipeline(|pipeline| {
        let white = constant_environment([1.0; 3]);
        for (ior, method) in [1.33, 1.5, 2.4].into_iter().flat_map(|ior| {
            ["split-sum", "sampled", "sampled-vndf", "reference"].map(|method| (ior, method))
        }) {
            let request = plastic(&white, ior).shaded(|s| {
                s.method = Method::listed(method);
                s.samples = 16384;
            });
            let frame = render_by_seeds(pipeline, &request);
            for sight in sights(&request, 5) {
                let Surface {
                    model,
                    masking,
                    alpha,
                    fresnel,
                    f0,
                    n,
                    v,
                    ..
                } = exact_surface(&sight);
                let pair = dfg_of(model, masking, fresnel, n.dot(v), alpha);
                let expected = f0.x * pair.f0_scale + pair.f90_scale;
                let found = radiance(&frame, sight.pixel).x;
                assert!(
                    (found / expected - 1.0).abs() < 4e-3,
                    "{method} {ior} {:?}: {found} for {expected}",
                    sight.pixel
                );
            }
        }
    });
}

/// In radiance 1 a compensation adds to a black dielectric what its formula says for the exact mean
/// reflectance of the index, which Schlick's misses by 7 %.
#[test]
fn compensations_have_the_mean_reflectance_of_an_index() {
    with_pipeline(|pipeline| {
        let white = constant_environment([1.0; 3]);
        let plastic = plastic(&white, 1.5);
        let black = MaterialOverride {
            albedo: Some([0.0; 3]),
            alpha: Some(0.8),
            ..MaterialOverride::default()
        };
        let black = RenderRequest {
            scene: Arc::new(plastic.scene.apply(&black)),
            ..plastic
        };
        let mean = mean_albedo(&exact_surface(&sights(&black, 1)[0]));
        // The light that is added is as small as the noise of the reference.
        for (method, diffuse, within) in
            [("split-sum", "sh9", 0.01), ("reference", "reference", 0.4)]
        {
            let plain = black.shaded(|s| {
                s.method = Method::listed(method);
                s.diffuse = Diffuse::listed(diffuse);
            });
            let single = render_by_seeds(pipeline, &plain);
            for compensation in [
                Compensation::FdezAguera,
                Compensation::KullaConty,
                Compensation::Cycles,
            ] {
                let request = plain.shaded(|s| s.compensation = compensation);
                let frame = render_by_seeds(pipeline, &request);
                for sight in sights(&request, 5) {
                    let surface = exact_surface(&sight);
                    let [found, before] =
                        [&frame, &single].map(|frame| radiance(frame, sight.pixel).x);
                    let pair = pair(&surface, surface.n.dot(surface.v));
                    let added = |fresnel| {
                        let all = reflectance(compensation, fresnel, surface.f0, pair, mean).x;
                        all - surface.f0.x * pair.x - pair.y
                    };
                    let expected = added(surface.fresnel);
                    let name = format!("{compensation:?} {method} {:?}", sight.pixel);
                    assert!(
                        (found - before - expected).abs() < within * expected,
                        "{name}: {} for {expected}",
                        found - before
                    );
                    let of_schlick = added(FresnelWeight::Schlick);
                    assert!(of_schlick < 0.95 * expected, "{name}: {of_schlick}");
                }
            }
        }
    });
}

/// Returns A and B of a surface's lobe at a cosine.
fn pair(surface: &Surface, cosine: f64) -> DVec2 {
    let Surface {
        model,
        masking,
        alpha,
        fresnel,
        ..
    } = *surface;
    let pair = dfg_of(model, masking, fresnel, cosine, alpha);
    DVec2::new(pair.f0_scale, pair.f90_scale)
}

/// Returns the mean albedo of a surface's lobe for F = 1.
fn mean_albedo(surface: &Surface) -> f64 {
    const NODES: u32 = 64;
    let term = |i: u32| {
        let cosine = (f64::from(i) + 0.5) / f64::from(NODES);
        2.0 * cosine * pair(surface, cosine).element_sum()
    };
    (0..NODES).map(term).sum::<f64>() / f64::from(NODES)
}

/// The reference's specular term and the diffuse term with Fresnel inside, against f64.
#[test]
fn references_of_an_index_are_its_integrals() {
    with_pipeline(|pipeline| {
        let environment = golden_environment();
        let quadrature = exact_quadrature(&environment.image);
        let specular =
            plastic(&environment, 1.5).shaded(|s| s.method = Method::listed("reference"));
        let both = specular.shaded(|s| s.diffuse = Diffuse::listed("fresnel-inside"));
        let [specular_frame, both_frame] =
            [&specular, &both].map(|request| render_by_seeds(pipeline, request));
        for sight in sights(&specular, 11) {
            let answer = integrate(&quadrature, &exact_surface(&sight), EXACT);
            let diffuse = sight.albedo * answer.diffuse_transmitted.value;
            for (frame, expected) in [
                (&specular_frame, answer.specular.value),
                (&both_frame, answer.specular.value + diffuse),
            ] {
                let [x, y] = sight.pixel;
                let error = frame.standard_error.as_ref().unwrap().get(x, y);
                let most = 5.0 * DVec3::from_array(error.map(f64::from)) + 3e-4 * expected;
                let found = radiance(frame, sight.pixel);
                assert!(
                    (found - expected).abs().cmple(most).all(),
                    "{:?}: {found} for {expected}",
                    sight.pixel
                );
                assert!(
                    most.max_element() < 0.04 * expected.max_element(),
                    "{most} of {expected} says nothing"
                );
            }
        }
    });
}

/// Metals, and dielectrics of several F0, have no one index.
#[test]
fn surfaces_without_one_index_are_refused() {
    with_pipeline(|pipeline| {
        let white = constant_environment([1.0; 3]);
        let plain = plastic(&white, 1.5);
        for values in [
            MaterialOverride {
                metallic: Some(1.0),
                ..MaterialOverride::default()
            },
            MaterialOverride {
                f0: Some([0.04, 0.05, 0.04]),
                ..MaterialOverride::default()
            },
        ] {
            let request = RenderRequest {
                scene: Arc::new(plain.scene.apply(&values)),
                ..plain.clone()
            };
            let refused = pipeline.render(&request).unwrap_err();
            assert!(
                matches!(refused, PipelineError::Fresnel(_)) && refused.is_input(),
                "{refused}"
            );
        }
    });
}
