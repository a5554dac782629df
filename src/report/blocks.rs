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
/// Significant digits in a sentence and in a table.
const DIGITS: [usize; 2] = [2, 3];

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
        let content = table(&words(&head[START.len()..]), results);
        let content = content.map_err(|what| format!("the block `{head}-->`: {what}"))?;
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

fn table(words: &[String], results: &Path) -> Result<Option<String>, String> {
    let (file, conditions) = words.split_first().ok_or("expected RUN/FILE.csv")?;
    let run = file.split('/').next().unwrap_or_default();
    if !results.join(run).is_dir() {
        return Ok(None);
    }
    let table = csv::Table::read(&results.join(file)).map_err(|error| error.to_string())?;
    let column = |name: &str| table.column(name).map_err(|error| error.to_string());
    let mut filters: Vec<(usize, &str)> = Vec::new();
    let mut shown: Option<Vec<usize>> = None;
    for condition in conditions {
        let (name, value) = condition
            .split_once('=')
            .ok_or_else(|| format!("{condition} is not COLUMN=CELL"))?;
        match name {
            "show" => shown = Some(value.split(',').map(column).collect::<Result<_, _>>()?),
            _ => filters.push((column(name)?, value)),
        }
    }
    let is_wanted = |row: &&Vec<String>| {
        filters
            .iter()
            .all(|(column, value)| is_same(&row[*column], value))
    };
    let rows: Vec<&Vec<String>> = table.rows.iter().filter(is_wanted).collect();
    if rows.is_empty() {
        return Err(format!("{file} has no such row"));
    }
    let shown = shown.unwrap_or_else(|| {
        let is_filtered = |column: usize| filters.iter().any(|filter| filter.0 == column);
        let is_empty = |column: usize| rows.iter().all(|row| row[column].is_empty());
        (0..table.columns.len())
            .filter(|column| !is_filtered(*column) && !is_empty(*column))
            .collect()
    });
    if let ([row], [column]) = (&rows[..], &shown[..]) {
        return Ok(Some(cell(&row[*column], DIGITS[0])));
    }
    let align = |column: &usize| match rows
        .iter()
        .all(|row| row[*column].is_empty() || number(&row[*column]).is_some())
    {
        true => Align::Right,
        false => Align::Left,
    };
    let heads: Vec<(&str, Align)> = shown
        .iter()
        .map(|column| (table.columns[*column].as_str(), align(column)))
        .collect();
    let mut markdown = MarkdownTable::new(&heads);
    for row in rows {
        markdown.row(
            &shown
                .iter()
                .map(|column| cell(&row[*column], DIGITS[1]))
                .collect::<Vec<_>>(),
        );
    }
    Ok(Some(format!("\n{markdown}")))
}

fn number(text: &str) -> Option<f64> {
    text.parse().ok()
}

/// Whether two texts are equal, or equal numbers.
fn is_same(cell: &str, value: &str) -> bool {
    cell == value || number(cell).is_some_and(|own| Some(own) == number(value))
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
