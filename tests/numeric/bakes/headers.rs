//! What headers state beside the size: turned rows, reordered channels, colours, compression, and
//! parts that contradict each other.

use super::files;
use glam::DVec3;
use half::f16;
use ktx2::{Header, LevelIndex};
use splitsum::bake::container::{TEXELS, Texel, Texture, from_bytes};
use splitsum::base::pixels::RgbImage;
use std::io::Write;
use std::path::Path;

/// A file with this data format descriptor and metadata, after a header whose level index and
/// levels [`files::ktx2`] made without them.
fn ktx2_with(
    texel: &Texel,
    side: u32,
    levels: &[files::Level],
    colors: [u8; 4],
    keys: &[(&str, &str)],
) -> Vec<u8> {
    let mut file = files::ktx2(texel, side, levels, false);
    let index_end = Header::LENGTH + LevelIndex::LENGTH * levels.len();
    // Length, then a block: two words, the colours, and nothing that readers of colours need.
    let mut added = 16u32.to_le_bytes().to_vec();
    added.extend([0; 8]);
    added.extend(colors);
    let dfd_length = added.len();
    for (key, value) in keys {
        let pair = [key.as_bytes(), b"\0", value.as_bytes(), b"\0"].concat();
        added.extend((pair.len() as u32).to_le_bytes());
        added.extend(&pair);
        added.resize(added.len().next_multiple_of(4), 0);
    }
    let kvd_length = added.len() - dfd_length;
    let put = |file: &mut Vec<u8>, at: usize, word: usize| {
        file[at..at + 4].copy_from_slice(&(word as u32).to_le_bytes());
    };
    put(&mut file, 48, index_end);
    put(&mut file, 52, dfd_length);
    put(&mut file, 56, index_end + dfd_length);
    put(&mut file, 60, kvd_length);
    for level in 0..levels.len() {
        let at = Header::LENGTH + LevelIndex::LENGTH * level;
        let start = u32::from_le_bytes(file[at..at + 4].try_into().unwrap()) as usize;
        put(&mut file, at, start + added.len());
    }
    file.splice(index_end..index_end, added);
    file
}

fn texel(name: &str) -> &'static Texel {
    TEXELS.iter().find(|texel| texel.name == name).unwrap()
}

fn floats(values: &[f32]) -> Vec<u8> {
    values
        .iter()
        .flat_map(|value| value.to_le_bytes())
        .collect()
}

/// One face of 2x2 texels, each its number: rows from the top are 0 1, 2 3.
fn numbered() -> Vec<files::Level> {
    let texels: Vec<f32> = (0..4)
        .flat_map(|i| [i as f32, 10.0 + i as f32, 20.0 + i as f32, 0.5])
        .collect();
    vec![vec![floats(&texels)]]
}

fn read_ktx2(colors: [u8; 4], keys: &[(&str, &str)]) -> Texture {
    let file = ktx2_with(texel("rgba32f"), 2, &numbered(), colors, keys);
    from_bytes(Path::new("x.ktx2"), &file).unwrap()
}

fn reds(image: &RgbImage) -> Vec<f32> {
    image.data.iter().map(|texel| texel[0]).collect()
}

