//! Prefiltering without samples. The prefiltered map is a convolution, `P(r, alpha) = (K * L)(r)`
//! with the kernel `K(γ) = D(γ/2) w(cos γ)` over its integral; in spherical harmonics it is a
//! product, `P_lm = k_l L_lm`.
//!
//! GGX has the longest tails: `k_l` falls as `exp(-2 alpha l)`, and degrees up to 8/alpha leave
//! 1e-7 of it. Lobes end at the horizon, wide ones most: then `k_l` falls as a power of l.
//! docs/estimators.md has the remaining errors.

use super::Kernel;
use crate::base::math::harmonics::Harmonics;
use crate::base::math::quadrature::GaussLegendre;
use crate::base::pixels::RgbImage;
use crate::instrument::brdf::Brdf;
use crate::instrument::environment::layout::MapLayout;
use glam::{DVec2, DVec3};
use rayon::prelude::*;
use std::f64::consts::TAU;

/// Highest degree of a map's coefficients.
pub const DEGREE_MAX: usize = 1024;
/// Narrower lobes need higher degrees: `exp(-10)` of them would be lost.
pub const ALPHA_MIN: f64 = 5.0 / DEGREE_MAX as f64;

/// Returns the degree up to which a lobe of that width matters: tails of narrow lobes, horizon
/// edges of wide ones.
pub fn degree(alpha: f64) -> usize {
    let counts = f64::max(8.0 / alpha, 192.0 * alpha.sqrt());
    (counts.ceil() as usize).clamp(128, DEGREE_MAX)
}

/// Returns a degree beyond [`degree`], to judge maps that were cut off there: tails of narrow lobes
/// fall from 1e-7 to 2e-9, and horizon edges count up to twice the degree.
pub fn degree_of_judge(alpha: f64) -> usize {
    let counts = f64::max(10.0 / alpha, 384.0 * alpha.sqrt());
    (counts.ceil() as usize).clamp(256, DEGREE_MAX)
}

/// Returns the degree up to which a map matters whose levels have widths from `alpha` to 1.
pub fn degree_of_map(alpha: f64) -> usize {
    degree(alpha).max(degree(1.0))
}

/// Computes the coefficients of an environment up to a degree.
pub fn harmonics(environment: &RgbImage, degree: usize) -> Harmonics {
    let [width, height] = [environment.width, environment.height].map(|side| side as usize);
    Harmonics::new(width, height, degree, |x, y| {
        environment.get(x as u32, y as u32)
    })
}

/// Computes `k_l` for l up to a degree: the mean of `P_l(cos γ)` over the kernel.
pub fn factors(kernel: Kernel, alpha: f64, degree: usize) -> Vec<f64> {
    factors_of(kernel.brdf, alpha, degree, |n_dot_l| {
        kernel.weight(alpha, n_dot_l)
    })
}

/// Computes `k_l` of the kernel `D w(n·l)`.
pub fn factors_of(
    brdf: &dyn Brdf,
    alpha: f64,
    degree: usize,
    weight: impl Fn(f64) -> f64,
) -> Vec<f64> {
    let integrals = integrals(brdf, alpha, degree, weight);
    integrals
        .iter()
        .map(|integral| integral / integrals[0])
        .collect()
}

