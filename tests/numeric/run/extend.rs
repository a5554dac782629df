//! Runs that become the beginning of a larger plan.

use super::run::EXPERIMENT;
use super::runs::{Bench, contents, extend, fakes, finished, invoke, log, options, plan, read, snapshot, summary};
use splitsum::experiment::Plan;
use splitsum::run::store::Store;
use splitsum::run::{MakeRenderer, Progress, RunError, run, timing};
use std::collections::BTreeMap;
use std::path::Path;
use std::sync::atomic::AtomicBool;

/// What a run leaves but what tells of its invocations, records without the time they took among it.
fn left(dir: &Path) -> BTreeMap<String, Vec<u8>> {
    let is_same = |name: &String| {
        let told = ["provenance.json", "summary.md", "trace.json", ".lock"].contains(&name.as_str());
        let timed =
            ["cells/", "timings", "timing_", "experiment.", "answers/"].iter().any(|start| name.starts_with(start));
        !told && !timed
    };
    contents(dir).into_iter().filter(|(name, _)| is_same(name)).collect()
}

fn assert_like_whole(dir: &Path, plan: &Plan) {
    let whole = tempfile::tempdir().unwrap();
    finished(plan, whole.path());
    let (found, due) = (left(dir), left(whole.path()));
    assert_eq!(found.keys().collect::<Vec<_>>(), due.keys().collect::<Vec<_>>());
    for (name, bytes) in &due {
        assert!(found[name] == *bytes, "{name} differs");
    }
    assert!(read(dir.join("errors.csv")) == read(whole.path().join("errors.csv")));
    for cell in &plan.cells {
        let record = |dir: &Path| Store::at(dir).whole_cell(&cell.id).unwrap().expect("a record");
        let [mut found, due] = [record(dir), record(whole.path())];
        found.spent = due.spent.clone();
        assert_eq!(found, due);
    }
}

#[test]
fn an_extended_run_keeps_what_is_done_and_ends_like_one_of_the_whole_plan() {
    let whole = plan(EXPERIMENT);
    // More values of an axis that is swept; one that begins to be swept; a tone curve, whose maps every cell needs.
    let parts = [
        ("[1, 4, 16]", "[4, 16]", 4 + 4, true),
        ("[\"ggx\", \"phong\"]", "[\"phong\"]", 2 * 5, true),
        ("[0.1, 0.5]", "[0.5]", 2 * 5, true),
        ("[1, 10]", "[10]", 4 * 5, false),
    ];
    for (all, few, renders, keeps_records) in parts {
        let part = plan(&EXPERIMENT.replace(all, few));
        let dir = tempfile::tempdir().unwrap();
        finished(&part, dir.path());
        let kept: Vec<_> =
            part.cells.iter().map(|cell| Store::at(dir.path()).cell(&cell.id).unwrap().unwrap()).collect();
        let log = log();
        let outcome = extend(&whole, dir.path(), &log).unwrap();
        assert!(outcome.failures.is_empty() && !outcome.is_stopped);
        let made = log.borrow().renders.iter().filter(|(method, _)| method != "reference").count();
        // References stand, or are new with their models and alphas.
        let references = log.borrow().renders.len() - made;
        assert!(made + references <= renders, "{few}: {made} images and {references} references");
        for record in kept {
            let now = Store::at(dir.path()).cell(&record.cell).unwrap().unwrap();
            assert!(!keeps_records || now.spent == record.spent, "{few}: {} was done again", record.cell);
            assert_eq!(now.scores, record.scores);
        }
        assert_like_whole(dir.path(), &whole);
        // Once it is extended it is a run like any other.
        let before = snapshot(dir.path());
        invoke(&whole, dir.path(), &super::runs::log(), usize::MAX).unwrap();
        assert!(before.iter().all(|(name, (bytes, _))| contents(dir.path())[name] == *bytes), "{few}");
    }
}

#[test]
fn the_folder_tells_that_it_was_extended_and_from_what() {
    let first = EXPERIMENT.replace("[0.1, 0.5]", "[0.5]");
    let (part, whole) = (Bench::finished(&first), plan(EXPERIMENT));
    extend(&whole, part.dir.path(), &log()).unwrap();
    let provenance = part.json("provenance.json");
    assert_eq!((&provenance["plan_hash"], provenance["sessions"].as_array().unwrap().len()), (&whole.hash.into(), 2));
    let [extension] = &provenance["extensions"].as_array().unwrap()[..] else { panic!("{provenance:#}") };
    assert_eq!(extension["from"]["plan_hash"], part.plan.hash);
    assert_eq!([&extension["cells_kept"], &extension["cells_new"]], [16, 16]);
    let frozen = part.read(extension["from"]["frozen"].as_str().unwrap());
    assert!(frozen == first.as_bytes() && part.read("experiment.toml") == EXPERIMENT.as_bytes());
    let told = format!("from plan {0} (`experiment.{0}.toml`): 16 of its 16 cells kept, 16 new.", part.plan.hash);
    assert!(summary(part.dir.path()).contains(&told), "{}", summary(part.dir.path()));
}

