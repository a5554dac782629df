use super::{
    ColorScale, FLIP_ERROR, NAN_COLOR, OFF_MASK_COLOR, Palette, RELATIVE_ERROR, Range, SIGNED_ERROR,
};
use crate::base::color;
use crate::base::pixels::GrayImage;

/// Relative luminance of an sRGB colour.
fn luminance(code: [u8; 3]) -> f64 {
    color::luminance(code.map(|code| color::srgb_decode(f32::from(code) / 255.0)))
}

#[test]
fn palettes_match_the_published_ones() {
    // matplotlib's magma at 0, 128/255 and 1: (0.001462, 0.000466, 0.013866), (0.716387, 0.214982,
    // 0.475290), (0.987053, 0.991438, 0.749504), which d3's table of 8-bit codes, ours, holds to
    // one code.
    let magma = |t| Palette::Magma.color(t);
    assert_eq!(
        [magma(0.0), magma(128.0 / 255.0), magma(1.0)],
        [[0, 0, 4], [182, 54, 121], [252, 253, 191]]
    );
    let blue_red = |t| Palette::BlueRed.color(t);
    assert_eq!(
        [blue_red(0.0), blue_red(0.5), blue_red(1.0)],
        [[5, 48, 97], [247, 247, 247], [103, 0, 31]]
    );
    assert_eq!(blue_red(0.05), [19, 75, 135]);
    for palette in [Palette::Magma, Palette::BlueRed] {
        assert_eq!(
            [palette.color(-3.0), palette.color(7.0)],
            [palette.color(0.0), palette.color(1.0)]
        );
        assert_eq!(palette.color(f64::NAN), NAN_COLOR);
    }
    // Order by lightness, so that a grey print still reads; one code of rounding is allowed.
    let rises = |colors: Vec<f64>| colors.windows(2).all(|pair| pair[1] > pair[0] - 1e-3);
    assert!(rises(
        (0..=100)
            .map(|i| luminance(magma(f64::from(i) / 100.0)))
            .collect()
    ));
    assert!(rises(
        (0..=50)
            .map(|i| luminance(blue_red(f64::from(i) / 100.0)))
            .collect()
    ));
    assert!(rises(
        (0..=50)
            .map(|i| luminance(blue_red(1.0 - f64::from(i) / 100.0)))
            .collect()
    ));
}

#[test]
fn ranges_are_fixed() {
    assert!((RELATIVE_ERROR.share(10f64.powf(-1.5)) - 0.5).abs() < 1e-12);
    assert_eq!(
        [RELATIVE_ERROR.share(0.0), RELATIVE_ERROR.share(-1.0)],
        [0.0, 0.0]
    );
    assert_eq!(RELATIVE_ERROR.ticks(), [1e-3, 1e-2, 1e-1, 1.0]);
    assert_eq!(SIGNED_ERROR.color(0.0), [247; 3]);
    assert_eq!(SIGNED_ERROR.ticks(), [-0.5, -0.25, 0.0, 0.25, 0.5]);
    assert_eq!(
        (FLIP_ERROR.share(0.25), FLIP_ERROR.ticks().len()),
        (0.25, 5)
    );
    let narrow = ColorScale {
        palette: Palette::Magma,
        range: Range::Log { lo: 2e-3, hi: 0.5 },
    };
    assert_eq!(narrow.ticks(), [1e-2, 1e-1]);
    let map = GrayImage::new(3, 1, vec![0.0, 1.0, 1.0]);
    let mask = GrayImage::new(3, 1, vec![1.0, 1.0, 0.0]);
    let [first, last] = [0.0, 1.0].map(|t| Palette::Magma.color(t));
    assert_eq!(
        RELATIVE_ERROR.image(&map, &mask).data,
        [first, last, OFF_MASK_COLOR]
    );
}
