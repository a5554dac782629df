//! The radiance of every coalition of the split sum's steps.
//!
//! docs/estimators.md ("The ladder") has the radiance of a coalition with the kernel K, `(f0 A + B)
//! <K F, L>` or `<K, L>`. K is `D G2 / (4 n·v)`, or with masking approximated `D n·h / (4 v·h)
//! w(l)`; with n = v = r it is `D/4` times G1(l) or w(l). Before n = v = r the reference's passes
//! draw the means. After it K is isotropic about r, so a mean is a convolution `m(r, alpha)`, exact
//! by spherical harmonics. Approximations then apply in this order:
//!
//! - samples: `m` is the prefilter's estimate, for any direction and width;
//! - storage: `m` is rounded to the number format;
//! - texels: `m` is linear between the texels of a level, both levels around alpha by their shares;
//!   else taken at r;
//! - levels: a level has its own width; else each has alpha.

use super::game::Coalition;
use super::{FRESNEL, LEVELS, MASKING, SAMPLES, STORAGE, TABLE, TEXELS, VIEW};
use crate::base::math::frame::Frame;
use crate::base::math::harmonics::{Harmonics, SmoothMap};
use crate::base::math::sequence::SEQUENCES;
use crate::base::names::Listed;
use crate::instrument::brdf::{Brdf, MaskingShadowing, reflect, schlick_weight};
use crate::instrument::environment::Environment;
use crate::instrument::environment::layout::{FilteredMap, lod_from_solid_angles};
use crate::instrument::precompute::dfg::Albedos;
use crate::instrument::precompute::prefilter::{Kernel, Weight, harmonic};
use crate::instrument::precompute::{HALF_MAX, PrecomputeSettings, PrefilterBy, StorageFormat};
use glam::{DVec2, DVec3};
use half::f16;
use rayon::prelude::*;
use std::collections::HashMap;

/// One model and width under one light.
pub struct Setting<'a> {
    pub model: &'static dyn Brdf,
    pub masking: MaskingShadowing,
    pub alpha: f64,
    pub albedos: &'a Albedos,
    pub tables: &'a PrecomputeSettings,
    pub environment: &'a Environment,
    /// Multiplies the environment's radiance.
    pub scale: f64,
    /// Degrees of the environment, up to the degree of the narrowest lobe.
    pub harmonics: &'a Harmonics,
    pub filtered: &'a FilteredMap,
    /// (A, B) from the DFG table, by pixel.
    pub table: Vec<DVec2>,
    /// Normal and view of each pixel in the environment's frame.
    pub frames: &'a [[DVec3; 2]],
    /// Radiance of each scramble.
    pub drawn: Vec<Drawn>,
}

/// Radiance before n = v = r: with masking exact and approximated, each for f0 = 0 and 1.
pub type Drawn = [[Vec<DVec3>; 2]; 2];

/// `<K, L>`, `<K (1 - Fc), L>` and `<K Fc, L>`.
type Means = [DVec3; 3];
/// `∫ K (1 - Fc)` and `∫ K Fc`, up to a common factor.
type Split = DVec2;
/// The means of both kernels: masking exact, then approximated.
type Stored = [Means; 2];

/// Radiance by coalition, for any f0.
pub struct Radiance {
    scale: f64,
    exact: Vec<DVec2>,
    table: Vec<DVec2>,
    /// With masking approximated.
    weighted: Vec<Split>,
    scrambles: Vec<Drawn>,
    /// Mean of the scrambles.
    drawn: Drawn,
    /// Both levels after n = v = r, by the approximated steps of [`TABULATED`].
    tabulated: HashMap<Coalition, [Looked; 2]>,
}

/// One of the two levels around alpha, as looked up.
struct Looked {
    share: f64,
    /// Of each kernel at the level's width.
    splits: [Split; 2],
    /// By pixel; empty for a level without a share.
    means: Vec<Stored>,
}

/// Returns `<K F, L>`, or `<K, L>` with Fresnel approximated.
fn mean([whole, below, grazing]: Means, split: Split, f0: DVec3, is_outside: bool) -> DVec3 {
    if is_outside {
        whole
    } else {
        (f0 * split.x * below + split.y * grazing) / (f0 * split.x + split.y)
    }
}

/// The steps that act on tables.
const TABULATED: [usize; 4] = [LEVELS, TEXELS, SAMPLES, STORAGE];

fn has(coalition: Coalition, step: usize) -> bool {
    coalition >> step & 1 == 1
}

