//! Where everything of a figure stands at a width: small multiples in columns, axes, labels, words that overlap nothing.

use super::dodge::{Dodge, PITCH, dodges};
use super::head::{Head, PAD};
use super::labels::{FONT, Labels};
use super::scale::Axis;
use super::text::{ASCENT, Font, LINE, MIDDLE, is_whole};
use super::words::{Anchor, Words};
use super::{Figure, Panel, Scale, ScaleKind, Shape};

const NAME: Font = Font::bold(12.0);
const NAME_LINES: usize = 3;
const AXIS: Font = Font::new(12.0);
/// More columns make panels that cannot be compared with those below.
const COLUMNS: usize = 4;
/// Between columns and between rows of panels, pixels.
const COLUMN_GAP: f64 = 18.0;
const ROW_GAP: f64 = 14.0;
/// The narrowest panel of numbers, and the smallest step by what stands on it, pixels.
const NARROWEST: f64 = 120.0;
const STEP_LEAST: f64 = 14.0;
const PART_LEAST: f64 = 6.0;
/// Names of steps take at most this share of a column, and at most so many pixels.
const NAMES_SHARE: f64 = 0.44;
const NAMES_MOST: f64 = 300.0;
/// Height of a panel over its width, and its least and most.
const ASPECT: f64 = 0.68;
const HEIGHTS: [f64; 2] = [110.0, 320.0];
/// Least heights of a row of marks, of tiles, and the margin of a row.
const ROW: f64 = 20.0;
const TILE: f64 = 25.0;
const ROW_MARGIN: f64 = 7.0;
/// The smallest size of the words of tiles, pixels: smaller ones are left out.
const TILE_FONT_LEAST: f64 = 8.0;
const TILE_MARGIN: f64 = 5.0;
/// Most lines of an axis title.
const TITLE_LINES: usize = 3;
/// More rows of panels than this are not seen at once: each has its own labels.
const ROWS_AT_ONCE: usize = 3;

/// A panel in its place.
#[derive(Clone, Debug, PartialEq)]
pub struct Frame {
    pub x: Axis,
    pub y: Axis,
    pub left: f64,
    pub top: f64,
    pub right: f64,
    pub bottom: f64,
    /// Labelled places, and those between them, along x and y.
    pub ticks: [Vec<f64>; 2],
    pub minor: [Vec<f64>; 2],
    pub dodge: Dodge,
    /// Which of x and y have grid lines, and which have bands of steps.
    pub lines: [bool; 2],
    pub bands: [bool; 2],
    /// Size of the words of tiles; nothing where they have no room.
    pub tile_font: Option<f64>,
}

/// A figure laid out.
#[derive(Clone, Debug, PartialEq)]
pub struct Layout {
    pub width: f64,
    pub height: f64,
    pub head: Head,
    pub frames: Vec<Frame>,
    pub words: Vec<Words>,
}

/// What the panels have in common.
struct Grid<'f> {
    figure: &'f Figure,
    dodges: Vec<Dodge>,
    width: f64,
    /// All panels have one scale: only the outer ones are labelled.
    is_shared: [bool; 2],
    /// The title of the axis of all panels.
    titles: [Option<&'f str>; 2],
    /// Lines of the common title of y.
    lines: usize,
}

/// A figure at a width.
pub fn layout(figure: &Figure, width: f64) -> Layout {
    let head = Head::new(figure, width);
    let dodges = dodges(figure);
    let common = |of: fn(&Panel) -> &Scale| -> (bool, Option<&str>) {
        let mut all = figure.panels.iter().map(of);
        let Some(first) = all.next() else { return (false, None) };
        let is_one = all.clone().all(|scale| scale.label == first.label);
        (figure.panels.len() > 1 && all.all(|scale| scale == first), is_one.then_some(first.label.as_str()))
    };
    let [x, y] = [common(|panel| &panel.x), common(|panel| &panel.y)];
    let mut grid = Grid { figure, dodges, width, is_shared: [x.0, y.0], titles: [x.1, y.1], lines: 1 };
    loop {
        let found = grid.place(head.clone());
        let room = grid_height(&found);
        let is_cut = grid.titles[1].is_some_and(|title| !is_whole(&AXIS.wrap(title, room, grid.lines), title));
        if !is_cut || grid.lines == TITLE_LINES {
            return found;
        }
        grid.lines += 1;
    }
}

