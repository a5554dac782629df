//! Runs that are stopped, damaged or fail: the files that remain, and how the next run continues.

use super::runs::{Bench, Steps, contents, fakes, log, options, read, snapshot, summary};
use super::whole::EXPERIMENT;
use splitsum::experiment::{Id, Plan};
use splitsum::run::store::Store;
use splitsum::run::{MakeRenderer, RenderFault, Renderer, RunError, RunOptions, run, timing};
use splitsum::study::finished::Finished;
use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;

fn timed() -> String {
    format!("{EXPERIMENT}[timing]\nwarmup = 1\nrounds = 3\n")
}

#[test]
fn fail_fast_ends_the_run_at_the_first_failure() {
    let (bench, broken, stop) = (Bench::new(EXPERIMENT), log(), AtomicBool::new(false));
    broken.borrow_mut().broken_method = Some("split-sum");
    let options = RunOptions {
        fail_fast: true,
        ..options(bench.dir.path(), &stop)
    };
    let mut progress = Steps {
        stop: &stop,
        left: usize::MAX,
        notes: Vec::new(),
    };
    let outcome = run(
        &bench.plan,
        &mut fakes(&broken) as &mut MakeRenderer,
        &options,
        &mut progress,
    )
    .unwrap();
    assert!(outcome.is_stopped);
    assert_eq!(outcome.failures.len(), 1);
    // One reference and the three images of `sampled` before it; nothing after.
    assert_eq!(broken.borrow().renders.len(), 4);
    bench.invoke(&log(), usize::MAX).unwrap();
    assert!(bench.read("errors.csv") == Bench::finished(EXPERIMENT).read("errors.csv"));
}

#[test]
fn a_finished_run_is_not_touched_and_needs_no_renderer() {
    let bench = Bench::finished(&timed());
    let before = contents(bench.dir.path());
    let stop = AtomicBool::new(false);
    let mut progress = Steps {
        stop: &stop,
        left: usize::MAX,
        notes: Vec::new(),
    };
    let mut make = || -> Result<Box<dyn Renderer>, RenderFault> { panic!("a renderer was made") };
    run(
        &bench.plan,
        &mut make as &mut MakeRenderer,
        &options(bench.dir.path(), &stop),
        &mut progress,
    )
    .unwrap();
    assert!(contents(bench.dir.path()) == before);
}

#[test]
fn a_run_stopped_anywhere_ends_like_an_undisturbed_run() {
    let whole = Bench::finished(EXPERIMENT);
    for steps in [1, 7, 20] {
        let bench = Bench::new(EXPERIMENT);
        let mut invocations = 0;
        loop {
            let outcome = bench.invoke(&log(), steps).unwrap();
            invocations += 1;
            let rows = bench.table("errors.csv").rows.len();
            assert_eq!(
                rows,
                (invocations * steps).min(32),
                "rows after {invocations} times {steps} steps"
            );
            if !outcome.is_stopped {
                break;
            }
        }
        assert_eq!(invocations, 32usize.div_ceil(steps));
        for name in [
            "errors.csv",
            "errors_by_n_dot_v.csv",
            "summary.md",
            "experiment.toml",
            "tables/ggx.svg",
        ] {
            assert!(
                bench.read(name) == whole.read(name),
                "{name} differs after stops of {steps} steps"
            );
        }
        assert!(
            bench.images() == whole.images(),
            "images differ after stops of {steps} steps"
        );
    }
}

/// If an image is missing, truncated or replaced by another of the same length, its cell is
/// rendered again. Files that it shares with other cells remain.
#[test]
fn images_that_differ_from_their_records_are_rendered_again() {
    let bench = Bench::finished(EXPERIMENT);
    let (before, errors) = (bench.images(), bench.read("errors.csv"));
    type Damage = fn(&Path, &[u8]);
    let remove: Damage = |path, _| std::fs::remove_file(path).unwrap();
    let cut: Damage = |path, bytes| std::fs::write(path, &bytes[..bytes.len() - 40]).unwrap();
    let change: Damage = |path, bytes| {
        let mut bytes = bytes.to_vec();
        let middle = bytes.len() / 2;
        bytes[middle] ^= 1;
        std::fs::write(path, bytes).unwrap();
    };
    for (end, damage) in [
        (".error.png", remove),
        (".flip.png", remove),
        (".exr", cut),
        (".exr", change),
        (".error.png", change),
    ] {
        let name = before
            .keys()
            .find(|name| name.contains("split-sum") && name.ends_with(end))
            .unwrap();
        damage(&bench.path("images").join(name), &before[name]);
        let (notes, renders) = bench.again().unwrap();
        let note = format!(
            "1 missing or changed images of finished cells; rendering these cells again; the \
             first: images/{name}"
        );
        assert!(notes.len() == 1 && notes[0].starts_with(&note), "{notes:?}");
        // One image; its reference is read back.
        assert_eq!(renders, [("split-sum".to_owned(), 1)], "{name}");
        assert!(
            bench.images() == before && bench.read("errors.csv") == errors,
            "{name}"
        );
    }
}

