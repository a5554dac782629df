//! `summary.md`: what was run, what it answers, what it took.

use super::answers::run_folder::RunFolder;
use super::answers::study::Study;
use super::answers::{AnswerRecord, Answers, markdown};
use crate::runner::provenance::EXTENSIONS;
use crate::runner::sheets::sheet_files;
use crate::runner::statistics::median;
use crate::runner::store::StopReason;
use crate::runner::tables::{REFERENCE_COLUMNS, ratio_axes};
use crate::runner::timing::{self, Key, TimingRecord, summarize, swept_axes};
use crate::runner::timing_ratios::{Ratio, interval_words, ratios};
use crate::slips;
use crate::table::markdown::{Align, MarkdownTable, inline, link, paragraph, significant};
use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write;

/// Digits of a score in the summary; the CSV has all.
const DIGITS: usize = 3;

/// The text of `summary.md`, from the files of the run alone.
pub fn markdown(run: &RunFolder, study: &Study, answers: &Answers, record: &AnswerRecord) -> String {
    let mut text = format!("# {}\n\n", inline(&record.name));
    if !record.question.is_empty() {
        let _ = writeln!(text, "{}\n", paragraph(&record.question));
    }
    let _ = writeln!(text, "**{}**\n", inline(&record.answer.sentence));
    for fact in &record.answer.facts {
        let _ = writeln!(text, "- {}", paragraph(fact));
    }
    if !record.answer.facts.is_empty() {
        text.push('\n');
    }
    text += &state(run, study, record);
    text += &pictures(record);
    text += &contact_sheets(run);
    text += &markdown::sections(study, answers);
    text += &times_section(run);
    if let Some(table) = run.slips.as_ref().and_then(|table| slips::markdown(table).ok()) {
        text += &format!("## What each slip costs\n\n{}\n{table}\n", slips::HEADING);
    }
    text += &failures_section(run);
    text
}

fn state(run: &RunFolder, study: &Study, record: &AnswerRecord) -> String {
    let sizes: BTreeSet<&str> = study.rows.iter().map(|row| study.value(row, "size")).collect();
    let sizes = sizes.into_iter().collect::<Vec<_>>().join(", ");
    let planned = run.provenance["cell_count"].as_u64().unwrap_or(0);
    let mut text = format!("{} of {planned} cells done", record.cells);
    if record.failed > 0 {
        let _ = write!(text, ", {} failed", record.failed);
    }
    let _ = writeln!(
        text,
        ". Images of {sizes} against `{}` with {} samples a pixel{}. Device: {}.\n",
        inline(&run.text("/reference/method")),
        inline(&run.text("/reference/samples")),
        reference_stops(run),
        if record.devices.is_empty() { "none yet".to_owned() } else { inline(&record.devices.join("; ")) }
    );
    text += &extensions(run);
    if record.devices.len() > 1 {
        text +=
            "**The cells come from more than one device or driver: their scores may differ in the last digits.**\n\n";
    }
    text
}

/// A sentence for each time that the run was made the beginning of a larger one.
fn extensions(run: &RunFolder) -> String {
    let extensions = run.provenance[EXTENSIONS].as_array().into_iter().flatten();
    let sentences = extensions.map(|extension| {
        let text = |pointer: &str| match extension.pointer(pointer) {
            Some(serde_json::Value::String(text)) => inline(text),
            Some(value) => inline(&value.to_string()),
            None => String::new(),
        };
        let timed = match extension["timed_again"].as_u64().unwrap_or(0) {
            0 => String::new(),
            count => format!(", {count} timed configurations timed anew with those they are now compared with"),
        };
        format!(
            "Extended on {} from plan {} (`{}`): {} of its {} cells kept, {} new{timed}.\n\n",
            text("/date_utc"),
            text("/from/plan_hash"),
            text("/from/frozen"),
            text("/cells_kept"),
            text("/from/cell_count"),
            text("/cells_new"),
        )
    });
    sentences.collect()
}

