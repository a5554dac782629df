//! Fits the width and gain that best explain a level.

use super::directions::Directions;
use super::{EXPLAINED, Truth, errors};
use crate::instrument::metrics::Epsilon;
use glam::DVec3;
use std::f64::consts::PI;

/// Tries lobes narrower and wider by this factor.
const REACH: f64 = 5.0;
const DIRECTIONS: usize = 600;
pub const DEGREE_MAX: usize = 320;
/// Narrower lobes reach beyond [`DEGREE_MAX`].
pub const ALPHA_MIN: f64 = 5.0 / DEGREE_MAX as f64;
/// Widths on the grid, then bisections around the best.
const GRID: i32 = 14;
const REFINED: u32 = 8;

/// Largest relMSE that a fit may leave: 20 % rms.
const CLOSE: f64 = 0.04;

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

/// Fits a level of width `alpha` with texels `found` at `directions`, which should be `exact`.
pub fn fit(
    truth: &Truth,
    directions: &Directions,
    [found, exact]: [&[DVec3]; 2],
    alpha: f64,
) -> Option<Fit> {
    let chosen = directions.grid(DIRECTIONS);
    let [found, exact] =
        [found, exact].map(|all| chosen.iter().map(|index| all[*index]).collect::<Vec<_>>());
    let directions = directions.only(&chosen);
    let bands = truth.harmonics.bands(DEGREE_MAX, &directions.world);
    let epsilon = truth.epsilon();
    let own = errors(&directions, &found, &exact, epsilon, 1.0).relmse;
    let at = |alpha: f64| {
        let exact = truth.of_bands(&bands, alpha);
        let gain = gain(&directions, &found, &exact, epsilon);
        Fit {
            alpha,
            gain,
            left: errors(&directions, &found, &exact, epsilon, 1.0 / gain).relmse / own,
        }
    };
    let high = if is_narrow(alpha) {
        1.0
    } else {
        (alpha * REACH).min(1.0)
    };
    let low = (alpha / REACH).max(ALPHA_MIN);
    let widths = (0..=GRID).map(|k| low * (high / low).powf(f64::from(k) / f64::from(GRID)));
    let mut best = widths.map(at).min_by(|a, b| a.left.total_cmp(&b.left))?;
    let mut step = (high / low).powf(0.5 / f64::from(GRID));
    for _ in 0..REFINED {
        for alpha in [best.alpha / step, best.alpha * step] {
            let next = at(alpha.clamp(low, high));
            if next.left < best.left {
                best = next;
            }
        }
        step = step.sqrt();
    }
    Some(best)
}

/// Returns the gain g of least mean `(found/g - exact)²/(exact² + ε)`.
pub fn gain(directions: &Directions, found: &[DVec3], exact: &[DVec3], epsilon: Epsilon) -> f64 {
    let (mut product, mut square) = (0.0, 0.0);
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

/// Factors that are forgotten, and their names.
pub const KNOWN: [f64; 7] = [PI, 1.0 / PI, 4.0 * PI, 0.25 / PI, 2.0 * PI, 2.0, 0.5];
const NAMES: [&str; 7] = ["pi", "1/pi", "4 pi", "1/4pi", "2 pi", "2", "1/2"];

/// Describes a gain, as a forgotten factor if it is near one, and returns what was described.
pub fn gain_in_words(gain: f64) -> (String, f64) {
    let is_near = |factor: f64| (gain / factor - 1.0).abs() < 0.01;
    let power = gain.log2().round().exp2();
    match KNOWN.iter().position(|factor| is_near(*factor)) {
        Some(i) => (format!("times {}", NAMES[i]), KNOWN[i]),
        None if power != 1.0 && is_near(power) => (format!("times {power}"), power),
        None if gain > 2.0 => (format!("{:.0} % too bright", 100.0 * (gain - 1.0)), gain),
        None if gain > 1.0 => (format!("{:.1} % too bright", 100.0 * (gain - 1.0)), gain),
        None => (format!("{:.1} % too dark", 100.0 * (1.0 - gain)), gain),
    }
}
