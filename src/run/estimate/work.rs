//! The stated work of a plan by kind, in seconds of a software driver (lavapipe, LLVM 15) on two quiet cores. The published runs took 0.65
//! to 1.25 times as long.

use crate::experiment::axis::{AXES, DFG, IRRADIANCE, MIPS, PREFILTER, Point, SH9};
use crate::experiment::plan::{Cell, Plan};
use crate::experiment::value::Value;
use crate::pipeline::frames::CONVERGED_SAMPLES;
use crate::precompute::PrefilterBy;
use crate::run::timing::{FRAME, TimingJob};
use crate::shade::frames::Motion;
use std::collections::{BTreeMap, BTreeSet, HashSet};

/// First word of the kinds of timed frames and tables, before the kind of the same work untimed.
pub const TIMED: &str = "timed ";
/// Work after the last step.
pub const END: &str = "host end";
/// Scores, which are computed in parallel with the device.
pub const SCORE: &str = "host score";

/// Kind, ns per pixel, ns per sample. A kind of one word covers all other kinds that begin with it.
const STATED_NS: [(&str, f64, f64); 15] = [
    ("reference", 1500.0, 20.0),
    ("reference none", 1500.0, 28.0),
    ("image", 120.0, 15.0),
    ("image split-sum", 250.0, 15.0),
    ("image none", 250.0, 15.0),
    ("image reference", 120.0, 42.0),
    ("ladder", 0.0, 400.0),
    ("table mips", 0.0, 10.0),
    ("table sh9", 0.0, 10.0),
    ("table prefilter", 0.0, 2.5),
    ("table dfg", 0.0, 9.0),
    ("table irradiance", 0.0, 11.0),
    ("display", 50.0, 0.0),
    // Scores and pictures of a cell on one thread.
    (SCORE, 500.0, 0.0),
    // A cell in the tables, contact sheets, answers and report.
    (END, 150.0, 0.0),
];

/// Time of a map by harmonics over its part on the device, which alone is timed.
const HARMONIC_HOST: f64 = 90.0;

/// Pixels and samples (of all pixels together) of one item of work.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Amount {
    pixels: f64,
    samples: f64,
}

/// The listed kind of `what` with this method or table, and its seconds.
fn stated(what: &str, of: &str, amount: Amount) -> (&'static str, f64) {
    let special = format!("{what} {of}");
    let known = |kind: &str| STATED_NS.iter().find(|(known, ..)| *known == kind);
    let (kind, pixel, sample) = known(&special).or_else(|| known(what)).expect("a listed kind");
    (kind, 1e-9 * (pixel * amount.pixels + sample * amount.samples))
}

/// Count and stated seconds by kind.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Work(pub BTreeMap<String, [f64; 2]>);

impl Work {
    fn add(&mut self, kind: &str, times: f64, seconds: f64) {
        let [count, sum] = self.0.entry(kind.to_owned()).or_default();
        (*count, *sum) = (*count + times, *sum + seconds);
    }

    fn item(&mut self, what: &str, of: &str, amount: Amount) {
        let (kind, seconds) = stated(what, of, amount);
        self.add(kind, 1.0, seconds);
    }

    pub fn append(&mut self, other: &Self) {
        other.0.iter().for_each(|(kind, [count, seconds])| self.add(kind, *count, *seconds));
    }

    pub fn remove(&mut self, part: &Self) {
        part.0.iter().for_each(|(kind, [count, seconds])| self.add(kind, -count, -seconds));
    }

    pub fn stated_s(&self) -> f64 {
        self.0.values().map(|[_, seconds]| seconds).sum()
    }
}

/// Computes the work of each step. Work that several steps share belongs to the first.
#[derive(Debug)]
pub struct Steps<'p> {
    plan: &'p Plan,
    /// References, images and tables of earlier steps.
    seen: HashSet<String>,
    /// Blocks with more than one configuration.
    compared: BTreeSet<String>,
}

impl<'p> Steps<'p> {
    /// Steps of a plan with these timed configurations. References in `kept` are cached.
    pub fn new(plan: &'p Plan, jobs: &[TimingJob], kept: impl IntoIterator<Item = String>) -> Self {
        let blocks = jobs.chunk_by(|a, b| a.block == b.block).filter(|block| block.len() > 1);
        let compared = blocks.map(|block| block[0].block.clone()).collect();
        Self { plan, seen: kept.into_iter().collect(), compared }
    }

