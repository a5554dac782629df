//! Levels of filters that are right but for one step: samples that read mips too coarse, and faces
//! that are filtered one by one.

use super::cause::Cause;
use super::directions::Directions;
use super::exact::mirror;
use super::sample::{Sample, Slipped};
use super::{Truth, fit, has_width};
use crate::bake::container::FACE_COUNT;
use crate::instrument::environment::layout::LAYOUTS;
use crate::instrument::precompute::prefilter::Kernel;
use glam::DVec3;
use rayon::prelude::*;
use std::f64::consts::TAU;

/// Number of samples that the estimate of coarse mips assumes, as most bakers take.
pub const SAMPLES: f64 = 1024.0;
/// Range of the levels that are tried, and the steps in it.
const LEVELS_MIN: f64 = 0.75;
const LEVELS_MAX: f64 = 4.0;
const LEVELS_STEP: f64 = 0.25;
/// Bisections around the best.
const REFINED: u32 = 4;
/// Phase of the highest degree between two nodes, rad.
const PHASE_MAX: f64 = 0.5;
/// Side of the faces that are filtered one by one, texels: a twentieth of a radian.
const FACE_SIDE: u32 = 40;
/// Lobes narrower than this have too few texels in such a face.
const FACE_ALPHA_MIN: f64 = 0.05;
/// Variance along an axis of a linear lookup in mips, over the solid angle of their texels: 1/12
/// of the box that a texel averages, 1/6 of the tent that interpolates.
const LOOKUP_VARIANCE: f64 = 0.25;
/// Smallest sum of weights that is divided by.
const SUM_MIN: f64 = 1e-30;

impl Sample<'_, '_> {
    /// The level whose samples read mips too coarse, by the levels of least error.
    pub fn coarse_mips(&self) -> Option<Slipped> {
        let level = self.level;
        if !has_width(level.alpha) || self.is_irradiance() {
            return None;
        }
        let search = CoarseSearch::new(level.truth, level.kernel, &self.directions);
        let best = search.least(level.alpha, &|values| self.relmse(values));
        let levels = best.levels;
        Some(Slipped::one(Cause::CoarseMips { levels }, best.values))
    }

    /// The level whose texels average the light of their own face only.
    pub fn faces_alone(&self) -> Option<Slipped> {
        let level = self.level;
        let is_cube = level.directions.layout.face_count as usize == FACE_COUNT;
        if !is_cube || level.alpha < FACE_ALPHA_MIN || self.is_irradiance() {
            return None;
        }
        let light = Directions::new(&LAYOUTS[0], level.directions.axes, [FACE_SIDE; 2]);
        let radiance = mirror(level.truth.environment, &light);
        let texel_count = (FACE_SIDE * FACE_SIDE) as usize;
        // A level is not shared between threads.
        let kernel = level.kernel;
        let alpha = level.alpha;
        let directions = &self.directions;
        let value = |index: usize| {
            let r = directions.world[index];
            let [face, _, _] = directions.texel_of(index);
            let mut sum = DVec3::ZERO;
            let mut whole = 0.0;
            let texels = face * texel_count..(face + 1) * texel_count;
            let solid_angles = &light.weights[texels.clone()];
            let world = &light.world[texels.clone()];
            for ((solid_angle, l), color) in solid_angles.iter().zip(world).zip(&radiance[texels]) {
                let weight = solid_angle * lobe(&kernel, alpha, r, *l);
                sum += weight * *color;
                whole += weight;
            }
            sum / f64::max(whole, SUM_MIN)
        };
        let values = (0..directions.world.len())
            .into_par_iter()
            .map(value)
            .collect();
        Some(Slipped::one(Cause::FacesAlone, values))
    }
}

/// Searches the levels by which samples read mips too coarse.
///
/// A sample along l stands for `1/(N p(l))` of solid angle, `p = D/4` at n = v, and looks the light
/// up in texels of `4^L` times that. Blurs about l, of a width that depends on the angle to r
/// alone, make a zonal kernel again.
pub struct CoarseSearch {
    kernel: Kernel,
    /// Bands of the light at each compared texel.
    bands: Vec<Vec<DVec3>>,
}

