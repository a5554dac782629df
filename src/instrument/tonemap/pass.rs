//! The device pass: radiance to packed 8-bit pixels.

use super::ToneCurve;
use crate::base::glsl::layout::{SharedStruct, TonemapParams};
use crate::base::pixels::{Pixels, Rgb8Image};
use crate::instrument::gpu::{Bind, Buffer, Gpu, GpuError, Report, image_groups};

/// Makes a buffer for the packed pixels of an image.
pub fn packed(gpu: &Gpu, size: [u32; 2]) -> Result<Buffer, GpuError> {
    gpu.buffer(
        "tone-mapped pixels",
        4 * u64::from(size[0]) * u64::from(size[1]),
    )
}

/// Applies `curve` to `radiance` (a vec4 per pixel).
pub fn run(
    gpu: &Gpu,
    curve: ToneCurve,
    radiance: &Buffer,
    packed: &Buffer,
    [width, height]: [u32; 2],
) -> Result<Report, GpuError> {
    let push = TonemapParams {
        width,
        height,
        exposure: curve.exposure,
        contrast: curve.contrast,
    }
    .to_bytes();
    let binds = [Bind::Read(radiance), Bind::Write(packed)];
    gpu.submit_pass("tonemap", |r| {
        r.dispatch(
            "tonemap/tonemap.comp",
            &[],
            &binds,
            &push,
            image_groups(width, height),
        )
    })
}

pub fn read(gpu: &Gpu, packed: &Buffer, size: [u32; 2]) -> Result<Rgb8Image, GpuError> {
    let words: Vec<u32> = gpu.read_buffer(packed)?;
    let rgb = words.iter().map(|word| {
        let [r, g, b, _] = word.to_le_bytes();
        [r, g, b]
    });
    Ok(Pixels::new(size[0], size[1], rgb.collect()))
}
