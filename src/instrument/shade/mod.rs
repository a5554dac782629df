//! Image-based lighting: turns a g-buffer and an environment into radiance.

pub mod bend;
pub mod coat;
pub mod diffuse;
pub mod frames;
#[cfg(feature = "gpu")]
pub mod layer_pass;
#[cfg(feature = "gpu")]
pub mod lights;
pub mod metallic;
pub mod method;
pub mod occlusion;
#[cfg(feature = "gpu")]
pub mod pass;
pub mod reference;
#[cfg(feature = "gpu")]
pub mod reference_pass;
mod shading;
pub mod sheen;
pub mod twin;

/// What both kinds of method answer about their term.
macro_rules! of_a_term {
    ($kind:ty) => {
        impl $kind {
            /// Whether the passes of the reference estimate it: without bias, with a standard
            /// error.
            pub fn is_integrated(&self) -> bool {
                self.lobe.is_some()
            }

            /// Whether it is exact, and not a step between the exact term and an approximation.
            pub fn is_reference(&self) -> bool {
                self.name == REFERENCE
            }

            pub fn is_none(&self) -> bool {
                self.name == NONE
            }

            /// Whether it has its own shader; the reference has other passes.
            pub fn has_pass(&self) -> bool {
                !self.is_none() && !self.is_integrated()
            }
        }
    };
}
of_a_term!(Method);
of_a_term!(Diffuse);

/// Name of the unbiased method, specular and diffuse.
pub const REFERENCE: &str = "reference";
/// Name of the method that omits its term, specular and diffuse.
pub const NONE: &str = "none";

/// Name of the split sum with exact factors, which tables approximate.
pub const EXACT_SPLIT: &str = "ladder-view";

pub use crate::base::glsl::constants::FILE_PREFIX;
pub use diffuse::{DIFFUSE, Diffuse};
pub use method::{METHODS, Method, Role, from_file, printed_lobe_alpha};
pub use shading::{PointTable, Shading};
