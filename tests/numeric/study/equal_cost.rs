//! Equal cost beside equal error, on made errors and made counts of instructions.

use super::paper::{Made, alu, costs, finished, numbers};
use splitsum::cost::isa::Counts;
use splitsum::cost::record::RecordedPass;
use splitsum::experiment::axis::Point;
use splitsum::study::frame::Frame;
use splitsum::study::questions::question;

const AXES: &str = r#"
environment = ["builtin:sky", "builtin:studio", "builtin:cap"]
method = ["sampled", "split-sum"]
samples = [1, 2, 4, 8, 16, 32]
"#;

/// Sampling meets the error of the other at 3, 6 and 12 samples.
fn made(point: &Point) -> Option<Made> {
    let meets = match point.get("environment").to_string().as_str() {
        "builtin:sky" => 3.0,
        "builtin:studio" => 6.0,
        _ => 12.0,
    };
    let samples: f64 = point.get("samples").to_string().parse().unwrap_or(meets);
    Some(Made::error(meets / samples))
}

#[test]
fn sampling_wins_where_equal_error_takes_fewer_samples_than_equal_cost() {
    let mut run = finished(AXES, made);
    let found = |run: &splitsum::study::finished::Finished, names: [&str; 7]| {
        let frame = Frame::new(run, None);
        let finding = (question("equal-cost").unwrap().answer)(&frame).unwrap();
        assert_eq!(finding.table.rows.len(), 1);
        names.map(|name| numbers(&finding.table, name)[0])
    };
    const NAMES: [&str; 7] = [
        "samples_at_equal_cost_least",
        "samples_at_equal_cost_most",
        "samples_at_equal_cost_each_frame_least",
        "samples_at_equal_cost_each_frame_most",
        "samples_at_equal_error",
        "sampled_errs_less",
        "fixed_errs_less",
    ];
    assert!((question("equal-cost").unwrap().answer)(&Frame::new(&run, None)).is_none(), "no costs, no answer");
    // 64 + 64 N <= 640 + share: six faces of 128 x 128 texels with one sample, a third as many with 256, are 8.45 million samples of 64
    // instructions: 4.08 samples a pixel of a frame, 0.07 of sixty.
    let passes = [("sampled", alu(64.0), alu(64.0)), ("split-sum", alu(640.0), alu(0.0)), ("", alu(0.0), alu(64.0))];
    run.costs = Some(costs(&Point::default(), &passes));
    let [least, most, frame_least, frame_most, met, won, lost] = found(&run, NAMES);
    assert_eq!([least, most, frame_least, frame_most], [9.0, 9.0, 13.0, 13.0]);
    assert!((met - 6.0).abs() < 1e-9 && [won, lost] == [2.0, 1.0], "{met} {won} {lost}");
    // A second unit as busy as the first: beside it for nothing, or after it. What lies between the ends is open.
    let both = Counts { alu: 640.0, quarter: 160.0, ..Counts::default() };
    run.costs = Some(costs(&Point::default(), &[passes[0], ("split-sum", both, alu(0.0)), passes[2]]));
    let [least, most, .., won, lost] = found(&run, NAMES);
    assert_eq!([least, most, won, lost], [9.0, 19.0, 2.0, 0.0]);
    // Another card, where the other method costs a half: 64 + 64 N <= 320 + share. Each card has its row; nothing is pooled over both.
    let cheap = costs(&Point::default(), &[passes[0], ("split-sum", alu(320.0), alu(0.0)), passes[2]]).passes;
    let cheap = cheap.into_iter().map(|pass| RecordedPass { family: "vega10".to_owned(), ..pass });
    run.costs.as_mut().unwrap().passes.extend(cheap);
    let frame = Frame::new(&run, None);
    let finding = (question("equal-cost").unwrap().answer)(&frame).unwrap();
    let column = |name| numbers(&finding.table, name);
    assert_eq!(column(NAMES[0]), [4.0, 9.0]);
    assert_eq!(column(NAMES[1]), [4.0, 19.0]);
    assert_eq!([column("sampled_errs_less"), column("fixed_errs_less")], [vec![1.0, 2.0], vec![2.0, 0.0]]);
    let cards = "on a `Radeon RX 6800 XT`, `sampled` takes **9 to 19 samples a pixel**; on a `Radeon RX Vega 64` 4.";
    assert!(finding.sentence.contains(cards), "{}", finding.sentence);
}
