//! Levels whose samples read mips that are too coarse, the usual slip of filtered importance
//! sampling.
//!
//! A sample along l stands for `1/(N p(l))` of solid angle and looks the light up in texels of `4^L`
//! times that. `p = D/4` for GGX at n = v, `p = n·l/π` for irradiance.

use super::cause::Cause;
use super::directions::Directions;
use super::mip_chain::{MipChain, MipSource};
use super::sample::{Sample, Slipped};
use super::sampled_lobe::SampledLobe;
use super::{Truth, fit, has_width};
use glam::DVec3;

/// Range of the levels that are tried, and the steps in it.
const LEVELS_MIN: f64 = 0.75;
const LEVELS_MAX: f64 = 4.0;
const LEVELS_STEP: f64 = 0.25;
/// Approximate number of texels that are tried first.
const FIRST_TEXELS: usize = 120;
/// Bisections around the best.
const REFINED: u32 = 4;
/// Phase of the highest degree between two rings, rad, and the largest step of rings in ln tan(γ/2).
const PHASE_MAX: f64 = 0.5;
const STEP_MAX: f64 = 0.1;
/// Variance along an axis of a linear lookup in mips, over the solid angle of their texels: 1/12
/// of the box that a texel averages, 1/6 of the tent that interpolates.
const LOOKUP_VARIANCE: f64 = 0.25;
/// Largest share of a relMSE that mips of a map leave of the texels tried first, if they are tried
/// on all.
const LIKELY: f64 = 0.8;
/// Largest ratio to the relMSE that mips of the other map leave of them.
const RIVAL: f64 = 2.0;

impl Sample<'_, '_> {
    /// Lists the level by mips that are too coarse by the levels of least error: even blurs, and mips
    /// of a cube and of a lat-long map.
    pub fn coarse_mips(&self, right: &[DVec3]) -> Vec<Slipped> {
        let level = self.level;
        if !has_width(level.alpha) {
            return Vec::new();
        }
        let search = CoarseSearch::new(level.truth, self.lobe(), level.alpha, &self.directions);
        let even = search.least(level.alpha, &|values| self.relmse(&self.stored(values)));
        // The last mips, which wide lobes read at their edges, do not resemble even blurs.
        let range = [LEVELS_MIN, LEVELS_MAX];
        let step = (self.found.len() / FIRST_TEXELS).max(1);
        let first = self.every(step);
        let tries = [MipSource::Cube, MipSource::LatLong].map(|source| MipTry {
            source,
            found: first.by_mips(source, range),
        });
        let right: Vec<DVec3> = right.iter().copied().step_by(step).collect();
        let of_tries = tries.iter().map(|tried| tried.found.relmse);
        let most =
            (RIVAL * of_tries.fold(f64::INFINITY, f64::min)).min(LIKELY * first.relmse(&right));
        let on_all = |tried: &MipTry| {
            let around = [-LEVELS_STEP, LEVELS_STEP];
            let range = around.map(|step| (tried.found.levels + step).max(LEVELS_MIN));
            self.by_mips(tried.source, range).slipped(tried.source)
        };
        let likely = tries.iter().filter(|tried| tried.found.relmse <= most);
        std::iter::once(even.slipped(MipSource::Cube))
            .chain(likely.map(on_all))
            .collect()
    }

    /// Finds the levels in a range of least error by which samples read mips of a map too coarse.
    fn by_mips(&self, source: MipSource, range: [f64; 2]) -> CoarseLevel {
        let level = self.level;
        let means = MipMeans {
            mips: level.lights.mips(source),
            lobe: self.lobe(),
            directions: &self.directions,
        };
        let relmse = |values: &[DVec3]| self.relmse(&self.stored(values));
        means.least(level.alpha, range, &relmse)
    }

    fn lobe(&self) -> SampledLobe {
        SampledLobe {
            kernel: self.level.kernel,
            is_irradiance: self.is_irradiance(),
        }
    }
}

/// Mips of a map, as the samples of a lobe about each direction read them.
pub struct MipMeans<'m> {
    pub mips: &'m MipChain,
    pub lobe: SampledLobe,
    pub directions: &'m Directions,
}

impl MipMeans<'_> {
    /// Finds the levels of least `relmse`, of all that are tried, by which samples of a width read
    /// mips too coarse.
    pub fn least_of_all(&self, alpha: f64, relmse: &dyn Fn(&[DVec3]) -> f64) -> CoarseLevel {
        self.least(alpha, [LEVELS_MIN, LEVELS_MAX], relmse)
    }

    fn least(&self, alpha: f64, range: [f64; 2], relmse: &dyn Fn(&[DVec3]) -> f64) -> CoarseLevel {
        // Bisections step beyond the range by less than a step of it.
        let tried = [range[0] - LEVELS_STEP, range[1] + LEVELS_STEP];
        let rings = self
            .mips
            .ring_means(self.lobe, alpha, tried, self.directions);
        least(range, relmse, &|levels| rings.level(levels))
    }
}

/// Mips of a map on the texels that are tried first.
struct MipTry {
    source: MipSource,
    found: CoarseLevel,
}

