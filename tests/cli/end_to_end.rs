//! A tiny experiment through the binary, on any Vulkan device. Without one the tests skip with a
//! line.

use super::{assert_ends, command, entries, ok, splitsum, stderr, stdout};
use std::io::{BufRead, BufReader};
use std::path::Path;
use std::process::Stdio;

pub(super) const EXPERIMENT: &str = r#"
name = "tiny"
question = "Does everything run?"
size = [32, 32]
reference = { samples = 64, noise_share = 0 }
[axes]
environment = ["builtin:gradient"]
brdf = ["ggx", "phong"]
alpha = [0.25, 1.0]
method = ["sampled", "split-sum"]
samples = [4, 16]
diffuse = ["none"]
f0 = [1]
albedo = [0]
exposure = [1, 5]
[precompute]
prefilter_size = [16, 16]
prefilter_level_count = 2
prefilter_sample_count = 16
dfg_size = 16
dfg_sample_count = 64
"#;
const CELLS: usize = 2 * 2 * 3 * 2;

/// Whether there is a device; without one, prints a line.
pub(super) fn has_device() -> bool {
    let found = splitsum(Path::new("."), &["devices"]).status.success();
    if !found {
        eprintln!("skipped: no Vulkan device");
    }
    found
}

/// A folder with the experiment; `None` without a device.
pub(super) fn folder() -> Option<tempfile::TempDir> {
    if !has_device() {
        return None;
    }
    let dir = tempfile::tempdir().unwrap();
    std::fs::write(dir.path().join("tiny.toml"), EXPERIMENT).unwrap();
    Some(dir)
}

fn errors(dir: &Path) -> Vec<u8> {
    std::fs::read(dir.join("runs/tiny/errors.csv")).unwrap()
}

#[test]
fn a_run_leaves_the_documented_files_and_a_second_run_changes_nothing() {
    let Some(dir) = folder() else { return };
    let output = splitsum(dir.path(), &["run", "tiny.toml"]);
    assert!(output.status.success(), "{}", stderr(&output));
    let text = stdout(&output);
    assert!(
        text.contains("break-even") && text.contains("Written to runs/tiny"),
        "{text}"
    );
    assert!(
        stderr(&output).contains(&format!("[{CELLS}/{CELLS}]")),
        "{}",
        stderr(&output)
    );
    let run = dir.path().join("runs/tiny");
    for name in [
        "experiment.toml",
        "provenance.json",
        "errors.csv",
        "errors_by_n_dot_v.csv",
        "images",
        "tables",
        "summary.md",
    ] {
        assert!(
            entries(&run).contains(&name.to_owned()),
            "no {name} in {:?}",
            entries(&run)
        );
    }
    assert_eq!(entries(&run.join("tables")), ["ggx.svg", "phong.svg"]);
    let before = errors(dir.path());
    assert_eq!(
        before.iter().filter(|byte| **byte == b'\n').count(),
        CELLS + 1
    );

    let again = splitsum(dir.path(), &["run", "tiny.toml"]);
    assert!(again.status.success());
    assert_eq!(stdout(&again), text);
    assert!(errors(dir.path()) == before);

    // The folder alone suffices to answer again.
    let summary = std::fs::read(run.join("summary.md")).unwrap();
    std::fs::remove_dir_all(run.join("answers")).unwrap();
    ok(
        dir.path(),
        &["answers", "runs/tiny", "--publish", "results"],
    );
    assert!(
        run.join("answers/break-even.svg").exists()
            && std::fs::read(run.join("summary.md")).unwrap() == summary
    );
    assert!(entries(&dir.path().join("results/tiny")).contains(&"ggx.svg".to_owned()));
    assert!(
        std::fs::read_to_string(dir.path().join("results/README.md"))
            .unwrap()
            .contains("[tiny](tiny/summary.md)")
    );
    // A sheet of more than a megabyte is named in place of the link.
    let sheet = run.join("tables/ggx.svg");
    let padded = std::fs::read_to_string(&sheet).unwrap() + &" ".repeat(1 << 20);
    std::fs::write(&sheet, padded).unwrap();
    ok(
        dir.path(),
        &["answers", "runs/tiny", "--publish", "results"],
    );
    assert!(!dir.path().join("results/tiny/ggx.svg").exists());
    let published = std::fs::read_to_string(dir.path().join("results/tiny/summary.md")).unwrap();
    assert!(
        published.contains("Too large to be published: ggx.svg (1.")
            && !published.contains("Contact sheet"),
        "{published}"
    );
    // All files of a run use one metric, the report included.
    for (metric, arguments) in [("flip", &["--metric", "flip"][..]), ("relmse", &[])] {
        ok(dir.path(), &[&["answers", "runs/tiny"], arguments].concat());
        let read = |name: &str| std::fs::read_to_string(run.join(name)).unwrap();
        assert!(
            read("report.html").contains(&format!("\"headline\":\"{metric}\"")),
            "{metric}"
        );
        assert!(
            read("summary.md").contains(&format!("`{metric}`")),
            "{metric}"
        );
    }
    let plan = stdout(&splitsum(dir.path(), &["plan", "tiny.toml"]));
    assert!(
        plan.contains(&format!("{CELLS} done, 0 failed, 0 open")),
        "{plan}"
    );
}

