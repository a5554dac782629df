//! Other sources of a bake: the light with its lamps cut, another encoding, half of it, or summed
//! by other weights.

use super::texel::{CURVES, CUTS, Change, Cut, TONES};
use super::{Cause, Truth};
use crate::base::color::luminance;
use crate::base::pixels::RgbImage;
use crate::instrument::environment::Environment;
use glam::DVec3;
use std::f64::consts::PI;

/// Largest relative difference of a bake's mean and its source's.
pub const SAME_MEAN: f64 = 0.02;
/// Texels below this share of a cut are not cut.
pub const UNCUT: f64 = 0.98;
/// Rows of a map whose mean is searched.
const ROWS: u32 = 64;

pub fn rounded(x: f64) -> f64 {
    let digits = 10.0_f64.powf(2.0 - x.max(1e-9).log10().floor());
    (x * digits).round() / digits
}

/// Another source, and what its convolution is divided by.
pub struct Source {
    pub cause: Cause,
    pub light: Environment,
    pub whole: Option<Environment>,
}

/// The truths of a [`Source`].
pub struct Lit<'l> {
    pub cause: Cause,
    pub truth: Truth<'l>,
    pub whole: Option<Truth<'l>>,
}

impl Source {
    fn new(of: &Environment, words: String, image: RgbImage, whole: Option<RgbImage>) -> Self {
        let named = |image: RgbImage| Environment::from_image(of.name.clone(), image);
        Self {
            cause: Cause {
                kind: "source",
                words,
            },
            light: named(image),
            whole: whole.map(named),
        }
    }

    pub fn lit(&self, truth: &Truth, alphas: &[f64]) -> Lit<'_> {
        let of = |light| Truth::new(light, truth.kernel, alphas);
        Lit {
            cause: self.cause.clone(),
            truth: of(&self.light),
            whole: self.whole.as_ref().map(of),
        }
    }
}

/// Finds where a rising function comes nearest to a value, by its logarithm.
pub fn solved([mut low, mut high]: [f64; 2], value: f64, of: impl Fn(f64) -> f64) -> f64 {
    for _ in 0..24 {
        let middle = f64::sqrt(low * high);
        if of(middle) > value {
            high = middle
        } else {
            low = middle
        }
    }
    if value - of(low) < of(high) - value {
        low
    } else {
        high
    }
}

/// The words of a curve at an exposure.
pub fn exposed(words: &str, exposure: f64) -> String {
    if (exposure - 1.0).abs() < 0.02 {
        words.to_owned()
    } else {
        format!("{words}, exposed by {}", rounded(exposure))
    }
}

