//! Counts instructions, registers and lookups of shading passes, per pixel and sample, on GPUs that
//! you don't have.
//!
//! Mesa's RADV compiles for AMD GPUs without having one (`RADV_FORCE_FAMILY`), in a [`child`]
//! process, since a process can choose a driver only once. [`isa`] counts instructions in and out
//! of the loop over samples. See docs/cost.md.

pub mod child;
pub mod family;
pub mod isa;
pub mod pass;
pub mod table;
