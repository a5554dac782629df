//! Runs with a synthetic renderer: renders, scores and files.

use super::fake::{ERROR_AT_ONE, SPLIT_SUM_ERROR};
use super::runs::{Bench, invoke, log, plan, read, snapshot, summary};
use splitsum::base::csv::Table;
use splitsum::instrument::ladder::{BANDS, STEPS};
use std::collections::BTreeMap;

pub const EXPERIMENT: &str = r#"
name = "tiny"
question = "When does sampling win?"
size = [24, 24]
reference = { samples = 64, noise_share = 0 }
[axes]
environment = ["builtin:constant"]
brdf = ["ggx", "phong"]
method = ["sampled", "split-sum"]
samples = [1, 4, 16]
alpha = [0.1, 0.5]
exposure = [1, 10]
"#;

#[test]
fn a_run_renders_each_radiance_once_and_leaves_everything() {
    let (dir, log, plan) = (tempfile::tempdir().unwrap(), log(), plan(EXPERIMENT));
    let outcome = invoke(&plan, dir.path(), &log, usize::MAX).unwrap();
    assert!(outcome.failures.is_empty() && !outcome.is_stopped);
    // 2 models x 2 alphas, each with one reference, three sample counts and split-sum; two
    // exposures share all of them.
    let renders = log.borrow().renders.clone();
    assert_eq!(renders.len(), 4 * 5);
    assert_eq!(
        renders
            .iter()
            .filter(|r| **r == ("reference".to_owned(), 64))
            .count(),
        4
    );

    let table = Table::read(&dir.path().join("errors.csv")).unwrap();
    assert_eq!(table.rows.len(), 32);
    assert_eq!(
        table.columns[..7],
        [
            "cell",
            "brdf",
            "method",
            "samples",
            "alpha",
            "perceptual_roughness",
            "exposure"
        ]
    );
    // Columns with one value come last.
    let place = |name: &str| table.column(name).unwrap();
    assert!(
        place("environment") > place("verdict") && place("size") > place("verdict"),
        "{:?}",
        table.columns
    );
    for (row, cell) in table.rows.iter().zip(&plan.cells) {
        assert_eq!(row[0], cell.id.to_string());
    }
    let method = table.column("method").unwrap();
    let samples = crate::table::numbers(&table, "samples");
    let verdict = table.column("verdict").unwrap();
    let bias = crate::table::numbers(&table, "bias_rel");
    for (i, row) in table.rows.iter().enumerate() {
        let expected = match samples[i] {
            None => SPLIT_SUM_ERROR,
            Some(n) => ERROR_AT_ONE / (n as f32).sqrt(),
        };
        assert_eq!(row[method] == "split-sum", samples[i].is_none());
        // All error of the fake is a factor; f32 pixels hold it to about 1e-7.
        assert!(
            (bias[i].unwrap() - f64::from(expected)).abs() < 1e-5,
            "{row:?}"
        );
        assert_eq!(row[verdict], "resolved");
    }
    for metric in splitsum::instrument::metrics::linear_metrics() {
        let floors = crate::table::numbers(&table, &format!("{}_noise_floor", metric.name));
        assert!(
            floors.iter().all(|floor| floor.is_some_and(|f| f > 0.0)),
            "{}",
            metric.name
        );
    }

    let bins = Table::read(&dir.path().join("errors_by_n_dot_v.csv")).unwrap();
    let counts = crate::table::numbers(&bins, "pixel_count");
    let cells: Vec<&str> = bins.rows.iter().map(|row| row[0].as_str()).collect();
    let of_first: f64 = counts
        .iter()
        .zip(&cells)
        .filter(|(_, id)| **id == plan.cells[0].id.to_string())
        .map(|(n, _)| n.unwrap())
        .sum();
    let inside = |i: usize| (i as f64 + 0.5) / 24.0 * 2.1 - 1.05;
    let disc = (0..24 * 24)
        .filter(|i| inside(i % 24).powi(2) + inside(i / 24).powi(2) < 1.0)
        .count();
    assert_eq!(of_first, disc as f64);

    let files = snapshot(dir.path());
    let count = |folder: &str, end: &str| {
        files
            .keys()
            .filter(|f| f.starts_with(folder) && f.ends_with(end))
            .count()
    };
    assert_eq!(count("images/", ".exr"), 20);
    // The exposure has no effect on the linear error.
    assert_eq!(count("images/", ".error.png"), 16);
    // The exposure is swept, so each cell has its own map of visible differences.
    assert_eq!(count("images/", ".flip.png"), 32);
    // Each cell has a test picture, and each model, alpha and exposure a reference picture.
    assert_eq!(count("images/", ".png"), 16 + 2 * 32 + 8);
    assert_eq!(count("tables/", ".svg"), 2);
    assert_eq!(count("cells/", ".json"), 32);
    assert_eq!(files["experiment.toml"].0, EXPERIMENT.as_bytes());
    assert!(
        files.keys().all(|f| !f.ends_with(".part")),
        "temporary files are left: {:?}",
        files.keys()
    );
}

