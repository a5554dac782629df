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

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AxesFit {
    pub axes: Axes,
    /// Correlation of the logarithms of bake and light.
    pub correlation: f64,
}

/// Ranks every orientation of a map, best first, by the level whose width is nearest to `ALPHA`.
pub fn axes(truth: &Truth, map: &Map, convention: &Convention) -> Result<Vec<AxesFit>, String> {
    let alphas = convention.alphas(map.levels.len())?;
    let off = |level: &usize| (alphas[*level].max(1e-3) / ALPHA).ln().abs();
    let level = (0..alphas.len())
        .min_by(|a, b| off(a).total_cmp(&off(b)))
        .expect("a map has levels");
    // Compares with the light at another width than the level's.
    let fits = |factor: f64| {
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
    let better = |best: Vec<AxesFit>, factor| match best[0].correlation >= SURE {
        true => best,
        false => [best, fits(factor)]
            .into_iter()
            .max_by(|a, b| a[0].correlation.total_cmp(&b[0].correlation))
            .expect("two"),
    };
    Ok([0.5, 0.25, 2.0, 4.0].into_iter().fold(fits(1.0), better))
}

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
    let along = |direction: DVec3| {
        let (face, uv) = (LAYOUTS[0].place)(direction);
        let [x, y] = (uv * f64::from(SIDE))
            .to_array()
            .map(|at| (at as u32).min(SIDE - 1));
        light[((face * SIDE + y) * SIDE + x) as usize]
    };
    let floor = FLOOR * truth.environment.luminance.mean.max(f64::MIN_POSITIVE);
    // The floor scales with the bake's own mean, so a gain has no effect.
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
    let own_floor = FLOOR * mean.max(f64::MIN_POSITIVE);
    let log = |value: DVec3, floor: f64| ((value.element_sum() / 3.0).max(0.0) + floor).ln();
    let found: Vec<f64> = values.iter().map(|value| log(*value, own_floor)).collect();
    let of = |axes: Axes| {
        let light = directions
            .world
            .iter()
            .map(|file| log(along(axes.to_world(*file)), floor));
        AxesFit {
            axes,
            correlation: correlation(&directions.weights, &found, &light.collect::<Vec<_>>()),
        }
    };
    let mut fits: Vec<AxesFit> = Axes::all().map(of).collect();
    fits.sort_by(|a, b| b.correlation.total_cmp(&a.correlation));
    fits
}

fn correlation(weights: &[f64], a: &[f64], b: &[f64]) -> f64 {
    let sum =
        |value: &dyn Fn(usize) -> f64| (0..a.len()).map(|i| weights[i] * value(i)).sum::<f64>();
    let [mean_a, mean_b] = [sum(&|i| a[i]), sum(&|i| b[i])].map(|of| of / sum(&|_| 1.0));
    let (a, b) = (|i: usize| a[i] - mean_a, |i: usize| b[i] - mean_b);
    let [ab, aa, bb] = [
        sum(&|i| a(i) * b(i)),
        sum(&|i| a(i).powi(2)),
        sum(&|i| b(i).powi(2)),
    ];
    if aa * bb > 0.0 {
        ab / (aa * bb).sqrt()
    } else {
        0.0
    }
}

/// Whether the best fit leaves far less variance than another.
pub fn is_clear(best: AxesFit, other: AxesFit) -> bool {
    1.0 - other.correlation * other.correlation.abs()
        > CLEAR * (1.0 - best.correlation * best.correlation.abs())
}
