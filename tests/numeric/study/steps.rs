//! The steps of the split sum's error in answers, for runs with given shares; and the weight of
//! each environment.

use super::paper::{F64, Paper, column, numbers, only};
use splitsum::study::finished::{Bin, StepRow};
use splitsum::study::questions::Finding;

/// Shares of the steps `masking` and `view`, which together make the error.
fn steps(n_dot_v: [f64; 2], masking: f64, noise: f64) -> Vec<StepRow> {
    let row = |step: &str, share: f64, rung_error: f64| StepRow {
        n_dot_v,
        step: step.to_owned(),
        share,
        share_error: 1e-3,
        rung_error,
        first_in: 0.5 * share,
        last_out: 2.0 * share,
        shapley: share,
        step_error: 2e-3,
        noise,
    };
    vec![
        row("masking", masking, 0.1),
        row("view", 1.0 - masking, 1.0),
    ]
}

/// One image of each light at one alpha, with the share of masking over all views and facing the
/// viewer.
fn run(lights: &[(&str, f64, f64)]) -> Finding {
    let mut paper = Paper::new(&["scene", "environment", "method", "alpha"]);
    for (light, all, facing) in lights {
        // View has its least share facing the viewer at one alpha, and its largest there at the
        // other.
        for (alpha, grazing, facing) in [("0.5", 0.5, *facing), ("0.1", 0.4, 0.1)] {
            let bands = [
                ([0.0, 1.0], *all),
                ([0.0, 0.2], grazing),
                ([0.8, 1.0], facing),
            ];
            let listed = bands
                .map(|(seen, masking)| steps(seen, masking, 1e-6))
                .concat();
            paper.add(&["design", light, "split-sum", alpha], 1.0).steps = listed.into();
        }
    }
    // Under constant light no error is above the noise.
    paper
        .add(&["design", "builtin:constant", "split-sum", "0.5"], 1e-3)
        .steps = steps([0.0, 1.0], 0.5, 0.2).into();
    let mut frame = splitsum::study::frame::Frame::new(&paper.run, None);
    (frame.shape.has_ladder, frame.shape.reference_method) = (true, "reference".to_owned());
    let question = splitsum::study::questions::question("ladder").unwrap();
    assert_eq!(question.lack(&frame.shape), None);
    (question.answer)(&frame).unwrap()
}

const MAPS: [&str; 6] = ["a.hdr", "b.hdr", "c.hdr", "d.hdr", "e.hdr", "f.hdr"];

#[test]
fn noise_alone_is_attributed_to_no_step() {
    let finding = run(&[]);
    assert!(
        finding.table.rows.is_empty() && !finding.sentences.markdown().contains('%'),
        "{}",
        finding.sentences.markdown()
    );
}

#[test]
fn shares_are_means_over_maps_with_formulas_apart() {
    let shares = [0.1, 0.2, 0.3, 0.1, 0.2, 0.3];
    let maps = MAPS
        .iter()
        .zip(shares)
        .map(|(map, share)| (*map, share, 0.7));
    let finding = run(&maps.chain([("builtin:sky", 0.9, 0.9)]).collect::<Vec<_>>());
    let whole = [
        ("environment", "all"),
        ("n_dot_v_from", "0"),
        ("rung", "masking"),
    ];
    let row = only(&finding.table, &whole);
    // Six maps: the mean is 0.2, the standard deviation sqrt(0.008), t of 5 degrees of freedom
    // 2.5706.
    let half = 2.570_581_836 * (0.008_f64 / 6.0).sqrt();
    for (name, right) in [
        ("share", 0.2),
        ("share_lo", 0.2 - half),
        ("share_hi", 0.2 + half),
        ("first_in", 0.1),
    ] {
        assert!(
            (numbers(&row, name)[0] - right).abs() < 1e-4,
            "{name}: {:?}",
            numbers(&row, name)
        );
    }
    // A formula has its own row; constant light has none.
    let own = [
        ("environment", "builtin:sky"),
        ("n_dot_v_from", "0"),
        ("rung", "masking"),
    ];
    assert!((numbers(&only(&finding.table, &own), "share")[0] - 0.9).abs() < F64);
    assert!(!column(&finding.table, "environment").contains(&"builtin:constant".to_owned()));
    let says = ["80 %", "70 %", "by more than 0.20 %"]
        .map(|words| finding.sentences.markdown().contains(words));
    assert_eq!(says, [true; 3], "{}", finding.sentences.markdown());
}

