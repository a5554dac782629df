//! Cached results of the pipeline, and the part that a request gets.

use super::antialias::Edges;
use super::cache::Recent;
use super::fit::image_buffer_bytes;
use super::shared_work::Levels;
use super::{PipelineError, RenderRequest};
use crate::base::math::harmonics::Harmonics;
use crate::base::math::sequence::PixelPoints;
use crate::base::pixels::GrayImage;
use crate::instrument::brdf::MaskingShadowing;
use crate::instrument::environment::Environment;
use crate::instrument::gbuffer::pass::{GbufferImages, SceneData};
use crate::instrument::gpu::{Buffer, Format, Gpu, GpuError, Image, Report};
use crate::instrument::ladder::radiance::Radiance;
use crate::instrument::precompute::dfg::Albedos;
use crate::instrument::precompute::points::Points;
use crate::instrument::precompute::prefilter::{Kernel, harmonic};
use crate::instrument::scene::{Camera, Scene};
use crate::instrument::shade::layer_pass::LayerAlbedos;
use crate::instrument::shade::pass::Tables;
use crate::instrument::shade::reference_pass::{DistributionBuffers, Lobe, Sums};
use std::collections::BTreeSet;
use std::convert::Infallible;
use std::sync::{Arc, OnceLock};

pub(super) struct Shelves {
    /// Radiance with its mips.
    pub(super) environments: Recent<String, Levels>,
    /// Radiance in another layout.
    pub(super) filtered: Recent<String, Levels>,
    pub(super) coefficients: Recent<String, Buffer>,
    pub(super) irradiance_maps: Recent<String, Levels>,
    pub(super) prefiltered: Recent<String, Levels>,
    /// Spherical harmonics of environments, by degree.
    pub(super) harmonics: Recent<String, Arc<Harmonics>>,
    pub(super) dfg_tables: Recent<String, Levels>,
    pub(super) tap_tables: Recent<String, Levels>,
    /// Copies in half precision.
    pub(super) halves: Recent<String, Image>,
}

impl Shelves {
    pub(super) fn new() -> Self {
        Self {
            environments: Recent::weighed(2, Levels::bytes),
            filtered: Recent::weighed(2, Levels::bytes),
            coefficients: Recent::new(8),
            irradiance_maps: Recent::weighed(4, Levels::bytes),
            prefiltered: Recent::weighed(6, Levels::bytes),
            harmonics: Recent::new(2),
            dfg_tables: Recent::weighed(9, Levels::bytes),
            tap_tables: Recent::new(9),
            halves: Recent::weighed(9, Image::bytes),
        }
    }
}

/// What determines the points of a dispatch.
#[derive(PartialEq)]
pub(super) struct PointKey {
    pub(super) count: u32,
    /// Name of the sequence.
    pub(super) sequence: &'static str,
    pub(super) set: u32,
    pub(super) pixel_points: PixelPoints,
}

/// What determines the targets and edges of a view.
#[derive(Clone, PartialEq)]
pub(super) struct ViewKey {
    /// Hash of the scene.
    pub(super) scene: String,
    pub(super) camera: Camera,
    pub(super) size: [u32; 2],
}

impl ViewKey {
    pub(super) fn new(request: &RenderRequest) -> Self {
        Self {
            scene: request.scene.hash.clone(),
            camera: request.camera,
            size: request.size,
        }
    }
}

pub(super) struct Resources {
    pub(super) tables: Shelves,
    pub(super) distributions: Recent<String, DistributionBuffers>,
    pub(super) points: Recent<PointKey, Points>,
    /// Radiance of coalitions, as far as f0 does not matter.
    pub(super) steps: Recent<String, Arc<Radiance>>,
    /// Independent of the light.
    pub(super) albedos: Recent<String, Arc<Albedos>>,
    pub(super) layer_albedos: Recent<String, LayerAlbedos>,
    pub(super) scenes: Recent<String, Arc<SceneData>>,
    /// [`Scene::tangents`] by the scene.
    pub(super) tangents: Recent<String, Arc<Scene>>,
    pub(super) targets: Recent<ViewKey, Arc<Target>>,
    pub(super) edges: Recent<ViewKey, Arc<Edges>>,
    /// Bound in place of tables that a request does not use.
    pub(super) blank_image: Image,
    pub(super) blank_cube: Image,
    pub(super) blank_buffer: Buffer,
}

