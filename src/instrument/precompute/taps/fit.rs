//! Finds the taps whose kernels are together closest to a lobe.

use super::chain::{Chain, LEVEL_MIN};
use super::{Tap, TapCount};
use crate::base::math::quadrature::GaussLegendre;
use glam::{DVec2, DVec3};
use std::f64::consts::{FRAC_PI_2, PI};

/// Flux of even light over a small lamp's, in the relative error of several taps. Chosen on five
/// maps.
pub const AMBIENT: f64 = 4.0;

/// Penalty of the squared error of the first moment of the taps: without it light that is linear in
/// direction comes out too dark or too bright. Found on ten maps; builtin environments agree.
pub const MOMENT: f64 = 40.0;
/// Penalty of squared weights: without it two taps of opposite weights cancel where that gains
/// nothing.
const RIDGE: f64 = 1e-3;
/// Penalty of squared parameters: where taps hardly differ, they stay at the lobe's own direction
/// and level.
const PRIOR: f64 = 1e-3;

/// Most levels of a tap over the lobe's own level. Much rougher ones show nothing, which would do
/// for narrow lobes.
const LEVEL_RATIO_MAX: f64 = 2.0;

/// Parameters of `count` taps: of each the angle to the lobe's first moment over `√alpha sin θ`,
/// the logarithm of its level over the lobe's own, and, except for the first, the weight. The first
/// has the rest of the weight.
pub type Parameters = Vec<f64>;

/// Step in a parameter by which the derivative by an angle is taken.
const STEP: f64 = 1e-4;
/// Most steps of one search, and of one step's length.
const STEP_COUNT: u32 = 30;
const TRIAL_COUNT: u32 = 6;
/// A longer step in one parameter is shortened to this.
const STEP_MAX: f64 = 0.5;
/// The search ends at a smaller relative gain.
const GAIN_MIN: f64 = 1e-3;

/// A lobe at the directions at which it is compared with taps.
pub struct Fit<'a> {
    chain: &'a Chain,
    /// Above the plane of incidence; each counts for its mirror image too.
    directions: Vec<DVec3>,
    pub densities: Vec<f64>,
    measures: Vec<f64>,
    /// Measure and objective's weight. Over all nodes the errors of no tap and of one along the
    /// moment add up to 1.
    weights: Vec<f64>,
    /// From the normal to the first moment.
    moment_angle: f64,
    /// `√alpha sin θ`.
    angle_unit: f64,
    own_level: f64,
    level_max: f64,
}

/// Taps at one place of the search.
struct Trial {
    taps: Vec<Tap>,
    kernels: Vec<Vec<[f64; 2]>>,
    residuals: Vec<f64>,
    cost: f64,
}

/// Returns the direction at an angle from the normal towards the mirror direction.
fn direction(angle: f64) -> DVec3 {
    DVec3::new(-angle.sin(), 0.0, angle.cos())
}

/// Returns directions of the upper half about `direction(angle)` with their measures; they gather
/// at the centre and at the plane of incidence.
fn rings(angle: f64, narrowest: f64) -> Vec<(DVec3, f64)> {
    const POWER: f64 = 2.2;
    let centre = direction(angle);
    let tangent = DVec3::new(-angle.cos(), 0.0, -angle.sin());
    let polar = GaussLegendre::<28>::new();
    let azimuth = GaussLegendre::<10>::new();
    let quarter = azimuth
        .nodes
        .iter()
        .zip(&azimuth.weights)
        .map(|(y, weight)| {
            let u = 0.5 * (1.0 + y);
            (
                FRAC_PI_2 * u.powf(POWER),
                weight * FRAC_PI_2 * POWER * u.powf(POWER - 1.0),
            )
        });
    let half: Vec<_> = quarter
        .flat_map(|(phi, weight)| [phi, PI - phi].map(|phi| (phi.sin_cos(), weight)))
        .collect();
    // s = ln tan(γ/2).
    let low = narrowest.ln();
    let high = 1.5;
    let mut found = Vec::with_capacity(polar.nodes.len() * half.len());
    for (x, weight) in polar.nodes.iter().zip(&polar.weights) {
        let s = low + 0.5 * (1.0 + x) * (high - low);
        let sin = 1.0 / s.cosh();
        let ring = 0.5 * weight * (high - low) * sin * sin;
        for ((sin_phi, cos_phi), weight) in &half {
            let l = -s.tanh() * centre + sin * (*cos_phi * tangent + *sin_phi * DVec3::Y);
            found.push((l, ring * weight));
        }
    }
    found
}

