//! The binary as a user runs it: messages, exit codes, files.

mod bad_input;
mod cache;
mod check_bake;
mod cost;
mod end_to_end;
mod faults;
mod growth;
mod hostile;
mod integrate;
#[cfg(unix)]
mod interruptions;
#[path = "../shared/scratch.rs"]
mod scratch;
#[cfg(unix)]
mod shards;
mod soak;

use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::sync::LazyLock;

/// The binary with these arguments, run in `dir`.
fn splitsum(dir: &Path, arguments: &[&str]) -> Output {
    command(dir, arguments).output().expect("the binary starts")
}

fn command(dir: &Path, arguments: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_splitsum"));
    command.current_dir(dir).args(arguments);
    // One cache for all tests, as a user has one for all runs, and not the user's.
    command.env("XDG_CACHE_HOME", &*CACHE_HOME).env_remove("LOCALAPPDATA").env_remove("HOME");
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

/// What a command that must succeed prints.
fn ok(dir: &Path, arguments: &[&str]) -> String {
    let output = splitsum(dir, arguments);
    assert!(output.status.success(), "{}", stderr(&output));
    stdout(&output)
}

/// An exit code, parts of the message, and no panic.
fn assert_ends(output: &Output, code: i32, parts: &[&str]) {
    let message = stderr(output);
    assert_eq!(output.status.code(), Some(code), "{message}");
    for part in parts {
        assert!(message.contains(part), "no {part:?} in {message}");
    }
    assert!(!message.contains("panicked"), "{message}");
}

/// Files and folders directly in `dir`.
fn entries(dir: &Path) -> Vec<String> {
    let mut names: Vec<String> =
        std::fs::read_dir(dir).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    names
}
