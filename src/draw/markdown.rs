//! Markdown tables, aligned in the source text for terminals; safe Markdown text; numbers.

use crate::base::names::printable;
pub use crate::base::numbers::significant;
use std::fmt;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Align {
    Left,
    Right,
}

#[derive(Clone, Debug)]
struct Column {
    /// Escaped.
    name: String,
    align: Align,
}

/// A table of texts; its `Display` is Markdown.
#[derive(Clone, Debug)]
pub struct MarkdownTable {
    columns: Vec<Column>,
    /// Escaped.
    rows: Vec<Vec<String>>,
}

impl MarkdownTable {
    pub fn new(columns: &[(&str, Align)]) -> Self {
        Self {
            columns: columns
                .iter()
                .map(|&(name, align)| Column {
                    name: escape(name),
                    align,
                })
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
        let mut row = vec![link.replace('|', "\\|")];
        row.extend(cells.iter().map(|cell| escape(cell.as_ref())));
        self.rows.push(row);
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
    // One backtick begins a name, three a block; two asterisks begin bold words.
    let is_name = line.starts_with('`') && !line.starts_with("``") || line.starts_with("**");
    if is_name {
        return line;
    }
    let digit_count = line.bytes().take_while(u8::is_ascii_digit).count();
    let (digits, rest) = line.split_at(digit_count);
    match rest.chars().next() {
        Some('.' | ')') if digit_count > 0 => format!("{digits}\\{rest}"),
        Some('#' | '>' | '-' | '+' | '*' | '=' | '~' | '`' | '|' | '[' | '_')
            if digit_count == 0 =>
        {
            format!("\\{line}")
        }
        _ => line,
    }
}

/// A link to a file with any name.
pub fn link(label: &str, target: &str) -> String {
    format!("[{}]({})", link_label(label), percent_escaped(target))
}

/// A path in a URL.
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

/// A text in the brackets of a link.
pub fn link_label(label: &str) -> String {
    printable(label)
        .replace('\\', "\\\\")
        .replace('[', "\\[")
        .replace(']', "\\]")
        .replace('<', "\\<")
}

impl MarkdownTable {
    /// Characters of the widest cell of each column.
    fn widths(&self) -> Vec<usize> {
        let mut widths = Vec::with_capacity(self.columns.len());
        for (index, column) in self.columns.iter().enumerate() {
            let mut width = MIN_WIDTH.max(column.name.chars().count());
            for row in &self.rows {
                width = width.max(row[index].chars().count());
            }
            widths.push(width);
        }
        widths
    }

    fn write_row<'c>(
        &self,
        f: &mut fmt::Formatter,
        widths: &[usize],
        cells: impl Iterator<Item = &'c String>,
    ) -> fmt::Result {
        for ((cell, width), column) in cells.zip(widths).zip(&self.columns) {
            match column.align {
                Align::Left => write!(f, "| {cell:<width$} ")?,
                Align::Right => write!(f, "| {cell:>width$} ")?,
            }
        }
        writeln!(f, "|")
    }
}

/// Markdown needs three characters in the rule below the header.
const MIN_WIDTH: usize = 3;

impl fmt::Display for MarkdownTable {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let widths = self.widths();
        self.write_row(f, &widths, self.columns.iter().map(|column| &column.name))?;
        for (width, column) in widths.iter().zip(&self.columns) {
            match column.align {
                Align::Left => write!(f, "|{}", "-".repeat(width + 2))?,
                Align::Right => write!(f, "|{}:", "-".repeat(width + 1))?,
            }
        }
        writeln!(f, "|")?;
        for row in &self.rows {
            self.write_row(f, &widths, row.iter())?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests;
