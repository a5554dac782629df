//! The runs of a page in words: labels, provenance, warnings, differences.
//!
//! Nothing is averaged over runs: two runs of one experiment are the same cases twice.

use crate::base::files;
use crate::draw::markdown::percent_escaped;
use crate::instrument::metrics::Metric;
use crate::report::sheets::sheet_files;
use crate::run::provenance::Session;
use crate::study::finished::{Finished, FinishedCell};
use crate::study::questions::Answer;
use itertools::Itertools;
use serde::Serialize;
use serde_json::Value as Json;
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

#[derive(Clone)]
pub struct PageRun<'a> {
    /// Short and unique in the page.
    pub label: String,
    pub finished: &'a Finished,
    /// The main answer first.
    pub answers: &'a [Answer],
}

impl<'a> PageRun<'a> {
    /// Labels runs by folder, numbered if two are equal.
    pub fn of_runs(runs: &'a [(Finished, Vec<Answer>)]) -> Vec<Self> {
        let names: Vec<String> = runs.iter().map(|(run, _)| folder_name(run)).collect();
        let mut page_runs = Vec::with_capacity(runs.len());
        for (i, (finished, answers)) in runs.iter().enumerate() {
            let is_double = names.iter().filter(|name| **name == names[i]).count() > 1;
            page_runs.push(Self {
                label: if is_double {
                    format!("{} #{}", names[i], i + 1)
                } else {
                    names[i].clone()
                },
                finished,
                answers,
            });
        }
        page_runs
    }

    /// The last session; an empty one before the first.
    fn session(&self) -> Session {
        let last = self.finished.provenance.last_session();
        last.cloned().unwrap_or_default()
    }

    /// The question of the experiment, else its name.
    pub fn question(&self) -> String {
        let provenance = &self.finished.provenance;
        if provenance.question.is_empty() {
            provenance.name.clone()
        } else {
            provenance.question.clone()
        }
    }

    /// The device of the last session with its driver.
    pub fn device(&self) -> String {
        let device = self.session().device;
        format!("{} · {}", device.name, device.driver)
    }

    /// When the last session began: `2026-11-21 18:07 UTC` for `2026-11-21T18:07:34Z`.
    pub fn date(&self) -> String {
        let date = self.session().date_utc;
        let parts = date
            .split_once('T')
            .and_then(|(day, time)| Some((day, time.strip_suffix('Z')?.get(..5)?)));
        match parts {
            Some((day, time)) => format!("{day} {time} UTC"),
            None => date,
        }
    }

    /// The commit of the program, marked if files or shaders were changed; empty if unknown.
    pub fn commit(&self) -> String {
        let session = self.session();
        let changed = if session.has_changes() {
            " (changed)"
        } else {
            ""
        };
        let hash = session
            .commit
            .map_or_else(String::new, |commit| commit.hash);
        format!("{hash}{changed}").trim_start().to_owned()
    }

    /// What is missing from the answers, one sentence each.
    pub fn warnings(&self) -> Vec<String> {
        let run = self.finished;
        let mut warnings = Vec::new();
        let failed_count = run.failed_count();
        if failed_count == 1 {
            warnings.push("1 cell failed and is missing from every figure; see Run.".to_owned());
        } else if failed_count > 1 {
            warnings.push(format!(
                "{failed_count} cells failed and are missing from every figure; see Run."
            ));
        }
        let done = run.cells.len() as u64;
        let planned = run.provenance.cell_count;
        if done < planned {
            warnings.push(format!(
                "{done} of {planned} cells are done: the run was stopped."
            ));
        }
        warnings
    }

    /// Names the CPU drivers whose times the answers contain.
    pub fn cpu_warning(&self) -> Option<String> {
        let devices: BTreeSet<&str> = self
            .finished
            .timings
            .iter()
            .filter(|record| record.device_type == "cpu")
            .map(|record| record.device.as_str())
            .collect();
        if devices.is_empty() {
            return None;
        }
        let devices = devices.into_iter().join(", ");
        Some(format!(
            "The times of {devices} come from a CPU driver: they say nothing about a GPU."
        ))
    }

