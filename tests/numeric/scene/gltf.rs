//! glTF files, made by the tests in memory.

use crate::gbuffer_twin::gbuffer;
use crate::gltf_files::{load, mesh, png, sheet, textured};
use crate::snapshot::assert_snapshot;
use glam::{DQuat, DVec3};
use serde_json::{Value, json};
use splitsum::base::color::srgb_decode;
use splitsum::base::pixels::RgbImage;
use splitsum::base::pixels::lookup::Wrap;
use splitsum::instrument::brdf::alpha_from_perceptual_roughness;
use splitsum::instrument::gbuffer::Gbuffer;
use splitsum::instrument::scene::{
    Camera, CameraKind, MaterialOverride, Mesh, Projection, Scene, Texture,
};

/// Rounding of f32 numbers of order 1.
pub const F32: f64 = 1e-6;

/// The square [-1, 1]² of the plane z = 0 with its front to +z; u grows to +x, v, as glTF counts
/// it, to -y.
pub fn quad() -> Value {
    let positions = [-1., 1., 0., -1., -1., 0., 1., -1., 0., 1., 1., 0.];
    let normals = [0., 0., 1.].repeat(4);
    let uvs = [0., 0., 0., 1., 1., 1., 1., 0.];
    mesh(
        &[
            ("POSITION", 3, &positions),
            ("NORMAL", 3, &normals),
            ("TEXCOORD_0", 2, &uvs),
        ],
        &[0, 1, 2, 0, 2, 3],
    )
}

/// A model as a binary file without a binary part.
pub fn glb(model: &Value) -> Vec<u8> {
    let text = model.to_string();
    let padded = format!("{text:<width$}", width = text.len().next_multiple_of(4));
    let words = [2, 20 + padded.len() as u32, padded.len() as u32]
        .map(u32::to_le_bytes)
        .concat();
    [b"glTF", &words[..], b"JSON", padded.as_bytes()].concat()
}

pub fn loaded(model: &Value) -> Scene {
    load(model).expect("a readable file")
}

fn vector(v: [f32; 3]) -> DVec3 {
    glam::Vec3::from_array(v).as_dvec3()
}

/// The view of a camera straight in front of the square, a texel a pixel.
pub fn seen(scene: &Scene, size: [u32; 2], toward_viewer: DVec3) -> Gbuffer<f64> {
    let front = Camera::for_scene(CameraKind::Ortho, &Scene::sphere(), size);
    let camera = Camera {
        eye: 3.0 * toward_viewer,
        forward: -toward_viewer,
        up: DVec3::Y,
        right: DVec3::Y.cross(toward_viewer),
        // Half of the height; the width follows from the image's aspect, so the square is as wide
        // as the image.
        projection: Projection::Ortho { half_height: 1.0 },
        ..front
    };
    gbuffer(scene, &camera, size)
}

#[test]
fn a_node_that_is_turned_is_the_model_turned() {
    let plain = sheet();
    let turn = DQuat::from_euler(glam::EulerRot::XYZ, 0.3, -0.8, 1.1);
    let [x, y, z, w] = turn.to_array();
    for scale in [DVec3::new(2.0, 0.5, 1.5), DVec3::new(-2.0, 0.5, 1.5)] {
        let mut model = plain.clone();
        // A parent that shifts and scales, a child that turns and shifts.
        model["nodes"] = json!([
            { "children": [1], "translation": [0.5, -1, 2], "scale": scale.to_array() },
            { "mesh": 0, "translation": [1, 2, 3], "rotation": [x, y, z, w] },
        ]);
        let (before, after) = (&loaded(&plain).meshes[0], &loaded(&model).meshes[0]);
        assert_eq!(after.positions.len(), 4);
        for i in 0..4 {
            let to_world = |p: DVec3| {
                scale * (turn * p + DVec3::new(1.0, 2.0, 3.0)) + DVec3::new(0.5, -1.0, 2.0)
            };
            let position = to_world(vector(before.positions[i]));
            assert!(
                (vector(after.positions[i]) - position).length() < 5.0 * F32,
                "position {i}"
            );
            // A normal stays perpendicular to the surface: it is divided by the scale, not
            // multiplied.
            let normal = (turn * vector(before.normals[i]) / scale).normalize();
            assert!(
                (vector(after.normals[i]) - normal).length() < F32,
                "normal {i}, scale {scale}"
            );
        }
        // The front stays the front, also after mirroring.
        for mesh in [before, after] {
            for triangle in mesh.triangles() {
                let [a, b, c] = triangle.map(|i| vector(mesh.positions[i as usize]));
                let sum: DVec3 = triangle
                    .iter()
                    .map(|&i| vector(mesh.normals[i as usize]))
                    .sum();
                assert!((b - a).cross(c - a).dot(sum) > 0.0, "scale {scale}");
            }
        }
    }
    let mut columns = plain.clone();
    columns["nodes"][0]["matrix"] = json!([0, 1, 0, 0, -1, 0, 0, 0, 0, 0, 1, 0, 5, 6, 7, 1]);
    let turned = &loaded(&columns).meshes[0];
    assert!(
        (vector(turned.positions[0]) - DVec3::new(6.0, 5.0, 7.0)).length() < F32,
        "a quarter turn about z"
    );
}

