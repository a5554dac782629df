//! Names the slips that explain a level.
//!
//! Each known slip is put into the exact level, and the result is compared with the file. The slip
//! that comes nearest is named if it leaves at most `EXPLAINED` of the error, and at most `CLOSE`;
//! two slips, if one leaves the level wrong.

use super::cause::{Cause, CutSlip, Encoding, GainSlip, Mips};
use super::faces::FaceSlip;
use super::fit::Gain;
use super::light::{SAME_MEAN, UNCUT, solved_exposure};
use super::sample::{Level, Sample, Slipped};
use super::texel::{
    ChannelCopy, ChannelOrder, ColorConversion, Curve, Cut, Packing, Primaries, Rgbm, Tone,
};
use super::{EXPLAINED, GOOD, GOOD_BIAS, errors, faces, fit, has_width};
use crate::instrument::precompute::prefilter::{Kernel, harmonic};
use glam::{DQuat, DVec3};

/// The slips of a level, at most two besides black faces.
#[derive(Clone, Debug, PartialEq)]
pub struct Slip {
    pub causes: Vec<Cause>,
    /// relMSE that remains, over the level's.
    pub left: f64,
    /// relMSE that remains.
    pub relmse: f64,
}

/// Largest relMSE that a slip may leave: 10 % rms.
const CLOSE: f64 = 0.01;
/// relMSE above which a second slip is tried: 1 % rms.
const ENOUGH: f64 = 1e-4;
/// relMSE of a fit above which slips are tried that take longer: 0.1 % rms.
const SURE: f64 = 1e-6;
/// Largest share of one slip's rest that two may leave.
pub const BETTER: f64 = 0.3;
/// Largest share of a fit's rest that a slip may leave.
const BETTER_THAN_FIT: f64 = 0.5;
/// Largest share of a relMSE that the rounding of a file may leave, if it is named.
const ROUNDED: f64 = 0.8;
/// relMSE of values that the rounding changes enough to be named beside a larger rest: 1 % rms.
const ROUNDING_SHOWS: f64 = 1e-4;
/// Smallest ratio of two channels' gains that is a slip.
const CHANNELS_APART: f64 = 1.02;
/// Largest difference of the texels of a flat level, as a share.
const FLAT: f64 = 1e-3;
/// A face of one texel cannot vary within itself.
const FLAT_COUNT_MIN: usize = 6;
/// Smallest sum that a gain is taken of.
const SUM_MIN: f64 = 1e-12;

/// Slips of the whole level, in the order in which they are tried: the next stage takes longer.
#[derive(Clone, Copy, PartialEq)]
enum Stage {
    /// Only slips that change each texel by itself, and moved faces.
    Texels,
    Kernels,
    Turns,
    SummedSources,
    Level0,
}

const STAGES: [Stage; 5] = [
    Stage::Texels,
    Stage::Kernels,
    Stage::Turns,
    Stage::SummedSources,
    Stage::Level0,
];

impl Level<'_, '_> {
    /// Whether the level's mean is this multiple of the exact mean.
    pub fn has_mean(&self, gain: f64) -> bool {
        (self.mean_ratio / gain - 1.0).abs() <= GOOD_BIAS
    }

    /// Names a gain, and the factor of the file that it changes.
    pub fn gain_cause(&self, gain: f64) -> Cause {
        // Half vectors of density D n·h give l of density D/4 at n = v.
        let Kernel { brdf, .. } = self.kernel;
        let weight = |n_dot_l| self.kernel.weight(self.alpha, n_dot_l);
        let mean_weight = if has_width(self.alpha) {
            0.25 * harmonic::integrals(brdf, self.alpha, 1, weight)[0]
        } else {
            1.0
        };
        if mean_weight < UNCUT && (gain / mean_weight - 1.0).abs() < SAME_MEAN {
            return Cause::Gain(GainSlip::MeanWeight);
        }
        Cause::Gain(GainSlip::Level {
            gain: Gain::new(gain),
            scale: self.scale,
        })
    }