    /// Title and link (from the folder `link_base`) of the contact sheets.
    pub fn sheets(&self, link_base: &Path) -> Vec<[String; 2]> {
        let sheet = |path: PathBuf| {
            let title = path
                .file_stem()
                .map_or_else(String::new, |stem| stem.to_string_lossy().into_owned());
            [title, link(link_base, &path)]
        };
        sheet_files(&self.finished.dir)
            .into_iter()
            .map(sheet)
            .collect()
    }
}

/// The name of a run's folder, else of its experiment.
fn folder_name(run: &Finished) -> String {
    let path = std::fs::canonicalize(&run.dir).unwrap_or_else(|_| run.dir.clone());
    path.file_name().map_or_else(
        || run.provenance.name.clone(),
        |name| name.to_string_lossy().into_owned(),
    )
}

/// A fact of each run.
#[derive(Serialize)]
pub struct Fact {
    what: &'static str,
    differs: bool,
    values: Vec<String>,
}

impl Fact {
    fn new<'a>(
        what: &'static str,
        runs: &[PageRun<'a>],
        value: fn(&PageRun<'a>) -> String,
    ) -> Self {
        let values: Vec<String> = runs.iter().map(value).collect();
        Self {
            what,
            differs: values.iter().any(|value| *value != values[0]),
            values,
        }
    }
}

/// Device, commit and question of each run, and whether they differ.
pub fn facts(runs: &[PageRun]) -> Vec<Fact> {
    vec![
        Fact::new("device", runs, PageRun::device),
        Fact::new("commit", runs, PageRun::commit),
        Fact::new("question", runs, PageRun::question),
    ]
}

/// The heading of the page: one or two questions, else their number.
pub fn heading(runs: &[PageRun]) -> String {
    let questions: Vec<String> = runs.iter().map(PageRun::question).unique().collect();
    if questions.len() <= 2 {
        questions.join(" · ")
    } else {
        format!("{} runs, {} questions", runs.len(), questions.len())
    }
}

/// The score of a cell; `None` if it failed or lacks the metric.
pub fn score(cell: &FinishedCell, metric: &Metric) -> Option<f64> {
    cell.scores.as_ref()?.get(metric.name)
}

/// `to` as a link from the folder `from`.
pub fn link(from: &Path, to: &Path) -> String {
    percent_escaped(&files::relative(from, to))
}

/// The facts of a run in its provenance by title, with the hashes of its inputs last.
pub fn provenance(page_run: &PageRun) -> Vec<(&'static str, Vec<(String, String)>)> {
    let provenance = &page_run.finished.provenance;
    let session = provenance.last_session();
    let groups = [
        ("Device", session.map(|session| entries(&session.device))),
        ("Host", session.map(|session| entries(&session.host))),
        ("Program", session.map(entries)),
        (
            "Commit",
            session.and_then(|session| session.commit.as_ref().map(entries)),
        ),
        ("Experiment", Some(entries(provenance))),
        ("Inputs", Some(entries(&provenance.inputs))),
    ];
    groups
        .into_iter()
        .map(|(title, entries)| (title, entries.unwrap_or_default()))
        .filter(|(_, entries)| !entries.is_empty())
        .collect()
}

/// The fields of an object that are texts, numbers, flags or lists of texts, by name as in the
/// file.
fn entries(object: &impl Serialize) -> Vec<(String, String)> {
    let object = serde_json::to_value(object).expect("JSON can hold text, numbers and lists");
    let mut entries = Vec::new();
    for (name, value) in object.as_object().into_iter().flatten() {
        let text = match value {
            Json::String(text) => text.clone(),
            Json::Array(list) => {
                let texts: Option<Vec<&str>> = list.iter().map(Json::as_str).collect();
                texts.unwrap_or_default().join(" ")
            }
            Json::Number(_) | Json::Bool(_) => value.to_string(),
            Json::Null | Json::Object(_) => String::new(),
        };
        if !text.is_empty() {
            entries.push((name.clone(), text));
        }
    }
    entries
}
