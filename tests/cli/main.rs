//! The binary as a user runs it: messages, exit codes, files.

#![expect(
    clippy::too_many_lines,
    reason = "a test states its cases and follows one scenario"
)]

mod bad_input;
mod cases;
mod check_bake;
mod check_shader;
mod cost;
mod edited_shaders;
mod end_to_end;
mod faults;
mod growth;
mod hostile;
mod integrate;
#[cfg(unix)]
mod interruptions;
mod kept;
#[path = "../shared/scratch.rs"]
mod scratch;
#[cfg(unix)]
mod shards;
#[path = "../shared/snapshot.rs"]
mod snapshot;

use snapshot::{assert_snapshot, without_lists};
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::sync::LazyLock;
use std::time::SystemTime;

fn splitsum(dir: &Path, arguments: &[&str]) -> Output {
    command(dir, arguments).output().expect("the binary starts")
}

fn command(dir: &Path, arguments: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_splitsum"));
    command.current_dir(dir).args(arguments);
    // One cache for all tests, as one user's runs share one, but not the user's own.
    command
        .env("XDG_CACHE_HOME", &*CACHE_HOME)
        .env_remove("LOCALAPPDATA")
        .env_remove("HOME");
    command
}

/// Empty when the tests begin.
static CACHE_HOME: LazyLock<PathBuf> = LazyLock::new(scratch::scratch);

fn stdout(output: &Output) -> String {
    String::from_utf8_lossy(&output.stdout).into_owned()
}

fn stderr(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

/// The output of a command that must succeed.
fn ok(dir: &Path, arguments: &[&str]) -> String {
    let output = splitsum(dir, arguments);
    assert!(output.status.success(), "{}", stderr(&output));
    stdout(&output)
}

/// Checks exit code and parts of the message, and that there is no panic.
fn assert_ends(output: &Output, code: i32, parts: &[&str]) {
    let message = stderr(output);
    assert_eq!(output.status.code(), Some(code), "{message}");
    for part in parts {
        assert!(message.contains(part), "no {part:?} in {message}");
    }
    assert!(!message.contains("panicked"), "{message}");
}

fn golden() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/golden")
}

fn entries(dir: &Path) -> Vec<String> {
    let mut names: Vec<String> = std::fs::read_dir(dir)
        .unwrap()
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .collect();
    names.sort();
    names
}

#[derive(PartialEq)]
struct FileState {
    name: String,
    bytes: Option<u64>,
    modified: Option<SystemTime>,
}

/// The files in a folder, in the order of their names.
fn files(dir: &Path) -> Vec<FileState> {
    let state = |name: String| {
        let data = std::fs::metadata(dir.join(&name)).ok();
        FileState {
            bytes: data.as_ref().map(|data| data.len()),
            modified: data.and_then(|data| data.modified().ok()),
            name,
        }
    };
    entries(dir).into_iter().map(state).collect()
}

/// Runs a command that must be refused, without a panic or a change of the folder. Returns its exit
/// code and message: `[2] e.toml: ...`.
fn refusal(dir: &Path, line: &str) -> String {
    let before = files(dir);
    let output = splitsum(dir, &line.split_whitespace().collect::<Vec<_>>());
    let message = stderr(&output).replace(&dir.display().to_string(), "DIR");
    let code = output.status.code().unwrap();
    assert!(
        [1, 2, 3].contains(&code) && !message.contains("panicked"),
        "{line}: {code} {message}"
    );
    assert!(
        !message.trim().is_empty() && files(dir) == before,
        "{line}: {message}"
    );
    // Whether progress is shown depends on the machine.
    let lines = message
        .lines()
        .filter(|line| !line.is_empty() && !line.contains(" seconds"));
    let lines: Vec<String> = lines.map(without_lists).collect();
    format!("[{code}] {}", lines.join("\n    "))
}

/// Runs commands that must be refused; the snapshot has exit codes and messages.
fn assert_refusals(name: &str, dir: &Path, commands: &[&str]) {
    let shown = commands
        .iter()
        .map(|line| format!("$ {line}\n{}\n", refusal(dir, line)));
    assert_snapshot(name, &shown.collect::<Vec<_>>().join("\n"));
}

/// A copy of a published run, in a folder of the same name.
fn published(root: &Path, name: &str) -> PathBuf {
    let (from, dir) = (
        Path::new(env!("CARGO_MANIFEST_DIR")).join("results/timing"),
        root.join(name),
    );
    std::fs::create_dir(&dir).unwrap();
    for entry in std::fs::read_dir(from)
        .unwrap()
        .map(Result::unwrap)
        .filter(|entry| entry.path().is_file())
    {
        std::fs::copy(entry.path(), dir.join(entry.file_name())).unwrap();
    }
    dir
}
