//! Tidy CSV tables (RFC 4180, UTF-8, `\n`): one header, one row per case.
//!
//! Numbers have the fewest digits that read back to the same f64; infinities are `inf` and `-inf`,
//! which pandas, R and DuckDB read. A missing value is an empty cell.

use crate::base::files::open_regular;
use crate::base::names::not_one_of;
use crate::base::numbers::shortest;
use std::borrow::Cow;
use std::collections::HashMap;
use std::fs::File;
use std::io::{Read, Seek};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// A cell of a table. Tables have many: texts are shared, and a cell takes no more room than a
/// number and its kind.
#[derive(Clone, Debug, PartialEq)]
pub enum Cell {
    Text(Arc<String>),
    /// A number in words, with its unit or its interval: "12 (95 % 8.1 to 17)".
    Quantity(Arc<String>),
    Named(Arc<NameAndLabel>),
    Number(f64),
    Integer(u64),
    Missing,
}

/// The code name of an entry of a list: the name is for files, the label for readers.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct NameAndLabel {
    pub name: String,
    pub label: String,
}

macro_rules! cell_from {
    ($($value:ident: $source:ty => $cell:expr),+ $(,)?) => {
        $(impl From<$source> for Cell {
            fn from($value: $source) -> Self {
                $cell
            }
        })+
    };
}

cell_from! {
    text: &str => Self::Text(Arc::new(text.to_owned())),
    text: String => Self::Text(Arc::new(text)),
    name: NameAndLabel => Self::Named(Arc::new(name)),
    number: f64 => Self::Number(number),
    number: u32 => Self::Integer(number.into()),
    number: u64 => Self::Integer(number),
    number: usize => Self::Integer(number as u64),
    // 1 or 0.
    is: bool => Self::Integer(is.into()),
}

impl<T: Into<Cell>> From<Option<T>> for Cell {
    fn from(value: Option<T>) -> Self {
        value.map_or(Self::Missing, T::into)
    }
}

impl Cell {
    /// A number in words.
    pub fn quantity(words: impl Into<String>) -> Self {
        Self::Quantity(Arc::new(words.into()))
    }

    /// The text of a file, as far as the cell is one.
    pub fn text(&self) -> Option<&str> {
        match self {
            Self::Text(text) | Self::Quantity(text) => Some(text),
            Self::Named(named) => Some(&named.name),
            Self::Number(_) | Self::Integer(_) | Self::Missing => None,
        }
    }

    fn field(&self) -> Cow<'_, [u8]> {
        match self {
            Self::Number(number) => shortest(*number).into_bytes().into(),
            Self::Integer(integer) => integer.to_string().into_bytes().into(),
            Self::Text(_) | Self::Quantity(_) | Self::Named(_) | Self::Missing => {
                self.text().unwrap_or_default().as_bytes().into()
            }
        }
    }
}

#[derive(Debug, thiserror::Error)]
pub enum TableError {
    #[error("{}: {source}", path.display())]
    File {
        path: PathBuf,
        source: std::io::Error,
    },
    #[error("{}: {}", path.display(), in_words(source))]
    Syntax { path: PathBuf, source: ::csv::Error },
    #[error("{}: row {row}, column {column}: {value:?} is not a number", path.display())]
    Number {
        path: PathBuf,
        row: usize,
        column: String,
        value: String,
    },
    #[error("{}: ends within a row; it is probably truncated", path.display())]
    Torn { path: PathBuf },
    #[error("{}: {what}", path.display())]
    NoColumn { path: PathBuf, what: String },
}

/// Describes a row of a wrong length by its line; other faults as the crate does.
fn in_words(error: &::csv::Error) -> String {
    match error.kind() {
        ::csv::ErrorKind::UnequalLengths {
            pos: Some(position),
            expected_len,
            len,
        } => {
            format!(
                "line {}: the row has {len} cells; expected {expected_len}, as the header",
                position.line()
            )
        }
        _ => error.to_string(),
    }
}

impl TableError {
    fn no_column(path: &Path, column: &str, columns: &[String]) -> Self {
        let columns: Vec<&str> = columns.iter().map(String::as_str).collect();
        Self::NoColumn {
            path: path.to_owned(),
            what: not_one_of("column", column, &columns, ""),
        }
    }
}

pub fn to_text<'r>(columns: &[String], rows: impl IntoIterator<Item = &'r [Cell]>) -> Vec<u8> {
    let mut writer = ::csv::Writer::from_writer(Vec::new());
    writer
        .write_record(columns)
        .expect("memory takes rows of equal length");
    for row in rows {
        writer
            .write_record(row.iter().map(Cell::field))
            .expect("memory takes rows of equal length");
    }
    writer.into_inner().expect("memory can be flushed")
}

/// Writes a table row by row, to save memory.
pub fn write<E: From<TableError>>(
    path: &Path,
    columns: &[String],
    rows: impl IntoIterator<Item = Result<Vec<Cell>, E>>,
) -> Result<(), E> {
    let fault = |source: ::csv::Error| TableError::Syntax {
        path: path.to_owned(),
        source,
    };
    let mut writer = ::csv::Writer::from_path(path).map_err(fault)?;
    writer.write_record(columns).map_err(fault)?;
    for row in rows {
        writer
            .write_record(row?.iter().map(Cell::field))
            .map_err(fault)?;
    }
    Ok(writer.flush().map_err(|source| file_error(path, source))?)
}

