//! Sheen and coats: the reference against f64, lookups against twins and closed forms, and nothing
//! without layers.

use crate::harness::{constant_environment, render_by_seeds, request, scene, with_pipeline};
use crate::methods::{EXACT, radiance, sights};
use crate::symmetry::smooth_environment;
use glam::{DVec2, DVec3};
use splitsum::base::names::Listed;
use splitsum::instrument::brdf::{MaskingShadowing, SheenVisibility, f_schlick};
use splitsum::instrument::environment::Environment;
use splitsum::instrument::pipeline::RenderRequest;
use splitsum::instrument::precompute::dfg::reference::dfg;
use splitsum::instrument::precompute::exact_quadrature;
use splitsum::instrument::precompute::irradiance::reference::irradiance;
use splitsum::instrument::precompute::prefilter::{Kernel, reference::prefilter};
use splitsum::instrument::scene::{CameraKind, MaterialOverride};
use splitsum::instrument::shade::coat::{COAT_F0, COAT_RENDERERS, CoatLayering};
use splitsum::instrument::shade::reference::{Surface, integrate, specular};
use splitsum::instrument::shade::sheen::{SHEEN_LOOKUPS, SheenMap, shares};
use splitsum::instrument::shade::{Diffuse, Method};
use std::f64::consts::PI;
use std::sync::Arc;

const COLOR: [f32; 3] = [0.9, 0.5, 0.25];
const ALPHA: f32 = 0.25;
const COAT_ALPHA: f32 = 0.2;
const CORRELATED: MaskingShadowing = MaskingShadowing::Correlated;

fn cloth(
    environment: &Arc<Environment>,
    sheen: Option<[f32; 3]>,
    coat: Option<f32>,
) -> RenderRequest {
    let material = MaterialOverride {
        albedo: Some([0.8, 0.4, 0.2]),
        metallic: Some(0.25),
        alpha: Some(0.5),
        f0: Some([0.04, 0.05, 0.06]),
        coat,
        coat_alpha: Some(COAT_ALPHA),
        sheen_color: sheen,
        sheen_alpha: Some(ALPHA),
        ..MaterialOverride::default()
    };
    let plain = request(
        environment,
        scene("sphere", material),
        CameraKind::Ortho,
        [9, 9],
    );
    RenderRequest {
        reference_samples: 16384,
        ..plain
    }
}

/// The reference of both visibilities, each under a coat of another layering, against the integrals
/// of all layers.
#[test]
fn the_reference_of_layers_is_the_sum_of_their_integrals() {
    with_pipeline(|pipeline| {
        let color = DVec3::from_array(COLOR.map(f64::from));
        for (visibility, layering) in SheenVisibility::all().zip(CoatLayering::all()) {
            let request = cloth(&smooth_environment(), Some(COLOR), Some(0.75)).shaded(|s| {
                (s.sheen_visibility, s.coat_layering) = (*visibility, *layering);
                (s.method, s.diffuse) = (Method::listed("reference"), Diffuse::listed("reference"));
            });
            let quadrature = exact_quadrature(&request.environment.image);
            let frame = render_by_seeds(pipeline, &request);
            for sight in sights(&request, 7) {
                let Surface {
                    model,
                    masking,
                    n,
                    v,
                    alpha,
                    f0,
                    ..
                } = sight.surface;
                let of = |alpha: f64| dfg(model, masking, n.dot(v), alpha);
                let base = integrate(&quadrature, &sight.surface, EXACT);
                let diffuse = 0.75
                    * sight.albedo
                    * (DVec3::ONE - f0 * of(alpha).f0_scale - of(alpha).f90_scale);
                let base = base.specular.value + diffuse * base.diffuse.value;
                let lobe = Surface::new(visibility, CORRELATED, ALPHA.into(), DVec3::ONE, [n, v]);
                let sheen = specular(&quadrature, &lobe, EXACT)
                    .combine([DVec3::ONE, DVec3::ZERO])
                    .value;
                let albedo = dfg(visibility, CORRELATED, n.dot(v), ALPHA.into()).albedo();
                let cloth = color * sheen + (1.0 - color.x * albedo).max(0.0) * base;
                let over = Surface::new(
                    model,
                    masking,
                    COAT_ALPHA.into(),
                    DVec3::splat(COAT_F0),
                    [n, v],
                );
                let over = integrate(&quadrature, &over, EXACT);
                let (fresnel, pair) = (
                    f_schlick(DVec3::splat(COAT_F0), n.dot(v)).x,
                    of(COAT_ALPHA.into()),
                );
                let (lost, coat) = match layering {
                    CoatLayering::Khr => (fresnel, fresnel * over.specular_white.value),
                    CoatLayering::Albedo => (
                        COAT_F0 * pair.f0_scale + pair.f90_scale,
                        over.specular.value,
                    ),
                };
                let exact = (1.0 - 0.75 * lost) * cloth + 0.75 * coat;
                let [x, y] = sight.pixel;
                let sigma = frame
                    .standard_error
                    .as_ref()
                    .unwrap()
                    .get(x, y)
                    .map(f64::from);
                let most = 5.0 * DVec3::from_array(sigma) + 3e-4 * exact;
                let own = radiance(&frame, sight.pixel);
                assert!(
                    (own - exact).abs().cmple(most).all(),
                    "{visibility:?} {:?}: {own} for {exact}",
                    sight.pixel
                );
                assert!(
                    most.max_element() < 0.02 * exact.max_element(),
                    "{most} of {exact}"
                );
            }
        }
    });
}

