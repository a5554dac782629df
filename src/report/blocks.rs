//! Fills blocks of Markdown pages from published runs, so that no number is typed by hand.
//!
//! `<!-- csv RUN/FILE.csv COLUMN=CELL ... show=COLUMN,... -->` ... `<!-- /csv -->` holds the rows
//! of a table with these cells, and the columns of `show`, by default all that are neither filtered
//! nor empty. A single cell becomes a number within a sentence. Words with blanks are quoted.
//!
//! Blocks of unpublished runs stay unchanged.

use super::publish::PublishError;
use crate::base::csv;
use crate::base::files::{TEXT_BYTES_MAX, read_text};
use crate::base::pixels::write_atomically;
use crate::draw::markdown::{Align, MarkdownTable, significant};
use std::io::Write;
use std::path::{Path, PathBuf};

const START: &str = "<!-- csv ";
const END: &str = "<!-- /csv -->";
const DIGITS_IN_SENTENCE: usize = 2;
const DIGITS_IN_TABLE: usize = 3;

/// Fills the blocks of `README.md` and `docs/*.md` beside a folder of published runs. Returns the
/// pages with blocks.
pub fn fill_pages(results: &Path) -> Result<Vec<PathBuf>, PublishError> {
    let root = results.parent().unwrap_or(Path::new(""));
    let docs = std::fs::read_dir(root.join("docs"))
        .into_iter()
        .flatten()
        .flatten()
        .map(|entry| entry.path());
    let mut pages: Vec<PathBuf> = docs
        .filter(|path| path.extension().is_some_and(|end| end == "md"))
        .collect();
    pages.sort();
    pages.insert(0, root.join("README.md"));
    let mut filled = Vec::new();
    for page in pages {
        let Ok(old) = read_text(&page, TEXT_BYTES_MAX) else {
            continue;
        };
        let new = fill(&old, results)
            .map_err(|what| PublishError::Misuse(format!("{}: {what}", page.display())))?;
        if new != old {
            write_atomically(&page, |writer| writer.write_all(new.as_bytes()))?;
        }
        if old.contains(END) {
            filled.push(page);
        }
    }
    Ok(filled)
}

/// Fills the blocks of a page from the published runs in `results`. An error names the wrong block.
pub fn fill(page: &str, results: &Path) -> Result<String, String> {
    let mut filled = String::new();
    let mut rest = page;
    while let Some(start) = rest.find(START) {
        let block = &rest[start..];
        let parts = block
            .split_once("-->")
            .and_then(|(head, body)| Some((head, body.split_once(END)?)));
        let (head, (old, after)) = parts
            .ok_or_else(|| format!("the block `{:.60}` has no end {END}", first_line(block)))?;
        let content = content(&words(&head[START.len()..]), results)
            .map_err(|what| format!("the block `{head}-->`: {what}"))?;
        filled += &format!(
            "{}{head}-->{}{END}",
            &rest[..start],
            content.as_deref().unwrap_or(old)
        );
        rest = after;
    }
    Ok(filled + rest)
}

fn first_line(text: &str) -> &str {
    text.lines().next().unwrap_or_default()
}

/// The words of a head; quotes keep blanks.
fn words(head: &str) -> Vec<String> {
    let mut is_quoted = false;
    let splits = |c: char| {
        is_quoted ^= c == '"';
        c.is_whitespace() && !is_quoted
    };
    head.split(splits)
        .filter(|word| !word.is_empty())
        .map(|word| word.replace('"', ""))
        .collect()
}

/// The content of a block from the words of its head; `None` for a run that is not published.
fn content(words: &[String], results: &Path) -> Result<Option<String>, String> {
    let (file, conditions) = words.split_first().ok_or("expected RUN/FILE.csv")?;
    let run = file.split('/').next().unwrap_or_default();
    if !results.join(run).is_dir() {
        return Ok(None);
    }
    let table = csv::Table::read(&results.join(file)).map_err(|error| error.to_string())?;
    let query = Query::new(&table, conditions)?;
    let rows: Vec<&Vec<String>> = table
        .rows
        .iter()
        .filter(|row| query.contains(row))
        .collect();
    if rows.is_empty() {
        return Err(format!("{file} has no such row"));
    }
    let columns = query.columns(&table, &rows);
    if let ([row], [column]) = (&rows[..], &columns[..]) {
        return Ok(Some(cell(&row[*column], DIGITS_IN_SENTENCE)));
    }
    Ok(Some(format!("\n{}", markdown(&table, &rows, &columns))))
}

/// The wanted part of a table.
struct Query<'w> {
    filters: Vec<Filter<'w>>,
    /// The columns of `show`.
    shown: Option<Vec<usize>>,
}

struct Filter<'w> {
    column: usize,
    value: &'w str,
}

impl<'w> Query<'w> {
    fn new(table: &csv::Table, conditions: &'w [String]) -> Result<Self, String> {
        let column = |name: &str| table.column(name).map_err(|error| error.to_string());
        let mut filters = Vec::new();
        let mut shown = None;
        for condition in conditions {
            let (name, value) = condition
                .split_once('=')
                .ok_or_else(|| format!("{condition} is not COLUMN=CELL"))?;
            if name == "show" {
                let columns: Result<Vec<usize>, String> = value.split(',').map(column).collect();
                shown = Some(columns?);
            } else {
                let column = column(name)?;
                filters.push(Filter { column, value });
            }
        }
        Ok(Self { filters, shown })
    }

    fn contains(&self, row: &[String]) -> bool {
        self.filters
            .iter()
            .all(|filter| is_same(&row[filter.column], filter.value))
    }

    /// The columns of `show`, else all that are neither filtered nor empty.
    fn columns(&self, table: &csv::Table, rows: &[&Vec<String>]) -> Vec<usize> {
        if let Some(shown) = &self.shown {
            return shown.clone();
        }
        let is_filtered = |column: usize| self.filters.iter().any(|filter| filter.column == column);
        let is_empty = |column: usize| rows.iter().all(|row| row[column].is_empty());
        (0..table.columns.len())
            .filter(|column| !is_filtered(*column) && !is_empty(*column))
            .collect()
    }
}

fn markdown(table: &csv::Table, rows: &[&Vec<String>], columns: &[usize]) -> MarkdownTable {
    let is_number = |text: &String| text.is_empty() || number(text).is_some();
    let mut heads = Vec::with_capacity(columns.len());
    for &column in columns {
        let has_numbers = rows.iter().all(|row| is_number(&row[column]));
        let align = if has_numbers {
            Align::Right
        } else {
            Align::Left
        };
        heads.push((table.columns[column].as_str(), align));
    }
    let mut markdown = MarkdownTable::new(&heads);
    for row in rows {
        let cells: Vec<String> = columns
            .iter()
            .map(|column| cell(&row[*column], DIGITS_IN_TABLE))
            .collect();
        markdown.row(&cells);
    }
    markdown
}

fn number(text: &str) -> Option<f64> {
    text.parse().ok()
}

/// Whether two texts are equal, or equal numbers.
fn is_same(cell: &str, value: &str) -> bool {
    cell == value
        || number(cell).is_some_and(|number_of_cell| Some(number_of_cell) == number(value))
}

/// Rounds a number to `digits`, unless it is whole.
fn cell(text: &str, digits: usize) -> String {
    let rounded = number(text)
        .filter(|_| text.parse::<i64>().is_err())
        .map(|value| significant(value, digits));
    rounded
        .filter(|rounded| rounded.len() < text.len())
        .unwrap_or_else(|| text.to_owned())
}
