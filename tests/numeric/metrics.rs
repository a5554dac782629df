//! Every metric on images worked by hand, its invariants, its bins and its noise floor.

mod display;

use crate::study::estimate::normal;
use fastrand::Rng;
use splitsum::base::names::Listed;
use splitsum::base::pixels::{GrayImage, RgbImage};
use splitsum::instrument::metrics::Metric;
use splitsum::instrument::metrics::{
    Comparison, Epsilon, METRICS, MetricsError, N_DOT_V_BIN_EDGES, NoiseEffect, NoiseUse,
    ReferenceNoise, Space, Verdict, linear_metrics, noise_floor, verdict,
};
use splitsum::instrument::tonemap::ToneCurve;

/// f32 storage of the images of a test.
const F32_STORAGE: f64 = 1e-6;

/// A linear curve of codes: radiance that displays as `code` exactly.
const LINEAR_CURVE: ToneCurve = ToneCurve {
    exposure: 1.0,
    contrast: 2.2,
};

fn radiance_of_code(code: f64) -> f32 {
    (code / (255.0 - code)) as f32
}

fn whole(image: &RgbImage) -> GrayImage {
    GrayImage::filled(image.width, image.height, 1.0)
}

fn score(test: &RgbImage, reference: &RgbImage, mask: &GrayImage, name: &str) -> f64 {
    let comparison =
        Comparison::new(test, reference, mask, LINEAR_CURVE, Epsilon::ABSOLUTE).unwrap();
    comparison.evaluate(&[Metric::listed(name)])[0].1
}

fn assert_relative(found: f64, expected: f64, tolerance: f64, what: &str) {
    let error = (found - expected).abs() / expected.abs().max(1e-12);
    assert!(
        error <= tolerance,
        "{what}: {found} instead of {expected}, relative error {error:e}"
    );
}

/// A noisy image over a noisy reference, both positive.
fn noisy_pair(width: u32, height: u32) -> [RgbImage; 2] {
    let mut random = Rng::with_seed(7);
    let reference = RgbImage::from_fn(width, height, |_, _| {
        std::array::from_fn(|_| (2.0 * random.f64()) as f32)
    });
    let test = reference.map(|pixel| pixel.map(|value| value * (0.5 + random.f64()) as f32));
    [test, reference]
}

#[test]
fn linear_metrics_of_two_by_two_pixels() {
    // One pixel is off the mask and wildly wrong. Of the other three one is exact, one has red too
    // bright by 1, one has all channels too dark by 1/2.
    let reference = RgbImage::new(2, 2, vec![[1.0; 3], [1.0, 2.0, 0.0], [0.5; 3], [1.0; 3]]);
    let test = RgbImage::new(2, 2, vec![[1.0; 3], [2.0, 2.0, 0.0], [0.0; 3], [900.0; 3]]);
    let mask = GrayImage::new(2, 2, vec![1.0, 1.0, 1.0, 0.0]);
    let shown = |l: f64| (0.5 * l / (0.5 * l + 1.0)).powf(1.0 / 2.2);
    let expected = [
        ("rmse", ((1.0 + 3.0 * 0.25) / 9.0f64).sqrt()),
        ("relmse", (1.0 / 1.01 + 3.0 * 0.25 / 0.26) / 9.0),
        // Exposure 1/2: radiance 2, 1, 1/2 and 0 show as the power 1/2.2 of 1/2, 1/3, 1/5 and 0.
        (
            "tone_mapped_mse",
            ((shown(2.0) - shown(1.0)).powi(2) + 3.0 * shown(0.5).powi(2)) / 9.0,
        ),
        ("bias_rel", (1.0 - 1.5) / (3.0 + 3.0 + 1.5)),
    ];
    let comparison = Comparison::new(
        &test,
        &reference,
        &mask,
        ToneCurve::default(),
        Epsilon::ABSOLUTE,
    )
    .unwrap();
    let found = comparison.evaluate(&linear_metrics());
    assert_eq!(
        found.len(),
        expected.len(),
        "a linear metric without a value worked by hand"
    );
    for ((name, value), (expected_name, expected_value)) in found.into_iter().zip(expected) {
        assert_eq!(name, expected_name);
        assert_relative(value, expected_value, F32_STORAGE, name);
    }
    let map = comparison.relative_error_map();
    assert_eq!([map.data[0], map.data[3]], [0.0, 0.0]);
    assert_relative(
        f64::from(map.data[1]),
        (1.0 / 1.01 / 3.0f64).sqrt(),
        F32_STORAGE,
        "error map",
    );
    let signed = comparison.signed_error_map();
    assert_relative(
        f64::from(signed.data[2]),
        -0.5 / 0.26f64.sqrt(),
        F32_STORAGE,
        "signed error map",
    );
    assert_eq!(signed.data[3], 0.0);
}

