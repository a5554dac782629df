//! The answers as tidy tables. The CSV files of a run, its report's figures and their specifications read these.

use super::break_even::BreakEven;
use super::cases::{Crossing, Pair};
use super::effects::Effect;
use super::study::Study;
use super::{Answers, dynamic_range};
use crate::experiment::tables::{DISPLAY_HEADLINE, HEADLINE};
use crate::experiment::timing::{TimingRecord, summarize};
use crate::table::csv::Cell;

/// One table.
#[derive(Clone, Debug, PartialEq)]
pub struct AnswerTable {
    /// Stem of its file.
    pub name: &'static str,
    pub columns: Vec<String>,
    pub rows: Vec<Vec<Cell>>,
}

/// Every table of a run that has rows.
pub fn of_run(study: &Study, answers: &Answers) -> Vec<AnswerTable> {
    let all = [
        convergence(answers),
        slopes(answers),
        break_even(answers),
        break_even_by_n_dot_v(answers),
        n_dot_v_and_alpha(answers),
        time_and_error(study),
        visibility(answers),
        range(answers),
        range_growth(answers),
        effects(answers),
    ];
    all.into_iter().filter(|table| !table.rows.is_empty()).collect()
}

/// What figures draw: also what a run has in a table of its own.
pub fn of_figures(study: &Study, answers: &Answers, timings: &[TimingRecord]) -> Vec<AnswerTable> {
    let more = [n_dot_v_profile(study), pass_times(timings)];
    of_run(study, answers).into_iter().chain(more.into_iter().filter(|table| !table.rows.is_empty())).collect()
}

fn columns(answers: &Answers, own: &[&str]) -> Vec<String> {
    answers.case_axes.iter().cloned().chain(own.iter().map(|name| name.to_string())).collect()
}

fn texts(key: &[String]) -> Vec<Cell> {
    key.iter().map(|value| if value.is_empty() { Cell::Missing } else { Cell::from(value.as_str()) }).collect()
}

fn count(n: u32) -> Cell {
    Cell::Integer(u64::from(n))
}

fn yes(is: bool) -> Cell {
    Cell::from(if is { "yes" } else { "no" })
}

/// One row a curve and sample count; the ends are those of the point sets.
fn convergence(answers: &Answers) -> AnswerTable {
    let rows = answers.curves.iter().flat_map(|curve| {
        curve.points.iter().map(|point| {
            let mut row = texts(&curve.key);
            row.extend([Cell::from(curve.method.as_str()), count(point.samples), point.error.into()]);
            let ends = [f64::min as fn(f64, f64) -> f64, f64::max];
            row.extend(ends.map(|end| point.errors.iter().copied().reduce(end).into()));
            row.extend([count(point.errors.len() as u32), curve.noise_floor.into(), yes(point.is_resolved)]);
            row
        })
    });
    let own = ["method", "samples", HEADLINE, "smallest", "largest", "point_sets", "noise_floor", "is_resolved"];
    AnswerTable { name: "convergence", columns: columns(answers, &own), rows: rows.collect() }
}

