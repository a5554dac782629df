//! The error of a split sum by its steps (`ladder`), for the scene `design`.

use super::light_tables::read_level;
use super::{Pipeline, PipelineError, RenderRequest};
use crate::environment::layout::FilteredMap;
use crate::gbuffer::design;
use crate::glsl::constants::ALPHA_MIN;
use crate::ladder::attribution::{Attribution, Case, attributions};
use crate::ladder::radiance::{Radiance, Setting};
use crate::pixels::{Pixels, RgbImage};
use crate::precompute::dfg::{self, Albedos};
use crate::precompute::prefilter::{Kernel, harmonic};
use crate::scene::MaterialOverride;
use crate::shade::method::ladder::MASKING_ALONE;
use crate::shade::{Method, NONE, REFERENCE, diffuse_by_name, method_by_name};
use glam::{DVec2, DVec3};
use std::sync::Arc;

/// What of the radiance of coalitions does not hang on f0, and may serve the next request.
pub(super) type KeptRadiance = Arc<Radiance>;
/// What hangs on no light.
pub(super) type KeptAlbedos = Arc<Albedos>;

impl Pipeline {
    /// The error of the split sum that `request` asks for, by steps: over all pixels, and over those of each band of n·v. The scene is a
    /// `design`; what is drawn takes `samples` a pixel.
    pub fn attributions(
        &mut self,
        request: &RenderRequest,
        samples: u32,
        bands: &[[f64; 2]],
    ) -> Result<Vec<Attribution>, PipelineError> {
        assert!(request.scene.is_design, "the steps are told on the scene `design`");
        let request = RenderRequest {
            diffuse: diffuse_by_name(NONE).expect("a listed diffuse method"),
            reference_samples: samples,
            reference_error: None,
            ..request.clone()
        };
        let reference = method_by_name(REFERENCE).expect("a listed method");
        let truth = self.render(&RenderRequest { method: reference, ..request.clone() })?;
        let standard_error = truth.standard_error.as_ref().map(vectors).expect("the reference knows its error");
        let material = &request.scene.materials[0];
        let rgb = |values: [f32; 3]| DVec3::from_array(values.map(f64::from));
        let f0 = rgb(material.f0).lerp(rgb(material.albedo), material.metallic.into());
        let frames = frames(&request);
        let n_dot_v: Vec<f64> = frames.iter().map(|[n, v]| n.dot(*v)).collect();
        let radiance = self.radiance_by_steps(&request, &frames, reference)?;
        let case = Case {
            n_dot_v: &n_dot_v,
            radiance: &|coalition| radiance.of(coalition, f0),
            standard_error: &standard_error,
            epsilon: request.epsilon(),
        };
        Ok(attributions(&case, bands))
    }

    fn radiance_by_steps(
        &mut self,
        request: &RenderRequest,
        frames: &[[DVec3; 2]],
        reference: &'static Method,
    ) -> Result<KeptRadiance, PipelineError> {
        let alpha = f64::from(request.scene.materials[0].alpha.max(ALPHA_MIN));
        let RenderRequest { environment, placement, environment_scale, brdf, masking_shadowing, .. } = request;
        let key = format!(
            "{} {placement:?} {environment_scale} {} {masking_shadowing:?} {alpha} {:?} {:?} {} {}",
            environment.hash,
            brdf.name(),
            request.precompute,
            request.size,
            request.reference_samples,
            request.seed
        );
        if let Some(known) = self.resources.steps.get(&key) {
            return Ok(known);
        }
        let mut drawn = |method: &'static Method, f0: f32| -> Result<Vec<DVec3>, PipelineError> {
            let material = MaterialOverride { f0: Some([f0; 3]), metallic: Some(0.0), ..MaterialOverride::default() };
            let scene = Arc::new(request.scene.apply(&material));
            Ok(vectors(&self.render(&RenderRequest { method, scene, ..request.clone() })?.radiance))
        };
        let mut of_method = |method| Ok::<_, PipelineError>([drawn(method, 0.0)?, drawn(method, 1.0)?]);
        let drawn = [of_method(reference)?, of_method(&MASKING_ALONE)?];

        let prepared = self.prepare(request)?;
        let tables = &request.precompute;
        let levels = (0..prepared.tables.filtered.mip_count()).map(|mip| {
            let stacked = read_level(&self.gpu, &prepared.tables.filtered, mip)?;
            let [width, height] = prepared.tables.filtered.mip_size(mip);
            let faces = stacked.data.chunks((width * height) as usize);
            let face =
                |texels: &[[f32; 3]]| Pixels::new(width, height, texels.iter().map(|rgb| vector(*rgb)).collect());
            Ok(faces.map(face).collect())
        });
        let filtered =
            FilteredMap { layout: tables.layout, levels: levels.collect::<Result<Vec<_>, PipelineError>>()? };
        let [side, _] = prepared.tables.dfg.mip_size(0);
        let table = Pixels::new(side, side, self.gpu.read_image(&prepared.tables.dfg, 0)?);
        let table = table.map(|[a, b, ..]: [f32; 4]| DVec2::new(a.into(), b.into()));
        let count = tables.prefilter_level_count;
        let mip = tables.level_mapping.mip_from_alpha(alpha, count).floor().min(f64::from(count) - 2.0);
        let widths = [alpha, tables.level_mapping.alpha_from_mip(mip, count)];
        let degree = widths.into_iter().filter(|alpha| *alpha > 0.0).map(harmonic::degree).max();
        let harmonics = self.resources.harmonics(environment, degree.expect("alpha is above 0"))?;
        let kernel = Kernel::new(*brdf, tables.prefilter_weight, *masking_shadowing);
        let of_lobe = format!("{} {} {masking_shadowing:?} {alpha}", brdf.name(), kernel.weight.name);
        let make = || Ok::<_, PipelineError>(Arc::new(Albedos::new(kernel, *masking_shadowing, alpha)));
        let albedos = self.resources.albedos.get_or_make(of_lobe, make)?;
        let radiance = Arc::new(Radiance::new(Setting {
            model: *brdf,
            masking: *masking_shadowing,
            alpha,
            albedos: &albedos,
            tables,
            environment,
            scale: (*environment_scale).into(),
            harmonics: &harmonics,
            filtered: &filtered,
            table: frames.iter().map(|[n, v]| dfg::lookup(&table, n.dot(*v), alpha)).collect(),
            frames,
            drawn,
        }));
        self.resources.steps.get_or_make(key, || Ok(radiance))
    }
}

/// Normal and view of each pixel in the environment's frame.
fn frames(request: &RenderRequest) -> Vec<[DVec3; 2]> {
    let [width, height] = request.size;
    let turn = request.placement.environment_from_world();
    (0..width * height).map(|i| design::frame(i, width * height).map(|d| (turn * d).normalize())).collect()
}

fn vector(rgb: [f32; 3]) -> DVec3 {
    DVec3::from_array(rgb.map(f64::from))
}

fn vectors(image: &RgbImage) -> Vec<DVec3> {
    image.data.iter().map(|rgb| vector(*rgb)).collect()
}
