//! One experiment by several processes in one folder, on any Vulkan device; without one the tests
//! skip with a line.

use super::end_to_end::{EXPERIMENT, folder};
use super::{assert_ends, command, entries, ok, splitsum, stderr};
use std::process::Stdio;

#[test]
fn shards_make_the_run_of_one_process() {
    let Some(dir) = folder() else { return };
    let dir = dir.path();
    std::fs::write(
        dir.join("tiny.toml"),
        format!("{EXPERIMENT}[timing]\nrounds = 3\nwarmup = 1\n"),
    )
    .unwrap();
    ok(dir, &["run", "tiny.toml", "--out", "whole"]);
    ok(
        dir,
        &["run", "tiny.toml", "--shard", "1/2", "--out", "shared"],
    );
    let again = "splitsum run shared/experiment.toml --out shared --shard 2/2";
    let missing = [
        "are missing:",
        &format!("shard 2/2, never started: {again}"),
    ];
    assert_ends(&splitsum(dir, &["merge", "shared"]), 4, &missing);
    // The second shard starts in another folder.
    std::fs::create_dir(dir.join("elsewhere")).unwrap();
    let text = ok(
        &dir.join("elsewhere"),
        &[
            "run",
            "../shared/experiment.toml",
            "--shard",
            "2/2",
            "--out",
            "../shared",
        ],
    );
    assert!(text.starts_with("Shard 2/2 is done: "), "{text}");
    let text = ok(dir, &["merge", "shared"]);
    assert!(
        text.contains("break-even") && text.contains("Written to shared"),
        "{text}"
    );
    for name in [
        "errors.csv",
        "errors_by_n_dot_v.csv",
        "images.csv",
        "experiment.toml",
        "tables/ggx.svg",
    ] {
        let read = |out: &str| std::fs::read(dir.join(out).join(name)).unwrap();
        assert!(read("shared") == read("whole"), "{name} differs");
    }
    assert_eq!(
        entries(&dir.join("shared/images")),
        entries(&dir.join("whole/images"))
    );
    // The frames of a model are timed together: without the record of one all three count as open.
    let timings = dir.join("whole/timings");
    let is_frame = |name: &String| {
        std::fs::read_to_string(timings.join(name))
            .unwrap()
            .contains("\"frame\"")
    };
    let frame = entries(&timings).into_iter().find(is_frame).unwrap();
    std::fs::remove_file(timings.join(frame)).unwrap();
    let plan = ok(dir, &["plan", "tiny.toml", "--out", "whole"]);
    assert!(
        plan.contains("\n10 configurations are timed; 7 done\n"),
        "{plan}"
    );
}

/// Without a terminal, long work prints a line every few seconds.
#[test]
fn long_work_shows_signs_of_life() {
    let Some(dir) = folder() else { return };
    let long = [
        "render",
        "--method",
        "reference",
        "--samples",
        "65536",
        "--size",
        "1024x1024",
        "--out",
        "x.exr",
    ];
    let mut child = command(dir.path(), &long)
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let mut lines = std::io::BufRead::lines(std::io::BufReader::new(child.stderr.take().unwrap()))
        .map(Result::unwrap);
    let found = lines.find(|line| line.starts_with("rendering: "));
    child.kill().unwrap();
    child.wait().unwrap();
    assert!(found.is_some_and(|line| line.contains("second")), "no line");
    // Short work prints no progress.
    let begun = std::time::Instant::now();
    let output = splitsum(
        dir.path(),
        &[
            "render",
            "--size",
            "8x8",
            "--method",
            "split-sum",
            "--out",
            "x.exr",
        ],
    );
    let is_short = begun.elapsed().as_secs_f64() < 1.0;
    assert!(
        output.status.success() && (stderr(&output).is_empty() || !is_short),
        "{}",
        stderr(&output)
    );
}
