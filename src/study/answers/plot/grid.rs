//! Heat maps: panels of coloured cells with their values written into them, and the colours' scale beside them.

use super::canvas::{Canvas, GRID, INK, MUTED, PlotError, Rgb, Stroke, look, picture, text_width};
use super::lines::wrapped;
use crate::table::colormap::{ColorScale, Palette, Range};

/// One cell.
#[derive(Clone, Debug, PartialEq)]
pub struct HeatCell {
    /// What the colour shows.
    pub value: f64,
    /// What is written.
    pub text: String,
    /// Smaller, in a second line; empty for none.
    pub range: String,
}

/// Why a place of a map has no value.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Gap {
    /// The experiment leaves the combination out.
    Excluded,
    /// No pixel of the image is in the bin.
    NoPixels,
}

/// One map.
#[derive(Clone, Debug)]
pub struct HeatPanel {
    pub title: String,
    pub rows: Vec<String>,
    pub columns: Vec<String>,
    /// By row and column.
    pub cells: Vec<Vec<Result<HeatCell, Gap>>>,
}

/// A figure of maps that share their colours.
#[derive(Clone, Debug)]
pub struct HeatChart {
    pub title: String,
    pub notes: Vec<String>,
    pub row_label: String,
    pub column_label: String,
    pub color_label: String,
    /// Ends of the logarithmic colour scale.
    pub range: [f64; 2],
    /// Values that the scale names.
    pub color_ticks: Vec<(f64, String)>,
    pub panels: Vec<HeatPanel>,
}

const TITLE: i32 = 17;
const SUBTITLE: i32 = 13;
const LABEL: i32 = 12;
const MARGIN: i32 = 14;
const HEAD: i32 = 34;
const ABOVE: i32 = 24;
const BELOW: i32 = 46;
/// Cells with one line, and with two.
const CELL: [i32; 2] = [50, 27];
const CELL_WITH_RANGE_HEIGHT: i32 = 35;
/// Room beside a second line.
const RANGE_MARGIN: i32 = 8;
/// Second lines: their size, and how far both lines stand from the middle.
const RANGE_LABEL: i32 = 10;
const LINE_SHIFT: i32 = 8;
const GAP: i32 = 14;
/// Colour scale: width of its bar, and room for its labels.
const BAR: i32 = 16;
const BAR_HEIGHT_MIN: i32 = 130;
const BAR_LABELS: i32 = 72;
/// The palette's dark and pale ends are cut off: text must be legible on every colour.
const PALETTE_FROM: f64 = 0.12;
const PALETTE_TO: f64 = 1.0;
const COLUMNS_MAX: usize = 2;
/// Ground of a cell without a value, pixels between its hatches, and its text.
const PALE: Rgb = [246, 246, 246];
const HATCH: usize = 6;
const EMPTY_LABEL: i32 = 10;

impl HeatChart {
    fn color(&self, value: f64) -> Rgb {
        let scale = ColorScale { palette: Palette::Magma, range: Range::Log { lo: self.range[0], hi: self.range[1] } };
        // Pale is small, dark is large: like ink on paper.
        let place = scale.place(value).clamp(0.0, 1.0);
        Palette::Magma.color(PALETTE_TO + (PALETTE_FROM - PALETTE_TO) * place)
    }

    /// Width and height of a cell.
    fn cell_size(&self) -> [i32; 2] {
        let cells = self.panels.iter().flat_map(|panel| panel.cells.iter().flatten().flatten());
        let ranges = cells.filter(|cell| !cell.range.is_empty()).map(|cell| text_width(&cell.range, RANGE_LABEL));
        ranges.max().map_or(CELL, |longest| [CELL[0].max(longest + RANGE_MARGIN), CELL_WITH_RANGE_HEIGHT])
    }

    pub fn svg(&self) -> Result<String, PlotError> {
        let size = self.cell_size();
        let rows = self.panels.iter().map(|panel| panel.rows.len()).max().unwrap_or(0) as i32;
        let columns = self.panels.iter().map(|panel| panel.columns.len()).max().unwrap_or(0) as i32;
        let names = self.panels.iter().flat_map(|panel| &panel.rows);
        let left = names.map(|name| text_width(name, LABEL)).max().unwrap_or(0) + 14;
        let across = COLUMNS_MAX.min(self.panels.len()).max(1);
        let down = self.panels.len().div_ceil(across) as i32;
        let [panel_width, panel_height] = [left + columns * size[0] + GAP, ABOVE + rows * size[1] + BELOW];
        let full_width = 2 * MARGIN + across as i32 * panel_width + BAR + BAR_LABELS;
        let notes = wrapped(&self.notes, full_width - 2 * MARGIN - left);
        let grid_height = (down * panel_height).max(ABOVE + BAR_HEIGHT_MIN + GAP);
        let full_height = 2 * MARGIN + HEAD + grid_height + notes.len() as i32 * (LABEL + 4);
        picture(&self.title, [full_width, full_height], |canvas| {
            canvas.text(&self.title, (MARGIN + left, MARGIN + TITLE / 2), look(TITLE).bold())?;
            for (i, panel) in self.panels.iter().enumerate() {
                let x = MARGIN + (i % across) as i32 * panel_width + left;
                let y = MARGIN + HEAD + (i / across) as i32 * panel_height + ABOVE;
                self.panel(canvas, panel, (x, y))?;
            }
            let bar = (MARGIN + across as i32 * panel_width, MARGIN + HEAD + ABOVE);
            self.bar(canvas, bar, (down * panel_height - ABOVE - BELOW).clamp(BAR_HEIGHT_MIN, 10 * size[1]))?;
            let top = MARGIN + HEAD + grid_height + 4;
            for (i, note) in notes.iter().enumerate() {
                canvas.text(note, (MARGIN + left, top + i as i32 * (LABEL + 4)), look(LABEL).color(MUTED))?;
            }
            Ok(())
        })
    }

