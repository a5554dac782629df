//! What the tables of each method cost, which are made once for each environment or model.

use super::run_folder::RunFolder;
use super::study::{RUN_AXIS, Study};
use crate::runner::timing::{Key, PRECOMPUTE, PassSamples, Summary, TimingRecord, summarize};

/// One pass of one timed configuration.
#[derive(Clone, Debug, PartialEq)]
pub struct TableTime {
    /// Label of the run; empty where it is the only one.
    pub run: String,
    pub environment_size: [u32; 2],
    /// All other axes that tell sets of tables apart, with those of the method that needs them.
    pub key: Key,
    pub pass: String,
    /// Over the rounds, ms.
    pub ms: Summary,
    /// Whether it comes from a CPU driver, which says nothing about a GPU.
    pub is_cpu: bool,
}

impl TableTime {
    /// The value of an axis; empty where the tables do not depend on it.
    pub fn axis(&self, name: &str) -> &str {
        self.key.get(name).map_or("", String::as_str)
    }
}

/// Every timed pass that makes a table, in the order of the records.
pub fn table_times(study: &Study, runs: &[RunFolder]) -> Vec<TableTime> {
    let label = |run: usize| match study.rows.iter().find(|row| row.run == run) {
        Some(row) if runs.len() > 1 => study.value(row, RUN_AXIS).to_owned(),
        _ => String::new(),
    };
    let of_record = |run: &str, record: &TimingRecord| {
        let time = |pass: &PassSamples| TableTime {
            run: run.to_owned(),
            environment_size: record.environment_size,
            key: record.key(),
            pass: pass.pass.clone(),
            ms: summarize(&pass.ms),
            is_cpu: record.device_type == "cpu",
        };
        record.passes.iter().map(time).collect::<Vec<_>>()
    };
    let of_run = |(run, folder): (usize, &RunFolder)| {
        let (label, records) = (label(run), folder.timings.iter());
        let times = records.filter(|record| record.phase == PRECOMPUTE).flat_map(|record| of_record(&label, record));
        times.collect::<Vec<_>>()
    };
    runs.iter().enumerate().flat_map(of_run).collect()
}
