//! Larger plans that continue in the folder of a smaller run.

use super::runs::{
    Bench, Each, assert_like_whole, contents, fakes, finished, invoke, log, options, plan, read,
    snapshot, written,
};
use super::whole::EXPERIMENT;
use splitsum::experiment::Id;
use splitsum::report::publish::publish;
use splitsum::run::store::Store;
use splitsum::run::{MakeRenderer, RunError, run, timing};
use std::collections::BTreeMap;
use std::sync::atomic::AtomicBool;

#[test]
fn a_larger_plan_keeps_finished_cells_and_equals_a_fresh_run() {
    let whole = plan(EXPERIMENT);
    // More values of a swept axis; a new swept axis; tone curves, for which every cell needs
    // another map.
    let parts = [
        ("[1, 4, 16]", "[4, 16]", 4, 0),
        ("[\"ggx\", \"phong\"]", "[\"phong\"]", 8, 2),
        ("[0.1, 0.5]", "[0.5]", 8, 2),
        ("[1, 10]", "[10]", 16, 0),
    ];
    for (all, few, images, references) in parts {
        let part = plan(&EXPERIMENT.replace(all, few));
        let dir = tempfile::tempdir().unwrap();
        finished(&part, dir.path());
        let log = log();
        let outcome = invoke(&whole, dir.path(), &log, usize::MAX).unwrap();
        assert!(outcome.failures.is_empty() && !outcome.is_stopped);
        let (of_references, of_images): (Vec<_>, Vec<_>) = log
            .borrow()
            .renders
            .iter()
            .cloned()
            .partition(|(method, _)| method == "reference");
        assert_eq!(
            (of_images.len(), of_references.len()),
            (images, references),
            "{few}"
        );
        assert_like_whole(dir.path(), &whole);
        let provenance: serde_json::Value =
            serde_json::from_slice(&read(dir.path().join("provenance.json"))).unwrap();
        let plans: Vec<&str> = provenance["sessions"]
            .as_array()
            .unwrap()
            .iter()
            .map(|s| s["plan_hash"].as_str().unwrap())
            .collect();
        assert_eq!(
            (plans, &provenance["plan_hash"]),
            (vec![&*part.hash, &whole.hash], &(&*whole.hash).into()),
            "{few}"
        );
        // From then on it is an ordinary run.
        let before = contents(dir.path());
        invoke(&whole, dir.path(), &super::runs::log(), usize::MAX).unwrap();
        assert!(contents(dir.path()) == before, "{few}");
    }
}

/// No byte changes if a plan is refused.
#[test]
fn a_plan_that_lacks_finished_work_is_refused() {
    let timed = format!("{EXPERIMENT}[timing]\nwarmup = 1\nrounds = 6\n");
    let dir = tempfile::tempdir().unwrap();
    finished(&plan(&timed), dir.path());
    let refused = |text: &str, words: &[&str]| {
        let before = snapshot(dir.path());
        let RunError::Store(fault) =
            invoke(&plan(text), dir.path(), &log(), usize::MAX).unwrap_err()
        else {
            panic!("no fault of the folder")
        };
        assert!(fault.is_misuse(), "{fault}");
        for part in words {
            assert!(fault.to_string().contains(part), "no {part:?} in {fault}");
        }
        assert_eq!(fault.to_string().lines().count(), 1, "{fault}");
        assert_eq!(before, snapshot(dir.path()));
    };
    let other_alpha = timed.replace("[0.1, 0.5]", "[0.1, 0.25]");
    refused(
        &other_alpha,
        &["holds another run; choose another --out (16 finished cells are not in tiny.toml)"],
    );
    // Another seed, shader or input changes all cells.
    refused(
        &format!("seed = 2\n{timed}"),
        &[
            "32 finished cells",
            "tiny.toml: seed is 1 there and 2 here)",
        ],
    );
    refused(
        &timed.replace("samples = 64", "samples = 96"),
        &["32 finished cells", ": reference is ", "96"],
    );
    refused(
        EXPERIMENT,
        &["12 timed configurations are not in tiny.toml"],
    );
    refused(
        &timed.replace("rounds = 6", "rounds = 7"),
        &["12 timed configurations"],
    );

    let path = dir.path().join("provenance.json");
    let whole: serde_json::Value = serde_json::from_slice(&read(&path)).unwrap();
    let with = |pointer: &str, value: serde_json::Value| {
        let mut changed = whole.clone();
        *changed.pointer_mut(pointer).unwrap() = value;
        std::fs::write(&path, changed.to_string()).unwrap();
    };
    with("/metrics/1/version", 99.into());
    let metric = whole["metrics"][1]["name"].as_str().unwrap();
    refused(
        &timed,
        &[&format!("another version of the metric {metric}")],
    );
    with("/shader_hash", "0".into());
    refused(&other_alpha, &[": they were rendered by other shaders)"]);
    with("/inputs/builtin:constant", "0".into());
    refused(&other_alpha, &[": builtin:constant has changed since)"]);

    // A published folder has tables without records.
    with("/name", whole["name"].clone());
    written(dir.path()).write().unwrap();
    let results = tempfile::tempdir().unwrap();
    publish(dir.path(), results.path(), false).unwrap();
    let published = results.path().join("tiny");
    let error = invoke(&plan(&other_alpha), &published, &log(), usize::MAX)
        .unwrap_err()
        .to_string();
    assert!(error.contains("16 finished cells are not in"), "{error}");
}

