//! The kernel that a lookup of a prefiltered map averages with: the blend of two levels.

use crate::base::glsl::constants::ALPHA_MIN;
use crate::base::math::quadrature::GaussLegendre;
use crate::instrument::precompute::prefilter::{Kernel, LevelMapping, LevelSpacing};
use glam::DVec3;
use std::f64::consts::TAU;

/// Intervals of a tabulated kernel, over `1 - alpha / √(q + alpha²)`, `q = sin² γ/2`: every model
/// is smooth there.
const INTERVALS: usize = 512;

/// If level 0 is a mirror, the kernel below level 1 has the width in between, tabulated at this many
/// levels. The device blends level 1 with the mirror there. Taken as such, it would never be used,
/// because light is smooth over texels.
const PARTS_OF_LEVEL_1: u32 = 8;

/// Smallest level that has a kernel.
pub const LEVEL_MIN: f64 = 1.0 / PARTS_OF_LEVEL_1 as f64;

pub struct Chain {
    kernels: Vec<LevelKernel>,
    spacing: LevelSpacing,
}

struct LevelKernel {
    level: f64,
    alpha2: f64,
    values: Vec<f64>,
}

impl Chain {
    /// `level_count`: at least 2.
    pub fn new(kernel: Kernel, mapping: &'static LevelMapping, level_count: u32) -> Self {
        Self::spaced(
            kernel,
            LevelSpacing {
                mapping,
                level_count,
            },
        )
    }

    /// Takes levels of any roughness.
    pub fn spaced(kernel: Kernel, spacing: LevelSpacing) -> Self {
        let level_count = spacing.level_count;
        let has_mirror = spacing.alpha_from_level(0.0) < ALPHA_MIN.into();
        let first: Vec<f64> = if has_mirror {
            (1..PARTS_OF_LEVEL_1)
                .map(|part| f64::from(part) * LEVEL_MIN)
                .collect()
        } else {
            vec![0.0]
        };
        let of_level = |level: f64| {
            let alpha = spacing.alpha_from_level(level).max(ALPHA_MIN.into());
            let alpha2 = alpha * alpha;
            let scale = 1.0 / integral(kernel, alpha);
            // Beyond the horizon the table goes on with its last value: `density` is 0 there.
            let cos = |i: usize| {
                let rest = 1.0 - i as f64 / INTERVALS as f64;
                (1.0 - 2.0 * alpha2 * (1.0 / (rest * rest) - 1.0)).max(1e-9)
            };
            let values = (0..INTERVALS)
                .map(|i| scale * value(kernel, alpha, cos(i)))
                .collect();
            LevelKernel {
                level,
                alpha2,
                values,
            }
        };
        Self {
            kernels: first
                .into_iter()
                .chain((1..level_count).map(f64::from))
                .map(of_level)
                .collect(),
            spacing,
        }
    }

    /// Returns the index of the roughest level.
    pub fn last(&self) -> f64 {
        f64::from(self.spacing.level_count - 1)
    }

    /// Returns the real level of a width.
    pub fn level(&self, alpha: f64) -> f64 {
        self.spacing.level_from_alpha(alpha)
    }

    /// Returns the density of a lookup at a real level from `LEVEL_MIN` on, by the cosine to its
    /// direction, and its derivative by the level.
    pub fn lookup(&self, level: f64) -> impl Fn(f64) -> [f64; 2] {
        let rougher = self
            .kernels
            .partition_point(|kernel| kernel.level <= level)
            .clamp(1, self.kernels.len() - 1);
        let [fine, rough] = [&self.kernels[rougher - 1], &self.kernels[rougher]];
        move |cos| {
            if cos <= 0.0 {
                return [0.0; 2];
            }
            let q = 0.5 * (1.0 - cos).max(0.0);
            let value = |kernel: &LevelKernel| {
                let at = (1.0 - (kernel.alpha2 / (q + kernel.alpha2)).sqrt()) * INTERVALS as f64;
                let low = (at as usize).min(INTERVALS - 2);
                kernel.values[low]
                    + (at - low as f64) * (kernel.values[low + 1] - kernel.values[low])
            };
            let of_fine = value(fine);
            let slope = (value(rough) - of_fine) / (rough.level - fine.level);
            [of_fine + (level - fine.level) * slope, slope]
        }
    }
}

/// `D(γ/2) w(cos γ)`.
fn value(kernel: Kernel, alpha: f64, cos: f64) -> f64 {
    let sin_h = (0.5 * (1.0 - cos)).max(0.0).sqrt();
    let cos_h = (0.5 * (1.0 + cos)).sqrt();
    kernel.brdf.d(DVec3::new(sin_h, 0.0, cos_h), alpha) * kernel.weight(alpha, cos)
}

/// Integrates the kernel over the hemisphere, in `t = -ln tan(γ/2)` by panels.
fn integral(kernel: Kernel, alpha: f64) -> f64 {
    const PANEL: f64 = 0.5;
    let rule = GaussLegendre::<8>::new();
    let panels = ((4.0 - alpha.ln()) / PANEL).ceil() as u32;
    let of_panel = |panel: u32| {
        let low = PANEL * f64::from(panel);
        rule.integrate(low, low + PANEL, |t| {
            value(kernel, alpha, t.tanh()) * TAU / t.cosh().powi(2)
        })
    };
    (0..panels).map(of_panel).sum()
}
