//! A lobe as weighted directions, by the quadrature derived in
//! `shaders/lib/directional_albedo.glsl`.

use crate::instrument::brdf::{Brdf, FresnelWeight, MaskingShadowing, g1, g2_from_g1};
use glam::{DVec2, DVec3};
use std::f64::consts::{PI, TAU};

/// Nodes in azimuth, over half a turn, and in each of two ranges of the polar angle.
const PHI_COUNT: u32 = 16;
const R_COUNT: u32 = 16;

/// The lobe of a view at `(sin θ, 0, cos θ)`. Its mirror image in y is omitted.
pub struct Lobe {
    model: &'static dyn Brdf,
    masking: MaskingShadowing,
    fresnel: FresnelWeight,
    pub alpha: f64,
    v: DVec3,
    g1_v: f64,
    /// Directions, and the contribution of each to A and B.
    nodes: Vec<(DVec3, DVec2)>,
    /// (A, B).
    pub albedos: DVec2,
}

/// Returns node and weight on `[0, 1]` of the midpoint rule after the sin² transformation
/// \[Sidi93\].
fn periodic_node(i: u32, count: u32) -> (f64, f64) {
    let x = (f64::from(i) + 0.5) / f64::from(count);
    (
        x - (TAU * x).sin() / TAU,
        (1.0 - (TAU * x).cos()) / f64::from(count),
    )
}

/// Half vectors at one angle to the normal, up to an azimuth.
struct Ring {
    sin_h: f64,
    cos_h: f64,
    phi_end: f64,
    weight: f64,
}

impl Ring {
    /// Returns the half vector at a fraction of the largest azimuth.
    fn half_vector(&self, fraction: f64) -> DVec3 {
        let (sin_phi, cos_phi) = (fraction * self.phi_end).sin_cos();
        DVec3::new(self.sin_h * cos_phi, self.sin_h * sin_phi, self.cos_h)
    }
}

/// Returns the rings of a view in both ranges of the polar angle: up to the last whole circle above
/// the horizon, and beyond it.
fn rings(model: &'static dyn Brdf, alpha: f64, v: DVec3) -> impl Iterator<Item = Ring> {
    let alpha2 = alpha * alpha;
    let low2 = 0.5 * v.z * v.z / (1.0 + v.x);
    let high2 = 0.5 * (1.0 + v.x);
    let ggx_r = |sin2: f64, cos2: f64| (alpha2 * cos2 / (sin2 + alpha2 * cos2)).sqrt();
    let r_ends = [1.0, ggx_r(low2, high2), ggx_r(high2, low2)];
    let ring = move |range: usize, i: u32| {
        let (position, weight) = periodic_node(i, R_COUNT);
        let r = r_ends[range] + (r_ends[range + 1] - r_ends[range]) * position;
        let u = (1.0 - r) * (1.0 + r);
        let k = 1.0 / (1.0 + (alpha2 - 1.0) * u);
        let cos_h = r * k.sqrt();
        let sin_h = alpha * (u * k).sqrt();
        let phi_end = if range == 0 {
            PI
        } else {
            (v.z * (0.5 / cos_h - cos_h) / (v.x * sin_h).max(1e-30))
                .clamp(-1.0, 1.0)
                .acos()
        };
        let k_ggx = sin_h * sin_h + alpha2 * cos_h * cos_h;
        let d_ratio = model.d(DVec3::new(sin_h, 0.0, cos_h), alpha) * PI * k_ggx * k_ggx / alpha2;
        Ring {
            sin_h,
            cos_h,
            phi_end,
            weight: weight
                * (r_ends[range] - r_ends[range + 1])
                * 2.0
                * r
                * (phi_end / PI)
                * d_ratio,
        }
    };
    (0..2).flat_map(move |range| (0..R_COUNT).map(move |i| ring(range, i)))
}

impl Lobe {
    /// Makes a lobe with Schlick's reflectance.
    pub fn new(
        model: &'static dyn Brdf,
        masking: MaskingShadowing,
        n_dot_v: f64,
        alpha: f64,
    ) -> Self {
        Self::reflecting(model, masking, FresnelWeight::Schlick, n_dot_v, alpha)
    }

    /// Makes a lobe with any weight Fc of f90.
    pub fn reflecting(
        model: &'static dyn Brdf,
        masking: MaskingShadowing,
        fresnel: FresnelWeight,
        n_dot_v: f64,
        alpha: f64,
    ) -> Self {
        let v = DVec3::new(((1.0 - n_dot_v) * (1.0 + n_dot_v)).sqrt(), 0.0, n_dot_v);
        let g1_v = g1(model, n_dot_v, alpha, masking);
        let mut nodes = Vec::with_capacity((2 * R_COUNT * PHI_COUNT) as usize);
        let mut albedos = DVec2::ZERO;
        for ring in rings(model, alpha, v) {
            for j in 0..PHI_COUNT {
                let (position, weight) = periodic_node(j, PHI_COUNT);
                let h = ring.half_vector(position);
                let v_dot_h = v.dot(h);
                // The sine form keeps l a unit vector at small alpha.
                let l = 2.0 * v_dot_h * h - v;
                if l.z <= 0.0 || v_dot_h <= 0.0 {
                    continue;
                }
                let gv = g2_from_g1(g1_v, g1(model, l.z, alpha, masking), masking) * v_dot_h
                    / (n_dot_v * ring.cos_h);
                let fc = fresnel.at(v_dot_h);
                let part = ring.weight * weight * gv * DVec2::new(1.0 - fc, fc);
                albedos += part;
                nodes.push((l, part));
            }
        }
        Self {
            model,
            masking,
            fresnel,
            alpha,
            v,
            g1_v,
            nodes,
            albedos,
        }
    }

    /// Returns the normalised lobe in a direction; `share` weighs the part of weight Fc.
    pub fn density(&self, share: f64, l: DVec3) -> f64 {
        if l.z <= 0.0 {
            return 0.0;
        }
        let h = (self.v + l).normalize();
        let fc = self.fresnel.at(self.v.dot(h));
        let parts = DVec2::new((1.0 - share) * (1.0 - fc), share * fc) / self.albedos;
        let g2 = g2_from_g1(
            self.g1_v,
            g1(self.model, l.z, self.alpha, self.masking),
            self.masking,
        );
        // f n·l, so n·l cancels.
        self.model.d(h, self.alpha) * g2 / (4.0 * self.v.z) * parts.element_sum()
    }

    /// Returns the angle from the normal to the first moment; `share` weighs the part of weight Fc.
    pub fn moment_angle(&self, share: f64) -> f64 {
        let [of_f0, of_f90] = self.moments();
        let of = of_f0.lerp(of_f90, share);
        f64::atan2(of.x * self.v.x, of.x * self.v.z + of.y)
    }

    /// Returns the first moment of each part over its integral, as shares of r and n.
    pub fn moments(&self) -> [DVec2; 2] {
        let mut x = DVec2::ZERO;
        let mut z = DVec2::ZERO;
        for (l, part) in &self.nodes {
            x += *part * l.x;
            z += *part * l.z;
        }
        let of_r = -x / (self.v.x * self.albedos);
        let of_n = z / self.albedos - of_r * self.v.z;
        [DVec2::new(of_r.x, of_n.x), DVec2::new(of_r.y, of_n.y)]
    }
}
