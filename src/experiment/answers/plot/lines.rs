//! Panels with lines, markers and error bars on shared axes, and one legend below them.

use super::canvas::{Canvas, GRID, INK, MUTED, Marker, PlotError, Rgb, Stroke, look, picture, text_width};
use super::scale::Scale;

/// A value with its interval, where it has one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Point {
    pub x: f64,
    pub y: f64,
    /// Ends beyond the axis are drawn to its edge.
    pub interval: Option<[f64; 2]>,
}

/// What is joined by a line.
#[derive(Clone, Debug)]
pub struct Series {
    pub label: String,
    pub color: Rgb,
    pub marker: Option<Marker>,
    pub stroke: Option<Stroke>,
    pub points: Vec<Point>,
}

/// A horizontal line over a whole panel.
#[derive(Clone, Debug)]
pub struct Rule {
    pub label: String,
    pub color: Rgb,
    pub stroke: Stroke,
    pub y: f64,
}

/// One small chart.
#[derive(Clone, Debug)]
pub struct Panel {
    pub title: String,
    pub series: Vec<Series>,
    pub rules: Vec<Rule>,
}

/// A figure of panels.
#[derive(Clone, Debug)]
pub struct LineChart {
    pub title: String,
    /// Sentences below the legend.
    pub notes: Vec<String>,
    pub x_label: String,
    pub y_label: String,
    pub x: Scale,
    pub y: Scale,
    pub panels: Vec<Panel>,
}

const TITLE: i32 = 17;
const SUBTITLE: i32 = 13;
const LABEL: i32 = 12;
/// Outer margin.
const MARGIN: i32 = 14;
/// Room for the title.
const HEAD: i32 = 34;
/// Room left of a plot area for its tick labels and, in the first column, the axis label.
const LEFT: i32 = 62;
/// Room below a plot area for tick labels and axis label.
const BELOW: i32 = 44;
/// Room above a plot area for its title.
const ABOVE: i32 = 24;
const GAP: i32 = 14;
const LEGEND_ROW: i32 = 20;
const LEGEND_MARK: i32 = 34;
/// Pixels between series with error bars, where there is room.
const ASIDE: i32 = 5;
/// Panels in a row.
const COLUMNS_MAX: usize = 3;

/// The series of a panel together stand no wider than this, pixels, and than this share of the distance between neighbouring values.
const ASIDE_MAX: f64 = 24.0;
const ASIDE_SHARE: f64 = 0.5;
/// Room for half a mark beside the outermost series.
const MARK: f64 = 6.0;

/// Place of the plot area of a panel.
#[derive(Clone, Copy)]
struct Frame {
    left: i32,
    top: i32,
    width: i32,
    height: i32,
    /// Room at the left and the right that series which stand aside reach into.
    inset: f64,
}

impl LineChart {
    fn columns(&self) -> usize {
        match self.panels.len() {
            0..=COLUMNS_MAX => self.panels.len().max(1),
            // Two rows of two look better than three and one.
            4 => 2,
            _ => COLUMNS_MAX,
        }
    }

    fn panel_size(&self) -> (i32, i32) {
        match self.columns() {
            1 => (600, 340),
            2 => (380, 270),
            _ => (280, 220),
        }
    }

    pub fn svg(&self) -> Result<String, PlotError> {
        let columns = self.columns();
        let rows = self.panels.len().div_ceil(columns);
        let (width, height) = self.panel_size();
        let full_width = 2 * MARGIN + columns as i32 * (LEFT + width) + (columns as i32 - 1) * GAP;
        let legend = self.legend(full_width - 2 * MARGIN - LEFT);
        let legend_rows = legend.iter().map(|(_, (_, row))| row + 1).max().unwrap_or(0);
        let notes = wrapped(&self.notes, full_width - 2 * MARGIN - LEFT);
        let spread = self.panels.iter().map(|panel| self.spread(panel, width)).fold(0.0, f64::max);
        let grid_height = rows as i32 * (ABOVE + height + BELOW);
        let full_height =
            2 * MARGIN + HEAD + grid_height + legend_rows * LEGEND_ROW + notes.len() as i32 * (LABEL + 4) + GAP;
        picture(&self.title, [full_width, full_height], |canvas| {
            canvas.text(&self.title, (MARGIN + LEFT, MARGIN + TITLE / 2), look(TITLE).bold())?;
            for (i, panel) in self.panels.iter().enumerate() {
                let (column, row) = ((i % columns) as i32, (i / columns) as i32);
                let frame = Frame {
                    left: MARGIN + LEFT + column * (LEFT + width + GAP),
                    top: MARGIN + HEAD + ABOVE + row * (ABOVE + height + BELOW),
                    width,
                    height,
                    inset: if spread > 0.0 { spread / 2.0 + MARK } else { 0.0 },
                };
                // The last panel of each column has the label of the x axis.
                let is_last = i + columns >= self.panels.len();
                self.axes(canvas, frame, &panel.title, is_last, column == 0)?;
                self.panel(canvas, frame, panel)?;
            }
            let top = MARGIN + HEAD + grid_height + GAP;
            for (entry, (x, row)) in &legend {
                entry.draw(canvas, (MARGIN + LEFT + x, top + row * LEGEND_ROW))?;
            }
            let top = top + legend_rows * LEGEND_ROW;
            for (i, note) in notes.iter().enumerate() {
                canvas.text(note, (MARGIN + LEFT, top + i as i32 * (LABEL + 4)), look(LABEL).color(MUTED))?;
            }
            Ok(())
        })
    }

