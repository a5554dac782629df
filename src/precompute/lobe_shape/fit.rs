//! The width of the round kernel that is closest to a lobe.

use super::rule::Lobe;
use crate::glsl::constants::ALPHA_MIN;
use crate::math::quadrature::GaussLegendre;
use crate::precompute::prefilter::Kernel;
use glam::{DVec2, DVec3};
use std::f64::consts::TAU;

/// Widths that are tried; between them the objective is a parabola in ln a.
const PER_OCTAVE: f64 = 8.0;

/// The kernels of a prefiltered map.
pub struct Widths {
    kernel: Kernel,
    rows: Vec<Row>,
}

/// One kernel: its width, its integral, and the integral of its square once it is normalised.
struct Row {
    alpha: f64,
    integral: f64,
    square: f64,
}

impl Widths {
    /// From alpha 1 down to a quarter of the least that is shaded.
    pub fn new(kernel: Kernel) -> Self {
        let octaves = 2.0 - f64::from(ALPHA_MIN).log2();
        let row = |k: u32| {
            let alpha = (-f64::from(k) / PER_OCTAVE).exp2();
            let [integral, square] = moments(kernel, alpha);
            Row { alpha, integral, square: square / (integral * integral) }
        };
        Self { kernel, rows: (0..=(octaves * PER_OCTAVE) as u32).map(row).collect() }
    }

    /// The width in (0, 1] of the kernel about m closest to the lobe whose part of weight Fc has that share.
    pub fn fit(&self, lobe: &Lobe, share: f64, m: DVec3) -> f64 {
        let weights = DVec2::new(1.0 - share, share) / lobe.albedos;
        let nodes: Vec<(f64, f64)> =
            lobe.nodes.iter().map(|(l, part)| (0.25 * l.distance_squared(m), part.dot(weights))).collect();
        let objective = |k: usize| {
            let row = &self.rows[k];
            let overlap: f64 = nodes.iter().map(|&(sin2, w)| w * value(self.kernel, row.alpha, sin2)).sum();
            row.square - 2.0 * overlap / row.integral
        };
        let last = self.rows.len() - 1;
        let mut k = ((-lobe.alpha.log2() * PER_OCTAVE).round() as usize).clamp(1, last - 1);
        let mut around = [objective(k - 1), objective(k), objective(k + 1)];
        while around[0] < around[1] && k > 1 {
            k -= 1;
            around = [objective(k - 1), around[0], around[1]];
        }
        while around[2] < around[1] && k < last - 1 {
            k += 1;
            around = [around[1], around[2], objective(k + 1)];
        }
        let [wide, middle, narrow] = around;
        let bend = wide - 2.0 * middle + narrow;
        let step = if bend > 0.0 { (0.5 * (wide - narrow) / bend).clamp(-1.0, 1.0) } else { 0.0 };
        (self.rows[k].alpha * (-step / PER_OCTAVE).exp2()).min(1.0)
    }
}

/// `D(γ/2) w(cos γ)` by sin²(γ/2).
pub(super) fn value(kernel: Kernel, alpha: f64, sin2: f64) -> f64 {
    match kernel.weight(alpha, 1.0 - 2.0 * sin2) {
        0.0 => 0.0,
        weight => kernel.brdf.d(DVec3::new(sin2.sqrt(), 0.0, (1.0 - sin2).sqrt()), alpha) * weight,
    }
}

/// Integrals of the kernel and of its square, in `t = ln tan(γ/2)`, where a lobe of any width has the same shape.
fn moments(kernel: Kernel, alpha: f64) -> [f64; 2] {
    const PANEL: f64 = 0.25;
    let count = ((12.0 - alpha.ln()) / PANEL).ceil() as u32;
    let rule = GaussLegendre::<6>::new();
    let mut sums = [0.0; 2];
    for panel in 0..count {
        let low = -PANEL * f64::from(panel + 1);
        for (node, weight) in rule.nodes.iter().zip(rule.weights) {
            // sin γ = 1/cosh t, sin²(γ/2) = 1/(1 + e^-2t), dω = 2π sin² γ dt.
            let t = low + 0.5 * PANEL * (1.0 + node);
            let measure = 0.5 * PANEL * weight * TAU / t.cosh().powi(2);
            let value = value(kernel, alpha, 1.0 / (1.0 + (-2.0 * t).exp()));
            sums[0] += measure * value;
            sums[1] += measure * value * value;
        }
    }
    sums
}
