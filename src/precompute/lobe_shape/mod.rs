//! Where the lobe of a surface points and how wide it is, so that one lookup of the prefiltered map can replace it.
//!
//! Schlick's Fresnel splits the lobe `f n·l` into parts of weights 1 - Fc and Fc; A and B are their integrals. The
//! table has the first moment `∫ l dl` of each part over its integral, as `x r + y n`: r the mirror direction, n the
//! normal. Of the light reflected for an f0, the second part has the share `s = B/(f0 A + B)`. So the first moment of
//! the lobe is linear in s, and m is the unit vector along it.
//!
//! The width is the one of the prefiltered map's kernel K_a, about m, closest to the normalised lobe ŵ: by `∫ (K_a -
//! ŵ)²`, and by `∫ (K_a - ŵ)² / (b + ŵ)²` ([`Objective`]). No environment enters.
//!
//! There is a table for each model, masking and weight of prefiltered maps. Its axes are `√n_dot_v` and perceptual
//! roughness, with nodes at both ends of each. Three parts lie below each other: the moments (x, y of the part 1 - Fc,
//! then of Fc), and the widths by each objective, as `√(a/alpha)` for s = 0, 1/2, 1.

mod fit;
pub(crate) mod rule;
mod table;

use crate::brdf::{Brdf, MaskingShadowing, alpha_from_perceptual_roughness, perceptual_roughness_from_alpha};
use crate::glsl::constants::{ALPHA_MIN, COSINE_MIN, LOBE_SHAPE_PARTS, LOBE_SHAPE_SIDE};
use crate::precompute::prefilter::Kernel;
use fit::Widths;
pub use fit::{AMBIENT, Objective};
use glam::{DVec2, DVec3};
use rayon::prelude::*;
pub use rule::Lobe;
pub use table::LobeTable;

/// Shares of the part of weight Fc for which the table has widths.
pub const SHARES: [f64; 3] = [0.0, 0.5, 1.0];

/// Objectives of the table's widths, part by part.
pub const OBJECTIVES: [Objective; 2] = [Objective::Square, Objective::Relative];

/// The contents of a node.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LobeShape {
    /// First moments of the parts of weights 1 - Fc and Fc over their integrals, as shares of r and n.
    pub moments: [DVec2; 2],
    /// `√(a/alpha)` by [`OBJECTIVES`] and [`SHARES`].
    pub width_ratios: [[f64; 3]; 2],
}

/// Returns `(n_dot_v, alpha)` of a node.
pub fn parameters_from_node(node: [u32; 2]) -> DVec2 {
    let at = DVec2::new(node[0].into(), node[1].into()) / f64::from(LOBE_SHAPE_SIDE - 1);
    // Closer to the normal the share of r is 0/0.
    let n_dot_v = (at.x * at.x).clamp(COSINE_MIN.into(), 1.0 - 1e-6);
    DVec2::new(n_dot_v, alpha_from_perceptual_roughness(at.y).max(ALPHA_MIN.into()))
}

/// Returns the texture coordinates of a lookup in a part of the table.
pub fn uv_from_parameters(n_dot_v: f64, alpha: f64, part: u32) -> DVec2 {
    let (side, parts) = (f64::from(LOBE_SHAPE_SIDE), f64::from(LOBE_SHAPE_PARTS));
    let texel = DVec2::new(n_dot_v.sqrt(), perceptual_roughness_from_alpha(alpha)) * (side - 1.0) + 0.5;
    DVec2::new(texel.x, texel.y + f64::from(part) * side) / DVec2::new(side, side * parts)
}

/// Computes the shapes of a model's lobes, for maps prefiltered by a kernel.
pub struct LobeShapes {
    widths: Widths,
    brdf: &'static dyn Brdf,
    masking: MaskingShadowing,
}

impl LobeShapes {
    pub fn new(kernel: Kernel, masking: MaskingShadowing) -> Self {
        Self { widths: Widths::new(kernel), brdf: kernel.brdf, masking }
    }

    /// Computes the shape for one view, `n_dot_v` below 1.
    pub fn at(&self, n_dot_v: f64, alpha: f64) -> LobeShape {
        let lobe = Lobe::new(self.brdf, self.masking, n_dot_v, alpha);
        let moments = lobe.moments();
        let fits = SHARES.map(|share| {
            let [x, y] = moments[0].lerp(moments[1], share).to_array();
            let m = (x * lobe.mirror() + y * DVec3::Z).normalize();
            self.widths.fit(&lobe, share, m, OBJECTIVES).map(|width| (width / alpha).sqrt())
        });
        LobeShape { moments, width_ratios: [0, 1].map(|objective| fits.map(|fit| fit[objective])) }
    }
}

/// Computes the texels of a table, row by row.
pub fn texels(kernel: Kernel, masking: MaskingShadowing) -> Vec<[f32; 4]> {
    let (shapes, side) = (LobeShapes::new(kernel, masking), LOBE_SHAPE_SIDE);
    let nodes: Vec<[u32; 2]> = (0..side).flat_map(|y| (0..side).map(move |x| [x, y])).collect();
    let shape = |node: &[u32; 2]| {
        let DVec2 { x: n_dot_v, y: alpha } = parameters_from_node(*node);
        shapes.at(n_dot_v, alpha)
    };
    let shapes: Vec<LobeShape> = nodes.par_iter().map(shape).collect();
    let moments = shapes.iter().map(|LobeShape { moments: [a, b], .. }| [a.x, a.y, b.x, b.y]);
    let widths = |objective: usize| {
        let ratios = shapes.iter().map(move |shape| shape.width_ratios[objective]);
        ratios.map(|[low, middle, high]| [low, middle, high, 1.0])
    };
    moments.chain(widths(0)).chain(widths(1)).map(|texel| texel.map(|x| x as f32)).collect()
}
