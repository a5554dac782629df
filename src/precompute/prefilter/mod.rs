//!
pub mod pass;

/// Width alpha of the lobe that level `level` of `level_count` holds: perceptual roughness is linear in the level, level 0 is a mirror.
pub fn alpha_of_level(level: u32, level_count: u32) -> f64 {
    if level_count < 2 {
        return 0.0;
    }
    crate::brdf::alpha_from_perceptual_roughness(f64::from(level) / f64::from(level_count - 1))
}
