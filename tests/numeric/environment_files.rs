//! Environments of other projections: cubes in texture files and in OpenEXR, lat-long maps with
//! texels on their edges, and JPEG files with a gain map.

use exr::meta::attribute::EnvironmentMap;
use exr::prelude::{
    Encoding, Image, Layer, LayerAttributes, SpecificChannels, Vec2, WritableImage,
};
use glam::{DVec2, DVec3};
use splitsum::bake::ENVIRONMENT_FORMATS;
use splitsum::bake::container::{Encoding as Texture, FORMATS, Texel};
use splitsum::base::math::equirect;
use splitsum::base::names::Listed;
use splitsum::base::pixels::{Content, GrayImage, RgbImage, TexelPosition, exr as exr_file};
use splitsum::instrument::environment::layout::MapLayout;
use splitsum::instrument::environment::{Environment, LoadOptions};
use std::f64::consts::PI;
use std::path::Path;

/// Another slope along each axis in each channel.
fn marker(d: DVec3) -> DVec3 {
    DVec3::new(2.0 + d.x, 1.0 + d.y / 2.0, 0.5 + d.z / 4.0)
}

/// Root of the mean squared error of a map at the centres of its texels.
fn rms_error(map: &Environment, radiance: impl Fn(DVec3) -> DVec3) -> f64 {
    let size = DVec2::new(map.image.width.into(), map.image.height.into());
    let places = (0..map.image.height).flat_map(|y| (0..map.image.width).map(move |x| (x, y)));
    let squares: f64 = places
        .map(|(x, y)| {
            let uv = (DVec2::new(x.into(), y.into()) + 0.5) / size;
            let found = DVec3::from_array(map.image.get(x, y).map(f64::from));
            (found - radiance(equirect::direction_from_uv(uv))).length_squared()
        })
        .sum();
    (squares / (size.x * size.y)).sqrt()
}

fn load(spec: &str, folder: &Path, texels: Option<TexelPosition>) -> Result<Environment, String> {
    let options = LoadOptions {
        texels,
        more_formats: ENVIRONMENT_FORMATS,
        ..LoadOptions::default()
    };
    Environment::load(spec, folder, &options).map_err(|error| error.to_string())
}

#[test]
fn cubes_in_texture_files_are_environments() {
    let folder = tempfile::tempdir().unwrap();
    let layout = MapLayout::listed("cube");
    let side = 64;
    let face = |face: u32| {
        RgbImage::from_fn(side, side, |x, y| {
            let uv = (DVec2::new(x.into(), y.into()) + 0.5) / f64::from(side);
            marker((layout.direction)(face, uv)).as_vec3().to_array()
        })
    };
    let levels = [(0..6).map(face).collect()];
    for format in FORMATS {
        let name = format!("cube.{}", format.extension);
        let file = (format.write)(&Texture {
            texel: Texel::listed("rgba32f"),
            levels: &levels,
            keys: &[],
            is_packed: false,
        });
        std::fs::write(folder.path().join(&name), file).unwrap();
        let plain = load(&name, folder.path(), None).unwrap();
        assert!(rms_error(&plain, marker) < 5e-4, "{name}");
        assert!(plain.warnings[0].contains("+x+y+z"), "{:?}", plain.warnings);
        // The file's x is the world's -x, and its z the world's y.
        let turned = load(&format!("{name}#-x+z+y"), folder.path(), None).unwrap();
        let expected = |d: DVec3| marker(DVec3::new(-d.x, d.z, d.y));
        assert!(rms_error(&turned, expected) < 5e-4, "{name}");
        assert!(turned.warnings.is_empty(), "{:?}", turned.warnings);
        let message = load(&format!("{name}#bevy"), folder.path(), None).unwrap_err();
        assert!(message.contains("is not a list of axes"), "{message}");
    }
    let without = Environment::load("cube.ktx2", folder.path(), &LoadOptions::default());
    assert!(
        without
            .unwrap_err()
            .to_string()
            .contains("expected one of .hdr")
    );
}

/// Writes an OpenEXR file with the attribute `envmap`.
fn write_envmap(path: &Path, image: &RgbImage, kind: EnvironmentMap) {
    let size = Vec2(image.width as usize, image.height as usize);
    let channels = SpecificChannels::rgb(|place: Vec2<usize>| {
        let [r, g, b] = image.get(place.x() as u32, place.y() as u32);
        (r, g, b)
    });
    let attributes = LayerAttributes {
        environment_map: Some(kind),
        ..LayerAttributes::default()
    };
    let layer = Layer::new(size, attributes, Encoding::UNCOMPRESSED, channels);
    Image::from_layer(layer).write().to_file(path).unwrap();
}

