use super::{Line, t_95};

/// f64 arithmetic of a few sums.
const ROUNDING: f64 = 1e-9;

#[test]
fn a_line_has_the_slope_and_the_standard_error_of_least_squares() {
    let exact: Vec<[f64; 2]> = (0..5)
        .map(|i| [f64::from(i), 3.0 - 2.0 * f64::from(i)])
        .collect();
    let line = Line::fit(&exact).unwrap();
    assert!((line.slope + 2.0).abs() < ROUNDING && line.standard_error < ROUNDING);
    // Residuals 1/6, -1/3, 1/6 of (0, 0), (1, 0), (2, 1): slope 1/2, variance 1/6 over one degree
    // of freedom, Sxx 2.
    let bent = Line::fit(&[[0.0, 0.0], [1.0, 0.0], [2.0, 1.0]]).unwrap();
    assert!(
        (bent.slope - 0.5).abs() < ROUNDING
            && (bent.standard_error - (1.0f64 / 12.0).sqrt()).abs() < ROUNDING,
        "{bent:?}"
    );
    assert_eq!(Line::fit(&exact[..2]), None, "two points have no residual");
    assert_eq!(
        Line::fit(&[[1.0, 0.0], [1.0, 1.0], [1.0, 2.0]]),
        None,
        "one x has no slope"
    );
    assert_eq!(
        Line::fit(&[[0.0, 0.0], [1.0, f64::NEG_INFINITY], [2.0, 1.0]]),
        None,
        "ln 0"
    );
}

#[test]
fn quantiles_of_student_meet_tables_and_their_normal_limit() {
    for (degrees, t) in [
        (1, 12.706),
        (5, 2.571),
        (10, 2.228),
        (12, 2.179),
        (30, 2.042),
        (100, 1.984),
    ] {
        assert!((t_95(degrees) / t - 1.0).abs() < 1e-3, "{degrees}");
    }
    assert!(t_95(0).is_infinite());
}
