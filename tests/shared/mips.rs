//! The mip chain in f64: the twin of the device pass.

use glam::DVec3;
use splitsum::base::pixels::{Pixels, RgbImage};
use splitsum::instrument::precompute::mips::level_count;
use std::f64::consts::PI;

/// Computes every level, from the image itself down to 1 x 1, each from the level above.
pub fn chain(image: &RgbImage) -> Vec<Pixels<DVec3>> {
    let mut levels = vec![image.map(|radiance| DVec3::from_array(radiance.map(f64::from)))];
    let size = [image.width, image.height];
    for mip in 1..level_count(size) {
        let level = downsample(
            &levels[mip as usize - 1],
            size.map(|side| (side >> mip).max(1)),
        );
        levels.push(level);
    }
    levels
}

/// Resamples the map to `size`, no larger than the source, by means over solid angle.
pub fn downsample(source: &Pixels<DVec3>, size: [u32; 2]) -> Pixels<DVec3> {
    Pixels::from_fn(size[0], size[1], |x, y| {
        let (mut sum, mut total) = (DVec3::ZERO, 0.0);
        for (row, top, bottom) in overlaps(y, size[1], source.height) {
            let band = band(top, bottom, source.height);
            for (column, left, right) in overlaps(x, size[0], source.width) {
                let weight = band * (right - left);
                sum += weight * source.get(column, row);
                total += weight;
            }
        }
        sum / total
    })
}

/// Lists source texels under texel `index` of `count`, with the overlap's ends in source texels.
pub fn overlaps(
    index: u32,
    count: u32,
    source_count: u32,
) -> impl Iterator<Item = (u32, f64, f64)> {
    // Exact in integers: a rounded edge would add a sliver of another texel.
    let edge = |i: u32| u64::from(i) * u64::from(source_count);
    let (low, high) = (edge(index), edge(index + 1));
    let count = u64::from(count);
    (low / count..high.div_ceil(count)).map(move |source| {
        let (start, end) = (low.max(source * count), high.min((source + 1) * count));
        (
            source as u32,
            start as f64 / count as f64,
            end as f64 / count as f64,
        )
    })
}

/// Returns `cos θ_start - cos θ_end` of a band of rows of `height`: its solid angle per radian of
/// azimuth.
fn band(start: f64, end: f64, height: u32) -> f64 {
    let theta = |row: f64| PI * row / f64::from(height);
    // As a product: the difference of cosines loses digits in thin bands.
    2.0 * (0.5 * (theta(start) + theta(end))).sin() * (0.5 * (theta(end) - theta(start))).sin()
}
