//! Times of frames and tables, for runs with known times.

use super::paper::{Paper, column, numbers, only};
use crate::run::timing_ratios::{record, swept};
use splitsum::run::timing::TimingRecord;
use splitsum::study::frame::Frame;
use splitsum::study::questions::question;

#[test]
fn without_times_no_question_of_times_is_served() {
    assert!(beside(Vec::new()).lacks("times").is_some());
}

#[test]
fn times_of_a_cpu_driver_are_named() {
    let paper = beside(swept());
    let frame = Frame::new(&paper.run, None);
    assert!(question("times").unwrap().rests_on_cpu_times(frame.run));
    assert!(!question("error").unwrap().rests_on_cpu_times(frame.run));
    assert!(
        paper
            .finding("times")
            .sentences
            .markdown()
            .contains("on this CPU driver")
    );
}

#[test]
fn five_rounds_have_no_interval() {
    let mut records = swept();
    records
        .iter_mut()
        .flat_map(|record| &mut record.passes)
        .for_each(|pass| pass.ms.truncate(5));
    let found = beside(records).finding("times");
    assert!(
        numbers(&found.table, "ms_lo")
            .iter()
            .chain(&numbers(&found.table, "ratio_lo"))
            .all(|lo| lo.is_nan())
    );
    assert!(
        !found.sentences.markdown().contains("NaN")
            && !found.digest.unwrap().markdown().contains("NaN")
    );
}

/// A split sum and a sampled image with these times.
fn beside(records: Vec<TimingRecord>) -> Paper {
    let mut paper = Paper::new(&["method", "samples"]);
    paper.add(&["split-sum", ""], 0.3);
    paper.add(&["sampled", "40"], 0.2);
    paper.run.timings = records;
    paper
}

#[test]
fn ratios_come_from_frames_timed_together() {
    let finding = beside(swept()).finding("times");
    let ratio = |method, samples, over| {
        let own = only(
            &finding.table,
            &[
                ("method", method),
                ("samples", samples),
                ("over", over),
                ("masking", "separable"),
            ],
        );
        numbers(&own, "ratio")
    };
    assert_eq!(ratio("sampled", "40", "split-sum"), [3.0]);
    assert_eq!(ratio("sampled-unfiltered", "16", "split-sum"), [1.5]);
    assert_eq!(
        ratio("sampled", "40", "sampled-unfiltered 40"),
        [1.5],
        "two of one kind at the same count"
    );
    assert_eq!(ratio("sampled", "40", "sampled-unfiltered 16"), [0.0; 0]);
    let split = only(
        &finding.table,
        &[("method", "split-sum"), ("phase", "frame")],
    );
    assert_eq!(
        (numbers(&split, "ms"), column(&split, "over")),
        (vec![2.0; 2], vec![String::new(); 2])
    );
    // 2 ms of passes within 1 ms of the host's time are impossible.
    assert!(
        column(&finding.table, "host_check")
            .iter()
            .all(|check| check == "passes-exceed-wall")
    );
}

#[test]
fn a_way_without_samples_takes_as_long_as_the_count_at_which_the_ratio_passes_1() {
    // 0.5 + 0.25 n ms beside 2.25 ms: equal at 7 samples. Beside 0.6 ms every count is slower.
    for (ms, wanted) in [(2.25, Some("7.0 samples")), (0.6, None)] {
        let axes = |method, samples| [("brdf", "ggx"), ("method", method), ("samples", samples)];
        let fixed = record("frame", &axes("split-sum", ""), &[("shade-specular", ms)]);
        let counts = [("1", 0.75), ("4", 1.5), ("8", 2.5), ("16", 4.5)];
        let sampled = counts.map(|(n, ms)| {
            record(
                "frame",
                &axes("sampled", n),
                &[("gbuffer", 9.0), ("shade-specular", ms)],
            )
        });
        let two = record(
            "frame",
            &axes("split-sum-two", ""),
            &[("shade-specular", 1.5 * ms)],
        );
        let digest = beside(vec![fixed.clone(), two])
            .finding("times")
            .digest
            .unwrap();
        assert_eq!(
            column(
                &only(&digest, &[("method", "split-sum-two")]),
                "times `split-sum`"
            ),
            ["1.5"]
        );
        let finding = beside([vec![fixed], sampled.to_vec()].concat()).finding("times");
        let says = |words: &str| finding.sentences.markdown().contains(words);
        assert!(
            wanted.map_or(!says("samples"), |words| says(&format!(
                "`split-sum` {words}"
            ))),
            "{}",
            finding.sentences.markdown()
        );
    }
}

#[test]
fn alternative_tables_are_a_range_and_never_a_sum() {
    let own: Vec<TimingRecord> = swept()
        .into_iter()
        .filter(|record| record.axes["masking"] == "separable")
        .collect();
    let finding = beside(own).finding("times");
    let digest = finding.digest.as_ref().unwrap();
    let split = |name| column(&only(digest, &[("method", "split-sum")]), name).remove(0);
    assert_eq!(split("tables once, ms"), "40 to 382");
    assert_eq!(split("of which"), "mips 2.0, prefilter 30 to 372, dfg 8.0");
    assert!(!digest.markdown().contains("422") && !finding.table.csv().contains("422"));
    assert!(
        finding
            .sentences
            .markdown()
            .ends_with("The tables of `split-sum` take 40 to 382 ms once per map and model.")
    );
    let all = only(
        &finding.table,
        &[
            ("phase", "precompute"),
            ("method", "split-sum"),
            ("pass", "all"),
        ],
    );
    assert_eq!(column(&all, "prefilter_sample_count"), ["64", "1024"]);
    assert_eq!(numbers(&all, "ms"), [40.0, 382.0]);
    assert!(
        finding.table.columns.iter().all(|name| name != "masking"),
        "one masking only"
    );
}
