//! Two methods timed together, and when tables have paid for themselves, of times that are known.

use splitsum::run::store::Store;
use splitsum::run::tables::timing_ratios;
use splitsum::run::timing::TimingRecord;
use splitsum::run::timing_ratios::{Payback, Verdict, ratios, verdict};
use splitsum::study::finished::Finished;
use splitsum::table::csv::Table;
use std::path::Path;

const AXES: [&str; 7] = ["brdf", "method", "diffuse", "samples", "masking", "storage_format", "prefilter_sample_count"];

/// A record of seven rounds that all take `ms`; `axes` by name, `passes` by name and time.
pub fn record(phase: &str, axes: &[(&str, &str)], passes: &[(&str, f64)]) -> TimingRecord {
    let value = |name: &str| axes.iter().find(|(axis, _)| *axis == name).map_or("", |(_, value)| *value);
    let all: serde_json::Map<_, _> = AXES.iter().map(|name| (name.to_string(), value(name).into())).collect();
    let passes: Vec<_> =
        passes.iter().map(|(pass, ms)| serde_json::json!({ "pass": pass, "ms": vec![*ms; 7] })).collect();
    // Blocks share what is not compared.
    let block = format!("{} {}", value("brdf"), value("masking"));
    serde_json::from_value(serde_json::json!({
        "cell": "0000", "phase": phase, "block": block, "environment_size": [8, 4], "size": [256, 256], "axes": all, "warmup": 1,
        "passes": passes, "wall_ms": vec![1.0; 7], "device": "slate", "device_type": "cpu", "driver": "pencil",
    }))
    .unwrap()
}

/// Tables of 40 and 382 ms by their samples, doubled by another masking; frames of 2 ms without samples and 6 with.
pub fn swept() -> Vec<TimingRecord> {
    let mut records = Vec::new();
    for (masking, factor) in [("separable", 1.0), ("height-correlated", 2.0)] {
        let of = |method: &'static str, further: &[(&'static str, &'static str)]| {
            [&[("brdf", "ggx"), ("diffuse", "none"), ("masking", masking), ("method", method)], further].concat()
        };
        for (samples, ms) in [("64", 30.0), ("1024", 372.0)] {
            let axes = of("split-sum", &[("prefilter_sample_count", samples), ("storage_format", "f32")]);
            let passes = [("mips", 2.0), ("prefilter mip 1", factor * ms), ("dfg", 8.0)];
            records.push(record("precompute", &axes, &passes));
        }
        records.push(record("precompute", &of("sampled", &[]), &[("mips", 2.0)]));
        records.push(record("precompute", &of("sampled-unfiltered", &[]), &[]));
        records.push(record("frame", &of("sampled", &[("samples", "40")]), &[("shade", 6.0)]));
        records.push(record("frame", &of("sampled-unfiltered", &[("samples", "40")]), &[("shade", 4.0)]));
        records.push(record("frame", &of("sampled-unfiltered", &[("samples", "16")]), &[("shade", 3.0)]));
        records.push(record("frame", &of("split-sum", &[("storage_format", "f32")]), &[("shade", 2.0)]));
    }
    records
}

#[test]
fn each_configuration_pays_for_its_own_tables() {
    let records = swept();
    let found = ratios(&records);
    let costs = |sampled: &str, masking: &str| -> Vec<(String, f64, Option<f64>)> {
        let is_it = |pair: &&splitsum::run::timing_ratios::Ratio| {
            pair.sampled.axes["method"] == sampled
                && pair.sampled.axes["samples"] == "40"
                && pair.fixed.axes["method"] == "split-sum"
                && pair.fixed.axes["masking"] == masking
        };
        let [pair] = found.iter().filter(is_it).collect::<Vec<_>>()[..] else { panic!("one pair of {sampled}") };
        let cost = |t: &splitsum::run::timing_ratios::TableCost| {
            (t.key["prefilter_sample_count"].clone(), t.ms, t.payback.frames())
        };
        pair.tables.iter().map(cost).collect()
    };
    // Frames of 6 against 2 ms pay 4 ms each; the mips are common.
    let expected = |less: f64, more: f64| {
        vec![("64".to_owned(), less, Some((less / 4.0).ceil())), ("1024".to_owned(), more, Some((more / 4.0).ceil()))]
    };
    assert_eq!(costs("sampled", "separable"), expected(38.0, 380.0));
    assert_eq!(costs("sampled", "height-correlated"), expected(68.0, 752.0));
    // A method without tables is one whose tables cost nothing; its frames take 2 ms more.
    let unfiltered = costs("sampled-unfiltered", "separable");
    assert!(unfiltered[0].1 == 40.0 && unfiltered[0].2 == Some(20.0), "{unfiltered:?}");

    let (columns, rows) = timing_ratios(&records);
    let key = |name: &str| columns.iter().position(|column| column == name).unwrap_or_else(|| panic!("no {name}"));
    let keys =
        ["environment_size", "size", "masking", "prefilter_sample_count", "sampled", "samples", "fixed"].map(key);
    let mut seen: Vec<String> =
        rows.iter().map(|row| format!("{:?}", keys.map(|column| row[column].clone()))).collect();
    seen.sort();
    seen.dedup();
    assert_eq!((seen.len(), rows.len()), (14, 14), "one row a key");
    assert!(!columns.contains(&"storage_format".to_owned()), "one format only");
}

