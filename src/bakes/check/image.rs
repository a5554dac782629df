//! Effect of given tables on an image, rung by rung, each compared with the exact integral.
//!
//! The surfaces come from the scene `design` ([`design::frame`]). With A and B the exact directional albedo and
//! `m(r, alpha)` exact prefiltered radiance:
//!
//! 1. the split sum, `(f0 A + B) m(r, alpha)`;
//! 2. its levels: m blended linearly between exact levels;
//! 3. the map: m from the given texels;
//! 4. the table: A and B from the given texels.
//!
//! If the split sum errs far more than the tables, rungs barely move, so the last rung is also compared with the first.

use super::level::level_of;
use super::{Truth, has_width, relative_square};
use crate::bakes::convention::Convention;
use crate::bakes::parts::Bake;
use crate::brdf::{perceptual_roughness_from_alpha, reflect};
use crate::environment::layout::FilteredMap;
use crate::math::design;
use crate::math::equirect_quadrature::EquirectQuadrature;
use crate::math::harmonics::SmoothMap;
use crate::math::quadrature::Tolerance;
use crate::pixels::lookup::{Wrap, bilinear};
use crate::precompute::dfg::reference::dfg_within;
use crate::shade::reference::{Surface, specular};
use glam::{DVec2, DVec3};
use rayon::prelude::*;
use serde::Serialize;

pub const ALPHAS: [f64; 5] = [0.05, 0.1, 0.25, 0.5, 1.0];
/// F0 of a dielectric and of a perfect reflector.
const F0: [f64; 2] = [0.04, 1.0];
/// Surfaces for each width.
pub const COUNT: u32 = 128;
/// Error bounds of the integrals; true errors are at most a tenth, relMSE below 1e-8.
const WITHIN: Tolerance = Tolerance { relative: 1e-3, max_part_count: 20_000 };
const ALBEDO_WITHIN: f64 = 1e-4;

/// relMSE of each rung for one width and F0; `None` for rungs without a table.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ImageScore {
    pub alpha: f64,
    pub f0: f64,
    pub split_sum: f64,
    pub levels: Option<f64>,
    pub map: Option<f64>,
    pub table: Option<f64>,
    /// relMSE of the last rung against the first: the effect of the tables alone.
    pub alone: f64,
}

struct Looked {
    /// Radiance for F0 = 1 and 0.
    exact: [DVec3; 2],
    /// Prefiltered radiance of rungs 1 to 3.
    means: Vec<DVec3>,
    /// (A, B), exact and from the table.
    albedo: DVec2,
    table: Option<DVec2>,
}

/// Scores the effect of the map and the table; empty without either.
pub fn score(truth: &Truth, bake: &Bake, convention: &Convention) -> Result<Vec<ImageScore>, String> {
    if bake.specular.is_none() && bake.dfg.is_none() {
        return Ok(Vec::new());
    }
    let image = &truth.environment.image;
    let quadrature = EquirectQuadrature::new(image.width, image.height, |x, y| image.get(x, y));
    let frames: Vec<[DVec3; 2]> = (0..COUNT).map(|i| design::frame(i, COUNT)).collect();
    let given = match &bake.specular {
        None => None,
        Some(map) => {
            let level = |faces: &Vec<_>| {
                let texel = |texel: [f32; 3]| convention.scale * DVec3::from_array(texel.map(f64::from));
                faces.iter().map(|face: &crate::pixels::RgbImage| face.map(texel)).collect()
            };
            let levels = map.levels.iter().map(level).collect();
            let widths = convention.alphas(map.levels.len())?;
            let exact: Vec<Option<SmoothMap>> =
                widths.iter().map(|alpha| has_width(*alpha).then(|| truth.prefiltered(*alpha))).collect();
            Some((FilteredMap { layout: map.layout, levels }, widths, exact))
        }
    };
    let mut scores = Vec::new();
    for alpha in ALPHAS {
        let (kernel, masking) = (truth.kernel, convention.masking);
        let prefiltered = truth.prefiltered(alpha);
        let of_surface = |[n, v]: &[DVec3; 2]| {
            let r = reflect(*v, *n);
            let n_dot_v = n.dot(*v);
            let exact = specular(&quadrature, &Surface::new(kernel.brdf, masking, alpha, DVec3::ONE, [*n, *v]), WITHIN);
            let white = exact.combine([DVec3::ONE, DVec3::ZERO]).value;
            let grazing = exact.combine([DVec3::ZERO, DVec3::ONE]).value;
            let mut means = vec![prefiltered.value(r)];
            if let Some((map, widths, exact)) = &given {
                let last = widths.len() - 1;
                let lod = level_of(convention, widths, alpha).unwrap_or(last as f64).clamp(0.0, last as f64);
                let of_level = |k: usize| match &exact[k.min(last)] {
                    Some(map) => map.value(r),
                    None => truth.environment.radiance(r),
                };
                means.push(of_level(lod as usize).lerp(of_level(lod as usize + 1), lod.fract()));
                means.push(map.value(convention.axes.to_file(r), lod));
            }
            let table = bake.dfg.as_ref().map(|image| {
                let at = DVec2::new(n_dot_v, perceptual_roughness_from_alpha(alpha));
                let texel = |texel: [f32; 3]| DVec3::from_array(texel.map(f64::from));
                let found = bilinear(image, convention.table_axes.place(at), Wrap::CLAMP, texel);
                (convention.table_channels.pair)(found.truncate())
            });
            let albedo = dfg_within(kernel.brdf, masking, n_dot_v, alpha, ALBEDO_WITHIN);
            let albedo = DVec2::new(albedo.f0_scale, albedo.f90_scale);
            Looked { exact: [white, grazing], means, albedo, table }
        };
        let surfaces: Vec<_> = frames.par_iter().map(of_surface).collect();
        for f0 in F0 {
            let radiance = |surface: &Looked, rung: usize, by_table: bool| {
                let pair = surface.table.filter(|_| by_table).unwrap_or(surface.albedo);
                (f0 * pair.x + pair.y) * surface.means[rung]
            };
            let relmse = |rung: usize, by_table: bool, is_alone: bool| {
                let square = |surface: &Looked| {
                    let [white, grazing] = surface.exact;
                    let image = f0 * white + (1.0 - f0) * grazing;
                    let against = if is_alone { radiance(surface, 0, false) } else { image };
                    relative_square(radiance(surface, rung, by_table), against, truth.epsilon())
                };
                surfaces.iter().map(square).sum::<f64>() / f64::from(COUNT)
            };
            let last = if given.is_some() { 2 } else { 0 };
            scores.push(ImageScore {
                alpha,
                f0,
                split_sum: relmse(0, false, false),
                levels: given.as_ref().map(|_| relmse(1, false, false)),
                map: given.as_ref().map(|_| relmse(2, false, false)),
                table: bake.dfg.as_ref().map(|_| relmse(last, true, false)),
                alone: relmse(last, true, true),
            });
        }
    }
    Ok(scores)
}

pub fn in_words(scores: &[ImageScore]) -> Option<String> {
    let worst = scores.iter().max_by(|a, b| a.alone.total_cmp(&b.alone))?;
    Some(format!(
        "The tables alone move an image by {:.1} % rms at worst (alpha {}, f0 {}), where the split sum itself errs by {:.1} %",
        100.0 * worst.alone.sqrt(),
        worst.alpha,
        worst.f0,
        100.0 * worst.split_sum.sqrt()
    ))
}
