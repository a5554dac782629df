//! Microfacet BRDF models in f64: the twins of `shaders/brdf`.
//!
//! `f(v, l) = D(h) F(v·h) G2(v, l) / (4 n_dot_v n_dot_l)` [Walter07, eq. 20]. All vectors are local
//! (n is +z) and point away from the surface. `eval` excludes the cosine.
//!
//! Densities: a half vector of density `pdf_h` gives `l = reflect(-v, h) = 2 (v·h) h - v` of
//! density `pdf_l = pdf_h / (4 |v·h|)` [Walter07, eq. 14]. So `f n_dot_l / pdf_l` is `F G2 (v·h) /
//! (n_dot_v n_dot_h)` for `pdf_h = D n_dot_h`, and `F G2 / G1(v)` for visible normals, `pdf_h =
//! G1(v) max(v·h, 0) D / n_dot_v` \[HeitzDeon14\]. A sample whose `l` lies below the horizon has
//! weight 0 but counts.

use crate::base::names::{Listed, listed};
use glam::{DVec2, DVec3};

mod anisotropy;
mod beckmann;
mod compensation;
mod fresnel;
mod ggx;
mod phong;
mod sheen;
mod under_coat;

pub use anisotropy::{Stretch, WidthLaw, Widths, stretchable};
pub use beckmann::Beckmann;
pub use compensation::Compensation;
pub use fresnel::{Fresnel, FresnelWeight, f_dielectric, schlick_weight};
pub use ggx::Ggx;
pub use phong::{Phong, exponent_from_alpha};
pub use sheen::{SHEEN_ALPHA_MIN, SheenVisibility};
pub use under_coat::{RoughnessUnderCoat, UnderCoatLaw};

/// A microfacet distribution with its Smith masking. `alpha` is in (0, 1] and precise down to
/// 0.001. The samplers take two widths; a distribution that knows one gets it twice.
pub trait Brdf: Sync + std::fmt::Debug {
    /// Name in configs, tables and shader files.
    fn name(&self) -> &'static str;
    fn about(&self) -> &'static str;
    /// Whether stretched slopes are the slopes of other widths ([`Widths`]).
    fn is_stretchable(&self) -> bool {
        true
    }
    /// Normal distribution D(h), 1/sr, of a unit vector; 0 below the horizon. `∫ D n_dot_h = 1`.
    fn d(&self, h_local: DVec3, alpha: f64) -> f64;
    /// Smith masking G1, in [0, 1], of a direction with cosine `n_dot_w` to the normal; 0 below the
    /// horizon.
    fn g1(&self, n_dot_w: f64, alpha: f64) -> f64;
    /// Exact Smith masking of the model's own D: `n_dot_w / ∫ D(m) max(w·m, 0) dm` \[Heitz14\]; 0
    /// below the horizon.
    ///
    /// It differs from [`Brdf::g1`] if that is a fit. With it no surface reflects more than it
    /// receives: by the integral, the visible facets fill the projected area, and shadowing only
    /// removes light.
    fn g1_exact(&self, n_dot_w: f64, alpha: f64) -> f64;
    /// Samples a half vector with density `pdf_h = D(h) n_dot_h`. `xi.x` in [0, 1) is 0 at the
    /// normal, `φ = 2π xi.y`.
    fn sample_d(&self, xi: DVec2, alpha: f64) -> DVec3;
    /// Samples a half vector among the normals visible from `v_local`, for the method
    /// `sampled-vndf`; [`Brdf::pdf_vndf_l`] is its density over `l`. The default draws normals of
    /// GGX within the cap that reflects above the horizon \[EtoTokuyoshi23\].
    fn sample_vndf(&self, xi: DVec2, v_local: DVec3, widths: Widths) -> DVec3 {
        ggx::sample_bounded(xi, v_local, widths)
    }
    /// Density per solid angle of `l = reflect(-v, h)` under [`Brdf::sample_vndf`]; its integral
    /// over the sphere is 1.
    fn pdf_vndf_l(&self, v_local: DVec3, h_local: DVec3, widths: Widths) -> f64 {
        ggx::pdf_bounded_l(v_local, h_local, widths)
    }
    /// Largest `G2 D / (4 n_dot_v pdf_vndf_l)` with exact masking: the weight of a sample of
    /// [`Brdf::sample_vndf`] in constant light. It is 1 if the model draws its own visible normals.
    fn vndf_weight_max(&self) -> f64 {
        1.0
    }
    /// Samples a half vector among the normals visible from `v_local`, for the reference;
    /// [`Brdf::pdf_visible_l`] is its density over `l`. The default draws all visible normals of
    /// GGX by spherical caps \[Dupuy23\]: `xi.x = 0` is the cap's centre.
    fn sample_visible(&self, xi: DVec2, v_local: DVec3, widths: Widths) -> DVec3 {
        ggx::sample_visible(xi, v_local, widths)
    }
    /// Density per solid angle of `l = reflect(-v, h)` under [`Brdf::sample_visible`].
    fn pdf_visible_l(&self, v_local: DVec3, h_local: DVec3, widths: Widths) -> f64 {
        ggx::pdf_visible_l(v_local, h_local, widths)
    }
}

