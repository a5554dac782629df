//! The score of a level: errors, the worst direction, and a likely cause.

use super::cause::{Mips, Scale, ScaleFlag, Unknown, WidthSlip};
use super::directions::{Directions, texels};
use super::exact::{between_texels, exact_of, finer, prefiltered};
use super::faces::BlackFaces;
use super::fit::{self, Fit, KnownFactor, picked};
use super::light::{self, OtherLights};
use super::negative::NegativeTexels;
use super::sample::{self, Level};
use super::slip::Slip;
use super::verdict::{Quality, Verdict};
use super::{Cause, Errors, GOOD, Truth, errors, has_width, relative_square};
use crate::bake::convention::{Axes, Convention};
use crate::bake::parts::Map;
use crate::base::pixels::RgbImage;
use glam::DVec3;
use std::cell::LazyCell;

/// Largest bias of a good level: a few bright texels carry much of the light, and little of relMSE.
pub const GOOD_BIAS: f64 = 0.03;
/// Smallest shift in levels that a verdict mentions.
const SHIFT: f64 = 0.05;
/// Ratios of widths that a verdict mentions, if it is not a shift in levels.
const WIDTH_BLURRED: f64 = 1.1;
const WIDTH_SHARP: f64 = 0.9;
/// Smallest relative gain that a verdict mentions.
const GAIN_APART: f64 = 0.01;

/// The direction of a level's largest relative error.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Worst {
    /// In the world.
    pub direction: DVec3,
    /// Face, column and row.
    pub texel: [usize; 3],
    /// Radiance of the bake and of the integral.
    pub found: DVec3,
    pub exact: DVec3,
}

/// The score of a level, or of an irradiance map.
#[derive(Clone, Debug, Default)]
pub struct LevelScore {
    pub size: [u32; 2],
    pub alpha: f64,
    pub errors: Errors,
    /// relMSE of lookups between texels; `None` for a mirror level, a level that the engine does
    /// not read and irradiance.
    pub between: Option<f64>,
    pub worst: Worst,
    pub negative: Option<NegativeTexels>,
    /// Set if relMSE is above [`GOOD`].
    pub fit: Option<Fit>,
    /// Slip that explains the error, if the fit does not.
    pub slip: Option<Slip>,
    pub verdict: Verdict,
}

/// A level of a map as radiance.
struct Sheet {
    directions: Directions,
    found: Vec<DVec3>,
}

impl Sheet {
    fn new(map: &Map, level: usize, axes: Axes, scale: f64) -> Self {
        let faces = &map.levels[level];
        let size = [faces[0].width, faces[0].height];
        Self {
            directions: Directions::new(map.layout, axes, size),
            found: texels(faces, scale),
        }
    }

    fn mean(&self) -> DVec3 {
        self.directions.mean(&self.found)
    }
}

/// Scores the levels of a prefiltered map, finest first.
pub fn score(truth: &Truth, map: &Map, convention: &Convention) -> Result<Vec<LevelScore>, String> {
    let alphas = convention.alphas(map.levels.len())?;
    let read_count = convention.mapping_levels(map.levels.len()) as usize;
    let sheets: Vec<Sheet> = (0..map.levels.len())
        .map(|level| Sheet::new(map, level, convention.axes, convention.scale))
        .collect();
    let changed = LazyCell::new(|| changed_sources(truth, &sheets, &alphas));
    let summed = LazyCell::new(|| light::summed(truth.environment));
    let level_0 = LazyCell::new(|| {
        light::of_level_0(truth.environment, map.layout, &map.levels[0], convention)
    });
    let lights = OtherLights::new(truth, &alphas, &changed, &summed, &level_0);
    // Of a map of another light, one unexplained level ends the long searches.
    let mut is_lost = false;
    let mut scores: Vec<LevelScore> = Vec::new();
    for (k, sheet) in sheets.iter().enumerate() {
        let faces = &map.levels[k];
        let alpha = alphas[k];
        let exact_map = prefiltered(truth, truth.kernel, alpha);
        let level = Level {
            truth,
            kernel: truth.kernel,
            map: exact_map.as_ref(),
            lights: &lights,
            directions: &sheet.directions,
            found: &sheet.found,
            alpha,
            alphas_before: &alphas[..k],
            scale: Scale {
                flag: ScaleFlag::Radiance,
                value: convention.scale,
            },
            mean_ratio: 1.0,
            proven_cut: None,
            may_inherit: scores.first().is_some_and(LevelScore::hands_on),
            is_lost,
        };
        let mut score = level.score(true, |alpha| level_of(convention, alphas.len(), alpha));
        if k > 0 && score.errors.relmse > GOOD && is_mip(&map.levels[k - 1], faces) {
            score.verdict = Verdict::from_causes(vec![Cause::Mips(Mips::OfLevelBefore)]);
        }
        is_lost |= truth.is_other && has_width(alpha) && !score.is_explained();
        if let Some(exact_map) = exact_map.as_ref().filter(|_| k < read_count) {
            let relmse = between_texels(truth, map.layout, faces, convention, exact_map);
            score.between = Some(relmse);
        }
        if let Some(between) = score.coarseness() {
            score.verdict = Verdict::Good(Quality::CoarseMap { between });
        }
        scores.push(score);
    }
    withdraw_gains(&mut scores);
    Ok(scores)
}

