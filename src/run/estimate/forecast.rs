//! Predicts the time that a run still takes.
//!
//! The remaining work is scaled, kind by kind, by measured over stated seconds of the finished part. A correction follows: seconds on the
//! clock over predicted seconds of that part. It has full weight after a tenth of the work.

use super::work::{END, SCORE, Steps, TIMED, Work, timed};
use crate::experiment::plan::{Cell, Plan};
use crate::run::statistics::median;
use crate::run::store::Spent;
use crate::run::timing::{TimingJob, TimingRecord};
use std::collections::{BTreeMap, HashMap};

/// Share of the work after which the correction by the clock has full weight.
const TRUSTED_SHARE: f64 = 0.1;

/// Names of the parts of a run, by the beginning of their kinds.
const PARTS: [(&str, &str); 8] = [
    ("reference", "references"),
    ("image", "images"),
    ("ladder", "steps of the error"),
    ("table", "tables"),
    ("display", "tone curve"),
    (SCORE, "scores and files"),
    (TIMED, "timing"),
    (END, "tables and pages"),
];

/// The machine that does the work.
#[derive(Clone, Copy, Debug)]
pub struct Host {
    /// Threads that compute scores.
    pub threads: usize,
    /// Whether the device computes on the same processors.
    pub is_cpu_device: bool,
}

impl Host {
    pub fn here(device_type: &str) -> Self {
        let threads = std::thread::available_parallelism().map_or(1, usize::from);
        Self { threads, is_cpu_device: device_type == "cpu" }
    }
}

#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Ahead {
    /// Finished share of the work, from 0 to 1.
    pub share: f64,
    /// Predicted seconds until the end.
    pub seconds: f64,
}

#[derive(Clone, Debug)]
pub struct Forecast<'p> {
    plan: &'p Plan,
    /// Work of each open step by the id of its cell or timed configuration.
    steps: HashMap<String, Work>,
    left: Work,
    done: Work,
    /// Measured and stated seconds by kind.
    measured: BTreeMap<String, [f64; 2]>,
    host: Host,
}

impl<'p> Forecast<'p> {
    /// Forecasts these cells, in the order in which they are rendered, and these timings. References in `kept` are cached.
    pub fn new(
        plan: &'p Plan,
        cells: &[&Cell],
        jobs: &[TimingJob],
        kept: impl IntoIterator<Item = String>,
        host: Host,
    ) -> Self {
        let mut of = Steps::new(plan, jobs, kept);
        let cells = cells.iter().map(|cell| (cell.id.clone(), of.cell(cell))).collect::<Vec<_>>();
        let mut steps: HashMap<_, _> =
            cells.into_iter().chain(jobs.iter().map(|job| (job.id.clone(), of.timing(job)))).collect();
        let mut left = Work::default();
        for step in steps.values_mut() {
            left.append(step);
            // Tables and pages are written after the last step.
            step.0.remove(END);
        }
        Self { plan, steps, left, done: Work::default(), measured: BTreeMap::new(), host }
    }

    /// Notes a cell that was tried, and the time that it took.
    pub fn cell(&mut self, cell: &Cell, spent: Option<&Spent>) {
        self.finish(&cell.id, |kind, _| Some(spent?.ms(kind)? / 1e3));
    }

    /// Notes a configuration that was tried, and its times.
    pub fn timing(&mut self, job: &TimingJob, record: Option<&TimingRecord>) {
        let once: f64 = timed(self.plan, job).iter().map(|(_, seconds)| seconds).sum();
        let slowness = record.map(|record| median(&record.wall_ms) / 1e3 / once);
        self.finish(&job.id, |_, stated| Some(slowness? * stated));
    }

    /// Notes a finished step. `taken` returns the measured seconds of a kind whose stated seconds it gets.
    fn finish(&mut self, id: &str, taken: impl Fn(&str, f64) -> Option<f64>) {
        let Some(work) = self.steps.remove(id) else { return };
        self.left.remove(&work);
        self.done.append(&work);
        for (kind, [_, stated]) in &work.0 {
            if let Some(taken) = taken(kind, *stated).filter(|taken| taken.is_finite() && *stated > 0.0) {
                let [sum, of] = self.measured.entry(kind.clone()).or_default();
                (*sum, *of) = (*sum + taken, *of + stated);
            }
        }
    }

    /// Predicts the seconds of work of a kind from its stated seconds; threads share scores.
    fn predicted(&self, kind: &str, stated: f64) -> f64 {
        let threads = if kind.starts_with(SCORE) { self.host.threads as f64 } else { 1.0 };
        stated.max(0.0) * self.slowness(kind) / threads
    }

    /// Measured over stated seconds of a kind, else of the same work untimed, of all kinds with its first word, or of all
    /// work; 1 if nothing is measured.
    fn slowness(&self, kind: &str) -> f64 {
        let untimed = kind.strip_prefix(TIMED).unwrap_or(kind);
        let word = untimed.split(' ').next().unwrap_or_default();
        let likenesses: [&dyn Fn(&str) -> bool; 4] =
            [&|own| own == kind, &|own| own == untimed, &|own| own.starts_with(word), &|_| true];
        let sum = |is_alike: &&dyn Fn(&str) -> bool| {
            let own = self.measured.iter().filter(|(own, _)| is_alike(own)).map(|(_, sum)| *sum);
            own.reduce(|a, b| [a[0] + b[0], a[1] + b[1]])
        };
        likenesses.iter().find_map(sum).map_or(1.0, |[taken, stated]| taken / stated)
    }

    /// Predicts the rest after `elapsed` seconds of work.
    pub fn ahead(&self, elapsed: f64) -> Ahead {
        let [done, left] = [&self.done, &self.left].map(|work| self.seconds(work));
        if done <= 0.0 {
            return Ahead { share: 0.0, seconds: left };
        }
        let share = done / (done + left);
        let trust = (share / TRUSTED_SHARE).min(1.0);
        Ahead { share, seconds: left * (elapsed / done).powf(trust) }
    }

    /// Seconds of this work. A GPU renders while the processors score; a software driver shares them.
    fn seconds(&self, work: &Work) -> f64 {
        let [mut device, mut beside, mut alone] = [0.0; 3];
        for (kind, [_, stated]) in &work.0 {
            let seconds = self.predicted(kind, *stated);
            match kind {
                kind if kind.starts_with(SCORE) => beside += seconds,
                kind if kind == END || kind.starts_with(TIMED) => alone += seconds,
                _ => device += seconds,
            }
        }
        alone + if self.host.is_cpu_device { device + beside } else { device.max(beside) }
    }

    /// Name, count and seconds of each part that is left.
    pub fn parts(&self) -> Vec<(&'static str, f64, f64)> {
        let mut parts: BTreeMap<usize, [f64; 2]> = BTreeMap::new();
        for (kind, [count, stated]) in &self.left.0 {
            let Some(place) = PARTS.iter().position(|(known, _)| kind.starts_with(known)) else { continue };
            let [sum, seconds] = parts.entry(place).or_default();
            (*sum, *seconds) = (*sum + count, *seconds + self.predicted(kind, *stated));
        }
        parts.into_iter().map(|(place, [count, seconds])| (PARTS[place].1, count, seconds)).collect()
    }
}
