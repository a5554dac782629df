//! Recommended tables, for runs with given errors of tables.

use super::paper::{F64, Paper, column, numbers, only};
use splitsum::study::finished::MetricValues;
use splitsum::study::frame::Frame;
use splitsum::study::questions::{Finding, question};

const FROM_HERE: &str = "smallest tables that are enough from here on";

fn judged_by(method: &str) -> Paper {
    let mut paper = Paper::new(&[
        "environment",
        "alpha",
        "method",
        "prefilter_size",
        "prefilter_sample_count",
        "level_mapping",
        "prefilter",
    ]);
    paper.run.provenance.reference.method = method.into();
    paper
}

fn shown<const N: usize>(finding: &Finding, alpha: &str, names: [&str; N]) -> [String; N] {
    let row = only(finding.digest.as_ref().unwrap(), &[("alpha", alpha)]);
    names.map(|name| column(&row, name).concat())
}

/// Two lights and two alphas. The split errs by 1 at alpha 0.1 and by 4 at 0.5; tables err by their
/// own number, twice that under the sky.
pub fn run() -> Paper {
    let mut paper = judged_by("ladder-view");
    for (light, of_light) in [("builtin:studio", 1.0), ("builtin:sky", 2.0)] {
        for (alpha, split) in [("0.1", 1.0), ("0.5", 4.0)] {
            paper.add(&[light, alpha, "reference", "", "", "", ""], split);
            for (size, samples, mapping, error) in [
                ("16x16", "64", "linear", 0.19),
                ("64x64", "64", "linear", 0.04),
                ("64x64", "64", "quadratic", 0.03),
                ("64x64", "256", "linear", 0.01),
            ] {
                paper.add(
                    &[light, alpha, "split-sum", size, samples, mapping, "sampled"],
                    of_light * error,
                );
            }
        }
        // Tried under one alpha only.
        paper.add(
            &[
                light,
                "0.1",
                "split-sum",
                "32x32",
                "64",
                "linear",
                "sampled",
            ],
            1e-3,
        );
    }
    paper
}

#[test]
fn tables_are_enough_if_they_err_by_a_tenth_of_the_split() {
    let finding = run().finding("tables");
    // 2 x 0.19 is 0.38 of 1 and 0.095 of 4; of equal sizes the better mapping leads, though both
    // are enough.
    let [tables, share, error] = [
        FROM_HERE,
        "share at most, from here on",
        "their error here, geometric mean over all n·v",
    ];
    let at_half = shown(&finding, "0.5", [tables, share, "where"]);
    assert_eq!(
        at_half,
        [
            "16x16, 64 samples, linear mapping",
            "9.5 %",
            "sky · alpha 0.5"
        ]
    );
    // Tables that were tried at one alpha are not enough from it on.
    let on = shown(&finding, "0.1", [tables, share, "where"]);
    assert_eq!(
        on,
        [
            "64x64, 64 samples, quadratic mapping",
            "6.0 %",
            "sky · alpha 0.1"
        ]
    );
    // The geometric mean of 0.03 and 0.06.
    assert!(
        shown(&finding, "0.1", [error])[0].starts_with("0.042"),
        "{:?}",
        shown(&finding, "0.1", [error])
    );
    assert!(
        finding
            .sentences
            .markdown()
            .starts_with("Ship **64x64, 64 samples, quadratic mapping**"),
        "{}",
        finding.sentences.markdown()
    );
    let set = "--set prefilter_size=64x64 --set level_mapping=quadratic`";
    assert!(
        finding.sentences.markdown().contains(set),
        "{}",
        finding.sentences.markdown()
    );
    let own = [
        ("alpha", "0.5"),
        ("environment", "builtin:sky"),
        ("prefilter_size", "16x16"),
    ];
    let row = only(&finding.table, &own);
    let found = ["error", "split_error", "share"].map(|name| numbers(&row, name)[0]);
    assert!(
        found
            .iter()
            .zip([0.38, 4.0, 0.095])
            .all(|(a, b)| (a - b).abs() < F64),
        "{found:?}"
    );
    assert_eq!(column(&row, "is_enough"), ["1"]);
    // An rmse may be a third of the split's own: true for the studio, false for the sky.
    let mut roots = run().run;
    for cell in &mut roots.cells {
        let error = cell.scores.as_ref().unwrap().get("relmse");
        cell.scores = Some(MetricValues::from_fn(|_| error));
    }
    let table = (question("tables").unwrap().answer)(&Frame::new(&roots, Some("rmse")))
        .unwrap()
        .table;
    assert_eq!(
        column(
            &only(&table, &[("alpha", "0.1"), ("prefilter_size", "16x16")]),
            "is_enough"
        ),
        ["1", "0"]
    );
}

#[test]
fn only_the_exact_split_judges_tables() {
    assert!(run().lacks("tables").is_none());
    let mut two = run();
    two.add(
        &[
            "builtin:sky",
            "0.1",
            "split-sum-two",
            "16x16",
            "64",
            "linear",
            "sampled",
        ],
        0.1,
    );
    assert!(
        two.lacks("tables").is_some(),
        "the exact split is not the limit of another split sum"
    );
    let mut by_truth = judged_by("reference");
    let mut without_truth = judged_by("ladder-view");
    for paper in [&mut by_truth, &mut without_truth] {
        for samples in ["64", "256"] {
            paper.add(
                &[
                    "builtin:sky",
                    "0.1",
                    "split-sum",
                    "64x64",
                    samples,
                    "linear",
                    "sampled",
                ],
                1.0,
            );
        }
    }
    by_truth.add(&["builtin:sky", "0.1", "reference", "", "", "", ""], 1.0);
    assert!(by_truth.lacks("tables").is_some() && without_truth.lacks("tables").is_some());
}
