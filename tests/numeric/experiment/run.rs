//! Runs with a renderer made of formulas: what is rendered, what is left behind, what a second run changes.

use super::fake::{ERROR_AT_ONE, Fake, Log, NOISE, SET_ERROR, SPLIT_SUM_ERROR};
use splitsum::experiment::{MakeRenderer, Outcome, Plan, Progress, RenderFault, RunError, RunOptions, run};
use splitsum::table::csv::Table;
use std::cell::RefCell;
use std::collections::BTreeMap;
use std::path::Path;
use std::rc::Rc;
use std::sync::atomic::{AtomicBool, Ordering};

const EXPERIMENT: &str = r#"
name = "tiny"
question = "When does sampling win?"
size = [24, 24]
reference = { samples = 64 }
[axes]
environment = ["builtin:constant"]
brdf = ["ggx", "phong"]
method = ["sampled", "split-sum"]
samples = [1, 4, 16]
alpha = [0.1, 0.5]
exposure = [1, 10]
"#;

/// Stops the run after a number of steps.
struct Steps<'a> {
    stop: &'a AtomicBool,
    left: usize,
    failures: Vec<String>,
}

impl Progress for Steps<'_> {
    fn start(&mut self, _: usize, _: usize) {}

    fn step(&mut self, label: &str, failure: Option<&str>) {
        self.failures.extend(failure.map(|reason| format!("{label}: {reason}")));
        self.left = self.left.saturating_sub(1);
        if self.left == 0 {
            self.stop.store(true, Ordering::Relaxed);
        }
    }

    fn note(&mut self, _: &str) {}
}

fn plan(text: &str) -> Plan {
    Plan::from_text(Path::new("tiny.toml"), text, &[]).unwrap_or_else(|error| panic!("{error}"))
}

/// One invocation that is stopped after `steps` steps.
fn invoke(plan: &Plan, dir: &Path, log: &Rc<RefCell<Log>>, steps: usize) -> Result<Outcome, RunError> {
    let stop = AtomicBool::new(false);
    let options = RunOptions {
        dir: dir.to_owned(),
        stop: &stop,
        command_line: vec!["splitsum".to_owned()],
        fail_fast: false,
        trace: true,
    };
    let mut progress = Steps { stop: &stop, left: steps, failures: Vec::new() };
    let mut make =
        || -> Result<Box<dyn splitsum::experiment::Renderer>, RenderFault> { Ok(Box::new(Fake(log.clone()))) };
    run(plan, &mut make as &mut MakeRenderer, &options, &mut progress)
}

fn log() -> Rc<RefCell<Log>> {
    Rc::new(RefCell::new(Log::default()))
}

fn read(dir: &Path, name: &str) -> Vec<u8> {
    std::fs::read(dir.join(name)).unwrap_or_else(|error| panic!("{name}: {error}"))
}

/// Every file below `dir` with its content and, for files, its time of change.
fn snapshot(dir: &Path) -> BTreeMap<String, (Vec<u8>, std::time::SystemTime)> {
    let mut files = BTreeMap::new();
    for entry in std::fs::read_dir(dir).unwrap().map(Result::unwrap) {
        if entry.path().is_dir() {
            let name = entry.file_name().into_string().unwrap();
            files.extend(snapshot(&entry.path()).into_iter().map(|(k, v)| (format!("{name}/{k}"), v)));
        } else {
            let time = entry.metadata().unwrap().modified().unwrap();
            files.insert(entry.file_name().into_string().unwrap(), (std::fs::read(entry.path()).unwrap(), time));
        }
    }
    files
}

