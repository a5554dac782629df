//! Lobes of two widths, along a tangent and across it: the twins of `shaders/lib/widths.glsl`.
//!
//! Local vectors have the tangent along +x. Slopes stretched by (x, y) have the distribution of
//! width 1 at the half vector `(h.x/x, h.y/y, h.z)/q`, q its length before: `D = D_1 / (x y q⁴)`.
//! Their masking has the one width along the azimuth of the direction \[Heitz14\]. GGX and Beckmann
//! allow it; Phong's slopes change their shape with the width.

use super::{Brdf, MODELS, MaskingShadowing, g1, g2_from_g1};
use crate::base::glsl::constants::{
    ALPHA_MIN, ANISOTROPY_DISNEY, ANISOTROPY_GLTF, ANISOTROPY_KULLA, ANISOTROPY_OPENPBR,
};
use crate::base::names::listed;
use glam::{DVec2, DVec3};

/// How alpha and a strength s in [0, 1] make the widths (along the tangent, across it), each
/// clamped to [`ALPHA_MIN`] to 1.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[repr(u32)]
pub enum WidthLaw {
    /// `(mix(alpha, 1, s²), alpha)` \[KhrAnisotropy23\]: keeps the narrow width.
    #[default]
    Gltf = ANISOTROPY_GLTF,
    /// `alpha (1 + s, 1 - s)` \[KullaConty17\], as Filament and Unity: keeps the mean.
    Kulla = ANISOTROPY_KULLA,
    /// `alpha (1/k, k)`, `k = √(1 - 0.9 s)` \[Burley12\], as Godot: keeps the geometric mean.
    Disney = ANISOTROPY_DISNEY,
    /// `alpha √(2/(1 + (1 - s)²)) (1, 1 - s)` of OpenPBR 1.1: keeps the mean square.
    OpenPbr = ANISOTROPY_OPENPBR,
}

listed!(WidthLaw, "law of widths", {
    "gltf": Gltf,
    "kulla": Kulla,
    "disney": Disney,
    "openpbr": OpenPbr,
});

/// The models whose lobes may have two widths.
pub fn stretchable() -> impl Iterator<Item = &'static dyn Brdf> + Clone {
    let models = MODELS.iter().copied();
    models.filter(|model| model.is_stretchable())
}

impl WidthLaw {
    /// Returns why lobes of that model and masking have one width only; `None` if they may have
    /// two.
    pub fn fault(self, model: &dyn Brdf, masking: MaskingShadowing) -> Option<String> {
        let name = model.name();
        if !model.is_stretchable() {
            let others: Vec<&str> = stretchable().map(Brdf::name).collect();
            return Some(format!(
                "{name} has one width: its slopes change their shape with it; expected {}",
                others.join(" or ")
            ));
        }
        let is_schlick = masking == MaskingShadowing::Schlick;
        is_schlick.then(|| {
            "masking schlick is a fit for one width; expected separable, correlated or \
                      smith-exact"
                .to_owned()
        })
    }

    pub fn widths(self, alpha: f64, s: f64) -> Widths {
        let widths = match self {
            Self::Gltf => DVec2::new(alpha + (1.0 - alpha) * s * s, alpha),
            Self::Kulla => alpha * DVec2::new(1.0 + s, 1.0 - s),
            Self::Disney => {
                alpha * DVec2::new(1.0 / (1.0 - 0.9 * s).sqrt(), (1.0 - 0.9 * s).sqrt())
            }
            Self::OpenPbr => {
                alpha * (2.0 / (1.0 + (1.0 - s).powi(2))).sqrt() * DVec2::new(1.0, 1.0 - s)
            }
        };
        Widths(widths.clamp(DVec2::splat(ALPHA_MIN.into()), DVec2::ONE))
    }
}

/// The widths of a lobe along local x and y.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Widths(pub DVec2);

impl From<f64> for Widths {
    fn from(alpha: f64) -> Self {
        Self(DVec2::splat(alpha))
    }
}

impl Widths {
    /// Returns the one width of lookups that know no other: the root of the mean square.
    pub fn mean(self) -> f64 {
        if self.0.x == self.0.y {
            self.0.x
        } else {
            (0.5 * self.0.length_squared()).sqrt()
        }
    }

    /// Returns the width along the azimuth of a direction.
    pub fn along(self, w_local: DVec3) -> f64 {
        let across = w_local.truncate();
        let equal = self.0.x == self.0.y || w_local.truncate() == DVec2::ZERO;
        if equal {
            self.0.y
        } else {
            (self.0 * across).length() / across.length()
        }
    }

    pub(super) fn stretched(self, w_local: DVec3) -> DVec3 {
        (self.0 * w_local.truncate()).extend(w_local.z)
    }

    /// Computes D(h), 1/sr.
    pub fn d(self, model: &dyn Brdf, h_local: DVec3) -> f64 {
        if self.0.x == self.0.y {
            return model.d(h_local, self.0.x);
        }
        let slope = (h_local.truncate() / self.0).extend(h_local.z);
        let q = slope.length();
        model.d(slope / q, 1.0) / (self.0.x * self.0.y * q.powi(4))
    }

    /// Samples a half vector with density `D(h) n_dot_h`.
    pub fn sample_d(self, model: &dyn Brdf, xi: DVec2) -> DVec3 {
        if self.0.x == self.0.y {
            model.sample_d(xi, self.0.x)
        } else {
            self.stretched(model.sample_d(xi, 1.0)).normalize()
        }
    }

    pub fn g1(self, model: &dyn Brdf, w_local: DVec3, masking: MaskingShadowing) -> f64 {
        g1(model, w_local.z, self.along(w_local), masking)
    }

    /// Computes `D G2 / (4 n_dot_v)`, 1/sr: the lobe for `F = 1`; 0 if `v` or `l` is not above the
    /// horizon.
    pub fn lobe(
        self,
        model: &dyn Brdf,
        v_local: DVec3,
        l_local: DVec3,
        masking: MaskingShadowing,
    ) -> f64 {
        if v_local.z <= 0.0 || l_local.z <= 0.0 {
            return 0.0;
        }
        let g2 = g2_from_g1(
            self.g1(model, v_local, masking),
            self.g1(model, l_local, masking),
            masking,
        );
        self.d(model, (v_local + l_local).normalize()) * g2 / (4.0 * v_local.z)
    }
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stretch {
    pub widths: Widths,
    /// Unit vector, orthogonal to the normal.
    pub tangent: DVec3,
}
