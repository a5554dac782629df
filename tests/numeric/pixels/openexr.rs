//! OpenEXR files.

use super::{folder, put};
use crate::snapshot::assert_snapshot;
use exr::prelude::{
    AnyChannel, AnyChannels, Compression, Encoding, FlatSamples, Image, Layer, LayerAttributes,
    LineOrder, WritableImage, f16,
};
use fastrand::Rng;
use splitsum::base::pixels::{Content, Decoded, GrayImage, PixelsError, RgbImage, exr as exr_file};

fn test_image(seed: u64, width: u32, height: u32) -> RgbImage {
    let mut random = Rng::with_seed(seed);
    // All finite bit patterns, subnormals and negative numbers included.
    let mut float = || loop {
        let value = f32::from_bits(random.u32(..));
        if value.is_finite() {
            return value;
        }
    };
    RgbImage::from_fn(width, height, |_, _| [float(), float(), float()])
}

fn bits(image: &RgbImage) -> Vec<u32> {
    image
        .data
        .iter()
        .flatten()
        .map(|value| value.to_bits())
        .collect()
}

#[test]
fn files_read_back_bit_for_bit() {
    let folder = folder();
    let path = folder.path().join("frame.exr");
    let (rgb, error) = (test_image(1, 37, 19), test_image(2, 37, 19));
    let alpha = GrayImage::from_fn(37, 19, |x, y| ((x + y) % 2) as f32);
    exr_file::write_rgba(&path, &rgb, &alpha, &[("standard_error", &error)]).unwrap();
    let frame = exr_file::read(&path).unwrap();
    assert_eq!(bits(&frame.rgb), bits(&rgb));
    assert_eq!(frame.alpha.as_ref(), Some(&alpha));
    assert!(frame.warnings.is_empty(), "{:?}", frame.warnings);
    let layer = exr_file::read_layer(&path, Some("standard_error")).unwrap();
    assert_eq!(bits(&layer.rgb), bits(&error));
    assert!(layer.alpha.is_none());
    assert!(
        exr_file::read_layer(&path, Some("depth"))
            .unwrap_err()
            .to_string()
            .contains("in layer \"depth\"")
    );

    // An independent reader finds the channels under the names by which viewers group them.
    let outside = exr::prelude::read_first_flat_layer_from_file(&path).unwrap();
    let names: Vec<String> = outside
        .layer_data
        .channel_data
        .list
        .iter()
        .map(|c| c.name.to_string())
        .collect();
    assert_eq!(
        names,
        [
            "A",
            "B",
            "G",
            "R",
            "standard_error.B",
            "standard_error.G",
            "standard_error.R"
        ]
    );
    let FlatSamples::F32(green) = &outside.layer_data.channel_data.list[2].sample_data else {
        panic!("not f32")
    };
    assert!(
        green
            .iter()
            .zip(&rgb.data)
            .all(|(green, texel)| green.to_bits() == texel[1].to_bits())
    );
}

#[test]
fn writing_replaces_and_leaves_nothing_else() {
    let folder = folder();
    let path = folder.path().join("frame.exr");
    let alpha = GrayImage::filled(4, 2, 1.0);
    for seed in [3, 4] {
        exr_file::write_rgba(&path, &test_image(seed, 4, 2), &alpha, &[]).unwrap();
    }
    assert_eq!(
        bits(&exr_file::read(&path).unwrap().rgb),
        bits(&test_image(4, 4, 2))
    );
    // A folder of the same name: the rename fails after everything was written.
    let blocked = folder.path().join("blocked.exr");
    std::fs::create_dir(&blocked).unwrap();
    assert!(exr_file::write_rgba(&blocked, &test_image(3, 4, 2), &alpha, &[]).is_err());
    let missing = folder.path().join("none/frame.exr");
    let message = exr_file::write_rgba(&missing, &test_image(3, 4, 2), &alpha, &[])
        .unwrap_err()
        .to_string();
    assert!(
        message.contains("none/frame.exr: cannot be written"),
        "{message}"
    );
    let mut left: Vec<_> = std::fs::read_dir(&folder)
        .unwrap()
        .map(|entry| entry.unwrap().file_name())
        .collect();
    left.sort();
    assert_eq!(left, ["blocked.exr", "frame.exr"]);
}

