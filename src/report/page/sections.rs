//! The sections of the page: one per answer, with the SVG of `answers/`.

use super::model::{ScriptRows, ScriptTable};
use super::page_run::{PageRun, link};
use crate::draw::figure::svg::{WIDTHS, svg};
use crate::draw::words::{Span, spans};
use crate::report::record::{DigestCut, Shown};
use crate::run::store::ANSWERS_FOLDER;
use crate::study::questions::Answer;
use crate::study::table::{ColumnKind, Table, labelled};
use minijinja::Value as Markup;
use serde::Serialize;
use std::path::Path;

/// Most rows of a table that is shown if an answer has no digest.
const TABLE_ROWS_MAX: usize = 24;
/// Most rows of a table that the page has whole, to save and to read without the folder of the run.
const WHOLE_ROWS_MAX: usize = 5000;
/// Rows that the page has of a larger table: as many as it shows.
const FIRST_ROWS: usize = 200;
/// Most columns of a digest that has room next to its figure.
const COLUMNS_BESIDE_FIGURE: usize = 6;

/// An answer, for the template.
#[derive(Serialize)]
pub struct Section {
    id: String,
    /// Of the section among the sections of all runs.
    index: usize,
    /// Name of the question.
    key: &'static str,
    question: &'static str,
    /// All sentences.
    sentence: Vec<Span>,
    /// The first sentence.
    headline: Vec<Span>,
    /// The other sentences.
    scope: Vec<Span>,
    row_count: usize,
    /// Whether the page has all rows.
    has_all_rows: bool,
    /// Link to the table.
    csv: String,
    /// Whether the answer depends on times of a CPU driver.
    is_cpu: bool,
    /// Whether the digest is next to the figure.
    is_split: bool,
    /// The SVG for a desktop and for a phone.
    figure: Option<[Markup; 2]>,
    digest: Option<Digest>,
}

/// The answers of a run as sections for the template; `first` is the index of the first among all
/// runs.
pub fn sections(page_run: &PageRun, run: usize, first: usize, link_base: &Path) -> Vec<Section> {
    let sections = page_run.answers.iter().enumerate();
    sections
        .map(|(i, answer)| section(page_run, answer, run, first + i, link_base))
        .collect()
}

fn section(
    page_run: &PageRun,
    answer: &Answer,
    run: usize,
    index: usize,
    link_base: &Path,
) -> Section {
    let key = answer.question.name;
    let finding = &answer.finding;
    let figure = finding.figure.as_ref().map(|figure| {
        WIDTHS.map(|width| Markup::from_safe_string(svg(figure, width).trim_end().to_owned()))
    });
    let row_count = finding.table.rows.len();
    let answers = page_run.finished.dir.join(ANSWERS_FOLDER);
    let digest = (finding.digest.is_some() || row_count <= TABLE_ROWS_MAX).then(|| {
        Digest::new(Shown::new(answer), |file| {
            link(link_base, &answers.join(file))
        })
    });
    let is_narrow = digest
        .as_ref()
        .is_some_and(|digest| digest.columns.len() <= COLUMNS_BESIDE_FIGURE);
    let csv = answers.join(format!("{key}.csv"));
    Section {
        // Numbered from the second run.
        id: if run == 0 {
            key.to_owned()
        } else {
            format!("{key}-{}", run + 1)
        },
        index,
        key,
        question: answer.question.asks,
        sentence: spans(finding.sentences.all()),
        headline: spans([&finding.sentences.headline]),
        scope: spans(finding.sentences.after_headline()),
        row_count,
        has_all_rows: has_all_rows(row_count),
        csv: link(link_base, &csv),
        is_cpu: answer.question.rests_on_cpu_times(page_run.finished),
        is_split: figure.is_some() && is_narrow,
        figure,
        digest,
    }
}

fn has_all_rows(row_count: usize) -> bool {
    row_count <= WHOLE_ROWS_MAX
}

/// The tables of the answers of a run, of large ones the first rows.
pub fn tables<'a>(page_run: &PageRun<'a>, run: usize) -> Vec<ScriptTable<'a>> {
    let table = |answer: &'a Answer| {
        let Table { columns, rows, .. } = &answer.finding.table;
        let has_all_rows = has_all_rows(rows.len());
        ScriptTable {
            columns,
            name: answer.question.name,
            row_count: rows.len(),
            rows: ScriptRows(if has_all_rows {
                rows
            } else {
                &rows[..FIRST_ROWS]
            }),
            run,
        }
    };
    page_run.answers.iter().map(table).collect()
}

/// A small table in words.
#[derive(Serialize)]
struct Digest {
    columns: Vec<DigestColumn>,
    rows: Vec<Vec<String>>,
    /// If there are more rows.
    cut: Option<DigestCut>,
    /// Link to the file with all rows, if there are more.
    whole: Option<String>,
}

#[derive(Serialize)]
struct DigestColumn {
    text: String,
    /// Whether the column is aligned as numbers are.
    is_number: bool,
}

impl Digest {
    /// `link` makes the link to a file of the folder of answers.
    fn new(Shown { table, cut }: Shown, link: impl Fn(&str) -> String) -> Self {
        let column = |index: usize| DigestColumn {
            text: table.label(index),
            // The first column names the rows.
            is_number: index > 0 && table.kind(index) != ColumnKind::Texts,
        };
        let rows = table.rows.iter();
        Self {
            columns: (0..table.columns.len()).map(column).collect(),
            rows: rows.map(|row| row.iter().map(labelled).collect()).collect(),
            whole: cut.as_ref().map(|cut| link(&cut.file)),
            cut,
        }
    }
}
