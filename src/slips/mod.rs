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
    /// Whether light is proportional to the quantity: what is seen is wrong by the same factor. Others are angles, levels, exponents,
    /// texture coordinates.
    pub is_light: bool,
}

const fn figure(quantity: &'static str, printed: f64, right: f64) -> Figure {
    Figure { quantity, printed, right, is_light: false }
}

/// A quantity that light is proportional to.
const fn light(quantity: &'static str, printed: f64, right: f64) -> Figure {
    Figure { quantity, printed, right, is_light: true }
}

impl Figure {
    /// By which factor light is too strong or too weak, >= 1; `None` where the quantity is no amount of light.
    pub fn light_ratio(&self) -> Option<f64> {
        let ratio = (self.printed / self.right).ln().abs().exp();
        (self.is_light && ratio.is_finite()).then_some(ratio)
    }
}

/// Every slip with the digit of its document (0, 1 or 4), in the order in which the documents print them.
pub fn slips() -> impl Iterator<Item = (u32, &'static Slip)> {
    let documents = [(0, document_0::SLIPS), (1, document_1::SLIPS), (4, document_4::SLIPS)];
    documents.into_iter().flat_map(|(document, slips)| slips.iter().map(move |slip| (document, slip)))
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
    let row = |(document, slip): (u32, &Slip), figure: Figure| {
        let mut row = vec![Cell::Integer(document.into())];
        row.extend([slip.printed, slip.right, figure.quantity].map(Cell::from));
        row.extend([figure.printed, figure.right].map(Cell::from));
        row
    };
    let rows = slips().flat_map(|slip| (slip.1.figures)().into_iter().map(move |figure| row(slip, figure)));
    (COLUMNS.map(str::to_owned).to_vec(), rows.collect())
}

/// A slip by its worst figure.
#[derive(Clone, Debug)]
pub struct Cost {
    pub document: u32,
    pub slip: &'static Slip,
    pub figure: Figure,
    /// [`Figure::light_ratio`]; `None` where no figure of the slip is an amount of light.
    pub light_ratio: Option<f64>,
}

/// Side by side, light of this ratio is just told apart: Weber's fraction of daylight vision is one to two percent.
pub const VISIBLE_RATIO: f64 = 1.02;

/// Every slip once, in the order of [`slips`].
pub fn costs() -> Vec<Cost> {
    let cost = |(document, slip): (u32, &'static Slip)| {
        // Of equals the first.
        let worse = |a: Figure, b: Figure| if b.light_ratio() > a.light_ratio() { b } else { a };
        let figure = (slip.figures)().into_iter().reduce(worse)?;
        Some(Cost { document, slip, light_ratio: figure.light_ratio(), figure })
    };
    slips().filter_map(cost).collect()
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