/// Halves that every lossless compression must keep, written by the crate `exr`, whole or in tiles
/// that do not divide the image.
#[test]
fn compressions_and_tiles() {
    let folder = folder();
    let (width, height) = (45, 37);
    let value = |channel: usize, x: usize, y: usize| {
        f16::from_f32((channel * 1000 + y * 7 + x * x % 83) as f32 / 64.0)
    };
    let blocks = [
        exr::image::Blocks::ScanLines,
        exr::image::Blocks::Tiles(exr::math::Vec2(16, 8)),
    ];
    for compression in [
        Compression::Uncompressed,
        Compression::RLE,
        Compression::ZIP1,
        Compression::ZIP16,
        Compression::PIZ,
        Compression::PXR24,
    ] {
        for blocks in blocks {
            let channels = ["B", "G", "R"]
                .into_iter()
                .zip([2, 1, 0])
                .map(|(name, channel)| {
                    let samples = (0..width * height)
                        .map(|i| value(channel, i % width, i / width))
                        .collect();
                    AnyChannel::new(name, FlatSamples::F16(samples))
                });
            let encoding = Encoding {
                compression,
                blocks,
                line_order: LineOrder::Increasing,
            };
            let channels = AnyChannels::sort(channels.collect());
            let path = folder.path().join("lossless.exr");
            Image::from_encoded_channels((width, height), encoding, channels)
                .write()
                .to_file(&path)
                .unwrap();
            let image = exr_file::read(&path).unwrap().rgb;
            let expected = RgbImage::from_fn(width as u32, height as u32, |x, y| {
                [0, 1, 2].map(|channel| value(channel, x as usize, y as usize).to_f32())
            });
            assert!(image == expected, "{compression:?} {blocks:?}");
        }
    }
}

/// Against the pixels that the OpenEXR library 3.5.3 reads from its own files: ramps, an edge, a
/// bright disc and a flat part (which B44A stores in fewer bytes), with a size that does not divide
/// into whole blocks.
#[test]
fn lossy_compressions_are_read_as_the_reference_library_reads_them() {
    let golden = std::path::Path::new("tests/golden/exr");
    for (name, decoded) in [
        ("b44", "b44"),
        ("b44a", "b44"),
        ("dwaa", "dwa"),
        ("dwab", "dwa"),
    ] {
        let image = exr_file::read(&golden.join(format!("{name}.exr")))
            .unwrap()
            .rgb;
        let expected = exr_file::read(&golden.join(format!("{decoded}-decoded.exr")))
            .unwrap()
            .rgb;
        assert_eq!([image.width, image.height], [36, 20]);
        assert!(bits(&image) == bits(&expected), "{name}");
        let sum: f32 = expected.data.iter().flatten().sum();
        assert!(
            (3000.0..6000.0).contains(&sum),
            "{decoded}-decoded.exr does not hold the picture: {sum}"
        );
    }
}

#[test]
fn mip_and_rip_maps_show_the_largest_level() {
    let side = |level: usize| 16usize >> level;
    let samples = |is_largest: bool, base: f32, count: usize| {
        FlatSamples::F32(vec![if is_largest { base } else { 99.0 }; count])
    };
    let rounding_mode = exr::math::RoundingMode::Down;
    let mip = |base: f32| exr::image::Levels::Mip {
        rounding_mode,
        level_data: (0..5)
            .map(|level| samples(level == 0, base, side(level) * side(level)))
            .collect(),
    };
    let rip = |base: f32| {
        let levels = (0..5).flat_map(|y| (0..5).map(move |x| (x, y)));
        let map_data = levels
            .map(|(x, y)| samples(x + y == 0, base, side(x) * side(y)))
            .collect();
        let level_data = exr::image::RipMaps {
            map_data,
            level_count: exr::math::Vec2(5, 5),
        };
        exr::image::Levels::Rip {
            rounding_mode,
            level_data,
        }
    };
    let folder = folder();
    let path = folder.path().join("levels.exr");
    let encoding = Encoding {
        compression: Compression::ZIP16,
        blocks: exr::image::Blocks::Tiles(exr::math::Vec2(4, 4)),
        line_order: LineOrder::Increasing,
    };
    for levels in [
        &mip as &dyn Fn(f32) -> exr::image::Levels<FlatSamples>,
        &rip,
    ] {
        let channels = [("R", 1.0), ("G", 2.0), ("B", 3.0)]
            .map(|(name, base)| AnyChannel::new(name, levels(base)));
        let channels = AnyChannels::sort(channels.into_iter().collect());
        Image::from_encoded_channels((16, 16), encoding, channels)
            .write()
            .to_file(&path)
            .unwrap();
        assert_eq!(
            exr_file::read(&path).unwrap().rgb,
            RgbImage::filled(16, 16, [1.0, 2.0, 3.0])
        );
    }
}

