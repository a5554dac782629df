//! Names the slips that explain a level.
//!
//! Each known slip is put into the exact level, and the result is compared with the file. The slip
//! that comes nearest is named if it leaves at most `EXPLAINED` of the error, and at most `CLOSE`;
//! two slips, if one leaves the level wrong.

use super::light::{SAME_MEAN, UNCUT, exposed, rounded, solved};
use super::sample::{Level, Sample, Slipped};
use super::texel::{COLORS, COPIES, CURVES, CUTS, Change, ORDERS, PACKINGS, RGBM, TONES, rgbm};
use super::{Cause, EXPLAINED, GOOD, faces, fit, has_width};
use crate::instrument::precompute::prefilter::{Kernel, harmonic};
use glam::{DMat3, DQuat, DVec3};

#[derive(Clone, Debug, PartialEq)]
pub struct Slip {
    pub causes: Vec<Cause>,
    /// relMSE that remains, over the level's own and by itself.
    pub left: f64,
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
/// Smallest ratio of two channels' gains that is a slip.
const CHANNELS_APART: f64 = 1.02;

impl Level<'_, '_> {
    /// Describes a gain with the flag that fixes it.
    pub fn gain_in_words(&self, gain: f64) -> String {
        // Half vectors of density D n·h give l of density D/4 at n = v.
        let Kernel { brdf, .. } = self.kernel;
        let weight = |n_dot_l| self.kernel.weight(self.alpha, n_dot_l);
        let mean = if has_width(self.alpha) {
            0.25 * harmonic::integrals(brdf, self.alpha, 1, weight)[0]
        } else {
            1.0
        };
        if mean < UNCUT && (gain / mean - 1.0).abs() < SAME_MEAN {
            return "times the mean weight: divide by the sum of the weights, not by their number"
                .to_owned();
        }
        let ((flag, scale), (words, gain)) = (self.scale, fit::gain_in_words(gain));
        format!("{words}: {flag} {}", rounded(scale / gain))
    }

    /// Returns the slips that leave least, if they explain the level clearly better than its fit,
    /// which leaves a share.
    pub fn slip(&self, fit_left: f64) -> Option<Slip> {
        if self.found.iter().all(|texel| *texel == DVec3::ZERO) {
            let causes = vec![Cause {
                kind: "black",
                words: "every texel is black".to_owned(),
            }];
            return Some(Slip {
                causes,
                left: 0.0,
                relmse: 0.0,
            });
        }
        let sample = Sample::new(self);
        let right = Slipped {
            causes: Vec::new(),
            values: sample.right(&sample.directions, DQuat::IDENTITY),
        };
        let own = sample.off(&sample.found, &right.values);
        let (mut one, mut two): (Option<Slip>, Option<Slip>) = (None, None);
        let explains = |left: f64, most: f64| left <= EXPLAINED && left * own <= most;
        let left = |slip: &Option<Slip>| slip.as_ref().map_or(1.0, |slip| slip.left);
        // What takes longer is tried only if it is needed.
        for stage in 0..if self.is_lost { 1 } else { 4 } {
            let known = left(&one).min(left(&two)).min(fit_left);
            if explains(left(&one), ENOUGH)
                || fit_left * own <= SURE
                || stage == 3 && explains(known, GOOD)
            {
                break;
            }
            let bases = match stage {
                0 => vec![right.clone()],
                1 => [sample.kernels(), sample.grids(), sample.sources(0)].concat(),
                2 => [sample.turns(), sample.sources_by_others()].concat(),
                _ => sample.sources(1),
            };
            for (causes, off) in bases
                .into_iter()
                .flat_map(|base| sample.finished(sample.coded(base)))
            {
                let best = if causes.len() == 1 {
                    &mut one
                } else {
                    &mut two
                };
                if !causes.is_empty() && best.as_ref().is_none_or(|best| off / own < best.left) {
                    *best = Some(Slip {
                        causes,
                        left: off / own,
                        relmse: off,
                    });
                }
            }
        }
        let known = left(&one).min(fit_left);
        let two = two.filter(|slip| !explains(known, ENOUGH) && slip.left < BETTER * known);
        let best = two.or(one.filter(|slip| slip.left < 0.5 * fit_left))?;
        // For another map, a slip that flattens the level leaves a small part of a huge error.
        explains(best.left, CLOSE).then_some(best)
    }
}

impl Sample<'_, '_> {
    /// The same with another order of channels, another encoding, or both; at most two slips.
    fn coded(&self, base: Slipped) -> Vec<Slipped> {
        let order = |(words, change): &(&str, Change)| {
            base.with("channels", format!("channels in the order {words}"), change)
        };
        let orders: Vec<Slipped> = ORDERS.iter().map(order).collect();
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
            for (words, change) in CURVES.iter().chain(TONES).chain(PACKINGS) {
                all.push(base.with("encoding", (*words).to_owned(), change));
            }
            for &(range, exponent) in RGBM {
                let power = if exponent == 1.0 {
                    String::new()
                } else {
                    format!(" to the power of {exponent}")
                };
                let words = format!("RGBM read as linear: decode {range} alpha RGB{power}");
                all.push(base.with("encoding", words, |x| rgbm(x.powf(1.0 / exponent), range)));
            }
            all.push(base);
        }
        all
    }

