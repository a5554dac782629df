//! What commands answer, against kept answers: a slip in a term, a table, a column or a key moves
//! one.

use super::cases::Cases;
use super::{golden, ok, splitsum, stderr, stdout};
use splitsum::bake::container::read_texture;
use splitsum::base::csv::Table;
use std::path::Path;

/// What differs between two texts, word by word, numbers within a share of themselves. Ids of
/// cells, which are hexadecimal, do not count.
fn difference(found: &str, kept: &str, within: f64) -> Option<String> {
    let words = |text| {
        str::split(text, |c: char| c.is_whitespace() || ",:\"|;()%".contains(c))
            .filter(|word| !word.is_empty())
    };
    if words(found).count() != words(kept).count() {
        return Some(format!("found:\n{found}\nkept:\n{kept}"));
    }
    let is_near = |found: &str, kept: &str| match (found.parse::<f64>(), kept.parse::<f64>()) {
        (Ok(found), Ok(kept)) => (found - kept).abs() <= within * kept.abs().max(1e-6),
        _ => found == kept || found.len() == 16 && found.bytes().all(|c| c.is_ascii_hexdigit()),
    };
    let mut pairs = words(found).zip(words(kept));
    let (found, kept) = pairs.find(|(found, kept)| !is_near(found, kept))?;
    Some(format!("found {found}, kept {kept}"))
}

/// Cells with a value of their own on every axis, and images by all options. Other drivers draw
/// other edges, and another version rounds otherwise.
#[test]
fn errors_over_every_axis_are_kept() {
    let dir = tempfile::tempdir().unwrap();
    if !stdout(&splitsum(dir.path(), &["devices"])).contains("llvmpipe") {
        return eprintln!("skipped: kept on lavapipe");
    }
    let axes = golden().join("all_axes.toml");
    ok(dir.path(), &["run", axes.to_str().unwrap(), "--out", "run"]);
    let kept = Table::read(&golden().join("all_axes.csv")).unwrap();
    let found = Table::read(&dir.path().join("run/errors.csv")).unwrap();
    assert_eq!(found.rows.len(), kept.rows.len());
    let places: Vec<usize> = kept
        .columns
        .iter()
        .map(|name| found.column(name).unwrap())
        .collect();
    for (row, (found, kept)) in found.rows.iter().zip(&kept.rows).enumerate() {
        let found: Vec<&str> = places.iter().map(|place| found[*place].as_str()).collect();
        let difference = difference(&found.join(","), &kept.join(","), 0.02);
        assert_eq!(difference, None, "row {row}");
    }
    assert_kept(Cases::read("renders"), 0.02);
}

/// Commands that need no device, on queries and settings drawn at random.
#[test]
fn answers_of_commands_are_kept() {
    for group in Cases::folder("commands") {
        assert_kept(group, 1e-3);
    }
}

fn assert_kept(cases: Cases, within: f64) {
    let dir = tempfile::tempdir().unwrap();
    cases.unpack(dir.path());
    let failures = cases.check(
        |command| answer(dir.path(), command),
        |found, kept| difference(found, kept, within),
    );
    assert!(failures.is_empty(), "{}", failures.join("\n\n"));
}

/// What a command prints, its warnings, and the means of the table of taps that it writes, which
/// is in no other answer.
fn answer(dir: &Path, command: &str) -> String {
    let words: Vec<&str> = command.split(' ').collect();
    let output = splitsum(dir, &words);
    assert!(output.status.success(), "{command}: {}", stderr(&output));
    let mut answer = stdout(&output);
    for line in stderr(&output).lines() {
        // "shade-": what a reference drew.
        if line.starts_with("warning") || line.starts_with("shade-") {
            answer += &format!("{line}\n");
        }
    }
    if let Some(flag) = words.iter().position(|word| *word == "--out") {
        let taps = dir.join(words[flag + 1]).join("taps.ktx2");
        if taps.exists() {
            let texels = read_texture(&taps).unwrap().levels.concat().remove(0).data;
            let mean = |c: usize| {
                texels.iter().map(|texel| f64::from(texel[c])).sum::<f64>() / texels.len() as f64
            };
            answer += &format!("taps {:.5} {:.5} {:.5}\n", mean(0), mean(1), mean(2));
        }
    }
    answer
}
