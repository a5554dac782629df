//! What every question keeps to, asked of made runs. A new question is tested by being listed.

use super::paper::scaled;
use super::sentences::{sentences, unfounded, word_count};
use crate::kept;
use crate::run::fake::Log;
use crate::run::runs::{finished, invoke, plan};
use crate::scratch::scratch;
use crate::snapshot::assert_snapshot;
use splitsum::experiment::axis::{Named, Point};
use splitsum::experiment::value::Value;
use splitsum::figure::Figure;
use splitsum::figure::svg::{WIDTHS, svg};
use splitsum::study::finished::Finished;
use splitsum::study::frame::{Frame, Shape};
use splitsum::study::questions::{Finding, QUESTIONS, Question, question};
use std::cell::RefCell;
use std::path::Path;
use std::rc::Rc;
use std::sync::OnceLock;

/// Experiments that together serve every question: the name, the text before the axes, the axes and the text after
/// them. Seven environments are enough for intervals.
const EXPERIMENTS: [[&str; 3]; 9] = [
    [
        "methods",
        REFERENCE,
        r#"environment = ["builtin:constant", "builtin:sky", "builtin:studio", "builtin:checker", "builtin:cap", "builtin:gradient", "builtin:sky:elevation_deg=8"]
method = ["sampled", "split-sum"]
samples = [1, 4, 16]
alpha = [0.1, 0.5]
exposure = [1, 10]
diffuse = ["none"]
[timing]
warmup = 1
rounds = 7"#,
    ],
    [
        "parameters",
        REFERENCE,
        r#"environment = ["builtin:sky"]
environment_scale = [1, 3]
method = ["sampled", "split-sum", "sampled-unfiltered"]
samples = [4, 16]
alpha = [0.1, 0.5]
lod_bias = [0, 1]
prefilter = ["sampled"]
prefilter_sample_count = [16, 64]
dfg_size = [16, 32]
diffuse = ["none"]
[timing]
warmup = 1
rounds = 7"#,
    ],
    [
        "one-case",
        REFERENCE,
        r#"method = ["sampled", "split-sum"]
samples = [1, 4, 16]
contrast = [1, 2]
diffuse = ["none"]"#,
    ],
    [
        "diffuse",
        REFERENCE,
        r#"environment = ["builtin:sky", "builtin:studio"]
method = ["none"]
diffuse = ["sh9", "irradiance-map"]
irradiance_size = [[16, 16], [32, 32]]
prefilter = ["sampled"]
irradiance_sample_count = [[32, 8], [64, 16]]"#,
    ],
    [
        "tables",
        "reference = { method = \"ladder-view\", samples = 64 }",
        r#"environment = ["builtin:sky", "builtin:studio"]
method = ["split-sum", "reference"]
samples = [64]
alpha = [0.1, 0.5]
prefilter_size = [[64, 64], [128, 128]]
level_mapping = ["linear", "quadratic"]
dfg_size = [16, 32]
diffuse = ["none"]"#,
    ],
    [
        "ladder",
        "scene = \"design\"\nreference = { samples = 64 }\n[ladder]\nsamples = 64",
        r#"environment = ["builtin:constant", "builtin:sky", "builtin:studio", "builtin:checker", "builtin:cap", "builtin:gradient"]
method = ["split-sum"]
alpha = [0.1, 0.5]
diffuse = ["none"]"#,
    ],
    [
        "split-sums",
        REFERENCE,
        r#"environment = ["builtin:constant", "builtin:sky", "builtin:studio", "builtin:checker", "builtin:cap", "builtin:gradient"]
environment_orientation = [1, 2]
method = ["split-sum", "split-sum-one", "split-sum-two", "sampled"]
samples = [4, 16]
f0 = [0.04, 1]
alpha = [0.1, 0.5]
diffuse = ["none"]
compensation = ["turquin"]"#,
    ],
    [
        "frames",
        REFERENCE,
        r#"environment = ["builtin:constant", "builtin:sky", "builtin:studio", "builtin:checker", "builtin:cap", "builtin:gradient"]
method = ["split-sum", "split-sum-two", "sampled"]
samples = [1, 4]
frames = [1, 4, 16]
motion = ["still", "light"]
alpha = [0.1, 0.5]
diffuse = ["none"]"#,
    ],
    [
        "furnace",
        "reference = { method = \"none\", samples = 64, terms = \"all\" }",
        r#"environment = ["builtin:constant"]
brdf = ["ggx", "phong"]
masking = ["separable", "correlated"]
method = ["reference"]
samples = [64]
alpha = [0.1, 0.5]
f0 = [1]
albedo = [1]
metallic = [0]
diffuse = ["none"]"#,
    ],
];