fn triangle_corners(mesh: &Mesh) -> Vec<[DVec3; 3]> {
    mesh.triangles()
        .map(|triangle| triangle.map(|i| vector(mesh.positions[i as usize])))
        .collect()
}

/// Strips and fans reverse every other triangle; bytes, strides and sparse elements are other
/// encodings of the same numbers.
#[test]
fn every_form_of_a_mesh_gives_the_same_triangles() {
    let plain = quad();
    let expected = triangle_corners(&loaded(&plain).meshes[0]);
    let area = |corners: &[[DVec3; 3]]| -> DVec3 {
        corners
            .iter()
            .map(|[a, b, c]| 0.5 * (b - a).cross(c - a))
            .sum()
    };
    assert!((area(&expected) - DVec3::new(0.0, 0.0, 4.0)).length() < F32);
    for (mode, indices) in [(5, [1u16, 2, 0, 3]), (6, [0, 1, 2, 3])] {
        let positions = [-1., 1., 0., -1., -1., 0., 1., -1., 0., 1., 1., 0.];
        let mut model = mesh(&[("POSITION", 3, &positions)], &indices);
        model["meshes"][0]["primitives"][0]["mode"] = json!(mode);
        let corners = triangle_corners(&loaded(&model).meshes[0]);
        assert_eq!(corners.len(), 2);
        assert!(
            corners
                .iter()
                .all(|corners| (area(&[*corners]) - DVec3::new(0.0, 0.0, 2.0)).length() < F32),
            "{mode}"
        );
    }
    let mut bare = plain.clone();
    bare["meshes"][0]["primitives"][0]["attributes"]
        .as_object_mut()
        .unwrap()
        .remove("NORMAL");
    let flat = &loaded(&bare).meshes[0];
    assert!(
        flat.normals.iter().all(|normal| *normal == [0.0, 0.0, 1.0]),
        "the triangles' own normals"
    );

    // Application-specific attributes are ignored.
    let mut named = plain.clone();
    named["meshes"][0]["primitives"][0]["attributes"]["_FEATURE_ID_0"] = json!(0);
    assert_eq!(triangle_corners(&loaded(&named).meshes[0]), expected);

    // Interleaved positions and normals; a sparse element moves the last corner.
    let bent = loaded(&sheet()).meshes[0].clone();
    let rows: Vec<f32> = (0..4)
        .flat_map(|i| [bent.positions[i], bent.normals[i]].concat())
        .collect();
    let mut model = mesh(
        &[("POSITION", 3, &rows[..12]), ("NORMAL", 3, &rows[12..])],
        &[0, 1, 2, 0, 2, 3],
    );
    let both: Vec<u8> = rows
        .iter()
        .flat_map(|x| x.to_le_bytes())
        .chain([3, 0, 0, 0])
        .collect();
    use base64::Engine;
    let uri =
        base64::prelude::BASE64_STANDARD.encode([both, 9f32.to_le_bytes().repeat(3)].concat());
    model["buffers"][0] = json!({ "uri": format!("data:;base64,{uri}"), "byteLength": 112 });
    model["bufferViews"][0] = json!({ "buffer": 0, "byteLength": 96, "byteStride": 24 });
    model["bufferViews"][1] =
        json!({ "buffer": 0, "byteOffset": 12, "byteLength": 84, "byteStride": 24 });
    let views = model["bufferViews"].as_array_mut().unwrap();
    views.push(json!({ "buffer": 0, "byteOffset": 96, "byteLength": 4 }));
    views.push(json!({ "buffer": 0, "byteOffset": 100, "byteLength": 12 }));
    model["accessors"][0]["sparse"] = json!({
        "count": 1,
        "indices": { "bufferView": 3, "componentType": 5121 },
        "values": { "bufferView": 4 },
    });
    let scene = loaded(&model);
    assert_eq!(scene.meshes[0].positions[..3], bent.positions[..3]);
    assert_eq!(scene.meshes[0].positions[3], [9.0; 3]);
    assert!((vector(scene.meshes[0].normals[1]) - vector(bent.normals[1])).length() < F32);
}

