//! Maps of materials: their levels, their edges, and transforms of texture coordinates.

use super::gltf::{loaded, quad, seen};
use crate::gltf_files::{load, png, textured};
use base64::Engine;
use base64::prelude::BASE64_STANDARD;
use glam::DVec3;
use serde_json::{Value, json};
use splitsum::base::color::srgb_decode;
use splitsum::base::pixels::RgbImage;
use splitsum::base::pixels::lookup::{Edge, Wrap, bilinear};
use splitsum::instrument::scene::{Scene, Texture};

/// Rounding of f32 numbers of order 1.
const F32: f64 = 1e-6;

/// The square with a map of base colour, transformed by `transform` and continued by `sampler`.
fn square(transform: Value, sampler: Value, image: Value) -> Scene {
    let info = json!({ "index": 0, "extensions": { "KHR_texture_transform": transform } });
    let material =
        json!({ "doubleSided": true, "pbrMetallicRoughness": { "baseColorTexture": info } });
    let mut model = textured(quad(), material, &[image]);
    model["extensionsUsed"] = json!(["KHR_texture_transform"]);
    model["extensionsRequired"] = json!(["KHR_texture_transform"]);
    model["samplers"] = json!([sampler]);
    model["textures"][0]["sampler"] = json!(0);
    let scene = loaded(&model);
    assert!(scene.warnings.is_empty(), "{:?}", scene.warnings);
    scene
}

/// The picture of the square with a map of `count` squared texels, a texel a pixel: column and row
/// of each visible texel.
fn texels(scene: &Scene, size: [u32; 2], count: u32) -> Vec<[u32; 2]> {
    let linear: Vec<f64> = (0..count)
        .map(|i| srgb_decode((40 * i) as f32 / 255.0).into())
        .collect();
    let nearest = |value: f64| {
        linear
            .iter()
            .position(|x| (x - value).abs() < F32)
            .expect("a texel of the map") as u32
    };
    seen(scene, size, DVec3::Z)
        .albedo_metallic
        .data
        .iter()
        .map(|texel| [nearest(texel[0]), nearest(texel[1])])
        .collect()
}

fn places(x: u32, y: u32) -> [u8; 3] {
    [40 * x as u8, 40 * y as u8, 0]
}

/// The example of the extension: the lower left quadrant, turned clockwise by 90 degrees.
#[test]
fn a_texture_transform_shows_the_quadrant_of_its_specification() {
    let transform =
        json!({ "offset": [0, 1], "rotation": std::f64::consts::FRAC_PI_2, "scale": [0.5, 0.5] });
    let scene = square(transform, json!({}), png(4, 4, places));
    // Turned clockwise, the picture's left column is its top row, the lowest texel first.
    assert_eq!(texels(&scene, [2, 2], 4), [[0, 3], [0, 2], [1, 3], [1, 2]]);
    // (u, v) -> (height v, 1 - u/2): corners at u, v 0, 0; 0, 1; 1, 1; 1, 0, of which the mesh
    // keeps 1 - v.
    for height in [0.5, 0.25] {
        let transform = json!({ "offset": [0, 1], "rotation": std::f64::consts::FRAC_PI_2, "scale": [0.5, height] });
        let expected = [[0.0, 0.0], [height, 0.0], [height, 0.5], [0.0, 0.5]];
        for (uv, expected) in square(transform, json!({}), png(4, 4, places)).meshes[0]
            .uvs
            .iter()
            .zip(expected)
        {
            assert!(
                (0..2).all(|c| (f64::from(uv[c]) - expected[c]).abs() < F32),
                "{uv:?} for {expected:?}"
            );
        }
    }
    // The transform selects the set of coordinates, and the maps of a material must agree.
    let with = |normal: Value| {
        let material = json!({ "normalTexture": normal, "pbrMetallicRoughness": { "baseColorTexture": { "index": 0 } } });
        load(&textured(quad(), material, &[png(1, 1, |_, _| [128; 3])]))
    };
    let of = |transform: Value| json!({ "index": 0, "extensions": { "KHR_texture_transform": transform } });
    with(of(json!({ "scale": [1, 1] }))).expect("it changes nothing");
    for (transform, expected) in [
        (json!({ "texCoord": 1 }), "coordinates 0 and 1"),
        (json!({ "scale": [2, 1] }), "several KHR_texture_transform"),
        (
            json!({ "rotation": "x" }),
            "KHR_texture_transform of its normal map",
        ),
    ] {
        let error = with(of(transform)).expect_err(expected);
        assert!(error.contains(expected), "{error}");
    }
}

