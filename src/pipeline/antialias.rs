//! Antialiased silhouettes.
//!
//! Shading stays at one point a pixel, so that "16 samples a pixel" means 16. The coverage of a pixel comes from a g-buffer with
//! [`POINTS_PER_SIDE`]² points a pixel; a pixel on a silhouette becomes `c S + (1 - c) B`, where c is its coverage, S the radiance of the
//! surface and B that behind it. The pixel's own radiance is one of the two; the mean over the nearest eight pixels of the other kind is
//! the other. Scores leave those pixels out.

use super::Frame;
use crate::pixels::{GrayImage, RgbImage};
use std::sync::Arc;

/// Points of a pixel's side at which coverage is sampled: 17 steps from bare to covered.
pub(super) const POINTS_PER_SIDE: u32 = 4;

/// Share of each pixel that the scene covers, from a mask with [`POINTS_PER_SIDE`] points a pixel's side.
pub(super) fn coverage(points: &GrayImage) -> GrayImage {
    let side = POINTS_PER_SIDE as usize;
    let (width, height) = (points.width as usize / side, points.height as usize / side);
    let mut covered = vec![0.0; width * height];
    for (y, row) in points.data.chunks_exact(points.width as usize).enumerate() {
        for (x, point) in row.iter().enumerate() {
            covered[y / side * width + x / side] += point / (side * side) as f32;
        }
    }
    GrayImage::new(width as u32, height as u32, covered)
}

/// The frame with its silhouettes resolved by `coverage`; its mask keeps the pixels that are covered whole.
pub(super) fn resolved(frame: Frame, coverage: &GrayImage) -> Frame {
    let is_edge = |share: f32| 0.0 < share && share < 1.0;
    let mask = coverage.data.iter().zip(&frame.mask.data).map(|(&share, &hit)| if share < 1.0 { 0.0 } else { hit });
    let mask = GrayImage::new(coverage.width, coverage.height, mask.collect());
    let mut radiance = frame.radiance.clone();
    for (index, &share) in coverage.data.iter().enumerate().filter(|(_, share)| is_edge(**share)) {
        let [surface, behind] = [1.0, 0.0].map(|hit| mean_of(&frame, index, hit).unwrap_or(frame.radiance.data[index]));
        radiance.data[index] = std::array::from_fn(|c| share * surface[c] + (1.0 - share) * behind[c]);
    }
    Frame { radiance, mask: Arc::new(mask), ..frame }
}

/// The pixel's own radiance if its centre is of the kind `hit` (1 surface, 0 none), else the mean of such pixels around it.
fn mean_of(frame: &Frame, index: usize, hit: f32) -> Option<[f32; 3]> {
    let RgbImage { width, height, data } = &frame.radiance;
    if frame.mask.data[index] == hit {
        return Some(data[index]);
    }
    let (x, y) = (index as u32 % width, index as u32 / width);
    let rows = y.saturating_sub(1)..=(y + 1).min(height - 1);
    let around =
        rows.flat_map(|y| (x.saturating_sub(1)..=(x + 1).min(width - 1)).map(move |x| (y * width + x) as usize));
    let of_kind: Vec<[f32; 3]> = around.filter(|&i| frame.mask.data[i] == hit).map(|i| data[i]).collect();
    let count = of_kind.len() as f32;
    (!of_kind.is_empty()).then(|| std::array::from_fn(|c| of_kind.iter().map(|texel| texel[c]).sum::<f32>() / count))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A half plane of radiance 2 before one of 6: a pixel that the edge cuts has the mean of both by area.
    #[test]
    fn an_edge_pixel_mixes_both_sides_by_area() {
        let points = GrayImage::new(12, 12, (0..144).map(|i| f32::from(u8::from(i % 12 < 5))).collect());
        let share = coverage(&points);
        assert_eq!(share.data[..3], [1.0, 0.25, 0.0]);
        // The centre of the cut pixel sees what is behind.
        let hit = |x: usize| if x == 0 { 1.0 } else { 0.0 };
        let mask = Arc::new(GrayImage::new(3, 3, (0..9).map(|i| hit(i % 3)).collect()));
        let radiance = RgbImage::new(3, 3, (0..9).map(|i| [if i % 3 == 0 { 2.0 } else { 6.0 }; 3]).collect());
        let frame = Frame {
            radiance,
            standard_error: None,
            convergences: Vec::new(),
            n_dot_v: mask.clone(),
            mask,
            timings: Default::default(),
        };
        let resolved = resolved(frame, &share);
        assert_eq!(resolved.radiance.data[3..6], [[2.0; 3], [0.25 * 2.0 + 0.75 * 6.0; 3], [6.0; 3]]);
        assert_eq!(resolved.mask.data[3..6], [1.0, 0.0, 0.0]);
    }
}
