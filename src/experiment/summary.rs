//! The answer of an experiment as Markdown: break-even, errors, display differences, times.

use super::axis::Axis;
use super::break_even::{BreakEven, break_even, median};
use super::heat;
use super::images::short_text;
use super::plan::{Cell, Plan};
use super::rows;
use super::store::{CellRecord, ReferenceStop, StopReason, Store};
use super::tables::{CellResult, DISPLAY_HEADLINE, HEADLINE, Results};
use super::timing::{self, TimingRecord, summarize};
use super::timing_ratios::ratios;
use crate::shade::METHODS;
use crate::table::markdown::{Align, MarkdownTable, significant};
use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write;

/// Digits of a score in the summary; the CSV has all.
const DIGITS: usize = 3;
/// Stands after a score that the reference's own noise reaches.
const NOISE_MARK: &str = " ~";

/// Finished cells with their records.
type Done<'r> = Vec<(&'r Cell, &'r CellRecord)>;

/// The text of `summary.md`.
pub fn markdown(plan: &Plan, results: &Results, timings: &[TimingRecord], store: &Store) -> String {
    let done: Done = plan
        .cells
        .iter()
        .filter_map(|cell| match results.get(&cell.id) {
            Some(CellResult::Done(record)) => Some((cell, record)),
            _ => None,
        })
        .collect();
    let mut text = format!("# {}\n\n", plan.config.name);
    if !plan.config.question.is_empty() {
        let _ = writeln!(text, "{}\n", plan.config.question);
    }
    text += &state(plan, results, &done);
    let answer = break_even_section(plan, &done);
    if answer.is_empty() {
        text += &errors_section(plan, &done);
    } else {
        text += &answer;
    }
    text += &heat::section(plan, &done, store);
    text += &display_section(plan, &done);
    text += &times_section(timings);
    text += &failures_section(plan, results);
    text
}

fn state(plan: &Plan, results: &Results, done: &Done) -> String {
    let failed = results.values().filter(|result| matches!(result, CellResult::Failed(_))).count();
    let devices: BTreeSet<String> = done.iter().map(|(_, r)| format!("{} ({})", r.device, r.driver)).collect();
    let devices: Vec<String> = devices.into_iter().collect();
    let sizes: BTreeSet<String> = plan.cells.iter().map(|cell| cell.point.get("size").to_string()).collect();
    let sizes = sizes.into_iter().collect::<Vec<_>>().join(", ");
    let reference = &plan.config.reference;
    let stops = reference_stops(plan, done);
    let mut text = format!("{} of {} cells done", done.len(), plan.cells.len());
    if failed > 0 {
        let _ = write!(text, ", {failed} failed");
    }
    let _ = writeln!(
        text,
        ". Images of {sizes} against `{}` with {} samples a pixel{stops}. Device: {}.\n",
        reference.method,
        reference.samples,
        if devices.is_empty() { "none yet".to_owned() } else { devices.join("; ") }
    );
    if devices.len() > 1 {
        text +=
            "**The cells come from more than one device or driver: their scores may differ in the last digits.**\n\n";
    }
    text
}

/// Where the references stopped, as the end of a sentence; empty where they do not know.
fn reference_stops(plan: &Plan, done: &Done) -> String {
    let stops: BTreeMap<&str, &ReferenceStop> =
        done.iter().filter_map(|(cell, record)| Some((cell.reference.as_str(), record.reference.as_ref()?))).collect();
    let errors: Vec<f64> = stops.values().map(|stop| stop.relative_error.0).collect();
    let worst = errors.iter().copied().fold(f64::NAN, f64::max);
    let errors = format!("median {}, largest {}", significant(summarize(&errors).median, 2), significant(worst, 2));
    match plan.config.reference.relative_error {
        _ if stops.is_empty() => String::new(),
        None => format!(" (relative standard error: {errors})"),
        Some(wanted) => {
            let met = stops.values().filter(|stop| stop.stopped_by == StopReason::RelativeError).count();
            format!(
                " at most; {met} of {} references stopped earlier by a relative standard error of {wanted} ({errors})",
                stops.len()
            )
        }
    }
}

/// The axes that tell the rows of an error table apart. Linear metrics do not see the tone curve.
fn row_axes(plan: &Plan) -> Vec<&'static Axis> {
    plan.swept().filter(|a| a.changes_radiance && !["method", "samples"].contains(&a.name)).collect()
}

