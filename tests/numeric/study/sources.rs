//! A finished run is the same from memory and from its files.

use crate::runner::run::EXPERIMENT;
use crate::runner::runs::{invoke, log, plan};
use splitsum::runner::columns::{CELL, TABLES};
use splitsum::runner::store::Store;
use splitsum::study::finished::Finished;
use splitsum::table::csv::Table;

#[test]
fn memory_and_files_tell_the_same() {
    let text = format!("{EXPERIMENT}[timing]\nwarmup = 1\nrounds = 3\n");
    let (dir, plan) = (tempfile::tempdir().unwrap(), plan(&text));
    let broken = log();
    broken.borrow_mut().broken_method = Some("split-sum");
    let outcome = invoke(&plan, dir.path(), &broken, usize::MAX).unwrap();
    let store = Store::at(dir.path());
    let memory = Finished::of_run(&plan, &store, &outcome.results, &outcome.timings).unwrap();
    let files = Finished::read(dir.path()).unwrap();
    assert_eq!(memory.cells.len(), 32);
    assert_eq!(memory.failed_count(), 8);
    assert_eq!(format!("{:?}", memory.cells), format!("{:?}", files.cells));
    assert_eq!(memory.lights, files.lights);
    assert_eq!((memory.failures.len(), memory.timings.len()), (files.failures.len(), files.timings.len()));
    assert_eq!((memory.provenance, memory.experiment), (files.provenance, files.experiment));
}

#[test]
fn every_column_of_every_table_is_explained() {
    let text = format!("printed_slips = true\n{EXPERIMENT}[timing]\nwarmup = 1\nrounds = 3\n");
    let (dir, plan) = (tempfile::tempdir().unwrap(), plan(&text));
    invoke(&plan, dir.path(), &log(), usize::MAX).unwrap();
    let axes = splitsum::runner::axis::Named::all().map(|axis| axis.name());
    let metrics: Vec<&str> = splitsum::metrics::METRICS.iter().map(|metric| metric.description().name).collect();
    let known: Vec<&str> = axes.chain(metrics.iter().copied()).chain([CELL.name]).collect();
    for (file, columns, _) in TABLES {
        let table = Table::read(&dir.path().join(file)).unwrap();
        for name in &table.columns {
            let bare = name.strip_suffix("_noise_floor").unwrap_or(name);
            let is_told = known.contains(&bare) || columns.iter().any(|column| column.name == *name);
            assert!(is_told, "{file}: the column {name} is not explained");
        }
        for column in *columns {
            assert!(table.columns.iter().any(|name| name == column.name), "{file} has no column {}", column.name);
        }
    }
}