#[test]
fn shares_of_both_signs_are_given_as_a_range() {
    let maps = MAPS
        .iter()
        .enumerate()
        .map(|(i, map)| (*map, if i % 2 == 0 { -0.2 } else { 0.25 }, 0.1));
    let finding = run(&maps.collect::<Vec<_>>());
    let digest = finding.digest.unwrap();
    assert_eq!(
        column(&only(&digest, &[("n·v", "all")]), "masking"),
        ["-20 to 25 %"; 2]
    );
}

#[test]
fn tables_are_judged_in_every_band_of_the_view() {
    let mut paper = Paper::new(&["scene", "environment", "alpha", "method", "prefilter_size"]);
    paper.run.provenance.reference.method = "ladder-view".into();
    // Over all n·v both tables err by less than a tenth of the split; facing the viewer only the
    // larger one does.
    let bands = |grazing: f64, facing: f64| -> Vec<Bin> {
        let bin = |lo: f64, error: f64| super::paper::bin([lo, lo + 0.2], |_| Some(error));
        vec![bin(0.0, grazing), bin(0.8, facing)]
    };
    paper
        .add(&["design", "a.hdr", "0.1", "reference", ""], 1.0)
        .bins = bands(1.0, 0.1).into();
    paper
        .add(&["design", "a.hdr", "0.1", "split-sum", "64x64"], 0.05)
        .bins = bands(0.05, 0.02).into();
    paper
        .add(&["design", "a.hdr", "0.1", "split-sum", "128x128"], 0.02)
        .bins = bands(0.02, 0.005).into();
    let finding = paper.finding("tables");
    let digest = finding.digest.unwrap();
    let row = only(&digest, &[("alpha", "0.1")]);
    assert_eq!(
        [
            "smallest tables that are enough from here on",
            "share at most, from here on",
            "where"
        ]
        .map(|name| column(&row, name).concat()),
        ["128x128", "5.0 %", "n·v 0.8 to 1"]
    );
    let small = only(
        &finding.table,
        &[("n_dot_v_from", "0.8"), ("prefilter_size", "64x64")],
    );
    assert!((numbers(&small, "share")[0] - 0.2).abs() < F64);
    assert_eq!(column(&small, "is_enough"), ["0"]);
    // Six faces, five levels, and the DFG table.
    let texels = 6.0 * 64.0 * 64.0 * (1.0 + 0.25 + 0.0625 + 0.015625 + 0.00390625) + 128.0 * 128.0;
    assert_eq!(numbers(&small, "texels")[0], texels);
}

/// If there is a design, pictures do not count in a metric of radiance: their errors are not
/// averaged with the design's.
#[test]
fn a_design_alone_answers_for_metrics_of_radiance() {
    let mut paper = Paper::new(&["scene", "environment", "method", "alpha"]);
    for (method, error) in [("split-sum", 0.5), ("split-sum-unity", 0.1)] {
        paper.add(&["design", "builtin:sky", method, "0.5"], error);
        paper.add(
            &["sphere", "builtin:sky", method, "0.5"],
            100.0 * error * error,
        );
    }
    let finding = paper.finding("effect");
    let ratios = numbers(&finding.table, "ratio");
    assert!(
        ratios.len() == 1
            && [0.2, 5.0]
                .iter()
                .any(|right| (ratios[0] - right).abs() < F64),
        "{ratios:?}"
    );
}
