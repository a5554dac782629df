use super::{Chromaticities, RADIANCE, REC709, luminance, srgb_decode, srgb_encode};
use glam::DVec3;

#[test]
fn srgb_curve() {
    // IEC 61966-2-1: mid grey, and the two pieces meet.
    assert!((srgb_encode(0.5) - 0.735_357).abs() < 1e-6);
    assert!((srgb_encode(0.003_130_8) - 0.040_45).abs() < 1e-5);
    assert!((srgb_encode(0.003_131) - 0.040_45).abs() < 1e-5);
    for signal in 0..=255 {
        let linear = srgb_decode(signal as f32 / 255.0);
        assert_eq!((srgb_encode(linear) * 255.0).round() as i32, signal);
    }
    assert_eq!(srgb_encode(-1.0), 0.0);
    assert_eq!(srgb_encode(f32::INFINITY), 1.0);
    assert_eq!(srgb_encode(f32::NAN), 0.0);
}

#[test]
fn rec709_matrix_is_the_published_one() {
    // sRGB (D65) to XYZ as printed in IEC 61966-2-1, four decimals.
    let published = [
        [0.4124, 0.3576, 0.1805],
        [0.2126, 0.7152, 0.0722],
        [0.0193, 0.1192, 0.9505],
    ];
    let matrix = REC709.to_xyz().unwrap();
    for (i, row) in published.iter().enumerate() {
        for (j, entry) in row.iter().enumerate() {
            assert!(
                (matrix.row(i)[j] - entry).abs() < 1e-4,
                "row {i} column {j}: {}",
                matrix.row(i)[j]
            );
        }
    }
    assert!((luminance([1.0; 3]) - 1.0).abs() < 1e-12);
}

#[test]
fn conversions_keep_white() {
    let identity = REC709.to_rec709().unwrap();
    assert!((identity * DVec3::new(0.2, 0.5, 0.9)).abs_diff_eq(DVec3::new(0.2, 0.5, 0.9), 1e-12));
    let white = RADIANCE.to_rec709().unwrap() * DVec3::ONE;
    assert!(white.abs_diff_eq(DVec3::ONE, 1e-9), "{white}");
    // Another property of the same space: equal energy is Y = 1 and X = Y = Z.
    assert!((RADIANCE.to_xyz().unwrap() * DVec3::ONE).abs_diff_eq(DVec3::ONE, 1e-9));
    let flat = Chromaticities {
        red: REC709.blue,
        ..REC709
    };
    assert!(flat.to_xyz().is_none());
}
