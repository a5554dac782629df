//! Runs that are stopped, damaged or fail: what is left behind, and what the next one makes of it.

use super::run::EXPERIMENT;
use super::runs::{Steps, contents, fakes, finished, invoke, log, options, plan, read, snapshot, summary};
use splitsum::runner::{MakeRenderer, Progress, RenderFault, Renderer, RunError, RunOptions, run};
use splitsum::study::finished::{Finished, notes};
use splitsum::table::csv::Table;
use std::path::Path;
use std::sync::atomic::AtomicBool;

#[test]
fn fail_fast_ends_the_run_at_the_first_failure() {
    let (dir, plan) = (tempfile::tempdir().unwrap(), plan(EXPERIMENT));
    let broken = log();
    broken.borrow_mut().broken_method = Some("split-sum");
    let stop = AtomicBool::new(false);
    let options = RunOptions { fail_fast: true, ..options(dir.path(), &stop) };
    let mut progress = Steps { stop: &stop, left: usize::MAX, failures: Vec::new() };
    let outcome = run(&plan, &mut fakes(&broken) as &mut MakeRenderer, &options, &mut progress).unwrap();
    assert!(outcome.is_stopped);
    assert_eq!(outcome.failures.len(), 1);
    // One reference and the three images of `sampled` before it; nothing after.
    assert_eq!(broken.borrow().renders.len(), 4);
    invoke(&plan, dir.path(), &log(), usize::MAX).unwrap();
    let whole = tempfile::tempdir().unwrap();
    invoke(&plan, whole.path(), &log(), usize::MAX).unwrap();
    assert!(read(dir.path().join("errors.csv")) == read(whole.path().join("errors.csv")));
}

#[test]
fn a_second_run_in_the_same_folder_is_told() {
    let (dir, plan) = (tempfile::tempdir().unwrap(), plan(EXPERIMENT));
    let held = splitsum::runner::store::Store::open(dir.path(), &plan).unwrap();
    let error = invoke(&plan, dir.path(), &log(), usize::MAX).unwrap_err();
    assert!(error.to_string().contains("another run is at work in it"), "{error}");
    drop(held);
    invoke(&plan, dir.path(), &log(), usize::MAX).unwrap();
}

#[test]
fn what_a_killed_run_left_half_written_is_no_obstacle() {
    let (dir, plan) = (tempfile::tempdir().unwrap(), plan(EXPERIMENT));
    std::fs::create_dir(dir.path().join("images")).unwrap();
    for name in [".splitsum-aZ3.part", "errors.csv.part", "images/.splitsum-b.part"] {
        std::fs::write(dir.path().join(name), "half").unwrap();
    }
    invoke(&plan, dir.path(), &log(), usize::MAX).unwrap();
    assert!(snapshot(dir.path()).keys().all(|name| !name.ends_with(".part")));
}

#[test]
fn a_finished_run_is_not_touched_and_needs_no_renderer() {
    let (dir, plan) = (tempfile::tempdir().unwrap(), plan(&format!("{EXPERIMENT}[timing]\nwarmup = 1\nrounds = 3\n")));
    invoke(&plan, dir.path(), &log(), usize::MAX).unwrap();
    let before = snapshot(dir.path());
    let stop = AtomicBool::new(false);
    let options = options(dir.path(), &stop);
    let mut progress = Steps { stop: &stop, left: usize::MAX, failures: Vec::new() };
    let mut make = || -> Result<Box<dyn Renderer>, RenderFault> { panic!("a renderer was made") };
    run(&plan, &mut make as &mut MakeRenderer, &options, &mut progress).unwrap();
    let after = snapshot(dir.path());
    assert_eq!(before.keys().collect::<Vec<_>>(), after.keys().collect::<Vec<_>>());
    for (name, (bytes, _)) in &before {
        assert!(*bytes == after[name].0, "{name} changed");
    }
}