/// Cells grouped into rows, in plan order.
fn rows<'d, 'r>(axes: &[&Axis], done: &'d Done<'r>) -> Vec<Vec<&'d (&'r Cell, &'r CellRecord)>> {
    rows::rows(done, axes, |(cell, _)| &cell.point)
}

/// What a row has on each of its axes.
fn row_words(axes: &[&Axis], row: &[&(&Cell, &CellRecord)]) -> Vec<String> {
    axes.iter().map(|axis| short_text(axis, rows::teller(row.iter().map(|(cell, _)| &cell.point), axis))).collect()
}

fn method_label(cell: &Cell) -> String {
    format!("{} {}", cell.point.get("method"), cell.point.get("samples")).trim_end().to_owned()
}

fn headline(record: &CellRecord) -> f64 {
    record.scores.get(HEADLINE).map_or(f64::NAN, |score| score.0)
}

fn score_text(record: &CellRecord) -> String {
    let mark = if record.verdict == "resolved" || record.verdict == "no-noise-floor" { "" } else { NOISE_MARK };
    format!("{}{mark}", significant(headline(record), DIGITS))
}

fn noise_note(text: &str) -> &'static str {
    if text.contains(NOISE_MARK) {
        "`~`: within ten times what the reference's own noise would give; more reference samples would change it.\n\n"
    } else {
        ""
    }
}

/// For every method with samples against every one without: the sample count from which the first wins.
fn break_even_section(plan: &Plan, done: &Done) -> String {
    let used: Vec<&str> = METHODS
        .iter()
        .map(|method| method.name)
        .filter(|name| *name != plan.config.reference.method && *name != "none")
        .filter(|name| done.iter().any(|(cell, _)| cell.point.get("method").text() == *name))
        .collect();
    let draws = |name: &str| METHODS.iter().any(|method| method.name == name && method.uses_samples);
    let mut text = String::new();
    for fixed in used.iter().filter(|name| !draws(name)) {
        for sampled in used.iter().filter(|name| draws(name)) {
            text += &break_even_of(plan, done, sampled, fixed);
        }
    }
    text
}

fn break_even_of(plan: &Plan, done: &Done, sampled: &str, fixed: &str) -> String {
    let axes = row_axes(plan);
    let mut counts: Vec<u32> = done
        .iter()
        .filter(|(cell, _)| cell.point.get("method").text() == sampled)
        .map(|(cell, _)| cell.point.get("samples").count())
        .collect();
    counts.sort_unstable();
    counts.dedup();
    let mut header: Vec<(String, Align)> = axes.iter().map(|axis| (axis.name.to_owned(), Align::Left)).collect();
    header.push((fixed.to_owned(), Align::Right));
    header.extend(counts.iter().map(|n| (format!("{sampled} {n}"), Align::Right)));
    header.push(("break-even".to_owned(), Align::Right));
    let header: Vec<(&str, Align)> = header.iter().map(|(name, align)| (name.as_str(), *align)).collect();
    let mut table = MarkdownTable::new(&header);
    // Break-even of each row with the values of its axes other than alpha.
    let mut found: Vec<(Vec<String>, BreakEven)> = Vec::new();
    for row in rows(&axes, done) {
        let of = |name: &str, n: Option<u32>| {
            row.iter().find(|(cell, _)| {
                cell.point.get("method").text() == name && n.is_none_or(|n| cell.point.get("samples").count() == n)
            })
        };
        let Some((_, fixed_record)) = of(fixed, None) else { continue };
        let mut cells = row_words(&axes, &row);
        cells.push(score_text(fixed_record));
        let curve: Vec<(u32, f64)> =
            counts.iter().filter_map(|&n| Some((n, headline(of(sampled, Some(n))?.1)))).collect();
        cells.extend(counts.iter().map(|&n| of(sampled, Some(n)).map_or_else(String::new, |(_, r)| score_text(r))));
        let result = break_even(&curve, headline(fixed_record));
        cells.push(result.to_string());
        table.row(&cells);
        let key: Vec<&Axis> = axes.iter().copied().filter(|axis| axis.name != "alpha").collect();
        found.push((row_words(&key, &row), result));
    }
    let Some(overall) = median(&found.iter().map(|(_, result)| *result).collect::<Vec<_>>()) else {
        return String::new();
    };
    let scope = match found.len() {
        1 => String::new(),
        rows => format!("Median over all {rows} rows: "),
    };
    let mut text = format!(
        "## From how many samples on does `{sampled}` beat `{fixed}`?\n\n{scope}**{overall}** samples a pixel.\n\n"
    );
    if axes.iter().any(|axis| axis.name == "alpha") && axes.len() > 1 {
        text += &format!("Median over alpha:\n\n{}\n", medians_over_alpha(&axes, &found));
    }
    let _ = write!(
        text,
        "{HEADLINE} of each, and the smallest of the tried sample counts from which on `{sampled}` stays below `{fixed}`:\n\n{table}\n"
    );
    text += noise_note(&table.to_string());
    text
}

