//! The mip chain in f64: the twin of the device pass.

use super::{band, level_count, level_size, overlaps};
use crate::pixels::{Pixels, RgbImage};
use glam::DVec3;

/// Computes every level, from the image itself down to 1 x 1, each from the level above.
pub fn chain(image: &RgbImage) -> Vec<Pixels<DVec3>> {
    let mut levels = vec![image.map(|radiance| DVec3::from_array(radiance.map(f64::from)))];
    let size = [image.width, image.height];
    for mip in 1..level_count(size) {
        let level = downsample(&levels[mip as usize - 1], level_size(size, mip));
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
