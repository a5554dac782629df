//! Student's interval of a mean.

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

/// Mean of numbers with half its 95 % interval: infinite for one number, `None` for none or one that is not finite.
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
