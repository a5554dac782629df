//! The score of a level: errors, the worst direction, and a likely cause.

use super::directions::{Directions, texels};
use super::exact::{exact, finer};
use super::fit::{self, Fit};
use super::light::{self, Lit, Source};
use super::sample::{self, Level};
use super::slip::Slip;
use super::{Cause, Errors, GOOD, Truth, errors, faces, has_width, relative_square, words};
use crate::bake::convention::{Axes, Convention};
use crate::bake::parts::Map;
use crate::base::pixels::RgbImage;
use crate::instrument::environment::layout::{FilteredMap, MapLayout};
use glam::DVec3;
use rayon::prelude::*;
use std::cell::LazyCell;

/// The direction of a level's largest relative error.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Worst {
    /// In the world.
    pub direction: DVec3,
    pub texel: [usize; 3],
    /// Radiance of the bake and of the integral.
    pub found: DVec3,
    pub exact: DVec3,
}

#[derive(Clone, Debug, Default)]
pub struct LevelScore {
    pub size: [u32; 2],
    pub alpha: f64,
    pub errors: Errors,
    /// relMSE of lookups between texels; `None` for a mirror level, a level that the engine does
    /// not read and irradiance.
    pub between: Option<f64>,
    pub worst: Worst,
    /// Set if relMSE is above [`GOOD`].
    pub fit: Option<Fit>,
    /// Slip that explains the error, if the fit does not.
    pub slip: Option<Slip>,
    /// What the verdict names; empty if the level is good.
    pub causes: Vec<Cause>,
    pub verdict: String,
}

pub fn score(truth: &Truth, map: &Map, convention: &Convention) -> Result<Vec<LevelScore>, String> {
    // Of a map of another light, one unexplained level ends the long searches.
    let mut is_lost = false;
    let alphas = convention.alphas(map.levels.len())?;
    let read = convention.mapping_levels(map.levels.len()) as usize;
    let sheets = map
        .levels
        .iter()
        .map(|faces| level_texels(map, faces, convention.axes, convention.scale));
    let sheets: Vec<(Directions, Vec<DVec3>)> = sheets.collect();
    // One level may be wrong by itself, so the middle mean counts.
    let mut means: Vec<DVec3> = sheets
        .iter()
        .map(|(directions, found)| mean(directions, found))
        .collect();
    means.sort_by(|a, b| a.element_sum().total_cmp(&b.element_sum()));
    let lights = LazyCell::new(|| {
        let gain = sample::usual_gain(truth, &sheets[0].0, &sheets[0].1, alphas[0]);
        let gains = if (gain - 1.0).abs() > light::SAME_MEAN {
            &[1.0, gain][..]
        } else {
            &[1.0]
        };
        light::sources(truth.environment, means[means.len() / 2], gains)
    });
    let sources = LazyCell::new(|| of_lights(truth, &lights, &alphas));
    let sums = LazyCell::new(|| light::summed(truth.environment));
    let summed = LazyCell::new(|| of_lights(truth, &sums, &alphas));
    let of = |(k, (directions, found)): (usize, &(Directions, Vec<DVec3>))| {
        let (faces, alpha) = (&map.levels[k], alphas[k]);
        let scale = ("--scale", convention.scale);
        let lit = |kind: usize| if kind == 0 { &sources[..] } else { &summed[..] };
        let (kernel, sources, before) = (truth.kernel, &lit, &alphas[..k]);
        let own = Level {
            truth,
            kernel,
            sources,
            directions,
            found,
            alpha,
            before,
            scale,
            is_lost,
        };
        let mut score = own.score(true, |alpha| level_of(convention, alphas.len(), alpha));
        if let Some(before) = k.checked_sub(1).filter(|_| score.errors.relmse > GOOD)
            && is_mip(&map.levels[before], faces)
        {
            score.set(Cause {
                kind: "mips",
                words: "the mean of the level before it: plain mips".to_owned(),
            });
        }
        is_lost |= truth.is_other && has_width(alpha) && !score.is_explained();
        let is_read = k < read && has_width(alpha);
        score.between =
            is_read.then(|| between_texels(truth, map.layout, faces, convention, alpha));
        if let Some(relmse) = score.coarseness() {
            score.verdict = format!(
                "{GOOD_WORDS} at its texels, {:.1} % rms between them",
                100.0 * relmse.sqrt()
            );
        }
        score
    };
    Ok(sheets.iter().enumerate().map(of).collect())
}

