//! The SVG of a figure.
//!
//! It needs nothing but itself: inks are custom properties with fallbacks ([`super::ink`]), so that a page that holds it may set them, and
//! there is no id, so that many figures can stand in one page. A mark with a tip is a `<g class="mark">` with its words in `aria-label`,
//! `data-tip` and `<title>`, its cell in `data-cell`, and the indices of its panel and series in `data-panel` and `data-series`.

use super::head::{SWATCH, ramp_kind};
use super::ink::{class, dashes, hex, style};
use super::layout::{Frame, Layout, layout};
use super::marks::{draw, marker};
use super::scale::Axis;
use super::text::{escape, px};
use super::words::{Anchor, Words};
use super::{Figure, Mark, Ramp, Shape};
use std::fmt::Write;

/// Widths at which figures are laid out, pixels: a desk and a phone.
pub const WIDTHS: [u32; 2] = [760, 360];
/// A figure has at least this width.
const NARROWEST: u32 = 240;

/// An SVG document of that width.
pub fn svg(figure: &Figure, width: u32) -> String {
    let layout = layout(figure, f64::from(width.max(NARROWEST)));
    let (width, height) = (px(layout.width), px(layout.height.ceil()));
    let (title, note) = (escape(&figure.title), escape(&figure.note));
    let mut out = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" class=\"fig\" width=\"{width}\" height=\"{height}\" viewBox=\"0 0 {width} {height}\" \
         role=\"group\" aria-label=\"{title}\">\n<title>{title}</title>\n<desc>{note}</desc>\n<style>{}</style>\n\
         <rect class=\"fig-ground\" width=\"{width}\" height=\"{height}\"/>\n",
        style()
    );
    for words in &layout.head.words {
        write_words(&mut out, words);
    }
    legend(&mut out, figure, &layout);
    if let (Some(ramp), Some((area, places))) = (&figure.ramp, &layout.head.bar) {
        bar(&mut out, ramp, *area, places);
    }
    for frame in &layout.frames {
        grid(&mut out, frame);
    }
    for words in &layout.words {
        write_words(&mut out, words);
    }
    for (index, frame) in layout.frames.iter().enumerate() {
        draw(&mut out, figure, index, frame);
    }
    out + "</svg>\n"
}

/// One line of text.
pub fn write_words(out: &mut String, words: &Words) {
    let anchor = match words.anchor {
        Anchor::Start => "",
        Anchor::Middle => " text-anchor=\"middle\"",
        Anchor::End => " text-anchor=\"end\"",
    };
    let [x, y] = words.at.map(px);
    let turn = if words.is_upright { format!(" transform=\"rotate(-90 {x} {y})\"") } else { String::new() };
    let full = words.full.as_ref().map_or_else(String::new, |full| format!("<title>{}</title>", escape(full)));
    let (class, text) = (words.class, escape(&words.text));
    let _ = writeln!(out, "<text class=\"{class}\" x=\"{x}\" y=\"{y}\"{anchor}{turn}>{full}{text}</text>");
}

/// What the marks of a series look like.
fn legend(out: &mut String, figure: &Figure, layout: &Layout) {
    for (series, [x, y]) in &layout.head.entries {
        let own = |is: fn(&Shape) -> bool| {
            let mut marks = figure.panels.iter().flat_map(|panel| &panel.marks);
            marks.any(|mark| mark.series == Some(*series) && is(&mark.shape))
        };
        let is_dashed = figure.series[*series].is_dashed;
        let is_line = own(|shape| matches!(shape, Shape::Line(_) | Shape::HorizontalRule(_) | Shape::VerticalRule(_)));
        let is_bar = own(|shape| matches!(shape, Shape::Bar { .. } | Shape::HorizontalBar { .. }));
        let has_marker = own(|shape| matches!(shape, Shape::Dot(_))) || (is_line && !is_dashed);
        let _ = write!(out, "<g class=\"{}\" data-series=\"{series}\">", class(Some(*series)));
        if is_bar {
            let (top, height) = (px(y - 5.0), 10);
            let _ = write!(
                out,
                "<rect class=\"fig-f\" x=\"{}\" y=\"{top}\" width=\"{}\" height=\"{height}\"/>",
                px(*x),
                px(SWATCH - 4.0)
            );
        }
        if is_line {
            let dash =
                dashes(*series, is_dashed).map_or_else(String::new, |dash| format!(" stroke-dasharray=\"{dash}\""));
            let _ = write!(out, "<path class=\"fig-l\"{dash} d=\"M{},{}h{}\"/>", px(*x), px(*y), px(SWATCH));
        }
        if has_marker || !(is_line || is_bar) {
            let _ = write!(out, "<path class=\"fig-d\" d=\"{}\"/>", marker(Some(*series), [x + SWATCH / 2.0, *y]));
        }
        *out += "</g>\n";
    }
}

