//! The score of a level: errors, the worst direction, and a likely cause.

use super::directions::{Directions, texels};
use super::exact::{exact, exact_irradiance};
use super::fit::{self, Fit};
use super::slip::{self, Slip};
use super::{EXPLAINED, Errors, GOOD, Truth, errors, has_width, relative_square};
use crate::bakes::convention::{Axes, Convention};
use crate::bakes::parts::Map;
use crate::environment::layout::{FilteredMap, MapLayout};
use crate::pixels::RgbImage;
use glam::DVec3;
use rayon::prelude::*;
use std::cell::LazyCell;

/// The direction of a level's largest relative error.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Worst {
    /// In the world.
    pub direction: DVec3,
    pub texel: [usize; 3],
    /// Radiance of the bake and of the integral.
    pub found: DVec3,
    pub exact: DVec3,
}

#[derive(Clone, Debug)]
pub struct LevelScore {
    pub size: [u32; 2],
    pub alpha: f64,
    pub errors: Errors,
    /// relMSE of lookups between texels; `None` for a mirror level, a level that the engine does not read and irradiance.
    pub between: Option<f64>,
    pub worst: Worst,
    /// Set if the level is not [`GOOD`].
    pub fit: Option<Fit>,
    /// Slip that explains the error, if the fit does not.
    pub slip: Option<Slip>,
    pub verdict: String,
}

pub fn score(truth: &Truth, map: &Map, convention: &Convention) -> Result<Vec<LevelScore>, String> {
    let alphas = convention.alphas(map.levels.len())?;
    // The same map cut at 1, if a level needs an explanation.
    let cut = LazyCell::new(|| truth.environment.clipped(1.0));
    let of_cut = LazyCell::new(|| Truth::new(&cut, truth.kernel, &alphas));
    let read = convention.mapping_levels(map.levels.len()) as usize;
    let of = |(k, (faces, &alpha)): (usize, (&Vec<RgbImage>, &f64))| {
        let (directions, found) = level_texels(map, faces, convention.axes, convention.scale);
        let exact = exact(truth, &directions, alpha);
        let (errors, worst) = errors_and_worst(truth, &directions, &found, &exact);
        let is_wrong = errors.relmse > GOOD;
        let fit = is_wrong.then(|| fit::fit(truth, &directions, &found, alpha)).flatten();
        let level =
            |of_cut| slip::Level { truth, of_cut, directions: &directions, found: &found, exact: &exact, alpha };
        let few = is_wrong.then(|| few_texels(truth, &directions, &found, &exact, errors.relmse)).flatten();
        let slip = few.or_else(|| is_wrong.then(|| level(&of_cut).slip()).flatten());
        // A slip must explain clearly more than width and gain do.
        let slip = slip.filter(|slip| fit.is_none_or(|fit| slip.left < 0.5 * fit.left));
        let is_read = k < read && has_width(alpha);
        let between = is_read.then(|| between_texels(truth, map.layout, faces, convention, alpha));
        let verdict = match &slip {
            Some(slip) => slip.words.clone(),
            None => verdict(errors, fit, alpha, |alpha| level_of(convention, &alphas, alpha)),
        };
        let size = [faces[0].width, faces[0].height];
        let mut score = LevelScore { size, alpha, errors, between, worst, fit, slip, verdict };
        if let Some(relmse) = score.coarseness() {
            score.verdict = format!("{GOOD_WORDS} at its texels, {:.1} % rms between them", 100.0 * relmse.sqrt());
        }
        score
    };
    Ok(map.levels.iter().zip(&alphas).enumerate().map(of).collect())
}

/// Describes the texels that alone are wrong, if the rest of the level is good.
fn few_texels(truth: &Truth, directions: &Directions, found: &[DVec3], exact: &[DVec3], relmse: f64) -> Option<Slip> {
    let square = |i: usize| directions.weights[i] * relative_square(found[i], exact[i], truth.epsilon());
    let mut squares: Vec<(f64, usize)> = (0..found.len()).map(|i| (square(i), i)).collect();
    squares.sort_by(|a, b| b.0.total_cmp(&a.0));
    let own: f64 = squares.iter().map(|(square, _)| square).sum();
    let left = |count: usize| squares[count..].iter().map(|(square, _)| square).sum::<f64>() / own;
    let count = (1..=FEW.min(squares.len())).find(|count| left(*count) * relmse <= GOOD)?;
    let [face, x, y] = directions.texel(squares[0].1);
    let words = match count {
        1 => format!("one texel is wrong: face {face}, column {x}, row {y}"),
        _ => format!("{count} texels are wrong, most at face {face}, column {x}, row {y}"),
    };
    Some(Slip { words, left: left(count) })
}

/// Returns relMSE at four points per texel, looked up as a GPU does: linear, across the edges of faces.
pub fn between_texels(
    truth: &Truth,
    layout: &'static MapLayout,
    faces: &[RgbImage],
    convention: &Convention,
    alpha: f64,
) -> f64 {
    let texel = |texel: [f32; 3]| convention.scale * DVec3::from_array(texel.map(f64::from));
    let level = FilteredMap { layout, levels: vec![faces.iter().map(|face| face.map(texel)).collect()] };
    let directions = Directions::new(layout, convention.axes, [2 * faces[0].width, 2 * faces[0].height]);
    let found = directions.world.par_iter().map(|world| level.value(convention.axes.to_file(*world), 0.0));
    errors(&directions, &found.collect::<Vec<_>>(), &exact(truth, &directions, alpha), truth.epsilon(), 1.0).relmse
}

