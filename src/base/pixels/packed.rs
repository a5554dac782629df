//! Linear images as text: half floats, planes, differences, deflate, base64.
//!
//! Half floats have 11 significant bits (within 4.9e-4), enough for error maps, whose colours start
//! at 1e-3; 8-bit RGBE has not. Each channel is a plane of high bytes, then low bytes, each as the
//! difference to the byte before modulo
//! 256. On a noisy 1024x512 image this saves 28 % over deflating interleaved halves.

use super::{GrayImage, HALF_MAX, Pixels};
use base64::Engine;
use base64::prelude::BASE64_STANDARD;
use flate2::Compression;
use flate2::write::DeflateEncoder;
use half::f16;
use std::io::Write;

#[derive(Clone, Debug)]
pub struct Encoded {
    pub base64: String,
    /// Number of channels above [`HALF_MAX`].
    pub clamped_count: usize,
}

pub fn texels<const N: usize>(image: &Pixels<[f32; N]>) -> Encoded {
    let clamped_count = image
        .data
        .iter()
        .flatten()
        .filter(|value| **value > HALF_MAX)
        .count();
    let halves: Vec<[u16; N]> = image
        .data
        .iter()
        .map(|texel| texel.map(|value| f16::from_f32(value.min(HALF_MAX)).to_bits()))
        .collect();
    Encoded {
        base64: words(&halves),
        clamped_count,
    }
}

/// Encodes texels of 16-bit words.
pub fn words<const N: usize>(texels: &[[u16; N]]) -> String {
    let mut bytes = Vec::with_capacity(texels.len() * N * 2);
    for channel in 0..N {
        push_differences(
            &mut bytes,
            texels.iter().map(|texel| (texel[channel] >> 8) as u8),
        );
        push_differences(&mut bytes, texels.iter().map(|texel| texel[channel] as u8));
    }
    deflated(&bytes)
}

/// Encodes a mask: one byte per texel, 0 or 1.
pub fn mask(mask: &GrayImage) -> String {
    let mut bytes = Vec::with_capacity(mask.data.len());
    push_differences(
        &mut bytes,
        mask.data.iter().map(|value| u8::from(*value != 0.0)),
    );
    deflated(&bytes)
}

fn push_differences(bytes: &mut Vec<u8>, plane: impl Iterator<Item = u8>) {
    let mut last = 0u8;
    bytes.extend(plane.map(|byte| byte.wrapping_sub(std::mem::replace(&mut last, byte))));
}

fn deflated(bytes: &[u8]) -> String {
    let mut encoder = DeflateEncoder::new(Vec::new(), Compression::new(6));
    let written = encoder.write_all(bytes).and_then(|()| encoder.finish());
    BASE64_STANDARD.encode(written.expect("writing to memory cannot fail"))
}
