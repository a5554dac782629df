//! Radiance files.

use crate::snapshot::assert_snapshot;
use splitsum::base::pixels::{Decoded, PixelsError, RgbImage, radiance};
use std::path::Path;

const MAGIC: &str = "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n";

fn read(header: &str, pixels: &[u8]) -> Result<Decoded, PixelsError> {
    radiance::read_bytes(
        Path::new("image.hdr"),
        &[header.as_bytes(), pixels].concat(),
        None,
    )
}

/// (mantissas, e): 2^(e - 136).
const ONE: [u8; 4] = [128, 64, 32, 129];
const ONE_VALUE: [f32; 3] = [1.0, 0.5, 0.25];

#[test]
fn flat_texels() {
    let image = read(
        &format!("{MAGIC}\n-Y 1 +X 3\n"),
        &[ONE, [255, 0, 1, 128], [9, 9, 9, 0]].concat(),
    )
    .unwrap();
    assert_eq!(
        image.rgb.data,
        [ONE_VALUE, [255.0 / 256.0, 0.0, 1.0 / 256.0], [0.0; 3]]
    );
    assert!(image.alpha.is_none() && image.warnings.is_empty());
}

#[test]
fn extreme_exponents_stay_finite() {
    let image = read(
        &format!("{MAGIC}\n-Y 1 +X 2\n"),
        &[[255, 128, 1, 255], [1, 128, 255, 1]].concat(),
    )
    .unwrap();
    assert_eq!(
        image.rgb.get(0, 0),
        [255, 128, 1].map(|m: i32| (f64::from(m) * 2f64.powi(119)) as f32)
    );
    assert_eq!(
        image.rgb.get(1, 0),
        [1, 128, 255].map(|m: i32| (f64::from(m) * 2f64.powi(-135)) as f32)
    );
}

#[test]
fn run_length_forms_agree_with_flat() {
    // Nine texels: one A, then eight B.
    let (a, b) = ([200, 100, 50, 130], [10, 255, 128, 127]);
    let header = format!("{MAGIC}\n-Y 1 +X 9\n");
    let flat = read(&header, &[vec![a], vec![b; 8]].concat().concat())
        .unwrap()
        .rgb;
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
    let texels = [
        ONE,
        [1, 1, 1, 0],
        [1, 1, 1, 2],
        [7, 7, 7, 129],
        [1, 1, 1, 1],
    ]
    .concat();
    let image = read(&format!("{MAGIC}\n-Y 1 +X 515\n"), &texels)
        .unwrap()
        .rgb;
    assert!(image.data[..513].iter().all(|texel| *texel == ONE_VALUE));
    assert!(
        image.data[513..]
            .iter()
            .all(|texel| *texel == [7.0 / 128.0; 3])
    );
}

#[test]
fn eight_orientations_show_one_picture() {
    // The picture: texel (x, y) of 3 x 2 has red mantissa 10 + 3 y + x.
    let mantissa = |x: usize, y: usize| 10 + 3 * y + x;
    let texel = |x: usize, y: usize| [mantissa(x, y) as u8, 0, 0, 136];
    let flip = |sign: char, positive: char, i: usize, n: usize| {
        if sign == positive { i } else { n - 1 - i }
    };
    for columns_first in [false, true] {
        for (x_sign, y_sign) in [('+', '-'), ('+', '+'), ('-', '-'), ('-', '+')] {
            let (x_axis, y_axis) = (format!("{x_sign}X 3"), format!("{y_sign}Y 2"));
            let (resolution, order): (String, Vec<(usize, usize)>) = if columns_first {
                (
                    format!("{x_axis} {y_axis}"),
                    (0..3).flat_map(|x| (0..2).map(move |y| (x, y))).collect(),
                )
            } else {
                (
                    format!("{y_axis} {x_axis}"),
                    (0..2).flat_map(|y| (0..3).map(move |x| (x, y))).collect(),
                )
            };
            let texels: Vec<u8> = order
                .into_iter()
                .flat_map(|(x, y)| texel(flip(x_sign, '+', x, 3), flip(y_sign, '-', y, 2)))
                .collect();
            let image = read(&format!("{MAGIC}\n{resolution}\n"), &texels)
                .unwrap()
                .rgb;
            let expected = RgbImage::from_fn(3, 2, |x, y| {
                [mantissa(x as usize, y as usize) as f32, 0.0, 0.0]
            });
            assert_eq!(image, expected, "{resolution}");
        }
    }
}

