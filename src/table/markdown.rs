//! Small tables for a terminal and for Markdown alike: the columns are aligned in the source text.

use crate::spelling::printable;
use std::fmt::{self, Write};

/// Side on which the cells of a column line up.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Align {
    Left,
    Right,
}

/// A table of texts; its `Display` is Markdown.
#[derive(Clone, Debug)]
pub struct MarkdownTable {
    columns: Vec<(String, Align)>,
    rows: Vec<Vec<String>>,
}

impl MarkdownTable {
    pub fn new(columns: &[(&str, Align)]) -> Self {
        Self { columns: columns.iter().map(|&(name, align)| (escape(name), align)).collect(), rows: Vec::new() }
    }

    /// As [`MarkdownTable::row`], with a [`link`] before the cells.
    pub fn row_with_link<T: AsRef<str>>(&mut self, link: &str, cells: &[T]) {
        assert_eq!(cells.len() + 1, self.columns.len(), "cells of a Markdown row");
        let rest = cells.iter().map(|cell| escape(cell.as_ref()));
        self.rows.push(std::iter::once(link.replace('|', "\\|")).chain(rest).collect());
    }

    /// Appends a row. Panics when the number of cells is not that of the columns.
    pub fn row<T: AsRef<str>>(&mut self, cells: &[T]) {
        assert_eq!(cells.len(), self.columns.len(), "cells of a Markdown row");
        self.rows.push(cells.iter().map(|cell| escape(cell.as_ref())).collect());
    }
}

/// A cell is one line and holds no bare column separator.
fn escape(cell: &str) -> String {
    inline(cell).replace('|', "\\|")
}

/// A text of anyone's making within a line of Markdown: one line, in which no tag, no link and no image begins, and nothing that a terminal
/// obeys. What is only written strangely, such as a name with `_`, stays as it is: people read the source, too.
pub fn inline(text: &str) -> String {
    let line = text.replace("\r\n", " ").replace(['\n', '\r', '\t'], " ");
    let mut safe = String::with_capacity(line.len());
    let mut characters = line.chars().peekable();
    while let Some(c) = characters.next() {
        let next = characters.peek().copied();
        // A `<` before a blank or digit is a comparison.
        let is_tag = c == '<' && next.is_some_and(|next| next.is_ascii_alphabetic() || "/!?".contains(next));
        let is_link = c == ']' && next.is_some_and(|next| "([".contains(next));
        // One that is there already would take the effect of the one that is put before what follows.
        let is_escape = c == '\\' && next.is_some_and(|next| "\\<]".contains(next));
        if is_tag || is_link || is_escape {
            safe.push('\\');
        }
        safe.push(c);
    }
    printable(&safe)
}

/// As [`inline`], of a text that is a paragraph of its own: it begins no heading, list, quotation, table, rule or block of code.
pub fn paragraph(text: &str) -> String {
    let line = inline(text.trim());
    let digits = line.len() - line.trim_start_matches(|c: char| c.is_ascii_digit()).len();
    // One backtick begins a name; three begin a block.
    let is_name = line.starts_with('`') && !line.starts_with("``");
    match line[digits..].chars().next().filter(|_| !is_name) {
        Some('.' | ')') if digits > 0 => format!("{}\\{}", &line[..digits], &line[digits..]),
        Some('#' | '>' | '-' | '+' | '*' | '=' | '~' | '`' | '|' | '[' | '_') if digits == 0 => format!("\\{line}"),
        _ => line,
    }
}

/// A link to a file beside the text, whatever its name holds.
pub fn link(label: &str, target: &str) -> String {
    let mut path = String::new();
    for byte in target.bytes() {
        match byte {
            b'/' | b'-' | b'_' | b'.' | b'~' => path.push(byte.into()),
            byte if byte.is_ascii_alphanumeric() => path.push(byte.into()),
            byte => {
                let _ = write!(path, "%{byte:02X}");
            }
        }
    }
    format!("[{}]({path})", link_label(label))
}

/// The label of a [`link`].
pub fn link_label(label: &str) -> String {
    printable(label).replace('\\', "\\\\").replace('[', "\\[").replace(']', "\\]").replace('<', "\\<")
}

impl fmt::Display for MarkdownTable {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let length = |text: &str| text.chars().count();
        let widths: Vec<usize> = (0..self.columns.len())
            .map(|c| {
                let cells = self.rows.iter().map(|row| length(&row[c]));
                // Markdown needs three characters in the rule below the header.
                cells.chain([length(&self.columns[c].0), 3]).max().unwrap_or(3)
            })
            .collect();
        let line = |f: &mut fmt::Formatter, cells: &mut dyn Iterator<Item = &str>| -> fmt::Result {
            for ((cell, width), (_, align)) in cells.zip(&widths).zip(&self.columns) {
                match align {
                    Align::Left => write!(f, "| {cell:<width$} ")?,
                    Align::Right => write!(f, "| {cell:>width$} ")?,
                }
            }
            writeln!(f, "|")
        };
        line(f, &mut self.columns.iter().map(|column| column.0.as_str()))?;
        for (width, (_, align)) in widths.iter().zip(&self.columns) {
            match align {
                Align::Left => write!(f, "|{}", "-".repeat(width + 2))?,
                Align::Right => write!(f, "|{}:", "-".repeat(width + 1))?,
            }
        }
        writeln!(f, "|")?;
        self.rows.iter().try_for_each(|row| line(f, &mut row.iter().map(String::as_str)))
    }
}

/// Decimal exponents that are written out; outside, the number gets an exponent.
const FIXED_EXPONENTS: std::ops::Range<i32> = -4..6;

/// A number for reading, rounded to `digits` significant digits (at least 1): `0.0123`, `1.50`, `1234`, `1.23e-7`, `inf`.
/// Digits before the decimal point are never replaced by zeros.
pub fn significant(number: f64, digits: usize) -> String {
    if number == 0.0 {
        return "0".to_owned();
    }
    if !number.is_finite() {
        return number.to_string();
    }
    let decimals = digits.max(1) - 1;
    // Rounded first: 0.9996 to three digits is 1.00, with the exponent of 1.
    let scientific = format!("{number:.decimals$e}");
    let exponent: i32 = scientific
        .split_once('e')
        .and_then(|(_, exponent)| exponent.parse().ok())
        .expect("the exponent format of a finite number ends in e and an integer");
    if FIXED_EXPONENTS.contains(&exponent) {
        let decimals = (decimals as i32 - exponent).max(0) as usize;
        format!("{number:.decimals$}")
    } else {
        scientific
    }
}
