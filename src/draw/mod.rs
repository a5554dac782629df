//! Figures, contact sheets, colours, Markdown.

#[cfg(feature = "cli")]
pub mod colormap;
#[cfg(feature = "cli")]
pub mod figure;
pub mod markdown;
pub mod method_titles;