/// Whether a run is done depends on its folder's place, which summary and provenance name.
#[test]
fn a_run_that_was_moved_names_its_new_folder() {
    let Some(dir) = folder() else { return };
    ok(dir.path(), &["run", "tiny.toml"]);
    let [old, new] = ["runs/tiny", "runs/moved"].map(|name| dir.path().join(name));
    std::fs::rename(old, &new).unwrap();
    let again = splitsum(dir.path(), &["run", "tiny.toml", "--out", "runs/moved"]);
    assert!(again.status.success(), "{}", stderr(&again));
    let text = stdout(&again);
    assert!(
        text.contains("Written to runs/moved") && !text.contains("runs/tiny"),
        "{text}"
    );
}

#[test]
fn a_finished_run_is_answered_and_published_when_nobody_uses_its_folder() {
    let Some(dir) = folder() else { return };
    ok(dir.path(), &["run", "tiny.toml", "--set", "brdf=ggx"]);
    let run = dir.path().join("runs/tiny");
    std::fs::remove_dir_all(run.join("answers")).unwrap();
    // As if a run held the lock.
    let lock = std::fs::File::options()
        .write(true)
        .open(run.join(".lock"))
        .unwrap();
    lock.lock().unwrap();
    let publish = ["answers", "runs/tiny", "--publish", "results"];
    assert_ends(
        &splitsum(dir.path(), &publish),
        2,
        &["runs/tiny: a run is using the folder"],
    );
    assert!(!run.join("answers").exists());
    assert!(!dir.path().join("results").exists());
    lock.unlock().unwrap();
    // Publishing the same run again works; another plan needs `--replace`.
    for _ in 0..2 {
        ok(
            dir.path(),
            &["answers", "runs/tiny", "--publish", "results"],
        );
    }
    ok(
        dir.path(),
        &[
            "run",
            "tiny.toml",
            "--set",
            "brdf=phong",
            "--out",
            "runs/other",
        ],
    );
    let publish = ["answers", "runs/other", "--publish", "results"];
    let output = splitsum(dir.path(), &publish);
    assert_eq!(output.status.code(), Some(2), "{}", stderr(&output));
    assert!(
        stderr(&output).starts_with(
            "results/tiny: contains a published run of another plan than runs/other; give --replace"
        ),
        "{}",
        stderr(&output)
    );
    ok(dir.path(), &[publish.as_slice(), &["--replace"]].concat());
}

#[cfg(unix)]
#[test]
fn ctrl_c_and_a_kill_stop_after_a_cell_and_the_next_run_goes_on() {
    ["-INT", "-TERM"].into_iter().for_each(stops_after_a_cell);
}

#[cfg(unix)]
fn stops_after_a_cell(signal: &str) {
    let Some(dir) = folder() else { return };
    let mut child = command(dir.path(), &["run", "tiny.toml"])
        .stdout(Stdio::null())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let mut lines = BufReader::new(child.stderr.take().unwrap())
        .lines()
        .map(Result::unwrap);
    let first = lines
        .find(|line| line.starts_with("[1/"))
        .expect("a first cell");
    assert!(first.contains("brdf=ggx"), "{first}");
    let kill = std::process::Command::new("sh")
        .args(["-c", "kill $1 $0", &child.id().to_string(), signal])
        .status()
        .unwrap();
    assert!(kill.success());
    let rest: Vec<String> = lines.collect();
    assert_eq!(child.wait().unwrap().code(), Some(1), "{rest:#?}");
    assert!(
        rest.iter()
            .any(|line| line.starts_with("stopped; to go on: ") && line.ends_with("run tiny.toml")),
        "{rest:#?}"
    );
    let done = errors(dir.path())
        .iter()
        .filter(|byte| **byte == b'\n')
        .count()
        - 1;
    assert!((1..CELLS).contains(&done), "{done} cells were done");

    let output = splitsum(dir.path(), &["run", "tiny.toml"]);
    assert!(output.status.success(), "{}", stderr(&output));
    assert!(
        stderr(&output).contains(&format!("{done} of {CELLS} steps are done already")),
        "{}",
        stderr(&output)
    );
    let whole = splitsum(dir.path(), &["run", "tiny.toml", "--out", "runs/whole"]);
    assert!(whole.status.success());
    assert!(errors(dir.path()) == std::fs::read(dir.path().join("runs/whole/errors.csv")).unwrap());
}

