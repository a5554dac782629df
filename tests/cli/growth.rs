//! What grows with the number of cells: nothing may hold all images, all records or the whole text of a plan.

use super::{command, ok, splitsum, stderr};
use std::io::{BufRead, BufReader, Read};
use std::path::Path;
use std::process::Stdio;
use std::time::Duration;

/// An experiment of 5 cells for each alpha, small ones on the scene whose images nobody looks at.
fn experiment(cells: usize) -> String {
    format!(
        r#"
name = "growth"
asks = ["error"]
size = [16, 16]
scene = "design"
reference = {{ samples = 32 }}
[axes]
environment = ["builtin:gradient"]
brdf = ["ggx"]
f0 = [1]
alpha = {{ linspace = [0.1, 1, {}] }}
method = ["sampled", "split-sum"]
samples = [1, 2, 4, 8]
diffuse = ["none"]
albedo = [0]
[precompute]
prefilter_size = [16, 16]
prefilter_level_count = 2
dfg_size = 16
dfg_sample_count = 64
"#,
        cells / 5
    )
}

fn folder(cells: usize) -> tempfile::TempDir {
    let dir = tempfile::tempdir().unwrap();
    std::fs::write(dir.path().join("growth.toml"), experiment(cells)).unwrap();
    dir
}

/// Memory of a process, KiB, as far as the system tells: `VmHWM:` is the most that it held, `VmRSS:` what it holds.
fn kib(process: u32, line: &str) -> Option<u64> {
    let status = std::fs::read_to_string(format!("/proc/{process}/status")).ok()?;
    status.lines().find_map(|text| text.strip_prefix(line))?.split_whitespace().next()?.parse().ok()
}

fn peak_kib(process: u32) -> Option<u64> {
    kib(process, "VmHWM:")
}

/// Peak, KiB, of a plan when its first line comes out; its text must be whole all the same.
fn plan_peak(cells: usize) -> Option<u64> {
    let dir = folder(cells);
    let mut child =
        command(dir.path(), &["plan", "growth.toml", "--json", "--no-cache"]).stdout(Stdio::piped()).spawn().unwrap();
    let mut out = BufReader::new(child.stdout.take().unwrap());
    let mut text = String::new();
    out.read_line(&mut text).unwrap();
    let peak = peak_kib(child.id());
    out.read_to_string(&mut text).unwrap();
    assert!(child.wait().unwrap().success());
    let plan: serde_json::Value = serde_json::from_str(&text).unwrap();
    assert_eq!(plan["cells"].as_array().unwrap().len(), cells);
    assert!(plan["plan_hash"].is_string() && plan["estimate"]["seconds"].is_number());
    let is_cell =
        |line: &&str| line.trim_end_matches(',').parse::<serde_json::Value>().is_ok_and(|v| v["axes"].is_object());
    assert_eq!(text.lines().filter(is_cell).count(), cells, "a line a cell");
    peak
}

#[test]
fn a_plan_is_written_as_it_is_made() {
    let (Some(few), Some(many)) = (plan_peak(1000), plan_peak(9000)) else {
        return eprintln!("skipped: the system does not tell the memory of a process");
    };
    let bytes = many.saturating_sub(few) * 1024 / 8000;
    println!("{few} KiB and {many} KiB: {bytes} bytes a cell");
    assert!(bytes < 4000, "{bytes} bytes a cell: as JSON values alone a cell takes 12,000");
}

/// Peak of a command that succeeds, KiB, or `None` where the system does not tell.
fn peak_of(dir: &Path, arguments: &[&str]) -> Option<u64> {
    let mut child = command(dir, arguments).stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap();
    let mut peak = None;
    let code = loop {
        peak = peak_kib(child.id()).or(peak);
        match child.try_wait().unwrap() {
            Some(status) => break status.code(),
            None => std::thread::sleep(Duration::from_millis(2)),
        }
    };
    assert_eq!(code, Some(0));
    peak
}

#[test]
fn a_run_of_four_times_the_cells_takes_little_more_memory() {
    let [small, large] = [folder(200), folder(800)];
    if !splitsum(small.path(), &["devices"]).status.success() {
        return eprintln!("skipped: no Vulkan device");
    }
    let run = ["run", "growth.toml", "--no-cache"];
    let (Some(few), Some(many)) = (peak_of(small.path(), &run), peak_of(large.path(), &run)) else {
        return eprintln!("skipped: the system does not tell the memory of a process");
    };
    let bytes = many.saturating_sub(few) * 1024 / 600;
    println!("{few} KiB and {many} KiB: {bytes} bytes a cell");
    assert!(bytes < 8_000, "{bytes} bytes a cell: its image takes 7,700, its tables as text 40,000");

    // No image of a design stands in the report, nor in a sheet.
    let run = large.path().join("runs/growth");
    let report = std::fs::metadata(run.join("report.html")).unwrap().len();
    assert!(report < 4_000_000, "{report}");
    assert_eq!(super::entries(&run.join("tables")), [""; 0]);
}

