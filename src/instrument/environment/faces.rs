//! Images of the six faces of a cube, which are not lat-long maps.

use super::error::{EnvironmentError, not_radiance};
use crate::base::pixels::RgbImage;

/// Refuses the six faces of a cube, which as a lat-long map would be another light.
pub(super) fn check_not_a_strip(spec: &str, image: &RgbImage) -> Result<(), EnvironmentError> {
    let is_strip = image.width == 6 * image.height || image.height == 6 * image.width;
    if !is_strip {
        return Ok(());
    }
    let what = format!(
        "it is {}x{}, a strip of six faces; expected a lat-long map, twice as wide as high",
        image.width, image.height
    );
    Err(not_radiance(spec, what))
}

/// Squares of a cross that hold no face, by column and row: of 4x3 squares, and of 3x4.
const UNUSED_ACROSS: [[u32; 2]; 6] = [[0, 0], [2, 0], [3, 0], [0, 2], [2, 2], [3, 2]];
const UNUSED_DOWN: [[u32; 2]; 6] = [[0, 0], [2, 0], [0, 2], [2, 2], [0, 3], [2, 3]];

/// Refuses the six faces of a cube in a cross: the squares beside its arms are empty.
pub(super) fn check_not_a_cross(spec: &str, image: &RgbImage) -> Result<(), EnvironmentError> {
    let RgbImage { width, height, .. } = *image;
    let is_cross = 3 * width == 4 * height && has_empty_squares(image, width / 4, UNUSED_ACROSS)
        || 4 * width == 3 * height && has_empty_squares(image, height / 4, UNUSED_DOWN);
    if !is_cross {
        return Ok(());
    }
    let what = format!(
        "it is {width}x{height}, a cross of six faces; expected a lat-long map, twice as wide as high"
    );
    Err(not_radiance(spec, what))
}

/// Whether these squares have one value, and the image has others.
fn has_empty_squares(image: &RgbImage, side: u32, squares: [[u32; 2]; 6]) -> bool {
    let first = image.get(0, 0);
    let is_empty = |[column, row]: [u32; 2]| {
        let mut texels = (0..side).flat_map(|y| (0..side).map(move |x| (x, y)));
        texels.all(|(x, y)| image.get(side * column + x, side * row + y) == first)
    };
    side > 0 && squares.into_iter().all(is_empty) && image.data.iter().any(|texel| *texel != first)
}
