//! What is asked of the pipeline and what it answers.

use super::antialias::POINTS_PER_SIDE;
use crate::bakes::given::Given;
use crate::brdf::{Brdf, Compensation, Ggx, MaskingShadowing};
use crate::environment::{Environment, Placement};
use crate::gpu::PassTime;
use crate::math::sequence::{PixelPoints, SEQUENCES, Sequence};
use crate::metrics::Epsilon;
use crate::pixels::{GrayImage, RgbImage};
use crate::precompute::{PrecomputeSettings, PrefilterBy};
use crate::scene::{Camera, CameraKind, Light, Scene};
use crate::shade::reference_pass::{Convergence, Levels, Lobe, Stop};
use crate::shade::{Diffuse, Method, NONE, diffuse_by_name, method_by_name};
use std::sync::Arc;

/// Everything that determines one radiance image.
#[derive(Clone, Debug)]
pub struct RenderRequest {
    pub environment: Arc<Environment>,
    pub placement: Placement,
    /// Multiplies the environment's radiance.
    pub environment_scale: f32,
    pub scene: Arc<Scene>,
    pub camera: Camera,
    pub size: [u32; 2],
    pub method: &'static Method,
    pub diffuse: &'static Diffuse,
    pub brdf: &'static dyn Brdf,
    pub masking_shadowing: MaskingShadowing,
    /// What gives back the light of several scatterings.
    pub compensation: Compensation,
    /// Samples a pixel of a sampled method.
    pub samples: u32,
    /// Where a sampled method takes its points from.
    pub sequence: &'static Sequence,
    /// Which set of the sequence: 0 the plain one, k > 0 randomised copies.
    pub point_set: u32,
    /// How a pixel comes by the points of that set.
    pub pixel_points: PixelPoints,
    /// Samples a pixel of the reference, wherever it is the method or the diffuse term.
    pub reference_samples: u32,
    /// Stops the reference earlier, once the relative standard error of each of its terms is at most this.
    pub reference_error: Option<f64>,
    /// Levels added to the mip level of a filtered method.
    pub lod_bias: f32,
    pub lights: Vec<Light>,
    /// Shows the environment where nothing is hit.
    pub background: bool,
    /// Antialiases edges; pixels on them leave the mask. Without effect on the scene `design`.
    pub antialias: bool,
    pub precompute: PrecomputeSettings,
    /// Tables of other tools; sizes, levels and mapping in `precompute` are theirs.
    pub given: Given,
    /// Seeds the scrambles of the reference.
    pub seed: u32,
}

impl RenderRequest {
    /// A view of `scene` under `environment` as they are: GGX, split sum, no diffuse term, default tables.
    ///
    /// A sphere by the split sum, and how far it is from the reference:
    ///
    /// ```
    /// use splitsum::environment::{Environment, LoadOptions};
    /// use splitsum::pipeline::{Options, Pipeline, RenderRequest};
    /// use splitsum::scene::{CameraKind, Scene};
    /// use splitsum::shade::method_by_name;
    /// use std::{path::Path, sync::Arc};
    ///
    /// # fn main() -> Result<(), Box<dyn std::error::Error>> {
    /// let light = Environment::load("builtin:studio", Path::new("."), &LoadOptions::default())?;
    /// let request = RenderRequest::plain(Arc::new(light), Scene::sphere(), CameraKind::Ortho, [32, 32]);
    /// // Without a Vulkan device there is nothing to show.
    /// let Ok(mut pipeline) = Pipeline::new(Options::default()) else { return Ok(()) };
    /// let image = pipeline.render(&request)?;
    /// let method = method_by_name("reference").expect("a listed method");
    /// let reference = pipeline.render(&RenderRequest { method, ..request })?;
    /// let [own, exact] = [&image, &reference].map(|frame| frame.radiance.get(16, 16)[1]);
    /// assert!(own > 0.0 && own != exact, "{own} for {exact}");
    /// # Ok(())
    /// # }
    /// ```
    pub fn plain(environment: Arc<Environment>, scene: Scene, kind: CameraKind, size: [u32; 2]) -> Self {
        Self {
            environment,
            placement: Placement::default(),
            environment_scale: 1.0,
            camera: Camera::for_scene(kind, &scene, size),
            scene: Arc::new(scene),
            size,
            method: method_by_name("split-sum").expect("a listed method"),
            diffuse: diffuse_by_name(NONE).expect("a listed diffuse method"),
            brdf: &Ggx,
            masking_shadowing: MaskingShadowing::default(),
            compensation: Compensation::default(),
            samples: 64,
            sequence: &SEQUENCES[0],
            point_set: 0,
            pixel_points: PixelPoints::default(),
            reference_samples: 1024,
            reference_error: None,
            lod_bias: 0.0,
            lights: Vec::new(),
            background: false,
            antialias: false,
            precompute: PrecomputeSettings::default(),
            given: Given::default(),
            seed: 1,
        }
    }