impl Radiance {
    pub fn new(setting: Setting) -> Self {
        let n_dot_v: Vec<f64> = setting.frames.iter().map(|[n, v]| n.dot(*v)).collect();
        let tabulated = Tables::new(&setting).all();
        Self {
            scale: setting.scale,
            exact: n_dot_v
                .iter()
                .map(|n_dot_v| setting.albedos.exact(*n_dot_v))
                .collect(),
            weighted: n_dot_v
                .iter()
                .map(|n_dot_v| setting.albedos.weighted(*n_dot_v))
                .collect(),
            table: setting.table,
            drawn: mean_of(&setting.drawn),
            scrambles: setting.drawn,
            tabulated,
        }
    }

    /// Returns the radiance of a feasible coalition by pixel.
    pub fn of(&self, coalition: Coalition, f0: DVec3) -> Vec<DVec3> {
        self.by(&self.drawn, coalition, f0)
    }

    /// Returns the same as each scramble drew it; empty after n = v = r, where it is exact.
    pub fn scrambles(&self, coalition: Coalition, f0: DVec3) -> Vec<Vec<DVec3>> {
        let drawn = self.scrambles.iter().filter(|_| !has(coalition, VIEW));
        drawn.map(|drawn| self.by(drawn, coalition, f0)).collect()
    }

    fn by(&self, drawn: &Drawn, coalition: Coalition, f0: DVec3) -> Vec<DVec3> {
        let albedo = if has(coalition, TABLE) {
            &self.table
        } else {
            &self.exact
        };
        let (pixels, is_outside) = (0..self.exact.len(), has(coalition, FRESNEL));
        let reflectance = |pixel: usize| f0 * albedo[pixel].x + albedo[pixel].y;
        if has(coalition, VIEW) {
            let acts = TABULATED
                .iter()
                .filter(|step| has(coalition, **step))
                .fold(0, |all, step| all | 1 << step);
            let kernel = usize::from(has(coalition, MASKING));
            let levels = self.tabulated[&acts]
                .iter()
                .filter(|level| level.share > 0.0);
            let of_level = |level: &Looked, pixel: usize| {
                level.share
                    * mean(
                        level.means[pixel][kernel],
                        level.splits[kernel],
                        f0,
                        is_outside,
                    )
            };
            let of_pixel = |pixel| {
                levels
                    .clone()
                    .map(|level| of_level(level, pixel))
                    .sum::<DVec3>()
            };
            return pixels
                .map(|pixel| self.scale * reflectance(pixel) * of_pixel(pixel))
                .collect();
        }
        // `B <K Fc, L>` and `(A + B) <K, L>` are drawn.
        let [grazing, white] = &drawn[usize::from(has(coalition, MASKING))];
        let splits = if has(coalition, MASKING) {
            &self.weighted
        } else {
            &self.exact
        };
        let of_pixel = |pixel: usize| {
            let (exact, split) = (self.exact[pixel], splits[pixel]);
            let (whole, grazing) = (white[pixel] / exact.element_sum(), grazing[pixel] / exact.y);
            let below = (split.element_sum() * whole - split.y * grazing) / split.x;
            reflectance(pixel) * mean([whole, below, grazing], split, f0, is_outside)
        };
        pixels.map(of_pixel).collect()
    }
}

fn mean_of(scrambles: &[Drawn]) -> Drawn {
    std::array::from_fn(|masking| {
        std::array::from_fn(|f0| {
            let mean = |pixel: usize| {
                scrambles
                    .iter()
                    .map(|of| of[masking][f0][pixel])
                    .sum::<DVec3>()
            };
            (0..scrambles[0][0][0].len())
                .map(|pixel| mean(pixel) / scrambles.len() as f64)
                .collect()
        })
    })
}

/// Indices into a place's directions, with weights.
type Stencil = Vec<(usize, f64)>;

/// Directions of lookups, and the lookups of each pixel.
struct Place {
    directions: Vec<DVec3>,
    stencils: Vec<Stencil>,
    /// Whether they are texels of a level with faces of `size`; otherwise they are r.
    is_level: bool,
    size: [u32; 2],
}

/// One of the two levels around alpha.
struct Level {
    alpha: f64,
    share: f64,
    /// At r, and at the level's texels.
    places: [usize; 2],
}

struct Tables<'a> {
    setting: &'a Setting<'a>,
    kernels: [Kernel; 2],
    places: [Place; 3],
    levels: [Level; 2],
}