#[test]
fn equal_images_have_the_best_scores() {
    let [_, image] = noisy_pair(24, 20);
    let scores = Comparison::new(
        &image,
        &image,
        &whole(&image),
        ToneCurve::default(),
        Epsilon::ABSOLUTE,
    )
    .unwrap()
    .evaluate_all();
    for (name, value) in &scores {
        let best = match *name {
            "psnr" => f64::INFINITY,
            "ssim" => 1.0,
            _ => 0.0,
        };
        assert_eq!(*value, best, "{name}");
        assert_eq!(Metric::listed(name).error(*value), 0.0, "error by {name}");
    }
}

#[test]
fn bounds_at_black() {
    let [test, _] = noisy_pair(16, 16);
    let black = RgbImage::filled(16, 16, [0.0; 3]);
    assert_eq!(score(&black, &black, &whole(&test), "bias_rel"), 0.0);
    assert_eq!(
        score(&test, &black, &whole(&test), "bias_rel"),
        f64::INFINITY
    );
}

#[test]
fn pixels_off_the_mask_never_count() {
    let [test, reference] = noisy_pair(32, 32);
    let mask = GrayImage::from_fn(32, 32, |x, y| {
        if (8..24).contains(&x) && (8..24).contains(&y) {
            1.0
        } else {
            0.0
        }
    });
    let mut other = test.clone();
    for (pixel, inside) in other.data.iter_mut().zip(&mask.data) {
        if *inside == 0.0 {
            *pixel = [f32::NAN, -3.0, 1e30];
        }
    }
    let all = |test: &RgbImage| {
        Comparison::new(test, &reference, &mask, LINEAR_CURVE, Epsilon::ABSOLUTE)
            .unwrap()
            .evaluate_all()
    };
    assert_eq!(all(&test), all(&other));
    let comparison =
        Comparison::new(&test, &reference, &mask, LINEAR_CURVE, Epsilon::ABSOLUTE).unwrap();
    for map in [
        comparison.flip_map(),
        comparison.relative_error_map(),
        comparison.signed_error_map(),
    ] {
        let outside = map
            .data
            .iter()
            .zip(&mask.data)
            .filter(|(_, inside)| **inside == 0.0);
        assert!(outside.into_iter().all(|(value, _)| *value == 0.0));
    }
    let map = comparison.flip_map();
    let mean = map.data.iter().map(|&value| f64::from(value)).sum::<f64>() / 256.0;
    assert_relative(
        score(&test, &reference, &mask, "flip"),
        mean,
        1e-12,
        "mean of the map",
    );
}

