//! Elements of an SVG.

use super::Figure;
use super::ink::dashes;
use super::text::{Anchor, Words, escape, px};

/// Path data of a polyline.
pub fn line(points: &[[f64; 2]]) -> String {
    let mut data = String::new();
    for (i, [x, y]) in points.iter().enumerate() {
        let command = if i == 0 { 'M' } else { 'L' };
        data += &format!("{command}{},{}", px(*x), px(*y));
    }
    data
}

/// Path data of a rectangle.
pub fn rectangle([x, y, width, height]: [f64; 4]) -> String {
    let [x, y, width, height] = [x, y, width, height].map(px);
    format!("M{x},{y}h{width}v{height}h-{width}z")
}

/// A path element; `more` are further attributes.
pub fn path(class: &str, more: &str, data: &str) -> String {
    format!("<path class=\"{class}\"{more} d=\"{data}\"/>")
}

/// The dash attribute of a series; empty for solid lines.
pub fn dash(figure: &Figure, series: Option<usize>) -> String {
    let dashes = series.and_then(|index| dashes(index, figure.series.get(index)?.is_dashed));
    dashes.map_or_else(String::new, |dashes| {
        format!(" stroke-dasharray=\"{dashes}\"")
    })
}

/// A text element.
pub fn words(words: &Words) -> String {
    let [x, y] = words.position.map(px);
    let anchor = match words.anchor {
        // The default of SVG.
        Anchor::Start => "",
        Anchor::Middle => " text-anchor=\"middle\"",
        Anchor::End => " text-anchor=\"end\"",
    };
    let turn = if words.is_upright {
        format!(" transform=\"rotate(-90 {x} {y})\"")
    } else {
        String::new()
    };
    let full = words.full.as_ref().map_or_else(String::new, |full| {
        format!("<title>{}</title>", escape(full))
    });
    let class = &words.class;
    let text = escape(&words.text);
    format!("<text class=\"{class}\" x=\"{x}\" y=\"{y}\"{anchor}{turn}>{full}{text}</text>\n")
}
