//! The tone curve, the dynamic range, and the energy that is left.

use super::{AnswerTable, columns, texts};
use crate::runner::tables::{DISPLAY_HEADLINE, HEADLINE};
use crate::study::answers::Answers;
use crate::study::answers::dynamic_range::{Growth, RangePoint, growth};
use crate::study::answers::exposure::Visibility;
use crate::table::csv::Cell;

/// One row a method and setting of the tone curve.
pub(super) fn visibility(answers: &Answers) -> AnswerTable {
    let row = |one: &Visibility| {
        let numbers = [one.exposure, one.contrast, one.median, one.lower_quartile, one.upper_quartile];
        let mut row = vec![Cell::from(one.method.as_str())];
        row.extend(numbers.map(Cell::Number));
        row.extend([Cell::Integer(one.n as u64), Cell::from(if one.is_visible() { "visible" } else { "hidden" })]);
        row
    };
    let display = [
        DISPLAY_HEADLINE.to_owned(),
        format!("{DISPLAY_HEADLINE}_lower_quartile"),
        format!("{DISPLAY_HEADLINE}_upper_quartile"),
    ];
    let mut columns = ["method", "exposure", "contrast"].map(str::to_owned).to_vec();
    columns.extend(display);
    columns.extend(["cells", "visibility"].map(str::to_owned));
    AnswerTable { name: "exposure_and_contrast", columns, rows: answers.visibility.iter().map(row).collect() }
}

/// One row a method, environment and clip.
pub(super) fn range(answers: &Answers) -> AnswerTable {
    let row = |point: &RangePoint| {
        let mut row = texts(&[point.environment.clone(), point.clip_log2.clone()]);
        row.extend([point.range.into(), Cell::from(point.method.as_str())]);
        row.extend([point.median, point.lower_quartile, point.upper_quartile].map(Cell::Number));
        row.push(Cell::Integer(point.n as u64));
        row
    };
    let quartiles = ["lower_quartile", "upper_quartile"].map(|name| format!("{HEADLINE}_{name}"));
    let mut columns =
        ["environment", "environment_clip_log2", "dynamic_range_stops", "method", HEADLINE].map(str::to_owned).to_vec();
    columns.extend(quartiles);
    columns.push("cells".to_owned());
    AnswerTable { name: "dynamic_range", columns, rows: answers.dynamic_range.iter().map(row).collect() }
}

/// One row a method and series: the factor of its error per stop.
pub(super) fn range_growth(answers: &Answers) -> AnswerTable {
    let row = |growth: Growth| {
        let mut row = texts(&[growth.series.clone(), growth.method.clone()]);
        row.extend([growth.fit.value, growth.fit.lo, growth.fit.hi].map(|x| Cell::Number(x.exp())));
        row.push(Cell::Integer(growth.fit.n as u64));
        row
    };
    let columns = ["series", "method", "factor_per_stop", "factor_lo", "factor_hi", "points"];
    AnswerTable {
        name: "dynamic_range_growth",
        columns: columns.map(str::to_owned).to_vec(),
        rows: growth(&answers.dynamic_range).into_iter().map(row).collect(),
    }
}

/// One row an image of a white furnace: energy that leaves over energy that arrives.
pub(super) fn energy(answers: &Answers) -> AnswerTable {
    let row = |one: &crate::study::answers::furnace::Furnace| {
        let mut row = texts(&one.key);
        row.extend([Cell::from(one.method.as_str()), (1.0 + one.change).into()]);
        row.extend(one.interval.map_or([None; 2], |ends| ends.map(|end| Some(1.0 + end))).map(Cell::from));
        let extremes = one.extremes.map_or([None; 2], |ends| ends.map(Some));
        row.extend(extremes.iter().flat_map(|end| {
            let number = |get: fn(&(f64, [f64; 2])) -> f64| Cell::from(end.as_ref().map(get));
            [number(|e| 1.0 + e.0), number(|e| e.1[0]), number(|e| e.1[1])]
        }));
        row
    };
    let own = [
        "method",
        "albedo",
        "albedo_lo",
        "albedo_hi",
        "least",
        "least_n_dot_v_from",
        "least_n_dot_v_to",
        "most",
        "most_n_dot_v_from",
        "most_n_dot_v_to",
    ];
    AnswerTable { name: "energy", columns: columns(answers, &own), rows: answers.furnace.iter().map(row).collect() }
}

/// One row an image of a white furnace and bin of `n_dot_v`: energy that leaves over energy that arrives.
pub(super) fn energy_by_n_dot_v(answers: &Answers) -> AnswerTable {
    let rows = answers.furnace.iter().flat_map(|one| {
        one.bins.iter().map(|(change, ends)| {
            let mut row = texts(&one.key);
            row.push(Cell::from(one.method.as_str()));
            row.extend([ends[0], ends[1], 1.0 + change].map(Cell::Number));
            row
        })
    });
    let own = ["method", "n_dot_v_from", "n_dot_v_to", "albedo"];
    AnswerTable { name: "energy_by_n_dot_v", columns: columns(answers, &own), rows: rows.collect() }
}