#[test]
fn a_run_renders_each_radiance_once_and_leaves_everything() {
    let (dir, log, plan) = (tempfile::tempdir().unwrap(), log(), plan(EXPERIMENT));
    let outcome = invoke(&plan, dir.path(), &log, usize::MAX).unwrap();
    assert!(outcome.failures.is_empty() && !outcome.is_stopped);
    // 2 models x 2 alphas, each with one reference, three sample counts and split-sum; two exposures share all of it.
    let renders = log.borrow().renders.clone();
    assert_eq!(renders.len(), 4 * 5);
    assert_eq!(renders.iter().filter(|r| **r == ("reference".to_owned(), 64)).count(), 4);

    let table = Table::read(&dir.path().join("errors.csv")).unwrap();
    assert_eq!(table.rows.len(), 32);
    assert_eq!(table.columns[..7], ["cell", "environment", "brdf", "method", "samples", "alpha", "exposure"]);
    for (row, cell) in table.rows.iter().zip(&plan.cells) {
        assert_eq!(row[0], cell.id);
    }
    let method = table.column("method").unwrap();
    let samples = table.numbers("samples").unwrap();
    let verdict = table.column("verdict").unwrap();
    let bias = table.numbers("bias_rel").unwrap();
    for (i, row) in table.rows.iter().enumerate() {
        let expected = match samples[i] {
            None => SPLIT_SUM_ERROR,
            Some(n) => ERROR_AT_ONE / (n as f32).sqrt(),
        };
        assert_eq!(row[method] == "split-sum", samples[i].is_none());
        // All error of the fake is a factor; f32 pixels carry it to about 1e-7.
        assert!((bias[i].unwrap() - f64::from(expected)).abs() < 1e-5, "{row:?}");
        assert_eq!(row[verdict], "resolved");
    }
    assert!(table.numbers("rmse_noise_floor").unwrap().iter().all(|floor| floor.is_some_and(|f| f > 0.0)));

    let bins = Table::read(&dir.path().join("errors_by_n_dot_v.csv")).unwrap();
    let counts = bins.numbers("pixel_count").unwrap();
    let cells: Vec<&str> = bins.rows.iter().map(|row| row[0].as_str()).collect();
    let of_first: f64 =
        counts.iter().zip(&cells).filter(|(_, id)| **id == plan.cells[0].id).map(|(n, _)| n.unwrap()).sum();
    let inside = |i: usize| (i as f64 + 0.5) / 24.0 * 2.1 - 1.05;
    let disc = (0..24 * 24).filter(|i| inside(i % 24).powi(2) + inside(i / 24).powi(2) < 1.0).count();
    assert_eq!(of_first, disc as f64);

    let files = snapshot(dir.path());
    let count = |folder: &str, end: &str| files.keys().filter(|f| f.starts_with(folder) && f.ends_with(end)).count();
    assert_eq!(count("images/", ".exr"), 20);
    assert_eq!(count("images/", ".error.png"), 32);
    // The exposure is swept, so each cell has its own map of visible differences.
    assert_eq!(count("images/", ".flip.png"), 32);
    // And a test picture for each cell, and a reference for each model, alpha and exposure.
    assert_eq!(count("images/", ".png"), 3 * 32 + 8);
    assert_eq!(count("tables/", ".png"), 2);
    assert_eq!(count("cells/", ".json"), 32);
    assert_eq!(files["experiment.toml"].0, EXPERIMENT.as_bytes());
    assert!(files.keys().all(|f| !f.ends_with(".part")), "temporary files are left: {:?}", files.keys());
}

#[test]
fn a_sheet_that_would_be_too_wide_is_split_between_methods() {
    let text = "name = \"wide\"\nsize = [640, 8]\nreference = { samples = 4 }\n[axes]\nmethod = [\"sampled\", \"split-sum\"]\n\
                samples = [1, 2, 3, 4, 5, 6, 7, 8, 9, 10]\n";
    let (dir, plan) = (tempfile::tempdir().unwrap(), plan(text));
    invoke(&plan, dir.path(), &log(), usize::MAX).unwrap();
    // 12 columns of at least 200 pixels do not fit on 2600: ten of `sampled` with the reference do, in 206 pixels each.
    for name in ["wide_1.png", "wide_2.png"] {
        let sheet = splitsum::pixels::png::read_rgb8(&dir.path().join("tables").join(name)).unwrap();
        assert!(sheet.width <= 2600, "{name} is {} pixels wide", sheet.width);
    }
    assert!(!dir.path().join("tables/wide_3.png").exists());
}