#[test]
fn orientation_and_swizzle_of_ktx_are_honoured() {
    let plain = read_ktx2([0; 4], &[("KTXorientation", "rd")]);
    assert_eq!(reds(&plain.levels[0][0]), [0.0, 1.0, 2.0, 3.0]);
    assert!(plain.warnings.is_empty(), "{:?}", plain.warnings);
    let up = read_ktx2([0; 4], &[("KTXorientation", "ru")]);
    assert_eq!(reds(&up.levels[0][0]), [2.0, 3.0, 0.0, 1.0]);
    assert!(up.warnings[0].contains("KTXorientation"), "{up:?}");
    let left = read_ktx2([0; 4], &[("KTXorientation", "ld")]);
    assert_eq!(reds(&left.levels[0][0]), [1.0, 0.0, 3.0, 2.0]);
    let swizzled = read_ktx2([0; 4], &[("KTXswizzle", "ba01")]);
    assert_eq!(swizzled.levels[0][0].get(1, 0), [21.0, 0.5, 0.0]);
    assert!(swizzled.warnings[0].contains("KTXswizzle"), "{swizzled:?}");

    // KTX 1 writes the same as S and T.
    let mut old = files::ktx1(texel("rgba32f"), 2, &numbered());
    let pair = b"KTXorientation\0S=r,T=u\0";
    let mut keys = (pair.len() as u32).to_le_bytes().to_vec();
    keys.extend(pair);
    keys.resize(keys.len().next_multiple_of(4), 0);
    old[60..64].copy_from_slice(&(keys.len() as u32).to_le_bytes());
    old.splice(64..76, keys);
    let old = from_bytes(Path::new("x.ktx"), &old).unwrap();
    assert_eq!(reds(&old.levels[0][0]), [2.0, 3.0, 0.0, 1.0]);
}

/// ITU-R BT.2087: Rec.709 red in Rec.2020 is (0.6274, 0.0691, 0.0164). IEC 61966-2-1: the signal
/// 0.5 is 0.2140 linear.
#[test]
fn stated_colours_are_converted_to_linear_rec709() {
    let read = |rgba: [f32; 4], colors: [u8; 4]| {
        let level = vec![vec![floats(&rgba)]];
        let file = ktx2_with(texel("rgba32f"), 1, &level, colors, &[]);
        let texture = from_bytes(Path::new("x.ktx2"), &file)?;
        let [r, g, b] = texture.levels[0][0].get(0, 0).map(f64::from);
        Ok::<_, splitsum::base::pixels::PixelsError>((DVec3::new(r, g, b), texture.warnings))
    };
    let near = |found: DVec3, expected: [f64; 3]| {
        (found - DVec3::from_array(expected)).abs().max_element() < 2e-3
    };
    let (plain, warnings) = read([0.25, 0.5, 0.75, 1.0], [1, 1, 1, 0]).unwrap();
    assert!(near(plain, [0.25, 0.5, 0.75]) && warnings.is_empty());
    let (red, warnings) = read([0.6274, 0.0691, 0.0164, 1.0], [1, 4, 1, 0]).unwrap();
    assert!(near(red, [1.0, 0.0, 0.0]), "{red}");
    assert!(warnings[0].contains("BT.2020"), "{warnings:?}");
    let (grey, warnings) = read([0.5, 0.5, 0.5, 1.0], [1, 1, 2, 0]).unwrap();
    assert!(near(grey, [0.2140; 3]), "{grey}");
    assert!(warnings[0].contains("sRGB"), "{warnings:?}");
    let (divided, warnings) = read([0.1, 0.2, 0.3, 0.5], [1, 1, 1, 1]).unwrap();
    assert!(near(divided, [0.2, 0.4, 0.6]), "{divided}");
    assert!(warnings[0].contains("premultiplied"), "{warnings:?}");
    let refused = read([1.0; 4], [1, 1, 10, 0]).unwrap_err().to_string();
    assert!(refused.contains("PQ EOTF (code 10)"), "{refused}");
}

/// KDF 1.4: the models 163 to 168 are transcoded before they are drawn.
#[test]
fn universal_texels_are_refused_by_name() {
    for (model, name) in [(163, "ETC1S"), (166, "UASTC"), (167, "UASTC HDR of 4x4")] {
        let level = vec![vec![floats(&[1.0; 4])]];
        let mut file = ktx2_with(texel("rgba32f"), 1, &level, [model, 1, 2, 0], &[]);
        // Such files have no Vulkan format; ETC1S is packed by BasisLZ.
        file[12..16].copy_from_slice(&0u32.to_le_bytes());
        file[44..48].copy_from_slice(&u32::from(model == 163).to_le_bytes());
        let message = from_bytes(Path::new("x.ktx2"), &file)
            .unwrap_err()
            .to_string();
        assert!(
            message.contains(&format!("its texels are {name}")),
            "{message}"
        );
        assert!(message.contains("ktx create --format"), "{message}");
    }
}

