//! Predicts how long a run takes.
//!
//! Each step (a cell, a timed configuration) has stated seconds: of a software driver (lavapipe,
//! LLVM 15) on two quiet cores. The published runs took 0.65 to 1.25 times as long. The clock of a
//! run corrects them.

use super::recovery;
use super::timing::{FRAME, LONG_MS, TimingJob};
use crate::experiment::axis::{AXES, Point, PrecomputedTable};
use crate::experiment::id::Id;
use crate::experiment::plan::{Cell, Plan};
use crate::experiment::value::Value;
use crate::instrument::pipeline::frames::CONVERGED_SAMPLES;
use crate::instrument::precompute::PrefilterBy;
use crate::instrument::shade::frames::Motion;
use crate::instrument::shade::{NONE, REFERENCE};
use std::collections::{BTreeMap, BTreeSet, HashSet};

/// An item of work. Methods are named.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Work {
    /// A reference image.
    Reference {
        method: &'static str,
    },
    /// The image of a cell.
    Image {
        method: &'static str,
    },
    /// The steps of an error.
    Ladder,
    Table(PrecomputedTable),
    /// Tone curve, scores and pictures of a cell.
    Scores,
    /// Tone curve and picture of a cell that is not scored.
    Picture,
    /// A cell in the tables, contact sheets, answers and report, after the last step.
    End,
}

/// Nanoseconds per pixel and per sample.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Price {
    pixel_ns: f64,
    sample_ns: f64,
}

const fn price(pixel_ns: f64, sample_ns: f64) -> Price {
    Price {
        pixel_ns,
        sample_ns,
    }
}

impl Work {
    fn price(self) -> Price {
        match self {
            Self::Reference { method: NONE } => price(1500.0, 28.0),
            Self::Reference { .. } => price(1500.0, 20.0),
            Self::Image {
                method: "split-sum" | NONE,
            } => price(250.0, 15.0),
            Self::Image { method: REFERENCE } => price(120.0, 42.0),
            Self::Image { .. } => price(120.0, 15.0),
            Self::Ladder => price(0.0, 400.0),
            Self::Table(PrecomputedTable::Mips | PrecomputedTable::Sh9) => price(0.0, 10.0),
            Self::Table(PrecomputedTable::Prefilter) => price(0.0, 2.5),
            Self::Table(PrecomputedTable::Dfg) => price(0.0, 9.0),
            Self::Table(PrecomputedTable::Irradiance) => price(0.0, 11.0),
            Self::Scores => price(300.0, 0.0),
            Self::Picture => price(60.0, 0.0),
            Self::End => price(150.0, 0.0),
        }
    }

    /// Stated seconds.
    fn seconds(self, amount: Amount) -> f64 {
        let price = self.price();
        1e-9 * (price.pixel_ns * amount.pixels + price.sample_ns * amount.samples)
    }

    /// A reference image of a point.
    fn reference(point: &Point) -> Self {
        Self::Reference {
            method: point.method().name,
        }
    }

    /// The image of a point.
    fn image(point: &Point) -> Self {
        Self::Image {
            method: point.method().name,
        }
    }
}

/// Time of a map by harmonics over its part on the device, which alone is timed.
const HARMONIC_HOST: f64 = 90.0;
/// Share of the work after which the correction by the clock has full weight.
const TRUSTED_SHARE: f64 = 0.1;

/// Pixels and samples (of all pixels together) of one item of work.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Amount {
    pixels: f64,
    samples: f64,
}

#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Ahead {
    /// Finished share of the work, from 0 to 1.
    pub share: f64,
    pub seconds: f64,
}

#[derive(Clone, Debug)]
pub struct Forecast {
    /// Stated seconds by the id of the cell or timed configuration, sorted, so that their sum has
    /// the same digits in every run.
    steps: BTreeMap<Id, f64>,
    /// Stated seconds, of the work after the last step too.
    left: f64,
    done: f64,
}

