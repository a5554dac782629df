//! The statements of an OBJ file, checked line by line and rewritten for `tobj`.
//!
//! `tobj` names no lines in its errors, joins no continued lines, reads no forward references across materials and takes a missing
//! texture or normal index from the corner before. So every statement is checked here and handed on in a form without those cases:
//! all `v`, `vt` and `vn` come first, every corner is `v/vt/vn` with positive indices, and index 1 of `vt` (0, 0) and of `vn` (0, 0, 0) stands
//! for "the file has none".

use std::borrow::Cow;
use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write;

/// Largest coordinate that is read. The squares of differences must stay far below the largest f32.
const MAX_COORDINATE: f32 = 1e15;

/// Longest part of an unknown keyword that is repeated in a warning.
const MAX_KEYWORD: usize = 16;

/// What is wrong with one line.
#[derive(Debug)]
pub struct LineError {
    /// Counted from 1; of a continued statement the first.
    pub line: usize,
    pub message: String,
}

/// A checked OBJ file.
#[derive(Debug, Default)]
pub struct ObjText {
    /// The file as `tobj` shall see it. Its one `mtllib` statement stands for all of [`ObjText::libraries`].
    pub text: String,
    /// What follows each `mtllib`: one file name with spaces or several names.
    pub libraries: Vec<String>,
    /// Names that `usemtl` asks for.
    pub materials: BTreeSet<String>,
    pub face_count: usize,
    pub position_count: usize,
    /// Number of statements of each kind that are legal and not read (`l`, `p`, `curv`, ...).
    pub ignored: BTreeMap<String, usize>,
}

/// The logical lines of a text with the number of their first line: line ends of any kind, a byte order mark, and lines continued by `\`.
pub fn logical_lines(text: &str) -> Vec<(usize, Cow<'_, str>)> {
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    // A file with CR only holds no LF at all; in any other a CR at the end of a line is blank space.
    let ends = if text.contains('\n') { '\n' } else { '\r' };
    let mut lines = Vec::new();
    let mut physical = text.split(ends).map(str::trim).enumerate();
    while let Some((i, line)) = physical.next() {
        let mut logical = Cow::Borrowed(line);
        // A comment that ends in a backslash (a Windows folder, say) does not swallow the next line.
        while !logical.starts_with('#') && logical.ends_with('\\') {
            // In place: copying what is joined so far would take the square of the number of lines.
            let joined = logical.to_mut();
            joined.truncate(joined.trim_end_matches('\\').len());
            let Some((_, next)) = physical.next() else { break };
            joined.push(' ');
            joined.push_str(next);
        }
        if !logical.is_empty() && !logical.starts_with('#') {
            lines.push((i + 1, logical));
        }
    }
    lines
}

/// A finite number, or what is wrong with `word`.
pub fn number(word: &str) -> Result<f32, String> {
    match word.parse::<f32>() {
        Ok(value) if value.is_finite() => Ok(value),
        Ok(_) => Err(format!("\"{word}\" is not a finite number")),
        Err(_) => Err(format!("\"{word}\" is not a number")),
    }
}

/// The three kinds of elements that a corner refers to, in the order `v/vt/vn`.
const ELEMENTS: [&str; 3] = ["position", "texture coordinate", "normal"];

/// Checks an OBJ file and rewrites it for `tobj`.
pub fn read(text: &str) -> Result<ObjText, LineError> {
    let lines = logical_lines(text);
    // A face may refer to elements that follow it, so their numbers are needed first.
    let totals = ["v", "vt", "vn"].map(|kind| lines.iter().filter(|(_, line)| split_keyword(line).0 == kind).count());
    let mut out =
        ObjText { text: "mtllib all\nvt 0 0\nvn 0 0 0\n".to_owned(), position_count: totals[0], ..ObjText::default() };
    let mut faces = String::new();
    let mut counts = [0usize; 3];
    for (line, logical) in &lines {
        let (keyword, rest) = split_keyword(logical);
        // Names may hold a number sign, numbers may not.
        let values = rest.split('#').next().unwrap_or_default();
        let result = match keyword {
            "v" => element(&mut out.text, "v", values, 3..=3, &mut counts[0]),
            "vt" => element(&mut out.text, "vt", values, 1..=2, &mut counts[1]),
            "vn" => element(&mut out.text, "vn", values, 3..=3, &mut counts[2]),
            "f" | "fo" => {
                out.face_count += 1;
                face(&mut faces, values, counts, totals)
            }
            "mtllib" => {
                out.libraries.push(rest.to_owned());
                Ok(())
            }
            "usemtl" if rest.is_empty() => Err("usemtl: expected the name of a material".to_owned()),
            "usemtl" => {
                let _ = writeln!(faces, "usemtl {rest}");
                out.materials.insert(rest.to_owned());
                Ok(())
            }
            // Names and smoothing groups change nothing: normals that a file does not give are smooth everywhere.
            "o" | "g" | "s" => Ok(()),
            other => {
                *out.ignored.entry(other.chars().take(MAX_KEYWORD).collect()).or_default() += 1;
                Ok(())
            }
        };
        result.map_err(|message| LineError { line: *line, message })?;
    }
    out.text.push_str(&faces);
    Ok(out)
}

