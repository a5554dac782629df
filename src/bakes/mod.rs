//! Tables of the split sum that other programs baked: reading them, what their numbers stand for, and how wrong they are.
//!
//! [`container`] reads files, [`source`] finds the parts of a bake in them, [`convention`] says what directions, levels and channels mean,
//! [`check`] scores each part against its exact integral, and [`make`] bakes what an engine takes, by the same conventions.

pub mod check;
pub mod container;
pub mod convention;
pub mod given;
pub mod make;
#[cfg(feature = "cli")]
pub mod page;
mod parts;
pub mod product;
pub mod sh;
pub mod source;

pub use parts::{Bake, Map, Told};