#[test]
fn the_summary_answers_with_the_break_even_of_the_error_model() {
    let (dir, plan) = (tempfile::tempdir().unwrap(), plan(EXPERIMENT));
    let summary = invoke(&plan, dir.path(), &log(), usize::MAX).unwrap().summary;
    // 0.4 / sqrt(4) = 0.2 is above the fixed 0.15, 0.4 / sqrt(16) = 0.1 below it.
    assert!(summary.contains("From how many samples on does `sampled` beat `split-sum`?"), "{summary}");
    assert!(summary.contains("Median over all 4 rows: **16** samples a pixel."), "{summary}");
    assert!(summary.contains("## After the tone curve"), "{summary}");
    // The fake's error is a factor f of radiance, so its relative square is f² less what ε hides of dark pixels.
    let heat = summary.split("## Error by alpha and n_dot_v").nth(1).unwrap().split("##").next().unwrap();
    for (method, factor) in [("`sampled 16`:", ERROR_AT_ONE / 4.0), ("`split-sum`:", SPLIT_SUM_ERROR)] {
        let table = heat.split(method).nth(1).unwrap().split('`').next().unwrap();
        let rows: Vec<Vec<f64>> = table
            .lines()
            .map(|line| line.split('|').filter_map(|field| field.trim().parse().ok()).collect::<Vec<f64>>())
            .filter(|row| row.len() == 11)
            .collect();
        assert_eq!(rows.iter().map(|row| row[0]).collect::<Vec<_>>(), [0.1, 0.5], "{heat}");
        let square = f64::from(factor).powi(2);
        assert!(rows.iter().all(|row| row[1..].iter().all(|error| (0.3..1.0).contains(&(error / square)))), "{heat}");
    }
    assert_eq!(read(dir.path(), "summary.md"), summary.as_bytes());
}

#[test]
fn a_method_that_ignores_an_axis_stands_beside_every_value_of_it() {
    let text = "name = \"x\"\nsize = [16, 16]\nreference = { samples = 4 }\n[axes]\nmethod = [\"sampled\", \"split-sum\"]\n\
                diffuse = [\"none\"]\nsamples = [1, 16]\ndfg_size = [16, 32, 64]\n";
    let (dir, plan) = (tempfile::tempdir().unwrap(), plan(text));
    assert_eq!(plan.cells.len(), 2 + 3);
    let summary = invoke(&plan, dir.path(), &log(), usize::MAX).unwrap().summary;
    assert!(summary.contains("Median over all 3 rows: **16**"), "{summary}");
}

#[test]
fn repeats_part_bias_from_variance() {
    let (dir, plan) = (tempfile::tempdir().unwrap(), plan(&format!("{EXPERIMENT}[bias_variance]\nrepeats = 8\n")));
    let log = log();
    invoke(&plan, dir.path(), &log, usize::MAX).unwrap();
    // Each of the 12 sampled images is rendered with 8 further sets.
    assert_eq!(log.borrow().renders.len(), 20 + 12 * 8);
    let table = Table::read(&dir.path().join("errors.csv")).unwrap();
    let column = |name: &str| table.numbers(name).unwrap();
    let (rmse, relmse, samples) = (column("rmse"), column("relmse_eps1e-2"), column("samples"));
    let (var, bias2) = (column("var_hat"), column("bias2_hat"));
    let (var_rel, bias2_rel) = (column("var_hat_eps1e-2"), column("bias2_hat_eps1e-2"));
    for i in 0..table.rows.len() {
        let Some(count) = samples[i] else {
            assert_eq!((var[i], bias2[i], var_rel[i], bias2_rel[i]), (None, None, None, None));
            continue;
        };
        // All errors are factors of the reference, so each figure is a multiple of the mean square of its pixels.
        let factor = f64::from(ERROR_AT_ONE) / count.sqrt();
        let variance = f64::from(SET_ERROR).powi(2) * 8.0 / 7.0;
        let bias2_factor = factor.powi(2) - variance / 8.0 - f64::from(NOISE).powi(2);
        for (score, var, bias2) in
            [(rmse[i].unwrap().powi(2), var[i], bias2[i]), (relmse[i].unwrap(), var_rel[i], bias2_rel[i])]
        {
            let mean_square = score / factor.powi(2);
            assert!((var.unwrap() / (variance * mean_square) - 1.0).abs() < 1e-4, "{var:?}");
            assert!((bias2.unwrap() / (bias2_factor * mean_square) - 1.0).abs() < 1e-4, "{bias2:?}");
        }
    }
}

