//! Pictures that stay on the device: their radiance is what the host puts together, and nothing of
//! it is read back.

use crate::compare::{Tolerance, Worst};
use crate::gltf_files::{load, mesh, png, textured};
use crate::harness::{request, scene, with_gpu, with_pipeline};
use crate::symmetry::smooth_environment;
use glam::DVec3;
use serde_json::json;
use splitsum::base::names::Listed;
use splitsum::instrument::brdf::SheenVisibility;
use splitsum::instrument::gpu::Gpu;
use splitsum::instrument::pipeline::{Pipeline, RenderRequest};
use splitsum::instrument::scene::{Camera, CameraKind, Light, MaterialOverride, Scene};
use splitsum::instrument::shade::coat::{COAT_RENDERERS, CoatLayering};
use splitsum::instrument::shade::occlusion::SpecularOcclusion;
use splitsum::instrument::shade::sheen::SHEEN_LOOKUPS;
use splitsum::instrument::shade::{Diffuse, Method};
use splitsum::instrument::tonemap::ToneCurve;

/// The device adds in f32 what the host adds in f64. Shares of layers lose digits where a cosine is
/// near 0 and where terms cancel.
const ROUNDING: Tolerance = Tolerance {
    relative: 3e-6,
    floor: 1e-7,
};

fn view(scene: Scene) -> RenderRequest {
    let environment = smooth_environment();
    let plain = request(&environment, scene, CameraKind::Perspective, [13, 11]);
    RenderRequest {
        background: true,
        reference_samples: 16,
        ..plain
    }
    .shaded(|s| (s.method, s.diffuse) = (Method::listed("split-sum"), Diffuse::listed("sh9")))
}

fn sphere(coat: Option<f32>, sheen: Option<[f32; 3]>) -> Scene {
    let material = MaterialOverride {
        albedo: Some([0.8, 0.4, 0.2]),
        metallic: Some(0.25),
        alpha: Some(0.36),
        coat,
        coat_alpha: Some(0.16),
        sheen_color: sheen,
        sheen_alpha: Some(0.3),
        ..MaterialOverride::default()
    };
    scene("sphere", material)
}

const CLOTH: [f32; 3] = [0.9, 0.5, 0.25];

/// A square with every layer and a map of each, whose texels differ.
fn square() -> Scene {
    let positions = [-1., 1., 0., -1., -1., 0., 1., -1., 0., 1., 1., 0.];
    // Outwards, so that the view reaches grazing angles.
    let normals = [-1., 1., 0.2, -1., -1., 0.2, 1., -1., 0.2, 1., 1., 0.2];
    let uvs = [0., 0., 0., 1., 1., 1., 1., 0.];
    let attributes = [
        ("POSITION", 3, &positions[..]),
        ("NORMAL", 3, &normals),
        ("TEXCOORD_0", 2, &uvs),
    ];
    let map = |index: u32| json!({ "index": index });
    let material = json!({
        "doubleSided": true,
        "emissiveFactor": [0.5, 0.25, 0.1],
        "emissiveTexture": map(0),
        "occlusionTexture": map(0),
        "pbrMetallicRoughness": { "metallicFactor": 0.25, "roughnessFactor": 0.6 },
        "extensions": {
            "KHR_materials_clearcoat": {
                "clearcoatFactor": 0.75,
                "clearcoatTexture": map(0),
                "clearcoatRoughnessFactor": 0.9,
                "clearcoatRoughnessTexture": map(1),
            },
            "KHR_materials_sheen": {
                "sheenColorFactor": CLOTH,
                "sheenColorTexture": map(0),
                "sheenRoughnessFactor": 0.8,
                "sheenRoughnessTexture": map(1),
            },
            "KHR_materials_specular": { "specularFactor": 0.5, "specularTexture": map(1) },
        },
    });
    let weights = png(4, 4, |x, y| [(50 + 60 * x) as u8, (40 + 50 * y) as u8, 200]);
    let roughness = png(4, 4, |x, y| [90, (150 + 10 * x + 12 * y) as u8, 90]);
    load(&textured(
        mesh(&attributes, &[0, 1, 2, 0, 2, 3]),
        material,
        &[weights, roughness],
    ))
    .expect("a readable file")
}

fn sun() -> Light {
    Light::directional(DVec3::new(-0.5, -0.7, -0.6).normalize(), [3.0, 2.0, 1.0])
}

