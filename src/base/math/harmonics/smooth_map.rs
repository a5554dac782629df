//! A smooth function between equirectangular texels, by Lagrange interpolation across seam and
//! poles.

use crate::base::math::equirect::uv_from_direction;
use glam::{DVec2, DVec3, DVec4};

/// Points of the interpolation per direction.
const STENCIL: usize = 8;

/// A function on rows of constant θ, smooth between them.
#[derive(Clone, Debug)]
pub struct SmoothMap {
    width: usize,
    height: usize,
    /// Padded by half a stencil on each side.
    texels: Vec<DVec4>,
}

impl SmoothMap {
    /// Takes an even number of columns, and at least a stencil of both.
    pub(super) fn new(width: usize, height: usize, texels: &[DVec3]) -> Self {
        const PAD: usize = STENCIL / 2;
        let texel = |y: usize, x: usize| {
            // Beyond a pole the rows continue on the other side.
            let (row, turn) = match y.checked_sub(PAD) {
                Some(row) if row < height => (row, 0),
                Some(row) => (2 * height - 1 - row, width / 2),
                None => (PAD - 1 - y, width / 2),
            };
            texels[row * width + (x + width - PAD + turn) % width].extend(0.0)
        };
        let across = width + STENCIL;
        let texels = (0..height + STENCIL)
            .flat_map(|y| (0..across).map(move |x| texel(y, x)))
            .collect();
        Self {
            width,
            height,
            texels,
        }
    }

    pub fn value(&self, direction: DVec3) -> DVec3 {
        let size = DVec2::new(self.width as f64, self.height as f64);
        let texel = uv_from_direction(direction) * size - 0.5;
        let (column, columns) = stencil(texel.x);
        let (row, rows) = stencil(texel.y);
        let mut sum = DVec4::ZERO;
        for (j, weight) in rows.iter().enumerate() {
            let line = &self.texels[(row + j) * (self.width + STENCIL) + column..][..STENCIL];
            let mut across = DVec4::ZERO;
            for (texel, weight) in line.iter().zip(&columns) {
                across += *weight * *texel;
            }
            sum += *weight * across;
        }
        sum.truncate()
    }
}

/// Returns first point (counted with the margin) and weights of the Lagrange interpolation at a
/// position.
fn stencil(position: f64) -> (usize, [f64; STENCIL]) {
    /// `1 / Π (i - j)` over the other points.
    const SCALES: [f64; STENCIL] = {
        let mut scales = [1.0; STENCIL];
        let mut i = 0;
        while i < STENCIL {
            let mut j = 0;
            while j < STENCIL {
                scales[i] /= if j == i { 1.0 } else { i as f64 - j as f64 };
                j += 1;
            }
            i += 1;
        }
        scales
    };
    let floor = position.floor();
    let t = position - floor + (STENCIL / 2 - 1) as f64;
    let mut weights = SCALES;
    let mut left = 1.0;
    let mut right = 1.0;
    for i in 0..STENCIL {
        weights[i] *= left;
        left *= t - i as f64;
        let back = STENCIL - 1 - i;
        weights[back] *= right;
        right *= t - back as f64;
    }
    ((floor + 1.0) as usize, weights)
}
