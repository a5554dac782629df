//! The regularised incomplete beta function `I_x(n, 1/2)` in f64, for `n >= 1`.
//!
//! With `x = sin² θ = exp(-w²)`, `∫_0^θ sin^(2n-1) ψ dψ = ∫_w^∞ exp(-κ t²) S(t²) dt`, `κ = n -
//! 1/4`, where `S(u) = √((u/2)/sinh(u/2))` is even and flat at 0. Its Taylor series, integrated
//! term by term, is asymptotic in `1/κ²`. For small n, the recurrence `I_x(n, 1/2) = I_x(n + 1,
//! 1/2) + x^n √(1 - x) / (n B(n, 1/2))`, a sum of positive terms, leads to a large n. The exponent
//! n - 1/4 makes S even.

use libm::erfc;
use std::f64::consts::PI;

/// Coefficients of `u^(2j)` in S(u).
const SERIES: [f64; 6] = [
    1.0,
    -1.0 / 48.0,
    1.0 / 2560.0,
    -61.0 / 7_741_440.0,
    1261.0 / 7_431_782_400.0,
    -79.0 / 20_761_804_800.0,
];
/// From this n on, the first dropped term is below 1e-15.
const ASYMPTOTIC_FROM: f64 = 25.0;

/// Counts the steps from `n` up to where the series holds.
fn step_count(n: f64) -> u32 {
    (ASYMPTOTIC_FROM - n).ceil().max(0.0) as u32
}

/// Computes `√κ ∫_w^∞ exp(-κ t²) S(t²) dt` with `z = √κ w`, for a large κ.
fn scaled_integral(kappa: f64, z: f64) -> f64 {
    // Moments ∫_z^∞ t^(2k) exp(-t²) dt by parts.
    let gauss = (-z * z).exp();
    let mut moment = 0.5 * PI.sqrt() * erfc(z);
    let mut sum = moment;
    let mut edge = 0.5 * gauss * z;
    let mut scale = 1.0;
    for (j, coefficient) in SERIES.iter().enumerate().skip(1) {
        for k in [2 * j - 1, 2 * j] {
            moment = edge + (k as f64 - 0.5) * moment;
            edge *= z * z;
        }
        scale /= kappa * kappa;
        sum += coefficient * scale * moment;
    }
    sum
}

/// Computes `Γ(n + 1/2) / Γ(n)`, relative error about 1e-15.
pub fn gamma_ratio_half(n: f64) -> f64 {
    let steps = step_count(n);
    let ratio: f64 = (0..steps)
        .map(|k| n + f64::from(k))
        .map(|m| m / (m + 0.5))
        .product();
    // At x = 1 the integral is B(n, 1/2)/2 = √π Γ(n) / (2 Γ(n + 1/2)).
    let kappa = n + f64::from(steps) - 0.25;
    ratio * 0.5 * (PI * kappa).sqrt() / scaled_integral(kappa, 0.0)
}

/// Computes `I_x(n, 1/2)` at `x = 1 - c²` for `c` in [0, 1]: 1 at c = 0 and 0 at c = 1.
pub fn incomplete_beta_half(n: f64, c: f64) -> f64 {
    let x = (1.0 - c) * (1.0 + c);
    if x <= 0.0 {
        return 0.0;
    }
    let log_x = (-c * c).ln_1p();
    let steps = step_count(n);
    let kappa = n + f64::from(steps) - 0.25;
    let top = scaled_integral(kappa, (-kappa * log_x).sqrt()) / scaled_integral(kappa, 0.0);
    // 1 / (n B(n, 1/2)) = Γ(n + 1/2) / (√π n Γ(n)).
    let mut term = if steps > 0 {
        c * (n * log_x).exp() * gamma_ratio_half(n) / (PI.sqrt() * n)
    } else {
        0.0
    };
    let mut sum = top;
    for m in (0..steps).map(|k| n + f64::from(k)) {
        sum += term;
        term *= x * (m + 0.5) / (m + 1.0);
    }
    sum
}
