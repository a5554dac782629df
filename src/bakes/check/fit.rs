//! Which width and gain would explain what a level holds.

use super::directions::Directions;
use super::{Truth, errors};
use crate::precompute::prefilter::harmonic::ALPHA_MIN;
use glam::DVec3;

/// How much narrower or wider than a level's own the lobes are that are tried.
pub const REACH: f64 = 4.0;
/// Directions that a fit looks at, about.
const DIRECTIONS: usize = 2000;
/// Widths that are tried on the grid, and by bisection about the best of them.
const GRID: i32 = 8;
const REFINED: u32 = 8;

/// The lobe that comes nearest to a level.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fit {
    /// Its width.
    pub alpha: f64,
    /// What the level is of it: 1.1 is 10 % too bright.
    pub gain: f64,
    /// relMSE that is left.
    pub relmse: f64,
}

/// Fits a level of the width `alpha`; `found` are its texels at `directions`.
pub fn fit(truth: &Truth, directions: &Directions, found: &[DVec3], alpha: f64) -> Fit {
    let side = (directions.world.len() as f64 / DIRECTIONS as f64).sqrt();
    let chosen = directions.subset((side.round() as usize).max(1));
    let found: Vec<DVec3> = chosen.iter().map(|index| found[*index]).collect();
    let directions = directions.only(&chosen);
    let at = |alpha: f64| at_width(truth, &directions, &found, alpha);
    let (low, high) = ((alpha / REACH).max(ALPHA_MIN), (alpha.max(ALPHA_MIN) * REACH).min(1.0));
    let widths = (0..=GRID).map(|k| low * (high / low).powf(f64::from(k) / f64::from(GRID)));
    let mut best = widths.map(at).min_by(|a, b| a.relmse.total_cmp(&b.relmse)).expect("a grid of widths");
    let mut step = (high / low).powf(0.5 / f64::from(GRID));
    for _ in 0..REFINED {
        for alpha in [best.alpha / step, best.alpha * step] {
            let next = at(alpha.clamp(low, high));
            if next.relmse < best.relmse {
                best = next;
            }
        }
        step = step.sqrt();
    }
    best
}

fn at_width(truth: &Truth, directions: &Directions, found: &[DVec3], alpha: f64) -> Fit {
    let map = truth.prefiltered(alpha);
    let exact: Vec<DVec3> = directions.world.iter().map(|direction| map.value(*direction)).collect();
    let epsilon = truth.epsilon();
    // The gain of least relMSE, of `found = gain * exact`: that of the errors of `found / gain` has no closed form.
    let (mut product, mut square) = (0.0, 0.0);
    for ((weight, found), exact) in directions.weights.iter().zip(found).zip(&exact) {
        let scale = *weight / (*exact * *exact + epsilon);
        product += (scale * *found * *exact).element_sum();
        square += (scale * *exact * *exact).element_sum();
    }
    let gain = if square > 0.0 && product > 0.0 { product / square } else { 1.0 };
    Fit { alpha, gain, relmse: errors(directions, found, &exact, epsilon, 1.0 / gain).relmse }
}
