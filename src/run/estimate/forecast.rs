//! The time that a run still takes, from its first second on.
//!
//! It is the stated work that is left, scaled kind by kind by what earlier runs took and by what this one takes beside them, times a
//! correction: the seconds on the clock over the seconds that the finished part should have taken. The correction counts in full after a tenth
//! of the work.

use super::speeds::{Measured, Speeds, of_cell, of_timing};
use super::work::{END, SCORE, Steps, TIMED, Work};
use crate::experiment::plan::{Cell, Plan};
use crate::run::store::Spent;
use crate::run::timing::{TimingJob, TimingRecord};
use std::collections::BTreeMap;

/// Share of the work after which the clock alone tells how fast it goes.
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

/// Where the work is done.
#[derive(Clone, Copy, Debug)]
pub struct Host {
    /// Threads that score.
    pub threads: usize,
    /// Whether the device computes on the same processors.
    pub is_cpu_device: bool,
}

impl Host {
    /// This machine, with a device of that type.
    pub fn here(device_type: &str) -> Self {
        let threads = std::thread::available_parallelism().map_or(1, usize::from);
        Self { threads, is_cpu_device: device_type == "cpu" }
    }
}

/// What is ahead of a run.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Ahead {
    /// The finished share of the work, from 0 to 1.
    pub share: f64,
    pub seconds: f64,
}

/// The forecast of a run.
#[derive(Clone, Debug)]
pub struct Forecast<'p> {
    plan: &'p Plan,
    steps: Steps<'p>,
    left: Work,
    done: Work,
    /// What earlier runs took.
    earlier: Speeds,
    /// What this run took, beside what is stated and beside earlier runs.
    own: Speeds,
    beside_earlier: Speeds,
    host: Host,
}

impl<'p> Forecast<'p> {
    /// The forecast of these cells and timed configurations at the speeds of earlier runs. References `kept` in a cache are no work.
    pub fn new(
        plan: &'p Plan,
        cells: &[&Cell],
        jobs: &[TimingJob],
        kept: impl IntoIterator<Item = String>,
        earlier: Speeds,
        host: Host,
    ) -> Self {
        let steps = Steps::new(plan, jobs, kept);
        let mut left = Work::default();
        let mut all = steps.clone();
        cells.iter().for_each(|cell| left.append(&all.cell(cell)));
        jobs.iter().for_each(|job| left.append(&all.timing(job)));
        let (own, beside_earlier) = (Speeds::default(), Speeds::default());
        Self { plan, steps, left, done: Work::default(), earlier, own, beside_earlier, host }
    }

    /// Notes a cell that was tried, with the time that its parts took.
    pub fn cell(&mut self, cell: &Cell, spent: Option<&Spent>) {
        let mut work = self.steps.cell(cell);
        // Tables and pages are written after the last step.
        work.0.remove(END);
        self.finish(&work, spent.map(|spent| of_cell(self.plan, cell, spent)));
    }

    /// Notes a configuration that was tried, with its times.
    pub fn timing(&mut self, job: &TimingJob, record: Option<&TimingRecord>) {
        self.finish(&self.steps.timing(job), record.map(|record| of_timing(self.plan, job, record)));
    }

    fn finish(&mut self, work: &Work, measured: Option<Vec<Measured>>) {
        self.left.remove(work);
        self.done.append(work);
        for (kind, taken, stated) in measured.into_iter().flatten() {
            self.own.add(&kind, taken, stated);
            self.beside_earlier.add(&kind, taken, stated * self.earlier.ratio(&kind));
        }
    }

    /// Seconds that work of a kind takes over those stated.
    fn ratio(&self, kind: &str) -> f64 {
        self.earlier.ratio(kind) * self.beside_earlier.ratio(kind)
    }

    /// What is ahead when the run has worked for `elapsed` seconds.
    pub fn ahead(&self, elapsed: f64) -> Ahead {
        let [done, left] = [&self.done, &self.left].map(|work| self.seconds(work));
        let share = if done > 0.0 { done / (done + left) } else { 0.0 };
        let trust = (share / TRUSTED_SHARE).min(1.0);
        let correction = if done > 0.0 { (elapsed / done).powf(trust) } else { 1.0 };
        Ahead { share, seconds: left * correction }
    }

    /// Seconds of this work: a GPU renders while the processors score; a software driver shares them.
    fn seconds(&self, work: &Work) -> f64 {
        let [mut device, mut beside, mut alone] = [0.0; 3];
        for (kind, [_, stated]) in &work.0 {
            let seconds = stated.max(0.0) * self.ratio(kind);
            match kind {
                kind if kind.starts_with(SCORE) => beside += seconds / self.host.threads as f64,
                kind if kind == END || kind.starts_with(TIMED) => alone += seconds,
                _ => device += seconds,
            }
        }
        alone + if self.host.is_cpu_device { device + beside } else { device.max(beside) }
    }

    /// Count and seconds of the work that is left, by part.
    pub fn parts(&self) -> Vec<(&'static str, f64, f64)> {
        let mut parts: BTreeMap<usize, [f64; 2]> = BTreeMap::new();
        for (kind, [count, stated]) in &self.left.0 {
            let Some(place) = PARTS.iter().position(|(known, _)| kind.starts_with(known)) else { continue };
            let threads = if PARTS[place].0 == SCORE { self.host.threads as f64 } else { 1.0 };
            let [sum, seconds] = parts.entry(place).or_default();
            (*sum, *seconds) = (*sum + count, *seconds + stated * self.ratio(kind) / threads);
        }
        parts.into_iter().map(|(place, [count, seconds])| (PARTS[place].1, count, seconds)).collect()
    }

    /// What this run took, for later ones.
    pub fn own_speeds(&self) -> &Speeds {
        &self.own
    }
}
