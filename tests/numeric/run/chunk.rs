//! Runs in chunks, with a renderer made of formulas: the bench on which the tests of each subject work.

mod attempts;
mod cut;
mod damage;
mod devices;
mod plan_file;

use super::fake::Log;
use super::runs::{Silent, fakes, finished, options};
use splitsum::experiment::Plan;
use splitsum::pixels::{GrayImage, RgbImage, exr};
use splitsum::run::chunk::{ChunkError, Merged, PlanFile, Prices, merge, run_chunk};
use splitsum::run::estimate::{Line, Speeds};
use splitsum::run::execute::ShareOutcome;
use std::cell::RefCell;
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::rc::Rc;
use std::sync::atomic::AtomicBool;

const EXPERIMENT: &str = r#"
name = "tiny"
question = "When does sampling win?"
size = [24, 24]
reference = { samples = 64 }
[axes]
alpha = [0.1, 0.5]
environment = ["sky.exr", "builtin:constant"]
brdf = ["ggx", "phong"]
method = ["sampled", "split-sum"]
samples = [1, 4, 16]
exposure = [1, 10]
[timing]
rounds = 6
warmup = 1
"#;
const CELLS: usize = 64;
/// Cells of one reference: four images at two exposures.
const GROUP_CELLS: usize = 8;

/// A folder with the experiment and its environment, and a plan file for it.
struct Bench {
    dir: tempfile::TempDir,
    file: PlanFile,
    plan: Plan,
}

impl Bench {
    /// A plan file with chunks of `seconds` at 25 million samples a second, 30 ms a cell and a second for each start, less that second.
    fn new(seconds: f64) -> Self {
        let dir = tempfile::tempdir().unwrap();
        std::fs::write(dir.path().join("tiny.toml"), EXPERIMENT).unwrap();
        write_environment(dir.path(), 1.0);
        let plan = load(dir.path());
        PlanFile::new(&plan, dir.path(), seconds + 1.0, prices(25e6, 1.0))
            .write(&dir.path().join("plan.json"))
            .unwrap();
        let (file, plan) = PlanFile::load(&dir.path().join("plan.json")).unwrap();
        Self { dir, file, plan }
    }

    fn path(&self, name: &str) -> PathBuf {
        self.dir.path().join(name)
    }

    fn chunk(&self, chunk: usize, log: &Rc<RefCell<Log>>) -> Result<ShareOutcome, ChunkError> {
        let stop = AtomicBool::new(false);
        let options = options(&self.path("store"), &stop);
        run_chunk(&self.file, &self.plan, chunk, &mut fakes(log), &options, &mut Silent)
    }

    /// Does a chunk on a device of that name and counts the renders.
    fn chunk_on(&self, device: &'static str, chunk: usize) -> usize {
        let log = log(device);
        assert!(self.chunk(chunk, &log).unwrap().failures.is_empty());
        log.borrow().renders.len()
    }

    fn merge(&self) -> Result<Merged, ChunkError> {
        self.merge_of(&self.file, "store")
    }

    fn merge_of(&self, file: &PlanFile, store: &str) -> Result<Merged, ChunkError> {
        let stop = AtomicBool::new(false);
        merge(file, &self.plan, &self.path(store), &options(&self.path("merged"), &stop))
    }

    /// The folder that a run on one machine leaves.
    fn whole(&self) -> PathBuf {
        finished(&self.plan, &self.path("whole"))
    }

    /// The folders of the attempts at a chunk, in order.
    fn attempts(&self, chunk: usize) -> Vec<PathBuf> {
        let entries = std::fs::read_dir(self.path("store/chunks").join(format!("{chunk:05}"))).unwrap();
        let mut paths: Vec<PathBuf> = entries.map(|entry| entry.unwrap().path()).collect();
        paths.sort_by_key(|path| std::fs::metadata(path.join("provenance.json")).unwrap().modified().unwrap());
        paths
    }

    /// Names of the files in a folder of the merged run.
    fn names(&self, folder: &Path) -> BTreeSet<String> {
        std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect()
    }
}

fn write_environment(dir: &Path, radiance: f32) {
    let (rgb, alpha) = (RgbImage::filled(32, 16, [radiance; 3]), GrayImage::filled(32, 16, 1.0));
    exr::write_rgba(&dir.join("sky.exr"), &rgb, &alpha, &[]).unwrap();
}

fn load(dir: &Path) -> Plan {
    Plan::load(&dir.join("tiny.toml"), &[]).unwrap_or_else(|error| panic!("{error}"))
}

fn log(device: &'static str) -> Rc<RefCell<Log>> {
    Rc::new(RefCell::new(Log { device: Some(device), ..Log::default() }))
}

/// Seconds of a cell's scores.
const CELL_SECONDS: f64 = 0.03;

/// Prices of samples, cells, timed frames and starts, and of nothing else.
fn prices(samples_per_second: f64, start_seconds: f64) -> Prices {
    let fixed = |fixed: f64| Line { fixed, ..Line::default() };
    let sample = Line { per_sample: 1.0 / samples_per_second, ..Line::default() };
    let lines = [
        ("image", sample),
        ("reference", sample),
        ("table", sample),
        ("frame", Line { fixed: 0.002, ..sample }),
        ("score", fixed(CELL_SECONDS)),
        ("start", fixed(start_seconds)),
    ];
    let lines = Speeds(lines.map(|(kind, line)| (kind.to_owned(), line)).into());
    Prices { basis: String::new(), lines }
}
