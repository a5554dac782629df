//! Tables of other tools: files against closed forms, hostile files, and the search for the parts
//! of a bake.

mod causes;
mod coarse_mips;
pub mod files;
mod headers;
mod make;
mod packed;
mod plain;
pub mod scores;
pub mod slips;

use files::Level;
use half::f16;
use splitsum::bake::container::{Encoding, FORMATS, TEXELS, Texel, from_bytes};
use splitsum::bake::source::{Reading, read};
use splitsum::base::pixels::{GrayImage, RgbImage, exr};
use std::path::Path;

/// A texel of a format, and the small whole numbers that it encodes.
fn encoded(texel: &Texel, [r, g, b]: [u32; 3]) -> (Vec<u8>, [f32; 3]) {
    let channels = [r, g, b, 1].map(|value| value as f32);
    let count = match texel.name {
        name if name.starts_with("rgba") => 4,
        name if name.starts_with("rgb") => 3,
        _ => 2,
    };
    let seen = |i: usize| if i < count { channels[i] } else { 0.0 };
    let seen = [seen(0), seen(1), seen(2)];
    match texel.name {
        // Mantissas of 9 bits with the exponent of 1: 2^(24 - 15 - 9).
        "rgb9e5" => (
            (r | g << 9 | b << 18 | 24 << 27).to_le_bytes().to_vec(),
            channels[..3].try_into().unwrap(),
        ),
        "r11g11b10f" => {
            let bits =
                |value: u32, drop: u32| u32::from(f16::from_f32(value as f32).to_bits()) >> drop;
            let word = bits(r, 4) | bits(g, 4) << 11 | bits(b, 5) << 22;
            (
                word.to_le_bytes().to_vec(),
                channels[..3].try_into().unwrap(),
            )
        }
        name if name.ends_with("16f") => (
            channels[..count]
                .iter()
                .flat_map(|v| f16::from_f32(*v).to_le_bytes())
                .collect(),
            seen,
        ),
        _ => (
            channels[..count]
                .iter()
                .flat_map(|v| v.to_le_bytes())
                .collect(),
            seen,
        ),
    }
}

/// The place of a texel as a colour: face and level, column, row.
fn place(face: u32, level: u32, x: u32, y: u32) -> [u32; 3] {
    [1 + face + 8 * level, 1 + x, 1 + y]
}

/// A cube of 4 with its levels, each texel of its own colour: as bytes, and as decoded colours.
fn marker(texel: &Texel, faces: u32) -> (Vec<Level>, Vec<Vec<RgbImage>>) {
    let sides = [4, 2, 1];
    let bytes = |level: u32, face: u32| {
        let side = sides[level as usize];
        (0..side * side)
            .flat_map(|i| encoded(texel, place(face, level, i % side, i / side)).0)
            .collect()
    };
    let image = |level: u32, face: u32| {
        let side = sides[level as usize];
        RgbImage::from_fn(side, side, |x, y| {
            encoded(texel, place(face, level, x, y)).1
        })
    };
    let of = |level: u32| (0..faces).map(|face| bytes(level, face)).collect();
    let seen = |level: u32| (0..faces).map(|face| image(level, face)).collect();
    ((0..3).map(of).collect(), (0..3).map(seen).collect())
}

#[test]
fn every_pixel_format_is_read_from_every_container() {
    for texel in TEXELS {
        for faces in [1, 6] {
            let (bytes, seen) = marker(texel, faces);
            let check = |name: &str, file: &[u8]| {
                let found = from_bytes(Path::new(name), file)
                    .unwrap_or_else(|error| panic!("{} {error}", texel.name));
                assert!(
                    found.levels == seen && found.texel == texel.name,
                    "{} in {name}: {found:?}",
                    texel.name
                );
            };
            check("x.ktx2", &files::ktx2(texel, 4, &bytes, false));
            check("x.ktx2", &files::ktx2(texel, 4, &bytes, true));
            check("x.ktx", &files::ktx1(texel, 4, &bytes));
            if texel.dxgi.is_some() {
                check("x.dds", &files::dds(texel, 4, &bytes));
            }
            // Our own levels begin at multiples of 4 and of a texel's bytes (KTX 2.0, section
            // 3.9.7).
            let own = (FORMATS[0].write)(&Encoding {
                texel,
                levels: &seen,
                keys: &[],
                is_packed: false,
            });
            let mut starts = own[80..152]
                .chunks(24)
                .map(|entry| u32::from_le_bytes(entry[..4].try_into().unwrap()));
            assert!(
                starts.all(|start| start % 4 == 0 && start % texel.bytes as u32 == 0),
                "{}",
                texel.name
            );
        }
    }
}

