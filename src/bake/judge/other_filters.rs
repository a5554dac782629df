//! Levels of cubes whose faces were filtered one by one.

use super::cause::Cause;
use super::directions::Directions;
use super::exact::mirror;
use super::sample::{Sample, Slipped};
use crate::bake::container::FACE_COUNT;
use crate::instrument::environment::layout::LAYOUTS;
use crate::instrument::precompute::prefilter::Kernel;
use glam::DVec3;
use rayon::prelude::*;

/// Side of the faces that are filtered one by one, texels: a twentieth of a radian.
const FACE_SIDE: u32 = 40;
/// Lobes narrower than this have too few texels in such a face.
const FACE_ALPHA_MIN: f64 = 0.05;
/// Smallest sum of weights that is divided by.
const SUM_MIN: f64 = 1e-30;

impl Sample<'_, '_> {
    /// The level whose texels average the light of their own face only.
    pub fn faces_alone(&self) -> Option<Slipped> {
        let level = self.level;
        let is_cube = level.directions.layout.face_count as usize == FACE_COUNT;
        if !is_cube || level.alpha < FACE_ALPHA_MIN || self.is_irradiance() {
            return None;
        }
        let light = Directions::new(&LAYOUTS[0], level.directions.axes, [FACE_SIDE; 2]);
        let radiance = mirror(level.truth.environment, &light);
        let texel_count = (FACE_SIDE * FACE_SIDE) as usize;
        // A level is not shared between threads.
        let kernel = level.kernel;
        let alpha = level.alpha;
        let directions = &self.directions;
        let value = |index: usize| {
            let r = directions.world[index];
            let [face, _, _] = directions.texel_of(index);
            let mut sum = DVec3::ZERO;
            let mut whole = 0.0;
            let texels = face * texel_count..(face + 1) * texel_count;
            let solid_angles = &light.weights[texels.clone()];
            let world = &light.world[texels.clone()];
            for ((solid_angle, l), color) in solid_angles.iter().zip(world).zip(&radiance[texels]) {
                let weight = solid_angle * lobe(&kernel, alpha, r, *l);
                sum += weight * *color;
                whole += weight;
            }
            sum / f64::max(whole, SUM_MIN)
        };
        let values = (0..directions.world.len())
            .into_par_iter()
            .map(value)
            .collect();
        Some(Slipped::one(Cause::FacesAlone, values))
    }
}

/// Returns the kernel about r at a direction of light.
fn lobe(kernel: &Kernel, alpha: f64, r: DVec3, l: DVec3) -> f64 {
    let cos = r.dot(l);
    if cos <= 0.0 {
        return 0.0;
    }
    let half = (0.5 * (1.0 + cos)).sqrt();
    kernel.weight(alpha, cos) * d(kernel, alpha, half)
}

fn d(kernel: &Kernel, alpha: f64, n_dot_h: f64) -> f64 {
    let h = DVec3::new((1.0 - n_dot_h * n_dot_h).max(0.0).sqrt(), 0.0, n_dot_h);
    kernel.brdf.d(h, alpha)
}
