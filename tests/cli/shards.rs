//! One experiment by several processes, as a cluster would run it: side by side in one folder, one of them killed. On whatever Vulkan device
//! there is; without one the tests skip with a line.

use super::end_to_end::{EXPERIMENT, folder};
use super::{assert_ends, command, entries, ok, splitsum, stderr, stdout};
use std::path::Path;
use std::process::{Child, Stdio};
use std::time::{Duration, Instant};

fn spawn(dir: &Path, shard: &str) -> Child {
    let arguments = ["run", "tiny.toml", "--shard", shard, "--out", "shared"];
    command(dir, &arguments).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap()
}

#[test]
fn shards_side_by_side_killed_and_repeated_make_the_run_of_one_process() {
    let Some(dir) = folder() else { return };
    let dir = dir.path();
    std::fs::write(dir.join("tiny.toml"), format!("{EXPERIMENT}[timing]\nrounds = 3\nwarmup = 1\n")).unwrap();
    ok(dir, &["run", "tiny.toml", "--out", "whole"]);

    // Killed at work: after its first record where that can be met.
    let mut killed = spawn(dir, "1/3");
    let deadline = Instant::now() + Duration::from_secs(20);
    let has_record = || std::fs::read_dir(dir.join("shared/cells")).is_ok_and(|mut entries| entries.next().is_some());
    while !has_record() && killed.try_wait().unwrap().is_none() && Instant::now() < deadline {
        std::thread::sleep(Duration::from_millis(1));
    }
    let _ = killed.kill();
    killed.wait().unwrap();
    let merge = splitsum(dir, &["merge", "shared"]);
    let again = "splitsum run shared/experiment.toml --out shared --shard 2/3";
    assert_ends(&merge, 4, &["are missing:", &format!("shard 2/3, never started: {again}")]);

    // Twice the same shard and another beside it; the third from another folder.
    for child in [spawn(dir, "1/3"), spawn(dir, "2/3"), spawn(dir, "1/3")] {
        let output = child.wait_with_output().unwrap();
        match output.status.code() {
            Some(75) => assert!(stderr(&output).contains("shard 1/3 is using it"), "{}", stderr(&output)),
            code => assert_eq!(code, Some(0), "{}", stderr(&output)),
        }
    }
    std::fs::create_dir(dir.join("elsewhere")).unwrap();
    let text =
        ok(&dir.join("elsewhere"), &["run", "../shared/experiment.toml", "--shard", "3/3", "--out", "../shared"]);
    assert!(text.starts_with("Shard 3/3 is done: "), "{text}");
    let merge = splitsum(dir, &["merge", "shared"]);
    assert_ends(&merge, 0, &[]);
    let text = stdout(&merge);
    assert!(
        text.contains("break-even") && text.contains("Written to shared") && text.contains("report.html"),
        "{text}"
    );
    for name in ["errors.csv", "errors_by_n_dot_v.csv", "images.csv", "experiment.toml", "tables/ggx.png"] {
        let read = |out: &str| std::fs::read(dir.join(out).join(name)).unwrap();
        assert!(read("shared") == read("whole"), "{name} differs");
    }
    assert_eq!(entries(&dir.join("shared/images")), entries(&dir.join("whole/images")));

    // The folder is a run like any other.
    let output = splitsum(dir, &["run", "tiny.toml", "--out", "shared"]);
    assert!(output.status.success() && !stderr(&output).contains("[1/"), "{}", stderr(&output));
}

/// Elsewhere than on a terminal work says every few seconds that it goes on.
#[test]
fn long_work_shows_signs_of_life() {
    let Some(dir) = folder() else { return };
    let long = ["render", "--method", "reference", "--samples", "65536", "--size", "1024x1024", "--out", "x.exr"];
    let mut child = command(dir.path(), &long).stderr(Stdio::piped()).spawn().unwrap();
    let mut lines = std::io::BufRead::lines(std::io::BufReader::new(child.stderr.take().unwrap())).map(Result::unwrap);
    let found = lines.find(|line| line.starts_with("rendering: "));
    child.kill().unwrap();
    child.wait().unwrap();
    assert!(found.is_some_and(|line| line.contains("second")), "no line");
    // Short work says nothing.
    let begun = std::time::Instant::now();
    let output = splitsum(dir.path(), &["render", "--size", "8x8", "--method", "split-sum", "--out", "x.exr"]);
    let is_short = begun.elapsed().as_secs_f64() < 1.0;
    assert!(output.status.success() && (stderr(&output).is_empty() || !is_short), "{}", stderr(&output));
}