/// The room of an upright title along all panels.
fn grid_height(layout: &Layout) -> f64 {
    layout.height - layout.head.bottom - 2.0 * PAD
}

/// Coordinates of the marks of a panel, to choose ticks by.
pub fn tried(panel: &Panel) -> [Vec<f64>; 2] {
    let mut places: [Vec<f64>; 2] = Default::default();
    let mut add = |[x, y]: [f64; 2]| {
        places[0].push(x);
        places[1].push(y);
    };
    for mark in &panel.marks {
        match &mark.shape {
            Shape::Line(points) => points.iter().for_each(|point| add(*point)),
            Shape::Dot(at) => add(*at),
            Shape::Bar { x, to, .. } => add([*x, *to]),
            Shape::HorizontalBar { y, to, .. } => add([*to, *y]),
            _ => (),
        }
    }
    places
}

impl Grid<'_> {
    fn panels(&self) -> &[Panel] {
        &self.figure.panels
    }

    /// The room of the common title of y.
    fn outer(&self) -> f64 {
        match self.titles[1] {
            Some(title) if !title.is_empty() => self.lines as f64 * AXIS.size * LINE + 4.0,
            _ => 0.0,
        }
    }

    fn height_of(&self, plot_width: f64) -> f64 {
        (plot_width * ASPECT).clamp(HEIGHTS[0], HEIGHTS[1])
    }

    /// Labels beside each panel for columns of a width.
    fn beside(&self, columns: usize) -> Vec<Labels> {
        let column = (self.width - 2.0 * PAD - self.outer()) / columns as f64;
        let room = (column * NAMES_SHARE).min(NAMES_MOST);
        let length = self.height_of(column - 30.0);
        self.panels().iter().map(|panel| Labels::beside(&panel.y, length, room, &tried(panel)[1])).collect()
    }

    /// The room left of each column, and the width of its panels.
    fn columns(&self, columns: usize, beside: &[Labels]) -> (Vec<f64>, f64) {
        let own_title = |panel: &Panel| match self.titles[1] {
            None if !panel.y.label.is_empty() => AXIS.size * LINE + 2.0,
            _ => 0.0,
        };
        let depth = |i: usize| match self.is_shared[1] && i % columns > 0 {
            true => 0.0,
            false => beside[i].depth + own_title(&self.panels()[i]),
        };
        let gutters: Vec<f64> =
            (0..columns).map(|c| (c..beside.len()).step_by(columns).map(depth).fold(0.0, f64::max)).collect();
        let gaps = COLUMN_GAP * (columns as f64 - 1.0);
        let room = self.width - 2.0 * PAD - self.outer() - gaps - gutters.iter().sum::<f64>();
        (gutters, room / columns as f64)
    }

    /// The narrowest that a panel may be.
    fn narrowest(&self, index: usize) -> f64 {
        let panel = &self.panels()[index];
        let ScaleKind::Steps(names) = &panel.x.kind else { return NARROWEST };
        let own = panel.marks.iter().map(|mark| match &mark.shape {
            Shape::Tile { text, .. } => Font::new(TILE_FONT_LEAST + 1.0).width(text) + TILE_MARGIN,
            Shape::Bar { parts, .. } => *parts as f64 * PART_LEAST + 4.0,
            _ => 0.0,
        });
        let step = own.fold(STEP_LEAST, f64::max).max(self.dodges[index].count as f64 * PITCH);
        (names.len() as f64 * step).max(NARROWEST * 0.75)
    }

    /// The most columns in which every panel has room, evenly filled.
    fn column_count(&self) -> usize {
        let count = self.panels().len().max(1);
        let fits = |columns: &usize| {
            let (_, width) = self.columns(*columns, &self.beside(*columns));
            (0..self.panels().len()).all(|i| self.narrowest(i) <= width)
        };
        let most = (1..=COLUMNS.min(count)).rev().find(fits).unwrap_or(1);
        count.div_ceil(count.div_ceil(most))
    }

    fn shares_x(&self, columns: usize) -> bool {
        self.is_shared[0] && self.panels().len().div_ceil(columns) <= ROWS_AT_ONCE
    }

    fn row_height(&self, index: usize, labels: &Labels) -> f64 {
        let has_tiles = self.panels()[index].marks.iter().any(|mark| matches!(mark.shape, Shape::Tile { .. }));
        let least = if has_tiles { TILE } else { ROW };
        let lanes = if self.dodges[index].is_y { self.dodges[index].count as f64 * PITCH } else { 0.0 };
        least.max(labels.row() + ROW_MARGIN).max(lanes + ROW_MARGIN)
    }

    fn place(&self, head: Head) -> Layout {
        let columns = self.column_count();
        let beside = self.beside(columns);
        let (gutters, plot_width) = self.columns(columns, &beside);
        let mut layout = Layout { width: self.width, height: 0.0, head, frames: Vec::new(), words: Vec::new() };
        let mut top = layout.head.bottom + PAD;
        let count = self.panels().len();
        for row in (0..count).step_by(columns) {
            let own = row..(row + columns).min(count);
            let lefts: Vec<f64> = (0..columns)
                .map(|c| {
                    let before = c as f64 * (plot_width + COLUMN_GAP) + gutters[..=c].iter().sum::<f64>();
                    PAD + self.outer() + before
                })
                .collect();
            let names: Vec<Vec<String>> =
                own.clone().map(|i| NAME.wrap_list(&self.panels()[i].title, plot_width, NAME_LINES)).collect();
            let name_height = names.iter().map(Vec::len).max().unwrap_or(0) as f64 * NAME.size * LINE;
            for (name, i) in names.iter().zip(own.clone()) {
                for (k, line) in name.iter().enumerate() {
                    let rise = (name.len() - 1 - k) as f64 * NAME.size * LINE + 5.0;
                    let at = [lefts[i - row], top + name_height - rise];
                    layout.words.push(Words::new(line, at, NAME, "fig-ink fig-name").of(&self.panels()[i].title));
                }
            }
            top += if name_height > 0.0 { name_height + 3.0 } else { 0.0 };
            let mut bottom = top;
            for i in own {
                let depth = self.panel(&mut layout, i, [lefts[i - row], top, plot_width], &beside[i], columns);
                bottom = depth.max(bottom);
            }
            top = bottom + ROW_GAP;
        }
        layout.height = top - ROW_GAP + PAD;
        self.common_titles(&mut layout);
        layout
    }

    /// Places one panel; returns the end of what stands below it.
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
        // Half of what is between two panels; all of the margin at the sides of the figure.
        let side = COLUMN_GAP / 2.0 - 2.0;
        let over = [if index % columns == 0 { beside.depth.max(side) } else { side }, side];
        let height = match &panel.y.kind {
            ScaleKind::Steps(names) => names.len().max(1) as f64 * self.row_height(index, beside),
            _ => self.height_of(width),
        };
        let bottom = top + height;
        let x = Axis::new(&panel.x.kind, left, right);
        // Steps run down, numbers up.
        let [from, to] = if matches!(panel.y.kind, ScaleKind::Steps(_)) { [top, bottom] } else { [bottom, top] };
        let y = Axis::new(&panel.y.kind, from, to);
        let below = Labels::below(&panel.x, width, over, &tried(panel)[0]);
        let ((x_ticks, x_minor), (y_ticks, y_minor)) = (below.places(&x), beside.places(&y));
        let mut end = bottom;
        if !self.shares_x(columns) || index + columns >= self.panels().len() {
            layout.words.extend(below.words_below(&x, [left, right], bottom, over));
            end += below.depth;
        }
        if !self.is_shared[1] || index % columns == 0 {
            layout.words.extend(beside.words_beside(&y, left));
            if self.titles[1].is_none() {
                let title = AXIS.elide(&panel.y.label, height);
                let at = [left - beside.depth - 6.0, (top + bottom) / 2.0];
                let words = Words::new(title, at, AXIS, "fig-ink fig-note").anchor(Anchor::Middle).upright();
                layout.words.push(words.of(&panel.y.label));
            }
        }
        if self.titles[0].is_none() {
            for line in AXIS.wrap(&panel.x.label, width + side, 2) {
                end += AXIS.size * LINE;
                let at = [(left + right) / 2.0, end];
                let words = Words::new(line, at, AXIS, "fig-ink fig-note").anchor(Anchor::Middle);
                layout.words.push(words.of(&panel.x.label));
            }
            end += 3.0;
        }
        let tile_font = tile_font(panel, &x);
        let dodge = self.dodges[index].clone();
        let bands = [x.has_steps() && !dodge.is_y, dodge.is_y].map(|is_along| is_along && dodge.count > 1);
        // A line behind the middle of a bar or a tile leads to nothing.
        let is_filled = panel
            .marks
            .iter()
            .any(|mark| matches!(mark.shape, Shape::Bar { .. } | Shape::HorizontalBar { .. } | Shape::Tile { .. }));
        let lines = [&x, &y].map(|axis| !(axis.has_steps() && is_filled));
        let lines = [lines[0] && !bands[0], lines[1] && !bands[1]];
        let (ticks, minor) = ([x_ticks, y_ticks], [x_minor, y_minor]);
        layout.frames.push(Frame { x, y, left, top, right, bottom, ticks, minor, dodge, lines, bands, tile_font });
        end
    }

    /// The title of y, once, or beside each row where there are many.
    fn upright_title(&self, layout: &mut Layout, title: &str, [top, bottom]: [f64; 2]) {
        let (first, last) = (layout.head.bottom + PAD, layout.height - PAD);
        let mut rows: Vec<[f64; 2]> = layout.frames.iter().map(|frame| [frame.top, frame.bottom]).collect();
        rows.dedup_by_key(|row| row[0]);
        let is_whole = |row: &[f64; 2]| AXIS.width(title) <= row[1] - row[0];
        if rows.len() <= ROWS_AT_ONCE || !rows.iter().all(is_whole) {
            rows = vec![[top, bottom]];
        }
        let lines = AXIS.wrap(title, last - first, self.lines);
        let half = lines.iter().map(|line| AXIS.width(line)).fold(0.0, f64::max) / 2.0;
        for [top, bottom] in rows {
            let middle = ((top + bottom) / 2.0).min(last - half).max(first + half);
            for (i, line) in lines.iter().enumerate() {
                let at = [PAD + AXIS.size * (ASCENT + i as f64 * LINE), middle];
                let words = Words::new(line, at, AXIS, "fig-ink fig-note").anchor(Anchor::Middle).upright();
                layout.words.push(words.of(title));
            }
        }
    }

    /// The titles that all panels share.
    fn common_titles(&self, layout: &mut Layout) {
        let (Some(first), Some(last)) = (layout.frames.first(), layout.frames.last()) else { return };
        let top = first.top;
        let bottom = layout.frames.iter().map(|frame| frame.bottom).fold(last.bottom, f64::max);
        let (left, right) = (first.left, layout.width - PAD);
        if let Some(title) = self.titles[1].filter(|title| !title.is_empty()) {
            self.upright_title(layout, title, [top, bottom]);
        }
        if let Some(title) = self.titles[0].filter(|title| !title.is_empty()) {
            let mut y = layout.height - PAD;
            let middle = (left + right) / 2.0;
            let reach = 2.0 * (middle - PAD).min(layout.width - PAD - middle);
            for line in AXIS.wrap(title, reach, TITLE_LINES) {
                y += AXIS.size * LINE;
                let at = [middle, y + AXIS.size * (MIDDLE - 0.25)];
                let words = Words::new(line, at, AXIS, "fig-ink fig-note").anchor(Anchor::Middle);
                layout.words.push(words.of(title));
            }
            layout.height = y + PAD;
        }
    }
}

/// The largest size at which the words of all tiles fit into them.
fn tile_font(panel: &Panel, x: &Axis) -> Option<f64> {
    let widest = panel.marks.iter().filter_map(|mark| match &mark.shape {
        Shape::Tile { text, .. } => Some(Font::new(1.0).width(text)),
        _ => None,
    });
    let widest = widest.reduce(f64::max)?;
    let size = ((x.step() - TILE_MARGIN) / widest.max(f64::EPSILON)).min(FONT.size);
    (size >= TILE_FONT_LEAST).then_some((size * 2.0).floor() / 2.0)
}