/// A complete reference that differs from the one of finished cells must not judge the other cells.
#[test]
fn a_changed_reference_is_rendered_again() {
    let bench = Bench::finished(EXPERIMENT);
    let (before, errors) = (bench.images(), bench.read("errors.csv"));
    let open = &bench.plan.cells[5];
    let id = open.reference.expect("its reference").to_string();
    let is_reference = |name: &&String| name.contains(&id) && name.ends_with(".exr");
    let reference = before
        .keys()
        .find(is_reference)
        .expect("the image of its reference");
    let (other, _) = before
        .iter()
        .find(|(name, _)| name.ends_with(".exr") && *name != reference)
        .unwrap();
    let mut flipped = before[reference].clone();
    *flipped.last_mut().unwrap() ^= 1;
    for changed in [before[other].clone(), flipped] {
        std::fs::write(bench.path("images").join(reference), changed).unwrap();
        std::fs::remove_file(bench.path(&format!("cells/{}.json", open.id))).unwrap();
        assert_eq!(
            bench.again().unwrap().1.len(),
            5,
            "the reference and the four images that it judges"
        );
        assert!(bench.images() == before && bench.read("errors.csv") == errors);
    }
}

/// A record that is missing, truncated, edited or of another cell does not count: only its cell is
/// rendered again.
#[test]
fn a_cell_with_a_damaged_record_is_rendered_again() {
    let bench = Bench::finished(EXPERIMENT);
    let errors = bench.read("errors.csv");
    let of_method =
        |cell: &&splitsum::experiment::Cell| cell.point.get("method").to_string() == "split-sum";
    let split_sum = bench.plan.cells.iter().find(of_method).unwrap();
    let path = bench.path(&format!("cells/{}.json", split_sum.id));
    let text = String::from_utf8(read(&path)).unwrap();
    let place = text.find("\"rmse\": \"").unwrap() + 9;
    let edited = format!("{}9{}", &text[..place], &text[place + 1..]);
    let other =
        String::from_utf8(bench.read(&format!("cells/{}.json", bench.plan.cells[0].id))).unwrap();
    for content in [
        None,
        Some(""),
        Some("{\"cell\": \"12"),
        Some(&edited),
        Some(&other),
    ] {
        std::fs::remove_file(&path).unwrap();
        content
            .into_iter()
            .for_each(|content| std::fs::write(&path, content).unwrap());
        let (notes, renders) = bench.again().unwrap();
        assert_eq!(notes.len(), usize::from(content.is_some()), "{notes:?}");
        assert_eq!(renders, [("split-sum".to_owned(), 1)], "{content:?}");
        assert!(bench.read("errors.csv") == errors, "{content:?}");
    }
}

#[test]
fn a_timing_record_under_another_name_is_ignored() {
    let bench = Bench::finished(&timed());
    let (dir, store, jobs) = (
        bench.dir.path(),
        Store::read_only(bench.dir.path()),
        timing::jobs(&bench.plan),
    );
    let path = |id: Id| bench.path(&format!("timings/{id}.json"));
    std::fs::copy(path(jobs[0].id), path(jobs[1].id)).unwrap();
    assert!(store.has_timing(jobs[0].id) && !store.has_timing(jobs[1].id));
    // A concurrent reader counts the cell once, as the run does.
    let counted = || Finished::read(dir).unwrap().timings.len();
    assert_eq!(counted(), jobs.len() - 1);
    let other = path(Id::of_text("no configuration"));
    std::fs::copy(path(jobs[0].id), &other).unwrap();
    assert_eq!(counted(), jobs.len() - 1);
    std::fs::remove_file(&other).unwrap();
    bench.again().unwrap();
    assert!(store.has_timing(jobs[1].id));
}

#[test]
fn a_reference_with_a_damaged_record_is_rendered_again() {
    let bench = Bench::finished(EXPERIMENT);
    let (store, table) = (Store::read_only(bench.dir.path()), bench.read("errors.csv"));
    let (first, last) = (&bench.plan.cells[0], bench.plan.cells.last().unwrap());
    let path = |id: Id| bench.path(&format!("references/{id}.json"));
    let [first_id, last_id] = [first, last].map(|cell| cell.reference.expect("its reference"));
    assert_ne!(first_id, last_id);
    for content in [read(path(first_id))[..30].to_vec(), read(path(last_id))] {
        std::fs::write(path(first_id), content).unwrap();
        assert!(store.reference(first_id).unwrap().is_none());
        std::fs::remove_file(store.cell_path(first.id)).unwrap();
        bench.again().unwrap();
        assert!(store.reference(first_id).unwrap().is_some() && bench.read("errors.csv") == table);
    }
}

fn failed_rows(bench: &Bench) -> usize {
    let table = bench.table("errors.csv");
    let verdict = table.column("verdict").unwrap();
    table
        .rows
        .iter()
        .filter(|row| row[verdict] == "failed")
        .count()
}