#[test]
fn bins_add_up_to_the_whole() {
    let [test, reference] = noisy_pair(40, 30);
    let mask = GrayImage::from_fn(40, 30, |x, y| if x == y { 0.0 } else { 1.0 });
    // From -0.05 to 1.05: both ends are clamped into the outer bins.
    let n_dot_v = GrayImage::from_fn(40, 30, |x, y| (x + 40 * y) as f32 / 1200.0 * 1.1 - 0.05);
    let comparison =
        Comparison::new(&test, &reference, &mask, LINEAR_CURVE, Epsilon::ABSOLUTE).unwrap();
    let rows = comparison
        .evaluate_bins(&n_dot_v, &N_DOT_V_BIN_EDGES, METRICS)
        .unwrap();
    assert_eq!(rows.iter().map(|row| row.pixel_count).sum::<usize>(), 1170);
    assert_eq!((rows.len(), rows[0].lo, rows[9].hi), (10, 0.0, 1.0));
    let value =
        |values: &[(&str, f64)], name: &str| values.iter().find(|entry| entry.0 == name).unwrap().1;
    let whole = comparison.evaluate_all();
    let pooled = |name: &str, mean_of: fn(f64) -> f64| {
        let weighted = rows
            .iter()
            .map(|row| row.pixel_count as f64 * mean_of(value(&row.values, name)))
            .sum::<f64>();
        assert_relative(weighted / 1170.0, mean_of(value(&whole, name)), 1e-12, name);
    };
    for name in ["relmse", "flip"] {
        pooled(name, |value| value);
    }
    pooled("rmse", |value| value * value);
}

#[test]
fn bin_edges_and_empty_bins() {
    let [test, reference] = noisy_pair(4, 1);
    let comparison = Comparison::new(
        &test,
        &reference,
        &GrayImage::filled(4, 1, 1.0),
        LINEAR_CURVE,
        Epsilon::ABSOLUTE,
    )
    .unwrap();
    let n_dot_v = GrayImage::new(4, 1, vec![0.0, 0.25, 0.5, 1.0]);
    let rows = comparison
        .evaluate_bins(&n_dot_v, &[0.0, 0.25, 0.4, 0.5, 1.0], &linear_metrics())
        .unwrap();
    assert_eq!(
        rows.iter().map(|row| row.pixel_count).collect::<Vec<_>>(),
        [1, 1, 0, 2]
    );
    assert!(rows[2].values.is_empty() && rows[3].values.len() == linear_metrics().len());
    for edges in [&[0.0][..], &[0.0, 0.5, 0.5], &[0.0, f64::NAN], &[]] {
        let result = comparison.evaluate_bins(&n_dot_v, edges, METRICS);
        assert!(
            matches!(result, Err(MetricsError::BinEdges { .. })),
            "{edges:?}"
        );
    }
    let broken = GrayImage::new(4, 1, vec![0.0, 0.25, f32::NAN, 1.0]);
    let result = comparison.evaluate_bins(&broken, &N_DOT_V_BIN_EDGES, METRICS);
    assert!(matches!(
        result,
        Err(MetricsError::Cosine { x: 2, y: 0, .. })
    ));
}

#[test]
fn bad_input_is_named() {
    let [test, reference] = noisy_pair(3, 2);
    let mask = whole(&reference);
    let error = |test: &RgbImage, mask: &GrayImage| {
        Comparison::new(test, &reference, mask, LINEAR_CURVE, Epsilon::ABSOLUTE)
            .err()
            .expect("bad input must be refused")
            .to_string()
    };
    let wide = RgbImage::filled(4, 2, [0.0; 3]);
    assert_eq!(
        error(&wide, &mask),
        "the test image is 4x2 pixels, but the reference is 3x2"
    );
    assert_eq!(
        error(&test, &whole(&wide)),
        "the mask is 4x2 pixels, but the reference is 3x2"
    );
    assert!(error(&test, &GrayImage::filled(3, 2, 0.0)).contains("3x2 mask is 0 everywhere"));
    let mut soft = mask.clone();
    soft.data[4] = 0.5;
    assert!(error(&test, &soft).contains("0.5 at column 1, row 1"));
    for value in [f32::NAN, f32::INFINITY, -0.25] {
        let mut broken = test.clone();
        broken.data[2][1] = value;
        broken.data[5][0] = value;
        let message = error(&broken, &mask);
        assert!(
            message.contains("test image has 2 masked pixels")
                && message.contains("column 2, row 0"),
            "{message}"
        );
    }
}

