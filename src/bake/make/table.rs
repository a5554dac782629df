//! The DFG table of a bake.

use crate::bake::convention::TableAxes;
use crate::bake::judge::table;
use crate::base::glsl::constants::ALPHA_MIN;
use crate::base::pixels::RgbImage;
use crate::instrument::brdf::{Brdf, MaskingShadowing, alpha_from_perceptual_roughness, g1};
use crate::instrument::precompute::dfg::chebyshev;
use glam::DVec2;

/// Bound on the relative error of a table's integrals. True errors are at most 7.5e-5 (GGX and
/// Beckmann, 289 texels of 128x128); [`chebyshev`] adds at most 1e-4.
const TABLE_WITHIN: f64 = 1e-2;

/// Computes A and B at texel centres.
pub fn dfg(
    brdf: &'static dyn Brdf,
    masking: MaskingShadowing,
    axes: &TableAxes,
    side: u32,
) -> RgbImage {
    // Walter's fit of G1 has a kink where no polynomial is close; without its error A and B are
    // smooth.
    let smooth = if masking == MaskingShadowing::Schlick {
        masking
    } else {
        MaskingShadowing::SmithExact
    };
    let kink = |parameters: DVec2| {
        let alpha = alpha_from_perceptual_roughness(parameters.y).max(ALPHA_MIN.into());
        g1(brdf, parameters.x, alpha, masking) / g1(brdf, parameters.x, alpha, smooth)
    };
    let table = chebyshev::table(side, |parameters| {
        table::exact(brdf, masking, parameters, TABLE_WITHIN) / kink(parameters)
    });
    let size = f64::from(side);
    RgbImage::from_fn(side, side, |x, y| {
        let uv = (DVec2::new(x.into(), y.into()) + 0.5) / size;
        let parameters = axes.parameters(uv);
        let [x, y] = (size * parameters).to_array().map(|x| x as u32);
        (kink(parameters) * table.get(x, y))
            .extend(0.0)
            .as_vec3()
            .to_array()
    })
}
