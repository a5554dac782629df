//! Samples that read mips of a cube or of a lat-long map.
//!
//! Mips average four texels each, whatever solid angle these have. So a lat-long map's hold too much
//! of the light at the poles (VTK 9.7.1, `vtkPBRPrefilterTexture`), and a cube's too much of its
//! corners (PlayCanvas 2.23.3, `reprojectTexture`): a level of coarse ones has another mean.

use super::directions::Directions;
use super::exact::mirror;
use super::sampled_lobe::{Ring, SampledLobe};
use crate::bake::convention::Axes;
use crate::base::names::Listed;
use crate::base::pixels::Pixels;
use crate::instrument::environment::Environment;
use crate::instrument::environment::layout::{FilteredMap, MapLayout};
use glam::DVec3;
use rayon::prelude::*;
use std::f64::consts::{PI, TAU};
use std::ops::Range;

/// Steps of the rings of a lobe in `ln tan(γ/2)`. Samples of irradiance blur the least for the width
/// of their lobe.
const RING_STEP: f64 = 0.125;
const RING_STEP_OF_IRRADIANCE: f64 = 0.0625;
/// Fewest and most directions in a ring: as far apart as the texels that are read.
const RING_COUNT_MIN: f64 = 4.0;
const RING_COUNT_MAX: f64 = 100.0;
/// Turn from ring to ring, so that directions do not line up: the golden angle, rad.
const RING_TURN: f64 = 2.399_963_229_728_653;
/// Largest share of a lobe that rings may leave out.
const LEFT_OUT: f64 = 1e-4;
/// Largest side of a cube's face, texels: coarse mips need no finer ones.
const SIDE_MAX: u32 = 128;

/// The texture whose mips the samples of a level read.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum MipSource {
    /// Texels of about equal solid angle, as of a cube.
    Cube,
    /// A lat-long map, whose mips average rows without their solid angles.
    LatLong,
}

/// A map and its mips.
pub struct MipChain {
    map: FilteredMap,
    /// Solid angle of a texel of the finest level, in the mean.
    texel_angle: f64,
}

/// Light at one angle to the middle of a lobe. Its samples read one mip.
struct MipRing {
    weight: f64,
    /// Mip whose texels are as large as a sample. It may lie outside the chain.
    mip: f64,
    /// Mips that are averaged.
    mips: Range<usize>,
    /// Directions about +z.
    local: Vec<DVec3>,
}

/// The mips of a chain, averaged over the rings of a lobe about each compared direction. A level of
/// samples that read any mips is a sum of these.
pub struct RingMeans {
    rings: Vec<MipRing>,
    /// By direction: the means of each ring, one for each of its mips.
    means: Vec<Vec<DVec3>>,
}

impl MipChain {
    pub fn new(environment: &Environment, source: MipSource) -> Self {
        let image = &environment.image;
        let (layout, finest) = match source {
            MipSource::LatLong => {
                let texel = |texel: [f32; 3]| DVec3::from_array(texel.map(f64::from));
                (MapLayout::listed("equirect"), vec![image.map(texel)])
            }
            MipSource::Cube => {
                let layout = MapLayout::listed("cube");
                let side = image.height.next_power_of_two().min(SIDE_MAX);
                let directions = Directions::new(layout, Axes::SAME, [side; 2]);
                let texels = mirror(environment, &directions);
                let faces = texels.chunks_exact((side * side) as usize);
                let face = |face: &[DVec3]| Pixels::new(side, side, face.to_vec());
                (layout, faces.map(face).collect())
            }
        };
        Self::of_finest(layout, finest)
    }

    fn of_finest(layout: &'static MapLayout, finest: Vec<Pixels<DVec3>>) -> Self {
        let texel_count: usize = finest.iter().map(|face| face.data.len()).sum();
        let mut levels = vec![finest];
        while levels[levels.len() - 1][0].height > 1 {
            let next = levels[levels.len() - 1].iter().map(halved).collect();
            levels.push(next);
        }
        Self {
            map: FilteredMap { layout, levels },
            texel_angle: 4.0 * PI / texel_count as f64,
        }
    }

