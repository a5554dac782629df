//! Source files: code, comments, and the paths that code names.

use std::collections::BTreeSet;
use std::path::Path;

/// Code without comments. Paths in literals stay: they make rules stricter.
pub fn code(source: &str) -> String {
    source
        .lines()
        .map(|line| line.split("//").next().unwrap_or_default())
        .collect::<Vec<_>>()
        .join("\n")
}

/// Comments without their markers, one space a line break.
pub fn comments(source: &str) -> String {
    let comments = source.lines().filter_map(|line| line.split_once("//"));
    comments
        .map(|(_, comment)| comment.trim_start_matches(['/', '!']).trim())
        .collect::<Vec<_>>()
        .join(" ")
}

/// Identifiers of a text, with their places.
pub fn words(code: &str) -> impl Iterator<Item = (usize, &str)> {
    let is_word = |c: char| c.is_alphanumeric() || c == '_';
    code.split(move |c: char| !is_word(c))
        .filter(|word| !word.is_empty())
        .map(move |word| (word.as_ptr() as usize - code.as_ptr() as usize, word))
}

/// Module of a file below `src`: `src/a/b.rs` and `src/a/b/mod.rs` are `[a, b]`.
pub fn module_of(file: &Path) -> Vec<String> {
    let path = file.strip_prefix("src").unwrap().with_extension("");
    let mut module: Vec<String> = path
        .iter()
        .map(|part| part.to_str().unwrap().to_owned())
        .collect();
    if module
        .last()
        .is_some_and(|last| last == "mod" || last == "lib")
    {
        module.pop();
    }
    module
}

/// Every path that code of `module` names by `crate::` or `super::`, from the crate's root, with
/// trees in braces expanded.
pub fn imports(module: &[String], code: &str) -> BTreeSet<Vec<String>> {
    let mut found = BTreeSet::new();
    for (start, word) in words(code) {
        // The second `super` of `super::super` belongs to the first.
        if !["crate", "super"].contains(&word) || code[..start].ends_with("::") {
            continue;
        }
        let mut base = if word == "crate" {
            Vec::new()
        } else {
            module[..module.len() - 1].to_vec()
        };
        let mut rest = &code[start + word.len()..];
        while let Some(after) = rest.strip_prefix("::super") {
            base.pop();
            rest = after;
        }
        expand(rest, &base, &mut found);
    }
    found
}

/// Reads `::name`, `::{...}` and `::*` after `base`; returns the rest.
fn expand<'t>(text: &'t str, base: &[String], found: &mut BTreeSet<Vec<String>>) -> &'t str {
    let end = text.trim_start();
    let Some(rest) = end.strip_prefix("::").map(str::trim_start) else {
        found.insert(base.to_vec());
        return end;
    };
    if let Some(mut rest) = rest.strip_prefix('{') {
        loop {
            // Each item of the tree is read as if it followed `::`.
            rest = rest.trim_start();
            if let Some(after) = rest.strip_prefix('}') {
                return after;
            }
            let name = rest.len()
                - rest
                    .trim_start_matches(|c: char| c.is_alphanumeric() || c == '_')
                    .len();
            let mut path = base.to_vec();
            if &rest[..name] != "self" {
                path.push(rest[..name].to_owned());
            }
            rest = expand(&rest[name..], &path, found);
            // Skips ` as other` and the comma.
            let next = rest.find([',', '}']).expect("a use tree is closed");
            rest = rest[next..].trim_start_matches(',');
        }
    }
    let name = rest.len()
        - rest
            .trim_start_matches(|c: char| c.is_alphanumeric() || c == '_')
            .len();
    let mut path = base.to_vec();
    if name > 0 {
        path.push(rest[..name].to_owned());
        return expand(&rest[name..], &path, found);
    }
    found.insert(path);
    rest
}
