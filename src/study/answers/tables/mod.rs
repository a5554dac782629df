//! The answers as tidy tables. The CSV files of a run, its report's figures and their specifications read these.

mod break_even;
mod light;
mod parameters;

use super::Answers;
use super::study::Study;
use crate::runner::tables::HEADLINE;
use crate::runner::timing::{TimingRecord, summarize};
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
        break_even::break_even(answers),
        break_even::break_even_by_n_dot_v(answers),
        n_dot_v_and_alpha(answers),
        time_and_error(study),
        parameters::sufficiency(answers),
        light::visibility(answers),
        light::range(answers),
        light::range_growth(answers),
        light::energy(answers),
        parameters::sizes(answers),
        parameters::effects(answers),
        parameters::table_times(answers),
    ];
    all.into_iter().filter(|table| !table.rows.is_empty()).collect()
}

/// What figures draw: also what a run has in a table of its own.
pub fn of_figures(study: &Study, answers: &Answers, timings: &[TimingRecord]) -> Vec<AnswerTable> {
    let more = [n_dot_v_profile(study), pass_times(timings), light::energy_by_n_dot_v(answers)];
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

/// One row a method, sample count, alpha and bin: the median over everything else, with the ends of its 95 % interval over cases.
fn n_dot_v_and_alpha(answers: &Answers) -> AnswerTable {
    let mut rows = Vec::new();
    for table in &answers.heat {
        for (alpha, errors) in table.alphas.iter().zip(&table.errors) {
            for ((lo, hi), error) in table.bins.iter().zip(errors) {
                let samples = table.samples.parse().map_or(Cell::Missing, Cell::Integer);
                let method = Cell::from(table.method.as_str());
                let ends = error.and_then(|error| error.interval).map_or([None; 2], |ends| ends.map(Some));
                let error = error.map(|error| error.median);
                let mut row = vec![method, samples, (*alpha).into(), (*lo).into(), (*hi).into(), error.into()];
                row.extend(ends.map(Cell::from));
                rows.push(row);
            }
        }
    }
    let columns = ["method", "samples", "alpha", "n_dot_v_from", "n_dot_v_to", HEADLINE, "median_lo", "median_hi"];
    let columns = columns.map(str::to_owned).to_vec();
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
