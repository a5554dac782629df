//! The statements of an OBJ file, checked line by line. No crate names lines in errors, joins continued lines, allows
//! forward references across materials and distinguishes missing indices.

use std::borrow::Cow;
use std::collections::BTreeMap;

/// Largest coordinate: the squares of differences must stay far below the largest f32.
const MAX_COORDINATE: f32 = 1e15;

/// Longest part of an unknown keyword in a warning.
const MAX_KEYWORD: usize = 16;

#[derive(Debug)]
pub struct LineError {
    /// From 1; the first line of a continued statement.
    pub line: usize,
    pub message: String,
}

/// A checked OBJ file.
#[derive(Debug, Default)]
pub struct Obj {
    pub positions: Vec<[f32; 3]>,
    pub uvs: Vec<[f32; 2]>,
    pub normals: Vec<[f32; 3]>,
    /// Faces between two `usemtl` statements, in the order of the file.
    pub runs: Vec<Run>,
    /// Arguments of `mtllib`: one file name with spaces or several names.
    pub libraries: Vec<String>,
    /// Number of legal statements of each kind that are not read (`l`, `p`, `curv`, ...).
    pub ignored: BTreeMap<String, usize>,
}

/// Faces with one material.
#[derive(Debug, Default)]
pub struct Run {
    pub material: Option<String>,
    /// Corners of each face.
    pub arities: Vec<usize>,
    /// `v/vt/vn` of each corner, from 1; 0 for a missing one.
    pub corners: Vec<[usize; 3]>,
}

/// Splits a text into logical lines, each with the number of its first line: any line ends, a byte order mark, lines
/// continued by `\`.
pub fn logical_lines(text: &str) -> Vec<(usize, Cow<'_, str>)> {
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    // A file with CR only has no LF at all; in any other a CR at the end of a line is blank space.
    let ends = if text.contains('\n') { '\n' } else { '\r' };
    let mut lines = Vec::new();
    let mut physical = text.split(ends).map(str::trim).enumerate();
    while let Some((i, line)) = physical.next() {
        let mut logical = Cow::Borrowed(line);
        // A comment that ends in a backslash (a Windows folder, say) does not continue.
        while !logical.starts_with('#') && logical.ends_with('\\') {
            // In place: copying would take the square of the number of lines.
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

/// Parses a finite number.
pub fn number(word: &str) -> Result<f32, String> {
    match word.parse::<f32>() {
        Ok(value) if value.is_finite() => Ok(value),
        Ok(_) => Err(format!("\"{word}\" is not a finite number")),
        Err(_) => Err(format!("\"{word}\" is not a number")),
    }
}

/// Elements of a corner, in the order `v/vt/vn`.
const ELEMENTS: [&str; 3] = ["position", "texture coordinate", "normal"];

/// Reads and checks an OBJ file.
pub fn read(text: &str) -> Result<Obj, LineError> {
    let lines = logical_lines(text);
    // A face may refer to elements that follow it.
    let totals = ["v", "vt", "vn"].map(|kind| lines.iter().filter(|(_, line)| split_keyword(line).0 == kind).count());
    let mut obj = Obj { runs: vec![Run::default()], ..Obj::default() };
    for (line, logical) in &lines {
        statement(&mut obj, logical, totals).map_err(|message| LineError { line: *line, message })?;
    }
    Ok(obj)
}

/// Most corners of a face.
const CORNERS_MAX: usize = 1 << 16;

fn statement(obj: &mut Obj, logical: &str, totals: [usize; 3]) -> Result<(), String> {
    let (keyword, rest) = split_keyword(logical);
    // Names may contain a number sign, numbers may not.
    let values = rest.split('#').next().unwrap_or_default();
    match keyword {
        "v" => obj.positions.push(element("v", values, 3)?),
        "vt" => obj.uvs.push(element("vt", values, 1)?),
        "vn" => obj.normals.push(element("vn", values, 3)?),
        "f" | "fo" => {
            let counts = [obj.positions.len(), obj.uvs.len(), obj.normals.len()];
            let run = obj.runs.last_mut().expect("one from the beginning");
            let count = values.split_whitespace().take(CORNERS_MAX + 1).count();
            if !(3..=CORNERS_MAX).contains(&count) {
                let more = if count > CORNERS_MAX { "more than " } else { "" };
                let count = count.min(CORNERS_MAX);
                return Err(format!("a face of {more}{count} corners; expected 3 to {CORNERS_MAX}"));
            }
            for word in values.split_whitespace() {
                run.corners.push(corner(word, counts, totals)?);
            }
            run.arities.push(count);
        }
        "mtllib" => obj.libraries.push(rest.to_owned()),
        "usemtl" if rest.is_empty() => return Err("usemtl: expected the name of a material".to_owned()),
        "usemtl" => obj.runs.push(Run { material: Some(rest.to_owned()), ..Run::default() }),
        // Names and smoothing groups have no effect: missing normals are smooth everywhere.
        "o" | "g" | "s" => {}
        other => *obj.ignored.entry(other.chars().take(MAX_KEYWORD).collect()).or_default() += 1,
    }
    Ok(())
}

/// Splits off the first word of a statement.
pub fn split_keyword(logical: &str) -> (&str, &str) {
    let (keyword, rest) = logical.split_once(char::is_whitespace).unwrap_or((logical, ""));
    (keyword, rest.trim())
}

/// Parses the first values of a `v`, `vt` or `vn`, at least `least`; ignores others (w, colours, the third texture coordinate).
fn element<const N: usize>(keyword: &str, values: &str, least: usize) -> Result<[f32; N], String> {
    let mut element = [0.0; N];
    let mut count = 0;
    for (place, word) in element.iter_mut().zip(values.split_whitespace()) {
        *place = number(word).map_err(|message| format!("{keyword}: {message}"))?;
        if place.abs() > MAX_COORDINATE {
            return Err(format!("{keyword}: {word} is outside -{MAX_COORDINATE:e} to {MAX_COORDINATE:e}"));
        }
        count += 1;
    }
    if count < least { Err(format!("{keyword}: {count} values; expected {least}")) } else { Ok(element) }
}

/// Parses a corner as indices from 1, 0 for a missing one. Negative indices count back from the elements so far
/// (`counts`); positive ones may reach all of the file's (`totals`).
fn corner(word: &str, counts: [usize; 3], totals: [usize; 3]) -> Result<[usize; 3], String> {
    let malformed = || format!("face corner \"{word}\"; expected v, v/vt, v//vn or v/vt/vn with integers");
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
