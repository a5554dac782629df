//! Reads tables of queries. Every row is checked, and every fault is reported with line and column.

use super::row::{Fault, Row};
use super::{F0_COLUMN, IOR_COLUMN, Kind, KindColumns, Query};
use crate::base::csv::Cell;
use crate::base::files::{TEXT_BYTES_MAX, read_given};
use crate::base::names::{Listed, suggestion};
use crate::instrument::environment::{Environment, LoadOptions};
use std::fmt;
use std::path::{Path, PathBuf};

/// A checked table of queries with its environments.
#[derive(Debug)]
pub struct Queries {
    pub(super) kind: Kind,
    /// As in the file.
    pub(super) columns: Vec<String>,
    /// As in the file.
    pub(super) cells: Vec<Vec<Cell>>,
    pub(super) queries: Vec<Query>,
    pub environments: Vec<Environment>,
}

/// All faults of a table, one per line: `file:line:column: what; what was expected`.
#[derive(Debug)]
pub struct QueryFaults {
    path: PathBuf,
    faults: Vec<Fault>,
}

impl fmt::Display for QueryFaults {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        for (i, Fault { line, column, what }) in self.faults.iter().enumerate() {
            let end_of_last = if i > 0 { "\n" } else { "" };
            let separator = if column.is_empty() { "" } else { ":" };
            // Line 0 is the file as a whole.
            let line = if *line == 0 {
                String::new()
            } else {
                format!(":{line}")
            };
            write!(
                f,
                "{end_of_last}{}{line}{separator}{column}: {what}",
                self.path.display()
            )?;
        }
        Ok(())
    }
}

impl std::error::Error for QueryFaults {}

impl Queries {
    /// Reads a CSV file with a header. Environments are loaded once each; relative paths start at
    /// the file's folder.
    pub fn read(path: &Path, kind: Kind, options: &LoadOptions) -> Result<Self, QueryFaults> {
        let bytes = read_given(path, TEXT_BYTES_MAX).map_err(|error| {
            one_fault(
                path,
                0,
                format!("cannot be read ({error}); expected a CSV file of queries"),
            )
        })?;
        Self::from_bytes(path, &bytes, kind, options)
    }

    /// As [`Queries::read`], from the bytes of the file at `path`.
    pub fn from_bytes(
        path: &Path,
        bytes: &[u8],
        kind: Kind,
        options: &LoadOptions,
    ) -> Result<Self, QueryFaults> {
        let text = std::str::from_utf8(bytes).map_err(|error| {
            let line = 1 + bytes[..error.valid_up_to()]
                .iter()
                .filter(|byte| **byte == b'\n')
                .count() as u64;
            one_fault(path, line, "the line is not UTF-8 text".to_owned())
        })?;
        let text = text.strip_prefix('\u{feff}').unwrap_or(text);
        Reader::new(path, kind, options)
            .read(text)
            .map_err(|faults| QueryFaults {
                path: path.to_owned(),
                faults,
            })
    }

    pub fn len(&self) -> usize {
        self.queries.len()
    }

    /// Whether the table has only a header.
    pub fn is_empty(&self) -> bool {
        self.queries.is_empty()
    }

    /// Lists the warnings of the environments, one sentence each, with the environment's name.
    pub fn warnings(&self) -> impl Iterator<Item = (&str, &str)> {
        self.environments.iter().flat_map(|e| {
            e.warnings
                .iter()
                .map(|warning| (e.name.as_str(), warning.as_str()))
        })
    }
}

/// Makes a fault that concerns a whole line.
fn one_fault(path: &Path, line: u64, what: String) -> QueryFaults {
    QueryFaults {
        path: path.to_owned(),
        faults: vec![Fault {
            line,
            column: String::new(),
            what,
        }],
    }
}

/// An environment under the name that the rows use.
struct NamedEnvironment {
    spec: String,
    first_line: u64,
    row_count: usize,
    loaded: Result<Environment, String>,
}

impl NamedEnvironment {
    /// Returns the fault of its first row, if it cannot be loaded.
    fn fault(&self) -> Option<Fault> {
        let message = self.loaded.as_ref().err()?;
        let rows = if self.row_count > 1 {
            format!(" ({} rows name it)", self.row_count)
        } else {
            String::new()
        };
        Some(Fault {
            line: self.first_line,
            column: "environment".to_owned(),
            what: format!("{message}{rows}"),
        })
    }
}

struct Reader<'a> {
    folder: &'a Path,
    kind: Kind,
    options: &'a LoadOptions,
    columns: Vec<String>,
    environments: Vec<NamedEnvironment>,
    faults: Vec<Fault>,
}

impl<'a> Reader<'a> {
    fn new(path: &'a Path, kind: Kind, options: &'a LoadOptions) -> Self {
        let folder = path.parent().unwrap_or(Path::new(""));
        Self {
            folder,
            kind,
            options,
            columns: Vec::new(),
            environments: Vec::new(),
            faults: Vec::new(),
        }
    }

