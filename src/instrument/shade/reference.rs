//! Exact shading in f64, with error bounds: the integrals that all methods approximate.
//!
//! For one point with normal n, view v and an environment's bilinear map L, over the l with
//! `n_dot_l > 0`:
//!
//! - specular: `∫ f L n_dot_l dl`, `f n_dot_l = D(h) F(v·h) G2(v, l) / (4 n_dot_v)` [Walter07, eq.
//!   20];
//! - diffuse of albedo 1: `1/π ∫ (1 - F(v·h)) L n_dot_l dl`; with `F = 0` it is Lambert's.
//!
//! `F = f0 + (1 - f0) Fc` is linear in `f0`, with Fc Schlick's `(1 - v·h)⁵` or the weight of a
//! dielectric ([`FresnelWeight`]), so two integrals of each kind serve every `f0`. See
//! `examples/integrate_pixel.rs`.

use crate::base::math::equirect_quadrature::{EquirectQuadrature, Focus};
use crate::base::math::frame::Frame;
use crate::base::math::quadrature::{Bounded, Estimate, Tolerance};
use crate::instrument::brdf::{Brdf, FresnelWeight, MaskingShadowing, Stretch, Widths, reflect};
use glam::DVec3;
use std::f64::consts::PI;

/// A point to shade. `n` and `v` are unit vectors in the environment's frame, `n·v > 0`; `alpha` is
/// in (0, 1].
#[derive(Clone, Copy, Debug)]
pub struct Surface {
    pub model: &'static dyn Brdf,
    pub masking: MaskingShadowing,
    /// Width of the lobe; of two, [`Widths::mean`].
    pub alpha: f64,
    /// Its two widths, if it has.
    pub stretch: Option<Stretch>,
    /// Reflectance at normal incidence, linear RGB.
    pub f0: DVec3,
    /// The weight of f90.
    pub fresnel: FresnelWeight,
    pub n: DVec3,
    pub v: DVec3,
}

impl Surface {
    /// Makes a surface of one width from normal and view.
    pub fn new(
        model: &'static dyn Brdf,
        masking: MaskingShadowing,
        alpha: f64,
        f0: DVec3,
        [n, v]: [DVec3; 2],
    ) -> Self {
        Self {
            model,
            masking,
            alpha,
            stretch: None,
            f0,
            fresnel: FresnelWeight::Schlick,
            n,
            v,
        }
    }

    /// Returns the surface with two widths.
    pub fn stretched(self, stretch: Stretch) -> Self {
        Self {
            alpha: stretch.widths.mean(),
            stretch: Some(stretch),
            ..self
        }
    }

    pub fn widths(&self) -> Widths {
        self.stretch
            .map_or(self.alpha.into(), |stretch| stretch.widths)
    }

    /// Calls a function with the focus on the lobe, which at grazing views is a long arc.
    pub(crate) fn focused<T>(&self, integrate: impl FnOnce(Focus) -> T) -> T {
        let frame = self.frame();
        let Widths(widths) = self.widths();
        let v = frame.to_local(self.v);
        // Slopes of the half vector over the widths.
        let in_widths = |l: DVec3| {
            let l = frame.to_local(l);
            let h = v + l.with_z(l.z.max(0.0));
            (h.truncate() / (h.z * widths)).extend(l.z)
        };
        // Across the plane of incidence the lobe about the mirror direction is narrowest: 2 alpha
        // (v·h).
        let alpha = widths.min_element();
        integrate(Focus {
            direction: reflect(self.v, self.n),
            radius: alpha * v.z.max(alpha),
            in_widths: Some(&in_widths),
        })
    }

    pub fn frame(&self) -> Frame {
        self.stretch.map_or_else(
            || Frame::from_normal(self.n),
            |stretch| Frame::from_tangent(self.n, stretch.tangent),
        )
    }
}

/// The exact answers for one [`Surface`]: outgoing radiance, linear RGB.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Answer {
    /// Specular with F = 1.
    pub specular_white: Bounded,
    /// Specular with Schlick's F.
    pub specular: Bounded,
    /// Diffuse of albedo 1: irradiance over π.
    pub diffuse: Bounded,
    /// Diffuse of albedo 1 with the factor `1 - F(v·h)` in the integral.
    pub diffuse_transmitted: Bounded,
}

/// A relative error bound of 1e-5. True errors are a tenth to a thousandth of the bound.
pub const TOLERANCE: Tolerance = Tolerance {
    relative: 1e-5,
    max_part_count: 100_000,
};

pub fn integrate(
    environment: &EquirectQuadrature,
    surface: &Surface,
    tolerance: Tolerance,
) -> Answer {
    let f0 = surface.f0;
    let specular = specular(environment, surface, tolerance);
    let diffuse = diffuse(environment, surface, tolerance);
    Answer {
        specular_white: specular.combine([DVec3::ONE, DVec3::ZERO]),
        specular: specular.combine([f0, DVec3::ONE - f0]),
        diffuse: diffuse.combine([DVec3::ONE, DVec3::ZERO]),
        diffuse_transmitted: diffuse.combine([DVec3::ONE - f0, f0 - DVec3::ONE]),
    }
}

/// Integrates `∫ f L n·l dl` with F = 1 and with `F = Fc`.
pub fn specular(
    environment: &EquirectQuadrature,
    surface: &Surface,
    tolerance: Tolerance,
) -> Estimate<2> {
    let Surface {
        model,
        masking,
        fresnel,
        v,
        ..
    } = *surface;
    let frame = surface.frame();
    let widths = surface.widths();
    let v_local = frame.to_local(v);
    let kernel = |l: DVec3| {
        let l_local = frame.to_local(l);
        if l_local.z <= 0.0 {
            return [0.0; 2];
        }
        let f = widths.lobe(model, v_local, l_local, masking);
        [
            f,
            f * fresnel.at(v_local.dot((v_local + l_local).normalize())),
        ]
    };
    surface.focused(|focus| environment.integrate(kernel, Some(focus), tolerance))
}

/// Integrates `∫ n·l L dl / π` and `∫ Fc n·l L dl / π`.
pub fn diffuse(
    environment: &EquirectQuadrature,
    surface: &Surface,
    tolerance: Tolerance,
) -> Estimate<2> {
    let Surface { n, v, fresnel, .. } = *surface;
    let kernel = |l: DVec3| {
        let n_dot_l = n.dot(l);
        if n_dot_l <= 0.0 {
            return [0.0; 2];
        }
        let f = n_dot_l / PI;
        [f, f * fresnel.at(v.dot((v + l).normalize()))]
    };
    environment.integrate(kernel, None, tolerance)
}
