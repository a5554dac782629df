//! What every question keeps to, asked of made runs. A new question is tested by being listed.

use super::paper::scaled;
use super::sentences::{sentences, unfounded, word_count};
use crate::run::fake::Log;
use crate::run::runs::{finished, invoke, plan};
use crate::scratch::scratch;
use splitsum::draw::figure::Figure;
use splitsum::draw::figure::svg::{WIDTHS, svg};
use splitsum::experiment::axis::{AXES, Named, Point};
use splitsum::experiment::plan::Plan;
use splitsum::experiment::value::Value;
use splitsum::study::finished::{Bin, Finished, FinishedCell, MetricValues};
use splitsum::study::frame::{Frame, Shape};
use splitsum::study::questions::{Finding, QUESTIONS, Question, question};
use std::cell::RefCell;
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::rc::Rc;
use std::sync::OnceLock;

/// Texts of the experiments in a folder, by name.
pub fn experiments(folder: &str) -> Vec<(String, String)> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join(folder);
    let files = std::fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap().path());
    let files = files.filter(|path| {
        path.extension()
            .is_some_and(|extension| extension == "toml")
    });
    let named = |path: PathBuf| {
        let name = path.file_stem().unwrap().to_string_lossy().into_owned();
        (name, std::fs::read_to_string(path).unwrap())
    };
    let mut all: Vec<_> = files.map(named).collect();
    all.sort();
    all
}

/// Experiments that together serve every question. Seven environments are enough for intervals.
const SYNTHETIC: &str = "tests/golden/questions";
const SHIPPED: &str = "experiments";

/// The runs of the experiments, and each again with errors that depend on alpha, environment and
/// method.
fn runs() -> &'static [Finished] {
    static RUNS: OnceLock<Vec<Finished>> = OnceLock::new();
    RUNS.get_or_init(|| {
        let mut runs = Vec::new();
        let folder = scratch();
        for (name, text) in experiments(SYNTHETIC) {
            // Some questions read the images of their run, so the folder must live longer.
            let dir = folder.join(name);
            finished(&plan(&text), &dir);
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
    let serves = QUESTIONS
        .iter()
        .filter(|question| question.lack(&frame.shape).is_none());
    let name = run.provenance.name.clone();
    let answer = |asked: &&'static Question| {
        let finding = (asked.answer)(&frame);
        // The synthetic renderer has no error in the diffuse term, so a ratio of its errors has no
        // meaning.
        assert!(
            finding.is_some() || name == "diffuse",
            "{}: no answer of {name}",
            asked.name
        );
        Some((*asked, finding?))
    };
    serves.filter_map(answer).collect()
}

pub fn figures() -> Vec<Figure> {
    runs()
        .iter()
        .flat_map(asked)
        .filter_map(|(_, finding)| finding.figure)
        .collect()
}

fn each(check: impl Fn(&Finished, &'static Question, &Finding)) {
    for run in runs() {
        asked(run)
            .iter()
            .for_each(|(question, finding)| check(run, question, finding));
    }
}

#[test]
fn every_question_is_served_by_a_synthetic_run() {
    let served: Vec<&str> = runs()
        .iter()
        .flat_map(asked)
        .map(|(question, _)| question.name)
        .collect();
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
            let [before, after] = [&written, &rendered].map(|shape| question.lack(shape));
            assert_eq!(
                before, after,
                "{} of {}",
                question.name, run.provenance.name
            );
        }
    }
}

#[test]
fn every_question_has_a_table_of_its_columns() {
    each(|_, question, finding| {
        let names = &finding.table.columns;
        assert!(!finding.table.rows.is_empty(), "{}", question.name);
        assert!(
            names
                .iter()
                .all(|name| !name.is_empty() && !name.contains('-')),
            "{names:?}"
        );
        let is_axis = |name: &String| Named::all().any(|named| named.name() == name);
        let own: Vec<&str> = names
            .iter()
            .filter(|name| !is_axis(name))
            .map(String::as_str)
            .collect();
        assert_eq!(
            own,
            question
                .columns
                .iter()
                .map(|column| column.name)
                .collect::<Vec<_>>(),
            "{}",
            question.name
        );
        assert!(
            question
                .columns
                .iter()
                .all(|column| column.about.ends_with('.')),
            "{}",
            question.name
        );
        assert!(question.asks.ends_with('?'), "{}", question.asks);
    });
}

