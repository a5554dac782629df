//! Spherical-harmonic transform of a bilinear equirectangular map, and the synthesis of what a zonal kernel makes of it.
//!
//! A map with coefficients `L_lm`, convolved with a kernel that depends on the angle γ alone, has `k_l L_lm` with
//! `k_l = 2π ∫ K(γ) P_l(cos γ) sin γ dγ` (the theorem of Funk and Hecke): no samples and no noise.
//!
//! Analysis: the real FFT of each row; the tent between columns is the factor `sinc²(m/W)`; between rows the map is linear, and
//! Gauss nodes integrate it against the Legendre functions. Synthesis: Legendre sums on rows at twice the rate of the highest
//! degree, the inverse FFT, and Lagrange's interpolation of order 8 in between, which runs across the poles.
//!
//! The functions are `P_lm(cos θ) exp(i m φ)`, orthonormal, with `φ = 2π u` and `θ = π v` of the map; orders m < 0 are conjugates.

use super::equirect::uv_from_direction;
use super::quadrature::GaussLegendre;
use glam::{DVec2, DVec3};
use rayon::prelude::*;
use realfft::RealFftPlanner;
use realfft::num_complex::Complex;
use std::f64::consts::{PI, TAU};

/// Real parts of red, green and blue, then the imaginary ones.
type Sextet = [f64; 6];

/// Rows that one recurrence runs for.
const LANES: usize = 4;
/// Orders beyond `degree sin θ` by this much have no part in a row: their functions are below 1e-12 there.
const MARGIN: f64 = 60.0;
/// Points of the interpolation in each direction.
const STENCIL: usize = 8;

/// Coefficients of a map up to a degree.
#[derive(Clone, Debug)]
pub struct Harmonics {
    degree: usize,
    /// Of order m: degrees m to `degree`.
    orders: Vec<Vec<Sextet>>,
}

/// A function on rows of constant θ, between which it is smooth.
#[derive(Clone, Debug)]
pub struct SmoothMap {
    width: usize,
    height: usize,
    texels: Vec<DVec3>,
}

/// Two rows, at θ and at π - θ: their sum and their difference serve the degrees of even and of odd l + m.
struct Pair {
    cos: f64,
    sin: f64,
    /// Weight of the quadrature.
    weight: f64,
    /// Rows next to the northern one, and the place between them.
    rows: [usize; 2],
    part: f64,
}

impl Harmonics {
    /// The coefficients of a map of `width` x `height` texels (row 0 at v = 0).
    pub fn new(width: usize, height: usize, degree: usize, texel: impl Fn(usize, usize) -> [f32; 3] + Sync) -> Self {
        let spectra = spectra(width, height, degree, texel);
        let pairs = gauss_pairs(height, degree);
        let of_order = |m: usize| {
            let mut sums = vec![[0.0; 6]; degree + 1 - m];
            for block in pairs.chunks(LANES) {
                if is_beyond(m, degree, block) {
                    continue;
                }
                let mut halves = [[[0.0; 6]; 2]; LANES];
                for (half, pair) in halves.iter_mut().zip(block) {
                    let mixed = |rows: [usize; 2]| -> Sextet {
                        let [a, b] = rows.map(|row| &spectra[row][m]);
                        std::array::from_fn(|i| pair.weight * (a[i] + (b[i] - a[i]) * pair.part))
                    };
                    let (north, south) = (mixed(pair.rows), mixed(pair.rows.map(|row| height - 1 - row)));
                    *half =
                        [std::array::from_fn(|i| north[i] + south[i]), std::array::from_fn(|i| north[i] - south[i])];
                }
                legendre(m, degree, block, |l, p| {
                    let sum = &mut sums[l - m];
                    for (half, p) in halves.iter().zip(p) {
                        let values = &half[(l + m) % 2];
                        for i in 0..6 {
                            sum[i] += p * values[i];
                        }
                    }
                });
            }
            sums
        };
        Self { degree, orders: (0..=degree).into_par_iter().map(of_order).collect() }
    }

    pub fn degree(&self) -> usize {
        self.degree
    }

    /// The part of each degree up to `degree` at unit directions: `Σ_m L_lm Y_lm(d)` for l = 0 on. With it a convolution by any zonal kernel
    /// is `Σ k_l` times these, so many kernels at few directions cost little.
    pub fn bands(&self, degree: usize, directions: &[DVec3]) -> Vec<Vec<DVec3>> {
        let degree = degree.min(self.degree);
        let of_block = |block: &[DVec3]| {
            let pair =
                |d: &DVec3| Pair { cos: d.y, sin: d.x.hypot(d.z).max(1e-12), weight: 1.0, rows: [0; 2], part: 0.0 };
            let pairs: Vec<Pair> = block.iter().map(pair).collect();
            let mut bands = vec![vec![DVec3::ZERO; degree + 1]; block.len()];
            for m in (0..=degree).filter(|m| !is_beyond(*m, degree, &pairs)) {
                // Orders -m are conjugates: they double the real part.
                let twice = if m == 0 { 1.0 } else { 2.0 };
                let azimuth = |d: &DVec3| m as f64 * TAU * uv_from_direction(*d).x;
                let turns: Vec<(f64, f64)> = block.iter().map(|d| azimuth(d).sin_cos()).collect();
                legendre(m, degree, &pairs, |l, p| {
                    let value = &self.orders[m][l - m];
                    for ((bands, (sin, cos)), p) in bands.iter_mut().zip(&turns).zip(p) {
                        let part = |i: usize| value[i] * cos - value[i + 3] * sin;
                        bands[l] += twice * p * DVec3::new(part(0), part(1), part(2));
                    }
                });
            }
            bands
        };
        directions.par_chunks(LANES).flat_map_iter(of_block).collect()
    }

