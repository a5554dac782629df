//! Questions that a run can answer, one file each. The file's stem, with hyphens, is the key in
//! `asks`, the name of CSV and SVG, and the anchor of the page.

mod by_lookups;
mod chart;
mod numbers;
mod prelude;
mod weights;
pub mod words;

pub use super::finding::{Finding, Sentences};
use super::finished::{Finished, check_weight};
use super::frame::{Frame, Shape};
use super::table::{Column, column};
use crate::base::names::not_listed;
use crate::experiment::axis::{AXES, AxisId, ENVIRONMENT, METHOD, Part, SCENE};
use crate::experiment::config::Config;
use crate::experiment::fault::Faults;
use crate::instrument::metrics::Weight;

/// Where a user finds every question.
const LISTED_QUESTIONS: &str = "a name of `splitsum list questions`";

const ERROR: Column = column(
    "error",
    "Error in the metric of the question, geometric mean over point sets.",
);
const NOISE_FLOOR: Column = column(
    "noise_floor",
    "Error that an exact image would have, from the reference's own noise; taken off the error \
     unless references are exact.",
);
const IS_RESOLVED: Column = column(
    "is_resolved",
    "1 if the mean square error is at least 11 times that noise, or 100 times with exact references, \
     else 0.",
);
const SAMPLED: Column = column("sampled", "The sampling method.");
const FIXED: Column = column("fixed", "The method without samples.");
pub const N_DOT_V_FROM: Column = column("n_dot_v_from", "Lower end of n·v.");
pub const N_DOT_V_TO: Column = column("n_dot_v_to", "Upper end of n·v.");
/// The first column of weighted answers.
pub const WEIGHT: Column = column(
    "weight",
    "Weight of the views of the scene `design`: `picture` is 2 n·v, `uniform` is equal for all \
     n·v, a scene's name takes the n·v of its pixels. Rows of pictures have `picture`.",
);
const UPPER: &str = "Upper end of that interval.";
/// Declares and lists the modules of the questions.
macro_rules! questions {
    ($($stem:ident),+ $(,)?) => {
        $(mod $stem;)+
        pub static QUESTIONS: &[&Question] = &[$(&$stem::QUESTION),+];
    };
}

questions! {
    break_even,
    frames,
    convergence,
    error,
    effect,
    tables,
    ladder,
    n_dot_v,
    visibility,
    key_light,
    pictures,
    recovery,
    times,
}

pub struct Question {
    /// The file's stem with hyphens.
    pub name: &'static str,
    pub asks: &'static str,
    /// Columns of its table after the axes.
    pub columns: &'static [Column],
    /// Whether it needs cells that are compared with references.
    pub needs_scores: bool,
    /// Whether the answer depends on measured times.
    pub uses_times: bool,
    /// Whether the weight of views changes its answer for the scene `design`.
    pub is_weighted: bool,
    /// Whether `by` can name the axis of the rows of its digest.
    pub has_rows: bool,
    /// Missing part of a scored experiment, as [`Question::lack`].
    pub lacks: fn(&Shape) -> Option<&'static str>,
    /// `None` without suitable finished cells.
    pub answer: fn(&Frame) -> Option<Finding>,
}

impl Question {
    const PLAIN: Self = Self {
        name: "",
        asks: "",
        columns: &[],
        needs_scores: true,
        uses_times: false,
        is_weighted: true,
        has_rows: true,
        lacks: |_| None,
        answer: |_| None,
    };

    /// Missing part of an experiment of this shape, as the end of "cannot be answered: ...".
    pub fn lack(&self, shape: &Shape) -> Option<&'static str> {
        if self.needs_scores && !shape.is_scored {
            return Some("it needs scores, and the experiment has reference = \"none\"");
        }
        (self.lacks)(shape)
    }

    /// Whether the answer depends on times of a CPU driver, which say nothing about a GPU.
    pub fn rests_on_cpu_times(&self, run: &Finished) -> bool {
        self.uses_times && run.is_cpu_timed()
    }
}

pub struct Answer {
    pub question: &'static Question,
    pub finding: Finding,
}

pub fn question(name: &str) -> Option<&'static Question> {
    QUESTIONS
        .iter()
        .copied()
        .find(|question| question.name == name)
}

/// Answers the questions of the experiment, by default every question that its axes can answer.
/// `metric` replaces the experiment's own.
pub fn answers(run: &Finished, metric: Option<&str>) -> Vec<Answer> {
    let mut plain = Frame::new(run, metric);
    let recorded_weight = weights::recorded_weight(&plain);
    let weights = weights::weights(&plain);
    let mut asked = asked_questions(run);
    asked.retain(|asked| asked.question.lack(&plain.shape).is_none());
    let weighted_findings = weighted_findings(&plain, metric, weights, &asked);
    let mut answers = Vec::new();
    for (asked, findings) in asked.iter().zip(weighted_findings) {
        let question = asked.question;
        let finding = if !question.is_weighted {
            asked.answer(&mut plain)
        } else if weights.is_empty() {
            let finding = asked.answer(&mut plain);
            finding.map(|finding| weights::with_weight(finding, recorded_weight))
        } else {
            weights::united(findings)
        };
        answers.extend(finding.map(|finding| Answer { question, finding }));
    }
    answers
}

