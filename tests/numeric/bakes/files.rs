//! Files of every container, made by the tests.

use glam::{DVec2, DVec3};
use ktx2::{Header, Index, LevelIndex, SupercompressionScheme};
use ruzstd::encoding::{CompressionLevel, compress_to_vec};
use splitsum::bake::container::Texel;
use splitsum::base::pixels::RgbImage;
use splitsum::instrument::environment::layout::MapLayout;

pub fn faces(
    layout: &MapLayout,
    [width, height]: [u32; 2],
    value: impl Fn(DVec3) -> DVec3,
) -> Vec<RgbImage> {
    let size = DVec2::new(width.into(), height.into());
    let texel = |face: u32, x: u32, y: u32| {
        let uv = (DVec2::new(x.into(), y.into()) + 0.5) / size;
        value((layout.direction)(face, uv)).as_vec3().to_array()
    };
    (0..layout.face_count)
        .map(|face| RgbImage::from_fn(width, height, |x, y| texel(face, x, y)))
        .collect()
}

pub type Level = Vec<Vec<u8>>;

/// A KTX 2 file of square levels, smallest first as is usual.
pub fn ktx2(texel: &Texel, side: u32, levels: &[Level], is_zstd: bool) -> Vec<u8> {
    let index_end = Header::LENGTH + LevelIndex::LENGTH * levels.len();
    let header = Header {
        format: Some(texel.vulkan),
        type_size: 4,
        pixel_width: side,
        pixel_height: side,
        pixel_depth: 0,
        layer_count: 0,
        face_count: levels[0].len() as u32,
        level_count: levels.len() as u32,
        supercompression_scheme: is_zstd.then_some(SupercompressionScheme::Zstandard),
        index: Index {
            dfd_byte_offset: index_end as u32,
            dfd_byte_length: 4,
            kvd_byte_offset: 0,
            kvd_byte_length: 0,
            sgd_byte_offset: 0,
            sgd_byte_length: 0,
        },
    };
    let mut body = 4u32.to_le_bytes().to_vec();
    let mut index = vec![Vec::new(); levels.len()];
    for (level, faces) in levels.iter().enumerate().rev() {
        let plain = faces.concat();
        let stored = if is_zstd {
            compress_to_vec(&plain[..], CompressionLevel::Fastest)
        } else {
            plain.clone()
        };
        let entry = LevelIndex {
            byte_offset: (index_end + body.len()) as u64,
            byte_length: stored.len() as u64,
            uncompressed_byte_length: plain.len() as u64,
        };
        index[level] = entry.as_bytes().to_vec();
        body.extend(stored);
    }
    [&header.as_bytes()[..], &index.concat(), &body].concat()
}

/// A KTX 1 file in the form of cmgen.
pub fn ktx1(texel: &Texel, side: u32, levels: &[Level]) -> Vec<u8> {
    let faces = levels[0].len() as u32;
    let keys = *b"\x06\0\0\0sh\x001\n\0\0\0";
    let words = [
        0x0403_0201,
        0,
        1,
        0x1907,
        texel.gl,
        texel.gl,
        side,
        side,
        0,
        0,
        faces,
        levels.len() as u32,
        12,
    ];
    let mut bytes = b"\xabKTX 11\xbb\r\n\x1a\n".to_vec();
    bytes.extend(words.iter().flat_map(|word: &u32| word.to_le_bytes()));
    bytes.extend(&keys[..12]);
    // Rows are padded to 4 bytes, also in the size of a face: GL_UNPACK_ALIGNMENT is 4.
    for (k, level) in levels.iter().enumerate() {
        let row = (side >> k).max(1) as usize * texel.bytes;
        let padded = |face: &Vec<u8>| {
            face.chunks(row)
                .flat_map(|row| [row, &vec![0; row.len() % 4]].concat())
                .collect::<Vec<_>>()
        };
        bytes.extend((padded(&level[0]).len() as u32).to_le_bytes());
        bytes.extend(level.iter().flat_map(padded));
    }
    bytes
}

fn dxgi(texel: &Texel) -> ddsfile::DxgiFormat {
    use ddsfile::DxgiFormat as Dxgi;
    match texel.name {
        "rgba16f" => Dxgi::R16G16B16A16_Float,
        "rg16f" => Dxgi::R16G16_Float,
        "rgba32f" => Dxgi::R32G32B32A32_Float,
        "rgb32f" => Dxgi::R32G32B32_Float,
        "rg32f" => Dxgi::R32G32_Float,
        "rgb9e5" => Dxgi::R9G9B9E5_SharedExp,
        "r11g11b10f" => Dxgi::R11G11B10_Float,
        name => panic!("{name} has no code"),
    }
}

/// A DDS file with the later header: face by face, each with its levels.
pub fn dds(texel: &Texel, side: u32, levels: &[Level]) -> Vec<u8> {
    let is_cube = levels[0].len() == 6;
    let mut file = ddsfile::Dds::new_dxgi(ddsfile::NewDxgiParams {
        height: side,
        width: side,
        depth: None,
        format: dxgi(texel),
        mipmap_levels: Some(levels.len() as u32),
        array_layers: is_cube.then_some(6),
        caps2: is_cube.then_some(ddsfile::Caps2::CUBEMAP | ddsfile::Caps2::CUBEMAP_ALLFACES),
        is_cubemap: is_cube,
        resource_dimension: ddsfile::D3D10ResourceDimension::Texture2D,
        alpha_mode: ddsfile::AlphaMode::Opaque,
    })
    .unwrap();
    file.data = (0..levels[0].len())
        .flat_map(|face| levels.iter().flat_map(move |level| level[face].clone()))
        .collect();
    let mut bytes = Vec::new();
    file.write(&mut bytes).unwrap();
    bytes
}
