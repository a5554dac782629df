//! Compensation of the light that single scattering loses between facets; twins of `shaders/lib/compensation.glsl`.
//!
//! Let (A, B) be the DFG pair at n·v, `E = A + B` the albedo for F = 1, `E_avg = 2 ∫ E μ dμ` its mean, and `F_avg = f0
//! + (1 - f0)/21` Schlick's mean. The specular term of albedo `f0 A + B` gets
//!
//! | | what | source |
//! |---|---|---|
//! | `turquin` | a factor `1 + f0 (1 - E)/E` | \[Turquin19\] |
//! | `fdez-aguera` | irradiance over π times `(1 - E) (f0 A + B) F_avg / (1 - F_avg (1 - E))` | \[FdezAguera19\] |
//! | `kulla-conty` | the lobe `(1 - E(l)) n·l / (π (1 - E_avg))` times `(1 - E(v)) F_avg² E_avg / (1 - F_avg (1 - E_avg))` | \[KullaConty17\], with the square of \[Hill18\] |
//!
//! At f0 = 1 each returns all lost light. The diffuse term gets the rest.

use crate::spelling::listed;
use glam::{DVec2, DVec3};

/// Kinds of compensation. The discriminants are `glsl::constants::COMPENSATION_*`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Compensation {
    #[default]
    None = 0,
    Turquin = 1,
    FdezAguera = 2,
    KullaConty = 3,
}

listed!(Compensation, "compensation", {
    "none": None,
    "turquin": Turquin,
    "fdez-aguera": FdezAguera,
    "kulla-conty": KullaConty,
});

impl Compensation {
    /// Whether a part of it is taken from irradiance.
    pub fn is_diffuse(self) -> bool {
        matches!(self, Self::FdezAguera | Self::KullaConty)
    }

    /// Returns the factor of single scattering.
    pub fn factor(self, f0: DVec3, pair: DVec2) -> DVec3 {
        let albedo = pair.element_sum();
        match self {
            Self::Turquin => 1.0 + f0 * ((1.0 - albedo) / albedo),
            _ => DVec3::ONE,
        }
    }

    /// Returns the added share of irradiance over π, or of the compensation's own lobe.
    pub fn multiple(self, f0: DVec3, pair: DVec2, mean_albedo: f64) -> DVec3 {
        // Fitted masking may reflect more than it receives: nothing is lost then.
        let lost = (1.0 - pair.element_sum()).max(0.0);
        let average = f0 + (1.0 - f0) / 21.0;
        match self {
            Self::FdezAguera => lost * (f0 * pair.x + pair.y) * average / (1.0 - average * lost),
            Self::KullaConty => lost * average * average * mean_albedo / (1.0 - average * (1.0 - mean_albedo).max(0.0)),
            _ => DVec3::ZERO,
        }
    }

    /// Returns the albedo of the whole specular term: its reflection of constant radiance 1.
    pub fn reflectance(self, f0: DVec3, pair: DVec2, mean_albedo: f64) -> DVec3 {
        (f0 * pair.x + pair.y) * self.factor(f0, pair) + self.multiple(f0, pair, mean_albedo)
    }
}
