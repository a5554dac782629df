//! Files that engines pack: Babylon.js' `.env` and PlayCanvas' atlas, made by their formulas, and
//! exact ones that `bake` writes.

use super::files::faces;
use super::scores::marked_light;
use glam::{DVec2, DVec3};
use image::{ImageFormat, Rgba, RgbaImage};
use rayon::prelude::*;
use serde_json::json;
use splitsum::bake::ENVIRONMENT_FORMATS;
use splitsum::bake::convention::{Axes, Preset};
use splitsum::bake::judge::{Judged, Judging, Truth};
use splitsum::bake::make::{Making, make};
use splitsum::bake::source::{Reading, read};
use splitsum::base::math::equirect::direction_from_uv;
use splitsum::base::math::spherical_harmonics::irradiance;
use splitsum::base::names::Listed;
use splitsum::base::pixels::RgbImage;
use splitsum::instrument::brdf::Ggx;
use splitsum::instrument::environment::layout::LAYOUTS;
use splitsum::instrument::environment::{Environment, LoadOptions};
use splitsum::instrument::precompute::exact_quadrature;
use splitsum::instrument::precompute::prefilter::Kernel;
use splitsum::instrument::precompute::sh9::reference::project_bilinear;
use std::f64::consts::PI;
use std::io::Cursor;
use std::path::Path;

pub fn judged_file(light: &Environment, path: &Path) -> Judged {
    let bake = read(&[path.display().to_string()], Reading::default()).unwrap();
    let judging = Judging::stated(&bake.stated).unwrap();
    judging.judge(light, &bake, |_| ()).unwrap()
}

fn assert_good(judged: &Judged) {
    for part in judged.parts() {
        assert!(part.verdict.is_good(), "{}: {}", part, judged.verdict());
    }
}

fn encoded(image: &RgbaImage, format: ImageFormat) -> Vec<u8> {
    let mut bytes = Cursor::new(Vec::new());
    image.write_to(&mut bytes, format).unwrap();
    bytes.into_inner()
}

/// `toRGBD` of Babylon.js: a divisor of whole bytes, then gamma 2.2.
fn rgbd(color: DVec3) -> Rgba<u8> {
    let divisor = (255.0 / color.max_element()).floor().clamp(1.0, 255.0) / 255.0;
    let signal = |value: f64| (255.0 * (value * divisor).min(1.0).powf(1.0 / 2.2)).round() as u8;
    Rgba([
        signal(color.x),
        signal(color.y),
        signal(color.z),
        (255.0 * divisor).round() as u8,
    ])
}

/// The file of Babylon.js' writer for exact levels: six pictures a level, rows from the bottom.
fn babylon_env(light: &Environment, side: u32, format: ImageFormat) -> Vec<u8> {
    let axes = Axes::parse("-x+y+z").unwrap();
    let level_count = side.ilog2() + 1;
    let alphas: Vec<f64> = (0..level_count)
        .map(|k| (f64::from(k) / 0.8).exp2() / f64::from(side))
        .collect();
    let truth = Truth::new(light, Kernel::cosine(&Ggx), &alphas);
    let mut images = Vec::new();
    let mut mipmaps = Vec::new();
    for (k, alpha) in alphas.iter().enumerate() {
        let map = (k > 0).then(|| truth.prefiltered(*alpha));
        let size = side >> k;
        let value = |d: DVec3| {
            let world = axes.to_world(d);
            map.as_ref()
                .map_or_else(|| light.radiance(world), |map| map.value(world))
        };
        for face in faces(&LAYOUTS[0], [size; 2], value) {
            let image = RgbaImage::from_fn(size, size, |x, y| {
                rgbd(DVec3::from_array(face.get(x, size - 1 - y).map(f64::from)))
            });
            let bytes = encoded(&image, format);
            mipmaps.push(json!({ "length": bytes.len(), "position": images.len() }));
            images.extend(bytes);
        }
    }
    let header = json!({
        "version": 2, "width": side, "imageType": format.to_mime_type(),
        "irradiance": polynomial(light, axes),
        "specular": { "mipmaps": mipmaps, "lodGenerationScale": 0.8 },
    });
    let magic = [0x86, 0x16, 0x87, 0x96, 0xf6, 0xd6, 0x96, 0x36];
    [&magic[..], header.to_string().as_bytes(), &[0], &images].concat()
}

