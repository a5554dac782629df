//! The tone-mapping pass against its f64 twin.

use crate::harness::with_pipeline;
use splitsum::base::pixels::RgbImage;
use splitsum::instrument::tonemap::ToneCurve;

fn ramp() -> RgbImage {
    RgbImage::from_fn(37, 11, |x, y| {
        let l = 10f32.powf(0.2 * x as f32 - 5.0) * y as f32;
        [l, 0.5 * l, if y % 2 == 0 { 0.0 } else { 72_704.0 }]
    })
}

#[test]
fn bytes_match_the_twin() {
    with_pipeline(|pipeline| {
        for exposure in [0.1, 1.0, 50.0, 1e4] {
            for contrast in [0.1, 1.0, 5.0] {
                let curve = ToneCurve { exposure, contrast };
                let (actual, time) = pipeline.tonemap(&ramp(), curve).unwrap();
                assert_eq!(time.pass, "tonemap");
                let exact = ramp().map(|l| curve.apply(l.map(f64::from)).map(|c| 255.0 * c));
                for (a, b) in actual.data.iter().zip(&exact.data) {
                    for c in 0..3 {
                        // The nearest code; within 1e-3 of the middle between two codes, either
                        // one.
                        assert!(
                            (f64::from(a[c]) - b[c]).abs() <= 0.501,
                            "{curve:?}: {a:?} for {b:?}"
                        );
                    }
                }
            }
        }
    });
}