#[test]
fn every_linear_metric_has_its_noise_floor() {
    let (dir, plan) = (tempfile::tempdir().unwrap(), plan(EXPERIMENT));
    invoke(&plan, dir.path(), &log(), usize::MAX).unwrap();
    let table = Table::read(&dir.path().join("errors.csv")).unwrap();
    for metric in splitsum::metrics::linear_metrics() {
        let floors = table.numbers(&format!("{}_noise_floor", metric.description().name)).unwrap();
        assert!(floors.iter().all(|floor| floor.is_some_and(|f| f > 0.0)), "{}", metric.description().name);
    }
}

#[test]
fn fail_fast_ends_the_run_at_the_first_failure() {
    let (dir, plan) = (tempfile::tempdir().unwrap(), plan(EXPERIMENT));
    let broken = log();
    broken.borrow_mut().broken_method = Some("split-sum");
    let stop = AtomicBool::new(false);
    let options =
        RunOptions { dir: dir.path().to_owned(), stop: &stop, command_line: Vec::new(), fail_fast: true, trace: false };
    let mut progress = Steps { stop: &stop, left: usize::MAX, failures: Vec::new() };
    let mut make =
        || -> Result<Box<dyn splitsum::experiment::Renderer>, RenderFault> { Ok(Box::new(Fake(broken.clone()))) };
    let outcome = run(&plan, &mut make as &mut MakeRenderer, &options, &mut progress).unwrap();
    assert!(outcome.is_stopped);
    assert_eq!(outcome.failures.len(), 1);
    // One reference and the three images of `sampled` before it; nothing after.
    assert_eq!(broken.borrow().renders.len(), 4);
    invoke(&plan, dir.path(), &log(), usize::MAX).unwrap();
    let whole = tempfile::tempdir().unwrap();
    invoke(&plan, whole.path(), &log(), usize::MAX).unwrap();
    assert!(read(dir.path(), "errors.csv") == read(whole.path(), "errors.csv"));
}

#[test]
fn each_row_says_where_its_reference_stopped() {
    // The fake stops at 16 of 64 samples when an error of 1/1000 or more is asked for, else it takes all.
    for (asked, samples, stopped_by) in [
        ("", 64.0, "samples"),
        (", relative_error = 2e-3", 16.0, "relative-error"),
        (", relative_error = 1e-4", 64.0, "samples"),
    ] {
        let text = EXPERIMENT.replace("samples = 64", &format!("samples = 64{asked}"));
        let (dir, plan) = (tempfile::tempdir().unwrap(), plan(&text));
        // Stopped between two cells of one reference and gone on with: the second invocation reads that reference back.
        invoke(&plan, dir.path(), &log(), 3).unwrap();
        let outcome = invoke(&plan, dir.path(), &log(), usize::MAX).unwrap();
        let table = Table::read(&dir.path().join("errors.csv")).unwrap();
        assert_eq!(table.rows.len(), 32);
        assert!(table.numbers("reference_samples").unwrap().iter().all(|n| *n == Some(samples)), "{asked}");
        assert!(table.numbers("reference_relative_error").unwrap().iter().all(|x| *x == Some(1e-3)), "{asked}");
        let column = table.column("reference_stopped_by").unwrap();
        assert!(table.rows.iter().all(|row| row[column] == stopped_by), "{asked}");
        let says = match asked {
            "" => "64 samples a pixel (relative standard error: median 0.0010, largest 0.0010)",
            _ if stopped_by == "samples" => "64 samples a pixel at most; 0 of 4 references stopped earlier",
            _ => "64 samples a pixel at most; 4 of 4 references stopped earlier by a relative standard error of 0.002",
        };
        assert!(outcome.summary.contains(says), "{}", outcome.summary);
        let whole = tempfile::tempdir().unwrap();
        invoke(&plan, whole.path(), &log(), usize::MAX).unwrap();
        assert!(read(dir.path(), "errors.csv") == read(whole.path(), "errors.csv"), "{asked}");
    }
}

#[test]
fn a_second_run_in_the_same_folder_is_told() {
    let (dir, plan) = (tempfile::tempdir().unwrap(), plan(EXPERIMENT));
    let held = splitsum::experiment::store::Store::open(dir.path(), &plan).unwrap();
    let error = invoke(&plan, dir.path(), &log(), usize::MAX).unwrap_err();
    assert!(error.to_string().contains("another run is at work in it"), "{error}");
    drop(held);
    invoke(&plan, dir.path(), &log(), usize::MAX).unwrap();
}