#[test]
fn a_run_stopped_anywhere_ends_like_one_that_was_not() {
    let plan = plan(EXPERIMENT);
    let whole = tempfile::tempdir().unwrap();
    invoke(&plan, whole.path(), &log(), usize::MAX).unwrap();
    for steps in [1, 7, 20] {
        let dir = tempfile::tempdir().unwrap();
        let mut invocations = 0;
        loop {
            let outcome = invoke(&plan, dir.path(), &log(), steps).unwrap();
            invocations += 1;
            let rows = Table::read(&dir.path().join("errors.csv")).unwrap().rows.len();
            assert_eq!(rows, (invocations * steps).min(32), "rows after {invocations} times {steps} steps");
            if !outcome.is_stopped {
                break;
            }
        }
        assert_eq!(invocations, 32usize.div_ceil(steps));
        for name in ["errors.csv", "errors_by_n_dot_v.csv", "summary.md", "experiment.toml", "tables/ggx.png"] {
            assert!(
                read(dir.path().join(name)) == read(whole.path().join(name)),
                "{name} differs after stops of {steps} steps"
            );
        }
        let images = |dir: &Path| snapshot(&dir.join("images")).into_iter().map(|(k, v)| (k, v.0)).collect::<Vec<_>>();
        assert!(images(dir.path()) == images(whole.path()), "images differ after stops of {steps} steps");
    }
}

#[test]
fn images_that_are_gone_or_cut_off_are_made_again() {
    let (dir, plan) = (tempfile::tempdir().unwrap(), plan(EXPERIMENT));
    invoke(&plan, dir.path(), &log(), usize::MAX).unwrap();
    let before = contents(&dir.path().join("images"));
    let errors = read(dir.path().join("errors.csv"));
    let of_split_sum = |end: &str| {
        before
            .keys()
            .find(|name| name.contains("split-sum") && name.ends_with(end))
            .expect("an image of split-sum")
            .clone()
    };
    for name in [of_split_sum(".error.png"), of_split_sum(".flip.png"), of_split_sum(".exr")] {
        let path = dir.path().join("images").join(&name);
        match name.ends_with(".exr") {
            true => std::fs::write(&path, &before[&name][..before[&name].len() - 40]).unwrap(),
            false => std::fs::remove_file(&path).unwrap(),
        }
        let log = log();
        invoke(&plan, dir.path(), &log, usize::MAX).unwrap();
        // One image; its reference is read back.
        assert_eq!(log.borrow().renders, [("split-sum".to_owned(), 1)], "{name}");
        assert!(contents(&dir.path().join("images")) == before, "{name}");
        assert!(read(dir.path().join("errors.csv")) == errors, "{name}");
    }
}

/// An image that is whole, as long as before, and another one: its cell is done again, and what it shares with others stands.
#[test]
fn an_image_of_a_finished_cell_that_was_changed_is_made_again() {
    let (dir, plan) = (tempfile::tempdir().unwrap(), plan(EXPERIMENT));
    invoke(&plan, dir.path(), &log(), usize::MAX).unwrap();
    let before = contents(&dir.path().join("images"));
    let errors = read(dir.path().join("errors.csv"));
    for end in [".exr", ".error.png"] {
        let name = before.keys().find(|name| name.contains("split-sum") && name.ends_with(end)).unwrap();
        let mut changed = before[name].clone();
        let middle = changed.len() / 2;
        changed[middle] ^= 1;
        std::fs::write(dir.path().join("images").join(name), changed).unwrap();
        let (log, stop) = (log(), AtomicBool::new(false));
        let mut progress = Notes::default();
        run(&plan, &mut fakes(&log) as &mut MakeRenderer, &options(dir.path(), &stop), &mut progress).unwrap();
        let note =
            format!("images of finished cells that are missing or were changed since: 1, the first images/{name};");
        assert!(progress.0.len() == 1 && progress.0[0].starts_with(&note), "{:?}", progress.0);
        assert_eq!(log.borrow().renders, [("split-sum".to_owned(), 1)], "{name}");
        assert!(
            contents(&dir.path().join("images")) == before && read(dir.path().join("errors.csv")) == errors,
            "{name}"
        );
    }
}

