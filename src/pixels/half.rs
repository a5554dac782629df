//! Half floats (IEEE 754 binary16) by their bits.

/// Bits of 2^-14, the smallest normal half, as an f32.
const NORMAL_MIN: u32 = 0x3880_0000;
/// Bits of 65520, the smallest f32 that rounds to infinity.
const INFINITE_MIN: u32 = 0x477f_f000;
/// Difference of the exponent biases, shifted to an f32's exponent.
const REBIAS: u32 = (127 - 15) << 23;

/// Rounds to the nearest half, ties to even.
pub fn to_bits(value: f32) -> u16 {
    let bits = value.to_bits();
    let (sign, magnitude) = ((bits >> 16) as u16 & 0x8000, bits & 0x7fff_ffff);
    let half = if value.is_nan() {
        0x7e00
    } else if magnitude >= INFINITE_MIN {
        0x7c00
    } else if magnitude >= NORMAL_MIN {
        let rebased = magnitude - REBIAS;
        (rebased + 0xfff + (rebased >> 13 & 1)) >> 13
    } else {
        // The last bit of 0.5 is 2^-24, as that of a subnormal half, so the sum rounds.
        (f32::from_bits(magnitude) + 0.5).to_bits() - 0.5_f32.to_bits()
    };
    sign | half as u16
}

pub fn from_bits(bits: u16) -> f32 {
    let magnitude = u32::from(bits & 0x7fff);
    let value = match magnitude {
        0..0x400 => magnitude as f32 * 2_f32.powi(-24),
        0x400..0x7c00 => f32::from_bits((magnitude << 13) + REBIAS),
        _ => f32::from_bits(magnitude << 13 | 0x7f80_0000),
    };
    if bits & 0x8000 == 0 { value } else { -value }
}