    /// One channel in all, other primaries, and curves of the exposure that gives the level's mean.
    fn colors(&self, base: &Slipped) -> Vec<Slipped> {
        let copies = COPIES
            .iter()
            .map(|(words, change)| base.with("channels", (*words).to_owned(), change));
        let colors = COLORS.iter().flat_map(|(name, rows)| {
            let to = DMat3::from_cols_array_2d(rows).transpose();
            [("to", to), ("from", to.inverse())].map(|(way, matrix)| {
                base.with("colors", format!("converted {way} {name}"), |x| matrix * x)
            })
        });
        let tones = TONES.iter().map(|(words, curve)| {
            let of = |exposure: f64| {
                self.sum(
                    &base
                        .values
                        .iter()
                        .map(|x| curve(exposure * *x))
                        .collect::<Vec<_>>(),
                )
            };
            let exposure = solved([1e-3, 1e3], self.sum(&self.found), of);
            base.with("encoding", exposed(words, exposure), |x| {
                curve(exposure * x)
            })
        });
        copies.chain(colors).chain(tones).collect()
    }

    /// Adds a gain, gains by channel, a cut or moved faces to those with fewer than two slips.
    /// Returns what each leaves.
    fn finished(&self, coded: Vec<Slipped>) -> impl Iterator<Item = (Vec<Cause>, f64)> {
        let with_gain = |from: &Slipped, gain: f64| {
            from.with("gain", self.level.gain_in_words(gain), |x| gain * x)
        };
        let cut_words = format!("cut at {}", rounded(self.most));
        let most = self.most;
        coded.into_iter().flat_map(move |slipped| {
            let (mut all, mut by_faces) = (Vec::new(), Vec::new());
            if slipped.causes.len() < 2 {
                all.push(with_gain(&slipped, self.gain(&slipped.values)));
                // Beside an encoding they would fit too much.
                all.extend(
                    self.channel_gains(&slipped)
                        .filter(|_| slipped.causes.is_empty()),
                );
                // The gain of what is not cut.
                let uncut = |(found, _): &(&DVec3, &DVec3)| found.max_element() < UNCUT * most;
                let pairs = self.found.iter().zip(&slipped.values).filter(uncut);
                let [found, right] = pairs.fold([0.0; 2], |[a, b], (x, y)| {
                    [a + x.element_sum(), b + y.element_sum()]
                });
                let before = slipped
                    .causes
                    .is_empty()
                    .then(|| with_gain(&slipped, found / right.max(1e-12)));
                for from in [Some(&slipped), before.as_ref()].into_iter().flatten() {
                    all.extend(
                        CUTS.map(|(_, cut)| from.with("cut", cut_words.clone(), |x| cut(x, most))),
                    );
                }
                // Moved faces keep the mean.
                let gain = self.sum(&self.found) / self.sum(&slipped.values).max(1e-12);
                let gained = slipped.causes.is_empty().then(|| with_gain(&slipped, gain));
                for from in [Some(&slipped), gained.as_ref()].into_iter().flatten() {
                    let moved = faces::slip(
                        self.level.truth,
                        &self.directions,
                        &self.found,
                        &from.values,
                    );
                    by_faces.extend(
                        moved.map(|(cause, off)| ([&[cause], &from.causes[..]].concat(), off)),
                    );
                }
            }
            all.push(slipped);
            let off = |slipped: Slipped| {
                let off = self.off(&self.found, &slipped.values);
                (slipped.causes, off)
            };
            all.into_iter().map(off).chain(by_faces).collect::<Vec<_>>()
        })
    }

    fn channel_gains(&self, from: &Slipped) -> Option<Slipped> {
        let only = |texels: &[DVec3], axis: DVec3| {
            texels.iter().map(|texel| *texel * axis).collect::<Vec<_>>()
        };
        let gains = [DVec3::X, DVec3::Y, DVec3::Z].map(|axis| {
            let (found, right) = (only(&self.found, axis), only(&from.values, axis));
            let is_black = found.iter().all(|texel| *texel == DVec3::ZERO);
            if is_black {
                0.0
            } else {
                fit::gain(&self.directions, &found, &right, self.level.truth.epsilon())
            }
        });
        let [red, green, blue] = gains;
        let words = format!("red, green and blue times {red:.2}, {green:.2} and {blue:.2}");
        let gains = DVec3::from_array(gains);
        let is_uneven = gains.max_element() > CHANNELS_APART * gains.min_element();
        is_uneven.then(|| from.with("gain", words, |x| gains * x))
    }
}
