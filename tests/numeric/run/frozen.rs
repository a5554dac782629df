//! The copy of an experiment in a run's folder can be run again.

use super::runs::{finished, read, snapshot};
use serde_json::{Value, json};
use splitsum::base::pixels::{GrayImage, RgbImage};
use splitsum::experiment::Plan;
use splitsum::experiment::plan::Source;
use splitsum::instrument::environment::LoadOptions;
use splitsum::report::publish::publish;
use splitsum::run::frozen;
use std::path::Path;

const EXPERIMENT: &str = "name = \"files\"\nsize = [16, 16]\nscene = \"ball.obj\"\nreference = { \
                          samples = 32, noise_share = 0 }\n[axes]\n\
                          environment = [\"maps/a.exr\", \"builtin:constant\"]\nmethod = \
                          [\"split-sum\"]\nalpha = [0.1, 0.5]\n";
const BALL: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\nvn 0 0 1\nf 1//1 2//1 3//1\n";

fn map(path: &Path, radiance: f32) {
    std::fs::create_dir_all(path.parent().unwrap()).unwrap();
    let (radiance, alpha) = (
        RgbImage::filled(8, 4, [radiance; 3]),
        GrayImage::filled(8, 4, 1.0),
    );
    splitsum::base::pixels::exr::write_rgba(path, &radiance, &alpha, &[]).unwrap();
}

fn load(path: &Path, set: &[&str]) -> Result<(Plan, Option<String>), String> {
    let set: Vec<String> = set.iter().map(|text| text.to_string()).collect();
    frozen::load(path, &set, &LoadOptions::default(), |_, _| {}).map_err(|error| error.to_string())
}

/// A folder with an experiment that names files, and its run in another folder, with a map from a
/// third folder.
fn made() -> (tempfile::TempDir, Plan) {
    let root = tempfile::tempdir().unwrap();
    let sweeps = root.path().join("sweeps");
    map(&sweeps.join("maps/a.exr"), 1.0);
    map(&root.path().join("others/b.exr"), 2.0);
    std::fs::write(sweeps.join("ball.obj"), BALL).unwrap();
    std::fs::write(sweeps.join("files.toml"), EXPERIMENT).unwrap();
    let (plan, _) = load(&sweeps.join("files.toml"), &[]).unwrap();
    (root, plan)
}

#[test]
fn a_frozen_experiment_makes_the_plan_of_its_run() {
    let (root, plan) = made();
    let run = finished(&plan, &root.path().join("out/runs/files"));
    let frozen = run.join("experiment.toml");
    assert!(
        read(&frozen) == EXPERIMENT.as_bytes(),
        "the text is the one that was run"
    );
    let (again, note) = load(&frozen, &[]).unwrap();
    assert_eq!(again.hash, plan.hash);
    assert!(note.unwrap().contains("the files it names are in "));
    // Run in its own folder, the copy is a finished run; run elsewhere, it keeps the paths of the
    // files.
    let before = snapshot(&run);
    finished(&again, &run);
    assert_eq!(
        read(run.join("provenance.json")),
        before["provenance.json"].0
    );
    let elsewhere = finished(&again, &root.path().join("elsewhere"));
    assert_eq!(
        load(&elsewhere.join("experiment.toml"), &[])
            .unwrap()
            .0
            .hash,
        plan.hash
    );
    // The same for a published run, and for a tree that was moved.
    publish(&run, &root.path().join("results"), false).unwrap();
    assert_eq!(
        load(&root.path().join("results/files/experiment.toml"), &[])
            .unwrap()
            .0
            .hash,
        plan.hash
    );
    let moved = tempfile::tempdir().unwrap();
    for part in ["sweeps", "out", "others"] {
        std::fs::rename(root.path().join(part), moved.path().join(part)).unwrap();
    }
    assert_eq!(
        load(&moved.path().join("out/runs/files/experiment.toml"), &[])
            .unwrap()
            .0
            .hash,
        plan.hash
    );
}

