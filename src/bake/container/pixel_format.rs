//! How a container stores texels: one by one ([`Texel`]), or in blocks of BC6H.

use super::byte_color::ByteColor;
use super::interpretation::Interpretation;
use super::texel::{SRGB8, Texel};
use crate::base::pixels::{Fault, Pixels, RgbImage, reserved};
use ktx2::Format;

/// Texels along a side of a block, and its bytes.
const BLOCK: usize = 4;
const BLOCK_BYTES: usize = 16;

/// A format that is read.
#[derive(Clone, Copy, Debug)]
pub enum PixelFormat {
    Plain(&'static Texel),
    /// Blocks of halves, signed or not [DirectX, "BC6H Format"].
    Bc6h {
        is_signed: bool,
    },
}

/// The codes of BC6H in each container.
struct BlockCodes {
    vulkan: Format,
    gl: u32,
    dxgi: u32,
    is_signed: bool,
}

const BC6H: [BlockCodes; 2] = [
    BlockCodes {
        vulkan: Format::BC6H_UFLOAT_BLOCK,
        gl: 0x8e8f,
        dxgi: 95,
        is_signed: false,
    },
    BlockCodes {
        vulkan: Format::BC6H_SFLOAT_BLOCK,
        gl: 0x8e8e,
        dxgi: 96,
        is_signed: true,
    },
];

impl PixelFormat {
    /// Finds the format of KTX 2.
    pub fn of_vulkan(code: Option<Format>, bytes: Option<ByteColor>) -> Result<Self, Fault> {
        if code == Some(SRGB8.vulkan)
            && let Some(bytes) = bytes
        {
            return Ok(Self::Plain(bytes.texel()));
        }
        let name = || match code {
            Some(code) => format!("its pixel format is {code:?}"),
            None => "its pixel format is undefined".to_owned(),
        };
        Self::blocks(|codes| Some(codes.vulkan) == code).map_or_else(
            || Texel::with_code(|texel| Some(texel.vulkan) == code, name).map(Self::Plain),
            Ok,
        )
    }

    /// Finds the format of KTX 1 by its `glInternalFormat`.
    pub fn of_gl(code: u32, bytes: Option<ByteColor>) -> Result<Self, Fault> {
        if code == SRGB8.gl
            && let Some(bytes) = bytes
        {
            return Ok(Self::Plain(bytes.texel()));
        }
        let name = || format!("its glInternalFormat is {code:#06x}");
        Self::blocks(|codes| codes.gl == code).map_or_else(
            || Texel::with_code(|texel| texel.gl == code, name).map(Self::Plain),
            Ok,
        )
    }

    /// Finds the format of a DXGI code; `name` describes what the file says.
    pub fn of_dxgi(code: Option<u32>, name: impl Fn() -> String) -> Result<Self, Fault> {
        let plain = |texel: &Texel| texel.dxgi.is_some() && texel.dxgi == code;
        Self::blocks(|codes| Some(codes.dxgi) == code).map_or_else(
            || {
                Texel::with_code(plain, || format!("its pixel format is {}", name()))
                    .map(Self::Plain)
            },
            Ok,
        )
    }

    fn blocks(has_code: impl Fn(&BlockCodes) -> bool) -> Option<Self> {
        let codes = BC6H.iter().find(|codes| has_code(codes))?;
        Some(Self::Bc6h {
            is_signed: codes.is_signed,
        })
    }

    pub fn name(self) -> &'static str {
        match self {
            Self::Plain(texel) => texel.name,
            Self::Bc6h { .. } => "bc6h",
        }
    }

    /// Returns the bytes of a row of texels or blocks.
    pub fn row_bytes(self, width: u32) -> usize {
        match self {
            Self::Plain(texel) => width as usize * texel.bytes,
            Self::Bc6h { .. } => (width as usize).div_ceil(BLOCK) * BLOCK_BYTES,
        }
    }

    /// Returns the number of rows of texels or blocks.
    pub fn row_count(self, height: u32) -> usize {
        match self {
            Self::Plain(_) => height as usize,
            Self::Bc6h { .. } => (height as usize).div_ceil(BLOCK),
        }
    }

    pub fn image_bytes(self, width: u32, height: u32) -> usize {
        self.row_bytes(width) * self.row_count(height)
    }

    /// Decodes `width` x `height` texels from the front of `bytes`.
    pub fn image(
        self,
        width: u32,
        height: u32,
        bytes: &[u8],
        interpretation: &Interpretation,
    ) -> Result<RgbImage, Fault> {
        let bytes = &bytes[..self.image_bytes(width, height)];
        let image = match self {
            Self::Plain(texel) => texel.image(width, height, bytes, interpretation)?,
            Self::Bc6h { is_signed } => {
                let mut data = reserved(width as usize * height as usize)?;
                for row in bytes.chunks_exact(self.row_bytes(width)) {
                    let rows = block_rows(row, is_signed);
                    let count = BLOCK.min(height as usize - data.len() / width as usize);
                    data.extend(rows.iter().take(count).flat_map(|texels| {
                        let texels = texels.iter().take(width as usize);
                        texels.map(|[r, g, b]| interpretation.color([*r, *g, *b, 1.0]))
                    }));
                }
                Pixels::new(width, height, data)
            }
        };
        Ok(interpretation.turned(image))
    }
}

/// Decodes the four rows of texels in a row of blocks.
fn block_rows(blocks: &[u8], is_signed: bool) -> [Vec<[f32; 3]>; BLOCK] {
    let mut rows = [const { Vec::new() }; BLOCK];
    for block in blocks.chunks_exact(BLOCK_BYTES) {
        let mut values = [0.0; 3 * BLOCK * BLOCK];
        bcdec_rs::bc6h_float(block, &mut values, 3 * BLOCK, is_signed);
        for (row, texels) in rows.iter_mut().zip(values.as_chunks::<3>().0.chunks(BLOCK)) {
            row.extend(texels);
        }
    }
    rows
}
