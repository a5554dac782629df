//! Tables of the split sum from other programs: reading, conventions, errors, and baking by the
//! same conventions.
//!
//! [`container`] reads files, [`source`] finds the parts of a bake, [`convention`] defines
//! directions, levels and channels, [`judge`] scores parts against exact integrals, [`make`] bakes
//! for engines, [`plain`] for any program.

pub mod container;
pub mod convention;
pub mod given;
pub mod judge;
pub mod make;
mod parts;
pub mod paste;
pub mod plain;
pub mod product;
pub mod sh;
pub mod source;

pub use parts::{Bake, Map, Stated, TexelOrder};
