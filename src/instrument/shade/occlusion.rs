//! Ambient occlusion: the share of the image-based light that the surroundings of a point let
//! through, from a map of the material.
//!
//! The diffuse term is multiplied by it. Source document 1 multiplies the specular term too; engines
//! derive a factor for it from n·v and alpha. The factors multiply the method's image and the
//! reference's alike, so they add no error of their own. A map says nothing about directions, so
//! none of them is exact.

use crate::base::glsl::constants as code;
use crate::base::names::listed;

/// How the specular term of a surface is occluded; 1 without occlusion.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[repr(u32)]
pub enum SpecularOcclusion {
    /// By the map's value, as source document 1 prints it.
    #[default]
    Ao = code::SPECULAR_OCCLUSION_AO,
    /// Not at all, as in renderers that occlude the diffuse term alone.
    None = code::SPECULAR_OCCLUSION_NONE,
    /// `saturate((n·v + ao)^(2^(-16 alpha - 1)) - 1 + ao)` [Lagarde14, listing 26].
    Lagarde = code::SPECULAR_OCCLUSION_LAGARDE,
    /// The part of a cone about the mirror direction that a cone about the normal lets through
    /// \[Jimenez16\]. See [`cone`].
    Cone = code::SPECULAR_OCCLUSION_CONE,
}

listed!(SpecularOcclusion, "specular occlusion", {
    "ao": Ao,
    "none": None,
    "lagarde": Lagarde,
    "cone": Cone,
});

impl SpecularOcclusion {
    /// Returns the factor of the specular term, in [0, 1], for an occlusion `ao` in [0, 1] (1 lets
    /// all light through) and a cosine and width in (0, 1].
    pub fn factor(self, ao: f64, n_dot_v: f64, alpha: f64) -> f64 {
        match self {
            Self::Ao => ao,
            Self::None => 1.0,
            Self::Lagarde => lagarde(ao, n_dot_v, alpha),
            Self::Cone => cone(ao, n_dot_v, alpha),
        }
    }
}

fn lagarde(ao: f64, n_dot_v: f64, alpha: f64) -> f64 {
    let exponent = (-16.0 * alpha - 1.0).exp2();
    ((n_dot_v + ao).powf(exponent) - 1.0 + ao).clamp(0.0, 1.0)
}

/// Both cones' common solid angle, over that at `ao = 1`: what the surface hides of the lobe is in
/// the BRDF already. A visible cone with `sin² = ao` has the cosine-weighted occlusion `ao`; the
/// lobe's has the cosine `10^(-alpha²)` \[Jimenez16\].
fn cone(ao: f64, n_dot_v: f64, alpha: f64) -> f64 {
    let lobe = 10f64.powf(-alpha * alpha).acos();
    let visible = |ao: f64| (1.0 - ao).sqrt().acos();
    let mirror = n_dot_v.acos();
    let whole = common_solid_angle(visible(1.0), lobe, mirror);
    common_solid_angle(visible(ao), lobe, mirror) / whole
}

/// Solid angle that two cones of half angles `a` and `b` have in common, their axes `apart`, by the
/// cubic of [OatSander07].
fn common_solid_angle(a: f64, b: f64, apart: f64) -> f64 {
    let [small, large] = [a.min(b), a.max(b)];
    let smaller_cone = std::f64::consts::TAU * (1.0 - small.cos());
    if apart <= large - small {
        return smaller_cone;
    }
    if apart >= large + small {
        return 0.0;
    }
    let x = 1.0 - (apart - (large - small)) / (2.0 * small);
    smaller_cone * x * x * (3.0 - 2.0 * x)
}

#[cfg(test)]
mod tests;
