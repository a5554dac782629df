//! Documents, help and messages avoid banned words, and documents take measured numbers from published runs.

use crate::layering::{self, files};
use std::path::{Path, PathBuf};

/// Banned phrases.
const BANNED: &str = "told, tells of, anew, is no, are no, was no, were no, hangs on, hang on, stands for itself, mend, mends, whoever, \
                      that of, those of, stands beside, stand beside, stands in, as it stands, held against, somebody";

/// Phrases in which a banned one is plain English.
const ALLOWED: &str = " no longer, there is no , there are no , there was no , there were no ";

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

/// The banned phrases of a text, each with the words after it. A phrase may continue on the next line, but not across punctuation.
fn banned(text: &str) -> Vec<String> {
    let words = text.split_whitespace().filter(|word| !["#", "//", "//!", "///", "\\"].contains(word));
    let text = format!(" {} ", words.collect::<Vec<_>>().join(" ").to_lowercase());
    let text = ALLOWED.split(',').fold(text, |text, phrase| text.replace(phrase, " ... "));
    let is_whole = |at: usize, end: usize| {
        !text[..at].ends_with(char::is_alphanumeric) && !text[end..].starts_with(char::is_alphanumeric)
    };
    let places =
        BANNED.split(", ").flat_map(|phrase| text.match_indices(phrase).map(|(at, _)| (at, at + phrase.len())));
    places.filter(|(at, end)| is_whole(*at, *end)).map(|(at, _)| text[at..].chars().take(60).collect()).collect()
}

/// Fails if what `read` takes from a file has a banned phrase.
fn assert_plain(files: &[PathBuf], read: fn(&str) -> String) {
    let of = |file: &PathBuf| banned(&read(&layering::read(file))).join("\n");
    let faults = files.iter().map(|file| (file, of(file))).filter(|(_, found)| !found.is_empty());
    let faults: Vec<String> = faults.map(|(file, found)| format!("{}: {found}", file.display())).collect();
    assert!(faults.is_empty(), "\n{}", faults.join("\n"));
}

#[test]
fn documents_use_plain_words() {
    assert_plain(&documents(), prose);
}

#[test]
fn help_messages_comments_and_names_of_tests_use_plain_words() {
    let rust = ["src", "tests", "examples", "benches", "shaders", "python/src"].map(|folder| files(folder, &["rs"]));
    let is_checked = |file: &PathBuf| !file.ends_with("tests/numeric/words.rs");
    let rust: Vec<PathBuf> = rust.concat().into_iter().filter(is_checked).collect();
    assert!(rust.len() > 400, "{} files", rust.len());
    assert_plain(&rust, words_of_rust);
    let python = ["python/package", "python/tests", "python/examples"].map(|folder| files(folder, &["py"]));
    let page = files("assets/report", &["js", "html"]);
    let scripts = [files("scripts", &["sh", "mjs", "py"]), files("cluster", &["yaml"]), python.concat(), page];
    assert_plain(&[files("shaders", &["glsl", "comp", "vert", "frag"]), scripts.concat()].concat(), str::to_owned);
}

#[test]
fn banned_words_are_found_in_prose_comments_texts_and_names_alone() {
    let source = "/// Prints that\n/// of mine, `anew`.\nlet told = \"a \\\n  mend\"; // anew\nf(\"is\", \"no\", '\"', \"whoever\");\n\
                  fn a_name_that_is_no_fact() {}\n";
    let found = banned(&words_of_rust(source));
    assert_eq!(found.len(), 6, "{found:?}");
    let page = "It is\nno number. Told, `anew` and\n\n    whoever\n```\nmend\n```\nIt is. No longer is it so; it is no longer, and there is no\nother.\n";
    assert_eq!(banned(&prose(page)).len(), 2);
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
const PLACES: &str = "alpha roughness f0 n·v mesa lavapipe rust debian apache-2 ofl version renderdoc ±";

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
                is_place = PLACES.split(' ').any(|place| place == bare) || is_place && joins.contains(&bare.as_str());
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
