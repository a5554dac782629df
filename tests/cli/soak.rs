//! A long sweep in one process: memory stays flat, nothing leaks, and the results are those of processes of their own.
//!
//! It takes minutes, so it runs only when asked for: `scripts/soak.sh`.

use super::{command, ok, splitsum, stdout};
use std::collections::BTreeMap;
use std::path::Path;
use std::time::Duration;

/// Alpha is the slowest axis, so that the environments take turns: the caches of the pipeline hold fewer of them.
const EXPERIMENT: &str = r#"
name = "soak"
question = "Does a long sweep stay small?"
size = [16, 16]
reference = { samples = 64 }
[axes]
alpha = { linspace = [0.05, 1.0, 56] }
environment = ["builtin:constant", "builtin:gradient", "builtin:checker", "builtin:studio", "builtin:cap"]
brdf = ["ggx", "beckmann", "phong"]
method = ["split-sum", "sampled"]
samples = [1, 2, 4, 8, 16]
diffuse = ["none"]
f0 = [1]
albedo = [0]
[precompute]
prefilter_size = [16, 16]
prefilter_level_count = 2
prefilter_sample_count = 16
dfg_size = 16
dfg_sample_count = 64
"#;
const CELLS: usize = 56 * 5 * 3 * 6;

/// Cells after which everything that is kept on purpose is there.
const WARM: usize = 500;
/// Largest growth after that.
const GROWTH: f64 = 0.05;

/// Resident memory in KiB and open files of a process.
fn footprint(id: u32) -> Option<(f64, usize)> {
    let status = std::fs::read_to_string(format!("/proc/{id}/status")).ok()?;
    let line = status.lines().find(|line| line.starts_with("VmRSS:"))?;
    let kib = line.split_whitespace().nth(1)?.parse().ok()?;
    Some((kib, std::fs::read_dir(format!("/proc/{id}/fd")).ok()?.count()))
}

/// The rows of errors.csv by cell.
fn rows(dir: &Path, out: &str) -> BTreeMap<String, String> {
    let text = std::fs::read_to_string(dir.join(out).join("errors.csv")).unwrap();
    text.lines().skip(1).map(|line| (line.split(',').next().unwrap().to_owned(), line.to_owned())).collect()
}

#[cfg(target_os = "linux")]
#[test]
#[ignore = "takes minutes: scripts/soak.sh"]
fn a_sweep_of_thousands_of_cells_stays_flat() {
    let dir = tempfile::tempdir().unwrap();
    std::fs::write(dir.path().join("soak.toml"), EXPERIMENT).unwrap();
    assert!(stdout(&splitsum(dir.path(), &["plan", "soak.toml"])).contains(&CELLS.to_string()));

    // The validation layer writes to standard output what it finds, objects that outlive their device included.
    let log = |name: &str| std::fs::File::create(dir.path().join(name)).unwrap();
    let mut child = command(dir.path(), &["run", "soak.toml", "--out", "whole"])
        .env("VK_INSTANCE_LAYERS", "VK_LAYER_KHRONOS_validation")
        .env("VK_LOADER_DEBUG", "layer")
        .stdout(log("stdout.txt"))
        .stderr(log("stderr.txt"))
        .spawn()
        .unwrap();
    let mut samples: Vec<(usize, f64, usize)> = Vec::new();
    let status = loop {
        if let Some(status) = child.try_wait().unwrap() {
            break status;
        }
        let done = std::fs::read_dir(dir.path().join("whole/cells")).map_or(0, Iterator::count);
        if done >= samples.last().map_or(0, |(last, ..)| *last) + 50
            && let Some((kib, files)) = footprint(child.id())
        {
            samples.push((done, kib, files));
        }
        std::thread::sleep(Duration::from_millis(20));
    };
    assert!(status.success());
    let said = std::fs::read_to_string(dir.path().join("stderr.txt")).unwrap();
    let is_layer = |line: &str| line.contains("Insert instance layer") && line.contains("KHRONOS_validation");
    assert!(said.lines().any(is_layer), "the validation layer is not installed, or the loader words it differently");
    let output = std::fs::read_to_string(dir.path().join("stdout.txt")).unwrap();
    assert!(!output.contains("Validation Error") && !output.contains("VUID-"), "{output}");

    let at = |wanted: usize| samples.iter().filter(move |(done, ..)| *done >= wanted).map(|s| (s.1, s.2));
    // Single samples move with what is in flight: medians of the first and the last twentieth of what follows.
    let window = (CELLS - WARM) / 20;
    let median = |mut kib: Vec<f64>| {
        kib.sort_by(f64::total_cmp);
        kib[kib.len() / 2]
    };
    let before = median(at(WARM).take(window / 50).map(|s| s.0).collect());
    let after = median(at(CELLS - window).map(|s| s.0).collect());
    let files: Vec<usize> = at(WARM).map(|s| s.1).collect();
    for (done, kib, files) in samples.iter().step_by(10) {
        println!("{done:6} cells {:8.1} MiB resident, {files} files open", kib / 1024.0);
    }
    let growth = after / before - 1.0;
    println!(
        "from cell {WARM} to {CELLS}: {:.1} to {:.1} MiB, {:+.2} %",
        before / 1024.0,
        after / 1024.0,
        100.0 * growth
    );
    assert!(growth < GROWTH, "resident memory grew by {:.1} %", 100.0 * growth);
    assert!(files.iter().max().unwrap() - files.iter().min().unwrap() <= 4, "open files: {files:?}");

    // Parts of it in processes of their own.
    let whole = rows(dir.path(), "whole");
    assert_eq!(whole.len(), CELLS);
    let mut compared = 0;
    for (part, (brdf, environment)) in
        [("ggx", "builtin:cap"), ("phong", "builtin:studio"), ("beckmann", "builtin:gradient")].into_iter().enumerate()
    {
        let out = format!("part-{part}");
        let sets = [format!("brdf={brdf}"), format!("environment={environment}")];
        ok(dir.path(), &["run", "soak.toml", "--out", &out, "--set", &sets[0], "--set", &sets[1]]);
        for (cell, row) in rows(dir.path(), &out) {
            assert_eq!(whole.get(&cell), Some(&row));
            compared += 1;
        }
    }
    assert_eq!(compared, 3 * 56 * 6);
    println!("{compared} rows equal those of processes of their own");
}
