//! The environment's mip chain: each texel is the mean of radiance over its solid angle.
//!
//! A texel of a level covers a rectangle of the level above. Its value is `Σ w L / Σ w`, with w the
//! solid angle of the overlap with each source texel: overlap in u times the difference of cos θ
//! over the overlap in θ. Unlike a box filter this keeps the integral over the sphere at every
//! size; a box filter overrates the texels at the poles.

#[cfg(feature = "gpu")]
pub mod pass;

/// Counts the levels down to 1 x 1.
pub fn level_count(size: [u32; 2]) -> u32 {
    size[0].max(size[1]).ilog2() + 1
}
