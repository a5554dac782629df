//! Lays a figure out at a width: panels in columns, axes, labels, words.

use super::dodge::{Dodge, PITCH};
use super::ends::{end_names, ends_room};
use super::frame::{Frame, HEIGHT_MIN, Layout, PAD};
use super::labels::{Labels, OFF};
use super::scale::Axis;
use super::text::{AXIS, Anchor, LABEL, NAME, Words, stack};
use super::{Figure, Panel, Scale, ScaleKind, Shape};

const COLUMNS: usize = 5;
const COLUMN_GAP: f64 = 18.0;
const ROW_GAP: f64 = 14.0;
/// Least width of a panel of numbers, and of a step, pixels.
const NARROWEST: f64 = 150.0;
const STEP_LEAST: f64 = 14.0;
/// Largest share of a column, and most pixels, of names of steps.
const NAMES_SHARE: f64 = 0.44;
const NAMES_MOST: f64 = 300.0;
/// Height of a panel of numbers over its width, and the most in pixels.
const ASPECT: f64 = 0.68;
const HEIGHT_MAX: f64 = 320.0;
/// Least height and margin of a row, pixels.
const ROW: f64 = 20.0;
const ROW_MARGIN: f64 = 7.0;
const LINES: usize = 3;
/// With more rows of panels, each has its own labels.
const ROWS_AT_ONCE: usize = 3;

pub fn layout(figure: &Figure, width: f64) -> Layout {
    let mut layout = Layout {
        width,
        height: PAD,
        ..Layout::default()
    };
    layout.head(figure);
    let ends = ends_room(figure, width).unwrap_or(0.0);
    Grid {
        figure,
        dodges: figure.panels.iter().map(Dodge::new).collect(),
        width: width - ends,
        x: SharedScale::new(figure, |panel| &panel.x),
        y: SharedScale::new(figure, |panel| &panel.y),
    }
    .lay_out(&mut layout);
    layout
}

/// What the scales of all panels along one direction have in common.
struct SharedScale<'f> {
    /// Whether all are equal: then only outer panels are labelled.
    is_shared: bool,
    /// The common title; `None` if the titles differ.
    title: Option<&'f str>,
}

impl<'f> SharedScale<'f> {
    fn new(figure: &'f Figure, scale: fn(&Panel) -> &Scale) -> Self {
        let scales: Vec<&Scale> = figure.panels.iter().map(scale).collect();
        let Some(first) = scales.first() else {
            return Self {
                is_shared: false,
                title: None,
            };
        };
        let has_one_title = scales.iter().all(|scale| scale.label == first.label);
        Self {
            is_shared: scales.len() > 1 && scales.iter().all(|scale| scale == first),
            title: has_one_title.then_some(first.label.as_str()),
        }
    }
}

/// The panels in rows and columns.
struct Grid<'f> {
    figure: &'f Figure,
    dodges: Vec<Dodge>,
    /// Without the names at the ends of lines.
    width: f64,
    x: SharedScale<'f>,
    y: SharedScale<'f>,
}

/// The columns of a [`Grid`], pixels.
struct Columns {
    count: usize,
    /// Left borders of the panels.
    lefts: Vec<f64>,
    /// Width of a panel.
    width: f64,
}

/// Coordinates of the points of marks, for the choice of ticks.
fn points(panel: &Panel) -> Vec<[f64; 2]> {
    let points = panel.marks.iter().flat_map(|mark| match &mark.shape {
        Shape::Line(points) => points.clone(),
        Shape::Dot(position) => vec![*position],
        Shape::HorizontalBar { y, to, .. } => vec![[*to, *y]],
        _ => Vec::new(),
    });
    points.collect()
}

fn xs(panel: &Panel) -> Vec<f64> {
    points(panel).into_iter().map(|[x, _]| x).collect()
}

fn ys(panel: &Panel) -> Vec<f64> {
    points(panel).into_iter().map(|[_, y]| y).collect()
}

/// Height of a panel of numbers with this width.
fn plot_height(plot_width: f64) -> f64 {
    (plot_width * ASPECT).clamp(HEIGHT_MIN, HEIGHT_MAX)
}

