//! Convergence slopes: least squares of ln(error) over ln(samples), with Student's interval.

use serde::Serialize;

/// Slope of ln(error) over ln(samples) with its 95 % interval (Student's t); plain Monte Carlo has -1 in squared error.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Slope {
    pub value: f64,
    pub lo: f64,
    pub hi: f64,
    /// ln(error) at one sample.
    pub intercept: f64,
    pub n: usize,
}

/// Two-sided 95 % quantiles of Student's t for 1 to 10 degrees of freedom; beyond, [`T_NORMAL`] with its first correction.
const T_95: [f64; 10] = [12.706, 4.303, 3.182, 2.776, 2.571, 2.447, 2.365, 2.306, 2.262, 2.228];
/// That of the normal distribution.
pub const T_NORMAL: f64 = 1.960;

/// Two-sided 95 % quantile of Student's t; infinite without a degree of freedom.
pub fn t_95(degrees: usize) -> f64 {
    match degrees {
        0 => f64::INFINITY,
        1..=10 => T_95[degrees - 1],
        // Cornish-Fisher: t = z + (z^3 + z) / 4 dof, good to 0.5 % above 10.
        _ => T_NORMAL + (T_NORMAL.powi(3) + T_NORMAL) / (4.0 * degrees as f64),
    }
}

/// Least-squares slope of ln y over ln x; `None` for fewer than three points, or ones that are not positive.
pub fn slope(points: &[(f64, f64)]) -> Option<Slope> {
    let logs: Vec<(f64, f64)> = points.iter().map(|(x, y)| (x.ln(), y.ln())).collect();
    line(&logs)
}

/// Least-squares line; `None` for fewer than three points, points that are not finite, or one x only.
pub fn line(points: &[(f64, f64)]) -> Option<Slope> {
    if points.len() < 3 || points.iter().any(|(x, y)| !x.is_finite() || !y.is_finite()) {
        return None;
    }
    let n = points.len() as f64;
    let (mean_x, mean_y) = (points.iter().map(|p| p.0).sum::<f64>() / n, points.iter().map(|p| p.1).sum::<f64>() / n);
    let sxx: f64 = points.iter().map(|p| (p.0 - mean_x).powi(2)).sum();
    let sxy: f64 = points.iter().map(|p| (p.0 - mean_x) * (p.1 - mean_y)).sum();
    if sxx == 0.0 {
        return None;
    }
    let value = sxy / sxx;
    let intercept = mean_y - value * mean_x;
    let residual: f64 = points.iter().map(|p| (p.1 - intercept - value * p.0).powi(2)).sum();
    let half = t_95(points.len() - 2) * (residual / (n - 2.0) / sxx).sqrt();
    Some(Slope { value, lo: value - half, hi: value + half, intercept, n: points.len() })
}

/// Mean of numbers with half its 95 % interval (Student's t): infinite for one number, `None` for none or one that is not finite.
pub fn mean_95(numbers: &[f64]) -> Option<(f64, f64)> {
    if numbers.is_empty() || numbers.iter().any(|x| !x.is_finite()) {
        return None;
    }
    let n = numbers.len() as f64;
    let mean = numbers.iter().sum::<f64>() / n;
    let variance = numbers.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / (n - 1.0);
    let half = if numbers.len() < 2 { f64::INFINITY } else { t_95(numbers.len() - 1) * (variance / n).sqrt() };
    Some((mean, half))
}