#[derive(Clone, Debug, PartialEq)]
pub struct Table {
    path: PathBuf,
    pub columns: Vec<String>,
    pub rows: Vec<Vec<String>>,
}

impl Table {
    /// Reads a whole table; every row must have as many cells as the header, and the last line must
    /// be whole.
    pub fn read(path: &Path) -> Result<Self, TableError> {
        let mut table = TableRows::open(path)?;
        let mut rows = Vec::new();
        table.each(|row| {
            rows.push(row.record.iter().map(str::to_owned).collect());
            Ok(())
        })?;
        Ok(Self {
            path: table.path,
            columns: table.columns,
            rows,
        })
    }

    pub fn column(&self, name: &str) -> Result<usize, TableError> {
        let index = self.columns.iter().position(|column| column == name);
        index.ok_or_else(|| TableError::no_column(&self.path, name, &self.columns))
    }
}

/// A table that is read row by row, to save memory.
#[derive(Debug)]
pub struct TableRows {
    path: PathBuf,
    columns: Vec<String>,
    column_indices: HashMap<String, usize>,
    reader: ::csv::Reader<File>,
}

#[derive(Clone, Copy, Debug)]
pub struct Row<'t> {
    table: &'t TableRows,
    record: &'t ::csv::StringRecord,
    /// From 1.
    number: usize,
}

impl TableRows {
    /// Opens a whole table: the last line must be whole.
    pub fn open(path: &Path) -> Result<Self, TableError> {
        let io = |source| file_error(path, source);
        let mut file = open_regular(path).map_err(io)?;
        if !is_whole(&mut file).map_err(io)? {
            return Err(TableError::Torn {
                path: path.to_owned(),
            });
        }
        file.rewind().map_err(io)?;
        let mut reader = ::csv::Reader::from_reader(file);
        let heads = reader.headers().map_err(|source| TableError::Syntax {
            path: path.to_owned(),
            source,
        })?;
        let columns: Vec<String> = heads.iter().map(str::to_owned).collect();
        let column_indices = columns
            .iter()
            .enumerate()
            .rev()
            .map(|(index, name)| (name.clone(), index))
            .collect();
        Ok(Self {
            path: path.to_owned(),
            columns,
            column_indices,
            reader,
        })
    }

    pub fn path(&self) -> &Path {
        &self.path
    }

    pub fn columns(&self) -> &[String] {
        &self.columns
    }

    /// Fails without this column.
    pub fn needs(&self, name: &str) -> Result<(), TableError> {
        let error = || TableError::no_column(&self.path, name, &self.columns);
        self.column_indices
            .contains_key(name)
            .then_some(())
            .ok_or_else(error)
    }

    /// Calls `visit` with each row; every row must have as many cells as the header.
    pub fn each(
        &mut self,
        mut visit: impl FnMut(Row) -> Result<(), TableError>,
    ) -> Result<(), TableError> {
        let mut record = ::csv::StringRecord::new();
        let mut number = 0;
        while self
            .reader
            .read_record(&mut record)
            .map_err(|source| TableError::Syntax {
                path: self.path.clone(),
                source,
            })?
        {
            number += 1;
            visit(Row {
                table: self,
                record: &record,
                number,
            })?;
        }
        Ok(())
    }
}

impl<'t> Row<'t> {
    /// The field of a column; `None` if it is empty or missing.
    pub fn text(&self, column: &str) -> Option<&'t str> {
        Some(&self.record[*self.table.column_indices.get(column)?]).filter(|text| !text.is_empty())
    }

    pub fn number(&self, column: &str) -> Option<f64> {
        self.text(column)?.parse().ok()
    }

    /// As [`Row::number`]; fails if the field is neither empty nor a number.
    pub fn checked_number(&self, column: &str) -> Result<Option<f64>, TableError> {
        let number = |text: &str| {
            text.parse().map_err(|_| TableError::Number {
                path: self.table.path.clone(),
                row: self.number,
                column: column.to_owned(),
                value: text.to_owned(),
            })
        };
        self.text(column).map(number).transpose()
    }
}

fn is_whole(file: &mut File) -> std::io::Result<bool> {
    let mut buffer = vec![0; 1 << 16];
    let mut is_quoted = false;
    let mut last = b'\n';
    loop {
        let count = file.read(&mut buffer)?;
        let Some(end) = buffer[..count].last() else {
            return Ok(!is_quoted && last == b'\n');
        };
        is_quoted ^= buffer[..count].iter().filter(|byte| **byte == b'"').count() % 2 == 1;
        last = *end;
    }
}

fn file_error(path: &Path, source: std::io::Error) -> TableError {
    TableError::File {
        path: path.to_owned(),
        source,
    }
}

#[cfg(test)]
mod tests;
