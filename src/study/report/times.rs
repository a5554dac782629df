//! The times of a run as the page draws them: passes of each timed configuration, and when tables that are made once have paid for themselves.

use crate::runner::timing::{Key, TimingRecord, summarize};
use crate::runner::timing_ratios::{Ratio, TableCost, ratios};
use crate::study::answers::run_folder::RunFolder;
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

/// Every pair of a sampling method and one without samples that was timed in the same rounds, with each set of tables behind them. The axes
/// of `fixed` are those of its tables, too.
pub fn paybacks(run: &RunFolder) -> Vec<Value> {
    let pairs = ratios(&run.timings);
    let payback = |pair: &Ratio, tables: &TableCost| {
        // The page names a configuration by the axes of its record.
        let is_own = |name: &str| pair.fixed.axes.contains_key(name);
        let of_tables = tables.key.clone().into_iter().filter(|(name, _)| is_own(name));
        let fixed: Key = pair.fixed.axes.clone().into_iter().chain(of_tables).collect();
        json!({
            "sampled": pair.sampled.axes,
            "fixed": fixed,
            "device": pair.fixed.device,
            "environment_size": pair.fixed.environment_size,
            "ratio": pair.ratio,
            "interval": pair.interval,
            "rounds": pair.rounds,
            "tables_ms": tables.ms,
            "frames": tables.payback.frames(),
            "payback": tables.payback.to_string(),
        })
    };
    let asked = pairs.iter().filter(|pair| pair.has_payback());
    asked.flat_map(|pair| pair.tables.iter().map(|tables| payback(pair, tables)).collect::<Vec<_>>()).collect()
}