#[test]
fn a_plan_that_would_lose_cells_extends_nothing() {
    let dir = tempfile::tempdir().unwrap();
    finished(&plan(EXPERIMENT), dir.path());
    let before = snapshot(dir.path());
    let timed = format!("{EXPERIMENT}[timing]\nwarmup = 1\nrounds = 3\n");
    for (text, words) in [
        (EXPERIMENT.replace("[0.1, 0.5]", "[0.1, 0.25]"), "16 would not be in the tables of this one: "),
        (EXPERIMENT.replace("[0.1, 0.5]", "[0.1, 0.25]"), ": alpha is 0.1, 0.5 there and 0.1, 0.25 here."),
        (EXPERIMENT.replace("[0.1, 0.5]", "[0.1, 0.25]"), " alpha=0.5 exposure=1"),
        (EXPERIMENT.replace("[0.1, 0.5]", "[0.1, 0.25]"), "; 13 more; give another --out"),
        // Another seed makes other cells throughout.
        (format!("seed = 2\n{EXPERIMENT}"), "seed is 1 there and 2 here. Of its 32 cells 32 would not be"),
        (EXPERIMENT.replace("\"tiny\"", "\"small\""), "another experiment"),
    ] {
        let error = extend(&plan(&text), dir.path(), &log()).unwrap_err();
        let RunError::Store(fault) = &error else { panic!("{error}") };
        assert!(fault.is_misuse() && fault.to_string().contains(words), "{error}");
        assert_eq!(before, snapshot(dir.path()));
    }
    // Without leave a plan that could extend it is refused too, and told how.
    let error = invoke(&plan(&timed), dir.path(), &log(), usize::MAX).unwrap_err();
    assert!(
        error
            .to_string()
            .contains("each of its 32 cells is in this one; `splitsum run --extend` keeps them and does the others"),
        "{error}"
    );
    assert_eq!(before, snapshot(dir.path()));
}

#[test]
fn tables_without_their_records_and_scores_of_another_metric_are_not_extended() {
    let part = Bench::finished(&EXPERIMENT.replace("[0.1, 0.5]", "[0.5]"));
    let refused = |words: &str| {
        let before = snapshot(part.dir.path());
        let RunError::Store(fault) = extend(&plan(EXPERIMENT), part.dir.path(), &log()).unwrap_err() else {
            panic!("no fault of the folder")
        };
        assert!(fault.is_misuse() && fault.to_string().contains(words), "{fault}");
        assert_eq!(before, snapshot(part.dir.path()));
    };
    let whole = part.json("provenance.json");
    let mut other = whole.clone();
    other["metrics"][1]["version"] = 99.into();
    std::fs::write(part.path("provenance.json"), other.to_string()).unwrap();
    refused(&format!("another version of the metric {}", whole["metrics"][1]["name"].as_str().unwrap()));
    std::fs::write(part.path("provenance.json"), whole.to_string()).unwrap();
    // As `answers --publish` leaves it.
    std::fs::remove_dir_all(part.path("cells")).unwrap();
    refused("but no records of 16 of its cells, as a published run does");
}

/// A kill after the provenance names the new plan leaves a run of it; one before leaves the old run. Both go on.
#[test]
fn an_extension_that_was_cut_off_goes_on() {
    let (part, whole) = (plan(&EXPERIMENT.replace("[\"ggx\", \"phong\"]", "[\"ggx\"]")), plan(EXPERIMENT));
    let dir = tempfile::tempdir().unwrap();
    finished(&part, dir.path());
    let old = read(dir.path().join("provenance.json"));
    let cut = log();
    cut.borrow_mut().renders_left = Some(3);
    assert!(matches!(extend(&whole, dir.path(), &cut), Err(RunError::DeviceLost(_))));
    invoke(&whole, dir.path(), &log(), usize::MAX).unwrap();
    assert_like_whole(dir.path(), &whole);

    // Before: the images have their new names already, and some of their old ones.
    let dir = tempfile::tempdir().unwrap();
    finished(&part, dir.path());
    let images = contents(&dir.path().join("images"));
    let mut stopped = log();
    stopped.borrow_mut().renders_left = Some(0);
    assert!(extend(&whole, dir.path(), &stopped).is_err());
    for (name, bytes) in &images {
        std::fs::write(dir.path().join("images").join(name), bytes).unwrap();
    }
    std::fs::write(dir.path().join("provenance.json"), &old).unwrap();
    stopped = log();
    invoke(&part, dir.path(), &stopped, usize::MAX).unwrap();
    assert!(stopped.borrow().renders.is_empty(), "the old run is whole");
    let again = log();
    extend(&whole, dir.path(), &again).unwrap();
    // One model and its references.
    assert_eq!(again.borrow().renders.len(), 2 * 5);
    assert_like_whole(dir.path(), &whole);
}

