//! Break-even, over the whole object and by `n_dot_v`.

use super::{AnswerTable, columns, count, texts, yes};
use crate::study::answers::Answers;
use crate::study::answers::break_even::BreakEven;
use crate::study::answers::cases::{Crossing, Pair};
use crate::table::csv::Cell;

/// The columns of a crossing.
const CROSSING: [&str; 7] =
    ["break_even", "answer", "crossing", "crossing_lo", "crossing_hi", "interval_from", "at_equal_time"];

fn crossing([smallest, largest]: [u32; 2], crossing: &Crossing) -> Vec<Cell> {
    let (n, answer) = match crossing.break_even {
        BreakEven::From(n) if n == smallest => (n, "always"),
        BreakEven::From(n) => (n, "from"),
        BreakEven::Above(_) => (largest, "never"),
    };
    let ends = crossing.interval.map_or([None; 2], |ends| ends.map(Some));
    vec![
        count(n),
        Cell::from(answer),
        crossing.crossing.into(),
        ends[0].into(),
        ends[1].into(),
        Some(crossing.basis.name()).filter(|name| !name.is_empty()).map_or(Cell::Missing, Cell::from),
        Some(crossing.at_equal_time.name()).filter(|name| !name.is_empty()).map_or(Cell::Missing, Cell::from),
    ]
}

fn pair_cells(pair: &Pair) -> [Cell; 2] {
    [Cell::from(pair.sampled.as_str()), Cell::from(pair.fixed.as_str())]
}

/// One row a case and pair of methods. `break_even` is a tried count: the first one from which sampling stays better (answers `from`
/// and `always`), or the largest one tried (`never`). Ends of intervals: 0 is below the tried counts, `inf` above them.
pub(super) fn break_even(answers: &Answers) -> AnswerTable {
    let rows = answers.pairs.iter().flat_map(|pair| {
        pair.cases.iter().map(move |case| {
            let mut row = texts(&case.key);
            row.extend(pair_cells(pair));
            row.push(case.fixed_error.into());
            row.extend(crossing(pair.tried(), &case.whole));
            row.push(case.time.map(|time| time.samples).into());
            let ends = case.time.and_then(|time| time.interval).map_or([None; 2], |ends| ends.map(Some));
            row.extend(ends.map(Cell::from));
            let ends = case.time_ratio_interval.map_or([None; 2], |ends| ends.map(Some));
            row.extend([case.time_ratio_at_crossing, ends[0], ends[1], case.payback_frames].map(Cell::from));
            row.push(case.time.map_or(Cell::Missing, |time| yes(time.is_cpu)));
            row.push(yes(case.is_reference_limited));
            row
        })
    });
    let mut own = vec!["sampled", "fixed", "fixed_error"];
    own.extend(CROSSING);
    own.extend(["samples_in_equal_time", "samples_in_equal_time_lo", "samples_in_equal_time_hi"]);
    own.extend([
        "time_ratio_at_crossing",
        "time_ratio_lo",
        "time_ratio_hi",
        "payback_frames",
        "is_cpu_time",
        "is_reference_limited",
    ]);
    AnswerTable { name: "break_even", columns: columns(answers, &own), rows: rows.collect() }
}

/// One row a case, pair of methods and bin of `n_dot_v`; as `break_even`.
pub(super) fn break_even_by_n_dot_v(answers: &Answers) -> AnswerTable {
    let rows = answers.pairs.iter().flat_map(|pair| {
        pair.cases.iter().flat_map(move |case| {
            case.bins.iter().map(move |bin| {
                let mut row = texts(&case.key);
                row.extend(pair_cells(pair));
                row.extend([bin.lo.into(), bin.hi.into(), bin.fixed_error.into()]);
                row.extend(crossing(pair.tried(), &bin.crossing));
                row.push(case.time.map_or(Cell::Missing, |time| yes(time.is_cpu)));
                row
            })
        })
    });
    let mut own = vec!["sampled", "fixed", "n_dot_v_from", "n_dot_v_to", "fixed_error"];
    own.extend(CROSSING);
    own.push("is_cpu_time");
    AnswerTable { name: "break_even_by_n_dot_v", columns: columns(answers, &own), rows: rows.collect() }
}
