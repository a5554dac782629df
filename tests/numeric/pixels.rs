//! Colour functions and image files. Every input file is made here, byte by byte or by an independent writer.

use exr::prelude::{
    AnyChannel, AnyChannels, Compression, Encoding, FlatSamples, Image, Layer, LayerAttributes, LineOrder,
    WritableImage, f16,
};
use glam::DVec3;
use splitsum::color::{self, RADIANCE, REC709};
use splitsum::pixels::{Decoded, GrayImage, PixelsError, Rgb8Image, RgbImage, exr as exr_file, png, radiance};
use std::path::{Path, PathBuf};
use tempfile::TempDir;

fn folder() -> TempDir {
    tempfile::tempdir().unwrap()
}

fn put(folder: &TempDir, name: &str, bytes: &[u8]) -> PathBuf {
    let path = folder.path().join(name);
    std::fs::write(&path, bytes).unwrap();
    path
}

/// Pseudo-random 64-bit words (xorshift).
fn words(mut state: u64) -> impl FnMut() -> u64 {
    move || {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        state
    }
}

mod colour {
    use super::*;

    #[test]
    fn srgb_curve() {
        // IEC 61966-2-1: mid grey, and the two pieces meet.
        assert!((color::srgb_encode(0.5) - 0.735_357).abs() < 1e-6);
        assert!((color::srgb_encode(0.003_130_8) - 0.040_45).abs() < 1e-5);
        assert!((color::srgb_encode(0.003_131) - 0.040_45).abs() < 1e-5);
        for signal in 0..=255 {
            let linear = color::srgb_decode(signal as f32 / 255.0);
            assert_eq!((color::srgb_encode(linear) * 255.0).round() as i32, signal);
        }
        assert_eq!(color::srgb_encode(-1.0), 0.0);
        assert_eq!(color::srgb_encode(f32::INFINITY), 1.0);
        assert_eq!(color::srgb_encode(f32::NAN), 0.0);
    }

    #[test]
    fn rec709_matrix_is_the_published_one() {
        // sRGB (D65) to XYZ as printed in IEC 61966-2-1, four decimals.
        let published = [[0.4124, 0.3576, 0.1805], [0.2126, 0.7152, 0.0722], [0.0193, 0.1192, 0.9505]];
        let matrix = REC709.to_xyz().unwrap();
        for (i, row) in published.iter().enumerate() {
            for (j, entry) in row.iter().enumerate() {
                assert!((matrix.row(i)[j] - entry).abs() < 1e-4, "row {i} column {j}: {}", matrix.row(i)[j]);
            }
        }
        assert!((color::luminance([1.0; 3]) - 1.0).abs() < 1e-12);
    }

    #[test]
    fn conversions_keep_white() {
        let identity = REC709.to_rec709().unwrap();
        assert!((identity * DVec3::new(0.2, 0.5, 0.9)).abs_diff_eq(DVec3::new(0.2, 0.5, 0.9), 1e-12));
        let white = RADIANCE.to_rec709().unwrap() * DVec3::ONE;
        assert!(white.abs_diff_eq(DVec3::ONE, 1e-9), "{white}");
        // The same space in other words: equal energy is Y = 1 and X = Y = Z.
        assert!((RADIANCE.to_xyz().unwrap() * DVec3::ONE).abs_diff_eq(DVec3::ONE, 1e-9));
        let zeros = color::Chromaticities {
            red: glam::DVec2::ZERO,
            green: glam::DVec2::ZERO,
            blue: glam::DVec2::ZERO,
            white: glam::DVec2::ZERO,
        };
        assert!(zeros.to_xyz().is_none());
    }
}

mod rgbe {
    use super::*;

    const MAGIC: &str = "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n";

    fn read(header: &str, pixels: &[u8]) -> Result<Decoded, PixelsError> {
        let folder = folder();
        radiance::read(&put(&folder, "image.hdr", &[header.as_bytes(), pixels].concat()))
    }

    fn refusal(header: &str, pixels: &[u8]) -> String {
        read(header, pixels).unwrap_err().to_string()
    }

    /// (mantissas, e): 2^(e - 136).
    const ONE: [u8; 4] = [128, 64, 32, 129];
    const ONE_VALUE: [f32; 3] = [1.0, 0.5, 0.25];

