//! Spherical harmonics of a bilinear equirectangular map, and synthesis of its convolution with a
//! zonal kernel.
//!
//! A map with coefficients `L_lm`, convolved with a kernel of the angle γ alone, has coefficients
//! `k_l L_lm` with `k_l = 2π ∫ K(γ) P_l(cos γ) sin γ dγ` (the theorem of Funk and Hecke): no
//! samples and no noise.
//!
//! Analysis is exact for the bilinear map. Columns: the real FFT of each row, times the tent's
//! `sinc²(m/W)`. Rows: `L_lm = ∫ g P_lm sin θ dθ` with g linear between rows. On the whole circle
//! of θ, `g |sin θ|` has a Fourier series in closed form, from the FFT of the rows, and `P_lm` is a
//! polynomial of degree l: only orders up to the degree matter. The series cut there is summed on
//! one row more than the degree, where the sum over rows equals the integral.
//!
//! Synthesis: Legendre sums on rows, the inverse FFT of each, and Lagrange interpolation of order 8
//! between rows.
//!
//! The functions are `P_lm(cos θ) exp(i m φ)`, orthonormal, with `φ = 2π u` and `θ = π v`; m < 0
//! are conjugates.

mod legendre;
mod smooth_map;

pub use legendre::margin;
pub use smooth_map::SmoothMap;

use super::equirect::uv_from_direction;
use glam::DVec3;
use legendre::{Block, LANES, Legendre};
use rayon::prelude::*;
use realfft::RealFftPlanner;
use realfft::num_complex::Complex;
use rustfft::FftPlanner;
use std::f64::consts::{PI, TAU};

/// Real parts of red, green and blue, then the imaginary ones.
type Sextet = [f64; 6];

/// Coefficients of a map up to a degree.
#[derive(Clone, Debug)]
pub struct Harmonics {
    legendre: Legendre,
    /// By order m: degrees m to the highest.
    orders: Vec<Vec<Sextet>>,
}

impl Harmonics {
    /// Computes the coefficients of a map of `width` x `height` texels (row 0 at v = 0).
    pub fn new(
        width: usize,
        height: usize,
        degree: usize,
        texel: impl Fn(usize, usize) -> [f32; 3] + Sync,
    ) -> Self {
        let legendre = Legendre::new(degree);
        let spectra = spectra(width, height, degree, texel);
        let rows = Rows::new(height, degree);
        let blocks = Block::all(rows.count);
        let of_order = |m: usize| {
            let halves = rows.halves(m, &spectra);
            let mut sums = vec![[0.0; 6]; degree + 1 - m];
            let mut p = Vec::new();
            for (block, halves) in blocks.iter().zip(halves.chunks(LANES)) {
                if !legendre.fill(m, degree, block, &mut p) {
                    continue;
                }
                for parity in 0..2 {
                    let mut values = [[0.0; 6]; LANES];
                    values
                        .iter_mut()
                        .zip(halves)
                        .for_each(|(value, half)| *value = half[parity]);
                    let parity_sums = sums.iter_mut().skip(parity).step_by(2);
                    for (sum, p) in parity_sums.zip(p.iter().skip(parity).step_by(2)) {
                        (0..LANES).for_each(|lane| {
                            (0..6).for_each(|i| sum[i] += p[lane] * values[lane][i])
                        });
                    }
                }
            }
            sums
        };
        let orders = (0..=degree).into_par_iter().map(of_order).collect();
        Self { legendre, orders }
    }

    pub fn degree(&self) -> usize {
        self.orders.len() - 1
    }

    /// Returns the part of each degree up to `degree` at unit directions: `Σ_m L_lm Y_lm(d)` for l
    /// = 0 on. A convolution by a zonal kernel is `Σ k_l` times these, so many kernels at few
    /// directions cost little.
    pub fn bands(&self, degree: usize, directions: &[DVec3]) -> Vec<Vec<DVec3>> {
        let degree = degree.min(self.degree());
        let bands_of = |members: &[DVec3]| {
            let block = Block::at(members);
            let mut bands = vec![vec![DVec3::ZERO; degree + 1]; members.len()];
            let mut p = Vec::new();
            for m in 0..=degree {
                if !self.legendre.fill(m, degree, &block, &mut p) {
                    continue;
                }
                // Orders -m are conjugates: they double the real part.
                let twice = if m == 0 { 1.0 } else { 2.0 };
                for (lane, (bands, d)) in bands.iter_mut().zip(members).enumerate() {
                    let (sin, cos) = (m as f64 * TAU * uv_from_direction(*d).x).sin_cos();
                    for ((band, value), p) in bands[m..].iter_mut().zip(&self.orders[m]).zip(&p) {
                        let part = |i: usize| value[i] * cos - value[i + 3] * sin;
                        *band += twice * p[lane] * DVec3::new(part(0), part(1), part(2));
                    }
                }
            }
            bands
        };
        directions
            .par_chunks(LANES)
            .flat_map_iter(bands_of)
            .collect()
    }

