//! Other sources of a bake: the light with its lamps cut, another encoding, half of it, or summed
//! by other weights.

use super::Truth;
use super::mip_chain::{MipChain, MipSource};
use super::texel::{Curve, Cut, Tone};
use crate::bake::convention::Convention;
use crate::base::color::luminance;
use crate::base::math::equirect::direction_from_uv;
use crate::base::pixels::RgbImage;
use crate::instrument::environment::Environment;
use crate::instrument::environment::layout::{FilteredMap, MapLayout};
use glam::{DVec2, DVec3};
use std::cell::LazyCell;
use std::f64::consts::PI;

/// Largest relative difference of a bake's mean and its source's.
pub const SAME_MEAN: f64 = 0.02;
/// Texels below this share of a cut are not cut.
pub const UNCUT: f64 = 0.98;
/// Bins of a channel's values for each factor of e: the values of a bin differ by less than 1 %.
const BINS_PER_E: f64 = 128.0;
/// Smallest value that has a bin of its own.
const BIN_LEAST: f64 = 1e-6;
/// Fewest and most rows of a map that a level 0 is resampled to.
const LEVEL_0_ROWS_RANGE: [u32; 2] = [64, 512];
/// Rows of a lat-long map for each row of a face: a cube has two faces from pole to pole, and
/// linear lookups between its texels need more.
const LEVEL_0_ROWS: u32 = 4;
/// Range of exposures, and the smallest value of a cut.
const EXPOSURES: [f64; 2] = [1e-3, 1e3];

/// What happened to the environment before the bake.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum SourceSlip {
    Cut {
        cut: Cut,
        limit: f64,
    },
    Curve(Curve),
    /// Cut at 1, then a curve.
    CutAndCurve(Curve),
    Tone {
        tone: Tone,
        exposure: f64,
    },
    /// Half of the map is black.
    WithoutHalf(Half),
    /// Pixels are summed without their solid angle.
    WithoutSolidAngle,
    /// Samples are weighted by 1/(1 + luminance).
    DarkWeighted,
    /// Level 0 of the bake, and what is wrong there.
    Level0,
}

/// A half of a lat-long map.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Half {
    Upper,
    Lower,
}

impl SourceSlip {
    /// Changes a colour in row `y` of a map. Sums by other weights change no colour by itself.
    fn apply(self, color: DVec3, y: u32, height: u32) -> DVec3 {
        match self {
            Self::Cut { cut, limit } => cut.apply(color, limit),
            Self::Curve(curve) => color.map(|x| curve.apply(x)),
            Self::CutAndCurve(curve) => color.min(DVec3::ONE).map(|x| curve.apply(x)),
            Self::Tone { tone, exposure } => tone.apply(exposure * color),
            Self::WithoutHalf(half) => {
                let is_lower = 2 * y >= height;
                if is_lower == (half == Half::Lower) {
                    DVec3::ZERO
                } else {
                    color
                }
            }
            Self::WithoutSolidAngle | Self::DarkWeighted | Self::Level0 => color,
        }
    }
}

/// Another source of a bake.
pub struct Source {
    pub slip: SourceSlip,
    pub light: Environment,
    /// What the convolution is divided by, if the source is a weighted sum.
    pub divisor: Option<Environment>,
}

/// The truths of a [`Source`].
pub struct Lit<'l> {
    pub slip: SourceSlip,
    pub truth: Truth<'l>,
    pub divisor: Option<Truth<'l>>,
}

impl Source {
    fn new(
        environment: &Environment,
        slip: SourceSlip,
        image: RgbImage,
        divisor: Option<RgbImage>,
    ) -> Self {
        let named = |image: RgbImage| Environment::from_image(environment.name.clone(), image);
        Self {
            slip,
            light: named(image),
            divisor: divisor.map(named),
        }
    }

    fn lit(&self, truth: &Truth, alphas: &[f64]) -> Lit<'_> {
        Lit {
            slip: self.slip,
            truth: Truth::new(&self.light, truth.kernel, alphas),
            divisor: self
                .divisor
                .as_ref()
                .map(|light| Truth::new(light, truth.kernel, alphas)),
        }
    }
}

