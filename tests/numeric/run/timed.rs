//! Timings of runs with a renderer whose times are known.

use super::runs::{invoke, log, plan, snapshot};
use super::whole::EXPERIMENT;
use splitsum::base::csv::Table;
use std::collections::BTreeMap;

#[test]
fn timings_are_taken_once_a_configuration_and_kept() {
    let (dir, log) = (tempfile::tempdir().unwrap(), log());
    let plan = plan(&format!("{EXPERIMENT}[timing]\nwarmup = 1\nrounds = 10\n"));
    invoke(&plan, dir.path(), &log, usize::MAX).unwrap();
    // Two models, each with the tables of two methods, three sample counts and split-sum; alpha and
    // exposure do not count.
    assert_eq!(log.borrow().timings, (4 + 8) * (1 + 10));
    assert_eq!(
        log.borrow().warmups,
        8 * 10,
        "a short frame after each change of configuration"
    );
    let table = Table::read(&dir.path().join("timings.csv")).unwrap();
    assert_eq!(table.rows.len(), 4 + 8 * 2);
    let (pass, phase) = (
        table.column("pass").unwrap(),
        table.column("phase").unwrap(),
    );
    let numbers = |name: &str| {
        crate::table::numbers(&table, name)
            .into_iter()
            .map(Option::unwrap)
            .collect::<Vec<f64>>()
    };
    let samples = crate::table::numbers(&table, "samples");
    for (i, row) in table.rows.iter().enumerate() {
        if row[pass] == "shade-specular" {
            // Samples n, n + 1, ... n + 4, each twice; split-sum draws none, which the fake counts
            // as 1.
            let n = samples[i].unwrap_or(1.0);
            let found = ["median_lo_ms", "median_ms", "median_hi_ms"].map(|name| numbers(name)[i]);
            // Of ten samples, the second from each end.
            let expected = [n, n + 2.0, n + 4.0];
            assert!(
                found
                    .iter()
                    .zip(expected)
                    .all(|(f, e)| (f - e).abs() < 1e-12),
                "{found:?} {expected:?}"
            );
        }
        let check = if row[phase] == "precompute" {
            "mostly-outside-passes"
        } else {
            "ok"
        };
        assert_eq!(row[table.column("wall_check").unwrap()], check);
        assert_eq!(row[table.column("device_type").unwrap()], "cpu");
    }
}

/// A frame of many samples fills the caches in a small part of its time.
#[test]
fn long_frames_follow_a_change_of_configuration_at_once() {
    let (dir, log) = (tempfile::tempdir().unwrap(), log());
    let samples = EXPERIMENT.replace("[1, 4, 16]", "[1, 64, 256]");
    let plan = plan(&format!("{samples}[timing]\nwarmup = 1\nrounds = 10\n"));
    invoke(&plan, dir.path(), &log, usize::MAX).unwrap();
    // Of each of two models, one sample and split-sum.
    assert_eq!(log.borrow().warmups, 4 * 10);
}

#[test]
fn compared_configurations_are_timed_in_the_same_rounds_in_changing_order() {
    let (dir, log) = (tempfile::tempdir().unwrap(), log());
    let lights = EXPERIMENT.replace(
        "constant\"",
        "constant\", \"tests/golden/exr/dwa-decoded.exr\"",
    );
    let plan = plan(&format!("{lights}[timing]\nwarmup = 1\nrounds = 20\n"));
    invoke(&plan, dir.path(), &log, usize::MAX).unwrap();
    let mut blocks: BTreeMap<String, Vec<Vec<u64>>> = BTreeMap::new();
    for (name, (bytes, _)) in snapshot(&dir.path().join("timings")) {
        let record: serde_json::Value =
            serde_json::from_slice(&bytes).unwrap_or_else(|e| panic!("{name}: {e}"));
        let orders = record["rounds"]
            .as_array()
            .unwrap()
            .iter()
            .map(|place| place["order"].as_u64().unwrap());
        if record["phase"] == "frame" {
            blocks
                .entry(record["block"].as_str().unwrap().to_owned())
                .or_default()
                .push(orders.collect());
        }
    }
    assert_eq!(blocks.len(), 4, "one for each model and size of a map");
    for orders in blocks.values() {
        assert_eq!(orders.len(), 4, "three sample counts and split-sum");
        for round in 0..20 {
            let mut places: Vec<u64> = orders.iter().map(|of_one| of_one[round]).collect();
            places.sort_unstable();
            assert_eq!(places, [0, 1, 2, 3], "each once a round");
        }
        for of_one in orders {
            assert!(
                (0..4).all(|place| of_one.contains(&place)),
                "in every place at some time: {of_one:?}"
            );
        }
    }
}
