//! Files of a run that are whole but not what their names say, or not what the program wrote.

use super::resume::Notes;
use super::run::EXPERIMENT;
use super::runs::{fakes, finished, log, options, plan, read};
use splitsum::runner::store::Store;
use splitsum::runner::{MakeRenderer, Plan, RunError, run, timing};
use splitsum::study::finished::{Finished, notes};
use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;

/// Runs again what is not done, and returns what was told and how many images were rendered.
fn again(plan: &Plan, dir: &Path) -> Result<(Vec<String>, usize), RunError> {
    let (stop, log, mut notes) = (AtomicBool::new(false), log(), Notes::default());
    run(plan, &mut fakes(&log) as &mut MakeRenderer, &options(dir, &stop), &mut notes)?;
    let renders = log.borrow().renders.len();
    Ok((notes.0, renders))
}

fn swap(a: &Path, b: &Path) {
    let (of_a, of_b) = (read(a), read(b));
    std::fs::write(a, of_b).unwrap();
    std::fs::write(b, of_a).unwrap();
}

#[test]
fn a_record_under_another_name_is_none() {
    let (dir, plan) = (tempfile::tempdir().unwrap(), plan(&format!("{EXPERIMENT}[timing]\nwarmup = 1\nrounds = 3\n")));
    let store = Store::at(&finished(&plan, dir.path()));
    let table = read(dir.path().join("errors.csv"));
    let last = plan.cells.last().unwrap();
    swap(&store.cell_path(&plan.cells[0].id), &store.cell_path(&last.id));
    assert!(store.cell(&last.id).unwrap().is_none());
    let (told_by_run, renders) = again(&plan, dir.path()).unwrap();
    assert!(told_by_run.len() == 1 && told_by_run[0].contains(": 2, the first "), "{told_by_run:?}");
    assert!(renders > 0 && read(dir.path().join("errors.csv")) == table);

    let jobs = timing::jobs(&plan);
    let path = |id: &str| dir.path().join(format!("timings/{id}.json"));
    std::fs::copy(path(&jobs[0].id), path(&jobs[1].id)).unwrap();
    assert!(store.has_timing(&jobs[0].id) && !store.has_timing(&jobs[1].id));
    // Who reads the folder meanwhile counts it once, as the run does.
    let counted = Finished::read(dir.path()).unwrap().timings.len();
    assert_eq!(counted, jobs.len() - 1);
    std::fs::copy(path(&jobs[0].id), path("0123456789abcdef")).unwrap();
    assert_eq!(Finished::read(dir.path()).unwrap().timings.len(), counted);
    let told: Vec<String> = notes(dir.path()).collect();
    let words = format!("2 of {} timing records are damaged or another's and do not count", jobs.len() + 1);
    assert!(told.len() == 1 && told[0].contains(&words), "{told:?}");
    std::fs::remove_file(path("0123456789abcdef")).unwrap();
    again(&plan, dir.path()).unwrap();
    assert!(store.has_timing(&jobs[1].id) && notes(dir.path()).next().is_none());
}

#[test]
fn a_reference_record_that_cannot_be_used_is_made_anew() {
    let (dir, plan) = (tempfile::tempdir().unwrap(), plan(EXPERIMENT));
    let store = Store::at(&finished(&plan, dir.path()));
    let table = read(dir.path().join("errors.csv"));
    let (first, last) = (&plan.cells[0], plan.cells.last().unwrap());
    let path = |id: &str| dir.path().join(format!("references/{id}.json"));
    assert_ne!(first.reference, last.reference);
    for damage in
        [&|| std::fs::write(path(&first.reference), &read(path(&first.reference))[..30]).unwrap() as (), &|| {
            std::fs::copy(path(&last.reference), path(&first.reference)).unwrap();
        }] as [&dyn Fn(); 2]
    {
        damage();
        assert!(store.reference(&first.reference).unwrap().is_none());
        std::fs::remove_file(store.cell_path(&first.id)).unwrap();
        again(&plan, dir.path()).unwrap();
        assert!(store.reference(&first.reference).unwrap().is_some() && read(dir.path().join("errors.csv")) == table);
    }
}

#[test]
fn the_frozen_experiment_of_a_finished_run_comes_back() {
    let (dir, plan) = (tempfile::tempdir().unwrap(), plan(EXPERIMENT));
    finished(&plan, dir.path());
    assert_eq!(notes(dir.path()).next(), None);
    let path = dir.path().join("experiment.toml");
    let whole = read(&path);
    let provenance = read(dir.path().join("provenance.json"));
    for (damage, what) in [
        (&|| std::fs::write(&path, &whole[..20]).unwrap() as (), "is not the experiment that was run"),
        (&|| std::fs::remove_file(&path).unwrap(), "is missing"),
    ] as [(&dyn Fn(), &str); 2]
    {
        damage();
        assert!(notes(dir.path()).next().unwrap().contains(what));
        let (notes, renders) = again(&plan, dir.path()).unwrap();
        assert!(notes.len() == 1 && notes[0].contains("experiment.toml was not"), "{notes:?}");
        assert!(renders == 0 && read(&path) == whole && read(dir.path().join("provenance.json")) == provenance);
    }
    // The same cells from another text: the provenance names the new one.
    let other = super::runs::plan(&format!("# A comment.\n{EXPERIMENT}"));
    assert_eq!(other.hash, plan.hash);
    again(&other, dir.path()).unwrap();
    assert!(read(&path).starts_with(b"# A comment") && notes(dir.path()).next().is_none());
}

#[test]
fn a_provenance_that_is_none_is_refused_wherever_it_is_read() {
    let (dir, plan) = (tempfile::tempdir().unwrap(), plan(EXPERIMENT));
    finished(&plan, dir.path());
    let path: PathBuf = dir.path().join("provenance.json");
    let whole: serde_json::Value = serde_json::from_slice(&read(&path)).unwrap();
    let with = |version: serde_json::Value| {
        let mut changed = whole.clone();
        changed["schema_version"] = version;
        changed.to_string()
    };
    for (text, what) in [
        ("[1, 2, 3]".to_owned(), "holds no object"),
        ("{}".to_owned(), "no schema_version"),
        ("{\"schema".to_owned(), "not a provenance file of splitsum"),
        (with("2".into()), "not a whole number"),
        (with(2.into()), "format 2"),
    ] {
        std::fs::write(&path, text).unwrap();
        let Err(RunError::Store(error)) = again(&plan, dir.path()) else { panic!("{what}: went on") };
        assert!(error.is_misuse() && error.to_string().contains(what), "{what}: {error}");
        assert_eq!(Finished::read(dir.path()).unwrap_err().to_string(), error.to_string());
    }
}

#[test]
fn images_csv_names_nothing_outside_the_images() {
    let (dir, plan) = (tempfile::tempdir().unwrap(), plan(EXPERIMENT));
    finished(&plan, dir.path());
    let path = dir.path().join("images.csv");
    let text = String::from_utf8(read(&path)).unwrap();
    let name = Finished::read(dir.path()).unwrap().cells.into_iter().find_map(|cell| cell.images).unwrap().radiance;
    for stranger in ["../../../../etc/passwd", "..", "/etc/passwd", "a\\b", "a\u{1b}[31m"] {
        std::fs::write(&path, text.replacen(&name, stranger, 1)).unwrap();
        let error = Finished::read(dir.path()).unwrap_err().to_string();
        assert!(error.contains("images.csv") && error.contains("is not the name of an image"), "{error}");
    }
}