    /// Returns the slips that leave least, if they explain the level clearly better than its fit,
    /// which leaves a share.
    pub fn slip(&self, fit_left: f64) -> Option<Slip> {
        if self.found.iter().all(|texel| *texel == DVec3::ZERO) {
            return Some(Slip {
                causes: vec![Cause::Black],
                left: 0.0,
                relmse: 0.0,
            });
        }
        let sample = Sample::new(self);
        let right = Slipped {
            causes: Vec::new(),
            values: sample.right(&sample.directions, DQuat::IDENTITY),
        };
        if is_flat(self.found) && !is_flat(&right.values) {
            return Some(Slip {
                causes: vec![Cause::Flat],
                left: 0.0,
                relmse: 0.0,
            });
        }
        let relmse = sample.relmse(&right.values);
        let explains = |left: f64, most: f64| left <= EXPLAINED && left * relmse <= most;
        let mut best = BestSlips::default();
        let stages = if self.is_lost { &STAGES[..1] } else { &STAGES };
        for stage in stages {
            let known = best.one_left().min(best.two_left()).min(fit_left);
            if explains(best.one_left(), ENOUGH)
                || fit_left * relmse <= SURE
                || matches!(stage, Stage::SummedSources | Stage::Level0) && explains(known, GOOD)
            {
                break;
            }
            for base in sample.bases(*stage, &right) {
                for coded in sample.coded(base) {
                    best.add(sample.finished(coded), relmse);
                }
            }
        }
        let known = best.one_left().min(fit_left);
        let two = best
            .two
            .filter(|slip| !explains(known, ENOUGH) && slip.left < BETTER * known);
        let one = best
            .one
            .filter(|slip| slip.left < BETTER_THAN_FIT * fit_left);
        // For another map, a slip that flattens the level leaves a small part of a huge error.
        two.or(one).filter(|slip| explains(slip.left, CLOSE))
    }
}

/// Whether all texels have one value.
fn is_flat(texels: &[DVec3]) -> bool {
    let Some(first) = texels.first() else {
        return false;
    };
    let most = FLAT * first.max_element();
    texels.len() > FLAT_COUNT_MIN
        && texels
            .iter()
            .all(|texel| (*texel - *first).abs().max_element() <= most)
}

/// The slips that leave least of a level.
#[derive(Default)]
struct BestSlips {
    one: Option<Slip>,
    two: Option<Slip>,
}

impl BestSlips {
    fn one_left(&self) -> f64 {
        self.one.as_ref().map_or(1.0, |slip| slip.left)
    }

    fn two_left(&self) -> f64 {
        self.two.as_ref().map_or(1.0, |slip| slip.left)
    }

    /// Compares candidates for a level of this relMSE.
    fn add(&mut self, candidates: Vec<Candidate>, relmse: f64) {
        for candidate in candidates {
            let left = candidate.relmse / relmse;
            let best = match slip_count(&candidate.causes) {
                0 => continue,
                1 => &mut self.one,
                _ => &mut self.two,
            };
            if best.as_ref().is_none_or(|best| left < best.left) {
                *best = Some(Slip {
                    causes: candidate.causes,
                    left,
                    relmse: candidate.relmse,
                });
            }
        }
    }
}

/// Counts slips. A rounding of the whole file counts only if it is alone.
fn slip_count(causes: &[Cause]) -> usize {
    let others = causes.iter().filter(|cause| !cause.is_rounding()).count();
    others.max(usize::from(!causes.is_empty()))
}

/// Slips, and the relMSE that they leave.
struct Candidate {
    causes: Vec<Cause>,
    relmse: f64,
}

impl Sample<'_, '_> {
    /// Lists the level under each slip of a stage.
    fn bases(&self, stage: Stage, right: &Slipped) -> Vec<Slipped> {
        let lights = self.level.lights;
        match stage {
            Stage::Texels => vec![right.clone()],
            Stage::Kernels => {
                let sources = self.of_sources(&lights.changed);
                [self.kernels(right), self.grids(), sources].concat()
            }
            Stage::Turns => [self.turns(), self.likeliest_source_by_others()].concat(),
            Stage::SummedSources => self.of_sources(&lights.summed),
            Stage::Level0 if self.level.may_inherit => self.of_sources(&lights.level_0),
            Stage::Level0 => Vec::new(),
        }
    }

