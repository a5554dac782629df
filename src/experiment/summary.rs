//! `summary.md`: what was run, what it answers, what it took.

use super::answers::run_folder::RunFolder;
use super::answers::study::Study;
use super::answers::{AnswerRecord, Answers, markdown};
use super::provenance::EXTENSIONS;
use super::sheets::sheet_files;
use super::statistics::median;
use super::store::StopReason;
use super::tables::REFERENCE_COLUMNS;
use super::timing::{self, TimingRecord, summarize};
use super::timing_ratios::{interval_words, ratios};
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
        ("environment_size", Align::Left),
        ("brdf", Align::Left),
        ("diffuse", Align::Left),
        ("method", Align::Left),
        ("over", Align::Left),
        ("ratio", Align::Right),
        ("95 %", Align::Right),
        ("verdict", Align::Left),
        ("tables paid after, frames (95 %)", Align::Left),
    ]);
    let ratios = ratios(timings);
    for pair in &ratios {
        let method = format!("{} {}", axis(pair.sampled, "method"), axis(pair.sampled, "samples"));
        let interval = interval_words(pair.interval, DIGITS);
        let payback = pair.payback.to_string();
        let (brdf, diffuse, fixed) =
            (axis(pair.sampled, "brdf"), axis(pair.sampled, "diffuse"), axis(pair.fixed, "method"));
        let verdict = format!("{}{}", pair.verdict, if pair.sampled.device_type == "cpu" { " (CPU)" } else { "" });
        let [width, height] = pair.sampled.environment_size;
        pairs.row(&[
            format!("{width}x{height}"),
            brdf,
            diffuse,
            method,
            fixed,
            significant(pair.ratio, DIGITS),
            interval,
            verdict,
            payback,
        ]);
    }
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
