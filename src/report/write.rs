//! Writes `answers/` and `summary.md` in the folder of a run.

use super::record::{ANSWER_FILE, AnswerRecord, AnswerSentence, WriteError};
use super::summary;
use crate::base::files::holds;
use crate::base::names::Listed;
use crate::base::pixels::Staged;
use crate::draw::figure::svg::{FILE_WIDTH, svg};
use crate::draw::figure::{Figure, ScaleKind};
use crate::instrument::shade::{Method, words_in};
use crate::run::store::ANSWERS_FOLDER;
use crate::study::finished::Finished;
use crate::study::questions::Answer;
use std::path::PathBuf;

pub const SUMMARY_FILE: &str = "summary.md";

/// Methods in the order of [`SERIES`](crate::draw::figure::ink::SERIES): each has one colour in all
/// figures.
const INKED: [&str; 10] = [
    "split-sum",
    "split-sum-two",
    "sampled",
    "sampled-vndf",
    "split-sum-cap",
    "split-sum-one",
    "split-sum-unity",
    "split-sum-frostbite",
    "split-sum-four",
    "sampled-unfiltered",
];

/// The colour of the method whose title a series begins with, or whose name it is.
fn ink(series: &str) -> Option<usize> {
    let title = |name: &str| Method::listed(name).title;
    let found = INKED
        .iter()
        .filter(|name| series.starts_with(title(name)) || series == **name);
    let method = found.max_by_key(|name| title(name).len())?;
    INKED.iter().position(|name| name == method)
}

/// The SVG of a figure, with methods in words and in their colours.
pub fn drawing(figure: &Figure, width: u32) -> String {
    let mut own = figure.clone();
    own.note = words_in(&own.note);
    for series in &mut own.series {
        series.name = words_in(&series.name);
        series.ink = ink(&series.name);
    }
    for panel in &mut own.panels {
        panel.title = words_in(&panel.title);
        panel
            .marks
            .iter_mut()
            .for_each(|mark| mark.tip = words_in(&mark.tip));
        for scale in [&mut panel.x, &mut panel.y] {
            if let ScaleKind::Steps(names) = &mut scale.kind {
                names.iter_mut().for_each(|name| *name = words_in(name));
            }
        }
    }
    svg(&own, width)
}

/// The answers of a run, ready to be written.
#[derive(Debug)]
pub struct Written {
    dir: PathBuf,
    pub summary: String,
    pub record: AnswerRecord,
    /// Name and content of the files in `answers/`.
    pub files: Vec<(String, String)>,
}

impl Written {
    pub fn new(run: &Finished, answers: &[Answer]) -> Result<Self, WriteError> {
        let mut files: Vec<(String, String)> = Vec::new();
        for Answer { question, finding } in answers {
            files.push((format!("{}.csv", question.name), finding.table.csv()));
            if let Some(digest) = &finding.digest {
                files.push((format!("{}_digest.csv", question.name), digest.csv()));
            }
            if let Some(figure) = &finding.figure {
                files.push((
                    format!("{}.svg", question.name),
                    drawing(figure, FILE_WIDTH),
                ));
            }
        }
        let sentence = |answer: &Answer| AnswerSentence {
            question: answer.question.name.to_owned(),
            asks: answer.question.asks.to_owned(),
            sentence: answer.finding.sentences.markdown(),
        };
        let session = run.last_session();
        let record = AnswerRecord {
            name: run.text("/name"),
            question: run.text("/question"),
            answers: answers.iter().map(sentence).collect(),
            cells: run.cells.len() - run.failed_count(),
            failed: run.failed_count(),
            devices: run.devices(),
            date_utc: run.text(&format!("{session}/date_utc")),
            commit: run.text(&format!("{session}/commit/hash")),
            is_cpu_timed: run.is_cpu_timed(),
            files: files.iter().map(|(name, _)| name.clone()).collect(),
        };
        let json = |error| WriteError::Json {
            path: run.dir.join(ANSWERS_FOLDER).join(ANSWER_FILE),
            error,
        };
        files.push((
            ANSWER_FILE.to_owned(),
            serde_json::to_string_pretty(&record).map_err(json)? + "\n",
        ));
        let summary = summary::markdown(run, answers, &record);
        Ok(Self {
            dir: run.dir.clone(),
            summary,
            record,
            files,
        })
    }

    /// Writes all files, or none if one cannot be written, and removes files of former answers.
    /// Returns whether anything changed.
    pub fn write(&self) -> Result<bool, WriteError> {
        let folder = self.dir.join(ANSWERS_FOLDER);
        let io = |error| WriteError::Io {
            path: folder.clone(),
            error,
        };
        std::fs::create_dir_all(&folder).map_err(io)?;
        let answers = self
            .files
            .iter()
            .map(|(name, text)| (folder.join(name), text));
        // The summary comes last: it refers to the others.
        let due = answers.chain([(self.dir.join(SUMMARY_FILE), &self.summary)]);
        let is_new = |(path, text): &(PathBuf, &String)| !holds(path, text.as_bytes());
        // Errors such as a full disk come before the first file is replaced.
        let staged = due.filter(is_new).map(|(path, text)| {
            if path.is_dir() {
                let error = std::io::ErrorKind::IsADirectory.into();
                return Err(WriteError::Io { path, error });
            }
            Ok(Staged::new(&path, text.as_bytes())?)
        });
        let staged: Vec<Staged> = staged.collect::<Result<_, _>>()?;
        let is_new = !staged.is_empty();
        staged.into_iter().try_for_each(Staged::put)?;
        for entry in std::fs::read_dir(&folder).map_err(io)?.flatten() {
            let name = entry.file_name().to_string_lossy().into_owned();
            let is_ours = [".csv", ".svg"].iter().any(|end| name.ends_with(end));
            if is_ours && self.files.iter().all(|(known, _)| *known != name) {
                std::fs::remove_file(entry.path()).map_err(io)?;
            }
        }
        Ok(is_new)
    }
}