    #[test]
    fn flat_texels() {
        let image = read(&format!("{MAGIC}\n-Y 1 +X 3\n"), &[ONE, [255, 0, 1, 128], [9, 9, 9, 0]].concat()).unwrap();
        assert_eq!(image.rgb.data, [ONE_VALUE, [255.0 / 256.0, 0.0, 1.0 / 256.0], [0.0; 3]]);
        assert!(image.alpha.is_none() && image.warnings.is_empty());
    }

    #[test]
    fn extreme_exponents_stay_finite() {
        let image = read(&format!("{MAGIC}\n-Y 1 +X 2\n"), &[[255, 128, 1, 255], [1, 128, 255, 1]].concat()).unwrap();
        assert_eq!(image.rgb.get(0, 0), [255, 128, 1].map(|m: i32| (f64::from(m) * 2f64.powi(119)) as f32));
        assert_eq!(image.rgb.get(1, 0), [1, 128, 255].map(|m: i32| (f64::from(m) * 2f64.powi(-135)) as f32));
    }

    #[test]
    fn run_length_forms_agree_with_flat() {
        // Nine texels: one A, then eight B.
        let (a, b) = ([200, 100, 50, 130], [10, 255, 128, 127]);
        let header = format!("{MAGIC}\n-Y 1 +X 9\n");
        let flat = read(&header, &[vec![a], vec![b; 8]].concat().concat()).unwrap().rgb;
        let mut new_form = vec![2, 2, 0, 9];
        for channel in 0..4 {
            // A literal of one, a run of five, a literal of three.
            let value = b[channel];
            new_form.extend([1, a[channel], 128 + 5, value, 3, value, value, value]);
        }
        assert_eq!(read(&header, &new_form).unwrap().rgb, flat);
        let old_form = [a, b, [1, 1, 1, 7]].concat();
        assert_eq!(read(&header, &old_form).unwrap().rgb, flat);
    }

    #[test]
    fn old_runs_count_in_base_256() {
        // 1 texel and a run of 0 + 2 * 256 more; then a run begins again at the lowest digit.
        let texels = [ONE, [1, 1, 1, 0], [1, 1, 1, 2], [7, 7, 7, 129], [1, 1, 1, 1]].concat();
        let image = read(&format!("{MAGIC}\n-Y 1 +X 515\n"), &texels).unwrap().rgb;
        assert!(image.data[..513].iter().all(|texel| *texel == ONE_VALUE));
        assert!(image.data[513..].iter().all(|texel| *texel == [7.0 / 128.0; 3]));
    }

    #[test]
    fn eight_orientations_show_one_picture() {
        // The picture: texel (x, y) of 3 x 2 has red mantissa 10 + 3 y + x.
        let mantissa = |x: usize, y: usize| 10 + 3 * y + x;
        let texel = |x: usize, y: usize| [mantissa(x, y) as u8, 0, 0, 136];
        let flip = |sign: char, positive: char, i: usize, n: usize| if sign == positive { i } else { n - 1 - i };
        for columns_first in [false, true] {
            for (x_sign, y_sign) in [('+', '-'), ('+', '+'), ('-', '-'), ('-', '+')] {
                let (x_axis, y_axis) = (format!("{x_sign}X 3"), format!("{y_sign}Y 2"));
                let (resolution, order): (String, Vec<(usize, usize)>) = if columns_first {
                    (format!("{x_axis} {y_axis}"), (0..3).flat_map(|x| (0..2).map(move |y| (x, y))).collect())
                } else {
                    (format!("{y_axis} {x_axis}"), (0..2).flat_map(|y| (0..3).map(move |x| (x, y))).collect())
                };
                let texels: Vec<u8> = order
                    .into_iter()
                    .flat_map(|(x, y)| texel(flip(x_sign, '+', x, 3), flip(y_sign, '-', y, 2)))
                    .collect();
                let image = read(&format!("{MAGIC}\n{resolution}\n"), &texels).unwrap().rgb;
                let expected = RgbImage::from_fn(3, 2, |x, y| [mantissa(x as usize, y as usize) as f32, 0.0, 0.0]);
                assert_eq!(image, expected, "{resolution}");
            }
        }
    }

