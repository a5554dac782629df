//! Scores of the scene `design` under a weight of views, against integrals over n·v.

use super::paper::{F64, Made, Paper, bin, column, finished_of, numbers, only};
use crate::run::runs::Bench;
use fastrand::Rng;
use splitsum::base::math::design::frame;
use splitsum::base::names::Listed;
use splitsum::base::pixels::{GrayImage, RgbImage};
use splitsum::instrument::metrics::{
    Comparison, Epsilon, METRICS, Metric, N_DOT_V_BIN_EDGES, Pooling, ReferenceNoise, Weight,
};
use splitsum::instrument::tonemap::ToneCurve;
use splitsum::study::finished::{Bin, BinRange, Finished, Light, MetricValues};
use splitsum::study::questions::answers;

const SIZE: u32 = 128;

/// n·v of the pixels of the scene `design`.
fn n_dot_v() -> GrayImage {
    GrayImage::from_fn(SIZE, SIZE, |x, y| {
        let [n, v] = frame(y * SIZE + x, SIZE * SIZE);
        n.dot(v) as f32
    })
}

fn image(value: impl Fn(f64) -> f64) -> RgbImage {
    n_dot_v().map(|cosine| [value(f64::from(cosine)) as f32; 3])
}

/// A run of one cell of `design` with the bins of this test, reference and standard error.
fn run(test: &RgbImage, reference: &RgbImage, standard_error: &RgbImage) -> Finished {
    let (n_dot_v, mask) = (n_dot_v(), GrayImage::filled(SIZE, SIZE, 1.0));
    let comparison = Comparison::new(
        test,
        reference,
        &mask,
        ToneCurve::default(),
        Epsilon::ABSOLUTE,
    )
    .unwrap();
    let rows = comparison
        .evaluate_bins(&n_dot_v, &N_DOT_V_BIN_EDGES, METRICS)
        .unwrap();
    let pixels = comparison.bin_pixels(&n_dot_v, &N_DOT_V_BIN_EDGES).unwrap();
    let bins = rows.iter().zip(pixels).map(|(row, pixels)| {
        let noise =
            ReferenceNoise::of_pixels([reference, standard_error], &pixels, Epsilon::ABSOLUTE);
        let score = |name: &str| {
            row.values
                .iter()
                .find(|(own, _)| *own == name)
                .map(|(_, value)| *value)
        };
        Bin {
            reference_mean: Some(row.reference_mean),
            noise_floors: MetricValues::from_fn(|name| Metric::listed(name).noise_floor(&noise)),
            ..with_pixels(row.pixel_count as u64, bin([row.lo, row.hi], score))
        }
    });
    let mut paper = Paper::new(&["scene", "method"]);
    let scores = comparison.evaluate_all();
    let cell = paper.add(&["design", "split-sum"], 1.0);
    cell.bins = bins.collect::<Vec<_>>().into();
    cell.scores = Some(MetricValues::from_fn(|name| {
        scores
            .iter()
            .find(|(own, _)| *own == name)
            .map(|(_, value)| *value)
    }));
    paper.run
}

fn score(run: &Finished, weight: &Weight, name: &str) -> Option<f64> {
    run.weighted(weight).cells[0]
        .scores
        .as_ref()
        .unwrap()
        .get(name)
}

#[test]
fn the_picture_weight_integrates_an_error_over_2_n_dot_v() {
    // Reference 1, error a + b μ. With the density 2 μ the mean of its square is a² + 4/3 ab +
    // b²/2, of the error itself a + 2/3 b.
    let (a, b) = (0.6, -0.5);
    let run = run(
        &image(|cosine| 1.0 + a + b * cosine),
        &image(|_| 1.0),
        &image(|_| 0.0),
    );
    let square = a * a + 4.0 / 3.0 * a * b + b * b / 2.0;
    let even = a * a + a * b + b * b / 3.0;
    for (name, truth) in [
        ("relmse", square / 1.01),
        ("rmse", square.sqrt()),
        ("bias_rel", a + 2.0 / 3.0 * b),
    ] {
        // Exact but for the 16,384 points.
        let found = score(&run, &Weight::Picture, name).unwrap();
        assert!(
            (found - truth).abs() < 5e-4 * truth,
            "{name}: {found} instead of {truth}"
        );
        let band = run
            .weighted(&Weight::Picture)
            .within_n_dot_v([0.0, 2.0])
            .unwrap();
        assert_eq!(
            score(&band, &Weight::Uniform, name),
            Some(found),
            "all bands together"
        );
    }
    // Constant weights within bins of h miss h²/6 of the change of the error: 0.0017 of 0.35.
    let bins = &run.cells[0].bins;
    let constant: f64 = bins
        .iter()
        .map(|bin| {
            (bin.range.hi.powi(2) - bin.range.lo.powi(2)) * bin.scores.get("relmse").unwrap()
        })
        .sum();
    assert!((constant - square / 1.01) > 1e-3 * square, "{constant}");
    let found = score(&run, &Weight::Uniform, "relmse").unwrap();
    assert!(
        (found - even / 1.01).abs() < 1e-3 * even,
        "{found} instead of {}",
        even / 1.01
    );
    // Displays have no weighted score.
    for metric in METRICS
        .iter()
        .filter(|metric| metric.pooling == Pooling::None)
    {
        assert_eq!(
            score(&run, &Weight::Picture, metric.name),
            None,
            "{}",
            metric.name
        );
    }
}

