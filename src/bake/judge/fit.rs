//! Fits the width and gain that best explain a level.

use super::directions::Directions;
use super::{EXPLAINED, Truth, errors};
use crate::instrument::metrics::Epsilon;
use crate::instrument::precompute::prefilter::harmonic;
use glam::DVec3;
use std::f64::consts::PI;

/// Tries lobes narrower and wider by this factor.
const REACH: f64 = 5.0;
/// Of levels wider than the BRDF's, lobes are tried up to this factor.
const BEYOND: f64 = 1.5;
const DIRECTIONS: usize = 600;
/// Largest degree of the harmonics of a fit.
pub const DEGREE_MAX: usize = 320;
/// Least degree of the harmonics of a fit, enough for the horizon edges of wide lobes.
const DEGREE_MIN: usize = 192;
/// Narrower lobes reach beyond [`DEGREE_MAX`].
pub const ALPHA_MIN: f64 = 5.0 / DEGREE_MAX as f64;
/// Widths on the grid, then bisections around the best.
const GRID: i32 = 14;
const REFINED: u32 = 8;

/// Largest relMSE that a fit may leave: 20 % rms.
const CLOSE: f64 = 0.04;

/// The width and gain that best explain a level.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fit {
    pub alpha: f64,
    /// Factor on the lobe: 1.1 means the level is 10 % too bright.
    pub gain: f64,
    /// relMSE of the fit over the relMSE of the level's own width at a gain of 1.
    pub left: f64,
}

impl Fit {
    /// Whether width and gain explain a level of this relmse.
    pub fn explains(&self, relmse: f64) -> bool {
        self.left <= EXPLAINED && self.left * relmse <= CLOSE
    }

    /// Whether the right width of a level may be beyond the widths that were tried.
    pub fn is_at_end(&self, alpha: f64) -> bool {
        self.alpha < 1.02 * ALPHA_MIN.max(alpha / REACH) || self.alpha > 0.98 * REACH * alpha
    }
}

/// Whether a level may be too blurred, but has no narrower lobes that could be tried.
pub fn is_narrow(alpha: f64) -> bool {
    alpha * REACH < 2.0 * ALPHA_MIN
}

/// Returns the degree up to which lobes from `alpha` to 1 are compared.
pub fn degree(alpha: f64) -> usize {
    harmonic::degree(alpha).clamp(DEGREE_MIN, DEGREE_MAX)
}

/// Fits a level of width `alpha` with texels `found` at `directions`, which should be `exact`.
pub fn fit(
    truth: &Truth,
    directions: &Directions,
    found: &[DVec3],
    exact: &[DVec3],
    alpha: f64,
) -> Option<Fit> {
    let chosen = directions.grid(DIRECTIONS);
    let found = picked(found, &chosen);
    let exact = picked(exact, &chosen);
    let directions = directions.only(&chosen);
    let low = (alpha / REACH).max(ALPHA_MIN);
    let bands = truth.harmonics.bands(degree(low), &directions.world);
    let epsilon = truth.epsilon();
    let unfitted = errors(&directions, &found, &exact, epsilon, 1.0).relmse;
    let with_width = |alpha: f64| {
        let exact = truth.of_bands(&bands, alpha);
        let gain = gain(&directions, &found, &exact, epsilon);
        let fitted = errors(&directions, &found, &exact, epsilon, 1.0 / gain).relmse;
        Fit {
            alpha,
            gain,
            left: fitted / unfitted,
        }
    };
    let high = if is_narrow(alpha) {
        1.0
    } else {
        let widest = if alpha > 1.0 { BEYOND * alpha } else { 1.0 };
        (alpha * REACH).min(widest)
    };
    let widths = (0..=GRID).map(|k| low * (high / low).powf(f64::from(k) / f64::from(GRID)));
    let mut best = widths
        .map(with_width)
        .min_by(|a, b| a.left.total_cmp(&b.left))?;
    let mut step = (high / low).powf(0.5 / f64::from(GRID));
    for _ in 0..REFINED {
        for alpha in [best.alpha / step, best.alpha * step] {
            let next = with_width(alpha.clamp(low, high));
            if next.left < best.left {
                best = next;
            }
        }
        step = step.sqrt();
    }
    Some(best)
}

/// Returns the texels at these indices.
pub fn picked(texels: &[DVec3], indices: &[usize]) -> Vec<DVec3> {
    indices.iter().map(|index| texels[*index]).collect()
}

/// Returns the gain g of least mean `(found/g - exact)²/(exact² + ε)`.
pub fn gain(directions: &Directions, found: &[DVec3], exact: &[DVec3], epsilon: Epsilon) -> f64 {
    let mut product = 0.0;
    let mut square = 0.0;
    for ((weight, found), exact) in directions.weights.iter().zip(found).zip(exact) {
        let scale = DVec3::from_array(
            exact
                .to_array()
                .map(|exact| epsilon.relative(*weight, exact)),
        );
        product += (scale * *found * *exact).element_sum();
        square += (scale * *found * *found).element_sum();
    }
    if square > 0.0 && product > 0.0 {
        square / product
    } else {
        1.0
    }
}

/// A factor that programs forget.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum KnownFactor {
    Pi,
    OverPi,
    FourPi,
    OverFourPi,
    TwoPi,
    Two,
    Half,
}

impl KnownFactor {
    pub const ALL: [Self; 7] = [
        Self::Pi,
        Self::OverPi,
        Self::FourPi,
        Self::OverFourPi,
        Self::TwoPi,
        Self::Two,
        Self::Half,
    ];

    pub fn value(self) -> f64 {
        match self {
            Self::Pi => PI,
            Self::OverPi => 1.0 / PI,
            Self::FourPi => 4.0 * PI,
            Self::OverFourPi => 0.25 / PI,
            Self::TwoPi => 2.0 * PI,
            Self::Two => 2.0,
            Self::Half => 0.5,
        }
    }
}

/// A gain, and the forgotten factor that it is within 1 % of.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Gain {
    Known(KnownFactor),
    /// A power of two.
    Power(f64),
    Other(f64),
}

impl Gain {
    pub fn new(gain: f64) -> Self {
        let is_near = |factor: f64| (gain / factor - 1.0).abs() < 0.01;
        let power = gain.log2().round().exp2();
        let known = KnownFactor::ALL
            .into_iter()
            .find(|factor| is_near(factor.value()));
        match known {
            Some(factor) => Self::Known(factor),
            None if power != 1.0 && is_near(power) => Self::Power(power),
            None => Self::Other(gain),
        }
    }

    /// Returns the forgotten factor, or the gain itself.
    pub fn value(self) -> f64 {
        match self {
            Self::Known(factor) => factor.value(),
            Self::Power(gain) | Self::Other(gain) => gain,
        }
    }
}
