//! Splits the error of a split sum into the steps of its ladder, on the scene `design`.

use super::light_tables::{read_level, read_texels};
use super::passes::reference_run;
use super::resources::{Prepared, harmonics};
use super::{Pipeline, PipelineError, RenderRequest};
use crate::base::glsl::constants::ALPHA_MIN;
use crate::base::math::design;
use crate::base::names::Listed;
use crate::base::pixels::Pixels;
use crate::instrument::brdf::{Compensation, Fresnel};
use crate::instrument::environment::layout::FilteredMap;
use crate::instrument::gpu::{Gpu, Image};
use crate::instrument::ladder::attribution::{Attribution, Case, attributions};
use crate::instrument::ladder::radiance::{ByKernel, KernelRadiance, Radiance, Setting};
use crate::instrument::precompute::PrecomputeSettings;
use crate::instrument::precompute::given::Given;
use crate::instrument::precompute::prefilter::{Kernel, harmonic};
use crate::instrument::scene::MaterialOverride;
use crate::instrument::shade::method::ladder::MASKING_ALONE;
use crate::instrument::shade::reference_pass::pair_count;
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
        let f0 = vector(material.f0).lerp(vector(material.albedo), material.metallic.into());
        let specular = RenderRequest {
            shading: Shading {
                diffuse: Diffuse::listed(NONE),
                // The steps split single scattering by Schlick's reflectance.
                compensation: Compensation::None,
                fresnel: Fresnel::Schlick,
                ..request.shading
            },
            reference_samples: samples,
            reference_error: None,
            ..request.clone()
        };
        let radiance = self.radiance_by_steps(&specular, &frames)?;
        let case = Case {
            n_dot_v: &n_dot_v,
            radiance: &|coalition| radiance.for_coalition(coalition, f0),
            scrambles: &|coalition| radiance.scrambles(coalition, f0),
            epsilon: request.epsilon(),
        };
        Ok(attributions(&case, bands))
    }

    /// Returns the radiance of each scramble of the single reference term: the same points for
    /// every lobe.
    pub fn scrambles(&mut self, request: &RenderRequest) -> Result<Vec<Vec<DVec3>>, PipelineError> {
        let prepared = self.prepare(request)?;
        let reference = prepared
            .reference
            .as_ref()
            .expect("a term of the reference");
        let &[lobe] = &prepared.lobes[..] else {
            panic!("one term of the reference")
        };
        let pairs = pair_count(request.reference_samples)?;
        let mask = prepared.target.coverage(&self.gpu)?.mask;
        let scrambles = reference_run(request, &prepared, reference, &mask)
            .scrambles(&self.gpu, lobe, pairs)?;
        let radiance = |image: Vec<[f32; 4]>| {
            image
                .into_iter()
                .map(|[r, g, b, _]| vector([r, g, b]))
                .collect()
        };
        Ok(scrambles.into_iter().map(radiance).collect())
    }

    /// Returns the specular radiance of every coalition, kept for other f0 of the same setting.
    fn radiance_by_steps(
        &mut self,
        request: &RenderRequest,
        frames: &[[DVec3; 2]],
    ) -> Result<Arc<Radiance>, PipelineError> {
        let alpha = f64::from(request.scene.materials[0].alpha.max(ALPHA_MIN));
        let key = steps_key(request, alpha);
        if let Some(known) = self.resources.steps.get(&key) {
            return Ok(known);
        }
        let drawn = self.drawn_radiance(request)?;
        let prepared = self.prepare(request)?;
        let filtered = self.filtered_map(request, &prepared)?;
        let dfg_table = read_texels(&self.gpu, &prepared.tables.dfg)?
            .map(|[a, b, ..]: [f32; 4]| DVec2::new(a.into(), b.into()));

        let environment = &request.environment;
        let Shading {
            environment_scale,
            brdf,
            masking_shadowing,
            ..
        } = request.shading;
        let tables = &request.shading.precompute;
        let harmonics = harmonics(
            &mut self.resources.tables.harmonics,
            environment,
            harmonic_degree(tables, alpha),
        )?;
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
                .map(|[n, v]| tables.dfg_axes.lookup(&dfg_table, n.dot(*v), alpha))
                .collect(),
            frames,
            drawn,
        }));
        self.resources.steps.get_or_make(key, || Ok(radiance))
    }

    /// Draws the radiance before n = v = r, by scramble.
    fn drawn_radiance(
        &mut self,
        request: &RenderRequest,
    ) -> Result<Vec<ByKernel<KernelRadiance>>, PipelineError> {
        let exact = self.drawn_with_kernel(request, Method::listed(REFERENCE))?;
        let weighted = self.drawn_with_kernel(request, &MASKING_ALONE)?;
        Ok(exact
            .into_iter()
            .zip(weighted)
            .map(|(exact, weighted)| ByKernel { exact, weighted })
            .collect())
    }

    /// Draws the radiance with the kernel of a method, by scramble.
    fn drawn_with_kernel(
        &mut self,
        request: &RenderRequest,
        method: &'static Method,
    ) -> Result<Vec<KernelRadiance>, PipelineError> {
        let mut drawn = |f0: f32| {
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
            self.with_memory(|pipeline| pipeline.scrambles(&request))
        };
        let f0_0 = drawn(0.0)?;
        let f0_1 = drawn(1.0)?;
        Ok(f0_0
            .into_iter()
            .zip(f0_1)
            .map(|(f0_0, f0_1)| KernelRadiance { f0_0, f0_1 })
            .collect())
    }

    /// Reads the environment's filtered levels from the device.
    fn filtered_map(
        &self,
        request: &RenderRequest,
        prepared: &Prepared,
    ) -> Result<FilteredMap, PipelineError> {
        let image = &prepared.tables.filtered;
        Ok(FilteredMap {
            layout: request.shading.precompute.layout,
            levels: (0..image.mip_count())
                .map(|mip| read_faces(&self.gpu, image, mip))
                .collect::<Result<Vec<_>, PipelineError>>()?,
        })
    }
}

