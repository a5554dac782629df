//! The light of environments: mean, peak and range of luminance.

use splitsum::environment::Environment;
use splitsum::pixels::RgbImage;

#[test]
fn the_range_of_an_environment_is_peak_over_mean() {
    let flat = Environment::from_image("flat", RgbImage::filled(8, 4, [0.5; 3])).luminance;
    assert!((flat.mean - 0.5).abs() < 1e-6 && flat.range_stops().unwrap().abs() < 1e-6, "{flat:?}");
    // The upper half of the sphere has 2, the lower 0: mean 1, for any number of rows.
    let half = RgbImage::from_fn(8, 6, |_, y| if y < 3 { [2.0; 3] } else { [0.0; 3] });
    let half = Environment::from_image("half", half).luminance;
    assert!((half.mean - 1.0).abs() < 1e-6 && (half.range_stops().unwrap() - 1.0).abs() < 1e-6, "{half:?}");
    let black = Environment::from_image("black", RgbImage::filled(2, 2, [0.0; 3])).luminance;
    assert_eq!(black.range_stops(), None);
}
