//! Runs that are killed, that fill the disk, or that share a folder: finished work is kept, and the
//! result is the same. They use any Vulkan device; without one they skip with a line.

use super::end_to_end::folder;
use super::{assert_ends, command, ok, splitsum, stderr};
use std::path::Path;
use std::process::Stdio;
use std::time::{Duration, Instant};

const KILLS: usize = 20;

fn run_to(dir: &Path, out: &str) {
    ok(dir, &["run", "tiny.toml", "--out", out]);
}

fn table(dir: &Path, out: &str, name: &str) -> Vec<u8> {
    std::fs::read(dir.join(out).join(name)).unwrap()
}

/// Every file of the run except the files that describe its invocations.
fn files(dir: &Path) -> Vec<String> {
    let mut names = Vec::new();
    for entry in std::fs::read_dir(dir).unwrap().map(Result::unwrap) {
        let name = entry.file_name().into_string().unwrap();
        if entry.path().is_dir() {
            names.extend(
                files(&entry.path())
                    .into_iter()
                    .map(|file| format!("{name}/{file}")),
            );
        } else {
            names.push(name);
        }
    }
    names.sort();
    names
}

#[test]
fn a_run_killed_at_twenty_moments_ends_with_the_same_tables() {
    let Some(dir) = folder() else { return };
    let started = Instant::now();
    run_to(dir.path(), "whole");
    let whole = started.elapsed();
    // Moments spread over the duration of a run by the golden ratio, so that they hit every phase.
    for kill in 0..KILLS {
        let moment = whole.mul_f64((0.05 + kill as f64 * 0.618_034).fract());
        let mut child = command(dir.path(), &["run", "tiny.toml", "--out", "killed"])
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .spawn()
            .unwrap();
        let deadline = Instant::now() + moment;
        while child.try_wait().unwrap().is_none() && Instant::now() < deadline {
            std::thread::sleep(Duration::from_millis(1));
        }
        let _ = child.kill();
        child.wait().unwrap();
    }
    run_to(dir.path(), "killed");
    for name in [
        "errors.csv",
        "errors_by_n_dot_v.csv",
        "summary.md",
        "experiment.toml",
        "tables/ggx.svg",
    ] {
        assert!(
            table(dir.path(), "killed", name) == table(dir.path(), "whole", name),
            "{name} differs"
        );
    }
    assert_eq!(
        files(&dir.path().join("killed")),
        files(&dir.path().join("whole"))
    );
}

/// A small file system, removed at the end of the test. `None` if mounting is not allowed.
struct SmallDisk(std::path::PathBuf);

impl SmallDisk {
    fn mount(path: &Path, kibibytes: u32) -> Option<Self> {
        std::fs::create_dir_all(path).unwrap();
        let disk = Self(path.to_owned());
        disk.call(
            "mount",
            &["-t", "tmpfs", "-o", &format!("size={kibibytes}k"), "tmpfs"],
        )
        .then_some(disk)
    }

    fn enlarge(&self, kibibytes: u32) {
        assert!(self.call("mount", &["-o", &format!("remount,size={kibibytes}k")]));
    }

    fn call(&self, program: &str, arguments: &[&str]) -> bool {
        let call = std::process::Command::new(program)
            .args(arguments)
            .arg(&self.0)
            .stderr(Stdio::null())
            .status();
        call.is_ok_and(|status| status.success())
    }
}

impl Drop for SmallDisk {
    fn drop(&mut self) {
        self.call("umount", &[]);
    }
}

#[cfg(target_os = "linux")]
#[test]
fn a_closed_standard_error_does_not_stop_a_run() {
    let Some(dir) = folder() else { return };
    let full = || {
        std::fs::OpenOptions::new()
            .write(true)
            .open("/dev/full")
            .unwrap()
    };
    let run = command(dir.path(), &["run", "tiny.toml", "--out", "run"])
        .stderr(full())
        .status()
        .unwrap();
    assert_eq!(run.code(), Some(0));
    run_to(dir.path(), "whole");
    assert!(table(dir.path(), "run", "errors.csv") == table(dir.path(), "whole", "errors.csv"));
    let refused = command(dir.path(), &["run", "nowhere.toml", "--out", "run"])
        .stderr(full())
        .status()
        .unwrap();
    assert_eq!(refused.code(), Some(2));
}

#[test]
fn a_full_disk_below_the_caches_costs_a_warning() {
    let Some(dir) = folder() else { return };
    let Some(disk) = SmallDisk::mount(&dir.path().join("disk"), 16) else {
        eprintln!("skipped: a small file system cannot be mounted (needs root)");
        return;
    };
    // Full to the last page, so that no page is left for the driver's shader cache.
    let _ = std::fs::write(dir.path().join("disk/fill"), vec![0; 1 << 16]);
    let mut command = command(dir.path(), &["run", "tiny.toml", "--out", "run"]);
    let output = command
        .env("XDG_CACHE_HOME", dir.path().join("disk"))
        .output()
        .unwrap();
    assert_eq!(
        output.status.code(),
        Some(0),
        "{:?}: {}",
        output.status,
        stderr(&output)
    );
    assert!(
        stderr(&output).contains("warning: cache: "),
        "{}",
        stderr(&output)
    );
    run_to(dir.path(), "whole");
    assert!(table(dir.path(), "run", "errors.csv") == table(dir.path(), "whole", "errors.csv"));
    drop(disk);
}

#[test]
fn a_full_disk_ends_the_run_and_more_room_lets_it_go_on() {
    let Some(dir) = folder() else { return };
    let Some(disk) = SmallDisk::mount(&dir.path().join("disk"), 256) else {
        eprintln!("skipped: a small file system cannot be mounted (needs root)");
        return;
    };
    assert_ends(
        &splitsum(dir.path(), &["run", "tiny.toml", "--out", "disk/run"]),
        1,
        &["No space left"],
    );
    disk.enlarge(65536);
    run_to(dir.path(), "disk/run");
    run_to(dir.path(), "whole");
    for name in ["errors.csv", "errors_by_n_dot_v.csv", "summary.md"] {
        assert!(
            table(dir.path(), "disk/run", name) == table(dir.path(), "whole", name),
            "{name} differs"
        );
    }
}
