//! The report without a browser: what is computed from a run, what is embedded, what cannot break out of the page.

use crate::runner::runs::{finished, plan};
use base64::Engine;
use base64::prelude::BASE64_STANDARD;
use flate2::read::DeflateDecoder;
use half::f16;
use splitsum::pixels::packed;
use splitsum::pixels::{GrayImage, RgbImage};
use splitsum::study::answers::break_even::{BreakEven, crossing};
use splitsum::study::answers::run_folder::RunFolder;
use splitsum::study::answers::slope::slope;
use splitsum::study::answers::study::{Role, Study};
use splitsum::study::answers::words::answer;
use splitsum::study::answers::{Answered, Answers};
use splitsum::study::report::images::{BUDGET_BYTES, Choice, Window, collect};
use splitsum::study::report::page::in_script;
use splitsum::study::report::{ReportOptions, write};
use splitsum::table::csv::Table;
use std::collections::{BTreeMap, BTreeSet};
use std::io::Read;
use std::path::{Path, PathBuf};

/// f64 arithmetic of a few logarithms.
const F64: f64 = 1e-12;

#[test]
fn a_power_law_has_its_exponent_and_no_spread() {
    let points: Vec<(f64, f64)> = [1.0, 4.0, 16.0, 64.0].map(|n: f64| (n, 3.0 * n.powf(-0.75))).to_vec();
    let fit = slope(&points).unwrap();
    assert!((fit.value + 0.75).abs() < F64 && (fit.intercept - 3f64.ln()).abs() < F64, "{fit:?}");
    assert!(fit.hi - fit.lo < 1e-6, "{fit:?}");
}

#[test]
fn the_interval_of_a_slope_is_students() {
    // ln x = 0, 1, 2 and ln y = 0, -1.5, -2: slope -1, residuals 1/6, -1/3, 1/6, so s^2 = 1/6 and sxx = 2.
    let points = [(0.0, 0.0), (1.0, -1.5), (2.0, -2.0)].map(|(x, y): (f64, f64)| (x.exp(), y.exp()));
    let fit = slope(&points).unwrap();
    let half = 12.706 * (1.0f64 / 6.0 / 2.0).sqrt();
    assert!((fit.value + 1.0).abs() < F64 && (fit.hi - fit.value - half).abs() < 1e-9, "{fit:?} {half}");
    assert!(slope(&points[..2]).is_none(), "two points leave no degree of freedom");
    assert!(slope(&[(1.0, 1.0), (2.0, 0.0), (4.0, 1.0)]).is_none(), "ln 0");
}

#[test]
fn curves_cross_where_their_segment_does() {
    let curve = [(1, 0.4), (4, 0.2), (16, 0.1)];
    let n = crossing(&curve, 0.15, BreakEven::From(16)).unwrap();
    // Error falls as 1/sqrt(n): 0.4 / sqrt(n) = 0.15.
    assert!((n - (0.4f64 / 0.15).powi(2)).abs() < 1e-9, "{n}");
    assert_eq!(crossing(&curve, 0.5, BreakEven::From(1)), None, "already better at the first count");
    assert_eq!(crossing(&curve, 0.01, BreakEven::Above(16)), None);
}

#[test]
fn json_in_a_script_element_cannot_end_it() {
    let value = serde_json::json!({ "</script><!--": ["<script>", "]]>", "\u{2028}", "\"=1+1"] });
    let text = in_script(&value);
    assert!(!text.contains('<'), "{text}");
    assert_eq!(serde_json::from_str::<serde_json::Value>(&text).unwrap(), value);
}

/// What the page does: base64, inflate, sum the differences.
fn decoded(text: &str, plane: usize) -> Vec<u8> {
    let mut bytes = Vec::new();
    DeflateDecoder::new(BASE64_STANDARD.decode(text).unwrap().as_slice()).read_to_end(&mut bytes).unwrap();
    for plane in bytes.chunks_mut(plane) {
        for i in 1..plane.len() {
            plane[i] = plane[i].wrapping_add(plane[i - 1]);
        }
    }
    bytes
}

