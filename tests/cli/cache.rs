//! Tables and references kept for later runs change nothing but the time.

use super::end_to_end::folder;
use super::{assert_ends, splitsum, stderr};
use std::path::{Path, PathBuf};

/// One run into `out`; what it said, and its errors.
fn run(dir: &Path, out: &str, flags: &[&str]) -> (String, Vec<u8>) {
    let output = splitsum(dir, &[&["run", "tiny.toml", "--out", out], flags].concat());
    assert!(output.status.success(), "{}", stderr(&output));
    (stderr(&output), std::fs::read(dir.join(out).join("errors.csv")).unwrap())
}

fn entries(cache: &Path) -> Vec<PathBuf> {
    let mut files: Vec<PathBuf> = std::fs::read_dir(cache).unwrap().map(|entry| entry.unwrap().path()).collect();
    // Beside the entries stands how fast runs were.
    files.retain(|file| file.extension().is_some_and(|end| end == "kept"));
    files.sort();
    files
}

/// `made` and `read` of a kind in the last session of a run.
fn tally(dir: &Path, kind: &str) -> [u64; 2] {
    let text = std::fs::read(dir.join("provenance.json")).unwrap();
    let provenance: serde_json::Value = serde_json::from_slice(&text).unwrap();
    let work = &provenance["sessions"].as_array().unwrap().last().unwrap()["shared_work"][kind];
    ["made", "read"].map(|name| work[name].as_u64().unwrap_or(0))
}

#[test]
fn a_warm_cache_gives_the_same_bytes_and_a_damaged_entry_is_made_again() {
    let Some(dir) = folder() else { return };
    let dir = dir.path();
    let cache = ["--cache", "cache"];
    let (without, expected) = run(dir, "without", &["--no-cache"]);
    assert!(!without.contains("from the cache"), "{without}");
    let (_, cold) = run(dir, "cold", &cache);
    assert_eq!(cold, expected);
    // Two models at two widths.
    assert_eq!(tally(&dir.join("cold"), "reference"), [4, 0]);

    let (said, warm) = run(dir, "warm", &cache);
    assert_eq!(warm, expected);
    for kind in ["reference", "prefilter", "dfg", "mips"] {
        let [made, read] = tally(&dir.join("cold"), kind);
        assert!(made > 0 && read == 0, "{kind}: {made} made, {read} read");
        assert_eq!(tally(&dir.join("warm"), kind), [0, made], "{kind}");
    }
    assert!(said.contains("reference 0 (and 4 from the cache)"), "{said}");

    let files = entries(&dir.join("cache"));
    for (index, file) in files.iter().enumerate() {
        let mut bytes = std::fs::read(file).unwrap();
        let place = bytes.len() / 2;
        if index.is_multiple_of(2) {
            bytes[place] ^= 1
        } else {
            bytes.truncate(place)
        }
        std::fs::write(file, bytes).unwrap();
    }
    let (said, again) = run(dir, "again", &cache);
    assert_eq!(again, expected);
    assert_eq!(said.matches("is damaged; making its contents again").count(), files.len(), "{said}");
    assert_eq!(tally(&dir.join("again"), "reference"), [4, 0]);
    assert_eq!(entries(&dir.join("cache")), files);
}

#[test]
fn a_cache_that_cannot_be_used_is_a_fault_when_it_was_asked_for() {
    let Some(dir) = folder() else { return };
    std::fs::write(dir.path().join("file"), "").unwrap();
    assert_ends(&splitsum(dir.path(), &["run", "tiny.toml", "--cache", "file"]), 2, &["--cache: file: "]);
    assert!(!dir.path().join("runs").exists());
}
