//! What the slips of the source documents' printed formulas cost, in numbers.
//!
//! Source documents: 0 [Kim22]; 1, an article on image-based lighting, in Chinese, without a name; 4 (K. Shatos, "Image Based
//! Lighting"). Each slip is a printed formula, the right one, and figures: one quantity, computed in f64 with either. Where nothing else is said the
//! quantities are those of GGX with separable masking, and the directional albedo is what a white furnace (radiance 1, F = 1) shows.
//! The derivations of the right forms are in docs/estimators.md.

mod document_0;
mod document_1;
mod document_4;
mod furnace;

use crate::table::csv::{Cell, Table, TableError};
use crate::table::markdown::{Align, MarkdownTable, significant};

/// A printed formula that was corrected.
#[derive(Clone, Copy, Debug)]
pub struct Slip {
    /// Digit of the source document: 0, 1 or 4.
    pub document: u32,
    /// The formula as printed, or the place in words.
    pub printed: &'static str,
    pub right: &'static str,
    pub figures: fn() -> Vec<Figure>,
}

/// One quantity by the printed formula and by the right one.
#[derive(Clone, Debug, PartialEq)]
pub struct Figure {
    pub quantity: &'static str,
    /// NaN where the printed formula gives no number.
    pub printed: f64,
    pub right: f64,
}

const fn figure(quantity: &'static str, printed: f64, right: f64) -> Figure {
    Figure { quantity, printed, right }
}

/// Every slip, by document, in the order in which the documents print them.
pub fn slips() -> impl Iterator<Item = &'static Slip> {
    [document_0::SLIPS, document_1::SLIPS, document_4::SLIPS].into_iter().flatten()
}

/// What [`table`] is called in the folder of a run.
pub const FILE_NAME: &str = "printed_slips.csv";

/// Stands above [`markdown`].
pub const HEADING: &str =
    "Of GGX with separable masking, where nothing else is said. Albedo: directional, what a white furnace shows.\n";

/// Columns of [`table`].
pub const COLUMNS: [&str; 6] = ["document", "printed", "right", "quantity", "printed_value", "right_value"];

/// One row a figure.
pub fn table() -> (Vec<String>, Vec<Vec<Cell>>) {
    let row = |slip: &Slip, figure: Figure| {
        let mut row = vec![Cell::Integer(slip.document.into())];
        row.extend([slip.printed, slip.right, figure.quantity].map(Cell::from));
        row.extend([figure.printed, figure.right].map(Cell::from));
        row
    };
    let rows = slips().flat_map(|slip| (slip.figures)().into_iter().map(move |figure| row(slip, figure)));
    (COLUMNS.map(str::to_owned).to_vec(), rows.collect())
}

/// A slip by its worst figure, of a table that [`table`] was written to.
#[derive(Clone, Debug, PartialEq)]
pub struct Cost {
    pub document: String,
    pub printed: String,
    pub quantity: String,
    pub printed_value: f64,
    pub right_value: f64,
    /// By which factor the quantity is too large or too small, >= 1; `None` where no figure of the slip is an amount of light.
    pub light_ratio: Option<f64>,
}

/// How the quantities begin to which light is proportional: wrong by a factor, what is seen is wrong by it. Others are angles, levels,
/// exponents, texture coordinates.
const OF_LIGHT: [&str; 14] = [
    "albedo",
    "specular albedo",
    "reflectance",
    "A, ",
    "A + B",
    "Kd",
    "k_D",
    "E/π",
    "∫ cos/π",
    "mean of 1",
    "the same at the peak",
    "second factor",
    "integral over",
    "display value",
];

/// Side by side, light of this ratio is just told apart: Weber's fraction of daylight vision is one to two percent.
pub const VISIBLE_RATIO: f64 = 1.02;

/// Every slip of a table once, in its order.
pub fn costs(table: &Table) -> Result<Vec<Cost>, TableError> {
    let mut columns = [0; 4];
    for (column, name) in columns.iter_mut().zip(COLUMNS) {
        *column = table.column(name)?;
    }
    let [document, printed, right, quantity] = columns;
    let [printed_values, right_values] = [table.numbers("printed_value")?, table.numbers("right_value")?];
    let mut costs: Vec<(&String, Cost)> = Vec::new();
    for (i, row) in table.rows.iter().enumerate() {
        let [printed_value, right_value] = [printed_values[i], right_values[i]].map(|x| x.unwrap_or(f64::NAN));
        let ratio = (printed_value / right_value).ln().abs().exp();
        let is_light = OF_LIGHT.iter().any(|start| row[quantity].starts_with(start)) && ratio.is_finite();
        let cost = Cost {
            document: row[document].clone(),
            printed: row[printed].clone(),
            quantity: row[quantity].clone(),
            printed_value,
            right_value,
            light_ratio: is_light.then_some(ratio),
        };
        let is_same = |(of, known): &&mut (&String, Cost)| {
            known.document == cost.document && known.printed == cost.printed && **of == row[right]
        };
        match costs.last_mut().filter(is_same) {
            Some((_, known)) if cost.light_ratio > known.light_ratio => *known = cost,
            Some(_) => {}
            None => costs.push((&row[right], cost)),
        }
    }
    Ok(costs.into_iter().map(|(_, cost)| cost).collect())
}

/// A table that [`table`] was written to, for reading: a slip's formulas stand in its first row only.
pub fn markdown(table: &Table) -> Result<String, TableError> {
    /// Digits of a figure; the table has all.
    const DIGITS: usize = 3;
    let mut columns = [0; 4];
    for (column, name) in columns.iter_mut().zip(COLUMNS) {
        *column = table.column(name)?;
    }
    let [printed, right] = [table.numbers("printed_value")?, table.numbers("right_value")?];
    let mut text = MarkdownTable::new(&[
        ("document", Align::Left),
        ("printed", Align::Left),
        ("right", Align::Left),
        ("quantity", Align::Left),
        ("as printed", Align::Right),
        ("right value", Align::Right),
    ]);
    let number = |x: Option<f64>| x.map_or_else(String::new, |x| significant(x, DIGITS));
    let mut last: [&str; 3] = [""; 3];
    for (i, row) in table.rows.iter().enumerate() {
        let formulas = [&row[columns[0]], &row[columns[1]], &row[columns[2]]].map(String::as_str);
        let shown = if formulas == last { [""; 3] } else { formulas };
        last = formulas;
        let mut cells = shown.map(str::to_owned).to_vec();
        cells.extend([row[columns[3]].clone(), number(printed[i]), number(right[i])]);
        text.row(&cells);
    }
    Ok(text.to_string())
}