/// A value that is computed when it is first read.
type Lazy<'l, T> = LazyCell<T, Box<dyn FnOnce() -> T + 'l>>;

/// Truths of other sources by the kernel of a bake. Each takes a second, so they wait for a level
/// that needs them.
pub struct OtherLights<'l> {
    /// Sources with the mean of the bake.
    pub changed: Lazy<'l, Vec<Lit<'l>>>,
    /// Sources that are sums by other weights.
    pub summed: Lazy<'l, Vec<Lit<'l>>>,
    /// Level 0 of the bake.
    pub level_0: Lazy<'l, Vec<Lit<'l>>>,
    mips_of_cube: Lazy<'l, MipChain>,
    mips_of_lat_long: Lazy<'l, MipChain>,
}

impl<'l> OtherLights<'l> {
    /// Convolves sources when a level reads them.
    pub fn new<
        F: FnOnce() -> Vec<Source>,
        G: FnOnce() -> Vec<Source>,
        H: FnOnce() -> Vec<Source>,
    >(
        truth: &'l Truth,
        alphas: &'l [f64],
        changed: &'l LazyCell<Vec<Source>, F>,
        summed: &'l LazyCell<Vec<Source>, G>,
        level_0: &'l LazyCell<Vec<Source>, H>,
    ) -> Self {
        let lit = move |sources: &'l [Source]| -> Vec<Lit<'l>> {
            sources
                .iter()
                .map(|source| source.lit(truth, alphas))
                .collect()
        };
        let mips = |source: MipSource| -> Lazy<'l, MipChain> {
            LazyCell::new(Box::new(move || MipChain::new(truth.environment, source)))
        };
        Self {
            changed: LazyCell::new(Box::new(move || lit(changed))),
            summed: LazyCell::new(Box::new(move || lit(summed))),
            level_0: LazyCell::new(Box::new(move || lit(level_0))),
            mips_of_cube: mips(MipSource::Cube),
            mips_of_lat_long: mips(MipSource::LatLong),
        }
    }

    /// Returns the environment with its mips as a cube or a lat-long map.
    pub fn mips(&self, source: MipSource) -> &MipChain {
        match source {
            MipSource::Cube => &self.mips_of_cube,
            MipSource::LatLong => &self.mips_of_lat_long,
        }
    }
}

/// Finds where a rising function comes nearest to a value, by its logarithm.
pub fn solved([mut low, mut high]: [f64; 2], value: f64, rising: impl Fn(f64) -> f64) -> f64 {
    for _ in 0..24 {
        let middle = f64::sqrt(low * high);
        if rising(middle) > value {
            high = middle
        } else {
            low = middle
        }
    }
    if value - rising(low) < rising(high) - value {
        low
    } else {
        high
    }
}

/// Finds the exposure from 0.001 to 1000 under which `mean` of a tone-mapped image has a value.
pub fn solved_exposure(value: f64, mean: impl Fn(f64) -> f64) -> f64 {
    solved(EXPOSURES, value, mean)
}

struct WeightedTexel {
    /// Solid angle, up to a factor.
    weight: f64,
    color: DVec3,
}

/// Values of a channel that are nearly alike.
#[derive(Clone, Copy, Default)]
struct Bin {
    weight: f64,
    /// Weighted sum.
    sum: f64,
}

/// The values of a channel in bins: the mean of any smooth function of them takes little time.
struct ChannelBins(Vec<Bin>);

impl ChannelBins {
    fn new(texels: &[WeightedTexel], channel: usize) -> Self {
        let mut bins: Vec<Bin> = Vec::new();
        for texel in texels {
            let value = texel.color[channel];
            // Saturates at 0.
            let index = (1.0 + BINS_PER_E * (value / BIN_LEAST).ln()) as usize;
            if index >= bins.len() {
                bins.resize(index + 1, Bin::default());
            }
            bins[index].weight += texel.weight;
            bins[index].sum += texel.weight * value;
        }
        bins.retain(|bin| bin.weight > 0.0);
        Self(bins)
    }

    /// Returns the weighted sum of a function of the values.
    fn sum(&self, function: impl Fn(f64) -> f64) -> f64 {
        let terms = self.0.iter();
        terms
            .map(|bin| bin.weight * function(bin.sum / bin.weight))
            .sum()
    }
}

