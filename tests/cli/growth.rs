//! Memory by the number of cells: the program never holds all images, all records or the whole text
//! of a plan.

use super::end_to_end::has_device;
use super::{command, ok, splitsum, stderr};
use splitsum::experiment::axis::AXES;
use std::io::{BufRead, BufReader, Read};
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::Duration;

/// The program with one arena of glibc's allocator. By default each thread that finds the arenas busy
/// opens one more, so that the peak of one command differs by 30 MB with the timing of its threads.
fn one_arena(dir: &Path, arguments: &[&str]) -> Command {
    let mut command = command(dir, arguments);
    command.env("MALLOC_ARENA_MAX", "1");
    command
}

/// An experiment of 5 small cells for each alpha, on the scene without pictures.
fn experiment(cells: usize) -> String {
    format!(
        r#"
name = "growth"
asks = ["error"]
size = [16, 16]
scene = "design"
reference = {{ samples = 32, noise_share = 0 }}
[axes]
environment = ["builtin:gradient"]
brdf = ["ggx"]
f0 = [1]
alpha = {:?}
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
        (1..=cells / 5)
            .map(|k| 0.1 + 0.9 * k as f64 / cells as f64)
            .collect::<Vec<_>>()
    )
}

fn folder(cells: usize) -> tempfile::TempDir {
    let dir = tempfile::tempdir().unwrap();
    std::fs::write(dir.path().join("growth.toml"), experiment(cells)).unwrap();
    dir
}

/// Peak memory of a process, KiB, if the system reports it.
fn peak_kib(process: u32) -> Option<u64> {
    let status = std::fs::read_to_string(format!("/proc/{process}/status")).ok()?;
    status
        .lines()
        .find_map(|text| text.strip_prefix("VmHWM:"))?
        .split_whitespace()
        .next()?
        .parse()
        .ok()
}

/// Peak memory that each further cell adds, KiB, for a command in a folder of few cells and one of
/// many; 0, with a line, if the system does not report memory.
fn bytes_a_cell([few, many]: [usize; 2], peak: impl Fn(&Path, usize) -> Option<u64>) -> u64 {
    let [Some(small), Some(large)] = [few, many].map(|cells| peak(folder(cells).path(), cells))
    else {
        eprintln!("skipped: the system does not report the memory of a process");
        return 0;
    };
    let bytes = large.saturating_sub(small) * 1024 / (many - few) as u64;
    println!("{small} KiB and {large} KiB: {bytes} bytes a cell");
    bytes
}

/// Peak memory of a plan, KiB, when its first line appears. Its text must still be complete.
fn plan_peak(dir: &Path, cells: usize) -> Option<u64> {
    let mut child = one_arena(dir, &["plan", "growth.toml", "--json", "--no-cache"])
        .stdout(Stdio::piped())
        .spawn()
        .unwrap();
    let mut out = BufReader::new(child.stdout.take().unwrap());
    let mut text = String::new();
    out.read_line(&mut text).unwrap();
    let peak = peak_kib(child.id());
    out.read_to_string(&mut text).unwrap();
    assert!(child.wait().unwrap().success());
    let plan: serde_json::Value = serde_json::from_str(&text).unwrap();
    assert_eq!(plan["cells"].as_array().unwrap().len(), cells);
    assert!(plan["plan_hash"].is_string() && plan["estimate"]["seconds"].is_number());
    let is_cell = |line: &&str| {
        line.trim_end_matches(',')
            .parse::<serde_json::Value>()
            .is_ok_and(|v| v["axes"].is_object())
    };
    assert_eq!(text.lines().filter(is_cell).count(), cells, "a line a cell");
    peak
}

#[test]
fn a_plan_is_written_as_it_is_made() {
    let bytes = bytes_a_cell([1000, 9000], plan_peak);
    assert!(
        bytes < 700,
        "{bytes} bytes a cell: a value on each axis takes 1,000, as JSON 12,000"
    );
}