/// One row a curve: how fast its error falls above the reference's noise.
fn slopes(answers: &Answers) -> AnswerTable {
    let rows = answers.curves.iter().filter(|curve| curve.points.len() > 1).map(|curve| {
        let mut row = texts(&curve.key);
        row.push(Cell::from(curve.method.as_str()));
        let fit = |get: fn(&super::slope::Slope) -> f64| Cell::from(curve.slope.as_ref().map(get));
        row.extend([fit(|s| s.value), fit(|s| s.lo), fit(|s| s.hi)]);
        let resolved = curve.points.iter().filter(|point| point.is_resolved).count();
        row.extend([count(resolved as u32), count(curve.points.len() as u32)]);
        row
    });
    let own = ["method", "slope", "slope_lo", "slope_hi", "points_used", "points"];
    AnswerTable { name: "convergence_slopes", columns: columns(answers, &own), rows: rows.collect() }
}

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
fn break_even(answers: &Answers) -> AnswerTable {
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
fn break_even_by_n_dot_v(answers: &Answers) -> AnswerTable {
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

/// One row a method, sample count, alpha and bin: the median over everything else.
fn n_dot_v_and_alpha(answers: &Answers) -> AnswerTable {
    let mut rows = Vec::new();
    for table in &answers.heat {
        for (alpha, errors) in table.alphas.iter().zip(&table.errors) {
            for ((lo, hi), error) in table.bins.iter().zip(errors) {
                let samples = table.samples.parse().map_or(Cell::Missing, Cell::Integer);
                let method = Cell::from(table.method.as_str());
                rows.push(vec![method, samples, (*alpha).into(), (*lo).into(), (*hi).into(), (*error).into()]);
            }
        }
    }
    let columns = ["method", "samples", "alpha", "n_dot_v_from", "n_dot_v_to", HEADLINE].map(str::to_owned).to_vec();
    AnswerTable { name: "error_by_n_dot_v_and_alpha", columns, rows }
}

/// One row an image and bin of `n_dot_v`.
fn n_dot_v_profile(study: &Study) -> AnswerTable {
    let axes = study.case_axes();
    let mut rows = Vec::new();
    for row in study.images() {
        for bin in &row.bins {
            let mut cells = texts(&super::curves::key(row, &axes));
            cells.extend(texts(&["method", "samples", "point_set"].map(|name| study.value(row, name).to_owned())));
            cells.extend([bin.lo.into(), bin.hi.into(), Cell::Integer(bin.pixel_count as u64), bin.error.into()]);
            rows.push(cells);
        }
    }
    let own = ["method", "samples", "point_set", "n_dot_v_from", "n_dot_v_to", "pixel_count", HEADLINE];
    let names = axes.iter().map(|&axis| study.axes[axis].name.clone());
    AnswerTable { name: "n_dot_v_profile", columns: names.chain(own.map(str::to_owned)).collect(), rows }
}

/// One row a timed image.
fn time_and_error(study: &Study) -> AnswerTable {
    let axes: Vec<usize> = study.case_axes();
    let names = axes.iter().map(|&axis| study.axes[axis].name.clone());
    let own = ["method", "samples", HEADLINE, "frame_ms_median", "frame_ms_p05", "frame_ms_p95", "is_cpu_time"];
    let rows = study.images().into_iter().filter_map(|row| {
        let (error, time) = (row.error?, row.frame_ms?);
        let mut cells = texts(&super::curves::key(row, &axes));
        cells.extend(texts(&["method", "samples"].map(|name| study.value(row, name).to_owned())));
        cells.extend([error, time.median, time.p05, time.p95].map(Cell::Number));
        cells.push(yes(time.is_cpu));
        Some(cells)
    });
    AnswerTable { name: "time_and_error", columns: names.chain(own.map(str::to_owned)).collect(), rows: rows.collect() }
}

/// One row a method and setting of the tone curve.
fn visibility(answers: &Answers) -> AnswerTable {
    let row = |one: &super::Visibility| {
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
fn range(answers: &Answers) -> AnswerTable {
    let row = |point: &super::RangePoint| {
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
fn range_growth(answers: &Answers) -> AnswerTable {
    let row = |growth: dynamic_range::Growth| {
        let mut row = texts(&[growth.series.clone(), growth.method.clone()]);
        row.extend([growth.fit.value, growth.fit.lo, growth.fit.hi].map(|x| Cell::Number(x.exp())));
        row.push(Cell::Integer(growth.fit.n as u64));
        row
    };
    let columns = ["series", "method", "factor_per_stop", "factor_lo", "factor_hi", "points"];
    AnswerTable {
        name: "dynamic_range_growth",
        columns: columns.map(str::to_owned).to_vec(),
        rows: dynamic_range::growth(&answers.dynamic_range).into_iter().map(row).collect(),
    }
}

/// One row an axis, value, method and alpha; an empty alpha is all of them.
fn effects(answers: &Answers) -> AnswerTable {
    let row = |effect: &Effect| {
        let mut row = texts(&[&effect.axis, &effect.value, &effect.base, &effect.method].map(|text| text.to_owned()));
        row.push(effect.alpha.as_deref().map_or(Cell::Missing, Cell::from));
        row.extend([effect.ratio, effect.interval[0], effect.interval[1]].map(Cell::Number));
        row.extend([effect.n, effect.better].map(|n| Cell::Integer(n as u64)));
        row
    };
    let columns =
        ["axis", "value", "base", "method", "alpha", "error_ratio", "ratio_lo", "ratio_hi", "pairs", "pairs_better"];
    AnswerTable {
        name: "effects",
        columns: columns.map(str::to_owned).to_vec(),
        rows: answers.effects.iter().map(row).collect(),
    }
}

/// One row a timed configuration and pass of one run, in running order.
fn pass_times(records: &[TimingRecord]) -> AnswerTable {
    let axes = ["brdf", "method", "samples", "diffuse"];
    let mut rows = Vec::new();
    for record in records {
        for pass in &record.passes {
            let of_axis = axes.map(|name| record.axes.get(name).cloned().unwrap_or_default());
            let words: Vec<&str> =
                of_axis.iter().map(String::as_str).filter(|w| !w.is_empty() && *w != "none").collect();
            let mut row = vec![Cell::from(record.phase.as_str()), Cell::Text(words.join(" "))];
            row.extend(texts(&of_axis));
            row.extend([Cell::from(pass.pass.as_str()), summarize(&pass.ms).median.into()]);
            row.push(Cell::from(record.device_type.as_str()));
            rows.push(row);
        }
    }
    let mut columns = vec!["phase", "configuration"];
    columns.extend(axes);
    columns.extend(["pass", "median_ms", "device_type"]);
    AnswerTable { name: "pass_times", columns: columns.into_iter().map(str::to_owned).collect(), rows }
}
