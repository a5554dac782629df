//! Figures, contact sheets, colours, Markdown, words.

#[cfg(feature = "cli")]
pub mod colormap;
#[cfg(feature = "cli")]
pub mod figure;
pub mod markdown;
pub mod variant;
#[cfg(feature = "cli")]
pub mod words;
