//! Writes the SVG of a figure. It has no ids, so that a page can hold many.
//!
//! Colours are custom properties with fallbacks for light and dark. A page may set `--fig-ground`,
//! `--fig-ink`, `--fig-muted`, `--fig-grid`, `--fig-axis`, `--fig-s0` to `--fig-s7`, and
//! `--fig-font`.
//!
//! A mark with a tip is a `<g class="mark">` with the words in `aria-label`, `data-tip` and
//! `<title>`, its cell in `data-cell`, and the indices of panel and series in `data-panel` and
//! `data-series`.

use super::element::{dash, line, path, rectangle, words};
use super::frame::{Frame, Layout, LegendEntry};
use super::ink::{class, style};
use super::layout::layout;
use super::marks::{draw, marker};
use super::text::{escape, px};
use super::{Figure, Shape};

/// Widths of figures for a file, a desktop and a phone, pixels.
pub const FILE_WIDTH: u32 = 760;
pub const WIDTHS: [u32; 2] = [1180, 360];
const NARROWEST: u32 = 240;

/// The SVG of a figure at a width, pixels.
pub fn svg(figure: &Figure, width: u32) -> String {
    let layout = layout(figure, f64::from(width.max(NARROWEST)));
    let mut body = legend(figure, &layout);
    body.extend(layout.frames.iter().map(grid));
    body.extend(layout.words.iter().map(words));
    for (index, frame) in layout.frames.iter().enumerate() {
        body += &draw(figure, index, frame);
    }
    let width = px(layout.width);
    let height = px(layout.height.ceil());
    let title = escape(&figure.title);
    let note = escape(&figure.whole_note());
    let style = style();
    format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" class=\"fig\" width=\"{width}\" \
         height=\"{height}\" viewBox=\"0 0 {width} {height}\" \
         role=\"group\" \
         aria-label=\"{title}\">\n<title>{title}</title>\n<desc>{note}</desc>\n\
         <style>{style}</style>\n\
         <rect class=\"fig-ground\" width=\"{width}\" height=\"{height}\"/>\n{body}</svg>\n"
    )
}

/// The samples of marks in the legend; the names of series are words.
fn legend(figure: &Figure, layout: &Layout) -> String {
    let mut body = String::new();
    for entry in &layout.entries {
        let class = class(figure.ink(Some(entry.series)));
        let sample = legend_sample(figure, entry, layout.swatch);
        let index = entry.series;
        body += &format!("<g class=\"{class}\" data-series=\"{index}\">{sample}</g>\n");
    }
    body
}

/// A bar, a line and a dot, as far as a series has such marks.
fn legend_sample(figure: &Figure, entry: &LegendEntry, width: f64) -> String {
    let [x, y] = entry.position;
    let series = Some(entry.series);
    let has = |is_wanted: fn(&Shape) -> bool| {
        figure
            .marks()
            .any(|mark| mark.series == series && is_wanted(&mark.shape))
    };
    let has_bar = has(|shape| matches!(shape, Shape::HorizontalBar { .. }));
    let has_line = has(|shape| {
        matches!(
            shape,
            Shape::Line(_) | Shape::HorizontalRule(_) | Shape::VerticalRule(_)
        )
    });
    let has_dot = has(|shape| matches!(shape, Shape::Dot(_)));
    let mut sample = String::new();
    if has_bar {
        sample += &path("fig-f", "", &rectangle([x, y - 6.0, width, 12.0]));
    }
    if has_line {
        let dash = dash(figure, series);
        sample += &path("fig-l", &dash, &line(&[[x, y], [x + width, y]]));
    }
    if has_dot || !(has_bar || has_line) {
        let outline = marker(figure.ink(series), [x + width / 2.0, y]);
        sample += &path("fig-d", "", &outline);
    }
    sample
}

fn grid(frame: &Frame) -> String {
    let mut data = String::new();
    for &x in &frame.grid_x {
        data += &line(&[[x, frame.top], [x, frame.bottom]]);
    }
    for &y in &frame.grid_y {
        data += &line(&[[frame.left, y], [frame.right, y]]);
    }
    path("fig-grid", "", &data) + "\n"
}