    pub fn cell(&mut self, cell: &Cell) -> Work {
        let (plan, point) = (self.plan, &cell.point);
        let reference = plan.reference_point(point);
        let own = amount(plan, point);
        let pixels = Amount { samples: 0.0, ..own };
        let mut work = Work::default();
        if self.seen.insert(cell.reference.clone()) {
            work.item("reference", method(&reference), amount(plan, &reference));
        }
        let is_first = self.seen.insert(cell.radiance.clone());
        if is_first {
            work.item("image", method(point), own);
            if let Some(samples) = plan.ladder_of(point) {
                work.item("ladder", "", Amount { samples: own.pixels * f64::from(samples), ..own });
            }
        }
        for Table { key, table, mut amount } in tables(plan, point).into_iter().chain(tables(plan, &reference)) {
            let by = point.settings().shading.precompute.prefilter;
            if table == PREFILTER && by == PrefilterBy::Harmonic {
                amount.samples *= HARMONIC_HOST;
            }
            if self.seen.insert(key) {
                work.item("table", table, amount);
            }
        }
        work.item("display", "", pixels);
        work.item(SCORE, "", pixels);
        work.item(END, "", pixels);
        work
    }

    pub fn timing(&self, job: &TimingJob) -> Work {
        let Some(timing) = self.plan.config.timing else { return Work::default() };
        // A frame that does not count follows each change of configuration.
        let counted = f64::from(timing.rounds * if self.compared.contains(&job.block) { 2 } else { 1 });
        let mut work = Work::default();
        for (kind, seconds) in timed(self.plan, job) {
            work.add(&kind, counted, (counted + f64::from(timing.warmup)) * seconds);
        }
        work
    }
}

/// Kind and stated seconds of one execution of a timed configuration.
pub fn timed(plan: &Plan, job: &TimingJob) -> Vec<(String, f64)> {
    let point = &job.cell.point;
    let items = match job.phase {
        FRAME => vec![stated("image", method(point), amount(plan, point))],
        _ => tables(plan, point).iter().map(|own| stated("table", own.table, own.amount)).collect(),
    };
    items.into_iter().map(|(kind, seconds)| (format!("{TIMED}{kind}"), seconds)).collect()
}

/// Pixels of a point's image, and the most samples of its terms.
fn amount(plan: &Plan, point: &Point) -> Amount {
    let settings = point.settings();
    let [width, height] = settings.size.map(f64::from);
    let specular = if settings.shading.method.uses_samples { settings.shading.samples } else { 1 };
    let diffuse = if settings.shading.diffuse.is_integrated() { plan.config.reference.samples } else { 0 };
    let samples = f64::from(specular) + f64::from(diffuse);
    // A moving frame is rendered without noise, too.
    let frames = settings.shading.frames;
    let more = if frames.motion == Motion::Still { 0.0 } else { f64::from(CONVERGED_SAMPLES) };
    let (pixels, more) = (width * height * f64::from(frames.count), if frames.count > 1 { more } else { 0.0 });
    Amount { pixels, samples: pixels * (samples + more) }
}

fn method(point: &Point) -> &'static str {
    point.settings().shading.method.name
}

struct Table {
    /// Differs between tables.
    key: String,
    table: &'static str,
    /// Samples, or texels if it draws none.
    amount: Amount,
}

/// The tables that the image of a point reads.
fn tables(plan: &Plan, point: &Point) -> Vec<Table> {
    let settings = point.settings();
    let (shading, image) = (settings.shading, &plan.inputs.environment(&settings.environment).image);
    let texels = f64::from(image.width) * f64::from(image.height);
    let reads = [
        (PREFILTER, shading.method.uses_prefiltered()),
        (DFG, shading.method.needs_dfg(shading.compensation, shading.diffuse)),
        (IRRADIANCE, shading.diffuse.uses_irradiance_map),
        (MIPS, true),
        (SH9, shading.diffuse.uses_sh9),
    ];
    let table = |(table, _): (&'static str, bool)| {
        let axes = AXES.iter().zip(&point.0).filter(|(axis, _)| axis.feeds.contains(&table));
        // An unset axis has its default: a reference shares the mips of the images.
        let key = axes.fold(table.to_owned(), |key, (axis, value)| match value {
            Value::Unset => format!("{key} {}={}", axis.name, (axis.default)()),
            value => format!("{key} {}={value}", axis.name),
        });
        let samples = shading.precompute.samples_of(table).unwrap_or(texels);
        Table { key, table, amount: Amount { pixels: 0.0, samples } }
    };
    reads.into_iter().filter(|(_, is_read)| *is_read).map(table).collect()
}
