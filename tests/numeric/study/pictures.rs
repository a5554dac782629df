//! Pictures against the textbook's split sum, for runs with known ratios.

use super::paper::{F64, Paper, column, numbers, only};
use splitsum::instrument::metrics::PICTURE_SCORES;
use splitsum::study::finished::MetricValues;
use splitsum::study::questions::answers;
use splitsum::study::table::Table;

const AXES: &[&str] = &[
    "scene",
    "environment",
    "environment_orientation",
    "alpha",
    "method",
];

/// Six environments, two scenes and two orientations. Under environment i the ratios of
/// `split-sum-one` are x/2 and 2x on the sphere and x twice on the ball, x = 0.5 exp(0.4 (i -
/// 2.5)). Brightness is off by half, and by a hundredth.
fn six_maps() -> Paper {
    let mut paper = Paper::new(AXES);
    for i in 0..6 {
        let x = 0.5 * (0.4 * (f64::from(i) - 2.5)).exp();
        for (scene, orientation, ratio) in [
            ("sphere", "1", x / 2.0),
            ("sphere", "2", 2.0 * x),
            ("shader-ball", "1", x),
            ("shader-ball", "2", x),
        ] {
            let sign = if orientation == "1" { -1.0 } else { 1.0 };
            for (method, error, bias) in [
                ("split-sum", 0.1, 0.5),
                ("split-sum-one", 0.1 * ratio, 0.01),
            ] {
                let cell = paper.add(
                    &[scene, &format!("map{i}.hdr"), orientation, "0.1", method],
                    error,
                );
                cell.scores = Some(MetricValues::from_fn(|name| {
                    Some(if name == "bias_rel" {
                        sign * bias
                    } else {
                        error
                    })
                }));
            }
        }
    }
    paper
}

fn row(table: &Table, method: &str, metric: &str) -> Table {
    only(
        table,
        &[("scene", "all"), ("method", method), ("metric", metric)],
    )
}

fn number(row: &Table, name: &str) -> f64 {
    numbers(row, name)[0]
}

#[test]
fn pictures_have_a_median_a_share_made_worse_and_a_worst_one() {
    let found = six_maps().finding("pictures");
    let row_of = |metric| row(&found.table, "split-sum-one", metric);
    for metric in &PICTURE_SCORES[..3] {
        let own = row_of(metric);
        assert_eq!(number(&own, "images"), 24.0);
        // The median under environment i is x; of six the middle is 0.5.
        assert!((number(&own, "median_ratio") - 0.5).abs() < F64);
        // Above 1: three of four under the last environment, one of four under the two before.
        assert!((number(&own, "worse_fraction") - (0.75 + 0.25 + 0.25) / 6.0).abs() < F64);
        assert!((number(&own, "worst_ratio") - 1f64.exp()).abs() < F64);
        let place = ["worst_environment", "worst_orientation", "worst_scene"]
            .map(|name| column(&own, name).concat());
        assert_eq!(place, ["map5.hdr", "2", "sphere"]);
        // Logarithms have the variance 0.56; Student's factor with 5 degrees of freedom is 2.571.
        let half = 2.571 * (0.56f64 * (1.0 + 1.0 / 6.0)).sqrt();
        assert!((number(&own, "median_predicted_lo") / (0.5 * (-half).exp()) - 1.0).abs() < F64);
        assert!((number(&own, "median_predicted_hi") / (0.5 * half.exp()) - 1.0).abs() < F64);
        assert_eq!(
            (number(&own, "worse_lo"), number(&own, "worse_predicted_lo")),
            (0.0, 0.0)
        );
    }
    // A signed score is never averaged: its ends and the ratio of magnitudes.
    let light = row_of("bias_rel");
    assert_eq!(
        ["least_score", "largest_score"].map(|name| number(&light, name)),
        [-0.01, 0.01]
    );
    assert!((number(&light, "median_ratio") - 0.02).abs() < F64);
    let base = row(&found.table, "split-sum", "bias_rel");
    assert_eq!(
        ["least_score", "largest_score"].map(|name| number(&base, name)),
        [-0.5, 0.5]
    );
    let digest = found.digest.as_ref().unwrap();
    let light = only(digest, &[("score", "bias_rel")]);
    assert_eq!(
        ["split-sum-one", "split-sum"].map(|name| column(&light, name).concat()),
        ["-1.0 to 1.0 %", "-50 to 50 %"]
    );
    // Each scene has its own row.
    let ball = only(
        &found.table,
        &[
            ("scene", "shader-ball"),
            ("method", "split-sum-one"),
            ("metric", "relmse"),
        ],
    );
    assert!(
        (number(&ball, "worse_fraction") - 1.0 / 6.0).abs() < F64
            && number(&ball, "images") == 12.0
    );
}

#[test]
fn the_order_of_pictures_changes_nothing() {
    let rows = |paper: &Paper| {
        let mut lines: Vec<String> = paper
            .finding("pictures")
            .table
            .csv()
            .lines()
            .map(str::to_owned)
            .collect();
        lines.sort();
        lines
    };
    let (paper, mut turned) = (six_maps(), six_maps());
    // The cells of pictures with equal ratios keep their ids.
    turned.run.cells.reverse();
    assert_eq!(rows(&paper), rows(&turned));
}

#[test]
fn pictures_within_the_noise_do_not_count() {
    let mut paper = six_maps();
    // Both errors of one picture are below ten standard errors, of the next one only one.
    for place in [0, 1, 3] {
        paper.run.cells[place].noise_floors =
            MetricValues::from_fn(|name| (name == "relmse").then_some(0.1));
    }
    let table = paper.finding("pictures").table;
    let images = |metric| number(&row(&table, "split-sum-one", metric), "images");
    assert_eq!((images("relmse"), images("flip")), (23.0, 24.0));
}

#[test]
fn runs_without_several_orientations_or_a_base_are_refused() {
    let lack = |rows: &[[&str; 5]]| {
        let mut paper = Paper::new(AXES);
        for values in rows {
            paper.add(values, 1.0);
        }
        paper.lacks("pictures")
    };
    let [base, other] = [
        ["sphere", "a.hdr", "1", "0.1", "split-sum"],
        ["sphere", "a.hdr", "1", "0.1", "split-sum-one"],
    ];
    assert!(
        lack(&[base, other])
            .unwrap()
            .contains("fewer than two orientations")
    );
    assert!(
        lack(&[other, ["sphere", "a.hdr", "2", "0.1", "split-sum-one"]])
            .unwrap()
            .contains("no `split-sum`")
    );
    let design = |[_, a, b, c, d]: [&'static str; 5]| ["design", a, b, c, d];
    assert!(
        lack(&[design(base), design(other)])
            .unwrap()
            .contains("not a picture")
    );
    // A design in the same run does not hide the pictures.
    let mut paper = six_maps();
    paper.add(&["design", "map0.hdr", "1", "0.1", "split-sum"], 1.0);
    let answers = answers(&paper.run, None);
    let found = answers
        .iter()
        .find(|answer| answer.question.name == "pictures")
        .unwrap();
    assert_eq!(
        number(
            &row(&found.finding.table, "split-sum-one", "relmse"),
            "images"
        ),
        24.0
    );
}
