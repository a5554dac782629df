//! What the code of a shading pass holds on GPUs that are not here: instructions, registers and lookups, a pixel and a sample.
//!
//! Mesa's RADV compiles for AMD GPUs without having one (`RADV_FORCE_FAMILY`). A [`child`] process does so, since a driver is chosen once a
//! process. [`isa`] counts the instructions inside and outside the loop over samples. Nothing is executed or timed. See docs/cost.md.

pub mod child;
pub mod family;
pub mod isa;
pub mod pass;
pub mod table;