#[test]
fn multi_part_files_give_the_first_part_with_colour() {
    let folder = folder();
    let path = folder.path().join("parts.exr");
    let part = |name: &str, channels: &[(&str, f32)]| {
        let channels = channels
            .iter()
            .map(|(name, value)| AnyChannel::new(*name, FlatSamples::F32(vec![*value; 8])));
        Layer::new(
            (4, 2),
            LayerAttributes::named(name),
            Encoding::FAST_LOSSLESS,
            AnyChannels::sort(channels.collect()),
        )
    };
    let window = exr::image::Image::from_layers(
        exr::meta::header::ImageAttributes::with_size((4, 2)),
        vec![
            part("depth", &[("Z", 9.0)]),
            part("beauty", &[("R", 1.0), ("G", 2.0), ("B", 3.0)]),
            part("albedo", &[("R", 4.0), ("G", 5.0), ("B", 6.0)]),
        ],
    );
    window.write().to_file(&path).unwrap();
    let image = exr_file::read(&path).unwrap();
    assert_eq!(image.rgb, RgbImage::filled(4, 2, [1.0, 2.0, 3.0]));
    assert_eq!(
        image.warnings,
        ["Only part 2 of 3 is used; FILE#NAME reads another (albedo)."]
    );
    let albedo = exr_file::read_layer(&path, Some("albedo")).unwrap();
    assert_eq!(albedo.rgb, RgbImage::filled(4, 2, [4.0, 5.0, 6.0]));
}

/// A channel of a file made by hand: name, sample type (0 uint, 1 half, 2 float), value at a pixel
/// of the data window.
struct Channel {
    name: &'static str,
    kind: i32,
    value: fn(i32, i32) -> f32,
}

fn channel(name: &'static str, kind: i32, value: fn(i32, i32) -> f32) -> Channel {
    Channel { name, kind, value }
}

/// An uncompressed scan-line file by the format's specification. Returns the bytes and the start of
/// the table of blocks.
fn handmade(
    channels: &[Channel],
    data: [i32; 4],
    display: [i32; 4],
    extra: &[u8],
) -> (Vec<u8>, usize) {
    let ints = |values: &[i32]| {
        values
            .iter()
            .flat_map(|value| value.to_le_bytes())
            .collect::<Vec<u8>>()
    };
    let mut list = Vec::new();
    for channel in channels {
        list.extend([channel.name.as_bytes(), &[0]].concat());
        list.extend(ints(&[channel.kind, 0, 1, 1]));
    }
    list.push(0);
    let mut file = [&[0x76, 0x2f, 0x31, 0x01][..], &ints(&[2])].concat();
    for (name, kind, value) in [
        ("channels", "chlist", list),
        ("compression", "compression", vec![0]),
        ("dataWindow", "box2i", ints(&data)),
        ("displayWindow", "box2i", ints(&display)),
        ("lineOrder", "lineOrder", vec![0]),
        ("pixelAspectRatio", "float", 1f32.to_le_bytes().to_vec()),
        ("screenWindowCenter", "v2f", vec![0; 8]),
        ("screenWindowWidth", "float", 1f32.to_le_bytes().to_vec()),
    ] {
        file.extend(attribute(name, kind, &value));
    }
    file.extend(extra);
    file.push(0);
    let table = file.len();
    let [left, top, right, bottom] = data;
    let mut offset = table + 8 * (bottom - top + 1) as usize;
    let (mut offsets, mut blocks) = (Vec::new(), Vec::new());
    for y in top..=bottom {
        let mut line = Vec::new();
        for channel in channels {
            for x in left..=right {
                let value = (channel.value)(x, y);
                match channel.kind {
                    0 => line.extend((value as u32).to_le_bytes()),
                    1 => line.extend(f16::from_f32(value).to_le_bytes()),
                    _ => line.extend(value.to_le_bytes()),
                }
            }
        }
        offsets.extend((offset as u64).to_le_bytes());
        offset += 8 + line.len();
        blocks.extend([ints(&[y, line.len() as i32]), line].concat());
    }
    file.extend(offsets);
    file.extend(blocks);
    (file, table)
}