pub(super) struct ReferenceData {
    pub(super) distribution: DistributionBuffers,
    pub(super) sums: Sums,
    /// A vec4 per pixel.
    pub(super) squared_error: Buffer,
}

/// Targets of a view of a scene.
pub(super) struct Target {
    pub(super) gbuffer: GbufferImages,
    /// The shaders that drew the g-buffer.
    pub(super) shaders: BTreeSet<String>,
    /// A vec4 per pixel.
    pub(super) radiance: Buffer,
    pub(super) camera: Camera,
    /// Read when it is first asked for: pictures that stay on the device need none.
    pub(super) coverage: OnceLock<Coverage>,
}

/// Where the surfaces of a view are.
#[derive(Clone)]
pub(super) struct Coverage {
    pub(super) mask: Arc<GrayImage>,
    pub(super) n_dot_v: Arc<GrayImage>,
}

impl Target {
    pub(super) fn coverage(&self, gpu: &Gpu) -> Result<Coverage, GpuError> {
        if let Some(known) = self.coverage.get() {
            return Ok(known.clone());
        }
        let surfaces = self.gbuffer.read_surfaces(gpu)?;
        let read = Coverage {
            mask: Arc::new(surfaces.mask()),
            n_dot_v: Arc::new(surfaces.n_dot_v(&self.camera)),
        };
        Ok(self.coverage.get_or_init(|| read).clone())
    }

    fn bytes(&self) -> u64 {
        // Four attachments, depth and radiance; mask and n·v on the host.
        image_buffer_bytes(self.gbuffer.size) * 6
    }
}

/// All that one request shades with.
pub(super) struct Prepared {
    pub(super) tables: Tables,
    pub(super) scene: Arc<SceneData>,
    pub(super) target: Arc<Target>,
    /// The g-buffer of [`Scene::tangents`], if lobes have two widths.
    pub(super) tangents: Option<Arc<Target>>,
    /// Times of the precompute passes that ran for this request.
    pub(super) precompute: Report,
    pub(super) samples_per_pixel: u32,
    /// Present if a term is a reference.
    pub(super) reference: Option<ReferenceData>,
    /// The reference terms, specular first.
    pub(super) lobes: Vec<Lobe>,
}

impl Resources {
    pub(super) fn new(gpu: &Gpu) -> Result<Self, PipelineError> {
        Ok(Self {
            tables: Shelves::new(),
            distributions: Recent::new(2),
            points: Recent::new(16),
            steps: Recent::new(6),
            albedos: Recent::new(32),
            layer_albedos: Recent::new(8),
            scenes: Recent::new(4),
            tangents: Recent::new(2),
            targets: Recent::weighed(4, |target: &Arc<Target>| target.bytes()),
            edges: Recent::weighed(16, |edges: &Arc<Edges>| edges.bytes()),
            blank_image: gpu.image("blank", [1, 1], 1, Format::Rgba32Float)?,
            blank_cube: gpu.faced_image("blank cube", [1, 1], 6, 1, Format::Rgba32Float)?,
            blank_buffer: gpu.buffer("blank", 256)?,
        })
    }

    /// Returns exact (A, B) of a lobe by n·v.
    pub(super) fn albedos_of(
        &mut self,
        kernel: Kernel,
        masking: MaskingShadowing,
        alpha: f64,
    ) -> Arc<Albedos> {
        let key = format!(
            "{} {} {masking:?} {alpha}",
            kernel.brdf.name(),
            kernel.weight.name
        );
        let make = || Ok::<_, Infallible>(Arc::new(Albedos::new(kernel, masking, alpha)));
        let Ok(albedos) = self.albedos.get_or_make(key, make);
        albedos
    }

    /// Frees everything that can be made again and takes device memory.
    pub(super) fn forget_all(&mut self) {
        self.tables = Shelves::new();
        self.distributions.clear();
        self.points.clear();
        self.steps.clear();
        self.layer_albedos.clear();
        self.scenes.clear();
        self.targets.clear();
        self.edges.clear();
    }
}

/// Returns the coefficients of an environment up to a degree.
pub(super) fn harmonics(
    known: &mut Recent<String, Arc<Harmonics>>,
    environment: &Environment,
    degree: usize,
) -> Result<Arc<Harmonics>, GpuError> {
    let name = format!("{} {degree}", environment.hash);
    known.get_or_make(name, || {
        Ok(Arc::new(harmonic::harmonics(&environment.image, degree)))
    })
}
