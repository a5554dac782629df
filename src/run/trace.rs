//! Timed passes as a Chrome trace, which Perfetto and chrome://tracing open.

use super::timing::TimingRecord;
use serde_json::{Value, json};

/// One complete event for each pass of each round; `ts` and `dur` in µs. Rounds stand where they were measured, the passes of a round one
/// after the other: their gaps are not known. Each block of compared configurations is a process, each configuration a thread.
pub fn chrome_trace(records: &[TimingRecord]) -> Value {
    let mut blocks: Vec<&str> = Vec::new();
    let mut events = Vec::new();
    for (thread, record) in records.iter().enumerate() {
        let process = blocks.iter().position(|block| *block == record.block).unwrap_or_else(|| {
            blocks.push(&record.block);
            blocks.len() - 1
        });
        let words: Vec<&str> = record.axes.values().map(String::as_str).filter(|value| !value.is_empty()).collect();
        let name = format!("{} {} ({})", record.phase, words.join(" "), record.device_type);
        let ids = |mut event: Value| {
            event["pid"] = json!(process);
            event["tid"] = json!(thread);
            event
        };
        events.push(ids(json!({ "ph": "M", "name": "thread_name", "args": { "name": name } })));
        for (round, place) in record.rounds.iter().enumerate() {
            let mut start_us = place.start_s * 1e6;
            for pass in &record.passes {
                let Some(ms) = pass.ms.get(round) else { continue };
                let arguments = json!({ "round": round, "order": place.order });
                events.push(ids(json!({
                    "ph": "X", "name": pass.pass, "cat": record.phase, "ts": start_us, "dur": ms * 1e3, "args": arguments
                })));
                start_us += ms * 1e3;
            }
        }
    }
    json!({ "traceEvents": events, "displayTimeUnit": "ms" })
}
