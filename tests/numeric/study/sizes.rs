//! Which tables one ships, of runs whose tables cost what is written down.

use super::paper::{F64, Paper, column, numbers, only};
use crate::runner::fake::SPLIT_SUM_ERROR;
use crate::runner::runs::{fakes, log, options, plan};
use splitsum::runner::{MakeRenderer, run};
use splitsum::study::finished::{Finished, MetricValues};
use splitsum::study::questions::{Finding, answers};
use std::sync::atomic::AtomicBool;

/// The digest's column by axis of the tables.
fn of(finding: &Finding, axis: &str, name: &str) -> String {
    let rows = only(finding.digest.as_ref().unwrap(), &[("table", axis)]);
    let [only] = <[String; 1]>::try_from(column(&rows, name)).unwrap();
    only
}

#[test]
fn tables_are_enough_from_where_no_larger_one_gains() {
    // The error falls with the samples up to 64, and a third level halves it; a small map, which cannot have three levels, seems to cost
    // nothing beside two.
    let mut paper =
        Paper::new(&["alpha", "method", "prefilter_size", "prefilter_level_count", "prefilter_sample_count"]);
    for (alpha, scale) in [("0.1", 1.0), ("0.5", 3.0)] {
        for (samples, of_samples) in [("256", 1.0), ("64", 1.01), ("16", 1.5), ("1024", 0.99)] {
            for (levels, of_levels) in [("3", 1.0), ("2", 2.0)] {
                for size in ["256x128", "64x32"] {
                    if size == "256x128" || levels == "2" {
                        paper.add(&[alpha, "split-sum", size, levels, samples], scale * of_samples * of_levels);
                    }
                }
            }
        }
    }
    let finding = paper.finding("table-size");
    assert_eq!(column(finding.digest.as_ref().unwrap(), "table"), ["prefilter_level_count", "prefilter_sample_count"]);
    let samples = "prefilter_sample_count";
    assert_eq!(
        [of(&finding, samples, "ship"), of(&finding, "prefilter_level_count", "ship")],
        ["64 samples", "3 levels"]
    );
    let cost = |value, against| {
        let rows =
            only(&finding.table, &[("axis", samples), ("value", value), ("against", against), ("alpha", "0.500")]);
        numbers(&rows, "ratio")
    };
    // Beside three levels alone: two are below the base.
    assert!((cost("16", "64")[0] - 1.5 / 1.01).abs() < F64 && cost("16", "64").len() == 1);
    assert!((cost("64", "1024")[0] - 1.01 / 0.99).abs() < F64);
    assert_eq!(of(&finding, samples, "costs up to"), "49 %", "1.5 / 1.01");
    assert_eq!(of(&finding, samples, "larger gains at most"), "2.0 %", "1 - 0.99 / 1.01");
    assert_eq!(of(&finding, "prefilter_level_count", "larger gains at most"), "no larger one tried");
    assert_eq!(of(&finding, "prefilter_level_count", "costs up to"), "100 %");
}

#[test]
fn what_is_enough_of_one_table_may_need_more_of_another() {
    // Four levels err by half of what three do, and only the larger map has room for them; its size itself gains nothing.
    let mut paper = Paper::new(&["alpha", "method", "prefilter_size", "prefilter_level_count"]);
    for (alpha, scale) in [("0.1", 1.0), ("0.5", 3.0)] {
        for (size, levels, error) in [("256x128", "3", 2.0), ("512x256", "3", 2.0), ("512x256", "4", 1.0)] {
            paper.add(&[alpha, "split-sum", size, levels], scale * error);
        }
    }
    let finding = paper.finding("table-size");
    let told = |axis| ["enough alone", "ship"].map(|name| of(&finding, axis, name));
    assert_eq!(told("prefilter_size"), ["256x128", "512x256"]);
    assert_eq!(told("prefilter_level_count"), ["4 levels", "4 levels"]);
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
    let told = |name| of(&finding, "prefilter_level_count", name);
    assert_eq!([told("ship"), told("costs up to"), told("where")], ["6 levels", "100 %", "alpha 0.05 · sky"]);
    assert_eq!([told("alpha 0.05"), told("alpha 0.5")], ["6 levels", "5 levels"], "the wide lobe needs fewer");
    assert_eq!(numbers(&finding.table, "is_enough"), [0.0, 1.0, 1.0, 1.0]);
}

#[test]
fn pairs_within_the_noise_tell_nothing() {
    let made = |floor: f64| {
        let mut paper = Paper::new(&["method", "prefilter_sample_count"]);
        for (samples, error) in [("64", 3e-3), ("256", 1e-3)] {
            paper.add(&["split-sum", samples], error).noise_floors = MetricValues::of(|_| Some(floor));
        }
        (
            paper.lacks("table-size"),
            splitsum::study::questions::answers(&paper.run, &["table-size".to_owned()], None).len(),
        )
    };
    assert_eq!(made(1e-9), (None, 1));
    assert_eq!(made(1e-3), (None, 0), "nothing is claimed from noise");
}

#[test]
fn a_renderer_whose_error_falls_with_the_levels() {
    // relmse is a mean square: half the error costs a factor of four.
    let levels = |request: &splitsum::pipeline::RenderRequest| match request.precompute.prefilter_level_count {
        2 => 4.0 * SPLIT_SUM_ERROR,
        3 => 2.0 * SPLIT_SUM_ERROR,
        _ => SPLIT_SUM_ERROR,
    };
    let (dir, log, stop) = (tempfile::tempdir().unwrap(), log(), AtomicBool::new(false));
    log.borrow_mut().split_sum_error = Some(levels);
    let plan = plan(
        "name = \"levels\"\nsize = [16, 16]\nreference = { samples = 64 }\n[axes]\nenvironment = [\"builtin:constant\", \"builtin:sky\"]\n\
         method = [\"split-sum\"]\nalpha = [0.1, 0.5]\nprefilter_size = [[256, 128]]\nprefilter_level_count = [3, 2, 4, 5]\ndiffuse = [\"none\"]\n",
    );
    run(&plan, &mut fakes(&log) as &mut MakeRenderer, &options(dir.path(), &stop), &mut crate::runner::runs::Silent)
        .unwrap();
    let run = Finished::read(dir.path()).unwrap();
    let [answer] = <[_; 1]>::try_from(answers(&run, &["table-size".to_owned()], None)).unwrap_or_else(|_| panic!());
    let told = |name| of(&answer.finding, "prefilter_level_count", name);
    assert_eq!([told("ship"), told("next smaller"), told("larger gains at most")], ["4 levels", "3 levels", "0 %"]);
    let cost = only(&answer.finding.table, &[("value", "2"), ("against", "3")]);
    // f32 pixels carry the factor to about 1e-6.
    assert!(cost.rows.len() == 4 && numbers(&cost, "ratio").iter().all(|ratio| (ratio - 4.0).abs() < 1e-4));
}
