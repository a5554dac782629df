//! Requests to the pipeline, and its results.

use crate::base::glsl::constants::FRESNEL_SCHLICK;
use crate::base::pixels::{GrayImage, RgbImage};
use crate::instrument::brdf::Fresnel;
use crate::instrument::environment::Environment;
use crate::instrument::gbuffer::pass::GBUFFER_PASS;
use crate::instrument::gpu::PassTime;
use crate::instrument::metrics::Epsilon;
use crate::instrument::precompute::PrefilterBy;
use crate::instrument::precompute::given::Given;
use crate::instrument::scene::{Camera, CameraKind, Light, Scene};
use crate::instrument::shade::Shading;
use crate::instrument::shade::reference_pass::{Convergence, Lobe, Stop};
use std::sync::Arc;

/// What lights the surfaces of an image.
#[derive(Clone, Debug, Default)]
pub enum Illumination {
    /// The environment, and the lights of the scene if there are any.
    #[default]
    Environment,
    /// These lights alone; each term must be a reference or absent.
    Lights(Arc<[Light]>),
}

/// Everything that determines one radiance image.
#[derive(Clone, Debug)]
pub struct RenderRequest {
    pub environment: Arc<Environment>,
    pub scene: Arc<Scene>,
    pub camera: Camera,
    pub size: [u32; 2],
    pub shading: Shading,
    /// Samples a pixel of a reference, specular or diffuse.
    pub reference_samples: u32,
    /// Stops references early, once the relative standard error of each term is at most this.
    pub reference_error: Option<f64>,
    /// Shows the environment where nothing is hit.
    pub background: bool,
    /// Antialiases edges and removes their pixels from the mask. Has no effect on the scene
    /// `design`.
    pub antialias: bool,
    /// Tables from files. Sizes, levels and mapping in `shading.precompute` must match them.
    pub given: Given,
    /// Chooses the scrambles of the reference.
    pub seed: u32,
    /// [`Illumination::Environment`] but in the pipeline's own requests.
    pub illumination: Illumination,
}

impl RenderRequest {
    /// A view of `scene` under `environment`: GGX, split sum, no diffuse term, default tables; see
    /// `examples/render_sphere.rs`.
    pub fn plain(
        environment: Arc<Environment>,
        scene: Scene,
        kind: CameraKind,
        size: [u32; 2],
    ) -> Self {
        Self {
            environment,
            camera: Camera::for_scene(kind, &scene, size),
            scene: Arc::new(scene),
            size,
            shading: Shading::default(),
            reference_samples: 1024,
            reference_error: None,
            background: false,
            antialias: false,
            given: Given::default(),
            seed: 1,
            illumination: Illumination::default(),
        }
    }

    /// Whether edges are antialiased: pixels of the scene `design` have none.
    pub(super) fn is_antialiased(&self) -> bool {
        self.antialias && !self.scene.is_design
    }

    /// Returns a copy with other shading parameters.
    pub fn shaded(&self, change: impl FnOnce(&mut Shading)) -> Self {
        let mut request = self.clone();
        change(&mut request.shading);
        request
    }

    /// Returns the reference terms, specular first.
    pub(super) fn reference_lobes(&self) -> Vec<Lobe> {
        let Shading {
            method, diffuse, ..
        } = self.shading;
        method
            .lobe
            .map(Lobe::Specular)
            .into_iter()
            .chain(diffuse.lobe.map(Lobe::Diffuse))
            .collect()
    }

    /// Whether the environment lights the surfaces.
    pub(super) fn is_under_environment(&self) -> bool {
        matches!(self.illumination, Illumination::Environment)
    }

    /// Returns the ε of relative metrics under this environment; direct lights do not change it.
    pub fn epsilon(&self) -> Epsilon {
        Epsilon::of_light(
            self.environment.luminance.mean * f64::from(self.shading.environment_scale),
        )
    }

    pub(super) fn reference_stop(&self) -> Stop {
        Stop {
            sample_count: self.reference_samples,
            relative_error: self.reference_error,
        }
    }

    /// Whether the frame reads the environment's filtered levels, directly or through a map made
    /// from them.
    pub fn reads_filtered_levels(&self) -> bool {
        let Shading {
            method, diffuse, ..
        } = self.shading;
        let is_integrated =
            diffuse.uses_irradiance_map && self.shading.tables().prefilter == PrefilterBy::Sampled;
        method.uses_lod_bias || method.uses_prefiltered() || is_integrated
    }