/// A failed cell is not finished, so a plan without it forgets it.
#[test]
fn failures_of_cells_that_a_plan_lacks_are_forgotten() {
    let (bench, broken) = (Bench::new(EXPERIMENT), log());
    broken.borrow_mut().broken_method = Some("split-sum");
    assert_eq!(bench.invoke(&broken, usize::MAX).unwrap().failures.len(), 8);
    let sampled = plan(&EXPERIMENT.replace("[\"sampled\", \"split-sum\"]", "[\"sampled\"]"));
    let log = log();
    invoke(&sampled, bench.dir.path(), &log, usize::MAX).unwrap();
    assert!(log.borrow().renders.is_empty());
    assert_like_whole(bench.dir.path(), &sampled);
}

#[test]
fn a_block_with_a_new_member_is_timed_again_and_others_stay() {
    let text = |samples: &str, brdfs: &str| {
        let text = EXPERIMENT
            .replace("[1, 4, 16]", samples)
            .replace("[\"ggx\", \"phong\"]", brdfs);
        plan(&format!("{text}[timing]\nwarmup = 1\nrounds = 6\n"))
    };
    let (part, more, models) = (
        text("[4, 16]", "[\"ggx\"]"),
        text("[1, 4, 16]", "[\"ggx\"]"),
        text("[1, 4, 16]", "[\"ggx\", \"phong\"]"),
    );
    let dir = tempfile::tempdir().unwrap();
    finished(&part, dir.path());
    let of = |id: Id| read(dir.path().join(format!("timings/{id}.json")));
    let old: BTreeMap<Id, Vec<u8>> = timing::jobs(&part)
        .into_iter()
        .map(|job| (job.id, of(job.id)))
        .collect();
    finished(&more, dir.path());
    let frames = |plan: &splitsum::experiment::Plan| {
        timing::jobs(plan)
            .into_iter()
            .filter(|job| job.phase == timing::FRAME)
            .map(|job| job.id)
            .collect::<Vec<_>>()
    };
    // Sampled 1, 4, 16 and split-sum of one model are one block.
    assert_eq!(frames(&more).len(), 4);
    for (id, record) in &old {
        assert_eq!(frames(&part).contains(id), of(*id) != *record, "{id}");
    }
    // Another model is another block.
    let old: Vec<(Id, Vec<u8>)> = frames(&more).into_iter().map(|id| (id, of(id))).collect();
    finished(&models, dir.path());
    assert!(old.iter().all(|(id, record)| of(*id) == *record));
}

/// Records of a block come from the same rounds, even if a run is killed: all old ones are removed
/// before the first new one is written.
#[test]
fn a_block_never_mixes_rounds() {
    let bench = Bench::finished(&format!("{EXPERIMENT}[timing]\nwarmup = 1\nrounds = 6\n"));
    let (dir, plan) = (bench.dir.path(), &bench.plan);
    let jobs = timing::jobs(plan);
    let of_last = jobs
        .iter()
        .filter(|job| job.block == jobs.last().unwrap().block);
    let block: Vec<Id> = of_last.map(|job| job.id).collect();
    assert_eq!(block.len(), 4);
    std::fs::remove_file(dir.join(format!("timings/{}.json", block[1]))).unwrap();
    let stop = AtomicBool::new(false);
    // The records when the first new one is written.
    let mut seen = None;
    let mut progress = Each(|label: &str, _| {
        if label.starts_with("timing") && seen.is_none() {
            seen = Some(
                block
                    .iter()
                    .filter(|id| Store::read_only(dir).has_timing(**id))
                    .collect::<Vec<_>>(),
            );
        }
    });
    run(
        plan,
        &mut fakes(&log()) as &mut MakeRenderer,
        &options(dir, &stop),
        &mut progress,
    )
    .unwrap();
    assert_eq!(seen, Some(vec![&block[0]]));
    assert!(block.iter().all(|id| Store::read_only(dir).has_timing(*id)));
}
