//! Recovers roughness and F0 of a surface from photos of it, as an inverse renderer does: by the
//! images of a method that are most like the photos.
//!
//! Light, shape and camera are known. An error of the method becomes an error of the material: the
//! photos are references, so a method without error recovers the truth.

mod fit;
mod loss;

pub use fit::{F0_MAX, Fit, Lines, Photo, Problem};
pub use loss::Loss;