/// The bar of tile colours with its ticks.
fn bar(out: &mut String, ramp: &Ramp, [left, top, width, height]: [f64; 4], places: &[f64]) {
    /// Enough for the eye to see no steps.
    const PARTS: usize = 55;
    let axis = Axis::new(&ramp_kind(ramp), 0.0, 1.0);
    let part = width / PARTS as f64;
    for i in 0..PARTS {
        let color = hex(ramp.color(axis.value((i as f64 + 0.5) / PARTS as f64)));
        // Each reaches below the next, so that no seam shows.
        let wide = if i + 1 < PARTS { part + 0.5 } else { part };
        let (x, wide) = (px(left + i as f64 * part), px(wide));
        let _ = write!(
            out,
            "<rect fill=\"{color}\" x=\"{x}\" y=\"{}\" width=\"{wide}\" height=\"{}\"/>",
            px(top),
            px(height)
        );
    }
    let ticks: String = places.iter().map(|x| format!("M{},{}v3", px(*x), px(top + height))).collect();
    let _ = writeln!(out, "\n<path class=\"fig-axis\" d=\"{ticks}\"/>");
}

/// Grid lines, the border, and minor ticks.
fn grid(out: &mut String, frame: &Frame) {
    let Frame { left, top, right, bottom, .. } = *frame;
    let (wide, high) = (px(right - left), px(bottom - top));
    let upright = |all: &[f64]| -> String { all.iter().map(|x| format!("M{},{}v{high}", px(*x), px(top))).collect() };
    let level = |all: &[f64]| -> String { all.iter().map(|y| format!("M{},{}h{wide}", px(left), px(*y))).collect() };
    let minor = upright(&frame.minor[0]) + &level(&frame.minor[1]);
    if !minor.is_empty() {
        let _ = writeln!(out, "<path class=\"fig-grid fig-minor\" d=\"{minor}\"/>");
    }
    let major = upright(&frame.ticks[0]) + &level(&frame.ticks[1]);
    let _ = writeln!(out, "<path class=\"fig-grid\" d=\"{major}\"/>");
    let (left, top, bottom) = (px(left), px(top), px(bottom));
    let _ = writeln!(out, "<path class=\"fig-axis\" d=\"M{left},{top}V{bottom}h{wide}\"/>");
}

/// The start of a group that people can point at; nothing for a mark without a tip.
pub fn open_mark(out: &mut String, mark: &Mark, panel: usize) {
    let _ = write!(out, "<g class=\"{}{}\"", if mark.tip.is_empty() { "" } else { "mark " }, class(mark.series));
    if !mark.tip.is_empty() {
        let tip = escape(&mark.tip);
        let _ = write!(out, " tabindex=\"-1\" role=\"img\" aria-label=\"{tip}\" data-tip=\"{tip}\"");
        if let Some(cell) = &mark.cell {
            let _ = write!(out, " data-cell=\"{}\"", escape(cell));
        }
        let _ = write!(out, " data-panel=\"{panel}\"");
        if let Some(series) = mark.series {
            let _ = write!(out, " data-series=\"{series}\"");
        }
        let _ = write!(out, "><title>{tip}</title>");
    } else {
        *out += ">";
    }
}
