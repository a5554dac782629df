//! Every file of a folder of odd or broken inputs through the binary: read, or refused with one message. The folder is given by the
//! environment variable `SPLITSUM_ODD_INPUTS`; the result is a table. Run by hand, because such collections are large.

use super::{command, stderr};
use std::path::{Path, PathBuf};
use std::process::Stdio;
use std::time::{Duration, Instant};

const LONGEST: Duration = Duration::from_secs(10);
/// A file of at most some megabytes may not take more, whatever its header claims.
const MOST_KIB: u64 = 2 << 20;

fn files(folder: &Path, found: &mut Vec<PathBuf>) {
    let mut paths: Vec<PathBuf> = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    paths.sort();
    for path in paths {
        if path.is_dir() { files(&path, found) } else { found.push(path) }
    }
}

/// What a file is, by its extension or else by its first bytes.
fn kind(path: &Path) -> Option<&'static str> {
    let bytes = std::fs::read(path).ok()?;
    match path.extension().map(|extension| extension.to_string_lossy().to_lowercase()).as_deref() {
        Some("hdr" | "pic" | "rgbe") => Some("hdr"),
        Some("exr") => Some("exr"),
        Some("obj") => Some("obj"),
        Some("mtl" | "md" | "tsv" | "json" | "png" | "jpg" | "txt") => None,
        _ if bytes.starts_with(&[0x76, 0x2f, 0x31, 0x01]) || path.to_string_lossy().contains("exr") => Some("exr"),
        _ => None,
    }
}

#[cfg(target_os = "linux")]
#[test]
#[ignore = "needs SPLITSUM_ODD_INPUTS=FOLDER"]
fn every_file_is_read_or_refused() {
    let folder = PathBuf::from(std::env::var("SPLITSUM_ODD_INPUTS").expect("SPLITSUM_ODD_INPUTS=FOLDER"));
    let mut paths = Vec::new();
    files(&folder, &mut paths);
    let dir = tempfile::tempdir().unwrap();
    let mut bad = Vec::new();
    let mut counts = [0usize; 2];
    for path in &paths {
        let Some(kind) = kind(path) else { continue };
        let is_scene = kind == "obj";
        // Some collections keep their files without an extension.
        let input = match is_scene || path.extension().is_some_and(|e| e.eq_ignore_ascii_case(kind)) {
            true => path.canonicalize().unwrap(),
            false => {
                let copy = dir.path().join(format!("{}.{kind}", path.file_name().unwrap().to_string_lossy()));
                std::fs::copy(path, &copy).unwrap();
                copy
            }
        };
        let input = input.to_string_lossy().into_owned();
        let flag = if is_scene { "--scene" } else { "--environment" };
        let mut arguments = vec!["render", "--size", "8x8", "--method", "split-sum", "--out", "x.exr", flag, &input];
        if !is_scene {
            arguments.push("--clamp-invalid");
        }
        let started = Instant::now();
        let mut child = command(dir.path(), &arguments).stdout(Stdio::null()).stderr(Stdio::piped()).spawn().unwrap();
        let mut peak = 0;
        while child.try_wait().unwrap().is_none() && started.elapsed() < LONGEST {
            let status = std::fs::read_to_string(format!("/proc/{}/status", child.id())).unwrap_or_default();
            let line = status.lines().find(|line| line.starts_with("VmHWM:")).unwrap_or_default();
            peak = peak.max(line.split_whitespace().nth(1).and_then(|kib| kib.parse::<u64>().ok()).unwrap_or(0));
            std::thread::sleep(Duration::from_millis(2));
        }
        let seconds = started.elapsed().as_secs_f64();
        let _ = child.kill();
        let output = child.wait_with_output().unwrap();
        let message = stderr(&output);
        let faults: Vec<&str> = message.lines().filter(|line| !line.starts_with("warning: ")).collect();
        let name = path.strip_prefix(&folder).unwrap().display().to_string();
        let verdict = match output.status.code() {
            Some(0) => "read",
            Some(2) if faults.len() == 1 && peak <= MOST_KIB && !message.contains("panicked") => "refused",
            _ => "BAD",
        };
        match verdict {
            "read" => counts[0] += 1,
            "refused" => counts[1] += 1,
            _ => bad.push(name.clone()),
        }
        println!("{verdict}\t{seconds:.2} s\t{} MiB\t{name}\t{}", peak >> 10, faults.first().unwrap_or(&""));
    }
    println!("{} read, {} refused, {} bad", counts[0], counts[1], bad.len());
    assert!(counts[0] + counts[1] > 0, "{} holds no input", folder.display());
    assert!(bad.is_empty(), "{bad:#?}");
}