#[test]
fn epsilon_follows_the_scale_of_a_light() {
    let mut paper = Paper::new(&["environment", "environment_scale", "method"]);
    let point = paper
        .add(&["builtin:sky", "4", "split-sum"], 1.0)
        .point
        .clone();
    paper.run.lights = vec![Light {
        environment: "builtin:sky".to_owned(),
        mean: 2.0,
        peak: 3.0,
    }];
    assert_eq!(paper.run.epsilon(&point).mean(), 8.0);
}

/// The noise floor under a weight is the expected score of an exact image, as without a weight.
#[test]
fn weighted_noise_floors_are_the_scores_of_an_exact_image() {
    let sigma = |cosine: f64| 0.02 * (1.2 - cosine);
    let (exact, error) = (image(|cosine| 0.5 + cosine), image(sigma));
    let mut random = Rng::with_seed(3);
    let rounds = 60;
    let pooled = || {
        METRICS
            .iter()
            .filter(|metric| metric.pooling != Pooling::None)
    };
    let (mut sums, mut floors) = (vec![0.0; METRICS.len()], vec![0.0; METRICS.len()]);
    for _ in 0..rounds {
        // The error of a pixel is uniform, as `metrics::noise` says of one stated standard error.
        let noisy = RgbImage::from_fn(SIZE, SIZE, |x, y| {
            let deviate = 3f64.sqrt() * (2.0 * random.f64() - 1.0);
            exact
                .get(x, y)
                .map(|value| value + (deviate * f64::from(error.get(x, y)[0])) as f32)
        });
        let run = run(&exact, &noisy, &error).weighted(&Weight::Picture);
        let cell = &run.cells[0];
        for (place, metric) in pooled().enumerate() {
            let square = |value: f64| {
                if metric.name == "bias_rel" {
                    value * value
                } else {
                    value
                }
            };
            sums[place] += square(cell.scores.as_ref().unwrap().get(metric.name).unwrap());
            floors[place] += square(cell.noise_floors.get(metric.name).unwrap());
        }
    }
    for (place, metric) in pooled().enumerate() {
        // The square of one number has a standard error of √(2/60) = 18 %; means over pixels of 0.2
        // %.
        let tolerance = if metric.name == "bias_rel" { 0.4 } else { 0.01 };
        let ratio = floors[place] / sums[place];
        assert!((ratio - 1.0).abs() < tolerance, "{}: {ratio}", metric.name);
    }
}

/// A run as written and read: its bins together are the whole.
#[test]
fn recorded_bins_determine_scores_and_floors() {
    let bench = Bench::finished(
        "name = \"bins\"\nscene = \"design\"\nsize = [24, 24]\nreference = { samples = 64, noise_share = 0 \
         }\n[axes]\nmethod = [\"split-sum\"]\ndiffuse = [\"none\"]\n",
    );
    let run = Finished::read(bench.dir.path()).unwrap();
    let (whole, pooled) = (&run.cells[0], run.within_n_dot_v([0.0, 1.0]).unwrap());
    for metric in METRICS
        .iter()
        .filter(|metric| metric.pooling != Pooling::None)
    {
        let [a, b] = [whole, &pooled.cells[0]]
            .map(|cell| cell.scores.as_ref().unwrap().get(metric.name).unwrap());
        let [c, d] =
            [whole, &pooled.cells[0]].map(|cell| cell.noise_floors.get(metric.name).unwrap());
        assert!(
            (a / b - 1.0).abs() < F64 && (c / d - 1.0).abs() < F64,
            "{}: {a} {b}, {c} {d}",
            metric.name
        );
    }
}

