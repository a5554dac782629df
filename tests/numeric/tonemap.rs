//! The tone curve's f64 twin.

use splitsum::base::pixels::RgbImage;
use splitsum::instrument::tonemap::ToneCurve;

/// f64 order of one division and one power.
const F64_ORDER: f64 = 1e-15;

fn assert_close(found: f64, expected: f64) {
    assert!(
        (found - expected).abs() <= F64_ORDER,
        "{found} instead of {expected}"
    );
}

#[test]
fn values_worked_by_hand() {
    // (1/2)^(1/2.2) and (3/4)^(1/2.2); then contrast cancels the display exponent.
    let neutral = ToneCurve::default().apply([1.0, 0.0, 3.0]);
    assert_close(neutral[0], 0.7297400528407231);
    assert_eq!(neutral[1], 0.0);
    assert_close(neutral[2], 0.8774243147253664);
    // f32 holds 2.2 to 2e-8 only, so the exponent is 1 to that order.
    let linear = ToneCurve {
        exposure: 3.0,
        contrast: 2.2,
    }
    .apply([1.0, 2.0, 1.0 / 3.0]);
    for (found, expected) in linear.into_iter().zip([3.0 / 4.0, 6.0 / 7.0, 1.0 / 2.0]) {
        assert!(
            (found - expected).abs() < 1e-7,
            "{found} instead of {expected}"
        );
    }
}

#[test]
fn the_curve_rises_and_stays_below_one() {
    for contrast in [0.1, 1.0, 5.0] {
        let curve = ToneCurve {
            exposure: 1.0,
            contrast,
        };
        let values: Vec<f64> = (-60..40)
            .map(|k| curve.apply([2f64.powi(k); 3])[0])
            .collect();
        assert!(
            values.windows(2).all(|pair| pair[0] < pair[1]),
            "contrast {contrast} does not rise"
        );
        assert!(values.iter().all(|c| (0.0..1.0).contains(c)));
    }
}

#[test]
fn codes_round_to_nearest() {
    let curve = ToneCurve {
        exposure: 1.0,
        contrast: 2.2,
    };
    // L = c / (1 - c) gives display value c.
    let radiance = |code: f64| (code / 255.0 / (1.0 - code / 255.0)) as f32;
    assert_eq!(
        curve.apply_rgb8([radiance(99.51), radiance(100.49), radiance(100.51)]),
        [100, 100, 101]
    );
    assert_eq!(
        curve.apply_rgb8([0.0, f32::MAX, radiance(0.49)]),
        [0, 255, 0]
    );
    let image = RgbImage::new(1, 2, vec![[0.0; 3], [radiance(7.0); 3]]);
    assert_eq!(curve.apply_image(&image).data, [[0; 3], [7; 3]]);
}

#[test]
fn negative_and_non_finite_radiance_is_refused() {
    for bad in [-1e-9, f64::NAN, f64::INFINITY] {
        let result = std::panic::catch_unwind(|| ToneCurve::default().apply([0.0, bad, 0.0]));
        assert!(result.is_err(), "{bad} passed");
    }
}