#[test]
fn an_encoded_image_decodes_to_its_nearest_halves() {
    let image = RgbImage::from_fn(5, 3, |x, y| [0.1 * x as f32, 1e-7 * y as f32, 30_000.0 * (x * y) as f32]);
    let encoded = packed::radiance(&image);
    let bytes = decoded(&encoded.base64, 15);
    for (i, texel) in image.data.iter().enumerate() {
        for (channel, value) in texel.iter().enumerate() {
            let at = channel * 30 + i;
            let half = f16::from_bits(u16::from_be_bytes([bytes[at], bytes[at + 15]]));
            assert_eq!(half, f16::from_f32(value.min(packed::HALF_MAX)), "texel {i}, channel {channel}");
        }
    }
    assert_eq!(encoded.clamped_count, image.data.iter().filter(|texel| texel[2] > packed::HALF_MAX).count());
    assert!(encoded.clamped_count > 0);
    let mask = GrayImage::from_fn(4, 4, |x, y| if x > y { 1.0 } else { 0.0 });
    assert_eq!(decoded(&packed::mask(&mask), 16), mask.data.iter().map(|m| *m as u8).collect::<Vec<u8>>());
}

const EXPERIMENT: &str = r#"
name = "tiny"
question = "When does sampling win?"
size = [200, 200]
reference = { samples = 64 }
[axes]
environment = ["builtin:constant"]
alpha = [0.1, 0.5]
method = ["sampled", "split-sum"]
samples = [1, 4, 16]
exposure = [1, 10]
[timing]
warmup = 1
rounds = 3
"#;

pub fn finished_run(dir: &Path) -> PathBuf {
    finished(&plan(EXPERIMENT), &dir.join("run"))
}

#[test]
fn a_run_is_read_back_as_cases_with_their_answer() {
    let dir = tempfile::tempdir().unwrap();
    let runs = [RunFolder::read(&finished_run(dir.path())).unwrap()];
    let study = Study::new(&runs, &["run".to_owned()]);
    let role = |name: &str| study.axes.iter().find(|axis| axis.name == name).unwrap().role;
    let found = ["alpha", "samples", "method", "exposure", "brdf"].map(role);
    assert_eq!(found, [Role::Scene, Role::Variant, Role::Variant, Role::Display, Role::Fixed]);
    let analysis = Answers::new(&study, &runs);
    assert_eq!(analysis.case_axes, ["alpha"]);
    let [pair] = analysis.pairs.as_slice() else { panic!("{:?}", analysis.pairs) };
    assert_eq!((pair.cases.len(), &pair.sample_counts), (2, &vec![1, 4, 16]));
    for case in &pair.cases {
        // The fake's errors: 0.4 / sqrt(n) against 0.15 of the same radiance.
        assert_eq!(case.whole.break_even, BreakEven::From(16));
        assert!((case.whole.crossing.unwrap() - (0.4f64 / 0.15).powi(2)).abs() < 1e-3, "{:?}", case.whole.crossing);
        assert!(!case.bins.is_empty() && case.bins.iter().all(|bin| bin.crossing.break_even == BreakEven::From(16)));
        let slope = analysis.curves[case.curve].slope.unwrap();
        assert!((slope.value + 1.0).abs() < 1e-3, "squared error falls as 1/n: {slope:?}");
    }
    let answer = answer(&study, &analysis);
    // There are more sample counts than tone curves, so break-even leads; what the curves show follows.
    assert_eq!(answer.number, "16");
    assert!(answer.sentence.starts_with("From 16 samples a pixel on, sampled"), "{}", answer.sentence);
    assert!(answer.facts.iter().any(|fact| fact.contains("shows most at exposure 1 ")), "{:?}", answer.facts);
    assert!(answer.facts.iter().any(|fact| fact.contains("18.0 ms against 3.00 ms")), "{:?}", answer.facts);
    // The ratio beside the two is not their quotient, and says so.
    assert!(answer.facts.iter().any(|fact| fact.contains("; round by round it takes")), "{:?}", answer.facts);
}

