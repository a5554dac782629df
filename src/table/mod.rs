//! Rows and image tables: what a run leaves for people and for programs.
//!
//! [`csv`] keeps the numbers, [`markdown`] shows a few of them, [`contact_sheet`] shows the images with their error maps,
//! coloured by [`colormap`].

#[cfg(feature = "cli")]
pub mod colormap;
#[cfg(feature = "cli")]
pub mod contact_sheet;
pub mod csv;
pub mod markdown;
#[cfg(feature = "cli")]
mod text;
