//! Documents, help and messages avoid banned words, and documents take measured numbers from published runs.

use crate::layering::{self, files};
use std::path::{Path, PathBuf};

/// Banned phrases, and their replacements.
const BANNED: [(&str, &str); 21] = [
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
    ("stands beside", "is in, is next to"),
    ("stand beside", "are in, are next to"),
    ("stands in", "is in"),
    ("as it stands", "unchanged"),
    ("held against", "compared with"),
    ("was no", "was not a, there was no"),
    ("were no", "were not, there were no"),
    ("somebody", "the user, the caller"),
];

/// Phrases in which a banned one is plain English.
const ALLOWED: [&str; 8] = [
    "is no longer",
    "are no longer",
    "was no longer",
    "were no longer",
    "there is no",
    "there are no",
    "there was no",
    "there were no",
];

/// Files that may use banned phrases, and why.
const EXEMPT: [(&str, &str); 1] = [("tests/numeric/words.rs", "it lists the phrases")];

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

/// A Rust file with its names of functions as words. A mark at each quote keeps code and literals apart.
fn words_of_rust(source: &str) -> String {
    let line = |line: &str| {
        let line = without_code(line).replace('"', " . ");
        if line.contains("fn ") { line.replace('_', " ") } else { line }
    };
    source.lines().map(line).collect::<Vec<_>>().join("\n")
}

/// The banned phrases of a text, each with its line from 1. A phrase may continue on the next line, but not across
/// punctuation.
fn banned(text: &str) -> Vec<(usize, &'static str)> {
    let words: Vec<(usize, &str)> = text
        .lines()
        .enumerate()
        .flat_map(|(line, text)| text.split_whitespace().map(move |word| (line + 1, word)))
        .filter(|(_, word)| !["#", "//", "//!", "///", "\\"].contains(word))
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
        let text = layering::read(file);
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
fn help_messages_comments_and_names_of_tests_use_plain_words() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let is_checked = |file: &PathBuf| EXEMPT.iter().all(|(exempt, _)| !file.ends_with(exempt));
    let rust = ["src", "tests", "examples", "benches", "shaders", "python/src"].map(|folder| files(folder, &["rs"]));
    let rust: Vec<PathBuf> = rust.concat().into_iter().filter(is_checked).collect();
    assert!(rust.len() > 400, "{} files", rust.len());
    assert_plain(&rust, words_of_rust);
    let shaders = files("shaders", &["glsl", "comp", "vert", "frag"]);
    let python = ["python/package", "python/tests", "python/examples"].map(|folder| files(folder, &["py"]));
    let scripts = [files("scripts", &["sh", "mjs", "py"]), files("cluster", &["yaml"]), python.concat()];
    let is_text = |file: &PathBuf| file.extension().is_some_and(|end| end == "js" || end == "html");
    let of_page = |folder: &str| std::fs::read_dir(root.join("assets").join(folder)).unwrap();
    let page = of_page("report").chain(of_page("bakes")).map(|entry| entry.unwrap().path());
    let page: Vec<PathBuf> = page.filter(is_text).collect();
    assert_plain(&[shaders, scripts.concat(), page].concat(), str::to_owned);
}

#[test]
fn banned_words_are_found_in_comments_texts_and_names() {
    let source = "/// Prints that\n/// of mine, `anew`.\nlet told = \"a \\\n  mend\"; // anew\nf(\"is\", \"no\", '\"', \"whoever\");\n\
                  fn a_name_that_is_no_fact() {}\n";
    let found = [(1, "that of"), (3, "told"), (4, "mend"), (4, "anew"), (5, "whoever"), (6, "is no")];
    assert_eq!(banned(&words_of_rust(source)), found);
}

#[test]
fn banned_words_are_found_in_prose_only() {
    let page = "It is\nno number. Told, `anew` and\n\n    whoever\n```\nmend\n```\nIt is. No longer is it so; it is no longer, and there is no\nother.\n";
    assert_eq!(banned(&prose(page)), [(1, "is no"), (2, "told")]);
}