/// The first word of a statement and the rest.
pub fn split_keyword(logical: &str) -> (&str, &str) {
    let (keyword, rest) = logical.split_once(char::is_whitespace).unwrap_or((logical, ""));
    (keyword, rest.trim())
}

/// Copies the first values of a `v`, `vt` or `vn`; further ones (w, colours, the third texture coordinate) are not read.
fn element(
    out: &mut String,
    keyword: &str,
    values: &str,
    wanted: std::ops::RangeInclusive<usize>,
    count: &mut usize,
) -> Result<(), String> {
    let words: Vec<&str> = values.split_whitespace().take(*wanted.end()).collect();
    if words.len() < *wanted.start() {
        return Err(format!("{keyword}: {} values, expected {}", words.len(), wanted.start()));
    }
    out.push_str(keyword);
    for i in 0..*wanted.end() {
        let word = words.get(i).copied().unwrap_or("0");
        let value = number(word).map_err(|message| format!("{keyword}: {message}"))?;
        if value.abs() > MAX_COORDINATE {
            return Err(format!("{keyword}: {word} is outside -{MAX_COORDINATE:e} to {MAX_COORDINATE:e}"));
        }
        out.push(' ');
        out.push_str(word);
    }
    out.push('\n');
    *count += 1;
    Ok(())
}

/// Writes a face whose corners are all `v/vt/vn`, counting from 1 and past the stand-ins for "none".
fn face(out: &mut String, values: &str, counts: [usize; 3], totals: [usize; 3]) -> Result<(), String> {
    let mut corner_count = 0;
    out.push('f');
    for word in values.split_whitespace() {
        let [v, vt, vn] = corner(word, counts, totals)?;
        let _ = write!(out, " {v}/{}/{}", vt + 1, vn + 1);
        corner_count += 1;
    }
    out.push('\n');
    if corner_count < 3 {
        return Err(format!("a face of {corner_count} corners, expected at least 3"));
    }
    Ok(())
}

/// A corner as indices from 1, 0 for an index that is left out. Negative indices count back from the elements read so far (`counts`);
/// positive ones may reach all of the file's (`totals`).
fn corner(word: &str, counts: [usize; 3], totals: [usize; 3]) -> Result<[usize; 3], String> {
    let malformed = || format!("face corner \"{word}\", expected v, v/vt, v//vn or v/vt/vn with integers");
    let mut corner = [0; 3];
    for (k, part) in word.split('/').enumerate() {
        let Some(index) = corner.get_mut(k) else {
            return Err(malformed());
        };
        if part.is_empty() && k > 0 {
            continue;
        }
        let value: i64 = part.parse().map_err(|_| malformed())?;
        *index = match value {
            0 => return Err(format!("{} index 0 in \"{word}\", indices start at 1", ELEMENTS[k])),
            1.. => usize::try_from(value).ok().filter(|&index| index <= totals[k]).ok_or_else(|| match totals[k] {
                0 => format!("{} index {value}, but the file defines none", ELEMENTS[k]),
                total => format!("{} index {value} is outside 1 to {total}", ELEMENTS[k]),
            })?,
            _ => usize::try_from(value.unsigned_abs())
                .ok()
                .and_then(|back| (counts[k] + 1).checked_sub(back))
                .filter(|&index| index > 0)
                .ok_or_else(|| format!("{} index {value} reaches before the first of {}", ELEMENTS[k], counts[k]))?,
        };
    }
    Ok(corner)
}
