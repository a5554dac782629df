//! Synthesis: Legendre sums on rows, then the inverse FFT of each.

use super::Sextet;
use super::legendre::{Block, LANES, Legendre};
use glam::DVec3;
use rayon::prelude::*;
use realfft::num_complex::Complex;
use realfft::{ComplexToReal, RealFftPlanner};
use std::f64::consts::PI;
use std::sync::Arc;

/// Sums over the degrees of one order, by parity of l + m, part of a [`Sextet`] and lane.
type OrderSums = [[[f64; LANES]; 6]; 2];

/// The texels of a row and of its mirror image.
type RowPair = [Vec<DVec3>; 2];

/// The convolution of a map with a zonal kernel, ready for rows of `width` texels.
pub(super) struct Synthesis<'a> {
    legendre: &'a Legendre,
    width: usize,
    /// Coefficients times the kernel's, by order m from 0 to the degree.
    orders: Vec<Vec<Sextet>>,
    /// By order: the shift to the centres of columns, half a column on.
    turns: Vec<Complex<f64>>,
    inverse: Arc<dyn ComplexToReal<f64>>,
}

/// The buffers of an inverse FFT.
struct Buffers {
    spectrum: Vec<Complex<f64>>,
    line: Vec<f64>,
    scratch: Vec<Complex<f64>>,
}

impl<'a> Synthesis<'a> {
    /// Scales the coefficients of a map by a kernel's `factors`, one per degree.
    pub(super) fn new(
        legendre: &'a Legendre,
        orders: &[Vec<Sextet>],
        factors: &[f64],
        width: usize,
    ) -> Self {
        let degree = (orders.len() - 1).min(factors.len() - 1);
        let scaled = |m: usize| {
            orders[m]
                .iter()
                .zip(&factors[m..])
                .map(|(value, factor)| value.map(|x| factor * x))
                .collect()
        };
        let turn = |m: usize| Complex::from_polar(1.0, PI * m as f64 / width as f64);
        Self {
            legendre,
            width,
            orders: (0..=degree).map(scaled).collect(),
            turns: (0..=degree).map(turn).collect(),
            inverse: RealFftPlanner::<f64>::new().plan_fft_inverse(width),
        }
    }

    /// Returns the texels of `height` rows.
    pub(super) fn map(&self, height: usize) -> Vec<DVec3> {
        let rows: Vec<RowPair> = Block::all(height)
            .par_iter()
            .flat_map_iter(|block| self.rows(block))
            .collect();
        let pairs = height.div_ceil(2);
        let north = rows[..pairs].iter().map(|[north, _]| north);
        // The middle row of an odd number mirrors itself.
        north
            .chain(rows[..height / 2].iter().rev().map(|[_, south]| south))
            .flatten()
            .copied()
            .collect()
    }

    /// Returns the rows of a block's lanes.
    fn rows(&self, block: &Block) -> Vec<RowPair> {
        let sums = self.sums(block);
        let mut buffers = Buffers {
            spectrum: self.inverse.make_input_vec(),
            line: self.inverse.make_output_vec(),
            scratch: self.inverse.make_scratch_vec(),
        };
        (0..LANES)
            .map(|lane| [1.0, -1.0].map(|sign| self.row(&sums, lane, sign, &mut buffers)))
            .collect()
    }

    /// Sums over the degrees of each order.
    fn sums(&self, block: &Block) -> Vec<OrderSums> {
        let degree = self.orders.len() - 1;
        let mut sums: Vec<OrderSums> = vec![[[[0.0; LANES]; 6]; 2]; degree + 1];
        let mut p = Vec::new();
        for (m, (values, sums)) in self.orders.iter().zip(&mut sums).enumerate() {
            if !self.legendre.fill(m, degree, block, &mut p) {
                continue;
            }
            for (parity, sums) in sums.iter_mut().enumerate() {
                let mut parity_sums = [[0.0; LANES]; 6];
                let values = values.iter().skip(parity).step_by(2);
                for (value, p) in values.zip(p.iter().skip(parity).step_by(2)) {
                    (0..6).for_each(|i| {
                        (0..LANES).for_each(|lane| parity_sums[i][lane] += value[i] * p[lane])
                    });
                }
                *sums = parity_sums;
            }
        }
        sums
    }

    /// Returns the row of a lane (`sign` 1) or its mirror image (-1).
    fn row(&self, sums: &[OrderSums], lane: usize, sign: f64, buffers: &mut Buffers) -> Vec<DVec3> {
        let mut texels = vec![DVec3::ZERO; self.width];
        for channel in 0..3 {
            self.fill_spectrum(&mut buffers.spectrum, sums, channel, |[even, odd], i| {
                even[i][lane] + sign * odd[i][lane]
            });
            self.inverse
                .process_with_scratch(
                    &mut buffers.spectrum,
                    &mut buffers.line,
                    &mut buffers.scratch,
                )
                .expect("buffers of the plan's own size");
            for (texel, value) in texels.iter_mut().zip(&buffers.line) {
                texel[channel] = *value;
            }
        }
        texels
    }

    /// Adds up the spectrum of a channel of a row; `part` reads the row's sums.
    fn fill_spectrum(
        &self,
        spectrum: &mut [Complex<f64>],
        sums: &[OrderSums],
        channel: usize,
        part: impl Fn(&OrderSums, usize) -> f64,
    ) {
        let width = self.width;
        spectrum.fill(Complex::default());
        for (m, (sums, turn)) in sums.iter().zip(&self.turns).enumerate() {
            let value = Complex::new(part(sums, channel), part(sums, channel + 3)) * turn;
            // Orders beyond the columns' rate fold back, as point values do.
            let bin = m % width;
            if m == 0 {
                spectrum[0].re += value.re;
            } else if bin == 0 || 2 * bin == width {
                spectrum[bin].re += 2.0 * value.re;
            } else if 2 * bin < width {
                spectrum[bin] += value;
            } else {
                spectrum[width - bin] += value.conj();
            }
        }
    }
}
