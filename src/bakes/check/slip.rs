//! Names the slips that explain a level.
//!
//! Each known slip is put into the exact level, and the result is compared with the file. The slip that comes nearest is
//! named if it leaves at most `EXPLAINED` of the error, and at most `CLOSE`; two slips, if one leaves the level wrong.

use super::directions::Directions;
use super::exact::{exact, mirror};
use super::light::{SAME_MEAN, UNCUT, rounded, without_solid_angles};
use super::texel::{COPIES, CURVES, CUTS, Change, ORDERS, PACKINGS, RGBM, rgbm};
use super::{Cause, EXPLAINED, Truth, errors, faces, fit, has_width};
use crate::brdf::MODELS;
use crate::environment::Environment;
use crate::precompute::prefilter::{Kernel, WEIGHTS, harmonic};
use glam::{DQuat, DVec3};

#[derive(Clone, Debug, PartialEq)]
pub struct Slip {
    pub causes: Vec<Cause>,
    /// relMSE that remains, over the level's own and by itself.
    pub left: f64,
    pub relmse: f64,
}

impl Slip {
    pub fn one(kind: &'static str, words: String, [left, relmse]: [f64; 2]) -> Self {
        Self { causes: vec![Cause { kind, words }], left, relmse }
    }
}

/// Approximate number of texels that are compared.
const TEXELS: usize = 864;
/// Largest relMSE that a slip may leave: 10 % rms.
const CLOSE: f64 = 0.01;
/// relMSE above which a second slip is tried: 1 % rms.
const ENOUGH: f64 = 1e-4;
/// relMSE of a fit above which slips are tried that take longer: 0.1 % rms.
const SURE: f64 = 1e-6;
/// Largest share of one slip's rest that two may leave.
pub const BETTER: f64 = 0.3;
/// Step of the turns about y that are tried, degrees, and the bisections around the best.
const TURN_STEP: f64 = 5.0;
const TURNS_REFINED: u32 = 8;
/// Points per side of a mirror level's texel.
const MIRROR_POINTS: u32 = 3;
/// Smallest ratio of two channels' gains that is a slip.
const CHANNELS_APART: f64 = 1.02;
/// Smallest turn that is a slip, degrees.
const TURN_MIN: f64 = 0.5;

/// Returns the median ratio of a level and its integral: a gain, if only lamps were cut.
pub fn usual_gain(truth: &Truth, directions: &Directions, found: &[DVec3], alpha: f64) -> f64 {
    let chosen = directions.grid(TEXELS);
    let right = exact(truth, truth.kernel, &directions.only(&chosen), alpha);
    let ratio = |(index, right): (&usize, &DVec3)| found[*index].element_sum() / right.element_sum().max(1e-12);
    let mut ratios: Vec<f64> = chosen.iter().zip(&right).map(ratio).collect();
    ratios.sort_by(f64::total_cmp);
    ratios[ratios.len() / 2].max(1e-12)
}