#[test]
fn levels_packed_by_zlib_are_read() {
    let plain = files::ktx2(texel("rgba32f"), 2, &numbered(), false);
    let right = from_bytes(Path::new("x.ktx2"), &plain).unwrap();
    let mut encoder = flate2::write::ZlibEncoder::new(Vec::new(), flate2::Compression::default());
    encoder.write_all(&numbered()[0][0]).unwrap();
    let packed = encoder.finish().unwrap();
    let mut file = plain.clone();
    file.truncate(plain.len() - 64);
    file.extend(&packed);
    file[44..48].copy_from_slice(&3u32.to_le_bytes());
    file[88..92].copy_from_slice(&(packed.len() as u32).to_le_bytes());
    let found = from_bytes(Path::new("x.ktx2"), &file).unwrap();
    assert_eq!(found.levels, right.levels);
    file[44..48].copy_from_slice(&1u32.to_le_bytes());
    let refused = from_bytes(Path::new("x.ktx2"), &file)
        .unwrap_err()
        .to_string();
    assert!(refused.contains("BasisLZ"), "{refused}");
}

/// A block of BC6H, mode 11: five bits of mode, two endpoints of three times ten bits, indices.
/// Equal endpoints E are the half whose bits are 31/64 of `(65536 E + 32768)/1024`.
#[test]
fn blocks_of_bc6h_are_decoded() {
    let endpoints: [u32; 3] = [100, 400, 700];
    let mut block = 0b00011u128;
    for (i, endpoint) in endpoints.iter().chain(&endpoints).enumerate() {
        block |= u128::from(*endpoint) << (5 + 10 * i);
    }
    let expected = endpoints.map(|endpoint| {
        let unquantized = ((endpoint << 16) + 0x8000) >> 10;
        f16::from_bits(((unquantized * 31) >> 6) as u16).to_f32()
    });
    // Two blocks a row, of which the second is cut at 6 texels.
    let mut file = files::ktx2(
        texel("rgba32f"),
        6,
        &[vec![block.to_le_bytes().repeat(4)]],
        false,
    );
    file[12..16].copy_from_slice(&143u32.to_le_bytes());
    let found = from_bytes(Path::new("x.ktx2"), &file).unwrap();
    assert_eq!(found.texel, "bc6h");
    assert_eq!(found.levels[0][0], RgbImage::filled(6, 6, expected));

    let mut dds = files::dds(texel("rgba32f"), 4, &[vec![vec![0; 256]]]);
    dds.truncate(148);
    dds[128..132].copy_from_slice(&95u32.to_le_bytes());
    dds.extend(block.to_le_bytes());
    let found = from_bytes(Path::new("x.dds"), &dds).unwrap();
    assert_eq!(found.levels[0][0], RgbImage::filled(4, 4, expected));
    // No bytes make the decoder panic.
    for seed in 0..2000u32 {
        let bytes = blake3::hash(&seed.to_le_bytes());
        dds[148..164].copy_from_slice(&bytes.as_bytes()[..16]);
        let _ = from_bytes(Path::new("x.dds"), &dds);
    }
}

