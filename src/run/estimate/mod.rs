//! How long the rest of a run will take and how much disk it needs.
//!
//! Items of work (`items`) are priced with speeds: those of earlier records (`records`) where there are any, else stated constants. A short
//! probe of the device (`probe`) scales these; without it they are a guess, and are called so.

mod constants;
mod items;
mod probe;
mod records;
mod speeds;

pub use constants::{SAMPLES_PER_SECOND, constants, constants_at, device_speeds};
pub use items::{Item, Part, amount, items};
pub use probe::samples_per_second;
pub use records::recorded;
pub use speeds::{Amount, Line, Speeds};

use crate::experiment::plan::{Cell, Plan};
use std::collections::BTreeMap;

/// Where a speed comes from, best first.
#[derive(Clone, Copy, Debug, Eq, Ord, PartialEq, PartialOrd)]
pub enum Source {
    Records,
    /// Stated, and scaled to what a probe of the device measured.
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

/// The cost of the rest of a run.
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

impl Host {
    /// The machine that the [`constants`] stand for.
    pub const STATED: Self = Self { threads: 2, is_cpu_device: true };
}

/// A pixel of a linear image in the report, which has a budget.
const REPORT_BYTES_PER_PIXEL: f64 = 5.0;
/// That budget, bytes.
pub const REPORT_BYTES_MAX: usize = 40_000_000;
/// Parts that only constants tell: they are small.
const STATED: [&str; 2] = ["start", "end"];

/// Whether these speeds lack an item: then a further source is worth its time.
pub fn lack(speeds: &Speeds, items: &[Item]) -> bool {
    items.iter().any(|item| !STATED.contains(&item.kind.as_str()) && speeds.line(&item.kind).is_none())
}

/// The price of a kind of work by the first source that knows it.
pub fn line_of(sources: &[(Source, Speeds)], kind: &str) -> (Source, Line) {
    let of = |(source, speeds): &(Source, Speeds)| Some((*source, *speeds.line(kind)?));
    sources.iter().find_map(of).unwrap_or((Source::Constants, Line::default()))
}

/// The cost of items and of the files of these cells; `sources` are asked in their order, and the last one knows all kinds.
pub fn estimate(plan: &Plan, cells: &[&Cell], items: &[Item], sources: &[(Source, Speeds)], host: Host) -> Estimate {
    let mut found = Estimate::default();
    for item in items {
        let (source, line) = line_of(sources, &item.kind);
        let mut seconds = item.seconds(&line);
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
        let (source, line) = line_of(sources, kind);
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