impl Grid<'_> {
    fn panels(&self) -> &[Panel] {
        &self.figure.panels
    }

    /// The labels of y of each panel.
    fn left_labels(&self, column_count: usize) -> Vec<Labels> {
        let column = (self.width - 2.0 * PAD) / column_count as f64;
        let room = (column * NAMES_SHARE).min(NAMES_MOST);
        // About the width of a panel without its labels.
        let length = plot_height(column - 30.0);
        self.panels()
            .iter()
            .map(|panel| Labels::left(&panel.y, length, room, &ys(panel)))
            .collect()
    }

    /// Whether a panel shows its labels of y.
    fn has_left_labels(&self, index: usize, column_count: usize) -> bool {
        !self.y.is_shared || index.is_multiple_of(column_count)
    }

    fn columns(&self, count: usize, left_labels: &[Labels]) -> Columns {
        let depth = |panel: usize| {
            if self.has_left_labels(panel, count) {
                left_labels[panel].depth
            } else {
                0.0
            }
        };
        let gutters: Vec<f64> = (0..count)
            .map(|column| {
                (column..left_labels.len())
                    .step_by(count)
                    .map(depth)
                    .fold(0.0, f64::max)
            })
            .collect();
        let gaps = COLUMN_GAP * (count as f64 - 1.0);
        let width = (self.width - 2.0 * PAD - gaps - gutters.iter().sum::<f64>()) / count as f64;
        let left = |column: usize| {
            PAD + column as f64 * (width + COLUMN_GAP) + gutters[..=column].iter().sum::<f64>()
        };
        Columns {
            count,
            lefts: (0..count).map(left).collect(),
            width,
        }
    }

    /// Least width of a panel.
    fn narrowest(&self, index: usize) -> f64 {
        let panel = &self.panels()[index];
        let ScaleKind::Steps(names) = &panel.x.kind else {
            return NARROWEST;
        };
        // Level names are easier to read than upright ones.
        let words = names
            .iter()
            .flat_map(|name| name.split_whitespace())
            .map(|word| LABEL.width(word) + OFF);
        let lanes = self.dodges[index].count as f64 * PITCH;
        let step = words.fold(STEP_LEAST, f64::max).max(lanes);
        (names.len() as f64 * step).max(NARROWEST * 0.75)
    }

    /// The largest number of columns with room for every panel, evenly filled.
    fn column_count(&self) -> usize {
        let panel_count = self.panels().len().max(1);
        let truncated_count =
            |labels: &[Labels]| labels.iter().map(Labels::truncated_count).sum::<usize>();
        let least_truncated = truncated_count(&self.left_labels(1));
        let has_room = |count: &usize| {
            let left_labels = self.left_labels(*count);
            let width = self.columns(*count, &left_labels).width;
            // More columns must not truncate names.
            truncated_count(&left_labels) == least_truncated
                && (0..self.panels().len()).all(|panel| self.narrowest(panel) <= width)
        };
        let most = (1..=COLUMNS.min(panel_count))
            .rev()
            .find(has_room)
            .unwrap_or(1);
        panel_count.div_ceil(panel_count.div_ceil(most))
    }

    /// Height of a step along y.
    fn row_height(&self, index: usize, labels: &Labels) -> f64 {
        let lanes = if self.dodges[index].is_y {
            self.dodges[index].count as f64 * PITCH
        } else {
            0.0
        };
        ROW.max(labels.tallest().max(lanes) + ROW_MARGIN)
    }

    /// The words above a panel, with y from its top: its name, and the title of y unless that is
    /// common.
    fn names(&self, index: usize, left: f64, width: f64) -> Vec<Words> {
        let panel = &self.panels()[index];
        let title = if self.y.title.is_none() {
            panel.y.label.as_str()
        } else {
            ""
        };
        let mut bottom = -8.0;
        let mut words = Vec::new();
        for (text, font) in [(title, AXIS), (panel.title.as_str(), NAME)] {
            let lines = font.wrap(text, width, LINES);
            bottom -= lines.len() as f64 * font.line();
            let position = [left, bottom + font.line()];
            words.extend(stack(&lines, text, position, font, Anchor::Start));
        }
        words
    }

    fn lay_out(&self, layout: &mut Layout) {
        let column_count = self.column_count();
        let left_labels = self.left_labels(column_count);
        let columns = self.columns(column_count, &left_labels);
        layout.height += PAD - 2.0;
        if let Some(title) = self.y.title.filter(|title| !title.is_empty()) {
            layout.paragraph(title, AXIS, LINES);
            layout.height += OFF;
        }
        let panel_count = self.panels().len();
        for first in (0..panel_count).step_by(column_count) {
            let end = (first + column_count).min(panel_count);
            self.lay_out_row(layout, first..end, &columns, &left_labels);
            layout.height += ROW_GAP;
        }
        layout.height -= ROW_GAP;
        if let (Some(title), Some(left)) = (self.x.title, columns.lefts.first()) {
            let right = self.width - PAD;
            layout.height = title_below(layout, title, [*left, right], layout.height);
        }
        layout.height += PAD;
    }

    /// Lays out a row of panels, with their names above, down to the lowest labels.
    fn lay_out_row(
        &self,
        layout: &mut Layout,
        panels: std::ops::Range<usize>,
        columns: &Columns,
        left_labels: &[Labels],
    ) {
        let first = panels.start;
        let names: Vec<Vec<Words>> = panels
            .clone()
            .map(|panel| self.names(panel, columns.lefts[panel - first], columns.width))
            .collect();
        let line_count = names.iter().map(Vec::len).max().unwrap_or(0) as f64;
        let mut top = layout.height;
        if line_count > 0.0 {
            top += line_count * NAME.line() + 3.0;
        }
        for words in names.into_iter().flatten() {
            let [x, y] = words.position;
            layout.words.push(Words {
                position: [x, top + y],
                ..words
            });
        }
        for panel in panels {
            let bottom = self.lay_out_panel(layout, panel, columns, top, &left_labels[panel]);
            layout.height = layout.height.max(bottom);
        }
    }

    /// The border of a panel, without grid lines.
    fn frame(&self, index: usize, columns: &Columns, top: f64, left_labels: &Labels) -> Frame {
        let panel = &self.panels()[index];
        let left = columns.lefts[index % columns.count];
        let right = left + columns.width;
        let height = match &panel.y.kind {
            ScaleKind::Steps(names) => {
                names.len().max(1) as f64 * self.row_height(index, left_labels)
            }
            _ => plot_height(columns.width),
        };
        let bottom = top + height;
        // Steps run down, numbers up.
        let y = match panel.y.kind {
            ScaleKind::Steps(_) => Axis::new(&panel.y.kind, top, bottom),
            _ => Axis::new(&panel.y.kind, bottom, top),
        };
        Frame {
            x: Axis::new(&panel.x.kind, left, right),
            y,
            left,
            top,
            right,
            bottom,
            grid_x: Vec::new(),
            grid_y: Vec::new(),
            dodge: self.dodges[index].clone(),
        }
    }

    /// Lays out a panel; returns the lower end of its labels.
    fn lay_out_panel(
        &self,
        layout: &mut Layout,
        index: usize,
        columns: &Columns,
        top: f64,
        left_labels: &Labels,
    ) -> f64 {
        let panel = &self.panels()[index];
        let panel_count = self.panels().len();
        let mut frame = self.frame(index, columns, top, left_labels);
        // Labels may use half of the gap between panels, or the margin.
        let side = COLUMN_GAP / 2.0 - 2.0;
        let is_leftmost = index.is_multiple_of(columns.count);
        let over_left = if is_leftmost {
            left_labels.depth.max(side)
        } else {
            side
        };
        let labels_below = Labels::below(&panel.x, columns.width, [over_left, side], &xs(panel));
        let mut end = frame.bottom;
        let has_many_rows = panel_count.div_ceil(columns.count) > ROWS_AT_ONCE;
        let is_in_last_row = index + columns.count >= panel_count;
        if !self.x.is_shared || has_many_rows || is_in_last_row {
            let ends = [frame.left - over_left, frame.right + side];
            let words = labels_below.words_below(&frame.x, frame.bottom, ends);
            layout.words.extend(words);
            end += labels_below.depth;
        }
        if self.has_left_labels(index, columns.count) {
            let words = left_labels.words_left(&frame.y, frame.left);
            layout.words.extend(words);
        }
        if self.x.title.is_none() {
            let ends = [frame.left, frame.right + side];
            end = title_below(layout, &panel.x.label, ends, end);
        }
        frame.grid_x = grid_lines(panel, &frame.x, &labels_below);
        frame.grid_y = grid_lines(panel, &frame.y, left_labels);
        let has_ends = layout.width > self.width;
        let is_rightmost = (index + 1).is_multiple_of(columns.count) || index + 1 == panel_count;
        if has_ends && is_rightmost {
            layout.words.extend(end_names(self.figure, panel, &frame));
        }
        layout.frames.push(frame);
        end
    }
}

/// Grid lines at the labels of an axis; none for steps with bars, which would hide them.
fn grid_lines(panel: &Panel, axis: &Axis, labels: &Labels) -> Vec<f64> {
    let has_bars = panel
        .marks
        .iter()
        .any(|mark| matches!(mark.shape, Shape::HorizontalBar { .. }));
    if axis.has_steps() && has_bars {
        return Vec::new();
    }
    labels
        .values()
        .into_iter()
        .map(|value| axis.pixel(value))
        .collect()
}

/// Appends the title of x below `top`; returns its lower end.
fn title_below(layout: &mut Layout, title: &str, [left, right]: [f64; 2], top: f64) -> f64 {
    let lines = AXIS.wrap(title, right - left, LINES);
    let position = [(left + right) / 2.0, top + AXIS.line()];
    let words = stack(&lines, title, position, AXIS, Anchor::Middle);
    layout.words.extend(words);
    top + lines.len() as f64 * AXIS.line() + OFF / 2.0
}
