//! Faults of an experiment, all reported at once, each with its location.

use std::collections::HashSet;
use std::fmt;
use std::hash::{DefaultHasher, Hash, Hasher};
use std::path::Path;

/// Faults printed before the rest are only counted.
pub const FAULTS_SHOWN: usize = 50;
/// Longest printed fault, characters.
const TEXT_LENGTH_MAX: usize = 2000;

#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Fault {
    /// Line and column from 1; (0, 0), which sorts first, for the command line.
    position: (usize, usize),
    location: String,
    /// The key, the value and the expected values.
    text: String,
}

impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        write!(f, "{}: {}", self.location, self.text)
    }
}

/// The faults of one experiment, in the order of the file.
#[derive(Debug, thiserror::Error)]
#[error("{}", self.lines().join("\n"))]
pub struct ConfigError {
    /// At most [`FAULTS_SHOWN`].
    pub faults: Vec<Fault>,
    pub more: usize,
}

impl ConfigError {
    /// Returns a line for each fault, and one that counts the rest.
    pub fn lines(&self) -> Vec<String> {
        let more = (self.more > 0).then(|| format!("and {} more", self.more));
        self.faults
            .iter()
            .map(Fault::to_string)
            .chain(more)
            .collect()
    }
}

#[derive(Clone, Debug, Default, Eq, Hash, PartialEq)]
pub enum Location {
    /// Byte offset in the experiment file.
    File(usize),
    /// `--set` of this axis.
    Set(String),
    #[default]
    Default,
}

impl Location {
    /// Writes the location: `experiments/x.toml:12:9` or `--set alpha`.
    pub fn words(&self, path: &Path, lines: &Lines) -> String {
        match self {
            Self::File(offset) => {
                let (line, column) = lines.line_column(*offset);
                format!("{}:{line}:{column}", path.display())
            }
            Self::Set(axis) => format!("--set {axis}"),
            Self::Default => path.display().to_string(),
        }
    }
}

#[derive(Debug)]
pub struct Lines<'t> {
    text: &'t str,
    /// Byte offsets of line starts, ascending.
    starts: Vec<usize>,
}

impl<'t> Lines<'t> {
    pub fn new(text: &'t str) -> Self {
        let after_breaks = text.match_indices('\n').map(|(offset, _)| offset + 1);
        Self {
            text,
            starts: std::iter::once(0).chain(after_breaks).collect(),
        }
    }

    /// Returns line and column (in characters), both from 1, of a byte offset.
    pub fn line_column(&self, offset: usize) -> (usize, usize) {
        let offset = if self.text.is_char_boundary(offset) {
            offset
        } else {
            self.text.len()
        };
        let line = self.starts.partition_point(|start| *start <= offset);
        (
            line,
            self.text[self.starts[line - 1]..offset].chars().count() + 1,
        )
    }
}

pub struct Faults<'a> {
    path: &'a Path,
    lines: Lines<'a>,
    found: Vec<Fault>,
    /// Hashes of known faults: many combinations have the same one.
    known: HashSet<u64>,
    more: usize,
}

impl<'a> Faults<'a> {
    pub fn new(path: &'a Path, text: &'a str) -> Self {
        Self {
            path,
            lines: Lines::new(text),
            found: Vec::new(),
            known: HashSet::new(),
            more: 0,
        }
    }

    /// Adds a fault unless it is known.
    pub fn add(&mut self, location: &Location, text: impl Into<String>) {
        let mut text = text.into();
        let mut hasher = DefaultHasher::new();
        (location, &text).hash(&mut hasher);
        if !self.known.insert(hasher.finish()) {
            return;
        }
        if self.found.len() == FAULTS_SHOWN {
            self.more += 1;
            return;
        }
        if let Some((end, _)) = text.char_indices().nth(TEXT_LENGTH_MAX) {
            text.truncate(end);
            text.push('…');
        }
        let position = match location {
            Location::File(offset) => self.lines.line_column(*offset),
            Location::Set(_) | Location::Default => (0, 0),
        };
        self.found.push(Fault {
            position,
            location: location.words(self.path, &self.lines),
            text,
        });
    }

    /// Adds a fault whose text is expensive; builds it only if it will be printed.
    pub fn add_with(&mut self, location: &Location, text: impl FnOnce() -> String) {
        if self.found.len() == FAULTS_SHOWN {
            self.more += 1;
        } else {
            self.add(location, text());
        }
    }

    pub fn is_empty(&self) -> bool {
        self.found.is_empty()
    }

    pub fn into_result(mut self) -> Result<(), ConfigError> {
        self.found.sort();
        if self.found.is_empty() {
            Ok(())
        } else {
            Err(ConfigError {
                faults: self.found,
                more: self.more,
            })
        }
    }
}
