//! The table of taps, and lookups in it.

use super::chain::Chain;
use super::nodes::{Nodes, SIDE, parameters_from_node};
use super::{F0, TapCount};
use crate::base::pixels::Pixels;
use crate::base::pixels::lookup::{Wrap, bilinear};
use crate::instrument::brdf::{
    Brdf, FresnelWeight, MaskingShadowing, perceptual_roughness_from_alpha,
};
use glam::{DVec2, DVec3, DVec4};

/// Texels of a table. Halves by f0, parts and rows as in the parent module.
#[derive(Clone, Debug)]
pub struct TapTable {
    pub texels: Pixels<[f32; 4]>,
}

/// Returns the share in [0, 1] of the taps for f0 = 0.04; the rest of the mix are the taps for f0 =
/// 1.
///
/// Of the light reflected for an f0, the part of weight Fc has the share `s = B/(f0 A + B)`; this
/// is how far s is from its value at 1 to its value at 0.04.
pub fn dielectric_share(f0: f64, [a, b]: [f64; 2]) -> f64 {
    ((1.0 - f0) * (F0[1] * a + b) / ((1.0 - F0[1]) * (f0 * a + b))).clamp(0.0, 1.0)
}

/// Returns the number of parts for one f0: pairs of taps, and the weights of several.
fn part_count(count: TapCount) -> usize {
    count as usize / 2 + 1
}

impl TapTable {
    pub fn size(count: TapCount) -> [u32; 2] {
        [SIDE as u32, (F0.len() * part_count(count) * SIDE) as u32]
    }

    /// Fits taps to lobes with Schlick's reflectance.
    pub fn fit(
        chain: &Chain,
        brdf: &'static dyn Brdf,
        masking: MaskingShadowing,
        count: TapCount,
    ) -> Self {
        Self::fit_reflecting(chain, brdf, masking, FresnelWeight::Schlick, count)
    }

    /// Fits taps to lobes with any weight Fc of f90.
    pub fn fit_reflecting(
        chain: &Chain,
        brdf: &'static dyn Brdf,
        masking: MaskingShadowing,
        fresnel: FresnelWeight,
        count: TapCount,
    ) -> Self {
        let nodes = Nodes::new(chain, brdf, masking, fresnel, count);
        let mut parts: Vec<Vec<[f32; 4]>> = Vec::new();
        for f0 in 0..F0.len() {
            let of_node = |at: [usize; 2]| {
                let theta = parameters_from_node(at).x.acos();
                let taps = nodes.taps(f0, at);
                let pairs = taps.chunks(2).map(|pair| {
                    let channel = |k: usize| {
                        pair.get(k / 2)
                            .map_or(0.0, |tap| [tap.mirror_share(theta), tap.level][k % 2])
                    };
                    [0, 1, 2, 3].map(channel)
                });
                let weight = |k: usize| taps.get(k).map_or(0.0, |tap| tap.weight);
                let weights = [weight(0), weight(1), weight(2), weight(3)];
                pairs
                    .chain([weights])
                    .map(|texel| texel.map(|x| x as f32))
                    .collect::<Vec<_>>()
            };
            let texels: Vec<Vec<[f32; 4]>> = (0..SIDE)
                .flat_map(|y| (0..SIDE).map(move |x| [x, y]))
                .map(of_node)
                .collect();
            parts.extend((0..part_count(count)).map(|part| {
                texels
                    .iter()
                    .map(|of_node| of_node[part])
                    .collect::<Vec<_>>()
            }));
        }
        let [width, height] = Self::size(count);
        Self {
            texels: Pixels::new(width, height, parts.concat()),
        }
    }

    /// Returns place between n and r, level and weight of each tap; `dielectric` is the
    /// [`dielectric_share`].
    pub fn taps(&self, n_dot_v: f64, alpha: f64, dielectric: f64) -> Vec<[f64; 3]> {
        let side = f64::from(self.texels.width);
        let height = f64::from(self.texels.height);
        let of_f0 = self.texels.height / self.texels.width / F0.len() as u32;
        let at = DVec2::new(
            n_dot_v.clamp(0.0, 1.0).sqrt(),
            perceptual_roughness_from_alpha(alpha),
        ) * (side - 1.0)
            + 0.5;
        let lookup = |part: u32| {
            let uv = (at + DVec2::new(0.0, f64::from(part) * side)) / DVec2::new(side, height);
            let of = |channels: fn(DVec4) -> DVec3| {
                bilinear(&self.texels, uv, Wrap::CLAMP, |texel| {
                    channels(DVec4::from_array(texel.map(f64::from)))
                })
            };
            of(DVec4::truncate).extend(of(|texel| DVec3::splat(texel.w)).x)
        };
        let part = |part: u32| {
            lookup(part)
                .lerp(lookup(of_f0 + part), dielectric)
                .to_array()
        };
        if of_f0 == part_count(TapCount::One) as u32 {
            let [place, level, ..] = part(0);
            return vec![[place, level, 1.0]];
        }
        let weights = part(of_f0 - 1);
        let pairs = (0..of_f0 - 1).flat_map(|pair| {
            let [first, of_first, second, of_second] = part(pair);
            [[first, of_first], [second, of_second]]
        });
        pairs
            .zip(weights)
            .map(|([place, level], weight)| [place, level, weight])
            .collect()
    }
}
