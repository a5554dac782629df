//! Finds the axes of a map by comparing all 48 with the environment.

use super::directions::Directions;
use super::{Truth, has_width};
use crate::bake::convention::{Axes, Convention};
use crate::bake::parts::Map;
use crate::base::pixels::RgbImage;
use crate::instrument::environment::layout::{FilteredMap, LAYOUTS};
use glam::DVec3;

/// Width of the compared lobe: wide enough to average texels, narrow enough to distinguish
/// directions.
const ALPHA: f64 = 0.15;
/// Side of the cube of directions, texels.
const SIDE: u32 = 16;
/// Points per side of a texel, to average a mirror level.
const SUPERSAMPLED: u32 = 8;
/// Added to radiance before the logarithm, as a share of the mean, so that a lamp does not decide
/// alone.
const FLOOR: f64 = 0.1;
/// A fit is clear if it leaves this many times less variance than the next.
const CLEAR: f64 = 4.0;

/// Correlation below which a map belongs to another light: bakes of the light itself reach 0.95, of
/// other lights at most 0.8.
pub const SAME_LIGHT: f64 = 0.9;
/// Correlation from which the axes explain the whole map.
pub const SURE: f64 = 0.99;
/// Number of equally good axes below [`SURE`] that chance gives: a map of another light.
pub const ALIKE_MAX: usize = 4;

/// An orientation of a map, and how well the light fits it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AxesFit {
    pub axes: Axes,
    /// Correlation of the logarithms of bake and light.
    pub correlation: f64,
}

/// Ranks every orientation of a map, best first, by the level whose width is nearest to `ALPHA`.
pub fn axes(truth: &Truth, map: &Map, convention: &Convention) -> Result<Vec<AxesFit>, String> {
    let alphas = convention.alphas(map.levels.len())?;
    let distance = |level: &usize| (alphas[*level].max(1e-3) / ALPHA).ln().abs();
    let level = (0..alphas.len())
        .min_by(|a, b| distance(a).total_cmp(&distance(b)))
        .expect("a map has levels");
    // Compares with the light at another width than the level's.
    let ranked_at = |factor: f64| {
        let light = truth.prefiltered((factor * alphas[level]).clamp(ALPHA / 2.0, 1.0));
        ranked(
            truth,
            map,
            level,
            &directions().means(1, |direction| light.value(direction)),
        )
    };
    if !has_width(alphas[level]) {
        let light = directions().means(SUPERSAMPLED, |direction| {
            truth.environment.radiance(direction)
        });
        return Ok(ranked(truth, map, level, &light));
    }
    let mut best = ranked_at(1.0);
    for factor in [0.5, 0.25, 2.0, 4.0] {
        if best[0].correlation >= SURE {
            break;
        }
        let other = ranked_at(factor);
        if other[0].correlation.total_cmp(&best[0].correlation).is_ge() {
            best = other;
        }
    }
    Ok(best)
}

/// Ranks every orientation of an irradiance map, best first.
pub fn irradiance_axes(truth: &Truth, map: &Map) -> Vec<AxesFit> {
    let (kernel, alpha) = Truth::of_irradiance();
    let light = truth.prefiltered_by(kernel, alpha);
    ranked(
        truth,
        map,
        0,
        &directions().means(1, |direction| light.value(direction)),
    )
}

/// Directions of a cube, whose texels map to texels under every orientation.
fn directions() -> Directions {
    Directions::new(&LAYOUTS[0], Axes::SAME, [SIDE; 2])
}

fn ranked(truth: &Truth, map: &Map, level: usize, light: &[DVec3]) -> Vec<AxesFit> {
    let directions = directions();
    let texel_along = |direction: DVec3| {
        let (face, uv) = (LAYOUTS[0].face_uv)(direction);
        let [x, y] = (uv * f64::from(SIDE))
            .to_array()
            .map(|texel| (texel as u32).min(SIDE - 1));
        light[((face * SIDE + y) * SIDE + x) as usize]
    };
    let floor = FLOOR * truth.environment.luminance.mean.max(f64::MIN_POSITIVE);
    let texels = |image: &RgbImage| image.map(|texel| DVec3::from_array(texel.map(f64::from)));
    let found = FilteredMap {
        layout: map.layout,
        levels: vec![map.levels[level].iter().map(texels).collect()],
    };
    let values = directions.means(SUPERSAMPLED, |direction| found.value(direction, 0.0));
    let mean = values
        .iter()
        .map(|value| value.element_sum() / 3.0)
        .sum::<f64>()
        / values.len() as f64;
    // The floor scales with the bake's mean, so a gain has no effect.
    let found_floor = FLOOR * mean.max(f64::MIN_POSITIVE);
    let found: Vec<f64> = values
        .iter()
        .map(|value| log_mean(*value, found_floor))
        .collect();
    let fit = |axes: Axes| {
        let light: Vec<f64> = directions
            .world
            .iter()
            .map(|file| log_mean(texel_along(axes.to_world(*file)), floor))
            .collect();
        AxesFit {
            axes,
            correlation: correlation(&directions.weights, &found, &light),
        }
    };
    let mut fits: Vec<AxesFit> = Axes::all().map(fit).collect();
    fits.sort_by(|a, b| b.correlation.total_cmp(&a.correlation));
    fits
}

/// Returns the logarithm of the mean channel plus a floor.
fn log_mean(value: DVec3, floor: f64) -> f64 {
    ((value.element_sum() / 3.0).max(0.0) + floor).ln()
}

fn correlation(weights: &[f64], a: &[f64], b: &[f64]) -> f64 {
    let whole: f64 = weights.iter().sum();
    let mean_a = weighted_sum(weights, a, |a| a) / whole;
    let mean_b = weighted_sum(weights, b, |b| b) / whole;
    let centred: Vec<[f64; 2]> = a
        .iter()
        .zip(b)
        .map(|(a, b)| [a - mean_a, b - mean_b])
        .collect();
    let covariance = weighted_sum(weights, &centred, |[a, b]| a * b);
    let variance_a = weighted_sum(weights, &centred, |[a, _]| a.powi(2));
    let variance_b = weighted_sum(weights, &centred, |[_, b]| b.powi(2));
    if variance_a * variance_b > 0.0 {
        covariance / (variance_a * variance_b).sqrt()
    } else {
        0.0
    }
}

fn weighted_sum<T: Copy>(weights: &[f64], values: &[T], term: impl Fn(T) -> f64) -> f64 {
    weights
        .iter()
        .zip(values)
        .map(|(weight, value)| weight * term(*value))
        .sum()
}

/// Whether the best fit leaves far less variance than another.
pub fn is_clear(best: AxesFit, other: AxesFit) -> bool {
    1.0 - other.correlation * other.correlation.abs()
        > CLEAR * (1.0 - best.correlation * best.correlation.abs())
}
