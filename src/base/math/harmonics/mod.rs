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

mod analysis;
mod legendre;
mod smooth_map;
mod synthesis;

pub use legendre::margin;
pub use smooth_map::SmoothMap;

use super::equirect::uv_from_direction;
use analysis::{Rows, spectra};
use glam::DVec3;
use legendre::{Block, LANES, Legendre};
use rayon::prelude::*;
use std::f64::consts::TAU;
use synthesis::Synthesis;

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
            let block = Block::from_directions(members);
            let phi = |lane: usize| TAU * uv_from_direction(members[lane.min(members.len() - 1)]).x;
            let phi: [f64; LANES] = std::array::from_fn(phi);
            // Lanes side by side, by degree and channel.
            let mut bands = vec![[[0.0; LANES]; 3]; degree + 1];
            let mut p = Vec::new();
            for m in 0..=degree {
                if !self.legendre.fill(m, degree, &block, &mut p) {
                    continue;
                }
                // Orders -m are conjugates: they double the real part.
                let twice = if m == 0 { 1.0 } else { 2.0 };
                let turns = phi.map(|phi| (m as f64 * phi).sin_cos());
                for ((band, value), p) in bands[m..].iter_mut().zip(&self.orders[m]).zip(&p) {
                    for (channel, band) in band.iter_mut().enumerate() {
                        let [re, im] = [value[channel], value[channel + 3]];
                        (0..LANES).for_each(|lane| {
                            let (sin, cos) = turns[lane];
                            band[lane] += twice * p[lane] * (re * cos - im * sin);
                        });
                    }
                }
            }
            let of_lane = |lane: usize| -> Vec<DVec3> {
                let band =
                    |band: &[[f64; LANES]; 3]| DVec3::from_array(band.map(|lanes| lanes[lane]));
                bands.iter().map(band).collect()
            };
            (0..members.len()).map(of_lane).collect::<Vec<_>>()
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
        Synthesis::new(&self.legendre, &self.orders, factors, width).map(height)
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
