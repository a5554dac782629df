//! The diffuse methods: names, parameters, f64 twins.

mod fresnel_inside;
mod irradiance_map;
mod sh9;

use super::reference::integrate;
use super::twin::{DiffuseTwin, Twin};
use super::{NONE, REFERENCE};
use crate::base::names::listed;
use crate::instrument::precompute::sh9::Projection;
use glam::DVec3;

/// A way to compute the diffuse irradiance. Names are the stems of shader files (with `-` for `_`).
#[derive(Clone, Copy, Debug)]
pub struct Diffuse {
    pub name: &'static str,
    pub about: &'static str,
    /// Twin that device tests compare its frames with.
    pub twin: DiffuseTwin,
    /// Whether the size and sample count of the irradiance map change its result.
    pub uses_irradiance_map: bool,
    /// How texels count in the coefficients, if it reads them.
    pub sh9: Option<Projection>,
    /// Whether it reads the coefficients from a texture of their irradiance.
    pub uses_sh9_texture: bool,
    /// The integrand if the passes of the reference estimate the term without bias: a file of
    /// `shaders/shade/lobe/`.
    pub lobe: Option<&'static str>,
}

/// Every diffuse method. To add one: `shaders/shade/diffuse/<stem>.glsl`, its file here with its
/// twin, and a line here.
pub static DIFFUSE: &[Diffuse] = &[
    sh9::DIFFUSE,
    sh9::AT_CENTRES,
    sh9::TEXTURE,
    irradiance_map::DIFFUSE,
    INTEGRATED,
    fresnel_inside::DIFFUSE,
    Diffuse::plain(NONE, "no diffuse term", Twin::Estimator(|_, _| DVec3::ZERO)),
];

/// The unbiased estimator of irradiance, by many random samples of cosine and environment.
const INTEGRATED: Diffuse = Diffuse {
    lobe: Some("lambert"),
    ..Diffuse::plain(
        REFERENCE,
        "unbiased: cosine and environment sampling combined, many samples",
        Twin::Mean(|environment, surface, _, tolerance| {
            integrate(environment, surface, tolerance).diffuse
        }),
    )
};

impl Diffuse {
    /// A method without lookups. Each file sets its flags; every method has a twin.
    const fn plain(name: &'static str, about: &'static str, twin: DiffuseTwin) -> Self {
        Self {
            name,
            about,
            twin,
            uses_irradiance_map: false,
            sh9: None,
            uses_sh9_texture: false,
            lobe: None,
        }
    }
}

listed!(Diffuse, "diffuse method", DIFFUSE);
