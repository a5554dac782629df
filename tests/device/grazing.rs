//! Surfaces whose normals lean away from the viewer, and tangents without a direction.

use crate::gbuffer::draw;
use crate::gltf_files::{load, mesh};
use crate::harness::{constant_environment, golden_environment, request, with_gpu, with_pipeline};
use crate::symmetry::smooth_environment;
use glam::DVec3;
use serde_json::{Value, json};
use splitsum::base::names::Listed;
use splitsum::instrument::pipeline::{Pipeline, RenderRequest};
use splitsum::instrument::scene::{Camera, CameraKind, Scene};
use splitsum::instrument::shade::{Diffuse, METHODS, Method};

const SIZE: [u32; 2] = [6, 6];

fn loaded(model: &Value) -> Scene {
    load(model).expect("a readable file")
}

/// The square [-1, 1]² of the plane z = 0 with one normal and perhaps one tangent, of a metal.
fn quad(normal: DVec3, tangent: Option<[f32; 4]>) -> Value {
    let positions = [-1., -1., 0., 1., -1., 0., 1., 1., 0., -1., 1., 0.];
    let normals = normal.as_vec3().to_array().repeat(4);
    let tangents = tangent.unwrap_or_default().repeat(4);
    let mut attributes = vec![("POSITION", 3, &positions[..]), ("NORMAL", 3, &normals[..])];
    if tangent.is_some() {
        attributes.push(("TANGENT", 4, &tangents[..]));
    }
    let mut model = mesh(&attributes, &[0, 1, 2, 0, 2, 3]);
    model["materials"] = json!([{
        "doubleSided": true,
        "pbrMetallicRoughness": { "metallicFactor": 1.0, "roughnessFactor": 0.5 },
    }]);
    model
}

/// A square whose normal has this cosine to the viewer.
fn leaning(n_dot_v: f64) -> Scene {
    let v = loaded(&quad(DVec3::Z, None)).toward_viewer;
    let across = v.cross(DVec3::Y).normalize();
    let n = n_dot_v * v + (1.0 - n_dot_v * n_dot_v).sqrt() * across;
    loaded(&quad(n, None))
}

/// Mean radiance of the hit pixels.
fn mean(pipeline: &mut Pipeline, request: &RenderRequest) -> f64 {
    let frame = pipeline.render(request).unwrap();
    let pixels = frame.radiance.data.iter().zip(&frame.mask.data);
    let hits: Vec<f64> = pixels
        .filter(|(_, mask)| **mask == 1.0)
        .map(|(texel, _)| f64::from(texel[1]))
        .collect();
    assert!(!hits.is_empty());
    hits.iter().sum::<f64>() / hits.len() as f64
}

fn by(base: &RenderRequest, method: &str, samples: u32) -> RenderRequest {
    base.shaded(|s| {
        s.method = Method::listed(method);
        s.diffuse = Diffuse::listed("none");
        s.samples = samples;
    })
}

/// Normals of meshes that lean away are bent until they are seen, by the same rule for all methods.
#[test]
fn no_normal_of_the_g_buffer_leans_away() {
    with_gpu(|gpu| {
        for n_dot_v in [-0.9, -0.3, -0.01] {
            let scene = leaning(n_dot_v);
            let camera = Camera::for_scene(CameraKind::Ortho, &scene, SIZE);
            let gbuffer = draw(gpu, &scene, &camera, SIZE);
            let cosines = gbuffer.n_dot_v(&camera);
            let mask = gbuffer.mask();
            for (cosine, mask) in cosines.data.iter().zip(&mask.data) {
                assert!(*mask == 0.0 || (0.0..1e-5).contains(cosine), "{cosine}");
            }
        }
    });
}

/// Sampled methods converge to the reference where normals lean away from the viewer.
#[test]
fn methods_converge_where_normals_lean_away() {
    with_pipeline(|pipeline| {
        let light = smooth_environment();
        let base = RenderRequest {
            reference_samples: 1 << 14,
            ..request(&light, leaning(-0.3), CameraKind::Ortho, SIZE)
        };
        let exact = mean(pipeline, &by(&base, "reference", 1));
        for method in ["sampled", "sampled-unfiltered", "sampled-vndf"] {
            let found = mean(pipeline, &by(&base, method, 1 << 14));
            let off = (found / exact - 1.0).abs();
            assert!(off < 0.02, "{method}: {found}, reference {exact}");
        }
    });
}

/// Under constant light every method shows the albedo of the lobe there, as everywhere, but those
/// whose factor is not the albedo.
#[test]
fn leaning_surfaces_have_their_albedo() {
    with_pipeline(|pipeline| {
        let white = constant_environment([1.0; 3]);
        let base = RenderRequest {
            reference_samples: 1 << 14,
            ..request(&white, leaning(-0.3), CameraKind::Ortho, SIZE)
        };
        let exact = mean(pipeline, &by(&base, "reference", 1));
        let shown = METHODS
            .iter()
            .filter(|method| method.has_pass() && !method.is_as_printed)
            .filter(|method| !method.has_other_factor)
            .filter(|method| !method.name.starts_with("split-sum-strips"));
        for method in shown {
            let found = mean(pipeline, &by(&base, method.name, 4096));
            let off = (found / exact - 1.0).abs();
            assert!(off < 0.03, "{}: {found}, reference {exact}", method.name);
        }
    });
}