/// Each lookup against exact means of its kernel along its direction, over the frame without sheen.
#[test]
fn lookups_of_sheen_are_means_along_their_directions() {
    with_pipeline(|pipeline| {
        let color = DVec3::from_array(COLOR.map(f64::from));
        let base = pipeline
            .render(&cloth(&smooth_environment(), None, None))
            .unwrap();
        for lookup in SHEEN_LOOKUPS {
            let request =
                cloth(&smooth_environment(), Some(COLOR), None).shaded(|s| s.sheen_lookup = lookup);
            let quadrature = exact_quadrature(&request.environment.image);
            let frame = pipeline.render(&request).unwrap();
            for sight in sights(&request, 5) {
                let Surface { model, n, v, .. } = sight.surface;
                let tap = lookup.tap([n, v], ALPHA.into());
                let mean =
                    |kernel| prefilter(&quadrature, kernel, tap.alpha, tap.direction, EXACT).value;
                let mean = match lookup.map {
                    SheenMap::Levels => mean(Kernel::cosine(model)),
                    SheenMap::Charlie => mean(Kernel::cosine(&SheenVisibility::Charlie)),
                    SheenMap::Irradiance => irradiance(&quadrature, n, EXACT).value / PI,
                };
                let albedo = dfg(
                    &SheenVisibility::Charlie,
                    CORRELATED,
                    n.dot(v),
                    ALPHA.into(),
                )
                .albedo();
                let shares = shares(Some(lookup), color, ALPHA.into(), n.dot(v), albedo);
                let exact = shares.base * radiance(&base, sight.pixel) + shares.sheen * mean;
                let (own, off) = (
                    radiance(&frame, sight.pixel),
                    (radiance(&frame, sight.pixel) - exact).abs().max_element(),
                );
                // The roughest level has 8 x 8 texels.
                assert!(
                    off < 5e-3 * exact.max_element(),
                    "{} {:?}: {own} for {exact}",
                    lookup.name,
                    sight.pixel
                );
            }
        }
    });
}

/// A black sheen and a coat of weight 0 give the bits of a scene that has never heard of layers,
/// with background.
#[test]
fn layers_without_weight_change_no_bit() {
    with_pipeline(|pipeline| {
        let frames = [(Some([0.0; 3]), Some(0.0)), (None, None)].map(|(sheen, coat)| {
            let plain = cloth(&smooth_environment(), sheen, coat)
                .shaded(|s| s.diffuse = Diffuse::listed("sh9"));
            pipeline
                .render(&RenderRequest {
                    background: true,
                    antialias: true,
                    ..plain
                })
                .unwrap()
                .radiance
        });
        assert_eq!(frames[0], frames[1]);
    });
}