#[test]
fn the_noise_floor_is_the_score_of_an_exact_test() {
    // A reference over two decades of radiance with errors of 0.1 to 4 %. As in a renderer, the
    // channels of a pixel share the samples and so the deviate.
    let (width, height) = (80, 60);
    let mut random = Rng::with_seed(99);
    let exact = RgbImage::from_fn(width, height, |x, y| {
        let level = 10f32.powf(x as f32 / 40.0 - 1.0);
        [level, 0.8 * level, 0.5 * level].map(|value| value * (1.0 + 0.3 * (y % 5) as f32))
    });
    let standard_error = RgbImage::from_fn(width, height, |x, y| {
        exact.get(x, y).map(|v| v * (0.001 + 0.0005 * y as f32))
    });
    let mask = GrayImage::from_fn(
        width,
        height,
        |x, y| if (x + y) % 11 == 0 { 0.0 } else { 1.0 },
    );
    let rounds = 200;
    let (mut sums, mut floors) = (
        vec![0.0; linear_metrics().len()],
        vec![0.0; linear_metrics().len()],
    );
    for _ in 0..rounds {
        // The estimate of four scrambles: three degrees of freedom.
        let stated = standard_error.map(|errors| {
            let chi_square: f64 = (0..3).map(|_| normal(&mut random).powi(2)).sum();
            errors.map(|error| error * (chi_square / 3.0).sqrt() as f32)
        });
        let stated = noise_floor(&exact, &stated, &mask, Epsilon::ABSOLUTE).unwrap();
        let is_linear = |name: &str| linear_metrics().iter().any(|metric| metric.name == name);
        for (sum, (name, floor)) in floors
            .iter_mut()
            .zip(stated.into_iter().filter(|(name, _)| is_linear(name)))
        {
            let floor = floor.unwrap();
            *sum += if name == "bias_rel" {
                floor * floor
            } else {
                floor
            };
        }
        let noisy = RgbImage::from_fn(width, height, |x, y| {
            let deviate = normal(&mut random) as f32;
            std::array::from_fn(|c| exact.get(x, y)[c] + deviate * standard_error.get(x, y)[c])
        });
        let scores = Comparison::new(&exact, &noisy, &mask, LINEAR_CURVE, Epsilon::ABSOLUTE)
            .unwrap()
            .evaluate(&linear_metrics());
        for (sum, (name, value)) in sums.iter_mut().zip(scores) {
            *sum += if name == "bias_rel" {
                value * value
            } else {
                value
            };
        }
    }
    for ((sum, floor), metric) in sums.into_iter().zip(floors).zip(linear_metrics()) {
        let name = metric.name;
        let mean = sum / f64::from(rounds);
        // 200 rounds: 5 % for a standard deviation, 1 % for means over 4,000 pixels.
        let floor = floor / f64::from(rounds);
        let floor = if name == "bias_rel" {
            floor.sqrt()
        } else {
            floor
        };
        let (expected, tolerance) = match name {
            "bias_rel" => (mean.sqrt(), 0.15),
            _ => (mean, 0.015),
        };
        assert_relative(floor, expected, tolerance, name);
    }
}

#[test]
fn an_exact_reference_has_no_floor() {
    let [_, reference] = noisy_pair(5, 5);
    let zero = RgbImage::filled(5, 5, [0.0; 3]);
    for (name, floor) in noise_floor(&reference, &zero, &whole(&zero), Epsilon::ABSOLUTE).unwrap() {
        let is_linear = Metric::listed(name).space == Space::Linear;
        assert_eq!(floor, is_linear.then_some(0.0), "{name}");
    }
    let negative = RgbImage::filled(5, 5, [-1e-3; 3]);
    assert!(ReferenceNoise::new(&reference, &negative, &whole(&zero), Epsilon::ABSOLUTE).is_err());
}

