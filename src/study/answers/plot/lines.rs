//! Panels with lines, markers and error bars on shared axes, and one legend below them.

use super::canvas::{Canvas, GRID, INK, MUTED, Marker, PlotError, Rgb, Stroke, look, picture, text_width};
use super::scale::Scale;

/// A value with its interval, where it has one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Point {
    pub x: f64,
    pub y: Y,
    /// An end beyond the axis is drawn as an arrow.
    pub interval: Option<[f64; 2]>,
}

/// Where a point lies.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Y {
    At(f64),
    /// Below all that was tried: a mark in the band under the drawing, joined to nothing.
    Below,
    /// Above all that was tried.
    Above,
}

impl Y {
    /// The value, where there is one.
    pub fn known(self) -> Option<f64> {
        if let Self::At(y) = self { Some(y) } else { None }
    }
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
    /// What the bands below and above the drawing mean, where points lie in them.
    pub bands: [Option<String>; 2],
    /// Whether series with bars stand a little aside of each other: only where x has a few tried values, never where it is measured.
    pub is_aside: bool,
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
/// Height of a band beyond the drawing.
const BAND: i32 = 22;
/// Ground of a band.
const PALE: Rgb = [246, 246, 246];
/// Distance of the rows of tick labels.
const LABEL_ROW: i32 = 14;
/// Room between neighbouring labels of the x axis.
const LABEL_GAP: i32 = 8;

/// Place of the plot area of a panel.
#[derive(Clone, Copy)]
struct Frame {
    left: i32,
    top: i32,
    width: i32,
    height: i32,
    /// Room at the left and the right that series which stand aside reach into.
    inset: f64,
    /// Heights of the bands at the bottom and at the top.
    bands: [i32; 2],
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
        let bands = self.bands.each_ref().map(|band| if band.is_some() { BAND } else { 0 });
        let height = height + bands[0] + bands[1];
        let (stagger, label_rows) = self.label_rows(width);
        let below = BELOW + (label_rows - 1) * LABEL_ROW;
        let grid_height = rows as i32 * (ABOVE + height + below);
        let full_height =
            2 * MARGIN + HEAD + grid_height + legend_rows * LEGEND_ROW + notes.len() as i32 * (LABEL + 4) + GAP;
        picture(&self.title, [full_width, full_height], |canvas| {
            canvas.text(&self.title, (MARGIN + LEFT, MARGIN + TITLE / 2), look(TITLE).bold())?;
            for (i, panel) in self.panels.iter().enumerate() {
                let (column, row) = ((i % columns) as i32, (i / columns) as i32);
                let frame = Frame {
                    left: MARGIN + LEFT + column * (LEFT + width + GAP),
                    top: MARGIN + HEAD + ABOVE + row * (ABOVE + height + below),
                    width,
                    height,
                    bands,
                    inset: if spread > 0.0 { spread / 2.0 + MARK } else { 0.0 },
                };
                // The last panel of each column has the label of the x axis.
                let is_last = i + columns >= self.panels.len();
                self.axes(canvas, frame, &panel.title, is_last.then_some(below), column == 0, stagger)?;
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

    fn at(&self, frame: Frame, x: f64, y: Y) -> Option<(i32, i32)> {
        let y = match y {
            Y::At(y) => frame.y(self.y.place(y)?),
            Y::Below => frame.top + frame.height - BAND / 2,
            Y::Above => frame.top + BAND / 2,
        };
        Some((frame.x(self.x.place(x)?), y))
    }

    /// Rows over which neighbouring labels of the x axis are spread, 1 or 2, and the rows of text that takes.
    fn label_rows(&self, width: i32) -> (i32, i32) {
        let lines = self.x.ticks.iter().map(|(_, text)| text.lines().count() as i32).max().unwrap_or(1).max(1);
        let widest = |text: &str| text.lines().map(|line| text_width(line, LABEL)).max().unwrap_or(0);
        let places: Vec<(f64, i32)> =
            self.x.ticks.iter().filter_map(|(value, text)| Some((self.x.place(*value)?, widest(text)))).collect();
        let touch = |pair: &[(f64, i32)]| {
            (pair[1].0 - pair[0].0) * f64::from(width) < f64::from((pair[0].1 + pair[1].1) / 2 + LABEL_GAP)
        };
        let stagger = if places.windows(2).any(touch) { 2 } else { 1 };
        (stagger, stagger * lines)
    }

    fn axes(
        &self,
        canvas: &Canvas,
        frame: Frame,
        title: &str,
        below: Option<i32>,
        has_y_label: bool,
        stagger: i32,
    ) -> Result<(), PlotError> {
        let (right, bottom) = (frame.left + frame.width, frame.top + frame.height);
        if !title.is_empty() {
            canvas.text(title, (frame.left, frame.top - ABOVE / 2), look(SUBTITLE).bold())?;
        }
        for (band, (from, to), middle) in [
            (&self.bands[0], (bottom - frame.bands[0], bottom), bottom - BAND / 2),
            (&self.bands[1], (frame.top, frame.top + frame.bands[1]), frame.top + BAND / 2),
        ] {
            let Some(text) = band else { continue };
            canvas.rectangle((frame.left, from), (right, to), PALE)?;
            canvas.text(text, (frame.left - 7, middle), look(LABEL).right())?;
        }
        for (i, (value, text)) in self.x.ticks.iter().enumerate() {
            let Some(x) = self.x.place(*value).map(|place| frame.x(place)) else { continue };
            canvas.path(&[(x, frame.top), (x, bottom)], GRID, 1, Stroke::Solid)?;
            canvas.path(&[(x, bottom), (x, bottom + 4)], INK, 1, Stroke::Solid)?;
            let lines = text.lines().count() as i32;
            let top = bottom + 13 + i as i32 % stagger * lines * LABEL_ROW;
            for (row, line) in text.lines().enumerate() {
                canvas.text(line, (x, top + row as i32 * LABEL_ROW), look(LABEL).centred())?;
            }
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
        for (edge, band) in [(bottom - frame.bands[0], frame.bands[0]), (frame.top + frame.bands[1], frame.bands[1])] {
            if band > 0 {
                canvas.path(&[(frame.left, edge), (right, edge)], MUTED, 1, Stroke::Solid)?;
            }
        }
        canvas.frame((frame.left, frame.top), (right, bottom), INK)?;
        if let Some(below) = below {
            let at = (frame.left + frame.width / 2, bottom + below - 12);
            canvas.text(&self.x_label, at, look(SUBTITLE).centred())?;
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
            if let Some(stroke) = series.stroke {
                // What lies beyond the drawing parts the line.
                for run in series.points.split(|point| point.y.known().is_none()) {
                    canvas.path(&run.iter().filter_map(at).collect::<Vec<_>>(), series.color, 2, stroke)?;
                }
            }
            for point in &series.points {
                if let (Some(ends), Some(at)) = (point.interval, at(point)) {
                    self.bar(canvas, frame, at, point.y, ends, series.color)?;
                }
            }
            let Some(marker) = series.marker else { continue };
            for (point, at) in series.points.iter().filter_map(|point| Some((point, at(point)?))) {
                match point.y {
                    Y::At(_) => canvas.marker(at, marker, series.color)?,
                    Y::Above => canvas.arrow(at, 1, series.color)?,
                    Y::Below => canvas.arrow(at, -1, series.color)?,
                }
            }
        }
        Ok(())
    }

    /// The interval of a point at a place. Known ends have a cap; towards one beyond the drawing a dotted line runs to an arrow at the
    /// edge, so that what it crosses is crossed and what is drawn stays readable. The bar of a point in a band reaches into the drawing from there.
    fn bar(
        &self,
        canvas: &Canvas,
        frame: Frame,
        (x, y): (i32, i32),
        at: Y,
        ends: [f64; 2],
        color: Rgb,
    ) -> Result<(), PlotError> {
        let known = ends.map(|end| self.y.place(end).filter(|place| (0.0..=1.0).contains(place)).map(|p| frame.y(p)));
        // Downwards and upwards.
        for (end, sign) in known.into_iter().zip([1, -1]) {
            match (end, at) {
                (Some(end), _) => {
                    canvas.path(&[(x, y), (x, end)], color, 1, Stroke::Solid)?;
                    canvas.path(&[(x - 3, end), (x + 3, end)], color, 1, Stroke::Solid)?;
                }
                (None, Y::At(_)) => {
                    let tip = match sign {
                        1 => frame.top + frame.height - frame.bands[0] - 1,
                        _ => frame.top + frame.bands[1] + 1,
                    };
                    canvas.path(&[(x, y), (x, tip)], color, 1, Stroke::Dotted)?;
                    let wing = tip - sign * 4;
                    canvas.path(&[(x - 3, wing), (x, tip), (x + 3, wing)], color, 1, Stroke::Solid)?;
                }
                (None, _) => {}
            }
        }
        Ok(())
    }

    /// Pixels from the first series of a panel to the last one at the same value: 0 where no bars would hide each other.
    fn spread(&self, panel: &Panel, width: i32) -> f64 {
        let points = || panel.series.iter().flat_map(|series| &series.points);
        if !self.is_aside || panel.series.len() < 2 || points().all(|point| point.interval.is_none()) {
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
        let [below, above] = self.bands;
        self.top + above + ((1.0 - place) * f64::from(self.height - below - above)).round() as i32
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
