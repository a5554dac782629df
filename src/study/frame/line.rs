//! Least-squares lines, and Student's t.

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Line {
    pub slope: f64,
    /// Standard error of the slope, from the residuals.
    pub standard_error: f64,
}

/// Fewer points have no residual.
pub const POINTS_MIN: usize = 3;

impl Line {
    /// `None` below [`POINTS_MIN`] points, for points that are not finite, or for a single x.
    pub fn fit(points: &[[f64; 2]]) -> Option<Self> {
        if points.len() < POINTS_MIN || points.iter().flatten().any(|x| !x.is_finite()) {
            return None;
        }
        let n = points.len() as f64;
        let [mean_x, mean_y] = [0, 1].map(|i| points.iter().map(|point| point[i]).sum::<f64>() / n);
        let sxx: f64 = points.iter().map(|[x, _]| (x - mean_x).powi(2)).sum();
        let sxy: f64 = points
            .iter()
            .map(|[x, y]| (x - mean_x) * (y - mean_y))
            .sum();
        if sxx == 0.0 {
            return None;
        }
        let slope = sxy / sxx;
        let residual: f64 = points
            .iter()
            .map(|[x, y]| (y - mean_y - slope * (x - mean_x)).powi(2))
            .sum();
        let standard_error = (residual / (n - 2.0) / sxx).sqrt();
        Some(Self {
            slope,
            standard_error,
        })
    }
}

/// Two-sided 95 % quantiles of Student's t for 1 to 10 degrees of freedom; beyond, [`NORMAL_95`]
/// with two corrections.
const T_95: [f64; 10] = [
    12.706, 4.303, 3.182, 2.776, 2.571, 2.447, 2.365, 2.306, 2.262, 2.228,
];
/// Two-sided 95 % quantile of the normal distribution.
const NORMAL_95: f64 = 1.960;

/// Two-sided 95 % quantile of Student's t; infinite without a degree of freedom.
pub fn t_95(degrees: usize) -> f64 {
    match degrees {
        0 => f64::INFINITY,
        1..=10 => T_95[degrees - 1],
        // Cornish-Fisher: z + (z^3 + z) / 4 dof + (5 z^5 + 16 z^3 + 3 z) / 96 dof^2, good to 0.1 %
        // above 10.
        _ => {
            let z = NORMAL_95;
            let n = degrees as f64;
            z + (z.powi(3) + z) / (4.0 * n)
                + (5.0 * z.powi(5) + 16.0 * z.powi(3) + 3.0 * z) / (96.0 * n * n)
        }
    }
}

#[cfg(test)]
mod tests;
