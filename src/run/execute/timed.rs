//! Times the configurations of a run.
//!
//! Compared configurations form a block. Each round of a block times every configuration once, in a
//! new random order, so that drift and disturbances affect all of them alike (a randomised complete
//! block design).

use super::{Progress, Run, RunError, of_cell};
use crate::base::numbers::short_number;
use crate::experiment::config::Timing;
use crate::instrument::pipeline::{DeviceInfo, RenderRequest, TimingSamples};
use crate::run::cell_fault::CellFault;
use crate::run::renderer::{RenderFault, Renderer, Served};
use crate::run::store::TIMINGS_FOLDER;
use crate::run::timing::{self, PassSamples, RoundPosition, TimingJob, TimingRecord};
use fastrand::Rng;
use std::time::Instant;

/// An idle GPU lowers its clock. So it renders for so long, in ms, before the first round and
/// before each frame that counts.
const RAMP_MS: f64 = 1000.0;
const KEEP_MS: f64 = 100.0;

struct Timed<'p> {
    job: TimingJob<'p>,
    request: RenderRequest,
    samples: TimingSamples,
    positions: Vec<RoundPosition>,
}

impl<'p> Run<'p> {
    /// Times every open block. A failure is only reported: the scores do not depend on it.
    pub(super) fn time(
        &mut self,
        renderer: &mut dyn Renderer,
        progress: &mut dyn Progress,
    ) -> Result<(), RunError> {
        let Some(timing) = self.plan.config.timing else {
            return Ok(());
        };
        let jobs = self.jobs.clone();
        for block in jobs.chunk_by(|a, b| a.block == b.block) {
            if self.is_stopped() {
                return Ok(());
            }
            // The samples of a block belong together: a block that lacks a record is timed again as
            // a whole.
            if block.iter().all(|job| self.store.has_timing(job.id)) {
                continue;
            }
            let timed = self.time_block(block, timing, renderer);
            match of_cell(timed.map_err(CellFault::from))? {
                Ok(timed) => {
                    let device = renderer.device();
                    // A process killed while writing must not leave a mix of old and new records.
                    block
                        .iter()
                        .try_for_each(|job| self.store.remove_record(TIMINGS_FOLDER, job.id))?;
                    for configuration in timed {
                        let job = configuration.job.clone();
                        let label = format!("timing {}", configuration.words());
                        let record = configuration.into_record(timing.warmup, &device);
                        self.store.write_timing(job.id, &record)?;
                        self.forecast
                            .iter_mut()
                            .for_each(|forecast| forecast.finish(job.id));
                        progress.step(&label, None, self.ahead());
                    }
                }
                Err(reason) => {
                    for job in block {
                        self.forecast
                            .iter_mut()
                            .for_each(|forecast| forecast.finish(job.id));
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
                positions: Vec::new(),
            })
            .collect();
        let is_cpu = renderer.device().device_type == "cpu";
        // Frames that do not count before each that does, by configuration.
        let mut leading = Vec::new();
        for configuration in &timed {
            let sample = configuration.sample(timing.warmup - 1, 1, renderer)?;
            let lasting = |ms: f64| (ms / sample.wall_ms[0].max(0.01)).ceil() as u32;
            if !is_cpu {
                configuration.sample(lasting(RAMP_MS / block.len() as f64), 0, renderer)?;
            }
            leading.push(if is_cpu {
                u32::from(timed.len() > 1 && sample.method_ms() < timing::LONG_MS)
            } else {
                lasting(KEEP_MS)
            });
        }
        let started = Instant::now();
        let mut random = Rng::with_seed(self.plan.config.seed.into());
        let mut indices: Vec<usize> = (0..timed.len()).collect();
        for _ in 0..timing.rounds {
            random.shuffle(&mut indices);
            for (order, &index) in indices.iter().enumerate() {
                let configuration = &mut timed[index];
                let start_s = started.elapsed().as_secs_f64();
                let sample = configuration.sample(leading[index], 1, renderer)?;
                configuration.samples.append(sample);
                configuration
                    .positions
                    .push(RoundPosition { order, start_s });
            }
        }
        Ok(timed)
    }
}

impl Timed<'_> {
    fn sample(
        &self,
        warmup: u32,
        rounds: u32,
        renderer: &mut dyn Renderer,
    ) -> Served<TimingSamples> {
        renderer.time(
            &self.request,
            self.job.phase == timing::PRECOMPUTE,
            [warmup, rounds],
        )
    }

    /// Phase and axes, for people.
    fn words(&self) -> String {
        let values = self.job.axes.values().filter(|value| !value.is_empty());
        let mut words = self.job.phase.to_owned();
        for value in values {
            words.push(' ');
            words += &short_number(value);
        }
        words
    }

    fn into_record(self, warmup: u32, device: &DeviceInfo) -> TimingRecord {
        let passes = self
            .samples
            .passes
            .into_iter()
            .map(|(pass, ms)| PassSamples {
                pass: pass.to_owned(),
                ms,
            });
        TimingRecord {
            cell: self.job.cell.id,
            phase: self.job.phase.to_owned(),
            block: self.job.block,
            environment_size: self.job.environment_size,
            size: self.job.size,
            axes: self.job.axes,
            warmup,
            rounds: self.positions,
            passes: passes.collect(),
            wall_ms: self.samples.wall_ms,
            device: device.name.clone(),
            device_type: device.device_type.to_owned(),
            driver: device.driver.clone(),
            target: device.target.clone(),
        }
    }
}
