//! Slopes of curves and where two of them cross.

use splitsum::study::answers::break_even::{BreakEven, crossing};
use splitsum::study::answers::slope::slope;

/// f64 arithmetic of a few logarithms.
const F64: f64 = 1e-12;

#[test]
fn a_power_law_has_its_exponent_and_no_spread() {
    let points: Vec<(f64, f64)> = [1.0, 4.0, 16.0, 64.0].map(|n: f64| (n, 3.0 * n.powf(-0.75))).to_vec();
    let fit = slope(&points).unwrap();
    assert!((fit.value + 0.75).abs() < F64 && (fit.intercept - 3f64.ln()).abs() < F64, "{fit:?}");
    assert!(fit.hi - fit.lo < 1e-6, "{fit:?}");
}

#[test]
fn the_interval_of_a_slope_is_students() {
    // ln x = 0, 1, 2 and ln y = 0, -1.5, -2: slope -1, residuals 1/6, -1/3, 1/6, so s^2 = 1/6 and sxx = 2.
    let points = [(0.0, 0.0), (1.0, -1.5), (2.0, -2.0)].map(|(x, y): (f64, f64)| (x.exp(), y.exp()));
    let fit = slope(&points).unwrap();
    let half = 12.706 * (1.0f64 / 6.0 / 2.0).sqrt();
    assert!((fit.value + 1.0).abs() < F64 && (fit.hi - fit.value - half).abs() < 1e-9, "{fit:?} {half}");
    assert!(slope(&points[..2]).is_none(), "two points leave no degree of freedom");
    assert!(slope(&[(1.0, 1.0), (2.0, 0.0), (4.0, 1.0)]).is_none(), "ln 0");
}

#[test]
fn curves_cross_where_their_segment_does() {
    let curve = [(1, 0.4), (4, 0.2), (16, 0.1)];
    let n = crossing(&curve, 0.15, BreakEven::From(16)).unwrap();
    // Error falls as 1/sqrt(n): 0.4 / sqrt(n) = 0.15.
    assert!((n - (0.4f64 / 0.15).powi(2)).abs() < 1e-9, "{n}");
    assert_eq!(crossing(&curve, 0.5, BreakEven::From(1)), None, "already better at the first count");
    assert_eq!(crossing(&curve, 0.01, BreakEven::Above(16)), None);
}