#[test]
fn two_methods_of_one_kind_are_compared_at_the_same_count() {
    let records = swept();
    let found = ratios(&records);
    let alike: Vec<_> = found.iter().filter(|pair| pair.fixed.axes["method"] == "sampled-unfiltered").collect();
    assert_eq!(alike.len(), 2, "one a masking, at 40 samples only");
    for pair in alike {
        assert_eq!((pair.sampled.axes["method"].as_str(), pair.sampled.axes["samples"].as_str()), ("sampled", "40"));
        assert_eq!((pair.ratio, pair.verdict.to_string().as_str()), (1.5, "SLOW"));
        assert!(!pair.has_payback() && pair.tables.iter().all(|tables| tables.payback == Payback::NotAsked));
    }
    // Of two formats each is beside its own.
    let mut formats = Vec::new();
    for format in ["f32", "f16"] {
        for (method, samples) in [("sampled", "4"), ("split-sum", "")] {
            let axes = [("brdf", "ggx"), ("method", method), ("samples", samples), ("storage_format", format)];
            formats.push(record("frame", &axes, &[("shade", 1.0)]));
        }
    }
    assert_eq!(ratios(&formats).len(), 2);
}

/// Records of other maps, images and devices are another matter: each pair and its tables are those found without the others.
#[test]
fn records_of_other_sizes_and_devices_change_no_ratio() {
    let changes: [fn(&mut TimingRecord); 4] = [
        |_| (),
        |record| (record.environment_size, record.block) = ([16, 8], record.block.clone() + " large map"),
        |record| (record.size, record.block) = ([512; 2], record.block.clone() + " large image"),
        |record| record.device += " pro",
    ];
    let kinds = (1..).zip(changes).map(|(slower, change)| {
        let mut records = swept();
        for record in &mut records {
            change(record);
            record.passes.iter_mut().flat_map(|pass| &mut pass.ms).for_each(|ms| *ms *= f64::from(slower));
        }
        records
    });
    let kinds: Vec<Vec<TimingRecord>> = kinds.collect();
    let sorted = |mut texts: Vec<String>| {
        texts.sort();
        texts
    };
    let found = |records: &[TimingRecord]| ratios(records).iter().map(|pair| format!("{pair:?}")).collect::<Vec<_>>();
    let apart = kinds.iter().flat_map(|records| found(records)).collect();
    assert_eq!(sorted(found(&kinds.concat())), sorted(apart));
}

#[test]
fn the_published_ratios_are_those_of_their_records() {
    let name = "timing";
    let dir = Path::new(env!("CARGO_MANIFEST_DIR")).join("results").join(name);
    let published = Table::read(&dir.join("timing_ratios.csv")).unwrap();
    let (columns, rows) = timing_ratios(&Finished::read(&dir).unwrap().timings);
    let made = tempfile::tempdir().unwrap();
    Store::at(made.path()).write_table("made.csv", &columns, rows.into_iter().map(Ok)).unwrap();
    let mut made = Table::read(&made.path().join("made.csv")).unwrap();
    // The run has its records in plan order, the folder by the names of their files.
    let mut rows = published.rows.clone();
    made.rows.sort();
    rows.sort();
    assert_eq!((made.columns, made.rows), (published.columns, rows), "{name}");
}

#[test]
fn tables_are_paid_only_where_the_ratio_is_decided() {
    // A frame of 2 ms, tables of 30 ms.
    let of = |ratio, interval, rounds| Payback::new(ratio, interval, rounds, 2.0, 30.0);
    assert_eq!(of(2.0, [1.75, 2.5], 15), Payback::Frames { count: 15.0, interval: [10.0, 20.0] });
    assert_eq!(of(2.0, [1.75, 2.5], 15).to_string(), "15 (10 to 20)");
    assert_eq!(of(0.5, [0.4, 0.6], 15), Payback::Never);
    for (ratio, interval, rounds, said, why) in [
        (
            1.2,
            [0.9, 1.5],
            15,
            Verdict::Ambiguous,
            "not decided: the interval of the ratio leaves open whose frames are faster",
        ),
        (2.0, [1.75, 2.5], 5, Verdict::Ambiguous, "not decided: too few rounds for an interval"),
        (1.005, [1.0, 1.01], 15, Verdict::Same, "not decided: frames within 2 % of each other"),
    ] {
        assert_eq!(verdict(interval, rounds), said);
        let payback = of(ratio, interval, rounds);
        assert_eq!((payback.frames(), payback.to_string().as_str()), (None, why));
    }
    assert_eq!(Payback::new(2.0, [1.75, 2.5], 15, 2.0, f64::NAN), Payback::NotTimed);
}
