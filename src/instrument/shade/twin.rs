//! The f64 twins of the methods, which frames are compared with, and their inputs.
//!
//! The twin of an estimator computes the same sum from the same tables and points: only f32 and the
//! device's filter differ, so a wrong level, weight or exponent shows at any sample count. A method
//! that draws random points is compared with the mean of its estimator, within its standard error.

use super::bend::Bend;
use super::reference::Surface;
use crate::base::math::equirect::uv_from_direction;
use crate::base::math::equirect_quadrature::EquirectQuadrature;
use crate::base::math::quadrature::{Bounded, Tolerance};
use crate::base::math::sequence::{Sequence, scrambled};
use crate::base::math::spherical_harmonics::COUNT;
use crate::base::pixels::Pixels;
use crate::base::pixels::lookup::{Wrap, trilinear};
use crate::instrument::brdf::reflect;
use crate::instrument::environment::layout::FilteredMap;
use crate::instrument::precompute::PrecomputeSettings;
use crate::instrument::precompute::dfg::{Albedos, DfgAxes};
use crate::instrument::precompute::prefilter::LevelMapping;
use crate::instrument::precompute::taps::{TapTable, dielectric_share};
use glam::{DVec2, DVec3};

/// The f64 twin of a method.
#[derive(Clone, Copy, Debug)]
pub enum Twin<Estimator> {
    /// The same estimator.
    Estimator(Estimator),
    /// The mean of an unbiased estimator. Only the level widths of the settings matter.
    Mean(fn(&EquirectQuadrature, &Surface, &PrecomputeSettings, Tolerance) -> Bounded),
}

/// Returns the outgoing specular radiance of a point, for environment radiance as stored.
pub type SpecularTwin = Twin<fn(&Surface, &Light, &Samples) -> DVec3>;

/// Returns irradiance over π at a unit normal in the environment's frame.
pub type DiffuseTwin = Twin<fn(DVec3, &Light) -> DVec3>;

/// The tables of one environment, model and masking, as the device reads them.
#[derive(Clone, Debug)]
pub struct Light {
    /// Radiance with its mips, finest level first, equirectangular.
    pub environment: Vec<Pixels<DVec3>>,
    /// Radiance in the layout.
    pub filtered: FilteredMap,
    /// Mean radiance of the lobe, smoothest level first.
    pub prefiltered: FilteredMap,
    pub level_mapping: &'static LevelMapping,
    /// (A, B) of the DFG table.
    pub dfg: Pixels<DVec2>,
    pub dfg_axes: DfgAxes,
    /// Exact (A, B) by n·v.
    pub albedos: Albedos,
    pub one_tap: TapTable,
    pub two_taps: TapTable,
    pub four_taps: TapTable,
    /// Irradiance over π.
    pub irradiance_map: FilteredMap,
    /// Coefficients of radiance as the device sums them.
    pub sh9: [DVec3; COUNT],
}

/// The points of a sampled method, the bias of its lookups, and the bend of `split-sum-bent`.
#[derive(Clone, Copy, Debug)]
pub struct Samples {
    pub count: u32,
    pub sequence: &'static Sequence,
    pub set: u32,
    /// The pixel that scrambles the set; `None` if pixels share it.
    pub pixel: Option<[u32; 2]>,
    pub lod_bias: f64,
    pub bend: &'static Bend,
}

impl Samples {
    /// Returns the points in the unit square.
    pub fn points(&self) -> impl Iterator<Item = DVec2> {
        (0..self.count).map(|i| {
            let point = (self.sequence.point)(i, self.count, self.set);
            self.pixel
                .map_or(point, |pixel| scrambled(point, pixel, self.set))
        })
    }
}

impl Light {
    /// Returns width and height of the environment's finest level.
    pub fn environment_size(&self) -> [u32; 2] {
        [self.environment[0].width, self.environment[0].height]
    }

    /// Returns the radiance from a direction at a level of the environment's own mips, clamped to
    /// the chain.
    pub fn radiance(&self, direction: DVec3, lod: f64) -> DVec3 {
        trilinear(
            &self.environment,
            uv_from_direction(direction),
            lod,
            Wrap::EQUIRECT,
            |texel| texel,
        )
    }

    /// Returns the mean radiance of the lobe of width `alpha` about `r`, from the prefiltered map.
    pub fn mean_radiance(&self, r: DVec3, alpha: f64) -> DVec3 {
        self.prefiltered.value(
            r,
            self.level_mapping
                .mip_from_alpha(alpha, self.prefiltered.levels.len() as u32),
        )
    }

    /// Returns (A, B) of the DFG table: the lobe reflects `f0 A + B` of constant radiance.
    pub fn dfg(&self, n_dot_v: f64, alpha: f64) -> DVec2 {
        self.dfg_axes.lookup(&self.dfg, n_dot_v, alpha)
    }

    /// Computes the split sum with a lookup of that direction and width: `P(direction, width) (f0 A
    /// + B)`.
    pub fn split_sum(&self, surface: &Surface, direction: DVec3, width: f64) -> DVec3 {
        let pair = self.dfg(surface.n.dot(surface.v), surface.alpha);
        self.mean_radiance(direction, width) * (surface.f0 * pair.x + pair.y)
    }

    /// Computes the split sum at alpha along `normalize(mix(n, r, t))`, with t by n·v and alpha.
    pub fn split_sum_between(&self, surface: &Surface, share_of_r: fn(f64, f64) -> f64) -> DVec3 {
        let Surface { n, v, alpha, .. } = *surface;
        self.split_sum(
            surface,
            n.lerp(reflect(v, n), share_of_r(n.dot(v), alpha))
                .normalize(),
            alpha,
        )
    }

    /// Sums the taps of a table; a colour counts by its mean.
    pub fn tapped_split_sum(&self, surface: &Surface, table: &TapTable) -> DVec3 {
        let Surface { n, v, alpha, .. } = *surface;
        let pair = self.dfg(n.dot(v), alpha);
        let dielectric = dielectric_share(surface.f0.element_sum() / 3.0, pair.to_array());
        let taps = table.taps(n.dot(v), alpha, dielectric).into_iter();
        let mean: DVec3 = taps
            .map(|[place, level, weight]| {
                weight
                    * self
                        .prefiltered
                        .value(n.lerp(reflect(v, n), place).normalize(), level)
            })
            .sum();
        mean.max(DVec3::ZERO) * (surface.f0 * pair.x + pair.y)
    }

    /// Returns the share of the reflected light that has the weight Fc.
    pub fn share_of_f90(&self, surface: &Surface) -> f64 {
        let pair = self.dfg(surface.n.dot(surface.v), surface.alpha);
        pair.y / (surface.f0.element_sum() / 3.0 * pair.x + pair.y)
    }

    pub fn irradiance_over_pi(&self, n: DVec3) -> DVec3 {
        self.irradiance_map.value(n, 0.0)
    }
}