pub fn score_irradiance(truth: &Truth, map: &Map, convention: &Convention) -> LevelScore {
    let faces = &map.levels[0];
    let (directions, found) = level_texels(map, faces, convention.axes, convention.irradiance_scale);
    let exact = exact_irradiance(truth, &directions);
    let (own, worst) = errors_and_worst(truth, &directions, &found, &exact);
    // Irradiance has no width to fit.
    let gain = fit::gain(&directions, &found, &exact, truth.epsilon());
    let left = errors(&directions, &found, &exact, truth.epsilon(), 1.0 / gain).relmse / own.relmse;
    let fit = (own.relmse > GOOD).then_some(Fit { alpha: 1.0, gain, left });
    let verdict = match fit {
        None => GOOD_WORDS.to_owned(),
        Some(fit) if fit.left <= EXPLAINED => fit::gain_in_words(fit.gain),
        Some(_) => UNEXPLAINED.to_owned(),
    };
    LevelScore {
        size: [faces[0].width, faces[0].height],
        alpha: 1.0,
        errors: own,
        between: None,
        worst,
        fit,
        slip: None,
        verdict,
    }
}

fn level_texels(map: &Map, faces: &[RgbImage], axes: Axes, scale: f64) -> (Directions, Vec<DVec3>) {
    (Directions::new(map.layout, axes, [faces[0].width, faces[0].height]), texels(faces, scale))
}

fn errors_and_worst(truth: &Truth, directions: &Directions, found: &[DVec3], exact: &[DVec3]) -> (Errors, Worst) {
    let epsilon = truth.epsilon();
    let square = |index: usize| relative_square(found[index], exact[index], epsilon);
    let index = (0..found.len()).max_by(|a, b| square(*a).total_cmp(&square(*b))).expect("a level has texels");
    let worst = Worst {
        direction: directions.world[index],
        texel: directions.texel(index),
        found: found[index],
        exact: exact[index],
    };
    (errors(directions, found, exact, epsilon, 1.0), worst)
}

/// Returns the fractional level of a width on the convention's scale, among levels of widths `alphas`.
pub(super) fn level_of(convention: &Convention, alphas: &[f64], alpha: f64) -> Option<f64> {
    match &convention.alphas {
        None if alphas.len() > 1 => {
            Some(convention.mapping.mip_from_alpha(alpha, convention.mapping_levels(alphas.len())))
        }
        _ => between(alphas, alpha),
    }
}

fn between(alphas: &[f64], alpha: f64) -> Option<f64> {
    let after = alphas.iter().position(|known| *known >= alpha)?.max(1);
    let (low, high) = (*alphas.get(after - 1)?, *alphas.get(after)?);
    // Roughness steps are nearly even.
    (high > low).then(|| (after - 1) as f64 + (alpha.sqrt() - low.sqrt()) / (high.sqrt() - low.sqrt()))
}

fn verdict(errors: Errors, fit: Option<Fit>, alpha: f64, level_of: impl Fn(f64) -> Option<f64>) -> String {
    let Some(fit) = fit else {
        return if errors.relmse <= GOOD { GOOD_WORDS } else { UNEXPLAINED }.to_owned();
    };
    if fit.left > EXPLAINED {
        return UNEXPLAINED.to_owned();
    }
    let mut parts = Vec::new();
    let shift = level_of(fit.alpha).zip(level_of(alpha)).map(|(found, own)| found - own);
    let widths = format!("alpha {:.3} for {alpha:.3}", fit.alpha);
    match shift {
        Some(shift) if shift >= SHIFT => parts.push(format!("{shift:.1} levels too blurred ({widths})")),
        Some(shift) if shift <= -SHIFT => parts.push(format!("{:.1} levels too sharp ({widths})", -shift)),
        None if fit.alpha > 1.1 * alpha => parts.push(format!("too blurred ({widths})")),
        None if fit.alpha < 0.9 * alpha => parts.push(format!("too sharp ({widths})")),
        _ => {}
    }
    if (fit.gain - 1.0).abs() >= 0.01 {
        parts.push(fit::gain_in_words(fit.gain));
    }
    if parts.is_empty() { "slightly off".to_owned() } else { parts.join("; ") }
}

/// Smallest shift in levels that a verdict mentions.
const SHIFT: f64 = 0.05;

pub(super) const DOUBT: &str = "its axes or its light do not fit";
/// Start of the verdict of a part within [`GOOD`].
pub(super) const GOOD_WORDS: &str = "good";
const UNEXPLAINED: &str = "no known slip explains it";
/// Most texels that are wrong by themselves.
const FEW: usize = 4;

impl LevelScore {
    /// Returns relMSE between its good texels where it is not good: the level has few texels for its width.
    pub fn coarseness(&self) -> Option<f64> {
        self.between.filter(|relmse| self.errors.relmse <= GOOD && *relmse > GOOD)
    }

    /// Removes width and gain from the verdict because the axes or the light do not fit.
    pub fn doubt(&mut self) {
        if self.errors.relmse > GOOD && self.slip.is_none() {
            self.verdict = DOUBT.to_owned();
        }
    }
}
