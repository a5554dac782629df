//! A and B in f64, by adaptive cubature over half vectors.
//!
//! Let θ, φ be the polar angles of h, φ from the plane of v. The integrand `D(h) n_dot_h W` is even
//! in φ and ends where l meets the horizon: `n_dot_l > 0` means `cos φ > -cot(2θ) cot θ_v`. So all
//! azimuths count up to `θ_full = (π/2 - θ_v)/2`, and none beyond `θ_none = (π/2 + θ_v)/2`.
//! Integrating exactly up to that limit leaves no kink for GGX. The variables are
//!
//! - `t = ln tan θ`, in which lobes of any width have the same shape, linear below θ_full and
//!   `sin²(π x/2)` between θ_full and θ_none, which straightens the square roots at both ends of
//!   the limit;
//! - φ as a fraction of its limit.

use super::DfgAxes;
use crate::base::math::quadrature::{Bounded, Rectangle, Tolerance, integrate_columns};
use crate::base::pixels::Pixels;
use crate::instrument::brdf::{
    Brdf, FresnelWeight, MaskingShadowing, g1, g2_from_g1, schlick_weight,
};
use crate::instrument::precompute::prefilter::Kernel;
use glam::{DVec2, DVec3};
use rayon::prelude::*;
use std::f64::consts::{FRAC_PI_2, PI};

/// Directional albedo split by Fresnel: `f0 A + f90 B` with `f90 = 1`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dfg {
    /// A.
    pub f0_scale: f64,
    /// B.
    pub f90_scale: f64,
    /// Upper estimate of the absolute error of each.
    pub error: f64,
}

impl Dfg {
    /// Returns `A + B`: the directional albedo for F = 1.
    pub fn albedo(&self) -> f64 {
        self.f0_scale + self.f90_scale
    }
}

/// Half vectors nearer to the normal than `alpha exp(-12)` are 4e-11 of a lobe.
const LOG_WIDTH_BELOW: f64 = 12.0;

/// Relative error of [`dfg`].
pub const EXACT: f64 = 5e-7;

/// Integrates A and B for `n_dot_v` in (0, 1] and `alpha` in (0, 1].
pub fn dfg(model: &'static dyn Brdf, masking: MaskingShadowing, n_dot_v: f64, alpha: f64) -> Dfg {
    dfg_within(model, masking, n_dot_v, alpha, EXACT)
}

/// Integrates A and B with another weight of f90, Fc.
pub fn dfg_of(
    model: &'static dyn Brdf,
    masking: MaskingShadowing,
    fresnel: FresnelWeight,
    n_dot_v: f64,
    alpha: f64,
) -> Dfg {
    dfg_weighted(
        model,
        masking,
        n_dot_v,
        [alpha, alpha],
        EXACT,
        |v_dot_h, _| [v_dot_h, fresnel.at(v_dot_h)],
    )
}

/// Integrates A and B within a relative error.
pub fn dfg_within(
    model: &'static dyn Brdf,
    masking: MaskingShadowing,
    n_dot_v: f64,
    alpha: f64,
    relative: f64,
) -> Dfg {
    dfg_masked_by(model, masking, n_dot_v, [alpha, alpha], relative)
}

/// Integrates A and B of a distribution and a masking of different widths.
pub fn dfg_masked_by(
    model: &'static dyn Brdf,
    masking: MaskingShadowing,
    n_dot_v: f64,
    widths: [f64; 2],
    relative: f64,
) -> Dfg {
    dfg_by(model, masking, n_dot_v, widths, relative, |v_dot_h, _| {
        [v_dot_h; 2]
    })
}

/// The same with another factor for v·h in the weight of a half vector, and another cosine of
/// Fresnel, by v·h and n·h.
pub fn dfg_by(
    model: &'static dyn Brdf,
    masking: MaskingShadowing,
    n_dot_v: f64,
    widths: [f64; 2],
    relative: f64,
    facet: impl Fn(f64, f64) -> [f64; 2],
) -> Dfg {
    dfg_weighted(
        model,
        masking,
        n_dot_v,
        widths,
        relative,
        |v_dot_h, n_dot_h| {
            let [factor, cos] = facet(v_dot_h, n_dot_h);
            [factor, schlick_weight(cos)]
        },
    )
}

/// Integrates A and B with the factor for v·h and Fc that `facet` returns for v·h and n·h.
fn dfg_weighted(
    model: &'static dyn Brdf,
    masking: MaskingShadowing,
    n_dot_v: f64,
    [alpha, of_masking]: [f64; 2],
    relative: f64,
    facet: impl Fn(f64, f64) -> [f64; 2],
) -> Dfg {
    let g1_v = g1(model, n_dot_v, of_masking, masking);
    let integral = mean_over_facets(model, n_dot_v, alpha, relative, |h, v_dot_h, n_dot_l| {
        let g1_l = if n_dot_l > 0.0 {
            g1(model, n_dot_l, of_masking, masking)
        } else {
            0.0
        };
        let [factor, fc] = facet(v_dot_h, h.z);
        let weight = g2_from_g1(g1_v, g1_l, masking) * factor / (n_dot_v * h.z);
        DVec3::new(weight, weight * fc, 0.0)
    });
    let [albedo, f90_scale, _] = integral.value.to_array();
    Dfg {
        f0_scale: albedo - f90_scale,
        f90_scale,
        error: integral.error.x,
    }
}