/// `KHR_mesh_quantization`: integers are plain numbers, or fractions of the largest one from -1 on.
#[test]
fn quantized_positions_are_decoded() {
    for (kind, width, largest, least) in [
        (5120, 1, 127, -128),
        (5121, 1, 255, 0),
        (5122, 2, 32767, -32768),
        (5123, 2, 65535, 0),
    ] {
        let corners: [[i32; 3]; 4] = [
            [least, 0, 3],
            [largest, 0, 3],
            [largest, largest / 3, 3],
            [least, largest / 3, 3],
        ];
        // Rows of four numbers, as elements begin at multiples of four bytes.
        let rows = corners.iter().flat_map(|[x, y, z]| [*x, *y, *z, 0]);
        let bytes: Vec<u8> = rows
            .flat_map(|x| x.to_le_bytes()[..width].to_vec())
            .collect();
        for is_fraction in [false, true] {
            let mut model = quad();
            use base64::Engine;
            let uri = base64::prelude::BASE64_STANDARD.encode(&bytes);
            model["extensionsUsed"] = json!(["KHR_mesh_quantization"]);
            model["extensionsRequired"] = json!(["KHR_mesh_quantization"]);
            model["buffers"][0] =
                json!({ "uri": format!("data:;base64,{uri}"), "byteLength": bytes.len() });
            model["bufferViews"][0] =
                json!({ "buffer": 0, "byteLength": bytes.len(), "byteStride": 4 * width });
            model["accessors"][0]["componentType"] = json!(kind);
            model["accessors"][0]["normalized"] = json!(is_fraction);
            let scene = loaded(&model);
            assert!(scene.warnings.is_empty(), "{:?}", scene.warnings);
            for (found, corner) in scene.meshes[0].positions.iter().zip(corners) {
                let fraction = |x: i32| (f64::from(x) / f64::from(largest)).max(-1.0);
                let wanted = corner.map(|x| if is_fraction { fraction(x) } else { x.into() });
                let error = (vector(*found) - DVec3::from_array(wanted)).length();
                assert!(
                    error < F32,
                    "{kind}, {is_fraction}: {found:?} for {wanted:?}"
                );
            }
        }
    }
}

#[test]
fn a_textured_square_has_the_texels_of_its_textures() {
    let size = [4, 4];
    let color = |x: u32, y: u32| [(60 * x) as u8, (70 * y) as u8, 200];
    let surface = |x: u32, y: u32| [7, (60 * y + 15) as u8, (80 * x) as u8];
    let material = json!({
        "doubleSided": true,
        "pbrMetallicRoughness": {
            "baseColorFactor": [0.5, 1, 0.25, 1], "metallicFactor": 0.5, "roughnessFactor": 0.75,
            "baseColorTexture": { "index": 0 }, "metallicRoughnessTexture": { "index": 1 },
        },
    });
    let scene = loaded(&textured(
        quad(),
        material,
        &[png(4, 4, color), png(4, 4, surface)],
    ));
    assert!(scene.warnings.is_empty(), "{:?}", scene.warnings);
    let images = seen(&scene, size, DVec3::Z);
    let byte = |x: u8| f64::from(x) / 255.0;
    for (x, y) in (0..16).map(|i| (i % 4, i / 4)) {
        let linear = color(x, y).map(|byte| f64::from(srgb_decode(f32::from(byte) / 255.0)));
        let albedo = DVec3::new(0.5, 1.0, 0.25) * DVec3::from_array(linear);
        let [_, green, blue] = surface(x, y);
        let alpha = alpha_from_perceptual_roughness(0.75 * byte(green));
        let expected = [albedo.x, albedo.y, albedo.z, 0.5 * byte(blue)];
        let (surface, normal) = (
            images.albedo_metallic.get(x, y),
            images.normal_alpha.get(x, y),
        );
        assert!(
            (0..4).all(|c| (surface[c] - expected[c]).abs() < F32),
            "({x}, {y}): {surface:?}, {expected:?}"
        );
        assert!(
            (normal[3] - alpha).abs() < F32,
            "({x}, {y}): alpha {} for {alpha}",
            normal[3]
        );
        let f0 = DVec3::splat(0.04).lerp(albedo, expected[3]);
        assert!(
            (0..3).all(|c| (images.f0_material.get(x, y)[c] - f0[c]).abs() < F32),
            "f0 of ({x}, {y})"
        );
    }
}