#[test]
fn a_merge_of_four_times_the_cells_takes_little_more_memory() {
    let [small, large] = [folder(200), folder(800)];
    if !splitsum(small.path(), &["devices"]).status.success() {
        return eprintln!("skipped: no Vulkan device");
    }
    let merge_peak = |dir: &Path| {
        ok(dir, &["run", "growth.toml", "--shard", "1/1", "--out", "shared", "--no-cache"]);
        peak_of(dir, &["merge", "shared"])
    };
    let (Some(few), Some(many)) = (merge_peak(small.path()), merge_peak(large.path())) else {
        return eprintln!("skipped: the system does not tell the memory of a process");
    };
    let bytes = many.saturating_sub(few) * 1024 / 600;
    println!("{few} KiB and {many} KiB: {bytes} bytes a cell");
    assert!(bytes < 15_000, "{bytes} bytes a cell");
}

#[test]
fn a_finished_run_ends_at_once_unless_a_file_was_touched() {
    let dir = folder(10);
    if !splitsum(dir.path(), &["devices"]).status.success() {
        return eprintln!("skipped: no Vulkan device");
    }
    let run = ["run", "growth.toml", "--no-cache"];
    let first = ok(dir.path(), &run);
    let cells = dir.path().join("runs/growth/cells");
    let record = cells.join(&super::entries(&cells)[0]);
    // What has its size and its time of change is not read again.
    let (text, time) =
        (std::fs::read_to_string(&record).unwrap(), std::fs::metadata(&record).unwrap().modified().unwrap());
    std::fs::write(&record, text.replace("relmse", "wrong!")).unwrap();
    std::fs::File::options().write(true).open(&record).unwrap().set_modified(time).unwrap();
    let again = splitsum(dir.path(), &run);
    assert!(again.status.success() && stderr(&again).is_empty(), "{}", stderr(&again));
    assert_eq!(super::stdout(&again), first);
    // Touched, it is, and its fault is found and mended.
    std::fs::File::options().write(true).open(&record).unwrap().set_modified(time + Duration::from_secs(1)).unwrap();
    let mended = splitsum(dir.path(), &run);
    assert!(mended.status.success() && stderr(&mended).contains("damaged"), "{}", stderr(&mended));
    assert!(std::fs::read_to_string(&record).unwrap().contains("relmse"));
    // Neither another program's mark nor one of another experiment counts.
    let other = std::fs::read_to_string(dir.path().join("growth.toml")).unwrap() + "# other\n";
    std::fs::write(dir.path().join("growth.toml"), other).unwrap();
    assert!(ok(dir.path(), &run).contains("Written to"));
    assert!(std::fs::read_to_string(dir.path().join("runs/growth/experiment.toml")).unwrap().ends_with("# other\n"));
}

/// It takes minutes, so it runs only when asked for: `scripts/soak.sh`.
#[cfg(target_os = "linux")]
#[test]
#[ignore = "takes minutes: scripts/soak.sh"]
fn a_sweep_of_thousands_of_cells_stays_flat() {
    const CELLS: usize = 5000;
    let dir = folder(CELLS);
    // The validation layer writes what it finds, objects that outlive their device included.
    let log = |name: &str| std::fs::File::create(dir.path().join(name)).unwrap();
    let mut child = command(dir.path(), &["run", "growth.toml", "--out", "whole"])
        .env("VK_INSTANCE_LAYERS", "VK_LAYER_KHRONOS_validation")
        .env("VK_LOADER_DEBUG", "layer")
        .stdout(log("stdout.txt"))
        .stderr(log("stderr.txt"))
        .spawn()
        .unwrap();
    // Resident KiB and open files after every 50 cells.
    let mut samples: Vec<(u64, usize)> = Vec::new();
    let status = loop {
        if let Some(status) = child.try_wait().unwrap() {
            break status;
        }
        let done = std::fs::read_dir(dir.path().join("whole/cells")).map_or(0, Iterator::count);
        let files = std::fs::read_dir(format!("/proc/{}/fd", child.id())).map_or(0, Iterator::count);
        if let Some(kib) = kib(child.id(), "VmRSS:").filter(|_| done >= 50 * (samples.len() + 1)) {
            samples.push((kib, files));
        }
        std::thread::sleep(Duration::from_millis(20));
    };
    assert!(status.success());
    let [output, said] =
        ["stdout.txt", "stderr.txt"].map(|name| std::fs::read_to_string(dir.path().join(name)).unwrap());
    assert!(said.contains("KHRONOS_validation"), "the validation layer is not installed");
    assert!(!output.contains("Validation Error") && !output.contains("VUID-"), "{output}");
    // After 500 cells everything that is kept on purpose is there.
    let median = |samples: &[(u64, usize)]| {
        let mut kib: Vec<u64> = samples.iter().map(|(kib, _)| *kib).collect();
        kib.sort_unstable();
        kib[kib.len() / 2] as f64
    };
    let (before, after) = (median(&samples[10..15]), median(&samples[samples.len() - 5..]));
    println!("{before} KiB after 500 cells, {after} KiB after {CELLS}");
    assert!(after < 1.05 * before, "memory grew from {before} to {after} KiB");
    let files = samples[10..].iter().map(|(_, files)| *files);
    assert!(files.clone().max().unwrap() - files.min().unwrap() <= 4, "{samples:?}");
}
