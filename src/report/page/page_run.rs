//! The runs of a page in words: labels, provenance, warnings, differences.
//!
//! Nothing is averaged over runs: two runs of one experiment are the same cases twice.

use crate::base::files;
use crate::draw::markdown::percent_escaped;
use crate::instrument::metrics::Metric;
use crate::report::sheets::sheet_files;
use crate::study::finished::{Finished, FinishedCell};
use crate::study::questions::Answer;
use serde_json::{Value as Json, json};
use std::collections::BTreeSet;
use std::path::Path;

#[derive(Clone)]
pub struct PageRun<'a> {
    /// Short and unique in the page.
    pub label: String,
    pub finished: &'a Finished,
    /// The leading answer first.
    pub answers: &'a [Answer],
}

impl<'a> PageRun<'a> {
    /// Labels runs by folder, numbered if two are equal.
    pub fn of_runs(runs: &'a [(Finished, Vec<Answer>)]) -> Vec<Self> {
        let name = |run: &Finished| {
            let path = std::fs::canonicalize(&run.dir).unwrap_or_else(|_| run.dir.clone());
            path.file_name().map_or_else(
                || run.text("/name"),
                |name| name.to_string_lossy().into_owned(),
            )
        };
        let names: Vec<String> = runs.iter().map(|(run, _)| name(run)).collect();
        let is_double = |name: &String| names.iter().filter(|other| *other == name).count() > 1;
        let label = |i: usize| {
            if is_double(&names[i]) {
                format!("{} #{}", names[i], i + 1)
            } else {
                names[i].clone()
            }
        };
        let page_run = |(i, (finished, answers)): (usize, &'a (Finished, Vec<Answer>))| Self {
            label: label(i),
            finished,
            answers,
        };
        runs.iter().enumerate().map(page_run).collect()
    }

    /// A text of the last session.
    pub fn session(&self, pointer: &str) -> String {
        self.finished
            .text(&format!("{}{pointer}", self.finished.last_session()))
    }

    /// The question of the experiment, else its name.
    pub fn question(&self) -> String {
        Some(self.finished.text("/question"))
            .filter(|text| !text.is_empty())
            .unwrap_or_else(|| self.finished.text("/name"))
    }

    pub fn device(&self) -> String {
        format!(
            "{} · {}",
            self.session("/device/name"),
            self.session("/device/driver")
        )
    }

    /// `2026-11-21 18:07 UTC` for `2026-11-21T18:07:34Z`.
    pub fn date(&self) -> String {
        let date = self.session("/date_utc");
        let parts = date
            .split_once('T')
            .and_then(|(day, time)| Some((day, time.strip_suffix('Z')?.get(..5)?)));
        parts.map_or_else(|| date.clone(), |(day, time)| format!("{day} {time} UTC"))
    }

    /// The commit of the program, marked if files were changed.
    pub fn commit(&self) -> String {
        let changed = if self.session("/commit/dirty") == "true" {
            " (changed)"
        } else {
            ""
        };
        format!("{}{changed}", self.session("/commit/hash"))
    }

    pub fn warnings(&self) -> Vec<String> {
        let run = self.finished;
        let mut warnings = Vec::new();
        match run.failed_count() {
            0 => {}
            1 => {
                warnings.push("1 cell failed and is missing from every figure; see Run.".to_owned())
            }
            n => warnings.push(format!(
                "{n} cells failed and are missing from every figure; see Run."
            )),
        }
        let (done, planned) = (
            run.cells.len() as u64,
            run.provenance["cell_count"].as_u64().unwrap_or(0),
        );
        if done < planned {
            warnings.push(format!(
                "{done} of {planned} cells are done: the run was stopped."
            ));
        }
        warnings
    }

    pub fn cpu_warning(&self) -> Option<String> {
        let own = self
            .finished
            .timings
            .iter()
            .filter(|record| record.device_type == "cpu");
        let devices: BTreeSet<&str> = own.map(|record| record.device.as_str()).collect();
        let devices: Vec<&str> = devices.into_iter().collect();
        (!devices.is_empty()).then(|| {
            format!(
                "The times of {} come from a CPU driver: they say nothing about a GPU.",
                devices.join(", ")
            )
        })
    }

    /// Title and link (from the folder `here`) of the contact sheets.
    pub fn sheets(&self, here: &Path) -> Vec<[String; 2]> {
        let sheet = |path: &Path| {
            let title = path
                .file_stem()
                .map_or_else(String::new, |stem| stem.to_string_lossy().into_owned());
            [title, link(here, path)]
        };
        sheet_files(&self.finished.dir)
            .iter()
            .map(|path| sheet(path))
            .collect()
    }
}

/// Device, commit and question of each run, and whether they differ.
pub fn facts(runs: &[PageRun]) -> Vec<Json> {
    let facts = ["device", "commit", "question"].map(|what| {
        let of = |page_run: &PageRun| match what {
            "device" => page_run.device(),
            "commit" => page_run.commit(),
            _ => page_run.question(),
        };
        let values: Vec<String> = runs.iter().map(of).collect();
        json!({ "what": what, "differs": values.iter().any(|value| *value != values[0]), "values": values })
    });
    facts.to_vec()
}

/// The heading of the page: one or two questions, else their number.
pub fn heading(runs: &[PageRun]) -> String {
    let mut questions: Vec<String> = runs.iter().map(PageRun::question).collect();
    let mut seen = BTreeSet::new();
    questions.retain(|question| seen.insert(question.clone()));
    match questions.len() {
        0..=2 => questions.join(" · "),
        count => format!("{} runs, {count} questions", runs.len()),
    }
}

pub fn score(cell: &FinishedCell, metric: &Metric) -> Option<f64> {
    cell.scores.as_ref()?.get(metric.name)
}

/// `to` as a link from the folder `from`.
pub fn link(from: &Path, to: &Path) -> String {
    percent_escaped(&files::relative(from, to))
}

/// The facts of a run in its provenance by title, with the hashes of its inputs last.
pub fn provenance(page_run: &PageRun) -> Vec<(&'static str, Vec<(String, String)>)> {
    let all = &page_run.finished.provenance;
    let session = all
        .pointer(&page_run.finished.last_session())
        .unwrap_or(&Json::Null);
    let groups = [
        ("Device", &session["device"]),
        ("Host", &session["host"]),
        ("Program", session),
        ("Commit", &session["commit"]),
        ("Experiment", all),
        ("Inputs", &all["inputs"]),
    ];
    let words = |value: &Json| match value {
        Json::String(text) => Some(text.clone()),
        Json::Array(all) => Some(
            all.iter()
                .map(Json::as_str)
                .collect::<Option<Vec<_>>>()?
                .join(" "),
        ),
        Json::Number(_) | Json::Bool(_) => Some(value.to_string()),
        Json::Null | Json::Object(_) => None,
    };
    let facts = |value: &Json| -> Vec<(String, String)> {
        let facts = value.as_object().into_iter().flatten();
        let facts = facts.filter_map(|(name, value)| Some((name.clone(), words(value)?)));
        facts.filter(|(_, text)| !text.is_empty()).collect()
    };
    groups
        .map(|(title, value)| (title, facts(value)))
        .into_iter()
        .filter(|(_, facts)| !facts.is_empty())
        .collect()
}