fn medians_over_alpha(axes: &[&Axis], found: &[(Vec<String>, BreakEven)]) -> MarkdownTable {
    let mut header: Vec<(&str, Align)> =
        axes.iter().filter(|axis| axis.name != "alpha").map(|axis| (axis.name, Align::Left)).collect();
    header.push(("break-even", Align::Right));
    let mut table = MarkdownTable::new(&header);
    let mut seen = BTreeSet::new();
    for (key, _) in found {
        if seen.insert(key) {
            let of_key: Vec<BreakEven> = found.iter().filter(|(k, _)| k == key).map(|(_, result)| *result).collect();
            let middle = median(&of_key).map_or_else(String::new, |m| m.to_string());
            table.row(&key.iter().cloned().chain([middle]).collect::<Vec<_>>());
        }
    }
    table
}

/// The headline error of every method in every row.
fn errors_section(plan: &Plan, done: &Done) -> String {
    let axes = row_axes(plan);
    let mut labels: Vec<String> = Vec::new();
    for (cell, _) in done {
        let label = method_label(cell);
        if !labels.contains(&label) {
            labels.push(label);
        }
    }
    if labels.is_empty() {
        return String::new();
    }
    let mut header: Vec<(&str, Align)> = axes.iter().map(|axis| (axis.name, Align::Left)).collect();
    header.extend(labels.iter().map(|label| (label.as_str(), Align::Right)));
    let mut table = MarkdownTable::new(&header);
    for row in rows(&axes, done) {
        let mut cells = row_words(&axes, &row);
        for label in &labels {
            let entry = row.iter().find(|(cell, _)| method_label(cell) == *label);
            cells.push(entry.map_or_else(String::new, |(_, record)| score_text(record)));
        }
        table.row(&cells);
    }
    let note = noise_note(&table.to_string());
    format!("## Errors\n\n{HEADLINE} by method and sample count:\n\n{table}\n{note}")
}

/// The visible difference by exposure and contrast, where one of them is swept.
fn display_section(plan: &Plan, done: &Done) -> String {
    let axes: Vec<&Axis> = plan.swept().filter(|axis| !axis.changes_radiance).collect();
    if axes.is_empty() || done.is_empty() {
        return String::new();
    }
    let mut labels: Vec<String> = Vec::new();
    for (cell, _) in done {
        let label = method_label(cell);
        if !labels.contains(&label) {
            labels.push(label);
        }
    }
    let mut header: Vec<(&str, Align)> = axes.iter().map(|axis| (axis.name, Align::Right)).collect();
    header.extend(labels.iter().map(|label| (label.as_str(), Align::Right)));
    let mut table = MarkdownTable::new(&header);
    for row in rows(&axes, done) {
        let mut cells = row_words(&axes, &row);
        for label in &labels {
            let of_label = row.iter().filter(|(cell, _)| method_label(cell) == *label);
            let scores: Vec<f64> =
                of_label.filter_map(|(_, record)| record.scores.get(DISPLAY_HEADLINE).map(|score| score.0)).collect();
            cells.push(significant(summarize(&scores).median, DIGITS));
        }
        table.row(&cells);
    }
    format!(
        "## After the tone curve\n\nMedian {DISPLAY_HEADLINE} (0 is equal) over everything else that is swept:\n\n{table}\n"
    )
}