#[test]
fn compare_reads_the_files_of_render() {
    let Some(dir) = folder() else { return };
    let render = |method: &str, out: &str| {
        let arguments = [
            "render",
            "--size",
            "32x32",
            "--environment",
            "builtin:gradient",
            "--alpha",
            "0.5",
            "--method",
            method,
        ];
        ok(
            dir.path(),
            &[arguments.as_slice(), &["--out", out]].concat(),
        );
    };
    render("sampled", "a.exr");
    render("split-sum", "b.EXR");
    render("sampled", "c.png");
    let scores = |arguments: &[&str]| -> serde_json::Value {
        serde_json::from_str(&ok(
            dir.path(),
            &[&["compare", "--json"], arguments].concat(),
        ))
        .unwrap()
    };
    let equal = scores(&["a.exr", "a.exr"]);
    assert_eq!(
        (&equal["rmse"], &equal["flip"]),
        (&serde_json::json!(0.0), &serde_json::json!(0.0))
    );
    let different = scores(&["b.EXR", "a.exr"]);
    assert_eq!(
        different.as_object().unwrap().len(),
        splitsum::instrument::metrics::METRICS.len()
    );
    // Brighter light has a larger ε; without contrast all is white.
    let bright = scores(&[
        "b.EXR",
        "a.exr",
        "--environment-mean",
        "3",
        "--contrast",
        "0.01",
    ]);
    assert!(
        bright["flip"].as_f64().unwrap() < 0.05 * different["flip"].as_f64().unwrap(),
        "{bright}"
    );
    for (name, is_less) in [("relmse", true), ("rmse", false)] {
        assert_eq!(
            bright[name].as_f64().unwrap() < different[name].as_f64().unwrap(),
            is_less,
            "{name}"
        );
    }
}

/// README's first picture, whose options are in the script that made it, is what the program
/// renders today.
#[test]
fn the_first_picture_of_the_readme_is_current() {
    const SIDE: u32 = 400;
    let (root, dir) = (
        Path::new(env!("CARGO_MANIFEST_DIR")),
        tempfile::tempdir().unwrap(),
    );
    let script = std::fs::read_to_string(root.join("scripts/pictures.sh"))
        .unwrap()
        .replace("\\\n", "");
    let between = |from: &str, to: &str| {
        script
            .split_once(from)
            .unwrap()
            .1
            .split_once(to)
            .unwrap()
            .0
            .to_owned()
    };
    let options =
        between("\"$program\" render ", "--out") + &between("--method \"$method\" ", "\"$@\"");
    let arguments = ["render", "--method", "split-sum-two", "--out", "ball.png"].into_iter();
    ok(
        dir.path(),
        &arguments
            .chain(options.split_whitespace())
            .collect::<Vec<_>>(),
    );
    let [own, shown] = [dir.path().join("ball.png"), root.join("docs/effect.png")]
        .map(|file| image::open(&file).unwrap().into_rgb8());
    assert_eq!(own.dimensions(), (SIDE, SIDE));
    // The second of three.
    let off = |i: u32| {
        let (own, shown) = (
            own.get_pixel(i % SIDE, i / SIDE),
            shown.get_pixel(SIDE + i % SIDE, i / SIDE),
        );
        (0..3)
            .map(|c| f64::from(own[c].abs_diff(shown[c])))
            .sum::<f64>()
            / 3.0
    };
    let mean = (0..SIDE * SIDE).map(off).sum::<f64>() / f64::from(SIDE * SIDE);
    assert!(
        mean < 0.2,
        "{mean} of 255 on average: run scripts/pictures.sh and look"
    );
}
