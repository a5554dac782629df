//! Joined runs: each is answered for itself, as if it stood alone, and the page shows the answers side by side. Nothing is pooled over runs:
//! two runs of one experiment are the same cases twice, not more cases.

use crate::study::answers::cases::Pair;
use crate::study::answers::curves::Curve;
use crate::study::answers::run_folder::RunFolder;
use crate::study::answers::study::{RUN_AXIS, Study};
use crate::study::answers::words::{self, Answer};
use crate::study::answers::{ANSWER_FILE, AnswerRecord, Answers, FOLDER};
use serde::Serialize;
use std::collections::BTreeSet;

/// One of the runs without the others.
pub struct Alone {
    /// Its rows with each distinct image once.
    pub study: Study,
    pub answers: Answers,
    pub answer: Answer,
}

/// Every run for itself; `labels` name them.
pub fn each(runs: &[RunFolder], labels: &[String]) -> Vec<Alone> {
    let alone = |(run, label): (&RunFolder, &String)| {
        let run = std::slice::from_ref(run);
        let study = Study::new(run, std::slice::from_ref(label)).distinct();
        let answers = Answers::new(&study, run);
        let answer = words::answer(&study, &answers);
        Alone { study, answers, answer }
    };
    runs.iter().zip(labels).map(alone).collect()
}

/// The curves and cases of all runs, with keys of the same axes, so that one page can draw them. Each belongs to one run.
#[derive(Debug, Serialize)]
pub struct Analysis {
    pub case_axes: Vec<String>,
    pub curves: Vec<Curve>,
    pub pairs: Vec<RunPair>,
}

/// The cases of one run in which two methods meet; indices of curves are those of [`Analysis::curves`].
#[derive(Debug, Serialize)]
pub struct RunPair {
    pub run: usize,
    #[serde(flatten)]
    pub pair: Pair,
}

/// `study`: all rows of all runs.
pub fn analysis(study: &Study, each: &[Alone], runs: &[RunFolder], labels: &[String]) -> Analysis {
    // A single run has its own axes, so nothing is to be computed anew.
    if let [alone] = each {
        let Answers { case_axes, curves, pairs, .. } = &alone.answers;
        let pairs = pairs.iter().map(|pair| RunPair { run: 0, pair: pair.clone() }).collect();
        return Analysis { case_axes: case_axes.clone(), curves: curves.clone(), pairs };
    }
    let study = &study.distinct();
    let case_axes = study.case_axes().iter().map(|&axis| study.axes[axis].name.clone()).collect();
    let mut all = Analysis { case_axes, curves: Vec::new(), pairs: Vec::new() };
    for (run, label) in labels.iter().enumerate() {
        let answers = Answers::new(&rows_of(study, run, label), runs);
        let first = all.curves.len();
        for mut pair in answers.pairs {
            pair.cases.iter_mut().for_each(|case| case.curve += first);
            all.pairs.push(RunPair { run, pair });
        }
        all.curves.extend(answers.curves);
    }
    all
}

/// The rows of one run on the axes of all.
fn rows_of(study: &Study, run: usize, label: &str) -> Study {
    let is_own = |values: &&Vec<String>| study.axis(RUN_AXIS).is_none_or(|axis| values[axis] == label);
    Study {
        axes: study.axes.clone(),
        rows: study.rows.iter().filter(|row| row.run == run).cloned().collect(),
        excluded: study.excluded.iter().filter(is_own).cloned().collect(),
    }
}

/// A fact of the runs' provenance, one value a run.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Fact {
    pub what: &'static str,
    pub values: Vec<String>,
    pub differs: bool,
}

