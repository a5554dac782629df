//! The environment's mip chain: each texel is the mean of radiance over its solid angle.
//!
//! A texel of a level covers a rectangle of the level above. Its value is `Σ w L / Σ w`, with w the solid angle of the
//! overlap with each source texel: overlap in u times the difference of cos θ over the overlap in θ. Unlike a box
//! filter this keeps the integral over the sphere at every size; a box filter overrates the texels at the poles.

#[cfg(feature = "gpu")]
pub mod pass;
pub mod reference;

use std::f64::consts::PI;

/// Returns the size of level `mip` of a chain over a `size` map: halved and rounded down per level, at least 1.
pub fn level_size(size: [u32; 2], mip: u32) -> [u32; 2] {
    size.map(|side| side.checked_shr(mip).unwrap_or(0).max(1))
}

/// Counts the levels down to 1 x 1.
pub fn level_count(size: [u32; 2]) -> u32 {
    size[0].max(size[1]).ilog2() + 1
}

/// Lists source texels under texel `index` of `count`, with the overlap's ends in source texels.
pub fn overlaps(index: u32, count: u32, source_count: u32) -> impl Iterator<Item = (u32, f64, f64)> {
    // Exact in integers: a rounded edge would add a sliver of another texel.
    let edge = |i: u32| u64::from(i) * u64::from(source_count);
    let (low, high) = (edge(index), edge(index + 1));
    let count = u64::from(count);
    (low / count..high.div_ceil(count)).map(move |source| {
        let (start, end) = (low.max(source * count), high.min((source + 1) * count));
        (source as u32, start as f64 / count as f64, end as f64 / count as f64)
    })
}

/// Returns `cos θ_start - cos θ_end` of a band of rows of `height`: its solid angle per radian of azimuth.
pub fn band(start: f64, end: f64, height: u32) -> f64 {
    let theta = |row: f64| PI * row / f64::from(height);
    // As a product: the difference of cosines loses digits in thin bands.
    2.0 * (0.5 * (theta(start) + theta(end))).sin() * (0.5 * (theta(end) - theta(start))).sin()
}
