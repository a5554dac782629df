//! A folder that lasts as long as this process.

use std::path::PathBuf;
use std::process::{Command, Stdio};

/// Makes an empty folder, which is removed when this process ends, however it ends.
pub fn scratch() -> PathBuf {
    let folder = tempfile::tempdir().unwrap().keep();
    // The pipe closes with this process.
    let mut remover = Command::new("sh")
        .args(["-c", r#"trap '' INT HUP; cat >/dev/null; rm -rf "$1""#, "sh"])
        .arg(&folder)
        .stdin(Stdio::piped())
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    std::mem::forget(remover.stdin.take());
    folder
}
