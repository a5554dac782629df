//! The files of a run for the live view, and the part that a report embeds.

use crate::gltf_files::{png, textured};
use crate::run::runs::finished;
use crate::scene::gltf::quad;
use crate::study::page::{decoded, finished_run, read};
use glam::{DVec3, Vec3};
use serde_json::json;
use splitsum::base::glsl::source::{Language, parse};
use splitsum::base::pixels::HALF_MAX;
use splitsum::experiment::Plan;
use splitsum::instrument::brdf::MODELS;
use splitsum::instrument::environment::layout::{LAYOUTS, MapLayout};
use splitsum::instrument::precompute::taps::TapCount;
use splitsum::instrument::scene::Scene;
use splitsum::instrument::shade::{METHODS, Method};
use splitsum::report::live::model::{self, LiveModel, TRIANGLES_MAX};
use splitsum::report::live::record::{
    LIVE_FILE, LiveEnvironment, LiveLobe, LiveRecord, LiveShader, half_scale,
};
use splitsum::report::page::PageRun;
use splitsum::report::page::live::{BUDGET_BYTES, Light};
use splitsum::report::page::render::shaders;
use std::f64::consts::{PI, TAU};
use std::fmt::Write;
use std::path::Path;

fn record(run: &Path) -> LiveRecord {
    serde_json::from_str(&std::fs::read_to_string(run.join(LIVE_FILE)).unwrap()).unwrap()
}

fn light(run: &Path, budget: usize) -> Light {
    Light::collect(&PageRun::of_runs(&[read(run)]), budget)
}

#[test]
fn half_scales_are_the_least_powers_of_two_that_fit() {
    for (largest, scale) in [
        (0.0, 1.0),
        (1.0, 1.0),
        (65_504.0, 1.0),
        (65_505.0, 2.0),
        (131_009.0, 4.0),
        (1e9, 16_384.0),
    ] {
        assert_eq!(half_scale(largest), scale, "{largest}");
        assert!(largest / scale <= HALF_MAX);
    }
}

/// GLSL ES 3.00 compiles the shader of every split sum in every layout, and the samplers' shaders
/// for every model.
#[test]
fn the_page_has_a_shader_of_every_method_that_its_tables_serve() {
    let dir = tempfile::tempdir().unwrap();
    let run = finished_run(dir.path());
    // A run with methods of every table of taps.
    let mut record = record(&run);
    for lobe in &mut record.lobes {
        let table = lobe.tap_tables["one_tap"].clone();
        lobe.tap_tables
            .extend(TapCount::ALL.map(|count| (count.sampler().to_owned(), table.clone())));
    }
    std::fs::write(run.join(LIVE_FILE), serde_json::to_string(&record).unwrap()).unwrap();
    let mut light = light(&run, BUDGET_BYTES);
    let methods: Vec<&str> = light
        .methods
        .iter()
        .map(|method| method.name.as_str())
        .collect();
    let is_served = |method: &&Method| method.lookups > 0 && method.uses_dfg;
    for method in METHODS.iter().filter(is_served) {
        assert!(methods.contains(&method.name), "{}", method.name);
    }
    assert!(
        methods.contains(&"sampled") && light.methods[0].name == "split-sum",
        "{methods:?}"
    );
    let environment = light.environments[0].clone();
    let of_layout = |layout: &MapLayout| LiveEnvironment {
        layout: layout.name.to_owned(),
        ..environment.clone()
    };
    light.environments = LAYOUTS.iter().map(of_layout).collect();
    let lobe = light.lobes[0].clone();
    light.lobes = MODELS
        .iter()
        .map(|model| LiveLobe {
            brdf: model.name().to_owned(),
            ..lobe.clone()
        })
        .collect();
    let shaders = shaders(&light);
    for (name, text) in &shaders {
        let entry = if name.contains('.') {
            name.clone()
        } else {
            format!("{name}.frag")
        };
        parse(&entry, text, Language::Es).unwrap_or_else(|log| panic!("{name}: {log}"));
    }
    let sampled = light
        .methods
        .iter()
        .filter(|method| method.is_sampled)
        .count();
    // One more is the lookup of sheen.
    let specular = LAYOUTS.len() * (light.methods.len() + 1 - sampled + sampled * MODELS.len());
    assert_eq!(
        shaders
            .keys()
            .filter(|name| name.starts_with("specular:"))
            .count(),
        specular
    );
}