const WINDOW: [i32; 4] = [0, 0, 3, 1];

fn read(file: &[u8]) -> Result<Decoded, PixelsError> {
    let folder = folder();
    exr_file::read(&put(&folder, "handmade.exr", file))
}

#[test]
fn sample_types_and_windows() {
    let channels = [
        channel("A", 2, |x, _| x as f32 / 2.0),
        channel("B", 0, |x, y| (100_000 + x + y) as f32),
        channel("G", 1, |x, y| (x * y) as f32 - 0.5),
        channel("R", 2, |x, y| 0.1 * (x + 10 * y) as f32),
    ];
    // The data window lies at (-2, 5): two of its four columns are inside the display window.
    let (file, _) = handmade(&channels, [-2, 5, 1, 6], [0, 0, 9, 9], &[]);
    let image = read(&file).unwrap();
    let expected = RgbImage::from_fn(10, 10, |column, row| {
        let x = column as i32;
        let y = row as i32;
        if x > 1 || !(5..=6).contains(&y) {
            return [0.0; 3];
        }
        [
            0.1 * (x + 10 * y) as f32,
            (x * y) as f32 - 0.5,
            (100_000 + x + y) as f32,
        ]
    });
    assert_eq!(image.rgb, expected);
    assert_eq!(image.alpha.unwrap().data[50..54], [0.0, 0.5, 0.0, 0.0]);
    assert!(
        image.warnings[0].contains("4x2 at -2, 5") && image.warnings[0].contains("10x10 at 0, 0"),
        "{:?}",
        image.warnings
    );
    let (outside, _) = handmade(&channels, [-2, 5, -1, 6], [0, 0, 9, 9], &[]);
    let message = read(&outside).unwrap_err().to_string();
    assert!(
        message.contains("lies outside the display window"),
        "{message}"
    );
}

/// A header attribute: name and type, each with its NUL, then size and value.
fn attribute(name: &str, kind: &str, value: &[u8]) -> Vec<u8> {
    let size = (value.len() as i32).to_le_bytes();
    [name.as_bytes(), &[0], kind.as_bytes(), &[0], &size, value].concat()
}

fn interop_id(id: &str) -> Vec<u8> {
    attribute("colorInteropID", "string", id.as_bytes())
}

fn chromaticities(values: [f32; 8]) -> Vec<u8> {
    let bytes: Vec<u8> = values
        .iter()
        .flat_map(|value| value.to_le_bytes())
        .collect();
    attribute("chromaticities", "chromaticities", &bytes)
}

const ACESCG: [f32; 8] = [0.713, 0.293, 0.165, 0.83, 0.128, 0.044, 0.32168, 0.33767];

/// One texel of (0.5, 0.25, 0.125) with header attributes, as it is read.
fn labelled(attributes: &[u8]) -> Result<Decoded, PixelsError> {
    let channels = [
        channel("B", 2, |_, _| 0.125),
        channel("G", 2, |_, _| 0.25),
        channel("R", 2, |_, _| 0.5),
    ];
    read(&handmade(&channels, [0, 0, 0, 0], [0, 0, 0, 0], attributes).0)
}

