//! Names the slip that explains a level.
//!
//! Each known slip is put into the exact level, and the result is compared with the file. The slip that comes nearest is
//! named if it leaves at most `EXPLAINED` of the error, and at most `CLOSE`.

use super::directions::Directions;
use super::exact::exact;
use super::{EXPLAINED, Truth, errors, faces, fit, has_width};
use crate::color::srgb_encode;
use crate::precompute::prefilter::{Kernel, WEIGHTS};
use glam::{DMat3, DVec3, Vec3Swizzles};

#[derive(Clone, Debug, PartialEq)]
pub struct Slip {
    /// The slip; if there is one, the flag or setting that corrects it.
    pub words: String,
    /// relMSE that remains over the level's own.
    pub left: f64,
}

/// Approximate number of texels that are compared.
const TEXELS: f64 = 600.0;
/// Largest relMSE that a slip may leave: 10 % rms.
const CLOSE: f64 = 0.01;
/// Step of the turns about y that are tried, degrees, and the bisections around the best.
const TURN_STEP: f64 = 5.0;
const TURNS_REFINED: u32 = 8;
/// Smallest ratio of two channels' gains that is a slip.
const CHANNELS_APART: f64 = 1.02;
/// Smallest turn that is a slip, degrees.
const TURN_MIN: f64 = 0.5;

/// Slips that change each texel by itself, as functions of the right colour.
type Change = fn(DVec3) -> DVec3;
static CHANGES: &[(&str, Change)] = &[
    ("the channels are in the order R, B, G", |x| x.xzy()),
    ("the channels are in the order G, R, B", |x| x.yxz()),
    ("the channels are in the order B, G, R", |x| x.zyx()),
    ("the channels are in the order G, B, R", |x| x.yzx()),
    ("the channels are in the order B, R, G", |x| x.zxy()),
    ("encoded with gamma 2.2; decode it before the bake is read", |x| x.powf(1.0 / 2.2)),
    ("decoded with gamma 2.2 though it was linear", |x| x.powf(2.2)),
    ("encoded as sRGB and cut at 1: an LDR file", |x| {
        DVec3::from_array(x.to_array().map(|x| srgb_encode(x as f32).into()))
    }),
    ("RGBM read as linear radiance; multiply by alpha and the range", |x| rgbm(x, 8.0)),
    ("RGBM of range 64 read as linear radiance; multiply by alpha and 64", |x| rgbm(x, 64.0)),
    ("RGBM of square roots read as linear radiance; decode it", |x| rgbm(x.powf(0.5), 8.0)),
    ("RGBM with gamma 2.2 read as linear radiance; decode it", |x| rgbm(x.powf(1.0 / 2.2), 8.0)),
    ("RGBD read as linear radiance; divide by alpha", rgbd),
    ("RGBD with gamma 2.2 read as linear radiance; decode it", |x| rgbd(x).powf(1.0 / 2.2)),
    ("RGBE read as linear radiance; scale by 2 to the exponent in alpha", rgbe),
    ("LogLuv read as linear radiance; decode it", log_luv),
];

/// Colours of RGBM: over the range and over a multiplier of at most 1, in steps of 1/255.
fn rgbm(x: DVec3, range: f64) -> DVec3 {
    let multiplier = (255.0 * (x.max_element() / range).min(1.0)).ceil() / 255.0;
    if multiplier > 0.0 { x / (range * multiplier) } else { x }
}

/// Colours of RGBD: times a divisor of at most 1 that brings the largest below 1.
fn rgbd(x: DVec3) -> DVec3 {
    x * ((255.0 / x.max_element().max(1e-6)).floor().clamp(1.0, 255.0) / 255.0)
}

/// Mantissas of RGBE: over a power of two that brings the largest into [1/2, 1).
fn rgbe(x: DVec3) -> DVec3 {
    x / (x.max_element().max(1e-30).log2().floor() + 1.0).exp2()
}

/// First three channels of LogLuv in 32 bits (Larson 1998), with the matrix that three.js used.
fn log_luv(x: DVec3) -> DVec3 {
    const FROM_RGB: DMat3 =
        DMat3::from_cols_array(&[0.2209, 0.3390, 0.4184, 0.1138, 0.6780, 0.7319, 0.0102, 0.1130, 0.2969]);
    let [x, y, sum] = (FROM_RGB * x).max(DVec3::splat(1e-6)).to_array();
    let log = 2.0 * y.log2() + 127.0;
    DVec3::new(x / sum, y / sum, (log - (255.0 * log.fract()).floor() / 255.0) / 255.0)
}

pub struct Level<'a> {
    pub truth: &'a Truth<'a>,
    /// The truth of the same map, cut at 1.
    pub of_cut: &'a Truth<'a>,
    pub directions: &'a Directions,
    pub found: &'a [DVec3],
    pub exact: &'a [DVec3],
    pub alpha: f64,
}

impl Level<'_> {
    /// Returns the slip that leaves least, if it explains the level.
    pub fn slip(&self) -> Option<Slip> {
        if self.found.iter().all(|texel| *texel == DVec3::ZERO) {
            return Some(Slip { words: "every texel is black".to_owned(), left: 0.0 });
        }
        let side = (self.directions.world.len() as f64 / TEXELS).sqrt().round() as usize;
        // An odd stride covers all columns.
        let sample = Sample::new(self, side.max(1) | 1);
        let changes = CHANGES.iter().map(|(words, change)| sample.slip((*words).to_owned(), |x, _| change(x)));
        let slips = changes.chain(sample.cuts()).chain(sample.gain()).chain(sample.of_cut()).chain(sample.weights());
        let slips = slips.chain(sample.channel_gains()).chain(sample.turn()).chain(
            faces::slip(self.truth, self.directions, self.found, self.exact).map(|(words, left)| Slip { words, left }),
        );
        // For another map, a slip that flattens the level leaves a small part of a huge error.
        let is_close = |slip: &Slip| slip.left <= EXPLAINED && slip.left * sample.own <= CLOSE;
        slips.filter(is_close).min_by(|a, b| a.left.total_cmp(&b.left))
    }
}