/// An anisotropic surface with a tangent without a direction is finite, as without a tangent.
#[test]
fn tangents_without_a_direction_give_way_to_the_east() {
    let scene = |tangent: Option<[f32; 4]>| {
        let mut model = quad(DVec3::Z, tangent);
        model["materials"][0]["extensions"] = json!({ "KHR_materials_anisotropy": {
            "anisotropyStrength": 0.7, "anisotropyRotation": 0.4,
        } });
        loaded(&model)
    };
    with_pipeline(|pipeline| {
        let light = golden_environment();
        let shade = |pipeline: &mut Pipeline, tangent, method| {
            let base = RenderRequest {
                reference_samples: 256,
                ..request(&light, scene(tangent), CameraKind::Ortho, SIZE)
            };
            pipeline.render(&by(&base, method, 64)).unwrap().radiance
        };
        for method in ["sampled", "reference"] {
            let without = shade(pipeline, None, method);
            assert!(without.data.iter().any(|texel| texel[0] > 0.0));
            for tangent in [
                [0.0, 0.0, 1.0, 1.0],
                [0.0, 0.0, -1.0, -1.0],
                [0.0, 0.0, 0.0, 1.0],
                [f32::NAN, 0.0, 0.0, 1.0],
                [1.0, 0.0, 0.0, f32::NAN],
            ] {
                let found = shade(pipeline, Some(tangent), method);
                assert_eq!(found.data, without.data, "{method} {tangent:?}");
            }
        }
    });
}

/// Emission is added to every method and to the reference alike, under a coat attenuated by it.
#[test]
fn emission_is_added_to_every_method() {
    let scene = |coat: f64, strength: f64| {
        let mut model = quad(DVec3::Z, None);
        model["materials"][0]["emissiveFactor"] = json!([1, 0.5, 0.25]);
        model["materials"][0]["extensions"] = json!({
            "KHR_materials_emissive_strength": { "emissiveStrength": strength },
            "KHR_materials_clearcoat": { "clearcoatFactor": coat },
        });
        loaded(&model)
    };
    with_pipeline(|pipeline| {
        let light = golden_environment();
        for (coat, method) in [(0.0, "split-sum"), (0.0, "reference"), (1.0, "reference")] {
            let mut shade = |strength| {
                let base = RenderRequest {
                    reference_samples: 256,
                    ..request(&light, scene(coat, strength), CameraKind::Ortho, SIZE)
                };
                pipeline.render(&by(&base, method, 16)).unwrap()
            };
            let (dark, lit) = (shade(0.0), shade(3.0));
            for i in (0..dark.mask.data.len()).filter(|i| dark.mask.data[*i] == 1.0) {
                let n_dot_v = f64::from(dark.n_dot_v.data[i]);
                let through = 1.0 - coat * (0.04 + 0.96 * (1.0 - n_dot_v).powi(5));
                for (c, emission) in [3.0, 1.5, 0.75].into_iter().enumerate() {
                    let added = f64::from(lit.radiance.data[i][c] - dark.radiance.data[i][c]);
                    let off = added - through * emission;
                    assert!(off.abs() < 1e-4, "{method}, coat {coat}: {added}");
                }
            }
        }
    });
}

/// With half of the interface, a dielectric shows half of its specular term, and the diffuse term
/// gets the rest.
#[test]
fn half_an_interface_reflects_half() {
    let scene = |weight: f64| {
        let mut model = quad(DVec3::Z, None);
        model["materials"][0]["pbrMetallicRoughness"]["metallicFactor"] = json!(0.0);
        model["materials"][0]["extensions"] =
            json!({ "KHR_materials_specular": { "specularFactor": weight } });
        loaded(&model)
    };
    with_pipeline(|pipeline| {
        let light = golden_environment();
        for (method, diffuse) in [("split-sum", "sh9"), ("reference", "reference")] {
            let mut shade = |weight| {
                let base = RenderRequest {
                    reference_samples: 1024,
                    ..request(&light, scene(weight), CameraKind::Ortho, SIZE)
                };
                let request = base.shaded(|s| {
                    s.method = Method::listed(method);
                    s.diffuse = Diffuse::listed(diffuse);
                });
                mean(pipeline, &request)
            };
            let (none, half, whole) = (shade(0.0), shade(0.5), shade(1.0));
            let off = half / (0.5 * (none + whole)) - 1.0;
            assert!(
                off.abs() < 1e-4 && (whole / none - 1.0).abs() > 1e-3,
                "{method}: {none} {half} {whole}"
            );
        }
    });
}
