//! Runs with the synthetic renderer: how tests start them and read their folders.

use super::fake::Log;
pub use super::fake::{Silent, fakes};
use splitsum::base::csv::Table;
use splitsum::experiment::Plan;
use splitsum::report::COMPANIONS;
use splitsum::report::intermediates::{INTERMEDIATES_FILE, IntermediateRecord, PackedIntermediate};
use splitsum::report::write::Written;
use splitsum::run::estimate::Ahead;
use splitsum::run::store::{CELLS_FOLDER, Store, TIMINGS_FOLDER};
use splitsum::run::{MakeRenderer, Outcome, Progress, RunError, RunOptions, run};
use splitsum::study::finished::Finished;
use splitsum::study::questions::answers;
use std::cell::RefCell;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::rc::Rc;
use std::sync::atomic::{AtomicBool, Ordering};

pub fn log() -> Rc<RefCell<Log>> {
    Rc::new(RefCell::new(Log::default()))
}

pub fn plan(text: &str) -> Plan {
    Plan::from_text(Path::new("tiny.toml"), text, &[]).unwrap_or_else(|error| panic!("{error}"))
}

/// Stops the run after a number of steps, and keeps its notes.
pub struct Steps<'a> {
    pub stop: &'a AtomicBool,
    pub left: usize,
    pub notes: Vec<String>,
}

impl Progress for Steps<'_> {
    fn start(&mut self, _: usize, _: usize, _: Ahead) {}

    fn step(&mut self, _: &str, _: Option<&str>, _: Ahead) {
        self.left = self.left.saturating_sub(1);
        if self.left == 0 {
            self.stop.store(true, Ordering::Relaxed);
        }
    }

    fn note(&mut self, text: &str) {
        self.notes.push(text.to_owned());
    }
}

/// Follows a run: the label of each step, empty at the start, and the remaining work.
pub struct Each<F>(pub F);

impl<F: FnMut(&str, Ahead)> Progress for Each<F> {
    fn start(&mut self, _: usize, _: usize, ahead: Ahead) {
        (self.0)("", ahead);
    }

    fn step(&mut self, label: &str, _: Option<&str>, ahead: Ahead) {
        (self.0)(label, ahead);
    }

    fn note(&mut self, _: &str) {}
}

/// Method and sample count of each render.
type Renders = Vec<(String, u32)>;

pub struct Bench {
    pub dir: tempfile::TempDir,
    pub plan: Plan,
}

impl Bench {
    pub fn new(text: &str) -> Self {
        Self {
            dir: tempfile::tempdir().unwrap(),
            plan: plan(text),
        }
    }

    pub fn finished(text: &str) -> Self {
        let bench = Self::new(text);
        finished(&bench.plan, bench.dir.path());
        bench
    }

    /// One invocation that stops after `steps` steps.
    pub fn invoke(&self, log: &Rc<RefCell<Log>>, steps: usize) -> Result<Outcome, RunError> {
        invoke(&self.plan, self.dir.path(), log, steps)
    }

    /// Runs the unfinished cells; returns the notes, and the method and sample count of each
    /// render.
    pub fn again(&self) -> Result<(Vec<String>, Renders), RunError> {
        let (stop, log) = (AtomicBool::new(false), log());
        let mut steps = Steps {
            stop: &stop,
            left: usize::MAX,
            notes: Vec::new(),
        };
        run(
            &self.plan,
            &mut fakes(&log) as &mut MakeRenderer,
            &options(self.dir.path(), &stop),
            &mut steps,
        )?;
        let renders = log.borrow().renders.clone();
        Ok((steps.notes, renders))
    }

    pub fn path(&self, name: &str) -> PathBuf {
        self.dir.path().join(name)
    }

    pub fn read(&self, name: &str) -> Vec<u8> {
        read(self.path(name))
    }

    pub fn table(&self, name: &str) -> Table {
        Table::read(&self.path(name)).unwrap()
    }

    pub fn json(&self, name: &str) -> serde_json::Value {
        serde_json::from_slice(&self.read(name)).unwrap()
    }

    pub fn images(&self) -> BTreeMap<String, Vec<u8>> {
        contents(&self.path("images"))
    }
}

pub fn options<'a>(dir: &Path, stop: &'a AtomicBool) -> RunOptions<'a> {
    let command_line = vec![
        "splitsum".to_owned(),
        "run".to_owned(),
        "tiny.toml".to_owned(),
    ];
    RunOptions {
        command_line,
        companions: COMPANIONS,
        ..RunOptions::new(dir, stop)
    }
}

/// One invocation that stops after `steps` steps.
pub fn invoke(
    plan: &Plan,
    dir: &Path,
    log: &Rc<RefCell<Log>>,
    steps: usize,
) -> Result<Outcome, RunError> {
    let stop = AtomicBool::new(false);
    let mut progress = Steps {
        stop: &stop,
        left: steps,
        notes: Vec::new(),
    };
    answered(run(
        plan,
        &mut fakes(log) as &mut MakeRenderer,
        &options(dir, &stop),
        &mut progress,
    ))
}

