//! The work that is left of a plan, item by item, and how much each is.

use super::speeds::{Amount, Line};
use crate::experiment::axis::{AXES, DFG, IRRADIANCE, MIPS, PREFILTER, Point, SH9};
use crate::experiment::config::{Timing, Warmup};
use crate::experiment::plan::{Cell, Plan};
use crate::experiment::value::Value;
use crate::run::images;
use crate::run::timing::{FRAME, TimingJob, WARMUP_TIME_MAX};
use std::collections::{BTreeMap, BTreeSet};

/// The part of a run that an item belongs to.
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

    /// Opening the device.
    pub fn start() -> Self {
        Self::new(Part::Ends, "start", Amount::default())
    }

    /// The image of a point, with its repeats.
    pub fn image(plan: &Plan, point: &Point) -> Self {
        let times = f64::from(1 + plan.repeats_of(point).unwrap_or(0));
        Self { times, ..Self::new(Part::Images, kind_of("image", point), amount(plan, point)) }
    }

    /// The steps of the error of a point.
    pub fn ladder(plan: &Plan, point: &Point) -> Option<Self> {
        Some(Self::new(Part::Images, "ladder", ladder_amount(plan, point)?))
    }

    /// The reference of a cell: at most, where a relative error may end it earlier.
    pub fn reference(plan: &Plan, cell: &Cell) -> Self {
        let point = plan.reference_point(&cell.point);
        Self::new(Part::References, kind_of("reference", &point), amount(plan, &point))
    }

    /// Every table that the image of a point reads, after what tells it from others.
    pub fn tables(plan: &Plan, point: &Point) -> Vec<(String, Self)> {
        let item = |kind, samples| Self::new(Part::Tables, kind, Amount { pixels: 0.0, samples });
        all_tables(plan, point).into_iter().map(|(key, kind, samples)| (key, item(kind, samples))).collect()
    }

    /// The work of a cell beside its images; `is_first` of those that share one.
    pub fn cell(plan: &Plan, cell: &Cell, is_first: bool) -> [Self; 3] {
        let pixels = Amount { pixels: amount(plan, &cell.point).pixels, samples: 0.0 };
        [
            Self::new(Part::Displays, "display", pixels),
            Self::new(Part::Scores, if is_first { "score first" } else { "score again" }, pixels),
            Self::new(Part::Ends, "end", pixels),
        ]
    }

    /// The timing of a configuration in a block with `members` of them.
    pub fn timing(plan: &Plan, timing: Timing, job: &TimingJob, members: usize) -> Vec<Self> {
        let point = &job.cell.point;
        let work = match job.phase {
            FRAME => {
                let kind = kind_of("frame", point);
                vec![Self::new(Part::Timing, kind, amount(plan, point))]
            }
            _ => all_tables(plan, point)
                .into_iter()
                .map(|(_, kind, samples)| Self::new(Part::Timing, kind, Amount { pixels: 0.0, samples }))
                .collect(),
        };
        let (warmup, seconds_max) = match timing.warmup {
            Warmup::Frames(frames) => (frames, f64::INFINITY),
            Warmup::Stable => (STABLE_WARMUP_FRAMES, WARMUP_TIME_MAX.as_secs_f64()),
        };
        // A frame that does not count follows each change of configuration.
        let counted = timing.rounds * if members > 1 { 2 } else { 1 };
        let both = |item: Self| {
            let counted = Self { times: counted.into(), ..item.clone() };
            [Self { times: warmup.into(), seconds_max, ..item }, counted]
        };
        work.into_iter().flat_map(both).collect()
    }

    /// Seconds at the price of one.
    pub fn seconds(&self, line: &Line) -> f64 {
        let one = line.at(self.amount);
        (one * self.times).min(self.seconds_max.max(one))
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

/// What is drawn for the steps of a point's error.
pub fn ladder_amount(plan: &Plan, point: &Point) -> Option<Amount> {
    let (samples, pixels) = (plan.ladder_of(point)?, amount(plan, point).pixels);
    Some(Amount { pixels, samples: pixels * f64::from(samples) })
}

/// Frames that a warm-up until the times settle is taken to need: twice the window that is compared.
const STABLE_WARMUP_FRAMES: u32 = 64;

/// Kind of the work on the image, the reference or the timed frame of a point.
pub fn kind_of(what: &str, point: &Point) -> String {
    let settings = point.settings();
    format!(
        "{what} {} {} {}",
        settings.shading.method.name,
        settings.shading.diffuse.name,
        settings.shading.brdf.name()
    )
}

/// Every table that an image reads: what tells it from others, its kind, the samples it takes. Where it takes none, texels.
pub fn all_tables(plan: &Plan, point: &Point) -> Vec<(String, String, f64)> {
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
        // What is left unset stands at its default: a reference shares the mips of the images.
        let key = axes.fold(table.to_owned(), |key, (axis, value)| match value {
            Value::Unset => format!("{key} {}={}", axis.name, (axis.default)()),
            value => format!("{key} {}={value}", axis.name),
        });
        (
            key,
            format!("table {table} {}", settings.shading.brdf.name()),
            settings.shading.precompute.samples_of(table).unwrap_or(texels),
        )
    };
    reads.into_iter().filter(|(_, is_read)| *is_read).map(table).collect()
}

/// The work of these cells and timings. References in `kept` stand in a cache and are no work.
pub fn items(plan: &Plan, cells: &[&Cell], jobs: &[TimingJob], kept: &BTreeSet<&str>) -> Vec<Item> {
    let mut items = Vec::new();
    let mut seen: BTreeSet<String> = BTreeSet::new();
    for cell in cells {
        let reference = plan.reference_point(&cell.point);
        if seen.insert(cell.reference.clone()) && !kept.contains(cell.reference.as_str()) {
            items.push(Item::reference(plan, cell));
        }
        let is_first = seen.insert(cell.radiance.clone());
        if is_first {
            items.push(Item::image(plan, &cell.point));
            items.extend(Item::ladder(plan, &cell.point));
        }
        for (key, table) in Item::tables(plan, &cell.point).into_iter().chain(Item::tables(plan, &reference)) {
            if seen.insert(key) {
                items.push(table);
            }
        }
        items.extend(Item::cell(plan, cell, is_first));
    }
    if let Some(timing) = plan.config.timing {
        let mut members: BTreeMap<&str, usize> = BTreeMap::new();
        for job in jobs {
            *members.entry(&job.block).or_default() += 1;
        }
        items.extend(jobs.iter().flat_map(|job| Item::timing(plan, timing, job, members[job.block.as_str()])));
    }
    if !items.is_empty() {
        items.push(Item::start());
    }
    items
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
