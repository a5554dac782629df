//! The folder of a run in progress has no answers yet.

use crate::run::runs::{invoke, log, plan, read};
use crate::run::whole::EXPERIMENT;
use splitsum::run::store::Store;
use splitsum::study::finished::Finished;

#[test]
fn a_run_in_progress_has_no_answers_and_a_truncated_table_is_refused() {
    let (dir, plan) = (tempfile::tempdir().unwrap(), plan(EXPERIMENT));
    let dir = dir.path();
    invoke(&plan, dir, &log(), 7).unwrap();
    let early = read(dir.join("errors.csv"));
    invoke(&plan, dir, &log(), 10).unwrap();
    assert_eq!(Finished::read(dir).unwrap().cells.len(), 17);
    std::fs::write(dir.join("errors.csv"), early).unwrap();
    let error = Finished::read(dir).unwrap_err().to_string();
    assert!(error.contains("7 rows, but the folder has records of 17 cells: the table is truncated"), "{error}");
    let at_work = Store::open(dir, &plan).unwrap();
    let error = Finished::read(dir).unwrap_err().to_string();
    assert!(error.contains("a run is using the folder"), "{error}");
    drop(at_work);
    invoke(&plan, dir, &log(), usize::MAX).unwrap();
    assert_eq!(Finished::read(dir).unwrap().cells.len(), 32);
}