#[test]
fn a_report_is_the_same_each_time_and_has_its_figures_beside_it() {
    let dir = tempfile::tempdir().unwrap();
    let run = finished_run(dir.path());
    let options = ReportOptions::of_run(&run);
    let written = write(&options).unwrap();
    let before = std::fs::read(&written.path).unwrap();
    write(&options).unwrap();
    assert!(std::fs::read(&written.path).unwrap() == before);
    let page = String::from_utf8(before).unwrap();
    assert!(!page.contains("src=\"http") && !page.contains("href=\"http") && page.contains("default-src 'none'"));
    let figures = run.join("report-figures");
    for name in [
        "convergence",
        "break_even",
        "break_even_by_n_dot_v",
        "error_by_n_dot_v_and_alpha",
        "n_dot_v_profile",
        "exposure_and_contrast",
        "time_and_error",
        "pass_times",
    ] {
        let table = Table::read(&figures.join(format!("{name}.csv"))).unwrap();
        assert!(!table.rows.is_empty());
        let text = std::fs::read_to_string(figures.join(format!("{name}.vl.json"))).unwrap();
        let spec: serde_json::Value = serde_json::from_str(&text).unwrap();
        assert_eq!(spec["data"]["url"], format!("{name}.csv"));
        let (made, fields) = fields_of(&spec);
        for field in &fields {
            let is_known = made.contains_key(field) || table.columns.iter().any(|column| column == field);
            assert!(is_known, "{name} draws {field}");
        }
        assert!(spec.get("encoding").is_none_or(serde_json::Value::is_object), "{name}");
        assert_drawn_as_meant(name, &spec, &table);
    }
}

/// What Vega makes of a specification and no schema tells: found by looking at its pictures.
fn assert_drawn_as_meant(name: &str, spec: &serde_json::Value, table: &Table) {
    use serde_json::Value;
    let columns = |field: &str| table.columns.iter().position(|column| column == field);
    let values = |column: usize| table.rows.iter().map(move |row| row[column].as_str());
    // As text, 16 comes before 4.
    let parsed = spec["data"]["format"]["parse"].as_object().unwrap();
    for (i, column) in table.columns.iter().enumerate() {
        let are_numbers = values(i).all(|text| text.is_empty() || text.parse::<f64>().is_ok());
        let is_empty = values(i).all(str::is_empty);
        assert_eq!(parsed.contains_key(column), are_numbers && !is_empty, "{name}: {column}");
    }
    let mut parts = vec![spec];
    while let Some(part) = parts.pop() {
        parts.extend(part["layer"].as_array().into_iter().flatten().chain(part.get("spec")));
        let channels: Vec<(&String, &Value)> = part["encoding"].as_object().into_iter().flatten().collect();
        let has = |channel: &str| channels.iter().any(|(known, _)| *known == channel);
        for (channel, of) in &channels {
            // Axes of layers would otherwise be called by all their fields.
            let is_axis = ["x", "y"].contains(&channel.as_str()) && of["field"].is_string();
            let is_said = of.get("title").is_some()
                || table.columns.iter().any(|column| of["field"] == **column && !column.contains('_'));
            assert!(!is_axis || is_said, "{name}: {channel} has no title");
            // A mark whose size is that of a missing value is not drawn.
            let missing =
                of["field"].as_str().and_then(columns).is_some_and(|column| values(column).any(str::is_empty));
            assert!(*channel != "size" || !missing, "{name}: {channel} of missing values");
            // A facet sorts its values by their letters unless a field tells it otherwise.
            let is_facet = ["facet", "row"].contains(&channel.as_str());
            assert!(!is_facet || of["sort"]["field"].is_string(), "{name}: {channel} in the order of letters");
        }
        // A step without an axis to go along is an error.
        for (size, axis) in [("width", "x"), ("height", "y")] {
            assert!(part[size].get("step").is_none() || has(axis), "{name}: a step of {size} without {axis}");
        }
    }
}

