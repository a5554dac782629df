//! Predicts how long a run takes.
//!
//! Each step (a cell, a timed configuration) has stated seconds: of a software driver (lavapipe,
//! LLVM 15) on two quiet cores. The published runs took 0.65 to 1.25 times as long. The clock of a
//! run corrects them.

use super::timing::{FRAME, TimingJob};
use crate::experiment::axis::{AXES, DFG, IRRADIANCE, MIPS, PREFILTER, Point, SH9};
use crate::experiment::plan::{Cell, Plan};
use crate::experiment::value::Value;
use crate::instrument::pipeline::frames::CONVERGED_SAMPLES;
use crate::instrument::precompute::PrefilterBy;
use crate::instrument::shade::frames::Motion;
use std::collections::{BTreeSet, HashMap, HashSet};

/// Kind, ns per pixel, ns per sample. A kind of one word covers all other kinds that begin with it.
const STATED_NS: [(&str, f64, f64); 14] = [
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
    // Tone curve, scores and pictures of a cell.
    ("scores", 300.0, 0.0),
    // A cell in the tables, contact sheets, answers and report, after the last step.
    ("end", 150.0, 0.0),
];

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

/// The seconds of `what` with this method or table.
fn stated(what: &str, of: &str, amount: Amount) -> f64 {
    let special = format!("{what} {of}");
    let known = |kind: &str| STATED_NS.iter().find(|(known, ..)| *known == kind);
    let (_, pixel, sample) = known(&special)
        .or_else(|| known(what))
        .expect("a listed kind");
    1e-9 * (pixel * amount.pixels + sample * amount.samples)
}

#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Ahead {
    /// Finished share of the work, from 0 to 1.
    pub share: f64,
    pub seconds: f64,
}

#[derive(Clone, Debug)]
pub struct Forecast {
    /// Stated seconds by the id of the cell or timed configuration.
    steps: HashMap<String, f64>,
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
        kept: impl IntoIterator<Item = String>,
    ) -> Self {
        let mut of = Steps::new(plan, jobs, kept);
        let mut left: f64 = cells
            .iter()
            .map(|cell| stated("end", "", amount(plan, &cell.point)))
            .sum();
        let mut steps: HashMap<_, _> = cells
            .iter()
            .map(|cell| (cell.id.clone(), of.cell(cell)))
            .collect();
        steps.extend(jobs.iter().map(|job| (job.id.clone(), of.timing(job))));
        left += steps.values().sum::<f64>();
        Self {
            steps,
            left,
            done: 0.0,
        }
    }

    /// Notes a cell or timed configuration that was tried.
    pub fn finish(&mut self, id: &str) {
        let seconds = self.steps.remove(id).unwrap_or(0.0);
        (self.done, self.left) = (self.done + seconds, self.left - seconds);
    }

    /// Predicts the rest after `elapsed` seconds of work.
    pub fn ahead(&self, elapsed: f64) -> Ahead {
        let &Self { left, done, .. } = self;
        let share = if done > 0.0 {
            done / (done + left)
        } else {
            0.0
        };
        let trust = (share / TRUSTED_SHARE).min(1.0);
        Ahead {
            share,
            seconds: left
                * if done > 0.0 {
                    (elapsed / done).powf(trust)
                } else {
                    1.0
                },
        }
    }
}

/// Computes the stated seconds of each step. Work that several steps share belongs to the first.
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
        let blocks = jobs
            .chunk_by(|a, b| a.block == b.block)
            .filter(|block| block.len() > 1);
        let compared = blocks.map(|block| block[0].block.clone()).collect();
        Self {
            plan,
            seen: kept.into_iter().collect(),
            compared,
        }
    }

    pub fn cell(&mut self, cell: &Cell) -> f64 {
        let (plan, point) = (self.plan, &cell.point);
        let reference = plan.reference_point(point);
        let own = amount(plan, point);
        let mut seconds = stated("scores", "", own);
        if self.seen.insert(cell.reference.clone()) {
            seconds += stated("reference", method(&reference), amount(plan, &reference));
        }
        if self.seen.insert(cell.radiance.clone()) {
            seconds += stated("image", method(point), own);
            let samples = plan.ladder_of(point).map_or(0.0, f64::from);
            seconds += stated(
                "ladder",
                "",
                Amount {
                    samples: own.pixels * samples,
                    ..own
                },
            );
        }
        for Table {
            key,
            table,
            mut amount,
        } in tables(plan, point)
            .into_iter()
            .chain(tables(plan, &reference))
        {
            let by = point.settings().shading.precompute.prefilter;
            if table == PREFILTER && by == PrefilterBy::Harmonic {
                amount.samples *= HARMONIC_HOST;
            }
            if self.seen.insert(key) {
                seconds += stated("table", table, amount);
            }
        }
        seconds
    }

    pub fn timing(&self, job: &TimingJob) -> f64 {
        let (plan, point) = (self.plan, &job.cell.point);
        let Some(timing) = plan.config.timing else {
            return 0.0;
        };
        // A frame that does not count follows each change of configuration.
        let counted = timing.rounds
            * if self.compared.contains(&job.block) {
                2
            } else {
                1
            };
        let once: f64 = match job.phase {
            FRAME => stated("image", method(point), amount(plan, point)),
            _ => tables(plan, point)
                .iter()
                .map(|own| stated("table", own.table, own.amount))
                .sum(),
        };
        f64::from(counted + timing.warmup) * once
    }
}

/// Pixels of a point's image, and the most samples of its terms.
fn amount(plan: &Plan, point: &Point) -> Amount {
    let settings = point.settings();
    let [width, height] = settings.size.map(f64::from);
    let specular = if settings.shading.method.uses_samples {
        settings.shading.samples
    } else {
        1
    };
    let diffuse = if settings.shading.diffuse.is_integrated() {
        plan.config.reference.samples
    } else {
        0
    };
    let samples = f64::from(specular) + f64::from(diffuse);
    // A moving frame is rendered without noise, too.
    let frames = settings.shading.frames;
    let more = if frames.motion == Motion::Still {
        0.0
    } else {
        f64::from(CONVERGED_SAMPLES)
    };
    let (pixels, more) = (
        width * height * f64::from(frames.count),
        if frames.count > 1 { more } else { 0.0 },
    );
    Amount {
        pixels,
        samples: pixels * (samples + more),
    }
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
    let (shading, image) = (
        settings.shading,
        &plan.inputs.environment(&settings.environment).image,
    );
    let texels = f64::from(image.width) * f64::from(image.height);
    let reads = [
        (PREFILTER, shading.method.uses_prefiltered()),
        (
            DFG,
            shading
                .method
                .needs_dfg(shading.compensation, shading.diffuse),
        ),
        (IRRADIANCE, shading.diffuse.uses_irradiance_map),
        (MIPS, true),
        (SH9, shading.diffuse.uses_sh9),
    ];
    let table = |(table, _): (&'static str, bool)| {
        let axes = AXES
            .iter()
            .zip(&point.0)
            .filter(|(axis, _)| axis.feeds.contains(&table));
        // An unset axis has its default: a reference shares the mips of the images.
        let key = axes.fold(table.to_owned(), |key, (axis, value)| match value {
            Value::Unset => format!("{key} {}={}", axis.name, (axis.default)()),
            value => format!("{key} {}={value}", axis.name),
        });
        let samples = shading.precompute.samples_of(table).unwrap_or(texels);
        Table {
            key,
            table,
            amount: Amount {
                pixels: 0.0,
                samples,
            },
        }
    };
    reads
        .into_iter()
        .filter(|(_, is_read)| *is_read)
        .map(table)
        .collect()
}
