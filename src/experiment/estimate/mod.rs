//! How long the rest of a run will take and how much disk it needs.
//!
//! Items of work (`items`) are priced with speeds: those of earlier records (`records`) where there are any, else those of a short probe on
//! the device (`probe`), else stated constants, which are a guess and are called so.

mod items;
mod probe;
mod records;
mod speeds;

pub use items::{Item, Part, items};
pub use probe::probe;
pub use records::{Recorded, recorded};
pub use speeds::{Amount, Line, Speeds};

use super::chunk::Rates;
use super::plan::{Cell, Plan};
use std::collections::BTreeMap;

/// Where a speed comes from, best first.
#[derive(Clone, Copy, Debug, Eq, Ord, PartialEq, PartialOrd)]
pub enum Source {
    Records,
    Probe,
    /// Stated, not measured: see [`constants`].
    Constants,
}

impl Source {
    /// The word for people and programs.
    pub fn name(self) -> &'static str {
        match self {
            Self::Records => "records",
            Self::Probe => "probe",
            Self::Constants => "constants (a guess)",
        }
    }
}

/// Work of one part.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PartEstimate {
    /// References, images, cells ...: how many.
    pub count: f64,
    pub seconds: f64,
    /// Seconds by source.
    pub sources: BTreeMap<Source, f64>,
}

/// What is left of a run.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Estimate {
    pub parts: BTreeMap<Part, PartEstimate>,
    /// Of a reference or image at most.
    pub samples: f64,
    /// Of the whole; less than the sum of the parts where scores are made while a GPU renders.
    pub seconds: f64,
    pub bytes: f64,
    pub bytes_source: Option<Source>,
}

/// Where the work is done.
#[derive(Clone, Copy, Debug)]
pub struct Host {
    /// Threads that score.
    pub threads: usize,
    /// Whether the device computes on the same processors.
    pub is_cpu_device: bool,
}

/// f32 R, G, B and A.
const LINEAR_BYTES_PER_PIXEL: f64 = 16.0;
/// The same with the three channels of the standard error.
const REFERENCE_BYTES_PER_PIXEL: f64 = 28.0;
/// A PNG of a rendered image or an error map.
const PICTURE_BYTES_PER_PIXEL: f64 = 1.3;
/// All metrics in ten bins.
const RECORD_BYTES: f64 = 12_000.0;
/// A pixel of a cell in a contact sheet.
const SHEET_BYTES_PER_PIXEL: f64 = 1.5;
/// A cell in the tables and answers.
const ROWS_BYTES: f64 = 6000.0;
/// A pixel of a linear image in the report, which has a budget.
const REPORT_BYTES_PER_PIXEL: f64 = 5.0;
/// That budget, bytes.
pub const REPORT_BYTES_MAX: usize = 40_000_000;
/// Tables, contact sheets, answers and report, for each pixel of each cell, seconds.
const END_SECONDS_PER_PIXEL: f64 = 3e-7;
/// Processors of the machine that the constants stand for.
const CONSTANTS_THREADS: f64 = 2.0;

/// Speeds that nobody measured here: a software driver on two cores.
pub fn constants() -> Speeds {
    let rates = Rates::default();
    let per_sample = 1.0 / rates.samples_per_second;
    let fixed = |fixed: f64| Line { fixed, ..Line::default() };
    let bytes = |per_pixel: f64| Line { per_pixel, ..Line::default() };
    Speeds::of(&[
        ("image", Line { per_sample, ..Line::default() }),
        ("reference", Line { per_sample, ..Line::default() }),
        ("table", Line { per_sample, ..Line::default() }),
        ("frame", Line { per_sample, fixed: rates.seconds_per_frame, ..Line::default() }),
        ("display", fixed(0.0)),
        ("score", fixed(rates.seconds_per_cell * CONSTANTS_THREADS)),
        ("start", fixed(rates.seconds_per_chunk)),
        ("end", Line { per_pixel: END_SECONDS_PER_PIXEL, ..Line::default() }),
        ("bytes linear", bytes(LINEAR_BYTES_PER_PIXEL)),
        ("bytes reference", bytes(REFERENCE_BYTES_PER_PIXEL)),
        ("bytes picture", bytes(PICTURE_BYTES_PER_PIXEL)),
        ("bytes record", fixed(RECORD_BYTES)),
        ("bytes sheet", bytes(SHEET_BYTES_PER_PIXEL)),
        ("bytes rows", fixed(ROWS_BYTES)),
    ])
}

/// Parts that only constants tell: they are small.
const STATED: [&str; 2] = ["start", "end"];

/// Whether these speeds lack an item: then a further source is worth its time. Frames may be reckoned as images.
pub fn lack(speeds: &Speeds, items: &[Item]) -> bool {
    items.iter().any(|item| !STATED.contains(&item.kind.as_str()) && line(speeds, &item.kind).is_none())
}

fn line(speeds: &Speeds, kind: &str) -> Option<Line> {
    let as_image = || speeds.line(&kind.strip_prefix("frame ").map(|rest| format!("image {rest}"))?);
    speeds.line(kind).or_else(as_image).copied()
}

/// The cost of items and of the files of these cells; `sources` are asked in their order, and the last one knows all kinds.
pub fn estimate(plan: &Plan, cells: &[&Cell], items: &[Item], sources: &[(Source, Speeds)], host: Host) -> Estimate {
    let find = |kind: &str| {
        let of = |(source, speeds): &(Source, Speeds)| Some((*source, line(speeds, kind)?));
        sources.iter().find_map(of).unwrap_or((Source::Constants, Line::default()))
    };
    let mut found = Estimate::default();
    for item in items {
        let (source, line) = find(&item.kind);
        let mut seconds = (line.at(item.amount) * item.times).min(item.seconds_max.max(line.at(item.amount)));
        if item.part == Part::Scores {
            seconds /= host.threads as f64;
        }
        if [Part::References, Part::Images].contains(&item.part) {
            found.samples += item.amount.samples * item.times;
        }
        let part = found.parts.entry(item.part).or_default();
        part.count += if item.part == Part::Timing { item.times } else { 1.0 };
        part.seconds += seconds;
        *part.sources.entry(source).or_default() += seconds;
    }
    let mut report_bytes = 0.0;
    for (kind, amount) in items::files(plan, cells) {
        let (source, line) = find(kind);
        found.bytes += line.at(amount);
        // Sheets and rows are stated, and small beside the images.
        if !["bytes sheet", "bytes rows"].contains(&kind) {
            found.bytes_source = found.bytes_source.max(Some(source));
        }
        if kind == "bytes linear" || kind == "bytes reference" {
            report_bytes += amount.pixels * REPORT_BYTES_PER_PIXEL;
        }
    }
    found.bytes += report_bytes.min(REPORT_BYTES_MAX as f64);
    let seconds = |part: Part| found.parts.get(&part).map_or(0.0, |part| part.seconds);
    let beside = seconds(Part::Scores);
    let device: f64 = [Part::References, Part::Images, Part::Tables, Part::Displays].map(seconds).iter().sum();
    // Records were made while scores disturbed the device, so that their times hold the disturbance already.
    let is_disturbed = found.parts.get(&Part::Images).is_none_or(|part| part.sources.contains_key(&Source::Records));
    let both = if host.is_cpu_device && !is_disturbed { device + beside } else { device.max(beside) };
    found.seconds = both + seconds(Part::Timing) + seconds(Part::Ends);
    found
}