/// Integrates `∫ D w P_l dl` for l up to a degree, at least 1.
pub fn integrals(
    brdf: &dyn Brdf,
    alpha: f64,
    degree: usize,
    weight: impl Fn(f64) -> f64,
) -> Vec<f64> {
    // In t = ln tan(γ/2), where lobes of any width have the same shape; 4e-11 of it lies below
    // `low`.
    let low = alpha.ln() - 12.0;
    const NODES: usize = 6;
    let rule = GaussLegendre::<NODES>::new();
    let steps: Vec<[f64; 2]> = (0..=degree)
        .map(|l| [(2 * l + 1) as f64, l as f64].map(|x| x / (l + 1) as f64))
        .collect();
    let mut sums = vec![0.0; degree + 1];
    let mut high = 0.0_f64;
    while high > low {
        // Panels no longer than a radian and a half of the highest degree: dγ = sin γ dt.
        let step = f64::min(0.25, 1.5 * high.cosh() / degree as f64);
        // The nodes of a panel side by side: a single recurrence would wait for itself.
        let mut cosines = [0.0; NODES];
        let mut values = [0.0; NODES];
        for k in 0..NODES {
            let t = high - 0.5 * step * (1.0 + rule.nodes[k]);
            // sin γ = 1/cosh t, cos γ = -tanh t, dω = 2π sin² γ dt.
            let sin = 1.0 / t.cosh();
            let cos = -t.tanh();
            let h = (DVec3::new(sin, 0.0, cos) + DVec3::Z).normalize();
            let own_weight = if cos > 0.0 { weight(cos) } else { 0.0 };
            values[k] =
                0.5 * step * rule.weights[k] * TAU * sin * sin * brdf.d(h, alpha) * own_weight;
            cosines[k] = cos;
        }
        // (l + 1) P_l+1 = (2l + 1) cos γ P_l - l P_l-1.
        let mut last = [0.0; NODES];
        let mut current = [1.0; NODES];
        let mut next = [0.0; NODES];
        for (sum, [a, b]) in sums.iter_mut().zip(&steps) {
            (0..NODES).for_each(|k| *sum += values[k] * current[k]);
            (0..NODES).for_each(|k| next[k] = a * cosines[k] * current[k] - b * last[k]);
            (last, current) = (current, next);
        }
        high -= step;
    }
    sums
}

/// Computes `k_l` of the cosine lobe in closed form: 1, 2/3, 0 for other odd l, `2 (-1)^(l/2-1) l!
/// / ((l + 2)(l - 1) 2^l (l/2)!²)` for even l [Ramamoorthi01, eq. 19].
pub fn cosine_factors(degree: usize) -> Vec<f64> {
    // l!/(2^l (l/2)!²) with the sign, by its ratio.
    let mut central = -1.0;
    let mut factor = |l: usize| match l {
        0 => 1.0,
        1 => 2.0 / 3.0,
        l if l % 2 == 1 => 0.0,
        l => {
            let l = l as f64;
            central *= -(l - 1.0) / l;
            2.0 * central / ((l + 2.0) * (l - 1.0))
        }
    };
    (0..=degree).map(&mut factor).collect()
}

/// Computes the texels of a map convolved with a kernel of these `k_l`, face by face.
pub fn texels(
    harmonics: &Harmonics,
    factors: &[f64],
    layout: &MapLayout,
    size: [u32; 2],
) -> Vec<[f32; 4]> {
    // A series may ring below 0 by rounding.
    let texel = |value: DVec3| value.max(DVec3::ZERO).as_vec3().extend(1.0).to_array();
    if layout.is_environments() {
        let [width, height] = size.map(|side| side as usize);
        return harmonics
            .synthesized(factors, width, height)
            .into_iter()
            .map(texel)
            .collect();
    }
    let map = harmonics.convolved(factors);
    let extent = DVec2::new(size[0].into(), size[1].into());
    let rows: Vec<(u32, u32)> = (0..layout.face_count)
        .flat_map(|face| (0..size[1]).map(move |y| (face, y)))
        .collect();
    let row = |&(face, y): &(u32, u32)| {
        let texel = |x: u32| {
            let texel_position = DVec2::new(x.into(), y.into()) + 0.5;
            texel(map.value((layout.direction)(face, texel_position / extent)))
        };
        (0..size[0]).map(texel).collect::<Vec<_>>()
    };
    rows.par_iter().flat_map_iter(row).collect()
}

pub fn level(
    harmonics: &Harmonics,
    kernel: Kernel,
    alpha: f64,
    layout: &MapLayout,
    size: [u32; 2],
) -> Vec<[f32; 4]> {
    texels(
        harmonics,
        &factors(kernel, alpha, degree(alpha).min(harmonics.degree())),
        layout,
        size,
    )
}
