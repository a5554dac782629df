//! Levels without samples: the prefiltered map is a convolution, `P(r, alpha) = (K * L)(r)` with the kernel `K(γ) = D(γ/2) w(cos γ)` over
//! its integral. In spherical harmonics it is a product, `P_lm = k_l L_lm`.
//!
//! Tails of GGX are the longest: `k_l` falls as `exp(-2 alpha l)`. Degrees up to 8/alpha leave 1e-7 of it, at least 128 the edge of
//! the kernel at the horizon.

use super::Kernel;
use crate::environment::layout::MapLayout;
use crate::math::harmonics::{Harmonics, SmoothMap};
use crate::math::quadrature::GaussLegendre;
use crate::pixels::RgbImage;
use glam::{DVec2, DVec3};
use rayon::prelude::*;
use std::f64::consts::TAU;

/// Highest degree of a map's coefficients.
pub const DEGREE_MAX: usize = 1024;
/// Narrower lobes reach beyond that degree: it would leave more than `exp(-10)` of them.
pub const ALPHA_MIN: f64 = 5.0 / DEGREE_MAX as f64;
/// Lowest one that serves wide lobes, which end at the horizon.
const DEGREE_MIN: usize = 128;

/// Up to which degree a lobe of that width counts.
pub fn degree(alpha: f64) -> usize {
    ((8.0 / alpha).ceil() as usize).clamp(DEGREE_MIN, DEGREE_MAX)
}

/// The coefficients of an environment up to a degree.
pub fn harmonics(environment: &RgbImage, degree: usize) -> Harmonics {
    let [width, height] = [environment.width, environment.height].map(|side| side as usize);
    Harmonics::new(width, height, degree, |x, y| environment.get(x as u32, y as u32))
}

/// `k_l` for l up to a degree: the mean of `P_l(cos γ)` over the kernel.
pub fn factors(kernel: Kernel, alpha: f64, degree: usize) -> Vec<f64> {
    // In t = ln tan(γ/2), where a lobe of any width has the same shape; below it holds 4e-11.
    let low = alpha.ln() - 12.0;
    // Panels no longer than a radian of the highest degree.
    let count = (-low / f64::min(0.25, 1.5 / degree as f64)).ceil() as usize;
    let (rule, step) = (GaussLegendre::<6>::new(), -low / count as f64);
    let mut sums = vec![0.0; degree + 1];
    for panel in 0..count {
        for (node, weight) in rule.nodes.iter().zip(rule.weights) {
            let t = low + step * (panel as f64 + 0.5 * (1.0 + node));
            // sin γ = 1/cosh t, cos γ = -tanh t, dω = 2π sin² γ dt.
            let (sin, cos) = (1.0 / t.cosh(), -t.tanh());
            let h = (DVec3::new(sin, 0.0, cos) + DVec3::Z).normalize();
            let value = 0.5 * step * weight * TAU * sin * sin * kernel.brdf.d(h, alpha) * kernel.weight(alpha, cos);
            // (l + 1) P_l+1 = (2l + 1) cos γ P_l - l P_l-1.
            let (mut last, mut own) = (0.0, 1.0);
            for (l, sum) in sums.iter_mut().enumerate() {
                *sum += value * own;
                let l = l as f64;
                (last, own) = (own, ((2.0 * l + 1.0) * cos * own - l * last) / (l + 1.0));
            }
        }
    }
    let whole = sums[0];
    sums.iter_mut().for_each(|sum| *sum /= whole);
    sums
}

/// The prefiltered radiance by direction.
pub fn prefiltered(harmonics: &Harmonics, kernel: Kernel, alpha: f64) -> SmoothMap {
    harmonics.convolved(&factors(kernel, alpha, degree(alpha).min(harmonics.degree())))
}

/// The texels of a level, face after face.
pub fn level(harmonics: &Harmonics, kernel: Kernel, alpha: f64, layout: &MapLayout, size: [u32; 2]) -> Vec<[f32; 4]> {
    let map = prefiltered(harmonics, kernel, alpha);
    let extent = DVec2::new(size[0].into(), size[1].into());
    let rows: Vec<(u32, u32)> = (0..layout.face_count).flat_map(|face| (0..size[1]).map(move |y| (face, y))).collect();
    let row = |&(face, y): &(u32, u32)| {
        let texel = |x: u32| {
            let at = DVec2::new(x.into(), y.into()) + 0.5;
            // The sum of a series may ring below 0 by rounding.
            let rgb = map.value((layout.direction)(face, at / extent)).max(DVec3::ZERO).as_vec3();
            [rgb.x, rgb.y, rgb.z, 1.0]
        };
        (0..size[0]).map(texel).collect::<Vec<_>>()
    };
    rows.par_iter().flat_map_iter(row).collect()
}
