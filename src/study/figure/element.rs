//! The elements that marks share with the rest of a figure.

use super::Mark;
use super::ink::class;
use super::text::{escape, px};
use super::words::{Anchor, Words};
use std::fmt::Write;

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