/// Compares the device's radiance with the host's.
fn assert_equal(pipeline: &mut Pipeline, gpu: &Gpu, name: &str, request: &RenderRequest) {
    let expected = pipeline.render(request).unwrap();
    let found = pipeline.radiance_on_device(request).unwrap();
    let found: Vec<[f32; 4]> = gpu
        .read_buffer(&found.expect("a picture").radiance)
        .unwrap();
    let mut worst = Worst::new(name, ROUNDING);
    assert!(expected.mask.data.contains(&1.0), "{name}: nothing is hit");
    for (pixel, expected) in expected.radiance.data.iter().enumerate() {
        for c in 0..3 {
            worst.add(found[pixel][c].into(), expected[c].into(), || {
                format!("channel {c} of pixel {pixel}")
            });
        }
    }
    worst.check();
}

fn with_both(test: impl FnOnce(&mut Pipeline, &Gpu)) {
    with_gpu(|gpu| with_pipeline(|pipeline| test(pipeline, gpu)));
}

#[test]
fn coats_on_the_device() {
    with_both(|pipeline, gpu| {
        for renderer in COAT_RENDERERS {
            for layering in CoatLayering::all() {
                for background in [false, true] {
                    let request = RenderRequest {
                        background,
                        ..view(sphere(Some(0.75), None))
                    };
                    let request = request.shaded(|s| {
                        (s.coat_renderer, s.coat_layering) = (renderer, *layering);
                    });
                    let name = format!("{} {layering:?}", renderer.name);
                    assert_equal(pipeline, gpu, &name, &request);
                }
            }
        }
    });
}

#[test]
fn sheens_on_the_device() {
    with_both(|pipeline, gpu| {
        for visibility in SheenVisibility::all() {
            for lookup in SHEEN_LOOKUPS {
                for color in [CLOTH, [1.0; 3]] {
                    let request = view(sphere(None, Some(color))).shaded(|s| {
                        (s.sheen_visibility, s.sheen_lookup) = (*visibility, lookup);
                    });
                    let name = format!("{visibility:?} {}", lookup.name);
                    assert_equal(pipeline, gpu, &name, &request);
                }
            }
            // Without a lookup.
            let request = view(sphere(None, Some(CLOTH))).shaded(|s| {
                s.sheen_visibility = *visibility;
                s.method = Method::listed("reference");
            });
            assert_equal(pipeline, gpu, &format!("{visibility:?} exact"), &request);
        }
    });
}

/// All layers with maps, occlusion of every kind, and direct lights.
#[test]
fn layers_with_maps_on_the_device() {
    let terms = [
        ["split-sum", "sh9"],
        ["sampled", "none"],
        ["none", "sh9"],
        ["reference", "reference"],
    ];
    with_both(|pipeline, gpu| {
        for (kind, [method, diffuse]) in SpecularOcclusion::all()
            .zip(terms)
            .chain(SpecularOcclusion::all().map(|kind| (kind, ["split-sum", "irradiance-map"])))
        {
            for lights in [vec![], vec![sun()]] {
                let name = format!("{kind:?} {method} {diffuse}, {} lights", lights.len());
                let request = view(square().lit_by(lights)).shaded(|s| {
                    (s.method, s.diffuse) = (Method::listed(method), Diffuse::listed(diffuse));
                    s.specular_occlusion = *kind;
                    // Terms lose unequal parts.
                    s.coat_renderer = &COAT_RENDERERS[4];
                });
                assert_equal(pipeline, gpu, &name, &request);
            }
        }
    });
}

/// A turned camera needs new g-buffers and shares, but no read; the host's image needs some.
#[test]
fn nothing_of_a_picture_is_read_back() {
    with_both(|pipeline, gpu| {
        let request = view(square().lit_by(vec![sun()]));
        let curve = ToneCurve::default();
        pipeline.picture_on_device(&request, curve).unwrap();
        let turned = RenderRequest {
            camera: Camera::for_scene(CameraKind::Ortho, &request.scene, request.size),
            ..request
        };
        let before = gpu.read_count();
        let picture = pipeline.picture_on_device(&turned, curve).unwrap();
        assert!(!picture.expect("a picture").has_made_table);
        assert_eq!(gpu.read_count(), before);
        pipeline.render(&turned).unwrap();
        assert!(gpu.read_count() > before);
    });
}
