//! Microfacet BRDF models in f64: the twins of `shaders/brdf`.
//!
//! All vectors are local (n is +z) and point away from the surface. `eval` never includes the cosine.

use glam::{DVec2, DVec3};

mod beckmann;
mod ggx;
mod phong;

pub use beckmann::Beckmann;
pub use ggx::Ggx;
pub use phong::Phong;

/// A microfacet distribution with its Smith masking.
pub trait Brdf: Sync + std::fmt::Debug {
    /// Name in configs, tables and shader file names.
    fn name(&self) -> &'static str;
    /// Normal distribution D(h), 1/sr.
    fn d(&self, h_local: DVec3, alpha: f64) -> f64;
    /// Smith masking G1 of one direction with cosine `n_dot_w` to the normal.
    fn g1(&self, n_dot_w: f64, alpha: f64) -> f64;
    /// Half vector with density `pdf_h = D(h) n_dot_h`.
    fn sample_d(&self, xi: DVec2, alpha: f64) -> DVec3;
    /// Half vector by the best known sampler for the model given `v_local`; its density over `l` is [`Brdf::pdf_visible_l`].
    fn sample_visible(&self, xi: DVec2, v_local: DVec3, alpha: f64) -> DVec3;
    /// Density of `l = reflect(-v, h)` per solid angle of `l` under [`Brdf::sample_visible`].
    fn pdf_visible_l(&self, v_local: DVec3, h_local: DVec3, alpha: f64) -> f64;
}

/// Every model. Adding one: its file here, `shaders/brdf/<name>.glsl`, one line here.
pub static MODELS: &[&dyn Brdf] = &[&Ggx, &Beckmann, &Phong];

/// The model of that name.
pub fn by_name(name: &str) -> Option<&'static dyn Brdf> {
    MODELS.iter().copied().find(|model| model.name() == name)
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
}

impl MaskingShadowing {
    /// Every variant with its name.
    pub const ALL: &[(&str, Self)] =
        &[("separable", Self::Separable), ("correlated", Self::Correlated), ("schlick", Self::Schlick)];
}
