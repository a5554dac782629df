//! Computes the effect of each step on the error, from the radiance of coalitions.
//!
//! With r the radiance of the empty coalition, the reference, `e_S = E_S - r` and `w = 1/(r² + ε)`,
//! the value of a coalition is its `relmse`, `v(S) = mean of w e_S²`. For the steps δ_i in the
//! ladder's order, which sum to e, the covariance share is `Σ w δ_i e / Σ w e²`.
//!
//! Drawn rungs share their K scrambles. So a step has K estimates δ_ik, and its standard error `se²
//! = Σ_k (δ_ik - δ_i)² / (K (K - 1))` is far smaller than either rung's.

use super::game::{Coalition, before, coalitions, shapley, without};
use super::{STEPS, needs};
use crate::instrument::metrics::Epsilon;
use glam::DVec3;

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StepNumbers {
    pub step: &'static str,
    /// Covariance share in the ladder's order. Shares sum to 1; a negative one cancels error of the
    /// others.
    pub share: f64,
    /// `relmse` of the rung after this step and all before it.
    pub error: f64,
    /// `relmse` that the step adds if made first, after the steps that it needs.
    pub first_in: f64,
    /// `relmse` removed by making the step exact, with those that need it.
    pub last_out: f64,
    /// Mean increase over all orders; these sum to the error of the split sum.
    pub shapley: f64,
    /// Standard error of the step over the step, each as the root of the weighted mean square over
    /// pixels; 0 for a step that is not drawn or has no effect.
    pub step_error: f64,
    /// Standard error of the share, by leaving out each scramble in turn \[Efron79\].
    pub share_error: f64,
}

/// The error of a term over some pixels, by steps.
#[derive(Clone, Debug, PartialEq)]
pub struct Attribution {
    pub seen_at: [f64; 2],
    pub pixel_count: usize,
    /// `relmse` of all approximations together.
    pub error: f64,
    /// `relmse` of an exact image, from the reference's standard error.
    pub noise: f64,
    /// In the ladder's order.
    pub steps: Vec<StepNumbers>,
}

/// Input of [`attributions`].
pub struct Case<'a> {
    pub n_dot_v: &'a [f64],
    /// Returns the radiance of a feasible coalition by pixel.
    pub radiance: &'a dyn Fn(Coalition) -> Vec<DVec3>,
    /// Returns the same as each scramble drew it; empty if it is exact.
    pub scrambles: &'a dyn Fn(Coalition) -> Vec<Vec<DVec3>>,
    pub epsilon: Epsilon,
}

fn squared(x: DVec3) -> DVec3 {
    x * x
}

/// Computes a step's covariance share, `Σ w δ e / Σ w e²`, from each pixel's weight, step and
/// error; 0 without error.
pub fn covariance_share(pixels: impl Iterator<Item = [DVec3; 3]>) -> f64 {
    let add = |[of_step, whole]: [DVec3; 2], [w, step, error]: [DVec3; 3]| {
        [of_step + w * step * error, whole + w * error * error]
    };
    let [of_step, whole] = pixels.fold([DVec3::ZERO; 2], add).map(DVec3::element_sum);
    if whole > 0.0 { of_step / whole } else { 0.0 }
}

/// Difference of an image from its mean in each scramble.
type Deviations = Vec<Vec<DVec3>>;

/// Returns the deviation of `to` minus the one of `from`; exact images have none.
fn difference(to: &Deviations, from: &Deviations, pixel: usize, scramble: usize) -> DVec3 {
    let of = |image: &Deviations| {
        image
            .get(scramble)
            .map_or(DVec3::ZERO, |image| image[pixel])
    };
    of(to) - of(from)
}