/// Means of a lat-long map by solid angle, as it is and after changes of its texels.
struct MapMeans<'e> {
    image: &'e RgbImage,
    channels: [ChannelBins; 3],
    /// Darkest first.
    texels: Vec<WeightedTexel>,
    /// Weighted sum of the texels before each index.
    sums: Vec<DVec3>,
    weight: f64,
    /// Largest channel, at least 0.001.
    largest: f64,
}

impl<'e> MapMeans<'e> {
    fn new(image: &'e RgbImage) -> Self {
        let mut texels: Vec<WeightedTexel> = (0..image.height)
            .flat_map(|y| (0..image.width).map(move |x| (x, y)))
            .map(|(x, y)| WeightedTexel {
                weight: row_weight(image, y),
                color: color(image, x, y),
            })
            .collect();
        texels.sort_by(|a, b| a.color.max_element().total_cmp(&b.color.max_element()));
        let mut sums = vec![DVec3::ZERO];
        for (index, texel) in texels.iter().enumerate() {
            sums.push(sums[index] + texel.weight * texel.color);
        }
        Self {
            image,
            channels: [0, 1, 2].map(|channel| ChannelBins::new(&texels, channel)),
            weight: texels.iter().map(|texel| texel.weight).sum(),
            texels,
            sums,
            largest: image
                .data
                .iter()
                .flatten()
                .fold(1e-3, |most: f32, x| most.max(*x))
                .into(),
        }
    }

    /// Averages the map after a change that treats rows and channels alike.
    fn changed(&self, change: impl Fn(DVec3) -> DVec3) -> DVec3 {
        let channel = |index: usize| {
            let changed = |value: f64| change(DVec3::splat(value))[index];
            self.channels[index].sum(changed) / self.weight
        };
        DVec3::new(channel(0), channel(1), channel(2))
    }

    /// Averages one half of the map, with the other one black.
    fn half(&self, half: Half) -> DVec3 {
        let RgbImage { width, height, .. } = *self.image;
        let slip = SourceSlip::WithoutHalf(half);
        let row = |y: u32| {
            let changed = |x: u32| slip.apply(color(self.image, x, y), y, height);
            row_weight(self.image, y) * (0..width).map(changed).sum::<DVec3>()
        };
        (0..height).map(row).sum::<DVec3>() / self.weight
    }

    /// Whether a change of the map gives it this mean.
    fn has_mean(&self, slip: SourceSlip, mean: DVec3) -> bool {
        let found = match slip {
            SourceSlip::WithoutHalf(half) => self.half(half),
            _ => self.changed(|color| slip.apply(color, 0, 1)),
        };
        is_same(found, mean)
    }

    /// Averages the cut map. A cut leaves dark texels as they are, so only bright ones count again.
    fn cut(&self, cut: Cut, limit: f64) -> DVec3 {
        let dark = self
            .texels
            .partition_point(|texel| texel.color.max_element() <= limit);
        let bright: DVec3 = self.texels[dark..]
            .iter()
            .map(|texel| texel.weight * cut.apply(texel.color, limit))
            .sum();
        (self.sums[dark] + bright) / self.weight
    }

    /// Finds the value at which a cut gives the map this mean.
    fn cut_with_mean(&self, cut: Cut, mean: DVec3, element_sum: f64) -> Option<SourceSlip> {
        let limit = solved([EXPOSURES[0], self.largest], element_sum, |limit| {
            self.cut(cut, limit).element_sum()
        });
        let cuts_much = cut.apply(DVec3::splat(self.largest), limit).x < UNCUT * self.largest;
        let is_found = cuts_much && is_same(self.cut(cut, limit), mean);
        is_found.then_some(SourceSlip::Cut { cut, limit })
    }

    fn exposed(&self, tone: Tone, mean: DVec3) -> SourceSlip {
        let exposure = solved_exposure(mean.element_sum(), |exposure| {
            self.changed(|color| tone.apply(exposure * color))
                .element_sum()
        });
        SourceSlip::Tone { tone, exposure }
    }

    fn source(&self, environment: &Environment, slip: SourceSlip) -> Source {
        let RgbImage { width, height, .. } = *self.image;
        let image = RgbImage::from_fn(width, height, |x, y| {
            slip.apply(color(self.image, x, y), y, height)
                .as_vec3()
                .to_array()
        });
        Source::new(environment, slip, image, None)
    }
}