/// The flag of levels, too few levels, and no caps of a cube.
#[test]
fn headers_that_state_too_little_are_read_or_refused() {
    let rgba = texel("rgba32f");
    let faces = |count: usize| -> Vec<files::Level> {
        let level = |side: usize| vec![floats(&vec![1.0; 4 * side * side]); count];
        [4, 2, 1].map(level).to_vec()
    };
    let with = |bytes: &[u8], at: usize, word: u32| {
        let mut changed = bytes.to_vec();
        changed[at..at + 4].copy_from_slice(&word.to_le_bytes());
        changed
    };
    let word = |bytes: &[u8], at: usize| u32::from_le_bytes(bytes[at..at + 4].try_into().unwrap());
    let level_count = |bytes: &[u8]| {
        let found = from_bytes(Path::new("x.dds"), bytes);
        found.map(|texture| (texture.levels.len(), texture.levels[0].len()))
    };
    let refused = |name: &str, bytes: &[u8], part: &str| {
        let message = from_bytes(Path::new(name), bytes).unwrap_err().to_string();
        assert!(message.contains(part), "{part}: {message}");
    };
    let cube = files::dds(rgba, 4, &faces(6));
    assert_eq!(level_count(&cube).unwrap(), (3, 6));
    // Flags begin at byte 8, the number of levels at 28, the second caps at 112.
    let without_flag = with(&cube, 8, word(&cube, 8) & !0x2_0000);
    assert_eq!(level_count(&without_flag).unwrap(), (3, 6));
    let too_few = with(&cube, 28, 1);
    refused("x.dds", &too_few, "follow the 1 levels of 6 faces");
    refused("x.dds", &too_few, "its bytes are 3 levels of 6 faces");
    let no_caps = with(&with(&cube, 112, 0), 136, 0);
    refused("x.dds", &no_caps, "its bytes are 3 levels of 6 faces");
    // Any number without the flag, beside one level.
    let one = files::dds(rgba, 4, &faces(6)[..1]);
    let unflagged = with(&with(&one, 8, word(&one, 8) & !0x2_0000), 28, 3);
    assert_eq!(level_count(&unflagged).unwrap(), (1, 6));

    let old = files::ktx1(rgba, 4, &faces(6));
    let states_one = with(&old, 56, 1);
    refused("x.ktx", &states_one, "follow the 1 levels of 6 faces");
    let mut longer = files::ktx2(rgba, 4, &faces(6), false);
    longer.extend([0; 100]);
    refused("x.ktx2", &longer, "100 bytes follow the 3 levels");
}

/// Faces counted as cubes, and arrays without the flag of a cube.
#[test]
fn six_layers_of_dds_are_one_cube_unless_they_are_six() {
    let rgba = texel("rgba32f");
    let level = |side: usize| -> files::Level {
        (0..6)
            .map(|face| floats(&vec![face as f32; 4 * side * side]))
            .collect()
    };
    let cube = files::dds(rgba, 4, &[4, 2, 1].map(level));
    // The second caps begin at byte 112, the second header's flags at 136, its count at 140.
    let with = |words: &[(usize, u32)]| {
        let mut changed = cube.clone();
        for (at, word) in words {
            changed[*at..at + 4].copy_from_slice(&word.to_le_bytes());
        }
        changed
    };
    let read = |bytes: &[u8]| from_bytes(Path::new("x.dds"), bytes);
    let right = read(&with(&[(140, 1)])).unwrap();
    assert!(right.warnings.is_empty(), "{:?}", right.warnings);
    assert_eq!(reds(&right.levels[1][5]), [5.0; 4]);
    let none = read(&with(&[(140, 0)])).unwrap();
    assert_eq!(none.levels, right.levels);
    for (flags, warning) in [
        (vec![(140, 6)], "counts six cubes"),
        // As NVIDIA's texture tools: the flag is in the first header only.
        (vec![(140, 6), (136, 0)], "counts six cubes"),
        (vec![(140, 6), (136, 0), (112, 0)], "not marked as a cube"),
    ] {
        let found = read(&with(&flags)).unwrap();
        assert_eq!(found.levels, right.levels, "{flags:?}");
        assert!(found.warnings[0].contains(warning), "{:?}", found.warnings);
    }
    let data = cube[148..].repeat(6);
    let six_cubes = [&with(&[(140, 6)])[..148], &data].concat();
    let refused = read(&six_cubes).unwrap_err().to_string();
    assert!(refused.contains("6 layers"), "{refused}");
    let short = with(&[(140, 6)]);
    let refused = read(&short[..short.len() - 1]).unwrap_err().to_string();
    assert!(refused.contains("truncated"), "{refused}");
    // Six layers that are not square are not a cube.
    let wide = with(&[(140, 6), (136, 0), (112, 0), (16, 8)]);
    assert!(read(&wide).unwrap_err().to_string().contains("6 layers"));
}
