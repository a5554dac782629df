//! Lays a figure out at a width: panels in columns, axes, labels, words.

use super::dodge::{Dodge, PITCH};
use super::ink::class;
use super::labels::{Labels, OFF};
use super::scale::Axis;
use super::text::{AXIS, LABEL, MIDDLE, NAME, Words, stack};
use super::{Figure, Mark, Panel, Scale, ScaleKind, Shape};

/// Margin, pixels.
pub const PAD: f64 = 12.0;
const COLUMNS: usize = 5;
const COLUMN_GAP: f64 = 18.0;
const ROW_GAP: f64 = 14.0;
/// Least width of a panel of numbers, and of a step, pixels.
const NARROWEST: f64 = 150.0;
const STEP_LEAST: f64 = 14.0;
/// Largest share of a column, and most pixels, of names of steps.
const NAMES_SHARE: f64 = 0.44;
const NAMES_MOST: f64 = 300.0;
/// Height of a panel over its width, and its limits in pixels.
const ASPECT: f64 = 0.68;
const HEIGHTS: [f64; 2] = [140.0, 320.0];
/// Least height and margin of a row, pixels.
const ROW: f64 = 20.0;
const ROW_MARGIN: f64 = 7.0;
const LINES: usize = 3;
/// With more rows of panels, each has its own labels.
const ROWS_AT_ONCE: usize = 3;

/// Largest share of the width that names at the ends of lines take.
const ENDS_SHARE: f64 = 0.27;

#[derive(Clone, Debug, PartialEq)]
pub struct Frame {
    pub x: Axis,
    pub y: Axis,
    pub left: f64,
    pub top: f64,
    pub right: f64,
    pub bottom: f64,
    /// Grid lines along x and y.
    pub lines: [Vec<f64>; 2],
    pub dodge: Dodge,
}

#[derive(Clone, Debug, Default, PartialEq)]
pub struct Layout {
    pub width: f64,
    /// So far.
    pub height: f64,
    pub words: Vec<Words>,
    /// Series, and left middle of its mark in the legend.
    pub entries: Vec<(usize, [f64; 2])>,
    pub swatch: f64,
    pub frames: Vec<Frame>,
}

pub fn layout(figure: &Figure, width: f64) -> Layout {
    let mut layout = Layout {
        width,
        height: PAD,
        ..Layout::default()
    };
    layout.head(figure);
    let common = |of: fn(&Panel) -> &Scale| -> (bool, Option<&str>) {
        let mut all = figure.panels.iter().map(of);
        let Some(first) = all.next() else {
            return (false, None);
        };
        let is_one = all.clone().all(|scale| scale.label == first.label);
        (
            figure.panels.len() > 1 && all.all(|scale| scale == first),
            is_one.then_some(first.label.as_str()),
        )
    };
    let [x, y] = [common(|panel| &panel.x), common(|panel| &panel.y)];
    let dodges = figure.panels.iter().map(Dodge::new).collect();
    let ends = ends_room(figure, width).unwrap_or(0.0);
    Grid {
        figure,
        dodges,
        width: width - ends,
        is_shared: [x.0, y.0],
        titles: [x.1, y.1],
    }
    .place(&mut layout);
    layout
}

/// The room for names at the ends of lines, pixels; `None` if some panel has no line of some
/// series, or the names are too many or too long.
pub fn ends_room(figure: &Figure, width: f64) -> Option<f64> {
    let has_end = |panel: &Panel, series: usize| {
        panel
            .marks
            .iter()
            .any(|mark| mark.series == Some(series) && end(mark).is_some())
    };
    let is_whole = |panel: &Panel| (0..figure.series.len()).all(|series| has_end(panel, series));
    let room = OFF + NAME.widest(figure.series.iter().map(|series| &series.name));
    let count = figure.series.len();
    let fits = room < ENDS_SHARE * width && count as f64 * NAME.line() <= HEIGHTS[0];
    (count > 0 && fits && figure.panels.iter().all(is_whole)).then_some(room)
}

/// The last point of a line, or the y of a rule.
fn end(mark: &Mark) -> Option<[f64; 2]> {
    match &mark.shape {
        Shape::Line(points) => points.last().copied(),
        Shape::HorizontalRule(y) => Some([f64::NAN, *y]),
        _ => None,
    }
}

struct Grid<'f> {
    figure: &'f Figure,
    dodges: Vec<Dodge>,
    /// Without the names at the ends of lines.
    width: f64,
    /// Whether all panels have one scale of x and of y: then only outer panels are labelled.
    is_shared: [bool; 2],
    titles: [Option<&'f str>; 2],
}

