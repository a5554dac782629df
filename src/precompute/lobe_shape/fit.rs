//! Finds the width of the round kernel that is closest to a lobe.

use super::rule::Lobe;
use crate::glsl::constants::ALPHA_MIN;
use crate::math::quadrature::GaussLegendre;
use crate::precompute::prefilter::Kernel;
use glam::DVec3;
use std::f64::consts::{PI, TAU};

/// The error that a width minimises.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Objective {
    /// `∫ (K - ŵ)²`: squared error under light that is white noise over the sphere.
    Square,
    /// `∫ (K - ŵ)² / (b + ŵ)²`, `b = AMBIENT/4π`: squared relative error under a small lamp anywhere and even light.
    Relative,
}

/// Flux of the even light over the lamp's. Chosen on five maps.
pub const AMBIENT: f64 = 4.0;

impl Objective {
    /// Returns the weight of a squared difference at that density.
    pub fn weight(self, density: f64) -> f64 {
        match self {
            Self::Square => 1.0,
            Self::Relative => (AMBIENT / (4.0 * PI) + density).powi(-2),
        }
    }
}

/// Tried widths per octave; between them the objective is a parabola in ln a.
const PER_OCTAVE: f64 = 16.0;

/// The search starts this many octaves below the lobe's alpha.
const OCTAVES_BELOW: f64 = 3.0;

/// Rings about the lookup's direction, per panel in `t = ln tan(γ/2)`; the kernel ends at t = 0, the horizon.
const PANEL: f64 = 0.5;
const RINGS: usize = 4;
/// Panels below `ln alpha`, and nodes of a ring over half a turn.
const PANELS_BELOW: f64 = 10.0;
const PHI_COUNT: u32 = 16;

/// The kernels of a prefiltered map, on rings about its direction.
pub struct Widths {
    /// sin γ, cos γ and measure of each ring, widest first.
    rings: Vec<(f64, f64, f64)>,
    /// Each width, with its normalised kernel on the rings.
    rows: Vec<(f64, Vec<f64>)>,
}

impl Widths {
    /// Computes widths from alpha 1 to a sixteenth of the smallest shaded alpha.
    pub fn new(kernel: Kernel) -> Self {
        let rule = GaussLegendre::<RINGS>::new();
        let narrowest = f64::from(ALPHA_MIN).ln() - PANEL * PANELS_BELOW;
        let ring = |panel: u32, k: usize| {
            let t = -PANEL * (f64::from(panel) + 0.5 * (1.0 + rule.nodes[k]));
            // sin γ = 1/cosh t, cos γ = -tanh t, dω = 2π sin² γ dt.
            let sin = 1.0 / t.cosh();
            (sin, -t.tanh(), 0.5 * PANEL * rule.weights[k] * TAU * sin * sin)
        };
        let panels = (-narrowest / PANEL).ceil() as u32;
        let rings: Vec<_> = (0..panels).flat_map(|panel| (0..RINGS).map(move |k| ring(panel, k))).collect();
        let row = |k: u32| {
            let alpha = (-f64::from(k) / PER_OCTAVE).exp2();
            let values: Vec<f64> = rings.iter().map(|&(sin, cos, _)| value(kernel, alpha, sin, cos)).collect();
            let integral: f64 = values.iter().zip(&rings).map(|(value, ring)| value * ring.2).sum();
            (alpha, values.into_iter().map(|value| value / integral).collect())
        };
        let octaves = OCTAVES_BELOW + 1.0 - f64::from(ALPHA_MIN).log2();
        Self { rows: (0..=(octaves * PER_OCTAVE) as u32).map(row).collect(), rings }
    }

    /// Finds the widths in (0, 1] of the kernels about m closest to the lobe of that share, by each objective.
    pub fn fit<const N: usize>(&self, lobe: &Lobe, share: f64, m: DVec3, objectives: [Objective; N]) -> [f64; N] {
        let tangent = DVec3::new(m.z, 0.0, -m.x);
        let count = (((PANELS_BELOW - lobe.alpha.ln() / PANEL).ceil() as usize) * RINGS).min(self.rings.len());
        let azimuths: Vec<(f64, f64)> =
            (0..PHI_COUNT).map(|j| (PI * (f64::from(j) + 0.5) / f64::from(PHI_COUNT)).sin_cos()).collect();
        // Only `Σ K² S - 2 K T` depends on the kernel: S integrates the weight over a ring, T weight times lobe.
        let mut sums = vec![[(0.0, 0.0); N]; count];
        for (sums, (sin, cos, measure)) in sums.iter_mut().zip(&self.rings) {
            for (sin_phi, cos_phi) in &azimuths {
                let density = lobe.density(share, *cos * m + *sin * (*cos_phi * tangent + *sin_phi * DVec3::Y));
                for (sums, objective) in sums.iter_mut().zip(objectives) {
                    let weight = objective.weight(density) * measure / f64::from(PHI_COUNT);
                    *sums = (sums.0 + weight, sums.1 + weight * density);
                }
            }
        }
        std::array::from_fn(|n| {
            self.least(lobe.alpha, |row| {
                row.iter().zip(&sums).map(|(k, sums)| k * (k * sums[n].0 - 2.0 * sums[n].1)).sum()
            })
        })
    }

    /// Finds the narrowest local minimum of the objective over widths. For much wider kernels, which leak everywhere,
    /// the objective may fall again until they show nothing.
    fn least(&self, alpha: f64, objective: impl Fn(&[f64]) -> f64) -> f64 {
        let objective = |k: usize| objective(&self.rows[k].1);
        let last = self.rows.len() - 1;
        let mut k = (((OCTAVES_BELOW - alpha.log2()) * PER_OCTAVE).round() as usize).clamp(1, last - 1);
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
        (self.rows[k].0 * (-step / PER_OCTAVE).exp2()).min(1.0)
    }
}

/// `D(γ/2) w(cos γ)`.
fn value(kernel: Kernel, alpha: f64, sin: f64, cos: f64) -> f64 {
    match kernel.weight(alpha, cos) {
        0.0 => 0.0,
        weight => kernel.brdf.d(DVec3::new(sin, 0.0, 1.0 + cos).normalize(), alpha) * weight,
    }
}
