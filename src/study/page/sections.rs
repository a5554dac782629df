//! Answers as the page shows them: one section each, with the very SVG that stands in `answers/`.

use super::lead::rests_on_cpu_times;
use super::model::{field, roughness};
use super::told::{Told, link};
use crate::runner::value::Value;
use crate::study::figure::svg::{WIDTHS, svg};
use crate::study::figure::vega::vega;
use crate::study::frame::axis;
use crate::study::questions::Answer;
use crate::study::table::{Table, shown};
use crate::table::csv::Cell;
use serde::Serialize;
use serde_json::{Value as Json, json};
use std::path::Path;

/// The folder of a run's answers.
const FOLDER: &str = "answers";
/// A table of at most so many rows stands in the page as it is where an answer has no digest.
const DIGEST_ROWS: usize = 24;
/// A taller figure does not fit the first screen of a laptop, pixels at the desk's width.
const FIRST_SCREEN_HEIGHT: u32 = 640;

/// One answer.
#[derive(Clone, Debug, Serialize)]
pub struct Section {
    /// Anchor of the page: the question's key, numbered from the second run on.
    pub id: String,
    /// Place among the answers of all runs.
    pub index: usize,
    pub key: &'static str,
    pub question: &'static str,
    pub sentence: String,
    /// SVG documents for a desk and for a phone.
    pub figure: Option<[String; 2]>,
    pub digest: Option<Digest>,
    pub row_count: usize,
    /// The CSV file in the folder of the run.
    pub csv: String,
    /// Whether its verdict rests on the times of a CPU driver.
    pub is_cpu: bool,
    /// Whether its figure fits a first screen; else the digest stands there.
    pub figure_first: bool,
}

/// A small table for people.
#[derive(Clone, Debug, Serialize)]
pub struct Digest {
    pub columns: Vec<String>,
    pub rows: Vec<Vec<Field>>,
}

#[derive(Clone, Debug, Serialize)]
pub struct Field {
    pub text: String,
    pub is_number: bool,
}

/// The answers of a run as sections, in order; the first has the number `first` among those of all runs.
pub fn sections(told: &Told, run: usize, first: usize, here: &Path) -> Vec<Section> {
    let section = |(i, answer): (usize, &Answer)| {
        let (key, finding) = (answer.question.name, &answer.finding);
        let figure = finding.figure.as_ref().map(|figure| WIDTHS.map(|width| inline(&svg(figure, width))));
        let digest = finding
            .digest
            .as_ref()
            .or(Some(&finding.table).filter(|table| table.rows.len() <= DIGEST_ROWS))
            .map(digest);
        let fits = figure.as_ref().is_some_and(|[desk, _]| height(desk) <= FIRST_SCREEN_HEIGHT);
        Section {
            id: if run == 0 { key.to_owned() } else { format!("{key}-{}", run + 1) },
            index: first + i,
            key,
            question: answer.question.asks,
            sentence: finding.sentence.clone(),
            row_count: finding.table.rows.len(),
            csv: link(here, &told.finished.dir.join(FOLDER).join(format!("{key}.csv"))),
            is_cpu: rests_on_cpu_times(told, answer),
            figure_first: fits || digest.is_none(),
            figure,
            digest,
        }
    };
    told.answers.iter().enumerate().map(section).collect()
}

/// What the buttons of a section save, and its whole table.
pub fn model(told: &Told, run: usize) -> Vec<Json> {
    let entry = |answer: &Answer| {
        let table = &answer.finding.table;
        json!({
            "run": run,
            "name": answer.question.name,
            "columns": table.columns,
            "rows": table.rows.iter().map(|row| row.iter().map(field).collect()).collect::<Vec<Vec<Json>>>(),
            "vega": answer.finding.figure.as_ref().map(vega),
        })
    };
    told.answers.iter().map(entry).collect()
}

/// An SVG document without what only a file has.
fn inline(document: &str) -> String {
    let start = document.find("<svg").unwrap_or(0);
    document[start..].trim_end().to_owned()
}

/// The height of an SVG document that this program wrote.
fn height(svg: &str) -> u32 {
    let head = svg.split('>').next().unwrap_or_default();
    let value = head.split(" height=\"").nth(1).and_then(|rest| rest.split('"').next());
    value.and_then(|text| text.parse::<f64>().ok()).map_or(0, |height| height.ceil() as u32)
}

fn digest(table: &Table) -> Digest {
    let alpha = axis("alpha");
    let has_roughness = table.columns.iter().any(|name| name == "perceptual_roughness");
    let is_alpha = |column: usize| !has_roughness && table.columns[column] == crate::runner::axis::AXES[alpha].name;
    let field = |(column, cell): (usize, &Cell)| {
        let text = shown(cell);
        let beside =
            text.parse().ok().filter(|_| is_alpha(column)).and_then(|number| roughness(alpha, &Value::Number(number)));
        let is_number = !matches!(cell, Cell::Text(_)) || text.starts_with(|c: char| c.is_ascii_digit() || c == '-');
        Field { text: beside.map_or(text.clone(), |beside| format!("{text} ({beside})")), is_number }
    };
    let name = |(column, name): (usize, &String)| {
        if is_alpha(column) { format!("{name} (perceptual roughness)") } else { name.clone() }
    };
    Digest {
        columns: table.columns.iter().enumerate().map(name).collect(),
        rows: table.rows.iter().map(|row| row.iter().enumerate().map(field).collect()).collect(),
    }
}