/// Red of the map, moved to 1 by the strength, at the texels of the square.
#[test]
fn an_occlusion_map_counts_by_its_strength() {
    let size = [4, 4];
    let red = |x: u32, y: u32| [(60 * x + 5 * y) as u8, 255, 0];
    let model = |texture: Value, image: Value| {
        let material = json!({ "doubleSided": true, "occlusionTexture": texture });
        load(&textured(quad(), material, &[image]))
    };
    let scene = model(json!({ "index": 0, "strength": 0.5 }), png(4, 4, red)).unwrap();
    assert_eq!(scene.warnings, Vec::<String>::new());
    assert!(scene.has_occlusion() && !scene.unoccluded().has_occlusion());
    let occlusions = seen(&scene.occlusions(), size, DVec3::Z).albedo_metallic;
    for (x, y) in (0..16).map(|i| (i % 4, i / 4)) {
        let expected = 0.5 + 0.5 * f64::from(red(x, y)[0]) / 255.0;
        let found = occlusions.get(x, y)[0];
        assert!(
            (found - expected).abs() < F32,
            "({x}, {y}): {found}, {expected}"
        );
    }
    // A map without effect is not read, and one of other coordinates cannot be.
    let broken = json!({ "uri": "data:image/png;base64,AAAA" });
    let idle = model(json!({ "index": 0, "strength": 0 }), broken.clone()).unwrap();
    assert!(!idle.has_occlusion() && idle.hash == loaded(&bare()).hash);
    let error = model(json!({ "index": 0 }), broken).unwrap_err();
    assert!(error.contains("image 0"), "{error}");
    let mut shared = textured(
        quad(),
        json!({
            "doubleSided": true,
            "occlusionTexture": { "index": 0, "texCoord": 1 },
            "normalTexture": { "index": 0 },
        }),
        &[png(1, 1, |_, _| [128, 128, 255])],
    );
    let scene = loaded(&shared);
    assert!(!scene.has_occlusion());
    assert_eq!(
        scene.warnings,
        ["not read: occlusion by other texture coordinates than the other maps'"]
    );
    shared["materials"][0]["occlusionTexture"] = json!({ "index": 0, "strength": 1.5 });
    let scene = loaded(&shared);
    assert!(scene.has_occlusion());
    assert_eq!(
        scene.warnings,
        ["not read: the parts of factors beyond [0, 1]"]
    );
}

/// The square with a plain material.
fn bare() -> Value {
    textured(quad(), json!({ "doubleSided": true }), &[])
}

/// The vector that a texel of a normal map encodes.
fn unpacked(texel: [u8; 3]) -> DVec3 {
    2.0 * DVec3::from_array(texel.map(|x| f64::from(x) / 255.0)) - 1.0
}

#[test]
fn a_normal_map_turns_the_normal_into_its_frame() {
    let texel = [191, 153, 230];
    let m = unpacked(texel);
    let normal_of = |model: Value, toward: DVec3| {
        let normal = seen(&loaded(&model), [1, 1], toward).normal_alpha.data[0];
        DVec3::new(normal[0], normal[1], normal[2])
    };
    let map = |model: Value, scale: f64| {
        let material =
            json!({ "doubleSided": true, "normalTexture": { "index": 0, "scale": scale } });
        textured(model, material, &[png(1, 1, |_, _| texel)])
    };
    let expect = |what: &str, actual: DVec3, expected: DVec3| {
        assert!(
            (actual - expected.normalize()).length() < F32,
            "{what}: {actual}, expected {}",
            expected.normalize()
        );
    };
    // Red to the right, green up, as the specification has it (3.9.3), though v grows downward.
    expect("as it is", normal_of(map(quad(), 1.0), DVec3::Z), m);
    expect(
        "scaled",
        normal_of(map(quad(), 0.5), DVec3::Z),
        m * DVec3::new(0.5, 0.5, 1.0),
    );
    expect("from behind", normal_of(map(quad(), 1.0), DVec3::NEG_Z), -m);

    let uvs: Vec<f32> = vec![1., 0., 1., 1., 0., 1., 0., 0.];
    let positions = [-1., 1., 0., -1., -1., 0., 1., -1., 0., 1., 1., 0.];
    let normals = [0., 0., 1.].repeat(4);
    let attributes: [(&str, usize, &[f32]); 3] = [
        ("POSITION", 3, &positions),
        ("NORMAL", 3, &normals),
        ("TEXCOORD_0", 2, &uvs),
    ];
    let mirrored = mesh(&attributes, &[0, 1, 2, 0, 2, 3]);
    expect(
        "u to the left",
        normal_of(map(mirrored, 1.0), DVec3::Z),
        m * DVec3::new(-1.0, 1.0, 1.0),
    );

    // Tangents of the file instead of computed ones: a quarter turn, with the other handedness.
    let tangents = [0., 1., 0., -1.].repeat(4);
    let given = mesh(
        &[&attributes[..], &[("TANGENT", 4, &tangents)]].concat(),
        &[0, 1, 2, 0, 2, 3],
    );
    // The bitangent is -(z x y) = x.
    expect(
        "given",
        normal_of(map(given.clone(), 1.0), DVec3::Z),
        DVec3::new(m.y, m.x, m.z),
    );
    let mut given = map(given, 1.0);
    given["nodes"][0]["scale"] = json!([-1, 1, 1]);
    expect(
        "given, mirrored",
        normal_of(given, DVec3::Z),
        DVec3::new(-m.y, m.x, m.z),
    );

    // After a quarter turn about y the square faces +x; mirrored in x, its picture is mirrored.
    let half = std::f64::consts::FRAC_1_SQRT_2;
    let mut turned = map(quad(), 1.0);
    turned["nodes"][0]["rotation"] = json!([0, half, 0, half]);
    expect(
        "turned",
        normal_of(turned, DVec3::X),
        DVec3::new(m.z, m.y, -m.x),
    );
    let mut flipped = map(quad(), 1.0);
    flipped["nodes"][0]["scale"] = json!([-1, 1, 1]);
    expect(
        "mirrored",
        normal_of(flipped, DVec3::Z),
        m * DVec3::new(-1.0, 1.0, 1.0),
    );
}