/// Twice the width and the height of a map of three texels, from two texels before it and from one
/// row above it.
#[test]
fn maps_continue_by_their_samplers() {
    for (wrap, columns) in [
        (33071, [0, 0, 0, 1, 2, 2]),
        (33648, [1, 0, 0, 1, 2, 2]),
        (10497, [1, 2, 0, 1, 2, 0]),
    ] {
        let transform = json!({ "offset": [-2.0 / 3.0, -1.0 / 3.0], "scale": [2, 2] });
        let scene = square(
            transform,
            json!({ "wrapS": wrap, "wrapT": 10497 }),
            png(3, 3, places),
        );
        let rows = [2, 0, 1, 2, 0, 1];
        let expected: Vec<[u32; 2]> = rows
            .into_iter()
            .flat_map(|row| columns.map(|column| [column, row]))
            .collect();
        assert_eq!(texels(&scene, [6, 6], 3), expected, "{wrap}");
    }
    // An image with two samplers is two maps.
    let sheen = json!({ "sheenColorFactor": [1, 1, 1], "sheenColorTexture": { "index": 1 } });
    let base = json!({ "baseColorTexture": { "index": 0 } });
    let material =
        json!({ "pbrMetallicRoughness": base, "extensions": { "KHR_materials_sheen": sheen } });
    let mut model = textured(quad(), material, &[png(3, 3, places)]);
    model["samplers"] = json!([{}, { "wrapS": 33071 }]);
    model["textures"] = json!([{ "source": 0, "sampler": 0 }, { "source": 0, "sampler": 1 }]);
    assert_eq!(loaded(&model).textures.len(), 2);
}

#[test]
fn a_distant_map_is_the_mean_over_a_pixel() {
    let black_and_white = |x: u32, y: u32| [if (x + y).is_multiple_of(2) { 255 } else { 0 }; 3];
    let far = json!({ "scale": [16, 16] });
    // 64 texels a pixel each way: more than the map has.
    let scene = square(far, json!({}), png(16, 16, black_and_white));
    for texel in &seen(&scene, [4, 4], DVec3::Z).albedo_metallic.data {
        assert!(
            texel[..3].iter().all(|x| (x - 0.5).abs() < F32),
            "{texel:?}"
        );
    }
    // On a white texel the first level is 1 and every other level 1/2, so between one and two
    // texels a pixel the blend gives the level.
    for texels in [0.5f64, 1.0, 1.25, 1.7, 3.0] {
        let scale = texels / 16.0;
        let offset = 4.5 / 16.0 - 0.5 * scale;
        let transform = json!({ "scale": [scale, scale], "offset": [offset, offset] });
        let found = seen(
            &square(transform, json!({}), png(16, 16, black_and_white)),
            [1, 1],
            DVec3::Z,
        );
        let wanted = 1.0 - 0.5 * texels.log2().clamp(0.0, 1.0);
        let texel = found.albedo_metallic.data[0];
        assert!(
            (texel[0] - wanted).abs() < 1e-5,
            "{texels} texels a pixel: {} for {wanted}",
            texel[0]
        );
    }
    // Two texels a pixel: each is the mean of four.
    let scene = square(json!({}), json!({}), png(4, 4, places));
    let linear = |i: u32| f64::from(srgb_decode((40 * i) as f32 / 255.0));
    let images = seen(&scene, [2, 2], DVec3::Z);
    for (x, y) in [(0, 0), (1, 0), (0, 1), (1, 1)] {
        let mean = |i: u32| 0.5 * (linear(2 * i) + linear(2 * i + 1));
        let found = images.albedo_metallic.get(x, y);
        assert!(
            (found[0] - mean(x)).abs() < F32 && (found[1] - mean(y)).abs() < F32,
            "({x}, {y}): {found:?}"
        );
    }
}

