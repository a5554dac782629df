//! Rows and image tables: what a run leaves for people and for programs.
//!
//! [`csv`] keeps the numbers, [`markdown`] shows a few of them, `colormap` colours error maps.

#[cfg(feature = "cli")]
pub mod colormap;
pub mod csv;
pub mod markdown;
#[cfg(feature = "cli")]
pub(crate) mod text;