/// The command line of a published run names files, and no folder of the machine it ran on.
#[test]
fn a_published_command_line_has_no_absolute_folders() {
    let (root, plan) = made();
    let typed = [
        "/home/me/bin/splitsum",
        "run",
        "experiments/tiny.toml",
        "--set",
        "environment=/data/my maps/sky.hdr,maps/night.hdr,builtin:sky",
        "--set=environment=[\"/data/a.exr\", \"/data/b.exr\"]",
        "--set=method=split-sum,file:/home/me/own.glsl",
        "--out=/tmp/runs/tiny",
        "/",
    ];
    let shown = [
        "splitsum",
        "run",
        "experiments/tiny.toml",
        "--set",
        "environment=sky.hdr,maps/night.hdr,builtin:sky",
        "--set=environment=[\"a.exr\", \"b.exr\"]",
        "--set=method=split-sum,file:own.glsl",
        "--out=tiny",
        "/",
    ];
    let run = finished(&plan, &root.path().join("run"));
    let path = run.join("provenance.json");
    let mut record: Value = serde_json::from_slice(&std::fs::read(&path).unwrap()).unwrap();
    record["sessions"][0]["command_line"] = json!(typed);
    std::fs::write(&path, record.to_string()).unwrap();
    publish(&run, &root.path().join("results"), false).unwrap();
    let published = root.path().join("results/files/provenance.json");
    let published: Value = serde_json::from_slice(&std::fs::read(published).unwrap()).unwrap();
    assert_eq!(published["sessions"][0]["command_line"], json!(shown));
}

/// A published run names its maps by the way from its folder; not if the way leaves the folder that
/// holds all published runs, since that would name folders of the machine.
#[test]
fn a_published_run_has_no_way_to_folders_elsewhere() {
    let (root, plan) = made();
    let run = finished(&plan, &root.path().join("run"));
    let path = run.join("provenance.json");
    let mut record: Value = serde_json::from_slice(&read(&path)).unwrap();
    record["experiment_folder"] = json!("../sweeps");
    record["set_folder"] = json!("..");
    std::fs::write(&path, record.to_string()).unwrap();
    let folders = |results: &str| {
        publish(&run, &root.path().join(results), false).unwrap();
        let published = root.path().join(results).join("files/provenance.json");
        let published: Value = serde_json::from_slice(&read(&published)).unwrap();
        ["experiment_folder", "set_folder"].map(|name| published[name].clone())
    };
    assert_eq!(folders("results"), [json!("../../sweeps"), json!("../..")]);
    // A folder above is only a number of steps.
    assert_eq!(
        folders("checkout/results"),
        [Value::Null, json!("../../..")]
    );
}

#[test]
fn a_frozen_experiment_keeps_the_settings_of_the_command_line() {
    let (root, _) = made();
    let (file, maps) = (
        root.path().join("sweeps/files.toml"),
        root.path().join("others"),
    );
    let text = String::from_utf8(read(&file)).unwrap();
    let set = ["environment=b.exr".to_owned(), "alpha=0.25".to_owned()];
    let source = Source {
        set_dir: &maps,
        ..Source::new(&file, &text, &set)
    };
    let plan = Plan::from_source(&source, &LoadOptions::default())
        .unwrap_or_else(|error| panic!("{error}"));
    let run = finished(&plan, &root.path().join("run"));
    let frozen = run.join("experiment.toml");
    let (again, note) = load(&frozen, &[]).unwrap();
    assert_eq!(again.hash, plan.hash);
    assert!(
        note.unwrap()
            .contains("with --set environment=b.exr --set alpha=0.25")
    );
    let error = load(&frozen, &["alpha=0.5"]).unwrap_err();
    assert!(
        error.contains("was run with --set environment=b.exr --set alpha=0.25"),
        "{error}"
    );
}

#[test]
fn a_changed_frozen_experiment_is_refused() {
    let (root, plan) = made();
    let frozen = finished(&plan, &root.path().join("run")).join("experiment.toml");
    std::fs::write(&frozen, EXPERIMENT.replace("0.5", "0.6")).unwrap();
    let error = load(&frozen, &[]).unwrap_err();
    assert!(
        error.contains("was edited") && error.contains("copy it to another folder"),
        "{error}"
    );
}
