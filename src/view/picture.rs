//! Pictures of a frame: the image, its error, parts of the g-buffer, tables.

use crate::gbuffer::Gbuffer;
use crate::metrics::{Comparison, Epsilon};
use crate::pipeline::{Frame, LightTables, Pipeline, PipelineError};
use crate::pixels::{Pixels, Rgb8Image, RgbImage};
use crate::scene::Camera;
use crate::spelling::{Listed, listed};
use crate::table::colormap::{ColorScale, RELATIVE_ERROR, SIGNED_ERROR};
use crate::tonemap::ToneCurve;
use glam::DVec3;

/// Colour of errors and of the g-buffer beside the scene.
pub const GROUND: [u8; 3] = [0x31, 0x36, 0x3b];

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Picture {
    Image,
    Error,
    Signed,
    Difference,
    Position,
    Normal,
    NDotV,
    Albedo,
    Metallic,
    Alpha,
    F0,
    Prefiltered,
    Dfg,
}

listed!(Picture, "picture", {
    "image": Image,
    "error": Error,
    "signed error": Signed,
    "difference": Difference,
    "position": Position,
    "normal": Normal,
    "n·v": NDotV,
    "albedo": Albedo,
    "metallic": Metallic,
    "alpha": Alpha,
    "F0": F0,
    "prefiltered map": Prefiltered,
    "DFG table": Dfg,
});

impl Picture {
    /// Returns the colours of an error.
    pub fn scale(self) -> Option<ColorScale> {
        match self {
            Self::Error => Some(RELATIVE_ERROR),
            Self::Signed | Self::Difference => Some(SIGNED_ERROR),
            _ => None,
        }
    }

    /// Explains the colours.
    pub fn about(self) -> &'static str {
        match self {
            Self::Position => "position as a fraction of the scene's box",
            Self::Normal => "0.5 + 0.5 normal",
            Self::Alpha => "alpha, the width of the lobe",
            Self::Prefiltered => "one level; of a cube: +x -x +y above -y +z -z",
            Self::Dfg => "n·v to the right, roughness downwards; red scales F0, green is added",
            other => other.name(),
        }
    }

    pub fn has_sides(self) -> bool {
        matches!(self, Self::Image | Self::Error | Self::Signed)
    }

    /// Whether it shows a table instead of pixels.
    pub fn is_table(self) -> bool {
        matches!(self, Self::Prefiltered | Self::Dfg)
    }
}

/// How a frame becomes a picture.
#[derive(Clone, Copy, Debug)]
pub struct Look {
    pub picture: Picture,
    pub curve: ToneCurve,
    /// Level of the prefiltered map.
    pub level: u32,
}

/// Paints a half. An error needs its reference.
pub fn of_frame(
    pipeline: &mut Pipeline,
    look: Look,
    frame: &Frame,
    truth: Option<&Frame>,
    epsilon: Epsilon,
) -> Result<Rgb8Image, PipelineError> {
    let curve = look.curve;
    let Some(scale) = look.picture.scale() else {
        return Ok(pipeline.tonemap(&frame.radiance, curve)?.0);
    };
    // A scene out of sight has no error.
    let comparison = truth.map(|truth| Comparison::new(&frame.radiance, &truth.radiance, &frame.mask, curve, epsilon));
    let Some(Ok(comparison)) = comparison else {
        return Ok(Pixels::filled(frame.mask.width, frame.mask.height, GROUND));
    };
    let map = match look.picture {
        Picture::Signed | Picture::Difference => comparison.signed_error_map(),
        _ => comparison.relative_error_map(),
    };
    let mut image = scale.image(&map, &frame.mask);
    let uncovered = image.data.iter_mut().zip(&frame.mask.data).filter(|(_, covered)| **covered == 0.0);
    uncovered.for_each(|(texel, _)| *texel = GROUND);
    Ok(image)
}

/// Paints a part of the g-buffer: positions within the box `bounds`, normals as 0.5 + 0.5 n, the rest unchanged.
pub fn of_gbuffer(part: Picture, gbuffer: &Gbuffer<f32>, camera: &Camera, (low, high): (DVec3, DVec3)) -> Rgb8Image {
    let code = |xyz: [f64; 3]| xyz.map(|x| (255.0 * x.clamp(0.0, 1.0)).round() as u8);
    let three = |texel: [f32; 4]| DVec3::new(texel[0].into(), texel[1].into(), texel[2].into());
    let mask = gbuffer.mask();
    let n_dot_v = gbuffer.n_dot_v(camera);
    Pixels::from_fn(mask.width, mask.height, |x, y| {
        let normal = gbuffer.normal_alpha.get(x, y);
        let material = gbuffer.albedo_metallic.get(x, y);
        if mask.get(x, y) == 0.0 {
            return GROUND;
        }
        let side = (high - low).max(DVec3::splat(f64::MIN_POSITIVE));
        code(match part {
            Picture::Position => ((three(gbuffer.position_mask.get(x, y)) - low) / side).to_array(),
            Picture::Normal => (0.5 * three(normal) + DVec3::splat(0.5)).to_array(),
            Picture::NDotV => [n_dot_v.get(x, y).into(); 3],
            Picture::Albedo => three(material).to_array(),
            Picture::Metallic => [material[3].into(); 3],
            Picture::Alpha => [normal[3].into(); 3],
            _ => three(gbuffer.f0_material.get(x, y)).to_array(),
        })
    })
}

/// Paints a level of the prefiltered map, or the DFG table (red scales F0, green is added).
pub fn of_tables(look: Look, tables: &LightTables) -> Rgb8Image {
    if look.picture == Picture::Dfg {
        let code = |x: f32| (255.0 * x.clamp(0.0, 1.0)).round() as u8;
        return tables.dfg.map(|[a, b]| [code(a), code(b), 0]);
    }
    let level: &RgbImage = &tables.prefiltered[(look.level as usize).min(tables.prefiltered.len() - 1)];
    look.curve.apply_image(&unfolded(level))
}

/// Arranges the faces of a cube in two rows.
fn unfolded(level: &RgbImage) -> RgbImage {
    let side = level.width;
    if level.height != 6 * side {
        return level.clone();
    }
    Pixels::from_fn(3 * side, 2 * side, |x, y| level.get(x % side, (3 * (y / side) + x / side) * side + y % side))
}

/// Returns the pixel, if it is inside the image.
pub fn at<T: Copy>(image: &Pixels<T>, x: u32, y: u32) -> Option<T> {
    (x < image.width && y < image.height).then(|| image.get(x, y))
}
