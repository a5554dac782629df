//! The radiance of every coalition of a diffuse term's steps.
//!
//! With E the irradiance, c the albedo and `f0 A + B` the directional albedo of the specular lobe, the outgoing
//! radiance is `c T E / π`:
//!
//! - T is the share of irradiance that enters the surface. Exactly, it is `∫ (1 - F(v·h)) n·l L dl / ∫ n·l L dl`, so
//!   that the empty coalition's radiance is the diffuse integral. With Fresnel approximated it is `1 - (f0 A + B)`,
//!   with A and B by quadrature or from the table. Without a specular term it is 1.
//! - E is exact, or approximated by the coalition's other steps ([`Irradiance`]).
//!
//! Nothing is drawn: both integrals are known within 1e-5.

use super::FRESNEL;
use super::game::Coalition;
use crate::environment::layout::FilteredMap;
use crate::math::equirect_quadrature::EquirectQuadrature;
use crate::math::spherical_harmonics::{COUNT, irradiance};
use crate::shade::reference::{TOLERANCE, diffuse};
use glam::{DVec2, DVec3};
use rayon::prelude::*;
use std::f64::consts::PI;
use std::sync::Arc;

/// Steps of the irradiance, by position in either ladder.
const FIRST: usize = 1;
const SECOND: usize = 2;
const THIRD: usize = 3;
const TABLE: usize = 4;

pub enum Irradiance {
    /// Nine coefficients: exact, and as the device sums them.
    Sh9(Box<[[DVec3; COUNT]; 2]>),
    /// Maps of irradiance over π, exact and as the device makes them; each in f32 and as stored.
    Map([[FilteredMap; 2]; 2]),
}

/// `∫ n·l L dl / π` and `∫ Fc n·l L dl / π` of a pixel, `Fc = (1 - v·h)⁵`.
pub type Integrals = [DVec3; 2];

pub struct Radiance<'a> {
    /// Normal and view of each pixel in the environment's frame.
    pub frames: &'a [[DVec3; 2]],
    pub exact: Arc<Vec<Integrals>>,
    pub irradiance: Irradiance,
    /// (A, B) by pixel, exact and from the table; `None` without a specular term.
    pub albedos: Option<[Vec<DVec2>; 2]>,
    pub f0: DVec3,
    /// Albedo times the factor of the environment's radiance.
    pub scale: DVec3,
}

/// Computes the integrals of each pixel.
pub fn integrals(environment: &EquirectQuadrature, frames: &[[DVec3; 2]]) -> Vec<Integrals> {
    frames.par_iter().map(|[n, v]| diffuse(environment, *n, *v, TOLERANCE).value).collect()
}

impl Radiance<'_> {
    /// Returns the radiance of a feasible coalition by pixel.
    pub fn of(&self, coalition: Coalition) -> Vec<DVec3> {
        let acts = |step: usize| coalition >> step & 1 == 1;
        let entering = |pixel: usize| {
            let Some(albedos) = &self.albedos else { return DVec3::ONE };
            let ([whole, grazing], pair) = (self.exact[pixel], albedos[usize::from(acts(TABLE))][pixel]);
            match acts(FRESNEL) {
                true => 1.0 - (self.f0 * pair.x + pair.y),
                // 1 - F = (1 - f0) (1 - Fc).
                false => (1.0 - self.f0) * (whole - grazing) / whole,
            }
        };
        let irradiance_over_pi = |pixel: usize| {
            let ([n, _], [second, third]) = (self.frames[pixel], [SECOND, THIRD].map(|step| usize::from(acts(step))));
            match &self.irradiance {
                _ if !acts(FIRST) => self.exact[pixel][0],
                Irradiance::Sh9(coefficients) => {
                    let value = irradiance(&coefficients[third], n) / PI;
                    if second == 1 { value.max(DVec3::ZERO) } else { value }
                }
                Irradiance::Map(maps) => maps[second][third].value(n, 0.0),
            }
        };
        let of_pixel = |pixel| self.scale * entering(pixel) * irradiance_over_pi(pixel);
        (0..self.frames.len()).map(of_pixel).collect()
    }
}