impl<'a> Tables<'a> {
    fn new(setting: &'a Setting<'a>) -> Self {
        let tables = setting.tables;
        let masked = Weight::listed("masking");
        let kernels = [masked, tables.prefilter_weight]
            .map(|weight| Kernel::new(setting.model, weight, setting.masking));
        let r: Vec<DVec3> = setting
            .frames
            .iter()
            .map(|[n, v]| reflect(*v, *n))
            .collect();
        let (mapping, count) = (tables.level_mapping, tables.prefilter_level_count);
        let mip = mapping.mip_from_alpha(setting.alpha, count);
        let low = mip.floor().min(f64::from(count) - 2.0);
        let level = |place: usize| {
            let at = low + place as f64 - 1.0;
            let share = 1.0 - (mip - at).abs();
            Level {
                alpha: mapping.alpha_from_mip(at, count),
                share,
                places: [0, place],
            }
        };
        let size = |level: f64| tables.prefilter_size.map(|side| side >> level as u32);
        let mirrored = Place {
            stencils: (0..r.len()).map(|pixel| vec![(pixel, 1.0)]).collect(),
            directions: r.clone(),
            is_level: false,
            size: [0; 2],
        };
        let places = [
            mirrored,
            texels(tables, &r, size(low)),
            texels(tables, &r, size(low + 1.0)),
        ];
        Self {
            setting,
            kernels,
            places,
            levels: [level(1), level(2)],
        }
    }

    /// Computes both levels for every subset of the steps.
    fn all(&self) -> HashMap<Coalition, [Looked; 2]> {
        let mut known = HashMap::new();
        let subsets = (0..1 << TABULATED.len()).map(|bits: usize| {
            TABULATED
                .iter()
                .enumerate()
                .filter(|(i, _)| bits >> i & 1 == 1)
                .fold(0, |all, (_, step)| all | 1 << step)
        });
        subsets
            .map(|acts| (acts, self.means(acts, &mut known)))
            .collect()
    }

    fn means(
        &self,
        acts: Coalition,
        known: &mut HashMap<(u64, usize, bool), Vec<Stored>>,
    ) -> [Looked; 2] {
        self.levels.each_ref().map(|level| {
            let alpha = if has(acts, LEVELS) {
                level.alpha
            } else {
                self.setting.alpha
            };
            let splits = self.kernels.map(|kernel| split(kernel, alpha));
            if level.share == 0.0 {
                return Looked {
                    share: 0.0,
                    splits,
                    means: Vec::new(),
                };
            }
            let mut sums = vec![Stored::default(); self.setting.frames.len()];
            let place = level.places[usize::from(has(acts, TEXELS))];
            let by_samples = has(acts, SAMPLES);
            let stored = known
                .entry((alpha.to_bits(), place, by_samples))
                .or_insert_with(|| self.stored(alpha, &self.places[place], by_samples));
            let is_half = has(acts, STORAGE) && self.setting.tables.storage == StorageFormat::F16;
            for (sum, stencil) in sums.iter_mut().zip(&self.places[place].stencils) {
                for &(at, weight) in stencil {
                    for (sum, means) in sum.iter_mut().flatten().zip(stored[at].iter().flatten()) {
                        *sum += weight * if is_half { rounded(*means) } else { *means };
                    }
                }
            }
            Looked {
                share: level.share,
                splits,
                means: sums,
            }
        })
    }

    /// Computes the means in the directions of a place.
    fn stored(&self, alpha: f64, place: &Place, by_samples: bool) -> Vec<Stored> {
        let (setting, is_sampled) = (
            self.setting,
            self.setting.tables.prefilter == PrefilterBy::Sampled,
        );
        match (alpha == 0.0, by_samples) {
            // The mirror's level is the map filtered to its size, however the others are made.
            (true, _) if place.is_level => {
                let sides = |[width, height]: [u32; 2]| f64::from(width) * f64::from(height);
                let lod = 0.5 * (sides(setting.filtered.size()) / sides(place.size)).log2();
                let value =
                    |direction: &DVec3| [[setting.filtered.value(*direction, lod.max(0.0)); 3]; 2];
                place.directions.par_iter().map(value).collect()
            }
            (true, _) => place
                .directions
                .iter()
                .map(|direction| [[setting.environment.radiance(*direction); 3]; 2])
                .collect(),
            (false, true) if is_sampled => self.sampled(alpha, &place.directions),
            (false, _) => self.convolved(alpha, &place.directions),
        }
    }

    fn convolved(&self, alpha: f64, directions: &[DVec3]) -> Vec<Stored> {
        let harmonics = self.setting.harmonics;
        let degree = harmonic::degree(alpha).min(harmonics.degree());
        let map = |kernel: &Kernel, part: fn(f64) -> f64| -> SmoothMap {
            let weight = |n_dot_l: f64| kernel.weight(alpha, n_dot_l) * part(n_dot_l);
            harmonics.convolved(&harmonic::factors_of(kernel.brdf, alpha, degree, weight))
        };
        let maps = self
            .kernels
            .each_ref()
            .map(|kernel| PARTS.map(|part| map(kernel, part)));
        directions
            .par_iter()
            .map(|d| {
                maps.each_ref()
                    .map(|maps| maps.each_ref().map(|map| map.value(*d)))
            })
            .collect()
    }