#[test]
fn openexr_cubes_are_read_as_its_library_defines_them() {
    let folder = tempfile::tempdir().unwrap();
    let side = 65;
    // ImfEnvmap.cpp: the column and the row of a face grow along these directions.
    let axes = [
        (DVec3::X, DVec3::Z, -DVec3::Y),
        (-DVec3::X, -DVec3::Z, -DVec3::Y),
        (DVec3::Y, DVec3::X, -DVec3::Z),
        (-DVec3::Y, DVec3::X, DVec3::Z),
        (DVec3::Z, -DVec3::X, -DVec3::Y),
        (-DVec3::Z, DVec3::X, -DVec3::Y),
    ];
    let strip = RgbImage::from_fn(side, 6 * side, |x, y| {
        let (centre, right, down) = axes[(y / side) as usize];
        let at = |i: u32| 2.0 * f64::from(i) / f64::from(side - 1) - 1.0;
        let point = centre + at(x) * right + at(y % side) * down;
        marker(point.normalize()).as_vec3().to_array()
    });
    write_envmap(
        &folder.path().join("cube.exr"),
        &strip,
        EnvironmentMap::Cube,
    );
    let cube = load("cube.exr", folder.path(), None).unwrap();
    assert!(rms_error(&cube, marker) < 5e-4);
    // Read with texels half a texel inside, the map is another.
    let centres = load("cube.exr", folder.path(), Some(TexelPosition::Centres)).unwrap();
    assert!(rms_error(&centres, marker) > 2e-3);
    let flat = RgbImage::filled(8, 4, [1.0; 3]);
    write_envmap(&folder.path().join("flat.exr"), &flat, EnvironmentMap::Cube);
    let message = load("flat.exr", folder.path(), None).unwrap_err();
    assert!(message.contains("six square faces"), "{message}");
}

#[test]
fn texels_of_a_lat_long_map_may_lie_on_its_edges() {
    let folder = tempfile::tempdir().unwrap();
    let [width, height] = [64, 32];
    let nodes = RgbImage::from_fn(width, height, |x, y| {
        let uv = DVec2::new(x.into(), y.into())
            / DVec2::new(f64::from(width - 1), f64::from(height - 1));
        marker(equirect::direction_from_uv(uv)).as_vec3().to_array()
    });
    let path = folder.path().join("map.exr");
    write_envmap(&path, &nodes, EnvironmentMap::LatitudeLongitude);
    let edges = load("map.exr", folder.path(), Some(TexelPosition::Edges)).unwrap();
    assert!(rms_error(&edges, marker) < 1e-3);
    assert!(edges.warnings.is_empty(), "{:?}", edges.warnings);
    let centres = load("map.exr", folder.path(), Some(TexelPosition::Centres)).unwrap();
    assert_eq!(centres.image, nodes);
    assert!(centres.warnings.is_empty(), "{:?}", centres.warnings);
    let unstated = load("map.exr", folder.path(), None).unwrap();
    assert_eq!(unstated.image, nodes);
    assert!(
        unstated.warnings[0].contains("--texels edges"),
        "{:?}",
        unstated.warnings
    );
}

/// OpenEXR stores colours times alpha, so a map that is not opaque is darker than it may seem.
#[test]
fn alpha_below_one_is_named() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("map.exr");
    let rgb = RgbImage::filled(8, 4, [0.5; 3]);
    for (alpha, share) in [(1.0, None), (0.5, Some("12.50 %"))] {
        let alpha = GrayImage::from_fn(8, 4, |x, _| if x == 0 { alpha } else { 1.0 });
        exr_file::write_rgba(&path, &rgb, &alpha, &[]).unwrap();
        let map = load("map.exr", folder.path(), None).unwrap();
        assert_eq!(map.image, rgb);
        match share {
            Some(share) => assert!(map.warnings[0].contains(share), "{:?}", map.warnings),
            None => assert!(map.warnings.is_empty(), "{:?}", map.warnings),
        }
    }
}