/// [Vulkan13]: floats of 11 and 10 bits have 6 and 5 bits of mantissa, an exponent of bias 15, and
/// denormals.
#[test]
fn packed_floats_follow_their_formulas() {
    let one = |name: &str, word: u32| {
        let texel = TEXELS.iter().find(|texel| texel.name == name).unwrap();
        let file = files::ktx2(texel, 1, &[vec![word.to_le_bytes().to_vec()]], false);
        from_bytes(Path::new("x.ktx2"), &file).unwrap().levels[0][0]
            .get(0, 0)
            .map(f64::from)
    };
    let float = |bits: u32, mantissa_bits: u32| {
        let (mantissa, exponent) = (
            f64::from(bits & ((1 << mantissa_bits) - 1)),
            (bits >> mantissa_bits) as i32,
        );
        let share = mantissa / f64::from(1 << mantissa_bits);
        if exponent == 0 {
            share * 2f64.powi(-14)
        } else {
            (1.0 + share) * 2f64.powi(exponent - 15)
        }
    };
    for i in 0..2000u32 {
        let (r, g, b) = ((i * 7) % 1984, (i * 13 + 1) % 1984, (i * 5 + 3) % 992);
        assert_eq!(
            one("r11g11b10f", r | g << 11 | b << 22),
            [float(r, 6), float(g, 6), float(b, 5)]
        );
        let (r, g, b, e) = ((i * 7) % 512, (i * 11) % 512, (i * 3) % 512, i % 32);
        let scale = 2f64.powi(e as i32 - 15 - 9);
        assert_eq!(
            one("rgb9e5", r | g << 9 | b << 18 | e << 27),
            [r, g, b].map(|m| f64::from(m) * scale)
        );
    }
}

fn refused(name: &str, bytes: &[u8], part: &str) {
    let message = from_bytes(Path::new(name), bytes)
        .expect_err(part)
        .to_string();
    assert!(
        message.contains(part) && message.contains(name) && message.lines().count() == 1,
        "{part:?}: {message}"
    );
}

#[test]
fn hostile_files_are_refused_with_the_fact() {
    let texel = &TEXELS[0];
    let (levels, _) = marker(texel, 6);
    let good = files::ktx2(texel, 4, &levels, false);
    let with = |bytes: &[u8], at: usize, word: u32| {
        let mut changed = bytes.to_vec();
        changed[at..at + 4].copy_from_slice(&word.to_le_bytes());
        changed
    };
    // Width, height, depth, layers, faces and levels begin at byte 20, the level index at 80.
    refused("x.ktx2", &with(&good, 20, 8), "its faces are 8x4");
    let huge = with(&with(&good, 20, 1 << 30), 24, 1 << 30);
    refused("x.ktx2", &huge, "which take");
    refused("x.ktx2", &with(&good, 28, 4), "a depth of 4");
    refused("x.ktx2", &with(&good, 36, 5), "5 faces");
    refused("x.ktx2", &with(&good, 40, 400), "400 levels of 4x4");
    refused(
        "x.ktx2",
        &with(&with(&good, 20, 2), 24, 2),
        "3 levels of 2x2",
    );
    let first = u32::from_le_bytes(good[80..84].try_into().unwrap());
    refused("x.ktx2", &with(&good, 104, first), "share bytes");
    refused(
        "x.ktx2",
        &good[..good.len() - 1],
        "expected a complete KTX 2 file",
    );
    refused("x.ktx2", &with(&good, 12, 37), "R8G8B8A8_UNORM");

    // 64 MiB of zeros pack into a few kilobytes; the header claims 4 x 4 texels.
    let mut bomb = levels.clone();
    bomb[0] = vec![vec![0; 1 << 26]];
    let bomb = with(&files::ktx2(texel, 4, &bomb, true), 36, 6);
    assert!(bomb.len() < 1 << 14);
    refused("x.ktx2", &bomb, "unpacks to more than its 768 bytes");

    let good = files::ktx1(texel, 4, &levels);
    refused("x.ktx", &with(&good, 12, 0x0102_0304), "its byte order");
    refused("x.ktx", &with(&good, 36, 5), "its faces are 5x4");
    refused("x.ktx", &with(&good, 60, u32::MAX), "level 0 needs 4 bytes");
    refused(
        "x.ktx",
        &with(&good, 76, 1 << 31),
        "level 0 claims 2147483648 bytes a face",
    );
    refused(
        "x.ktx",
        &good[..good.len() - 1],
        "level 2 needs 48 bytes but has 47",
    );

    let good = files::dds(texel, 4, &levels);
    refused("x.dds", &good[..good.len() - 1], "truncated");
    refused("x.dds", &with(&good, 16, 5), "its faces are 5x4");
    refused("x.dds", &with(&good, 28, 9), "9 levels of 4x4");
    refused("x.dds", &with(&good, 140, 3), "3 layers");
    let one = files::dds(texel, 4, &marker(texel, 1).0);
    assert_eq!(
        from_bytes(Path::new("x.dds"), &with(&one[..one.len() - 80], 12, 2))
            .unwrap()
            .levels
            .len(),
        3,
        "4x2, 2x1 and 1x1"
    );

    let mut infinite = levels.clone();
    infinite[1][4][..2].copy_from_slice(&f16::INFINITY.to_le_bytes());
    refused(
        "x.ktx2",
        &files::ktx2(texel, 4, &infinite, false),
        "level 1, face 4, column 0, row 0",
    );
    refused("x.tga", &good, "its extension is \"tga\"");
}

