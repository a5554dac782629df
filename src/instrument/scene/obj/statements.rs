//! The statements of OBJ and MTL files, checked; OBJ files in the form that the crate `tobj` reads.
//!
//! `tobj` accepts NaN, finds wrong indices only after the last face of a material, takes polylines
//! for faces, and does not join continued lines. It splits faces at `g`, which therefore carries the
//! smoothing group.

use crate::instrument::scene::SceneError;
use std::collections::BTreeMap;
use std::path::Path;
use tobj::LoadError;

/// Longest part of a statement in a message.
const SHOWN_LENGTH: usize = 60;

/// What becomes of the values of a keyword.
#[derive(Clone, Copy)]
pub enum Role {
    /// Has no effect here, on purpose.
    Ignored,
    /// Numbers, of which the first ones are kept; a number sign ends them.
    Numbers(usize),
    /// Names, which may contain a number sign.
    Text,
    /// A smoothing group.
    Smoothing,
    /// Counted in [`Statements::skipped`].
    Unread,
}

/// The comment in which ZBrush stores colours of vertices.
const POLYPAINT: &str = "#MRGB";

/// The roles of the keywords of a kind of file.
pub type Roles = fn(&str) -> Role;

/// The name of `g` for faces without a smoothing group, which are flat.
pub const FLAT: &str = "off";

#[derive(Debug, Default)]
pub struct Statements {
    /// The comment in the first line, which names the writer.
    pub first_comment: String,
    /// One statement in the line where it begins.
    text: String,
    /// Largest number of values of each keyword of numbers, also of values that are not kept.
    pub longest: BTreeMap<String, usize>,
    /// Number of skipped statements of each keyword.
    pub skipped: BTreeMap<String, usize>,
}

impl Statements {
    pub fn new(bytes: &[u8], roles: Roles) -> Self {
        // Only comments and names contain other text; Latin-1 there must not stop the geometry.
        let text = String::from_utf8_lossy(bytes);
        let text = text.trim_start_matches('\u{feff}');
        let mut lines = text.lines().map(str::trim);
        let first = text.lines().next().unwrap_or_default();
        let mut found = Self {
            first_comment: first
                .trim()
                .strip_prefix('#')
                .unwrap_or_default()
                .to_owned(),
            ..Self::default()
        };
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
            found.add(&statement, roles);
            found.text.push_str(&ends);
        }
        found
    }

    fn add(&mut self, statement: &str, roles: Roles) {
        let (keyword, rest) = split_keyword(statement);
        if keyword == POLYPAINT {
            *self.skipped.entry(keyword.to_owned()).or_default() += 1;
        }
        if keyword.is_empty() || keyword.starts_with('#') {
            return;
        }
        let numbers = rest.split('#').next().unwrap_or_default();
        match roles(keyword) {
            Role::Ignored => {}
            Role::Text => self.text.extend([keyword, " ", rest]),
            Role::Numbers(count) => {
                self.text.push_str(keyword);
                let kept = numbers.split_whitespace().take(count);
                kept.for_each(|number| self.text.extend([" ", number]));
                let value_count = numbers.split_whitespace().count();
                match self.longest.get_mut(keyword) {
                    Some(longest) => *longest = value_count.max(*longest),
                    None => {
                        self.longest.insert(keyword.to_owned(), value_count);
                    }
                }
            }
            Role::Smoothing => {
                let group = numbers.trim();
                let is_flat = group.parse() == Ok(0) || group.eq_ignore_ascii_case("off");
                self.text.extend(["g ", if is_flat { FLAT } else { group }]);
            }
            Role::Unread => {
                *self
                    .skipped
                    .entry(keyword.chars().take(SHOWN_LENGTH).collect())
                    .or_default() += 1;
            }
        }
    }

    /// Returns keyword and values of each statement.
    pub fn all(&self) -> impl Iterator<Item = (&str, &str)> {
        self.text.lines().map(split_keyword)
    }

    /// Returns the values of each statement with this keyword.
    pub fn values<'a>(&'a self, keyword: &'a str) -> impl Iterator<Item = &'a str> {
        self.all()
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

/// Checks a colour: three numbers, or one for a grey.
pub fn check_color(values: &str, limit: f32) -> Result<(), String> {
    match values.split_whitespace().next() {
        Some(form @ ("spectral" | "xyz")) => Err(format!(
            "a colour by {form} is not read; expected red, green and blue"
        )),
        Some(only) if only == values => check_numbers(values, 1, limit),
        _ => check_numbers(values, 3, limit),
    }
}