    fn at(&self, frame: Frame, x: f64, y: f64) -> Option<(i32, i32)> {
        Some((frame.x(self.x.place(x)?), frame.y(self.y.place(y)?)))
    }

    fn axes(
        &self,
        canvas: &Canvas,
        frame: Frame,
        title: &str,
        has_x_label: bool,
        has_y_label: bool,
    ) -> Result<(), PlotError> {
        let (right, bottom) = (frame.left + frame.width, frame.top + frame.height);
        if !title.is_empty() {
            canvas.text(title, (frame.left, frame.top - ABOVE / 2), look(SUBTITLE).bold())?;
        }
        for (value, text) in &self.x.ticks {
            let Some(x) = self.x.place(*value).map(|place| frame.x(place)) else { continue };
            canvas.path(&[(x, frame.top), (x, bottom)], GRID, 1, Stroke::Solid)?;
            canvas.path(&[(x, bottom), (x, bottom + 4)], INK, 1, Stroke::Solid)?;
            canvas.text(text, (x, bottom + 13), look(LABEL).centred())?;
        }
        for (value, text) in &self.y.ticks {
            let Some(y) = self.y.place(*value).map(|place| frame.y(place)) else { continue };
            canvas.path(&[(frame.left, y), (right, y)], GRID, 1, Stroke::Solid)?;
            canvas.path(&[(frame.left - 4, y), (frame.left, y)], INK, 1, Stroke::Solid)?;
            canvas.text(text, (frame.left - 7, y), look(LABEL).right())?;
        }
        for x in self.x.minor.iter().filter_map(|value| self.x.place(*value)).map(|place| frame.x(place)) {
            canvas.path(&[(x, bottom), (x, bottom + 2)], INK, 1, Stroke::Solid)?;
        }
        for y in self.y.minor.iter().filter_map(|value| self.y.place(*value)).map(|place| frame.y(place)) {
            canvas.path(&[(frame.left - 2, y), (frame.left, y)], INK, 1, Stroke::Solid)?;
        }
        canvas.frame((frame.left, frame.top), (right, bottom), INK)?;
        if has_x_label {
            canvas.text(&self.x_label, (frame.left + frame.width / 2, bottom + 32), look(SUBTITLE).centred())?;
        }
        if has_y_label {
            let at = (frame.left - LEFT + 8, frame.top + frame.height / 2);
            canvas.text(&self.y_label, at, look(SUBTITLE).centred().upright())?;
        }
        Ok(())
    }

    fn panel(&self, canvas: &Canvas, frame: Frame, panel: &Panel) -> Result<(), PlotError> {
        for rule in &panel.rules {
            let Some(place) = self.y.place(rule.y).filter(|place| (0.0..=1.0).contains(place)) else { continue };
            let y = frame.y(place);
            canvas.path(&[(frame.left, y), (frame.left + frame.width, y)], rule.color, 1, rule.stroke)?;
        }
        // Bars at the same place would hide each other: each series stands a little aside.
        let spread = self.spread(panel, frame.width);
        let last = (panel.series.len() as f64 - 1.0).max(1.0);
        for (index, series) in panel.series.iter().enumerate() {
            let aside = (spread * (index as f64 / last - 0.5)).round() as i32;
            let at = |p: &Point| self.at(frame, p.x, p.y).map(|(x, y)| (x + aside, y));
            let shown: Vec<(i32, i32)> = series.points.iter().filter_map(at).collect();
            if let Some(stroke) = series.stroke {
                canvas.path(&shown, series.color, 2, stroke)?;
            }
            for point in &series.points {
                let (Some([lo, hi]), Some(x)) = (point.interval, self.x.place(point.x)) else { continue };
                let x = frame.x(x) + aside;
                let end = |value: f64, open: f64| self.y.place(value).map_or(open, |place| place.clamp(0.0, 1.0));
                let ends = [frame.y(end(lo, 0.0)), frame.y(end(hi, 1.0))];
                canvas.path(&[(x, ends[0]), (x, ends[1])], series.color, 1, Stroke::Solid)?;
                for (value, y) in [lo, hi].into_iter().zip(ends) {
                    // An end that lies beyond the axis has no cap.
                    if self.y.place(value).is_some_and(|place| (0.0..=1.0).contains(&place)) {
                        canvas.path(&[(x - 3, y), (x + 3, y)], series.color, 1, Stroke::Solid)?;
                    }
                }
            }
            if let Some(marker) = series.marker {
                shown.iter().try_for_each(|at| canvas.marker(*at, marker, series.color))?;
            }
        }
        Ok(())
    }