/// Searches the levels by which samples read mips too coarse, as even blurs.
///
/// Blurs about l, of a width that depends on the angle to r alone, make a zonal kernel again.
pub struct CoarseSearch {
    lobe: SampledLobe,
    /// Bands of the light at each compared texel.
    bands: Vec<Vec<DVec3>>,
}

/// The level of samples that read mips these many levels too coarse.
pub struct CoarseLevel {
    pub levels: f64,
    pub values: Vec<DVec3>,
    pub relmse: f64,
}

impl CoarseLevel {
    fn slipped(self, source: MipSource) -> Slipped {
        let levels = self.levels;
        Slipped::one(Cause::CoarseMips { levels, source }, self.values)
    }
}

impl CoarseSearch {
    /// Prepares the search for widths from `narrowest` on.
    pub fn new(truth: &Truth, lobe: SampledLobe, narrowest: f64, directions: &Directions) -> Self {
        let degree = fit::degree(narrowest);
        let bands = truth.harmonics.bands(degree, &directions.world);
        Self { lobe, bands }
    }

    /// Finds the level of least `relmse` at a width.
    pub fn least(&self, alpha: f64, relmse: &dyn Fn(&[DVec3]) -> f64) -> CoarseLevel {
        let range = [LEVELS_MIN, LEVELS_MAX];
        least(range, relmse, &|levels| self.values(alpha, levels))
    }

    /// Returns the right level of a width.
    pub fn plain(&self, truth: &Truth, alpha: f64) -> Vec<DVec3> {
        truth.of_bands(&self.bands, alpha)
    }

    fn values(&self, alpha: f64, levels: f64) -> Vec<DVec3> {
        let degree = self.bands.first().map_or(0, |bands| bands.len() - 1);
        let factors = coarse_factors(&self.lobe, alpha, degree, levels);
        let value = |bands: &Vec<DVec3>| -> DVec3 {
            let terms = bands.iter().zip(&factors);
            terms.map(|(band, factor)| *band * *factor).sum()
        };
        self.bands.iter().map(value).collect()
    }
}

/// Finds the number of levels in a range whose `values` have the least relMSE: in steps, then by
/// bisections.
fn least(
    [first, last]: [f64; 2],
    relmse: &dyn Fn(&[DVec3]) -> f64,
    values: &dyn Fn(f64) -> Vec<DVec3>,
) -> CoarseLevel {
    let scored = |levels: f64| {
        let values = values(levels);
        CoarseLevel {
            levels,
            relmse: relmse(&values),
            values,
        }
    };
    let better = |a: CoarseLevel, b: CoarseLevel| if b.relmse < a.relmse { b } else { a };
    let steps = ((last - first) / LEVELS_STEP).ceil() as u32;
    let mut best = scored(first);
    for k in 1..=steps {
        best = better(best, scored(first + LEVELS_STEP * f64::from(k)));
    }
    let mut step = 0.5 * LEVELS_STEP;
    for _ in 0..REFINED {
        let middle = best.levels;
        best = better(better(best, scored(middle - step)), scored(middle + step));
        step *= 0.5;
    }
    best
}

/// Returns the factors of degrees for samples that read mips too coarse.
fn coarse_factors(lobe: &SampledLobe, alpha: f64, degree: usize, levels: f64) -> Vec<f64> {
    let mut sums = vec![0.0; degree + 1];
    let step = |t: f64| f64::min(STEP_MAX, PHASE_MAX * f64::cosh(t) / degree as f64);
    for ring in lobe.rings(alpha, step) {
        let solid_angle = ring.solid_angle * levels.exp2().powi(2);
        add_blurred(
            &mut sums,
            ring.weight,
            ring.cos,
            LOOKUP_VARIANCE * solid_angle,
        );
    }
    let whole = sums[0];
    sums.iter().map(|sum| sum / whole).collect()
}

/// Adds `weight P_l(cos) b_l`, where `b_l = exp(-l (l + 1) σ²/2)` blurs by a Gaussian of the
/// variance σ² along an axis.
fn add_blurred(sums: &mut [f64], weight: f64, cos: f64, variance: f64) {
    let mut before = 0.0;
    let mut current = 1.0;
    for (l, sum) in sums.iter_mut().enumerate() {
        let l = l as f64;
        *sum += weight * current * (-0.5 * l * (l + 1.0) * variance).exp();
        let next = ((2.0 * l + 1.0) * cos * current - l * before) / (l + 1.0);
        before = current;
        current = next;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Without a blur the terms are `P_l`; a narrow blur of `P_l` costs its share of curvature.
    #[test]
    fn blurred_terms_are_legendre_polynomials_of_less_weight() {
        let cos = 0.3;
        let legendre = [1.0, cos, 1.5 * cos * cos - 0.5];
        let mut plain = [0.0; 3];
        add_blurred(&mut plain, 2.0, cos, 0.0);
        let mut blurred = [0.0; 3];
        add_blurred(&mut blurred, 2.0, cos, 1e-4);
        for l in 0..3 {
            assert!((plain[l] - 2.0 * legendre[l]).abs() < 1e-12, "{plain:?}");
            let share = 1.0 - 0.5e-4 * (l * (l + 1)) as f64;
            assert!((blurred[l] / plain[l] - share).abs() < 1e-7, "{blurred:?}");
        }
    }
}
