//! The error function in f64.
//!
//! `erf x = 2/√π ∫_0^x exp(-t²) dt`. Below [`SERIES_END`] by its Taylor series with positive terms
//! `2/√π exp(-x²) Σ 2^k x^(2k+1) / (2k+1)!!`, above by Laplace's continued fraction of `erfc = 1 - erf`.

use std::f64::consts::PI;

/// Above it the continued fraction converges within [`FRACTION_TERMS`]; below it `1 - erf` loses at most
/// two and a half digits.
const SERIES_END: f64 = 2.0;
/// Relative truncation error below exp(-30) for every x above [`SERIES_END`].
const FRACTION_TERMS: u32 = 60;

/// Error function, relative error about 1e-15.
pub fn erf(x: f64) -> f64 {
    if x.abs() < SERIES_END { erf_series(x) } else { (1.0 - erfc_fraction(x.abs())).copysign(x) }
}

/// `1 - erf x`, relative error below 1e-13 for every x, also where it is tiny.
pub fn erfc(x: f64) -> f64 {
    if x.abs() < SERIES_END {
        1.0 - erf_series(x)
    } else if x > 0.0 {
        erfc_fraction(x)
    } else {
        2.0 - erfc_fraction(-x)
    }
}

/// Inverse of [`erf`] for `y` in (-1, 1), by Newton's method.
///
/// At ±1 the result is finite: the root is sought within ±[`INVERSE_END`].
pub fn erf_inverse(y: f64) -> f64 {
    let magnitude = y.abs();
    let root = monotone_root(0.0, INVERSE_END, |x| {
        // Each form keeps the digits of its half of the range.
        let excess = if magnitude < 0.5 { erf(x) - magnitude } else { (1.0 - magnitude) - erfc(x) };
        (excess, 2.0 / PI.sqrt() * (-x * x).exp())
    });
    root.copysign(y)
}

/// `erfc(6) = 2e-17` is below the spacing of f64 at 1.
const INVERSE_END: f64 = 6.0;

/// Root of an increasing function in `[low, high]`: Newton steps, replaced by bisection where they leave the bracket.
///
/// `f` gives the value and its derivative. Returns the nearer end if the sign does not change.
pub fn monotone_root(mut low: f64, mut high: f64, f: impl Fn(f64) -> (f64, f64)) -> f64 {
    // Bisection alone ends in 64 steps; Newton usually in 6.
    const MAX_STEPS: u32 = 100;
    let mut x = 0.5 * (low + high);
    for _ in 0..MAX_STEPS {
        let (value, slope) = f(x);
        if value > 0.0 {
            high = x;
        } else {
            low = x;
        }
        let newton = x - value / slope;
        let next = if newton > low && newton < high { newton } else { 0.5 * (low + high) };
        if (next - x).abs() <= f64::EPSILON * x.abs().max(f64::MIN_POSITIVE) {
            return next;
        }
        x = next;
    }
    x
}

fn erf_series(x: f64) -> f64 {
    let mut term = x;
    let mut sum = x;
    let mut k = 0.0;
    while term.abs() > f64::EPSILON * 0.1 * sum.abs() {
        k += 1.0;
        term *= 2.0 * x * x / (2.0 * k + 1.0);
        sum += term;
    }
    2.0 / PI.sqrt() * (-x * x).exp() * sum
}

/// `erfc x = exp(-x²)/√π / (x + (1/2)/(x + (2/2)/(x + (3/2)/(x + ...))))` for x > 0, evaluated from the far end.
fn erfc_fraction(x: f64) -> f64 {
    let denominator = (1..=FRACTION_TERMS).rev().fold(x, |tail, k| x + 0.5 * f64::from(k) / tail);
    (-x * x).exp() / (PI.sqrt() * denominator)
}