/// Returns the weight of a squared difference along `l`, where the lobe has that density. For
/// several taps it is relative, except for lobes so narrow that level 0 shows through, and only
/// light above the horizon counts.
fn weight(count: TapCount, own_level: f64, l: DVec3, density: f64) -> f64 {
    match count {
        TapCount::Two | TapCount::Four if l.z < 0.0 => 0.0,
        TapCount::Two | TapCount::Four if own_level >= 1.0 => {
            (AMBIENT / (4.0 * PI) + density).powi(-2)
        }
        _ => 1.0,
    }
}

impl<'a> Fit<'a> {
    /// Takes a lobe of any scale by its densities along directions; the view lies on the side of
    /// +x.
    pub fn new(
        chain: &'a Chain,
        [n_dot_v, alpha]: [f64; 2],
        moment_angle: f64,
        count: TapCount,
        densities: impl FnOnce(&[DVec3]) -> Vec<f64>,
    ) -> Self {
        let narrowest = 0.02 * alpha * n_dot_v + 1e-5;
        // The lobe may be much narrower than its moment is far from its peak, near r: half of the
        // nodes about each.
        let centres = [n_dot_v.acos(), moment_angle].map(|angle| rings(angle, narrowest));
        let (directions, measures): (Vec<_>, Vec<_>) = centres
            .concat()
            .into_iter()
            .map(|(l, measure)| (l, 0.5 * measure))
            .unzip();
        let mut densities = densities(&directions);
        let whole: f64 = densities
            .iter()
            .zip(&measures)
            .map(|(density, measure)| density * measure)
            .sum();
        densities.iter_mut().for_each(|density| *density /= whole);
        let own_level = chain.level(alpha);
        let weights = (0..directions.len())
            .map(|i| measures[i] * weight(count, own_level, directions[i], densities[i]));
        let mut fit = Self {
            chain,
            weights: weights.collect(),
            directions,
            densities,
            measures,
            moment_angle,
            angle_unit: alpha.sqrt() * (1.0 - n_dot_v * n_dot_v).sqrt(),
            own_level,
            level_max: (LEVEL_RATIO_MAX * own_level).min(chain.last()),
        };
        let single_tap = Tap {
            angle: moment_angle,
            level: own_level,
            weight: 1.0,
        };
        let error = |taps: &[Tap]| fit.square(&fit.residuals(taps, &fit.kernels(taps)));
        let scale = error(&[]) + error(&[single_tap]);
        fit.weights.iter_mut().for_each(|weight| *weight /= scale);
        fit
    }

    pub fn taps(&self, x: &[f64]) -> Vec<Tap> {
        let rest: f64 = 1.0 - x.iter().skip(4).step_by(3).sum::<f64>();
        let tap_of = |[angle, level, weight]: [f64; 3]| Tap {
            angle: (self.moment_angle + angle * self.angle_unit).clamp(-0.3, 1.7),
            level: (self.own_level * level.exp()).clamp(LEVEL_MIN, self.level_max),
            weight,
        };
        let others = x[2..]
            .chunks_exact(3)
            .map(|tap| tap_of([tap[0], tap[1], tap[2]]));
        [tap_of([x[0], x[1], rest])]
            .into_iter()
            .chain(others)
            .collect()
    }

    /// Returns the kernel of a tap at the directions, and its derivative by the level.
    fn kernel(&self, tap: &Tap) -> Vec<[f64; 2]> {
        let about = direction(tap.angle);
        let density = self.chain.lookup(tap.level);
        self.directions
            .iter()
            .map(|l| density(l.dot(about)))
            .collect()
    }

