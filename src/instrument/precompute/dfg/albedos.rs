//! The directional albedo of one lobe by n·v, for lookups at many views.

use super::reference::{dfg_within, weight_means};
use crate::base::glsl::constants::{ALBEDO_NODES, ALBEDO_ROOT_MIN};
use crate::instrument::brdf::MaskingShadowing;
use crate::instrument::precompute::prefilter::Kernel;
use glam::{DVec2, DVec4, Vec4Swizzles};
use rayon::prelude::*;

/// The part of constant radiance that a lobe reflects, by n·v.
#[derive(Clone, Debug)]
pub struct Albedos {
    /// `[A, B, ∫ K (1 - Fc), ∫ K Fc]`, K with approximated masking, at n·v = s², s from
    /// [`Albedos::S_MIN`] to 1.
    nodes: Vec<DVec4>,
}

impl Albedos {
    const COUNT: usize = ALBEDO_NODES as usize;
    /// Smaller values of √(n·v) are clamped to this.
    const S_MIN: f64 = 0.01;
    const _AS_IN_SHADERS: () = assert!(Self::S_MIN as f32 == ALBEDO_ROOT_MIN);
    /// Relative error of a node: a tenth of the interpolation error.
    const WITHIN: f64 = 5e-6;

    pub fn new(kernel: Kernel, masking: MaskingShadowing, alpha: f64) -> Self {
        let node = |i: usize| {
            let s = Self::S_MIN + (1.0 - Self::S_MIN) * i as f64 / (Self::COUNT - 1) as f64;
            let (exact, [below, grazing]) = (
                dfg_within(kernel.brdf, masking, s * s, alpha, Self::WITHIN),
                weight_means(kernel, s * s, alpha, Self::WITHIN),
            );
            DVec4::new(exact.f0_scale, exact.f90_scale, below, grazing)
        };
        Self {
            nodes: (0..Self::COUNT).into_par_iter().map(node).collect(),
        }
    }

    /// Interpolates cubically between nodes.
    fn interpolated(&self, n_dot_v: f64) -> DVec4 {
        let last = (Self::COUNT - 1) as f64;
        let position =
            ((n_dot_v.sqrt() - Self::S_MIN) / (1.0 - Self::S_MIN) * last).clamp(0.0, last);
        let first = (position.floor() - 1.0).clamp(0.0, last - 3.0);
        let t = position - first;
        let weight = |i: usize| -> f64 {
            (0..4)
                .filter(|j| *j != i)
                .map(|j| (t - j as f64) / (i as f64 - j as f64))
                .product()
        };
        (0..4)
            .map(|i| weight(i) * self.nodes[first as usize + i])
            .sum()
    }

    /// Returns (A, B).
    pub fn exact(&self, n_dot_v: f64) -> DVec2 {
        self.interpolated(n_dot_v).xy()
    }

    /// Returns (A, B) at the nodes, as shaders read them.
    #[cfg(feature = "gpu")]
    pub fn exact_nodes(&self) -> impl Iterator<Item = [f32; 2]> {
        self.nodes.iter().map(|node| node.xy().as_vec2().to_array())
    }

    /// Returns `∫ K (1 - Fc)` and `∫ K Fc`.
    pub fn weighted(&self, n_dot_v: f64) -> DVec2 {
        self.interpolated(n_dot_v).zw()
    }
}