/// Writes the answers of a run, as the command line does.
fn answered(outcome: Result<Outcome, RunError>) -> Result<Outcome, RunError> {
    let outcome = outcome?;
    written(&outcome.dir).write().unwrap();
    Ok(outcome)
}

pub fn written(dir: &Path) -> Written {
    let run = Finished::read(dir).unwrap();
    Written::new(&run, &answers(&run, None)).unwrap()
}

pub fn summary(dir: &Path) -> String {
    String::from_utf8(read(dir.join("summary.md"))).unwrap()
}

pub fn finished(plan: &Plan, dir: &Path) -> PathBuf {
    let log = log();
    log.borrow_mut().has_f0 = plan.config.recovery.is_some();
    invoke(plan, dir, &log, usize::MAX).unwrap_or_else(|error| panic!("{error}"));
    dir.to_owned()
}

/// Checks that a folder equals the folder of a fresh run of the plan: the same tables, images and
/// records. Times and the list of invocations differ.
pub fn assert_like_whole(dir: &Path, plan: &Plan) {
    let whole = tempfile::tempdir().unwrap();
    finished(plan, whole.path());
    assert_alike(dir, whole.path(), plan);
}

/// Checks that two folders of a plan have the same tables, images and records.
pub fn assert_alike(dir: &Path, whole: &Path, plan: &Plan) {
    let is_alike = |name: &String| {
        let differs = [
            "provenance.json",
            "summary.md",
            ".lock",
            // Of a run whose plan lost cells, it still has these.
            INTERMEDIATES_FILE,
            "cells/",
            "timings",
            "timing_",
            "answers/",
            "shards/",
        ];
        !differs.iter().any(|start| name.starts_with(start))
    };
    let left = |dir: &Path| {
        contents(dir)
            .into_iter()
            .filter(|(name, _)| is_alike(name))
            .collect::<BTreeMap<_, _>>()
    };
    let (found, due) = (left(dir), left(whole));
    let odd = |a: &BTreeMap<String, Vec<u8>>, b: &BTreeMap<String, Vec<u8>>| -> Vec<String> {
        a.keys()
            .filter(|name| !b.contains_key(*name))
            .cloned()
            .collect()
    };
    assert_eq!(
        [odd(&found, &due), odd(&due, &found)],
        [[""; 0]; 2],
        "files that only one of them has"
    );
    for (name, bytes) in &due {
        assert!(found[name] == *bytes, "{name} differs");
    }
    let [found, due] = [dir, whole].map(|dir| intermediates(dir, plan));
    assert!(found == due, "pictures of what images are made of differ");
    let ids =
        |dir: &Path| [CELLS_FOLDER, TIMINGS_FOLDER].map(|folder| Store::read_only(dir).ids(folder));
    assert_eq!(ids(dir), ids(whole));
    for cell in &plan.cells {
        let record = |dir: &Path| {
            Store::read_only(dir)
                .cell(cell.id)
                .unwrap()
                .expect("a record")
        };
        let [mut found, due] = [record(dir), record(whole)];
        found.device = due.device.clone();
        // A second tone curve gives every cell a further file.
        assert_eq!(found, due);
    }
}

/// What the image of each cell of a plan is made of, as a run of the plan recorded it.
fn intermediates(dir: &Path, plan: &Plan) -> Vec<Vec<PackedIntermediate>> {
    let record: IntermediateRecord =
        serde_json::from_slice(&read(dir.join(INTERMEDIATES_FILE))).unwrap();
    let pictures = |set: &usize| {
        let set = record.sets[*set].iter();
        set.map(|index| record.pictures[*index].clone()).collect()
    };
    let cells = plan.cells.iter();
    cells
        .filter_map(|cell| record.cells.get(&cell.id.to_string()))
        .map(pictures)
        .collect()
}

pub fn read(path: impl AsRef<Path>) -> Vec<u8> {
    std::fs::read(path.as_ref())
        .unwrap_or_else(|error| panic!("{}: {error}", path.as_ref().display()))
}

/// Every file below `dir` with its content and, for files, its modification time.
pub fn snapshot(dir: &Path) -> BTreeMap<String, (Vec<u8>, std::time::SystemTime)> {
    let mut files = BTreeMap::new();
    for entry in std::fs::read_dir(dir).unwrap().map(Result::unwrap) {
        if entry.path().is_dir() {
            let name = entry.file_name().into_string().unwrap();
            files.extend(
                snapshot(&entry.path())
                    .into_iter()
                    .map(|(k, v)| (format!("{name}/{k}"), v)),
            );
        } else {
            let time = entry.metadata().unwrap().modified().unwrap();
            files.insert(
                entry.file_name().into_string().unwrap(),
                (std::fs::read(entry.path()).unwrap(), time),
            );
        }
    }
    files
}

/// Every file below `dir` with its content; empty without the folder.
pub fn contents(dir: &Path) -> BTreeMap<String, Vec<u8>> {
    let files = if dir.exists() {
        snapshot(dir)
    } else {
        BTreeMap::new()
    };
    files
        .into_iter()
        .map(|(name, (bytes, _))| (name, bytes))
        .collect()
}
