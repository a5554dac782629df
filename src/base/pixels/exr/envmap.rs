//! The attribute `envmap`: lat-long maps and cubes as OpenEXR's library defines them.

use crate::base::pixels::file::Fault;
use crate::base::pixels::{Projection, RgbImage, TexelPosition};
use ::exr::meta::attribute::EnvironmentMap;
use ::exr::meta::header::Header;
use glam::DMat3;

/// Returns the projection that a header states. Faces of a cube are turned to Vulkan's layout.
pub(super) fn projection(header: &Header, rgb: &mut RgbImage) -> Result<Option<Projection>, Fault> {
    match header.own_attributes.environment_map {
        None => Ok(None),
        Some(EnvironmentMap::LatitudeLongitude) => Ok(Some(Projection::LatLong)),
        Some(EnvironmentMap::Cube) => {
            if rgb.height != 6 * rgb.width {
                return Err(Fault::new(
                    format!(
                        "is a cube map by its header, but has {}x{} pixels",
                        rgb.width, rgb.height
                    ),
                    "six square faces below each other",
                ));
            }
            turn_faces(rgb);
            // The outermost texels of a face are shared with its neighbours (ImfEnvmap.h).
            Ok(Some(Projection::Cube {
                texels: TexelPosition::Edges,
                file_from_world: DMat3::IDENTITY,
            }))
        }
    }
}

/// Turns the faces +x, -x, +y, -y, +z, -z from OpenEXR's layout to Vulkan's, or back: OpenEXR shows
/// them from outside, so ±y are upside down and the others mirrored.
fn turn_faces(strip: &mut RgbImage) {
    let side = strip.width as usize;
    for (face, texels) in strip.data.chunks_exact_mut(side * side).enumerate() {
        let is_y = face / 2 == 1;
        if is_y {
            for row in 0..side / 2 {
                let (above, below) = texels.split_at_mut((side - 1 - row) * side);
                above[row * side..][..side].swap_with_slice(&mut below[..side]);
            }
        } else {
            texels.chunks_exact_mut(side).for_each(<[_]>::reverse);
        }
    }
}