/// Keeps what is noted.
#[derive(Default)]
pub struct Notes(pub Vec<String>);

impl Progress for Notes {
    fn start(&mut self, _: usize, _: usize) {}
    fn step(&mut self, _: &str, _: Option<&str>) {}
    fn note(&mut self, text: &str) {
        self.0.push(text.to_owned());
    }
}

/// A reference whose image is whole but another than the one that finished cells were judged against must not judge the rest.
#[test]
fn a_reference_that_was_changed_is_made_again() {
    let (dir, plan) = (tempfile::tempdir().unwrap(), plan(EXPERIMENT));
    invoke(&plan, dir.path(), &log(), usize::MAX).unwrap();
    let before = contents(&dir.path().join("images"));
    let errors = read(dir.path().join("errors.csv"));
    let open = &plan.cells[5];
    let reference = before.keys().find(|name| name.contains(&open.reference)).expect("the image of its reference");
    let path = dir.path().join("images").join(reference);
    let (other, _) = before.iter().find(|(name, _)| name.ends_with(".exr") && *name != reference).unwrap();
    let mut flipped = before[reference].clone();
    *flipped.last_mut().unwrap() ^= 1;
    for changed in [before[other].clone(), flipped] {
        std::fs::write(&path, changed).unwrap();
        std::fs::remove_file(dir.path().join(format!("cells/{}.json", open.id))).unwrap();
        let log = log();
        invoke(&plan, dir.path(), &log, usize::MAX).unwrap();
        assert_eq!(log.borrow().renders.len(), 5, "the reference and the four images that it judges");
        assert!(contents(&dir.path().join("images")) == before);
        assert!(read(dir.path().join("errors.csv")) == errors);
    }
}

#[test]
fn a_record_that_was_cut_off_is_no_record() {
    let (dir, plan) = (tempfile::tempdir().unwrap(), plan(EXPERIMENT));
    invoke(&plan, dir.path(), &log(), usize::MAX).unwrap();
    let errors = read(dir.path().join("errors.csv"));
    let split_sum = plan.cells.iter().find(|cell| cell.point.get("method").to_string() == "split-sum").unwrap();
    let record = dir.path().join("cells").join(format!("{}.json", split_sum.id));
    for contents in ["", "{\"cell\": \"12"] {
        std::fs::write(&record, contents).unwrap();
        let log = log();
        invoke(&plan, dir.path(), &log, usize::MAX).unwrap();
        assert_eq!(log.borrow().renders, [("split-sum".to_owned(), 1)], "{contents:?}");
        assert!(read(dir.path().join("errors.csv")) == errors, "{contents:?}");
    }
}

#[test]
fn a_record_that_vanished_is_made_again() {
    let (dir, plan) = (tempfile::tempdir().unwrap(), plan(EXPERIMENT));
    invoke(&plan, dir.path(), &log(), usize::MAX).unwrap();
    let before = read(dir.path().join("errors.csv"));
    std::fs::remove_file(dir.path().join(format!("cells/{}.json", plan.cells[5].id))).unwrap();
    std::fs::remove_file(dir.path().join("errors.csv")).unwrap();
    let log = log();
    invoke(&plan, dir.path(), &log, usize::MAX).unwrap();
    assert_eq!(log.borrow().renders.len(), 1, "its reference is read back");
    assert!(read(dir.path().join("errors.csv")) == before);
}

