//! The means of prefiltered maps after n = v = r, by the steps that act on tables.

use super::game::Coalition;
use super::setting::{ByKernel, Means, Parts, Setting, Split, StoredMeans};
use super::{LEVELS, SAMPLES, STORAGE, TEXELS};
use crate::base::math::frame::Frame;
use crate::base::math::harmonics::SmoothMap;
use crate::base::math::sequence::SEQUENCES;
use crate::base::names::Listed;
use crate::instrument::brdf::{reflect, schlick_weight};
use crate::instrument::environment::layout::lod_from_solid_angles;
use crate::instrument::precompute::prefilter::{Kernel, Weight, harmonic};
use crate::instrument::precompute::{HALF_MAX, PrecomputeSettings, PrefilterBy, StorageFormat};
use glam::{DVec2, DVec3};
use half::f16;
use rayon::prelude::*;
use std::collections::HashMap;

/// The steps that act on tables.
pub(super) const TABULATED: Coalition =
    Coalition::from_players(&[LEVELS, TEXELS, SAMPLES, STORAGE]);

/// What lookups of one of the two levels around alpha return.
pub(super) struct LevelMeans {
    pub(super) share: f64,
    /// At the level's width.
    pub(super) splits: ByKernel<Split>,
    /// By pixel; empty for a level without a share.
    pub(super) means: Vec<StoredMeans>,
}

/// A direction of a lookup and its weight.
struct Tap {
    /// Index of the direction.
    direction: usize,
    weight: f64,
}

/// Directions of lookups, and the lookups of each pixel.
struct Lookups {
    directions: Vec<DVec3>,
    /// By pixel.
    taps: Vec<Vec<Tap>>,
    /// Width and height of a face if the directions are texels of a level; `None` if they are r.
    level_size: Option<[u32; 2]>,
}

impl Lookups {
    /// Looks up the direction r of each pixel.
    fn along(r: &[DVec3]) -> Self {
        let tap = |direction| Tap {
            direction,
            weight: 1.0,
        };
        Self {
            directions: r.to_vec(),
            taps: (0..r.len()).map(|pixel| vec![tap(pixel)]).collect(),
            level_size: None,
        }
    }

    /// Looks up the texels of a level around the direction r of each pixel.
    fn texels(tables: &PrecomputeSettings, r: &[DVec3], size: [u32; 2]) -> Self {
        let layout = tables.layout;
        let extent = DVec2::new(size[0].into(), size[1].into());
        let mut index_of_texel = HashMap::new();
        let mut directions = Vec::new();
        let mut tap = |texel: [u32; 3], weight: f64| {
            let direction = *index_of_texel.entry(texel).or_insert_with(|| {
                let [face, x, y] = texel;
                let centre = DVec2::new(x.into(), y.into()) + 0.5;
                directions.push((layout.direction)(face, centre / extent));
                directions.len() - 1
            });
            Tap { direction, weight }
        };
        let taps = r
            .iter()
            .map(|r| {
                layout
                    .stencil(*r, size)
                    .into_iter()
                    .map(|(texel, weight)| tap(texel, weight))
                    .collect()
            })
            .collect();
        Self {
            directions,
            taps,
            level_size: Some(size),
        }
    }
}

/// One of the two levels around alpha.
struct Level {
    alpha: f64,
    share: f64,
    texels: Lookups,
}

/// What determines the means of a map.
#[derive(PartialEq, Eq, Hash)]
struct MeansKey {
    alpha_bits: u64,
    /// Index of the level whose texels are the directions; `None` for the directions r.
    level: Option<usize>,
    is_by_samples: bool,
}

/// Makes the means of both levels.
pub(super) struct Tables<'a> {
    setting: &'a Setting<'a>,
    kernels: ByKernel<Kernel>,
    along_r: Lookups,
    levels: [Level; 2],
}

impl<'a> Tables<'a> {
    pub(super) fn new(setting: &'a Setting<'a>) -> Self {
        let tables = setting.tables;
        let kernel = |weight| Kernel::new(setting.model, weight, setting.masking);
        let r: Vec<DVec3> = setting
            .frames
            .iter()
            .map(|[n, v]| reflect(*v, *n))
            .collect();
        let mapping = tables.level_mapping;
        let count = tables.prefilter_level_count;
        let mip = mapping.mip_from_alpha(setting.alpha, count);
        let low = mip.floor().min(f64::from(count) - 2.0);
        let level = |level: f64| {
            let size = tables.prefilter_size.map(|side| side >> level as u32);
            Level {
                alpha: mapping.alpha_from_mip(level, count),
                share: 1.0 - (mip - level).abs(),
                texels: Lookups::texels(tables, &r, size),
            }
        };
        Self {
            setting,
            kernels: ByKernel {
                exact: kernel(Weight::listed("masking")),
                weighted: kernel(tables.prefilter_weight),
            },
            levels: [level(low), level(low + 1.0)],
            along_r: Lookups::along(&r),
        }
    }