#[test]
fn a_failing_method_does_not_stop_the_rest_and_is_tried_again() {
    let (bench, broken) = (Bench::new(EXPERIMENT), log());
    broken.borrow_mut().broken_method = Some("split-sum");
    let outcome = bench.invoke(&broken, usize::MAX).unwrap();
    assert_eq!(
        (
            outcome.failures.len(),
            failed_rows(&bench),
            bench.table("errors.csv").rows.len()
        ),
        (8, 8, 32)
    );
    assert!(
        outcome
            .failures
            .iter()
            .all(|f| f.reason == "the shader is broken" && f.label.contains("split-sum"))
    );
    assert!(summary(bench.dir.path()).contains("the shader is broken"));
    // A failed reference fails only its cells.
    let (other, no_reference) = (Bench::new(EXPERIMENT), log());
    no_reference.borrow_mut().broken_method = Some("reference");
    let outcome = other.invoke(&no_reference, usize::MAX).unwrap();
    assert!(
        outcome.failures.len() == 32 && outcome.failures[0].reason.starts_with("its reference: ")
    );

    let whole = Bench::finished(EXPERIMENT).read("errors.csv");
    for bench in [bench, other] {
        assert!(
            bench
                .invoke(&log(), usize::MAX)
                .unwrap()
                .failures
                .is_empty()
        );
        assert!(bench.read("errors.csv") == whole);
    }
}

#[test]
fn a_folder_that_is_not_a_run_is_refused() {
    let bench = Bench::new(EXPERIMENT);
    std::fs::write(bench.path("thesis.tex"), "years of work").unwrap();
    let error = bench.invoke(&log(), usize::MAX).unwrap_err();
    assert!(error.to_string().contains("not a run"), "{error}");
    assert_eq!(snapshot(bench.dir.path()).len(), 1);
}

#[test]
fn the_frozen_experiment_of_a_finished_run_is_restored() {
    let bench = Bench::finished(EXPERIMENT);
    let path = bench.path("experiment.toml");
    let (whole, provenance) = (read(&path), bench.read("provenance.json"));
    for content in [Some(&whole[..20]), None] {
        std::fs::remove_file(&path).unwrap();
        content
            .into_iter()
            .for_each(|content| std::fs::write(&path, content).unwrap());
        let (notes, renders) = bench.again().unwrap();
        assert!(
            notes.len() == 1 && notes[0].contains("experiment.toml was missing or edited"),
            "{notes:?}"
        );
        assert!(
            renders.is_empty()
                && read(&path) == whole
                && bench.read("provenance.json") == provenance
        );
    }
    // The same cells from another text: the provenance has the new text.
    let plan: Plan = super::runs::plan(&format!("# A comment.\n{EXPERIMENT}"));
    assert_eq!(plan.hash, bench.plan.hash);
    let other = Bench { plan, ..bench };
    other.again().unwrap();
    assert!(read(&path).starts_with(b"# A comment"));
}

#[test]
fn a_damaged_provenance_is_refused_by_every_reader() {
    let bench = Bench::finished(EXPERIMENT);
    let path: PathBuf = bench.path("provenance.json");
    let whole: serde_json::Value = serde_json::from_slice(&read(&path)).unwrap();
    let with = |version: serde_json::Value| {
        let mut changed = whole.clone();
        changed["schema_version"] = version;
        changed.to_string()
    };
    for (text, what) in [
        ("[1, 2, 3]".to_owned(), "is not an object"),
        ("{}".to_owned(), "no schema_version"),
        ("{\"schema".to_owned(), "not a provenance file of splitsum"),
        (with("2".into()), "not a whole number"),
        (with(2.into()), "format 2"),
    ] {
        std::fs::write(&path, text).unwrap();
        let Err(RunError::Store(error)) = bench.again() else {
            panic!("{what}: went on")
        };
        assert!(
            error.is_misuse() && error.to_string().contains(what),
            "{what}: {error}"
        );
        assert_eq!(
            Finished::read(bench.dir.path()).unwrap_err().to_string(),
            error.to_string()
        );
    }
}

#[test]
fn images_csv_names_nothing_outside_the_images() {
    let bench = Bench::finished(EXPERIMENT);
    let text = String::from_utf8(bench.read("images.csv")).unwrap();
    let run = || Finished::read(bench.dir.path());
    let name = run()
        .unwrap()
        .cells
        .into_iter()
        .find_map(|cell| cell.images)
        .unwrap()
        .radiance
        .clone();
    for stranger in [
        "../../../../etc/passwd",
        "..",
        "/etc/passwd",
        "a\\b",
        "a\u{1b}[31m",
    ] {
        std::fs::write(bench.path("images.csv"), text.replacen(&name, stranger, 1)).unwrap();
        let error = run().unwrap_err().to_string();
        assert!(
            error.contains("images.csv") && error.contains("is not the name of an image"),
            "{error}"
        );
    }
}
