//! Pictures of a frame: the image, its error, and what it is made of.

use crate::base::names::{Listed, listed};
use crate::base::pixels::{Pixels, Rgb8Image};
use crate::draw::colormap::{ColorScale, RELATIVE_ERROR, SIGNED_ERROR};
use crate::instrument::metrics::Comparison;
use crate::instrument::pipeline::{
    Frame, Intermediate, Pipeline, PipelineError, RenderRequest, Selection,
};
use crate::instrument::tonemap::ToneCurve;

/// Colour of all pictures but the image where they have no value.
const GROUND: [u8; 3] = [0x31, 0x36, 0x3b];

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Picture {
    Image,
    Error,
    Signed,
    /// What the image is made of.
    Between(Intermediate),
}

listed!(Picture, "picture", {
    "image": Image,
    "error": Error,
    "signed error": Signed,
    "position": Between(Intermediate::Position),
    "normal": Between(Intermediate::Normal),
    "albedo": Between(Intermediate::Albedo),
    "f0": Between(Intermediate::F0),
    "alpha": Between(Intermediate::Alpha),
    "metallic": Between(Intermediate::Metallic),
    "occlusion": Between(Intermediate::Occlusion),
    "irradiance": Between(Intermediate::Irradiance),
    "prefiltered": Between(Intermediate::Prefiltered),
    "dfg": Between(Intermediate::Dfg),
});

impl Picture {
    /// The colours of an error.
    pub fn scale(self) -> Option<ColorScale> {
        match self {
            Self::Image | Self::Between(_) => None,
            Self::Error => Some(RELATIVE_ERROR),
            Self::Signed => Some(SIGNED_ERROR),
        }
    }

    /// Why a half has no such picture, if its method reads no such table.
    pub fn fault(self, request: &RenderRequest) -> Option<String> {
        match self {
            Self::Between(intermediate) => Selection::from(intermediate).fault(request),
            _ => None,
        }
    }

    /// The pictures of what the image is made of, by name.
    pub fn between() -> impl Iterator<Item = &'static str> {
        Self::all()
            .filter(|picture| matches!(picture, Self::Between(_)))
            .map(Self::name)
    }
}

/// Paints a half, `frame` of `request`. An error needs its reference.
pub fn painted(
    pipeline: &mut Pipeline,
    kind: Picture,
    curve: ToneCurve,
    request: &RenderRequest,
    frame: &Frame,
    truth: Option<&Frame>,
) -> Result<Rgb8Image, PipelineError> {
    if let Picture::Between(intermediate) = kind {
        if kind.fault(request).is_some() {
            return Ok(Pixels::filled(frame.mask.width, frame.mask.height, GROUND));
        }
        let image = pipeline.intermediate(request, intermediate.into())?;
        return image.picture(pipeline, curve, GROUND);
    }
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
            request.epsilon(),
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