#[test]
fn a_failing_method_leaves_the_rest_and_is_tried_again() {
    let (dir, plan) = (tempfile::tempdir().unwrap(), plan(EXPERIMENT));
    let broken = log();
    broken.borrow_mut().broken_method = Some("split-sum");
    let outcome = invoke(&plan, dir.path(), &broken, usize::MAX).unwrap();
    assert_eq!(outcome.failures.len(), 8);
    assert!(outcome.failures.iter().all(|f| f.reason == "the shader is broken" && f.label.contains("split-sum")));
    assert!(summary(dir.path()).contains("the shader is broken"));
    let table = Table::read(&dir.path().join("errors.csv")).unwrap();
    let verdict = table.column("verdict").unwrap();
    assert_eq!(table.rows.iter().filter(|row| row[verdict] == "failed").count(), 8);
    assert_eq!(table.rows.len(), 32);

    let outcome = invoke(&plan, dir.path(), &log(), usize::MAX).unwrap();
    assert!(outcome.failures.is_empty());
    let whole = tempfile::tempdir().unwrap();
    invoke(&plan, whole.path(), &log(), usize::MAX).unwrap();
    assert!(read(dir.path().join("errors.csv")) == read(whole.path().join("errors.csv")));
}

#[test]
fn a_failing_reference_fails_its_cells_only() {
    let (dir, plan) = (tempfile::tempdir().unwrap(), plan(EXPERIMENT));
    let broken = log();
    broken.borrow_mut().broken_method = Some("reference");
    let outcome = invoke(&plan, dir.path(), &broken, usize::MAX).unwrap();
    assert_eq!(outcome.failures.len(), 32);
    assert!(outcome.failures[0].reason.starts_with("its reference: "));
}

/// A folder in the place of one image is a fault of its cells: the run goes on, and ends with them when it is gone.
#[test]
fn a_folder_in_the_place_of_an_image_fails_its_cells_only() {
    let (whole, plan) = (tempfile::tempdir().unwrap(), plan(EXPERIMENT));
    finished(&plan, whole.path());
    let images = contents(&whole.path().join("images"));
    let cell = plan.cells.iter().find(|cell| cell.point.get("method").to_string() == "split-sum").unwrap();
    let named =
        |id: &str, end: &str| images.keys().find(|name| name.contains(id) && name.ends_with(end)).unwrap().clone();
    // The image of two exposures, and its map; a picture of one; the picture of a reference, at one exposure of four images; a reference.
    for (name, count) in [
        (named(&cell.radiance, ".exr"), 2),
        (named(&cell.radiance, ".error.png"), 2),
        (named(&cell.id, ".flip.png"), 1),
        (named(&cell.reference, ".png"), 4),
        (named(&cell.reference, ".exr"), 8),
    ] {
        let dir = tempfile::tempdir().unwrap();
        let place = dir.path().join("images").join(&name);
        std::fs::create_dir_all(&place).unwrap();
        let outcome = invoke(&plan, dir.path(), &log(), usize::MAX).unwrap();
        assert_eq!(outcome.failures.len(), count, "{name}");
        assert!(outcome.failures.iter().all(|failure| failure.reason.contains(&name)), "{:?}", outcome.failures);
        let table = Table::read(&dir.path().join("errors.csv")).unwrap();
        let verdict = table.column("verdict").unwrap();
        assert_eq!(table.rows.iter().filter(|row| row[verdict] == "failed").count(), count);
        std::fs::remove_dir(&place).unwrap();
        assert!(invoke(&plan, dir.path(), &log(), usize::MAX).unwrap().failures.is_empty());
        assert!(contents(&dir.path().join("images")) == images, "{name}");
        assert!(read(dir.path().join("errors.csv")) == read(whole.path().join("errors.csv")));
        // The same in the place of an image of a finished cell.
        std::fs::remove_file(&place).unwrap();
        std::fs::create_dir(&place).unwrap();
        assert_eq!(invoke(&plan, dir.path(), &log(), usize::MAX).unwrap().failures.len(), count, "{name}");
    }
}

#[test]
fn a_lost_device_ends_the_run_and_keeps_what_is_done() {
    let (dir, plan) = (tempfile::tempdir().unwrap(), plan(EXPERIMENT));
    let log = log();
    log.borrow_mut().renders_left = Some(4);
    let error = invoke(&plan, dir.path(), &log, usize::MAX).unwrap_err();
    assert!(matches!(error, RunError::DeviceLost(_)), "{error}");
    // A reference and three images, each with two exposures.
    assert_eq!(Table::read(&dir.path().join("errors.csv")).unwrap().rows.len(), 6);
    log.borrow_mut().renders_left = None;
    assert!(invoke(&plan, dir.path(), &log, usize::MAX).unwrap().failures.is_empty());
}