#[test]
fn what_a_killed_run_left_half_written_is_no_obstacle() {
    let (dir, plan) = (tempfile::tempdir().unwrap(), plan(EXPERIMENT));
    std::fs::create_dir(dir.path().join("images")).unwrap();
    for name in [".splitsum-aZ3.part", "errors.csv.part", "images/.splitsum-b.part"] {
        std::fs::write(dir.path().join(name), "half").unwrap();
    }
    invoke(&plan, dir.path(), &log(), usize::MAX).unwrap();
    assert!(snapshot(dir.path()).keys().all(|name| !name.ends_with(".part")));
}

#[test]
fn a_finished_run_is_not_touched_and_needs_no_renderer() {
    let (dir, plan) = (tempfile::tempdir().unwrap(), plan(&format!("{EXPERIMENT}[timing]\nwarmup = 1\nrounds = 3\n")));
    invoke(&plan, dir.path(), &log(), usize::MAX).unwrap();
    let before = snapshot(dir.path());
    let stop = AtomicBool::new(false);
    let options =
        RunOptions { dir: dir.path().to_owned(), stop: &stop, command_line: Vec::new(), fail_fast: false, trace: true };
    let mut progress = Steps { stop: &stop, left: usize::MAX, failures: Vec::new() };
    let mut make = || -> Result<Box<dyn splitsum::experiment::Renderer>, RenderFault> { panic!("a renderer was made") };
    run(&plan, &mut make as &mut MakeRenderer, &options, &mut progress).unwrap();
    let after = snapshot(dir.path());
    assert_eq!(before.keys().collect::<Vec<_>>(), after.keys().collect::<Vec<_>>());
    for (name, (bytes, _)) in &before {
        assert!(*bytes == after[name].0, "{name} changed");
    }
}

#[test]
fn a_run_stopped_anywhere_ends_like_one_that_was_not() {
    let plan = plan(EXPERIMENT);
    let whole = tempfile::tempdir().unwrap();
    invoke(&plan, whole.path(), &log(), usize::MAX).unwrap();
    for steps in [1, 7, 20] {
        let dir = tempfile::tempdir().unwrap();
        let mut invocations = 0;
        loop {
            let outcome = invoke(&plan, dir.path(), &log(), steps).unwrap();
            invocations += 1;
            let rows = Table::read(&dir.path().join("errors.csv")).unwrap().rows.len();
            assert_eq!(rows, (invocations * steps).min(32), "rows after {invocations} times {steps} steps");
            if !outcome.is_stopped {
                break;
            }
        }
        assert_eq!(invocations, 32usize.div_ceil(steps));
        for name in ["errors.csv", "errors_by_n_dot_v.csv", "summary.md", "experiment.toml", "tables/ggx.png"] {
            assert!(read(dir.path(), name) == read(whole.path(), name), "{name} differs after stops of {steps} steps");
        }
        let images = |dir: &Path| snapshot(&dir.join("images")).into_iter().map(|(k, v)| (k, v.0)).collect::<Vec<_>>();
        assert!(images(dir.path()) == images(whole.path()), "images differ after stops of {steps} steps");
    }
}

#[test]
fn images_that_are_gone_or_cut_off_are_made_again() {
    let (dir, plan) = (tempfile::tempdir().unwrap(), plan(EXPERIMENT));
    invoke(&plan, dir.path(), &log(), usize::MAX).unwrap();
    let contents =
        |dir: &Path| snapshot(dir).into_iter().map(|(name, (bytes, _))| (name, bytes)).collect::<BTreeMap<_, _>>();
    let before = contents(&dir.path().join("images"));
    let errors = read(dir.path(), "errors.csv");
    let of_split_sum = |end: &str| {
        before
            .keys()
            .find(|name| name.contains("split-sum") && name.ends_with(end))
            .expect("an image of split-sum")
            .clone()
    };
    for name in [of_split_sum(".error.png"), of_split_sum(".flip.png"), of_split_sum(".exr")] {
        let path = dir.path().join("images").join(&name);
        match name.ends_with(".exr") {
            true => std::fs::write(&path, &before[&name][..before[&name].len() - 40]).unwrap(),
            false => std::fs::remove_file(&path).unwrap(),
        }
        let log = log();
        invoke(&plan, dir.path(), &log, usize::MAX).unwrap();
        // One image; its reference is read back.
        assert_eq!(log.borrow().renders, [("split-sum".to_owned(), 1)], "{name}");
        assert!(contents(&dir.path().join("images")) == before, "{name}");
        assert!(read(dir.path(), "errors.csv") == errors, "{name}");
    }
}

