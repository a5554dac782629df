//! Splits the error of a split sum into the steps of its ladder, on the scene `design`.

use super::light_tables::{read_level, read_texels};
use super::resources::harmonics;
use super::{Pipeline, PipelineError, RenderRequest, passes};
use crate::base::glsl::constants::ALPHA_MIN;
use crate::base::math::design;
use crate::base::names::Listed;
use crate::base::pixels::Pixels;
use crate::instrument::brdf::Compensation;
use crate::instrument::environment::layout::FilteredMap;
use crate::instrument::gpu::{Gpu, Image};
use crate::instrument::ladder::attribution::{Attribution, Case, attributions};
use crate::instrument::ladder::game::Coalition;
use crate::instrument::ladder::radiance::{Radiance, Setting};
use crate::instrument::precompute::prefilter::{Kernel, harmonic};
use crate::instrument::scene::MaterialOverride;
use crate::instrument::shade::method::ladder::MASKING_ALONE;
use crate::instrument::shade::reference_pass::{ReferenceRun, pair_count};
use crate::instrument::shade::{Diffuse, Method, NONE, REFERENCE, Shading};
use glam::{DVec2, DVec3};
use std::sync::Arc;

impl Pipeline {
    /// Splits the error of the image of `request` into the steps of its ladder: over all pixels,
    /// and over the pixels of each band of n·v. The scene must be a `design`; drawn terms take
    /// `samples` a pixel.
    pub fn attributions(
        &mut self,
        request: &RenderRequest,
        samples: u32,
        bands: &[[f64; 2]],
    ) -> Result<Vec<Attribution>, PipelineError> {
        assert!(
            request.scene.is_design,
            "attributions need the scene `design`"
        );
        let frames = frames(request);
        let n_dot_v: Vec<f64> = frames.iter().map(|[n, v]| n.dot(*v)).collect();
        let material = &request.scene.materials[0];
        let rgb = |values: [f32; 3]| DVec3::from_array(values.map(f64::from));
        let f0 = rgb(material.f0).lerp(rgb(material.albedo), material.metallic.into());
        let split = |radiance: &dyn Fn(Coalition) -> Vec<DVec3>,
                     scrambles: &dyn Fn(Coalition) -> Vec<Vec<DVec3>>| {
            let (n_dot_v, epsilon) = (&n_dot_v[..], request.epsilon());
            attributions(
                &Case {
                    n_dot_v,
                    radiance,
                    scrambles,
                    epsilon,
                },
                bands,
            )
        };
        let request = RenderRequest {
            shading: Shading {
                diffuse: Diffuse::listed(NONE),
                // The steps split single scattering.
                compensation: Compensation::None,
                ..request.shading
            },
            reference_samples: samples,
            reference_error: None,
            ..request.clone()
        };
        let radiance = self.specular_by_steps(&request, &frames)?;
        Ok(split(
            &|coalition| radiance.of(coalition, f0),
            &|coalition| radiance.scrambles(coalition, f0),
        ))
    }

    /// Returns the radiance of each scramble of the single reference term: the same points for
    /// every lobe.
    pub fn scrambles(&mut self, request: &RenderRequest) -> Result<Vec<Vec<DVec3>>, PipelineError> {
        let prepared = self.prepare(request)?;
        let data = prepared
            .reference
            .as_ref()
            .expect("a term of the reference");
        let (distribution, sums, squared_error) =
            (&data.distribution, &data.sums, &data.squared_error);
        let (target, epsilon) = (&prepared.target, request.epsilon());
        let passes = passes(request, &prepared);
        let (stop, seed, mask) = (request.reference_stop(), request.seed, &*target.mask);
        let run = ReferenceRun {
            passes,
            stop,
            epsilon,
            seed,
            mask,
            distribution,
            sums,
            squared_error,
        };
        let &[lobe] = &prepared.lobes[..] else {
            panic!("one term of the reference")
        };
        let drawn = run.scrambles(&self.gpu, lobe, pair_count(request.reference_samples)?)?;
        let radiance = |image: Vec<[f32; 4]>| {
            image
                .into_iter()
                .map(|[r, g, b, _]| vector([r, g, b]))
                .collect()
        };
        Ok(drawn.into_iter().map(radiance).collect())
    }

    fn dfg_table(&self, table: &Image) -> Result<Pixels<DVec2>, PipelineError> {
        Ok(read_texels(&self.gpu, table)?
            .map(|[a, b, ..]: [f32; 4]| DVec2::new(a.into(), b.into())))
    }