#[test]
fn a_folder_of_something_else_is_refused() {
    let dir = tempfile::tempdir().unwrap();
    invoke(&plan(EXPERIMENT), dir.path(), &log(), usize::MAX).unwrap();
    let before = snapshot(dir.path());
    let other = plan(&EXPERIMENT.replace("[0.1, 0.5]", "[0.1, 0.6]"));
    let error = invoke(&other, dir.path(), &log(), usize::MAX).unwrap_err();
    assert!(error.to_string().contains("another plan of tiny, and of its 32 cells 16 would not be"), "{error}");
    let other = plan(&EXPERIMENT.replace("\"tiny\"", "\"small\""));
    let error = invoke(&other, dir.path(), &log(), usize::MAX).unwrap_err();
    assert!(error.to_string().contains("another experiment"), "{error}");
    assert_eq!(before, snapshot(dir.path()));

    let foreign = tempfile::tempdir().unwrap();
    std::fs::write(foreign.path().join("thesis.tex"), "years of work").unwrap();
    let error = invoke(&plan(EXPERIMENT), foreign.path(), &log(), usize::MAX).unwrap_err();
    assert!(error.to_string().contains("not a run"), "{error}");
    assert_eq!(snapshot(foreign.path()).len(), 1);
}

/// What a run that was killed early left is no table: who reads it is told the command that makes one.
#[test]
fn who_reads_a_run_without_tables_is_told_how_to_go_on() {
    let dir = tempfile::tempdir().unwrap();
    let (plan, again) = (plan(EXPERIMENT), "run the same command again: splitsum run tiny.toml");
    invoke(&plan, dir.path(), &log(), 3).unwrap();
    let note = notes(dir.path()).next().unwrap();
    assert!(note.contains(&format!("3 of {} cells are done", plan.cells.len())) && note.ends_with(again), "{note}");
    finished(&plan, dir.path());
    assert_eq!(notes(dir.path()).next(), None);
    std::fs::remove_file(dir.path().join("errors.csv")).unwrap();
    let error = Finished::read(dir.path()).unwrap_err().to_string();
    assert!(error.ends_with(again), "{error}");
}

/// A figure that was changed by hand is not taken for what was measured.
#[test]
fn an_edited_record_is_no_record() {
    let (dir, plan) = (tempfile::tempdir().unwrap(), plan(EXPERIMENT));
    finished(&plan, dir.path());
    let errors = read(dir.path().join("errors.csv"));
    let record = dir.path().join(format!("cells/{}.json", plan.cells[0].id));
    let text = String::from_utf8(read(&record)).unwrap();
    let place = text.find("\"mae\": \"").unwrap() + 8;
    std::fs::write(&record, format!("{}9{}", &text[..place], &text[place + 1..])).unwrap();
    let log = log();
    invoke(&plan, dir.path(), &log, usize::MAX).unwrap();
    assert_eq!(log.borrow().renders.len(), 1);
    assert!(read(dir.path().join("errors.csv")) == errors);
}

/// A resumed run must print what an uninterrupted one prints: no number of a record may move by a last bit when it is read back.
#[test]
fn every_number_survives_its_record() {
    let mut word = crate::pixels::words(7);
    let numbers = std::iter::repeat_with(|| f64::from_bits(word())).filter(|x| x.is_finite()).take(100_000);
    for number in numbers.chain([0.06051336572016566, 5e-324, f64::MAX]) {
        let text = serde_json::to_string(&number).unwrap();
        let back: f64 = serde_json::from_str(&text).unwrap();
        assert_eq!(back.to_bits(), number.to_bits(), "{number} became {back}");
    }
}