/// Computes attributions over all pixels, then by band of n·v; bands without pixels or error are
/// omitted.
pub fn attributions(case: &Case, bands: &[[f64; 2]]) -> Vec<Attribution> {
    let steps = STEPS;
    let (needs, everybody) = (needs(), (1 << steps.len()) - 1);
    let reference = (case.radiance)(0);
    let weights: Vec<DVec3> = reference.iter().map(|r| case.epsilon.weight(*r)).collect();
    let all = [[0.0, 1.0]];
    let bands: Vec<[f64; 2]> = all.iter().chain(bands).copied().collect();
    let pixels: Vec<Vec<usize>> = bands
        .iter()
        .map(|[lo, hi]| {
            let is_within = |n_dot_v: f64| n_dot_v >= *lo && (n_dot_v < *hi || *hi == 1.0);
            (0..reference.len())
                .filter(|&pixel| is_within(case.n_dot_v[pixel]))
                .collect()
        })
        .collect();
    let mean = |band: usize, term: &dyn Fn(usize) -> DVec3| -> f64 {
        let sum: DVec3 = pixels[band]
            .iter()
            .map(|&pixel| weights[pixel] * term(pixel))
            .sum();
        sum.element_sum() / (3 * pixels[band].len()) as f64
    };
    // By band, for every coalition.
    let mut values = vec![vec![0.0; 1 << steps.len()]; bands.len()];
    let mut chain = vec![reference.clone()];
    for coalition in coalitions(&needs) {
        let image = (case.radiance)(coalition);
        for (band, values) in values.iter_mut().enumerate() {
            values[coalition as usize] =
                mean(band, &|pixel| squared(image[pixel] - reference[pixel]));
        }
        // Rungs are the coalitions of the first steps, met in ascending order.
        if coalition + 1 == 1 << chain.len() {
            chain.push(image);
        }
    }
    let drawn: Vec<Deviations> = (0..chain.len())
        .map(|rung| {
            let scrambles = (case.scrambles)((1 << rung) - 1);
            let above = |image: Vec<DVec3>| {
                image
                    .iter()
                    .zip(&chain[rung])
                    .map(|(own, mean)| own - mean)
                    .collect()
            };
            scrambles.into_iter().map(above).collect()
        })
        .collect();
    let (last, exact, count) = (&chain[steps.len()], Deviations::new(), drawn[0].len());
    // Mean square of the standard error of the difference of two rungs.
    let noise_of = |band: usize, [from, to]: [&Deviations; 2]| {
        let of_pixel = |pixel| {
            (0..count)
                .map(|k| squared(difference(to, from, pixel, k)))
                .sum::<DVec3>()
        };
        if count > 1 {
            mean(band, &of_pixel) / (count * (count - 1)) as f64
        } else {
            0.0
        }
    };
    let of_band = |band: usize| {
        let value = |coalition: Coalition| values[band][coalition as usize];
        let error = value(everybody);
        let shapley = shapley(&needs, value);
        // Without scramble k an image lies at `mean - deviation / (count - 1)`.
        let left = -1.0 / (count as f64 - 1.0);
        let without_scramble = |k: usize| {
            let end = |pixel: usize| {
                last[pixel] - reference[pixel]
                    + left * difference(&drawn[steps.len()], &drawn[0], pixel, k)
            };
            let share = |i: usize| {
                let own = |pixel: usize| {
                    chain[i + 1][pixel] - chain[i][pixel]
                        + left * difference(&drawn[i + 1], &drawn[i], pixel, k)
                };
                covariance_share(
                    pixels[band]
                        .iter()
                        .map(|&pixel| [weights[pixel], own(pixel), end(pixel)]),
                )
            };
            (0..steps.len()).map(share).collect::<Vec<_>>()
        };
        let shares: Vec<Vec<f64>> = (0..count)
            .filter(|_| count > 1)
            .map(without_scramble)
            .collect();
        let step = |i: usize| {
            let [from, to] = [&chain[i], &chain[i + 1]];
            let of_pixel = |&pixel: &usize| {
                [
                    weights[pixel],
                    to[pixel] - from[pixel],
                    last[pixel] - reference[pixel],
                ]
            };
            let (least, most) = (before(i, &needs), without(i, &needs));
            let size = mean(band, &|pixel| squared(to[pixel] - from[pixel]));
            let noise = noise_of(band, [&drawn[i], &drawn[i + 1]]);
            let centre = shares.iter().map(|of| of[i]).sum::<f64>() / count as f64;
            let spread: f64 = shares.iter().map(|of| (of[i] - centre).powi(2)).sum();
            StepNumbers {
                step: steps[i].name,
                share: covariance_share(pixels[band].iter().map(of_pixel)),
                error: value((1 << (i + 1)) - 1),
                first_in: value(least | 1 << i) - value(least),
                last_out: error - value(most),
                shapley: shapley[i],
                step_error: if size > f64::EPSILON * error {
                    (noise / size).sqrt()
                } else {
                    0.0
                },
                share_error: if count > 1 {
                    (spread * (count - 1) as f64 / count as f64).sqrt()
                } else {
                    0.0
                },
            }
        };
        Attribution {
            seen_at: bands[band],
            pixel_count: pixels[band].len(),
            error,
            noise: noise_of(band, [&exact, &drawn[0]]),
            steps: (0..steps.len()).map(step).collect(),
        }
    };
    let found = (0..bands.len())
        .filter(|band| !pixels[*band].is_empty())
        .map(of_band);
    found.filter(|one| one.error > 0.0).collect()
}
