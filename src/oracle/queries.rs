//! Reads tables of queries. Every row is checked, and every fault is reported with line and column.

use super::row::{Fault, Row};
use super::{Integral, Kind, KindColumns, Query};
use crate::base::csv::Cell;
use crate::base::files::{TEXT_BYTES_MAX, read_given};
use crate::base::math::frame::east;
use crate::base::names::Listed;
use crate::base::names::suggestion;
use crate::instrument::brdf::Stretch;
use crate::instrument::environment::{Environment, LoadOptions};
use crate::instrument::precompute::prefilter::Kernel;
use crate::instrument::shade::reference::Surface;
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
struct Named {
    spec: String,
    first_line: u64,
    row_count: usize,
    loaded: Result<Environment, String>,
}

struct Reader<'a> {
    folder: &'a Path,
    kind: Kind,
    options: &'a LoadOptions,
    columns: Vec<String>,
    environments: Vec<Named>,
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
                // A missing or repeated column makes rows meaningless; an unknown one does not hide
                // their faults.
                let count =
                    |column: &str| self.columns.iter().filter(|there| *there == column).count();
                let has_all = self
                    .kind
                    .columns()
                    .required
                    .iter()
                    .all(|column| count(column) == 1);
                if !has_all || self.columns.iter().any(|column| count(column) > 1) {
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
        for named in &self.environments {
            if let Err(message) = &named.loaded {
                let rows = if named.row_count > 1 {
                    format!(" ({} rows name it)", named.row_count)
                } else {
                    String::new()
                };
                let what = format!("{message}{rows}");
                self.faults.push(Fault {
                    line: named.first_line,
                    column: "environment".to_owned(),
                    what,
                });
            }
        }
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
        for column in required
            .iter()
            .filter(|column| !record.iter().any(|there| there == **column))
        {
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
        // All cells are checked before any is used, so that a row reports all its faults.
        let integral = match self.kind {
            Kind::Shading | Kind::Ladder => {
                let model = row.model();
                let masking = row.masking();
                let alpha = row.alpha("alpha");
                let levels = row.levels();
                let coat = row.coat();
                let sheen = row.sheen();
                let anisotropy = row.anisotropy();
                let f0 = row.f0();
                let n = row.direction(["nx", "ny", "nz"]);
                let v = row.direction(["vx", "vy", "vz"]);
                if let (Some(n), Some(v)) = (n, v)
                    && n.dot(v) <= 0.0
                {
                    row.fault(
                        "vx,vy,vz",
                        format!(
                            "v is not above the horizon: n·v is {}; expected above 0",
                            n.dot(v)
                        ),
                    );
                }
                (|| {
                    let model = model?;
                    let masking = masking?;
                    let alpha = alpha?;
                    let surface = Surface::new(model, masking, alpha, f0?, [n?, v?]);
                    let surface = anisotropy?.map_or(surface, |(strength, turn, law)| {
                        let widths = law.widths(alpha, strength);
                        surface.stretched(Stretch {
                            widths,
                            tangent: east(surface.n, turn),
                        })
                    });
                    Some(match self.kind {
                        Kind::Ladder => Integral::Ladder {
                            surface,
                            levels: levels?,
                        },
                        _ => Integral::Shading {
                            surface,
                            coat: coat?,
                            sheen: sheen?,
                        },
                    })
                })()
            }
            Kind::Dfg => {
                let model = row.model();
                let masking = row.masking();
                let alpha = row.alpha("alpha");
                let n_dot_v = row.above_zero_to_one("n_dot_v");
                (|| {
                    Some(Integral::Dfg {
                        model: model?,
                        masking: masking?,
                        alpha: alpha?,
                        n_dot_v: n_dot_v?,
                    })
                })()
            }
            Kind::Prefilter => {
                let model = row.model();
                let alpha = row.alpha("alpha");
                let r = row.direction(["rx", "ry", "rz"]);
                let weight = row.weight();
                let masking = row.masking();
                (|| {
                    let kernel = Kernel::new(model?, weight?, masking?);
                    Some(Integral::Prefilter {
                        kernel,
                        alpha: alpha?,
                        r: r?,
                    })
                })()
            }
            Kind::Irradiance => row
                .direction(["nx", "ny", "nz"])
                .map(|n| Integral::Irradiance { n }),
            Kind::Sh9 => Some(Integral::Sh9),
        };
        let is_right = row.faults.is_empty();
        self.faults.append(&mut row.faults);
        integral.filter(|_| is_right).map(|integral| Query {
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
            self.environments.push(Named {
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
