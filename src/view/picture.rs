//! Pictures of a frame: the image and its error.

use crate::base::names::listed;
use crate::base::pixels::{Pixels, Rgb8Image};
use crate::draw::colormap::{ColorScale, RELATIVE_ERROR, SIGNED_ERROR};
use crate::instrument::metrics::{Comparison, Epsilon};
use crate::instrument::pipeline::{Frame, Pipeline, PipelineError};
use crate::instrument::tonemap::ToneCurve;

/// Colour of error images off the scene.
const GROUND: [u8; 3] = [0x31, 0x36, 0x3b];

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Picture {
    Image,
    Error,
    Signed,
}

listed!(Picture, "picture", {
    "image": Image,
    "error": Error,
    "signed error": Signed,
});

impl Picture {
    /// The colours of an error.
    pub fn scale(self) -> Option<ColorScale> {
        match self {
            Self::Image => None,
            Self::Error => Some(RELATIVE_ERROR),
            Self::Signed => Some(SIGNED_ERROR),
        }
    }
}

/// Paints a half. An error needs its reference.
pub fn painted(
    pipeline: &mut Pipeline,
    kind: Picture,
    curve: ToneCurve,
    frame: &Frame,
    truth: Option<&Frame>,
    epsilon: Epsilon,
) -> Result<Rgb8Image, PipelineError> {
    let Some(scale) = kind.scale() else {
        return Ok(pipeline.tonemap(&frame.radiance, curve)?.0);
    };
    // A scene out of sight has no error.
    let comparison = truth.map(|truth| {
        Comparison::new(
            &frame.radiance,
            &truth.radiance,
            &frame.mask,
            curve,
            epsilon,
        )
    });
    let Some(Ok(comparison)) = comparison else {
        return Ok(Pixels::filled(frame.mask.width, frame.mask.height, GROUND));
    };
    let map = match kind {
        Picture::Signed => comparison.signed_error_map(),
        _ => comparison.relative_error_map(),
    };
    let mut image = scale.image(&map, &frame.mask);
    for (color, covered) in image.data.iter_mut().zip(&frame.mask.data) {
        if *covered == 0.0 {
            *color = GROUND;
        }
    }
    Ok(image)
}

/// Returns the pixel, if it is inside the image.
pub fn pixel<T: Copy>(image: &Pixels<T>, x: u32, y: u32) -> Option<T> {
    (x < image.width && y < image.height).then(|| image.get(x, y))
}