    /// Pixels from the first series of a panel to the last one at the same value: 0 where no bars would hide each other.
    fn spread(&self, panel: &Panel, width: i32) -> f64 {
        let points = || panel.series.iter().flat_map(|series| &series.points);
        if panel.series.len() < 2 || points().all(|point| point.interval.is_none()) {
            return 0.0;
        }
        let mut places: Vec<f64> = points().filter_map(|point| self.x.place(point.x)).collect();
        places.sort_by(f64::total_cmp);
        // Values closer than a pixel are one to the eye.
        let distances = places.windows(2).map(|pair| (pair[1] - pair[0]) * f64::from(width)).filter(|d| *d >= 1.0);
        let nearest = distances.fold(f64::INFINITY, f64::min);
        f64::from(ASIDE * (panel.series.len() as i32 - 1)).min(ASIDE_MAX).min(ASIDE_SHARE * nearest)
    }

    /// Every label once, with its place: x offset and row.
    fn legend(&self, width: i32) -> Vec<(Entry<'_>, (i32, i32))> {
        let mut entries: Vec<Entry> = Vec::new();
        for panel in &self.panels {
            let series = panel.series.iter().map(|s| Entry {
                label: &s.label,
                color: s.color,
                marker: s.marker,
                stroke: s.stroke,
            });
            let rules = panel.rules.iter().map(|r| Entry {
                label: &r.label,
                color: r.color,
                marker: None,
                stroke: Some(r.stroke),
            });
            for entry in series.chain(rules) {
                if !entry.label.is_empty() && entries.iter().all(|known| known.label != entry.label) {
                    entries.push(entry);
                }
            }
        }
        let widest = entries.iter().map(|entry| text_width(entry.label, LABEL)).max().unwrap_or(0) + LEGEND_MARK + 18;
        let columns = (width / widest).max(1);
        let place = |i: usize| (i as i32 % columns * widest, i as i32 / columns);
        entries.into_iter().enumerate().map(|(i, entry)| (entry, place(i))).collect()
    }
}

impl Frame {
    fn x(&self, place: f64) -> i32 {
        self.left + (self.inset + place * (f64::from(self.width) - 2.0 * self.inset)).round() as i32
    }

    fn y(&self, place: f64) -> i32 {
        self.top + ((1.0 - place) * f64::from(self.height)).round() as i32
    }
}

/// One label of the legend with its mark.
struct Entry<'c> {
    label: &'c str,
    color: Rgb,
    marker: Option<Marker>,
    stroke: Option<Stroke>,
}

impl Entry<'_> {
    fn draw(&self, canvas: &Canvas, (x, y): (i32, i32)) -> Result<(), PlotError> {
        if let Some(stroke) = self.stroke {
            canvas.path(&[(x, y), (x + LEGEND_MARK - 8, y)], self.color, 2, stroke)?;
        }
        if let Some(marker) = self.marker {
            canvas.marker((x + LEGEND_MARK / 2 - 4, y), marker, self.color)?;
        }
        canvas.text(self.label, (x + LEGEND_MARK, y), look(LABEL))
    }
}

/// Sentences broken into lines of a width, pixels.
pub fn wrapped(notes: &[String], width: i32) -> Vec<String> {
    let mut lines = Vec::new();
    for note in notes {
        let mut line = String::new();
        for word in note.split(' ') {
            if !line.is_empty() && text_width(&line, LABEL) + text_width(word, LABEL) > width {
                lines.push(std::mem::take(&mut line));
            }
            if !line.is_empty() {
                line.push(' ');
            }
            line += word;
        }
        lines.push(line);
    }
    lines
}
