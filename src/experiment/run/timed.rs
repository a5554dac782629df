//! Times the configurations of a run.

use super::{Progress, Run, RunError, cell_result};
use crate::experiment::renderer::Renderer;
use crate::experiment::timing::{self, PassSamples, TimingRecord};

impl Run<'_> {
    /// Times one configuration unless it is done. A failure is a note: the errors do not depend on it.
    pub(super) fn time(
        &mut self,
        index: usize,
        renderer: &mut dyn Renderer,
        progress: &mut dyn Progress,
    ) -> Result<(), RunError> {
        let job = &self.jobs[index];
        let (Some(timing), false) = (self.plan.config.timing, self.is_stopped()) else { return Ok(()) };
        if self.store.has_timing(&job.id) {
            return Ok(());
        }
        let request = self.plan.request(&job.cell.point);
        let samples = match job.phase {
            timing::PRECOMPUTE => renderer.time_precompute(&request, timing.warmup, timing.rounds),
            _ => renderer.time(&request, timing.warmup, timing.rounds),
        };
        let label = format!("timing {} {}", job.phase, self.plan.label(job.cell));
        match cell_result(samples)? {
            Ok(samples) => {
                let device = renderer.device();
                let record = TimingRecord {
                    cell: job.cell.id.clone(),
                    phase: job.phase.to_owned(),
                    environment_size: job.environment_size,
                    size: self.plan.size_of(job.cell),
                    axes: job.axes.clone(),
                    warmup: timing.warmup,
                    passes: samples
                        .passes
                        .into_iter()
                        .map(|(pass, ms)| PassSamples { pass: pass.to_owned(), ms })
                        .collect(),
                    wall_ms: samples.wall_ms,
                    device: device.name,
                    device_type: device.device_type.to_owned(),
                    driver: device.driver,
                };
                self.store.write_timing(&job.id, &record)?;
                progress.step(&label, None);
            }
            Err(reason) => progress.step(&label, Some(&reason)),
        }
        Ok(())
    }
}
