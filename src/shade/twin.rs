//! The f64 twins of the methods: what they are given, and what a frame is held to.
//!
//! An estimator's twin computes the same sum from the same tables and the same points, so that only f32 and the filter of the device
//! part the two: a wrong level, weight or exponent shows at any sample count. A method that draws random points is held to the
//! mean of its estimator, within its standard error.

use super::reference::Surface;
use crate::environment::layout::FilteredMap;
use crate::math::equirect::uv_from_direction;
use crate::math::equirect_quadrature::EquirectQuadrature;
use crate::math::quadrature::{Bounded, Tolerance};
use crate::math::sequence::Sequence;
use crate::math::spherical_harmonics::COUNT;
use crate::pixels::Pixels;
use crate::pixels::lookup::{Wrap, trilinear};
use crate::precompute::PrecomputeSettings;
use crate::precompute::dfg::{self, Albedos};
use crate::precompute::prefilter::LevelMapping;
use glam::{DVec2, DVec3};

/// The f64 twin of a method.
#[derive(Clone, Copy, Debug)]
pub enum Twin<Estimator> {
    /// The same estimator.
    Estimator(Estimator),
    /// The mean of an unbiased estimator; of the settings only the widths of levels count.
    Mean(fn(&EquirectQuadrature, &Surface, &PrecomputeSettings, Tolerance) -> Bounded),
}

/// Outgoing specular radiance of a point, for environment radiance as stored.
pub type SpecularTwin = Twin<fn(&Surface, &Light, &Samples) -> DVec3>;

/// Irradiance over π at a unit normal in the environment's frame.
pub type DiffuseTwin = Twin<fn(DVec3, &Light) -> DVec3>;

/// The tables of one environment, model and masking, as the device reads them.
#[derive(Clone, Debug)]
pub struct Light {
    /// Radiance with its mips, as it came: finest level first.
    pub environment: Vec<Pixels<DVec3>>,
    /// Radiance by the layout.
    pub filtered: FilteredMap,
    /// Mean radiance of the lobe, smoothest level first.
    pub prefiltered: FilteredMap,
    /// Which roughness each of its levels holds.
    pub level_mapping: &'static LevelMapping,
    /// The DFG table: what scales f0, and what is added.
    pub dfg: Pixels<DVec2>,
    /// (A, B) by n·v, exact.
    pub albedos: Albedos,
    /// Irradiance over π.
    pub irradiance_map: FilteredMap,
    /// Coefficients of radiance.
    pub sh9: [DVec3; COUNT],
}

/// The points of a sampled method, and what moves the level of its lookups.
#[derive(Clone, Copy, Debug)]
pub struct Samples {
    pub count: u32,
    pub sequence: &'static Sequence,
    /// Which set of the sequence.
    pub set: u32,
    /// Levels added.
    pub lod_bias: f64,
}

impl Samples {
    /// The points in the unit square.
    pub fn points(&self) -> impl Iterator<Item = DVec2> {
        (0..self.count).map(|i| (self.sequence.point)(i, self.count, self.set))
    }
}

impl Light {
    /// Width and height of the environment's finest level.
    pub fn environment_size(&self) -> [u32; 2] {
        [self.environment[0].width, self.environment[0].height]
    }

    /// Radiance from a direction at a real level of the environment's own mips, which is clamped to the chain.
    pub fn radiance(&self, direction: DVec3, lod: f64) -> DVec3 {
        trilinear(&self.environment, uv_from_direction(direction), lod, Wrap::Equirect)
    }

    /// Mean radiance of the lobe of width `alpha` about `r`, from the prefiltered map.
    pub fn mean_radiance(&self, r: DVec3, alpha: f64) -> DVec3 {
        self.prefiltered.value(r, self.level_mapping.mip_from_alpha(alpha, self.prefiltered.levels.len() as u32))
    }

    /// (A, B) of the DFG table: the lobe reflects `f0 A + B` of constant radiance.
    pub fn dfg(&self, n_dot_v: f64, alpha: f64) -> DVec2 {
        dfg::lookup(&self.dfg, n_dot_v, alpha)
    }

    /// Irradiance over π from the irradiance map.
    pub fn irradiance_over_pi(&self, n: DVec3) -> DVec3 {
        self.irradiance_map.value(n, 0.0)
    }
}