/// Irradiance over π as a polynomial in the map's axes, of which degrees 1 and 2 are convolved with
/// the cosine twice: times 2/3 and 1/4. Finite differences of the function give the terms.
fn polynomial(light: &Environment, axes: Axes) -> serde_json::Value {
    let radiance = project_bilinear(&exact_quadrature(&light.image));
    let value = |d: DVec3| irradiance(&radiance, axes.to_world(d)) / PI;
    let odd = |d: DVec3| 0.5 * (value(d) - value(-d)) * (2.0 / 3.0);
    let even = |d: DVec3| 0.5 * (value(d) + value(-d));
    let [x, y, z] = DVec3::AXES;
    let mean = (even(x) + even(y) + even(z)) / 3.0;
    let square = |d: DVec3| mean + 0.25 * (even(d) - mean);
    let mixed = |a: DVec3, b: DVec3| {
        let diagonal = even((a + b).normalize()) - even((a - b).normalize());
        0.25 * diagonal
    };
    json!({
        "x": odd(x).to_array(), "y": odd(y).to_array(), "z": odd(z).to_array(),
        "xx": square(x).to_array(), "yy": square(y).to_array(), "zz": square(z).to_array(),
        "yz": mixed(y, z).to_array(), "zx": mixed(z, x).to_array(), "xy": mixed(x, y).to_array(),
    })
}

/// Means and slopes along the axes of the world.
fn moments(image: &RgbImage) -> [DVec3; 4] {
    let [height, width] = [image.height, image.width];
    let mut sums = [DVec3::ZERO; 4];
    let mut whole = 0.0;
    for y in 0..height {
        for x in 0..width {
            let size = DVec2::new(width.into(), height.into());
            let d = direction_from_uv((DVec2::new(x.into(), y.into()) + 0.5) / size);
            let weight = (1.0 - d.y * d.y).sqrt();
            let color = DVec3::from_array(image.get(x, y).map(f64::from));
            whole += weight;
            sums[0] += weight * color;
            for (sum, cos) in sums[1..].iter_mut().zip(d.to_array()) {
                *sum += weight * cos * color;
            }
        }
    }
    sums.map(|sum| sum / whole)
}

#[test]
fn an_env_of_babylon_is_an_environment_along_its_own_axes() {
    let light = marked_light();
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("light.env");
    std::fs::write(&path, babylon_env(&light, 64, ImageFormat::Png)).unwrap();
    let options = LoadOptions {
        more_formats: ENVIRONMENT_FORMATS,
        ..LoadOptions::default()
    };
    let load = |spec: &str| Environment::load(spec, dir.path(), &options).unwrap();
    let found = load("light.env");
    let expected = moments(&light.image);
    for (found, expected_moment) in moments(&found.image).iter().zip(expected) {
        let off = (*found - expected_moment).abs().max_element();
        assert!(
            off < 0.02 * expected[0].max_element(),
            "{found} {expected_moment}"
        );
    }
    let turned = moments(&load("light.env#+x+y-z").image);
    assert!((turned[3] + expected[3]).abs().max_element() < 0.02 * expected[0].max_element());
}

#[test]
fn an_exact_env_of_babylon_is_good() {
    let light = marked_light();
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("light.env");
    // The image crate writes WebP without loss.
    let packed = babylon_env(&light, 32, ImageFormat::WebP);
    std::fs::write(&path, &packed).unwrap();
    assert_good(&judged_file(&light, &path));
    let file = babylon_env(&light, 32, ImageFormat::Png);
    std::fs::write(&path, &file).unwrap();
    let judged = judged_file(&light, &path);
    assert_eq!(judged.levels.len(), 6);
    assert!((judged.levels[4].alpha - 1.0).abs() < 1e-12);
    assert!(judged.sh.is_some());
    assert_good(&judged);

    let refused = |bytes: &[u8], part: &str| {
        std::fs::write(&path, bytes).unwrap();
        let files = [path.display().to_string()];
        let message = read(&files, Reading::default()).unwrap_err().to_string();
        assert!(
            message.contains(part) && message.lines().count() == 1,
            "{message}"
        );
    };
    refused(&file[..file.len() - 1], "ends behind the file");
    refused(&file[1..], "another magic number");
    refused(&file[..100], "its header has no end");
    refused(&packed[..packed.len() - 1], "ends behind the file");
    let at = file
        .windows(9)
        .position(|part| part == b"image/png")
        .unwrap();
    let renamed = [&file[..at], b"image/bmp", &file[at + 9..]].concat();
    refused(&renamed, "its images are image/bmp");
}