/// Names what determines the radiance of coalitions, as far as f0 does not matter.
fn steps_key(request: &RenderRequest, alpha: f64) -> String {
    let RenderRequest {
        environment,
        // `design`, with the material of `alpha`.
        scene: _,
        // The pixels of `design` have their own views.
        camera: _,
        size,
        shading,
        reference_samples,
        // `None`: drawn terms take all samples.
        reference_error: _,
        background: _,
        antialias: _,
        given:
            Given {
                dfg,
                // The steps filter the environment themselves.
                prefiltered: _,
            },
        seed,
        // Steps are of the light of the environment.
        illumination: _,
    } = request;
    let Shading {
        placement,
        environment_scale,
        brdf,
        masking_shadowing,
        precompute,
        // The split sum has these steps, under single scattering and without layers.
        compensation: _,
        fresnel: _,
        method: _,
        diffuse: _,
        bend: _,
        widths: _,
        coat_layering: _,
        coat_renderer: _,
        sheen_visibility: _,
        sheen_lookup: _,
        specular_occlusion: _,
        metallic_mix: _,
        // Drawn terms take the samples of a reference.
        samples: _,
        sequence: _,
        point_set: _,
        pixel_points: _,
        frames: _,
        frame: _,
        lod_bias: _,
    } = shading;
    let given = dfg.as_ref().map_or("", |table| &table.hash);
    format!(
        "{} {placement:?} {environment_scale} {} {masking_shadowing:?} {alpha} {precompute:?} \
         {given} {size:?} {reference_samples} {seed}",
        environment.hash,
        brdf.name(),
    )
}

/// Returns the degree of harmonics that the lobes of alpha and of the level below alpha need.
fn harmonic_degree(tables: &PrecomputeSettings, alpha: f64) -> usize {
    let count = tables.prefilter_level_count;
    let mip = tables
        .level_mapping
        .mip_from_alpha(alpha, count)
        .floor()
        .min(f64::from(count) - 2.0);
    [alpha, tables.level_mapping.alpha_from_mip(mip, count)]
        .into_iter()
        .filter(|alpha| *alpha > 0.0)
        .map(harmonic::degree)
        .max()
        .expect("alpha is above 0")
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
    let [width, height] = image.mip_size(mip);
    let texels: Vec<DVec3> = read_level(gpu, image, mip)?
        .data
        .into_iter()
        .map(vector)
        .collect();
    Ok(texels
        .chunks((width * height) as usize)
        .map(|face| Pixels::new(width, height, face.to_vec()))
        .collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::pixels::RgbImage;
    use crate::instrument::environment::Environment;
    use crate::instrument::precompute::given::GivenTable;
    use crate::instrument::scene::{CameraKind, Scene};

    #[test]
    fn steps_by_another_given_table_have_another_key() {
        let white = Environment::from_image("white", RgbImage::filled(4, 2, [1.0; 3]));
        let plain =
            RenderRequest::plain(Arc::new(white), Scene::sphere(), CameraKind::Ortho, [8, 8]);
        let key = |hash: &str| {
            let table = GivenTable {
                name: "table".to_owned(),
                hash: hash.to_owned(),
                side: 1,
                texels: vec![[1.0, 0.0, 0.0, 1.0]],
            };
            let given = Given {
                dfg: Some(Arc::new(table)),
                prefiltered: None,
            };
            let request = RenderRequest {
                given,
                ..plain.clone()
            };
            steps_key(&request, 0.5)
        };
        assert_eq!(key("a"), key("a"));
        assert_ne!(key("a"), key("b"));
        assert_ne!(key("a"), steps_key(&plain, 0.5));
    }
}
