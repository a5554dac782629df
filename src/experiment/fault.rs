//! What is wrong with an experiment: every fault with its place, all reported at once.

use std::fmt;
use std::path::Path;

/// One thing that is wrong.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Fault {
    /// Line and column in the file, from 1; (0, 0) for the command line, which sorts first.
    position: (usize, usize),
    /// `experiments/x.toml:12:9` or `--set alpha`.
    place: String,
    /// The key, the value and what was expected.
    text: String,
}

impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        write!(f, "{}: {}", self.place, self.text)
    }
}

/// Every fault of one experiment, in the order of the file.
#[derive(Debug, thiserror::Error)]
#[error("{}", self.listing())]
pub struct ConfigError {
    pub faults: Vec<Fault>,
}

impl ConfigError {
    fn listing(&self) -> String {
        self.faults.iter().map(Fault::to_string).collect::<Vec<_>>().join("\n")
    }
}

/// Where a value was written.
#[derive(Clone, Debug, PartialEq)]
pub enum Place {
    /// Byte offset in the experiment file.
    File(usize),
    /// `--set` with this axis.
    Set(String),
    /// The program's own default.
    Default,
}

impl Place {
    /// The place for people, in the file at `path` with this text: `experiments/x.toml:12:9` or `--set alpha`.
    pub fn words(&self, path: &Path, text: &str) -> String {
        match self {
            Self::File(offset) => {
                let (line, column) = line_column(text, *offset);
                format!("{}:{line}:{column}", path.display())
            }
            Self::Set(axis) => format!("--set {axis}"),
            Self::Default => path.display().to_string(),
        }
    }
}

/// Collects faults of one file.
pub struct Faults<'a> {
    path: &'a Path,
    text: &'a str,
    found: Vec<Fault>,
}

impl<'a> Faults<'a> {
    /// No faults yet of the file at `path` with this text.
    pub fn new(path: &'a Path, text: &'a str) -> Self {
        Self { path, text, found: Vec::new() }
    }

    /// Notes a fault.
    pub fn add(&mut self, place: &Place, text: impl Into<String>) {
        let position = match place {
            Place::File(offset) => line_column(self.text, *offset),
            Place::Set(_) | Place::Default => (0, 0),
        };
        self.found.push(Fault { position, place: place.words(self.path, self.text), text: text.into() });
    }

    /// Whether nothing is wrong so far.
    pub fn is_empty(&self) -> bool {
        self.found.is_empty()
    }

    /// Everything found, in the order of the file and without repeats.
    pub fn into_result(mut self) -> Result<(), ConfigError> {
        self.found.sort();
        self.found.dedup();
        if self.found.is_empty() { Ok(()) } else { Err(ConfigError { faults: self.found }) }
    }
}

/// Line and column (in characters), both from 1, of a byte offset.
pub(super) fn line_column(text: &str, offset: usize) -> (usize, usize) {
    let before = text.get(..offset).unwrap_or(text);
    let line_start = before.rfind('\n').map_or(0, |i| i + 1);
    (before.matches('\n').count() + 1, before[line_start..].chars().count() + 1)
}
