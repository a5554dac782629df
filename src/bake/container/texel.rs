//! Pixel formats by their codes in each container.

use super::interpretation::Interpretation;
use crate::base::color::{srgb_decode, srgb_encode};
use crate::base::names::{Listed, listed};
use crate::base::pixels::{Fault, HALF_MAX, Pixels, RgbImage, reserved};
use half::f16;
use ktx2::Format;

/// A pixel format: little-endian and linear.
#[derive(Debug)]
pub struct Texel {
    pub name: &'static str,
    pub bytes: usize,
    pub channels: usize,
    /// Code in KTX 2.
    pub vulkan: Format,
    /// `glInternalFormat` in KTX 1.
    pub gl: u32,
    /// Component type in KTX 1.
    pub gl_type: GlType,
    /// `DXGI_FORMAT` in DDS; three halves have none.
    pub dxgi: Option<u32>,
    pub largest: f32,
    /// Decodes red, green, blue and alpha; 0 for missing colours, 1 for missing alpha.
    decode: fn(&[u8]) -> [f32; 4],
    /// Encodes red, green, blue and 1 within [0, largest], as many as fit.
    encode: fn([f32; 4], &mut [u8]),
}

/// `glType` and `glTypeSize` of KTX 1.
#[derive(Clone, Copy, Debug)]
pub struct GlType {
    pub code: u32,
    pub size: u32,
}

