//! The documents avoid the words that readers stumbled over.

use std::path::{Path, PathBuf};

/// Phrases, and what to write instead.
const BANNED: [(&str, &str); 13] = [
    ("told", "printed, reported, named"),
    ("tells of", "describes"),
    ("anew", "again"),
    ("is no", "is not a, there is no"),
    ("are no", "are not, there are no"),
    ("hangs on", "depends on"),
    ("hang on", "depend on"),
    ("stands for itself", "the fact that speaks"),
    ("mend", "fix"),
    ("mends", "fixes"),
    ("whoever", "the user"),
    ("that of", "the noun"),
    ("those of", "the noun"),
];

/// Phrases in which a banned one is plain English.
const ALLOWED: [&str; 4] = ["is no longer", "are no longer", "there is no", "there are no"];

/// The documents, relative to the repository.
fn documents() -> Vec<PathBuf> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let folder = |name: &str| -> Vec<PathBuf> {
        let entries = std::fs::read_dir(root.join(name)).unwrap_or_else(|error| panic!("{name}: {error}"));
        entries.map(|entry| entry.unwrap().path()).collect()
    };
    let published = folder("results").into_iter().flat_map(|run| [run.join("README.md"), run.join("remark.md")]);
    let pages = ["README.md", "CHANGELOG.md", "CONTRIBUTING.md", "cluster/README.md", "results/README.md"];
    let mut files: Vec<PathBuf> = pages.iter().map(|page| root.join(page)).collect();
    files.extend(published.filter(|file| file.exists()));
    let texts = [folder("docs"), folder("experiments")].concat();
    let is_text = |file: &PathBuf| file.extension().is_some_and(|end| end == "md" || end == "toml");
    files.extend(texts.into_iter().filter(is_text));
    files.sort();
    files
}

/// A line with each code span as one word.
fn without_code(line: &str) -> String {
    line.split('`').step_by(2).collect::<Vec<_>>().join("CODE")
}

/// Text of a page without code blocks, code spans and blocks filled from runs; lines stay where they are.
fn prose(page: &str) -> String {
    let (mut is_code, mut is_filled) = (false, false);
    let line = |line: &str| {
        let is_fence = line.trim_start().starts_with("```");
        is_code ^= is_fence;
        is_filled |= line.starts_with("<!-- csv ") || line.starts_with("<!-- sentence ");
        let is_skipped = is_code || is_fence || is_filled || line.starts_with("    ");
        is_filled &= !line.contains("<!-- /");
        if is_skipped { String::new() } else { without_code(line) }
    };
    page.lines().map(line).collect::<Vec<_>>().join("\n")
}

/// What a user may see of a source file: help comments (`///`) and string literals. Lines stay where they are; a mark
/// separates one literal from the next.
fn visible(source: &str) -> String {
    let mut text = String::new();
    let (mut is_text, mut rest) = (false, source);
    while let Some(c) = rest.chars().next() {
        let mut width = c.len_utf8();
        match c {
            '\n' => text.push('\n'),
            '\\' if is_text => {
                // An escaped line break continues the literal on the next line.
                let next = rest[1..].chars().next().unwrap_or_default();
                text.push(if next == '\n' { '\n' } else { ' ' });
                width += next.len_utf8();
            }
            '"' => {
                is_text = !is_text;
                text += " . ";
            }
            _ if is_text => text.push(c),
            '\'' if rest.starts_with("'\"'") => width = 3,
            '/' if rest.starts_with("//") => {
                let line = rest.lines().next().unwrap_or_default();
                text += &without_code(line.strip_prefix("///").unwrap_or_default());
                width = line.len();
            }
            _ => {}
        }
        rest = &rest[width..];
    }
    text
}

/// The banned phrases of a text, each with its line from 1. A phrase may continue on the next line, but not across
/// punctuation.
fn banned(text: &str) -> Vec<(usize, &'static str)> {
    let words: Vec<(usize, &str)> = text
        .lines()
        .enumerate()
        .flat_map(|(line, text)| text.split_whitespace().map(move |word| (line + 1, word)))
        .filter(|(_, word)| *word != "#" && *word != "//!" && *word != "///")
        .collect();
    let bare = |word: &str| word.trim_matches(|c: char| !c.is_alphanumeric()).to_lowercase();
    let is_at = |at: usize, phrase: &str| {
        let parts: Vec<&str> = phrase.split(' ').collect();
        let Some(found) = words.get(at..at + parts.len()) else { return false };
        let last = parts.len() - 1;
        let joined = found[..last].iter().all(|(_, word)| word.ends_with(char::is_alphanumeric));
        joined && found.iter().zip(&parts).all(|((_, word), part)| bare(word) == *part)
    };
    // An allowed phrase covers a banned one that begins at its first or second word.
    let is_allowed = |at: usize| {
        ALLOWED.iter().any(|phrase| is_at(at, phrase) || at.checked_sub(1).is_some_and(|at| is_at(at, phrase)))
    };
    let starts = (0..words.len()).filter(|at| !is_allowed(*at));
    starts
        .flat_map(|at| BANNED.iter().filter(move |(phrase, _)| is_at(at, phrase)).map(move |(p, _)| (at, *p)))
        .map(|(at, phrase)| (words[at].0, phrase))
        .collect()
}

/// Fails with file, line and phrase if what `read` takes from a file has a banned phrase.
fn assert_plain(files: &[PathBuf], read: fn(&str) -> String) {
    let mut faults = Vec::new();
    for file in files {
        let text = std::fs::read_to_string(file).unwrap_or_else(|error| panic!("{}: {error}", file.display()));
        let name = file.strip_prefix(env!("CARGO_MANIFEST_DIR")).unwrap_or(file).display().to_string();
        for (line, phrase) in banned(&read(&text)) {
            let instead = BANNED.iter().find(|(p, _)| *p == phrase).map_or("", |(_, instead)| instead);
            faults.push(format!("{name}:{line}: \"{phrase}\": write {instead}"));
        }
    }
    assert!(faults.is_empty(), "\n{}", faults.join("\n"));
}

#[test]
fn documents_use_plain_words() {
    assert_plain(&documents(), prose);
}

#[test]
fn help_and_messages_use_plain_words() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("src/cli");
    let files: Vec<PathBuf> = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    assert_plain(&files, visible);
}

#[test]
fn banned_words_are_found_in_help_and_messages_only() {
    let source = "/// Prints that\n/// of mine, `anew`.\nlet told = \"a \\\n  mend\"; // anew\nf(\"is\", \"no\", '\"', \"whoever\");\n";
    assert_eq!(banned(&visible(source)), [(1, "that of"), (4, "mend"), (5, "whoever")]);
}

#[test]
fn banned_words_are_found_in_prose_only() {
    let page = "It is\nno number. Told, `anew` and\n\n    whoever\n```\nmend\n```\nIt is. No longer is it so; it is no longer, and there is no\nother.\n";
    assert_eq!(banned(&prose(page)), [(1, "is no"), (2, "told")]);
}
