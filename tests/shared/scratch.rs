//! A folder that is removed when this process ends.

use std::path::PathBuf;
use std::process::{Child, Command, Stdio};
use std::sync::Mutex;

/// Each child removes a folder when its pipe closes with this process.
static REMOVERS: Mutex<Vec<Child>> = Mutex::new(Vec::new());

/// Makes an empty folder, which is removed however this process ends.
pub fn scratch() -> PathBuf {
    let folder = tempfile::tempdir().unwrap().keep();
    let remover = Command::new("sh")
        .args([
            "-c",
            r#"trap '' INT HUP; cat >/dev/null; rm -rf "$1""#,
            "sh",
        ])
        .arg(&folder)
        .stdin(Stdio::piped())
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    REMOVERS.lock().unwrap().push(remover);
    folder
}