/// The findings of each question under each weight, none for questions without views. The weights
/// come one after another, so that memory holds one weighted run.
fn weighted_findings<'w>(
    plain: &Frame,
    metric: Option<&str>,
    weights: &'w [Weight],
    asked: &[AskedQuestion],
) -> Vec<Vec<(&'w Weight, Finding)>> {
    let mut findings: Vec<Vec<_>> = asked.iter().map(|_| Vec::new()).collect();
    for (index, weight) in weights.iter().enumerate() {
        let run = plain.run.weighted(weight);
        let mut frame = Frame {
            is_first: index == 0,
            ..Frame::new(&run, metric)
        };
        for (asked, findings) in asked.iter().zip(&mut findings) {
            if asked.question.is_weighted {
                let finding = asked.answer(&mut frame);
                findings.extend(finding.map(|finding| (weight, finding)));
            }
        }
    }
    findings
}

/// A question to answer.
struct AskedQuestion {
    question: &'static Question,
    /// As [`Frame::digest_axis`].
    digest_axis: Option<AxisId>,
}

impl AskedQuestion {
    fn answer(&self, frame: &mut Frame) -> Option<Finding> {
        frame.digest_axis = self.digest_axis;
        (self.question.answer)(frame)
    }
}

/// The questions of the experiment; every question if it asks none.
fn asked_questions(run: &Finished) -> Vec<AskedQuestion> {
    let asks = run.config.as_ref().map_or(&[][..], |config| &config.asks);
    if asks.is_empty() {
        let questions = QUESTIONS.iter().map(|question| AskedQuestion {
            question,
            digest_axis: None,
        });
        return questions.collect();
    }
    asks.iter()
        .filter_map(|ask| {
            Some(AskedQuestion {
                question: question(&ask.question)?,
                digest_axis: ask.by.as_ref().map(|by| by.0),
            })
        })
        .collect()
}

/// Reports asked names that are not questions, questions that the axes cannot answer, and each `by`
/// that can make no rows. An axis with one value may be `by`, so that `--set` can narrow an
/// experiment.
pub fn check(config: &Config, faults: &mut Faults) {
    let shape = Shape::of_config(config);
    let names: Vec<&str> = QUESTIONS.iter().map(|question| question.name).collect();
    for (weight, location) in &config.weights {
        if let Err(fault) = check_weight(weight, &shape.values[SCENE]) {
            faults.add(location, format!("weights: {fault}"));
        }
    }
    for ask in &config.asks {
        let name = &ask.question;
        let Some(question) = question(name) else {
            let fault = not_listed("question", name, &names, "", Some(LISTED_QUESTIONS));
            faults.add(&ask.location, format!("asks: {fault}"));
            continue;
        };
        if let Some(lack) = question.lack(&shape) {
            let fault = format!("asks: {name:?} cannot be answered: {lack}");
            faults.add(&ask.location, fault);
        }
        if let Some((axis, location)) = &ask.by
            && let Some(fault) = fault_of_by(config, &shape, question, *axis)
        {
            faults.add(location, fault);
        }
    }
}

/// Why an axis cannot be the rows of an answer.
fn fault_of_by(
    config: &Config,
    shape: &Shape,
    question: &Question,
    axis: AxisId,
) -> Option<String> {
    if !question.has_rows {
        let name = question.name;
        return Some(format!(
            "asks.by: the rows of {name} are not values of an axis; leave it out"
        ));
    }
    if is_row_axis(axis) {
        return None;
    }
    let candidates: Vec<&str> = AXES
        .ids()
        .filter(|&axis| shape.is_swept(axis) && is_row_axis(axis))
        .map(|axis| config.named(axis).name())
        .collect();
    let expected = if candidates.is_empty() {
        "leave it out".to_owned()
    } else {
        format!("expected {}", candidates.join(", "))
    };
    let name = config.named(axis).name();
    Some(format!(
        "asks.by: {name} does not distinguish cases; {expected}"
    ))
}

/// Whether an axis can be the rows of an answer: it distinguishes cases, and is not the
/// environment, which makes columns.
fn is_row_axis(axis: AxisId) -> bool {
    let parts = [Part::Case, Part::Parameter, Part::Table, Part::Method];
    parts.contains(&AXES[axis].part) && ![METHOD, ENVIRONMENT].contains(&axis)
}
