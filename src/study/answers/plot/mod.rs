//! The answers as pictures (SVG), for papers and for reading beside the tables.
//!
//! [`figures`] chooses what is drawn, [`lines`] and [`grid`] draw it: panels with shared axes, and heat maps. Colours are safe for the
//! colour-blind and never the only difference: markers and dashes tell series apart as well. The ground is white, so that a picture looks the
//! same on paper and on a dark screen.

mod canvas;
pub mod figures;
mod grid;
mod light;
mod lines;
mod maps;
mod parameters;
pub mod scale;
mod slopes;

pub use canvas::PlotError;

/// One picture.
#[derive(Clone, Debug, PartialEq)]
pub struct Picture {
    /// Stem of its file.
    pub name: String,
    pub svg: String,
}