    pub fn kernels(&self, taps: &[Tap]) -> Vec<Vec<[f64; 2]>> {
        taps.iter().map(|tap| self.kernel(tap)).collect()
    }

    /// Returns `Σ w K - ŵ` at the directions.
    pub fn residuals(&self, taps: &[Tap], kernels: &[Vec<[f64; 2]>]) -> Vec<f64> {
        let approximation = |i: usize| {
            taps.iter()
                .zip(kernels)
                .map(|(tap, kernel)| tap.weight * kernel[i][0])
                .sum::<f64>()
        };
        (0..self.directions.len())
            .map(|i| approximation(i) - self.densities[i])
            .collect()
    }

    /// Returns the weighted `∫ (Σ w K - ŵ)²` in the unit of the weights.
    fn square(&self, residuals: &[f64]) -> f64 {
        self.weights
            .iter()
            .zip(residuals)
            .map(|(weight, residual)| weight * residual * residual)
            .sum()
    }

    /// Returns the objective of [`Self::residuals`] without the penalties of the parameters.
    pub fn objective(&self, residuals: &[f64]) -> f64 {
        self.square(residuals) + MOMENT * self.first_moment(residuals).length_squared()
    }

    /// Returns `∫ f l dl` in the plane of incidence, along x and z.
    pub fn first_moment(&self, f: &[f64]) -> DVec2 {
        let parts = self.directions.iter().zip(&self.measures).zip(f);
        parts
            .map(|((l, measure), f)| f * measure * DVec2::new(l.x, l.z))
            .sum()
    }

    fn trial(&self, x: &[f64], near: &[f64], pull: f64) -> Trial {
        let taps = self.taps(x);
        let kernels = self.kernels(&taps);
        let residuals = self.residuals(&taps, &kernels);
        let weights: f64 = taps.iter().map(|tap| tap.weight * tap.weight).sum();
        let far: f64 = x
            .iter()
            .zip(near)
            .map(|(x, near)| pull * (x - near).powi(2) + PRIOR * x * x)
            .sum();
        let cost = self.objective(&residuals) + RIDGE * weights + far;
        Trial {
            taps,
            kernels,
            residuals,
            cost,
        }
    }

    /// Minimises the error and its penalties from `start`, pulled towards `near`, by the method of
    /// Levenberg and Marquardt.
    pub fn solve(&self, start: &[f64], near: &[f64], pull: f64) -> Parameters {
        let mut x = start.to_vec();
        let mut damping = 1e-2;
        let mut least = self.trial(&x, near, pull);
        for _ in 0..STEP_COUNT {
            let NormalEquations { matrix, gradient } =
                self.normal_equations(&x, &least, near, pull);
            let mut gain = 0.0;
            for _ in 0..TRIAL_COUNT {
                let step = solve_positive(&matrix, &gradient, damping);
                let moved: Vec<f64> = x
                    .iter()
                    .zip(&step)
                    .map(|(x, step)| x - step.clamp(-STEP_MAX, STEP_MAX))
                    .collect();
                let trial = self.trial(&moved, near, pull);
                if trial.cost < least.cost {
                    gain = least.cost - trial.cost;
                    (x, least, damping) = (moved, trial, (damping * 0.3).max(1e-9));
                    break;
                }
                damping *= 4.0;
            }
            if gain < GAIN_MIN * least.cost {
                break;
            }
        }
        x
    }

