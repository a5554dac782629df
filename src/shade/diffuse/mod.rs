//! The diffuse methods: what each is called, what changes its result, and its f64 twin.

mod irradiance_map;
mod none;
mod reference;
mod sh9;

use super::twin::DiffuseTwin;
use super::{NONE, REFERENCE};

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
    /// Whether it reads the spherical-harmonic coefficients.
    pub uses_sh9: bool,
}

/// Every diffuse method. Adding one: `shaders/shade/diffuse/<stem>.glsl`, its file here with its twin, and one line here.
pub static DIFFUSE: &[Diffuse] = &[sh9::DIFFUSE, irradiance_map::DIFFUSE, reference::DIFFUSE, none::DIFFUSE];

impl Diffuse {
    /// Whether it is the unbiased one.
    pub fn is_reference(&self) -> bool {
        self.name == REFERENCE
    }

    /// Whether it leaves the term out.
    pub fn is_none(&self) -> bool {
        self.name == NONE
    }

    /// Whether a shader of its own makes the term: the reference has other passes.
    pub fn has_pass(&self) -> bool {
        !self.is_none() && !self.is_reference()
    }
}

/// The diffuse method of that name.
pub fn diffuse_by_name(name: &str) -> Option<&'static Diffuse> {
    DIFFUSE.iter().find(|diffuse| diffuse.name == name)
}
