//! What commands answer, against kept answers: a slip in a term, a table, a column or a key moves
//! one.

use super::{copied, golden, ok, splitsum, stderr, stdout};
use splitsum::bake::container::read_texture;
use splitsum::base::csv::Table;

/// Compares two texts word by word, numbers within a share of themselves. Ids of cells, which are
/// hexadecimal, do not count.
fn assert_near(what: &str, found: &str, kept: &str, within: f64) {
    let words = |text| {
        str::split(text, |c: char| c.is_whitespace() || ",:\"|;()%".contains(c))
            .filter(|w| !w.is_empty())
    };
    assert_eq!(words(found).count(), words(kept).count(), "{what}: {found}");
    for (found, kept) in words(found).zip(words(kept)) {
        let is_near = match (found.parse::<f64>(), kept.parse::<f64>()) {
            (Ok(found), Ok(kept)) => (found - kept).abs() <= within * kept.abs().max(1e-6),
            _ => found == kept || found.len() == 16 && found.bytes().all(|c| c.is_ascii_hexdigit()),
        };
        assert!(is_near, "{what}: {found}, kept {kept}");
    }
}

/// Cells with a value of their own on every axis, and images by all options. Other drivers draw
/// other edges, and another version rounds otherwise.
#[test]
fn errors_over_every_axis_are_kept() {
    let dir = tempfile::tempdir().unwrap();
    if !stdout(&splitsum(dir.path(), &["devices"])).contains("llvmpipe") {
        return eprintln!("skipped: kept on lavapipe");
    }
    ok(
        dir.path(),
        &[
            "run",
            golden().join("all_axes.toml").to_str().unwrap(),
            "--out",
            "run",
        ],
    );
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
        assert_near(
            &format!("row {row}"),
            &found.join(","),
            &kept.join(","),
            0.02,
        );
    }
    assert_kept("renders", 0.02);
}

/// Commands that need no device, on queries and settings drawn at random.
#[test]
fn answers_of_commands_are_kept() {
    assert_kept("commands", 1e-3);
}

fn assert_kept(folder: &str, within: f64) {
    let dir = copied(folder);
    for (number, command) in std::fs::read_to_string(dir.path().join("commands.txt"))
        .unwrap()
        .lines()
        .enumerate()
    {
        let words: Vec<&str> = command.split(' ').collect();
        let output = splitsum(dir.path(), &words);
        assert!(output.status.success(), "{command}: {}", stderr(&output));
        // What a reference drew, and warnings.
        let is_kept = |line: &&str| {
            ["warning", "shade-"]
                .iter()
                .any(|start| line.starts_with(start))
        };
        let mut found = stderr(&output)
            .lines()
            .filter(is_kept)
            .fold(stdout(&output), |all, line| all + line + "\n");
        // The table of taps is in no other answer.
        let out = words
            .iter()
            .position(|word| *word == "--out")
            .map(|at| dir.path().join(words[at + 1]));
        if let Some(taps) = out
            .map(|out| out.join("taps.ktx2"))
            .filter(|path| path.exists())
        {
            let texels = read_texture(&taps).unwrap().levels.concat().remove(0).data;
            let mean = |c: usize| {
                texels.iter().map(|texel| f64::from(texel[c])).sum::<f64>() / texels.len() as f64
            };
            found += &format!("taps {:.5} {:.5} {:.5}\n", mean(0), mean(1), mean(2));
        }
        let path = golden().join(format!("{folder}/answer_{number}.txt"));
        if std::env::var_os("INSTA_UPDATE").is_some_and(|update| update == "always") {
            std::fs::write(&path, &found).unwrap();
        }
        assert_near(
            command,
            &found,
            &std::fs::read_to_string(&path).unwrap(),
            within,
        );
    }
}