/// Coordinates of marks along x and y, for the choice of ticks.
fn tried(panel: &Panel) -> [Vec<f64>; 2] {
    let places = panel.marks.iter().flat_map(|mark| match &mark.shape {
        Shape::Line(points) => points.clone(),
        Shape::Dot(at) => vec![*at],
        Shape::HorizontalBar { y, to, .. } => vec![[*to, *y]],
        _ => Vec::new(),
    });
    places
        .map(|[x, y]| (x, y))
        .unzip::<f64, f64, Vec<f64>, Vec<f64>>()
        .into()
}

fn height_of(plot_width: f64) -> f64 {
    (plot_width * ASPECT).clamp(HEIGHTS[0], HEIGHTS[1])
}

impl Grid<'_> {
    fn panels(&self) -> &[Panel] {
        &self.figure.panels
    }

    fn beside(&self, columns: usize) -> Vec<Labels> {
        let column = (self.width - 2.0 * PAD) / columns as f64;
        let (room, length) = (
            (column * NAMES_SHARE).min(NAMES_MOST),
            height_of(column - 30.0),
        );
        self.panels()
            .iter()
            .map(|panel| Labels::beside(&panel.y, length, room, &tried(panel)[1]))
            .collect()
    }

    /// Whether a panel has labels of y.
    fn is_labelled(&self, index: usize, columns: usize) -> bool {
        !self.is_shared[1] || index.is_multiple_of(columns)
    }

    /// Left borders of the columns, and the width of panels.
    fn columns(&self, columns: usize, beside: &[Labels]) -> (Vec<f64>, f64) {
        let depth = |i: usize| {
            if self.is_labelled(i, columns) {
                beside[i].depth
            } else {
                0.0
            }
        };
        let gutters: Vec<f64> = (0..columns)
            .map(|c| {
                (c..beside.len())
                    .step_by(columns)
                    .map(depth)
                    .fold(0.0, f64::max)
            })
            .collect();
        let gaps = COLUMN_GAP * (columns as f64 - 1.0);
        let width = (self.width - 2.0 * PAD - gaps - gutters.iter().sum::<f64>()) / columns as f64;
        let left =
            |c: usize| PAD + c as f64 * (width + COLUMN_GAP) + gutters[..=c].iter().sum::<f64>();
        ((0..columns).map(left).collect(), width)
    }

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
        let count = self.panels().len().max(1);
        let cut = |labels: &[Labels]| labels.iter().map(Labels::cut).sum::<usize>();
        let at_best = cut(&self.beside(1));
        let fits = |columns: &usize| {
            let beside = self.beside(*columns);
            let (_, width) = self.columns(*columns, &beside);
            // More columns must not truncate names.
            cut(&beside) == at_best && (0..self.panels().len()).all(|i| self.narrowest(i) <= width)
        };
        let most = (1..=COLUMNS.min(count)).rev().find(fits).unwrap_or(1);
        count.div_ceil(count.div_ceil(most))
    }

    fn row_height(&self, index: usize, labels: &Labels) -> f64 {
        let lanes = if self.dodges[index].is_y {
            self.dodges[index].count as f64 * PITCH
        } else {
            0.0
        };
        ROW.max(labels.row().max(lanes) + ROW_MARGIN)
    }

    /// The words above a panel: its name, and the title of y unless that is common.
    fn names(&self, index: usize, left: f64, width: f64) -> Vec<Words> {
        let panel = &self.panels()[index];
        let title = if self.titles[1].is_none() {
            panel.y.label.as_str()
        } else {
            ""
        };
        let mut bottom = -8.0;
        let mut words = Vec::new();
        for (text, font) in [(title, AXIS), (panel.title.as_str(), NAME)] {
            let lines = font.wrap(text, width, LINES);
            bottom -= lines.len() as f64 * font.line();
            words.extend(stack(
                &lines,
                text,
                [left, bottom + font.line()],
                font,
                "start",
            ));
        }
        words
    }

    fn place(&self, layout: &mut Layout) {
        let columns = self.column_count();
        let beside = self.beside(columns);
        let (lefts, width) = self.columns(columns, &beside);
        layout.height += PAD - 2.0;
        if let Some(title) = self.titles[1].filter(|title| !title.is_empty()) {
            layout.paragraph(title, AXIS, LINES);
            layout.height += OFF;
        }
        let count = self.panels().len();
        for row in (0..count).step_by(columns) {
            let own = row..(row + columns).min(count);
            let names: Vec<Vec<Words>> = own
                .clone()
                .map(|i| self.names(i, lefts[i - row], width))
                .collect();
            let tallest = names.iter().map(Vec::len).max().unwrap_or(0) as f64;
            let top = layout.height
                + if tallest > 0.0 {
                    tallest * NAME.line() + 3.0
                } else {
                    0.0
                };
            for words in names.into_iter().flatten() {
                layout.words.push(Words {
                    at: [words.at[0], top + words.at[1]],
                    ..words
                });
            }
            for i in own {
                let end = self.panel(layout, i, [lefts[i - row], top, width], &beside[i], columns);
                layout.height = layout.height.max(end);
            }
            layout.height += ROW_GAP;
        }
        layout.height -= ROW_GAP;
        if let (Some(title), Some(left)) = (self.titles[0], lefts.first()) {
            let right = self.width - PAD;
            layout.height = title_below(layout, title, [*left, right], layout.height);
        }
        layout.height += PAD;
    }

    /// Places a panel; returns the lower end of its labels.
    fn panel(
        &self,
        layout: &mut Layout,
        index: usize,
        [left, top, width]: [f64; 3],
        beside: &Labels,
        columns: usize,
    ) -> f64 {
        let panel = &self.panels()[index];
        let right = left + width;
        // Labels may use half of the gap between panels, or the margin.
        let side = COLUMN_GAP / 2.0 - 2.0;
        let over = [
            if index.is_multiple_of(columns) {
                beside.depth.max(side)
            } else {
                side
            },
            side,
        ];
        let has_rows = matches!(panel.y.kind, ScaleKind::Steps(_));
        let height = match &panel.y.kind {
            ScaleKind::Steps(names) => names.len().max(1) as f64 * self.row_height(index, beside),
            _ => height_of(width),
        };
        let bottom = top + height;
        let x = Axis::new(&panel.x.kind, left, right);
        // Steps run down, numbers up.
        let [from, to] = if has_rows {
            [top, bottom]
        } else {
            [bottom, top]
        };
        let y = Axis::new(&panel.y.kind, from, to);
        let below = Labels::below(&panel.x, width, over, &tried(panel)[0]);
        let mut end = bottom;
        let has_many_rows = self.panels().len().div_ceil(columns) > ROWS_AT_ONCE;
        if !self.is_shared[0] || has_many_rows || index + columns >= self.panels().len() {
            layout
                .words
                .extend(below.words_below(&x, bottom, [left - over[0], right + over[1]]));
            end += below.depth;
        }
        if self.is_labelled(index, columns) {
            layout.words.extend(beside.words_beside(&y, left));
        }
        if self.titles[0].is_none() {
            end = title_below(layout, &panel.x.label, [left, right + side], end);
        }
        // Grid lines behind bars are useless.
        let is_filled = panel
            .marks
            .iter()
            .any(|mark| matches!(mark.shape, Shape::HorizontalBar { .. }));
        let lines = |axis: &Axis, labels: &Labels| match axis.has_steps() && is_filled {
            true => Vec::new(),
            false => labels
                .values()
                .into_iter()
                .map(|value| axis.at(value))
                .collect(),
        };
        let frame = Frame {
            lines: [lines(&x, &below), lines(&y, beside)],
            dodge: self.dodges[index].clone(),
            x,
            y,
            left,
            top,
            right,
            bottom,
        };
        if layout.width > self.width
            && ((index + 1).is_multiple_of(columns) || index + 1 == self.panels().len())
        {
            layout.words.extend(self.ends(panel, &frame));
        }
        layout.frames.push(frame);
        end
    }

    /// The names of the series at the ends of their lines, apart from each other.
    fn ends(&self, panel: &Panel, frame: &Frame) -> Vec<Words> {
        let at = |series: usize| {
            let own = panel
                .marks
                .iter()
                .filter(|mark| mark.series == Some(series));
            let point = own.filter_map(end).next_back()?;
            Some((
                series,
                frame.y.at(point[1]) + frame.dodge.shift(Some(series), point),
            ))
        };
        let mut places: Vec<(usize, f64)> = (0..self.figure.series.len())
            .filter(|series| !self.figure.series[*series].name.is_empty())
            .filter_map(at)
            .collect();
        places.sort_by(|a, b| a.1.total_cmp(&b.1));
        let mut free = frame.bottom - places.len() as f64 * NAME.line();
        let mut next = frame.top;
        let place = |(series, y): (usize, f64)| {
            // Room for those below stays free.
            let y = y.min(free + NAME.line()).max(next);
            (free, next) = (free + NAME.line(), y + NAME.line());
            let class = format!("fig-n {}", class(self.figure.ink(Some(series)))).into();
            let text = self.figure.series[series].name.clone();
            let at = [frame.right + OFF, y + NAME.size * MIDDLE];
            Words {
                text,
                full: None,
                at,
                anchor: "start",
                is_upright: false,
                class,
            }
        };
        places.into_iter().map(place).collect()
    }
}

/// Places the title of x below `top`; returns its lower end.
fn title_below(layout: &mut Layout, title: &str, [left, right]: [f64; 2], top: f64) -> f64 {
    let lines = AXIS.wrap(title, right - left, LINES);
    let at = [(left + right) / 2.0, top + AXIS.line()];
    layout
        .words
        .extend(stack(&lines, title, at, AXIS, "middle"));
    top + lines.len() as f64 * AXIS.line() + OFF / 2.0
}
