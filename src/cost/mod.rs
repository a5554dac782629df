//! A model of what a shading pass costs on GPUs that are not here: their compiler's code is counted, and published rates bound its cycles.
//!
//! Mesa's RADV compiles for AMD GPUs without having one (`RADV_FORCE_FAMILY`). A [`child`] process does so, since a driver is chosen once a
//! process. [`isa`] counts the instructions inside and outside the loop over samples, [`family`] holds the published rates, and [`model`]
//! makes a bound of both. Nothing here is a measured time. See docs/cost.md.

pub mod child;
pub mod family;
pub mod isa;
pub mod model;
pub mod record;
