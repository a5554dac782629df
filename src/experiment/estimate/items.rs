//! The work that is left of a plan, item by item, and how much each is.

use super::speeds::Amount;
use crate::experiment::axis::Point;
use crate::experiment::chunk::cost::{amount, tables, timing_frames, warmup_frames};
use crate::experiment::images;
use crate::experiment::plan::{Cell, Plan};
use crate::experiment::timing::{FRAME, TimingJob};
use std::collections::{BTreeMap, BTreeSet};

/// What an item is part of.
#[derive(Clone, Copy, Debug, Eq, Ord, PartialEq, PartialOrd)]
pub enum Part {
    References,
    Images,
    Tables,
    /// The tone curve, on the device.
    Displays,
    /// Scores and files, beside the device.
    Scores,
    Timing,
    /// Opening the device, and the tables and pages at the end.
    Ends,
}

impl Part {
    /// The word for people and programs.
    pub fn name(self) -> &'static str {
        match self {
            Self::References => "references",
            Self::Images => "images",
            Self::Tables => "tables",
            Self::Displays => "tone curve",
            Self::Scores => "scores and files",
            Self::Timing => "timing",
            Self::Ends => "start and end",
        }
    }
}

/// Work of one kind.
#[derive(Clone, Debug)]
pub struct Item {
    pub part: Part,
    /// The kind that [`super::speeds::Speeds`] knows.
    pub kind: String,
    pub amount: Amount,
    /// How often it is done.
    pub times: f64,
    /// It ends after this many seconds, done or not.
    pub seconds_max: f64,
}

impl Item {
    fn new(part: Part, kind: impl Into<String>, amount: Amount) -> Self {
        Self { part, kind: kind.into(), amount, times: 1.0, seconds_max: f64::INFINITY }
    }
}

/// Kind of an image's work.
pub fn image_kind(point: &Point) -> String {
    let settings = point.settings();
    format!("image {} {} {}", settings.method.name, settings.diffuse.name, settings.brdf.name())
}

/// Kind of a reference's work; `point` is that of the reference.
pub fn reference_kind(point: &Point) -> String {
    let settings = point.settings();
    format!("reference {} {} {}", settings.method.name, settings.diffuse.name, settings.brdf.name())
}

/// Kind of a table's work.
pub fn table_kind(table: &str, brdf: &str) -> String {
    format!("table {table} {brdf}")
}

/// Every table that an image reads: what tells it from others, its kind, the samples it takes. Where it takes none, texels.
pub fn all_tables(plan: &Plan, point: &Point) -> Vec<(String, String, f64)> {
    let settings = point.settings();
    let kind = |name: &str| table_kind(name, settings.brdf.name());
    let mut all: Vec<(String, String, f64)> = tables(plan, point)
        .into_iter()
        .map(|(key, samples)| {
            let name = key.split(' ').next().unwrap_or_default().to_owned();
            (key, kind(&name), samples)
        })
        .collect();
    let image = &plan.inputs.environment(&settings.environment).image;
    let texels = f64::from(image.width) * f64::from(image.height);
    let environment = format!("{} {:?}", settings.environment, settings.environment_clip_log2);
    all.push((format!("mips {environment}"), kind("mips"), texels));
    if settings.diffuse.name == "sh9" {
        all.push((format!("sh9 {environment}"), kind("sh9"), texels));
    }
    all
}

/// What is left when these cells and timings are. References in `kept` need not be made: a cache has them.
pub fn items(plan: &Plan, cells: &[&Cell], jobs: &[TimingJob], kept: &BTreeSet<&str>) -> Vec<Item> {
    let mut items = Vec::new();
    let mut seen: BTreeSet<String> = BTreeSet::new();
    for cell in cells {
        let size = amount(plan, &cell.point);
        let pixels = Amount { pixels: size.pixels, samples: 0.0 };
        let reference = plan.reference_point(&cell.point);
        if seen.insert(cell.reference.clone()) && !kept.contains(cell.reference.as_str()) {
            items.push(Item::new(Part::References, reference_kind(&reference), amount(plan, &reference)));
        }
        let is_first = seen.insert(cell.radiance.clone());
        if is_first {
            let times = f64::from(1 + plan.repeats_of(&cell.point).unwrap_or(0));
            items.push(Item { times, ..Item::new(Part::Images, image_kind(&cell.point), size) });
        }
        for (key, kind, samples) in all_tables(plan, &cell.point).into_iter().chain(all_tables(plan, &reference)) {
            if seen.insert(key) {
                items.push(Item::new(Part::Tables, kind, Amount { pixels: 0.0, samples }));
            }
        }
        items.push(Item::new(Part::Displays, "display", pixels));
        items.push(Item::new(Part::Scores, if is_first { "score first" } else { "score again" }, pixels));
        items.push(Item::new(Part::Ends, "end", pixels));
    }
    timing_items(plan, jobs, &mut items);
    if !items.is_empty() {
        items.push(Item::new(Part::Ends, "start", Amount::default()));
    }
    items
}

fn timing_items(plan: &Plan, jobs: &[TimingJob], items: &mut Vec<Item>) {
    let Some(timing) = plan.config.timing else { return };
    let mut members: BTreeMap<&str, usize> = BTreeMap::new();
    for job in jobs {
        *members.entry(&job.block).or_default() += 1;
    }
    for job in jobs {
        let point = &job.cell.point;
        let work = match job.phase {
            FRAME => {
                let kind = image_kind(point).replacen("image", "frame", 1);
                vec![Item::new(Part::Timing, kind, amount(plan, point))]
            }
            _ => all_tables(plan, point)
                .into_iter()
                .map(|(_, kind, samples)| Item::new(Part::Timing, kind, Amount { pixels: 0.0, samples }))
                .collect(),
        };
        let (warmup, seconds_max) = warmup_frames(timing);
        for item in work {
            items.push(Item { times: warmup, seconds_max, ..item.clone() });
            items.push(Item { times: timing_frames(timing, members[job.block.as_str()]), ..item });
        }
    }
}

/// Files that are left to write: how many pixels of each kind, and records.
pub fn files(plan: &Plan, cells: &[&Cell]) -> Vec<(&'static str, Amount)> {
    let mut seen = BTreeSet::new();
    let mut files = Vec::new();
    for cell in cells {
        let pixels = Amount { pixels: amount(plan, &cell.point).pixels, samples: 0.0 };
        let [_, reference] = images::linear_files(plan, cell);
        files.push(("bytes record", Amount::default()));
        files.push(("bytes sheet", pixels));
        files.push(("bytes rows", Amount::default()));
        for name in images::files(plan, cell) {
            let kind = file_kind(&name, name == reference);
            if seen.insert(name) {
                files.push((kind, pixels));
            }
        }
    }
    files
}

/// Kind of a file of `images/`.
pub fn file_kind(name: &str, is_reference: bool) -> &'static str {
    match (name.ends_with(".exr"), is_reference) {
        (true, true) => "bytes reference",
        (true, false) => "bytes linear",
        (false, _) => "bytes picture",
    }
}
