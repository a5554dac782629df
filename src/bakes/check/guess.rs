//! Which axes fit a map: all 48 are tried against the environment.

use super::Truth;
use super::directions::Directions;
use crate::bakes::convention::{Axes, Convention};
use crate::bakes::parts::Map;
use crate::environment::layout::{FilteredMap, LAYOUTS};
use crate::pixels::RgbImage;
use glam::DVec3;

/// Width of the lobe that is compared: wide enough that no texel decides, narrow enough to tell directions apart.
const ALPHA: f64 = 0.15;
/// Side of the cube of directions.
const SIDE: u32 = 16;
/// Beside radiance under the logarithm, as a share of the mean: a lamp counts, but not alone.
const FLOOR: f64 = 0.1;
/// How much less variance the best must leave than the next one to be clear.
const CLEAR: f64 = 4.0;

/// Axes and how well they fit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AxesFit {
    pub axes: Axes,
    /// Correlation of the logarithms of the bake and of the light.
    pub correlation: f64,
}

/// Every orientation of a map, best first. The level whose width is nearest to [`ALPHA`] is compared.
pub fn axes(truth: &Truth, map: &Map, convention: &Convention) -> Result<Vec<AxesFit>, String> {
    let alphas = convention.alphas(map.levels.len())?;
    let off = |level: &usize| (alphas[*level].max(1e-3) / ALPHA).ln().abs();
    let level = (0..alphas.len()).min_by(|a, b| off(a).total_cmp(&off(b))).expect("a map has levels");
    let light = truth.prefiltered(alphas[level].max(ALPHA / 2.0));
    Ok(ranked(truth, map, level, |direction| light.value(direction)))
}

/// As [`axes`], for a map of irradiance.
pub fn irradiance_axes(truth: &Truth, map: &Map) -> Vec<AxesFit> {
    let light = truth.irradiance();
    ranked(truth, map, 0, |direction| light.value(direction))
}

fn ranked(truth: &Truth, map: &Map, level: usize, light: impl Fn(DVec3) -> DVec3) -> Vec<AxesFit> {
    let directions = Directions::new(&LAYOUTS[0], Axes::SAME, [SIDE; 2]);
    let floor = FLOOR * truth.environment.luminance.mean.max(f64::MIN_POSITIVE);
    // A gain moves nothing: the floor of the bake is that of its own mean.
    let texels = |image: &RgbImage| image.map(|texel| DVec3::from_array(texel.map(f64::from)));
    let found = FilteredMap { layout: map.layout, levels: vec![map.levels[level].iter().map(texels).collect()] };
    let values: Vec<DVec3> = directions.world.iter().map(|direction| found.value(*direction, 0.0)).collect();
    let mean = values.iter().map(|value| value.element_sum() / 3.0).sum::<f64>() / values.len() as f64;
    let own_floor = FLOOR * mean.max(f64::MIN_POSITIVE);
    let log = |value: DVec3, floor: f64| ((value.element_sum() / 3.0).max(0.0) + floor).ln();
    let found: Vec<f64> = values.iter().map(|value| log(*value, own_floor)).collect();
    let of = |axes: Axes| {
        let light = directions.world.iter().map(|file| log(light(axes.to_world(*file)), floor));
        AxesFit { axes, correlation: correlation(&directions.weights, &found, &light.collect::<Vec<_>>()) }
    };
    let mut fits: Vec<AxesFit> = Axes::all().map(of).collect();
    fits.sort_by(|a, b| b.correlation.total_cmp(&a.correlation));
    fits
}

fn correlation(weights: &[f64], a: &[f64], b: &[f64]) -> f64 {
    let mean =
        |values: &[f64]| weights.iter().zip(values).map(|(w, x)| w * x).sum::<f64>() / weights.iter().sum::<f64>();
    let (mean_a, mean_b) = (mean(a), mean(b));
    let (mut ab, mut aa, mut bb) = (0.0, 0.0, 0.0);
    for ((w, a), b) in weights.iter().zip(a).zip(b) {
        let (a, b) = (a - mean_a, b - mean_b);
        (ab, aa, bb) = (ab + w * a * b, aa + w * a * a, bb + w * b * b);
    }
    if aa * bb > 0.0 { ab / (aa * bb).sqrt() } else { 0.0 }
}

/// Whether the best of ranked fits leaves far less variance than another one.
pub fn is_clear(best: AxesFit, other: AxesFit) -> bool {
    1.0 - other.correlation * other.correlation.abs() > CLEAR * (1.0 - best.correlation * best.correlation.abs())
}

/// The fits in a sentence.
pub fn in_words(fits: &[AxesFit]) -> String {
    let [best, next] = [fits[0], fits[1]];
    let mirror = if best.axes.is_mirror() { ", a mirror" } else { "" };
    let how = if is_clear(best, next) { "clearly" } else { "but not clearly" };
    format!(
        "axes {}{mirror} fit best, {how}: correlation {:.4}, next {} with {:.4}",
        best.axes, best.correlation, next.axes, next.correlation
    )
}