fn with_pixels(pixel_count: u64, bin: Bin) -> Bin {
    Bin {
        range: BinRange {
            pixel_count,
            ..bin.range
        },
        ..bin
    }
}

/// Two methods of a design with an error at grazing and at steep views, and a picture with a fifth
/// of its pixels at grazing ones.
fn two_views() -> Paper {
    let mut paper = Paper::new(&["scene", "method"]);
    for (method, errors) in [("split-sum", [1.0, 0.2]), ("split-sum-one", [0.1, 0.3])] {
        let [low, high] = errors;
        paper.add(&["design", method], 0.5 * (low + high)).bins = vec![
            bin([0.0, 0.5], |name| (name == "relmse").then_some(low)),
            bin([0.5, 1.0], |name| (name == "relmse").then_some(high)),
        ]
        .into();
        let picture = paper.add(&["sphere", method], 9.0);
        picture.bins = vec![
            with_pixels(20, bin([0.0, 0.5], |_| Some(7.0))),
            with_pixels(80, bin([0.5, 1.0], |_| Some(8.0))),
        ]
        .into();
    }
    paper
}

fn ratios(run: &Finished) -> Vec<(String, f64)> {
    let answers = answers(run, None);
    let effect = answers
        .iter()
        .find(|answer| answer.question.name == "effect")
        .unwrap();
    column(&effect.finding.table, "weight")
        .into_iter()
        .zip(numbers(&effect.finding.table, "ratio"))
        .collect()
}

#[test]
fn answers_have_the_rows_of_each_weight() {
    let run = two_views().run;
    // Under 2 n·v the halves count 1/4 and 3/4: 0.4 and 0.25; evenly 0.6 and 0.2.
    let found = ratios(&run);
    assert_eq!(
        found
            .iter()
            .map(|(weight, _)| &**weight)
            .collect::<Vec<_>>(),
        ["picture", "uniform"]
    );
    assert!(
        (found[0].1 - 0.25 / 0.4).abs() < F64 && (found[1].1 - 0.2 / 0.6).abs() < F64,
        "{found:?}"
    );
    // With the weight of the sphere, 1/5 and 4/5: 0.36 and 0.26.
    let of_scene = run.clone().with_weights(&["sphere".to_owned()]).unwrap();
    let [(name, ratio)] = &ratios(&of_scene)[..] else {
        panic!()
    };
    assert!(
        name == "sphere" && (ratio - 0.26 / 0.36).abs() < F64,
        "{ratio}"
    );
    // The order of cells and bins changes nothing.
    let mut turned = run.clone();
    for cell in &mut turned.cells {
        let mut bins: Vec<Bin> = cell.bins.iter().collect();
        bins.reverse();
        cell.bins = bins.into();
    }
    turned.cells.swap(1, 3);
    assert_eq!(ratios(&turned), found);
    // The sentence and both tables say so.
    let answers = answers(&run, None);
    let effect = answers
        .iter()
        .find(|answer| answer.question.name == "effect")
        .unwrap();
    assert!(
        effect
            .finding
            .sentences
            .markdown()
            .ends_with(" Views count as in pictures."),
        "{}",
        effect.finding.sentences.markdown()
    );
    let digest = effect.finding.digest.as_ref().unwrap();
    assert!(!only(digest, &[("weight", "picture")]).rows.is_empty());
    assert!(!only(digest, &[("weight", "uniform")]).rows.is_empty());
}

#[test]
fn runs_without_bins_or_floors_keep_their_scores() {
    // Older programs record no floor by bin, so the floor of the whole image stays.
    let run = two_views().run;
    assert_eq!(
        run.weighted(&Weight::Picture).cells[0]
            .noise_floors
            .get("relmse"),
        Some(1e-9)
    );
    let mut bare = run;
    bare.cells
        .iter_mut()
        .for_each(|cell| cell.bins = Default::default());
    let found = ratios(&bare);
    assert!(
        found.len() == 1 && found[0].0 == "uniform" && (found[0].1 - 0.2 / 0.6).abs() < F64,
        "{found:?}"
    );
    assert!(
        bare.with_weights(&["picture".to_owned()])
            .unwrap_err()
            .contains("errors_by_n_dot_v.csv")
    );
    // A picture's pixels count once each.
    let axes = "environment = [\"builtin:sky\"]\nmethod = [\"split-sum\", \"split-sum-one\"]\n";
    let run = finished_of(&format!("{}{axes}", super::paper::HEAD), |_| {
        Some(Made::error(0.5))
    });
    assert_eq!(ratios(&run), [("picture".to_owned(), 1.0)]);
}