#[test]
fn a_specification_without_an_axis_has_no_step_along_it() {
    let dir = tempfile::tempdir().unwrap();
    let few = EXPERIMENT.replace("alpha = [0.1, 0.5]", "alpha = [0.1]").replace("200, 200", "24, 24");
    let run = finished(&plan(&few), &dir.path().join("run"));
    write(&ReportOptions::of_run(&run)).unwrap();
    let file = |end: &str| run.join("report-figures").join(format!("break_even.{end}"));
    let spec = serde_json::from_str(&std::fs::read_to_string(file("vl.json")).unwrap()).unwrap();
    assert_drawn_as_meant("break_even", &spec, &Table::read(&file("csv")).unwrap());
}

#[test]
fn no_two_cases_lie_on_each_other_in_a_figure() {
    let dir = tempfile::tempdir().unwrap();
    let more = EXPERIMENT
        .replace("[\"builtin:constant\"]", "[\"builtin:constant\", \"builtin:sky\"]\nbrdf = [\"ggx\", \"phong\"]");
    let run = finished(&plan(&more.replace("200, 200", "24, 24")), &dir.path().join("run"));
    write(&ReportOptions::of_run(&run)).unwrap();
    let runs = [RunFolder::read(&run).unwrap()];
    let answers = Answers::new(&Study::new(&runs, &["run".to_owned()]), &runs);
    assert_eq!(answers.case_axes, ["environment", "brdf", "alpha"]);
    for name in ["convergence", "break_even", "break_even_by_n_dot_v", "n_dot_v_profile", "time_and_error"] {
        let text = std::fs::read_to_string(run.join("report-figures").join(format!("{name}.vl.json"))).unwrap();
        let (made, fields) = fields_of(&serde_json::from_str(&text).unwrap());
        // By itself, or within a made field.
        let is_within = |of: &String, axis: &str| of.contains(&format!("datum['{axis}']"));
        for axis in &answers.case_axes {
            let is_drawn = fields.contains(axis)
                || fields.iter().any(|field| made.get(field).is_some_and(|of| is_within(of, axis)));
            assert!(is_drawn, "{name} does not tell values of {axis} apart: {fields:?}");
        }
    }
}

/// The fields that a specification makes, with their expressions, and those that it draws.
fn fields_of(spec: &serde_json::Value) -> (BTreeMap<String, String>, BTreeSet<String>) {
    let (mut made, mut drawn) = (BTreeMap::new(), BTreeSet::new());
    let text = |value: &serde_json::Value, name: &str| value[name].as_str().map(str::to_owned);
    for step in spec["transform"].as_array().into_iter().flatten() {
        let parts = [&step["aggregate"], &step["window"]].map(|list| list.as_array().cloned().unwrap_or_default());
        for part in parts.concat().iter().chain([step]) {
            if let Some(name) = text(part, "as") {
                made.insert(name, text(part, "calculate").unwrap_or_default());
            }
        }
    }
    let channels = spec["encoding"].as_object().into_iter().flat_map(|encoding| encoding.values());
    let rows = ["row", "column"].map(|name| &spec["facet"][name]);
    let details = spec["encoding"]["detail"].as_array().into_iter().flatten();
    for channel in channels.chain([&spec["facet"]]).chain(rows).chain(details) {
        drawn.extend(text(channel, "field"));
    }
    for part in spec["layer"].as_array().into_iter().flatten().chain(spec.get("spec")) {
        let (more_made, more_drawn) = fields_of(part);
        made.extend(more_made);
        drawn.extend(more_drawn);
    }
    (made, drawn)
}