    fn panel(&self, canvas: &Canvas, panel: &HeatPanel, (x, y): (i32, i32)) -> Result<(), PlotError> {
        let size = self.cell_size();
        canvas.text(&panel.title, (x, y - ABOVE / 2), look(SUBTITLE).bold())?;
        let [width, height] = [panel.columns.len() as i32 * size[0], panel.rows.len() as i32 * size[1]];
        for (r, row) in panel.cells.iter().enumerate() {
            let top = y + r as i32 * size[1];
            canvas.text(&panel.rows[r], (x - 6, top + size[1] / 2), look(LABEL).right())?;
            for (c, cell) in row.iter().enumerate() {
                let corner = (x + c as i32 * size[0], top);
                let cell = match cell {
                    Ok(cell) => cell,
                    Err(gap) => {
                        empty(canvas, corner, size, *gap)?;
                        continue;
                    }
                };
                let color = self.color(cell.value);
                canvas.rectangle(corner, (corner.0 + size[0] - 1, corner.1 + size[1] - 1), color)?;
                let middle = (corner.0 + size[0] / 2, corner.1 + size[1] / 2);
                let shift = if cell.range.is_empty() { 0 } else { LINE_SHIFT };
                let look = |size| look(size).centred().color(ink_on(color));
                canvas.text(&cell.text, (middle.0, middle.1 - shift), look(LABEL))?;
                canvas.text(&cell.range, (middle.0, middle.1 + shift), look(RANGE_LABEL))?;
            }
        }
        for (c, name) in panel.columns.iter().enumerate() {
            let at = (x + c as i32 * size[0] + size[0] / 2, y + height + 10);
            canvas.text(name, at, look(LABEL - 1).centred())?;
        }
        canvas.text(&self.column_label, (x + width / 2, y + height + 28), look(SUBTITLE).centred())?;
        canvas.text(&self.row_label, (x - 6, y - ABOVE / 2), look(SUBTITLE).right())
    }

    fn bar(&self, canvas: &Canvas, (x, y): (i32, i32), height: i32) -> Result<(), PlotError> {
        let [lo, hi] = self.range;
        for step in 0..height {
            let place = 1.0 - f64::from(step) / f64::from(height);
            canvas.rectangle((x, y + step), (x + BAR, y + step + 1), self.color(lo * (hi / lo).powf(place)))?;
        }
        canvas.frame((x, y), (x + BAR, y + height), INK)?;
        for (value, text) in &self.color_ticks {
            let place = (value / lo).ln() / (hi / lo).ln();
            if (0.0..=1.0).contains(&place) {
                let at = y + ((1.0 - place) * f64::from(height)) as i32;
                canvas.path(&[(x + BAR, at), (x + BAR + 4, at)], INK, 1, Stroke::Solid)?;
                canvas.text(text, (x + BAR + 7, at), look(LABEL))?;
            }
        }
        let label = (x + BAR + BAR_LABELS - 10, y + height / 2);
        canvas.text(&self.color_label, label, look(LABEL).centred().upright())
    }
}

/// A cell without a value: hatched with its name where it was left out, and a dash where there is nothing to measure.
fn empty(canvas: &Canvas, (x, y): (i32, i32), size: [i32; 2], gap: Gap) -> Result<(), PlotError> {
    let [width, height] = size.map(|side| side - 1);
    canvas.rectangle((x, y), (x + width, y + height), PALE)?;
    let text = match gap {
        Gap::NoPixels => "–",
        Gap::Excluded => {
            for start in (-height..width).step_by(HATCH) {
                // From the lower edge to the upper, both ends cut to the cell.
                let (from, to) = (start.max(0), (start + height).min(width));
                canvas.path(
                    &[(x + from, y + height - (from - start)), (x + to, y + height - (to - start))],
                    GRID,
                    1,
                    Stroke::Solid,
                )?;
            }
            "excluded"
        }
    };
    canvas.text(text, (x + width / 2, y + height / 2), look(EMPTY_LABEL).centred().color(MUTED))
}

/// Black or white, whichever stands out more.
fn ink_on(color: Rgb) -> Rgb {
    let luminance = crate::color::luminance(color.map(|c| crate::color::srgb_decode(f32::from(c) / 255.0)));
    // Where the contrast ratios of black and white text are equal (WCAG 2): (L + 0.05)^2 = 1.05 0.05.
    if luminance > 0.179 { [0, 0, 0] } else { [255, 255, 255] }
}
