//! Image-based lighting: turns a g-buffer and an environment into radiance.

pub mod bend;
pub mod coat;
pub mod diffuse;
pub mod frames;
pub mod method;
#[cfg(feature = "gpu")]
pub mod pass;
pub mod reference;
#[cfg(feature = "gpu")]
pub mod reference_pass;
mod shading;
pub mod sheen;
pub mod twin;

/// Name of the unbiased method, specular and diffuse.
pub const REFERENCE: &str = "reference";
/// Name of the method that omits its term, specular and diffuse.
pub const NONE: &str = "none";

/// Name of the split sum with exact factors, which tables approximate.
pub const EXACT_SPLIT: &str = "ladder-view";

pub use crate::glsl::constants::FILE_PREFIX;
pub use diffuse::{DIFFUSE, Diffuse};
pub use method::{METHODS, Method, Role, own, words_in};
pub use shading::Shading;
