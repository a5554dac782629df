//! Ids of cells, images and timed configurations.

use serde::{Deserialize, Serialize};
use std::fmt;
use std::str::FromStr;

/// Hex digits of an id.
const DIGITS: usize = 16;

/// Hash of everything that determines a cell, an image or a timed configuration: 64 bits, so a
/// million of them collide with probability 3e-8. Files and tables have it as 16 hex digits.
#[derive(Clone, Copy, Debug, Deserialize, Eq, Hash, Ord, PartialEq, PartialOrd, Serialize)]
#[serde(into = "String", try_from = "String")]
pub struct Id(u64);

impl Id {
    pub fn of_text(text: &str) -> Self {
        let hash = blake3::hash(text.as_bytes());
        let (first, _) = hash
            .as_bytes()
            .split_first_chunk()
            .expect("a hash has 32 bytes");
        Self(u64::from_be_bytes(*first))
    }

    pub fn of_lines(lines: &[String]) -> Self {
        Self::of_text(&lines.join("\n"))
    }
}

impl fmt::Display for Id {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        write!(f, "{:0DIGITS$x}", self.0)
    }
}

impl FromStr for Id {
    type Err = String;

    /// Reads what [`fmt::Display`] writes.
    fn from_str(text: &str) -> Result<Self, String> {
        let is_digit = |c: char| matches!(c, '0'..='9' | 'a'..='f');
        let digits = Some(text).filter(|text| text.len() == DIGITS && text.chars().all(is_digit));
        digits
            .and_then(|digits| u64::from_str_radix(digits, 16).ok())
            .map(Self)
            .ok_or_else(|| format!("{text:?} is not an id: expected {DIGITS} hex digits"))
    }
}

impl From<Id> for String {
    fn from(id: Id) -> Self {
        id.to_string()
    }
}

impl TryFrom<String> for Id {
    type Error = String;

    fn try_from(text: String) -> Result<Self, String> {
        text.parse()
    }
}

#[cfg(test)]
mod tests {
    use super::Id;

    #[test]
    fn an_id_is_the_begin_of_the_hash_in_hex() {
        for text in ["", "name=quick", "a\nb"] {
            let id = Id::of_text(text);
            let hex = blake3::hash(text.as_bytes()).to_hex();
            assert_eq!(id.to_string(), hex[..16]);
            assert_eq!(id.to_string().parse(), Ok(id));
        }
        let lines = ["a", "b"].map(str::to_owned);
        assert_eq!(Id::of_lines(&lines), Id::of_text("a\nb"));
        // Zeros in front stay.
        assert_eq!(Id(0x2a).to_string(), "000000000000002a");
    }

    #[test]
    fn ids_sort_as_their_digits() {
        let ids: Vec<Id> = (0..100).map(|k| Id::of_text(&k.to_string())).collect();
        let mut by_number = ids.clone();
        by_number.sort();
        let mut by_digits = ids;
        by_digits.sort_by_key(Id::to_string);
        assert_eq!(by_number, by_digits);
    }

    #[test]
    fn texts_of_another_form_are_refused() {
        for text in [
            "",
            "0",
            "+00000000000002a",
            "000000000000002A",
            "000000000000002a0",
        ] {
            assert!(text.parse::<Id>().is_err(), "{text}");
        }
    }
}
