//! The primaries of a picture, by its ICC profile. Its curve is taken as the curve of sRGB.

use super::streams::Stream;
use glam::{DMat3, DVec3};

/// Signature, then the number of the part and the count of parts.
const SIGNATURE: &[u8] = b"ICC_PROFILE\0";
const PART_NUMBERS: usize = 2;
const HEADER: usize = 128;
const TAG: usize = 12;
/// Colorants of sRGB in the profile's space, XYZ under D50.
const SRGB: DMat3 = DMat3::from_cols(
    DVec3::new(0.436_07, 0.222_49, 0.013_92),
    DVec3::new(0.385_15, 0.716_87, 0.097_08),
    DVec3::new(0.143_07, 0.060_61, 0.714_10),
);
/// Profiles round their colorants to 16 bits, and some adapt their white with other digits.
const TOLERANCE: f64 = 2e-3;

/// Returns the matrix from the primaries of a profile to Rec.709, if one is needed, with a warning.
pub(super) fn to_rec709(picture: &Stream, warnings: &mut Vec<String>) -> Option<DMat3> {
    let profile: Vec<u8> = picture
        .after(SIGNATURE)
        .filter_map(|part| part.get(PART_NUMBERS..))
        .flatten()
        .copied()
        .collect();
    if profile.is_empty() {
        return None;
    }
    let Some(colorants) = colorants(&profile) else {
        warnings.push("The ICC profile has no primaries; sRGB was assumed.".to_owned());
        return None;
    };
    if (colorants - SRGB)
        .abs()
        .to_cols_array()
        .iter()
        .all(|&off| off < TOLERANCE)
    {
        return None;
    }
    warnings
        .push("The colours were converted from the ICC profile's primaries to Rec.709.".to_owned());
    Some(SRGB.inverse() * colorants)
}

/// Reads the columns red, green and blue of a profile.
fn colorants(profile: &[u8]) -> Option<DMat3> {
    let [r, g, b] = [b"rXYZ", b"gXYZ", b"bXYZ"].map(|name| xyz(profile, name));
    let matrix = DMat3::from_cols(r?, g?, b?);
    (matrix.determinant().abs() > f64::EPSILON).then_some(matrix)
}

/// Reads a tag of one XYZ number: a type of 8 bytes, then three fixed-point numbers.
fn xyz(profile: &[u8], name: &[u8; 4]) -> Option<DVec3> {
    let count = word(profile, HEADER)? as usize;
    let tags = profile.get(HEADER + 4..)?.chunks_exact(TAG).take(count);
    let tag = tags.into_iter().find(|tag| tag.starts_with(name))?;
    let offset = word(tag, 4)? as usize;
    let number = |i: usize| {
        let fixed = word(profile, offset.checked_add(8 + 4 * i)?)? as i32;
        Some(f64::from(fixed) / 65536.0)
    };
    Some(DVec3::new(number(0)?, number(1)?, number(2)?))
}

fn word(bytes: &[u8], offset: usize) -> Option<u32> {
    Some(u32::from_be_bytes(*bytes.get(offset..)?.first_chunk()?))
}