/// Whether each texel is the mean of four texels of a level twice as large, as far as half floats
/// hold it.
fn is_mip(above: &[RgbImage], level: &[RgbImage]) -> bool {
    let is_near = |a: f32, b: f64| (f64::from(a) - b).abs() <= 0.01 * b.abs() + 1e-4;
    let is_mean = |above: &RgbImage, own: &RgbImage| {
        [above.width, above.height] == [2 * own.width, 2 * own.height] && {
            let means = above.area_means(own.width, own.height, |texel| texel.map(f64::from));
            own.data
                .iter()
                .flatten()
                .zip(means.data.iter().flatten())
                .all(|(own, mean)| is_near(*own, *mean))
        }
    };
    let is_black = level
        .iter()
        .flat_map(|face| &face.data)
        .all(|texel| *texel == [0.0; 3]);
    !is_black
        && above
            .iter()
            .zip(level)
            .all(|(above, own)| is_mean(above, own))
}

/// The truths of other lights by the same kernel.
fn of_lights<'l>(truth: &Truth, lights: &'l [Source], alphas: &[f64]) -> Vec<Lit<'l>> {
    lights
        .iter()
        .map(|light| light.lit(truth, alphas))
        .collect()
}

fn mean(directions: &Directions, texels: &[DVec3]) -> DVec3 {
    let sum: DVec3 = directions
        .weights
        .iter()
        .zip(texels)
        .map(|(weight, texel)| *weight * *texel)
        .sum();
    sum / directions.weights.iter().sum::<f64>()
}

impl Level<'_, '_> {
    /// Irradiance has no width to fit.
    fn score(&self, may_fit: bool, level_of: impl Fn(f64) -> Option<f64>) -> LevelScore {
        let Self {
            truth,
            directions,
            found,
            alpha,
            ..
        } = *self;
        let mut exact = exact(truth, self.kernel, directions, alpha);
        let off = |directions: &Directions, found: &[DVec3], exact: &[DVec3]| {
            errors(directions, found, exact, truth.epsilon(), 1.0)
        };
        let mut errors = off(directions, found, &exact);
        // Lookups of a level as fine as the environment give the environment back.
        if !has_width(alpha) && finer(truth.environment, directions) <= 1 {
            let looked_up: Vec<DVec3> = directions
                .world
                .iter()
                .map(|at| truth.environment.radiance(*at))
                .collect();
            let own = off(directions, found, &looked_up);
            if own.relmse < errors.relmse {
                (errors, exact) = (own, looked_up);
            }
        }
        let (size, verdict, worst) = (
            directions.size,
            GOOD_WORDS.to_owned(),
            worst(truth, directions, found, &exact),
        );
        let mut score = LevelScore {
            size,
            alpha,
            errors,
            worst,
            verdict,
            ..LevelScore::default()
        };
        if errors.relmse <= GOOD {
            if errors.bias_rel.abs() > GOOD_BIAS {
                let most = found
                    .iter()
                    .map(|texel| texel.max_element())
                    .fold(0.0, f64::max);
                let cut: Vec<DVec3> = exact
                    .iter()
                    .map(|texel| super::texel::CUTS[0].1(*texel, most))
                    .collect();
                let [own, cut] = [found, &cut].map(|texels| mean(directions, texels).element_sum());
                let is_cut = (own / cut - 1.0).abs() < light::SAME_MEAN;
                let how = if is_cut {
                    format!("cut at {}: ", light::rounded(most))
                } else {
                    String::new()
                };
                let kind = if is_cut { "cut" } else { "unknown" };
                score.set(Cause {
                    kind,
                    words: format!("{how}its mean is off by {:+.0} %", 100.0 * errors.bias_rel),
                });
            }
            return score;
        }
        // What is wrong besides black faces.
        let (black, seen) = faces::black(directions, found, &exact);
        let of_seen =
            |texels: &[DVec3]| seen.iter().map(|index| texels[*index]).collect::<Vec<_>>();
        let (directions, found, exact) = (
            &directions.only(&seen),
            &of_seen(found)[..],
            &of_seen(&exact)[..],
        );
        let own = Level {
            directions,
            found,
            ..*self
        };
        let relmse = off(directions, found, exact).relmse;
        let fitted = |is_narrow: bool| {
            let is_due = may_fit && relmse > GOOD && fit::is_narrow(alpha) == is_narrow;
            is_due
                .then(|| fit::fit(truth, directions, [found, exact], alpha))
                .flatten()
        };
        score.fit = fitted(false);
        score.slip = if relmse <= GOOD {
            Some(Slip {
                causes: Vec::new(),
                left: relmse / errors.relmse,
                relmse,
            })
        } else {
            own.slip(score.fit.map_or(f64::INFINITY, |fit| fit.left))
        };
        // A wide lobe explains much of what is wrong with a mirror.
        score.fit = score
            .fit
            .or_else(|| score.slip.is_none().then(|| fitted(true)).flatten());
        let one = |kind, words: &str| {
            vec![Cause {
                kind,
                words: words.to_owned(),
            }]
        };
        let rest = match (&score.slip, score.fit) {
            (Some(slip), _) => slip.causes.clone(),
            (None, Some(fit)) if fit.explains(relmse) => own.fitted(fit, level_of),
            _ if own.is_noisy(exact) => one("noise", "noise from texel to texel: too few samples"),
            _ => one("unknown", UNEXPLAINED),
        };
        score.causes = black.into_iter().chain(rest).collect();
        score.verdict = words(&score.causes);
        if let Some(slip) = &mut score.slip {
            slip.causes.clone_from(&score.causes);
        }
        score
    }