/// Every model. docs/architecture.md ("Adding things") says what else a new one touches.
pub static MODELS: &[&dyn Brdf] = &[&Ggx, &Beckmann, &Phong];

impl Listed for dyn Brdf {
    const WHAT: &'static str = "BRDF model";

    fn all() -> impl Iterator<Item = &'static Self> + Clone {
        MODELS.iter().copied()
    }

    fn name(&self) -> &'static str {
        Brdf::name(self)
    }
}

/// How masking and shadowing combine. The discriminants are `glsl::constants::MASKING_*`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum MaskingShadowing {
    /// `G1(v) G1(l)`.
    #[default]
    Separable = 0,
    /// `1 / (1 + Λ(v) + Λ(l))`.
    Correlated = 1,
    /// Karis' Schlick-Smith, `k = alpha / 2`, for image-based lighting.
    Schlick = 2,
    /// `G1(v) G1(l)` with the exact Smith masking of each model's own D.
    SmithExact = 3,
}

listed!(MaskingShadowing, "masking-shadowing", {
    "separable": Separable,
    "correlated": Correlated,
    "schlick": Schlick,
    "smith-exact": SmithExact,
});

/// Returns the masking G1, in [0, 1], of a direction; 0 if its cosine is not positive.
///
/// Schlick: `G1 = c / (c (1 - k) + k)`, `k = alpha/2`, the same for every model [Karis13, eq. 4].
pub fn g1(model: &dyn Brdf, n_dot_w: f64, alpha: f64, masking: MaskingShadowing) -> f64 {
    match masking {
        MaskingShadowing::Separable | MaskingShadowing::Correlated => model.g1(n_dot_w, alpha),
        MaskingShadowing::Schlick if n_dot_w <= 0.0 => 0.0,
        MaskingShadowing::Schlick => {
            let k = 0.5 * alpha;
            n_dot_w / (n_dot_w * (1.0 - k) + k)
        }
        MaskingShadowing::SmithExact => model.g1_exact(n_dot_w, alpha),
    }
}

/// Returns the masking-shadowing G2, in [0, 1]; 0 if a cosine is not positive.
///
/// The product of both G1 [Walter07, eq. 23], or correlated: `Λ = 1/G1 - 1`, so `1/(1 + Λ(v) +
/// Λ(l)) = 1/(1/G1(v) + 1/G1(l) - 1)` [Heitz14, eq. 99].
pub fn g2(
    model: &dyn Brdf,
    n_dot_v: f64,
    n_dot_l: f64,
    alpha: f64,
    masking: MaskingShadowing,
) -> f64 {
    if n_dot_v <= 0.0 || n_dot_l <= 0.0 {
        return 0.0;
    }
    g2_from_g1(
        g1(model, n_dot_v, alpha, masking),
        g1(model, n_dot_l, alpha, masking),
        masking,
    )
}

/// Combines two G1 into [`g2`].
pub fn g2_from_g1(g1_v: f64, g1_l: f64, masking: MaskingShadowing) -> f64 {
    match masking {
        // Multiplied out, so that a vanishing G1 gives 0 and not 1/∞.
        MaskingShadowing::Correlated => g1_v * g1_l / (g1_v + g1_l - g1_v * g1_l),
        _ => g1_v * g1_l,
    }
}

/// Returns Schlick's Fresnel reflectance with `f90 = 1`, per channel.
pub fn f_schlick(f0: DVec3, v_dot_h: f64) -> DVec3 {
    f0 + (DVec3::ONE - f0) * schlick_weight(v_dot_h)
}

/// Largest index of refraction that users may set; its F0 is 0.96.
pub const IOR_MAX: f64 = 100.0;

