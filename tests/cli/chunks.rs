//! One experiment in chunks, as a cluster would run it: processes side by side on one folder, one of them killed. On whatever Vulkan
//! device there is; without one the tests skip with a line.

use super::end_to_end::{EXPERIMENT, folder};
use super::{command, ok, splitsum, stderr, stdout};
use std::path::Path;
use std::process::{Child, Stdio};
use std::time::{Duration, Instant};

/// A folder with an experiment, its plan file and the number of chunks.
fn planned() -> Option<(tempfile::TempDir, usize)> {
    let dir = folder()?;
    std::fs::write(dir.path().join("tiny.toml"), format!("{EXPERIMENT}[timing]\nrounds = 3\nwarmup = 1\n")).unwrap();
    let output = splitsum(dir.path(), &["plan", "tiny.toml", "--chunk-seconds", "1.02", "--out", "plan.json"]);
    assert!(output.status.success(), "{}", stderr(&output));
    assert!(!dir.path().join("runs").exists(), "a plan makes its file only");
    let plan: serde_json::Value =
        serde_json::from_slice(&std::fs::read(dir.path().join("plan.json")).unwrap()).unwrap();
    let count = plan["chunks"].as_array().unwrap().len();
    assert!(count >= 3, "{}", stdout(&output));
    Some((dir, count))
}

fn spawn(dir: &Path, chunk: usize) -> Child {
    let chunk = chunk.to_string();
    let arguments = ["run", "--plan", "plan.json", "--chunk", &chunk, "--store", "store"];
    command(dir, &arguments).stdout(Stdio::null()).stderr(Stdio::piped()).spawn().unwrap()
}

/// Exit code and messages of a merge.
fn merge(dir: &Path) -> (Option<i32>, String) {
    let output = splitsum(dir, &["merge", "--plan", "plan.json", "--store", "store"]);
    (output.status.code(), stdout(&output) + &stderr(&output))
}

/// A record that an attempt at a chunk has left, once there is one.
fn first_record(dir: &Path, chunk: usize) -> Option<std::path::PathBuf> {
    let attempts = std::fs::read_dir(dir.join(format!("store/chunks/{chunk:05}"))).ok()?.flatten();
    let mut records =
        attempts.flat_map(|attempt| std::fs::read_dir(attempt.path().join("cells")).into_iter().flatten());
    records.find_map(|record| Some(record.ok()?.path()).filter(|path| path.extension().is_some_and(|e| e == "json")))
}

#[test]
fn chunks_side_by_side_killed_and_repeated_make_the_run_of_one_machine() {
    let Some((dir, count)) = planned() else { return };
    let dir = dir.path();
    assert!(splitsum(dir, &["run", "tiny.toml", "--out", "whole"]).status.success());

    // Killed at work: after its first record where that can be met.
    let mut killed = spawn(dir, 0);
    let deadline = Instant::now() + Duration::from_secs(20);
    while first_record(dir, 0).is_none() && killed.try_wait().unwrap().is_none() && Instant::now() < deadline {
        std::thread::sleep(Duration::from_millis(1));
    }
    let _ = killed.kill();
    killed.wait().unwrap();
    let (code, text) = merge(dir);
    assert_eq!(code, Some(4), "{text}");
    assert!(text.contains("  chunk 1 (never begun): "), "{text}");
    assert!(text.contains("splitsum run --plan plan.json --chunk 1 --store store"), "{text}");

    // Twice the same chunk and another beside it.
    for child in [spawn(dir, 0), spawn(dir, 1), spawn(dir, 0)] {
        let output = child.wait_with_output().unwrap();
        assert!(output.status.success(), "{}", stderr(&output));
    }
    // From another folder: the plan file knows its files from its own.
    std::fs::create_dir(dir.join("elsewhere")).unwrap();
    for chunk in 2..count {
        let chunk = chunk.to_string();
        let arguments = ["run", "--plan", "../plan.json", "--chunk", &chunk, "--store", "../store"];
        ok(&dir.join("elsewhere"), &arguments);
    }
    let (code, text) = merge(dir);
    assert_eq!(code, Some(0), "{text}");
    assert!(text.contains("break-even") && text.contains("Written to store") && text.contains("report.html"), "{text}");
    for name in ["errors.csv", "errors_by_n_dot_v.csv", "images.csv", "experiment.toml", "tables/ggx.png"] {
        let read = |out: &str| std::fs::read(dir.join(out).join(name)).unwrap();
        assert!(read("store") == read("whole"), "{name} differs");
    }

    // The merged folder is a run like any other.
    let output = splitsum(dir, &["run", "tiny.toml", "--out", "store"]);
    assert!(output.status.success() && !stderr(&output).contains("[1/"), "{}", stderr(&output));
}

#[test]
fn a_plan_file_that_does_not_fit_is_refused_before_work() {
    let dir = tempfile::tempdir().unwrap();
    let dir = dir.path();
    std::fs::write(dir.join("tiny.toml"), EXPERIMENT).unwrap();
    let refused = |arguments: &[&str], parts: &[&str]| {
        let output = splitsum(dir, arguments);
        assert_eq!(output.status.code(), Some(2), "{arguments:?}: {}", stderr(&output));
        for part in parts {
            assert!(stderr(&output).contains(part), "no {part:?} in {}", stderr(&output));
        }
        assert!(!dir.join("store").exists());
    };
    let chunk = ["run", "--plan", "plan.json", "--chunk", "0", "--store", "store"];
    refused(&chunk, &["plan.json: cannot be read"]);
    for (name, set) in [("plan.json", "brdf=ggx"), ("again.json", "brdf=ggx"), ("other.json", "brdf=phong")] {
        let arguments = ["plan", "./tiny.toml", "--chunk-seconds", "60", "--out", name, "--set", set];
        assert!(splitsum(dir, &arguments).status.success());
    }
    let read = |name: &str| std::fs::read(dir.join(name)).unwrap();
    assert!(read("plan.json") == read("again.json") && read("plan.json") != read("other.json"));
    refused(&["run", "--plan", "plan.json", "--chunk", "5", "--store", "store"], &["has no chunk 5; expected 0 to 0"]);
    refused(&["run", "--plan", "plan.json", "--chunk", "0"], &["--store <DIR>"]);
    refused(&["run", "tiny.toml", "--chunk", "0", "--store", "store"], &["cannot be used with"]);
    refused(&["run", "tiny.toml", "--plan", "plan.json", "--chunk", "0", "--store", "store"], &["cannot be used with"]);
    refused(&["plan", "tiny.toml", "--chunk-seconds", "0", "--out", "x.json"], &["expected a number above 0"]);
    refused(&["plan", "tiny.toml", "--chunk-seconds", "60"], &["--out <PATH>"]);
    let chunks = ["plan", "tiny.toml", "--chunk-seconds", "60", "--out", "x.json"];
    refused(&[chunks.as_slice(), &["--from", "."]].concat(), &["--from", "cannot be used with"]);
    refused(&["merge", "--plan", "plan.json", "--store", "store"], &["store: holds no chunk of this plan"]);
    std::fs::write(dir.join("tiny.toml"), EXPERIMENT.replace("samples = 64", "samples = 65")).unwrap();
    refused(&chunk, &["tiny.toml has changed since the plan was made; make the plan again"]);
}
