//! The environment in another layout, level by level: each texel is the mean of radiance over its
//! solid angle.
//!
//! The finest level averages the bilinear environment, each other level the one before. Each texel
//! stores its solid angle, so the integral over the sphere is the same on every level.

pub mod pass;
