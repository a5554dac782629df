//! Shares of steps, of made chains.

use splitsum::metrics::Epsilon;
use splitsum::metrics::attribution::steps;
use splitsum::pixels::{GrayImage, Pixels, RgbImage};

const SIZE: [u32; 2] = [8, 8];

/// A reference that varies over two decades, and steps of chosen shape on it.
fn chain(shapes: &[fn(f32) -> f32]) -> Vec<RgbImage> {
    let value = |x: u32, y: u32| 0.05 * (1 + x + 8 * y) as f32;
    let mut images = vec![RgbImage::from_fn(SIZE[0], SIZE[1], |x, y| [value(x, y); 3])];
    for shape in shapes {
        let last = images.last().unwrap();
        let next = last.data.iter().enumerate().map(|(i, rgb)| {
            let r = value(i as u32 % 8, i as u32 / 8);
            rgb.map(|channel| channel + r * shape(i as f32 / 64.0))
        });
        images.push(Pixels::new(SIZE[0], SIZE[1], next.collect()));
    }
    images
}

fn shares(shapes: &[fn(f32) -> f32]) -> Vec<f64> {
    let images = chain(shapes);
    let mask = GrayImage::filled(SIZE[0], SIZE[1], 1.0);
    // So small an ε that the weight is 1/r².
    steps(&images.iter().collect::<Vec<_>>(), &mask, Epsilon::of_light(1e-9)).iter().map(|step| step.share).collect()
}

fn assert_near(found: &[f64], expected: &[f64]) {
    assert!(found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-5), "{found:?} for {expected:?}");
}

#[test]
fn shares_of_made_steps_are_found() {
    // Orthogonal steps of sizes 3 and 1, halves of opposite sign: shares are those of the squares.
    let even = |x: f32| if ((64.0 * x) as u32).is_multiple_of(2) { 0.3 } else { -0.3 };
    let half = |x: f32| if x < 0.5 { 0.1 } else { -0.1 };
    assert_near(&shares(&[even, half]), &[0.9, 0.1]);
    // Steps of one shape add up, one that changes nothing has no share, one that goes back cancels.
    assert_near(&shares(&[|_| 0.3, |_| 0.0, |_| 0.2, |_| -0.1]), &[0.75, 0.0, 0.5, -0.25]);
}

#[test]
fn shares_sum_to_one_and_errors_are_relmse() {
    let images = chain(&[|x| 0.2 * x, |x| -0.1 * x * x, |x| 0.05 * (9.0 * x).sin()]);
    let mask = GrayImage::from_fn(SIZE[0], SIZE[1], |x, _| if x < 5 { 1.0 } else { 0.0 });
    let epsilon = Epsilon::of_light(0.7);
    let found = steps(&images.iter().collect::<Vec<_>>(), &mask, epsilon);
    assert!((found.iter().map(|step| step.share).sum::<f64>() - 1.0).abs() < 1e-12);
    for (step, image) in found.iter().zip(&images[1..]) {
        let curve = splitsum::tonemap::ToneCurve::default();
        let comparison = splitsum::metrics::Comparison::new(image, &images[0], &mask, curve, epsilon).unwrap();
        let relmse = comparison.evaluate_linear().into_iter().find(|(name, _)| *name == "relmse").unwrap().1;
        assert!((step.relmse / relmse - 1.0).abs() < 1e-12, "{} {relmse}", step.relmse);
    }
}