    /// Computes both levels for every subset of [`TABULATED`].
    pub(super) fn by_steps(&self) -> HashMap<Coalition, [LevelMeans; 2]> {
        let mut known = HashMap::new();
        TABULATED
            .subsets()
            .map(|steps| {
                (
                    steps,
                    [0, 1].map(|level| self.means(steps, level, &mut known)),
                )
            })
            .collect()
    }

    fn means(
        &self,
        steps: Coalition,
        level_index: usize,
        known: &mut HashMap<MeansKey, Vec<StoredMeans>>,
    ) -> LevelMeans {
        let level = &self.levels[level_index];
        let alpha = if steps.contains(LEVELS) {
            level.alpha
        } else {
            self.setting.alpha
        };
        let splits = self.kernels.map(|kernel| split(*kernel, alpha));
        if level.share == 0.0 {
            return LevelMeans {
                share: 0.0,
                splits,
                means: Vec::new(),
            };
        }
        let is_by_texels = steps.contains(TEXELS);
        let lookups = if is_by_texels {
            &level.texels
        } else {
            &self.along_r
        };
        let key = MeansKey {
            alpha_bits: alpha.to_bits(),
            level: is_by_texels.then_some(level_index),
            is_by_samples: steps.contains(SAMPLES),
        };
        let is_by_samples = key.is_by_samples;
        let stored = known
            .entry(key)
            .or_insert_with(|| self.stored(alpha, lookups, is_by_samples));
        let is_half = steps.contains(STORAGE) && self.setting.tables.storage == StorageFormat::F16;
        LevelMeans {
            share: level.share,
            splits,
            means: lookups
                .taps
                .iter()
                .map(|taps| looked_up(stored, taps, is_half))
                .collect(),
        }
    }

    /// Computes the means in the directions of lookups.
    fn stored(&self, alpha: f64, lookups: &Lookups, is_by_samples: bool) -> Vec<StoredMeans> {
        let setting = self.setting;
        if alpha == 0.0 {
            self.mirrored(lookups)
        } else if is_by_samples && setting.tables.prefilter == PrefilterBy::Sampled {
            self.sampled(alpha, &lookups.directions)
        } else {
            self.convolved(alpha, &lookups.directions)
        }
    }

    /// Computes the means of a mirror. Its level is the map filtered to the level's size, however
    /// the other levels are made.
    fn mirrored(&self, lookups: &Lookups) -> Vec<StoredMeans> {
        let constant = |value: DVec3| {
            let means = Means {
                whole: value,
                below: value,
                grazing: value,
            };
            StoredMeans {
                exact: means,
                weighted: means,
            }
        };
        let setting = self.setting;
        let Some(size) = lookups.level_size else {
            return lookups
                .directions
                .iter()
                .map(|direction| constant(setting.environment.radiance(*direction)))
                .collect();
        };
        let area = |[width, height]: [u32; 2]| f64::from(width) * f64::from(height);
        let lod = 0.5 * (area(setting.filtered.size()) / area(size)).log2();
        lookups
            .directions
            .par_iter()
            .map(|direction| constant(setting.filtered.value(*direction, lod.max(0.0))))
            .collect()
    }

    /// Computes the means by spherical harmonics.
    fn convolved(&self, alpha: f64, directions: &[DVec3]) -> Vec<StoredMeans> {
        let harmonics = self.setting.harmonics;
        let degree = harmonic::degree(alpha).min(harmonics.degree());
        let map = |kernel: &Kernel, part: fn(f64) -> f64| -> SmoothMap {
            let weight = |n_dot_l: f64| kernel.weight(alpha, n_dot_l) * part(n_dot_l);
            harmonics.convolved(&harmonic::factors_of(kernel.brdf, alpha, degree, weight))
        };
        let maps = self
            .kernels
            .map(|kernel| PARTS.map(|part| map(kernel, *part)));
        directions
            .par_iter()
            .map(|direction| maps.map(|maps| maps.map(|map| map.value(*direction))))
            .collect()
    }

