//! How a surface mixes its dielectric and its metal, if `metallic` is between 0 and 1.

use crate::base::names::listed;
use crate::instrument::brdf::Compensation;

/// What `metallic` m mixes. Both ways have the same specular term, since Schlick's Fresnel is linear
/// in F0; the diffuse terms differ.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum MetallicMix {
    /// F0: one lobe of `f0 = mix(f0_dielectric, albedo, m)`. The diffuse term `(1 - m) albedo` gets
    /// what this lobe does not reflect.
    #[default]
    F0,
    /// Two finished surfaces, `mix(dielectric_brdf, metal_brdf, m)` (glTF 2.0, appendix B.2): the
    /// diffuse term gets what the dielectric does not reflect, `(1 - m)(1 - (f0_dielectric A + B))
    /// albedo`.
    Brdf,
}

listed!(MetallicMix, "metallic mixture", { "f0": F0, "brdf": Brdf });

impl MetallicMix {
    /// Returns what this mixture does not support: with a compensation the specular term is not
    /// linear in F0.
    pub fn fault(self, compensation: Compensation) -> Option<&'static str> {
        let is_linear = compensation == Compensation::None;
        (self == Self::Brdf && !is_linear).then_some("a compensation")
    }
}