/// A constant map of (0.5, 0.5, 1) has no effect; 8 bits have no such number, so its texels are set
/// directly.
#[test]
fn a_flat_normal_map_changes_nothing() {
    let plain = sheet();
    let material = json!({ "doubleSided": true, "normalTexture": { "index": 0 } });
    let mut mapped = loaded(&textured(
        plain.clone(),
        material,
        &[png(2, 2, |_, _| [128, 128, 255])],
    ));
    let decoded = mapped.textures[0].levels[0].data[0];
    assert!(
        decoded[..2].iter().all(|x| (x - 1.0 / 255.0).abs() < 1e-6) && decoded[2] == 1.0,
        "{decoded:?}"
    );
    let mut textures = mapped.textures.to_vec();
    textures[0] = Texture::new(RgbImage::filled(2, 2, [0.0, 0.0, 1.0]), Wrap::REPEAT);
    mapped.textures = textures.into();
    let tangents = &mapped.meshes[0].tangents;
    assert!(
        tangents
            .iter()
            .all(|t| (vector([t[0], t[1], t[2]]).length() - 1.0).abs() < F32 && t[3].abs() == 1.0)
    );
    let [with, without] = [&mapped, &loaded(&plain)].map(|scene| seen(scene, [9, 9], DVec3::Z));
    for (a, b) in with
        .normal_alpha
        .data
        .iter()
        .zip(&without.normal_alpha.data)
    {
        assert!((0..4).all(|c| (a[c] - b[c]).abs() < 1e-12), "{a:?}, {b:?}");
    }
}

/// 0 stands for a reflectance of 1; below 1 its specification has no other index.
#[test]
fn indices_of_refraction_below_1_are_named() {
    for (ior, f0, is_named) in [
        (0.0, 1.0, false),
        (1.5, 0.04, false),
        (0.5, 1.0 / 9.0, true),
    ] {
        let mut model = quad();
        model["materials"] = json!([{
            "pbrMetallicRoughness": { "metallicFactor": 0 },
            "extensions": { "KHR_materials_ior": { "ior": ior } },
        }]);
        model["extensionsUsed"] = json!(["KHR_materials_ior"]);
        let scene = loaded(&model);
        assert!(
            (f64::from(scene.materials[0].f0[0]) - f0).abs() < 1e-6,
            "{ior}"
        );
        let named = scene
            .warnings
            .iter()
            .any(|warning| warning.contains("index of refraction"));
        assert_eq!(named, is_named, "{ior}: {:?}", scene.warnings);
    }
}

