//! The diffuse methods: what each is called, what changes its result, and its f64 twin.

mod fresnel_inside;
mod irradiance_map;
pub mod ladder_clamp;
mod none;
mod reference;
mod sh9;
pub mod sh9_windowed;
pub mod zh3;

use super::NONE;
use super::twin::DiffuseTwin;
use crate::precompute::sh9::Projection;
use crate::spelling::listed;

/// How the diffuse irradiance is computed. The names are the shader file stems (with `-` for `_`).
#[derive(Clone, Copy, Debug)]
pub struct Diffuse {
    pub name: &'static str,
    /// One sentence for `splitsum list`.
    pub about: &'static str,
    /// What the device tests hold its frames to.
    pub twin: DiffuseTwin,
    /// Whether the size and sample count of the irradiance map change its result.
    pub uses_irradiance_map: bool,
    /// By what the spherical-harmonic coefficients are made that it reads.
    pub sh9: Option<Projection>,
    /// Whether its error has the steps of a ladder (`crate::ladder`).
    pub has_ladder: bool,
    /// The integrand, where the passes of the reference estimate the term without bias: a file of `shaders/shade/lobe/`.
    pub lobe: Option<&'static str>,
}

/// Every diffuse method. Adding one: `shaders/shade/diffuse/<stem>.glsl`, its file here with its twin, and one line here.
pub static DIFFUSE: &[Diffuse] = &[
    sh9::DIFFUSE,
    sh9_windowed::DIFFUSE,
    zh3::DIFFUSE,
    irradiance_map::DIFFUSE,
    reference::DIFFUSE,
    fresnel_inside::DIFFUSE,
    ladder_clamp::DIFFUSE,
    none::DIFFUSE,
];

impl Diffuse {
    /// A method that looks nothing up. Each file sets its flags beside it; no method goes without a twin.
    const fn plain(name: &'static str, about: &'static str, twin: DiffuseTwin) -> Self {
        Self { name, about, twin, uses_irradiance_map: false, sh9: None, has_ladder: false, lobe: None }
    }

    /// Whether the passes of the reference estimate it: without bias, with a standard error.
    pub fn is_integrated(&self) -> bool {
        self.lobe.is_some()
    }

    /// Whether it leaves the term out.
    pub fn is_none(&self) -> bool {
        self.name == NONE
    }

    /// Whether a shader of its own makes the term: the reference has other passes.
    pub fn has_pass(&self) -> bool {
        !self.is_none() && !self.is_integrated()
    }
}

listed!(Diffuse, "diffuse method", DIFFUSE);