/// Withdraws gains of single levels of a map whose other levels were cut: `--scale` applies to every
/// level, and the cut, not a gain, is what is wrong with the light.
fn withdraw_gains(scores: &mut [LevelScore]) {
    if !scores.iter().any(|score| score.has(Cause::is_cut)) {
        return;
    }
    for score in scores.iter_mut().filter(|score| !score.has(Cause::is_cut)) {
        if score.has(Cause::is_unknown_gain) {
            score.slip = None;
            score.verdict = Verdict::from_causes(vec![Cause::Unknown(Unknown::NoSlip)]);
        }
    }
}

/// Lists the sources with the mean of a map, or with its mean over the gain of its finest level.
fn changed_sources(truth: &Truth, sheets: &[Sheet], alphas: &[f64]) -> Vec<light::Source> {
    // One level may be wrong by itself, so the middle mean counts.
    let mut means: Vec<DVec3> = sheets.iter().map(Sheet::mean).collect();
    means.sort_by(|a, b| a.element_sum().total_cmp(&b.element_sum()));
    let mean = means[means.len() / 2];
    let gain = sample::usual_gain(truth, &sheets[0].directions, &sheets[0].found, alphas[0]);
    if (gain - 1.0).abs() > light::SAME_MEAN {
        light::sources(truth.environment, mean, &[1.0, gain])
    } else {
        light::sources(truth.environment, mean, &[1.0])
    }
}

/// Whether each texel is the mean of four texels of a level twice as large, as far as half floats
/// hold it.
fn is_mip(above: &[RgbImage], level: &[RgbImage]) -> bool {
    let is_black = level
        .iter()
        .flat_map(|face| &face.data)
        .all(|texel| *texel == [0.0; 3]);
    let mut faces = above.iter().zip(level);
    !is_black && faces.all(|(above, face)| is_mip_face(above, face))
}

fn is_mip_face(above: &RgbImage, face: &RgbImage) -> bool {
    if [above.width, above.height] != [2 * face.width, 2 * face.height] {
        return false;
    }
    let means = above.area_means(face.width, face.height, |texel| texel.map(f64::from));
    face.data
        .iter()
        .flatten()
        .zip(means.data.iter().flatten())
        .all(|(found, mean)| (f64::from(*found) - mean).abs() <= 0.01 * mean.abs() + 1e-4)
}

impl Level<'_, '_> {
    /// Scores the level, and names its slips if it is not good. Irradiance has no width to fit.
    fn score(&self, may_fit: bool, level_of: impl Fn(f64) -> Option<f64>) -> LevelScore {
        let (exact, errors) = self.exact_and_errors();
        let mut score = LevelScore {
            size: self.directions.size,
            alpha: self.alpha,
            errors,
            worst: self.worst(&exact),
            negative: NegativeTexels::of(self.directions, self.found),
            ..LevelScore::default()
        };
        if errors.relmse > GOOD || errors.relmse.is_nan() {
            self.explain(&mut score, &exact, may_fit, level_of);
            let is_vague = |cause: &Cause| cause.is_unknown() || *cause == Cause::Noise;
            if let Some(texels) = score.negative.filter(|texels| texels.is_large)
                && score.has(is_vague)
            {
                let causes = score.verdict.causes().iter().cloned();
                score.verdict = Verdict::from_causes(
                    [Cause::Negative(texels)]
                        .into_iter()
                        .chain(causes)
                        .collect(),
                );
            }
        } else if errors.bias_rel.abs() > GOOD_BIAS {
            score.verdict = Verdict::from_causes(vec![self.bias_cause(&exact, errors.bias_rel)]);
        } else if let Some(texels) = score.negative.filter(|texels| texels.is_large) {
            score.verdict = Verdict::from_causes(vec![Cause::Negative(texels)]);
        }
        score
    }

    fn errors(&self, exact: &[DVec3]) -> Errors {
        errors(
            self.directions,
            self.found,
            exact,
            self.truth.epsilon(),
            1.0,
        )
    }

