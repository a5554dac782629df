//! A figure in pixels, as far as it is laid out.

use super::dodge::Dodge;
use super::scale::Axis;
use super::text::Words;

/// Margin, pixels.
pub const PAD: f64 = 12.0;
/// Least height of a panel of numbers, pixels.
pub const HEIGHT_MIN: f64 = 140.0;

/// A panel in pixels.
#[derive(Clone, Debug, PartialEq)]
pub struct Frame {
    pub x: Axis,
    pub y: Axis,
    pub left: f64,
    pub top: f64,
    pub right: f64,
    pub bottom: f64,
    /// The x of vertical grid lines, and the y of horizontal ones.
    pub grid_x: Vec<f64>,
    pub grid_y: Vec<f64>,
    pub dodge: Dodge,
}

/// A figure in pixels.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Layout {
    pub width: f64,
    /// So far.
    pub height: f64,
    pub words: Vec<Words>,
    pub entries: Vec<LegendEntry>,
    /// Width of the samples of marks in the legend.
    pub swatch: f64,
    pub frames: Vec<Frame>,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LegendEntry {
    /// Index of the series.
    pub series: usize,
    /// Left middle of its sample.
    pub position: [f64; 2],
}
