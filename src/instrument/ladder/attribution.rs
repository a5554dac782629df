//! Computes the effect of each step on the error, from the radiance of coalitions.
//!
//! With r the radiance of the empty coalition, the reference, `e_S = E_S - r` and `w = 1/(r² + ε)`,
//! the value of a coalition is its `relmse`, `v(S) = mean of w e_S²`. For the steps δ_i in the
//! ladder's order, which sum to e, the covariance share is `Σ w δ_i e / Σ w e²`.
//!
//! Drawn rungs share their K scrambles. So a step has K estimates δ_ik, and its standard error `se²
//! = Σ_k (δ_ik - δ_i)² / (K (K - 1))` is far smaller than either rung's.

use super::game::{Coalition, Game};
use super::{STEPS, game};
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
    /// The pixels have n·v from the first to below the second; 1 is in the last band.
    pub n_dot_v: [f64; 2],
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

/// Computes attributions over all pixels, then by band of n·v; bands without pixels or error are
/// omitted.
pub fn attributions(case: &Case, bands: &[[f64; 2]]) -> Vec<Attribution> {
    let game = game();
    let reference = (case.radiance)(Coalition::EMPTY);
    let weights: Vec<DVec3> = reference.iter().map(|r| case.epsilon.weight(*r)).collect();
    let mut bands: Vec<Band> = [[0.0, 1.0]]
        .iter()
        .chain(bands)
        .map(|range| Band::new(*range, case.n_dot_v, game.player_count()))
        .collect();
    let mut rungs = vec![Rung::new(case, Coalition::EMPTY, reference.clone())];
    for coalition in game.coalitions() {
        let image = (case.radiance)(coalition);
        for band in &mut bands {
            let error = band.mean(&weights, |pixel| squared(image[pixel] - reference[pixel]));
            band.errors[coalition.index()] = error;
        }
        // Coalitions come after their subsets, so rungs come in the ladder's order.
        if coalition == Coalition::first(rungs.len()) {
            rungs.push(Rung::new(case, coalition, image));
        }
    }
    let ladder = Ladder {
        game,
        weights,
        rungs,
    };
    bands
        .iter()
        .filter(|band| !band.pixels.is_empty())
        .map(|band| ladder.attribution(band))
        .filter(|attribution| attribution.error > 0.0)
        .collect()
}

fn squared(x: DVec3) -> DVec3 {
    x * x
}

/// A range of n·v, its pixels, and the `relmse` over them.
struct Band {
    n_dot_v: [f64; 2],
    pixels: Vec<usize>,
    /// By index of the coalition.
    errors: Vec<f64>,
}

impl Band {
    fn new([low, high]: [f64; 2], n_dot_v: &[f64], player_count: usize) -> Self {
        let is_within = |x: f64| x >= low && (x < high || high == 1.0);
        Self {
            n_dot_v: [low, high],
            pixels: (0..n_dot_v.len())
                .filter(|&pixel| is_within(n_dot_v[pixel]))
                .collect(),
            errors: vec![0.0; 1 << player_count],
        }
    }

    fn error(&self, coalition: Coalition) -> f64 {
        self.errors[coalition.index()]
    }

    /// Computes the weighted mean of a term over pixels and channels.
    fn mean(&self, weights: &[DVec3], term: impl Fn(usize) -> DVec3) -> f64 {
        let sum: DVec3 = self
            .pixels
            .iter()
            .map(|&pixel| weights[pixel] * term(pixel))
            .sum();
        sum.element_sum() / (3 * self.pixels.len()) as f64
    }
}

/// The image after the first steps of the ladder.
struct Rung {
    mean: Vec<DVec3>,
    /// Difference of the image from its mean by scramble; empty if the image is exact.
    deviations: Vec<Vec<DVec3>>,
}

impl Rung {
    fn new(case: &Case, coalition: Coalition, mean: Vec<DVec3>) -> Self {
        let deviation =
            |image: Vec<DVec3>| image.iter().zip(&mean).map(|(x, mean)| x - mean).collect();
        Self {
            deviations: (case.scrambles)(coalition)
                .into_iter()
                .map(deviation)
                .collect(),
            mean,
        }
    }

    fn deviation(&self, scramble: usize, pixel: usize) -> DVec3 {
        self.deviations
            .get(scramble)
            .map_or(DVec3::ZERO, |image| image[pixel])
    }
}

/// The difference that some steps make.
#[derive(Clone, Copy)]
struct Change<'a> {
    from: &'a Rung,
    to: &'a Rung,
}

impl Change<'_> {
    fn mean(self, pixel: usize) -> DVec3 {
        self.to.mean[pixel] - self.from.mean[pixel]
    }

    fn deviation(self, scramble: usize, pixel: usize) -> DVec3 {
        self.to.deviation(scramble, pixel) - self.from.deviation(scramble, pixel)
    }

    /// Returns the mean of all `count` scrambles but one: an image without it lies at `mean -
    /// deviation / (count - 1)`.
    fn mean_without(self, scramble: usize, count: usize, pixel: usize) -> DVec3 {
        let factor = -1.0 / (count as f64 - 1.0);
        self.mean(pixel) + factor * self.deviation(scramble, pixel)
    }
}

