//! Columns of tables, and the lightness of colours.

use splitsum::base::color;
use splitsum::base::csv::Table;

/// The numbers of a column; an empty cell is `None`.
pub fn numbers(table: &Table, name: &str) -> Vec<Option<f64>> {
    let column = table.column(name).unwrap();
    table
        .rows
        .iter()
        .map(|row| (!row[column].is_empty()).then(|| row[column].parse().unwrap()))
        .collect()
}

/// Relative luminance of an sRGB colour.
pub fn luminance(code: [u8; 3]) -> f64 {
    color::luminance(code.map(|code| color::srgb_decode(f32::from(code) / 255.0)))
}
