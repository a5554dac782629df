//! Exact texels of a level, and lookups between its texels, compared with exact ones.

use super::directions::Directions;
use super::{Truth, errors, has_width};
use crate::bake::convention::Convention;
use crate::base::math::harmonics::SmoothMap;
use crate::base::pixels::RgbImage;
use crate::instrument::environment::Environment;
use crate::instrument::environment::layout::{FilteredMap, MapLayout};
use crate::instrument::precompute::prefilter::Kernel;
use glam::DVec3;
use rayon::prelude::*;

/// Returns exact texels of a level: prefiltered radiance, or the averaged environment for a mirror
/// level.
pub fn exact(truth: &Truth, kernel: Kernel, directions: &Directions, alpha: f64) -> Vec<DVec3> {
    let map = prefiltered(truth, kernel, alpha);
    exact_of(map.as_ref(), truth.environment, directions)
}

/// Convolves the light for a level; `None` for a mirror level.
pub fn prefiltered(truth: &Truth, kernel: Kernel, alpha: f64) -> Option<SmoothMap> {
    has_width(alpha).then(|| truth.prefiltered_by(kernel, alpha))
}

/// Returns exact texels of a level whose light is convolved.
pub fn exact_of(
    map: Option<&SmoothMap>,
    environment: &Environment,
    directions: &Directions,
) -> Vec<DVec3> {
    let Some(map) = map else {
        return mirror(environment, directions);
    };
    directions
        .world
        .par_iter()
        .map(|direction| map.value(*direction))
        .collect()
}

/// Averages the environment over each texel, at least two points per texel of the environment.
pub fn mirror(environment: &Environment, directions: &Directions) -> Vec<DVec3> {
    let points = (2 * finer(environment, directions)).clamp(2, 16);
    directions.means(points, |direction| environment.radiance(direction))
}

/// Returns how many texels of the environment a texel covers along a side, rounded up.
pub fn finer(environment: &Environment, directions: &Directions) -> u32 {
    let map = &environment.image;
    let [width, height] = directions.size;
    // A cube has two faces from pole to pole and four around.
    let (rows, columns) = if directions.layout.face_count > 1 {
        (2, 4)
    } else {
        (1, 1)
    };
    map.height
        .div_ceil(rows * height)
        .max(map.width.div_ceil(columns * width))
}

/// Returns relMSE of a level at four points per texel, looked up as a GPU does: linear, across the
/// edges of faces.
pub fn between_texels(
    truth: &Truth,
    layout: &'static MapLayout,
    faces: &[RgbImage],
    convention: &Convention,
    exact_map: &SmoothMap,
) -> f64 {
    let texel = |texel: [f32; 3]| convention.scale * DVec3::from_array(texel.map(f64::from));
    let level = FilteredMap {
        layout,
        levels: vec![faces.iter().map(|face| face.map(texel)).collect()],
    };
    let size = [2 * faces[0].width, 2 * faces[0].height];
    let directions = Directions::new(layout, convention.axes, size);
    let found: Vec<DVec3> = directions
        .world
        .par_iter()
        .map(|world| level.value(convention.axes.to_file(*world), 0.0))
        .collect();
    let exact = exact_of(Some(exact_map), truth.environment, &directions);
    errors(&directions, &found, &exact, truth.epsilon(), 1.0).relmse
}