/// The numbers of the fake's steps ([`super::fake::Fake`]), each under its name.
#[test]
fn steps_are_written_under_their_names() {
    let text = EXPERIMENT.replace(
        "[axes]",
        "scene = \"design\"\nladder = { samples = 64 }\n[axes]",
    );
    let table = Bench::finished(&text).table("steps.csv");
    let column = |name: &str| crate::table::numbers(&table, name);
    let [from, to] = ["n_dot_v_from", "n_dot_v_to"].map(column);
    let step = table.column("step").unwrap();
    let order = |name: &str| STEPS.iter().position(|step| step.name == name).unwrap();
    let total: usize = (1..=STEPS.len()).sum();
    let numbers = [
        "share",
        "rung_error",
        "first_in",
        "last_out",
        "shapley",
        "step_error",
        "share_error",
        "noise",
    ]
    .map(column);
    for (i, row) in table.rows.iter().enumerate() {
        assert!(from[i] < to[i], "{row:?}");
        let k = order(&row[step]) + 1;
        let below: usize = (1..=k).sum();
        let share = k as f64 / total as f64;
        let k = k as f64;
        let due = [
            share,
            0.01 * below as f64,
            0.02 * k,
            0.03 * k,
            0.04 * k,
            1e-3 * k,
            0.0,
            1e-6,
        ];
        for (column, due) in numbers.iter().zip(due) {
            // Four digits are written.
            assert!(
                (column[i].unwrap() - due).abs() <= 1e-3 * due,
                "{row:?}, {due}"
            );
        }
    }
    let cells = table.rows.iter().map(|row| row[0].as_str());
    let cells: std::collections::BTreeSet<&str> = cells.collect();
    let bands = 1 + BANDS.len();
    assert_eq!(table.rows.len(), cells.len() * bands * STEPS.len());
}

/// A cell's scores do not depend on the cells before it: every tone curve has its own displays.
/// The fake's frames without noise have half its radiance.
#[test]
fn the_lag_of_a_sequence_is_scored_against_the_reference() {
    let (dir, plan) = (
        tempfile::tempdir().unwrap(),
        plan(&EXPERIMENT.replace("exposure = [1, 10]", "frames = [1, 4]")),
    );
    invoke(&plan, dir.path(), &log(), usize::MAX).unwrap();
    let table = Table::read(&dir.path().join("errors.csv")).unwrap();
    let [frames, lag, bias, relmse] = ["frames", "lag_bias", "bias_rel", "relmse"]
        .map(|name| crate::table::numbers(&table, name));
    for i in 0..table.rows.len() {
        let is_sequence = f64::from(u8::from(frames[i] == Some(4.0)));
        let expected = is_sequence * (0.5 - 0.5 / bias[i].unwrap()).powi(2) * relmse[i].unwrap();
        assert!(
            (lag[i].unwrap_or(0.0) - expected).abs() <= 1e-4 * expected,
            "{:?}",
            table.rows[i]
        );
    }
}

#[test]
fn a_cells_record_does_not_depend_on_other_cells() {
    let records = |exposures: &str, contrasts: &str| -> BTreeMap<String, serde_json::Value> {
        let text = EXPERIMENT.replace(
            "exposure = [1, 10]",
            &format!("exposure = {exposures}\ncontrast = {contrasts}"),
        );
        let bench = Bench::finished(&text);
        let record = |cell: &splitsum::experiment::Cell| {
            let mut record = bench.json(&format!("cells/{}.json", cell.id));
            // A sweep of tone curves has one more image.
            record
                .as_object_mut()
                .unwrap()
                .retain(|name, _| !["checksum", "files"].contains(&name.as_str()));
            (cell.id.to_string(), record)
        };
        bench.plan.cells.iter().map(record).collect()
    };
    let values = ["[1]", "[10]"];
    let apart = values
        .map(|e| values.map(|c| records(e, c)))
        .into_iter()
        .flatten()
        .flatten();
    assert_eq!(records("[1, 10]", "[1, 10]"), apart.collect());
}