#[test]
fn images_over_the_budget_become_windows_where_the_error_is() {
    let dir = tempfile::tempdir().unwrap();
    let runs = [RunFolder::read(&finished_run(dir.path())).unwrap()];
    let whole = collect(&runs, Choice::Automatic, BUDGET_BYTES).unwrap();
    assert_eq!(whole.images.len(), 2 * (1 + 4));
    assert!(whole.notes.is_empty() && whole.images.iter().all(|image| image.window.unwrap().width == 200));
    let bytes = |payloads: &[String]| payloads.iter().map(String::len).sum::<usize>();
    let budget = bytes(&whole.payloads) / 2;
    let cut = collect(&runs, Choice::Automatic, budget).unwrap();
    assert!(cut.notes[0].contains("native texels"), "{:?}", cut.notes);
    assert!(bytes(&cut.payloads) <= budget && cut.images.iter().all(|image| image.payload.is_some()));
    let window = cut.images[1].window.unwrap();
    // The relative error d / sqrt(r^2 + 0.01) of a constant factor is largest where the sphere is brightest: in the middle.
    assert!((48..200).contains(&window.width) && (window.x + window.width / 2).abs_diff(100) < 8, "{window:?}");
    assert_eq!(cut.images[1].overview.unwrap().0, [67, 67]);
    let crop = |x, y, width, height| collect(&runs, Choice::Crop(Window { x, y, width, height }), BUDGET_BYTES);
    let corner = Window { x: 190, y: 0, width: 10, height: 10 };
    assert_eq!(crop(190, 0, 10, 10).unwrap().images[0].window, Some(corner));
    // One texel too far, far outside, larger than the image, and beyond what 32 bits can add.
    for [x, y, width, height] in [[191, 0, 10, 10], [500, 500, 10, 10], [100, 100, 200, 200], [u32::MAX, 0, 2, 2]] {
        let error = crop(x, y, width, height).unwrap_err().to_string();
        assert!(error.contains(&format!("--crop {x},{y},{width},{height}")) && error.contains("200 x "), "{error}");
    }
    // The command refuses it as bad input and writes nothing.
    let out = dir.path().join("cut.html");
    let output = std::process::Command::new(env!("CARGO_BIN_EXE_splitsum"))
        .args(["report", "--crop", "500,500,10,10", "--out"])
        .args([&out, &runs[0].dir])
        .output()
        .unwrap();
    assert_eq!(output.status.code(), Some(2), "{output:?}");
    assert!(String::from_utf8_lossy(&output.stderr).contains("--crop 500,500,10,10") && !out.exists(), "{output:?}");
    let none = collect(&runs, Choice::None, BUDGET_BYTES).unwrap();
    assert!(none.payloads.is_empty() && none.notes.len() == 1);
}

#[test]
fn no_file_but_a_report_is_written_over() {
    let dir = tempfile::tempdir().unwrap();
    let run = finished_run(dir.path());
    let report = |out: PathBuf| {
        let command = std::process::Command::new(env!("CARGO_BIN_EXE_splitsum"))
            .args(["report", "--no-images", "--out"])
            .args([&out, &run])
            .output();
        command.unwrap()
    };
    for name in ["errors.csv", "provenance.json", "summary.md"] {
        let path = run.join(name);
        let before = std::fs::read(&path).unwrap();
        let output = report(path.clone());
        let said = String::from_utf8_lossy(&output.stderr);
        assert!(output.status.code() == Some(2) && said.contains("is no report of splitsum"), "{name}: {output:?}");
        assert!(std::fs::read(&path).unwrap() == before, "{name}");
    }
    // A new file, and that file again.
    for _ in 0..2 {
        assert_eq!(report(dir.path().join("new.html")).status.code(), Some(0));
    }
}

#[test]
fn a_page_says_that_the_answers_beside_it_are_of_another_version() {
    let dir = tempfile::tempdir().unwrap();
    let run = finished_run(dir.path());
    Answered::of_run(&run).unwrap().write().unwrap();
    let page = || std::fs::read_to_string(write(&ReportOptions::of_run(&run)).unwrap().path).unwrap();
    assert!(!page().contains("written by another version of splitsum"));
    let file = run.join("answers").join("answer.json");
    let text = std::fs::read_to_string(&file).unwrap();
    std::fs::write(&file, text.replace("\"number\": \"16\"", "\"number\": \"17\"")).unwrap();
    assert!(page().contains("written by another version of splitsum"));
}

#[test]
fn a_folder_that_is_no_run_is_named() {
    let dir = tempfile::tempdir().unwrap();
    let error = write(&ReportOptions::of_run(dir.path())).unwrap_err().to_string();
    assert!(error.contains("has no provenance.json; expected the folder of a run"), "{error}");
}