fn times_section(timings: &[TimingRecord]) -> String {
    if timings.is_empty() {
        return String::new();
    }
    let mut text = String::from("## Time\n\n");
    let names = ["environment_size", "brdf", "method", "samples", "diffuse"];
    let mut header: Vec<(&str, Align)> = names.iter().map(|name| (*name, Align::Left)).collect();
    header.extend([("ms a frame", Align::Right), ("MAD", Align::Right), ("check against host", Align::Left)]);
    let mut frames = MarkdownTable::new(&header);
    let mut tables = MarkdownTable::new(&[
        ("environment_size", Align::Left),
        ("brdf", Align::Left),
        ("method", Align::Left),
        ("diffuse", Align::Left),
        ("pass", Align::Left),
        ("ms once", Align::Right),
        ("MAD", Align::Right),
    ]);
    let axis = |record: &TimingRecord, name: &str| record.axes.get(name).cloned().unwrap_or_default();
    for record in timings {
        let [width, height] = record.environment_size;
        let size = format!("{width}x{height}");
        if record.phase == timing::PRECOMPUTE {
            for pass in &record.passes {
                let s = summarize(&pass.ms);
                let numbers = [significant(s.median, DIGITS), significant(s.mad, 2)];
                let configuration = ["brdf", "method", "diffuse"].map(|name| axis(record, name));
                let [brdf, method, diffuse] = &configuration;
                tables.row(&[&size, brdf, method, diffuse, &pass.pass, &numbers[0], &numbers[1]]);
            }
        } else {
            let s = summarize(&record.sums_ms());
            let mut cells = vec![size];
            cells.extend(names[1..].iter().map(|name| axis(record, name)));
            cells.extend([significant(s.median, DIGITS), significant(s.mad, 2), record.wall_check().to_owned()]);
            frames.row(&cells);
        }
    }
    let mut pairs = MarkdownTable::new(&[
        ("brdf", Align::Left),
        ("diffuse", Align::Left),
        ("method", Align::Left),
        ("over", Align::Left),
        ("ratio", Align::Right),
        ("95 %", Align::Right),
        ("verdict", Align::Left),
        ("tables paid after, frames", Align::Right),
    ]);
    let ratios = ratios(timings);
    for pair in &ratios {
        let method = format!("{} {}", axis(pair.sampled, "method"), axis(pair.sampled, "samples"));
        let interval = pair.interval.map(|end| significant(end, DIGITS)).join(" to ");
        let payback = match pair.payback_frames {
            frames if frames.is_nan() => String::new(),
            frames if frames.is_infinite() => "never".to_owned(),
            frames => format!("{frames}"),
        };
        let (brdf, diffuse, fixed) =
            (axis(pair.sampled, "brdf"), axis(pair.sampled, "diffuse"), axis(pair.fixed, "method"));
        let verdict = format!("{}{}", pair.verdict, if pair.sampled.device_type == "cpu" { " (CPU)" } else { "" });
        pairs.row(&[brdf, diffuse, method, fixed, significant(pair.ratio, DIGITS), interval, verdict, payback]);
    }
    let pairs = match ratios.len() {
        0 => String::new(),
        _ => format!("Ratios of frame times, round by round, with the 95 % interval of their median:\n\n{pairs}\n"),
    };
    let rounds = timings[0].wall_ms.len();
    let _ = writeln!(text, "Median over {rounds} rounds on {} ({}).", timings[0].device, timings[0].device_type);
    if timings.iter().any(|record| record.device_type == "cpu") {
        text += "**Measured on a CPU driver: these times say nothing about a GPU.**\n";
    }
    let _ = write!(
        text,
        "\n{frames}\nTables that a method needs, made once per environment or model:\n\n{tables}\n{pairs}"
    );
    text
}

fn failures_section(plan: &Plan, results: &Results) -> String {
    let failed: Vec<_> = plan
        .cells
        .iter()
        .filter_map(|cell| match results.get(&cell.id) {
            Some(CellResult::Failed(record)) => Some(record),
            _ => None,
        })
        .collect();
    if failed.is_empty() {
        return String::new();
    }
    let mut table = MarkdownTable::new(&[("cell", Align::Left), ("what", Align::Left), ("why", Align::Left)]);
    for record in failed {
        table.row(&[&record.cell, &record.label, &record.reason]);
    }
    format!("## Failed cells\n\nRunning the experiment again tries them again.\n\n{table}\n")
}
