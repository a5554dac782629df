//! What the tables of each method cost, which are made once for each environment or model.

use super::run_folder::RunFolder;
use crate::experiment::timing::{PRECOMPUTE, PassSamples, Summary, TimingRecord, summarize};

/// One pass of one timed configuration.
#[derive(Clone, Debug, PartialEq)]
pub struct TableTime {
    pub environment_size: [u32; 2],
    pub brdf: String,
    pub method: String,
    pub diffuse: String,
    pub pass: String,
    /// Over the rounds, ms.
    pub ms: Summary,
    /// Whether it comes from a CPU driver, which says nothing about a GPU.
    pub is_cpu: bool,
}

/// Every timed pass that makes a table, in the order of the records.
pub fn table_times(runs: &[RunFolder]) -> Vec<TableTime> {
    let records = runs.iter().flat_map(|run| &run.timings).filter(|record| record.phase == PRECOMPUTE);
    let of_record = |record: &TimingRecord| {
        let axis = |name: &str| record.axes.get(name).cloned().unwrap_or_default();
        let time = |pass: &PassSamples| TableTime {
            environment_size: record.environment_size,
            brdf: axis("brdf"),
            method: axis("method"),
            diffuse: axis("diffuse"),
            pass: pass.pass.clone(),
            ms: summarize(&pass.ms),
            is_cpu: record.device_type == "cpu",
        };
        record.passes.iter().map(time).collect::<Vec<_>>()
    };
    records.flat_map(of_record).collect()
}