impl Forecast {
    /// Forecasts these cells, in the order in which they are rendered, and these timings.
    /// References in `kept` are cached.
    pub fn new(
        plan: &Plan,
        cells: &[&Cell],
        jobs: &[TimingJob],
        kept: impl IntoIterator<Item = Id>,
    ) -> Self {
        let mut stated = Steps::new(plan, jobs, kept);
        let mut left: f64 = cells
            .iter()
            .map(|cell| Work::End.seconds(amount(plan, &cell.point)))
            .sum();
        let mut steps: BTreeMap<_, _> = cells
            .iter()
            .map(|cell| (cell.id, stated.cell(cell)))
            .collect();
        steps.extend(jobs.iter().map(|job| (job.id, stated.timing(job))));
        left += steps.values().sum::<f64>() + recovery::seconds(plan);
        Self {
            steps,
            left,
            done: 0.0,
        }
    }

    /// Notes a cell or timed configuration that was tried.
    pub fn finish(&mut self, id: Id) {
        let seconds = self.steps.remove(&id).unwrap_or(0.0);
        self.done += seconds;
        self.left -= seconds;
    }

    /// Predicts the rest after `elapsed` seconds of work.
    pub fn ahead(&self, elapsed: f64) -> Ahead {
        let &Self { left, done, .. } = self;
        if done <= 0.0 {
            return Ahead {
                share: 0.0,
                seconds: left,
            };
        }
        let share = done / (done + left);
        let trust = (share / TRUSTED_SHARE).min(1.0);
        Ahead {
            share,
            seconds: left * (elapsed / done).powf(trust),
        }
    }
}

/// Computes the stated seconds of each step. Work that several steps share belongs to the first.
#[derive(Debug)]
pub struct Steps<'p> {
    plan: &'p Plan,
    /// References and images of earlier steps.
    rendered: HashSet<Id>,
    /// Keys of the tables of earlier steps.
    tables: HashSet<String>,
    /// Blocks with more than one configuration.
    compared: BTreeSet<String>,
}

impl<'p> Steps<'p> {
    /// Steps of a plan with these timed configurations. References in `kept` are cached.
    pub fn new(plan: &'p Plan, jobs: &[TimingJob], kept: impl IntoIterator<Item = Id>) -> Self {
        let blocks = jobs
            .chunk_by(|a, b| a.block == b.block)
            .filter(|block| block.len() > 1);
        let compared = blocks.map(|block| block[0].block.clone()).collect();
        Self {
            plan,
            rendered: kept.into_iter().collect(),
            tables: HashSet::new(),
            compared,
        }
    }

    pub fn cell(&mut self, cell: &Cell) -> f64 {
        let plan = self.plan;
        let point = &cell.point;
        let judge = plan.judge_of(cell);
        let image = amount(plan, point);
        let mut seconds = match &judge {
            Some(_) => Work::Scores,
            None => Work::Picture,
        }
        .seconds(image);
        if let Some((id, judge)) = cell.reference.zip(judge.as_ref())
            && self.rendered.insert(id)
        {
            let all = amount(plan, judge);
            let samples = all.samples * usual_share(plan, judge);
            seconds += Work::reference(judge).seconds(Amount { samples, ..all });
        }
        if self.rendered.insert(cell.radiance) {
            seconds += Work::image(point).seconds(image);
            let samples = plan.ladder_of(point).map_or(0.0, f64::from);
            seconds += Work::Ladder.seconds(Amount {
                samples: image.pixels * samples,
                ..image
            });
        }
        let by = point.settings().shading.precompute.prefilter;
        let all = tables(plan, point)
            .into_iter()
            .chain(judge.iter().flat_map(|judge| tables(plan, judge)));
        for TableWork {
            key,
            table,
            mut amount,
        } in all
        {
            if table == PrecomputedTable::Prefilter && by == PrefilterBy::Harmonic {
                amount.samples *= HARMONIC_HOST;
            }
            if self.tables.insert(key) {
                seconds += Work::Table(table).seconds(amount);
            }
        }
        seconds
    }