#[test]
fn methods_in_files_have_shaders_and_words() {
    let dir = tempfile::tempdir().unwrap();
    let run = finished_run(dir.path());
    let mut record = record(&run);
    let split_sum =
        Path::new(env!("CARGO_MANIFEST_DIR")).join("shaders/shade/method/split_sum.glsl");
    let shader = |name: &str, text: String| LiveShader {
        name: name.to_owned(),
        text,
        is_sampled: false,
    };
    record.methods = vec![
        shader(
            "file:my/own.glsl",
            std::fs::read_to_string(split_sum).unwrap(),
        ),
        shader(
            "file:broken.glsl",
            "vec3 specular_radiance(Surface s) { return 1; }".to_owned(),
        ),
    ];
    std::fs::write(run.join(LIVE_FILE), serde_json::to_string(&record).unwrap()).unwrap();
    let light = light(&run, BUDGET_BYTES);
    let own = light
        .methods
        .iter()
        .filter(|method| method.name.starts_with("file:"));
    assert_eq!(
        own.map(|method| method.title.as_str()).collect::<Vec<_>>(),
        ["own (file)"]
    );
    let [builtin, own] = ["split-sum", "file:my/own.glsl"].map(|name| {
        shaders(&light)[&format!("specular:{}:{name}", light.environments[0].layout)].clone()
    });
    assert_eq!(builtin, own);
    assert!(
        light
            .notes
            .iter()
            .any(|note| note.starts_with("file:broken.glsl does not compile")),
        "{:?}",
        light.notes
    );
}

/// The words of a packed text, a triple each.
fn unpacked(text: &str, count: usize) -> Vec<[u16; 3]> {
    let bytes = decoded(text, count);
    assert_eq!(bytes.len(), 6 * count);
    let word = |i: usize, c: usize| {
        u16::from_be_bytes([bytes[2 * c * count + i], bytes[(2 * c + 1) * count + i]])
    };
    (0..count).map(|i| [0, 1, 2].map(|c| word(i, c))).collect()
}

fn models(dir: &Path, axes: &str) -> Vec<LiveModel> {
    let text = format!("name = \"live\"\nsize = [8, 8]\n[axes]\n{axes}");
    let plan = Plan::from_text(&dir.join("live.toml"), &text, &[])
        .unwrap_or_else(|error| panic!("{error}"));
    model::models(&plan)
}

#[test]
fn a_model_is_packed_within_the_errors_that_it_states() {
    let dir = tempfile::tempdir().unwrap();
    // A ball of flat triangles, with more vertices than 16 bits can index.
    let (rings, sectors) = (100, 120);
    let at = |i: usize, k: usize| {
        let (polar, azimuth) = (
            PI * (i + 1) as f64 / (rings + 2) as f64,
            TAU * k as f64 / sectors as f64,
        );
        DVec3::new(
            polar.sin() * azimuth.cos(),
            polar.cos(),
            polar.sin() * azimuth.sin(),
        )
    };
    let mut obj = String::new();
    for (i, k) in (0..rings).flat_map(|i| (0..sectors).map(move |k| (i, k))) {
        let [a, b, c, d] = [at(i, k), at(i, k + 1), at(i + 1, k + 1), at(i + 1, k)];
        for corners in [[a, b, c], [a, c, d]] {
            for n in corners {
                let p = 3.0 * n + DVec3::new(10.0, 0.0, -5.0);
                writeln!(obj, "v {} {} {}", p.x, p.y, p.z).unwrap();
            }
            let n = (corners[0] + corners[1] + corners[2]).normalize();
            writeln!(obj, "vn {} {} {}\nf -3//-1 -2//-1 -1//-1", n.x, n.y, n.z).unwrap();
        }
    }
    std::fs::write(dir.path().join("ball.obj"), obj).unwrap();
    let models = models(
        dir.path(),
        "scene = [\"ball.obj\", \"sphere\"]\nalpha = [0.5]\n",
    );
    assert_eq!(
        models
            .iter()
            .map(|model| model.label.as_str())
            .collect::<Vec<_>>(),
        ["ball", "sphere"]
    );
    let ball = &models[0];
    let scene = Scene::load("ball.obj", dir.path()).unwrap();
    let mesh = &scene.meshes[0];
    let mut corners = mesh.indices.iter();
    let side = (0..3)
        .map(|c| ball.high[c] - ball.low[c])
        .fold(0.0, f64::max);
    assert_eq!(ball.parts.len(), 2);
    for part in &ball.parts {
        assert!(part.vertex_count <= 1 << 16);
        let [positions, normals] =
            [&part.positions, &part.normals].map(|text| unpacked(text, part.vertex_count));
        for place in unpacked(&part.triangles, part.triangle_count).as_flattened() {
            let index = *corners.next().unwrap() as usize;
            let fraction = positions[*place as usize].map(|word| f64::from(word) / 65535.0);
            #[allow(clippy::needless_range_loop, reason = "the component of several lists")]
            for c in 0..3 {
                let position = ball.low[c] + fraction[c] * (ball.high[c] - ball.low[c]);
                assert!(
                    (position - f64::from(mesh.positions[index][c])).abs()
                        <= side / 131_070.0 + 1e-6
                );
            }
            let [x, y, _] = normals[*place as usize].map(|word| f64::from(word as i16) / 32767.0);
            let z = 1.0 - x.abs() - y.abs();
            let fold = (-z).max(0.0);
            let n = DVec3::new(x - fold.copysign(x), y - fold.copysign(y), z).normalize();
            let wanted = Vec3::from_array(mesh.normals[index]).as_dvec3();
            assert!(
                n.cross(wanted).length() < 0.01f64.to_radians(),
                "{n} for {wanted}"
            );
        }
    }
    assert_eq!(
        (
            corners.next(),
            ball.parts[0].surface.roughness,
            ball.note.as_str()
        ),
        (None, 0.5f32.sqrt(), "")
    );
    // A model of too many triangles is replaced by a sphere, and the page says so.
    let twice = "f 1//1 2//2 3//3\n".repeat(TRIANGLES_MAX + 1);
    std::fs::write(
        dir.path().join("large.obj"),
        format!("v 0 0 0\nv 1 0 0\nv 0 1 0\nvn 0 0 1\nvn 0 0 1\nvn 0 0 1\n{twice}"),
    )
    .unwrap();
    let large = &self::models(dir.path(), "scene = [\"large.obj\"]\nalpha = [0.5]\n")[0];
    assert_eq!((large.spheres.len(), large.parts.len()), (1, 0));
    assert!(
        large.note.contains("large has 100001 triangles"),
        "{}",
        large.note
    );
}

