//! The checksum of a record: its last member is the hash of everything before it.
//!
//! It detects damage and forgotten edits by hand, not forgery.

/// Text before and after the hash.
const BEFORE: &str = ",\n  \"checksum\": \"";
const AFTER: &str = "\"\n}\n";
const END: &str = "\n}\n";

/// Appends the checksum to an indented, non-empty JSON object.
pub fn sealed(object: &str) -> String {
    let body = object
        .strip_suffix(END)
        .expect("an indented object ends so");
    format!("{body}{BEFORE}{}{AFTER}", hash(body))
}

/// Whether the text differs from the output of [`sealed`]. Older records have no checksum.
pub fn is_broken(text: &str) -> bool {
    match text.rsplit_once(BEFORE) {
        Some((body, rest)) if rest.strip_suffix(AFTER) == Some(hash(body).as_str()) => false,
        // Reformatted text counts as broken, too.
        _ => text.contains("\"checksum\""),
    }
}

fn hash(text: &str) -> String {
    blake3::hash(text.as_bytes()).to_hex().to_string()
}
