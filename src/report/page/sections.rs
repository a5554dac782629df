//! The sections of the page: one per answer, with the SVG of `answers/`.

use super::model::field;
use super::page_run::{PageRun, link};
use crate::draw::figure::svg::WIDTHS;
use crate::draw::words::spans;
use crate::instrument::shade::words_in;
use crate::report::write::drawing;
use crate::run::store::ANSWERS_FOLDER;
use crate::study::questions::Answer;
use crate::study::table::{Table, shown};
use serde_json::{Value as Json, json};
use std::path::Path;

/// Most rows of a table that is shown if an answer has no digest.
const DIGEST_ROWS: usize = 24;
/// Most columns of a digest that fits next to its figure.
const COLUMNS_BESIDE: usize = 6;

/// The answers of a run as sections for the template; `first` is the index of the first among all
/// runs.
pub fn sections(page_run: &PageRun, run: usize, first: usize, here: &Path) -> Vec<Json> {
    let section = |(i, answer): (usize, &Answer)| {
        let (key, finding) = (answer.question.name, &answer.finding);
        // For a desktop and for a phone.
        let figure = finding
            .figure
            .as_ref()
            .map(|figure| WIDTHS.map(|width| drawing(figure, width).trim_end().to_owned()));
        let small = Some(&finding.table).filter(|table| table.rows.len() <= DIGEST_ROWS);
        let digest = finding.digest.as_ref().or(small).map(digest);
        let is_narrow = digest.as_ref().is_some_and(|digest| {
            digest["columns"]
                .as_array()
                .is_some_and(|all| all.len() <= COLUMNS_BESIDE)
        });
        let sentences = &finding.sentences;
        json!({
            // Numbered from the second run.
            "id": if run == 0 { key.to_owned() } else { format!("{key}-{}", run + 1) },
            "index": first + i,
            "key": key,
            "question": answer.question.asks,
            "sentence": spans(sentences.all()),
            "headline": spans([&sentences.headline]),
            "scope": spans(sentences.after_headline()),
            "row_count": finding.table.rows.len(),
            "csv": link(here, &page_run.finished.dir.join(ANSWERS_FOLDER).join(format!("{key}.csv"))),
            "is_cpu": answer.question.rests_on_cpu_times(page_run.finished),
            "is_split": figure.is_some() && is_narrow,
            "figure": figure,
            "digest": digest,
        })
    };
    page_run.answers.iter().enumerate().map(section).collect()
}

/// The whole tables of the answers, for the scripts.
pub fn model(page_run: &PageRun, run: usize) -> Vec<Json> {
    let entry = |answer: &Answer| {
        let table = &answer.finding.table;
        json!({
            "run": run,
            "name": answer.question.name,
            "columns": table.columns,
            "rows": table.rows.iter().map(|row| row.iter().map(field).collect()).collect::<Vec<Vec<Json>>>(),
        })
    };
    page_run.answers.iter().map(entry).collect()
}

/// A small table in words: heads with their alignment, and rows of texts.
fn digest(table: &Table) -> Json {
    let rows: Vec<Vec<String>> = table
        .rows
        .iter()
        .map(|row| row.iter().map(|cell| words_in(&shown(cell))).collect())
        .collect();
    let starts_with_digit =
        |text: &String| text.starts_with(|c: char| c.is_ascii_digit() || c == '-');
    let is_number =
        |column: usize| column > 0 && rows.iter().any(|row| starts_with_digit(&row[column]));
    let head = |(column, name): (usize, &String)| json!({ "text": words_in(&name.replace('_', " ")), "is_number": is_number(column) });
    json!({ "columns": table.columns.iter().enumerate().map(head).collect::<Vec<Json>>(), "rows": rows })
}