    /// Returns the right texels; for a mirror, means or lookups, whichever are nearer.
    fn exact_and_errors(&self) -> (Vec<DVec3>, Errors) {
        let environment = self.truth.environment;
        let exact = exact_of(self.map, environment, self.directions);
        let errors = self.errors(&exact);
        // Lookups of a level as fine as the environment give the environment back.
        if !has_width(self.alpha) && finer(environment, self.directions) <= 1 {
            let world = self.directions.world.iter();
            let looked_up: Vec<DVec3> = world.map(|world| environment.radiance(*world)).collect();
            let errors_of_lookups = self.errors(&looked_up);
            if errors_of_lookups.relmse < errors.relmse {
                return (looked_up, errors_of_lookups);
            }
        }
        (exact, errors)
    }

    /// Finds black faces, and a fit or slips of the others.
    fn explain(
        &self,
        score: &mut LevelScore,
        exact: &[DVec3],
        may_fit: bool,
        level_of: impl Fn(f64) -> Option<f64>,
    ) {
        let black = BlackFaces::new(self.directions, self.found, exact);
        let rest = Level {
            directions: &self.directions.only(&black.other_texels),
            found: &picked(self.found, &black.other_texels),
            ..*self
        };
        let exact = picked(exact, &black.other_texels);
        let Errors { relmse, bias_rel } = rest.errors(&exact);
        let rest = Level {
            mean_ratio: 1.0 + bias_rel,
            proven_cut: rest.proven_cut(&exact, bias_rel),
            ..rest
        };
        let is_narrow = fit::is_narrow(self.alpha);
        // The width of a fit would explain a cut.
        let may_fit = may_fit && relmse > GOOD && rest.proven_cut.is_none();
        if may_fit && !is_narrow {
            score.fit = rest.fit(&exact);
        }
        score.slip = if relmse <= GOOD {
            Some(Slip {
                causes: Vec::new(),
                left: relmse / score.errors.relmse,
                relmse,
            })
        } else {
            rest.slip(score.fit.map_or(f64::INFINITY, |fit| fit.left))
        };
        // A wide lobe explains much of what is wrong with a mirror.
        if may_fit && is_narrow && score.slip.is_none() {
            score.fit = rest.fit(&exact);
        }
        let causes = match (&score.slip, score.fit) {
            (Some(slip), _) => slip.causes.clone(),
            (None, Some(fit)) if fit.explains(relmse) => rest.fit_causes(fit, level_of),
            _ if rest.proven_cut.is_some() => rest
                .proven_cut
                .map(Cause::Cut)
                .into_iter()
                .chain([Cause::Unknown(Unknown::NoSlip)])
                .collect(),
            _ if rest.is_noisy(&exact) => vec![Cause::Noise],
            _ => vec![Cause::Unknown(Unknown::NoSlip)],
        };
        let black = (!black.faces.is_empty()).then_some(Cause::BlackFaces(black.faces));
        let causes: Vec<Cause> = black.into_iter().chain(causes).collect();
        if let Some(slip) = &mut score.slip {
            slip.causes.clone_from(&causes);
        }
        score.verdict = Verdict::from_causes(causes);
    }

    fn fit(&self, exact: &[DVec3]) -> Option<Fit> {
        fit::fit(self.truth, self.directions, self.found, exact, self.alpha)
    }

    /// Whether errors of neighbours in a row differ as if by chance: then half of their squares,
    /// else far less.
    fn is_noisy(&self, exact: &[DVec3]) -> bool {
        let width = self.directions.size[0] as usize;
        let epsilon = self.truth.epsilon();
        let error = |index: usize| {
            let scale = exact[index]
                .to_array()
                .map(|exact| epsilon.relative(1.0, exact).sqrt());
            (self.found[index] - exact[index]) * DVec3::from_array(scale)
        };
        let mut apart = 0.0;
        let mut whole = 0.0;
        for index in (1..exact.len()).filter(|index| index % width > 0) {
            let left = error(index - 1);
            let right = error(index);
            apart += left.distance_squared(right);
            whole += left.length_squared() + right.length_squared();
        }
        has_width(self.alpha) && apart > 0.5 * whole
    }

    /// Names the width and the gain of a fit that explains the level.
    fn fit_causes(&self, fit: Fit, level_of: impl Fn(f64) -> Option<f64>) -> Vec<Cause> {
        let shift = level_of(fit.alpha)
            .zip(level_of(self.alpha))
            .map(|(found, expected)| found - expected);
        let has_other_width = match shift {
            Some(shift) => shift.abs() >= SHIFT,
            None => fit.alpha > WIDTH_BLURRED * self.alpha || fit.alpha < WIDTH_SHARP * self.alpha,
        };
        let width = has_other_width.then_some(Cause::Width(WidthSlip {
            found_alpha: fit.alpha,
            alpha: self.alpha,
            shift,
        }));
        // A convolution keeps the mean, so the mean shows whether there is a gain.
        let has_gain = (fit.gain - 1.0).abs() >= GAIN_APART && self.has_mean(fit.gain);
        let gain = has_gain.then(|| self.gain_cause(fit.gain));
        if width.is_none() && gain.is_none() {
            return vec![Cause::SlightlyOff];
        }
        width.into_iter().chain(gain).collect()
    }

