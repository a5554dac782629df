//! DDS: face after face, each with all of its levels.

use super::texel::{self, TEXELS};
use super::{Claim, Encoding, FACE_COUNT, Texture, truncated};
use crate::pixels::Fault;
use ddsfile::{AlphaMode, Caps2, D3D10ResourceDimension, D3DFormat, Dds, DxgiFormat, MiscFlag, NewDxgiParams};

pub fn read(bytes: &[u8]) -> Result<Texture, Fault> {
    let dds = Dds::read(bytes).map_err(|error| Fault::new(format!("is no whole DDS file ({error})"), "a DDS file"))?;
    let (header, more) = (&dds.header, &dds.header10);
    let is_cube = header.caps2.contains(Caps2::CUBEMAP)
        || more.as_ref().is_some_and(|more| more.misc_flag.contains(MiscFlag::TEXTURECUBE));
    if is_cube && more.is_none() && !header.caps2.contains(Caps2::CUBEMAP_ALLFACES) {
        return Err(Fault::new("it is a cube without all of its faces", "all six faces"));
    }
    let claim = Claim {
        width: header.width,
        height: header.height,
        depth: header.depth.unwrap_or(1),
        layers: more.as_ref().map_or(1, |more| more.array_size),
        faces: if is_cube { FACE_COUNT as u32 } else { 1 },
        levels: header.mip_map_count.unwrap_or(1).max(1),
    };
    let faces = claim.check()?;
    let format = dds.get_dxgi_format().or_else(|| dds.get_d3d_format().and_then(dxgi));
    let texel = TEXELS.iter().find(|texel| texel.dxgi.is_some() && texel.dxgi == format).ok_or_else(|| {
        let found = format.map_or("not known".to_owned(), |format| format!("{format:?}"));
        Fault::new(format!("its pixel format is {found}"), format!("one of {}", texel::names()))
    })?;
    let mut read = vec![Vec::new(); claim.levels as usize];
    let mut rest = dds.data.as_slice();
    for _ in 0..faces {
        for level in 0..claim.levels {
            let needed = claim.face_bytes(level, texel);
            let (face, after) = rest.split_at_checked(needed).ok_or_else(|| truncated(level, needed, rest.len()))?;
            let [width, height] = claim.size(level);
            read[level as usize].push(texel.image(width, height, face)?);
            rest = after;
        }
    }
    Ok(Texture { levels: read, texel: texel.name })
}

/// The file of a texture, whose texel has a code here. It has no room for keys.
pub fn write(encoding: &Encoding) -> Vec<u8> {
    let Encoding { texel, levels, .. } = encoding;
    let (first, faces) = (&levels[0][0], levels[0].len());
    let is_cube = faces == FACE_COUNT;
    let mut dds = Dds::new_dxgi(NewDxgiParams {
        height: first.height,
        width: first.width,
        depth: None,
        format: texel.dxgi.expect("a format with a code"),
        mipmap_levels: Some(levels.len() as u32),
        // The crate makes room for so many images; a cube of six faces is one in the header.
        array_layers: is_cube.then_some(FACE_COUNT as u32),
        caps2: is_cube.then_some(Caps2::CUBEMAP | Caps2::CUBEMAP_ALLFACES),
        is_cubemap: is_cube,
        resource_dimension: D3D10ResourceDimension::Texture2D,
        alpha_mode: AlphaMode::Opaque,
    })
    .expect("a texture of known size");
    dds.data = (0..faces).flat_map(|face| levels.iter().flat_map(move |level| texel.bytes_of(&level[face]))).collect();
    let mut file = Vec::new();
    dds.write(&mut file).expect("memory takes all");
    file
}

/// The formats that have a code of their own in files without the later header.
fn dxgi(format: D3DFormat) -> Option<DxgiFormat> {
    match format {
        D3DFormat::A16B16G16R16F => Some(DxgiFormat::R16G16B16A16_Float),
        D3DFormat::G16R16F => Some(DxgiFormat::R16G16_Float),
        D3DFormat::A32B32G32R32F => Some(DxgiFormat::R32G32B32A32_Float),
        D3DFormat::G32R32F => Some(DxgiFormat::R32G32_Float),
        _ => None,
    }
}
