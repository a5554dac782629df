//! glTF's mixture of a dielectric and a metal against its definition.

use crate::harness::{golden_environment, request, scene, with_pipeline};
use glam::DVec3;
use splitsum::base::names::Listed;
use splitsum::instrument::brdf::Compensation;
use splitsum::instrument::pipeline::{PipelineError, RenderRequest};
use splitsum::instrument::scene::{CameraKind, Light, MaterialOverride};
use splitsum::instrument::shade::metallic::MetallicMix;
use splitsum::instrument::shade::{Diffuse, Method};
use std::sync::Arc;

/// A coloured surface under an image and a light.
fn surface(metallic: f32, mix: MetallicMix) -> RenderRequest {
    let material = MaterialOverride {
        albedo: Some([0.9, 0.5, 0.1]),
        metallic: Some(metallic),
        alpha: Some(0.3),
        f0: Some([0.04, 0.1, 0.2]),
        ..MaterialOverride::default()
    };
    let key = Light::directional(DVec3::new(-0.3, -1.0, -0.8).normalize(), [2.0; 3]);
    RenderRequest {
        reference_samples: 256,
        ..request(
            &golden_environment(),
            scene("sphere", material).lit_by(vec![key]),
            CameraKind::Perspective,
            [12; 2],
        )
        .shaded(|s| s.metallic_mix = mix)
    }
}

/// `mix(dielectric_brdf, metal_brdf, metallic)` of whole images, by every kind of both terms. Their
/// points do not depend on the material, so noise is mixed, too.
#[test]
fn an_image_of_the_mixture_is_the_mixture_of_two_images() {
    const METALLIC: f32 = 0.375;
    // Roundings of a few sums in f32.
    const F32: f64 = 2e-5;
    with_pipeline(|pipeline| {
        for (method, diffuse) in [
            ("split-sum", "sh9"),
            ("sampled-vndf", "fresnel-inside"),
            ("sampled", "reference"),
            ("reference", "irradiance-map"),
            ("reference", "reference"),
        ] {
            let mut image = |metallic: f32, mix: MetallicMix| {
                let request = surface(metallic, mix).shaded(|s| {
                    (s.method, s.diffuse) = (Method::listed(method), Diffuse::listed(diffuse))
                });
                let frame = pipeline.render(&request).unwrap();
                let texel = |texel: &[f32; 3]| DVec3::from_array(texel.map(f64::from));
                frame.radiance.data.iter().map(texel).collect::<Vec<_>>()
            };
            let [dielectric, metal] = [0.0, 1.0].map(|metallic| {
                let of_brdf = image(metallic, MetallicMix::Brdf);
                assert_eq!(of_brdf, image(metallic, MetallicMix::F0), "{metallic}");
                of_brdf
            });
            let mixed = image(METALLIC, MetallicMix::Brdf);
            let one_lobe = image(METALLIC, MetallicMix::F0);
            let mut largest_loss = 0.0_f64;
            for (i, mixed) in mixed.iter().enumerate() {
                let expected = dielectric[i].lerp(metal[i], METALLIC.into());
                let off = (*mixed - expected).abs();
                let case = format!("{method} {diffuse} {i}: {mixed} for {expected}");
                assert!(off.cmple(F32 * expected.abs() + 1e-6).all(), "{case}");
                let loss = 1.0 - one_lobe[i] / expected.max(DVec3::splat(1e-6));
                largest_loss = largest_loss.max(loss.max_element());
            }
            assert!(largest_loss > 0.1, "{method} {diffuse}: {largest_loss}");
        }
    });
}

/// A compensated specular term is not linear in F0.
#[test]
fn mixtures_of_other_terms_are_refused() {
    with_pipeline(|pipeline| {
        let plain = surface(0.5, MetallicMix::Brdf);
        let compensated = plain.shaded(|s| s.compensation = Compensation::Turquin);
        let coat = MaterialOverride {
            coat: Some(1.0),
            ..MaterialOverride::default()
        };
        let coated = |renderer: &str| {
            RenderRequest {
                scene: Arc::new(plain.scene.apply(&coat)),
                ..plain.clone()
            }
            .shaded(|s| s.coat_renderer = Listed::listed(renderer))
        };
        pipeline.render(&coated("exact")).unwrap();
        for request in [compensated, coated("filament")] {
            let refused = pipeline.render(&request).unwrap_err();
            assert!(
                matches!(refused, PipelineError::MetallicMix(_)) && refused.is_input(),
                "{refused}"
            );
        }
    });
}
