//! The times of a run as the page draws them: passes of each timed configuration, and when tables that are made once have paid for themselves.

use crate::experiment::answers::run_folder::RunFolder;
use crate::experiment::timing::{TimingRecord, summarize};
use crate::experiment::timing_ratios::ratios;
use serde_json::{Value, json};

/// Every timed configuration with the median of each pass and that of their sum: round by round, so that it is not the sum of the medians.
pub fn records(run: &RunFolder) -> Vec<Value> {
    let record = |record: &TimingRecord| {
        json!({
            "phase": record.phase,
            "axes": record.axes,
            "size": record.size,
            "environment_size": record.environment_size,
            "device": record.device,
            "device_type": record.device_type,
            "wall_check": record.wall_check(),
            "total": summarize(&record.sums_ms()).median,
            "passes": record.passes.iter()
                .map(|pass| json!([pass.pass, summarize(&pass.ms).median])).collect::<Vec<_>>(),
        })
    };
    run.timings.iter().map(record).collect()
}

/// Every pair of a sampling method and one without samples that was timed in the same rounds.
pub fn paybacks(run: &RunFolder) -> Vec<Value> {
    let pairs = ratios(&run.timings);
    let payback = |pair: &crate::experiment::timing_ratios::Ratio| {
        json!({
            "sampled": pair.sampled.axes,
            "fixed": pair.fixed.axes,
            "device": pair.fixed.device,
            "environment_size": pair.fixed.environment_size,
            "ratio": pair.ratio,
            "interval": pair.interval,
            "rounds": pair.rounds,
            "tables_ms": pair.tables_ms,
            "frames": pair.payback.frames(),
            "payback": pair.payback.to_string(),
        })
    };
    pairs.iter().map(payback).collect()
}
