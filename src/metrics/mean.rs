//! Means over channels and pixels.

/// Mean of a term over the three channels.
pub(super) fn rgb_mean(term: impl Fn(usize) -> f64) -> f64 {
    (term(0) + term(1) + term(2)) / 3.0
}

/// Mean of a term over pixels.
pub(super) fn pixel_mean(pixels: &[usize], term: impl Fn(usize) -> f64) -> f64 {
    pixels.iter().map(|&pixel| term(pixel)).sum::<f64>() / pixels.len() as f64
}
