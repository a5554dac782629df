//! The colour space that a header states.
//!
//! Attributes count in the order of OpenEXR's documents: `acesImageContainerFlag`,
//! `colorInteropID`, `chromaticities`; a header without any means Rec.709. The names of the colour
//! interop IDs come from the Color Interop Forum.

use crate::base::color::{
    ACES_AP0, ACES_AP1, ADOBE_RGB, Chromaticities, DISPLAY_P3, REC709, REC2020, xyz_to_rec709,
};
use crate::base::pixels::Content;
use crate::base::pixels::file::Fault;
use ::exr::meta::attribute::{AttributeValue, Text};
use ::exr::meta::header::Header;
use ::exr::prelude::Vec2;
use glam::{DMat3, DVec2};

const ACES_FLAG: &str = "acesImageContainerFlag";
const INTEROP_ID: &str = "colorInteropID";

/// Scene-linear spaces by the stem of their ID; `_scene` or `_display` follows.
const LINEAR: [(&str, LinearSpace); 7] = [
    ("lin_rec709", LinearSpace::Rgb(REC709)),
    ("lin_p3d65", LinearSpace::Rgb(DISPLAY_P3)),
    ("lin_rec2020", LinearSpace::Rgb(REC2020)),
    ("lin_adobergb", LinearSpace::Rgb(ADOBE_RGB)),
    ("lin_ap0", LinearSpace::Rgb(ACES_AP0)),
    ("lin_ap1", LinearSpace::Rgb(ACES_AP1)),
    ("lin_ciexyzd65", LinearSpace::XyzD65),
];

/// Namespace of spaces that OpenColorIO has and the Forum's list lacks.
const OCIO: &str = "ocio:";

/// First words of IDs whose values are signals of a transfer function.
const ENCODINGS: [&str; 10] = [
    "srgb", "srgbe", "g18", "g22", "g24", "g26", "pq", "hlg", "acescc", "acescct",
];

#[derive(Clone, Copy)]
enum LinearSpace {
    Rgb(Chromaticities),
    /// CIE XYZ in which D65 is (0.9505, 1, 1.0891).
    XyzD65,
}

impl LinearSpace {
    /// Returns the matrix to Rec.709; `None` if the values are Rec.709 already.
    fn to_rec709(self) -> Option<DMat3> {
        match self {
            Self::Rgb(primaries) if primaries.is_close_to(&REC709) => None,
            Self::Rgb(primaries) => primaries.to_rec709(),
            Self::XyzD65 => Some(xyz_to_rec709()),
        }
    }

    fn has(self, chromaticities: &Chromaticities) -> bool {
        match self {
            Self::Rgb(primaries) => primaries.is_close_to(chromaticities),
            // Primaries of X, Y and Z; files write either white.
            Self::XyzD65 => chromaticities.red == DVec2::X && chromaticities.green == DVec2::Y,
        }
    }
}

/// ID of values that are not colours.
const DATA: &str = "data";
/// ID of the colours that this program writes.
const REC709_SCENE: &str = "lin_rec709_scene";

/// Names the content of a file to write.
pub(super) fn label(content: Content) -> (Text, AttributeValue) {
    let id = match content {
        Content::Radiance => REC709_SCENE,
        Content::Data => DATA,
    };
    (Text::from(INTEROP_ID), AttributeValue::Text(Text::from(id)))
}

/// Whether a header says that the values are not colours.
pub(super) fn content(header: &Header) -> Content {
    match text(header, INTEROP_ID).as_deref() {
        Some(DATA) => Content::Data,
        _ => Content::Radiance,
    }
}

/// Returns the matrix from the stated colour space to linear Rec.709, if one is needed. Refuses
/// colours that are encoded.
pub(super) fn conversion(
    header: &Header,
    warnings: &mut Vec<String>,
) -> Result<Option<DMat3>, Fault> {
    let chromaticities = chromaticities(header);
    if integer(header, ACES_FLAG) == Some(1) {
        return Ok(stated(
            ACES_FLAG,
            "1",
            LinearSpace::Rgb(ACES_AP0),
            chromaticities,
            warnings,
        ));
    }
    if let Some(id) = text(header, INTEROP_ID) {
        let id = id.as_str();
        match InteropId::parse(id) {
            InteropId::Linear(space) => {
                return Ok(stated(INTEROP_ID, id, space, chromaticities, warnings));
            }
            InteropId::Encoded => {
                return Err(Fault::new(
                    format!("has encoded colours ({INTEROP_ID} is {id:?})"),
                    "linear colours; `oiiotool in.exr --tocolorspace lin_rec709_scene -o out.exr` \
                     converts them",
                ));
            }
            InteropId::Data => return Ok(None),
            InteropId::Unknown => {
                let instead = if chromaticities.is_some() {
                    "its chromaticities were used"
                } else {
                    "Rec.709 was assumed"
                };
                warnings.push(format!(
                    "The header's {INTEROP_ID} {id:?} is not a space that is known here; {instead}."
                ));
            }
        }
    }
    if chromaticities.is_none() {
        warnings.extend(other_label(header));
    }
    let foreign = chromaticities.filter(|found| !found.is_close_to(&REC709));
    Ok(foreign.and_then(|found| found.to_rec709_with_warning("chromaticities", warnings)))
}