    #[test]
    fn exposures_and_colour_corrections_are_divided_out() {
        let header = format!("{MAGIC}EXPOSURE=  4  \nEXPOSURE=0.125\n\tEXPOSURE=99\nCOLORCORR=1 2 0.5\n\n-Y 1 +X 1\n");
        assert_eq!(read(&header, &ONE).unwrap().rgb.data, [[2.0, 0.5, 1.0]]);
    }

    #[test]
    fn headers_that_are_odd_but_legal() {
        let expected = read(&format!("{MAGIC}\n-Y 1 +X 1\n"), &ONE).unwrap().rgb;
        for header in [
            "#?RGBE\n\n-Y 1 +X 1\n".to_owned(),
            "#?RADIANCE\r\nFORMAT=32-bit_rle_rgbe\r\n\r\n-Y 1 +X 1\r\n".to_owned(),
            format!("{MAGIC}# comment\nVIEW= -vtv\nGAMMA=1\nPRIMARIES=0 0 0 0 0 0 0 0\nSOFTWARE=x\n\n-Y 1 +X 1\n"),
            format!("{MAGIC}PRIMARIES=.640 .330 .290 .600 .150 .060 .333 .333\n\n-Y 1 +X 1\n"),
        ] {
            let image = read(&header, &[&ONE[..], b"trailing garbage"].concat()).unwrap();
            assert_eq!(image.rgb, expected, "{header}");
            assert!(image.warnings.is_empty(), "{:?}", image.warnings);
        }
    }

    #[test]
    fn foreign_primaries_are_converted() {
        // BT.2020: its white is Rec.709's, its green lies outside.
        let header = format!("{MAGIC}PRIMARIES=.708 .292 .170 .797 .131 .046 .3127 .3290\n\n-Y 1 +X 2\n");
        let image = read(&header, &[[128, 128, 128, 129], [0, 128, 0, 129]].concat()).unwrap();
        let [white, green] = [image.rgb.get(0, 0), image.rgb.get(1, 0)];
        assert!(white.iter().all(|channel| (channel - 1.0).abs() < 1e-5), "{white:?}");
        // The published matrix (ITU-R BT.2087) has the green column (-0.588, 1.133, -0.101); below 0 is clamped.
        assert!(green[0] == 0.0 && (green[1] - 1.133).abs() < 1e-3 && green[2] == 0.0, "{green:?}");
        assert_eq!(image.warnings.len(), 2, "{:?}", image.warnings);
    }

    #[test]
    fn xyze_inverts_radiances_own_matrix() {
        // Equal energy is grey, in the unit of the file.
        let header = "#?RADIANCE\nFORMAT=32-bit_rle_xyze\nEXPOSURE=0.5\n\n-Y 1 +X 2\n";
        // Red of the Radiance programs is (0.514, 0.265, 0.024) in XYZ; 8-bit mantissas leave half a per cent.
        let image = read(header, &[[128, 128, 128, 129], [132, 68, 6, 128]].concat()).unwrap();
        let [grey, red] = [image.rgb.get(0, 0), image.rgb.get(1, 0)];
        assert!(grey.iter().all(|channel| (channel - 2.0).abs() < 1e-5), "{grey:?}");
        assert!((red[0] - 2.0).abs() < 0.02 && red[1].abs() < 0.01 && red[2].abs() < 0.01, "{red:?}");
        assert!(image.warnings[0].contains("179"));
    }