/// A level as its file has it.
#[derive(Clone, Copy)]
pub struct Level<'t, 'd> {
    pub truth: &'t Truth<'t>,
    pub kernel: Kernel,
    /// Returns truths of other sources with the same mean.
    pub sources: &'t dyn Fn() -> &'t [(Cause, Truth<'t>)],
    pub directions: &'d Directions,
    pub found: &'d [DVec3],
    pub alpha: f64,
    /// The flag that scales the file, and its value.
    pub scale: (&'static str, f64),
}

/// Values that a file with some slips would have.
#[derive(Clone)]
struct Slipped {
    causes: Vec<Cause>,
    values: Vec<DVec3>,
}

impl Slipped {
    fn one(kind: &'static str, words: String, values: Vec<DVec3>) -> Self {
        Self { causes: vec![Cause { kind, words }], values }
    }

    fn with(&self, kind: &'static str, words: String, change: impl Fn(DVec3) -> DVec3) -> Self {
        let cause = Cause { kind, words };
        let causes = self.causes.iter().cloned().chain([cause]).collect();
        Self { causes, values: self.values.iter().map(|x| change(*x)).collect() }
    }
}

impl Level<'_, '_> {
    /// Describes a gain with the flag that fixes it.
    pub fn gain_in_words(&self, gain: f64) -> String {
        // Half vectors of density D n·h give l of density D/4 at n = v.
        let Kernel { brdf, .. } = self.kernel;
        let weight = |n_dot_l| self.kernel.weight(self.alpha, n_dot_l);
        let mean = if has_width(self.alpha) { 0.25 * harmonic::integrals(brdf, self.alpha, 1, weight)[0] } else { 1.0 };
        if mean < UNCUT && (gain / mean - 1.0).abs() < SAME_MEAN {
            return "times the mean weight: divide by the sum of the weights, not by their number".to_owned();
        }
        let ((flag, scale), (words, gain)) = (self.scale, fit::gain_in_words(gain));
        format!("{words}: {flag} {}", rounded(scale / gain))
    }

    /// Returns the slips that leave least, if they explain the level clearly better than its fit, which leaves a share.
    pub fn slip(&self, fit_left: f64) -> Option<Slip> {
        if self.found.iter().all(|texel| *texel == DVec3::ZERO) {
            return Some(Slip::one("black", "every texel is black".to_owned(), [0.0; 2]));
        }
        let sample = Sample::new(self);
        // Without error there is nothing to explain.
        let right = Slipped { causes: Vec::new(), values: sample.of(self.truth, self.kernel) };
        let own = sample.off(&sample.found, &right.values);
        let (mut one, mut two): (Option<Slip>, Option<Slip>) = (None, None);
        let is_enough = |left: f64| left <= EXPLAINED && left * own <= ENOUGH;
        let left = |slip: &Option<Slip>| slip.as_ref().map_or(1.0, |slip| slip.left);
        // What takes longer is tried only if it is needed.
        for stage in 0..3 {
            if is_enough(left(&one)) || fit_left * own <= SURE {
                break;
            }
            let bases = match stage {
                0 => vec![right.clone()],
                1 => [sample.kernels(), sample.sources()].concat(),
                _ => sample.turn().into_iter().chain(sample.sources_by_others()).collect(),
            };
            for (causes, off) in bases.into_iter().flat_map(|base| sample.finished(sample.coded(base))) {
                let best = if causes.len() == 1 { &mut one } else { &mut two };
                if !causes.is_empty() && best.as_ref().is_none_or(|best| off / own < best.left) {
                    *best = Some(Slip { causes, left: off / own, relmse: off });
                }
            }
        }
        let known = left(&one).min(fit_left);
        let two = two.filter(|slip| !is_enough(known) && slip.left < BETTER * known);
        let best = two.or(one.filter(|slip| slip.left < 0.5 * fit_left))?;
        // For another map, a slip that flattens the level leaves a small part of a huge error.
        (best.left <= EXPLAINED && best.left * own <= CLOSE).then_some(best)
    }
}

struct Sample<'a, 't> {
    level: &'a Level<'t, 'a>,
    directions: Directions,
    found: Vec<DVec3>,
    /// Largest value of the level.
    most: f64,
}

impl<'a, 't> Sample<'a, 't> {
    fn new(level: &'a Level<'t, 'a>) -> Self {
        let chosen = level.directions.grid(TEXELS);
        let found = chosen.iter().map(|index| level.found[*index]).collect();
        let most = level.found.iter().map(|texel| texel.max_element()).fold(0.0, f64::max);
        Self { level, directions: level.directions.only(&chosen), found, most }
    }

    /// The right texels by a light and a kernel.
    fn of(&self, truth: &Truth, kernel: Kernel) -> Vec<DVec3> {
        exact(truth, kernel, &self.directions, self.level.alpha)
    }

    fn off(&self, found: &[DVec3], slipped: &[DVec3]) -> f64 {
        errors(&self.directions, found, slipped, self.level.truth.epsilon(), 1.0).relmse
    }

    fn is_irradiance(&self) -> bool {
        self.level.kernel.brdf.name() != self.level.truth.kernel.brdf.name()
    }

    /// Other weights and models; for irradiance, the mean over the hemisphere.
    fn other_kernels(&self) -> Vec<(Cause, Kernel)> {
        let Kernel { brdf, weight, masking } = self.level.kernel;
        if !has_width(self.level.alpha) {
            return Vec::new();
        }
        let is_irradiance = self.is_irradiance();
        let others = WEIGHTS.iter().filter(|other| other.name != weight.name);
        let weights = others.filter(|other| !is_irradiance || other.name == "none").map(|other| {
            let words = format!("weighted otherwise: --weight {}", other.name);
            let words = if is_irradiance { "not weighted by the cosine".to_owned() } else { words };
            (Cause { kind: "weight", words }, Kernel::new(brdf, other, masking))
        });
        let models = MODELS.iter().filter(|other| !is_irradiance && other.name() != brdf.name()).map(|other| {
            let words = format!("of another model: --brdf {}", other.name());
            (Cause { kind: "model", words }, Kernel::new(*other, weight, masking))
        });
        weights.chain(models).collect()
    }

    /// Levels by another kernel, and the map itself at the level's size.
    fn kernels(&self) -> Vec<Slipped> {
        if self.is_irradiance() {
            return [self.by_other_kernels(), self.without_solid_angles()].concat();
        }
        if !has_width(self.level.alpha) {
            return Vec::new();
        }
        let plain = mirror(self.level.truth.environment, &self.directions);
        let plain = Slipped::one("mips", "plain mips: not prefiltered".to_owned(), plain);
        let words = "half vectors taken as l: reflect v about them".to_owned();
        [self.by_other_kernels(), vec![plain, Slipped::one("model", words, self.by_half_vectors())]].concat()
    }

    fn by_other_kernels(&self) -> Vec<Slipped> {
        let of = |(cause, other)| Slipped { causes: vec![cause], values: self.of(self.level.truth, other) };
        self.other_kernels().into_iter().map(of).collect()
    }

    /// Irradiance of a plain sum over pixels, and of that sum over the sum of the cosines.
    fn without_solid_angles(&self) -> Vec<Slipped> {
        let Level { truth, kernel, .. } = *self.level;
        let even = Environment::from_image("even", truth.environment.image.map(|_| [1.0; 3]));
        let [(cause, summed), (_, whole)] = [truth.environment, &even].map(without_solid_angles);
        let [summed, whole] = [summed, whole].map(|light| self.of(&Truth::new(&light, kernel, &[]), kernel));
        let mean = summed.iter().zip(&whole).map(|(sum, whole)| *sum / *whole).collect();
        [summed, mean].map(|values| Slipped { causes: vec![cause.clone()], values }).to_vec()
    }

    /// The level with density `D(l) n·l` for `D(h)/4`.
    fn by_half_vectors(&self) -> Vec<DVec3> {
        let Level { truth, kernel, alpha, .. } = *self.level;
        let d = |cos: f64| kernel.brdf.d(DVec3::new((1.0 - cos * cos).max(0.0).sqrt(), 0.0, cos), alpha);
        let weight = |cos: f64| kernel.weight(alpha, cos) * cos * d(cos) / d((0.5 * (1.0 + cos)).sqrt());
        let map =
            truth.harmonics.convolved(&harmonic::factors_of(kernel.brdf, alpha, truth.harmonics.degree(), weight));
        self.directions.world.iter().map(|world| map.value(*world)).collect()
    }

    fn sources(&self) -> Vec<Slipped> {
        let of = |(cause, truth): &(Cause, Truth)| Slipped {
            causes: vec![cause.clone()],
            values: self.of(truth, self.level.kernel),
        };
        (self.level.sources)().iter().map(of).collect()
    }

    /// Levels of the likeliest other source by other kernels. Each further source takes a second.
    fn sources_by_others(&self) -> Vec<Slipped> {
        let Some((source, truth)) = (self.level.sources)().first() else { return Vec::new() };
        let of = |(other, kernel)| Slipped { causes: vec![source.clone(), other], values: self.of(truth, kernel) };
        self.other_kernels().into_iter().map(of).collect()
    }

    /// A turn about y that is not a quarter: the offset of a lat-long map.
    fn turn(&self) -> Option<Slipped> {
        let truth = self.level.truth;
        let map = has_width(self.level.alpha).then(|| truth.prefiltered_by(self.level.kernel, self.level.alpha));
        let turned = |degrees: f64| {
            let turn = DQuat::from_rotation_y(degrees.to_radians());
            match &map {
                Some(map) => self.directions.world.iter().map(|world| map.value(turn * *world)).collect(),
                None => self.directions.means(MIRROR_POINTS, |world| truth.environment.radiance(turn * world)),
            }
        };
        let scored = |degrees: f64| {
            let values: Vec<DVec3> = turned(degrees);
            let gain = self.gain(&values);
            (degrees, self.off(&self.found, &values.iter().map(|x| gain * *x).collect::<Vec<_>>()))
        };
        let nearer = |a: (f64, f64), b: (f64, f64)| if b.1 < a.1 { b } else { a };
        let mut best = (0..(360.0 / TURN_STEP) as u32).map(|k| scored(TURN_STEP * f64::from(k))).reduce(nearer)?;
        let mut step = 0.5 * TURN_STEP;
        for _ in 0..TURNS_REFINED {
            best = nearer(nearer(best, scored(best.0 - step)), scored(best.0 + step));
            step *= 0.5;
        }
        let degrees = (best.0 + 180.0).rem_euclid(360.0) - 180.0;
        let words = format!("turned by {degrees:.0}° about y: lat-long offset {:.3}", degrees / 360.0);
        (degrees.abs() >= TURN_MIN).then(|| Slipped::one("turn", words, turned(best.0)))
    }

    /// The same with another order of channels, another encoding, or both; at most two slips.
    fn coded(&self, base: Slipped) -> Vec<Slipped> {
        let order =
            |(words, change): &(&str, Change)| base.with("channels", format!("channels in the order {words}"), change);
        let orders: Vec<Slipped> = ORDERS.iter().map(order).collect();
        let mut all: Vec<Slipped> = match base.causes.len() {
            0 => COPIES.iter().map(|(words, change)| base.with("channels", (*words).to_owned(), change)).collect(),
            1 => Vec::new(),
            _ => vec![base.clone()],
        };
        for base in orders.into_iter().chain([base]).filter(|base| base.causes.len() < 2) {
            for (words, change) in CURVES.iter().chain(PACKINGS) {
                all.push(base.with("encoding", (*words).to_owned(), change));
            }
            for &(range, exponent) in RGBM {
                let power = if exponent == 1.0 { String::new() } else { format!(" to the power of {exponent}") };
                let words = format!("RGBM read as linear: decode {range} alpha RGB{power}");
                all.push(base.with("encoding", words, |x| rgbm(x.powf(1.0 / exponent), range)));
            }
            all.push(base);
        }
        all
    }

    fn gain(&self, values: &[DVec3]) -> f64 {
        fit::gain(&self.directions, &self.found, values, self.level.truth.epsilon())
    }

    /// Adds a gain, gains by channel, a cut or moved faces to those with fewer than two slips. Returns what each leaves.
    fn finished(&self, coded: Vec<Slipped>) -> impl Iterator<Item = (Vec<Cause>, f64)> {
        let with_gain = |from: &Slipped, gain: f64| from.with("gain", self.level.gain_in_words(gain), |x| gain * x);
        let cut_words = format!("cut at {}", rounded(self.most));
        let most = self.most;
        coded.into_iter().flat_map(move |slipped| {
            let (mut all, mut by_faces) = (Vec::new(), Vec::new());
            if slipped.causes.len() < 2 {
                all.push(with_gain(&slipped, self.gain(&slipped.values)));
                // Beside an encoding they would fit too much.
                all.extend(self.channel_gains(&slipped).filter(|_| slipped.causes.is_empty()));
                // The gain of what is not cut.
                let uncut = |(found, _): &(&DVec3, &DVec3)| found.max_element() < UNCUT * most;
                let pairs = self.found.iter().zip(&slipped.values).filter(uncut);
                let [found, right] = pairs.fold([0.0; 2], |[a, b], (x, y)| [a + x.element_sum(), b + y.element_sum()]);
                let before = slipped.causes.is_empty().then(|| with_gain(&slipped, found / right.max(1e-12)));
                for from in [Some(&slipped), before.as_ref()].into_iter().flatten() {
                    all.extend(CUTS.map(|(_, cut)| from.with("cut", cut_words.clone(), |x| cut(x, most))));
                }
                // Moved faces keep the mean.
                let sum = |texels: &[DVec3]| -> f64 {
                    texels.iter().zip(&self.directions.weights).map(|(x, weight)| weight * x.element_sum()).sum()
                };
                let gain = sum(&self.found) / sum(&slipped.values).max(1e-12);
                let gained = slipped.causes.is_empty().then(|| with_gain(&slipped, gain));
                for from in [Some(&slipped), gained.as_ref()].into_iter().flatten() {
                    let moved = faces::slip(self.level.truth, &self.directions, &self.found, &from.values);
                    by_faces.extend(moved.map(|(cause, off)| ([&[cause], &from.causes[..]].concat(), off)));
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
        let only = |texels: &[DVec3], axis: DVec3| texels.iter().map(|texel| *texel * axis).collect::<Vec<_>>();
        let gains = [DVec3::X, DVec3::Y, DVec3::Z].map(|axis| {
            let (found, right) = (only(&self.found, axis), only(&from.values, axis));
            let is_black = found.iter().all(|texel| *texel == DVec3::ZERO);
            if is_black { 0.0 } else { fit::gain(&self.directions, &found, &right, self.level.truth.epsilon()) }
        });
        let [red, green, blue] = gains;
        let words = format!("red, green and blue times {red:.2}, {green:.2} and {blue:.2}");
        let gains = DVec3::from_array(gains);
        let is_uneven = gains.max_element() > CHANNELS_APART * gains.min_element();
        is_uneven.then(|| from.with("gain", words, |x| gains * x))
    }
}
