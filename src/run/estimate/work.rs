//! The stated work of a plan by kind, in seconds of a software driver (lavapipe, LLVM 15) on two quiet cores: the published runs took 0.65 to
//! 1.25 of them.
//!
//! A kind is words from the general to the special, such as `image sampled none ggx`.

use crate::experiment::axis::{AXES, DFG, IRRADIANCE, MIPS, PREFILTER, Point, SH9};
use crate::experiment::config::Warmup;
use crate::experiment::plan::{Cell, Plan};
use crate::experiment::value::Value;
use crate::run::images;
use crate::run::timing::{FRAME, TimingJob, WARMUP_TIME_MAX};
use std::collections::{BTreeMap, BTreeSet, HashSet};

/// Kind, ns a pixel, ns a sample.
const STATED_NS: [(&str, f64, f64); 14] = [
    ("reference", 1500.0, 20.0),
    ("reference none", 1500.0, 28.0),
    ("image", 120.0, 15.0),
    ("image split-sum", 250.0, 15.0),
    ("image none", 250.0, 15.0),
    ("image reference", 120.0, 42.0),
    ("ladder", 0.0, 400.0),
    ("table", 0.0, 10.0),
    ("table prefilter", 0.0, 2.5),
    ("table dfg", 0.0, 9.0),
    ("table irradiance", 0.0, 11.0),
    ("display", 50.0, 0.0),
    // Scores and pictures of a cell on one thread.
    ("host score", 500.0, 0.0),
    // A cell in the tables, contact sheets, answers and report.
    (END, 150.0, 0.0),
];

/// Frames that a warm-up until the times settle is taken to need.
const STABLE_WARMUP_FRAMES: u32 = 64;

/// Bytes a pixel of a linear image (f32 R, G, B and A), of the standard error beside it, of a picture (PNG), of its place in a contact sheet
/// and of its place in the report.
const LINEAR: f64 = 16.0;
const STANDARD_ERROR: f64 = 12.0;
const PICTURE: f64 = 1.3;
const SHEET: f64 = 1.5;
const REPORT: f64 = 5.0;
/// Record and table rows of a cell, bytes.
const RECORD: f64 = 18_000.0;
/// The most that a report takes, bytes.
const REPORT_MAX: f64 = 40e6;

/// How much an item of work is.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Amount {
    pub pixels: f64,
    /// Of all pixels together.
    pub samples: f64,
}

/// A kind and the general ones that hold it: `image sampled`, `image`, and the empty one of all work.
pub fn kinds(kind: &str) -> impl Iterator<Item = &str> {
    let general = std::iter::successors(Some(kind), |kind| kind.rsplit_once(' ').map(|(general, _)| general));
    general.chain(std::iter::once(""))
}

/// As [`kinds`], with the same work untimed after each timed kind.
pub fn alike(kind: &str) -> impl Iterator<Item = &str> {
    kinds(kind).flat_map(|kind| [Some(kind), kind.strip_prefix(TIMED)]).flatten()
}

/// The first word of the kinds of timed frames and tables.
pub const TIMED: &str = "timed ";

/// The kind of what follows the last step.
pub const END: &str = "host end";
/// The general kind of scores, which are made beside the device.
pub const SCORE: &str = "host score";

/// The kind of the scores of a cell, the first of those that share an image or a further one.
pub fn score_kind(is_first: bool) -> &'static str {
    if is_first { "host score first" } else { "host score again" }
}

/// The stated seconds of one item.
pub fn stated_s(kind: &str, amount: Amount) -> f64 {
    let line = alike(kind).find_map(|kind| STATED_NS.iter().find(|(known, ..)| *known == kind));
    line.map_or(0.0, |(_, pixel, sample)| 1e-9 * (pixel * amount.pixels + sample * amount.samples))
}

/// Count and stated seconds of items by kind.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Work(pub BTreeMap<String, [f64; 2]>);