    /// Convolves the map with a kernel of these `k_l`, one per degree from 0 on.
    pub fn convolved(&self, factors: &[f64]) -> SmoothMap {
        // One and a half times the rate of the highest degree, which the kernel has almost removed.
        let height = smooth_even((3 * factors.len().min(self.orders.len()) / 2).max(16));
        SmoothMap::new(
            2 * height,
            height,
            &self.synthesized(factors, 2 * height, height),
        )
    }

    /// As [`Self::convolved`], at the texel centres of an equirectangular map.
    pub fn synthesized(&self, factors: &[f64], width: usize, height: usize) -> Vec<DVec3> {
        let degree = self.degree().min(factors.len() - 1);
        let scaled = |m: usize| -> Vec<Sextet> {
            self.orders[m]
                .iter()
                .zip(&factors[m..])
                .map(|(value, factor)| value.map(|x| factor * x))
                .collect()
        };
        let scaled: Vec<_> = (0..=degree).map(scaled).collect();
        // Column centres lie half a column on.
        let turns: Vec<_> = (0..=degree)
            .map(|m| Complex::from_polar(1.0, PI * m as f64 / width as f64))
            .collect();
        let inverse = RealFftPlanner::<f64>::new().plan_fft_inverse(width);
        let of_block = |block: &Block| {
            // By order: sums over even and over odd l + m, by lane.
            let mut sums = vec![[[[0.0; LANES]; 6]; 2]; degree + 1];
            let mut p = Vec::new();
            for (m, sums) in sums.iter_mut().enumerate() {
                if !self.legendre.fill(m, degree, block, &mut p) {
                    continue;
                }
                for (parity, sums) in sums.iter_mut().enumerate() {
                    let mut parity_sums = [[0.0; LANES]; 6];
                    let values = scaled[m].iter().skip(parity).step_by(2);
                    for (value, p) in values.zip(p.iter().skip(parity).step_by(2)) {
                        (0..6).for_each(|i| {
                            (0..LANES).for_each(|lane| parity_sums[i][lane] += value[i] * p[lane])
                        });
                    }
                    *sums = parity_sums;
                }
            }
            let mut spectrum = inverse.make_input_vec();
            let mut line = inverse.make_output_vec();
            let mut scratch = inverse.make_scratch_vec();
            let mut row = |lane: usize, sign: f64| {
                let mut texels = vec![DVec3::ZERO; width];
                for channel in 0..3 {
                    spectrum.fill(Complex::default());
                    for (m, ([even, odd], turn)) in sums.iter().zip(&turns).enumerate() {
                        let part = |i: usize| even[i][lane] + sign * odd[i][lane];
                        let value = Complex::new(part(channel), part(channel + 3)) * turn;
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
                    inverse
                        .process_with_scratch(&mut spectrum, &mut line, &mut scratch)
                        .expect("buffers of the plan's own size");
                    texels
                        .iter_mut()
                        .zip(&line)
                        .for_each(|(texel, value)| texel[channel] = *value);
                }
                texels
            };
            (0..LANES)
                .map(|lane| [row(lane, 1.0), row(lane, -1.0)])
                .collect::<Vec<_>>()
        };
        let rows: Vec<_> = Block::all(height)
            .par_iter()
            .flat_map_iter(of_block)
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
}

/// Returns the smallest even number from `least` on without a prime factor above 5, for fast FFTs.
fn smooth_even(least: usize) -> usize {
    let is_smooth = |n: &usize| {
        let mut rest = *n;
        for prime in [2, 3, 5] {
            while rest.is_multiple_of(prime) {
                rest /= prime;
            }
        }
        rest == 1
    };
    (least.next_multiple_of(2)..)
        .step_by(2)
        .find(is_smooth)
        .expect("a power of two at the latest")
}

/// Integrates each row over φ against `exp(-i m φ)`, with the map linear between columns.
fn spectra(
    width: usize,
    height: usize,
    degree: usize,
    texel: impl Fn(usize, usize) -> [f32; 3] + Sync,
) -> Vec<Vec<Sextet>> {
    let forward = RealFftPlanner::<f64>::new().plan_fft_forward(width);
    let factor = |m: usize| {
        let x = PI * m as f64 / width as f64;
        Complex::from_polar(TAU / width as f64 * sinc(x).powi(2), -x)
    };
    let factors: Vec<Complex<f64>> = (0..=degree).map(factor).collect();
    let row = |y: usize| {
        let mut found = vec![[0.0; 6]; degree + 1];
        let mut line = forward.make_input_vec();
        let mut spectrum = forward.make_output_vec();
        for channel in 0..3 {
            line.iter_mut()
                .enumerate()
                .for_each(|(x, value)| *value = texel(x, y)[channel].into());
            forward
                .process(&mut line, &mut spectrum)
                .expect("buffers of the plan's own size");
            for (m, (found, factor)) in found.iter_mut().zip(&factors).enumerate() {
                // The spectrum of samples repeats, mirrored.
                let bin = m % width;
                let value = if bin <= width / 2 {
                    spectrum[bin]
                } else {
                    spectrum[width - bin].conj()
                } * factor;
                (found[channel], found[channel + 3]) = (value.re, value.im);
            }
        }
        found
    };
    (0..height).into_par_iter().map(row).collect()
}

fn sinc(x: f64) -> f64 {
    if x == 0.0 { 1.0 } else { x.sin() / x }
}

/// Converts the rows of a map to the rows of the quadrature.
struct Rows {
    height: usize,
    /// Rows of the quadrature, at `π (i + 1/2)/count`.
    count: usize,
    forward: std::sync::Arc<dyn rustfft::Fft<f64>>,
    inverse: std::sync::Arc<dyn rustfft::Fft<f64>>,
    /// By order k up to degree + 1: factor from the FFT to Fourier coefficients of the function
    /// linear between rows.
    linear: Vec<Complex<f64>>,
    /// Coefficient of the step at the pole that is constant up to the first row, beyond the linear
    /// ramp there.
    step: Vec<Complex<f64>>,
    /// Shift by half a row of the quadrature.
    turn: Vec<Complex<f64>>,
}

impl Rows {
    fn new(height: usize, degree: usize) -> Self {
        let count = smooth_even(degree + 1);
        let mut planner = FftPlanner::new();
        let orders = || (0..=degree + 1).map(|k| k as f64);
        let half = 0.5 * PI / height as f64;
        let linear =
            |k: f64| Complex::from_polar(0.5 / height as f64 * sinc(k * half).powi(2), -k * half);
        let step = |k: f64| {
            Complex::new(
                0.0,
                if k == 0.0 {
                    0.0
                } else {
                    (sinc(k * half) - 1.0) / (PI * k)
                },
            )
        };
        Self {
            height,
            count,
            forward: planner.plan_fft_forward(2 * height),
            inverse: planner.plan_fft_inverse(2 * count),
            linear: orders().map(linear).collect(),
            step: orders().map(step).collect(),
            turn: orders()
                .map(|k| Complex::from_polar(PI / count as f64, 0.5 * PI * k / count as f64))
                .collect(),
        }
    }

    /// Returns the weighted sum and difference of `g |sin θ|` of each row pair, its series cut at
    /// the degree.
    fn halves(&self, m: usize, spectra: &[Vec<Sextet>]) -> Vec<[Sextet; 2]> {
        let height = self.height;
        let count = self.count;
        let value = |row: usize, channel: usize| {
            let coefficients = &spectra[row][m];
            Complex::new(coefficients[channel], coefficients[channel + 3])
        };
        // S = g sgn θ on the circle, even for odd orders: g |sin θ| is S sin θ.
        let is_odd = m % 2 == 1;
        let sign = if m % 2 == 1 { 1.0 } else { -1.0 };
        let mut circle = vec![Complex::default(); 6 * height];
        for channel in 0..3 {
            let line = &mut circle[2 * height * channel..][..2 * height];
            for row in 0..height {
                let coefficient = value(row, channel);
                (line[row], line[2 * height - 1 - row]) = (coefficient, sign * coefficient);
            }
        }
        self.forward.process(&mut circle);
        let mut found = vec![Complex::default(); 6 * count];
        for channel in 0..3 {
            let poles = [value(0, channel), value(height - 1, channel)];
            let line = &circle[2 * height * channel..][..2 * height];
            let series = |k: usize| {
                let linear = line[k % (2 * height)] * self.linear[k];
                let south = if k % 2 == 1 { poles[1] } else { -poles[1] };
                if is_odd {
                    linear
                } else {
                    linear + self.step[k] * (poles[0] + south)
                }
            };
            // W_k = (S_k-1 - S_k+1)/2i, W_-k = -sign W_k.
            let out = &mut found[2 * count * channel..][..2 * count];
            let degree = self.linear.len() - 2;
            let mut last = sign * series(1);
            let mut current = series(0);
            for k in 0..=degree {
                let next = series(k + 1);
                let w = (last - next) * Complex::new(0.0, -0.5);
                out[k] = w * self.turn[k];
                if k > 0 {
                    out[2 * count - k] = -sign * w * self.turn[k].conj();
                }
                (last, current) = (current, next);
            }
        }
        self.inverse.process(&mut found);
        let pair = |row: usize| {
            let part = |row: usize| -> Sextet {
                std::array::from_fn(|i| {
                    let value = found[2 * count * (i % 3) + row];
                    if i < 3 { value.re } else { value.im }
                })
            };
            let north = part(row);
            let south = part(count - 1 - row);
            [
                std::array::from_fn(|i| north[i] + south[i]),
                std::array::from_fn(|i| north[i] - south[i]),
            ]
        };
        (0..count / 2).map(pair).collect()
    }
}
