//! RGBP whose scale was rounded up.
//!
//! A texel of RGBP is `(rgb (8 - 7a))²`. An encoder rounds a down to a byte, so that the largest
//! root fits below the factor `8 - 7a`. PlayCanvas 2.23.3 rounds it up [`encode.js`, `encodeRGBP`]:
//! the factor is then up to 7/255 smaller than the largest root, which is cut at it.

use glam::DVec3;
use std::collections::BTreeSet;

/// Largest root.
const ROOT_MAX: f64 = 8.0;
/// Fewest different scales that prove a rounding: by chance a texel fits its scale exactly.
const SCALES_MIN: usize = 8;
/// Share of the bright texels whose largest root is cut. A few may be borders of black.
const CUT_SHARE: f64 = 0.95;

/// Whether the largest root of nearly every texel above 1 was cut at its factor.
pub fn has_rounded_up_scale(texels: &[[u8; 4]]) -> bool {
    let is_bright = |texel: &&[u8; 4]| (1..u8::MAX).contains(&texel[3]);
    let scales: BTreeSet<u8> = texels
        .iter()
        .filter(is_bright)
        .map(|texel| texel[3])
        .collect();
    let bright_count = texels.iter().filter(is_bright).count();
    let is_cut = |texel: &&[u8; 4]| texel[..3].contains(&u8::MAX);
    let cut_count = texels.iter().filter(is_bright).filter(is_cut).count();
    scales.len() >= SCALES_MIN && cut_count as f64 >= CUT_SHARE * bright_count as f64
}

/// Returns what a texel with a scale that was rounded up holds for a colour.
pub fn rounded_up(color: DVec3) -> DVec3 {
    let root = color.max(DVec3::ZERO).map(f64::sqrt);
    let largest = root.max_element().clamp(1.0, ROOT_MAX);
    let scale = (255.0 * (1.0 - (largest - 1.0) / (ROOT_MAX - 1.0))).ceil() / 255.0;
    let factor = ROOT_MAX - (ROOT_MAX - 1.0) * scale;
    let byte = |root: f64| (255.0 * (root / factor).min(1.0)).round() / 255.0;
    root.map(|root| (factor * byte(root)).powi(2))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A root just above 1 has the scale 1 and is cut at 1; the others keep their values.
    #[test]
    fn a_scale_that_is_rounded_up_cuts_the_largest_channel() {
        let stored = rounded_up(DVec3::new(1.05, 0.5, 0.0));
        assert!((stored.x - 1.0).abs() < 1e-12, "{stored}");
        assert!((stored.y - 0.5).abs() < 4e-3, "{stored}");
        // The loss is largest where the scale is 1: a factor of 1 for a root of 1 + 7/255.
        let losses = (1000..64_000).map(|x| {
            let value = f64::from(x) / 1000.0;
            1.0 - rounded_up(DVec3::splat(value)).x / value
        });
        let most = losses.fold(0.0, f64::max);
        let right = 1.0 - (1.0 + 7.0 / 255.0_f64).powi(-2);
        assert!((most - right).abs() < 1e-3, "{most} {right}");
    }

    /// The encoder that rounds down proves nothing, nor do texels of one scale.
    #[test]
    fn only_texels_at_their_factor_prove_the_rounding() {
        let cut: Vec<[u8; 4]> = (100..120).map(|scale| [255, 200, 100, scale]).collect();
        assert!(has_rounded_up_scale(&cut));
        let right: Vec<[u8; 4]> = (100..120).map(|scale| [253, 200, 100, scale]).collect();
        assert!(!has_rounded_up_scale(&right));
        assert!(!has_rounded_up_scale(&[[255; 4], [255, 255, 255, 100]]));
        assert!(!has_rounded_up_scale(&[]));
    }
}
