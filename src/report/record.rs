//! `answer.json`: the sentences of the answers of a run.

use crate::base::files::{RECORD_BYTES_MAX, read_text};
use crate::base::pixels::PixelsError;
use crate::run::store::ANSWERS_FOLDER;
use crate::study::questions::{Answer, Question};
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

/// Most rows of a digest that readers see, and most rows of a table in place of a digest.
const DIGEST_ROWS_MAX: usize = 100;
const TABLE_ROWS_MAX: usize = 40;

/// What readers see of the numbers of an answer: the first rows of its digest, else of its table.
pub struct Shown {
    pub table: Table,
    /// If the digest has more rows.
    pub cut: Option<DigestCut>,
}

/// A digest with more rows than readers see.
#[derive(Clone, Debug, Serialize)]
pub struct DigestCut {
    pub shown_count: usize,
    pub row_count: usize,
    /// In the folder of answers.
    pub file: String,
}

impl Shown {
    pub fn new(answer: &Answer) -> Self {
        let finding = &answer.finding;
        let Some(digest) = &finding.digest else {
            return Self {
                table: finding.table.first(TABLE_ROWS_MAX),
                cut: None,
            };
        };
        let table = digest.first(DIGEST_ROWS_MAX);
        let cut = DigestCut {
            shown_count: table.rows.len(),
            row_count: digest.rows.len(),
            file: digest_file(answer.question),
        };
        Self {
            table,
            cut: (cut.shown_count < cut.row_count).then_some(cut),
        }
    }
}

/// The name of the file of a question's digest.
pub fn digest_file(question: &Question) -> String {
    format!("{}_digest.csv", question.name)
}
