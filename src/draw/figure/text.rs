//! Widths, line breaks and escapes of words in a figure. The browser picks the font, so widths are
//! upper estimates.

use std::borrow::Cow;

/// Advance widths of printable ASCII in Helvetica, thousandths of the text size (Adobe font
/// metrics).
const ADVANCES: [u16; 95] = [
    278, 278, 355, 556, 556, 889, 667, 191, 333, 333, 389, 584, 278, 333, 278, 278, 556, 556, 556,
    556, 556, 556, 556, 556, 556, 556, 278, 278, 584, 584, 584, 556, 1015, 667, 667, 722, 722, 667,
    611, 778, 722, 278, 500, 667, 556, 833, 722, 778, 667, 778, 722, 667, 611, 722, 667, 944, 667,
    667, 611, 278, 278, 278, 469, 556, 333, 556, 556, 500, 556, 556, 278, 556, 556, 222, 222, 500,
    222, 833, 556, 556, 556, 556, 333, 500, 278, 556, 500, 722, 500, 500, 500, 334, 260, 334, 584,
];
/// The widest of the fonts in `figure.css` needs 6 % more than Helvetica.
const SLACK: f64 = 1.08;
/// A medium weight over a regular one.
const BOLD: f64 = 1.03;
/// Later letters (CJK) fill a square.
const SQUARE_FROM: char = '\u{2e80}';

/// Height of a line, text sizes.
pub const LINE: f64 = 1.2;
/// Top and bottom of letters from the baseline, text sizes.
pub const ASCENT: f64 = 0.78;
pub const DESCENT: f64 = 0.22;
/// Half the height of digits, text sizes: centres a text on a y.
pub const MIDDLE: f64 = 0.35;

/// Size, weight and CSS class of a text.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Font {
    pub size: f64,
    pub is_bold: bool,
    pub class: &'static str,
}

pub const TITLE: Font = Font {
    size: 15.0,
    is_bold: true,
    class: "fig-ink fig-title",
};
pub const NAME: Font = Font {
    size: 12.0,
    is_bold: true,
    class: "fig-ink fig-name",
};
pub const AXIS: Font = Font {
    size: 12.0,
    is_bold: false,
    class: "fig-ink fig-note",
};
pub const NOTE: Font = Font {
    class: "fig-muted fig-note",
    ..AXIS
};
pub const LABEL: Font = Font {
    size: 11.0,
    is_bold: false,
    class: "fig-muted",
};

impl Font {
    /// Height of a line, pixels.
    pub fn line(self) -> f64 {
        self.size * LINE
    }

    /// Upper estimate of the width of a line, pixels.
    pub fn width(self, text: &str) -> f64 {
        let weight = if self.is_bold { BOLD } else { 1.0 };
        text.chars().map(advance).sum::<f64>() * self.size * SLACK * weight
    }

    /// Width of the widest line, pixels.
    pub fn widest<'t>(self, lines: impl IntoIterator<Item = &'t String>) -> f64 {
        lines
            .into_iter()
            .map(|line| self.width(line))
            .fold(0.0, f64::max)
    }

    /// Breaks a text into at most `most` lines no wider than `room`, preferably after commas; the
    /// last may end in an ellipsis.
    pub fn wrap(self, text: &str, room: f64, most: usize) -> Vec<String> {
        let mut pieces: Vec<&str> = Vec::new();
        for item in text.split_inclusive(", ").map(str::trim) {
            if self.width(item) <= room {
                pieces.push(item);
            } else {
                pieces.extend(item.split_whitespace());
            }
        }
        let mut lines: Vec<String> = Vec::new();
        for piece in pieces.into_iter().filter(|piece| !piece.is_empty()) {
            let is_last_line = lines.len() >= most.max(1);
            match lines.last_mut() {
                Some(line) if is_last_line || self.width(&format!("{line} {piece}")) <= room => {
                    *line = format!("{line} {piece}");
                }
                _ => lines.push(piece.to_owned()),
            }
        }
        lines.iter().map(|line| self.elide(line, room)).collect()
    }

    /// Cuts a text to `room` pixels; the last letter is then an ellipsis.
    pub fn elide(self, text: &str, room: f64) -> String {
        if self.width(text) <= room {
            return text.to_owned();
        }
        text.char_indices()
            .rev()
            .map(|(end, _)| format!("{}…", text[..end].trim_end()))
            .find(|start| self.width(start) <= room)
            .unwrap_or_else(|| "…".to_owned())
    }
}

/// Where a text begins, ends or has its middle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Anchor {
    Start,
    Middle,
    End,
}

/// A line of text with its position.
#[derive(Clone, Debug, PartialEq)]
pub struct Words {
    pub text: String,
    /// The whole text, if `text` is truncated.
    pub full: Option<String>,
    /// The anchor on the baseline, pixels.
    pub position: [f64; 2],
    pub anchor: Anchor,
    /// From bottom to top.
    pub is_upright: bool,
    pub class: Cow<'static, str>,
}

/// Lines below each other, from the baseline of the first.
pub fn stack<'t>(
    lines: &'t [String],
    full: &'t str,
    [x, y]: [f64; 2],
    font: Font,
    anchor: Anchor,
) -> impl Iterator<Item = Words> + 't {
    lines.iter().enumerate().map(move |(i, line)| Words {
        text: line.clone(),
        full: (line.ends_with('…') && !full.contains(line.as_str())).then(|| full.to_owned()),
        position: [x, y + i as f64 * font.line()],
        anchor,
        is_upright: false,
        class: font.class.into(),
    })
}

/// Whether lines hold all of a text.
pub fn is_whole(lines: &[String], text: &str) -> bool {
    lines
        .join(" ")
        .split_whitespace()
        .eq(text.split_whitespace())
}

fn advance(letter: char) -> f64 {
    match letter {
        ' '..='~' => f64::from(ADVANCES[letter as usize - ' ' as usize]) / 1000.0,
        '²' | '³' | '¹' | '⁰' | '⁴'..='⁹' | '⁻' => 0.4,
        '·' => 0.3,
        'α'..='ω' => 0.6,
        '…' => 1.0,
        _ if letter >= SQUARE_FROM => 1.0,
        // The widest Latin capitals.
        _ => 0.8,
    }
}

/// Escapes a text for elements and attributes; controls become blanks.
pub fn escape(text: &str) -> String {
    let text = text.replace(
        |c: char| c.is_control() || ['\u{fffe}', '\u{ffff}'].contains(&c),
        " ",
    );
    let text = text
        .replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('>', "&gt;");
    text.replace('"', "&quot;").replace('\'', "&#39;")
}

/// A coordinate with at most two decimals; the sum removes the sign of a zero.
pub fn px(value: f64) -> String {
    ((value * 100.0).round() / 100.0 + 0.0).to_string()
}