    /// Whether errors of neighbours in a row differ as if by chance: then half of their squares,
    /// else far less.
    fn is_noisy(&self, exact: &[DVec3]) -> bool {
        let (width, epsilon) = (self.directions.size[0] as usize, self.truth.epsilon());
        let error = |index: usize| {
            let scale = exact[index]
                .to_array()
                .map(|exact| epsilon.relative(1.0, exact).sqrt());
            (self.found[index] - exact[index]) * DVec3::from_array(scale)
        };
        let pairs = (1..exact.len())
            .filter(|index| index % width > 0)
            .map(|index| [error(index - 1), error(index)]);
        let [apart, whole] = pairs.fold([0.0; 2], |[apart, whole], [a, b]| {
            [
                apart + a.distance_squared(b),
                whole + a.length_squared() + b.length_squared(),
            ]
        });
        has_width(self.alpha) && apart > 0.5 * whole
    }

    fn fitted(&self, fit: Fit, level_of: impl Fn(f64) -> Option<f64>) -> Vec<Cause> {
        let alpha = self.alpha;
        let shift = level_of(fit.alpha)
            .zip(level_of(alpha))
            .map(|(found, own)| found - own);
        let widths = format!("alpha {:.3} for {alpha:.3}", fit.alpha);
        let width = match shift {
            Some(shift) if shift >= SHIFT => {
                Some(format!("{shift:.1} levels too blurred ({widths})"))
            }
            Some(shift) if shift <= -SHIFT => {
                Some(format!("{:.1} levels too sharp ({widths})", -shift))
            }
            None if fit.alpha > 1.1 * alpha => Some(format!("too blurred ({widths})")),
            None if fit.alpha < 0.9 * alpha => Some(format!("too sharp ({widths})")),
            _ => None,
        };
        let gain = ((fit.gain - 1.0).abs() >= 0.01).then(|| self.gain_in_words(fit.gain));
        let causes = [("width", width), ("gain", gain)].map(|(kind, words)| {
            Some(Cause {
                kind,
                words: words?,
            })
        });
        let causes: Vec<Cause> = causes.into_iter().flatten().collect();
        if causes.is_empty() {
            vec![Cause {
                kind: "small",
                words: "slightly off".to_owned(),
            }]
        } else {
            causes
        }
    }
}

/// Returns relMSE at four points per texel, looked up as a GPU does: linear, across the edges of
/// faces.
pub fn between_texels(
    truth: &Truth,
    layout: &'static MapLayout,
    faces: &[RgbImage],
    convention: &Convention,
    alpha: f64,
) -> f64 {
    let texel = |texel: [f32; 3]| convention.scale * DVec3::from_array(texel.map(f64::from));
    let level = FilteredMap {
        layout,
        levels: vec![faces.iter().map(|face| face.map(texel)).collect()],
    };
    let directions = Directions::new(
        layout,
        convention.axes,
        [2 * faces[0].width, 2 * faces[0].height],
    );
    let found = directions
        .world
        .par_iter()
        .map(|world| level.value(convention.axes.to_file(*world), 0.0));
    let exact = exact(truth, truth.kernel, &directions, alpha);
    errors(
        &directions,
        &found.collect::<Vec<_>>(),
        &exact,
        truth.epsilon(),
        1.0,
    )
    .relmse
}

