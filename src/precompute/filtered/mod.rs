//! The environment by another layout, level by level: each texel is the mean of radiance over its solid angle.
//!
//! The finest level takes its means from the bilinear environment, every other level from the one before. Each texel carries its solid
//! angle, so that the integral over the sphere is the same on every level.

pub mod pass;