/// A glTF model is shown with the means of its maps: 0 and 255 make a half, and roughness is
/// squared afterwards.
#[test]
fn a_model_has_the_means_of_its_maps() {
    let dir = tempfile::tempdir().unwrap();
    let coat = json!({ "clearcoatFactor": 0.5, "clearcoatTexture": { "index": 0 } });
    let material = json!({ "extensions": { "KHR_materials_clearcoat": coat }, "pbrMetallicRoughness": {
        "baseColorFactor": [0.5, 1, 1, 1], "baseColorTexture": { "index": 0 },
        "roughnessFactor": 0.5, "metallicRoughnessTexture": { "index": 1 },
    } });
    let images = [
        png(2, 1, |x, _| [255 * x as u8, 51, 255]),
        png(2, 1, |x, _| [0, 255 * x as u8, 51 * x as u8]),
    ];
    std::fs::write(
        dir.path().join("x.gltf"),
        textured(quad(), material, &images).to_string(),
    )
    .unwrap();
    let model = &models(
        dir.path(),
        "scene = [\"x.gltf\"]\nmethod = [\"split-sum\"]\n",
    )[0];
    let surface = &model.parts[0].surface;
    let green = splitsum::base::color::srgb_decode(0.2);
    for (found, wanted) in surface.albedo.into_iter().zip([0.25, green, 1.0]) {
        assert!((found - wanted).abs() < 1e-6, "{surface:?}");
    }
    assert!(
        (surface.metallic - 0.1).abs() < 1e-6 && (surface.roughness - 0.25).abs() < 1e-6,
        "{surface:?}"
    );
    assert!((surface.coat - 0.25).abs() < 1e-6, "{surface:?}");
    assert_eq!(
        (model.parts[0].triangle_count, model.note.as_str()),
        (2, "The textures of x are replaced by their means.")
    );
}

/// Lights of the experiment and of a scene's file are named, since the view draws none; so are maps
/// of occlusion.
#[test]
fn notes_say_that_lights_and_occlusion_are_missing() {
    let note = |head: &str, scene: &str| -> Vec<String> {
        let dir = tempfile::tempdir().unwrap();
        let mut model = quad();
        model["extensionsUsed"] = json!(["KHR_lights_punctual"]);
        model["extensions"] =
            json!({ "KHR_lights_punctual": { "lights": [{ "type": "directional" }] } });
        model["nodes"].as_array_mut().unwrap().push(json!({
            "extensions": { "KHR_lights_punctual": { "light": 0 } }
        }));
        let last = model["nodes"].as_array().unwrap().len() - 1;
        model["scenes"][0]["nodes"]
            .as_array_mut()
            .unwrap()
            .push(json!(last));
        std::fs::write(dir.path().join("lit.gltf"), model.to_string()).unwrap();
        let occluded = json!({ "occlusionTexture": { "index": 0 } });
        let occluded = textured(quad(), occluded, &[png(2, 2, |_, _| [90, 0, 0])]);
        std::fs::write(dir.path().join("occluded.gltf"), occluded.to_string()).unwrap();
        let file = dir.path().join("lit.toml");
        let text = format!(
            "name = \"lit\"\nsize = [16, 16]\nscene = \"{scene}\"\n{head}\n[axes]\n\
             environment = [\"builtin:constant\"]\nmethod = [\"split-sum\"]\n"
        );
        let plan = Plan::from_text(&file, &text, &[]).unwrap_or_else(|error| panic!("{error}"));
        let run = finished(&plan, &dir.path().join("run"));
        light(&run, BUDGET_BYTES).notes
    };
    let sun = "[[lights]]\nkind = \"directional\"\ndirection = [0, -1, 0]";
    for (head, scene, are_named) in [
        ("", "sphere", [false, false]),
        (sun, "sphere", [true, false]),
        ("", "lit.gltf", [true, false]),
        ("", "occluded.gltf", [false, true]),
    ] {
        let notes = note(head, scene);
        let is_named = |start: &str| notes.iter().any(|note| note.starts_with(start));
        let found = ["The direct lights of the run", "Maps of occlusion"].map(is_named);
        assert_eq!(found, are_named, "{scene}: {notes:?}");
    }
}