    #[test]
    fn bad_files_are_refused_with_place_and_expectation() {
        let small = format!("{MAGIC}\n-Y 2 +X 1\n");
        let wide = format!("{MAGIC}\n-Y 1 +X 9\n");
        let cases: &[(String, Vec<u8>, &str)] = &[
            ("P6\n".into(), vec![], "first line is \"P6\""),
            (String::new(), vec![], "no first line"),
            ("#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n".into(), vec![], "no end"),
            ("#?RADIANCE\nFORMAT=8-bit\n\n-Y 1 +X 1\n".into(), ONE.to_vec(), "FORMAT is \"8-bit\""),
            (format!("{MAGIC}EXPOSURE=0\n\n-Y 1 +X 1\n"), ONE.to_vec(), "EXPOSURE is \"0\"; expected a number above 0"),
            (format!("{MAGIC}EXPOSURE=nan\n\n-Y 1 +X 1\n"), ONE.to_vec(), "EXPOSURE is \"nan\""),
            (format!("{MAGIC}COLORCORR=1 2\n\n-Y 1 +X 1\n"), ONE.to_vec(), "expected 3 numbers"),
            (format!("{MAGIC}-Y 1 +X 1\n"), ONE.to_vec(), "blank line before the resolution"),
            (format!("{MAGIC}\n-Y 1 +Z 1\n"), ONE.to_vec(), "resolution line is \"-Y 1 +Z 1\""),
            (format!("{MAGIC}\n-Y 0 +X 1\n"), vec![], "0 pixels"),
            (format!("{MAGIC}\n-Y 2147483647 +X 2147483647\n"), vec![], "2147483647x2147483647"),
            (format!("{MAGIC}\n-Y 10000 +X 10000\n"), vec![0; 64], "probably truncated"),
            (small, ONE.to_vec(), "ends within scanline 1 of 2"),
            (wide.clone(), vec![2, 2, 0, 10], "claims 10 texels, not 9"),
            (wide.clone(), vec![2, 2, 0, 9, 128 + 10, 7], "run of length 10 at texel 0"),
            (wide.clone(), vec![2, 2, 0, 9, 0, 0, 0, 0], "run of length 0"),
            (wide.clone(), vec![1, 1, 1, 5], "repeats nothing"),
            (wide, [ONE, [1, 1, 1, 9]].concat(), "run of length 9 at texel 1"),
        ];
        for (header, pixels, expected) in cases {
            let message = refusal(header, pixels);
            assert!(message.contains(expected), "{header:?}: {message}");
            assert!(message.contains("image.hdr: ") && message.contains("; expected "), "{message}");
        }
    }

    #[test]
    fn paths_that_are_no_files() {
        let folder = folder();
        assert!(radiance::read(folder.path()).unwrap_err().to_string().contains("not a regular file"));
        assert!(radiance::read(&folder.path().join("none.hdr")).unwrap_err().to_string().contains("cannot be read"));
    }
}

mod openexr {
    use super::*;

    fn test_image(seed: u64, width: u32, height: u32) -> RgbImage {
        let mut word = words(seed);
        // All finite bit patterns, subnormals and negative numbers included.
        let mut float = || loop {
            let value = f32::from_bits(word() as u32);
            if value.is_finite() {
                return value;
            }
        };
        RgbImage::from_fn(width, height, |_, _| [float(), float(), float()])
    }

    fn bits(image: &RgbImage) -> Vec<u32> {
        image.data.iter().flatten().map(|value| value.to_bits()).collect()
    }

    #[test]
    fn what_is_written_comes_back_bit_for_bit() {
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
        assert!(exr_file::read_layer(&path, Some("depth")).unwrap_err().to_string().contains("in layer \"depth\""));

        // An outside reader finds the channels under the names that viewers group by.
        let outside = exr::prelude::read_first_flat_layer_from_file(&path).unwrap();
        let names: Vec<String> = outside.layer_data.channel_data.list.iter().map(|c| c.name.to_string()).collect();
        assert_eq!(names, ["A", "B", "G", "R", "standard_error.B", "standard_error.G", "standard_error.R"]);
        let FlatSamples::F32(green) = &outside.layer_data.channel_data.list[2].sample_data else { panic!("not f32") };
        assert!(green.iter().zip(&rgb.data).all(|(green, texel)| green.to_bits() == texel[1].to_bits()));
    }

