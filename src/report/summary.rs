//! `summary.md`: the question, the answers, the state of the run.

use super::record::{AnswerRecord, DigestCut, Shown};
use super::sheets::sheet_files;
use crate::draw::markdown::{
    Align, MarkdownTable, inline, link, link_label, paragraph, significant,
};
use crate::draw::words::{self, Statement};
use crate::experiment::axis::{AXES, SIZE};
use crate::run::store::{ANSWERS_FOLDER, ReferenceStop, StopReason};
use crate::study::finished::Finished;
use crate::study::frame::{distinct_in_order, estimate::median};
use crate::study::questions::Answer;
use std::collections::BTreeMap;
use std::fmt::Write;
use std::path::PathBuf;

pub const SHEETS_FOLDER: &str = "tables";

pub fn markdown(run: &Finished, answers: &[Answer], record: &AnswerRecord) -> String {
    let mut text = format!("# {}\n\n", inline(&record.name));
    if !record.question.is_empty() {
        let _ = writeln!(text, "{}\n", paragraph(&record.question));
    }
    let headline = headline(answers, record);
    let _ = writeln!(text, "{}\n", inline(&words::markdown([&headline])));
    for answer in answers.iter().skip(1) {
        let _ = writeln!(
            text,
            "- {}",
            paragraph(&answer.finding.sentences.markdown())
        );
    }
    if answers.len() > 1 {
        text.push('\n');
    }
    text += &state(run, record);
    for answer in answers {
        text += &section(answer);
    }
    let sheets = if run.has_pictures() {
        sheet_files(&run.dir)
    } else {
        Vec::new()
    };
    text + &contact_sheets(&sheets) + &failures(run)
}

/// The main answer, emphasised as a whole.
fn headline(answers: &[Answer], record: &AnswerRecord) -> Statement {
    let sentences = answers
        .first()
        .map(|answer| Statement::joined(answer.finding.sentences.all().cloned(), " "));
    sentences
        .unwrap_or_else(|| record.no_answer().into())
        .strong()
}

fn section(answer: &Answer) -> String {
    let name = answer.question.name;
    let mut text = format!("## {}\n\n", answer.question.asks);
    if answer.finding.figure.is_some() {
        let _ = writeln!(
            text,
            "!{}\n",
            link(name, &format!("{ANSWERS_FOLDER}/{name}.svg"))
        );
    }
    let shown = Shown::new(answer);
    let _ = writeln!(text, "{}", shown.table.markdown());
    if let Some(DigestCut {
        shown_count,
        row_count,
        file,
    }) = shown.cut
    {
        let whole = link("all of them", &format!("{ANSWERS_FOLDER}/{file}"));
        let _ = writeln!(
            text,
            "The first {shown_count} of {row_count} rows: {whole}\n"
        );
    }
    let rows = answer.finding.table.rows.len();
    let whole = link("all rows", &format!("{ANSWERS_FOLDER}/{name}.csv"));
    let _ = writeln!(
        text,
        "{rows} {}: {whole}\n",
        if rows == 1 { "row" } else { "rows" }
    );
    text
}

fn state(run: &Finished, record: &AnswerRecord) -> String {
    let sizes =
        distinct_in_order(run.cells.iter().map(|cell| cell.point[SIZE].to_string())).join(", ");
    let planned = run.provenance.cell_count;
    let mut text = format!("{} of {planned} cells done", record.cells);
    if record.failed > 0 {
        let _ = write!(text, ", {} failed", record.failed);
    }
    let _ = writeln!(
        text,
        ". {} {sizes}. {}. Device: {}.\n",
        AXES[SIZE].name,
        reference(run),
        if record.devices.is_empty() {
            "none yet".to_owned()
        } else {
            inline(&record.devices.join("; "))
        }
    );
    if record.devices.len() > 1 {
        text += "**The cells come from several devices or drivers: scores may differ in the last \
                 digits.**\n\n";
    }
    text
}