#[test]
fn a_record_that_was_cut_off_is_no_record() {
    let (dir, plan) = (tempfile::tempdir().unwrap(), plan(EXPERIMENT));
    invoke(&plan, dir.path(), &log(), usize::MAX).unwrap();
    let errors = read(dir.path(), "errors.csv");
    let split_sum = plan.cells.iter().find(|cell| cell.point.get("method").to_string() == "split-sum").unwrap();
    let record = dir.path().join("cells").join(format!("{}.json", split_sum.id));
    for contents in ["", "{\"cell\": \"12"] {
        std::fs::write(&record, contents).unwrap();
        let log = log();
        invoke(&plan, dir.path(), &log, usize::MAX).unwrap();
        assert_eq!(log.borrow().renders, [("split-sum".to_owned(), 1)], "{contents:?}");
        assert!(read(dir.path(), "errors.csv") == errors, "{contents:?}");
    }
}

#[test]
fn the_provenance_says_what_a_session_shared_and_how_the_machine_was() {
    let (dir, plan) = (tempfile::tempdir().unwrap(), plan(&format!("{EXPERIMENT}[timing]\nwarmup = 1\nrounds = 3\n")));
    let outcome = invoke(&plan, dir.path(), &log(), usize::MAX).unwrap();
    let line = outcome.work.unwrap().line(1000.0);
    assert_eq!(line, "1.0 s, 100 % of it without the device. Made once and shared: dfg 2, reference 4");
    let value: serde_json::Value = serde_json::from_slice(&read(dir.path(), "provenance.json")).unwrap();
    let session = &value["sessions"][0];
    assert_eq!(session["shared_work"]["reference"], serde_json::json!({ "made": 4, "read": 0 }));
    assert_eq!(session["device_s"], 0.0);
    assert!(session["wall_s"].as_f64().unwrap() > 0.0);
    assert_eq!(session["program_hash"].as_str().unwrap().len(), 64);
    for state in [&session["state_before"], &session["state_after"]] {
        // The fake is no GPU: nobody tells its clocks.
        assert_eq!(state["gpu"], "unknown");
        assert!(state["load_average"].is_array() || state["load_average"] == "unknown");
    }
    let timings = Table::read(&dir.path().join("timings.csv")).unwrap();
    let slowdown = timings.column("slowdown").unwrap();
    assert!(timings.rows.iter().all(|row| row[slowdown] == "unknown"));
}

#[test]
fn a_record_that_vanished_is_made_again() {
    let (dir, plan) = (tempfile::tempdir().unwrap(), plan(EXPERIMENT));
    invoke(&plan, dir.path(), &log(), usize::MAX).unwrap();
    let before = read(dir.path(), "errors.csv");
    std::fs::remove_file(dir.path().join(format!("cells/{}.json", plan.cells[5].id))).unwrap();
    std::fs::remove_file(dir.path().join("errors.csv")).unwrap();
    let log = log();
    invoke(&plan, dir.path(), &log, usize::MAX).unwrap();
    assert_eq!(log.borrow().renders.len(), 1, "its reference is read back");
    assert!(read(dir.path(), "errors.csv") == before);
}

#[test]
fn a_failing_method_leaves_the_rest_and_is_tried_again() {
    let (dir, plan) = (tempfile::tempdir().unwrap(), plan(EXPERIMENT));
    let broken = log();
    broken.borrow_mut().broken_method = Some("split-sum");
    let outcome = invoke(&plan, dir.path(), &broken, usize::MAX).unwrap();
    assert_eq!(outcome.failures.len(), 8);
    assert!(outcome.failures.iter().all(|f| f.reason == "the shader is broken" && f.label.contains("split-sum")));
    assert!(outcome.summary.contains("the shader is broken"));
    let table = Table::read(&dir.path().join("errors.csv")).unwrap();
    let verdict = table.column("verdict").unwrap();
    assert_eq!(table.rows.iter().filter(|row| row[verdict] == "failed").count(), 8);
    assert_eq!(table.rows.len(), 32);

    let outcome = invoke(&plan, dir.path(), &log(), usize::MAX).unwrap();
    assert!(outcome.failures.is_empty());
    let whole = tempfile::tempdir().unwrap();
    invoke(&plan, whole.path(), &log(), usize::MAX).unwrap();
    assert!(read(dir.path(), "errors.csv") == read(whole.path(), "errors.csv"));
}

