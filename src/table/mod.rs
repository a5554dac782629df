//! Tables as CSV and Markdown, colours of error maps.

#[cfg(feature = "cli")]
pub mod colormap;
pub mod csv;
pub mod markdown;
