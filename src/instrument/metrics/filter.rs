//! Separable filters of an image plane, continued by its outermost pixels.

/// One number per pixel, row-major.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Plane {
    pub width: usize,
    pub data: Vec<f32>,
}

impl Plane {
    pub fn from_fn(width: usize, len: usize, value: impl FnMut(usize) -> f32) -> Self {
        Self {
            width,
            data: (0..len).map(value).collect(),
        }
    }

    /// `out(x, y) = Σ taps[i] · self(x + i - r, y)`, with `2 r + 1` taps.
    pub fn filter_rows(&self, taps: &[f32]) -> Self {
        let radius = taps.len() / 2;
        let mut out = vec![0.0; self.data.len()];
        let mut padded = vec![0.0; self.width + 2 * radius];
        for (row, sums) in self
            .data
            .chunks_exact(self.width)
            .zip(out.chunks_exact_mut(self.width))
        {
            padded[radius..radius + self.width].copy_from_slice(row);
            padded[..radius].fill(row[0]);
            padded[radius + self.width..].fill(row[self.width - 1]);
            for (i, &tap) in taps.iter().enumerate() {
                add_scaled(sums, &padded[i..], tap);
            }
        }
        Self {
            width: self.width,
            data: out,
        }
    }

    /// `out(x, y) = Σ taps[i] · self(x, y + i - r)`, with `2 r + 1` taps.
    pub fn filter_columns(&self, taps: &[f32]) -> Self {
        let radius = taps.len() / 2;
        let mut out = vec![0.0; self.data.len()];
        let height = self.data.len() / self.width;
        for (y, sums) in out.chunks_exact_mut(self.width).enumerate() {
            for (i, &tap) in taps.iter().enumerate() {
                let row = (y + i).saturating_sub(radius).min(height - 1);
                add_scaled(sums, &self.data[row * self.width..], tap);
            }
        }
        Self {
            width: self.width,
            data: out,
        }
    }
}

/// Adds `tap · values` as far as `sums` reaches.
fn add_scaled(sums: &mut [f32], values: &[f32], tap: f32) {
    sums.iter_mut()
        .zip(values)
        .for_each(|(sum, &value)| *sum += tap * value);
}