    fn specular_by_steps(
        &mut self,
        request: &RenderRequest,
        frames: &[[DVec3; 2]],
    ) -> Result<Arc<Radiance>, PipelineError> {
        let alpha = f64::from(request.scene.materials[0].alpha.max(ALPHA_MIN));
        let RenderRequest {
            environment,
            shading,
            ..
        } = request;
        let Shading {
            placement,
            environment_scale,
            brdf,
            masking_shadowing,
            ..
        } = *shading;
        let key = format!(
            "{} {placement:?} {environment_scale} {} {masking_shadowing:?} {alpha} {:?} {:?} {} {}",
            environment.hash,
            brdf.name(),
            request.shading.precompute,
            request.size,
            request.reference_samples,
            request.seed
        );
        if let Some(known) = self.resources.steps.get(&key) {
            return Ok(known);
        }
        let mut drawn = |method: &'static Method, f0: f32| {
            let material = MaterialOverride {
                f0: Some([f0; 3]),
                metallic: Some(0.0),
                ..MaterialOverride::default()
            };
            let scene = Arc::new(request.scene.apply(&material));
            let request = RenderRequest {
                scene,
                ..request.shaded(|s| s.method = method)
            };
            self.with_memory(|own| own.scrambles(&request))
        };
        let mut of_method =
            |method| Ok::<_, PipelineError>([drawn(method, 0.0)?, drawn(method, 1.0)?]);
        let reference = Method::listed(REFERENCE);
        let by_kernel = [of_method(reference)?, of_method(&MASKING_ALONE)?];
        let of_scramble = |k: usize| {
            by_kernel
                .each_ref()
                .map(|by_f0| by_f0.each_ref().map(|drawn| drawn[k].clone()))
        };
        let drawn = (0..by_kernel[0][0].len()).map(of_scramble).collect();

        let prepared = self.prepare(request)?;
        let tables = &request.shading.precompute;
        let levels = (0..prepared.tables.filtered.mip_count())
            .map(|mip| read_faces(&self.gpu, &prepared.tables.filtered, mip))
            .collect::<Result<Vec<_>, PipelineError>>()?;
        let filtered = FilteredMap {
            layout: tables.layout,
            levels,
        };
        let table = self.dfg_table(&prepared.tables.dfg)?;
        let count = tables.prefilter_level_count;
        let mip = tables
            .level_mapping
            .mip_from_alpha(alpha, count)
            .floor()
            .min(f64::from(count) - 2.0);
        let widths = [alpha, tables.level_mapping.alpha_from_mip(mip, count)];
        let degree = widths
            .into_iter()
            .filter(|alpha| *alpha > 0.0)
            .map(harmonic::degree)
            .max();
        let degree = degree.expect("alpha is above 0");
        let harmonics = harmonics(&mut self.resources.tables.harmonics, environment, degree)?;
        let kernel = Kernel::new(brdf, tables.prefilter_weight, masking_shadowing);
        let albedos = self.resources.albedos_of(kernel, masking_shadowing, alpha);
        let radiance = Arc::new(Radiance::new(Setting {
            model: brdf,
            masking: masking_shadowing,
            alpha,
            albedos: &albedos,
            tables,
            environment,
            scale: environment_scale.into(),
            harmonics: &harmonics,
            filtered: &filtered,
            table: frames
                .iter()
                .map(|[n, v]| tables.dfg_axes.lookup(&table, n.dot(*v), alpha))
                .collect(),
            frames,
            drawn,
        }));
        self.resources.steps.get_or_make(key, || Ok(radiance))
    }
}

/// Returns normal and view of each pixel in the environment's frame.
fn frames(request: &RenderRequest) -> Vec<[DVec3; 2]> {
    let [width, height] = request.size;
    let turn = request.shading.placement.environment_from_world();
    (0..width * height)
        .map(|i| design::frame(i, width * height).map(|d| (turn * d).normalize()))
        .collect()
}

fn vector(rgb: [f32; 3]) -> DVec3 {
    DVec3::from_array(rgb.map(f64::from))
}

/// Reads the faces of a level from the device.
fn read_faces(gpu: &Gpu, image: &Image, mip: u32) -> Result<Vec<Pixels<DVec3>>, PipelineError> {
    Ok(faces(
        read_level(gpu, image, mip)?.data.into_iter(),
        image.mip_size(mip),
    ))
}

/// Splits texels into faces that follow each other.
fn faces(texels: impl Iterator<Item = [f32; 3]>, [width, height]: [u32; 2]) -> Vec<Pixels<DVec3>> {
    let texels: Vec<DVec3> = texels.map(vector).collect();
    texels
        .chunks((width * height) as usize)
        .map(|face| Pixels::new(width, height, face.to_vec()))
        .collect()
}
