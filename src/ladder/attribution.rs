//! From the radiance of coalitions to what each step makes of the error.
//!
//! With r the radiance of nobody, the reference, `e_S = E_S - r` and `w = 1/(r² + ε)`, the value of a coalition is its `relmse`,
//! `v(S) = mean of w e_S²`. For the steps δ_i of the ladder's order, which sum to e, the covariance share is `Σ w δ_i e / Σ w e²`.

use super::game::{Coalition, before, coalitions, shapley, without};
use super::{STEPS, needs};
use crate::metrics::Epsilon;
use glam::DVec3;

/// The numbers of one step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StepNumbers {
    /// Covariance share in the ladder's order; shares sum to 1, a negative one cancels error of the others.
    pub share: f64,
    /// `relmse` of the rung, after this step and all before it.
    pub error: f64,
    /// `relmse` that the step adds when it is made first, after those that it needs.
    pub first_in: f64,
    /// `relmse` that goes away when it alone, with those that need it, is made exact.
    pub last_out: f64,
    /// The mean of what it adds over all orders; they sum to the error of the split sum.
    pub shapley: f64,
}

/// The error of the split sum over some pixels, by steps.
#[derive(Clone, Debug, PartialEq)]
pub struct Attribution {
    /// Ends of n·v.
    pub seen_at: [f64; 2],
    pub pixel_count: usize,
    /// `relmse` of all approximations together.
    pub error: f64,
    /// `relmse` that an exact image would have, from the reference's standard error.
    pub noise: f64,
    /// In the order of [`STEPS`].
    pub steps: Vec<StepNumbers>,
}

/// What attributions are made of.
pub struct Case<'a> {
    pub n_dot_v: &'a [f64],
    /// Radiance of a feasible coalition, pixel by pixel.
    pub radiance: &'a dyn Fn(Coalition) -> Vec<DVec3>,
    /// Standard error of the radiance of nobody.
    pub standard_error: &'a [DVec3],
    pub epsilon: Epsilon,
}

fn squared(x: DVec3) -> DVec3 {
    x * x
}

/// Over all pixels and then over those of each band of n·v; bands without pixels or without error are left out.
pub fn attributions(case: &Case, bands: &[[f64; 2]]) -> Vec<Attribution> {
    let (needs, everybody) = (needs(), (1 << STEPS.len()) - 1);
    let reference = (case.radiance)(0);
    let weights: Vec<DVec3> = reference.iter().map(|r| (r * r + case.epsilon.beside_square()).recip()).collect();
    let all = [[0.0, 1.0]];
    let bands: Vec<[f64; 2]> = all.iter().chain(bands).copied().collect();
    let pixels: Vec<Vec<usize>> = bands
        .iter()
        .map(|[lo, hi]| {
            let is_within = |n_dot_v: f64| n_dot_v >= *lo && (n_dot_v < *hi || *hi == 1.0);
            (0..reference.len()).filter(|&pixel| is_within(case.n_dot_v[pixel])).collect()
        })
        .collect();
    let mean = |band: usize, term: &dyn Fn(usize) -> DVec3| -> f64 {
        let sum: DVec3 = pixels[band].iter().map(|&pixel| weights[pixel] * term(pixel)).sum();
        sum.element_sum() / (3 * pixels[band].len()) as f64
    };
    // By band, of every coalition.
    let mut values = vec![vec![0.0; 1 << STEPS.len()]; bands.len()];
    let mut chain = vec![reference.clone()];
    for coalition in coalitions(&needs) {
        let image = (case.radiance)(coalition);
        for (band, values) in values.iter_mut().enumerate() {
            values[coalition as usize] = mean(band, &|pixel| squared(image[pixel] - reference[pixel]));
        }
        // Rungs are the coalitions of the first so many steps: in ascending order, as here.
        if coalition + 1 == 1 << chain.len() {
            chain.push(image);
        }
    }
    let last = &chain[STEPS.len()];
    let of_band = |band: usize| {
        let value = |coalition: Coalition| values[band][coalition as usize];
        let error = value(everybody);
        let shapley = shapley(&needs, value);
        let step = |i: usize| {
            let [from, to] = [&chain[i], &chain[i + 1]];
            let covariance = mean(band, &|pixel| (to[pixel] - from[pixel]) * (last[pixel] - reference[pixel]));
            let (least, most) = (before(i, &needs), without(i, &needs));
            StepNumbers {
                share: covariance / error,
                error: value((1 << (i + 1)) - 1),
                first_in: value(least | 1 << i) - value(least),
                last_out: error - value(most),
                shapley: shapley[i],
            }
        };
        let noise = mean(band, &|pixel| squared(case.standard_error[pixel]));
        Attribution {
            seen_at: bands[band],
            pixel_count: pixels[band].len(),
            error,
            noise,
            steps: (0..STEPS.len()).map(step).collect(),
        }
    };
    let found = (0..bands.len()).filter(|band| !pixels[*band].is_empty()).map(of_band);
    found.filter(|one| one.error > 0.0).collect()
}
