//! How a texel lies in bytes, by the code that each container has for it.

use crate::pixels::{Fault, Pixels, RgbImage, half, reserved};
use crate::spelling::listed;
use ktx2::Format;

/// A pixel format. All are little-endian and linear.
#[derive(Debug)]
pub struct Texel {
    pub name: &'static str,
    /// Bytes of a texel.
    pub bytes: usize,
    pub channels: usize,
    /// Its code in KTX 2.
    pub vulkan: Format,
    /// `glInternalFormat` in KTX 1.
    pub gl: u32,
    /// `glType` and `glTypeSize` there.
    pub gl_type: (u32, u32),
    /// Its `DXGI_FORMAT` in DDS; three halves have none there.
    pub dxgi: Option<u32>,
    /// Its largest number.
    pub largest: f32,
    /// Red, green and blue of its bytes; 0 where it has no such channel.
    decode: fn(&[u8]) -> [f32; 3],
    /// The bytes of red, green, blue and 1 within [0, largest]; as many as it has room for.
    encode: fn([f32; 4], &mut [u8]),
}

/// Every pixel format of the containers.
pub static TEXELS: &[Texel] = &[
    Texel {
        name: "rgba16f",
        bytes: 8,
        channels: 4,
        vulkan: Format::R16G16B16A16_SFLOAT,
        gl: 0x881a,
        gl_type: (0x140b, 2),
        dxgi: Some(10),
        largest: HALF_MAX,
        decode: halves,
        encode: to_halves,
    },
    Texel {
        name: "rgb16f",
        bytes: 6,
        channels: 3,
        vulkan: Format::R16G16B16_SFLOAT,
        gl: 0x881b,
        gl_type: (0x140b, 2),
        dxgi: None,
        largest: HALF_MAX,
        decode: halves,
        encode: to_halves,
    },
    Texel {
        name: "rg16f",
        bytes: 4,
        channels: 2,
        vulkan: Format::R16G16_SFLOAT,
        gl: 0x822f,
        gl_type: (0x140b, 2),
        dxgi: Some(34),
        largest: HALF_MAX,
        decode: halves,
        encode: to_halves,
    },
    Texel {
        name: "rgba32f",
        bytes: 16,
        channels: 4,
        vulkan: Format::R32G32B32A32_SFLOAT,
        gl: 0x8814,
        gl_type: (0x1406, 4),
        dxgi: Some(2),
        largest: f32::MAX,
        decode: floats,
        encode: to_floats,
    },
    Texel {
        name: "rgb32f",
        bytes: 12,
        channels: 3,
        vulkan: Format::R32G32B32_SFLOAT,
        gl: 0x8815,
        gl_type: (0x1406, 4),
        dxgi: Some(6),
        largest: f32::MAX,
        decode: floats,
        encode: to_floats,
    },
    Texel {
        name: "rg32f",
        bytes: 8,
        channels: 2,
        vulkan: Format::R32G32_SFLOAT,
        gl: 0x8230,
        gl_type: (0x1406, 4),
        dxgi: Some(16),
        largest: f32::MAX,
        decode: floats,
        encode: to_floats,
    },
    Texel {
        name: "rgb9e5",
        bytes: 4,
        channels: 3,
        vulkan: Format::E5B9G9R9_UFLOAT_PACK32,
        gl: 0x8c3d,
        gl_type: (0x8c3e, 4),
        dxgi: Some(67),
        largest: SHARED_MAX,
        decode: shared_exponent,
        encode: to_shared_exponent,
    },
    Texel {
        name: "r11g11b10f",
        bytes: 4,
        channels: 3,
        vulkan: Format::B10G11R11_UFLOAT_PACK32,
        gl: 0x8c3a,
        gl_type: CMGEN,
        dxgi: Some(26),
        largest: PACKED_MAX,
        decode: eleven_eleven_ten,
        encode: to_eleven_eleven_ten,
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

    /// The bytes of an image. Numbers outside [0, largest] are cut.
    pub(super) fn bytes_of(&self, image: &RgbImage) -> Vec<u8> {
        let mut bytes = vec![0; image.data.len() * self.bytes];
        for (texel, place) in image.data.iter().zip(bytes.chunks_exact_mut(self.bytes)) {
            let [r, g, b] = texel.map(|value| value.clamp(0.0, self.largest));
            (self.encode)([r, g, b, 1.0], place);
        }
        bytes
    }

    /// `glFormat` in KTX 1.
    pub(super) fn gl_format(&self) -> u32 {
        match self.channels {
            4 => 0x1908,
            3 => 0x1907,
            _ => 0x8227,
        }
    }
}

/// What Filament's reader knows 10-11-11 floats by, and what cmgen writes: the internal format in the place of the type.
const CMGEN: (u32, u32) = (0x8c3a, 1);

listed!(Texel, "texel format", TEXELS);

fn halves(bytes: &[u8]) -> [f32; 3] {
    let words = bytes.as_chunks::<2>().0;
    std::array::from_fn(|i| words.get(i).map_or(0.0, |word| half::from_bits(u16::from_le_bytes(*word))))
}

fn floats(bytes: &[u8]) -> [f32; 3] {
    let words = bytes.as_chunks::<4>().0;
    std::array::from_fn(|i| words.get(i).map_or(0.0, |word| f32::from_le_bytes(*word)))
}

fn to_halves(values: [f32; 4], bytes: &mut [u8]) {
    for (word, value) in bytes.as_chunks_mut::<2>().0.iter_mut().zip(values) {
        *word = half::to_bits(value).to_le_bytes();
    }
}

fn to_floats(values: [f32; 4], bytes: &mut [u8]) {
    for (word, value) in bytes.as_chunks_mut::<4>().0.iter_mut().zip(values) {
        *word = value.to_le_bytes();
    }
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

/// The least exponent by which the largest channel has nine bits [Vulkan13, "RGB to Shared Exponent"].
fn to_shared_exponent([r, g, b, _]: [f32; 4], bytes: &mut [u8]) {
    let largest = r.max(g).max(b);
    // The place of the leading bit, from the bits of the float: exact where a logarithm rounds.
    let leading = ((largest.to_bits() >> 23) as i32 - 127).max(-16);
    let mantissa = |value: f32, exponent: i32| (value / f32::powi(2.0, exponent - 24)).round_ties_even() as u32;
    let exponent = leading + 16;
    let exponent = exponent + i32::from(mantissa(largest, exponent) > 0x1ff);
    let word = [r, g, b]
        .iter()
        .zip([0, 9, 18])
        .fold((exponent as u32) << 27, |word, (value, shift)| word | mantissa(*value, exponent) << shift);
    bytes.copy_from_slice(&word.to_le_bytes());
}

fn to_eleven_eleven_ten([r, g, b, _]: [f32; 4], bytes: &mut [u8]) {
    // Rounded once, to a number that a half holds with `drop` zeros at its end.
    let bits = |value: f32, drop: i32| {
        let leading = ((value.to_bits() >> 23) as i32 - 127).max(-14);
        let step = f32::powi(2.0, leading - 10 + drop);
        u32::from(half::to_bits((value / step).round_ties_even() * step)) >> drop
    };
    bytes.copy_from_slice(&(bits(r, 4) | bits(g, 4) << 11 | bits(b, 5) << 22).to_le_bytes());
}

/// Largest finite half, shared-exponent number, and float of 10 bits, which is that of 11 but for its last bit.
const HALF_MAX: f32 = 65504.0;
const SHARED_MAX: f32 = 65408.0;
const PACKED_MAX: f32 = 64512.0;

/// Halves without a sign, cut to 6 and 5 bits of mantissa [Vulkan13, "Unsigned 11-Bit Floating-Point Numbers"].
fn eleven_eleven_ten(bytes: &[u8]) -> [f32; 3] {
    let word = word(bytes);
    let half = |bits: u32| half::from_bits(bits as u16);
    [half((word & 0x7ff) << 4), half(((word >> 11) & 0x7ff) << 4), half((word >> 22) << 5)]
}
