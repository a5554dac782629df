//! `answer.json`: the sentences of the answers of a run.

use crate::base::files::{RECORD_BYTES_MAX, read_text};
use crate::base::pixels::PixelsError;
use crate::run::store::ANSWERS_FOLDER;
use crate::study::questions::Answer;
use crate::study::table::Table;
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};

pub const ANSWER_FILE: &str = "answer.json";

/// In place of the main answer of a run without one.
const NO_ANSWER: &str = "No suitable cell is finished yet.";
/// The same without references.
const NO_SCORES: &str = "The run has no scores, by reference = \"none\", so it answers no question; \
                         its images are in images/.";

#[derive(Debug, thiserror::Error)]
pub enum WriteError {
    #[error(transparent)]
    File(#[from] PixelsError),
    #[error("{}: {error}", path.display())]
    Io {
        path: PathBuf,
        error: std::io::Error,
    },
    #[error("{}: {error}; repeat `splitsum answers` to regenerate it", path.display())]
    Json {
        path: PathBuf,
        error: serde_json::Error,
    },
}

#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
pub struct AnswerSentence {
    pub question: String,
    pub asks: String,
    /// In Markdown.
    pub sentence: String,
    /// The same without emphasis, for use within bold text.
    pub plain: String,
}

impl AnswerSentence {
    pub fn new(answer: &Answer) -> Self {
        Self {
            question: answer.question.name.to_owned(),
            asks: answer.question.asks.to_owned(),
            sentence: answer.finding.sentences.markdown(),
            plain: answer.finding.sentences.plain_markdown(),
        }
    }
}

#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
pub struct AnswerRecord {
    pub name: String,
    pub question: String,
    /// The main answer first.
    pub answers: Vec<AnswerSentence>,
    pub cells: usize,
    pub failed: usize,
    pub devices: Vec<String>,
    /// Of the last session.
    pub date_utc: String,
    /// Of the last session; empty if unknown.
    pub commit: String,
    /// Whether the code that ran is not the commit's.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub has_changes: bool,
    pub is_cpu_timed: bool,
    /// Whether the run has no references.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub is_unscored: bool,
    pub files: Vec<String>,
}

impl AnswerRecord {
    pub fn read(dir: &Path) -> Result<Self, WriteError> {
        let path = dir.join(ANSWERS_FOLDER).join(ANSWER_FILE);
        let text = read_text(&path, RECORD_BYTES_MAX).map_err(|error| WriteError::Io {
            path: path.clone(),
            error,
        })?;
        serde_json::from_str(&text).map_err(|error| WriteError::Json { path, error })
    }

    /// The main answer in words.
    pub fn headline(&self) -> &str {
        self.answers
            .first()
            .map_or(self.no_answer(), |answer| answer.sentence.as_str())
    }

    /// What to print in place of the main answer.
    pub fn no_answer(&self) -> &'static str {
        if self.is_unscored {
            NO_SCORES
        } else {
            NO_ANSWER
        }
    }

    /// The main answer without emphasis.
    pub fn plain_headline(&self) -> &str {
        self.answers
            .first()
            .map_or(NO_ANSWER, |answer| answer.plain.as_str())
    }
}

/// Most rows in place of a digest.
const ROWS_SHOWN_MAX: usize = 40;

/// The digest of an answer, else the first rows of its table.
pub fn shortened(answer: &Answer) -> Table {
    let finding = &answer.finding;
    let mut table = finding
        .digest
        .clone()
        .unwrap_or_else(|| finding.table.clone());
    table.rows.truncate(ROWS_SHOWN_MAX);
    table
}