#[test]
fn sentences_are_short() {
    each(|_, question, finding| {
        let text = finding.sentences.markdown();
        let said = sentences(&text);
        assert!(
            (1..=3).contains(&said.len()),
            "{}: {}",
            question.name,
            finding.sentences.markdown()
        );
        for sentence in said {
            // A formula in backticks is one word.
            let bare: String = sentence
                .split('`')
                .enumerate()
                .map(|(i, part)| if i % 2 == 1 { "formula" } else { part })
                .collect();
            let count = word_count(&bare);
            assert!(count <= 25, "{}: {count} words: {sentence}", question.name);
            assert!(
                sentence.ends_with('.') && !sentence.contains("  "),
                "{sentence}"
            );
            assert!(
                !sentence.contains("NaN") && !sentence.contains("inf"),
                "{sentence}"
            );
            assert!(
                !sentence.contains("1 cases") && !sentence.contains("of 1 case"),
                "{sentence}"
            );
        }
    });
}

#[test]
fn every_number_of_a_sentence_is_one_of_its_tables() {
    each(|run, question, finding| {
        let missing = unfounded(finding);
        let digest = finding
            .digest
            .as_ref()
            .map(|digest| digest.markdown())
            .unwrap_or_default();
        let name = run.provenance.name.clone();
        assert!(
            missing.is_empty(),
            "{} of {name}: {missing:?} in: {}\n{digest}",
            question.name,
            finding.sentences.markdown()
        );
    });
}