    /// Whether edges are antialiased: the pixels of the scene `design` have none.
    pub(super) fn is_antialiased(&self) -> bool {
        self.antialias && !self.scene.is_design
    }

    /// The request whose g-buffer has the points by which edges are found.
    pub(super) fn points_of_pixels(&self) -> Self {
        Self { size: self.size.map(|side| side * POINTS_PER_SIDE), antialias: false, ..self.clone() }
    }

    /// The terms that are taken from the reference, specular first.
    pub(super) fn reference_lobes(&self) -> Vec<Lobe> {
        let levels = Levels { mapping: self.precompute.level_mapping, weight: self.precompute.prefilter_weight };
        let (brdf, masking) = (self.brdf, self.masking_shadowing);
        let specular = self.method.lobe.map(|lobe| Lobe::Specular { lobe, brdf, masking, levels });
        specular.into_iter().chain(self.diffuse.lobe.map(|lobe| Lobe::Diffuse { lobe })).collect()
    }

    /// The settings of the tables that are made.
    pub fn tables(&self) -> PrecomputeSettings {
        self.method.tables(self.precompute)
    }

    /// That of relative errors under this light.
    pub fn epsilon(&self) -> Epsilon {
        Epsilon::of_light(self.environment.luminance.mean * f64::from(self.environment_scale))
    }

    /// When the reference stops.
    pub(super) fn reference_stop(&self) -> Stop {
        Stop { sample_count: self.reference_samples, relative_error: self.reference_error }
    }

    /// Whether the environment's filtered levels reach the frame, by themselves or by a map that is made of them.
    pub fn reads_filtered_levels(&self) -> bool {
        let is_integrated = self.diffuse.uses_irradiance_map && self.tables().prefilter == PrefilterBy::Sampled;
        self.method.uses_lod_bias || self.method.uses_prefiltered() || is_integrated
    }

    /// Whether a frame reads the DFG table.
    pub fn needs_dfg(&self) -> bool {
        self.method.needs_dfg(self.compensation, self.diffuse, !self.lights.is_empty())
    }

    /// Whether a term comes from the reference: then the frame has a standard error.
    pub fn has_reference_term(&self) -> bool {
        self.method.is_integrated() || self.diffuse.is_integrated()
    }
}

/// One rendered radiance image and what belongs to it.
#[derive(Clone, Debug)]
pub struct Frame {
    /// Linear radiance; 0 where nothing is hit, unless the background was asked for.
    pub radiance: RgbImage,
    /// Standard error of the mean per pixel and channel; only the reference has one.
    pub standard_error: Option<RgbImage>,
    /// Where each term of the reference stopped.
    pub convergences: Vec<Convergence>,
    /// 1 where a surface is hit.
    pub mask: Arc<GrayImage>,
    /// Cosine between normal and view; 0 where nothing is hit.
    pub n_dot_v: Arc<GrayImage>,
    pub timings: FrameTimings,
}

impl Frame {
    /// Memory that it holds alone, bytes.
    pub fn bytes(&self) -> u64 {
        let images = [Some(&self.radiance), self.standard_error.as_ref()];
        images.into_iter().flatten().map(|image| size_of_val(&image.data[..]) as u64).sum()
    }
}

/// Device times of one frame.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FrameTimings {
    /// Precompute passes that ran for this frame: `mips`, `sh9`, `irradiance`, `prefilter`, `dfg`. Empty when all tables were there already.
    pub precompute: Vec<PassTime>,
    /// Per-frame passes: `gbuffer`, `shade-specular`, `shade-diffuse`, `shade-lights`, `background`, `tonemap`.
    pub frame: Vec<PassTime>,
    /// Host time of the submissions that `frame` sums over, ms.
    pub wall_ms: f64,
}

/// Repeated times of the passes of a frame, or of the precompute passes.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TimingSamples {
    /// Milliseconds of each round by pass.
    pub passes: Vec<(&'static str, Vec<f64>)>,
    /// Host time of each round's submissions, ms.
    pub wall_ms: Vec<f64>,
}

impl TimingSamples {
    /// Adds the rounds of `more` after those that are there.
    pub fn append(&mut self, more: Self) {
        for (pass, ms) in more.passes {
            match self.passes.iter_mut().find(|(known, _)| *known == pass) {
                Some((_, samples)) => samples.extend(ms),
                None => self.passes.push((pass, ms)),
            }
        }
        self.wall_ms.extend(more.wall_ms);
    }

    /// Adds one round.
    pub(super) fn push(&mut self, round: &[PassTime], wall_ms: f64) {
        let passes = round.iter().map(|time| (time.pass, vec![time.ms])).collect();
        self.append(Self { passes, wall_ms: vec![wall_ms] });
    }
}