    /// What a kernel of these `k_l` makes of the map; `factors` has one for each degree that counts.
    pub fn convolved(&self, factors: &[f64]) -> SmoothMap {
        let degree = self.degree.min(factors.len() - 1);
        // Twice the rate of the highest degree.
        let (height, width) = ((2 * degree + 2).max(STENCIL), (4 * degree + 4).max(2 * STENCIL));
        let theta = |row: usize| PI * (row as f64 + 0.5) / height as f64;
        let pairs: Vec<Pair> = (0..height / 2)
            .map(|row| Pair { cos: theta(row).cos(), sin: theta(row).sin(), weight: 1.0, rows: [row; 2], part: 0.0 })
            .collect();
        let inverse = RealFftPlanner::<f64>::new().plan_fft_inverse(width);
        let of_block = |block: &[Pair]| {
            // Of each row pair and parity, by order.
            let mut sums = vec![[[[0.0; 6]; 2]; LANES]; degree + 1];
            for (m, sums) in sums.iter_mut().enumerate().filter(|(m, _)| !is_beyond(*m, degree, block)) {
                let own = &self.orders[m];
                legendre(m, degree, block, |l, p| {
                    let (factor, value, parity) = (factors[l], &own[l - m], (l + m) % 2);
                    for (sum, p) in sums.iter_mut().zip(p) {
                        for i in 0..6 {
                            sum[parity][i] += p * factor * value[i];
                        }
                    }
                });
            }
            let row = |lane: usize, sign: f64| {
                let mut texels = vec![DVec3::ZERO; width];
                let mut spectrum = inverse.make_input_vec();
                let mut line = inverse.make_output_vec();
                for channel in 0..3 {
                    spectrum.fill(Complex::default());
                    for (m, sums) in sums.iter().enumerate() {
                        let [even, odd] = &sums[lane];
                        let part = |i: usize| even[i] + sign * odd[i];
                        // Centres of columns lie half a column on.
                        let turn = Complex::from_polar(1.0, PI * m as f64 / width as f64);
                        spectrum[m] = Complex::new(part(channel), part(channel + 3)) * turn;
                    }
                    spectrum[0].im = 0.0;
                    inverse.process(&mut spectrum, &mut line).expect("buffers of the plan's own size");
                    texels.iter_mut().zip(&line).for_each(|(texel, value)| texel[channel] = *value);
                }
                texels
            };
            (0..block.len()).map(|lane| [row(lane, 1.0), row(lane, -1.0)]).collect::<Vec<_>>()
        };
        let rows: Vec<_> = pairs.par_chunks(LANES).flat_map_iter(of_block).collect();
        let north = rows.iter().map(|[north, _]| north);
        let texels = north.chain(rows.iter().rev().map(|[_, south]| south)).flatten().copied().collect();
        SmoothMap { width, height, texels }
    }
}

impl SmoothMap {
    /// The function in a direction.
    pub fn value(&self, direction: DVec3) -> DVec3 {
        let size = DVec2::new(self.width as f64, self.height as f64);
        let place = uv_from_direction(direction) * size - 0.5;
        let [columns, rows] = [place.x, place.y].map(stencil);
        let mut sum = DVec3::ZERO;
        for (j, weight) in rows.1.iter().enumerate() {
            let (mut row, mut first) = (rows.0 + j as i64, columns.0);
            // Beyond a pole the rows come back on the other side.
            if row < 0 || row >= self.height as i64 {
                row = if row < 0 { -1 - row } else { 2 * self.height as i64 - 1 - row };
                first += self.width as i64 / 2;
            }
            let line = &self.texels[row as usize * self.width..][..self.width];
            for (i, own) in columns.1.iter().enumerate() {
                sum += weight * own * line[(first + i as i64).rem_euclid(self.width as i64) as usize];
            }
        }
        sum
    }
}

/// First point and weights of Lagrange's interpolation at a place between whole numbers.
fn stencil(place: f64) -> (i64, [f64; STENCIL]) {
    let first = place.floor() - (STENCIL / 2 - 1) as f64;
    let t = place - first;
    let weight = |i: usize| (0..STENCIL).filter(|j| *j != i).map(|j| (t - j as f64) / (i as f64 - j as f64)).product();
    (first as i64, std::array::from_fn(weight))
}

