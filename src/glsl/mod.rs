//! What Rust and GLSL agree on. No dependencies: the build script includes these files and writes the GLSL text from them.
pub mod constants;
#[cfg(feature = "gpu")]
pub mod layout;
#[cfg(feature = "gpu")]
pub mod source;