/// What tells joined runs apart and what does not; facts that differ come first.
pub fn facts(runs: &[RunFolder]) -> Vec<Fact> {
    let session = |name: &str| runs.iter().map(|run| run.text(&format!("{}{name}", run.last_session()))).collect();
    let whole = |pointer: &str| runs.iter().map(|run| run.text(pointer)).collect();
    let of = |say: fn(&RunFolder) -> String| runs.iter().map(say).collect::<Vec<String>>();
    let facts: [(&'static str, Vec<String>); 19] = [
        ("device", session("/device/name")),
        ("device type", session("/device/type")),
        ("driver", session("/device/driver")),
        ("Vulkan", session("/device/api_version")),
        ("device memory", of(memory)),
        ("host", session("/host/cpu")),
        ("date", session("/date_utc")),
        ("program", session("/program_version")),
        ("commit", session("/commit/hash")),
        ("command", of(command)),
        ("question", whole("/question")),
        ("experiment", whole("/experiment_hash")),
        ("overrides", whole("/overrides")),
        ("plan", whole("/plan_hash")),
        ("seed", whole("/seed")),
        ("cells", of(cells)),
        ("timed", of(timed)),
        ("shaders", whole("/shader_hash")),
        ("inputs", of(inputs)),
    ];
    let fact = |(what, values): (&'static str, Vec<String>)| {
        let differs = values.iter().collect::<BTreeSet<_>>().len() > 1;
        Fact { what, values, differs }
    };
    let mut facts: Vec<Fact> = facts.into_iter().map(fact).collect();
    facts.sort_by_key(|fact| !fact.differs);
    facts
}

fn memory(run: &RunFolder) -> String {
    let bytes: f64 = run.text(&format!("{}/device/memory_bytes", run.last_session())).parse().unwrap_or(f64::NAN);
    if bytes.is_nan() { String::new() } else { format!("{:.1} GiB", bytes / f64::from(1u32 << 30)) }
}

fn command(run: &RunFolder) -> String {
    let words = run.provenance.pointer(&format!("{}/command_line", run.last_session()));
    let words = words.and_then(serde_json::Value::as_array).into_iter().flatten().filter_map(serde_json::Value::as_str);
    words.collect::<Vec<_>>().join(" ")
}

/// Digits of a hash that tell two inputs apart to people; the provenance has all.
const HASH_DIGITS: usize = 12;

/// Name and hash of each.
fn inputs(run: &RunFolder) -> String {
    let all = run.provenance["inputs"].as_object().into_iter().flatten();
    let short = |hash: &str| hash.chars().take(HASH_DIGITS).collect::<String>();
    let said = all.map(|(name, hash)| format!("{name} {}", hash.as_str().map_or_else(|| hash.to_string(), short)));
    said.collect::<Vec<_>>().join(", ")
}

fn cells(run: &RunFolder) -> String {
    let planned = run.provenance["cell_count"].as_u64().map_or_else(|| "?".to_owned(), |count| count.to_string());
    let excluded: u64 =
        run.provenance["excluded"].as_array().map_or(0, |all| all.iter().filter_map(|one| one["count"].as_u64()).sum());
    let (done, failed) = (run.errors.rows.len() - run.failed_count(), run.failed_count());
    format!("{done} of {planned} done, {failed} failed, {excluded} excluded")
}

fn timed(run: &RunFolder) -> String {
    match run.timings.len() {
        0 => "nothing".to_owned(),
        1 => "1 configuration".to_owned(),
        count => format!("{count} configurations"),
    }
}

/// Questions that one heading can hold.
const HEADING_QUESTIONS: usize = 2;

/// What joined runs ask, as one heading: their question, or both of two; where there are more, how many.
pub fn heading(runs: &[RunFolder]) -> String {
    let mut questions: Vec<String> = Vec::new();
    for run in runs {
        let question = Some(run.text("/question")).filter(|text| !text.is_empty()).unwrap_or_else(|| run.text("/name"));
        if !questions.contains(&question) {
            questions.push(question);
        }
    }
    match questions.len() {
        0..=HEADING_QUESTIONS => questions.join(" · "),
        count => format!("{} runs, {count} questions", runs.len()),
    }
}

/// A sentence for every run that repeats an earlier one: it is no further evidence.
pub fn repeats(runs: &[RunFolder], labels: &[String]) -> Vec<String> {
    let is_same = |a: &RunFolder, b: &RunFolder| {
        a.text("/plan_hash") == b.text("/plan_hash")
            && a.errors.columns == b.errors.columns
            && a.errors.rows == b.errors.rows
    };
    let times = |run: &RunFolder| run.csv.iter().find(|(name, _)| *name == "timings.csv").map(|(_, text)| text.clone());
    let say = |later: usize| {
        let earlier = (0..later).find(|&earlier| is_same(&runs[earlier], &runs[later]))?;
        let (cells, a, b) = (runs[later].errors.rows.len(), &labels[earlier], &labels[later]);
        let what = if times(&runs[earlier]) == times(&runs[later]) { "scores and times" } else { "scores" };
        Some(format!(
            "{b} is identical to {a}: the same plan and the same {what} in all {cells} cells. It is no further evidence."
        ))
    };
    (0..runs.len()).filter_map(say).collect()
}

/// What to tell where the answers in the folder of a run are not those of this page: another version of this program wrote them.
pub fn outdated(run: &RunFolder, answer: &Answer) -> Option<String> {
    let is_written = run.dir.join(FOLDER).join(ANSWER_FILE).exists();
    let is_same = || AnswerRecord::read(&run.dir).is_ok_and(|record| record.answer == *answer);
    (is_written && !run.is_under_way && !is_same()).then(|| {
        let dir = run.dir.display();
        format!(
            "answers/ and summary.md of {} were written by another version of splitsum and say something else than this page: \
             `splitsum answers {dir}` writes them anew.",
            run.text("/name")
        )
    })
}

/// What a reader must know of a run before believing its numbers.
pub fn warnings(run: &RunFolder) -> Vec<String> {
    let mut warnings: Vec<String> = cpu_warning(run).into_iter().collect();
    let failed = run.failures.len();
    if failed > 0 {
        let (cells, are) = if failed == 1 { ("cell", "is") } else { ("cells", "are") };
        warnings.push(format!("{failed} {cells} failed and {are} missing from every figure; the Run page lists them."));
    }
    let (done, planned) = (run.errors.rows.len() as u64, run.provenance["cell_count"].as_u64().unwrap_or(0));
    if done < planned {
        let state = if run.is_under_way { "is under way" } else { "was stopped" };
        warnings.push(format!("{done} of {planned} cells of {} are done: the run {state}.", run.text("/name")));
    }
    warnings
}

/// Which devices' times are those of a driver that computes on the CPU.
pub(super) fn cpu_warning(run: &RunFolder) -> Option<String> {
    let devices = |is_cpu: bool| -> Vec<String> {
        let own = run.timings.iter().filter(|record| (record.device_type == "cpu") == is_cpu);
        own.map(|record| record.device.clone()).collect::<BTreeSet<_>>().into_iter().collect()
    };
    let (cpu, other) = (devices(true).join(", "), devices(false).join(", "));
    let rest = if other.is_empty() { String::new() } else { format!(" Those of {other} do not.") };
    (!cpu.is_empty()).then(|| {
        format!(
            "The times of {cpu} come from a CPU driver: they say nothing about a GPU.{rest} The errors do not depend on the \
             device's speed."
        )
    })
}
