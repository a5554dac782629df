//! Questions that a run can answer, one file each. The file's stem, with hyphens, is the key in `asks`, the name of the CSV and the SVG, and
//! the anchor of the page.
//!
//! To add one: its file, one word in the list below, an experiment that asks it.

mod conditions;
pub(super) mod words;

use super::figure::Figure;
use super::finished::Finished;
use super::frame::{Frame, Shape};
use super::table::{Column, Table};

/// Declares the modules of the questions and lists them in this order.
macro_rules! questions {
    ($($stem:ident),+ $(,)?) => {
        $(mod $stem;)+
        /// Every question.
        pub static QUESTIONS: &[&Question] = &[$(&$stem::QUESTION),+];
    };
}

questions! {
    break_even,
    convergence,
    error,
    sample_count,
    table_size,
    n_dot_v,
    visibility,
    dynamic_range,
    energy,
    equal_time,
    frame_time,
    table_cost,
    printed_slips,
}

/// Sentences of a finding.
pub const SENTENCES_MAX: usize = 3;
/// Words of a sentence.
pub const WORDS_MAX: usize = 25;

/// Something that the rows of a run can answer.
pub struct Question {
    /// The file's stem with hyphens.
    pub name: &'static str,
    /// The question in words, with a question mark.
    pub asks: &'static str,
    /// Columns of its table that are no axes.
    pub columns: &'static [Column],
    /// Whether the answer rests on measured times.
    pub uses_times: bool,
    /// What an experiment lacks to serve it, as the end of the sentence "cannot be answered: ..."; `None` where it serves.
    pub lacks: fn(&Shape) -> Option<&'static str>,
    /// The answer; nothing while no finished cell tells.
    pub answer: fn(&Frame) -> Option<Finding>,
}

impl Question {
    /// Whether the answer rests on times of a driver that computes on the CPU: it says nothing about a GPU.
    pub fn rests_on_cpu_times(&self, frame: &Frame) -> bool {
        self.uses_times && frame.run.is_cpu_timed()
    }
}

/// What a question found.
#[derive(Clone, Debug)]
pub struct Finding {
    /// One to three sentences of at most 25 words. Each number of them stands in the table or the digest.
    pub sentence: String,
    /// Every row, for programs.
    pub table: Table,
    /// A few rows for people; the table itself where there is none.
    pub digest: Option<Table>,
    pub figure: Option<Figure>,
}

/// An answered question.
pub struct Answer {
    pub question: &'static Question,
    pub finding: Finding,
}

/// The question of that name.
pub fn question(name: &str) -> Option<&'static Question> {
    QUESTIONS.iter().copied().find(|question| question.name == name)
}

/// The answers of a run to what its experiment asks, the leading one first. Without `asks`, every question that its axes serve.
pub fn answers(run: &Finished, asked: &[String], metric: Option<&str>) -> Vec<Answer> {
    let frame = Frame::new(run, metric);
    let serves = |question: &&&Question| (question.lacks)(&frame.shape).is_none();
    let questions: Vec<&'static Question> = match asked.is_empty() {
        true => QUESTIONS.iter().filter(serves).copied().collect(),
        false => asked.iter().filter_map(|name| question(name)).collect(),
    };
    let answer = |question: &'static Question| Some(Answer { question, finding: (question.answer)(&frame)? });
    questions.into_iter().filter_map(answer).collect()
}