impl Work {
    fn add(&mut self, kind: String, times: f64, seconds: f64) {
        let [count, sum] = self.0.entry(kind).or_default();
        (*count, *sum) = (*count + times, *sum + seconds);
    }

    /// Adds other work.
    pub fn append(&mut self, other: &Self) {
        other.0.iter().for_each(|(kind, [count, seconds])| self.add(kind.clone(), *count, *seconds));
    }

    /// Takes away a part of it.
    pub fn remove(&mut self, part: &Self) {
        part.0.iter().for_each(|(kind, [count, seconds])| self.add(kind.clone(), -count, -seconds));
    }

    /// The stated seconds of all of it.
    pub fn stated_s(&self) -> f64 {
        self.0.values().map(|[_, seconds]| seconds).sum()
    }
}

/// Tells the work of each step. What several share belongs to the first that is asked for.
#[derive(Clone, Debug)]
pub struct Steps<'p> {
    plan: &'p Plan,
    /// References, images and tables that were told.
    seen: HashSet<String>,
    /// Blocks with more than one configuration.
    compared: BTreeSet<String>,
}

impl<'p> Steps<'p> {
    /// Steps of a plan with these timed configurations. References `kept` in a cache are no work.
    pub fn new(plan: &'p Plan, jobs: &[TimingJob], kept: impl IntoIterator<Item = String>) -> Self {
        let blocks = jobs.chunk_by(|a, b| a.block == b.block).filter(|block| block.len() > 1);
        let compared = blocks.map(|block| block[0].block.clone()).collect();
        Self { plan, seen: kept.into_iter().collect(), compared }
    }

    /// The work of a cell.
    pub fn cell(&mut self, cell: &Cell) -> Work {
        let (plan, point) = (self.plan, &cell.point);
        let reference = plan.reference_point(point);
        let mut work = Work::default();
        let mut one = |kind: String, amount| work.add(kind.clone(), 1.0, stated_s(&kind, amount));
        if self.seen.insert(cell.reference.clone()) {
            one(kind_of("reference", &reference), amount(plan, &reference));
        }
        let is_first = self.seen.insert(cell.radiance.clone());
        if is_first {
            (0..=plan.repeats_of(point).unwrap_or(0)).for_each(|_| one(kind_of("image", point), amount(plan, point)));
            ladder_amount(plan, point).into_iter().for_each(|drawn| one("ladder".to_owned(), drawn));
        }
        for Table { key, kind, samples } in tables(plan, point).into_iter().chain(tables(plan, &reference)) {
            if self.seen.insert(key) {
                one(kind, Amount { pixels: 0.0, samples });
            }
        }
        let pixels = Amount { samples: 0.0, ..amount(plan, point) };
        one("display".to_owned(), pixels);
        one(score_kind(is_first).to_owned(), pixels);
        one(END.to_owned(), pixels);
        work
    }

    /// The work of a timed configuration.
    pub fn timing(&self, job: &TimingJob) -> Work {
        let Some(timing) = self.plan.config.timing else { return Work::default() };
        // A frame that does not count follows each change of configuration.
        let counted = f64::from(timing.rounds * if self.compared.contains(&job.block) { 2 } else { 1 });
        let mut work = Work::default();
        for (kind, seconds) in timed(self.plan, job) {
            let warmup = match timing.warmup {
                Warmup::Frames(frames) => f64::from(frames) * seconds,
                Warmup::Stable => (f64::from(STABLE_WARMUP_FRAMES) * seconds).min(WARMUP_TIME_MAX.as_secs_f64()),
            };
            work.add(kind, counted, counted * seconds + warmup);
        }
        work
    }
}

/// Kind and stated seconds of what a timed configuration does once.
pub fn timed(plan: &Plan, job: &TimingJob) -> Vec<(String, f64)> {
    let point = &job.cell.point;
    let of = |kind: String, amount| (format!("{TIMED}{kind}"), stated_s(&kind, amount));
    match job.phase {
        FRAME => vec![of(kind_of("image", point), amount(plan, point))],
        _ => {
            let one = |table: Table| of(table.kind, Amount { pixels: 0.0, samples: table.samples });
            tables(plan, point).into_iter().map(one).collect()
        }
    }
}