/// If no side is a power of two, the mean is kept, and a texel is the mean of the part of the image
/// that it covers.
#[test]
fn levels_keep_the_mean() {
    let value = |x: u32, y: u32| {
        [
            (x * x + 3 * y) as f32,
            (x as f32).sin(),
            1.0 / (1.0 + y as f32),
        ]
    };
    for [width, height] in [[1, 1], [5, 3], [7, 1], [12, 20]] {
        let image = RgbImage::from_fn(width, height, value);
        let mean = |image: &RgbImage| {
            let sum: DVec3 = image
                .data
                .iter()
                .map(|texel| DVec3::from_array(texel.map(f64::from)))
                .sum();
            sum / image.data.len() as f64
        };
        let wanted = mean(&image);
        let texture = Texture::new(image, Wrap::REPEAT);
        assert_eq!(texture.levels.len() as u32, width.max(height).ilog2() + 1);
        for level in &texture.levels {
            assert!(
                (mean(level) - wanted).length() < 1e-5 * wanted.length(),
                "{width} x {height}: {}",
                mean(level)
            );
        }
        assert_eq!(texture.mean(), texture.levels.last().unwrap().data[0]);
    }
    let ramp = Texture::new(RgbImage::from_fn(3, 1, |x, _| [x as f32; 3]), Wrap::REPEAT);
    assert_eq!(ramp.levels[1].data, [[1.0; 3]]);
    let five = Texture::new(RgbImage::from_fn(5, 1, |x, _| [x as f32; 3]), Wrap::REPEAT);
    // 2.5 texels each: 0, 1 and half of 2.
    assert!(
        (five.levels[1].data[0][0] - 0.8).abs() < 1e-6
            && (five.levels[1].data[1][0] - 3.2).abs() < 1e-6
    );
}

/// Mirrored, a map is even about each of its edges; of odd period otherwise.
#[test]
fn edges_have_the_symmetries_of_their_names() {
    let image = RgbImage::from_fn(5, 3, |x, y| [(x * 7 + y * y) as f32; 3]);
    let at = |u: f64, v: f64, wrap: Wrap| {
        bilinear(&image, glam::DVec2::new(u, v), wrap, |texel| {
            DVec3::from_array(texel.map(f64::from))
        })
        .x
    };
    for (u, v) in [(0.13, 0.4), (0.77, -0.9), (-0.31, 1.6), (3.05, 0.02)] {
        let mirror = Wrap(Edge::Mirror, Edge::Repeat);
        for edge in [-2.0, 0.0, 1.0, 3.0] {
            assert!(
                (at(edge + u, v, mirror) - at(edge - u, v, mirror)).abs() < 1e-9,
                "{u} about {edge}"
            );
        }
        assert!((at(u, v, mirror) - at(u, v + 2.0, mirror)).abs() < 1e-9);
        let clamped = Wrap(Edge::Repeat, Edge::Clamp);
        assert!((at(u, 1.0 + v.abs(), clamped) - at(u, 9.0, clamped)).abs() < 1e-9);
        assert!((at(u, v, clamped) - at(u - 1.0, v, clamped)).abs() < 1e-9);
    }
}

/// 2^25 texels fit; with one more map each side of the larger one is halved, in either order.
#[test]
fn too_many_maps_are_made_coarser() {
    let [large, small] = [[8192, 4096], [4, 4]].map(|[width, height]| {
        let mut file = std::io::Cursor::new(Vec::new());
        let halves =
            image::GrayImage::from_fn(width, height, |x, _| image::Luma([if 2 * x < width { 0 } else { 255 }]));
        halves.write_to(&mut file, image::ImageFormat::Png).expect("a picture in memory");
        json!({ "uri": format!("data:image/png;base64,{}", BASE64_STANDARD.encode(file.into_inner())) })
    });
    let load = |images: &[Value]| {
        let map = |index| {
            if index < images.len() {
                json!({ "index": index })
            } else {
                Value::Null
            }
        };
        let material = json!({ "baseColorTexture": map(0), "metallicRoughnessTexture": map(1) });
        loaded(&textured(
            quad(),
            json!({ "pbrMetallicRoughness": material }),
            images,
        ))
    };
    let sizes = |scene: &Scene| -> Vec<[u32; 2]> {
        scene
            .textures
            .iter()
            .map(|map| [map.levels[0].width, map.levels[0].height])
            .collect()
    };
    let alone = load(std::slice::from_ref(&large));
    assert_eq!(
        (sizes(&alone), alone.warnings.len()),
        (vec![[8192, 4096]], 0)
    );
    drop(alone);
    for order in [[0, 1], [1, 0]] {
        let scene = load(&order.map(|i| [&large, &small][i].clone()));
        assert_eq!(sizes(&scene), order.map(|i| [[4096, 2048], [4, 4]][i]));
        assert!(
            scene.warnings[0].ends_with("were halved to at most 4096 x 4096"),
            "{:?}",
            scene.warnings
        );
        for map in scene.textures.iter() {
            let level = &map.levels[0];
            let wanted = (0..level.data.len() as u32).map(|i| {
                if 2 * (i % level.width) < level.width {
                    0.0
                } else {
                    1.0
                }
            });
            assert!(
                level
                    .data
                    .iter()
                    .zip(wanted)
                    .all(|(texel, wanted)| *texel == [wanted; 3]),
                "halves stay halves"
            );
        }
    }
}