    /// Computes the means by the samples of the prefilter.
    fn sampled(&self, alpha: f64, directions: &[DVec3]) -> Vec<StoredMeans> {
        let count = self.setting.tables.prefilter_sample_count;
        let samples: Vec<Sample> = (0..count)
            .map(|index| self.sample(alpha, index, count))
            .filter(|sample| sample.l_local.z > 0.0)
            .collect();
        directions
            .par_iter()
            .map(|direction| self.mean_of_samples(&samples, *direction))
            .collect()
    }

    fn sample(&self, alpha: f64, index: u32, count: u32) -> Sample {
        let model = self.setting.model;
        let h = model.sample_d((SEQUENCES[0].point)(index, count, 0), alpha);
        let l_local = reflect(DVec3::Z, h);
        Sample {
            l_local,
            omega_s: 4.0 / (f64::from(count) * model.d(h, alpha)),
            weights: self
                .kernels
                .map(|kernel| PARTS.map(|part| kernel.weight(alpha, l_local.z) * part(l_local.z))),
        }
    }

    /// Computes the means of one direction as the prefilter does.
    fn mean_of_samples(&self, samples: &[Sample], direction: DVec3) -> StoredMeans {
        let filtered = self.setting.filtered;
        let lod_bias = f64::from(self.setting.tables.prefilter_lod_bias);
        let frame = Frame::from_normal(direction);
        let mut sums = ByKernel::<Parts<WeightedSum>>::default();
        for sample in samples {
            let l = frame.to_world(sample.l_local);
            let omega_p = filtered.texel_solid_angle(l, sample.omega_s);
            let lod = lod_from_solid_angles(sample.omega_s, omega_p) + lod_bias;
            let value = filtered.value(l, lod.max(0.0));
            for (sums, weights) in sums.each_mut().into_iter().zip(sample.weights.each()) {
                for (sum, weight) in sums.each_mut().into_iter().zip(weights.each()) {
                    sum.value += *weight * value;
                    sum.weight += weight;
                }
            }
        }
        sums.map(|sums| {
            sums.map(|sum| {
                if sum.weight == 0.0 {
                    filtered.value(direction, 0.0)
                } else {
                    sum.value / sum.weight
                }
            })
        })
    }
}

/// A sample of the prefilter's lobe.
struct Sample {
    l_local: DVec3,
    /// Solid angle of the sample, sr.
    omega_s: f64,
    weights: ByKernel<Parts<f64>>,
}

#[derive(Clone, Copy, Default)]
struct WeightedSum {
    value: DVec3,
    weight: f64,
}

/// Interpolates stored means, each rounded to half precision if `is_half`.
fn looked_up(stored: &[StoredMeans], taps: &[Tap], is_half: bool) -> StoredMeans {
    let mut sums = StoredMeans::default();
    for tap in taps {
        let stored = &stored[tap.direction];
        for (sums, means) in sums.each_mut().into_iter().zip(stored.each()) {
            for (sum, mean) in sums.each_mut().into_iter().zip(means.each()) {
                *sum += tap.weight * if is_half { rounded(*mean) } else { *mean };
            }
        }
    }
    sums
}

/// Returns the split of a kernel at n = v; a mirror has no grazing part.
fn split(kernel: Kernel, alpha: f64) -> Split {
    if alpha == 0.0 {
        return DVec2::X;
    }
    let integral = |part: fn(f64) -> f64| -> f64 {
        let weight = |n_dot_l: f64| kernel.weight(alpha, n_dot_l) * part(n_dot_l);
        harmonic::integrals(kernel.brdf, alpha, 1, weight)[0]
    };
    DVec2::new(integral(PARTS.below), integral(PARTS.grazing))
}

/// The parts of Fresnel's factor by n·l at n = v.
const PARTS: Parts<fn(f64) -> f64> = Parts {
    whole: |_| 1.0,
    below: |n_dot_l| 1.0 - grazing(n_dot_l),
    grazing,
};

/// Returns Fc at n = v: `v·h = cos(θ_l/2)`.
fn grazing(n_dot_l: f64) -> f64 {
    schlick_weight((0.5 * (1.0 + n_dot_l)).sqrt())
}

/// Rounds to half precision, as tables are stored.
fn rounded(value: DVec3) -> DVec3 {
    let half = |x: f64| f64::from(f16::from_f32((x as f32).min(HALF_MAX)).to_f32());
    DVec3::new(half(value.x), half(value.y), half(value.z))
}