#[test]
fn a_block_with_a_new_member_is_timed_anew_and_others_stand() {
    let text = |samples: &str, brdfs: &str| {
        let text = EXPERIMENT.replace("[1, 4, 16]", samples).replace("[\"ggx\", \"phong\"]", brdfs);
        plan(&format!("{text}[timing]\nwarmup = 1\nrounds = 6\n"))
    };
    let (part, more, models) =
        (text("[4, 16]", "[\"ggx\"]"), text("[1, 4, 16]", "[\"ggx\"]"), text("[1, 4, 16]", "[\"ggx\", \"phong\"]"));
    let dir = tempfile::tempdir().unwrap();
    finished(&part, dir.path());
    let of = |id: &str| read(dir.path().join(format!("timings/{id}.json")));
    let old: BTreeMap<String, Vec<u8>> =
        timing::jobs(&part).into_iter().map(|job| (job.id.clone(), of(&job.id))).collect();
    extend(&more, dir.path(), &log()).unwrap();
    let frames = |plan: &Plan| {
        timing::jobs(plan).into_iter().filter(|job| job.phase == timing::FRAME).map(|job| job.id).collect::<Vec<_>>()
    };
    // Sampled 1, 4, 16 and split-sum of one model are one block.
    assert_eq!(frames(&more).len(), 4);
    for (id, record) in &old {
        assert_eq!(frames(&part).contains(id), of(id) != *record, "{id}");
    }
    let provenance: serde_json::Value = serde_json::from_slice(&read(dir.path().join("provenance.json"))).unwrap();
    assert_eq!(provenance["extensions"][0]["timed_again"], 3);
    // Another model is another block.
    let old: Vec<(String, Vec<u8>)> = frames(&more).into_iter().map(|id| (id.clone(), of(&id))).collect();
    extend(&models, dir.path(), &log()).unwrap();
    assert!(old.iter().all(|(id, record)| of(id) == *record));
    // Other rounds would make the old ones no part of the tables.
    let rounds = plan(&models.config.text.replace("rounds = 6", "rounds = 7"));
    let error = extend(&rounds, dir.path(), &log()).unwrap_err().to_string();
    assert!(error.contains("timed configurations (their [timing] counts)"), "{error}");
}

/// Looks, when the first record of a block is written, for old ones of the same block.
struct FirstRecord<'a> {
    dir: &'a Path,
    block: &'a [String],
    seen: Vec<String>,
}

impl Progress for FirstRecord<'_> {
    fn start(&mut self, _: usize, _: usize) {}

    fn step(&mut self, label: &str, _: Option<&str>) {
        if label.starts_with("timing") && self.seen.is_empty() {
            let path = |id: &String| self.dir.join(format!("timings/{id}.json"));
            self.seen = self.block.iter().filter(|id| path(id).exists()).cloned().collect();
        }
    }

    fn note(&mut self, _: &str) {}
}

/// Records of a block are of the same rounds, wherever a run is killed: all old ones are taken away before the first new one is written.
#[test]
fn a_block_never_mixes_rounds() {
    let (dir, plan) = (tempfile::tempdir().unwrap(), plan(&format!("{EXPERIMENT}[timing]\nwarmup = 1\nrounds = 6\n")));
    finished(&plan, dir.path());
    let jobs = timing::jobs(&plan);
    let of_last = jobs.iter().filter(|job| job.block == jobs.last().unwrap().block);
    let block: Vec<String> = of_last.map(|job| job.id.clone()).collect();
    assert_eq!(block.len(), 4);
    std::fs::remove_file(dir.path().join(format!("timings/{}.json", block[1]))).unwrap();
    let stop = AtomicBool::new(false);
    let mut progress = FirstRecord { dir: dir.path(), block: &block, seen: Vec::new() };
    run(&plan, &mut fakes(&log()) as &mut MakeRenderer, &options(dir.path(), &stop), &mut progress).unwrap();
    assert_eq!(progress.seen, block[..1]);
}
