//! Compensation of the light that single scattering loses between facets, in
//! `shaders/lib/compensation.glsl`.
//!
//! Let (A, B) be the DFG pair at n·v, `E = A + B` the albedo for F = 1, `E_avg = 2 ∫ E μ dμ` its
//! mean, and `F_avg` the mean of the reflectance, Schlick's `f0 + (1 - f0)/21` or the exact one of
//! an index ([`super::FresnelWeight::mean`]). The specular term of albedo `f0 A + B` gets
//!
//! | | what | source |
//! |---|---|---|
//! | `turquin` | a factor `1 + f0 (1 - E)/E` | \[Turquin19\] |
//! | `fdez-aguera` | irradiance over π times `(1 - E) (f0 A + B) F_avg / (1 - F_avg (1 - E))` | \[FdezAguera19\] |
//! | `kulla-conty` | the lobe `(1 - E(l)) n·l / (π (1 - E_avg))` times `(1 - E(v)) F_avg² E_avg / (1 - F_avg (1 - E_avg))` | \[KullaConty17\], with the square of \[Hill18\] |
//! | `cycles` | a factor `1 + (1 - E)/E F_avg E_avg / (1 - F_avg (1 - E_avg))` | `microfacet_ggx_preserve_energy` of Blender's Cycles 5.2, on \[KullaConty17\]; not squared |
//!
//! At f0 = 1 each returns all lost light. The diffuse term gets the rest.

use crate::base::names::listed;

/// Kinds of compensation. The discriminants are `glsl::constants::COMPENSATION_*`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Compensation {
    #[default]
    None = 0,
    Turquin = 1,
    FdezAguera = 2,
    KullaConty = 3,
    Cycles = 4,
}

listed!(Compensation, "compensation", {
    "none": None,
    "turquin": Turquin,
    "fdez-aguera": FdezAguera,
    "kulla-conty": KullaConty,
    "cycles": Cycles,
});

impl Compensation {
    /// Whether a part of it is taken from irradiance.
    pub fn is_diffuse(self) -> bool {
        matches!(self, Self::FdezAguera | Self::KullaConty)
    }
}