#[test]
fn exposures_and_colour_corrections_are_divided_out() {
    let header = format!(
        "{MAGIC}EXPOSURE=  4  \nEXPOSURE=0.125\n\tEXPOSURE=99\nCOLORCORR=1 2 0.5\n\n-Y 1 +X 1\n"
    );
    let image = read(&header, &ONE).unwrap();
    assert_eq!(image.rgb.data, [[2.0, 0.5, 1.0]]);
    // Many programs ignore the field, so the factor is named.
    assert!(
        image.warnings[0].contains("exposure 0.5 1 0.25"),
        "{:?}",
        image.warnings
    );
}

/// What programs write for "not exposed", and their own words in the first line.
#[test]
fn odd_exposures_and_first_lines_are_read_with_a_warning() {
    for (header, warning) in [
        (format!("{MAGIC}EXPOSURE=0\n\n-Y 1 +X 1\n"), "it is ignored"),
        (format!("{MAGIC}EXPOSURE=\n\n-Y 1 +X 1\n"), "it is ignored"),
        (
            format!("{MAGIC}EXPOSURE=1 # none\n\n-Y 1 +X 1\n"),
            "1 was used",
        ),
        (
            "#?AUTOPANO\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 1\n".to_owned(),
            "#?AUTOPANO",
        ),
    ] {
        let image = read(&header, &ONE).unwrap();
        assert_eq!(image.rgb.data, [[1.0, 0.5, 0.25]], "{header}");
        assert!(image.warnings[0].contains(warning), "{:?}", image.warnings);
    }
}

/// Radiance's views are not lat-long maps, its pixels may not be square, and other programs' files
/// may be encoded.
#[test]
fn views_pixel_aspects_and_gammas_are_named() {
    let warnings = |field: &str| {
        let header = format!("{MAGIC}{field}\n\n-Y 1 +X 1\n");
        read(&header, &[128, 128, 128, 128]).unwrap().warnings
    };
    assert!(warnings("VIEW= -vta -vh 180 -vv 180")[0].contains("an angular fisheye (-vta)"));
    assert!(warnings("VIEW= -vp 0 0 0 -vtv -vh 45")[0].contains("a perspective view"));
    assert!(warnings("PIXASPECT=2.0")[0].contains("pixel aspect ratio 2.0"));
    assert!(warnings("GAMMA= 2.2")[0].contains("GAMMA is \"2.2\""));
    for harmless in [
        "VIEW= -vtc -vh 360 -vv 180",
        "VIEW= -vp 0 0 0",
        "PIXASPECT= 1.000",
        "GAMMA=1.00",
    ] {
        assert!(warnings(harmless).is_empty(), "{harmless}");
    }
}

