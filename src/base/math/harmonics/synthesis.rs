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

/// What the rows of a block are computed in: the sums over its degrees, and an inverse FFT.
struct Buffers {
    legendre: Vec<[f64; LANES]>,
    sums: Vec<OrderSums>,
    spectrum: Vec<Complex<f64>>,
    line: Vec<f64>,
    scratch: Vec<Complex<f64>>,
}

/// The rows of a block in the map, and their mirror images: the last row is the first one's.
struct BlockRows<'t> {
    north: &'t mut [DVec3],
    south: &'t mut [DVec3],
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
        let mut texels = vec![DVec3::ZERO; self.width * height];
        // The middle row of an odd number mirrors itself.
        let (north, south) = texels.split_at_mut(self.width * height.div_ceil(2));
        let block_size = self.width * LANES;
        let north = north.par_chunks_mut(block_size);
        let south = south.par_rchunks_mut(block_size).map(Some);
        // The middle row may have a block of its own.
        let south = south.chain(rayon::iter::once(None));
        Block::all(height)
            .par_iter()
            .zip(north.zip(south))
            .for_each_init(
                || self.buffers(),
                |buffers, (block, (north, south))| {
                    let south = south.unwrap_or_default();
                    self.fill(block, BlockRows { north, south }, buffers);
                },
            );
        texels
    }

    fn buffers(&self) -> Buffers {
        Buffers {
            legendre: Vec::new(),
            sums: vec![[[[0.0; LANES]; 6]; 2]; self.orders.len()],
            spectrum: self.inverse.make_input_vec(),
            line: self.inverse.make_output_vec(),
            scratch: self.inverse.make_scratch_vec(),
        }
    }

    /// Computes the rows of a block's lanes.
    fn fill(&self, block: &Block, rows: BlockRows, buffers: &mut Buffers) {
        self.sum(block, buffers);
        let north = rows.north.chunks_mut(self.width);
        for (lane, row) in north.enumerate() {
            self.fill_row(row, lane, 1.0, buffers);
        }
        let south = rows.south.rchunks_mut(self.width);
        for (lane, row) in south.enumerate() {
            self.fill_row(row, lane, -1.0, buffers);
        }
    }

    /// Sums over the degrees of each order.
    fn sum(&self, block: &Block, buffers: &mut Buffers) {
        let degree = self.orders.len() - 1;
        let p = &mut buffers.legendre;
        for (m, (values, sums)) in self.orders.iter().zip(&mut buffers.sums).enumerate() {
            *sums = [[[0.0; LANES]; 6]; 2];
            if !self.legendre.fill(m, degree, block, p) {
                continue;
            }
            for (parity, sums) in sums.iter_mut().enumerate() {
                // The real parts, then the imaginary ones: sums of all six fill too many registers.
                for (part, sums) in sums.chunks_exact_mut(3).enumerate() {
                    let mut part_sums = [[0.0; LANES]; 3];
                    let values = values.iter().skip(parity).step_by(2);
                    for (value, p) in values.zip(p.iter().skip(parity).step_by(2)) {
                        for (sum, value) in part_sums.iter_mut().zip(&value[3 * part..]) {
                            (0..LANES).for_each(|lane| sum[lane] += value * p[lane]);
                        }
                    }
                    sums.copy_from_slice(&part_sums);
                }
            }
        }
    }

    /// Computes the row of a lane (`sign` 1) or its mirror image (-1).
    fn fill_row(&self, row: &mut [DVec3], lane: usize, sign: f64, buffers: &mut Buffers) {
        for channel in 0..3 {
            self.fill_spectrum(
                &mut buffers.spectrum,
                &buffers.sums,
                channel,
                |[even, odd], i| even[i][lane] + sign * odd[i][lane],
            );
            self.inverse
                .process_with_scratch(
                    &mut buffers.spectrum,
                    &mut buffers.line,
                    &mut buffers.scratch,
                )
                .expect("buffers of the plan's own size");
            for (texel, value) in row.iter_mut().zip(&buffers.line) {
                texel[channel] = *value;
            }
        }
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