struct Sample<'a> {
    level: &'a Level<'a>,
    directions: Directions,
    found: Vec<DVec3>,
    exact: Vec<DVec3>,
    /// Error without a slip.
    own: f64,
}

impl<'a> Sample<'a> {
    fn new(level: &'a Level<'a>, stride: usize) -> Self {
        let chosen = level.directions.subset(stride);
        let only = |texels: &[DVec3]| chosen.iter().map(|index| texels[*index]).collect::<Vec<_>>();
        let (directions, found, exact) = (level.directions.only(&chosen), only(level.found), only(level.exact));
        let own = errors(&directions, &found, &exact, level.truth.epsilon(), 1.0).relmse;
        Self { level, directions, found, exact, own }
    }

    fn left(&self, slipped: &[DVec3]) -> f64 {
        errors(&self.directions, &self.found, slipped, self.level.truth.epsilon(), 1.0).relmse / self.own
    }

    /// A slip as a function of the right colour and the direction.
    fn slip(&self, words: String, change: impl Fn(DVec3, DVec3) -> DVec3) -> Slip {
        let slipped = self.exact.iter().zip(&self.directions.world).map(|(exact, world)| change(*exact, *world));
        Slip { words, left: self.left(&slipped.collect::<Vec<_>>()) }
    }

    /// Cut at the largest value of the file: each channel, or the colour as a whole.
    fn cuts(&self) -> impl Iterator<Item = Slip> {
        let most = self.level.found.iter().map(|texel| texel.max_element()).fold(0.0, f64::max);
        let words = || format!("cut at {most:.3}");
        let each = self.slip(words(), |x, _| x.min(DVec3::splat(most)));
        [each, self.slip(words(), |x, _| x * (most / x.max_element().max(most)))].into_iter()
    }

    /// A gain alone. Wider levels have a fit of width and gain.
    fn gain(&self) -> impl Iterator<Item = Slip> {
        let is_narrow = !has_width(self.level.alpha);
        let gain = fit::gain(&self.directions, &self.found, &self.exact, self.level.truth.epsilon());
        is_narrow.then(|| self.slip(fit::gain_in_words(gain), |x, _| gain * x)).into_iter()
    }

    fn channel_gains(&self) -> Option<Slip> {
        let only = |texels: &[DVec3], axis: DVec3| texels.iter().map(|texel| *texel * axis).collect::<Vec<_>>();
        let gains = [DVec3::X, DVec3::Y, DVec3::Z].map(|axis| {
            let (found, exact) = (only(&self.found, axis), only(&self.exact, axis));
            let is_black = found.iter().all(|texel| *texel == DVec3::ZERO);
            if is_black { 0.0 } else { fit::gain(&self.directions, &found, &exact, self.level.truth.epsilon()) }
        });
        let [red, green, blue] = gains;
        let words = format!("red, green and blue are {red:.2}, {green:.2} and {blue:.2} times what they should be");
        let gains = DVec3::from_array(gains);
        let is_uneven = gains.max_element() > CHANNELS_APART * gains.min_element();
        is_uneven.then(|| self.slip(words, |x, _| gains * x))
    }

    fn of_cut(&self) -> impl Iterator<Item = Slip> {
        let slipped = exact(self.level.of_cut, &self.directions, self.level.alpha);
        let words = "a bake of the map cut at 1: an LDR source".to_owned();
        std::iter::once(Slip { words, left: self.left(&slipped) })
    }

    fn weights(&self) -> impl Iterator<Item = Slip> {
        let (truth, alpha) = (self.level.truth, self.level.alpha);
        let Kernel { brdf, weight: own, masking } = truth.kernel;
        let others = WEIGHTS.iter().filter(move |weight| has_width(alpha) && weight.name != own.name);
        others.map(move |weight| {
            let map = truth.prefiltered_by(Kernel::new(brdf, weight, masking), alpha);
            self.slip(format!("weighted otherwise: --weight {}", weight.name), |_, world| map.value(world))
        })
    }

    /// A turn about y that is not a quarter: the offset of a lat-long map.
    fn turn(&self) -> Option<Slip> {
        if !has_width(self.level.alpha) {
            return None;
        }
        let map = self.level.truth.prefiltered(self.level.alpha);
        let turned = |degrees: f64| {
            let turn = glam::DQuat::from_rotation_y(degrees.to_radians());
            let left = self.slip(String::new(), |_, world| map.value(turn * world)).left;
            (degrees, left)
        };
        let nearer = |a: (f64, f64), b: (f64, f64)| if b.1 < a.1 { b } else { a };
        let mut best = (0..(360.0 / TURN_STEP) as u32).map(|k| turned(TURN_STEP * f64::from(k))).reduce(nearer)?;
        let mut step = 0.5 * TURN_STEP;
        for _ in 0..TURNS_REFINED {
            best = nearer(nearer(best, turned(best.0 - step)), turned(best.0 + step));
            step *= 0.5;
        }
        let degrees = (best.0 + 180.0).rem_euclid(360.0) - 180.0;
        let words =
            format!("turned by {degrees:.0}° about y: an offset of {:.3} of a lat-long map's width", degrees / 360.0);
        (degrees.abs() >= TURN_MIN).then_some(Slip { words, left: best.1 })
    }
}