    pub fn timing(&self, job: &TimingJob) -> f64 {
        let plan = self.plan;
        let point = &job.cell.point;
        let Some(timing) = plan.config.timing else {
            return 0.0;
        };
        let once: f64 = if job.phase == FRAME {
            Work::image(point).seconds(amount(plan, point))
        } else {
            tables(plan, point)
                .iter()
                .map(|work| Work::Table(work.table).seconds(work.amount))
                .sum()
        };
        // A short frame that does not count follows each change of configuration.
        let is_repeated = self.compared.contains(&job.block) && once < 1e-3 * LONG_MS;
        let frames_per_round = if is_repeated { 2 } else { 1 };
        f64::from(timing.rounds * frames_per_round + timing.warmup) * once
    }
}

/// Samples of a reference that stops when it is exact enough, in all its rounds: the mean of `quick`.
const USUAL_SAMPLES: f64 = 800.0;

/// The usual samples of a reference over its most.
fn usual_share(plan: &Plan, judge: &Point) -> f64 {
    if plan.reference_counts(judge).len() == 1 {
        return 1.0;
    }
    (USUAL_SAMPLES / f64::from(plan.config.reference.samples)).min(1.0)
}

/// The pixels and samples of the image of a point.
fn amount(plan: &Plan, point: &Point) -> Amount {
    let settings = point.settings();
    let shading = settings.shading;
    let [width, height] = settings.size.map(f64::from);
    let specular = if shading.method.uses_samples {
        shading.samples
    } else {
        1
    };
    let diffuse = if shading.diffuse.is_integrated() {
        plan.config.reference.samples
    } else {
        0
    };
    let samples = f64::from(specular) + f64::from(diffuse);
    let frames = shading.frames;
    // A moving frame is rendered without noise, too.
    let without_noise = if frames.count > 1 && frames.motion != Motion::Still {
        f64::from(CONVERGED_SAMPLES)
    } else {
        0.0
    };
    let pixels = width * height * f64::from(frames.count);
    Amount {
        pixels,
        samples: pixels * (samples + without_noise),
    }
}

struct TableWork {
    /// Differs between tables.
    key: String,
    table: PrecomputedTable,
    /// Samples, or texels if it draws none.
    amount: Amount,
}

/// The tables that the image of a point reads.
fn tables(plan: &Plan, point: &Point) -> Vec<TableWork> {
    let settings = point.settings();
    let shading = settings.shading;
    let image = &plan.inputs.environment(&settings.environment).image;
    let texels = f64::from(image.width) * f64::from(image.height);
    let is_read = |table: &PrecomputedTable| match table {
        PrecomputedTable::Prefilter => shading.method.uses_prefiltered(),
        PrecomputedTable::Dfg => shading
            .method
            .needs_dfg(shading.compensation, shading.diffuse),
        PrecomputedTable::Irradiance => shading.diffuse.uses_irradiance_map,
        PrecomputedTable::Mips => true,
        PrecomputedTable::Sh9 => shading.diffuse.sh9.is_some(),
    };
    [
        PrecomputedTable::Prefilter,
        PrecomputedTable::Dfg,
        PrecomputedTable::Irradiance,
        PrecomputedTable::Mips,
        PrecomputedTable::Sh9,
    ]
    .into_iter()
    .filter(is_read)
    .map(|table| TableWork {
        key: table_key(point, table),
        table,
        amount: Amount {
            pixels: 0.0,
            samples: shading
                .precompute
                .samples_of(table.name())
                .unwrap_or(texels),
        },
    })
    .collect()
}

/// The values that determine a table's texels. An unset axis has its default: a reference shares
/// the mips of the images.
fn table_key(point: &Point, table: PrecomputedTable) -> String {
    let mut key = table.name().to_owned();
    for (axis, value) in AXES.iter().zip(point.values()) {
        if axis.feeds.contains(&table) {
            let value = match value {
                Value::Unset => (axis.default)(),
                value => value.clone(),
            };
            key += &format!(" {}={value}", axis.name);
        }
    }
    key
}
