//! Which tables one ships, of runs whose tables cost what is written down.

use super::paper::{F64, Paper, column, numbers, only};
use splitsum::study::finished::{Finished, MetricValues};
use splitsum::study::frame::Frame;
use splitsum::study::questions::{Finding, answers_to};
use std::path::Path;

/// Columns of the digest in the row of an alpha.
fn told<const N: usize>(finding: &Finding, alpha: &str, names: [&str; N]) -> [String; N] {
    let row = only(finding.digest.as_ref().unwrap(), &[("alpha", alpha)]);
    names.map(|name| column(&row, name).concat())
}

#[test]
fn tables_are_enough_from_where_no_larger_one_gains() {
    // The error falls with the samples up to 64, and a third level halves it; a small map has room for two levels only.
    let mut paper =
        Paper::new(&["alpha", "method", "prefilter_size", "prefilter_level_count", "prefilter_sample_count"]);
    for (alpha, scale) in [("0.1", 1.0), ("0.5", 3.0)] {
        for (samples, of_samples) in [("256", 1.0), ("64", 1.01), ("16", 1.5), ("1024", 0.99)] {
            for (size, levels, of_levels) in [("256x128", "3", 1.0), ("256x128", "2", 2.0), ("64x32", "2", 2.0)] {
                paper.add(&[alpha, "split-sum", size, levels, samples], scale * of_samples * of_levels);
            }
        }
    }
    let finding = paper.finding("table-size");
    let tables = ["prefilter_size", "prefilter_level_count", "prefilter_sample_count"];
    for alpha in ["0.1", "0.5", "all"] {
        assert_eq!(told(&finding, alpha, tables), ["256x128", "3", "64"]);
        // 1 - 0.99 / 1.01, and two levels cost a factor of two.
        assert_eq!(told(&finding, alpha, ["larger gains at most", "costs up to"]), ["2.0 %", "100 %"]);
        assert_eq!(told(&finding, alpha, ["next smaller"]), ["256x128, 2 levels, 64 samples"]);
    }
    let own = [("prefilter_level_count", "2"), ("prefilter_sample_count", "64"), ("prefilter_size", "64x32")];
    let small = only(&finding.table, &own);
    assert!(
        numbers(&small, "ratio").iter().all(|ratio| (ratio - 2.02 / 0.99).abs() < F64),
        "the best of all larger ones"
    );
    assert_eq!(
        (column(&small, "is_enough"), column(&small, "larger")[0].as_str()),
        (vec!["0".to_owned(); 2], "256x128, 3 levels, 1024 samples")
    );
}

#[test]
fn only_combinations_that_were_tried_are_shipped() {
    // Four levels err by half of what three do; only the large map has room for them, and was not tried with many samples.
    let mut paper = Paper::new(&["method", "prefilter_size", "prefilter_level_count", "prefilter_sample_count"]);
    for (size, levels, samples, error) in [
        ("256x128", "3", "64", 2.2),
        ("256x128", "3", "256", 2.0),
        ("256x128", "3", "1024", 1.8),
        ("512x256", "3", "256", 2.0),
        ("512x256", "4", "256", 1.0),
    ] {
        paper.add(&["split-sum", size, levels, samples], error);
    }
    let finding = paper.finding("table-size");
    assert_eq!(column(&finding.table, "is_enough"), ["0", "0", "1", "0", "1"], "nothing larger than 1024 was tried");
    // 256x128 x 3 x 1024 has 101 million texel samples, 512x256 x 4 x 256 has 134 million: the larger is not needed.
    assert!(
        finding.sentence.starts_with("Ship 256x128, 3 levels, 1024 samples for `split-sum`."),
        "{}",
        finding.sentence
    );
}

#[test]
fn an_error_that_is_small_by_luck_does_not_rule_out_larger_tables() {
    // Faults of few samples and of the split sum cancel: the smallest table errs least, and is shipped; a larger one is no loss to it.
    let mut paper = Paper::new(&["method", "prefilter_sample_count"]);
    for (samples, error) in [("16", 1.0), ("64", 2.0), ("256", 2.01)] {
        paper.add(&["split-sum", samples], error);
    }
    let finding = paper.finding("table-size");
    assert_eq!(column(&finding.table, "is_enough"), ["1", "1", "1"]);
    assert_eq!(
        told(&finding, "all", ["prefilter_sample_count", "larger gains at most", "costs up to"]),
        ["16", "0 %", ""]
    );
}

#[test]
fn each_condition_is_judged_by_itself() {
    // Six levels halve the error in one light and double it in the other: over both they would gain nothing.
    let mut paper = Paper::new(&["environment", "alpha", "method", "prefilter_level_count"]);
    for (light, of_six) in [("builtin:sky", 0.5), ("builtin:studio", 2.0)] {
        for alpha in ["0.05", "0.5"] {
            paper.add(&[light, alpha, "split-sum", "5"], 1.0);
            paper.add(&[light, alpha, "split-sum", "6"], if alpha == "0.5" { 1.0 } else { of_six });
        }
    }
    let finding = paper.finding("table-size");
    let names = ["prefilter_level_count", "costs up to", "where"];
    assert_eq!(told(&finding, "all", names), ["6", "100 %", "sky · alpha 0.05"]);
    assert_eq!(told(&finding, "0.5", ["prefilter_level_count", "costs up to"]), ["5", ""], "the wide lobe needs fewer");
}

#[test]
fn pairs_within_the_noise_tell_nothing() {
    let made = |floor: f64| {
        let mut paper = Paper::new(&["method", "prefilter_sample_count"]);
        for (samples, error) in [("64", 3e-3), ("256", 1e-3)] {
            paper.add(&["split-sum", samples], error).noise_floors = MetricValues::of(|_| Some(floor));
        }
        (paper.lacks("table-size"), answers_to(&Frame::new(&paper.run, None), &["table-size"]).len())
    };
    assert_eq!(made(1e-9), (None, 1));
    assert_eq!(made(1e-3), (None, 0), "nothing is claimed from noise");
}

#[test]
fn the_published_run_ships_what_its_errors_say() {
    let run = Finished::read(&Path::new(env!("CARGO_MANIFEST_DIR")).join("results/tables")).unwrap();
    let answers = answers_to(&Frame::new(&run, None), &["table-size"]);
    let finding = &answers[0].finding;
    let tables = ["prefilter_size", "prefilter_level_count", "prefilter_sample_count", "dfg_size"];
    // By hand from errors.csv: nothing larger in every size was tried; at alpha 0.05 five levels have 1.876 times the error under the sky.
    assert_eq!(told(finding, "all", tables), ["128x128", "6", "1024", "128"]);
    let costs = ["larger gains at most", "next smaller", "costs up to", "where"];
    assert_eq!(
        told(finding, "all", costs),
        ["none tried", "128x128, 5 levels, 1024 samples, DFG 128", "88 %", "sky · alpha 0.05"]
    );
}