/// Faces, lat-long levels and tables through files and the roles of their names.
#[test]
fn folders_and_images_are_found_by_their_form() {
    let dir = tempfile::tempdir().unwrap();
    let path = |name: &str| dir.path().join(name).to_string_lossy().into_owned();
    let write = |name: &str, image: &RgbImage| {
        exr::write_rgba(
            Path::new(&path(name)),
            image,
            &GrayImage::filled(image.width, image.height, 1.0),
            &[],
        )
        .unwrap();
    };
    let reading = Reading {
        layout: None,
        brdf: "ggx",
        byte_color: None,
    };
    let (_, seen) = marker(&TEXELS[3], 6);
    std::fs::create_dir(dir.path().join("faces")).unwrap();
    for (level, faces) in seen.iter().enumerate() {
        for (name, face) in ["px", "nx", "py", "ny", "pz", "nz"].iter().zip(faces) {
            write(&format!("faces/m{level}_{name}.exr"), face);
        }
    }
    let bake = read(&[path("faces")], reading).unwrap();
    assert_eq!(bake.specular.unwrap().levels, seen);

    let lat_long = |side: u32| RgbImage::from_fn(2 * side, side, |x, y| [x as f32, y as f32, 1.0]);
    write("a.exr", &lat_long(8));
    write("b.exr", &lat_long(4));
    assert_eq!(
        read(&[path("a.exr"), path("a.exr")], reading)
            .unwrap()
            .specular
            .unwrap()
            .levels
            .len(),
        2
    );
    write("table.exr", &RgbImage::filled(4, 4, [0.5, 0.25, 0.0]));
    write(
        "strip.exr",
        &RgbImage::from_fn(2, 12, |x, y| [x as f32, y as f32, 2.0]),
    );
    let bake = read(
        &[
            path("a.exr"),
            path("b.exr"),
            path("table.exr"),
            format!("irradiance={}", path("strip.exr")),
        ],
        reading,
    )
    .unwrap();
    assert_eq!(
        bake.specular.unwrap().levels,
        [[lat_long(8)], [lat_long(4)]]
    );
    assert_eq!(bake.dfg.unwrap().get(3, 3), [0.5, 0.25, 0.0]);
    let cube = bake.irradiance.unwrap();
    assert_eq!(
        (
            cube.layout.name,
            cube.levels[0].len(),
            cube.levels[0][5].get(1, 0)
        ),
        ("cube", 6, [1.0, 10.0, 2.0])
    );

    let refuse = |files: &[String], part: &str| {
        let message = read(files, reading).unwrap_err().to_string();
        assert!(message.contains(part), "{part}: {message}");
    };
    std::fs::remove_file(dir.path().join("faces/m2_ny.exr")).unwrap();
    refuse(&[path("faces")], "level 2 lacks the faces ny");
    std::fs::remove_file(dir.path().join("faces/m1_px.exr")).unwrap();
    refuse(
        &[path("faces")],
        "it has m1_nx.exr, but not every face before it",
    );
    write("faces/m0_ny.exr", &lat_long(2));
    refuse(&[path("faces")], "one square face of 4x4");
    write("odd.exr", &RgbImage::filled(5, 3, [0.0; 3]));
    refuse(&[path("odd.exr")], "it is one image of 5x3");
    refuse(
        &[path("table.exr"), path("table.exr")],
        "the second DFG table",
    );
    refuse(&[path("none.ktx2")], "cannot be read");
}

/// Grey and alpha, 8 bits and 16.
#[test]
fn png_tables_keep_their_samples() {
    use image::{DynamicImage, ImageBuffer, ImageFormat};
    let read = |image: DynamicImage| {
        let mut bytes = std::io::Cursor::new(Vec::new());
        image.write_to(&mut bytes, ImageFormat::Png).unwrap();
        from_bytes(Path::new("x.png"), bytes.get_ref())
            .unwrap()
            .levels[0][0]
            .get(1, 0)
    };
    let eight = ImageBuffer::from_fn(2, 2, |x, _| image::Rgb([(51 * x) as u8, 255, 7]));
    assert_eq!(
        read(DynamicImage::ImageRgb8(eight)),
        [0.2, 1.0, 7.0 / 255.0]
    );
    let sixteen = ImageBuffer::from_fn(2, 2, |x, _| image::Rgba([(12345 * x) as u16, 65535, 1, 9]));
    assert_eq!(
        read(DynamicImage::ImageRgba16(sixteen)),
        [12345.0 / 65535.0, 1.0, 1.0 / 65535.0]
    );
    let pair = ImageBuffer::from_fn(2, 2, |x, _| image::LumaA([(100 * x) as u16, 4000]));
    assert_eq!(
        read(DynamicImage::ImageLumaA16(pair)),
        [100.0 / 65535.0, 4000.0 / 65535.0, 0.0]
    );
}
