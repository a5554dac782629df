//! Analysis: the Fourier sums of a map's rows, then the rows of the quadrature over θ.

use super::{Sextet, smooth_even};
use rayon::prelude::*;
use realfft::RealFftPlanner;
use realfft::num_complex::Complex;
use rustfft::FftPlanner;
use std::f64::consts::{PI, TAU};

/// Integrates each row over φ against `exp(-i m φ)`, with the map linear between columns.
pub(super) fn spectra(
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
pub(super) struct Rows {
    height: usize,
    /// Rows of the quadrature, at `π (i + 1/2)/count`.
    pub(super) count: usize,
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
    pub(super) fn new(height: usize, degree: usize) -> Self {
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
    pub(super) fn halves(&self, m: usize, spectra: &[Vec<Sextet>]) -> Vec<[Sextet; 2]> {
        let order = Order {
            m,
            spectra,
            rows: self,
        };
        let mut circle = order.circle();
        self.forward.process(&mut circle);
        let mut found = order.series(&circle);
        self.inverse.process(&mut found);
        let pair = |row: usize| {
            let north = self.row(&found, row);
            let south = self.row(&found, self.count - 1 - row);
            [
                std::array::from_fn(|i| north[i] + south[i]),
                std::array::from_fn(|i| north[i] - south[i]),
            ]
        };
        (0..self.count / 2).map(pair).collect()
    }

    /// Reads a row of the quadrature from the sums on the circle, one circle per channel.
    fn row(&self, circles: &[Complex<f64>], row: usize) -> Sextet {
        std::array::from_fn(|i| {
            let value = circles[2 * self.count * (i % 3) + row];
            if i < 3 { value.re } else { value.im }
        })
    }
}

/// The sums of order m of all rows, as a function S = g sgn θ on the whole circle of θ: even for
/// odd orders, odd for even ones. `g |sin θ|` is S sin θ.
struct Order<'a> {
    m: usize,
    spectra: &'a [Vec<Sextet>],
    rows: &'a Rows,
}

impl Order<'_> {
    fn is_odd(&self) -> bool {
        self.m % 2 == 1
    }

    /// The sign of S on the second half of the circle.
    fn sign(&self) -> f64 {
        if self.is_odd() { 1.0 } else { -1.0 }
    }

    fn value(&self, row: usize, channel: usize) -> Complex<f64> {
        let coefficients = &self.spectra[row][self.m];
        Complex::new(coefficients[channel], coefficients[channel + 3])
    }

    /// Returns S at the rows, one circle per channel.
    fn circle(&self) -> Vec<Complex<f64>> {
        let height = self.rows.height;
        let sign = self.sign();
        let mut circle = vec![Complex::default(); 6 * height];
        for channel in 0..3 {
            let line = &mut circle[2 * height * channel..][..2 * height];
            for row in 0..height {
                let coefficient = self.value(row, channel);
                (line[row], line[2 * height - 1 - row]) = (coefficient, sign * coefficient);
            }
        }
        circle
    }

    /// Returns the Fourier coefficients of S sin θ up to the degree, one circle of the quadrature
    /// per channel, from the FFT of [`Self::circle`].
    fn series(&self, transformed: &[Complex<f64>]) -> Vec<Complex<f64>> {
        let Rows {
            height,
            count,
            linear,
            turn,
            ..
        } = self.rows;
        let sign = self.sign();
        let mut found = vec![Complex::default(); 6 * count];
        for channel in 0..3 {
            let line = &transformed[2 * height * channel..][..2 * height];
            // W_k = (S_k-1 - S_k+1)/2i, W_-k = -sign W_k.
            let out = &mut found[2 * count * channel..][..2 * count];
            let degree = linear.len() - 2;
            let mut last = sign * self.coefficient(line, channel, 1);
            let mut current = self.coefficient(line, channel, 0);
            for k in 0..=degree {
                let next = self.coefficient(line, channel, k + 1);
                let w = (last - next) * Complex::new(0.0, -0.5);
                out[k] = w * turn[k];
                if k > 0 {
                    out[2 * count - k] = -sign * w * turn[k].conj();
                }
                (last, current) = (current, next);
            }
        }
        found
    }

    /// Returns coefficient k of S, linear between rows.
    fn coefficient(&self, line: &[Complex<f64>], channel: usize, k: usize) -> Complex<f64> {
        let height = self.rows.height;
        let linear = line[k % (2 * height)] * self.rows.linear[k];
        if self.is_odd() {
            return linear;
        }
        // The step at the poles.
        let north = self.value(0, channel);
        let south = self.value(height - 1, channel);
        let south = if k % 2 == 1 { south } else { -south };
        linear + self.rows.step[k] * (north + south)
    }
}
