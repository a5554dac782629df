//! Samples that read mips of a cube or of a lat-long map.
//!
//! Mips average four texels each, whatever solid angle these have. So a lat-long map's hold too much
//! of the light at the poles (VTK 9.7.1, `vtkPBRPrefilterTexture`), and a cube's too much of its
//! corners (PlayCanvas 2.23.3, `reprojectTexture`): a level of coarse ones has another mean.

use super::directions::Directions;
use super::exact::mirror;
use super::sampled_lobe::SampledLobe;
use crate::bake::convention::Axes;
use crate::base::names::Listed;
use crate::base::pixels::Pixels;
use crate::instrument::environment::Environment;
use crate::instrument::environment::layout::{FilteredMap, MapLayout};
use glam::DVec3;
use rayon::prelude::*;
use std::f64::consts::{PI, TAU};

/// Step of the rings of a lobe in `ln tan(γ/2)`, and the directions in a ring: denser than the
/// blurs are wide.
const RING_STEP: f64 = 0.25;
const RING_COUNT: u32 = 20;
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

/// A direction of light about +z.
struct Light {
    local: DVec3,
    weight: f64,
    mip: f64,
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

    /// Returns the level whose samples read mips these many levels too coarse.
    pub fn level(
        &self,
        lobe: SampledLobe,
        alpha: f64,
        levels: f64,
        directions: &Directions,
    ) -> Vec<DVec3> {
        let lights = self.lights(lobe, alpha, levels);
        let whole: f64 = lights.iter().map(|light| light.weight).sum();
        let value = |r: &DVec3| {
            let (right, up) = r.any_orthonormal_pair();
            let radiance = |light: &Light| {
                let world = right * light.local.x + up * light.local.y + *r * light.local.z;
                light.weight * self.map.value(world, light.mip)
            };
            lights.iter().map(radiance).sum::<DVec3>() / whole
        };
        directions.world.par_iter().map(value).collect()
    }

    fn lights(&self, lobe: SampledLobe, alpha: f64, levels: f64) -> Vec<Light> {
        let rings = lobe.rings(alpha, |_| RING_STEP);
        let whole: f64 = rings.iter().map(|ring| ring.weight).sum();
        let least = LEFT_OUT * whole / rings.len() as f64;
        let mut lights = Vec::new();
        for (index, ring) in rings.iter().enumerate() {
            if ring.weight < least {
                continue;
            }
            let sin = (1.0 - ring.cos * ring.cos).max(0.0).sqrt();
            let mip = levels + 0.5 * (ring.solid_angle / self.texel_angle).log2();
            lights.extend((0..RING_COUNT).map(|k| {
                let turn = TAU * f64::from(k) / f64::from(RING_COUNT);
                let phi = turn + RING_TURN * index as f64;
                Light {
                    local: DVec3::new(sin * phi.cos(), sin * phi.sin(), ring.cos),
                    weight: ring.weight,
                    mip,
                }
            }));
        }
        lights
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
