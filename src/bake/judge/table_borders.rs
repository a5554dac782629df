//! Outermost texels of a DFG table that are wrong by themselves.

use super::table_slip::WrongBorders;
use glam::DVec2;

/// Smallest error of wrong borders at grazing angles; 1024 samples err by 0.024 there.
const BORDER_MIN: f64 = 0.1;

/// The errors of a texel.
#[derive(Clone, Copy, Default)]
pub struct Deviation {
    /// Texture coordinates.
    pub uv: DVec2,
    /// n·v and perceptual roughness.
    pub parameters: DVec2,
    /// Larger error of A and B.
    pub max: f64,
    /// Mean square error of A and B.
    pub mean_square: f64,
}

/// Returns the sides of wrong outermost texels if all other texels err by `good` at most. Few
/// samples err most in the outermost texels at grazing angles, but little.
pub fn wrong_borders(
    size: [u32; 2],
    deviations: &[Deviation],
    good: f64,
    is_grazing: impl Fn(&Deviation) -> bool,
) -> Option<WrongBorders> {
    let texel_size = 1.0 / DVec2::from_array(size.map(f64::from));
    let sides = |deviation: &Deviation| WrongBorders::at(deviation.uv, texel_size);
    let wrong = || deviations.iter().filter(|deviation| deviation.max > good);
    if wrong().any(|deviation| sides(deviation).is_empty()) {
        return None;
    }
    // A corner lies on two sides: sides of texels on one side count first.
    let alone = wrong()
        .map(sides)
        .filter(|sides| sides.count() == 1)
        .fold(WrongBorders::default(), WrongBorders::or);
    let all = wrong()
        .map(sides)
        .filter(|sides| !alone.intersects(*sides))
        .fold(alone, WrongBorders::or);
    let is_noise = wrong().all(|deviation| is_grazing(deviation) && deviation.max < BORDER_MIN);
    (!is_noise).then_some(all)
}
