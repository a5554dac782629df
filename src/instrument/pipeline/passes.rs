//! Runs the shading passes of a request over its g-buffer, and reads their radiance.

use super::resources::{Prepared, ReferenceData};
use super::{Pipeline, PipelineError, RenderRequest};
use crate::base::glsl::constants::POINTS_PER_DISPATCH;
use crate::base::pixels::{GrayImage, Pixels, RgbImage};
use crate::instrument::gpu::{Buffer, Gpu, Report};
use crate::instrument::shade::pass::{DIFFUSE_PASS, Passes, SPECULAR_PASS};
use crate::instrument::shade::reference_pass::{Convergence, Drawn, ReferenceRun, TermRun};

/// What the passes of a frame report.
pub(super) struct Shaded {
    pub(super) report: Report,
    /// Where each reference term stopped.
    pub(super) convergences: Vec<Convergence>,
    /// The sums of each reference term.
    pub(super) drawn: Vec<Drawn>,
}

/// Images that the passes of a frame leave on the device.
pub(super) struct RadianceImages {
    pub(super) radiance: RgbImage,
    /// Standard error of the mean; `None` without a reference term.
    pub(super) standard_error: Option<RgbImage>,
}

impl Pipeline {
    /// Runs every shading pass; the radiance stays in the target. `begun` are sums
    /// of the reference terms of the same request with fewer samples; empty if there are none.
    pub(super) fn shade(
        &self,
        request: &RenderRequest,
        prepared: &Prepared,
        begun: &[Drawn],
    ) -> Result<Shaded, PipelineError> {
        let gpu = &self.gpu;
        let passes = passes(request, prepared);
        let mut report = clear_radiance(gpu, prepared)?;
        if request.shading.method.has_pass() {
            let points_per_dispatch = prepared.samples_per_pixel.min(POINTS_PER_DISPATCH);
            for part in gpu.parts(request.size, 1, points_per_dispatch.into()) {
                for points in prepared.tables.points.ranges() {
                    report
                        .add(gpu.submit_pass(SPECULAR_PASS, |r| passes.specular(r, points, part))?);
                }
            }
        }
        let mut convergences = Vec::new();
        let mut all_drawn = Vec::new();
        if let Some(reference) = &prepared.reference {
            let mut recorder = gpu.record("reference")?;
            recorder.fill(&reference.squared_error, 0);
            report.add(recorder.submit()?);
            let mask = prepared.target.coverage(gpu)?.mask;
            let run = reference_run(request, prepared, reference, &mask);
            for (index, lobe) in prepared.lobes.iter().enumerate() {
                let TermRun {
                    report: times,
                    convergence,
                    drawn,
                } = run.run(gpu, *lobe, begun.get(index))?;
                report.add(times);
                convergences.push(convergence);
                all_drawn.push(drawn);
            }
        }
        for part in gpu.parts(request.size, 1, 1) {
            let mut recorder = gpu.record("shade")?;
            if request.shading.diffuse.has_pass() {
                recorder.pass(DIFFUSE_PASS, |r| passes.diffuse(r, part))?;
            }
            if request.background {
                recorder.pass("background", |r| passes.background(r, part))?;
            }
            report.add(recorder.submit()?);
        }
        Ok(Shaded {
            report,
            convergences,
            drawn: all_drawn,
        })
    }
}

/// Clears the radiance of a target whose g-buffer is drawn. The report has the shaders of the
/// g-buffer, since the image depends on them.
pub(super) fn clear_radiance(gpu: &Gpu, prepared: &Prepared) -> Result<Report, PipelineError> {
    let target = &prepared.target;
    let mut recorder = gpu.record("clear radiance")?;
    recorder.fill(&target.radiance, 0);
    let mut report = recorder.submit()?;
    report.shaders.extend(target.shaders.iter().cloned());
    Ok(report)
}

pub(super) fn passes<'a>(request: &'a RenderRequest, prepared: &'a Prepared) -> Passes<'a> {
    let Prepared { tables, target, .. } = prepared;
    Passes {
        shading: &request.shading,
        camera: &request.camera,
        tables,
        gbuffer: &target.gbuffer,
        fresnel_f0: request.fresnel_f0(),
        tangents: prepared.tangents.as_ref().map(|target| &target.gbuffer),
        radiance: &target.radiance,
    }
}

/// Returns the passes of the reference terms.
pub(super) fn reference_run<'a>(
    request: &'a RenderRequest,
    prepared: &'a Prepared,
    reference: &'a ReferenceData,
    mask: &'a GrayImage,
) -> ReferenceRun<'a> {
    let ReferenceData {
        distribution,
        sums,
        squared_error,
    } = reference;
    ReferenceRun {
        passes: passes(request, prepared),
        stop: request.reference_stop(),
        epsilon: request.epsilon(),
        seed: request.seed,
        mask,
        distribution,
        sums,
        squared_error,
    }
}

/// Reads the radiance and its standard error; an error if radiance is negative or not finite.
pub(super) fn read_radiance(
    gpu: &Gpu,
    prepared: &Prepared,
    request: &RenderRequest,
) -> Result<RadianceImages, PipelineError> {
    let radiance = read_image(gpu, &prepared.target.radiance, request.size)?;
    let is_invalid = |texel: &[f32; 3]| texel.iter().any(|x| !x.is_finite() || *x < 0.0);
    if let Some(index) = radiance.data.iter().position(is_invalid) {
        return Err(PipelineError::InvalidRadiance {
            method: request.shading.method,
            count: radiance
                .data
                .iter()
                .filter(|texel| is_invalid(texel))
                .count(),
            x: index as u32 % radiance.width,
            y: index as u32 / radiance.width,
            value: radiance.data[index],
        });
    }
    let standard_error = match &prepared.reference {
        Some(reference) => {
            let squared_error = read_image(gpu, &reference.squared_error, request.size)?;
            Some(squared_error.map(|texel| texel.map(f32::sqrt)))
        }
        None => None,
    };
    Ok(RadianceImages {
        radiance,
        standard_error,
    })
}

/// Reads a buffer of a vec4 per pixel, without the last component.
fn read_image(
    gpu: &Gpu,
    buffer: &Buffer,
    [width, height]: [u32; 2],
) -> Result<RgbImage, PipelineError> {
    let texels: Vec<[f32; 4]> = gpu.read_buffer(buffer)?;
    Ok(Pixels::new(
        width,
        height,
        texels.iter().map(|&[r, g, b, _]| [r, g, b]).collect(),
    ))
}