#[test]
fn headers_that_are_odd_but_legal() {
    let expected = read(&format!("{MAGIC}\n-Y 1 +X 1\n"), &ONE).unwrap().rgb;
    for header in [
        "#?RGBE\n\n-Y 1 +X 1\n".to_owned(),
        "#?RADIANCE\r\nFORMAT=32-bit_rle_rgbe\r\n\r\n-Y 1 +X 1\r\n".to_owned(),
        format!(
            "{MAGIC}# comment\nVIEW= -vtc\nGAMMA=1\nPRIMARIES=0 0 0 0 0 0 0 0\nSOFTWARE=x\n\n-Y 1 \
             +X 1\n"
        ),
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
    let header =
        format!("{MAGIC}PRIMARIES=.708 .292 .170 .797 .131 .046 .3127 .3290\n\n-Y 1 +X 2\n");
    let image = read(&header, &[[128, 128, 128, 129], [0, 128, 0, 129]].concat()).unwrap();
    let [white, green] = [image.rgb.get(0, 0), image.rgb.get(1, 0)];
    assert!(
        white.iter().all(|channel| (channel - 1.0).abs() < 1e-5),
        "{white:?}"
    );
    // The published matrix (ITU-R BT.2087) has the green column (-0.588, 1.133, -0.101); below 0 is
    // clamped.
    assert!(
        green[0] == 0.0 && (green[1] - 1.133).abs() < 1e-3 && green[2] == 0.0,
        "{green:?}"
    );
    assert_eq!(image.warnings.len(), 2, "{:?}", image.warnings);
}

#[test]
fn bad_files_are_refused_with_place_and_expectation() {
    let small = format!("{MAGIC}\n-Y 2 +X 1\n");
    let wide = format!("{MAGIC}\n-Y 1 +X 9\n");
    let cases: &[(&str, String, Vec<u8>)] = &[
        ("another format", "P6\n".into(), vec![]),
        ("empty", String::new(), vec![]),
        (
            "no end of the header",
            "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n".into(),
            vec![],
        ),
        (
            "8 bits",
            "#?RADIANCE\nFORMAT=8-bit\n\n-Y 1 +X 1\n".into(),
            ONE.to_vec(),
        ),
        (
            "XYZE",
            "#?RADIANCE\nFORMAT=32-bit_rle_xyze\n\n-Y 1 +X 1\n".into(),
            ONE.to_vec(),
        ),
        (
            "exposure nan",
            format!("{MAGIC}EXPOSURE=nan\n\n-Y 1 +X 1\n"),
            ONE.to_vec(),
        ),
        (
            "two corrections",
            format!("{MAGIC}COLORCORR=1 2\n\n-Y 1 +X 1\n"),
            ONE.to_vec(),
        ),
        ("no blank line", format!("{MAGIC}-Y 1 +X 1\n"), ONE.to_vec()),
        ("an axis z", format!("{MAGIC}\n-Y 1 +Z 1\n"), ONE.to_vec()),
        ("no pixels", format!("{MAGIC}\n-Y 0 +X 1\n"), vec![]),
        (
            "too many pixels",
            format!("{MAGIC}\n-Y 2147483647 +X 2147483647\n"),
            vec![],
        ),
        (
            "fewer bytes than any form of 25 million pixels",
            format!("{MAGIC}\n-Y 5000 +X 5000\n"),
            vec![0; 64],
        ),
        (
            "more than memory holds",
            format!("{MAGIC}\n-Y 8192 +X 16384\n"),
            vec![0; 1 << 17],
        ),
        ("one scanline of two", small, ONE.to_vec()),
        (
            "a scanline of another width",
            wide.clone(),
            vec![2, 2, 0, 10],
        ),
        (
            "a run over the end",
            wide.clone(),
            vec![2, 2, 0, 9, 128 + 10, 7],
        ),
        (
            "a literal of none",
            wide.clone(),
            vec![2, 2, 0, 9, 0, 0, 0, 0],
        ),
        ("an old run of nothing", wide.clone(), vec![1, 1, 1, 5]),
        (
            "an old run over the end",
            wide,
            [ONE, [1, 1, 1, 9]].concat(),
        ),
    ];
    let shown = cases.iter().map(|(case, header, pixels)| {
        let message = read(header, pixels).unwrap_err().to_string();
        format!("{case}: {}", message.split_once(": ").unwrap().1)
    });
    assert_snapshot(
        "radiance_files_that_are_refused",
        &shown.collect::<Vec<_>>().join("\n"),
    );
}