    #[test]
    fn writing_replaces_and_leaves_nothing_else() {
        let folder = folder();
        let path = folder.path().join("frame.exr");
        let alpha = GrayImage::filled(4, 2, 1.0);
        for seed in [3, 4] {
            exr_file::write_rgba(&path, &test_image(seed, 4, 2), &alpha, &[]).unwrap();
        }
        assert_eq!(bits(&exr_file::read(&path).unwrap().rgb), bits(&test_image(4, 4, 2)));
        // A folder in the way: the rename fails after everything was written.
        let blocked = folder.path().join("blocked.exr");
        std::fs::create_dir(&blocked).unwrap();
        assert!(exr_file::write_rgba(&blocked, &test_image(3, 4, 2), &alpha, &[]).is_err());
        let missing = folder.path().join("none/frame.exr");
        let message = exr_file::write_rgba(&missing, &test_image(3, 4, 2), &alpha, &[]).unwrap_err().to_string();
        assert!(message.contains("none/frame.exr: cannot be written"), "{message}");
        let mut left: Vec<_> = std::fs::read_dir(&folder).unwrap().map(|entry| entry.unwrap().file_name()).collect();
        left.sort();
        assert_eq!(left, ["blocked.exr", "frame.exr"]);
    }

    /// Halves that every lossless compression must keep, as written by the crate `exr`, whole or in tiles that do not divide it.
    #[test]
    fn compressions_and_tiles() {
        let folder = folder();
        let (width, height) = (45, 37);
        let value =
            |channel: usize, x: usize, y: usize| f16::from_f32((channel * 1000 + y * 7 + x * x % 83) as f32 / 64.0);
        let blocks = [exr::image::Blocks::ScanLines, exr::image::Blocks::Tiles(exr::math::Vec2(16, 8))];
        for compression in [
            Compression::Uncompressed,
            Compression::RLE,
            Compression::ZIP1,
            Compression::ZIP16,
            Compression::PIZ,
            Compression::PXR24,
        ] {
            for blocks in blocks {
                let channels = ["B", "G", "R"].into_iter().zip([2, 1, 0]).map(|(name, channel)| {
                    let samples = (0..width * height).map(|i| value(channel, i % width, i / width)).collect();
                    AnyChannel::new(name, FlatSamples::F16(samples))
                });
                let encoding = Encoding { compression, blocks, line_order: LineOrder::Increasing };
                let channels = AnyChannels::sort(channels.collect());
                let path = folder.path().join("lossless.exr");
                Image::from_encoded_channels((width, height), encoding, channels).write().to_file(&path).unwrap();
                let image = exr_file::read(&path).unwrap().rgb;
                let expected = RgbImage::from_fn(width as u32, height as u32, |x, y| {
                    [0, 1, 2].map(|channel| value(channel, x as usize, y as usize).to_f32())
                });
                assert!(image == expected, "{compression:?} {blocks:?}");
            }
        }
    }

    #[test]
    fn mip_maps_show_the_largest_level() {
        let folder = folder();
        let path = folder.path().join("mip.exr");
        let levels = |base: f32| exr::image::Levels::Mip {
            rounding_mode: exr::math::RoundingMode::Down,
            level_data: [16usize, 8, 4, 2, 1]
                .iter()
                .enumerate()
                .map(|(level, size)| FlatSamples::F32(vec![if level == 0 { base } else { 99.0 }; size * size]))
                .collect(),
        };
        let channels = [("R", 1.0), ("G", 2.0), ("B", 3.0)].map(|(name, base)| AnyChannel::new(name, levels(base)));
        let encoding = Encoding {
            compression: Compression::ZIP16,
            blocks: exr::image::Blocks::Tiles(exr::math::Vec2(4, 4)),
            line_order: LineOrder::Increasing,
        };
        Image::from_encoded_channels((16, 16), encoding, AnyChannels::sort(channels.into_iter().collect()))
            .write()
            .to_file(&path)
            .unwrap();
        assert_eq!(exr_file::read(&path).unwrap().rgb, RgbImage::filled(16, 16, [1.0, 2.0, 3.0]));
    }