    /// Lists the same with another order of channels, another encoding, or both; at most two slips.
    fn coded(&self, base: Slipped) -> Vec<Slipped> {
        let orders =
            ChannelOrder::WRONG.map(|order| base.with(Cause::Channels(order), |x| order.apply(x)));
        let mut all: Vec<Slipped> = match base.causes.len() {
            0 => self.colors(&base),
            1 => Vec::new(),
            _ => vec![base.clone()],
        };
        for base in orders
            .into_iter()
            .chain([base])
            .filter(|base| base.causes.len() < 2)
        {
            all.extend(encoded(&base));
            all.push(base);
        }
        all
    }

    /// One channel in all, other primaries, and curves of the exposure that gives the level's mean.
    fn colors(&self, base: &Slipped) -> Vec<Slipped> {
        let copies = ChannelCopy::ALL.map(|copy| base.with(Cause::Copy(copy), |x| copy.apply(x)));
        let colors = Primaries::ALL.into_iter().flat_map(|primaries| {
            [
                ColorConversion::To(primaries),
                ColorConversion::From(primaries),
            ]
            .map(|conversion| {
                let matrix = conversion.matrix();
                base.with(Cause::Colors(conversion), |x| matrix * x)
            })
        });
        let tones = Tone::ALL.map(|tone| {
            let exposure = solved_exposure(self.sum(&self.found), |exposure| {
                let exposed = base.values.iter().map(|x| tone.apply(exposure * *x));
                self.sum(&exposed.collect::<Vec<_>>())
            });
            let cause = Cause::Encoding(Encoding::Tone { tone, exposure });
            base.with(cause, |x| tone.apply(exposure * x))
        });
        copies.into_iter().chain(colors).chain(tones).collect()
    }

    /// Adds a gain, gains by channel, a cut or moved faces to fewer than two slips, and compares
    /// each with the level.
    fn finished(&self, base: Slipped) -> Vec<Candidate> {
        if self.level.proven_cut.is_some() && self.needs_cut(&base) {
            return self
                .cuts(&base)
                .into_iter()
                .map(|slipped| self.candidate(slipped))
                .collect();
        }
        if base.causes.len() >= 2 {
            return vec![self.candidate(base)];
        }
        let gain = self.gain(&base.values);
        let mut all = Vec::new();
        if self.has_mean(&base, gain) {
            all.push(self.with_gain(&base, gain));
        }
        let is_first = base.causes.is_empty();
        // Beside an encoding they would fit too much.
        if is_first {
            all.extend(self.with_channel_gains(&base));
        }
        let gain_of_uncut = is_first.then(|| self.with_gain(&base, self.gain_of_uncut(&base)));
        for slipped in [Some(&base), gain_of_uncut.as_ref()].into_iter().flatten() {
            all.extend(self.cuts(slipped));
        }
        // Moved faces keep the mean.
        let gain_of_mean = is_first.then(|| {
            let gain = self.sum(&self.found) / self.sum(&base.values).max(SUM_MIN);
            self.with_gain(&base, gain)
        });
        let moved: Vec<Candidate> = [Some(&base), gain_of_mean.as_ref()]
            .into_iter()
            .flatten()
            .filter_map(|slipped| self.with_moved_faces(slipped))
            .collect();
        all.push(base);
        all.into_iter()
            .map(|slipped| self.candidate(slipped))
            .chain(moved)
            .collect()
    }

    /// Whether slips of a level that was cut do not say why. An encoding may end at the limit.
    fn needs_cut(&self, base: &Slipped) -> bool {
        let is_below = |value: &DVec3| value.max_element() <= self.most;
        let is_light = |cause: &Cause| cause.keeps_mean() || matches!(cause, Cause::Mips(_));
        !base.causes.iter().any(Cause::is_cut)
            && (base.causes.iter().all(is_light) || !base.values.iter().all(is_below))
    }

    /// Whether the mean of the whole level agrees with a gain beside slips that keep the mean. The
    /// gain of least relMSE alone follows the dark texels.
    fn has_mean(&self, base: &Slipped, gain: f64) -> bool {
        let keeps_mean = base.causes.iter().all(Cause::keeps_mean);
        let looks_up = base.causes == [Cause::Mips(Mips::OneLookup)];
        !(keeps_mean || looks_up) || self.level.has_mean(gain)
    }