#[test]
fn verdicts_compare_differences() {
    let (rmse, relmse) = (Metric::listed("rmse"), Metric::listed("relmse"));
    // Squares of ratios are floors of mean squares: resolved are 100 with exact references, and 11,
    // a noise of a tenth, if answers take it off.
    for (ratio, exact, taken_off) in [
        (0.0, Verdict::EqualWithinNoise, Verdict::EqualWithinNoise),
        (1.9, Verdict::EqualWithinNoise, Verdict::EqualWithinNoise),
        (2.1, Verdict::ReferenceLimited, Verdict::ReferenceLimited),
        (3.3, Verdict::ReferenceLimited, Verdict::ReferenceLimited),
        (3.4, Verdict::ReferenceLimited, Verdict::Resolved),
        (9.9, Verdict::ReferenceLimited, Verdict::Resolved),
        (10.1, Verdict::Resolved, Verdict::Resolved),
    ] {
        for (noise, expected) in [(NoiseUse::Kept, exact), (NoiseUse::TakenOff, taken_off)] {
            assert_eq!(verdict(rmse, ratio * 0.01, 0.01, noise), expected);
            assert_eq!(verdict(rmse, -ratio * 0.01, 0.01, noise), expected);
            assert_eq!(verdict(relmse, ratio * ratio * 1e-4, 1e-4, noise), expected);
            assert_eq!(verdict(rmse, 0.0, 0.0, noise), Verdict::EqualWithinNoise);
            assert_eq!(verdict(rmse, 1e-9, 0.0, noise), Verdict::Resolved);
        }
    }
}

/// Over many references, a score without noise is in the mean the score against the exact one, from
/// two floors on. An exact image has half a floor.
#[test]
fn a_score_without_noise_has_no_bias() {
    let size = 64;
    let mut random = Rng::with_seed(11);
    let exact = RgbImage::from_fn(size, size, |_, _| {
        std::array::from_fn(|_| (0.5 + random.f64()) as f32)
    });
    let noise = exact.map(|pixel| pixel.map(|value| 0.02 * value));
    let mask = whole(&exact);
    let metrics = linear_metrics();
    // The error of the test, in units of the noise.
    for ratio in [0.0_f64, 1.1, 2.0, 3.0, 10.0] {
        let test = RgbImage::from_fn(size, size, |x, y| {
            let error = ratio as f32 * if (x + y) % 2 == 0 { 1.0 } else { -1.0 };
            std::array::from_fn(|c| exact.get(x, y)[c] + error * noise.get(x, y)[c])
        });
        let scores = |reference: &RgbImage| {
            Comparison::new(&test, reference, &mask, LINEAR_CURVE, Epsilon::ABSOLUTE)
                .unwrap()
                .evaluate(&metrics)
        };
        let rounds = 100;
        let mut means = vec![0.0; metrics.len()];
        let mut floor_means = vec![0.0; metrics.len()];
        for _ in 0..rounds {
            let noisy = RgbImage::from_fn(size, size, |x, y| {
                std::array::from_fn(|c| {
                    exact.get(x, y)[c] + normal(&mut random) as f32 * noise.get(x, y)[c]
                })
            });
            // Three degrees of freedom in each pixel.
            let stated = noise.map(|errors| {
                errors.map(|error| {
                    let squares: f64 = (0..3).map(|_| normal(&mut random).powi(2)).sum();
                    error * (squares / 3.0).sqrt() as f32
                })
            });
            let floors = noise_floor(&noisy, &stated, &mask, Epsilon::ABSOLUTE).unwrap();
            for (index, (name, score)) in scores(&noisy).into_iter().enumerate() {
                let floor = floors.iter().find(|(known, _)| *known == name).unwrap().1;
                let metric = metrics[index];
                means[index] += metric.without_noise(score, floor).powf(2.0 / metric.power);
                floor_means[index] += floor.unwrap().powf(2.0 / metric.power);
                assert_eq!(metric.without_noise(score, None), score);
            }
        }
        for (index, (name, due)) in scores(&exact).into_iter().enumerate() {
            let metric = metrics[index];
            let [mean, floor] = [&means, &floor_means].map(|sums| sums[index] / f64::from(rounds));
            if metric.noise != NoiseEffect::Adds {
                continue;
            }
            let due = due.powf(2.0 / metric.power);
            let words = format!("{name} at {ratio}");
            if ratio == 0.0 {
                assert_relative(mean, 0.5 * floor, 0.02, &words);
            } else {
                // 12,288 values a round; the noise is 2 % of the radiance, so the curvature of the
                // formulas moves less than that.
                assert_relative(mean, due, 0.01, &words);
            }
        }
    }
}