/// F0 and alpha of a base of `f0` and `alpha` under a coat of weight 0.75 and width `coat_alpha`, as
/// each renderer's source computes them.
fn below_coat(renderer: &str, f0: DVec3, alpha: f64, coat_alpha: f64) -> (DVec3, f64) {
    const WEIGHT: f64 = 0.75;
    let mixed = |lowered: DVec3| f0.lerp(lowered.clamp(DVec3::ZERO, DVec3::ONE), WEIGHT);
    let of_filament = f0 * (f0 * (0.941892 - 0.263008 * f0) + 0.346479) - 0.0285998;
    let of_unity = -0.0256868 + f0 * (0.326846 + (0.978946 - 0.283835 * f0) * f0);
    match renderer {
        "filament" => {
            let rougher = alpha.sqrt().max(coat_alpha.sqrt());
            let roughness = alpha.sqrt() * (1.0 - WEIGHT) + rougher * WEIGHT;
            (mixed(of_filament), roughness * roughness)
        }
        "babylon" => (mixed(of_filament), alpha),
        "unity" => {
            let eta = 1.0 - WEIGHT + WEIGHT / 1.5;
            let variance = (2.0 / (alpha * alpha) - 2.0) * eta * eta;
            (mixed(of_unity), (2.0 / (variance + 2.0)).sqrt())
        }
        _ => (f0, alpha),
    }
}

/// In radiance 1 a lookup gives 1: what remains are the shares of each renderer, and what it changes
/// in the base. The coat is smoother than the base, then rougher.
#[test]
fn renderers_of_a_coat_meet_their_closed_forms_in_constant_light() {
    with_pipeline(|pipeline| {
        let white = constant_environment([1.0; 3]);
        let cases = [COAT_ALPHA, 0.7].into_iter().flat_map(|coat_alpha| {
            COAT_RENDERERS
                .iter()
                .map(move |renderer| (coat_alpha, renderer))
        });
        for (coat_alpha, renderer) in cases {
            let coated = cloth(&white, None, Some(0.75)).shaded(|s| {
                s.coat_renderer = renderer;
                s.diffuse = Diffuse::listed("irradiance-map");
            });
            let rough = MaterialOverride {
                coat_alpha: Some(coat_alpha),
                ..MaterialOverride::default()
            };
            let request = RenderRequest {
                scene: Arc::new(coated.scene.apply(&rough)),
                ..coated
            };
            let coat_alpha = f64::from(coat_alpha);
            let frame = pipeline.render(&request).unwrap();
            for sight in sights(&request, 5) {
                let n_dot_v = sight.surface.n.dot(sight.surface.v);
                let pair = |alpha: f64| {
                    let found = dfg(sight.surface.model, sight.surface.masking, n_dot_v, alpha);
                    DVec2::new(found.f0_scale, found.f90_scale)
                };
                let Surface { f0, alpha, .. } = sight.surface;
                let (f0, alpha) = below_coat(renderer.name, f0, alpha, coat_alpha);
                let (under, over) = (pair(alpha), pair(coat_alpha));
                let specular = f0 * under.x + under.y;
                let diffuse = 0.75 * sight.albedo * (DVec3::ONE - specular);
                let fresnel = f_schlick(DVec3::splat(COAT_F0), n_dot_v).x;
                let albedo = COAT_F0 * over.x + over.y;
                let [lost, coat] = match renderer.name {
                    "exact" => [fresnel, fresnel * (over.x + over.y)],
                    "three" | "babylon" => [fresnel, albedo],
                    "openpbr" => [albedo, albedo],
                    "vtk" => [fresnel, fresnel * albedo],
                    _ => [fresnel, fresnel],
                };
                let left = 1.0 - 0.75 * lost;
                let [of_specular, of_diffuse] = match renderer.name {
                    "bevy" => [left * left, left],
                    "unity" => [left * left, 1.0],
                    "vtk" => [1.0, 1.0],
                    _ => [left, left],
                };
                let exact = of_specular * specular + of_diffuse * diffuse + 0.75 * coat;
                let own = radiance(&frame, sight.pixel);
                assert!(
                    (own - exact).abs().max_element() < 4e-3,
                    "{}: {own} for {exact}",
                    renderer.name
                );
            }
        }
    });
}