/// Makes the table of (A, B) of `side` x `side` texels, n·v along x and alpha along y, within a
/// relative error.
pub fn table(
    model: &'static dyn Brdf,
    masking: MaskingShadowing,
    axes: DfgAxes,
    side: u32,
    relative: f64,
) -> Pixels<DVec2> {
    let texel = |index: u32| {
        let position = DVec2::new((index % side).into(), (index / side).into()) + 0.5;
        let DVec2 {
            x: n_dot_v,
            y: alpha,
        } = axes.parameters(position, side);
        let pair = dfg_within(model, masking, n_dot_v, alpha, relative);
        DVec2::new(pair.f0_scale, pair.f90_scale)
    };
    Pixels::new(
        side,
        side,
        (0..side * side).into_par_iter().map(texel).collect(),
    )
}

/// Integrates the normalisation of the kernel `D n_dot_h / (4 v·h) w(l)` of prefiltered maps at a
/// view: the means of `(1 - Fc) w` and `Fc w` over half vectors of density `D n_dot_h`, within a
/// relative error.
pub fn weight_means(kernel: Kernel, n_dot_v: f64, alpha: f64, relative: f64) -> [f64; 2] {
    let integral = mean_over_facets(
        kernel.brdf,
        n_dot_v,
        alpha,
        relative,
        |_, v_dot_h, n_dot_l| {
            let weight = kernel.weight(alpha, n_dot_l);
            DVec3::new(weight, weight * schlick_weight(v_dot_h), 0.0)
        },
    );
    [integral.value.x - integral.value.y, integral.value.y]
}

/// Integrates the mean of `f(h, v·h, n·l)` over half vectors of density `D n_dot_h`; 0 if l is
/// below the horizon.
fn mean_over_facets(
    model: &'static dyn Brdf,
    n_dot_v: f64,
    alpha: f64,
    relative: f64,
    f: impl Fn(DVec3, f64, f64) -> DVec3,
) -> Bounded {
    let tolerance = Tolerance {
        relative,
        max_part_count: 100_000,
    };
    let facets = Facets::new(model, n_dot_v, alpha);
    let v = facets.v;
    let value = |arc: &Arc, fraction: f64| {
        let h = arc.half_vector(fraction);
        let v_dot_h = v.dot(h);
        arc.weight * f(h, v_dot_h, 2.0 * v_dot_h * h.z - v.z)
    };
    let unit = Rectangle {
        low: DVec2::ZERO,
        high: DVec2::ONE,
    };
    integrate_columns(
        unit,
        tolerance,
        |x| facets.arcs(x),
        |arcs, y| arcs.iter().flatten().map(|arc| value(arc, y)).sum(),
    )
}

/// The half vectors of a view, by t = ln tan θ of their angle θ to the normal.
struct Facets {
    model: &'static dyn Brdf,
    alpha: f64,
    v: DVec3,
    /// Where the integral begins.
    t_low: f64,
    /// Up to here no l is below the horizon.
    t_full: f64,
    /// From here on every l is below the horizon.
    t_none: f64,
}

/// Half vectors at one angle to the normal, up to an azimuth on both sides.
struct Arc {
    sin_theta: f64,
    cos_theta: f64,
    phi_limit: f64,
    weight: f64,
}

impl Facets {
    fn new(model: &'static dyn Brdf, n_dot_v: f64, alpha: f64) -> Self {
        let v = DVec3::new(((1.0 - n_dot_v) * (1.0 + n_dot_v)).sqrt(), 0.0, n_dot_v);
        let theta_v = v.x.atan2(v.z);
        let t_full = (0.5 * (FRAC_PI_2 - theta_v)).tan().ln();
        let t_none = (0.5 * (FRAC_PI_2 + theta_v)).tan().ln();
        Self {
            model,
            alpha,
            v,
            // At grazing views the first range may end within the core of the lobe.
            t_low: t_full.min(alpha.ln()) - LOG_WIDTH_BELOW,
            t_full,
            t_none,
        }
    }

    /// Returns the arcs of a column of the unit square: the whole circle while no l is below the
    /// horizon, and the part above it beyond.
    fn arcs(&self, x: f64) -> [Option<Arc>; 2] {
        let Self {
            v,
            t_low,
            t_full,
            t_none,
            ..
        } = *self;
        let full = self.arc(t_low + (t_full - t_low) * x, PI, t_full - t_low);
        let (sin, cos) = (FRAC_PI_2 * x).sin_cos();
        let t = t_full + (t_none - t_full) * sin * sin;
        let phi_limit = (-v.z / (v.x * (2.0 * t.exp().atan()).tan()))
            .clamp(-1.0, 1.0)
            .acos();
        // For v = n the limits coincide.
        let cut =
            (t_none > t_full).then(|| self.arc(t, phi_limit, (t_none - t_full) * PI * sin * cos));
        [Some(full), cut]
    }

    /// Returns the arc at t; `step` is dt per unit of the square.
    fn arc(&self, t: f64, phi_limit: f64, step: f64) -> Arc {
        let (sin_theta, cos_theta) = t.exp().atan().sin_cos();
        // dω = sin θ dθ dφ = sin² θ cos θ dt dφ, both signs of φ.
        let measure = 2.0 * phi_limit * sin_theta * sin_theta * cos_theta;
        let density = self
            .model
            .d(DVec3::new(sin_theta, 0.0, cos_theta), self.alpha)
            * cos_theta;
        Arc {
            sin_theta,
            cos_theta,
            phi_limit,
            weight: step * density * measure,
        }
    }
}

impl Arc {
    /// Returns the half vector at a fraction of the largest azimuth.
    fn half_vector(&self, fraction: f64) -> DVec3 {
        let (sin_phi, cos_phi) = (self.phi_limit * fraction).sin_cos();
        DVec3::new(
            self.sin_theta * cos_phi,
            self.sin_theta * sin_phi,
            self.cos_theta,
        )
    }
}
