//! Direct lights: an image of their own, by the lobes of the reference, added to the image under
//! the environment.
//!
//! It has no samples and no noise, and depends on no setting of a method: every method and the
//! reference get the same light. Layers divide it as they divide the environment's. Occlusion maps
//! are about the surroundings, so they do not dim it.

use super::layers::{Composition, Mixture};
use super::passes::{clear_radiance, passes};
use super::picture::{DeviceMixture, DeviceRadiance};
use super::request::{Frame, Illumination};
use super::resources::Prepared;
use super::{Pipeline, PipelineError, RenderRequest};
use crate::base::glsl::layout::LayerParams;
use crate::base::names::Listed;
use crate::instrument::gpu::Report;
use crate::instrument::precompute::PrecomputeSettings;
use crate::instrument::precompute::given::Given;
use crate::instrument::scene::Light;
use crate::instrument::shade::coat::COAT_RENDERERS;
use crate::instrument::shade::pass::{LIGHTS_PASS, LightBuffer};
use crate::instrument::shade::{Diffuse, Method, REFERENCE};
use std::sync::Arc;

impl RenderRequest {
    /// Returns the request under the environment alone.
    pub(super) fn unlit(&self) -> Self {
        if !self.scene.has_lights() {
            return self.clone();
        }
        Self {
            scene: Arc::new(self.scene.lit_by(Vec::new())),
            ..self.clone()
        }
    }

    /// Returns the request of the image under the scene's lights alone; `None` without any.
    fn under_lights(&self) -> Option<Self> {
        if !self.scene.has_lights() {
            return None;
        }
        let lit = self.unlit().dark();
        let request = lit.shaded(|shading| {
            if !shading.method.is_none() {
                shading.method = Method::listed(REFERENCE);
            }
            if shading.diffuse.has_pass() {
                shading.diffuse = Diffuse::listed(REFERENCE);
            }
            shading.coat_renderer = &COAT_RENDERERS[0];
            // The weight of the diffuse term reads the program's own DFG table.
            shading.precompute = PrecomputeSettings::default();
        });
        Some(Self {
            scene: Arc::new(request.scene.unoccluded()),
            illumination: Illumination::Lights(self.scene.lights.as_slice().into()),
            background: false,
            given: Given::default(),
            ..request
        })
    }

    /// Returns the composition with direct lights; `None` without any.
    pub(super) fn lit(&self) -> Option<Composition> {
        let under_lights = self.under_lights()?;
        let unlit = self.unlit();
        let parts = [unlit.composition(), under_lights.composition()];
        Some(Composition::mixed(AddedLights(unlit), parts))
    }
}

impl Pipeline {
    /// Renders the terms of one layer under direct lights.
    pub(super) fn render_under_lights(
        &mut self,
        request: &RenderRequest,
        lights: &[Light],
    ) -> Result<Frame, PipelineError> {
        self.with_memory(|pipeline| pipeline.reflected_lights(request, lights))
    }

    fn reflected_lights(
        &mut self,
        request: &RenderRequest,
        lights: &[Light],
    ) -> Result<Frame, PipelineError> {
        let prepared = self.prepare(request)?;
        let report = self.shade_lights(request, &prepared, lights)?;
        Ok(Frame {
            // The lights are exact.
            standard_error: None,
            ..self.read_frame(request, prepared, &report, Vec::new())?
        })
    }

    /// Runs the passes of direct lights; the radiance stays in the target.
    pub(super) fn shade_lights(
        &self,
        request: &RenderRequest,
        prepared: &Prepared,
        lights: &[Light],
    ) -> Result<Report, PipelineError> {
        let gpu = &self.gpu;
        let passes = passes(request, prepared);
        let mut report = clear_radiance(gpu, prepared)?;
        let lights = LightBuffer::new(gpu, lights)?;
        for lobe in &prepared.lobes {
            let shader = lobe.lights_shader(request.shading.brdf);
            let constants = lobe.shading_specialization(&passes);
            for part in gpu.parts(request.size, 1, lights.count().into()) {
                report.add(gpu.submit_pass(LIGHTS_PASS, |r| {
                    passes.lights(r, &shader, constants, &lights, part)
                })?);
            }
        }
        Ok(report)
    }
}

/// Adds the image under lights to the one under the environment, whose request it holds.
struct AddedLights(RenderRequest);

impl Mixture for AddedLights {
    fn on_host(&self, _: &mut Pipeline, frames: &[Frame]) -> Result<Frame, PipelineError> {
        let mut frame = frames[0].clone();
        let pixels = frame.radiance.data.iter_mut().zip(&frames[1].radiance.data);
        for (radiance, light) in pixels {
            (0..3).for_each(|c| radiance[c] += light[c]);
        }
        Ok(frame)
    }

    fn on_device(
        &self,
        pipeline: &mut Pipeline,
        images: &[DeviceRadiance],
    ) -> Result<DeviceRadiance, PipelineError> {
        pipeline.mixed_on_device(&DeviceMixture {
            shader: "shade/layers/lights.comp",
            images: &[&images[0], &images[1]],
            layer: &self.0,
            weights: None,
            lobe: None,
            params: LayerParams::default(),
        })
    }
}