/// Pixels of a point's image, and the samples that its terms draw at most.
pub fn amount(plan: &Plan, point: &Point) -> Amount {
    let settings = point.settings();
    let [width, height] = settings.size.map(f64::from);
    let specular = if settings.shading.method.uses_samples { settings.shading.samples } else { 1 };
    let diffuse = if settings.shading.diffuse.is_integrated() { plan.config.reference.samples } else { 0 };
    let pixels = width * height;
    Amount { pixels, samples: pixels * (f64::from(specular) + f64::from(diffuse)) }
}

/// The samples by which the steps of a point's error are drawn.
pub fn ladder_amount(plan: &Plan, point: &Point) -> Option<Amount> {
    let (samples, pixels) = (plan.ladder_of(point)?, amount(plan, point).pixels);
    Some(Amount { pixels, samples: pixels * f64::from(samples) })
}

/// Kind of the image or the reference of a point.
pub fn kind_of(what: &str, point: &Point) -> String {
    let settings = point.settings();
    format!(
        "{what} {} {} {}",
        settings.shading.method.name,
        settings.shading.diffuse.name,
        settings.shading.brdf.name()
    )
}

/// A table that an image reads.
pub struct Table {
    /// Tells it from others.
    pub key: String,
    pub kind: String,
    /// Samples that it takes; texels if it takes none.
    pub samples: f64,
}

/// Every table that the image of a point reads.
pub fn tables(plan: &Plan, point: &Point) -> Vec<Table> {
    let settings = point.settings();
    let image = &plan.inputs.environment(&settings.environment).image;
    let texels = f64::from(image.width) * f64::from(image.height);
    let reads = [
        (PREFILTER, settings.shading.method.uses_prefiltered()),
        (
            DFG,
            settings.shading.method.needs_dfg(
                settings.shading.compensation,
                settings.shading.diffuse,
                !plan.config.lights.is_empty(),
            ),
        ),
        (IRRADIANCE, settings.shading.diffuse.uses_irradiance_map),
        (MIPS, true),
        (SH9, settings.shading.diffuse.sh9.is_some()),
    ];
    let table = |(table, _): (&str, bool)| {
        let axes = AXES.iter().zip(&point.0).filter(|(axis, _)| axis.feeds.contains(&table));
        // An unset axis has its default: a reference shares the mips of the images.
        let key = axes.fold(table.to_owned(), |key, (axis, value)| match value {
            Value::Unset => format!("{key} {}={}", axis.name, (axis.default)()),
            value => format!("{key} {}={value}", axis.name),
        });
        let kind = format!("table {table} {}", settings.shading.brdf.name());
        Table { key, kind, samples: settings.shading.precompute.samples_of(table).unwrap_or(texels) }
    };
    reads.into_iter().filter(|(_, is_read)| *is_read).map(table).collect()
}

/// Bytes of the files that these cells add to a run.
pub fn file_bytes(plan: &Plan, cells: &[&Cell]) -> f64 {
    let mut seen = HashSet::new();
    let (mut bytes, mut report) = (0.0, 0.0);
    for cell in cells {
        let pixels = amount(plan, &cell.point).pixels;
        let [_, reference] = images::linear_files(plan, cell);
        bytes += RECORD + SHEET * pixels;
        for name in images::files(plan, cell) {
            let (is_linear, is_reference) = (name.ends_with(".exr"), name == reference);
            if !seen.insert(name) {
                continue;
            }
            bytes += pixels * if is_linear { LINEAR } else { PICTURE };
            bytes += if is_reference { STANDARD_ERROR * pixels } else { 0.0 };
            report += if is_linear { REPORT * pixels } else { 0.0 };
        }
    }
    bytes + report.min(REPORT_MAX)
}
