//! Means over channels and pixels.

pub(super) fn rgb_mean(term: impl Fn(usize) -> f64) -> f64 {
    (term(0) + term(1) + term(2)) / 3.0
}

pub(super) fn pixel_mean(pixels: &[usize], term: impl Fn(usize) -> f64) -> f64 {
    pixels.iter().map(|&pixel| term(pixel)).sum::<f64>() / pixels.len() as f64
}
