//! Times of passes, over several rounds.

use super::prepare::draw_gbuffer;
use super::resources::Shelves;
use super::shared_work::Kept;
use super::{Pipeline, PipelineError, RenderRequest, TimingSamples};
use crate::instrument::gpu::Report;
use crate::instrument::tonemap::{self, ToneCurve};

impl Pipeline {
    /// Times the passes of a frame, tone curve included: `warmup` rounds that do not count, then
    /// `rounds`. Of a sequence it times one frame.
    pub fn time(
        &mut self,
        request: &RenderRequest,
        warmup: u32,
        rounds: u32,
    ) -> Result<TimingSamples, PipelineError> {
        let layers = if request.is_sequence() {
            request.of_frame(0).layers()
        } else {
            request.layers()
        };
        let prepared = layers
            .iter()
            .map(|layer| self.prepare(layer))
            .collect::<Result<Vec<_>, _>>()?;
        let packed = tonemap::pass::packed(&self.gpu, request.size)?;
        let mut samples = TimingSamples::default();
        for round in 0..warmup + rounds {
            let mut report = Report::default();
            for (layer, prepared) in layers.iter().zip(&prepared) {
                // The host wrote the g-buffer of the scene `design`.
                if !layer.scene.is_design {
                    let images = &prepared.target.gbuffer;
                    report.add(draw_gbuffer(&self.gpu, layer, &prepared.scene, images)?);
                }
                report.add(self.shade(layer, prepared, &[])?.report);
            }
            report.add(tonemap::pass::run(
                &self.gpu,
                ToneCurve::default(),
                &prepared[0].target.radiance,
                &packed,
                request.size,
            )?);
            if round >= warmup {
                samples.push(&report.passes, report.wall_ms);
            }
        }
        Ok(samples)
    }

    /// Times the precompute passes of `request`. Each round makes all tables again, but those that
    /// no pass makes (taps).
    pub fn time_precompute(
        &mut self,
        request: &RenderRequest,
        warmup: u32,
        rounds: u32,
    ) -> Result<TimingSamples, PipelineError> {
        let mut samples = TimingSamples::default();
        for round in 0..warmup + rounds {
            let tap_tables =
                std::mem::replace(&mut self.resources.tables, Shelves::new()).tap_tables;
            self.resources.tables.tap_tables = tap_tables;
            self.check(request)?;
            let report = self
                .resources
                .prepare(&self.gpu, &mut Kept::default(), request)?
                .precompute;
            if round >= warmup {
                samples.push(&report.passes, report.wall_ms);
            }
        }
        Ok(samples)
    }
}