    /// Returns the derivatives of the residuals by each parameter.
    fn jacobian(&self, x: &[f64], trial: &Trial) -> Vec<Vec<f64>> {
        let kernels = &trial.kernels;
        // A moved parameter moves its tap alone, but for the first weight.
        let moved = |index: usize| {
            let mut x = x.to_vec();
            x[index] += STEP;
            self.taps(&x)
        };
        let mut columns: Vec<Vec<f64>> = vec![Vec::new(); x.len()];
        for (k, tap) in trial.taps.iter().enumerate() {
            let first = first_parameter(k);
            let turned = self.kernel(&moved(first)[k]);
            columns[first] = turned
                .iter()
                .zip(&kernels[k])
                .map(|(turned, [value, _])| tap.weight * (turned[0] - value) / STEP)
                .collect();
            let levels = (moved(first + 1)[k].level - tap.level) / STEP;
            columns[first + 1] = kernels[k]
                .iter()
                .map(|[_, slope]| tap.weight * levels * slope)
                .collect();
            if k > 0 {
                columns[first + 2] = kernels[k]
                    .iter()
                    .zip(&kernels[0])
                    .map(|(kernel, first_kernel)| kernel[0] - first_kernel[0])
                    .collect();
            }
        }
        columns
    }

    /// Returns the normal equations of the cost's square roots.
    fn normal_equations(
        &self,
        x: &[f64],
        trial: &Trial,
        near: &[f64],
        pull: f64,
    ) -> NormalEquations {
        let size = x.len();
        let Trial {
            taps, residuals, ..
        } = trial;
        let columns = self.jacobian(x, trial);
        let mut matrix = vec![vec![0.0; size]; size];
        let mut gradient = vec![0.0; size];
        for (i, weight) in self.weights.iter().enumerate() {
            for p in 0..size {
                let weighted = weight * columns[p][i];
                gradient[p] += weighted * residuals[i];
                for q in 0..=p {
                    matrix[p][q] += weighted * columns[q][i];
                }
            }
        }
        let moment = self.first_moment(residuals);
        let moments: Vec<DVec2> = columns
            .iter()
            .map(|column| self.first_moment(column))
            .collect();
        for p in 0..size {
            gradient[p] += MOMENT * moments[p].dot(moment);
            for q in 0..=p {
                matrix[p][q] += MOMENT * moments[p].dot(moments[q]);
            }
        }
        for k in 1..taps.len() {
            let weight_k = first_parameter(k) + 2;
            gradient[weight_k] += RIDGE * (taps[k].weight - taps[0].weight);
            for j in 1..=k {
                let weight_j = first_parameter(j) + 2;
                matrix[weight_k][weight_j] += if j == k { 2.0 * RIDGE } else { RIDGE };
            }
        }
        for p in 0..size {
            matrix[p][p] += pull + PRIOR;
            gradient[p] += pull * (x[p] - near[p]) + PRIOR * x[p];
        }
        NormalEquations { matrix, gradient }
    }
}

/// JᵀJ and Jᵀr.
struct NormalEquations {
    /// Row by row; the lower half is set.
    matrix: Vec<Vec<f64>>,
    gradient: Vec<f64>,
}

/// Returns the index of a tap's angle among the parameters, before its level and its weight. The
/// first tap has no weight of its own.
fn first_parameter(tap: usize) -> usize {
    if tap == 0 { 0 } else { 3 * tap - 1 }
}

/// Solves `(M + damping diag M) x = g` by Cholesky's method. Of M, which is positive definite, the
/// lower half is read.
fn solve_positive(matrix: &[Vec<f64>], g: &[f64], damping: f64) -> Vec<f64> {
    let size = g.len();
    let mut factor = matrix.to_vec();
    let mut x = g.to_vec();
    for i in 0..size {
        factor[i][i] *= 1.0 + damping;
        for j in 0..=i {
            let rest = factor[i][j] - (0..j).map(|k| factor[i][k] * factor[j][k]).sum::<f64>();
            factor[i][j] = if i == j {
                rest.max(f64::MIN_POSITIVE).sqrt()
            } else {
                rest / factor[j][j]
            };
        }
        x[i] = (x[i] - (0..i).map(|k| factor[i][k] * x[k]).sum::<f64>()) / factor[i][i];
    }
    for i in (0..size).rev() {
        x[i] = (x[i] - (i + 1..size).map(|k| factor[k][i] * x[k]).sum::<f64>()) / factor[i][i];
    }
    x
}
