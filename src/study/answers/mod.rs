//! The analysis step: what the rows of finished runs answer.
//!
//! Everything here is computed from the files of a run ([`run_folder`]), so that a finished folder can be answered again without device or
//! inputs, and `run`, `answers` and the report say the same. [`study`] joins the rows of one or more runs; the answers are
//!
//! - [`curves`] and [`slope`]: error over sample count, and how fast it falls,
//! - [`cases`] with [`break_even`] and [`times`]: from which sample count sampling wins, at equal error and at equal time,
//! - [`heat`]: error by `n_dot_v` and alpha,
//! - [`exposure`]: where the tone curve shows a difference and where it hides one,
//! - [`dynamic_range`]: error over the environment's peaks,
//! - [`effects`] and [`sizes`]: what each parameter of a method changes, and how large its tables must be,
//! - [`claim`]: whether 30 to 40 samples suffice,
//! - [`furnace`]: the energy that is lost or created,
//! - [`table_times`]: what the tables cost once.
//!
//! [`words`] says the answer in a sentence; [`tables`], [`markdown`] and [`plot`] write them as CSV, Markdown and SVG.

pub mod break_even;
pub mod cases;
pub mod claim;
pub mod curves;
pub mod dynamic_range;
pub mod effects;
pub mod exposure;
pub(super) mod folder;
pub mod furnace;
pub mod heat;
pub mod markdown;
pub mod plot;
pub mod publish;
pub mod run_folder;
pub mod sizes;
pub mod slope;
pub mod study;
pub mod table_times;
pub mod tables;
pub mod times;
pub mod words;

pub use folder::{ANSWER_FILE, AnswerRecord, Answered, AnswersError, FOLDER, SUMMARY_FILE};

use crate::slips::{self, Cost};
use cases::Pair;
use claim::Sufficiency;
use curves::Curve;
use dynamic_range::RangePoint;
use effects::Effect;
use exposure::Visibility;
use furnace::Furnace;
use heat::HeatTable;
use run_folder::RunFolder;
use serde::Serialize;
use sizes::Enough;
use study::{Row, Study};
use table_times::TableTime;
use times::FrameRatio;

/// Everything that is computed from the rows. The report reads the serialised part.
#[derive(Debug, Serialize)]
pub struct Answers {
    /// Names of the case axes, in key order.
    pub case_axes: Vec<String>,
    pub curves: Vec<Curve>,
    pub pairs: Vec<Pair>,
    #[serde(skip)]
    pub frame_ratios: Vec<FrameRatio>,
    #[serde(skip)]
    pub heat: Vec<HeatTable>,
    #[serde(skip)]
    pub visibility: Vec<Visibility>,
    #[serde(skip)]
    pub dynamic_range: Vec<RangePoint>,
    #[serde(skip)]
    pub effects: Vec<Effect>,
    #[serde(skip)]
    pub enough: Vec<Enough>,
    #[serde(skip)]
    pub sufficiency: Vec<Sufficiency>,
    #[serde(skip)]
    pub furnace: Vec<Furnace>,
    #[serde(skip)]
    pub table_times: Vec<TableTime>,
    /// What the slips of the source documents cost, where the runs ask for it.
    #[serde(skip)]
    pub slips: Vec<Cost>,
}

impl Answers {
    /// Answers joined runs, of which each distinct image counts once ([`Study::distinct`]).
    pub fn new(study: &Study, runs: &[RunFolder]) -> Self {
        let (curves, fixed) = curves::curves(study);
        let times = times::PairTimes::new(runs);
        let pairs = cases::pairs(study, &curves, &fixed, &times);
        Self {
            frame_ratios: times.frame_ratios(),
            case_axes: study.case_axes().iter().map(|&axis| study.axes[axis].name.clone()).collect(),
            pairs,
            curves,
            heat: heat::heat(study),
            visibility: exposure::visibility(study),
            dynamic_range: dynamic_range::dynamic_range(study),
            effects: effects::effects(study),
            enough: sizes::enough(study),
            sufficiency: claim::sufficiency(study),
            furnace: furnace::furnace(study, runs),
            table_times: table_times::table_times(study, runs),
            slips: if runs.iter().any(|run| run.slips.is_some()) { slips::costs() } else { Vec::new() },
        }
    }
}

/// A value as people say it: builtins without their prefix, files without folder and extension.
pub use study::short;

/// "alpha 0.1 · sky · ggx" of a case's key; "all" where nothing is swept.
pub fn key_label(axes: &[String], key: &[String]) -> String {
    let words: Vec<String> = axes
        .iter()
        .zip(key)
        .filter(|(_, value)| !value.is_empty())
        .map(|(axis, value)| {
            let word = short(axis, value);
            // A bare number does not say what it is.
            if word.starts_with(|c: char| c.is_ascii_digit() || c == '-') {
                format!("{axis} {word}")
            } else {
                word.into_owned()
            }
        })
        .collect();
    if words.is_empty() { "all".to_owned() } else { words.join(" · ") }
}

/// Rows that agree on some axes, each group with its key; an axis that a row does not use is unset there, and the row stands in every
/// group that it does not contradict.
pub fn grouped<'s>(study: &'s Study, axes: &[usize]) -> Vec<(Vec<String>, Vec<&'s Row>)> {
    let mut keys: Vec<Vec<String>> = Vec::new();
    for row in &study.rows {
        let key = curves::key(row, axes);
        if !keys.contains(&key) {
            keys.push(key);
        }
    }
    let lies_within = |key: &Vec<String>, of: &Vec<String>| {
        key.iter().zip(of).all(|(value, other)| value.is_empty() || value == other)
    };
    let whole = keys.iter().filter(|key| !keys.iter().any(|other| other != *key && lies_within(key, other)));
    whole
        .map(|group| {
            let own = study.rows.iter().filter(|row| lies_within(&curves::key(row, axes), group)).collect();
            (group.clone(), own)
        })
        .collect()
}
