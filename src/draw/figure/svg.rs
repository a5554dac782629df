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
use super::ink::{class, style};
use super::layout::{Frame, Layout, layout};
use super::marks::{draw, marker};
use super::text::{escape, px};
use super::{Figure, Shape};

/// Widths of figures for a file, a desktop and a phone, pixels.
pub const FILE_WIDTH: u32 = 760;
pub const WIDTHS: [u32; 2] = [1180, 360];
const NARROWEST: u32 = 240;

pub fn svg(figure: &Figure, width: u32) -> String {
    let layout = layout(figure, f64::from(width.max(NARROWEST)));
    let (width, height) = (px(layout.width), px(layout.height.ceil()));
    let (title, note, style) = (escape(&figure.title), escape(&figure.note), style());
    let body = std::iter::once(legend(figure, &layout))
        .chain(layout.frames.iter().map(grid))
        .chain(layout.words.iter().map(words))
        .chain(
            layout
                .frames
                .iter()
                .enumerate()
                .map(|(index, frame)| draw(figure, index, frame)),
        );
    let body: String = body.collect();
    format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" class=\"fig\" width=\"{width}\" \
         height=\"{height}\" viewBox=\"0 0 {width} {height}\" \
         role=\"group\" \
         aria-label=\"{title}\">\n<title>{title}</title>\n<desc>{note}</desc>\n<style>{style}</style>\n\
         <rect class=\"fig-ground\" width=\"{width}\" height=\"{height}\"/>\n{body}</svg>\n"
    )
}

fn legend(figure: &Figure, layout: &Layout) -> String {
    let swatch = layout.swatch;
    let entry = |(index, [x, y]): &(usize, [f64; 2])| {
        let series = Some(*index);
        let ink = figure.ink(series);
        let own = |is: fn(&Shape) -> bool| {
            figure
                .marks()
                .any(|mark| mark.series == series && is(&mark.shape))
        };
        let bar = own(|shape| matches!(shape, Shape::HorizontalBar { .. }))
            .then(|| path("fig-f", "", &rectangle([*x, y - 6.0, swatch, 12.0])));
        let is_line = |shape: &Shape| {
            matches!(
                shape,
                Shape::Line(_) | Shape::HorizontalRule(_) | Shape::VerticalRule(_)
            )
        };
        let curve = own(is_line).then(|| {
            path(
                "fig-l",
                &dash(figure, series),
                &line(&[[*x, *y], [x + swatch, *y]]),
            )
        });
        let has_dots =
            own(|shape| matches!(shape, Shape::Dot(_))) || (bar.is_none() && curve.is_none());
        let dot = has_dots.then(|| path("fig-d", "", &marker(ink, [x + swatch / 2.0, *y])));
        let drawn: String = [bar, curve, dot].into_iter().flatten().collect();
        format!(
            "<g class=\"{}\" data-series=\"{index}\">{drawn}</g>\n",
            class(ink)
        )
    };
    layout.entries.iter().map(entry).collect()
}

fn grid(frame: &Frame) -> String {
    let Frame {
        left,
        top,
        right,
        bottom,
        lines: [xs, ys],
        ..
    } = frame;
    let upright = xs.iter().map(|x| line(&[[*x, *top], [*x, *bottom]]));
    let level = ys.iter().map(|y| line(&[[*left, *y], [*right, *y]]));
    path("fig-grid", "", &upright.chain(level).collect::<String>()) + "\n"
}
