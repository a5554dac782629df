//! The plan file: the same bytes each time, wherever commands run, and what it refuses.

use super::{Bench, EXPERIMENT, load, log, write_environment};
use crate::run::runs::read;
use splitsum::environment::LoadOptions;
use splitsum::experiment::Plan;
use splitsum::experiment::plan::Source;
use splitsum::run::chunk::{ChunkError, PlanFile, Prices};
use std::path::Path;

#[test]
fn a_plan_file_has_the_same_bytes_each_time_and_refuses_what_changed() {
    let bench = Bench::new(0.3);
    let path = bench.path("plan.json");
    let text = String::from_utf8(read(path.clone())).unwrap();
    let again =
        PlanFile::new(&load(bench.dir.path()), bench.dir.path(), bench.file.chunk_seconds, bench.file.prices.clone());
    assert_eq!(again.text(), text);
    assert_eq!(again.id(), bench.file.id());
    let refused = |part: &str| {
        let error = PlanFile::load(&path).map(|_| ()).unwrap_err();
        assert!(error.is_misuse() && error.to_string().contains(part), "no {part:?} in {error}");
        assert_eq!(error.to_string().lines().count(), 1, "{error}");
        assert!(error.to_string().starts_with(&path.display().to_string()), "{error}");
    };
    let edited = |from: &str, to: &str, part: &str| {
        assert!(text.contains(from), "{from}");
        std::fs::write(&path, text.replacen(from, to, 1)).unwrap();
        refused(part);
    };
    edited("\"format_version\": 3", "\"format_version\": 9, \"colour\": 1", "format version 9, this program reads 3");
    edited("splitsum-plan", "shopping-list", "is not a plan file");
    edited("{", "", "expected a file that `splitsum plan --chunk-seconds` wrote");
    edited(
        &format!("\"program_version\": \"{}\"", env!("CARGO_PKG_VERSION")),
        "\"program_version\": \"0.0.9\"",
        "splitsum 0.0.9",
    );
    edited("\"shader_hash\": \"", "\"shader_hash\": \"0", "other shaders");
    edited("\"flip\": 2", "\"flip\": 7", "another version of the metric flip");
    edited(&bench.plan.cells[3].id, "0123456789abcdef", "its cells or chunks are not those");
    edited("\"chunk_seconds\": 1.3", "\"chunk_seconds\": 9.3", "its cells or chunks are not those");
    std::fs::write(&path, &text).unwrap();
    write_environment(bench.dir.path(), 2.0);
    refused("the input sky.exr has changed");
    write_environment(bench.dir.path(), 1.0);
    PlanFile::load(&path).unwrap();
    std::fs::write(bench.path("tiny.toml"), format!("{EXPERIMENT}# a comment\n")).unwrap();
    refused("tiny.toml has changed since the plan was made");
    std::fs::remove_file(bench.path("tiny.toml")).unwrap();
    refused("tiny.toml cannot be read");
}

/// The file names its experiment and the files of `--set` from its own folder: where a command runs is nothing to it, and a tree that is
/// moved as a whole keeps its plan file, byte for byte.
#[test]
fn a_plan_file_knows_its_files_from_its_own_folder() {
    let tree = |dir: &Path| {
        for folder in ["plans", "sweeps", "maps"] {
            std::fs::create_dir(dir.join(folder)).unwrap();
        }
        std::fs::write(dir.join("sweeps/tiny.toml"), EXPERIMENT.replace("\"sky.exr\", ", "")).unwrap();
        write_environment(&dir.join("maps"), 1.0);
        let (toml, set) = (dir.join("sweeps/tiny.toml"), ["environment=sky.exr".to_owned()]);
        let text = String::from_utf8(read(&toml)).unwrap();
        let source = Source { path: &toml, text: &text, overrides: &set, file_dir: None, set_dir: &dir.join("maps") };
        let plan = Plan::from_source(&source, &LoadOptions::default()).unwrap();
        let file = PlanFile::new(&plan, &dir.join("plans"), 9.0, Prices::stated(1e6));
        file.write(&dir.join("plans/plan.json")).unwrap();
        file.text()
    };
    let (here, there) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
    assert_eq!(tree(here.path()), tree(there.path()));
    assert!(tree_text(here.path()).contains("\"experiment_file\": \"../sweeps/tiny.toml\""));
    assert!(tree_text(here.path()).contains("\"set_folder\": \"../maps\""));
    PlanFile::load(&here.path().join("plans/plan.json")).unwrap();
    // Alone elsewhere it says where it looked.
    std::fs::copy(here.path().join("plans/plan.json"), here.path().join("plan.json")).unwrap();
    let error = PlanFile::load(&here.path().join("plan.json")).unwrap_err();
    assert!(error.is_misuse() && error.to_string().lines().count() == 1, "{error}");
    assert!(error.to_string().contains("paths in a plan file start at its own folder"), "{error}");
}

fn tree_text(dir: &Path) -> String {
    String::from_utf8(read(dir.join("plans/plan.json"))).unwrap()
}

#[test]
fn a_store_belongs_to_one_plan_file() {
    let bench = Bench::new(0.3);
    bench.chunk_on("fake", 0);
    let other = PlanFile::new(&bench.plan, bench.dir.path(), 7.0, bench.file.prices.clone());
    // Nor does the other one take the plan file's place; the same again does.
    let (path, before) = (bench.path("plan.json"), read(bench.path("plan.json")));
    let error = other.write(&path).unwrap_err();
    assert!(error.is_misuse() && error.to_string().contains("holds another plan"), "{error}");
    bench.file.write(&path).unwrap();
    assert!(read(&path) == before);
    let error = bench.merge_of(&other, "store").unwrap_err();
    assert!(matches!(error, ChunkError::OtherPlan { .. }) && error.is_misuse(), "{error}");
    let error = bench.merge_of(&bench.file, "nowhere").unwrap_err();
    assert!(matches!(error, ChunkError::NoStore { .. }) && !bench.path("merged").exists(), "{error}");
    let error = bench.chunk(99, &log("fake")).unwrap_err();
    let last = bench.file.chunks.len() - 1;
    assert!(error.to_string().contains(&format!("has no chunk 99; expected 0 to {last}")), "{error}");
}
