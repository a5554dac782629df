//! Smaller images.

use super::{Pixels, Rgb8Image};

impl Rgb8Image {
    /// Shrinks by area means of encoded values: for pictures, not for measuring.
    pub fn shrunk(&self, width: u32, height: u32) -> Self {
        assert!(
            (1..=self.width).contains(&width) && (1..=self.height).contains(&height),
            "{width}x{height} is not smaller"
        );
        let means = self.area_means(width, height, |pixel| pixel.map(f64::from));
        means.map(|mean| mean.map(|value| value.round() as u8))
    }
}

impl<T: Copy> Pixels<T> {
    /// Shrinks by area means to any smaller size.
    pub fn area_means(
        &self,
        width: u32,
        height: u32,
        value: impl Fn(T) -> [f64; 3],
    ) -> Pixels<[f64; 3]> {
        let columns = overlaps(self.width, width);
        let rows = overlaps(self.height, height);
        Pixels::from_fn(width, height, |x, y| {
            let mut sum = [0.0; 3];
            let mut weight_sum = 0.0;
            for (row, row_weight) in &rows[y as usize] {
                for (column, column_weight) in &columns[x as usize] {
                    let weight = row_weight * column_weight;
                    let values = value(self.get(*column, *row));
                    (0..3).for_each(|c| sum[c] += weight * values[c]);
                    weight_sum += weight;
                }
            }
            sum.map(|total| total / weight_sum)
        })
    }
}

/// Lists the pixels that each of `to` equal parts of `from` pixels covers, with lengths.
fn overlaps(from: u32, to: u32) -> Vec<Vec<(u32, f64)>> {
    let step = f64::from(from) / f64::from(to);
    let part = |i: u32| {
        let start = f64::from(i) * step;
        let end = f64::from(i + 1) * step;
        let covered = |pixel: u32| f64::from(pixel + 1).min(end) - f64::from(pixel).max(start);
        (start as u32..from.min(end.ceil() as u32))
            .map(|pixel| (pixel, covered(pixel)))
            .filter(|(_, w)| *w > 0.0)
            .collect()
    };
    (0..to).map(part).collect()
}