    /// Compares the level with slipped values, and with what the file's rounding makes of them.
    fn candidate(&self, slipped: Slipped) -> Candidate {
        let relmse = self.relmse(&slipped.values);
        let mut causes = slipped.causes;
        if !self.level.truth.has_rounded_up_scale {
            return Candidate { relmse, causes };
        }
        let stored = self.stored(&slipped.values);
        let by_rounding = self.relmse(&stored);
        let epsilon = self.level.truth.epsilon();
        let change = errors(&self.directions, &stored, &slipped.values, epsilon, 1.0).relmse;
        let shows = change > ROUNDING_SHOWS && by_rounding < relmse;
        if shows || by_rounding < ROUNDED * relmse {
            causes.push(Cause::Encoding(Encoding::RgbpScaleRoundedUp));
        }
        Candidate {
            relmse: relmse.min(by_rounding),
            causes,
        }
    }

    fn with_gain(&self, base: &Slipped, gain: f64) -> Slipped {
        base.with(self.level.gain_cause(gain), |x| gain * x)
    }

    /// Returns the gain of the texels that are not cut.
    fn gain_of_uncut(&self, base: &Slipped) -> f64 {
        let mut found_sum = 0.0;
        let mut right_sum = 0.0;
        for (found, right) in self.found.iter().zip(&base.values) {
            if found.max_element() < UNCUT * self.most {
                found_sum += found.element_sum();
                right_sum += right.element_sum();
            }
        }
        found_sum / right_sum.max(SUM_MIN)
    }

    fn cuts(&self, base: &Slipped) -> [Slipped; 3] {
        let limit = self.most;
        Cut::ALL.map(|cut| {
            // The table of levels has the bias; without it levels share a line.
            let slip = CutSlip {
                limit,
                bias_rel: None,
            };
            base.with(Cause::Cut(slip), |x| cut.apply(x, limit))
        })
    }

    fn with_moved_faces(&self, base: &Slipped) -> Option<Candidate> {
        let truth = self.level.truth;
        let (slip, relmse): (FaceSlip, f64) =
            faces::slip(truth, &self.directions, &self.found, &base.values)?;
        Some(Candidate {
            causes: [&[Cause::Faces(slip)], &base.causes[..]].concat(),
            relmse,
        })
    }

    /// Applies the best gain to each channel; `None` if they are alike.
    fn with_channel_gains(&self, base: &Slipped) -> Option<Slipped> {
        let gains = DVec3::from_array(DVec3::AXES.map(|axis| {
            let found: Vec<DVec3> = self.found.iter().map(|texel| *texel * axis).collect();
            let right: Vec<DVec3> = base.values.iter().map(|texel| *texel * axis).collect();
            if found.iter().all(|texel| *texel == DVec3::ZERO) {
                return 0.0;
            }
            let epsilon = self.level.truth.epsilon();
            fit::gain(&self.directions, &found, &right, epsilon)
        }));
        let is_uneven = gains.max_element() > CHANNELS_APART * gains.min_element();
        let cause = Cause::Gain(GainSlip::Channels(gains));
        is_uneven.then(|| base.with(cause, |x| gains * x))
    }
}

/// Lists encodings of the values.
fn encoded(base: &Slipped) -> Vec<Slipped> {
    let curves = Curve::ALL.map(|curve| {
        let cause = Cause::Encoding(Encoding::Curve(curve));
        base.with(cause, |x| x.map(|x| curve.apply(x)))
    });
    let tones = Tone::ALL.map(|tone| {
        let exposure = 1.0;
        let cause = Cause::Encoding(Encoding::Tone { tone, exposure });
        base.with(cause, |x| tone.apply(x))
    });
    let packings = Packing::ALL.map(|packing| {
        let cause = Cause::Encoding(Encoding::Packing(packing));
        base.with(cause, |x| packing.apply(x))
    });
    let rgbm = Rgbm::ALL.map(|rgbm| {
        let cause = Cause::Encoding(Encoding::Rgbm(rgbm));
        base.with(cause, |x| rgbm.apply(x))
    });
    curves
        .into_iter()
        .chain(tones)
        .chain(packings)
        .chain(rgbm)
        .collect()
}