/// Every pixel format.
pub static TEXELS: &[Texel] = &[
    half("rgba16f", 4, Format::R16G16B16A16_SFLOAT, 0x881a, Some(10)),
    half("rgb16f", 3, Format::R16G16B16_SFLOAT, 0x881b, None),
    half("rg16f", 2, Format::R16G16_SFLOAT, 0x822f, Some(34)),
    float("rgba32f", 4, Format::R32G32B32A32_SFLOAT, 0x8814, 2),
    float("rgb32f", 3, Format::R32G32B32_SFLOAT, 0x8815, 6),
    float("rg32f", 2, Format::R32G32_SFLOAT, 0x8230, 16),
    Texel {
        name: "rgb9e5",
        bytes: 4,
        channels: 3,
        vulkan: Format::E5B9G9R9_UFLOAT_PACK32,
        gl: 0x8c3d,
        gl_type: GlType {
            code: 0x8c3e,
            size: 4,
        },
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

/// sRGB codes in bytes that a container calls linear, of a program that decodes them anyway
/// ([`super::ByteColor`]): light above 1 is cut.
pub static SRGB8: Texel = Texel {
    channels: 4,
    ..color_in_bytes("srgb8", 1.0, srgb, to_srgb)
};

/// Babylon.js' RGBD: `(rgb^2.2)/a`. No container of [`TEXELS`] holds it.
pub static RGBD: Texel = color_in_bytes("rgbd", 255.0, rgbd, to_rgbd);

/// PlayCanvas' RGBP: `(rgb (8 - 7 a))²`. No container of [`TEXELS`] holds it.
pub static RGBP: Texel = color_in_bytes("rgbp", 64.0, rgbp, to_rgbp);

/// A colour in the four bytes of RGBA8.
const fn color_in_bytes(
    name: &'static str,
    largest: f32,
    decode: fn(&[u8]) -> [f32; 4],
    encode: fn([f32; 4], &mut [u8]),
) -> Texel {
    Texel {
        name,
        bytes: 4,
        channels: 3,
        vulkan: Format::R8G8B8A8_UNORM,
        gl: 0x8058,
        gl_type: GlType {
            code: 0x1401,
            size: 1,
        },
        dxgi: Some(28),
        largest,
        decode,
        encode,
    }
}

const fn half(
    name: &'static str,
    channels: usize,
    vulkan: Format,
    gl: u32,
    dxgi: Option<u32>,
) -> Texel {
    Texel {
        name,
        bytes: 2 * channels,
        channels,
        vulkan,
        gl,
        gl_type: GlType {
            code: 0x140b,
            size: 2,
        },
        dxgi,
        largest: HALF_MAX,
        decode: halves,
        encode: to_halves,
    }
}

const fn float(name: &'static str, channels: usize, vulkan: Format, gl: u32, dxgi: u32) -> Texel {
    Texel {
        name,
        bytes: 4 * channels,
        channels,
        vulkan,
        gl,
        gl_type: GlType {
            code: 0x1406,
            size: 4,
        },
        dxgi: Some(dxgi),
        largest: f32::MAX,
        decode: floats,
        encode: to_floats,
    }
}

impl Texel {
    /// Finds a format by its code in a container; `found` describes an unknown code.
    pub(super) fn with_code(
        has_code: impl Fn(&Self) -> bool,
        found: impl FnOnce() -> String,
    ) -> Result<&'static Self, Fault> {
        let unknown = || Fault::new(found(), format!("one of {}", Self::names().join(", ")));
        TEXELS
            .iter()
            .find(|texel| has_code(texel))
            .ok_or_else(unknown)
    }

    /// Decodes `width` x `height` texels from the front of `bytes`, rows as stored.
    pub(in crate::bake) fn image(
        &self,
        width: u32,
        height: u32,
        bytes: &[u8],
        interpretation: &Interpretation,
    ) -> Result<RgbImage, Fault> {
        let count = width as usize * height as usize;
        let mut data = reserved(count)?;
        data.extend(
            bytes[..count * self.bytes]
                .chunks_exact(self.bytes)
                .map(|texel| interpretation.color((self.decode)(texel))),
        );
        Ok(Pixels::new(width, height, data))
    }

    /// Encodes an image; clips to [0, largest].
    pub(in crate::bake) fn bytes_of(&self, image: &RgbImage) -> Vec<u8> {
        let mut bytes = vec![0; image.data.len() * self.bytes];
        for (texel, encoded) in image.data.iter().zip(bytes.chunks_exact_mut(self.bytes)) {
            let [r, g, b] = texel.map(|value| value.clamp(0.0, self.largest));
            (self.encode)([r, g, b, 1.0], encoded);
        }
        bytes
    }

    pub(super) fn gl_format(&self) -> u32 {
        match self.channels {
            4 => 0x1908,
            3 => 0x1907,
            _ => 0x8227,
        }
    }
}

/// Filament's reader and cmgen identify 10-11-11 floats by the internal format, stored as the type.
const CMGEN: GlType = GlType {
    code: 0x8c3a,
    size: 1,
};

listed!(Texel, "texel format", TEXELS);

/// Values of channels that a texel lacks.
const MISSING: [f32; 4] = [0.0, 0.0, 0.0, 1.0];

fn halves(bytes: &[u8]) -> [f32; 4] {
    let words = bytes.as_chunks::<2>().0;
    std::array::from_fn(|i| {
        words
            .get(i)
            .map_or(MISSING[i], |word| f16::from_le_bytes(*word).to_f32())
    })
}

fn floats(bytes: &[u8]) -> [f32; 4] {
    let words = bytes.as_chunks::<4>().0;
    std::array::from_fn(|i| {
        words
            .get(i)
            .map_or(MISSING[i], |word| f32::from_le_bytes(*word))
    })
}

fn to_halves(values: [f32; 4], bytes: &mut [u8]) {
    for (word, value) in bytes.as_chunks_mut::<2>().0.iter_mut().zip(values) {
        *word = f16::from_f32(value).to_le_bytes();
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

/// Decodes 9 bits of mantissa each and a shared exponent: `m 2^(e - 15 - 9)` [Vulkan13, "Shared
/// Exponent to RGB"].
fn shared_exponent(bytes: &[u8]) -> [f32; 4] {
    let word = word(bytes);
    let scale = f32::powi(2.0, (word >> 27) as i32 - 24);
    let [r, g, b] = [0, 9, 18].map(|shift| ((word >> shift) & 0x1ff) as f32 * scale);
    [r, g, b, 1.0]
}

/// Encodes with the smallest exponent that fits the largest channel [Vulkan13, "RGB to Shared
/// Exponent"].
fn to_shared_exponent([r, g, b, _]: [f32; 4], bytes: &mut [u8]) {
    let largest = r.max(g).max(b);
    // Exact, where a logarithm rounds.
    let leading = ((largest.to_bits() >> 23) as i32 - 127).max(-16);
    let mantissa = |value: f32, exponent: i32| {
        (value / f32::powi(2.0, exponent - 24)).round_ties_even() as u32
    };
    let exponent = leading + 16;
    let exponent = exponent + i32::from(mantissa(largest, exponent) > 0x1ff);
    let word = [r, g, b]
        .iter()
        .zip([0, 9, 18])
        .fold((exponent as u32) << 27, |word, (value, shift)| {
            word | mantissa(*value, exponent) << shift
        });
    bytes.copy_from_slice(&word.to_le_bytes());
}

fn to_eleven_eleven_ten([r, g, b, _]: [f32; 4], bytes: &mut [u8]) {
    // Rounds once to a half with `drop` trailing zeros.
    let bits = |value: f32, drop: i32| {
        let leading = ((value.to_bits() >> 23) as i32 - 127).max(-14);
        let step = f32::powi(2.0, leading - 10 + drop);
        u32::from(f16::from_f32((value / step).round_ties_even() * step).to_bits()) >> drop
    };
    bytes.copy_from_slice(&(bits(r, 4) | bits(g, 4) << 11 | bits(b, 5) << 22).to_le_bytes());
}

/// Exponent of a display's gamma in RGBD.
const GAMMA: f32 = 2.2;
/// Largest root in RGBP.
const ROOT_MAX: f32 = 8.0;

fn unorm(bytes: &[u8]) -> [f32; 4] {
    std::array::from_fn(|i| f32::from(bytes[i]) / 255.0)
}

fn to_unorm(value: f32) -> u8 {
    (255.0 * value.clamp(0.0, 1.0)).round() as u8
}

fn srgb(bytes: &[u8]) -> [f32; 4] {
    let [r, g, b, alpha] = unorm(bytes);
    let [r, g, b] = [r, g, b].map(srgb_decode);
    [r, g, b, alpha]
}

fn to_srgb([r, g, b, alpha]: [f32; 4], bytes: &mut [u8]) {
    bytes[..3].copy_from_slice(&[r, g, b].map(|value| to_unorm(srgb_encode(value))));
    bytes[3] = to_unorm(alpha);
}

fn rgbd(bytes: &[u8]) -> [f32; 4] {
    let [r, g, b, divisor] = unorm(bytes);
    let divisor = divisor.max(1.0 / 255.0);
    let [r, g, b] = [r, g, b].map(|signal| signal.powf(GAMMA) / divisor);
    [r, g, b, 1.0]
}

/// The divisor is floored to a byte [Babylon.js 9.35.0, `helperFunctions.fx`, `toRGBD`].
fn to_rgbd([r, g, b, _]: [f32; 4], bytes: &mut [u8]) {
    let largest = r.max(g).max(b).max(f32::MIN_POSITIVE);
    let divisor = (255.0 / largest).floor().clamp(1.0, 255.0) / 255.0;
    let signals = [r, g, b].map(|value| to_unorm((value * divisor).powf(1.0 / GAMMA)));
    bytes[..3].copy_from_slice(&signals);
    bytes[3] = to_unorm(divisor);
}

fn rgbp(bytes: &[u8]) -> [f32; 4] {
    let [r, g, b, scale] = unorm(bytes);
    let factor = ROOT_MAX - (ROOT_MAX - 1.0) * scale;
    let [r, g, b] = [r, g, b].map(|root| (root * factor).powi(2));
    [r, g, b, 1.0]
}

/// The scale is rounded down to a byte, so that the largest root fits.
fn to_rgbp([r, g, b, _]: [f32; 4], bytes: &mut [u8]) {
    let roots = [r, g, b].map(f32::sqrt);
    let largest = roots.into_iter().fold(1.0, f32::max).min(ROOT_MAX);
    let scale = (255.0 * (1.0 - (largest - 1.0) / (ROOT_MAX - 1.0))).floor() / 255.0;
    let factor = ROOT_MAX - (ROOT_MAX - 1.0) * scale;
    bytes[..3].copy_from_slice(&roots.map(|root| to_unorm(root / factor)));
    bytes[3] = to_unorm(scale);
}

/// Largest shared-exponent number, and float of 10 bits.
const SHARED_MAX: f32 = 65408.0;
const PACKED_MAX: f32 = 64512.0;

/// Decodes unsigned halves with 6 and 5 bits of mantissa [Vulkan13, "Unsigned 11-Bit Floating-Point
/// Numbers"].
fn eleven_eleven_ten(bytes: &[u8]) -> [f32; 4] {
    let word = word(bytes);
    let half = |bits: u32| f16::from_bits(bits as u16).to_f32();
    [
        half((word & 0x7ff) << 4),
        half(((word >> 11) & 0x7ff) << 4),
        half((word >> 22) << 5),
        1.0,
    ]
}