/// Peak memory of a command that succeeds, KiB; `None` if the system does not report it. Mesa
/// compiles all shaders, cached or not.
fn peak_of(dir: &Path, arguments: &[&str]) -> Option<u64> {
    let mut command = one_arena(dir, arguments);
    command
        .env("MESA_SHADER_CACHE_DISABLE", "true")
        .stdout(Stdio::null())
        .stderr(Stdio::null());
    let mut child = command.spawn().unwrap();
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
    if !has_device() {
        return;
    }
    let bytes = bytes_a_cell([800, 3200], |dir, cells| {
        let peak = peak_of(dir, &["run", "growth.toml", "--no-cache"]);
        // Neither the report nor a sheet has an image of a design.
        let run = dir.join("runs/growth");
        let report = std::fs::metadata(run.join("report.html")).unwrap().len();
        assert!(report < 1_300_000 + 1300 * cells as u64, "{report}");
        assert_eq!(super::entries(&run.join("tables")), [""; 0]);
        peak
    });
    assert!(
        bytes < 3_000,
        "{bytes} bytes a cell: its image takes 7,700, its tables as text 40,000"
    );
}

#[test]
fn a_merge_of_four_times_the_cells_takes_little_more_memory() {
    if !has_device() {
        return;
    }
    let bytes = bytes_a_cell([200, 800], |dir, _| {
        ok(
            dir,
            &[
                "run",
                "growth.toml",
                "--shard",
                "1/1",
                "--out",
                "shared",
                "--no-cache",
            ],
        );
        peak_of(dir, &["merge", "shared"])
    });
    // A cell is a value on each axis.
    assert!(bytes < 280 * AXES.len() as u64, "{bytes} bytes a cell");
}

/// Sixteen points a pixel with position, normal and depth take 576 bytes.
#[test]
fn antialiasing_takes_the_memory_of_its_points_alone() {
    if !has_device() {
        return;
    }
    const SIDE: u64 = 384;
    let dir = tempfile::tempdir().unwrap();
    let size = format!("{SIDE}x{SIDE}");
    let image = ["render", "--method", "split-sum", "--size", &size, "--out"];
    let peak = |more: &[&str]| peak_of(dir.path(), &[&image[..], more].concat());
    let (Some(plain), Some(antialiased)) = (peak(&["plain.exr"]), peak(&["a.exr", "--antialias"]))
    else {
        eprintln!("skipped: the system does not report the memory of a process");
        return;
    };
    let bytes = antialiased.saturating_sub(plain) * 1024 / (SIDE * SIDE);
    println!("{plain} KiB and {antialiased} KiB: {bytes} bytes a pixel");
    assert!((100..800).contains(&bytes), "{bytes} bytes a pixel");
}

#[test]
fn a_finished_run_ends_at_once_unless_a_file_was_touched() {
    if !has_device() {
        return;
    }
    let dir = folder(10);
    let run = ["run", "growth.toml", "--no-cache"];
    let first = ok(dir.path(), &run);
    let cells = dir.path().join("runs/growth/cells");
    let record = cells.join(&super::entries(&cells)[0]);
    // A file with unchanged size and modification time is not read again.
    let (text, time) = (
        std::fs::read_to_string(&record).unwrap(),
        std::fs::metadata(&record).unwrap().modified().unwrap(),
    );
    std::fs::write(&record, text.replace("relmse", "wrong!")).unwrap();
    std::fs::File::options()
        .write(true)
        .open(&record)
        .unwrap()
        .set_modified(time)
        .unwrap();
    let again = splitsum(dir.path(), &run);
    assert!(
        again.status.success() && stderr(&again).is_empty(),
        "{}",
        stderr(&again)
    );
    assert_eq!(super::stdout(&again), first);
    // A changed modification time causes a check, which finds and repairs the fault.
    std::fs::File::options()
        .write(true)
        .open(&record)
        .unwrap()
        .set_modified(time + Duration::from_secs(1))
        .unwrap();
    let repaired = splitsum(dir.path(), &run);
    assert!(
        repaired.status.success() && stderr(&repaired).contains("damaged"),
        "{}",
        stderr(&repaired)
    );
    assert!(std::fs::read_to_string(&record).unwrap().contains("relmse"));
    // A mark of another program or of another experiment does not count.
    let other = std::fs::read_to_string(dir.path().join("growth.toml")).unwrap() + "# other\n";
    std::fs::write(dir.path().join("growth.toml"), other).unwrap();
    assert!(ok(dir.path(), &run).contains("Written to"));
    assert!(
        std::fs::read_to_string(dir.path().join("runs/growth/experiment.toml"))
            .unwrap()
            .ends_with("# other\n")
    );
}