/// How an encoder rounds the scale of RGBP to a byte.
#[derive(Clone, Copy, PartialEq)]
pub enum RgbpScale {
    /// Brings the largest root below 1.
    RoundedDown,
    /// As PlayCanvas 2.23.3 does: the largest root is cut at 1.
    RoundedUp,
}

/// RGBP: roots over a scale of whole bytes.
fn rgbp(color: DVec3, rounding: RgbpScale) -> Rgba<u8> {
    let root = color.map(f64::sqrt);
    let largest = root.max_element().clamp(1.0, 8.0);
    let scale = 255.0 * (1.0 - (largest - 1.0) / 7.0);
    let scale = match rounding {
        RgbpScale::RoundedDown => scale.floor(),
        RgbpScale::RoundedUp => scale.ceil(),
    } / 255.0;
    let byte = |value: f64| (255.0 * (value / (8.0 - 7.0 * scale)).min(1.0)).round() as u8;
    Rgba([
        byte(root.x),
        byte(root.y),
        byte(root.z),
        (255.0 * scale).round() as u8,
    ])
}

/// The rectangles of `generateAtlas`, as its comments list them: x, y, width, height of the
/// levels, then of irradiance.
const RECTANGLES: [[u32; 4]; 7] = [
    [0, 0, 512, 256],
    [0, 256, 256, 128],
    [0, 384, 128, 64],
    [0, 448, 64, 32],
    [0, 480, 32, 16],
    [0, 496, 16, 8],
    [128, 384, 64, 32],
];

/// An atlas of exact levels for these widths.
fn atlas(light: &Environment, alphas: [f64; 6]) -> RgbaImage {
    let truth = Truth::new(light, Kernel::cosine(&Ggx), &alphas);
    let maps: Vec<_> = alphas[1..]
        .iter()
        .map(|alpha| truth.prefiltered(*alpha))
        .collect();
    atlas_of(light, RgbpScale::RoundedDown, |k, d| match k {
        0 => light.radiance(d),
        _ => maps[k - 1].value(d),
    })
}

/// An atlas whose levels hold `value`; texture coordinates reach from border to border.
pub fn atlas_of(
    light: &Environment,
    scale: RgbpScale,
    value: impl Fn(usize, DVec3) -> DVec3 + Sync,
) -> RgbaImage {
    let (kernel, alpha) = Truth::of_irradiance();
    let irradiance = Truth::new(light, kernel, &[alpha]).prefiltered(alpha);
    let mut image = RgbaImage::from_pixel(512, 512, Rgba([0, 0, 0, 255]));
    for (k, [left, top, width, height]) in RECTANGLES.into_iter().enumerate() {
        let inner = DVec2::new(f64::from(width - 2), f64::from(height - 2));
        let texel = |(x, y): (u32, u32)| {
            let uv = (DVec2::new(x.into(), y.into()) - 0.5) / inner;
            let d = direction_from_uv(uv);
            let value = if k == 6 {
                irradiance.value(d)
            } else {
                value(k, d)
            };
            (left + x, top + y, rgbp(value, scale))
        };
        let places: Vec<(u32, u32)> = (0..height)
            .flat_map(|y| (0..width).map(move |x| (x, y)))
            .collect();
        let texels: Vec<_> = places.into_par_iter().map(texel).collect();
        for (x, y, pixel) in texels {
            image.put_pixel(x, y, pixel);
        }
    }
    image
}

