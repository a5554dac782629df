//! Separable filters of an image plane, continued by its outermost pixels.

use std::ops::{AddAssign, Mul};

/// One number per pixel, row-major.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Plane<T = f32> {
    pub width: usize,
    pub data: Vec<T>,
}

impl<T: Copy + Default + AddAssign + Mul<Output = T>> Plane<T> {
    pub fn from_fn(width: usize, len: usize, value: impl FnMut(usize) -> T) -> Self {
        Self {
            width,
            data: (0..len).map(value).collect(),
        }
    }

    /// `out(x, y) = Σ taps[i] · self(x + i - r, y)`, with `2 r + 1` taps.
    pub fn filter_rows(&self, taps: &[T]) -> Self {
        let radius = taps.len() / 2;
        let mut out = vec![T::default(); self.data.len()];
        let mut padded = vec![T::default(); self.width + 2 * radius];
        for (row, sums) in self
            .data
            .chunks_exact(self.width)
            .zip(out.chunks_exact_mut(self.width))
        {
            padded[radius..radius + self.width].copy_from_slice(row);
            padded[..radius].fill(row[0]);
            padded[radius + self.width..].fill(row[self.width - 1]);
            weighted_sums(sums, taps, |i| &padded[i..]);
        }
        Self {
            width: self.width,
            data: out,
        }
    }

    /// `out(x, y) = Σ taps[i] · self(x, y + i - r)`, with `2 r + 1` taps.
    pub fn filter_columns(&self, taps: &[T]) -> Self {
        let radius = taps.len() / 2;
        let mut out = vec![T::default(); self.data.len()];
        let height = self.data.len() / self.width;
        for (y, sums) in out.chunks_exact_mut(self.width).enumerate() {
            weighted_sums(sums, taps, |i| {
                let row = (y + i).saturating_sub(radius).min(height - 1);
                &self.data[row * self.width..]
            });
        }
        Self {
            width: self.width,
            data: out,
        }
    }
}

/// Sums that stay in registers while the taps pass over them.
const LANES: usize = 16;

/// `sums[x] = Σ taps[i] · values(i)[x]`, added in the order of the taps.
fn weighted_sums<'a, T>(sums: &mut [T], taps: &[T], values: impl Fn(usize) -> &'a [T])
where
    T: Copy + Default + AddAssign + Mul<Output = T> + 'a,
{
    let mut first = 0;
    let mut whole = sums.chunks_exact_mut(LANES);
    for lanes in &mut whole {
        let mut totals = [T::default(); LANES];
        for (i, &tap) in taps.iter().enumerate() {
            add_scaled(&mut totals, &values(i)[first..][..LANES], tap);
        }
        lanes.copy_from_slice(&totals);
        first += LANES;
    }
    let rest = whole.into_remainder();
    for (i, &tap) in taps.iter().enumerate() {
        add_scaled(rest, &values(i)[first..], tap);
    }
}

/// Adds `tap · values` as far as `sums` reaches.
#[inline]
fn add_scaled<T: Copy + AddAssign + Mul<Output = T>>(sums: &mut [T], values: &[T], tap: T) {
    sums.iter_mut()
        .zip(values)
        .for_each(|(sum, &value)| *sum += tap * value);
}