    #[test]
    fn multi_part_files_give_the_first_part_with_colour() {
        let folder = folder();
        let path = folder.path().join("parts.exr");
        let part = |name: &str, channels: &[(&str, f32)]| {
            let channels =
                channels.iter().map(|(name, value)| AnyChannel::new(*name, FlatSamples::F32(vec![*value; 8])));
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
        assert_eq!(image.warnings, ["Of 3 parts, only part 2 is used."]);
        let albedo = exr_file::read_layer(&path, Some("albedo")).unwrap();
        assert_eq!(albedo.rgb, RgbImage::filled(4, 2, [4.0, 5.0, 6.0]));
    }

    /// A channel of a file made by hand: name, sample type (0 uint, 1 half, 2 float), subsampling, value at a pixel of the data window.
    struct Channel {
        name: &'static str,
        kind: i32,
        sampling: i32,
        value: fn(i32, i32) -> f32,
    }

    fn channel(name: &'static str, kind: i32, value: fn(i32, i32) -> f32) -> Channel {
        Channel { name, kind, sampling: 1, value }
    }

    /// An uncompressed scan-line file after the format's specification. Returns the bytes and where the table of blocks begins.
    fn handmade(channels: &[Channel], data: [i32; 4], display: [i32; 4], extra: &[u8]) -> (Vec<u8>, usize) {
        fn attribute(name: &str, kind: &str, value: &[u8]) -> Vec<u8> {
            let size = (value.len() as i32).to_le_bytes();
            [name.as_bytes(), &[0], kind.as_bytes(), &[0], &size, value].concat()
        }
        let ints = |values: &[i32]| values.iter().flat_map(|value| value.to_le_bytes()).collect::<Vec<u8>>();
        let mut list = Vec::new();
        for channel in channels {
            list.extend([channel.name.as_bytes(), &[0]].concat());
            list.extend(ints(&[channel.kind, 0, channel.sampling, channel.sampling]));
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
            for channel in channels.iter().filter(|channel| y % channel.sampling == 0) {
                for x in (left..=right).filter(|x| x % channel.sampling == 0) {
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
        // The data window lies at (-2, 5).
        let (file, _) = handmade(&channels, [-2, 5, 1, 6], [0, 0, 9, 9], &[]);
        let image = read(&file).unwrap();
        let expected = RgbImage::from_fn(4, 2, |column, row| {
            let (x, y) = (column as i32 - 2, row as i32 + 5);
            [0.1 * (x + 10 * y) as f32, (x * y) as f32 - 0.5, (100_000 + x + y) as f32]
        });
        assert_eq!(image.rgb, expected);
        assert_eq!(image.alpha.unwrap().data[..4], [-1.0, -0.5, 0.0, 0.5]);
        assert!(image.warnings[0].contains("4x2 at -2, 5") && image.warnings[0].contains("data window is used"));
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
        assert_eq!(first(&["Y", "Z"]), [1.0; 3]);
        assert_eq!(first(&["Z", "beauty.B", "beauty.G", "beauty.R"]), [4.0, 3.0, 2.0]);
        // Plain channels win over a prefix that sorts before them.
        assert_eq!(first(&["AO.R", "B", "G", "R"]), [4.0, 3.0, 2.0]);
        let partial = at(&["B", "R"]).unwrap();
        assert_eq!(partial.rgb.get(0, 0), [2.0, 0.0, 1.0]);
        assert_eq!(partial.warnings, ["Channel G is missing; it was set to 0."]);
        let message = at(&["A", "Z"]).unwrap_err().to_string();
        assert!(message.contains("has the channels A, Z; expected R, G, B or Y channels"), "{message}");
    }

    #[test]
    fn luminance_chroma() {
        // Rec.709 R = 0.9, G = 0.5, B = 0.1: the chroma is constant, so its subsampling must not show.
        fn y(_: i32, line: i32) -> f32 {
            (0.2126 * 0.9 + 0.7152 * 0.5 + 0.0722 * 0.1) * (1 + line) as f32
        }
        fn ry(_: i32, _: i32) -> f32 {
            0.9 / y(0, 0) - 1.0
        }
        fn by(_: i32, _: i32) -> f32 {
            0.1 / y(0, 0) - 1.0
        }
        for sampling in [1, 2] {
            let chroma = |name, value| Channel { name, kind: 2, sampling, value };
            let channels = [chroma("BY", by), chroma("RY", ry), channel("Y", 2, y)];
            let image = read(&handmade(&channels, [2, 0, 5, 3], [2, 0, 5, 3], &[]).0).unwrap().rgb;
            for line in 0..4 {
                for (value, expected) in image.get(3, line).iter().zip([0.9, 0.5, 0.1]) {
                    let expected = expected * (1 + line) as f32;
                    assert!((value - expected).abs() < 1e-5 * expected, "{sampling}: {value} {expected}");
                }
            }
        }
        // Chroma that rises by 0.1 a pixel in x is interpolated between its samples at even x.
        fn ramp(x: i32, _: i32) -> f32 {
            0.1 * x as f32
        }
        let chroma = |name, value| Channel { name, kind: 2, sampling: 2, value };
        let channels = [chroma("BY", ramp), chroma("RY", ramp), channel("Y", 2, |_, _| 1.0)];
        let image = read(&handmade(&channels, WINDOW, WINDOW, &[]).0).unwrap().rgb;
        assert!((image.get(1, 1)[0] - 1.1).abs() < 1e-6, "{:?}", image.get(1, 1));
    }

    #[test]
    fn chromaticities_are_converted() {
        // BT.2020, as an attribute of eight floats; white stays white.
        let values: Vec<u8> = [0.708f32, 0.292, 0.170, 0.797, 0.131, 0.046, 0.3127, 0.3290]
            .iter()
            .flat_map(|value| value.to_le_bytes())
            .collect();
        let extra = [b"chromaticities\0chromaticities\0", &32i32.to_le_bytes()[..], &values].concat();
        let channels = [
            channel("B", 2, |x, _| (x == 0) as i32 as f32),
            channel("G", 2, |_, _| 1.0),
            channel("R", 2, |x, _| (x == 0) as i32 as f32),
        ];
        let image = read(&handmade(&channels, WINDOW, WINDOW, &extra).0).unwrap();
        let (white, green) = (image.rgb.get(0, 0), image.rgb.get(1, 0));
        assert!(white.iter().all(|channel| (channel - 1.0).abs() < 1e-5), "{white:?}");
        assert!((green[0] + 0.5876).abs() < 1e-3 && (green[1] - 1.1329).abs() < 1e-3, "{green:?}");
        assert!(image.warnings[0].contains("chromaticities"));
    }

    #[test]
    fn bad_files_are_refused_with_place_and_expectation() {
        let channels = [channel("B", 2, |_, _| 1.0), channel("G", 2, |_, _| 1.0), channel("R", 2, |_, _| 1.0)];
        let (good, table) = handmade(&channels, WINDOW, WINDOW, &[]);
        assert_eq!(read(&good).unwrap().rgb, RgbImage::filled(4, 2, [1.0; 3]));
        let refusal = |file: &[u8]| read(file).unwrap_err().to_string();
        let edited = |at: usize, bytes: &[u8]| {
            let mut file = good.clone();
            file[at..at + bytes.len()].copy_from_slice(bytes);
            file
        };
        let first_block = table + 16;
        let cases: [(Vec<u8>, &str); 9] = [
            (Vec::new(), "no usable header"),
            (b"plain text, no image".to_vec(), "no usable header"),
            (good[..good.len() - 1].to_vec(), "block 1 of 2 is missing or cut off"),
            (good[..table + 9].to_vec(), "ends within the table of blocks"),
            // An unfinished file: the table holds zeros.
            (edited(table + 8, &[0; 8]), "block 1 of 2 is missing or cut off"),
            // Two entries for the first block.
            (edited(table + 8, &good[table..table + 8]), "block 1 of 2: its position comes twice"),
            (edited(first_block, &7i32.to_le_bytes()), "block 0 of 2: its position is outside"),
            (edited(first_block + 4, &4i32.to_le_bytes()), "block 0 of 2: 4 bytes for 48 bytes of pixels"),
            (edited(first_block + 4, &i32::MAX.to_le_bytes()), "block 0 of 2 is missing or cut off"),
        ];
        for (file, expected) in cases {
            let message = refusal(&file);
            assert!(message.contains(expected), "{expected}: {message}");
            assert!(message.contains("handmade.exr") && message.contains("; expected "), "{message}");
        }
        // A window of 2^30 pixels in a small file.
        let window = [0, 0, (1 << 20) - 1, (1 << 10) - 1];
        let at = good.windows(11).position(|bytes| bytes == b"dataWindow\0").unwrap() + 11 + 6 + 4;
        let sizes: Vec<u8> = window.iter().flat_map(|value: &i32| value.to_le_bytes()).collect();
        assert!(refusal(&edited(at, &sizes)).contains("1048576x1024 pixels"));
    }

    /// Damage at random places of small files of several codecs: an image or an error, in bounded time and memory.
    #[test]
    fn mutated_files_do_no_harm() {
        let folder = folder();
        let path = folder.path().join("mutated.exr");
        let mut word = words(0x9e37_79b9_7f4a_7c15);
        for compression in
            [Compression::RLE, Compression::ZIP16, Compression::PIZ, Compression::PXR24, Compression::B44A]
        {
            let channels = ["B", "G", "R"].map(|name| {
                let samples = (0..32 * 20).map(|i| f16::from_f32((i % 57) as f32)).collect();
                AnyChannel::new(name, FlatSamples::F16(samples))
            });
            let encoding =
                Encoding { compression, blocks: exr::image::Blocks::ScanLines, line_order: LineOrder::Increasing };
            let channels = AnyChannels::sort(channels.into_iter().collect());
            Image::from_encoded_channels((32, 20), encoding, channels).write().to_file(&path).unwrap();
            let original = std::fs::read(&path).unwrap();
            let mut refused = 0;
            for _ in 0..200 {
                let mut file = original.clone();
                for _ in 0..1 + word() % 4 {
                    let at = word() as usize % file.len();
                    file[at] = word() as u8;
                }
                std::fs::write(&path, &file).unwrap();
                match exr_file::read(&path) {
                    Ok(image) => assert!(image.rgb.data.len() < 1 << 24),
                    Err(error) => {
                        assert!(!error.what.contains("cannot name"), "a codec panicked: {error}");
                        refused += 1;
                    }
                }
            }
            assert!(refused > 20, "{compression:?}: {refused} of 200");
        }
    }
}

mod png_file {
    use super::*;

    fn image() -> Rgb8Image {
        Rgb8Image::from_fn(5, 3, |x, y| [(x * 50) as u8, (y * 100) as u8, 255])
    }

    #[test]
    fn round_trip() {
        let folder = folder();
        let path = folder.path().join("picture.png");
        png::write_rgb8(&path, &image()).unwrap();
        assert_eq!(png::read_rgb8(&path).unwrap(), image());
        // A relative path without a folder names the current one; nothing else may be left where we wrote.
        assert_eq!(std::fs::read_dir(&folder).unwrap().count(), 1);
    }

    #[cfg(unix)]
    #[test]
    fn files_have_the_rights_of_new_files() {
        use std::os::unix::fs::PermissionsExt;
        let folder = folder();
        let (path, plain) = (folder.path().join("picture.png"), folder.path().join("plain"));
        png::write_rgb8(&path, &image()).unwrap();
        std::fs::write(&plain, b"").unwrap();
        let mode = |path: &Path| std::fs::metadata(path).unwrap().permissions().mode();
        assert_eq!(mode(&path), mode(&plain));
    }

    #[test]
    fn bad_files_are_refused() {
        let folder = folder();
        let path = folder.path().join("picture.png");
        png::write_rgb8(&path, &image()).unwrap();
        let mut bytes = std::fs::read(&path).unwrap();
        let cut = put(&folder, "cut.png", &bytes[..bytes.len() / 2]);
        assert!(png::read_rgb8(&cut).unwrap_err().to_string().contains("cut.png"));
        // Width and height of IHDR.
        bytes[16..24].copy_from_slice(&[0x7f, 0xff, 0xff, 0xff, 0x7f, 0xff, 0xff, 0xff]);
        let huge = put(&folder, "huge.png", &bytes);
        assert!(png::read_rgb8(&huge).is_err());
    }
}

#[test]
fn shrinking_keeps_the_area_weighted_mean() {
    // 5 columns to 2: the third one is shared by halves.
    let image = Rgb8Image::from_fn(5, 2, |x, y| [[10, 20, 60, 100, 200][x as usize], 7, if y == 0 { 0 } else { 100 }]);
    let small = image.shrunk(2, 1);
    // (10 + 20 + 60/2) / 2.5 = 24 and (60/2 + 100 + 200) / 2.5 = 132.
    assert_eq!(small.data, [[24, 7, 50], [132, 7, 50]]);
    assert_eq!(image.shrunk(5, 2), image);
}