#[test]
fn a_failing_reference_fails_its_cells_only() {
    let (dir, plan) = (tempfile::tempdir().unwrap(), plan(EXPERIMENT));
    let broken = log();
    broken.borrow_mut().broken_method = Some("reference");
    let outcome = invoke(&plan, dir.path(), &broken, usize::MAX).unwrap();
    assert_eq!(outcome.failures.len(), 32);
    assert!(outcome.failures[0].reason.starts_with("its reference: "));
}

#[test]
fn a_lost_device_ends_the_run_and_keeps_what_is_done() {
    let (dir, plan) = (tempfile::tempdir().unwrap(), plan(EXPERIMENT));
    let log = log();
    log.borrow_mut().renders_left = Some(4);
    let error = invoke(&plan, dir.path(), &log, usize::MAX).unwrap_err();
    assert!(matches!(error, RunError::DeviceLost(_)), "{error}");
    // A reference and three images, each with two exposures.
    assert_eq!(Table::read(&dir.path().join("errors.csv")).unwrap().rows.len(), 6);
    log.borrow_mut().renders_left = None;
    assert!(invoke(&plan, dir.path(), &log, usize::MAX).unwrap().failures.is_empty());
}

#[test]
fn a_folder_of_something_else_is_refused() {
    let dir = tempfile::tempdir().unwrap();
    invoke(&plan(EXPERIMENT), dir.path(), &log(), usize::MAX).unwrap();
    let before = snapshot(dir.path());
    let other = plan(&EXPERIMENT.replace("[0.1, 0.5]", "[0.1, 0.6]"));
    let error = invoke(&other, dir.path(), &log(), usize::MAX).unwrap_err();
    assert!(error.to_string().contains("another experiment"), "{error}");
    assert_eq!(before, snapshot(dir.path()));

    let foreign = tempfile::tempdir().unwrap();
    std::fs::write(foreign.path().join("thesis.tex"), "years of work").unwrap();
    let error = invoke(&plan(EXPERIMENT), foreign.path(), &log(), usize::MAX).unwrap_err();
    assert!(error.to_string().contains("not a run"), "{error}");
    assert_eq!(snapshot(foreign.path()).len(), 1);
}

