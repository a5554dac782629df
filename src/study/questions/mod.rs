//! Questions that a run can answer, one file each. The file's stem, with hyphens, is the key in
//! `asks`, the name of CSV and SVG, and the anchor of the page.

mod by_lookups;
mod chart;
mod numbers;
mod prelude;
mod weights;
pub mod words;

use super::finished::{Finished, check_weight};
use super::frame::{Frame, Shape};
use super::table::{Column, Table, column};
use crate::base::names::not_listed;
use crate::draw::figure::Figure;
use crate::experiment::axis::{AXES, AxisId, ENVIRONMENT, METHOD, Part, SCENE};
use crate::experiment::config::{Ask, Config};
use crate::experiment::fault::Faults;

/// Where a user finds every question.
const LISTED_QUESTIONS: &str = "a name of `splitsum list questions`";

const ERROR: Column = column(
    "error",
    "Error in the metric of the question, geometric mean over point sets.",
);
const NOISE_FLOOR: Column = column(
    "noise_floor",
    "Error that an exact image would have, from the reference's own noise.",
);
const IS_RESOLVED: Column = column(
    "is_resolved",
    "1 if the error is ten standard errors above that noise, else 0.",
);
const SAMPLED: Column = column("sampled", "The sampling method.");
const FIXED: Column = column("fixed", "The method without samples.");
pub const SEEN_FROM: Column = column("n_dot_v_from", "Lower end of n·v.");
pub const SEEN_TO: Column = column("n_dot_v_to", "Upper end of n·v.");
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
    pictures,
    times,
}

pub struct Question {
    /// The file's stem with hyphens.
    pub name: &'static str,
    pub asks: &'static str,
    /// Columns of its table after the axes.
    pub columns: &'static [Column],
    /// Whether the answer depends on measured times.
    pub uses_times: bool,
    /// Whether the weight of views changes its answer for the scene `design`.
    pub is_weighted: bool,
    /// Whether `by` can name the axis of the rows of its digest.
    pub has_rows: bool,
    /// Missing part of an experiment, as the end of "cannot be answered: ...".
    pub lacks: fn(&Shape) -> Option<&'static str>,
    /// `None` without suitable finished cells.
    pub answer: fn(&Frame) -> Option<Finding>,
}

impl Question {
    const PLAIN: Self = Self {
        name: "",
        asks: "",
        columns: &[],
        uses_times: false,
        is_weighted: true,
        has_rows: true,
        lacks: |_| None,
        answer: |_| None,
    };

    /// Whether the answer depends on times of a CPU driver, which say nothing about a GPU.
    pub fn rests_on_cpu_times(&self, run: &Finished) -> bool {
        self.uses_times && run.is_cpu_timed()
    }
}

#[derive(Clone, Debug)]
pub struct Finding {
    /// One to three sentences of at most 25 words. Each of their numbers is in the table or the
    /// digest.
    pub sentence: String,
    pub table: Table,
    /// A few rows for people; by default the table.
    pub digest: Option<Table>,
    pub figure: Option<Figure>,
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
    let asked = run.config.as_ref().map_or(&[][..], |config| &config.asks);
    let plain = Frame::new(run, metric);
    let (own_weight, runs) = (weights::own(&plain), weights::runs(&plain));
    // The run as it is, then under each weight.
    let mut frames = vec![plain];
    frames.extend(runs.iter().enumerate().map(|(place, run)| Frame {
        leads: place == 0,
        ..Frame::new(run, metric)
    }));
    let questions: Vec<(&'static Question, Option<AxisId>)> = match asked {
        [] => QUESTIONS.iter().map(|question| (*question, None)).collect(),
        asked => asked
            .iter()
            .filter_map(|ask| Some((question(&ask.question)?, ask.by.as_ref().map(|by| by.0))))
            .collect(),
    };
    let mut answers = Vec::new();
    for (question, by) in questions {
        frames.iter_mut().for_each(|frame| frame.by = by);
        if (question.lacks)(&frames[0].shape).is_some() {
            continue;
        }
        let finding = match &frames[1..] {
            _ if !question.is_weighted => (question.answer)(&frames[0]),
            [] => (question.answer)(&frames[0]).map(|own| weights::marked(own, own_weight)),
            weighted => weights::united(
                weighted
                    .iter()
                    .filter_map(|frame| Some((&frame.run.weight, (question.answer)(frame)?)))
                    .collect(),
            ),
        };
        let Some(finding) = finding else { continue };
        answers.push(Answer { question, finding });
    }
    answers
}

/// Reports asked names that are not questions, questions that the axes cannot answer, and each `by`
/// that can make no rows. An axis with one value may be `by`, so that `--set` can narrow an
/// experiment.
pub fn check(config: &Config, faults: &mut Faults) {
    let shape = Shape::of_config(config);
    let names: Vec<&str> = QUESTIONS.iter().map(|question| question.name).collect();
    for (weight, place) in &config.weights {
        if let Err(fault) = check_weight(weight, &shape.values[SCENE]) {
            faults.add(place, format!("weights: {fault}"));
        }
    }
    for Ask {
        question: name,
        place,
        by,
    } in &config.asks
    {
        let Some(question) = question(name) else {
            faults.add(
                place,
                format!(
                    "asks: {}",
                    not_listed("question", name, &names, "", Some(LISTED_QUESTIONS))
                ),
            );
            continue;
        };
        if let Some(lack) = (question.lacks)(&shape) {
            faults.add(place, format!("asks: {name:?} cannot be answered: {lack}"));
        }
        let Some((axis, place)) = by else { continue };
        if !question.has_rows {
            faults.add(
                place,
                format!("asks.by: the rows of {name} are not values of an axis; leave it out"),
            );
        } else if !is_row_axis(*axis) {
            let name = config.named(*axis).name();
            let fit = AXES
                .ids()
                .filter(|&axis| shape.is_swept(axis) && is_row_axis(axis));
            let known: Vec<&str> = fit.map(|axis| config.named(axis).name()).collect();
            let expected = if known.is_empty() {
                "leave it out".to_owned()
            } else {
                format!("expected {}", known.join(", "))
            };
            faults.add(
                place,
                format!("asks.by: {name} does not distinguish cases; {expected}"),
            );
        }
    }
}

/// Whether an axis can be the rows of an answer: it distinguishes cases, and is not the
/// environment, which makes columns.
fn is_row_axis(axis: AxisId) -> bool {
    let parts = [Part::Case, Part::Parameter, Part::Table, Part::Method];
    parts.contains(&AXES[axis].part) && ![METHOD, ENVIRONMENT].contains(&axis)
}