/// Returns the reflectance at normal incidence of a dielectric of index `ior` in air: `((1 -
/// ior)/(1 + ior))²`.
pub fn f0_from_ior(ior: f64) -> f64 {
    ((1.0 - ior) / (1.0 + ior)).powi(2)
}

/// Returns the index of refraction, 1 or above, whose [`f0_from_ior`] is `f0`; infinite for 1.
pub fn ior_from_f0(f0: f64) -> f64 {
    (1.0 + f0.sqrt()) / (1.0 - f0.sqrt())
}

/// Computes `D G2 / (4 n_dot_v n_dot_l)` (1/sr), the BRDF for `F = 1`; 0 if `v` or `l` is not above
/// the horizon.
pub fn eval_without_fresnel(
    model: &dyn Brdf,
    v_local: DVec3,
    l_local: DVec3,
    widths: impl Into<Widths>,
    masking: MaskingShadowing,
) -> f64 {
    let lobe = widths.into().lobe(model, v_local, l_local, masking);
    if lobe == 0.0 { 0.0 } else { lobe / l_local.z }
}

/// Computes the BRDF (1/sr), per channel, without the cosine; 0 if `v` or `l` is not above the
/// horizon.
pub fn eval(
    model: &dyn Brdf,
    v_local: DVec3,
    l_local: DVec3,
    widths: impl Into<Widths>,
    f0: DVec3,
    masking: MaskingShadowing,
) -> DVec3 {
    let f = eval_without_fresnel(model, v_local, l_local, widths, masking);
    if f == 0.0 {
        return DVec3::ZERO;
    }
    f_schlick(f0, v_local.dot((v_local + l_local).normalize())) * f
}

/// Returns `l = 2 (v·h) h - v`.
pub fn reflect(v: DVec3, h: DVec3) -> DVec3 {
    2.0 * v.dot(h) * h - v
}

/// Returns the density of `l = reflect(-v, h)` per solid angle of `l` under [`Brdf::sample_d`]: `D
/// n_dot_h / (4
/// |v·h|)`, for every `l`.
///
/// A normal facing away from `v` (`v·h < 0`) gives an `l` whose half vector is `-h`: the pair ±h
/// has one density.
pub fn pdf_d_l(model: &dyn Brdf, v_local: DVec3, h_local: DVec3, widths: Widths) -> f64 {
    let h = if h_local.z < 0.0 { -h_local } else { h_local };
    let pdf_h = widths.d(model, h) * h.z;
    // 0 also where l = -v, whose half vector is undefined.
    if pdf_h == 0.0 {
        0.0
    } else {
        pdf_h / (4.0 * v_local.dot(h).abs())
    }
}

/// Returns the microfacet width of a perceptual roughness in [0, 1]. Inverse:
/// [`perceptual_roughness_from_alpha`].
pub fn alpha_from_perceptual_roughness(perceptual_roughness: f64) -> f64 {
    perceptual_roughness * perceptual_roughness
}

/// Inverse of [`alpha_from_perceptual_roughness`].
pub fn perceptual_roughness_from_alpha(alpha: f64) -> f64 {
    alpha.sqrt()
}

/// Returns `sin² θ_h` and `cos² θ_h`. From x and y: `1 - z²` would lose all digits of a lobe of
/// width 0.001.
fn sin2_cos2(h_local: DVec3) -> (f64, f64) {
    (
        h_local.x * h_local.x + h_local.y * h_local.y,
        h_local.z * h_local.z,
    )
}

/// Computes Walter's fit of Beckmann's Smith G1 [Walter07, eq. 27], also used for Phong [Walter07,
/// section 5.2].
///
/// `a = 1/(alpha tan θ)`; for Phong `a = √(exponent/2 + 1)/tan θ`, the same number since `exponent
/// = 2/alpha² - 2`. The fit ends at 1.6, where it is 1.00003; relative error below 0.35 %.
fn g1_rational(n_dot_w: f64, alpha: f64) -> f64 {
    const FIT_END: f64 = 1.6;
    if n_dot_w <= 0.0 {
        return 0.0;
    }
    let tan_theta = (1.0 - n_dot_w * n_dot_w).max(0.0).sqrt() / n_dot_w;
    // Compared by product: tan θ = 0 at normal incidence has no 1/tan θ.
    if alpha * tan_theta * FIT_END <= 1.0 {
        return 1.0;
    }
    let a = 1.0 / (alpha * tan_theta);
    (3.535 * a + 2.181 * a * a) / (1.0 + 2.276 * a + 2.577 * a * a)
}
