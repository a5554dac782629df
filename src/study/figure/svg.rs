//! The SVG of a figure.
//!
//! It needs nothing but itself: inks are custom properties with fallbacks ([`super::ink`]), so that a page that holds it may set them, and
//! there is no id, so that many figures can stand in one page. A mark with a tip is a `<g class="mark">` with its words in `aria-label`,
//! `data-tip` and `<title>`, its cell in `data-cell`, and the indices of its panel and series in `data-panel` and `data-series`.

use super::head::ramp_kind;
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
    let swatch = layout.head.swatch;
    for (series, [x, y]) in &layout.head.entries {
        let own = |is: fn(&Shape) -> bool| {
            let mut marks = figure.panels.iter().flat_map(|panel| &panel.marks);
            marks.any(|mark| mark.series == Some(*series) && is(&mark.shape))
        };
        let is_dashed = figure.series[*series].is_dashed;
        let is_curve = own(|shape| matches!(shape, Shape::Line(_)));
        let is_line = is_curve || own(|shape| matches!(shape, Shape::HorizontalRule(_) | Shape::VerticalRule(_)));
        let is_bar = own(|shape| matches!(shape, Shape::Bar { .. } | Shape::HorizontalBar { .. }));
        let has_marker = own(|shape| matches!(shape, Shape::Dot(_))) || (is_curve && !is_dashed);
        let _ = write!(out, "<g class=\"{}\" data-series=\"{series}\">", class(Some(*series)));
        if is_bar {
            let (top, height) = (px(y - 6.0), 12);
            let _ = write!(
                out,
                "<rect class=\"fig-f\" x=\"{}\" y=\"{top}\" width=\"{}\" height=\"{height}\"/>",
                px(*x),
                px(swatch)
            );
        }
        if is_line {
            let dash =
                dashes(*series, is_dashed).map_or_else(String::new, |dash| format!(" stroke-dasharray=\"{dash}\""));
            let _ = write!(out, "<path class=\"fig-l\"{dash} d=\"M{},{}h{}\"/>", px(*x), px(*y), px(swatch));
        }
        let is_signed_bar = is_bar && figure.series.len() > 1;
        if has_marker || is_signed_bar || !(is_line || is_bar) {
            let class = if is_bar { "fig-hole" } else { "fig-d" };
            let _ = write!(out, "<path class=\"{class}\" d=\"{}\"/>", marker(Some(*series), [x + swatch / 2.0, *y]));
        }
        *out += "</g>\n";
    }
}

/// The bar of tile colours with its ticks.
fn bar(out: &mut String, ramp: &Ramp, [left, top, width, height]: [f64; 4], places: &[f64]) {
    /// Whole pixels, so that no seam shows.
    const PART: f64 = 2.0;
    let axis = Axis::new(&ramp_kind(ramp), 0.0, 1.0);
    let parts = (width / PART).ceil().max(1.0) as usize;
    for i in 0..parts {
        let start = i as f64 * PART;
        let color = hex(ramp.color(axis.value((start + PART / 2.0).min(width) / width)));
        let (x, wide) = (px(left + start), px(PART.min(width - start)));
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

/// Bands of steps, grid lines and minor ones.
fn grid(out: &mut String, frame: &Frame) {
    let Frame { left, top, right, bottom, .. } = *frame;
    let (wide, high) = (right - left, bottom - top);
    if frame.bands[1] {
        let bands = bands(&frame.ticks[1], frame.y.step(), |y, step| {
            format!("M{},{}h{}v{step}h-{}z", px(left), px(y), px(wide), px(wide))
        });
        let _ = writeln!(out, "<path class=\"fig-band\" d=\"{bands}\"/>");
    }
    if frame.bands[0] {
        let bands = bands(&frame.ticks[0], frame.x.step(), |x, step| {
            format!("M{},{}h{step}v{}h-{step}z", px(x), px(top), px(high))
        });
        let _ = writeln!(out, "<path class=\"fig-band\" d=\"{bands}\"/>");
    }
    let upright =
        |all: &[f64]| -> String { all.iter().map(|x| format!("M{},{}v{}", px(*x), px(top), px(high))).collect() };
    let level =
        |all: &[f64]| -> String { all.iter().map(|y| format!("M{},{}h{}", px(left), px(*y), px(wide))).collect() };
    let minor = upright(&frame.minor[0]) + &level(&frame.minor[1]);
    if !minor.is_empty() {
        let _ = writeln!(out, "<path class=\"fig-grid fig-minor\" d=\"{minor}\"/>");
    }
    let [x, y] = [0, 1].map(|way| if frame.lines[way] { frame.ticks[way].as_slice() } else { &[] });
    let major = upright(x) + &level(y);
    if !major.is_empty() {
        let _ = writeln!(out, "<path class=\"fig-grid\" d=\"{major}\"/>");
    }
}

/// Every second step.
fn bands(middles: &[f64], step: f64, draw: impl Fn(f64, String) -> String) -> String {
    middles.iter().step_by(2).map(|middle| draw(middle - step / 2.0, px(step))).collect()
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