/// Expected values by OpenColorIO 2.5 and its built-in configuration.
#[test]
fn colour_labels_are_read_in_the_order_of_openexr() {
    let rec709 = [0.5, 0.25, 0.125];
    let from_acescg = [0.686_67, 0.218_754, 0.099_878];
    let is_close = |found: [f32; 3], expected: [f32; 3]| {
        found
            .iter()
            .zip(expected)
            .all(|(found, expected)| (found - expected).abs() < 2e-4)
    };
    let acescg = labelled(&interop_id("lin_ap1_scene")).unwrap();
    assert!(
        is_close(acescg.rgb.data[0], from_acescg),
        "{:?}",
        acescg.rgb.data
    );
    assert!(
        acescg.warnings[0].contains("lin_ap1_scene"),
        "{:?}",
        acescg.warnings
    );
    let by_chromaticities = labelled(&chromaticities(ACESCG)).unwrap();
    assert!(is_close(by_chromaticities.rgb.data[0], from_acescg));

    let plain = labelled(&interop_id("lin_rec709_scene")).unwrap();
    assert_eq!(plain.rgb.data[0], rec709);
    assert!(plain.warnings.is_empty(), "{:?}", plain.warnings);

    // The ID wins over chromaticities that a program left behind, and the warning names both.
    let left_behind = [interop_id("lin_rec709_scene"), chromaticities(ACESCG)].concat();
    let left_behind = labelled(&left_behind).unwrap();
    assert_eq!(left_behind.rgb.data[0], rec709);
    assert_eq!(left_behind.warnings.len(), 1, "{:?}", left_behind.warnings);
    assert!(left_behind.warnings[0].contains("colorInteropID lin_rec709_scene"));
    assert!(left_behind.warnings[0].contains("chromaticities"));

    // The flag of ACES containers wins over both.
    let aces = attribute("acesImageContainerFlag", "int", &1i32.to_le_bytes());
    let ap0 = labelled(&interop_id("lin_ap0_scene")).unwrap().rgb;
    let container = labelled(&[aces, interop_id("lin_rec709_scene")].concat()).unwrap();
    assert_eq!(container.rgb, ap0);

    for (id, expected) in [
        ("lin_ap0_scene", [0.928_866, 0.192_91, 0.100_111]),
        ("lin_p3d65_scene", [0.556_235, 0.239_486, 0.107_806]),
        // Its green is -0.0104, outside Rec.709.
        ("lin_ciexyzd65_scene", [1.173_813, 0.0, 0.108_942]),
        ("ocio:lin_ciexyzd65_display", [1.173_813, 0.0, 0.108_942]),
    ] {
        let found = labelled(&interop_id(id)).unwrap().rgb.data[0];
        assert!(is_close(found, expected), "{id}: {found:?}");
    }

    for id in [
        "srgb_rec709_scene",
        "g22_ap1_scene",
        "pq_rec2020_display",
        "ocio:acescct_ap1_scene",
        "ocio:acescc_ap1_scene",
    ] {
        let message = labelled(&interop_id(id)).unwrap_err().to_string();
        assert!(message.contains(id), "{message}");
    }
    let data = labelled(&interop_id("data")).unwrap();
    assert_eq!((data.content, data.rgb.data[0]), (Content::Data, rec709));
    let unknown = labelled(&interop_id("show:lin_film")).unwrap();
    assert_eq!(unknown.rgb.data[0], rec709);
    assert!(
        unknown.warnings[0].contains("Rec.709 was assumed"),
        "{:?}",
        unknown.warnings
    );
}

/// OpenImageIO's name of a space does not count in OpenEXR; whole numbers are rarely light.
#[test]
fn foreign_labels_and_whole_numbers_are_named() {
    let by_oiio = |space: &str| attribute("oiio:ColorSpace", "string", space.as_bytes());
    let warnings = labelled(&by_oiio("ACEScg")).unwrap().warnings;
    assert!(
        warnings[0].contains("oiio:ColorSpace is \"ACEScg\""),
        "{warnings:?}"
    );
    assert!(
        labelled(&by_oiio("scene_linear"))
            .unwrap()
            .warnings
            .is_empty()
    );
    // Chromaticities say more.
    let both = [by_oiio("ACEScg"), chromaticities(ACESCG)].concat();
    let warnings = labelled(&both).unwrap().warnings;
    assert!(
        warnings.iter().all(|warning| !warning.contains("oiio")),
        "{warnings:?}"
    );

    let whole = ["B", "G", "R"].map(|name| channel(name, 0, |_, _| 7.0));
    let (file, _) = handmade(&whole, [0, 0, 0, 0], [0, 0, 0, 0], &[]);
    let warnings = read(&file).unwrap().warnings;
    assert!(warnings[0].contains("whole numbers (uint)"), "{warnings:?}");
}