/// Lists changed maps whose mean is a bake's over a gain: convolutions keep the mean.
pub fn sources(environment: &Environment, mean: DVec3, gains: &[f64]) -> Vec<Source> {
    let image = &environment.image;
    let at = |x, y| DVec3::from_array(image.get(x, y).map(f64::from));
    let weight_of = |y: u32| (PI * (f64::from(y) + 0.5) / f64::from(image.height)).sin();
    let mean_of = |step: u32, change: &dyn Fn(DVec3, u32) -> DVec3| {
        let (mut sum, mut whole) = (DVec3::ZERO, 0.0);
        for y in (0..image.height).step_by(step as usize) {
            let weight = weight_of(y);
            whole += weight * f64::from(image.width);
            sum += weight * (0..image.width).map(|x| change(at(x, y), y)).sum::<DVec3>();
        }
        sum / whole
    };
    // A cut leaves dark texels as they are: sorted, only the bright ones count again.
    let row = |y: u32| (0..image.width).map(move |x| (weight_of(y), at(x, y)));
    let mut texels: Vec<(f64, DVec3)> = (0..image.height).flat_map(row).collect();
    texels.sort_by(|(_, a), (_, b)| a.max_element().total_cmp(&b.max_element()));
    let whole: f64 = texels.iter().map(|(weight, _)| weight).sum();
    let mut sums = vec![DVec3::ZERO];
    for (place, (weight, x)) in texels.iter().enumerate() {
        sums.push(sums[place] + *weight * *x);
    }
    let cut_mean = |cut: Cut, most: f64| {
        let dark = texels.partition_point(|(_, x)| x.max_element() <= most);
        let bright: DVec3 = texels[dark..]
            .iter()
            .map(|(weight, x)| *weight * cut(*x, most))
            .sum();
        (sums[dark] + bright) / whole
    };
    let largest: f64 = image
        .data
        .iter()
        .flatten()
        .fold(1e-3, |most: f32, x| most.max(*x))
        .into();
    let is_same = |own: DVec3, mean: DVec3| (own - mean).abs().cmple(SAME_MEAN * mean).all();
    let source = |words: String, change: &dyn Fn(DVec3, u32) -> DVec3| {
        let texel = |x, y| change(at(x, y), y).as_vec3().to_array();
        Source::new(
            environment,
            words,
            RgbImage::from_fn(image.width, image.height, texel),
            None,
        )
    };
    let cut_by = |gain: f64, (how, cut): &(&str, Cut)| {
        let value = mean.element_sum() / gain;
        let most = solved([1e-3, largest], value, |most| {
            cut_mean(*cut, most).element_sum()
        });
        let ldr = if how.is_empty() && (most - 1.0).abs() < 0.05 {
            ": LDR"
        } else {
            ""
        };
        let change = |x: DVec3, _: u32| cut(x, most);
        let is_cut = cut(DVec3::splat(largest), most).x < UNCUT * largest
            && is_same(cut_mean(*cut, most), mean / gain);
        is_cut.then(|| {
            source(
                format!("source cut at {}{how}{ldr}", rounded(most)),
                &change,
            )
        })
    };
    let alike = |words: String, change: &dyn Fn(DVec3, u32) -> DVec3| {
        is_same(mean_of(image.height.div_ceil(8 * ROWS), change), mean)
            .then(|| source(words, change))
    };
    let coded = |(words, curve): &(&str, Change)| {
        let whole = alike(format!("source {words}"), &|x, _| curve(x));
        whole
            .into_iter()
            .chain(alike(format!("source cut at 1 and {words}"), &|x, _| {
                curve(x.min(DVec3::ONE))
            }))
    };
    let toned = |(words, curve): &(&str, Change)| {
        let of = |exposure: f64| {
            mean_of(image.height.div_ceil(ROWS), &|x, _| curve(exposure * x)).element_sum()
        };
        let exposure = solved([1e-3, 1e3], mean.element_sum(), of);
        alike(format!("source {}", exposed(words, exposure)), &|x, _| {
            curve(exposure * x)
        })
    };
    let halves = ["upper", "lower"]
        .into_iter()
        .enumerate()
        .filter_map(|(side, name)| {
            let is_black = |y: u32| usize::from(2 * y >= image.height) == side;
            alike(format!("source without its {name} half"), &|x, y| {
                if is_black(y) { DVec3::ZERO } else { x }
            })
        });
    let cuts = gains
        .iter()
        .flat_map(|gain| CUTS.iter().filter_map(|cut| cut_by(*gain, cut)));
    cuts.chain(halves)
        .chain(CURVES.iter().flat_map(coded))
        .chain(TONES.iter().filter_map(toned))
        .collect()
}

/// The sums over the pixels of a map without their solid angles, and by weights against bright
/// pixels.
pub fn summed(environment: &Environment) -> Vec<Source> {
    let image = &environment.image;
    let over_sin =
        |y: u32| 1.0 / (PI * (f64::from(y) + 0.5) / f64::from(image.height)).sin() as f32;
    let dark = |x: u32, y: u32| (1.0 / (1.0 + luminance(image.get(x, y)))) as f32;
    let by = |weight: &dyn Fn(u32, u32) -> f32| {
        let of = |value: &dyn Fn(u32, u32) -> [f32; 3]| {
            RgbImage::from_fn(image.width, image.height, |x, y| {
                value(x, y).map(|value| weight(x, y) * value)
            })
        };
        [of(&|x, y| image.get(x, y)), of(&|_, _| [1.0; 3])]
    };
    let ([sum, angles], [darker, weights]) = (by(&|_, y| over_sin(y)), by(&dark));
    let words = "source summed without the solid angle of its pixels, sin θ";
    let karis = "samples weighted by 1/(1 + luminance), as against fireflies";
    let of = |words: &str, image: RgbImage, whole| {
        Source::new(environment, words.to_owned(), image, whole)
    };
    vec![
        of(words, sum.clone(), None),
        of(words, sum, Some(angles)),
        of(karis, darker, Some(weights)),
    ]
}