#[test]
fn timings_are_taken_once_a_configuration_and_kept() {
    let (dir, log) = (tempfile::tempdir().unwrap(), log());
    let plan = plan(&format!("{EXPERIMENT}[timing]\nwarmup = 1\nrounds = 5\n"));
    invoke(&plan, dir.path(), &log, usize::MAX).unwrap();
    // Two models: each the tables of two methods, and three sample counts and split-sum; neither alpha nor exposure counts.
    assert_eq!(log.borrow().timings, (4 + 8) * (1 + 5));
    let table = Table::read(&dir.path().join("timings.csv")).unwrap();
    assert_eq!(table.rows.len(), 4 + 8 * 2);
    let (pass, phase) = (table.column("pass").unwrap(), table.column("phase").unwrap());
    let numbers = |name: &str| table.numbers(name).unwrap().into_iter().map(Option::unwrap).collect::<Vec<f64>>();
    let samples = table.numbers("samples").unwrap();
    for (i, row) in table.rows.iter().enumerate() {
        if row[pass] == "shade-specular" {
            // Samples n, n + 1, ... n + 4; split-sum draws none, which the fake sees as 1.
            let n = samples[i].unwrap_or(1.0);
            let found = [numbers("min_ms")[i], numbers("p05_ms")[i], numbers("median_ms")[i], numbers("p95_ms")[i]];
            let expected = [n, n + 0.2, n + 2.0, n + 3.8];
            assert!(found.iter().zip(expected).all(|(f, e)| (f - e).abs() < 1e-12), "{found:?} {expected:?}");
            assert_eq!(numbers("mad_ms")[i], 1.0);
        }
        let check = if row[phase] == "precompute" { "mostly-outside-passes" } else { "ok" };
        assert_eq!(row[table.column("wall_check").unwrap()], check);
        assert_eq!(row[table.column("device_type").unwrap()], "cpu");
    }
    let summary = String::from_utf8(read(dir.path(), "summary.md")).unwrap();
    assert!(summary.contains("Measured on a CPU driver") && summary.contains("SLOW (CPU)"), "{summary}");

    // Frames of 1 + n + i ms against 2 + i in round i: the median of the ratios is that of round 2.
    let ratios = Table::read(&dir.path().join("timing_ratios.csv")).unwrap();
    assert_eq!(ratios.rows.len(), 2 * 3);
    let samples = ratios.numbers("samples").unwrap();
    let ratio = ratios.numbers("sampled_over_fixed").unwrap();
    for (i, row) in ratios.rows.iter().enumerate() {
        let n = samples[i].unwrap();
        assert!((ratio[i].unwrap() - (3.0 + n) / 4.0).abs() < 1e-12, "{row:?}");
        let verdict = if n == 1.0 { "SAME" } else { "SLOW" };
        assert_eq!(row[ratios.column("verdict").unwrap()], verdict, "{row:?}");
        // The tables of both cost the same here, so they are paid at once; equal frames never pay.
        assert_eq!(ratios.numbers("payback_frames").unwrap()[i], (n > 1.0).then_some(0.0));
    }

    // One event a pass and round, besides the names.
    let trace: serde_json::Value = serde_json::from_slice(&read(dir.path(), "trace.json")).unwrap();
    let events = trace["traceEvents"].as_array().unwrap();
    assert_eq!(events.iter().filter(|event| event["ph"] == "X").count(), (4 + 8 * 2) * 5);
}

#[test]
fn compared_configurations_are_timed_in_the_same_rounds_in_changing_order() {
    let (dir, log) = (tempfile::tempdir().unwrap(), log());
    let plan = plan(&format!("{EXPERIMENT}[timing]\nwarmup = 1\nrounds = 20\n"));
    invoke(&plan, dir.path(), &log, usize::MAX).unwrap();
    let mut blocks: BTreeMap<String, Vec<Vec<u64>>> = BTreeMap::new();
    for (name, (bytes, _)) in snapshot(&dir.path().join("timings")) {
        let record: serde_json::Value = serde_json::from_slice(&bytes).unwrap_or_else(|e| panic!("{name}: {e}"));
        let orders = record["rounds"].as_array().unwrap().iter().map(|place| place["order"].as_u64().unwrap());
        if record["phase"] == "frame" {
            blocks.entry(record["block"].as_str().unwrap().to_owned()).or_default().push(orders.collect());
        }
    }
    assert_eq!(blocks.len(), 2, "one for each model");
    for orders in blocks.values() {
        assert_eq!(orders.len(), 4, "three sample counts and split-sum");
        for round in 0..20 {
            let mut places: Vec<u64> = orders.iter().map(|of_one| of_one[round]).collect();
            places.sort_unstable();
            assert_eq!(places, [0, 1, 2, 3], "each once a round");
        }
        for of_one in orders {
            assert!((0..4).all(|place| of_one.contains(&place)), "in every place at some time: {of_one:?}");
        }
    }
}

#[test]
fn the_provenance_names_inputs_sessions_and_metrics() {
    let (dir, plan) = (tempfile::tempdir().unwrap(), plan(EXPERIMENT));
    invoke(&plan, dir.path(), &log(), 3).unwrap();
    invoke(&plan, dir.path(), &log(), usize::MAX).unwrap();
    let value: serde_json::Value = serde_json::from_slice(&read(dir.path(), "provenance.json")).unwrap();
    assert_eq!(value["plan_hash"], plan.hash);
    assert_eq!(value["sessions"].as_array().unwrap().len(), 2);
    assert_eq!(value["sessions"][0]["device"]["name"], "fake");
    assert_eq!(value["inputs"]["builtin:constant"].as_str().unwrap().len(), 64);
    assert_eq!(value["metrics"].as_array().unwrap().len(), splitsum::metrics::METRICS.len());
}