    fn read(mut self, text: &str) -> Result<Queries, Vec<Fault>> {
        let mut records = ::csv::ReaderBuilder::new()
            .has_headers(false)
            .flexible(true)
            .trim(::csv::Trim::All)
            .from_reader(text.as_bytes());
        let mut record = ::csv::StringRecord::new();
        let mut cells = Vec::new();
        let mut queries = Vec::new();
        let mut is_header = true;
        // Reading UTF-8 from memory with rows of any length cannot fail.
        while records.read_record(&mut record).unwrap_or(false) {
            let line = record
                .position()
                .map_or(0, |position| line_of(text, position.byte()));
            if is_header {
                is_header = false;
                self.header(line, &record);
                if !self.has_meaningful_rows() {
                    break;
                }
            } else if let Some(query) = self.row(line, &record) {
                queries.push(query);
                cells.push(record.iter().map(Cell::from).collect());
            }
        }
        if is_header {
            self.fault(
                1,
                "",
                format!(
                    "the file is empty; expected a header of {}",
                    list(self.kind.columns().required)
                ),
            );
        }
        self.faults
            .extend(self.environments.iter().filter_map(NamedEnvironment::fault));
        if !self.faults.is_empty() {
            self.faults.sort_by_key(|fault| fault.line);
            return Err(self.faults);
        }
        let environments = self
            .environments
            .into_iter()
            .filter_map(|named| named.loaded.ok())
            .collect();
        Ok(Queries {
            kind: self.kind,
            columns: self.columns,
            cells,
            queries,
            environments,
        })
    }

    /// Whether the rows can be checked: a missing or repeated column makes them meaningless; an
    /// unknown one does not hide their faults.
    fn has_meaningful_rows(&self) -> bool {
        let count = |name: &str| self.columns.iter().filter(|column| *column == name).count();
        let in_place = |column: &&str| in_place_of(column).map_or(0, count);
        let required = self.kind.columns().required;
        required
            .iter()
            .all(|column| count(column) + in_place(column) == 1)
            && self.columns.iter().all(|column| count(column) == 1)
    }

    fn fault(&mut self, line: u64, column: &str, what: impl Into<String>) {
        self.faults.push(Fault {
            line,
            column: column.to_owned(),
            what: what.into(),
        });
    }

    fn header(&mut self, line: u64, record: &::csv::StringRecord) {
        let KindColumns {
            required, optional, ..
        } = *self.kind.columns();
        let kind = self.kind.name();
        let known = [required, optional].concat();
        self.columns = record.iter().map(str::to_owned).collect();
        for (i, column) in record.iter().enumerate() {
            if !known.contains(&column) {
                let elsewhere = Kind::all().find(|kind| kind.columns().required.contains(&column));
                let near = suggestion(column, &known);
                let hint = match elsewhere {
                    _ if !near.is_empty() => near,
                    Some(other) => format!("; --kind {} has it", other.name()),
                    None => format!("; expected {}", list(&known)),
                };
                self.fault(
                    line,
                    column,
                    format!("unknown column for --kind {kind}{hint}"),
                );
            } else if record.iter().take(i).any(|earlier| earlier == column) {
                self.fault(line, column, "the column is listed twice");
            }
        }
        let is_there = |column: &str| record.iter().any(|there| there == column);
        for &column in required {
            let other = in_place_of(column).filter(|other| is_there(other));
            if let Some(other) = other.filter(|_| is_there(column)) {
                let what = format!("{other} and {column} are one number; expected one of them");
                self.fault(line, other, what);
            }
            if is_there(column) || other.is_some() {
                continue;
            }
            self.fault(
                line,
                column,
                format!(
                    "the column is missing; --kind {kind} expects {}",
                    list(required)
                ),
            );
        }
    }

    /// Checks one row; `None` if it has a fault.
    fn row(&mut self, line: u64, record: &::csv::StringRecord) -> Option<Query> {
        if record.len() != self.columns.len() {
            let found = record.len();
            let expected = self.columns.len();
            self.fault(
                line,
                "",
                format!("the row has {found} cells; expected {expected}, as the header"),
            );
            return None;
        }
        let columns = self.columns.clone();
        let mut row = Row {
            line,
            columns: &columns,
            record,
            faults: Vec::new(),
        };
        let has_environment = self.kind.columns().required.contains(&"environment");
        let environment = has_environment.then(|| self.environment(&row));
        let integral = row.integral(self.kind);
        let is_valid = row.faults.is_empty();
        self.faults.append(&mut row.faults);
        integral.filter(|_| is_valid).map(|integral| Query {
            environment,
            integral,
        })
    }

    /// Returns the index of the row's environment, loading it on first use.
    fn environment(&mut self, row: &Row) -> usize {
        let spec = row.cell("environment");
        let known = self
            .environments
            .iter()
            .position(|named| named.spec == spec);
        let index = known.unwrap_or_else(|| {
            let loaded = Environment::load(spec, self.folder, self.options)
                .map_err(|error| error.to_string());
            self.environments.push(NamedEnvironment {
                spec: spec.to_owned(),
                first_line: row.line,
                row_count: 0,
                loaded,
            });
            self.environments.len() - 1
        });
        self.environments[index].row_count += 1;
        index
    }
}

/// Names the column that may be in place of a required one.
fn in_place_of(column: &str) -> Option<&'static str> {
    (column == F0_COLUMN).then_some(IOR_COLUMN)
}

/// Returns the line, from 1, of the record that starts at or after byte `start`.
///
/// The reader's own position names the last of a run of blank lines before a record.
fn line_of(text: &str, start: u64) -> u64 {
    let bytes = text.as_bytes();
    let mut end = (start as usize).min(bytes.len());
    while end < bytes.len() && matches!(bytes[end], b'\n' | b'\r') {
        end += 1;
    }
    bytes[..end].iter().filter(|byte| **byte == b'\n').count() as u64 + 1
}

fn list(names: &[&str]) -> String {
    names.join(",")
}
