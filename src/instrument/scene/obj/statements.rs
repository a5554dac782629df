//! The statements of OBJ and MTL files, checked and in the form that the crate `tobj` reads.
//!
//! `tobj` accepts NaN, panics for a colour of two numbers, finds wrong indices only after the last
//! face of a material, takes polylines for faces, and does not join continued lines.

use crate::instrument::scene::SceneError;
use std::collections::BTreeMap;
use std::path::Path;
use tobj::LoadError;

/// Longest part of a statement in a message.
const SHOWN_LENGTH: usize = 60;

#[derive(Debug, Default)]
pub struct Statements {
    /// One statement in the line where it begins.
    text: String,
    /// Number of skipped statements of each keyword.
    pub skipped: BTreeMap<String, usize>,
}

impl Statements {
    pub fn new(bytes: &[u8]) -> Self {
        // Only comments and names contain other text; Latin-1 there must not stop the geometry.
        let text = String::from_utf8_lossy(bytes);
        let mut lines = text.trim_start_matches('\u{feff}').lines().map(str::trim);
        let mut found = Self::default();
        while let Some(line) = lines.next() {
            let mut statement = line.to_owned();
            let mut ends = "\n".to_owned();
            // A comment that ends in a backslash (a Windows folder, say) does not continue.
            while !line.starts_with('#') && statement.ends_with('\\') {
                statement.pop();
                statement.push(' ');
                statement.push_str(lines.next().unwrap_or_default());
                ends.push('\n');
            }
            found.add(&statement);
            found.text.push_str(&ends);
        }
        found
    }

    fn add(&mut self, statement: &str) {
        let (keyword, rest) = split_keyword(statement);
        let number_count = match keyword {
            // Names and smoothing groups have no effect: missing normals are smooth everywhere.
            "" | "o" | "g" | "s" => return,
            _ if keyword.starts_with('#') => return,
            // Names may contain a number sign, numbers may not.
            "mtllib" | "usemtl" | "newmtl" | "map_Kd" => {
                self.text.extend([keyword, " ", rest]);
                return;
            }
            // Weights and colours follow.
            "v" => 3,
            "vt" | "vn" | "f" | "Kd" | "Ns" | "Ni" | "Pr" | "Pm" => usize::MAX,
            other => {
                *self
                    .skipped
                    .entry(other.chars().take(SHOWN_LENGTH).collect())
                    .or_default() += 1;
                return;
            }
        };
        self.text.push_str(keyword);
        let numbers = rest.split('#').next().unwrap_or_default();
        numbers
            .split_whitespace()
            .take(number_count)
            .for_each(|number| self.text.extend([" ", number]));
    }

    /// Returns the values of each statement with this keyword.
    pub fn values<'a>(&'a self, keyword: &'a str) -> impl Iterator<Item = &'a str> {
        self.text
            .lines()
            .map(split_keyword)
            .filter(move |(found, _)| *found == keyword)
            .map(|(_, values)| values)
    }

    /// Applies `check` to keyword and values of each statement; the message names the first wrong
    /// line.
    pub fn check(
        &self,
        path: &Path,
        mut check: impl FnMut(&str, &str) -> Result<(), String>,
    ) -> Result<(), SceneError> {
        self.text.lines().enumerate().try_for_each(|(i, line)| {
            let (keyword, values) = split_keyword(line);
            check(keyword, values).map_err(|message| {
                SceneError::of_line(path, i + 1, format!("{keyword}: {message}"))
            })
        })
    }

    /// Passes the text to a function of `tobj`, which stops behind a wrong line.
    pub fn read<T>(
        &self,
        path: &Path,
        read: impl FnOnce(&mut &[u8]) -> Result<T, LoadError>,
    ) -> Result<T, SceneError> {
        let mut rest = self.text.as_bytes();
        read(&mut rest).map_err(|error| {
            let done = self.text[..self.text.len() - rest.len()].lines();
            let statement: String = done
                .clone()
                .last()
                .unwrap_or_default()
                .trim()
                .chars()
                .take(SHOWN_LENGTH)
                .collect();
            SceneError::of_line(path, done.count(), format!("{statement}: {error}"))
        })
    }
}

fn split_keyword(statement: &str) -> (&str, &str) {
    let (keyword, rest) = statement
        .split_once(char::is_whitespace)
        .unwrap_or((statement, ""));
    (keyword, rest.trim())
}

/// Checks that the first `count` values are numbers and at most `limit` from 0.
pub fn check_numbers(values: &str, count: usize, limit: f32) -> Result<(), String> {
    // Also refuses NaN.
    let is_wrong = |word: &&str| {
        !word
            .parse::<f32>()
            .is_ok_and(|number| number.abs() <= limit)
    };
    if let Some(word) = values.split_whitespace().take(count).find(is_wrong) {
        return Err(format!(
            "\"{word}\" is not a number from -{limit:e} to {limit:e}"
        ));
    }
    let found = values.split_whitespace().take(count).count();
    if found < count {
        Err(format!("{found} values; expected {count}"))
    } else {
        Ok(())
    }
}