#[test]
fn an_exact_atlas_of_playcanvas_is_good_and_its_own_widths_are_named() {
    let light = marked_light();
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("atlas.png");
    let by = |last: f64| std::array::from_fn(|k| (k as f64 / last).powi(2));
    atlas(&light, by(5.0)).save(&path).unwrap();
    let judged = judged_file(&light, &path);
    let sizes: Vec<[u32; 2]> = judged.levels.iter().map(|level| level.size).collect();
    assert_eq!(
        sizes,
        [
            [510, 254],
            [254, 126],
            [126, 62],
            [62, 30],
            [30, 14],
            [14, 6]
        ]
    );
    assert_good(&judged);
    atlas(&light, by(5.5)).save(&path).unwrap();
    let verdict = judged_file(&light, &path).verdict();
    assert!(
        verdict.contains("level k is made for roughness k/(n - 1/2)"),
        "{verdict}"
    );
}

#[test]
fn packed_files_that_bake_writes_are_good() {
    let light = marked_light();
    for (engine, side) in [("babylon-env", 64), ("playcanvas-atlas", 512)] {
        let dir = tempfile::tempdir().unwrap();
        let making = Making::new(Preset::parse(engine).unwrap(), &light, side);
        making.check().unwrap();
        let baked = make(&making, dir.path()).unwrap();
        assert!(
            baked.levels.iter().all(|level| level.relmse < 3e-4),
            "{engine}: {:?}",
            baked.levels
        );
        assert!(!dir.path().join("taps.ktx2").exists());
        assert_good(&judged_file(&light, dir.path()));
        let file = dir.path().join(making.preset.product().specular);
        assert_good(&judged_file(&light, &file));
    }
}

/// Linear lookups at the edge of a rectangle find the other side of the map, not another level.
#[test]
fn borders_of_a_written_atlas_go_on_around_the_map() {
    let light = marked_light();
    let dir = tempfile::tempdir().unwrap();
    let preset = Preset::parse("playcanvas-atlas").unwrap();
    make(&Making::new(preset, &light, 512), dir.path()).unwrap();
    let found = image::open(dir.path().join("atlas.png"))
        .unwrap()
        .to_rgba8();
    let right = atlas(&light, std::array::from_fn(|k| (k as f64 / 5.0).powi(2)));
    let decoded = |pixel: &Rgba<u8>| {
        let [r, g, b, a] = pixel.0.map(|byte| f64::from(byte) / 255.0);
        (DVec3::new(r, g, b) * (8.0 - 7.0 * a)).map(|root| root * root)
    };
    for [left, top, width, height] in RECTANGLES {
        for y in 0..height {
            for x in 0..width {
                let at = |image: &RgbaImage| decoded(image.get_pixel(left + x, top + y));
                let off = (at(&found) - at(&right)).abs();
                let most = at(&right).max_element().max(0.1);
                assert!(
                    off.max_element() < 0.06 * most,
                    "{x},{y} of {width}x{height}: {} for {}",
                    at(&found),
                    at(&right)
                );
            }
        }
    }
}

/// Coefficients that F3D 4.0.0 kept of a map with a red, a green and a blue lamp along x, y and z: in
/// the axes of its cube x is our z, and z is our -x.
#[test]
fn coefficients_of_f3d_are_read_in_the_axes_of_its_cube() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/golden/f3d_sh.vtt");
    let bake = read(&[path.to_owned()], Reading::default()).unwrap();
    let radiance = bake.sh.unwrap().radiance;
    assert!(
        (radiance[0] - 6.4235).abs().max_element() < 1e-3,
        "{}",
        radiance[0]
    );
    assert!((radiance[1].y - 3.0855).abs() < 1e-3, "{}", radiance[1]);
    assert!((radiance[2].x + 2.6896).abs() < 1e-3, "{}", radiance[2]);
    assert!((radiance[3].z - 3.3815).abs() < 1e-3, "{}", radiance[3]);
    // A file that ends early, and one of another type.
    let text = std::fs::read_to_string(path).unwrap();
    let folder = tempfile::tempdir().unwrap();
    for (changed, part) in [
        (
            text[..text.rfind('_').unwrap() + 10].to_owned(),
            "ends behind the file",
        ),
        (text.replace("Float32", "Int8"), "is of type"),
        (
            text.replace("Components=\"9\"", "Components=\"3\""),
            "27 numbers",
        ),
    ] {
        let file = folder.path().join("sh.vtt");
        std::fs::write(&file, changed).unwrap();
        let fault = read(&[file.display().to_string()], Reading::default()).unwrap_err();
        assert!(fault.to_string().contains(part), "{fault}");
    }
}
