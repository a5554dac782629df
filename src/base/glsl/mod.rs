//! Definitions shared by Rust and GLSL. Without dependencies, since the build script includes these
//! files.

pub mod constants;
#[cfg(feature = "gpu")]
pub mod layout;
#[cfg(feature = "gpu")]
pub mod source;
pub mod specialization;
