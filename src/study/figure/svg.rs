//! The SVG of a figure.

use super::Figure;

/// Widths at which figures are laid out, pixels: a desk and a phone.
pub const WIDTHS: [u32; 2] = [760, 360];

/// An SVG document of that width.
pub fn svg(figure: &Figure, width: u32) -> String {
    format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"20\"><title>{}</title></svg>",
        figure.title
    )
}