#[test]
fn axes_replace_factors() {
    let mut model = quad();
    model["materials"] = json!([{
        "pbrMetallicRoughness": { "baseColorFactor": [0.9, 0.5, 0.1, 1], "metallicFactor": 0.375, "roughnessFactor": 0.5 },
        "extensions": { "KHR_materials_ior": { "ior": 1.8 } },
    }]);
    model["extensionsUsed"] = json!(["KHR_materials_ior"]);
    model["extensionsRequired"] = json!(["KHR_materials_ior"]);
    let f0 = ((1.8f64 - 1.0) / (1.8 + 1.0)).powi(2) as f32;
    let values = MaterialOverride {
        albedo: Some([0.9, 0.5, 0.1]),
        metallic: Some(0.375),
        alpha: Some(0.25),
        f0: Some([f0; 3]),
        ..MaterialOverride::default()
    };
    let images = [loaded(&model), loaded(&quad()).apply(&values)]
        .map(|scene| seen(&scene, [3, 3], DVec3::Z));
    let all = |g: &Gbuffer<f64>| {
        [&g.normal_alpha, &g.albedo_metallic, &g.f0_material].map(|image| image.data.concat())
    };
    for (a, b) in all(&images[0])
        .iter()
        .flatten()
        .zip(all(&images[1]).iter().flatten())
    {
        assert!((a - b).abs() < 1e-7, "{a}, {b}");
    }
    // A material without properties is a rough white metal; a value of an axis replaces the map.
    let default = &loaded(&quad()).materials[0];
    assert_eq!(
        (default.albedo, default.metallic, default.alpha, default.f0),
        ([1.0; 3], 1.0, 1.0, [0.04; 3])
    );
    let material =
        json!({ "pbrMetallicRoughness": { "metallicRoughnessTexture": { "index": 0 } } });
    let mapped = loaded(&textured(
        quad(),
        material,
        &[png(1, 1, |_, _| [0, 51, 102])],
    ));
    let set = mapped.apply(&MaterialOverride {
        alpha: Some(0.5),
        ..MaterialOverride::default()
    });
    let texel = |scene: &Scene| {
        let images = seen(scene, [1, 1], DVec3::Z);
        [
            images.normal_alpha.data[0][3],
            images.albedo_metallic.data[0][3],
        ]
    };
    let near = |[a, b]: [f64; 2], [c, d]: [f64; 2]| (a - c).abs() < F32 && (b - d).abs() < F32;
    assert!(near(texel(&mapped), [0.04, 0.4]), "{:?}", texel(&mapped));
    assert!(near(texel(&set), [0.5, 0.4]), "{:?}", texel(&set));
}

#[test]
fn only_double_sided_materials_show_their_back() {
    let mut model = quad();
    let hits = |model: &Value, toward| {
        seen(&loaded(model), [3, 3], toward)
            .mask()
            .data
            .iter()
            .sum::<f32>()
    };
    assert_eq!(
        [hits(&model, DVec3::Z), hits(&model, DVec3::NEG_Z)],
        [9.0, 9.0]
    );
    model["materials"] = json!([{}]);
    assert_eq!(
        [hits(&model, DVec3::Z), hits(&model, DVec3::NEG_Z)],
        [9.0, 0.0]
    );
    model["nodes"][0]["scale"] = json!([1, 1, -1]);
    assert_eq!(
        [hits(&model, DVec3::Z), hits(&model, DVec3::NEG_Z)],
        [0.0, 9.0]
    );
}