/// Where the references stopped, as the end of a sentence; empty where they do not know.
fn reference_stops(run: &RunFolder) -> String {
    let table = &run.errors;
    let place = |name: &str| table.columns.iter().position(|column| column == name);
    let columns = REFERENCE_COLUMNS.map(place);
    let (Some(cell), [Some(samples), Some(error), Some(stop)]) = (place("cell"), columns) else { return String::new() };
    let mut stops: BTreeMap<String, (f64, &str)> = BTreeMap::new();
    for row in &table.rows {
        let Ok(relative_error) = row[error].parse::<f64>() else { continue };
        // Cells of one reference share its file; where files are not known, references that stopped alike count once.
        let alike = || format!("{} {} {}", row[samples], row[error], row[stop]);
        let id = run.images.get(&row[cell]).map_or_else(alike, |images| images.reference.clone());
        stops.insert(id, (relative_error, &row[stop]));
    }
    let errors: Vec<f64> = stops.values().map(|(error, _)| *error).collect();
    let worst = errors.iter().copied().fold(f64::NAN, f64::max);
    let errors = format!("median {}, largest {}", significant(median(&errors), 2), significant(worst, 2));
    match run.provenance.pointer("/reference/relative_error").and_then(serde_json::Value::as_f64) {
        _ if stops.is_empty() => String::new(),
        None => format!(" (relative standard error: {errors})"),
        Some(wanted) => {
            let met = stops.values().filter(|(_, stop)| *stop == StopReason::RelativeError.name()).count();
            format!(
                " at most; {met} of {} references stopped earlier by a relative standard error of {wanted} ({errors})",
                stops.len()
            )
        }
    }
}

/// The pictures of `answers/`, where a viewer of Markdown shows them.
fn pictures(record: &AnswerRecord) -> String {
    let pictures = record.files.iter().filter(|name| name.ends_with(".svg"));
    let lines: String = pictures
        .map(|name| {
            let about = name.trim_end_matches(".svg").replace('_', " ");
            format!("!{}\n", link(&about, &format!("{}/{name}", super::answers::FOLDER)))
        })
        .collect();
    if lines.is_empty() { lines } else { lines + "\n" }
}

/// The folder of a run's contact sheets.
pub const SHEETS_FOLDER: &str = "tables";

/// A link to a contact sheet of the run, by the name of its file.
pub fn sheet_link(name: &str) -> String {
    link(sheet_title(name), &format!("{SHEETS_FOLDER}/{name}"))
}

/// What a link to a contact sheet says.
pub fn sheet_title(name: &str) -> &str {
    name.trim_end_matches(".png")
}

/// Links to all pages of all contact sheets.
fn contact_sheets(run: &RunFolder) -> String {
    let files = sheet_files(&run.dir);
    let links: Vec<String> = files.iter().filter_map(|path| Some(sheet_link(path.file_name()?.to_str()?))).collect();
    if links.is_empty() { String::new() } else { format!("Contact sheets: {}\n\n", links.join(" · ")) }
}

/// Runnable tasks for each processor above which others were at work too: the run itself keeps each processor busy.
const LOAD_MAX: f64 = 2.0;

/// A warning where all timings were taken on a busy host.
fn busy_host(run: &RunFolder) -> Option<String> {
    let load = |record: &TimingRecord| record.host[0].load_average.as_ref().and_then(|load| load.first().copied());
    let least = run.timings.iter().filter_map(load).min_by(f64::total_cmp)?;
    let processors = run.provenance["sessions"].as_array()?.last()?["host"]["cpu_count"].as_f64()?;
    (processors > 0.0 && least > LOAD_MAX * processors).then(|| {
        format!(
            "**The host was busy: a load of {} or more on {processors} processors. Time again on a quiet one.**\n",
            significant(least, 2)
        )
    })
}

fn times_section(run: &RunFolder) -> String {
    let timings = &run.timings;
    if timings.is_empty() {
        return String::new();
    }
    let mut text = String::from("## Time\n\n");
    let (tables, frames): (Vec<&TimingRecord>, Vec<&TimingRecord>) =
        timings.iter().partition(|record| record.phase == timing::PRECOMPUTE);
    let frames = frames_table(&frames);
    let tables = tables_table(&tables);
    let ratios = ratios(timings);
    let pairs = pairs_table(&ratios);
    let pairs = match ratios.len() {
        0 => String::new(),
        _ => format!("Ratios of frame times, round by round, with the 95 % interval of their median:\n\n{pairs}\n"),
    };
    let rounds = timings[0].wall_ms.len();
    let _ =
        writeln!(text, "Median over {rounds} rounds on {} ({}).", inline(&timings[0].device), timings[0].device_type);
    if timings.iter().any(|record| record.device_type == "cpu") {
        text += "**Measured on a CPU driver: these times say nothing about a GPU.**\n";
    }
    text += &busy_host(run).unwrap_or_default();
    let _ = write!(
        text,
        "\n{frames}\nTables that a method needs, made once per environment or model:\n\n{tables}\n{pairs}"
    );
    text
}