    fn worst(&self, exact: &[DVec3]) -> Worst {
        let epsilon = self.truth.epsilon();
        let square = |index: usize| relative_square(self.found[index], exact[index], epsilon);
        let index = (0..self.found.len())
            .max_by(|a, b| square(*a).total_cmp(&square(*b)))
            .expect("a level has texels");
        Worst {
            direction: self.directions.world[index],
            texel: self.directions.texel(index),
            found: self.found[index],
            exact: exact[index],
        }
    }
}

/// Scores an irradiance map of one level.
pub fn score_irradiance(truth: &Truth, map: &Map, convention: &Convention) -> LevelScore {
    let sheet = Sheet::new(map, 0, convention.axes, convention.irradiance_scale);
    let (kernel, alpha) = Truth::of_irradiance();
    let changed = LazyCell::new(|| {
        // Irradiance alone does not distinguish a gain from a cut, so only usual gains are tried.
        let known = KnownFactor::ALL.map(KnownFactor::value);
        let gains = [&[1.0], &known[..]].concat();
        light::sources(truth.environment, sheet.mean(), &gains)
    });
    let summed = LazyCell::new(|| light::summed(truth.environment));
    let level_0 = LazyCell::new(Vec::new);
    let exact_map = truth.prefiltered_by(kernel, alpha);
    let level = Level {
        truth,
        kernel,
        map: Some(&exact_map),
        lights: &OtherLights::new(truth, &[], &changed, &summed, &level_0),
        directions: &sheet.directions,
        found: &sheet.found,
        alpha,
        alphas_before: &[],
        scale: Scale {
            flag: ScaleFlag::Irradiance,
            value: convention.irradiance_scale,
        },
        mean_ratio: 1.0,
        proven_cut: None,
        may_inherit: false,
        is_lost: false,
    };
    level.score(false, |_| None)
}

/// Returns the fractional level of a width by the convention's mapping; `None` if widths are given
/// one by one.
fn level_of(convention: &Convention, count: usize, alpha: f64) -> Option<f64> {
    let has_mapping = convention.has_mapping() && count > 1;
    has_mapping.then(|| {
        convention
            .mapping
            .mip_from_alpha(alpha, convention.mapping_levels(count))
    })
}

impl LevelScore {
    /// Returns relMSE between its good texels where it is not good: the level has few texels for
    /// its width.
    pub fn coarseness(&self) -> Option<f64> {
        self.between
            .filter(|relmse| self.verdict.is_good() && *relmse > GOOD)
    }

    /// Returns the relMSE that is left without the causes; `None` if they are unknown or there are
    /// none.
    pub fn left(&self) -> Option<f64> {
        if let Some(slip) = &self.slip
            && slip.causes == self.verdict.causes()
        {
            return Some(slip.relmse);
        }
        if self.verdict.is_good() || self.has(Cause::is_mips) {
            return None;
        }
        let relmse = self.errors.relmse;
        self.fit
            .filter(|fit| fit.explains(relmse))
            .map(|fit| fit.left * relmse)
    }

    /// Whether it is good, or a slip explains it. A fit alone does not, because it says nothing of
    /// the axes or the light.
    pub fn is_explained(&self) -> bool {
        self.errors.relmse <= GOOD
            || self.slip.is_some()
            || self.has(Cause::is_black) && !self.has(Cause::is_unknown)
    }

    /// Whether levels that are filtered from this one inherit a slip of its texels. The light of
    /// another map would explain such levels as well, so the slip must be known.
    fn hands_on(&self) -> bool {
        let is_of_texels = |cause: &Cause| {
            matches!(
                cause,
                Cause::Grid(_)
                    | Cause::Cut(_)
                    | Cause::Mips(Mips::OneLookup | Mips::OneLookupRounded)
            )
        };
        self.slip.is_some() && self.has(is_of_texels)
    }

    /// Whether the verdict names such a cause.
    pub fn has(&self, is_such: impl Fn(&Cause) -> bool) -> bool {
        self.verdict.causes().iter().any(is_such)
    }

    /// Removes width and gain from the verdict because the axes or the light do not fit.
    pub fn doubt(&mut self) {
        if !self.is_explained() {
            self.verdict = Verdict::from_causes(vec![Cause::Unknown(Unknown::Doubt)]);
        }
    }
}
