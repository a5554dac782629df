//! Attempts at chunks that are repeated, killed, or fail, and the run that a merge makes of them.

use super::{Bench, CELLS, log};
use crate::run::runs::{read, rewrite};
use splitsum::run::RunError;
use splitsum::run::chunk::ChunkError;
use splitsum::run::timing::{self, TimingRecord};
use splitsum::table::csv::Table;
use std::path::Path;

#[test]
fn a_merge_is_the_run_of_one_machine() {
    let bench = Bench::new(0.3);
    let whole = bench.whole();
    let count = bench.file.chunks.len();
    assert!(count > 4, "{count}");
    // The last first: the order is nothing.
    for chunk in (0..count).rev() {
        bench.chunk_on("fake", chunk);
        assert_eq!(bench.chunk_on("fake", chunk), 0, "what is done is not done again");
        assert_eq!(bench.attempts(chunk).len(), 1);
    }
    let merged = bench.merge().unwrap();
    assert!(merged.holes.is_empty() && merged.notes.is_empty() && merged.outcome.failures.is_empty());
    for name in ["errors.csv", "errors_by_n_dot_v.csv", "images.csv", "experiment.toml"] {
        assert!(read(bench.path("merged").join(name)) == read(whole.join(name)), "{name} differs");
    }
    for folder in ["", "images", "references", "tables", "cells", "timings", "failed"] {
        // What the tables say is written by who asks for it.
        let is_of_the_run = |name: &String| !["answers", "summary.md"].contains(&name.as_str());
        let files = |root: &Path| bench.names(&root.join(folder)).into_iter().filter(is_of_the_run).collect::<Vec<_>>();
        assert_eq!(files(&bench.path("merged")), files(&whole), "{folder}");
    }
    for name in bench.names(&whole.join("images")) {
        assert!(
            read(bench.path("merged/images").join(&name)) == read(whole.join("images").join(&name)),
            "{name} differs"
        );
    }
    let provenance: serde_json::Value = serde_json::from_slice(&read(bench.path("merged/provenance.json"))).unwrap();
    assert_eq!(provenance["sessions"].as_array().unwrap().len(), count);
    assert_eq!(provenance["sessions"][2]["chunk"], 2);
    let before = read(bench.path("merged/provenance.json"));
    bench.merge().unwrap();
    assert!(read(bench.path("merged/provenance.json")) == before, "a second merge changes nothing");
}

#[test]
fn a_lost_device_leaves_its_reason_and_the_next_attempt_goes_on() {
    let bench = Bench::new(100.0);
    let lost = log("fake");
    lost.borrow_mut().renders_left = Some(12);
    let error = bench.chunk(0, &lost).unwrap_err();
    assert!(matches!(error, ChunkError::Run(RunError::DeviceLost(_))), "{error}");
    let done = bench.names(&bench.attempts(0)[0].join("cells")).len();
    assert!((1..CELLS).contains(&done), "{done}");
    let merged = bench.merge().unwrap();
    let [hole] = merged.holes.as_slice() else { panic!("{:?}", merged.holes) };
    assert_eq!((hole.chunk, hole.cells.len()), (0, CELLS - done));
    assert!(hole.block_count > 0 && hole.last.contains("unplugged"), "{hole:?}");
    assert_eq!(Table::read(&bench.path("merged/errors.csv")).unwrap().rows.len(), done);

    let renders = bench.chunk_on("fake", 0);
    assert!(renders < 40, "{renders} renders: all of it was done again");
    assert_eq!(bench.names(&bench.attempts(0)[1].join("cells")).len(), CELLS - done);
    assert!(bench.merge().unwrap().holes.is_empty());
    assert!(read(bench.path("merged/errors.csv")) == read(bench.whole().join("errors.csv")));
}

#[test]
fn a_cell_that_fails_keeps_its_reason_until_an_attempt_succeeds() {
    let bench = Bench::new(100.0);
    let broken = log("fake");
    broken.borrow_mut().broken_method = Some("split-sum");
    let outcome = bench.chunk(0, &broken).unwrap();
    assert_eq!(outcome.failures.len(), 16);
    let merged = bench.merge().unwrap();
    assert!(merged.holes.is_empty(), "{:?}", merged.holes);
    assert_eq!(merged.outcome.failures.len(), 16);
    assert!(merged.outcome.failures.iter().all(|failure| failure.reason.contains("the shader is broken")));
    bench.chunk_on("fake", 0);
    assert!(bench.merge().unwrap().outcome.failures.is_empty());
    assert!(read(bench.path("merged/errors.csv")) == read(bench.whole().join("errors.csv")));
}

#[test]
fn a_block_of_timings_without_all_its_records_is_timed_anew_as_a_whole() {
    let bench = Bench::new(100.0);
    bench.chunk_on("fake", 0);
    let jobs = timing::jobs(&bench.plan);
    let block = bench.file.chunks[0].blocks(&jobs).into_iter().find(|block| block.len() > 1).unwrap();
    let first = bench.attempts(0)[0].join("timings");
    std::fs::remove_file(first.join(format!("{}.json", block[1]))).unwrap();
    let hole = bench.merge().unwrap().holes.remove(0);
    assert_eq!((hole.cells.len(), hole.block_count), (0, 1));
    bench.chunk_on("fake", 0);
    let second = bench.attempts(0)[1].join("timings");
    assert_eq!(bench.names(&second), block.iter().map(|id| format!("{id}.json")).collect());
    // What the second attempt measured must be recognisable.
    for id in &block {
        rewrite(&second.join(format!("{id}.json")), |record| record["driver"] = "second".into());
    }
    assert!(bench.merge().unwrap().holes.is_empty());
    for id in &block {
        let record: TimingRecord =
            serde_json::from_slice(&read(bench.path(&format!("merged/timings/{id}.json")))).unwrap();
        assert_eq!(record.driver, "second", "samples of two attempts were mixed");
    }
}
