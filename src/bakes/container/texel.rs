//! How a texel lies in bytes, by the code that each container has for it.

use crate::pixels::{Fault, Pixels, RgbImage, reserved};
use ddsfile::DxgiFormat;
use half::f16;
use ktx2::Format;

/// A pixel format. All are little-endian and linear.
#[derive(Debug)]
pub struct Texel {
    pub name: &'static str,
    /// Bytes of a texel.
    pub bytes: usize,
    /// Its code in KTX 2.
    pub vulkan: Format,
    /// `glInternalFormat` in KTX 1.
    pub gl: u32,
    /// Its code in DDS; three channels have none there.
    pub dxgi: Option<DxgiFormat>,
    /// Red, green and blue of its bytes; 0 where it has no such channel.
    decode: fn(&[u8]) -> [f32; 3],
}

/// Every pixel format of the containers.
pub static TEXELS: &[Texel] = &[
    Texel {
        name: "rgba16f",
        bytes: 8,
        vulkan: Format::R16G16B16A16_SFLOAT,
        gl: 0x881a,
        dxgi: Some(DxgiFormat::R16G16B16A16_Float),
        decode: halves,
    },
    Texel { name: "rgb16f", bytes: 6, vulkan: Format::R16G16B16_SFLOAT, gl: 0x881b, dxgi: None, decode: halves },
    Texel {
        name: "rg16f",
        bytes: 4,
        vulkan: Format::R16G16_SFLOAT,
        gl: 0x822f,
        dxgi: Some(DxgiFormat::R16G16_Float),
        decode: halves,
    },
    Texel {
        name: "rgba32f",
        bytes: 16,
        vulkan: Format::R32G32B32A32_SFLOAT,
        gl: 0x8814,
        dxgi: Some(DxgiFormat::R32G32B32A32_Float),
        decode: floats,
    },
    Texel {
        name: "rgb32f",
        bytes: 12,
        vulkan: Format::R32G32B32_SFLOAT,
        gl: 0x8815,
        dxgi: Some(DxgiFormat::R32G32B32_Float),
        decode: floats,
    },
    Texel {
        name: "rg32f",
        bytes: 8,
        vulkan: Format::R32G32_SFLOAT,
        gl: 0x8230,
        dxgi: Some(DxgiFormat::R32G32_Float),
        decode: floats,
    },
    Texel {
        name: "rgb9e5",
        bytes: 4,
        vulkan: Format::E5B9G9R9_UFLOAT_PACK32,
        gl: 0x8c3d,
        dxgi: Some(DxgiFormat::R9G9B9E5_SharedExp),
        decode: shared_exponent,
    },
    Texel {
        name: "r11g11b10f",
        bytes: 4,
        vulkan: Format::B10G11R11_UFLOAT_PACK32,
        gl: 0x8c3a,
        dxgi: Some(DxgiFormat::R11G11B10_Float),
        decode: eleven_eleven_ten,
    },
];

impl Texel {
    /// The image of `width` x `height` texels at the front of `bytes`, which hold it.
    pub(super) fn image(&self, width: u32, height: u32, bytes: &[u8]) -> Result<RgbImage, Fault> {
        let count = width as usize * height as usize;
        let mut data = reserved(count)?;
        data.extend(bytes[..count * self.bytes].chunks_exact(self.bytes).map(self.decode));
        Ok(Pixels::new(width, height, data))
    }
}

/// What the formats of this list are called in messages.
pub fn names() -> String {
    TEXELS.iter().map(|texel| texel.name).collect::<Vec<_>>().join(", ")
}

fn halves(bytes: &[u8]) -> [f32; 3] {
    let words = bytes.as_chunks::<2>().0;
    std::array::from_fn(|i| words.get(i).map_or(0.0, |word| f16::from_le_bytes(*word).to_f32()))
}

fn floats(bytes: &[u8]) -> [f32; 3] {
    let words = bytes.as_chunks::<4>().0;
    std::array::from_fn(|i| words.get(i).map_or(0.0, |word| f32::from_le_bytes(*word)))
}

fn word(bytes: &[u8]) -> u32 {
    u32::from_le_bytes([bytes[0], bytes[1], bytes[2], bytes[3]])
}

/// Nine bits of mantissa each, without a leading 1, and five of exponent: `m 2^(e - 15 - 9)` [Vulkan13, "Shared Exponent to RGB"].
fn shared_exponent(bytes: &[u8]) -> [f32; 3] {
    let word = word(bytes);
    let scale = f32::powi(2.0, (word >> 27) as i32 - 24);
    [0, 9, 18].map(|shift| ((word >> shift) & 0x1ff) as f32 * scale)
}

/// Halves without a sign, cut to 6 and 5 bits of mantissa [Vulkan13, "Unsigned 11-Bit Floating-Point Numbers"].
fn eleven_eleven_ten(bytes: &[u8]) -> [f32; 3] {
    let word = word(bytes);
    let half = |bits: u32| f16::from_bits(bits as u16).to_f32();
    [half((word & 0x7ff) << 4), half(((word >> 11) & 0x7ff) << 4), half((word >> 22) << 5)]
}
