//! Documents take measured numbers from published runs.

use std::path::{Path, PathBuf};

fn documents() -> Vec<PathBuf> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let docs = std::fs::read_dir(root.join("docs")).unwrap().map(|entry| entry.unwrap().path());
    let is_page = |file: &PathBuf| file.extension().is_some_and(|end| end == "md");
    docs.filter(is_page).chain([root.join("README.md")]).collect()
}

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
    let mut faults = Vec::new();
    for file in &documents() {
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
