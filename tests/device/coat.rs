//! Clear coat: exact layers against f64, renderers against closed forms, and nothing without a coat.

use crate::harness::{constant_environment, render_by_seeds, request, scene, with_pipeline};
use crate::methods::{EXACT, radiance, sights};
use crate::symmetry::smooth_environment;
use glam::{DVec2, DVec3};
use splitsum::brdf::f_schlick;
use splitsum::pipeline::RenderRequest;
use splitsum::precompute::dfg::reference::dfg;
use splitsum::precompute::exact_quadrature;
use splitsum::scene::{CameraKind, MaterialOverride};
use splitsum::shade::coat::{COAT_F0, COAT_RENDERERS, CoatLayering};
use splitsum::shade::reference::{Surface, integrate};
use splitsum::shade::{Diffuse, Method};
use splitsum::spelling::Listed;

const WEIGHT: f32 = 0.75;
const ALPHA: f32 = 0.2;

/// A brown plastic with a rough base.
fn plastic(coat: Option<f32>) -> MaterialOverride {
    MaterialOverride {
        albedo: Some([0.8, 0.4, 0.2]),
        metallic: Some(0.25),
        alpha: Some(0.5),
        f0: Some([0.04, 0.05, 0.06]),
        coat,
        coat_alpha: Some(ALPHA),
        ..MaterialOverride::default()
    }
}

fn coated(environment: &std::sync::Arc<splitsum::environment::Environment>) -> RenderRequest {
    let scene = scene("sphere", plastic(Some(WEIGHT)));
    RenderRequest { reference_samples: 16384, ..request(environment, scene, CameraKind::Ortho, [9, 9]) }
}

/// The reference under both layerings against the integrals of base and coat, within the reference's error.
#[test]
fn the_reference_of_a_coat_is_the_sum_of_its_integrals() {
    with_pipeline(|pipeline| {
        let environment = smooth_environment();
        let quadrature = exact_quadrature(&environment.image);
        for layering in CoatLayering::all() {
            let request = coated(&environment).shaded(|s| {
                s.coat_layering = *layering;
                s.method = Method::listed("reference");
                s.diffuse = Diffuse::listed("reference");
            });
            let frame = render_by_seeds(pipeline, &request);
            for sight in sights(&request, 7) {
                let base = integrate(&quadrature, &sight.surface, EXACT);
                let n_dot_v = sight.surface.n.dot(sight.surface.v);
                let of = |alpha: f64| dfg(sight.surface.model, sight.surface.masking, n_dot_v, alpha);
                let (under, over) = (of(sight.surface.alpha), of(f64::from(ALPHA)));
                let reflected = sight.surface.f0 * under.f0_scale + under.f90_scale;
                let albedo = 0.75 * sight.albedo * (DVec3::ONE - reflected);
                let lobe = Surface { alpha: ALPHA.into(), f0: DVec3::splat(COAT_F0), ..sight.surface };
                let coat = integrate(&quadrature, &lobe, EXACT);
                let fresnel = COAT_F0 + (1.0 - COAT_F0) * (1.0 - n_dot_v).powi(5);
                let (lost, coat) = match layering {
                    CoatLayering::Khr => (fresnel, fresnel * coat.specular_white.value),
                    CoatLayering::Albedo => (COAT_F0 * over.f0_scale + over.f90_scale, coat.specular.value),
                };
                let c = f64::from(WEIGHT);
                let exact = (1.0 - c * lost) * (base.specular.value + albedo * base.diffuse.value) + c * coat;
                let own = radiance(&frame, sight.pixel);
                let [x, y] = sight.pixel;
                let sigma = frame.standard_error.as_ref().unwrap().get(x, y).map(f64::from);
                let most = 5.0 * DVec3::from_array(sigma) + 3e-4 * exact;
                assert!((own - exact).abs().cmple(most).all(), "{layering:?} {:?}: {own} for {exact}", sight.pixel);
            }
        }
    });
}

/// In radiance 1 a lookup gives 1: what remains are the shares of each renderer.
#[test]
fn renderers_of_a_coat_meet_their_closed_forms_in_constant_light() {
    with_pipeline(|pipeline| {
        let white = constant_environment([1.0; 3]);
        for renderer in COAT_RENDERERS {
            let request = coated(&white).shaded(|s| {
                s.coat_renderer = renderer;
                s.diffuse = Diffuse::listed("irradiance-map");
            });
            let frame = pipeline.render(&request).unwrap();
            for sight in sights(&request, 5) {
                let n_dot_v = sight.surface.n.dot(sight.surface.v);
                let pair = |alpha: f64| {
                    let found = dfg(sight.surface.model, sight.surface.masking, n_dot_v, alpha);
                    DVec2::new(found.f0_scale, found.f90_scale)
                };
                let (under, over) = (pair(sight.surface.alpha), pair(ALPHA.into()));
                let specular = sight.surface.f0 * under.x + under.y;
                let diffuse = 0.75 * sight.albedo * (DVec3::ONE - specular);
                let fresnel = f_schlick(DVec3::splat(COAT_F0), n_dot_v).x;
                let albedo = COAT_F0 * over.x + over.y;
                let [lost, coat] = match renderer.name {
                    "exact" => [fresnel, fresnel * (over.x + over.y)],
                    "three" => [fresnel, albedo],
                    "openpbr" => [albedo, albedo],
                    _ => [fresnel, fresnel],
                };
                let left = 1.0 - f64::from(WEIGHT) * lost;
                let [of_specular, of_diffuse] = match renderer.name {
                    "bevy" => [left * left, left],
                    "unity" => [left * left, 1.0],
                    _ => [left, left],
                };
                let exact = of_specular * specular + of_diffuse * diffuse + f64::from(WEIGHT) * coat;
                let own = radiance(&frame, sight.pixel);
                assert!((own - exact).abs().max_element() < 4e-3, "{}: {own} for {exact}", renderer.name);
            }
        }
    });
}

/// A weight of 0 gives the bits of a scene that has never heard of coats, with background.
#[test]
fn a_weight_of_0_changes_no_bit() {
    with_pipeline(|pipeline| {
        let environment = smooth_environment();
        let frames = [Some(0.0), None].map(|coat| {
            let scene = scene("sphere", plastic(coat));
            let plain = request(&environment, scene, CameraKind::Perspective, [16, 16]);
            let request = RenderRequest { background: true, antialias: true, ..plain };
            pipeline.render(&request.shaded(|s| s.diffuse = Diffuse::listed("sh9"))).unwrap().radiance
        });
        assert_eq!(frames[0], frames[1]);
    });
}
