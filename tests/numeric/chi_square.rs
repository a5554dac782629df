//! Pearson's chi-square test, and points that are random enough for it.

use fastrand::Rng;
use glam::{DVec2, DVec3};
use libm::erfc;
use splitsum::base::math::sampling::direction_from_polar;
use std::f64::consts::TAU;

/// Chi-square statistic's upper tail, by the Wilson-Hilferty transformation to a normal deviate.
pub fn chi_square_tail(statistic: f64, degrees_of_freedom: f64) -> f64 {
    let variance = 2.0 / (9.0 * degrees_of_freedom);
    let deviate = ((statistic / degrees_of_freedom).cbrt() - (1.0 - variance)) / variance.sqrt();
    0.5 * erfc(deviate / std::f64::consts::SQRT_2)
}

/// The next two numbers in [0, 1). Low-discrepancy points would pass a chi-square test too well.
pub fn xi(random: &mut Rng) -> DVec2 {
    DVec2::new(random.f64(), random.f64())
}

/// Bins of half vectors: `ln tan(θ/2)` about the lobe's width, times azimuth.
struct HalfVectorBins {
    log_low: f64,
    log_step: f64,
}

impl HalfVectorBins {
    const RINGS: usize = 14;
    const SECTORS: usize = 12;

    fn new(alpha: f64) -> Self {
        let (log_low, log_high) = (
            (0.5 * alpha).ln() - 2.5,
            ((0.5 * alpha).ln() + 2.5).min(0.0),
        );
        Self {
            log_low,
            log_step: (log_high - log_low) / Self::RINGS as f64,
        }
    }

    /// Bin of a half vector; the last holds all that lies outside the rings.
    fn index(&self, h: DVec3) -> usize {
        let sin_theta = h.x.hypot(h.y);
        let ring = ((sin_theta / (1.0 + h.z)).ln() - self.log_low) / self.log_step;
        let sector = (h.y.atan2(h.x) / TAU).rem_euclid(1.0) * Self::SECTORS as f64;
        if ring >= 0.0 && ring < Self::RINGS as f64 {
            ring as usize * Self::SECTORS + (sector as usize).min(Self::SECTORS - 1)
        } else {
            Self::RINGS * Self::SECTORS
        }
    }

    /// Probability of each bin under the density `pdf_h`, by the midpoint rule on 128 x 16 cells a
    /// bin, since a bounded cap may end within a ring. The last bin has the rest.
    fn probabilities(&self, pdf_h: impl Fn(DVec3) -> f64) -> Vec<f64> {
        const CELLS: usize = 16;
        const LOG_CELLS: usize = 128;
        let mut bins = vec![0.0; Self::RINGS * Self::SECTORS + 1];
        let step = self.log_step / LOG_CELLS as f64;
        for i in 0..Self::RINGS * LOG_CELLS {
            let t = self.log_low + (i as f64 + 0.5) * step;
            let sin_theta = 1.0 / t.cosh();
            for j in 0..Self::SECTORS * CELLS {
                let turn = (j as f64 + 0.5) / (Self::SECTORS * CELLS) as f64;
                let area = sin_theta * sin_theta * step * TAU / (Self::SECTORS * CELLS) as f64;
                bins[i / LOG_CELLS * Self::SECTORS + j / CELLS] +=
                    area * pdf_h(direction_from_polar(sin_theta, -t.tanh(), turn));
            }
        }
        let inside: f64 = bins.iter().sum();
        bins[Self::RINGS * Self::SECTORS] = (1.0 - inside).max(0.0);
        bins
    }
}

/// Probability of a fit of counts to their means at least this bad, by Pearson's test.
pub fn fit(counts: &[f64], means: &[f64]) -> f64 {
    /// Bins with fewer counts are pooled: below it the statistic is not chi-square distributed.
    const RARE: f64 = 10.0;
    let (mut statistic, mut degrees, mut pooled) = (0.0, -1.0, (0.0, 0.0));
    for (count, mean) in counts.iter().zip(means) {
        if *mean < RARE {
            pooled = (pooled.0 + count, pooled.1 + mean);
        } else {
            statistic += (count - mean) * (count - mean) / mean;
            degrees += 1.0;
        }
    }
    if pooled.0 + pooled.1 > 0.0 {
        statistic += (pooled.0 - pooled.1) * (pooled.0 - pooled.1) / pooled.1.max(1.0);
        degrees += 1.0;
    }
    chi_square_tail(statistic, degrees)
}

pub fn fit_of_half_vectors(alpha: f64, pdf_h: impl Fn(DVec3) -> f64, samples: &[DVec3]) -> f64 {
    let bins = HalfVectorBins::new(alpha);
    let means: Vec<f64> = bins
        .probabilities(pdf_h)
        .iter()
        .map(|p| p * samples.len() as f64)
        .collect();
    let mut counts = vec![0.0; means.len()];
    samples.iter().for_each(|h| counts[bins.index(*h)] += 1.0);
    fit(&counts, &means)
}
