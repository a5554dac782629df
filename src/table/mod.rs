//! Tables as CSV and Markdown, colours of error maps, text on images.

#[cfg(feature = "cli")]
pub mod colormap;
pub mod csv;
pub mod markdown;
#[cfg(feature = "cli")]
pub(crate) mod text;