#[test]
fn unsupported_and_broken_files_are_refused() {
    type Edit = fn(&mut Value);
    let edits: &[(&str, Edit)] = &[
        ("a skin", |m| {
            m["nodes"][0]["skin"] = json!(0);
            m["skins"] = json!([{ "joints": [0] }]);
        }),
        ("a morph target", |m| {
            m["meshes"][0]["primitives"][0]["targets"] = json!([{ "POSITION": 0 }])
        }),
        ("a coat's texture that does not exist", |m| {
            m["materials"] = json!([{ "extensions": { "KHR_materials_clearcoat": { "clearcoatFactor": 1, "clearcoatTexture": { "index": 7 } } } }]);
        }),
        ("a coat that is not one", |m| {
            m["materials"] = json!([{ "extensions": { "KHR_materials_clearcoat": { "clearcoatFactor": "much" } } }]);
        }),
        ("a sheen that is not one", |m| {
            m["materials"] =
                json!([{ "extensions": { "KHR_materials_sheen": { "sheenColorFactor": [1] } } }]);
        }),
        ("an extension", |m| {
            m["extensionsRequired"] = json!(["KHR_draco_mesh_compression"])
        }),
        ("two extensions", |m| {
            m["extensionsRequired"] = json!(["KHR_a", "KHR_b"])
        }),
        ("an extension in the place of a view", |m| {
            m["extensionsUsed"] = json!(["KHR_draco_mesh_compression"]);
            m["accessors"][0]
                .as_object_mut()
                .unwrap()
                .remove("bufferView");
        }),
        ("version 1", |m| m["asset"]["version"] = json!("1.0")),
        ("a later version that is needed", |m| {
            m["asset"] = json!({ "version": "2.1", "minVersion": "2.1" });
        }),
        ("a ring of nodes", |m| {
            m["nodes"][0]["children"] = json!([0])
        }),
        ("a node of two parents", |m| {
            m["nodes"] = json!([{ "mesh": 0, "children": [1, 1] }, {}])
        }),
        ("no scene", |m| {
            m.as_object_mut().unwrap().remove("scene");
            m["scenes"] = json!([]);
        }),
        ("no area", |m| m["nodes"][0]["scale"] = json!([0, 1, 0])),
        ("far away", |m| {
            m["nodes"][0]["translation"] = json!([1e16, 0, 0])
        }),
        ("an index too large", |m| {
            m["buffers"][3]["uri"] = json!("data:;base64,CQAJAAkACQAJAAkA")
        }),
        ("a short buffer", |m| {
            m["buffers"][0]["byteLength"] = json!(49)
        }),
        ("a long view", |m| {
            m["bufferViews"][0]["byteLength"] = json!(60)
        }),
        ("a view too far", |m| {
            m["bufferViews"][0]["byteOffset"] = json!(1)
        }),
        ("an element too many", |m| {
            m["accessors"][0]["count"] = json!(5)
        }),
        ("no such accessor", |m| {
            m["meshes"][0]["primitives"][0]["attributes"]["POSITION"] = json!(9)
        }),
        ("no elements", |m| m["accessors"][0]["count"] = json!(0)),
        ("four thousand million elements", |m| {
            m["accessors"][0]["count"] = json!(4_000_000_000u64)
        }),
        ("four numbers", |m| {
            m["accessors"][0]["type"] = json!("VEC4")
        }),
        ("whole numbers", |m| {
            m["accessors"][0]["componentType"] = json!(5125)
        }),
        ("fractions as indices", |m| {
            m["accessors"][3]["componentType"] = json!(5126);
            m["accessors"][3]["count"] = json!(3);
        }),
        ("no such file", |m| {
            m["buffers"][0]["uri"] = json!("a%20b.bin")
        }),
        ("a file elsewhere", |m| {
            m["buffers"][0]["uri"] = json!("../a.bin")
        }),
        ("a file elsewhere, by Windows", |m| {
            m["buffers"][0]["uri"] = json!("a\\..\\..\\b.bin")
        }),
        ("a whole path", |m| {
            m["buffers"][0]["uri"] = json!("/etc/passwd")
        }),
        ("data of another form", |m| {
            m["buffers"][0]["uri"] = json!("data:,x")
        }),
        ("no address", |m| {
            m["buffers"][0] = json!({ "byteLength": 48 })
        }),
        ("no object", |m| *m = json!([1])),
    ];
    let mut cases: Vec<(&str, Value)> = Vec::new();
    for (case, edit) in edits {
        let mut model = quad();
        edit(&mut model);
        cases.push((case, model));
    }
    let normal =
        |image: Value| textured(quad(), json!({ "normalTexture": { "index": 0 } }), &[image]);
    cases.push(("an image of nothing", normal(json!({}))));
    cases.push((
        "an image without a type",
        normal(json!({ "bufferView": 0 })),
    ));
    cases.push((
        "an image that is none",
        normal(json!({ "uri": "data:image/png;base64,AAAA" })),
    ));
    let mapped = |material| textured(quad(), material, &[png(1, 1, |_, _| [0; 3])]);
    // The g-buffer has room for one set of texture coordinates.
    let base = |set: u32| json!({ "baseColorTexture": { "index": 0, "texCoord": set } });
    let two =
        json!({ "normalTexture": { "index": 0, "texCoord": 1 }, "pbrMetallicRoughness": base(0) });
    cases.push(("two sets of texture coordinates", mapped(two)));
    cases.push((
        "a set that the mesh lacks",
        mapped(json!({ "pbrMetallicRoughness": base(1) })),
    ));
    let shown = cases
        .iter()
        .map(|(case, model)| format!("{case}: {}", load(model).expect_err(case)));
    assert_snapshot(
        "gltf_files_that_are_refused",
        &shown.collect::<Vec<_>>().join("\n"),
    );
}

#[test]
fn ignored_features_cause_a_warning() {
    let mut model = quad();
    model["materials"] = json!([{ "alphaMode": "MASK" }]);
    model["extensionsUsed"] = json!(["KHR_materials_iridescence"]);
    assert_eq!(
        loaded(&model).warnings,
        ["not read: KHR_materials_iridescence, transparency"]
    );
    model["materials"][0] =
        json!({ "extensions": { "KHR_materials_clearcoat": { "clearcoatFactor": 2 } } });
    assert_eq!(
        loaded(&model).warnings,
        ["not read: KHR_materials_iridescence, the parts of factors beyond [0, 1]"]
    );
}