    /// Whether a frame reads the DFG table.
    pub fn needs_dfg(&self) -> bool {
        let Shading {
            method,
            diffuse,
            compensation,
            ..
        } = self.shading;
        method.needs_dfg(compensation, diffuse)
    }

    /// Returns the specialization constant `fresnel_f0`.
    pub(super) fn fresnel_f0(&self) -> f32 {
        match (self.shading.fresnel, self.scene.dielectric_f0()) {
            (Fresnel::Exact, Ok(f0)) => f0,
            _ => FRESNEL_SCHLICK,
        }
    }

    /// Whether a term is a reference: then the frame has a standard error.
    pub fn has_reference_term(&self) -> bool {
        self.shading.method.is_integrated() || self.shading.diffuse.is_integrated()
    }
}

/// How steady a sequence is.
#[derive(Clone, Debug)]
pub struct Steadiness {
    /// The accumulated frames without noise: what is left of the error is bias.
    pub without_noise: RgbImage,
    /// Variance over the last frames, after the tone curve, of the result less the result without
    /// noise; mean over the mask.
    pub flicker: f64,
}

#[derive(Clone, Debug)]
pub struct Frame {
    /// Linear radiance; 0 if nothing is hit, unless the background is shown.
    pub radiance: RgbImage,
    /// Standard error of the mean, by pixel and channel; references only.
    pub standard_error: Option<RgbImage>,
    /// Where each reference term stopped.
    pub convergences: Vec<Convergence>,
    /// 1 if a surface is hit, else 0.
    pub mask: Arc<GrayImage>,
    /// Cosine between normal and view; 0 if nothing is hit.
    pub n_dot_v: Arc<GrayImage>,
    /// Of a sequence of frames, how steady it is.
    pub steadiness: Option<Steadiness>,
    pub timings: FrameTimings,
}

impl Frame {
    /// Memory of the images that it does not share, bytes.
    pub fn bytes(&self) -> u64 {
        let images = [Some(&self.radiance), self.standard_error.as_ref()];
        images
            .into_iter()
            .flatten()
            .map(|image| size_of_val(&image.data[..]) as u64)
            .sum()
    }
}

#[derive(Clone, Debug, Default, PartialEq)]
pub struct FrameTimings {
    /// Precompute passes that ran: `mips`, `sh9`, `irradiance`, `prefilter`, `dfg`. Empty if all
    /// tables existed.
    pub precompute: Vec<PassTime>,
    /// Per-frame passes: `gbuffer`, `shade-specular`, `shade-diffuse`, `background`, `tonemap`.
    pub frame: Vec<PassTime>,
    /// Host time of the submissions of `frame`, ms.
    pub wall_ms: f64,
}

impl FrameTimings {
    pub(super) fn and(mut self, other: Self) -> Self {
        self.precompute.extend(other.precompute);
        self.frame.extend(other.frame);
        Self {
            wall_ms: self.wall_ms + other.wall_ms,
            ..self
        }
    }
}

/// Repeated times of the passes of a frame, or of the precompute passes.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TimingSamples {
    /// Milliseconds per round, by pass.
    pub passes: Vec<(&'static str, Vec<f64>)>,
    /// Host time of each round's submissions, ms.
    pub wall_ms: Vec<f64>,
}

impl TimingSamples {
    pub fn append(&mut self, more: Self) {
        for (pass, ms) in more.passes {
            match self.passes.iter_mut().find(|(known, _)| *known == pass) {
                Some((_, samples)) => samples.extend(ms),
                None => self.passes.push((pass, ms)),
            }
        }
        self.wall_ms.extend(more.wall_ms);
    }

    /// Time of the first round without the g-buffer, which all methods share, ms.
    pub fn method_ms(&self) -> f64 {
        let of_method = self.passes.iter().filter(|(pass, _)| *pass != GBUFFER_PASS);
        of_method.filter_map(|(_, ms)| ms.first()).sum()
    }

    pub(super) fn push(&mut self, round: &[PassTime], wall_ms: f64) {
        let passes = round
            .iter()
            .map(|time| (time.pass, vec![time.ms]))
            .collect();
        self.append(Self {
            passes,
            wall_ms: vec![wall_ms],
        });
    }
}