const REFERENCE: &str = "reference = { samples = 64 }";

/// The runs of the experiments, and each again with errors that depend on alpha, environment and method.
fn runs() -> &'static [Finished] {
    static RUNS: OnceLock<Vec<Finished>> = OnceLock::new();
    RUNS.get_or_init(|| {
        let mut runs = Vec::new();
        let folder = scratch();
        for [name, head, axes] in EXPERIMENTS {
            // Some questions read the images of their run, so the folder must live longer.
            let dir = folder.join(name);
            finished(&plan(&format!("name = \"{name}\"\nsize = [16, 16]\n{head}\n[axes]\n{axes}\n")), &dir);
            runs.push(Finished::read(&dir).unwrap());
            let mut varied = Finished::read(&dir).unwrap();
            scaled(&mut varied, factor);
            runs.push(varied);
        }
        runs
    })
}

/// Sampling gains with alpha on the split sum, under some environments more than under others.
fn factor(point: &Point) -> f64 {
    let alpha = match point.get("alpha") {
        Value::Number(alpha) => *alpha,
        _ => 0.3,
    };
    let light = point.get("environment").to_string().len() as f64 / 10.0;
    match point.get("method").to_string().as_str() {
        "split-sum" => light * light * (0.05 + alpha),
        _ => light / (0.05 + alpha),
    }
}

fn asked(run: &Finished) -> Vec<(&'static Question, Finding)> {
    let frame = Frame::new(run, None);
    let serves = QUESTIONS.iter().filter(|question| (question.lacks)(&frame.shape).is_none());
    let name = run.text("/name");
    let answer = |asked: &&'static Question| {
        let finding = (asked.answer)(&frame);
        // The synthetic renderer has no error in the diffuse term, so a ratio of its errors has no meaning.
        assert!(finding.is_some() || name == "diffuse", "{}: no answer of {name}", asked.name);
        Some((*asked, finding?))
    };
    serves.filter_map(answer).collect()
}

pub fn figures() -> Vec<Figure> {
    runs().iter().flat_map(asked).filter_map(|(_, finding)| finding.figure).collect()
}