#[test]
fn headers_that_scale_or_turn_are_named() {
    let scaled = labelled(&attribute(
        "whiteLuminance",
        "float",
        &1.672f32.to_le_bytes(),
    ))
    .unwrap();
    assert!(
        scaled.warnings[0].contains("environment_scale=1.672"),
        "{:?}",
        scaled.warnings
    );
    let one = labelled(&attribute("whiteLuminance", "float", &1f32.to_le_bytes())).unwrap();
    assert!(one.warnings.is_empty());

    let channels = ["B", "G", "R"].map(|name| channel(name, 2, |x, y| (x + 10 * y) as f32));
    let turned = |value: i32| {
        let extra = attribute("Orientation", "int", &value.to_le_bytes());
        read(&handmade(&channels, [0, 0, 2, 1], [0, 0, 2, 1], &extra).0).unwrap()
    };
    let upside_down = turned(4);
    let rows: Vec<f32> = upside_down.rgb.data.iter().map(|texel| texel[0]).collect();
    assert_eq!(rows, [10.0, 11.0, 12.0, 0.0, 1.0, 2.0]);
    assert!(upside_down.warnings[0].contains("Orientation 4"));
    assert!(turned(1).warnings.is_empty());
    assert_eq!((turned(6).rgb.width, turned(6).rgb.height), (2, 3));
}

#[test]
fn new_compressions_are_named_with_a_way_out() {
    let (file, _) = handmade(&[channel("R", 2, |_, _| 1.0)], WINDOW, WINDOW, &[]);
    let mark = b"compression\0compression\0\x01\0\0\0";
    let place = file
        .windows(mark.len())
        .position(|part| part == mark)
        .unwrap()
        + mark.len();
    for (code, name) in [
        (10, "HTJ2K256"),
        (11, "HTJ2K32"),
        (12, "LJ2K"),
        (13, "ZSTD"),
    ] {
        let mut file = file.clone();
        file[place] = code;
        let message = read(&file).unwrap_err().to_string();
        assert!(
            message.contains(name) && message.contains("--compression zip"),
            "{message}"
        );
    }
}

#[test]
fn the_picture_comes_before_the_passes() {
    let names = |names: &[&'static str]| {
        let values = [
            |_, _| 1.0,
            |_, _| 2.0,
            |_, _| 3.0,
            |_, _| 4.0,
            |_, _| 5.0,
            |_, _| 6.0,
        ];
        let channels: Vec<Channel> = names
            .iter()
            .zip(values)
            .map(|(name, value)| channel(name, 2, value))
            .collect();
        read(&handmade(&channels, WINDOW, WINDOW, &[]).0).unwrap()
    };
    let passes = [
        "albedo.B", "albedo.G", "albedo.R", "beauty.B", "beauty.G", "beauty.R",
    ];
    assert_eq!(names(&passes).rgb.data[0], [6.0, 5.0, 4.0]);
    let blender = [
        "V.AO.B",
        "V.AO.G",
        "V.AO.R",
        "V.Combined.B",
        "V.Combined.G",
        "V.Combined.R",
    ];
    assert_eq!(names(&blender).rgb.data[0], [6.0, 5.0, 4.0]);
    // Numbers of objects come last, whatever their names.
    let mattes = [
        "CryptoObject00.B",
        "CryptoObject00.G",
        "CryptoObject00.R",
        "diffuse.B",
        "diffuse.G",
        "diffuse.R",
    ];
    assert_eq!(names(&mattes).rgb.data[0], [6.0, 5.0, 4.0]);
    assert_eq!(names(&["b", "g", "r"]).rgb.data[0], [3.0, 2.0, 1.0]);
    assert_eq!(names(&["Y"]).rgb.data[0], [1.0; 3]);
}

