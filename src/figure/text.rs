//! Words in a figure: how wide they are, how they break, how they are escaped.
//!
//! The reader's browser picks the font, so widths are estimates that err on the wide side.

/// Advance widths of the printable ASCII characters of Helvetica, thousandths of the text size (Adobe font metrics).
const ADVANCES: [u16; 95] = [
    278, 278, 355, 556, 556, 889, 667, 191, 333, 333, 389, 584, 278, 333, 278, 278, 556, 556, 556, 556, 556, 556, 556,
    556, 556, 556, 278, 278, 584, 584, 584, 556, 1015, 667, 667, 722, 722, 667, 611, 778, 722, 278, 500, 667, 556, 833,
    722, 778, 667, 778, 722, 667, 611, 722, 667, 944, 667, 667, 611, 278, 278, 278, 469, 556, 333, 556, 556, 500, 556,
    556, 278, 556, 556, 222, 222, 500, 222, 833, 556, 556, 556, 556, 333, 500, 278, 556, 500, 722, 500, 500, 500, 334,
    260, 334, 584,
];
/// The widest of the fonts in `figure.css` needs 6 % more than Helvetica.
const SLACK: f64 = 1.08;
/// Bold letters are wider.
const BOLD: f64 = 1.1;
/// From this character on (CJK) letters fill a square.
const SQUARE_FROM: char = '\u{2e80}';

/// Height of a line, text sizes.
pub const LINE: f64 = 1.2;
/// Top of the letters above the baseline, and the depth of those that hang below it, text sizes.
pub const ASCENT: f64 = 0.78;
pub const DESCENT: f64 = 0.22;
/// Half the height of digits above the baseline, text sizes: centres a text on a y.
pub const MIDDLE: f64 = 0.35;

/// A text size and weight with the class of its colour and size.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Font {
    pub size: f64,
    pub is_bold: bool,
    pub class: &'static str,
}

pub const TITLE: Font = Font { size: 15.0, is_bold: true, class: "fig-ink fig-title" };
/// Of a panel.
pub const NAME: Font = Font { size: 12.0, is_bold: true, class: "fig-ink fig-name" };
/// Titles of axes and names of series.
pub const AXIS: Font = Font { size: 12.0, is_bold: false, class: "fig-ink fig-note" };
pub const NOTE: Font = Font { class: "fig-muted fig-note", ..AXIS };
/// Words of tiles; their own class says their colour.
pub const TILE: Font = Font { size: 10.0, ..LABEL };
/// Labels of axes.
pub const LABEL: Font = Font { size: 11.0, is_bold: false, class: "fig-muted" };

impl Font {
    /// From one baseline to the next.
    pub fn line(self) -> f64 {
        self.size * LINE
    }

    /// At least the width of one line in pixels.
    pub fn width(self, text: &str) -> f64 {
        let weight = if self.is_bold { BOLD } else { 1.0 };
        text.chars().map(advance).sum::<f64>() * self.size * SLACK * weight
    }

    /// The width of the widest line.
    pub fn widest<'t>(self, lines: impl IntoIterator<Item = &'t String>) -> f64 {
        lines.into_iter().map(|line| self.width(line)).fold(0.0, f64::max)
    }

    /// The text in at most `most` lines no wider than `room`, broken after commas where that is possible; the last ends in an ellipsis where
    /// words are left out.
    pub fn wrap(self, text: &str, room: f64, most: usize) -> Vec<String> {
        let items = text.split_inclusive(", ").map(str::trim);
        let pieces = items.flat_map(|item| match self.width(item) <= room {
            true => vec![item],
            false => item.split_whitespace().collect(),
        });
        let mut lines: Vec<String> = Vec::new();
        for piece in pieces.filter(|piece| !piece.is_empty()) {
            let count = lines.len();
            match lines.last_mut() {
                Some(line) if count >= most.max(1) || self.width(&format!("{line} {piece}")) <= room => {
                    *line = format!("{line} {piece}");
                }
                _ => lines.push(piece.to_owned()),
            }
        }
        lines.iter().map(|line| self.elide(line, room)).collect()
    }

    /// The text, or as much of its start as fits with an ellipsis.
    pub fn elide(self, text: &str, room: f64) -> String {
        if self.width(text) <= room {
            return text.to_owned();
        }
        let starts = text.char_indices().rev().map(|(end, _)| format!("{}…", text[..end].trim_end()));
        starts.into_iter().find(|start| self.width(start) <= room).unwrap_or_else(|| "…".to_owned())
    }
}

/// One line of text at a place.
#[derive(Clone, Debug, PartialEq)]
pub struct Words {
    pub text: String,
    /// All of it where `text` is cut short.
    pub full: Option<String>,
    /// Of the anchor, on the baseline.
    pub at: [f64; 2],
    /// As SVG names it.
    pub anchor: &'static str,
    /// Reads from bottom to top.
    pub is_upright: bool,
    pub class: &'static str,
}

/// The lines of a text below each other; the baseline of the first is given.
pub fn stack<'t>(
    lines: &'t [String],
    full: &'t str,
    [x, y]: [f64; 2],
    font: Font,
    anchor: &'static str,
) -> impl Iterator<Item = Words> + 't {
    lines.iter().enumerate().map(move |(i, line)| Words {
        text: line.clone(),
        full: (line.ends_with('…') && !full.contains(line.as_str())).then(|| full.to_owned()),
        at: [x, y + i as f64 * font.line()],
        anchor,
        is_upright: false,
        class: font.class,
    })
}

/// Whether lines have every letter of a text.
pub fn is_whole(lines: &[String], text: &str) -> bool {
    lines.join(" ").split_whitespace().eq(text.split_whitespace())
}

fn advance(letter: char) -> f64 {
    match letter {
        ' '..='~' => f64::from(ADVANCES[letter as usize - ' ' as usize]) / 1000.0,
        '²' | '³' | '¹' | '⁰' | '⁴'..='⁹' | '⁻' => 0.4,
        '·' => 0.3,
        'α'..='ω' => 0.6,
        '…' => 1.0,
        _ if letter >= SQUARE_FROM => 1.0,
        // The widest Latin capitals; what is not a letter is seldom wider.
        _ => 0.8,
    }
}

/// The text for an element or a quoted attribute. Controls, which XML forbids or reads as blanks, are blanks.
pub fn escape(text: &str) -> String {
    let text = text.replace(|c: char| c.is_control() || ['\u{fffe}', '\u{ffff}'].contains(&c), " ");
    let text = text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;");
    text.replace('"', "&quot;").replace('\'', "&#39;")
}

/// A coordinate with at most two decimals, without the sign of a zero.
pub fn px(value: f64) -> String {
    ((value * 100.0).round() / 100.0 + 0.0).to_string()
}
