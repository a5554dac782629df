//! Reading the folder of a run in progress: the answers cover its finished cells and say so.

use crate::run::runs::{invoke, log, plan, read, written};
use crate::run::whole::EXPERIMENT;
use splitsum::report::page::{PageOptions, PageRun, write};
use splitsum::run::store::Store;
use splitsum::study::finished::{Finished, notes};

#[test]
fn a_run_in_progress_has_the_tables_of_its_finished_cells() {
    let (dir, plan) = (tempfile::tempdir().unwrap(), plan(EXPERIMENT));
    let dir = dir.path();
    invoke(&plan, dir, &log(), 7).unwrap();
    let early = read(dir.join("errors.csv"));
    invoke(&plan, dir, &log(), 10).unwrap();
    // A run writes its tables at intervals, so some records are not in them yet.
    std::fs::write(dir.join("errors.csv"), early).unwrap();
    let error = Finished::read(dir).unwrap_err().to_string();
    assert!(error.contains("7 rows, but the folder has records of 17 cells: the table is truncated"), "{error}");

    let at_work = Store::open(dir, &plan).unwrap();
    let note = format!("{}: in progress: 7 of 32 cells", dir.display());
    let run = Finished::read(dir).unwrap();
    assert_eq!(run.under_way_note().as_ref(), Some(&note));
    assert!(written(dir).record.cells == 7 && notes(dir).next().is_none());
    let options = PageOptions { out: dir.join("now.html"), ..PageOptions::in_folder(dir) };
    let page = write(&options, &PageRun::of_runs(&[super::page::read(dir)])).unwrap();
    assert_eq!(page.notes.first(), Some(&note));
    assert!(String::from_utf8(read(&page.path)).unwrap().contains("7 of 32 cells are done: the run is in progress."));
    std::fs::remove_file(dir.join("errors.csv")).unwrap();
    let error = Finished::read(dir).unwrap_err().to_string();
    assert!(error.contains("the run in progress has not written a table yet"), "{error}");

    drop(at_work);
    invoke(&plan, dir, &log(), usize::MAX).unwrap();
    assert_eq!(Finished::read(dir).unwrap().under_way_note(), None);
}