pub fn score_irradiance(truth: &Truth, map: &Map, convention: &Convention) -> LevelScore {
    let (directions, found) = level_texels(
        map,
        &map.levels[0],
        convention.axes,
        convention.irradiance_scale,
    );
    let (kernel, alpha) = Truth::of_irradiance();
    // Irradiance alone does not tell a gain from a cut, so only usual gains are tried.
    let gains = [&[1.0], &fit::KNOWN[..]].concat();
    let lights =
        LazyCell::new(|| light::sources(truth.environment, mean(&directions, &found), &gains));
    let sources = LazyCell::new(|| of_lights(truth, &lights, &[]));
    let sums = LazyCell::new(|| light::summed(truth.environment));
    let summed = LazyCell::new(|| of_lights(truth, &sums, &[]));
    let scale = ("--irradiance-scale", convention.irradiance_scale);
    let lit = |kind: usize| if kind == 0 { &sources[..] } else { &summed[..] };
    let (sources, directions, found) = (&lit, &directions, &found);
    Level {
        truth,
        kernel,
        sources,
        directions,
        found,
        alpha,
        before: &[],
        scale,
        is_lost: false,
    }
    .score(false, |_| None)
}

fn level_texels(map: &Map, faces: &[RgbImage], axes: Axes, scale: f64) -> (Directions, Vec<DVec3>) {
    (
        Directions::new(map.layout, axes, [faces[0].width, faces[0].height]),
        texels(faces, scale),
    )
}

fn worst(truth: &Truth, directions: &Directions, found: &[DVec3], exact: &[DVec3]) -> Worst {
    let square = |i: usize| relative_square(found[i], exact[i], truth.epsilon());
    let i = (0..found.len())
        .max_by(|a, b| square(*a).total_cmp(&square(*b)))
        .expect("a level has texels");
    Worst {
        direction: directions.world[i],
        texel: directions.texel(i),
        found: found[i],
        exact: exact[i],
    }
}

/// Returns the fractional level of a width by the convention's mapping; `None` if widths are given
/// one by one.
fn level_of(convention: &Convention, count: usize, alpha: f64) -> Option<f64> {
    let by_mapping = convention.alphas.is_none() && count > 1;
    by_mapping.then(|| {
        convention
            .mapping
            .mip_from_alpha(alpha, convention.mapping_levels(count))
    })
}

/// Largest bias of a good level: a few bright texels carry much of the light, and little of relMSE.
const GOOD_BIAS: f64 = 0.03;
/// Smallest shift in levels that a verdict mentions.
const SHIFT: f64 = 0.05;

pub(super) const DOUBT: &str = "its axes or its light do not fit";
/// Start of the verdict of a part within [`GOOD`].
pub(super) const GOOD_WORDS: &str = "good";
pub(super) const UNEXPLAINED: &str = "no known slip explains it";

impl LevelScore {
    /// Returns relMSE between its good texels where it is not good: the level has few texels for
    /// its width.
    pub fn coarseness(&self) -> Option<f64> {
        self.between
            .filter(|relmse| self.causes.is_empty() && *relmse > GOOD)
    }

    /// Returns the relMSE that is left without the causes; `None` if they are unknown or there are
    /// none.
    pub fn left(&self) -> Option<f64> {
        let relmse = self.errors.relmse;
        let of_fit = || {
            self.fit
                .filter(|fit| fit.explains(relmse))
                .map(|fit| fit.left * relmse)
        };
        let own = self
            .slip
            .as_ref()
            .filter(|slip| slip.causes == self.causes)
            .map(|slip| slip.relmse);
        own.or_else(|| of_fit().filter(|_| !self.names("mips") && !self.causes.is_empty()))
    }

    /// Whether it is good, or a slip explains it. A fit alone does not, because it says nothing of
    /// the axes or the light.
    pub fn is_explained(&self) -> bool {
        self.errors.relmse <= GOOD
            || self.slip.is_some()
            || self.names("black") && !self.names("unknown")
    }

    pub fn names(&self, kind: &str) -> bool {
        self.causes.iter().any(|cause| cause.kind == kind)
    }

    /// Removes width and gain from the verdict because the axes or the light do not fit.
    pub fn doubt(&mut self) {
        if !self.is_explained() {
            self.set(Cause {
                kind: "unknown",
                words: DOUBT.to_owned(),
            });
        }
    }

    fn set(&mut self, cause: Cause) {
        (self.verdict, self.causes) = (cause.words.clone(), vec![cause]);
    }
}