fn each(check: impl Fn(&Finished, &'static Question, &Finding)) {
    for run in runs() {
        asked(run).iter().for_each(|(question, finding)| check(run, question, finding));
    }
}

#[test]
fn every_question_is_served_by_a_synthetic_run() {
    let served: Vec<&str> = runs().iter().flat_map(asked).map(|(question, _)| question.name).collect();
    for question in QUESTIONS {
        assert!(served.contains(&question.name), "{}", question.name);
    }
}

#[test]
fn questions_an_experiment_serves_are_known_before_it_runs() {
    for run in runs() {
        let written = Shape::of_config(run.config.as_ref().unwrap());
        let rendered = Frame::new(run, None).shape;
        for question in QUESTIONS {
            let [before, after] = [&written, &rendered].map(|shape| (question.lacks)(shape));
            assert_eq!(before, after, "{} of {}", question.name, run.text("/name"));
        }
    }
}

#[test]
fn every_question_has_a_table_of_its_columns() {
    each(|_, question, finding| {
        let names = &finding.table.columns;
        assert!(!finding.table.rows.is_empty(), "{}", question.name);
        assert!(names.iter().all(|name| !name.is_empty() && !name.contains('-')), "{names:?}");
        let is_axis = |name: &String| Named::all().any(|named| named.name() == name);
        let own: Vec<&str> = names.iter().filter(|name| !is_axis(name)).map(String::as_str).collect();
        assert_eq!(own, question.columns.iter().map(|column| column.name).collect::<Vec<_>>(), "{}", question.name);
        assert!(question.columns.iter().all(|column| column.about.ends_with('.')), "{}", question.name);
        assert!(question.asks.ends_with('?'), "{}", question.asks);
    });
}

#[test]
fn sentences_are_short() {
    each(|_, question, finding| {
        let said = sentences(&finding.sentence);
        assert!((1..=3).contains(&said.len()), "{}: {}", question.name, finding.sentence);
        for sentence in said {
            // A formula in backticks is one word.
            let bare: String =
                sentence.split('`').enumerate().map(|(i, part)| if i % 2 == 1 { "formula" } else { part }).collect();
            let count = word_count(&bare);
            assert!(count <= 25, "{}: {count} words: {sentence}", question.name);
            assert!(sentence.ends_with('.') && !sentence.contains("  "), "{sentence}");
            assert!(!sentence.contains("NaN") && !sentence.contains("inf"), "{sentence}");
            assert!(!sentence.contains("1 cases") && !sentence.contains("of 1 case"), "{sentence}");
        }
    });
}

#[test]
fn every_number_of_a_sentence_is_one_of_its_tables() {
    each(|run, question, finding| {
        let missing = unfounded(finding);
        let digest = finding.digest.as_ref().map(|digest| digest.markdown()).unwrap_or_default();
        let name = run.text("/name");
        assert!(missing.is_empty(), "{} of {name}: {missing:?} in: {}\n{digest}", question.name, finding.sentence);
    });
}

#[test]
fn every_figure_is_well_formed_and_its_cells_exist() {
    each(|run, question, finding| {
        let Some(figure) = &finding.figure else { return };
        for width in WIDTHS {
            assert_eq!(roxmltree::Document::parse(&svg(figure, width)).err(), None, "{}", question.name);
        }
        let marks = || figure.panels.iter().flat_map(|panel| &panel.marks);
        assert!(marks().next().is_some(), "{}: nothing is drawn", question.name);
        for mark in marks() {
            assert!(mark.series.is_none_or(|series| series < figure.series.len()), "{}: {mark:?}", question.name);
            if let Some(id) = &mark.cell {
                assert!(run.cells.iter().any(|cell| cell.id == *id), "{}: no cell {id}", question.name);
                assert!(!mark.tip.is_empty(), "{}: a link without words", question.name);
            }
        }
    });
}

#[test]
fn a_failed_cell_does_not_prevent_an_answer() {
    for run in runs().iter().step_by(2) {
        let whole = asked(run);
        let last = run.cells.len() - 1;
        for failed in [0, run.cells.len() / 2, last] {
            let mut broken = run.clone();
            broken.cells[failed].scores = None;
            let frame = Frame::new(&broken, None);
            for (question, before) in &whole {
                let Some(after) = (question.answer)(&frame) else {
                    // The resolved part of so small a run may be too small.
                    assert!(before.table.rows.len() <= 4, "{} says nothing", question.name);
                    continue;
                };
                assert!(2 * after.table.rows.len() >= before.table.rows.len(), "{}", question.name);
                assert_eq!(unfounded(&after), Vec::<String>::new(), "{}: {}", question.name, after.sentence);
                let is_sound = |text: &str| !text.contains("NaN") && !text.contains("inf");
                assert!(is_sound(&after.sentence) && is_sound(&after.table.csv()), "{}", question.name);
            }
        }
    }
}

/// Errors, shares and times differ in every cell, three times, so a slip in a table, an answer or a figure moves a number.
#[test]
fn numbers_of_scrambled_runs_are_kept() {
    for [name, head, axes] in EXPERIMENTS {
        let kept = ["20, 14", "22, 15", "24, 17"].map(|size| {
            let (dir, log) = (tempfile::tempdir().unwrap(), Log { is_scrambled: true, ..Log::default() });
            let plan = plan(&format!("name = \"{name}\"\nsize = [{size}]\n{head}\n[axes]\n{axes}\n"));
            invoke(&plan, dir.path(), &Rc::new(RefCell::new(log)), usize::MAX).unwrap();
            kept::folder(dir.path())
        });
        assert_snapshot(&format!("run_{name}"), &kept.join("\n"));
    }
}

/// A question that no experiment asks would never be answered.
#[test]
fn every_question_is_asked_by_an_experiment() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("experiments");
    let files = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let files: Vec<_> = files.filter(|path| path.extension().is_some_and(|extension| extension == "toml")).collect();
    let asked: Vec<String> = files.iter().flat_map(|path| asks(&std::fs::read_to_string(path).unwrap())).collect();
    for question in QUESTIONS {
        assert!(asked.iter().any(|asked| asked == question.name), "no experiment asks {}", question.name);
    }
    for name in &asked {
        assert!(question(name).is_some(), "{name} is asked and is not a question");
    }
}

fn asks(text: &str) -> Vec<String> {
    let root: toml::Table = text.parse().unwrap();
    let name = |ask: &toml::Value| ask.get("question").unwrap_or(ask).as_str().unwrap().to_owned();
    root["asks"].as_array().unwrap().iter().map(name).collect()
}