    fn sampled(&self, alpha: f64, directions: &[DVec3]) -> Vec<Stored> {
        let (setting, model) = (self.setting, self.setting.model);
        let count = setting.tables.prefilter_sample_count;
        let of_point = |i: u32| {
            let h = model.sample_d((SEQUENCES[0].point)(i, count, 0), alpha);
            let l = reflect(DVec3::Z, h);
            let weights = self
                .kernels
                .each_ref()
                .map(|kernel| PARTS.map(|part| kernel.weight(alpha, l.z) * part(l.z)));
            (l, 4.0 / (f64::from(count) * model.d(h, alpha)), weights)
        };
        let points: Vec<_> = (0..count)
            .map(of_point)
            .filter(|(l, ..)| l.z > 0.0)
            .collect();
        let mean = |direction: &DVec3| -> Stored {
            let frame = Frame::from_normal(*direction);
            let (mut sums, mut wholes) = (Stored::default(), [[0.0; 3]; 2]);
            for (l_local, omega_s, weights) in &points {
                let l = frame.to_world(*l_local);
                let omega_p = setting.filtered.texel_solid_angle(l, *omega_s);
                let lod = lod_from_solid_angles(*omega_s, omega_p)
                    + f64::from(setting.tables.prefilter_lod_bias);
                let value = setting.filtered.value(l, lod.max(0.0));
                for (kernel, weights) in weights.iter().enumerate() {
                    for (part, weight) in weights.iter().enumerate() {
                        sums[kernel][part] += *weight * value;
                        wholes[kernel][part] += weight;
                    }
                }
            }
            let mirror = || setting.filtered.value(*direction, 0.0);
            let mean = |kernel: usize, part: usize| match wholes[kernel][part] {
                0.0 => mirror(),
                whole => sums[kernel][part] / whole,
            };
            std::array::from_fn(|kernel| std::array::from_fn(|part| mean(kernel, part)))
        };
        directions.par_iter().map(mean).collect()
    }
}

/// Returns the split of a kernel at n = v; a mirror has no grazing part.
fn split(kernel: Kernel, alpha: f64) -> Split {
    if alpha == 0.0 {
        return DVec2::X;
    }
    let of = |part: fn(f64) -> f64| -> f64 {
        let weight = |n_dot_l: f64| kernel.weight(alpha, n_dot_l) * part(n_dot_l);
        harmonic::integrals(kernel.brdf, alpha, 1, weight)[0]
    };
    DVec2::new(of(PARTS[1]), of(PARTS[2]))
}

/// 1, 1 - Fc and Fc by n·l at n = v.
const PARTS: [fn(f64) -> f64; 3] = [|_| 1.0, |n_dot_l| 1.0 - grazing(n_dot_l), grazing];

/// Returns Fc at n = v: `v·h = cos(θ_l/2)`.
fn grazing(n_dot_l: f64) -> f64 {
    schlick_weight((0.5 * (1.0 + n_dot_l)).sqrt())
}

/// Rounds to half precision, as tables are stored.
pub fn rounded(value: DVec3) -> DVec3 {
    let half = |x: f64| f64::from(f16::from_f32((x as f32).min(HALF_MAX)).to_f32());
    DVec3::new(half(value.x), half(value.y), half(value.z))
}

/// Collects the texels of a level that lookups in these directions read.
fn texels(tables: &PrecomputeSettings, r: &[DVec3], size: [u32; 2]) -> Place {
    let (mut places, mut directions) = (HashMap::new(), Vec::new());
    let extent = DVec2::new(size[0].into(), size[1].into());
    let stencil = |r: &DVec3| -> Stencil {
        let texel = |(texel, weight): ([u32; 3], f64)| {
            let at = *places.entry(texel).or_insert_with(|| {
                let [face, x, y] = texel;
                let centre = DVec2::new(x.into(), y.into()) + 0.5;
                directions.push((tables.layout.direction)(face, centre / extent));
                directions.len() - 1
            });
            (at, weight)
        };
        tables
            .layout
            .stencil(*r, size)
            .into_iter()
            .map(texel)
            .collect()
    };
    Place {
        stencils: r.iter().map(stencil).collect(),
        directions,
        is_level: true,
        size,
    }
}
