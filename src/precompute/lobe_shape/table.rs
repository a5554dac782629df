//! Lookups in a table of lobe shapes.

use super::{OBJECTIVES, Objective, texels, uv_from_parameters};
use crate::brdf::{MaskingShadowing, reflect};
use crate::glsl::constants::{LOBE_SHAPE_PARTS, LOBE_SHAPE_SIDE};
use crate::pixels::Pixels;
use crate::pixels::lookup::{Wrap, bilinear};
use crate::precompute::prefilter::Kernel;
use glam::{DVec3, DVec4};

#[derive(Clone, Debug)]
pub struct LobeTable {
    /// The parts below each other, in the order of the parent module.
    pub texels: Pixels<DVec4>,
}

impl LobeTable {
    /// Makes the table of a model's lobes for maps prefiltered by a kernel, rounded to f32 as on the device.
    pub fn new(kernel: Kernel, masking: MaskingShadowing) -> Self {
        let texels = texels(kernel, masking).iter().map(|texel| DVec4::from_array(texel.map(f64::from))).collect();
        Self { texels: Pixels::new(LOBE_SHAPE_SIDE, LOBE_SHAPE_PARTS * LOBE_SHAPE_SIDE, texels) }
    }

    /// Returns the unit direction of the lookup, for unit vectors n and v and the `share` in [0, 1] of weight Fc.
    pub fn direction(&self, [n, v]: [DVec3; 2], alpha: f64, share: f64) -> DVec3 {
        let of = |channels| self.lookup(n.dot(v), alpha, 0, channels);
        let [of_a, of_b] = [of(|t| DVec3::new(t.x, t.y, 0.0)), of(|t| DVec3::new(t.z, t.w, 0.0))];
        let moment = of_a.lerp(of_b, share);
        (moment.x * reflect(v, n) + moment.y * n).normalize()
    }

    /// Returns the width alpha of the level to look up, by an objective.
    pub fn width(&self, n_dot_v: f64, alpha: f64, share: f64, objective: Objective) -> f64 {
        let part = 1 + OBJECTIVES.iter().position(|listed| *listed == objective).expect("a listed objective") as u32;
        let [low, middle, high] = self.lookup(n_dot_v, alpha, part, DVec4::truncate).to_array();
        // A parabola through the three.
        let ratio = low + share * ((4.0 * middle - 3.0 * low - high) + share * 2.0 * (low - 2.0 * middle + high));
        (alpha * ratio * ratio).min(1.0)
    }

    fn lookup(&self, n_dot_v: f64, alpha: f64, part: u32, channels: fn(DVec4) -> DVec3) -> DVec3 {
        bilinear(&self.texels, uv_from_parameters(n_dot_v, alpha, part), Wrap::CLAMP, channels)
    }
}