fn value<'k>(key: &'k Key, name: &str) -> &'k str {
    key.get(name).map_or("", String::as_str)
}

fn size_words([width, height]: [u32; 2]) -> String {
    format!("{width}x{height}")
}

/// An empty table whose first columns are `environment_size` and `axes`.
fn table_by(axes: &[&'static str], further: &[(&'static str, Align)]) -> MarkdownTable {
    let mut header = vec![("environment_size", Align::Left)];
    header.extend(axes.iter().map(|name| (*name, Align::Left)));
    header.extend(further);
    MarkdownTable::new(&header)
}

/// `named` axes, then all others that these records sweep.
fn axes_of(records: &[&TimingRecord], named: &[&'static str]) -> Vec<&'static str> {
    let keys: Vec<Key> = records.iter().map(|record| record.key()).collect();
    named.iter().copied().chain(swept_axes(&keys).into_iter().filter(|name| !named.contains(name))).collect()
}

fn frames_table(records: &[&TimingRecord]) -> MarkdownTable {
    let axes = axes_of(records, &["brdf", "method", "samples", "diffuse"]);
    let mut table =
        table_by(&axes, &[("ms a frame", Align::Right), ("MAD", Align::Right), ("check against host", Align::Left)]);
    for record in records {
        let (key, s) = (record.key(), summarize(&record.sums_ms()));
        let mut cells = vec![size_words(record.environment_size)];
        cells.extend(axes.iter().map(|name| value(&key, name).to_owned()));
        cells.extend([significant(s.median, DIGITS), significant(s.mad, 2), record.wall_check().to_owned()]);
        table.row(&cells);
    }
    table
}

fn tables_table(records: &[&TimingRecord]) -> MarkdownTable {
    let axes = axes_of(records, &["brdf", "method", "diffuse"]);
    let mut table = table_by(&axes, &[("pass", Align::Left), ("ms once", Align::Right), ("MAD", Align::Right)]);
    for record in records {
        let key = record.key();
        for pass in &record.passes {
            let s = summarize(&pass.ms);
            let mut cells = vec![size_words(record.environment_size)];
            cells.extend(axes.iter().map(|name| value(&key, name).to_owned()));
            cells.extend([pass.pass.clone(), significant(s.median, DIGITS), significant(s.mad, 2)]);
            table.row(&cells);
        }
    }
    table
}

fn pairs_table(ratios: &[Ratio]) -> MarkdownTable {
    let axes = ratio_axes(ratios, &["brdf", "diffuse"]);
    let mut table = table_by(
        &axes,
        &[
            ("method", Align::Left),
            ("over", Align::Left),
            ("ratio", Align::Right),
            ("95 %", Align::Right),
            ("verdict", Align::Left),
            ("tables paid after, frames (95 %)", Align::Left),
        ],
    );
    for (pair, tables) in ratios.iter().flat_map(|pair| pair.tables.iter().map(move |tables| (pair, tables))) {
        let of_cpu = if pair.sampled.device_type == "cpu" { " (CPU)" } else { "" };
        let mut cells = vec![size_words(pair.sampled.environment_size)];
        cells.extend(axes.iter().map(|name| value(&tables.key, name).to_owned()));
        let way = |key: &Key| format!("{} {}", value(key, "method"), value(key, "samples")).trim_end().to_owned();
        cells.extend([way(&pair.sampled.axes), way(&pair.fixed.axes)]);
        cells.extend([significant(pair.ratio, DIGITS), interval_words(pair.interval, DIGITS)]);
        cells.extend([format!("{}{of_cpu}", pair.verdict), tables.payback.to_string()]);
        table.row(&cells);
    }
    table
}

fn failures_section(run: &RunFolder) -> String {
    if run.failures.is_empty() {
        return String::new();
    }
    let mut table = MarkdownTable::new(&[("cell", Align::Left), ("what", Align::Left), ("why", Align::Left)]);
    for record in &run.failures {
        table.row(&[&record.cell, &record.label, &record.reason]);
    }
    format!("## Failed cells\n\nRunning the experiment again tries them again.\n\n{table}\n")
}
