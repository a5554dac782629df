//! Direct lights: what their tests share, and lights of every method and of files.

mod closed_forms;
mod maps;
mod twins;

use crate::compare::{Worst, relative};
use crate::gltf_files::{load, sheet};
use crate::harness::{constant_environment, request, scene, with_pipeline};
use crate::methods::{radiance, sights};
use crate::symmetry::smooth_environment;
use glam::DVec3;
use serde_json::json;
use splitsum::base::names::Listed;
use splitsum::instrument::pipeline::RenderRequest;
use splitsum::instrument::precompute::given::GivenTable;
use splitsum::instrument::scene::light::{Cone, Emitter, LightUnit};
use splitsum::instrument::scene::{CameraKind, Light, MaterialOverride, Scene};
use splitsum::instrument::shade::{Diffuse, METHODS, Method};
use std::f64::consts::PI;
use std::sync::Arc;

/// f32 of the device; narrow lobes amplify the rounding of their half vectors.
const ROUNDING: f64 = 2e-4;

fn light(emitter: Emitter, color: [f32; 3]) -> Light {
    Light {
        emitter,
        color,
        unit: LightUnit::Absolute,
        range: None,
    }
}

/// A light of each kind, of other colours; the last one has a range.
fn three_lights() -> Vec<Light> {
    let spot = Emitter::Spot {
        position: DVec3::new(1.5, 2.0, 3.0),
        direction: DVec3::new(-1.4, -1.6, -2.7).normalize(),
        cone: Cone {
            inner: 0.1,
            outer: 0.35,
        },
    };
    let point = Emitter::Point {
        position: DVec3::new(-1.5, 0.5, 1.5),
    };
    vec![
        Light::directional(DVec3::new(-0.3, -1.0, -0.8).normalize(), [3.0, 2.0, 1.0]),
        light(spot, [9.0, 30.0, 20.0]),
        Light {
            range: Some(4.0),
            ..light(point, [2.0, 1.0, 5.0])
        },
    ]
}

/// A request that shows direct lights alone: the environment is black.
fn under(lights: Vec<Light>, scene: Scene, size: u32) -> RenderRequest {
    let dark = constant_environment([0.0; 3]);
    let plain = request(
        &dark,
        scene.lit_by(lights),
        CameraKind::Perspective,
        [size; 2],
    );
    RenderRequest {
        reference_samples: 8,
        ..plain
    }
    .shaded(|s| (s.method, s.diffuse) = (Method::listed("reference"), Diffuse::listed("reference")))
}

fn plastic(alpha: f32) -> MaterialOverride {
    MaterialOverride {
        albedo: Some([0.8, 0.4, 0.2]),
        metallic: Some(0.25),
        alpha: Some(alpha),
        f0: Some([0.04, 0.05, 0.06]),
        ..MaterialOverride::default()
    }
}

/// Every method gets the light that the reference gets, and no noise by it.
#[test]
fn the_same_light_for_every_method() {
    with_pipeline(|pipeline| {
        let sphere = scene("sphere", plastic(0.4));
        let lit = Arc::new(sphere.lit_by(three_lights()));
        let plain = request(
            &smooth_environment(),
            sphere,
            CameraKind::Perspective,
            [9; 2],
        );
        let plain = RenderRequest {
            reference_samples: 64,
            background: true,
            ..plain
        };
        let alone = under(three_lights(), scene("sphere", plastic(0.4)), 9);
        let alone = pipeline.render(&alone).unwrap();
        for method in METHODS.iter().filter(|method| !method.is_none()) {
            let request = plain.shaded(|s| {
                (s.method, s.diffuse) = (method, Diffuse::listed("sh9"));
                s.samples = 8;
                // Settings of tables do not change the light.
                s.precompute.dfg_size = 32;
            });
            let mut request = request;
            if method.name == "split-sum" {
                // Nor do tables of files.
                request.given.dfg = Some(Arc::new(GivenTable {
                    name: "table".to_owned(),
                    hash: "hash".to_owned(),
                    side: 32,
                    texels: vec![[0.3, 0.1, 0.0, 1.0]; 32 * 32],
                }));
            }
            let lit = RenderRequest {
                scene: lit.clone(),
                ..request.clone()
            };
            let [dark, lit] = [&request, &lit].map(|request| pipeline.render(request).unwrap());
            assert_eq!(dark.standard_error, lit.standard_error, "{}", method.name);
            let mut worst = Worst::new(method.name, relative(1e-6));
            for pixel in 0..lit.radiance.data.len() {
                for c in 0..3 {
                    let sum = dark.radiance.data[pixel][c] + alone.radiance.data[pixel][c];
                    worst.add(lit.radiance.data[pixel][c].into(), sum.into(), || {
                        format!("pixel {pixel}")
                    });
                }
            }
            worst.check();
        }
    });
}

/// A directional light of a glTF file shines along the -z axis of its node. Emission is added once.
#[test]
fn a_light_of_a_file_lights_its_scene() {
    let mut model = sheet();
    model["materials"] = json!([{
        "doubleSided": true,
        "emissiveFactor": [0.5, 0.25, 0.125],
        "pbrMetallicRoughness": { "metallicFactor": 0.0, "baseColorFactor": [0.5, 0.5, 0.5, 1.0] }
    }]);
    model["extensionsUsed"] = json!(["KHR_lights_punctual"]);
    model["extensions"] = json!({ "KHR_lights_punctual": { "lights": [
        { "type": "directional", "color": [1.0, 0.5, 0.25], "intensity": 3.0 }
    ] } });
    // A turn by 60 degrees about +y: -z becomes (-sin 60, 0, -cos 60).
    let (sin, cos) = (PI / 6.0).sin_cos();
    model["nodes"] = json!([{ "mesh": 0 }, {
        "rotation": [0.0, sin, 0.0, cos],
        "scale": [2.0, 3.0, 4.0],
        "extensions": { "KHR_lights_punctual": { "light": 0 } }
    }]);
    model["scenes"] = json!([{ "nodes": [0, 1] }]);
    let scene = load(&model).unwrap();
    let lights = scene.lights.clone();
    let request = under(lights, scene, 21).shaded(|s| s.method = Method::listed("none"));
    let l = DVec3::new((PI / 3.0).sin(), 0.0, (PI / 3.0).cos());
    with_pipeline(|pipeline| {
        let frame = pipeline.render(&request).unwrap();
        let mut worst = Worst::new("file", relative(1e-4));
        for sight in sights(&request, 1) {
            let cosine = sight.surface.n.dot(l).max(0.0);
            let emission = DVec3::new(0.5, 0.25, 0.125);
            let expected = emission + DVec3::new(3.0, 1.5, 0.75) * (0.5 / PI * cosine);
            worst.add_rgb(radiance(&frame, sight.pixel), expected, || {
                format!("{:?}", sight.pixel)
            });
        }
        worst.check();
    });
}