/// The images from the reference to the split sum.
struct Ladder {
    game: Game,
    /// `w`, by pixel.
    weights: Vec<DVec3>,
    rungs: Vec<Rung>,
}

impl Ladder {
    fn attribution(&self, band: &Band) -> Attribution {
        let reference = &self.rungs[0];
        let shapley = self.game.shapley(|coalition| band.error(coalition));
        Attribution {
            n_dot_v: band.n_dot_v,
            pixel_count: band.pixels.len(),
            error: band.error(self.game.everybody()),
            noise: self.squared_standard_error(band, |scramble, pixel| {
                reference.deviation(scramble, pixel)
            }),
            steps: (0..STEPS.len())
                .map(|step| self.step_numbers(band, step, shapley[step]))
                .collect(),
        }
    }

    fn step_numbers(&self, band: &Band, step: usize, shapley: f64) -> StepNumbers {
        let required = self.game.smallest_before(step);
        let others = self.game.largest_without(step);
        StepNumbers {
            step: STEPS[step].name,
            share: self.covariance_share(band, step, Change::mean),
            error: band.error(Coalition::first(step + 1)),
            first_in: band.error(required.with(step)) - band.error(required),
            last_out: band.error(self.game.everybody()) - band.error(others),
            shapley,
            step_error: self.step_error(band, step),
            share_error: self.share_error(band, step),
        }
    }

    /// Returns the change that a step makes.
    fn change(&self, step: usize) -> Change<'_> {
        Change {
            from: &self.rungs[step],
            to: &self.rungs[step + 1],
        }
    }

    /// Returns the change that all steps make, the error of the split sum.
    fn whole_change(&self) -> Change<'_> {
        Change {
            from: &self.rungs[0],
            to: &self.rungs[STEPS.len()],
        }
    }

    fn scramble_count(&self) -> usize {
        self.rungs[0].deviations.len()
    }

    /// Computes a step's covariance share, `Σ w δ e / Σ w e²`, from an estimate of changes by
    /// pixel; 0 without error.
    fn covariance_share<'a>(
        &'a self,
        band: &Band,
        step: usize,
        estimate: impl Fn(Change<'a>, usize) -> DVec3,
    ) -> f64 {
        let mut covariance = DVec3::ZERO;
        let mut variance = DVec3::ZERO;
        for &pixel in &band.pixels {
            let weight = self.weights[pixel];
            let error = estimate(self.whole_change(), pixel);
            covariance += weight * estimate(self.change(step), pixel) * error;
            variance += weight * error * error;
        }
        let whole = variance.element_sum();
        if whole > 0.0 {
            covariance.element_sum() / whole
        } else {
            0.0
        }
    }

    /// Computes the standard error of a covariance share by leaving out each scramble in turn; 0
    /// with less than two scrambles.
    fn share_error(&self, band: &Band, step: usize) -> f64 {
        let count = self.scramble_count();
        if count < 2 {
            return 0.0;
        }
        let shares: Vec<f64> = (0..count)
            .map(|scramble| {
                self.covariance_share(band, step, |change, pixel| {
                    change.mean_without(scramble, count, pixel)
                })
            })
            .collect();
        let mean = shares.iter().sum::<f64>() / count as f64;
        let spread: f64 = shares.iter().map(|share| (share - mean).powi(2)).sum();
        (spread * (count - 1) as f64 / count as f64).sqrt()
    }

    /// Computes the standard error of a step over the step; 0 if the step has no effect.
    fn step_error(&self, band: &Band, step: usize) -> f64 {
        let change = self.change(step);
        let size = band.mean(&self.weights, |pixel| squared(change.mean(pixel)));
        if size > f64::EPSILON * band.error(self.game.everybody()) {
            let noise = self
                .squared_standard_error(band, |scramble, pixel| change.deviation(scramble, pixel));
            (noise / size).sqrt()
        } else {
            0.0
        }
    }

    /// Computes the mean over the band of a squared standard error, from deviations by scramble and
    /// pixel; 0 with less than two scrambles.
    fn squared_standard_error(
        &self,
        band: &Band,
        deviation: impl Fn(usize, usize) -> DVec3,
    ) -> f64 {
        let count = self.scramble_count();
        if count < 2 {
            return 0.0;
        }
        let sum_of_squares = |pixel: usize| {
            (0..count)
                .map(|scramble| squared(deviation(scramble, pixel)))
                .sum::<DVec3>()
        };
        band.mean(&self.weights, sum_of_squares) / (count * (count - 1)) as f64
    }
}