#[test]
fn every_figure_is_well_formed_and_its_cells_exist() {
    each(|run, question, finding| {
        let Some(figure) = &finding.figure else {
            return;
        };
        for width in WIDTHS {
            assert_eq!(
                roxmltree::Document::parse(&svg(figure, width)).err(),
                None,
                "{}",
                question.name
            );
        }
        let marks = || figure.panels.iter().flat_map(|panel| &panel.marks);
        assert!(
            marks().next().is_some(),
            "{}: nothing is drawn",
            question.name
        );
        for mark in marks() {
            assert!(
                mark.series
                    .is_none_or(|series| series < figure.series.len()),
                "{}: {mark:?}",
                question.name
            );
            if let Some(id) = &mark.cell {
                assert!(
                    run.cells.iter().any(|cell| *cell.id == **id),
                    "{}: no cell {id}",
                    question.name
                );
                assert!(
                    !mark.tip.is_empty(),
                    "{}: a link without words",
                    question.name
                );
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
            broken.cells[failed].is_failed = true;
            let frame = Frame::new(&broken, None);
            for (question, before) in &whole {
                let Some(after) = (question.answer)(&frame) else {
                    // The resolved part of so small a run may be too small.
                    assert!(
                        before.table.rows.len() <= 4,
                        "{} says nothing",
                        question.name
                    );
                    continue;
                };
                assert!(
                    2 * after.table.rows.len() >= before.table.rows.len(),
                    "{}",
                    question.name
                );
                assert_eq!(
                    unfounded(&after),
                    Vec::<String>::new(),
                    "{}: {}",
                    question.name,
                    after.sentences.markdown()
                );
                let is_sound = |text: &str| !text.contains("NaN") && !text.contains("inf");
                assert!(
                    is_sound(&after.sentences.markdown()) && is_sound(&after.table.csv()),
                    "{}",
                    question.name
                );
            }
        }
    }
}

pub fn run_scrambled(plan: &Plan, dir: &Path) {
    let log = Log {
        is_scrambled: true,
        has_f0: plan.config.recovery.is_some(),
        ..Log::default()
    };
    invoke(plan, dir, &Rc::new(RefCell::new(log)), usize::MAX).unwrap();
}

/// Runs whose every error differs, so that nothing is tied.
fn scrambled_runs() -> Vec<Finished> {
    let read = |(name, text): (String, String)| {
        let dir = scratch().join(format!("scrambled-{name}"));
        run_scrambled(&plan(&text), &dir);
        Finished::read(&dir).unwrap()
    };
    // Of `counts` some images are equal, whose errors the fake renderer makes unequal.
    experiments(SYNTHETIC)
        .into_iter()
        .filter(|(name, _)| name != "counts")
        .map(read)
        .collect()
}

/// What a run answers, with the lines of tables in the order of their text.
fn said(run: &Finished) -> Vec<(&'static str, String)> {
    let frame = Frame::new(run, None);
    let said = |question: &'static Question| {
        let finding = (question.answer)(&frame)?;
        let digest = finding
            .digest
            .as_ref()
            .map(|digest| digest.markdown())
            .unwrap_or_default();
        let text = finding.sentences.markdown();
        let mut lines: Vec<&str> = digest.lines().chain([text.as_str()]).collect();
        lines.sort_unstable();
        Some((question.name, lines.join("\n")))
    };
    QUESTIONS
        .iter()
        .copied()
        .filter(|question| question.lack(&frame.shape).is_none())
        .filter_map(said)
        .collect()
}

/// Cells that bring a new value of an axis come first, because the first value is the base.
#[test]
fn order_and_failed_twins_of_cells_change_no_answer() {
    for run in scrambled_runs() {
        let (before, mut seen) = (said(&run), BTreeSet::new());
        let is_first: BTreeMap<&str, bool> = (run.cells.iter())
            .map(|cell| {
                (
                    &*cell.id,
                    AXES.ids()
                        .any(|axis| seen.insert((axis, cell.point[axis].to_string()))),
                )
            })
            .collect();
        // A failed cell beside a finished one of its point is irrelevant.
        let mut more = run.clone();
        let failed = |cell: &FinishedCell| FinishedCell {
            id: format!("{}-failed", cell.id).into(),
            scores: None,
            ..cell.clone()
        };
        more.cells.extend(run.cells.iter().map(failed));
        assert_eq!(
            said(&more),
            before,
            "{} with failed cells",
            run.provenance.name
        );
        for seed in 0..3 {
            let mut shuffled = run.clone();
            let hash = |id: &str| *blake3::hash(format!("{seed} {id}").as_bytes()).as_bytes();
            shuffled.cells.sort_by_key(|cell| {
                if is_first[&*cell.id] {
                    [0; 32]
                } else {
                    hash(&cell.id)
                }
            });
            assert_eq!(
                said(&shuffled),
                before,
                "{} by seed {seed}",
                run.provenance.name
            );
        }
    }
}

/// Ratios and break-evens do not depend on the unit of an error.
#[test]
fn the_unit_of_the_metric_changes_no_ratio() {
    for run in scrambled_runs() {
        let mut quadrupled = run.clone();
        scaled(&mut quadrupled, |_| 4.0);
        let by_four = |floors: &mut MetricValues| {
            let old = floors.clone();
            *floors = MetricValues::from_fn(|name| {
                old.get(name)
                    .map(|floor| if name == "flip" { floor } else { 4.0 * floor })
            });
        };
        for cell in &mut quadrupled.cells {
            by_four(&mut cell.noise_floors);
            let mut bins: Vec<Bin> = cell.bins.iter().collect();
            bins.iter_mut()
                .for_each(|bin| by_four(&mut bin.noise_floors));
            cell.bins = bins.into();
        }
        let ratios = |run: &Finished| {
            said(run)
                .into_iter()
                .filter(|(name, _)| ["break-even", "effect"].contains(name))
                .collect::<Vec<_>>()
        };
        assert_eq!(ratios(&quadrupled), ratios(&run), "{}", run.provenance.name);
    }
}

/// A question that no experiment asks would never be answered.
#[test]
fn every_question_is_asked_by_an_experiment() {
    let asked: Vec<String> = experiments(SHIPPED)
        .iter()
        .flat_map(|(_, text)| asks(text))
        .collect();
    for question in QUESTIONS {
        assert!(
            asked.iter().any(|asked| asked == question.name),
            "no experiment asks {}",
            question.name
        );
    }
    for name in &asked {
        assert!(
            question(name).is_some(),
            "{name} is asked and is not a question"
        );
    }
}

fn asks(text: &str) -> Vec<String> {
    let root: toml::Table = text.parse().unwrap();
    let name = |ask: &toml::Value| {
        ask.get("question")
            .unwrap_or(ask)
            .as_str()
            .unwrap()
            .to_owned()
    };
    root["asks"].as_array().unwrap().iter().map(name).collect()
}