/// The stated deviation of a mean square error is the one over many references: for an image that
/// errs alike everywhere, and for one whose error is nearly all in one pixel.
#[test]
fn noise_moves_a_score_by_the_stated_deviation() {
    let size = 16;
    let mut random = Rng::with_seed(12);
    let exact = RgbImage::from_fn(size, size, |_, _| {
        std::array::from_fn(|_| (0.5 + random.f64()) as f32)
    });
    let noise = exact.map(|pixel| pixel.map(|value| 0.02 * value));
    let mask = whole(&exact);
    let even = exact.map(|pixel| pixel.map(|value| 1.2 * value));
    let mut firefly = even.clone();
    firefly.data[3] = [50.0; 3];
    let mut deviations = Vec::new();
    for test in [&even, &firefly] {
        for name in ["rmse", "relmse"] {
            let metric = Metric::listed(name);
            let squared =
                |reference: &RgbImage| score(test, reference, &mask, name).powf(2.0 / metric.power);
            let rounds = 1000;
            let mut sums = [0.0; 2];
            for _ in 0..rounds {
                let noisy = RgbImage::from_fn(size, size, |x, y| {
                    std::array::from_fn(|c| {
                        exact.get(x, y)[c] + normal(&mut random) as f32 * noise.get(x, y)[c]
                    })
                });
                let square = squared(&noisy);
                sums[0] += square;
                sums[1] += square * square;
            }
            let [mean, mean_of_squares] = sums.map(|sum| sum / f64::from(rounds));
            let found = (mean_of_squares - mean * mean).sqrt() / squared(&exact);
            let comparison =
                Comparison::new(test, &exact, &mask, LINEAR_CURVE, Epsilon::ABSOLUTE).unwrap();
            let stated = metric.noise_deviation(&comparison, &noise);
            // The deviation of 1,000 values is known to 2 %.
            assert_relative(stated, found, 0.08, name);
            deviations.push(stated);
        }
    }
    // Where one pixel decides `relmse`, its noise does not average out.
    assert!(deviations[3] > 2.0 * deviations[1], "{deviations:?}");
}

/// Noise is taken off metrics to which it adds: not bias, which is signed, nor display scores, which
/// have no floor.
#[test]
fn only_mean_squares_lose_their_noise() {
    assert_eq!(Metric::listed("bias_rel").noise, NoiseEffect::Distorts);
    for metric in METRICS {
        let is_changed = metric.without_noise(0.5, Some(0.1)) != 0.5;
        let expected = metric.noise == NoiseEffect::Adds;
        assert_eq!(is_changed, expected, "{}", metric.name);
        assert!(
            !expected || metric.space == Space::Linear,
            "{}",
            metric.name
        );
        assert!(
            !expected || metric.noise_share(0.5, 0.6) == f64::INFINITY,
            "{}",
            metric.name
        );
    }
    let [rmse, relmse] = ["rmse", "relmse"].map(Metric::listed);
    for [score, floor, due, share] in [
        [5.0, 4.0, 12.5_f64.sqrt(), 16.0 / 9.0],
        [5.0, 3.0, 4.0, 9.0 / 16.0],
    ] {
        assert_relative(rmse.without_noise(score, Some(floor)), due, 1e-12, "rmse");
        assert_relative(rmse.noise_share(score, floor), share, 1e-12, "rmse");
    }
    assert_relative(relmse.without_noise(5.0, Some(1.0)), 4.0, 1e-12, "relmse");
    assert_relative(relmse.noise_share(11.0, 1.0), 0.1, 1e-12, "relmse");
}

