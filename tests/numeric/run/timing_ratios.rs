//! Two methods timed together, with known times.

use splitsum::base::csv::Cell;
use splitsum::run::tables::timings;
use splitsum::run::timing::TimingRecord;
use splitsum::run::timing_ratios::ratios;

const AXES: [&str; 7] = [
    "brdf",
    "method",
    "diffuse",
    "samples",
    "masking",
    "storage_format",
    "prefilter_sample_count",
];

/// A record of seven rounds that all take `ms`; `axes` by name, `passes` by name and time.
pub fn record(phase: &str, axes: &[(&str, &str)], passes: &[(&str, f64)]) -> TimingRecord {
    let value = |name: &str| {
        axes.iter()
            .find(|(axis, _)| *axis == name)
            .map_or("", |(_, value)| *value)
    };
    let all: serde_json::Map<_, _> = AXES
        .iter()
        .map(|name| (name.to_string(), value(name).into()))
        .collect();
    let passes: Vec<_> = passes
        .iter()
        .map(|(pass, ms)| serde_json::json!({ "pass": pass, "ms": vec![*ms; 7] }))
        .collect();
    // Blocks share the axes that are not compared.
    let block = format!("{} {}", value("brdf"), value("masking"));
    serde_json::from_value(serde_json::json!({
        "cell": "0000000000000000", "phase": phase, "block": block, "environment_size": [8, 4], "size": [256, 256], "axes": all, "warmup": 1,
        "passes": passes, "wall_ms": vec![1.0; 7], "device": "slate", "device_type": "cpu", "driver": "pencil",
    }))
    .unwrap()
}

/// Tables of 40 and 382 ms by their samples, doubled by another masking; frames of 2 ms without
/// samples and 6 with.
pub fn swept() -> Vec<TimingRecord> {
    let mut records = Vec::new();
    for (masking, factor) in [("separable", 1.0), ("height-correlated", 2.0)] {
        let of = |method: &'static str, further: &[(&'static str, &'static str)]| {
            [
                &[
                    ("brdf", "ggx"),
                    ("diffuse", "none"),
                    ("masking", masking),
                    ("method", method),
                ],
                further,
            ]
            .concat()
        };
        for (samples, ms) in [("64", 30.0), ("1024", 372.0)] {
            let axes = of(
                "split-sum",
                &[
                    ("prefilter_sample_count", samples),
                    ("storage_format", "f32"),
                ],
            );
            let passes = [
                ("mips", 2.0),
                ("prefilter mip 1", factor * ms),
                ("dfg", 8.0),
            ];
            records.push(record("precompute", &axes, &passes));
        }
        records.push(record("precompute", &of("sampled", &[]), &[("mips", 2.0)]));
        records.push(record("precompute", &of("sampled-unfiltered", &[]), &[]));
        records.push(record(
            "frame",
            &of("sampled", &[("samples", "40")]),
            &[("shade-specular", 6.0)],
        ));
        records.push(record(
            "frame",
            &of("sampled-unfiltered", &[("samples", "40")]),
            &[("shade-specular", 4.0)],
        ));
        records.push(record(
            "frame",
            &of("sampled-unfiltered", &[("samples", "16")]),
            &[("shade-specular", 3.0)],
        ));
        records.push(record(
            "frame",
            &of("split-sum", &[("storage_format", "f32")]),
            &[("shade-specular", 2.0)],
        ));
    }
    records
}

#[test]
fn two_methods_of_one_kind_are_compared_at_the_same_count() {
    let records = swept();
    let found = ratios(&records);
    let alike: Vec<_> = found
        .iter()
        .filter(|pair| pair.fixed.axes["method"] == "sampled-unfiltered")
        .collect();
    assert_eq!(alike.len(), 2, "one a masking, at 40 samples only");
    for pair in alike {
        assert_eq!(
            (
                pair.sampled.axes["method"].as_str(),
                pair.sampled.axes["samples"].as_str()
            ),
            ("sampled", "40")
        );
        assert_eq!(pair.ratio, 1.5);
    }
    // Each of two formats is compared with its own.
    let mut formats = Vec::new();
    for format in ["f32", "f16"] {
        for (method, samples) in [("sampled", "4"), ("split-sum", "")] {
            let axes = [
                ("brdf", "ggx"),
                ("method", method),
                ("samples", samples),
                ("storage_format", format),
            ];
            formats.push(record("frame", &axes, &[("shade-specular", 1.0)]));
        }
    }
    assert_eq!(ratios(&formats).len(), 2);
}

/// Records of other maps, images and devices change nothing: each pair and its tables are the same
/// without them.
#[test]
fn records_of_other_sizes_and_devices_change_no_ratio() {
    let changes: [fn(&mut TimingRecord); 5] = [
        |_| (),
        |record| {
            (record.environment_size, record.block) = ([16, 8], record.block.clone() + " large map")
        },
        |record| (record.size, record.block) = ([512; 2], record.block.clone() + " large image"),
        |record| record.device += " pro",
        |record| record.driver += " 2",
    ];
    let kinds = (1..).zip(changes).map(|(slower, change)| {
        let mut records = swept();
        for record in &mut records {
            change(record);
            record
                .passes
                .iter_mut()
                .flat_map(|pass| &mut pass.ms)
                .for_each(|ms| *ms *= f64::from(slower));
        }
        records
    });
    let kinds: Vec<Vec<TimingRecord>> = kinds.collect();
    let sorted = |mut texts: Vec<String>| {
        texts.sort();
        texts
    };
    let found = |records: &[TimingRecord]| {
        ratios(records)
            .iter()
            .map(|pair| format!("{pair:?}"))
            .collect::<Vec<_>>()
    };
    let apart = kinds.iter().flat_map(|records| found(records)).collect();
    assert_eq!(sorted(found(&kinds.concat())), sorted(apart));
}

/// Each statistic of a row of `timings.csv` comes from its own numbers.
#[test]
fn a_row_of_timings_has_the_medians_of_its_pass_and_of_the_host() {
    let mut record = record(
        "frame",
        &[("method", "split-sum")],
        &[("shade-specular", 2.0)],
    );
    record.passes[0].ms = vec![3.0, 1.0, 2.0, 5.0, 4.0, 7.0, 6.0];
    record.wall_ms = vec![10.0, 30.0, 8.0, 9.0, 20.0, 7.0, 6.0];
    let table = timings(&[record]);
    let row = &table.rows[0];
    let number = |name: &str| {
        let column = table.columns.iter().position(|column| column == name);
        match row[column.unwrap()] {
            Cell::Number(number) => number,
            ref other => panic!("{name}: {other:?}"),
        }
    };
    assert_eq!(number("median_ms"), 4.0);
    // With seven rounds the interval is from the least to the largest.
    assert_eq!([number("median_lo_ms"), number("median_hi_ms")], [1.0, 7.0]);
    assert_eq!(number("wall_median_ms"), 9.0);
    assert_eq!(number("passes_over_wall"), 4.0 / 9.0);
}