/// Of each row the integrals over φ against `exp(-i m φ)`, of the map that is linear between columns.
fn spectra(
    width: usize,
    height: usize,
    degree: usize,
    texel: impl Fn(usize, usize) -> [f32; 3] + Sync,
) -> Vec<Vec<Sextet>> {
    let forward = RealFftPlanner::<f64>::new().plan_fft_forward(width);
    let factor = |m: usize| {
        let x = PI * m as f64 / width as f64;
        let sinc = if m == 0 { 1.0 } else { x.sin() / x };
        Complex::from_polar(TAU / width as f64 * sinc * sinc, -x)
    };
    let factors: Vec<Complex<f64>> = (0..=degree).map(factor).collect();
    let row = |y: usize| {
        let mut found = vec![[0.0; 6]; degree + 1];
        let (mut line, mut spectrum) = (forward.make_input_vec(), forward.make_output_vec());
        for channel in 0..3 {
            line.iter_mut().enumerate().for_each(|(x, value)| *value = texel(x, y)[channel].into());
            forward.process(&mut line, &mut spectrum).expect("buffers of the plan's own size");
            for (m, (found, factor)) in found.iter_mut().zip(&factors).enumerate() {
                // The spectrum of samples repeats, mirrored.
                let bin = m % width;
                let value = if bin <= width / 2 { spectrum[bin] } else { spectrum[width - bin].conj() } * factor;
                (found[channel], found[channel + 3]) = (value.re, value.im);
            }
        }
        found
    };
    (0..height).into_par_iter().map(row).collect()
}

/// Gauss nodes between centres of rows of the northern half, three a radian of the highest degree; beyond the first row the map is constant.
fn gauss_pairs(height: usize, degree: usize) -> Vec<Pair> {
    let (rows, rule) = (height as f64, GaussLegendre::<3>::new());
    let pieces = (PI * degree as f64 / rows).ceil().max(1.0);
    let mut pairs = Vec::new();
    // In units of rows, centres at whole numbers: from the pole at -1/2 to the equator at (H - 1)/2.
    let mut low = -0.5;
    let end = 0.5 * (rows - 1.0);
    while low < end {
        let high = f64::min(low.floor() + 1.0, end);
        let half = 0.5 * (high - low) / pieces;
        let middle = |piece: usize| low + half * (2 * piece + 1) as f64;
        let of_piece = |piece| {
            rule.nodes.iter().zip(&rule.weights).map(move |(x, weight)| (middle(piece) + half * x, half * weight))
        };
        for (node, weight) in (0..pieces as usize).flat_map(of_piece) {
            let theta = PI * (node + 0.5) / rows;
            let row = node.floor().max(0.0);
            let next = (row as usize + 1).min(height - 1);
            let rows_of = if node < 0.0 { [0; 2] } else { [row as usize, next] };
            let weight = weight * PI / rows * theta.sin();
            pairs.push(Pair { cos: theta.cos(), sin: theta.sin(), weight, rows: rows_of, part: node - row });
        }
        low = high;
    }
    pairs
}

fn is_beyond(m: usize, degree: usize, block: &[Pair]) -> bool {
    block.iter().all(|pair| m as f64 > degree as f64 * pair.sin + MARGIN)
}

/// Calls `each(l, P_lm)` for l = m to `degree`, with the functions at the rows of a block; lanes without a row get 0.
fn legendre(m: usize, degree: usize, block: &[Pair], mut each: impl FnMut(usize, &[f64; LANES])) {
    let mut cos = [0.0; LANES];
    let mut last = [0.0; LANES];
    let mut own = [0.0; LANES];
    // P_mm = sqrt((2m + 1)/4π Π (2k - 1)/2k) sin^m θ, as a logarithm: it may be as small as 1e-300.
    let log_scale = 0.5 * ((2 * m + 1) as f64 / (4.0 * PI)).ln()
        + (1..=m).map(|k| 0.5 * ((2 * k - 1) as f64 / (2 * k) as f64).ln()).sum::<f64>();
    for (lane, pair) in block.iter().enumerate() {
        cos[lane] = pair.cos;
        own[lane] = (log_scale + m as f64 * pair.sin.ln()).exp();
    }
    let mut last_factor = 1.0;
    for l in m..=degree {
        each(l, &own);
        // P_l+1 = a_l+1 (cos θ P_l - P_l-1 / a_l), a_l² = (4 l² - 1)/(l² - m²).
        let next = (l + 1) as f64;
        let factor = ((4.0 * next * next - 1.0) / (next * next - (m * m) as f64)).sqrt();
        for lane in 0..LANES {
            let value = factor * (cos[lane] * own[lane] - last[lane] / last_factor);
            last[lane] = own[lane];
            own[lane] = value;
        }
        last_factor = factor;
    }
}