#[test]
fn scores_do_not_depend_on_order_of_evaluation() {
    let [test, reference] = noisy_pair(20, 20);
    let mask = whole(&test);
    let all = Comparison::new(&test, &reference, &mask, LINEAR_CURVE, Epsilon::ABSOLUTE)
        .unwrap()
        .evaluate_all();
    for metric in METRICS {
        let alone = Comparison::new(&test, &reference, &mask, LINEAR_CURVE, Epsilon::ABSOLUTE)
            .unwrap()
            .evaluate(&[*metric])[0];
        assert!(all.contains(&alone), "{alone:?}");
    }
}

#[test]
fn the_unit_of_radiance_does_not_change_relative_metrics() {
    let [test, reference] = noisy_pair(40, 30);
    let (standard_error, mask) = (
        reference.map(|pixel| pixel.map(|value| 0.01 * value + 1e-3)),
        whole(&test),
    );
    let scores = |unit: f32, mean: f64| {
        let scaled = |image: &RgbImage| image.map(|pixel| pixel.map(|value| unit * value));
        let [test, reference, standard_error] = [&test, &reference, &standard_error].map(scaled);
        let epsilon = Epsilon::of_light(f64::from(unit) * mean);
        let comparison = Comparison::new(&test, &reference, &mask, LINEAR_CURVE, epsilon).unwrap();
        let floors = noise_floor(&reference, &standard_error, &mask, epsilon)
            .unwrap()
            .into_iter();
        let floors = floors.filter_map(|(name, floor)| Some((format!("{name} floor"), floor?)));
        let maps = [
            comparison.relative_error_map(),
            comparison.signed_error_map(),
        ];
        let maps = maps.map(|map| {
            (
                "map".to_owned(),
                map.data.iter().map(|x| f64::from(*x).powi(2)).sum(),
            )
        });
        let own = comparison
            .evaluate(&linear_metrics())
            .into_iter()
            .map(|(name, score)| (name.to_owned(), score));
        own.chain(floors)
            .chain(maps)
            .collect::<Vec<(String, f64)>>()
    };
    for mean in [0.17, 2.2] {
        for unit in [1e-3, 1e3] {
            for ((name, plain), (_, other)) in scores(1.0, mean).into_iter().zip(scores(unit, mean))
            {
                let has_unit = name.trim_end_matches(" floor") == "rmse";
                let change = (other / plain - 1.0).abs();
                assert!(
                    if has_unit {
                        change > 0.02
                    } else {
                        change < 1e-5
                    },
                    "{name}: {plain} and {other} at {unit}"
                );
            }
        }
    }
    // A black map counts as light of mean luminance 1.
    let of = |mean, name| {
        let comparison = Comparison::new(
            &test,
            &reference,
            &mask,
            LINEAR_CURVE,
            Epsilon::of_light(mean),
        )
        .unwrap();
        comparison.evaluate(&[Metric::listed(name)])[0].1
    };
    assert_eq!(of(0.0, "relmse"), of(1.0, "relmse"));
    assert!(of(0.1, "relmse") > of(1.0, "relmse") && of(1.0, "relmse") > of(5.0, "relmse"));
}
