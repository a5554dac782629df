//! The checksum of a record: its last line is the hash of all that stands before it.
//!
//! A guard against damage, and against a figure that somebody corrected by hand and forgot: not against malice, since who changes a
//! figure can make a new hash as well.

/// The text between a record and its hash, and after it.
const BEFORE: &str = ",\n  \"checksum\": \"";
const AFTER: &str = "\"\n}\n";
/// The end of an indented object.
const END: &str = "\n}\n";

/// The state of a record's checksum.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Seal {
    /// Every byte is as it was written.
    Whole,
    /// It was written without one.
    None,
    Broken,
}

/// An indented JSON object that is not empty, with its checksum as the last member.
pub fn sealed(object: &str) -> String {
    let body = object.strip_suffix(END).expect("an indented object ends so");
    format!("{body}{BEFORE}{}{AFTER}", hash(body))
}

/// Whether the text is as [`sealed`] made it.
pub fn check(text: &str) -> Seal {
    match text.rsplit_once(BEFORE) {
        Some((body, rest)) if rest.strip_suffix(AFTER) == Some(hash(body).as_str()) => Seal::Whole,
        // Another program may have written the same object with other spaces: whether its figures are those is not known.
        _ if text.contains("\"checksum\"") => Seal::Broken,
        _ => Seal::None,
    }
}

fn hash(text: &str) -> String {
    blake3::hash(text.as_bytes()).to_hex().to_string()
}