/// A file of @monogrid/gainmap-js at quality 0.9: six lights on a floor and a hot texel, whose mean in
/// the Radiance file that it was made from is 1.812 in each channel.
#[test]
fn jpeg_files_with_a_gain_map_hold_radiance() {
    let golden = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/golden");
    let map = load("gain_map.jpg", &golden, None).unwrap();
    assert!(map.warnings.is_empty(), "{:?}", map.warnings);
    let mut mean = DVec3::ZERO;
    for (i, texel) in map.image.data.iter().enumerate() {
        let row = i as u32 / map.image.width;
        let omega = equirect::texel_solid_angle(row, map.image.width, map.image.height);
        mean += omega * DVec3::from_array(texel.map(f64::from)) / (4.0 * PI);
    }
    let error = (mean / 1.812 - 1.0).abs();
    assert!(error.max_element() < 0.05, "{mean}");
    // Texels by Pillow's decoder and the formula in f64; decoders differ by a code, 1.6 % of gain.
    for (column, row, light) in [
        (64, 64, [6.6805, 1.1175, 0.9182]),
        (192, 64, [1.2045, 7.3584, 8.5060]),
        (10, 1, [0.9837, 8.0329, 1.0014]),
        (10, 126, [8.0591, 1.0070, 8.1049]),
        (128, 64, [1.0031, 1.0196, 7.5992]),
        (1, 64, [7.7226, 8.0329, 0.9949]),
    ] {
        let found = DVec3::from_array(map.image.get(column, row).map(f64::from));
        let error = (found / DVec3::from_array(light) - 1.0).abs();
        assert!(error.max_element() < 0.03, "{column}, {row}: {found}");
    }

    let bytes = std::fs::read(golden.join("gain_map.jpg")).unwrap();
    let second = bytes
        .windows(3)
        .rposition(|start| start == [0xff, 0xd8, 0xff]);
    let folder = tempfile::tempdir().unwrap();
    for (name, bytes) in [
        ("plain.jpg", &bytes[..second.unwrap()]),
        ("cut.jpg", &bytes[..9000]),
    ] {
        std::fs::write(folder.path().join(name), bytes).unwrap();
        let message = load(name, folder.path(), None).unwrap_err();
        assert!(message.contains("without a gain map"), "{message}");
    }
    std::fs::write(folder.path().join("text.jpg"), "no picture").unwrap();
    let message = load("text.jpg", folder.path(), None).unwrap_err();
    assert!(message.contains("is not a JPEG file"), "{message}");
}

/// `hdr = (sdr + o) 2^(max g^(1/gamma)) - o`: files of the maxima M and 1 give `sdr + o` and g of a
/// texel, which predict its radiance at another gamma.
#[test]
fn gains_are_shaped_by_their_gamma() {
    const MAX: f64 = 5.912537164124118;
    const OFFSET: f64 = 0.015625;
    let golden = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/golden");
    let bytes = std::fs::read(golden.join("gain_map.jpg")).unwrap();
    let folder = tempfile::tempdir().unwrap();
    let with = |from: &str, to: &str| {
        assert_eq!(from.len(), to.len());
        let part = bytes.windows(from.len());
        let at = part.into_iter().position(|part| part == from.as_bytes());
        let mut changed = bytes.clone();
        changed[at.unwrap()..][..to.len()].copy_from_slice(to.as_bytes());
        std::fs::write(folder.path().join("changed.jpg"), changed).unwrap();
        load("changed.jpg", folder.path(), None).unwrap().image
    };
    let whole = load("gain_map.jpg", &golden, None).unwrap().image;
    let one = with(
        "GainMapMax=\"5.912537164124118\"",
        "GainMapMax=\"1.000000000000000\"",
    );
    let curved = with("Gamma=\"1\"", "Gamma=\"2\"");
    let mut differences = 0;
    for ((whole, one), curved) in whole.data.iter().zip(&one.data).zip(&curved.data) {
        for c in 0..3 {
            let [whole, one, curved] = [whole[c], one[c], curved[c]].map(|x| f64::from(x) + OFFSET);
            let gain = (whole / one).log2() / (MAX - 1.0);
            let sdr = one / gain.exp2();
            let expected = sdr * (MAX * gain.max(0.0).sqrt()).exp2();
            assert!(
                (curved / expected - 1.0).abs() < 1e-3,
                "{curved} {expected}"
            );
            differences += usize::from(curved > 1.1 * whole);
        }
    }
    assert!(differences > 10_000, "{differences}");
}

#[test]
fn written_files_say_whether_their_numbers_are_colours() {
    let folder = tempfile::tempdir().unwrap();
    let channel = |name: &str| (name.to_owned(), GrayImage::filled(4, 2, 1.0));
    for (name, content, id) in [
        ("map.exr", Content::Radiance, "lin_rec709_scene"),
        ("table.exr", Content::Data, "data"),
    ] {
        let path = folder.path().join(name);
        let channels = ["R", "G", "B"].map(channel).to_vec();
        exr_file::write_channels(&path, content, channels).unwrap();
        let decoded = exr_file::read(&path).unwrap();
        assert_eq!(decoded.content, content);
        assert!(decoded.warnings.is_empty(), "{:?}", decoded.warnings);
        let bytes = std::fs::read(&path).unwrap();
        let value = [
            &b"colorInteropID\0string\0"[..],
            &(id.len() as u32).to_le_bytes(),
            id.as_bytes(),
        ]
        .concat();
        assert!(bytes.windows(value.len()).any(|window| window == value));
    }
    load("map.exr", folder.path(), None).unwrap();
    let message = load("table.exr", folder.path(), None).unwrap_err();
    assert!(message.contains("holds no colours"), "{message}");
}