/// Pages, or sections of pages, with decimal numbers that no published table can fill, and why.
const TYPED: [(&str, &str, &str); 19] = [
    ("docs/architecture.md", "", "goldens and shares of tests"),
    ("docs/bakes.md", "## Files", "formats"),
    ("docs/bakes.md", "## Conventions", "formulas and versions of engines"),
    ("docs/bakes.md", "## Scores", "definitions and limits"),
    ("docs/bakes.md", "## Bakes for engines", "pixel formats, by hand"),
    ("docs/bakes.md", "## Checked in other programs", "other programs' pictures, by scripts/check-clients.sh"),
    ("docs/bibliography.md", "", "titles"),
    ("docs/columns.md", "", "definitions"),
    ("docs/conventions.md", "", "definitions"),
    ("docs/estimators.md", "", "algebra and constants of sources"),
    ("docs/glossary.md", "", "definitions"),
    ("docs/own-method.md", "", "ranges of inputs"),
    ("docs/paste.md", "## Tables", "algebra of a clamped lookup"),
    ("docs/research.md", "## Taps", "constants of the fit"),
    ("docs/research.md", "## Trials without a published run", "trials without a published run"),
    ("docs/running.md", "", "times of single commands on one machine"),
    ("docs/source-documents.md", "", "sources"),
    ("docs/testing.md", "## By hand", "programs by hand"),
    ("docs/testing.md", "## Missed goals", "times of single commands on one machine"),
];

/// Words before a number that is a place, a version or a level of confidence, not a result.
const PLACES: [&str; 13] = [
    "alpha",
    "roughness",
    "f0",
    "n·v",
    "mesa",
    "lavapipe",
    "rust",
    "debian",
    "apache-2",
    "ofl",
    "version",
    "renderdoc",
    "±",
];

/// Decimal numbers and percentages of a page that neither a block fills nor an entry of [`TYPED`] explains, each with
/// its line from 1.
fn typed_numbers(page: &str, text: &str) -> Vec<(usize, String)> {
    let mut heading = String::new();
    let mut found = Vec::new();
    for (line, (whole, prose)) in text.lines().zip(prose(text).lines()).enumerate() {
        if whole.starts_with("## ") || whole.starts_with("# ") {
            heading = whole.to_owned();
        }
        if TYPED.iter().any(|(own, section, _)| *own == page && (section.is_empty() || *section == heading)) {
            continue;
        }
        // Blocks within a sentence.
        let mut parts = prose.split("<!-- csv ");
        let first = parts.next().unwrap_or_default().to_owned();
        let prose = parts.fold(first, |all, part| all + part.split("<!-- /csv -->").nth(1).unwrap_or_default());
        let mut is_place = false;
        let words: Vec<&str> = prose.split_whitespace().collect();
        for (at, word) in words.iter().enumerate() {
            let bare = word.trim_matches(|c: char| !c.is_alphanumeric()).to_lowercase();
            let is_number = bare.starts_with(|c: char| c.is_ascii_digit()) && bare.parse::<f64>().is_ok();
            let is_share = words.get(at + 1).is_some_and(|next| next.starts_with('%')) && bare != "95" && bare != "100";
            if is_number && !is_place && (bare.contains(['.', 'e']) || is_share) {
                found.push((line + 1, bare));
            } else if !is_number {
                let joins = ["to", "and", "or", "of", "at", "below", "above", "from", "until", "is", "", "are"];
                is_place = PLACES.contains(&bare.as_str()) || is_place && joins.contains(&bare.as_str());
            }
        }
    }
    found
}

#[test]
fn measured_numbers_come_from_published_runs() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let is_page = |file: &PathBuf| {
        file.ends_with("README.md") && file.parent() == Some(root) || file.starts_with(root.join("docs"))
    };
    let mut faults = Vec::new();
    for file in documents().iter().filter(|file| is_page(file)) {
        let page = file.strip_prefix(root).unwrap().to_str().unwrap();
        let text = std::fs::read_to_string(file).unwrap();
        faults.extend(typed_numbers(page, &text).into_iter().map(|(line, number)| {
            format!("{page}:{line}: {number}: fill it by a block from results/, or explain its section in TYPED")
        }));
    }
    assert!(faults.is_empty(), "\n{}", faults.join("\n"));
}

#[test]
fn typed_numbers_are_found() {
    let page = "# A\n\nAt alpha 0.1, 0.25 and 0.5 it is 0.12. A share of 53 %, with 95 % <!-- csv a/b.csv x=0.5 -->0.7<!-- /csv -->.\n\n## B\n\n1.5 times\n";
    assert_eq!(typed_numbers("docs/a.md", page), [(3, "0.12".into()), (3, "53".into()), (7, "1.5".into())]);
    assert_eq!(typed_numbers("docs/estimators.md", page), []);
}
