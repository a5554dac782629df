//! The sections of the page: one per answer, with the SVG of `answers/`.

use super::model::field;
use super::told::{Told, link};
use crate::figure::svg::{WIDTHS, svg};
use crate::run::store::ANSWERS_FOLDER;
use crate::study::questions::Answer;
use crate::study::table::{Table, shown};
use serde_json::{Value as Json, json};
use std::path::Path;

/// A table with at most so many rows is shown if an answer has no digest.
const DIGEST_ROWS: usize = 24;
/// Largest figure that fits the first screen of a laptop, pixels.
const FIRST_SCREEN_HEIGHT: u32 = 640;
/// Width of a character and of the padding of a cell of a digest in report.css, pixels.
const CHARACTER: f64 = 7.3;
const CELL_PADDING: f64 = 19.2;
/// Longer texts wrap.
const CHARACTERS_MAX: usize = 36;

/// The answers of a run as sections for the template; `first` is the index of the first among all runs.
pub fn sections(told: &Told, run: usize, first: usize, here: &Path) -> Vec<Json> {
    let section = |(i, answer): (usize, &Answer)| {
        let (key, finding) = (answer.question.name, &answer.finding);
        // For a desktop and for a phone.
        let figure = finding.figure.as_ref().map(|figure| WIDTHS.map(|width| svg(figure, width).trim_end().to_owned()));
        let small = Some(&finding.table).filter(|table| table.rows.len() <= DIGEST_ROWS);
        let digest = finding.digest.as_ref().or(small).map(digest);
        let fits = figure.as_ref().is_some_and(|[desk, _]| height(desk) <= FIRST_SCREEN_HEIGHT);
        json!({
            // Numbered from the second run.
            "id": if run == 0 { key.to_owned() } else { format!("{key}-{}", run + 1) },
            "index": first + i,
            "key": key,
            "question": answer.question.asks,
            "sentence": finding.sentence,
            "row_count": finding.table.rows.len(),
            "csv": link(here, &told.finished.dir.join(ANSWERS_FOLDER).join(format!("{key}.csv"))),
            "is_cpu": answer.question.rests_on_cpu_times(told.finished),
            // Whether the figure comes before the digest.
            "figure_first": fits || digest.is_none(),
            "figure": figure,
            "digest": digest,
        })
    };
    told.answers.iter().enumerate().map(section).collect()
}

/// The whole tables of the answers, for the scripts.
pub fn model(told: &Told, run: usize) -> Vec<Json> {
    let entry = |answer: &Answer| {
        let table = &answer.finding.table;
        json!({
            "run": run,
            "name": answer.question.name,
            "columns": table.columns,
            "rows": table.rows.iter().map(|row| row.iter().map(field).collect()).collect::<Vec<Vec<Json>>>(),
        })
    };
    told.answers.iter().map(entry).collect()
}

/// The height of an SVG document that this program wrote.
fn height(svg: &str) -> u32 {
    let head = svg.split('>').next().unwrap_or_default();
    let value = head.split(" height=\"").nth(1).and_then(|rest| rest.split('"').next());
    value.and_then(|text| text.parse().ok()).unwrap_or(0)
}

/// A small table: heads with their alignment, and rows of texts.
fn digest(table: &Table) -> Json {
    let rows: Vec<Vec<String>> = table.rows.iter().map(|row| row.iter().map(shown).collect()).collect();
    let starts_with_digit = |text: &String| text.starts_with(|c: char| c.is_ascii_digit() || c == '-');
    let head = |(column, name): (usize, &String)| json!({ "text": name.replace('_', " "), "is_number": column > 0 && rows.iter().any(|row| starts_with_digit(&row[column])) });
    // Heads wrap, cells do not.
    let width = |(column, name): (usize, &String)| {
        let words = name.split(['_', ' ']).map(|word| word.chars().count());
        let cells = rows.iter().map(|row| row[column].chars().count().min(CHARACTERS_MAX));
        words.chain(cells).max().unwrap_or(0) as f64 * CHARACTER + CELL_PADDING
    };
    let width: f64 = table.columns.iter().enumerate().map(width).sum();
    json!({ "columns": table.columns.iter().enumerate().map(head).collect::<Vec<Json>>(), "rows": rows, "width": width })
}
