//! Ambient occlusion: the factors of both terms, for methods and the reference, and no change of a
//! bit by a map that occludes nothing.

use crate::gltf_files::{load, mesh, png, textured};
use crate::harness::{request, with_pipeline};
use crate::symmetry::smooth_environment;
use glam::DVec3;
use serde_json::json;
use splitsum::base::glsl::constants::COSINE_MIN;
use splitsum::base::names::Listed;
use splitsum::base::pixels::RgbImage;
use splitsum::instrument::pipeline::{Pipeline, RenderRequest};
use splitsum::instrument::scene::{CameraKind, Light, Scene};
use splitsum::instrument::shade::occlusion::SpecularOcclusion;
use splitsum::instrument::shade::{Diffuse, Method};

/// A square with a coat and a sheen, perhaps under a map of one texel.
fn square(occlusion: Option<u8>, layers: bool) -> Scene {
    let positions = [-1., 1., 0., -1., -1., 0., 1., -1., 0., 1., 1., 0.];
    let normals = [0., 0., 1.].repeat(4);
    let uvs = [0., 0., 0., 1., 1., 1., 1., 0.];
    let attributes = [
        ("POSITION", 3, &positions[..]),
        ("NORMAL", 3, &normals),
        ("TEXCOORD_0", 2, &uvs),
    ];
    let mut material = json!({
        "doubleSided": true,
        "emissiveFactor": [0.0, 0.0, 0.0],
        "pbrMetallicRoughness": { "metallicFactor": 0.25, "roughnessFactor": 0.6 },
    });
    if layers {
        material["emissiveFactor"] = json!([0.5, 0.25, 0.0]);
        material["extensions"] = json!({
            "KHR_materials_clearcoat": { "clearcoatFactor": 0.5, "clearcoatRoughnessFactor": 0.3 },
            "KHR_materials_sheen": { "sheenColorFactor": [0.4, 0.2, 0.1], "sheenRoughnessFactor": 0.7 },
            "KHR_materials_specular": { "specularFactor": 0.5 },
        });
    }
    if occlusion.is_some() {
        material["occlusionTexture"] = json!({ "index": 0 });
    }
    let map = png(1, 1, |_, _| [occlusion.unwrap_or(0), 0, 0]);
    load(&textured(
        mesh(&attributes, &[0, 1, 2, 0, 2, 3]),
        material,
        &[map],
    ))
    .expect("a readable file")
}

fn view(scene: Scene, kind: SpecularOcclusion, terms: [&str; 2]) -> RenderRequest {
    let plain = request(
        &smooth_environment(),
        scene,
        CameraKind::Perspective,
        [7, 7],
    );
    RenderRequest {
        reference_samples: 256,
        background: true,
        ..plain
    }
    .shaded(|s| {
        s.method = Method::listed(terms[0]);
        s.diffuse = Diffuse::listed(terms[1]);
        s.specular_occlusion = kind;
    })
}

const TERMS: [[&str; 2]; 4] = [
    ["split-sum", "sh9"],
    ["sampled", "none"],
    ["none", "sh9"],
    ["reference", "reference"],
];

#[test]
fn a_white_map_changes_no_bit() {
    with_pipeline(|pipeline| {
        for kind in SpecularOcclusion::all() {
            for terms in TERMS {
                let [plain, mapped] = [None, Some(255)].map(|map| {
                    pipeline
                        .render(&view(square(map, true), *kind, terms))
                        .unwrap()
                });
                assert_eq!(plain.radiance, mapped.radiance, "{kind:?} {terms:?}");
                assert_eq!(
                    plain.standard_error, mapped.standard_error,
                    "{kind:?} {terms:?}"
                );
            }
        }
    });
}

fn radiance(pipeline: &mut Pipeline, request: &RenderRequest) -> RgbImage {
    pipeline.render(request).unwrap().radiance
}

/// Without layers an image is the factor times each term, for every method; the background stays.
#[test]
fn each_term_has_its_factor() {
    const CODE: u8 = 102;
    with_pipeline(|pipeline| {
        let occlusion = f64::from(CODE) / 255.0;
        let alpha = 0.36;
        for kind in SpecularOcclusion::all() {
            for [specular, diffuse] in TERMS {
                let plain = |terms| view(square(None, false), *kind, terms);
                let whole = plain([specular, diffuse]);
                let frame = pipeline.render(&whole).unwrap();
                let specular_alone = radiance(pipeline, &plain([specular, "none"]));
                let occluded = view(square(Some(CODE), false), *kind, [specular, diffuse]);
                let occluded = radiance(pipeline, &occluded);
                for (pixel, found) in occluded.data.iter().enumerate() {
                    let n_dot_v = f64::from(frame.n_dot_v.data[pixel].max(COSINE_MIN)).min(1.0);
                    let is_hit = frame.mask.data[pixel] == 1.0;
                    for (c, found) in found.iter().enumerate() {
                        let all = f64::from(frame.radiance.data[pixel][c]);
                        let specular = f64::from(specular_alone.data[pixel][c]);
                        let expected = if is_hit {
                            occlusion * (all - specular)
                                + kind.factor(occlusion, n_dot_v, alpha) * specular
                        } else {
                            all
                        };
                        assert!(
                            (f64::from(*found) - expected).abs() <= 1e-6 * all,
                            "{kind:?}, pixel {pixel}: {found} instead of {expected}"
                        );
                    }
                }
            }
        }
    });
}

/// Occlusion does not dim emission.
#[test]
fn emission_and_black_maps() {
    with_pipeline(|pipeline| {
        let request = view(
            square(Some(0), true),
            SpecularOcclusion::Ao,
            ["split-sum", "sh9"],
        );
        let frame = pipeline.render(&request).unwrap();
        let lit: Vec<_> = (0..frame.radiance.data.len())
            .filter(|pixel| frame.mask.data[*pixel] == 1.0)
            .map(|pixel| frame.radiance.data[pixel])
            .collect();
        assert!(!lit.is_empty());
        // Under the coat.
        for [r, g, b] in lit {
            assert!(
                r > 0.4 && (r / g - 2.0).abs() < 1e-5 && b == 0.0,
                "{r} {g} {b}"
            );
        }
    });
}

/// A map is about the surroundings: direct lights keep their light, of all layers.
#[test]
fn maps_do_not_dim_direct_lights() {
    let sun = Light::directional(DVec3::new(-0.3, -0.4, -1.0).normalize(), [3.0, 2.0, 1.0]);
    let terms = ["split-sum", "sh9"];
    with_pipeline(|pipeline| {
        for kind in SpecularOcclusion::all() {
            let [open, occluded] = [None, Some(51)].map(|map| {
                let [dark, lit] = [vec![], vec![sun]].map(|lights| {
                    let scene = square(map, true).lit_by(lights);
                    radiance(pipeline, &view(scene, *kind, terms))
                });
                lit.data
                    .iter()
                    .zip(&dark.data)
                    .map(|(lit, dark)| lit[1] - dark[1])
                    .collect::<Vec<f32>>()
            });
            assert!(open.iter().any(|light| *light > 0.1));
            for (open, occluded) in open.iter().zip(occluded) {
                assert!((open - occluded).abs() < 1e-5, "{open} and {occluded}");
            }
        }
    });
}
