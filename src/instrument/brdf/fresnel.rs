//! Fresnel reflectance, with c the cosine between the view and the half vector.
//!
//! Both kinds are `f0 + (1 - f0) w(c)` with a weight w from 0 at c = 1 to 1 at c = 0, so that every
//! integral and table is linear in f0:
//!
//! - `schlick`: `w = (1 - c)⁵` \[Schlick94, eq. 15\];
//! - `exact`: `w = (F(c) - f0)/(1 - f0)` for the unpolarised reflectance F of a dielectric of index n
//!   in air, `f0 = ((n - 1)/(n + 1))²`. With `g = √(n² - 1 + c²)` it is
//!   `F = ½ ((g - c)/(g + c))² (1 + ((c (g + c) - 1)/(c (g - c) + 1))²)` \[Walter07, eq. 22\].

use super::ior_from_f0;
use crate::base::glsl::constants::FRESNEL_SCHLICK;
use crate::base::names::listed;

/// Whose reflectance dielectrics have.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Fresnel {
    #[default]
    Schlick,
    Exact,
}

listed!(Fresnel, "Fresnel reflectance", { "schlick": Schlick, "exact": Exact });

/// The weight w of f90 = 1.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum FresnelWeight {
    #[default]
    Schlick,
    /// Of a dielectric of this F0, in [0, 1).
    Dielectric { f0: f64 },
}

impl FresnelWeight {
    /// Returns the weight that the specialization constant `fresnel_f0` selects.
    pub fn of_constant(fresnel_f0: f32) -> Self {
        if fresnel_f0 == FRESNEL_SCHLICK {
            Self::Schlick
        } else {
            Self::Dielectric {
                f0: fresnel_f0.into(),
            }
        }
    }

    /// Returns the mean `2 ∫ w(μ) μ dμ` over cosines. With it `F_avg = f0 + (1 - f0) mean`.
    pub fn mean(self) -> f64 {
        match self {
            Self::Schlick => 1.0 / 21.0,
            Self::Dielectric { f0 } => (mean_of_dielectric(ior_from_f0(f0)) - f0) / (1.0 - f0),
        }
    }

    /// Returns w for a cosine, clamped to [0, 1].
    pub fn at(self, v_dot_h: f64) -> f64 {
        match self {
            Self::Schlick => schlick_weight(v_dot_h),
            Self::Dielectric { f0 } => {
                let reflected = f_dielectric(ior_from_f0(f0), v_dot_h.clamp(0.0, 1.0));
                (reflected - f0) / (1.0 - f0)
            }
        }
    }
}

/// Returns Schlick's `(1 - v·h)⁵`, the weight of `f90 = 1`.
pub fn schlick_weight(v_dot_h: f64) -> f64 {
    (1.0 - v_dot_h).clamp(0.0, 1.0).powi(5)
}

/// Returns the unpolarised reflectance of a dielectric of index `ior`, at least 1, in air.
/// \[Walter07, eq. 22\]
pub fn f_dielectric(ior: f64, v_dot_h: f64) -> f64 {
    let c = v_dot_h;
    let g = (ior * ior - 1.0 + c * c).sqrt();
    if g + c == 0.0 {
        // An index of 1 at a grazing angle: both limits are 1.
        return 1.0;
    }
    let across = ((g - c) / (g + c)).powi(2);
    let along = ((c * (g + c) - 1.0) / (c * (g - c) + 1.0)).powi(2);
    0.5 * across * (1.0 + along)
}

/// Returns the mean `2 ∫ F(μ) μ dμ` of [`f_dielectric`] over cosines: what a dielectric reflects of
/// diffuse light. \[Duntley42\]
fn mean_of_dielectric(ior: f64) -> f64 {
    if ior == 1.0 {
        return 0.0;
    }
    let n = ior;
    let n2 = n * n;
    let [sum, difference] = [n2 + 1.0, n2 * n2 - 1.0];
    0.5 + (n - 1.0) * (3.0 * n + 1.0) / (6.0 * (n + 1.0).powi(2))
        + n2 * (n2 - 1.0).powi(2) / sum.powi(3) * ((n - 1.0) / (n + 1.0)).ln()
        - 2.0 * n * n2 * (n2 + 2.0 * n - 1.0) / (sum * difference)
        + 8.0 * n2 * n2 * (n2 * n2 + 1.0) / (sum * difference.powi(2)) * n.ln()
}
