//! Source files read as the compiler reads them: code, comments, and the paths that code names.

use std::collections::BTreeSet;
use std::path::Path;

/// A source text taken apart: code without comments and literals, and the comments without their markers, one space a line break.
#[derive(Default)]
pub struct Text {
    pub code: String,
    pub comments: String,
}

impl Text {
    pub fn of(source: &str) -> Self {
        let chars: Vec<char> = source.chars().collect();
        let at = |i: usize| chars.get(i).copied().unwrap_or('\0');
        let find = |from: usize, end: &str| {
            let end: Vec<char> = end.chars().collect();
            (from..chars.len()).find(|&i| chars[i..].starts_with(&end)).map_or(chars.len(), |i| i + end.len())
        };
        let mut text = Self::default();
        let mut i = 0;
        while i < chars.len() {
            i = match (at(i), at(i + 1)) {
                ('/', '/') => {
                    let end = find(i, "\n");
                    let line: String = chars[i..end].iter().collect();
                    text.comments += line.trim_start_matches(['/', '!']).trim();
                    text.comments.push(' ');
                    text.code.push('\n');
                    end
                }
                ('/', '*') => find(i, "*/"),
                ('r', '"' | '#') if !at(i.wrapping_sub(1)).is_alphanumeric() && at(i.wrapping_sub(1)) != '_' => {
                    let hashes = chars[i + 1..].iter().take_while(|c| **c == '#').count();
                    let quote = i + 1 + hashes;
                    // A raw identifier (r#type) has no quote.
                    if at(quote) == '"' { find(quote + 1, &format!("\"{}", "#".repeat(hashes))) } else { quote }
                }
                ('"', _) => {
                    let mut end = i + 1;
                    while end < chars.len() && at(end) != '"' {
                        end += if at(end) == '\\' { 2 } else { 1 };
                    }
                    end + 1
                }
                ('\'', '\\') => find(i + 3, "'"),
                ('\'', _) if at(i + 2) == '\'' => i + 3,
                (c, _) => {
                    text.code.push(c);
                    i + 1
                }
            };
        }
        text
    }
}

/// Identifiers of a text, with where each begins.
pub fn words(code: &str) -> impl Iterator<Item = (usize, &str)> {
    let is_word = |c: char| c.is_alphanumeric() || c == '_';
    code.split(move |c: char| !is_word(c))
        .filter(|word| !word.is_empty())
        .map(move |word| (word.as_ptr() as usize - code.as_ptr() as usize, word))
}

/// Module of a file below `src`: `src/a/b.rs` and `src/a/b/mod.rs` are `[a, b]`.
pub fn module_of(file: &Path) -> Vec<String> {
    let path = file.strip_prefix("src").unwrap().with_extension("");
    let mut module: Vec<String> = path.iter().map(|part| part.to_str().unwrap().to_owned()).collect();
    if module.last().is_some_and(|last| last == "mod" || last == "lib") {
        module.pop();
    }
    module
}

/// Every path that code of `module` names by `crate::` or `super::`, from the crate's root, trees in braces multiplied out.
pub fn imports(module: &[String], code: &str) -> BTreeSet<Vec<String>> {
    let mut found = BTreeSet::new();
    for (start, word) in words(code) {
        // The second `super` of `super::super` belongs to the first.
        if !["crate", "super"].contains(&word) || code[..start].ends_with("::") {
            continue;
        }
        let mut base = if word == "crate" { Vec::new() } else { module[..module.len() - 1].to_vec() };
        let mut rest = &code[start + word.len()..];
        while let Some(after) = rest.strip_prefix("::super") {
            base.pop();
            rest = after;
        }
        expand(rest, &base, &mut found);
    }
    found
}

/// Reads `::name`, `::{...}` and `::*` after `base`; returns what follows.
fn expand<'t>(text: &'t str, base: &[String], found: &mut BTreeSet<Vec<String>>) -> &'t str {
    let end = text.trim_start();
    let Some(rest) = end.strip_prefix("::").map(str::trim_start) else {
        found.insert(base.to_vec());
        return end;
    };
    if let Some(mut rest) = rest.strip_prefix('{') {
        loop {
            // Each item of the tree stands as if after `::`.
            rest = rest.trim_start();
            if let Some(after) = rest.strip_prefix('}') {
                return after;
            }
            let name = rest.len() - rest.trim_start_matches(|c: char| c.is_alphanumeric() || c == '_').len();
            let mut path = base.to_vec();
            if &rest[..name] != "self" {
                path.push(rest[..name].to_owned());
            }
            rest = expand(&rest[name..], &path, found);
            // Past ` as other` and the comma.
            let next = rest.find([',', '}']).expect("a use tree is closed");
            rest = rest[next..].trim_start_matches(',');
        }
    }
    let name = rest.len() - rest.trim_start_matches(|c: char| c.is_alphanumeric() || c == '_').len();
    let mut path = base.to_vec();
    if name > 0 {
        path.push(rest[..name].to_owned());
        return expand(&rest[name..], &path, found);
    }
    found.insert(path);
    rest
}
