//! Tables of the split sum from other programs: reading, conventions, errors, and baking by the
//! same conventions.
//!
//! [`container`] reads files, [`source`] finds the parts of a bake, [`convention`] defines
//! directions, levels and channels, [`judge`] scores parts against exact integrals, [`make`] bakes
//! for engines, [`plain`] for any program.

mod babylon_env;
pub mod container;
pub mod convention;
mod cube_environment;
mod f3d_cache;
mod f3d_sh;
mod face_folder;
pub mod given;
pub mod judge;
mod level_law;
pub mod make;
mod map_form;
mod packed;
mod parts;
pub mod paste;
pub mod plain;
mod playcanvas_atlas;
pub mod product;
mod rgbp;
pub mod sh;
pub mod source;
mod vtk_xml;

pub use cube_environment::ENVIRONMENT_FORMATS;
pub use parts::{Bake, FileWarning, Map, Stated, TexelOrder};
