//! The checksum of a record: its last line is the hash of all that stands before it.
//!
//! A guard against damage, and against a figure that somebody corrected by hand and forgot: not against malice, since who changes a
//! figure can make a new hash as well.

/// The text between a record and its hash, and after it.
const BEFORE: &str = ",\n  \"checksum\": \"";
const AFTER: &str = "\"\n}\n";
/// The end of an indented object.
const END: &str = "\n}\n";

/// An indented JSON object that is not empty, with its checksum as the last member.
pub fn sealed(object: &str) -> String {
    let body = object.strip_suffix(END).expect("an indented object ends so");
    format!("{body}{BEFORE}{}{AFTER}", hash(body))
}

/// Whether the text has a checksum and is not as [`sealed`] made it. Records of older programs have none.
pub fn is_broken(text: &str) -> bool {
    match text.rsplit_once(BEFORE) {
        Some((body, rest)) if rest.strip_suffix(AFTER) == Some(hash(body).as_str()) => false,
        // Another program may have written the same object with other spaces: whether its figures are those is not known.
        _ => text.contains("\"checksum\""),
    }
}

fn hash(text: &str) -> String {
    blake3::hash(text.as_bytes()).to_hex().to_string()
}