/// Extensions of materials and nodes count without being listed as used.
#[test]
fn extensions_that_are_not_listed_are_named() {
    let mut model = quad();
    model["asset"] = json!({ "version": "2.1", "minVersion": "2.0" });
    model["materials"] = json!([{ "extensions": {
        "KHR_materials_transmission": { "transmissionFactor": 1 },
        "KHR_materials_clearcoat": { "clearcoatFactor": 1 },
    } }]);
    model["nodes"][0]["extensions"] = json!({ "KHR_node_visibility": { "visible": false } });
    let scene = loaded(&model);
    assert_eq!(
        scene.warnings,
        ["not read: KHR_materials_transmission, KHR_node_visibility"]
    );
    assert!(scene.has_coat());
}

/// One of four normals has no direction: it is the mean of its triangles', and the others stay.
#[test]
fn normals_of_zero_length_are_computed_with_a_warning() {
    let positions = [-1., 1., 0., -1., -1., 0., 1., -1., 0., 1., 1., 0.];
    let normals = [0., 0., 0., 0.6, 0., 0.8, 0., 0., 1., f32::NAN, 0., 0.];
    let model = mesh(
        &[("POSITION", 3, &positions), ("NORMAL", 3, &normals)],
        &[0, 1, 2, 0, 2, 3],
    );
    let scene = loaded(&model);
    assert_eq!(
        scene.warnings,
        ["computed 2 normals that are zero or not finite in the file"]
    );
    let right = [[0., 0., 1.], [0.6, 0., 0.8], [0., 0., 1.], [0., 0., 1.]];
    for (found, right) in scene.meshes[0].normals.iter().zip(right) {
        assert!((vector(*found) - vector(right)).length() < F32, "{found:?}");
    }
}

/// Chunks of unknown types are skipped, wherever the binary one is.
#[test]
fn unknown_chunks_of_a_container_are_skipped() {
    let mut model = quad();
    let bytes: Vec<u8> = [0f32, 0., 0., 1., 0., 0., 1., 1., 0., 0., 1., 0.]
        .into_iter()
        .flat_map(f32::to_le_bytes)
        .collect();
    model["buffers"][0] = json!({ "byteLength": bytes.len() });
    let plain = glb(&model);
    let chunk = |kind: &[u8; 4], data: &[u8]| {
        [&(data.len() as u32).to_le_bytes(), &kind[..], data].concat()
    };
    let unknown = chunk(b"ABCD", &[1, 2, 3, 4]);
    let binary = chunk(b"BIN\0", &bytes);
    let folder = tempfile::tempdir().unwrap();
    let read = |chunks: &[&[u8]]| {
        let mut file = [&[&plain[..]], chunks].concat().concat();
        let length = file.len() as u32;
        file[8..12].copy_from_slice(&length.to_le_bytes());
        std::fs::write(folder.path().join("x.glb"), file).unwrap();
        Scene::load("x.glb", folder.path()).expect("a readable file")
    };
    let expected = read(&[&binary]);
    for chunks in [[&unknown[..], &binary[..]], [&binary, &unknown]] {
        let scene = read(&chunks);
        assert_eq!(scene.hash, expected.hash);
        if chunks[0] == unknown {
            assert!(
                scene.warnings[0].contains("\"ABCD\""),
                "{:?}",
                scene.warnings
            );
        }
    }
}

/// A truncated `.glb`, or one with wrong lengths, is reported as such.
#[test]
fn a_truncated_container_is_refused() {
    let glb = glb(&quad());
    let folder = tempfile::tempdir().unwrap();
    let read = |bytes: &[u8]| {
        std::fs::write(folder.path().join("x.glb"), bytes).unwrap();
        Scene::load("x.glb", folder.path()).map_err(|error| error.to_string())
    };
    assert_eq!(
        read(&glb).expect("a readable file").hash,
        loaded(&quad()).hash
    );
    for length in (0..24).chain((24..glb.len()).step_by(97)) {
        let error = read(&glb[..length]).expect_err("a cut file");
        assert!(
            error.contains("x.glb: ") && error.lines().count() == 1,
            "{error:?}"
        );
    }
    for (at, value) in [(4, 1u32), (8, 3), (8, u32::MAX), (12, u32::MAX), (12, 7)] {
        let mut bytes = glb.clone();
        bytes[at..at + 4].copy_from_slice(&value.to_le_bytes());
        assert!(read(&bytes).is_err(), "{value} at {at}");
    }
}