    /// Averages the mips over the rings of a lobe, for samples that read mips too coarse by a number
    /// of levels in a range.
    pub fn ring_means(
        &self,
        lobe: SampledLobe,
        alpha: f64,
        levels: [f64; 2],
        directions: &Directions,
    ) -> RingMeans {
        let rings = self.rings(lobe, alpha, levels);
        let means_about = |r: &DVec3| {
            let (right, up) = r.any_orthonormal_pair();
            let mut means = Vec::with_capacity(rings.iter().map(|ring| ring.mips.len()).sum());
            for ring in &rings {
                let first = means.len();
                means.resize(first + ring.mips.len(), DVec3::ZERO);
                for local in &ring.local {
                    let world = right * local.x + up * local.y + *r * local.z;
                    let values = self.map.level_values(world, ring.mips.clone());
                    for (mean, value) in means[first..].iter_mut().zip(values) {
                        *mean += value / ring.local.len() as f64;
                    }
                }
            }
            means
        };
        RingMeans {
            means: directions.world.par_iter().map(means_about).collect(),
            rings,
        }
    }

    fn rings(&self, lobe: SampledLobe, alpha: f64, levels: [f64; 2]) -> Vec<MipRing> {
        let step = if lobe.is_irradiance {
            RING_STEP_OF_IRRADIANCE
        } else {
            RING_STEP
        };
        let rings = lobe.rings(alpha, |_| step);
        let whole: f64 = rings.iter().map(|ring| ring.weight).sum();
        let least = LEFT_OUT * whole / rings.len() as f64;
        let last = self.map.levels.len() - 1;
        let mip_ring = |(index, ring): (usize, &Ring)| {
            let sin = (1.0 - ring.cos * ring.cos).max(0.0).sqrt();
            let mip = 0.5 * (ring.solid_angle / self.texel_angle).log2();
            let read = levels.map(|levels| (mip + levels).clamp(0.0, last as f64));
            // The finest texels that are read.
            let side = (self.texel_angle * (2.0 * read[0]).exp2()).sqrt();
            let count = (TAU * sin / side)
                .ceil()
                .clamp(RING_COUNT_MIN, RING_COUNT_MAX);
            let direction = |k: u32| {
                let phi = TAU * f64::from(k) / count + RING_TURN * index as f64;
                DVec3::new(sin * phi.cos(), sin * phi.sin(), ring.cos)
            };
            MipRing {
                weight: ring.weight,
                mip,
                mips: read[0].floor() as usize..read[1].ceil() as usize + 1,
                local: (0..count as u32).map(direction).collect(),
            }
        };
        rings
            .iter()
            .enumerate()
            .filter(|(_, ring)| ring.weight >= least)
            .map(mip_ring)
            .collect()
    }
}

impl RingMeans {
    /// Returns the level whose samples read mips these many levels too coarse.
    pub fn level(&self, levels: f64) -> Vec<DVec3> {
        let whole: f64 = self.rings.iter().map(|ring| ring.weight).sum();
        let value = |means: &Vec<DVec3>| {
            let mut sum = DVec3::ZERO;
            let mut first = 0;
            for ring in &self.rings {
                let mips = &means[first..first + ring.mips.len()];
                sum += ring.weight * ring.lookup(mips, levels);
                first += ring.mips.len();
            }
            sum / whole
        };
        self.means.iter().map(value).collect()
    }
}

impl MipRing {
    /// Interpolates between the means of its mips, these many levels too coarse.
    fn lookup(&self, means: &[DVec3], levels: f64) -> DVec3 {
        let mip = self.mip + levels - self.mips.start as f64;
        let mip = mip.clamp(0.0, (means.len() - 1) as f64);
        let fine = mip.floor() as usize;
        let coarse = (fine + 1).min(means.len() - 1);
        means[fine].lerp(means[coarse], mip.fract())
    }
}

/// Returns the next mip.
fn halved(image: &Pixels<DVec3>) -> Pixels<DVec3> {
    let [width, height] = [image.width, image.height].map(|side| (side / 2).max(1));
    image
        .area_means(width, height, |texel| texel.to_array())
        .map(DVec3::from_array)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A ramp over the rows of a lat-long map keeps its middle in each mip; the last one holds the
    /// mean of every row, without solid angles.
    #[test]
    fn mips_of_a_ramp_keep_it() {
        let ramp = Pixels::from_fn(16, 8, |_, y| DVec3::splat(f64::from(y)));
        let chain = MipChain::of_finest(MapLayout::listed("equirect"), vec![ramp]);
        assert_eq!(chain.map.levels.len(), 4);
        for (direction, mip) in [(DVec3::Z, 0.0), (DVec3::Z, 1.5), (DVec3::Y, 9.0)] {
            let value = chain.map.value(direction, mip);
            assert!((value - 3.5).abs().max_element() < 1e-6, "{mip}: {value}");
        }
    }
}
