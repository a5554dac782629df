//! Markdown tables, aligned in the source text for terminals; safe Markdown text; numbers.

use crate::base::names::printable;
pub use crate::base::numbers::significant;
use std::fmt;

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
        Self {
            columns: columns
                .iter()
                .map(|&(name, align)| (escape(name), align))
                .collect(),
            rows: Vec::new(),
        }
    }

    /// Appends a row that begins with a [`link`].
    pub fn row_with_link<T: AsRef<str>>(&mut self, link: &str, cells: &[T]) {
        assert_eq!(
            cells.len() + 1,
            self.columns.len(),
            "cells of a Markdown row"
        );
        let rest = cells.iter().map(|cell| escape(cell.as_ref()));
        self.rows.push(
            std::iter::once(link.replace('|', "\\|"))
                .chain(rest)
                .collect(),
        );
    }

    /// Appends a row with one cell per column.
    pub fn row<T: AsRef<str>>(&mut self, cells: &[T]) {
        assert_eq!(cells.len(), self.columns.len(), "cells of a Markdown row");
        self.rows
            .push(cells.iter().map(|cell| escape(cell.as_ref())).collect());
    }
}

fn escape(cell: &str) -> String {
    inline(cell).replace('|', "\\|")
}

/// Makes any text safe within a line of Markdown: one line without tags, links, images and terminal
/// controls. Harmless characters such as `_` stay, for readers of the source.
pub fn inline(text: &str) -> String {
    let line = text.replace("\r\n", " ").replace(['\n', '\r', '\t'], " ");
    let mut safe = String::with_capacity(line.len());
    let mut characters = line.chars().peekable();
    while let Some(c) = characters.next() {
        let next = characters.peek().copied();
        // A `<` before a blank or digit is a comparison.
        let is_tag =
            c == '<' && next.is_some_and(|next| next.is_ascii_alphabetic() || "/!?".contains(next));
        let is_link = c == ']' && next.is_some_and(|next| "([".contains(next));
        // An existing backslash would cancel the one before the next character.
        let is_escape = c == '\\' && next.is_some_and(|next| "\\<]".contains(next));
        if is_tag || is_link || is_escape {
            safe.push('\\');
        }
        safe.push(c);
    }
    printable(&safe)
}

/// As [`inline`], for a paragraph: it begins no heading, list, quotation, table, rule or code
/// block.
pub fn paragraph(text: &str) -> String {
    let line = inline(text.trim());
    let digits = line.len() - line.trim_start_matches(|c: char| c.is_ascii_digit()).len();
    // One backtick begins a name, three a block; two asterisks begin bold words.
    let is_name = line.starts_with('`') && !line.starts_with("``") || line.starts_with("**");
    match line[digits..].chars().next().filter(|_| !is_name) {
        Some('.' | ')') if digits > 0 => format!("{}\\{}", &line[..digits], &line[digits..]),
        Some('#' | '>' | '-' | '+' | '*' | '=' | '~' | '`' | '|' | '[' | '_') if digits == 0 => {
            format!("\\{line}")
        }
        _ => line,
    }
}

/// A link to a file with any name.
pub fn link(label: &str, target: &str) -> String {
    format!("[{}]({})", link_label(label), percent_escaped(target))
}

pub fn percent_escaped(path: &str) -> String {
    let is_plain = |byte: u8| byte.is_ascii_alphanumeric() || b"/-_.~".contains(&byte);
    path.bytes()
        .map(|byte| {
            if is_plain(byte) {
                char::from(byte).to_string()
            } else {
                format!("%{byte:02X}")
            }
        })
        .collect()
}

pub fn link_label(label: &str) -> String {
    printable(label)
        .replace('\\', "\\\\")
        .replace('[', "\\[")
        .replace(']', "\\]")
        .replace('<', "\\<")
}

impl fmt::Display for MarkdownTable {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let length = |text: &str| text.chars().count();
        let widths: Vec<usize> = (0..self.columns.len())
            .map(|c| {
                let cells = self.rows.iter().map(|row| length(&row[c]));
                // Markdown needs three characters in the rule below the header.
                cells
                    .chain([length(&self.columns[c].0), 3])
                    .max()
                    .unwrap_or(3)
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
        self.rows
            .iter()
            .try_for_each(|row| line(f, &mut row.iter().map(String::as_str)))
    }
}