#[test]
fn each_row_has_the_count_at_which_its_reference_stopped() {
    // The fake stops at 16 of 64 samples if the requested error is 1/1000 or more, else it takes
    // all.
    for (asked, samples, stopped_by) in [
        ("", 64.0, "samples"),
        (", relative_error = 2e-3", 16.0, "relative-error"),
        (", relative_error = 1e-4", 64.0, "samples"),
    ] {
        let text = EXPERIMENT.replace("samples = 64", &format!("samples = 64{asked}"));
        let (dir, plan) = (tempfile::tempdir().unwrap(), plan(&text));
        // A run stopped between two cells of one reference and resumed: the second invocation reads
        // that reference back.
        invoke(&plan, dir.path(), &log(), 3).unwrap();
        invoke(&plan, dir.path(), &log(), usize::MAX).unwrap();
        let table = Table::read(&dir.path().join("errors.csv")).unwrap();
        assert_eq!(table.rows.len(), 32);
        assert!(
            crate::table::numbers(&table, "reference_samples")
                .iter()
                .all(|n| *n == Some(samples)),
            "{asked}"
        );
        assert!(
            crate::table::numbers(&table, "reference_relative_error")
                .iter()
                .all(|x| *x == Some(1e-3)),
            "{asked}"
        );
        let column = table.column("reference_stopped_by").unwrap();
        assert!(
            table.rows.iter().all(|row| row[column] == stopped_by),
            "{asked}"
        );
        let says = match asked {
            "" => "64 samples per pixel (relative standard error: median 0.0010, largest 0.0010)",
            _ if stopped_by == "samples" => "64 samples per pixel at most; 0 of 4 stopped earlier",
            _ => {
                "64 samples per pixel at most; 4 of 4 stopped earlier at a relative standard error \
                 of 0.002"
            }
        };
        assert!(
            summary(dir.path()).contains(says),
            "{}",
            summary(dir.path())
        );
        let whole = tempfile::tempdir().unwrap();
        invoke(&plan, whole.path(), &log(), usize::MAX).unwrap();
        assert!(
            read(dir.path().join("errors.csv")) == read(whole.path().join("errors.csv")),
            "{asked}"
        );
    }
}

#[test]
fn the_provenance_names_inputs_and_sessions() {
    let bench = Bench::new(&format!("{EXPERIMENT}[timing]\nwarmup = 1\nrounds = 3\n"));
    bench.invoke(&log(), 3).unwrap();
    bench.invoke(&log(), usize::MAX).unwrap();
    let value = bench.json("provenance.json");
    assert_eq!(value["plan_hash"], bench.plan.hash);
    assert_eq!(
        value["inputs"]["builtin:constant"].as_str().unwrap().len(),
        64
    );
    assert_eq!(
        value["metrics"].as_array().unwrap().len(),
        splitsum::instrument::metrics::METRICS.len()
    );
    let [first, second] = &value["sessions"].as_array().unwrap()[..] else {
        panic!("{value:#}")
    };
    assert_eq!(
        (
            &first["device"]["name"],
            first["program_hash"].as_str().unwrap().len()
        ),
        (&"fake".into(), 64)
    );
    assert!(second["wall_s"].as_f64().unwrap() > 0.0);
}

#[test]
fn the_provenance_of_published_runs_is_written_as_it_was_read() {
    let results = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("results");
    let mut count = 0;
    for entry in std::fs::read_dir(results).unwrap() {
        let dir = entry.unwrap().path();
        if !dir.is_dir() {
            continue;
        }
        if let Some(provenance) = splitsum::run::provenance::read(&dir).unwrap() {
            let text = read(dir.join("provenance.json"));
            let written = format!("{:#}\n", provenance.to_json());
            assert_eq!(String::from_utf8(text).unwrap(), written);
            count += 1;
        }
    }
    assert!(count > 10, "{count} published runs");
}