/// The level of samples that read mips these many levels too coarse.
pub struct CoarseLevel {
    pub levels: f64,
    pub values: Vec<DVec3>,
    pub relmse: f64,
}

impl CoarseSearch {
    pub fn new(truth: &Truth, kernel: Kernel, directions: &Directions) -> Self {
        let bands = truth.harmonics.bands(fit::DEGREE_MAX, &directions.world);
        Self { kernel, bands }
    }

    /// Finds the level of least `relmse` at a width.
    pub fn least(&self, alpha: f64, relmse: &dyn Fn(&[DVec3]) -> f64) -> CoarseLevel {
        let scored = |levels: f64| {
            let values = self.values(alpha, levels);
            CoarseLevel {
                levels,
                relmse: relmse(&values),
                values,
            }
        };
        let better = |a: CoarseLevel, b: CoarseLevel| if b.relmse < a.relmse { b } else { a };
        let steps = ((LEVELS_MAX - LEVELS_MIN) / LEVELS_STEP) as u32;
        let mut best = scored(LEVELS_MIN);
        for k in 1..=steps {
            best = better(best, scored(LEVELS_MIN + LEVELS_STEP * f64::from(k)));
        }
        let mut step = 0.5 * LEVELS_STEP;
        for _ in 0..REFINED {
            let middle = best.levels;
            best = better(better(best, scored(middle - step)), scored(middle + step));
            step *= 0.5;
        }
        best
    }

    /// Returns the right level of a width.
    pub fn plain(&self, truth: &Truth, alpha: f64) -> Vec<DVec3> {
        truth.of_bands(&self.bands, alpha)
    }

    fn values(&self, alpha: f64, levels: f64) -> Vec<DVec3> {
        let degree = self.bands.first().map_or(0, |bands| bands.len() - 1);
        let factors = coarse_factors(&self.kernel, alpha, degree, levels);
        let value = |bands: &Vec<DVec3>| -> DVec3 {
            let terms = bands.iter().zip(&factors);
            terms.map(|(band, factor)| *band * *factor).sum()
        };
        self.bands.iter().map(value).collect()
    }
}

/// Returns the kernel about r at a direction of light.
fn lobe(kernel: &Kernel, alpha: f64, r: DVec3, l: DVec3) -> f64 {
    let cos = r.dot(l);
    if cos <= 0.0 {
        return 0.0;
    }
    let half = (0.5 * (1.0 + cos)).sqrt();
    kernel.weight(alpha, cos) * d(kernel, alpha, half)
}

fn d(kernel: &Kernel, alpha: f64, n_dot_h: f64) -> f64 {
    let h = DVec3::new((1.0 - n_dot_h * n_dot_h).max(0.0).sqrt(), 0.0, n_dot_h);
    kernel.brdf.d(h, alpha)
}

/// Returns the factors of degrees for samples that read mips too coarse.
fn coarse_factors(kernel: &Kernel, alpha: f64, degree: usize, levels: f64) -> Vec<f64> {
    let mut sums = vec![0.0; degree + 1];
    // In t = ln tan(γ/2), as the exact factors; γ ends at the hemisphere's edge.
    let mut t = 0.0;
    let low = alpha.ln() - 8.0;
    while t > low {
        let step = f64::min(0.1, PHASE_MAX * f64::cosh(t) / degree as f64);
        let middle = t - 0.5 * step;
        let sin = 1.0 / middle.cosh();
        let cos = -middle.tanh();
        let density = d(kernel, alpha, (0.5 * (1.0 + cos)).sqrt());
        let weight = step * TAU * sin * sin * density * kernel.weight(alpha, cos);
        let angle = levels.exp2().powi(2) / (SAMPLES * 0.25 * density);
        add_blurred(&mut sums, weight, cos, LOOKUP_VARIANCE * angle);
        t -= step;
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
