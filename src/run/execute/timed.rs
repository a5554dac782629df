//! Times the configurations of a run.
//!
//! Compared configurations form a block. Each round of a block times every configuration once, in a new random order, so that drift and
//! disturbances affect all of them alike (a randomised complete block design).

use super::{Progress, Run, RunError, of_cell};
use crate::experiment::config::{Timing, Warmup};
use crate::pipeline::{DeviceInfo, RenderRequest, TimingSamples};
use crate::run::host::HostState;
use crate::run::renderer::{RenderFault, Renderer};
use crate::run::scoring::CellFault;
use crate::run::statistics::{Random, median};
use crate::run::store::TIMINGS_FOLDER;
use crate::run::timing::{self, PassSamples, Place, TimingJob, TimingRecord, WARMUP_TIME_MAX};
use crate::spelling::short_number;
use std::time::Instant;

/// A warm-up ends when the medians of this many frames and of as many before agree within [`STABLE_WITHIN`].
const STABLE_FRAMES: usize = 16;
const STABLE_WITHIN: f64 = 0.01;

struct Timed<'p> {
    job: TimingJob<'p>,
    request: RenderRequest,
    samples: TimingSamples,
    places: Vec<Place>,
    warmup: u32,
    host: [HostState; 2],
}

impl<'p> Run<'p> {
    /// Times every open block. A failure is only reported: the scores do not depend on it.
    pub(super) fn time(&mut self, renderer: &mut dyn Renderer, progress: &mut dyn Progress) -> Result<(), RunError> {
        let Some(timing) = self.plan.config.timing else { return Ok(()) };
        let jobs = self.jobs.clone();
        for block in jobs.chunk_by(|a, b| a.block == b.block) {
            if self.is_stopped() {
                return Ok(());
            }
            // The samples of a block belong together: a block that lacks a record is timed again as a whole.
            if block.iter().all(|job| self.store.has_timing(&job.id)) {
                continue;
            }
            let timed = self.time_block(block, timing, renderer);
            match of_cell(timed.map_err(CellFault::from))? {
                Ok(timed) => {
                    let device = renderer.device();
                    // A process killed while writing must not leave a mix of old and new records.
                    block.iter().try_for_each(|job| self.store.remove_record(TIMINGS_FOLDER, &job.id))?;
                    for configuration in timed {
                        let (job, label) = (configuration.job.clone(), format!("timing {}", configuration.words()));
                        let record = configuration.into_record(&device);
                        self.store.write_timing(&job.id, &record)?;
                        self.forecast.iter_mut().for_each(|forecast| forecast.timing(&job, Some(&record)));
                        progress.step(&label, None, self.ahead());
                    }
                }
                Err(reason) => {
                    for job in block {
                        self.forecast.iter_mut().for_each(|forecast| forecast.timing(job, None));
                        let label = format!("timing {} {}", job.phase, self.plan.label(job.cell));
                        progress.step(&label, Some(&reason), self.ahead());
                    }
                }
            }
        }
        Ok(())
    }

    fn time_block(
        &self,
        block: &[TimingJob<'p>],
        timing: Timing,
        renderer: &mut dyn Renderer,
    ) -> Result<Vec<Timed<'p>>, RenderFault> {
        let mut timed: Vec<Timed> = block
            .iter()
            .map(|job| Timed {
                job: job.clone(),
                request: self.plan.request(&job.cell.point),
                samples: TimingSamples::default(),
                places: Vec::new(),
                warmup: 0,
                host: Default::default(),
            })
            .collect();
        for configuration in &mut timed {
            configuration.warm_up(timing.warmup, renderer)?;
        }
        let before = HostState::observe();
        let (started, mut random) = (Instant::now(), Random::new(u64::from(self.plan.config.seed)));
        for _ in 0..timing.rounds {
            for (order, index) in random.order(timed.len()).into_iter().enumerate() {
                let configuration = &mut timed[index];
                let start_s = started.elapsed().as_secs_f64();
                // The first frame after a change of configuration does not count.
                let change = u32::from(block.len() > 1);
                let sample = configuration.sample(change, 1, renderer)?;
                configuration.samples.append(sample);
                configuration.places.push(Place { order, start_s });
            }
        }
        let host = [before, HostState::observe()];
        timed.iter_mut().for_each(|configuration| configuration.host = host.clone());
        Ok(timed)
    }
}

impl Timed<'_> {
    fn sample(&self, warmup: u32, rounds: u32, renderer: &mut dyn Renderer) -> Result<TimingSamples, RenderFault> {
        renderer.time(&self.request, self.job.phase == timing::PRECOMPUTE, warmup, rounds)
    }

    fn warm_up(&mut self, warmup: Warmup, renderer: &mut dyn Renderer) -> Result<(), RenderFault> {
        if let Warmup::Frames(frames) = warmup {
            self.sample(frames - 1, 1, renderer)?;
            self.warmup = frames;
            return Ok(());
        }
        let started = Instant::now();
        let mut frames_ms: Vec<f64> = Vec::new();
        while started.elapsed() < WARMUP_TIME_MAX {
            frames_ms.extend(self.sample(0, 1, renderer)?.wall_ms);
            if let Some(settled) = frames_ms.len().checked_sub(2 * STABLE_FRAMES) {
                let (before, after) = frames_ms[settled..].split_at(STABLE_FRAMES);
                if (median(after) / median(before) - 1.0).abs() <= STABLE_WITHIN {
                    break;
                }
            }
        }
        self.warmup = frames_ms.len() as u32;
        Ok(())
    }

    /// Phase and axes, for people.
    fn words(&self) -> String {
        let values = self.job.axes.values().filter(|value| !value.is_empty()).map(|value| short_number(value));
        std::iter::once(self.job.phase.into()).chain(values).collect::<Vec<_>>().join(" ")
    }

    fn into_record(self, device: &DeviceInfo) -> TimingRecord {
        let passes = self.samples.passes.into_iter().map(|(pass, ms)| PassSamples { pass: pass.to_owned(), ms });
        TimingRecord {
            cell: self.job.cell.id.clone(),
            phase: self.job.phase.to_owned(),
            block: self.job.block,
            environment_size: self.job.environment_size,
            size: self.job.size,
            axes: self.job.axes,
            warmup: self.warmup,
            rounds: self.places,
            passes: passes.collect(),
            wall_ms: self.samples.wall_ms,
            device: device.name.clone(),
            device_type: device.device_type.to_owned(),
            driver: device.driver.clone(),
            host: self.host,
        }
    }
}
