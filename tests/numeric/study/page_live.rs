//! What a run leaves for the live view, and what of it a report takes.

use crate::study::page::{finished_run, read};
use base64::Engine;
use base64::prelude::BASE64_STANDARD;
use splitsum::pixels::packed::HALF_MAX;
use splitsum::precompute::points;
use splitsum::runner::live::{LIVE_FILE, LiveRecord, half_scale};
use splitsum::study::page::Told;
use splitsum::study::page::live::{BUDGET_BYTES, Light};
use std::path::Path;

fn record(run: &Path) -> LiveRecord {
    serde_json::from_str(&std::fs::read_to_string(run.join(LIVE_FILE)).unwrap()).unwrap()
}

fn light(run: &Path, budget: usize) -> Light {
    Light::collect(&Told::of_runs(&[read(run)]), budget)
}

#[test]
fn half_scales_are_the_least_powers_of_two_that_fit() {
    for (largest, scale) in
        [(0.0, 1.0), (1.0, 1.0), (65_504.0, 1.0), (65_505.0, 2.0), (131_009.0, 4.0), (1e9, 16_384.0)]
    {
        assert_eq!(half_scale(largest), scale, "{largest}");
        assert!(largest / scale <= HALF_MAX);
    }
}

#[test]
fn a_run_leaves_its_tables_and_the_report_its_points() {
    let dir = tempfile::tempdir().unwrap();
    let run = finished_run(dir.path());
    let light = light(&run, BUDGET_BYTES);
    assert_eq!((light.environments.len(), light.lobes.len(), light.notes.len()), (1, 1, 0));
    assert_eq!((light.environments[0].label.as_str(), light.environments[0].levels[0].size), ("constant", [8, 4]));
    assert_eq!((light.lobes[0].brdf.as_str(), light.lobes[0].masking.as_str()), ("ggx", "separable"));
    let of_16 = light.points.iter().find(|table| table.count == 16).unwrap();
    let bytes = BASE64_STANDARD.decode(&of_16.base64).unwrap();
    let numbers: Vec<f32> = bytes.chunks_exact(4).map(|b| f32::from_le_bytes([b[0], b[1], b[2], b[3]])).collect();
    assert_eq!(numbers, points::table(16, &splitsum::math::sequence::SEQUENCES[0], 0).concat());
}

#[test]
fn tables_beyond_the_budget_lose_their_finest_levels_then_whole_environments() {
    let dir = tempfile::tempdir().unwrap();
    let run = finished_run(dir.path());
    let mut record = record(&run);
    let mut second = record.environments[0].clone();
    second.label = "second".to_owned();
    for (k, level) in record.environments[0].levels.iter_mut().enumerate() {
        level.size = [1024 >> k, 512 >> k];
        level.base64 = "A".repeat(4096 >> k);
    }
    record.environments.push(second);
    std::fs::write(run.join(LIVE_FILE), serde_json::to_string(&record).unwrap()).unwrap();
    let whole = light(&run, BUDGET_BYTES);
    assert_eq!((whole.environments[0].first_level, whole.environments.len()), (0, 2));
    let bytes = |light: &Light| light.environments[0].levels.iter().map(|level| level.base64.len()).sum::<usize>();
    let rest = serde_json::to_string(&light(&run, 0).environments[0]).unwrap().len();
    assert!(rest > 0);
    let reduced = light(&run, bytes(&whole) + 1000 - 4096);
    assert_eq!((reduced.environments[0].first_level, reduced.environments[0].levels[0].size), (1, [512, 256]));
    // 256 texels stay, whatever the budget; then the last environments go.
    let least = light(&run, 0);
    assert_eq!((least.environments.len(), least.environments[0].levels[0].size), (1, [256, 128]));
    assert!(least.notes[0].contains("1 more environment"), "{:?}", least.notes);
}

#[test]
fn a_missing_or_broken_file_is_a_note_and_no_failure() {
    let dir = tempfile::tempdir().unwrap();
    let run = finished_run(dir.path());
    let whole = std::fs::read_to_string(run.join(LIVE_FILE)).unwrap();
    for text in ["{", "{\"environments\": [], \"lobes\": [], \"left_out\": 0}", "[1]"] {
        std::fs::write(run.join(LIVE_FILE), text).unwrap();
        let light = light(&run, BUDGET_BYTES);
        assert!(light.environments.is_empty() && light.notes[0].contains(LIVE_FILE), "{text}: {:?}", light.notes);
    }
    std::fs::remove_file(run.join(LIVE_FILE)).unwrap();
    assert!(light(&run, BUDGET_BYTES).notes[0].contains("has no live.json"));
    // The same run again does what is missing without a renderer only where nothing else is.
    std::fs::write(run.join(LIVE_FILE), &whole).unwrap();
    assert_eq!(finished_run(dir.path()), run);
    assert_eq!(std::fs::read_to_string(run.join(LIVE_FILE)).unwrap(), whole);
}
