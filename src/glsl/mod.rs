//! Definitions shared by Rust and GLSL. No dependencies: the build script includes these files and writes GLSL from
//! them.

pub mod constants;
#[cfg(feature = "gpu")]
pub mod layout;
#[cfg(feature = "gpu")]
pub mod source;