/// The references in words, without a full stop.
fn reference(run: &Finished) -> String {
    if !run.is_scored() {
        return "No references".to_owned();
    }
    let settings = &run.provenance.reference;
    format!(
        "Reference: `{}`, {} samples per pixel{}",
        inline(&settings.method),
        settings.samples,
        reference_stops(run)
    )
}

/// Where the references stopped, as the end of a sentence.
fn reference_stops(run: &Finished) -> String {
    // Cells of one reference share its file.
    let mut stops: BTreeMap<String, &ReferenceStop> = BTreeMap::new();
    for cell in &run.cells {
        if let Some(stop) = &cell.reference {
            let file = cell
                .images
                .as_ref()
                .and_then(|images| images.reference.clone());
            stops.insert(file.unwrap_or_else(|| format!("{stop:?}")), stop);
        }
    }
    if stops.is_empty() {
        return String::new();
    }
    let errors: Vec<f64> = stops.values().map(|stop| stop.relative_error.0).collect();
    let worst = errors.iter().copied().fold(f64::NAN, f64::max);
    let errors = format!(
        "median {}, largest {}",
        significant(median(&errors), 2),
        significant(worst, 2)
    );
    let stopped = |reason: StopReason| {
        let stopped = stops.values().filter(|stop| stop.stopped_by == reason);
        format!("{} of {}", stopped.count(), stops.len())
    };
    let settings = &run.provenance.reference;
    if let Some(wanted) = settings.relative_error {
        let met = stopped(StopReason::RelativeError);
        return format!(
            " at most; {met} stopped earlier at a relative standard error of {wanted} ({errors})"
        );
    }
    match settings.largest_share() {
        Some(share) => {
            let enough = stopped(StopReason::NoiseShare);
            format!(
                " at most; {enough} stopped earlier with a noise of at most {share} of each mean \
                 square error, which answers take off (relative standard error: {errors})"
            )
        }
        None => format!(" (relative standard error: {errors})"),
    }
}

fn sheet_link(name: &str) -> String {
    link(sheet_title(name), &format!("{SHEETS_FOLDER}/{name}"))
}

fn sheet_title(name: &str) -> &str {
    name.trim_end_matches(".svg")
}

/// The summary for a folder that has the contact sheet `name` beside it and no others; `None` if
/// the summary does not link that sheet.
pub fn with_local_sheet(summary: &str, name: &str) -> Option<String> {
    let link_in_run = sheet_link(name);
    summary.contains(&link_in_run).then(|| {
        summary
            .replace(&link_in_run, &link(sheet_title(name), name))
            .replace(
                &link(SHEETS_FOLDER, SHEETS_FOLDER),
                &link_label(SHEETS_FOLDER),
            )
    })
}

/// The summary for a folder without any contact sheet, which has no paragraph with the link to the
/// sheet `name`.
pub fn without_sheet(summary: &str, name: &str) -> String {
    let link_in_run = sheet_link(name);
    let paragraphs = summary.split("\n\n");
    let kept: Vec<&str> = paragraphs
        .filter(|paragraph| !paragraph.contains(&link_in_run))
        .collect();
    kept.join("\n\n")
}

/// A link to the first contact sheet; empty without one.
fn contact_sheets(files: &[PathBuf]) -> String {
    let first = files
        .first()
        .and_then(|path| Some(sheet_link(path.file_name()?.to_str()?)));
    let Some(first) = first else {
        return String::new();
    };
    let others = match files.len() {
        1 => String::new(),
        n => format!(
            ", the first of {n} in {}",
            link(SHEETS_FOLDER, SHEETS_FOLDER)
        ),
    };
    format!("Contact sheet: {first}{others}.\n\n")
}

fn failures(run: &Finished) -> String {
    if run.failures.is_empty() {
        return String::new();
    }
    let mut table = MarkdownTable::new(&[
        ("cell", Align::Left),
        ("label", Align::Left),
        ("reason", Align::Left),
    ]);
    for record in &run.failures {
        table.row(&[&record.cell.to_string(), &record.label, &record.reason]);
    }
    format!("## Failed cells\n\nRun the experiment again to retry them.\n\n{table}\n")
}