/// Attributes of programs that name a colour space; OpenEXR does not define them.
const OTHER_LABELS: [&str; 3] = ["oiio:ColorSpace", "colorSpace", "ColorSpace"];
/// Names of linear Rec.709 in such attributes.
const OTHER_REC709: [&str; 6] = [
    "lin_rec709",
    "lin_srgb",
    "linear",
    "scene_linear",
    "linear rec.709 (srgb)",
    "lin_rec709_scene",
];

/// Warns of a colour space that only an attribute of another program names.
fn other_label(header: &Header) -> Option<String> {
    let mut labels = OTHER_LABELS.iter();
    labels.find_map(|name| {
        let space = text(header, name)?;
        let is_rec709 = OTHER_REC709.contains(&&*space.to_lowercase());
        (!is_rec709).then(|| {
            format!(
                "The header's {name} is {space:?}, which OpenEXR does not define; Rec.709 was \
                 assumed. `oiiotool in.exr --iscolorspace NAME --tocolorspace lin_rec709_scene -o \
                 out.exr` converts the colours."
            )
        })
    })
}

/// Takes the space of an attribute that wins over chromaticities, and warns of a conversion and of
/// a contradiction.
fn stated(
    attribute: &str,
    value: &str,
    space: LinearSpace,
    chromaticities: Option<Chromaticities>,
    warnings: &mut Vec<String>,
) -> Option<DMat3> {
    if chromaticities.is_some_and(|found| !space.has(&found)) {
        warnings.push(format!(
            "The header's {attribute} {value} and its chromaticities contradict each other; \
             {attribute} was used, as OpenEXR recommends."
        ));
    }
    let matrix = space.to_rec709();
    if matrix.is_some() {
        warnings.push(format!(
            "The colours were converted from the header's {attribute} {value} to Rec.709."
        ));
    }
    matrix
}

enum InteropId {
    Linear(LinearSpace),
    Encoded,
    Data,
    Unknown,
}

impl InteropId {
    fn parse(id: &str) -> Self {
        let local = id.strip_prefix(OCIO).unwrap_or(id);
        let stem = local
            .strip_suffix("_scene")
            .or_else(|| local.strip_suffix("_display"))
            .unwrap_or(local);
        if let Some((_, space)) = LINEAR.iter().find(|(name, _)| *name == stem) {
            return Self::Linear(*space);
        }
        let first_word = stem.split('_').next().unwrap_or_default();
        if ENCODINGS.contains(&first_word) {
            Self::Encoded
        } else if stem == DATA {
            Self::Data
        } else {
            Self::Unknown
        }
    }
}

fn chromaticities(header: &Header) -> Option<Chromaticities> {
    let xy = |Vec2(x, y): Vec2<f32>| DVec2::new(x.into(), y.into());
    let stated = header.shared_attributes.chromaticities?;
    Some(Chromaticities {
        red: xy(stated.red),
        green: xy(stated.green),
        blue: xy(stated.blue),
        white: xy(stated.white),
    })
}

/// An attribute that the crate does not know by name.
fn other<'h>(header: &'h Header, name: &str) -> Option<&'h AttributeValue> {
    let attributes = header
        .own_attributes
        .other
        .iter()
        .chain(&header.shared_attributes.other);
    attributes
        .into_iter()
        .find(|(key, _)| **key == *name)
        .map(|(_, value)| value)
}

pub(super) fn integer(header: &Header, name: &str) -> Option<i32> {
    match other(header, name)? {
        AttributeValue::I32(value) => Some(*value),
        _ => None,
    }
}

fn text(header: &Header, name: &str) -> Option<String> {
    match other(header, name)? {
        AttributeValue::Text(value) => Some(value.to_string()),
        _ => None,
    }
}