/// Returns the solid angle of a row's pixels, up to a factor.
fn row_weight(image: &RgbImage, y: u32) -> f64 {
    (PI * (f64::from(y) + 0.5) / f64::from(image.height)).sin()
}

fn color(image: &RgbImage, x: u32, y: u32) -> DVec3 {
    DVec3::from_array(image.get(x, y).map(f64::from))
}

fn is_same(found: DVec3, mean: DVec3) -> bool {
    (found - mean).abs().cmple(SAME_MEAN * mean).all()
}

/// Lists changed maps whose mean is a bake's over a gain: convolutions keep the mean.
pub fn sources(environment: &Environment, mean: DVec3, gains: &[f64]) -> Vec<Source> {
    let means = MapMeans::new(&environment.image);
    let cuts = gains.iter().flat_map(|gain| {
        let cuts = Cut::ALL.iter();
        cuts.filter_map(|cut| means.cut_with_mean(*cut, mean / *gain, mean.element_sum() / *gain))
    });
    let halves = [Half::Upper, Half::Lower].map(SourceSlip::WithoutHalf);
    let curves = Curve::ALL
        .into_iter()
        .flat_map(|curve| [SourceSlip::Curve(curve), SourceSlip::CutAndCurve(curve)]);
    let tones = Tone::ALL.into_iter().map(|tone| means.exposed(tone, mean));
    let others = halves
        .into_iter()
        .chain(curves)
        .chain(tones)
        .filter(|slip| means.has_mean(*slip, mean));
    cuts.chain(others)
        .map(|slip| means.source(environment, slip))
        .collect()
}

/// The sums over the pixels of a map without their solid angles, and by weights against bright
/// pixels.
pub fn summed(environment: &Environment) -> Vec<Source> {
    let image = &environment.image;
    let over_sin = |_: u32, y: u32| (1.0 / row_weight(image, y)) as f32;
    let dark = |x: u32, y: u32| (1.0 / (1.0 + luminance(image.get(x, y)))) as f32;
    let angles = SourceSlip::WithoutSolidAngle;
    let whole_of_angles = weights(image, over_sin);
    let sum = weighted(image, over_sin);
    vec![
        Source::new(environment, angles, sum.clone(), None),
        Source::new(environment, angles, sum, Some(whole_of_angles)),
        Source::new(
            environment,
            SourceSlip::DarkWeighted,
            weighted(image, dark),
            Some(weights(image, dark)),
        ),
    ]
}

/// Level 0 of the bake as a light: most bakers filter the other levels from it, with all that is
/// wrong there.
pub fn of_level_0(
    environment: &Environment,
    layout: &'static MapLayout,
    faces: &[RgbImage],
    convention: &Convention,
) -> Vec<Source> {
    let texel = |texel: [f32; 3]| convention.scale * DVec3::from_array(texel.map(f64::from));
    let level = FilteredMap {
        layout,
        levels: vec![faces.iter().map(|face| face.map(texel)).collect()],
    };
    let [least, most] = LEVEL_0_ROWS_RANGE;
    let rows = (LEVEL_0_ROWS * faces[0].height).clamp(least, most);
    let size = DVec2::new((2 * rows).into(), rows.into());
    let image = RgbImage::from_fn(2 * rows, rows, |x, y| {
        let uv = (DVec2::new(x.into(), y.into()) + 0.5) / size;
        let file = convention.axes.to_file(direction_from_uv(uv));
        level.value(file, 0.0).max(DVec3::ZERO).as_vec3().to_array()
    });
    vec![Source::new(environment, SourceSlip::Level0, image, None)]
}

fn weighted(image: &RgbImage, weight: impl Fn(u32, u32) -> f32) -> RgbImage {
    RgbImage::from_fn(image.width, image.height, |x, y| {
        image.get(x, y).map(|value| weight(x, y) * value)
    })
}

fn weights(image: &RgbImage, weight: impl Fn(u32, u32) -> f32) -> RgbImage {
    RgbImage::from_fn(image.width, image.height, |x, y| [weight(x, y); 3])
}