#[test]
fn channel_names() {
    let at = |names: &[&'static str]| {
        let channels: Vec<Channel> = names
            .iter()
            .enumerate()
            .map(|(i, name)| channel(name, 2, [|_, _| 1.0, |_, _| 2.0, |_, _| 3.0, |_, _| 4.0][i]))
            .collect();
        read(&handmade(&channels, WINDOW, WINDOW, &[]).0)
    };
    let first = |names: &[&'static str]| at(names).unwrap().rgb.get(0, 0);
    assert_eq!(first(&["B", "G", "R"]), [3.0, 2.0, 1.0]);
    assert_eq!(
        first(&["Z", "left.beauty.B", "left.beauty.G", "left.beauty.R"]),
        [4.0, 3.0, 2.0]
    );
    // Plain channels win over a prefix that sorts before them.
    assert_eq!(first(&["AO.R", "B", "G", "R"]), [4.0, 3.0, 2.0]);
    let partial = at(&["B", "R"]).unwrap();
    assert_eq!(partial.rgb.get(0, 0), [2.0, 0.0, 1.0]);
    assert_eq!(partial.warnings, ["Channel G is missing; it was set to 0."]);
    let several = at(&["beauty.B", "beauty.G", "beauty.R", "mask.R"]).unwrap();
    assert_eq!(
        several.warnings,
        ["Only layer \"beauty\" is used; FILE#NAME reads another (mask)."]
    );
    let refusals = [
        &["A", "Z"][..],
        &["U", "V"],
        &["X", "Y", "Z"],
        &["BY", "RY", "Y"],
        &["N.X", "N.Y", "N.Z"],
    ];
    let refusals = refusals.map(|names| at(names).unwrap_err().to_string());
    let refusals = refusals.map(|message| message.split_once(": ").unwrap().1.to_owned());
    assert_snapshot("exr_channels_that_are_refused", &refusals.join("\n"));
}

/// A header that claims more than fits in memory is refused before anything is unpacked, and so are
/// endless channels.
#[test]
fn claims_are_refused_with_the_figure() {
    let rgb = ["B", "G", "R"].map(|name| channel(name, 2, |_, _| 1.0));
    let small = handmade(&rgb, WINDOW, WINDOW, &[]).0;
    let window = |file: &[u8], from: [i32; 4], to: [i32; 4]| {
        let bytes = |window: [i32; 4]| {
            window
                .iter()
                .flat_map(|x| x.to_le_bytes())
                .collect::<Vec<u8>>()
        };
        let at = file
            .windows(16)
            .position(|part| part == bytes(from))
            .unwrap();
        [&file[..at], &bytes(to), &file[at + 16..]].concat()
    };
    let huge = window(&small, WINDOW, [0, 0, 16383, 8191]);
    let environment = |file: &[u8]| {
        exr_file::read_bytes("x.exr".as_ref(), file, None)
            .unwrap_err()
            .to_string()
    };
    assert!(
        environment(&huge)
            .contains("x.exr: the header claims 16384x8192 pixels, which take 7424 MiB of memory")
    );
    assert!(environment(&huge).contains("resample the image to 8192x4096 or less"));
    // A map may be larger than a frame.
    let map = window(&small, WINDOW, [0, 0, 8191, 4095]);
    assert!(
        environment(&map).contains("but the file has"),
        "{}",
        environment(&map)
    );
    assert!(
        read(&map)
            .unwrap_err()
            .to_string()
            .contains("which take 512 MiB"),
        "{:?}",
        read(&map).err()
    );
    assert!(
        read(&map)
            .unwrap_err()
            .to_string()
            .contains("resample the image to 4096x4096 or less")
    );
    assert!(
        read(&huge)
            .unwrap_err()
            .to_string()
            .contains("which take 2048 MiB"),
        "{:?}",
        read(&huge).err()
    );
}

#[test]
fn chromaticities_are_converted() {
    // BT.2020, as an attribute of eight floats; white stays white.
    let values: Vec<u8> = [0.708f32, 0.292, 0.170, 0.797, 0.131, 0.046, 0.3127, 0.3290]
        .iter()
        .flat_map(|value| value.to_le_bytes())
        .collect();
    let extra = [
        b"chromaticities\0chromaticities\0",
        &32i32.to_le_bytes()[..],
        &values,
    ]
    .concat();
    let channels = [
        channel("B", 2, |x, _| (x == 0) as i32 as f32),
        channel("G", 2, |_, _| 1.0),
        channel("R", 2, |x, _| (x == 0) as i32 as f32),
    ];
    let image = read(&handmade(&channels, WINDOW, WINDOW, &extra).0).unwrap();
    let (white, green) = (image.rgb.get(0, 0), image.rgb.get(1, 0));
    assert!(
        white.iter().all(|channel| (channel - 1.0).abs() < 1e-5),
        "{white:?}"
    );
    // Green of Rec.2020 lies outside Rec.709: below 0 is clamped, as in Radiance files.
    assert!(
        green[0] == 0.0 && (green[1] - 1.1329).abs() < 1e-3,
        "{green:?}"
    );
    assert!(image.warnings[0].contains("chromaticities"));
    assert!(
        image.warnings[1].contains("4 texels lie outside Rec.709")
            || image.warnings[1].contains("6 texels")
    );
}

#[test]
fn bad_files_are_refused_with_place_and_expectation() {
    let channels = [
        channel("B", 2, |_, _| 1.0),
        channel("G", 2, |_, _| 1.0),
        channel("R", 2, |_, _| 1.0),
    ];
    let (good, table) = handmade(&channels, WINDOW, WINDOW, &[]);
    assert_eq!(read(&good).unwrap().rgb, RgbImage::filled(4, 2, [1.0; 3]));
    let refusal = |file: &[u8]| read(file).unwrap_err().to_string();
    let edited = |at: usize, bytes: &[u8]| {
        let mut file = good.clone();
        file[at..at + bytes.len()].copy_from_slice(bytes);
        file
    };
    let first_block = table + 16;
    // For channel B: its type, whether it is linear, then the steps in x and y.
    let sampling = good
        .windows(6)
        .position(|bytes| bytes == b"B\0\x02\0\0\0")
        .unwrap()
        + 2
        + 8;
    let cases = [
        (
            "a subsampled channel",
            edited(sampling, &[2, 0, 0, 0, 2, 0, 0, 0]),
        ),
        ("empty", Vec::new()),
        ("another format", b"plain text, no image".to_vec()),
        ("cut off", good[..good.len() - 1].to_vec()),
        ("cut off in the table of blocks", good[..table + 9].to_vec()),
        (
            "unfinished, with a 0 in the table",
            edited(table + 8, &[0; 8]),
        ),
        (
            "one block for two places",
            edited(table + 8, &good[table..table + 8]),
        ),
        // The second block claims the first line, so the second line would stay 0.
        (
            "two blocks for one place",
            edited(first_block + 56, &0i32.to_le_bytes()),
        ),
        ("a block outside", edited(first_block, &7i32.to_le_bytes())),
        (
            "a block that is too short",
            edited(first_block + 4, &4i32.to_le_bytes()),
        ),
        (
            "a block that is too long",
            edited(first_block + 4, &i32::MAX.to_le_bytes()),
        ),
    ];
    let messages =
        cases.map(|(case, file)| format!("{case}: {}", refusal(&file).split_once(": ").unwrap().1));
    assert_snapshot("exr_files_that_are_refused", &messages.join("\n"));
    // A window of 2^30 pixels in a small file.
    let window = [0, 0, (1 << 20) - 1, (1 << 10) - 1];
    let at = good
        .windows(11)
        .position(|bytes| bytes == b"dataWindow\0")
        .unwrap()
        + 11
        + 6
        + 4;
    let sizes: Vec<u8> = window
        .iter()
        .flat_map(|value: &i32| value.to_le_bytes())
        .collect();
    assert!(refusal(&edited(at, &sizes)).contains("1048576x1024 pixels"));
}
