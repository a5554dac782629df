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
/// The widest of the fonts in [`FONTS`] needs 6 % more than Helvetica.
const SLACK: f64 = 1.08;
/// Bold letters are wider.
const BOLD: f64 = 1.1;
/// From this character on (CJK) letters fill a square.
const SQUARE_FROM: char = '\u{2e80}';

/// The fonts that the widths hold for, in the order in which a browser tries them.
pub const FONTS: &str = "'Helvetica Neue','Segoe UI',Arial,'Liberation Sans','DejaVu Sans Condensed',sans-serif";

/// Height of a line, text sizes.
pub const LINE: f64 = 1.2;
/// Top of the letters above the baseline, and the depth of those that hang below it, text sizes.
pub const ASCENT: f64 = 0.78;
pub const DESCENT: f64 = 0.22;
/// Half the height of digits above the baseline, text sizes: centres a text on a y.
pub const MIDDLE: f64 = 0.35;

/// A text size and weight.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Font {
    pub size: f64,
    pub is_bold: bool,
}

impl Font {
    pub const fn new(size: f64) -> Self {
        Self { size, is_bold: false }
    }

    pub const fn bold(size: f64) -> Self {
        Self { size, is_bold: true }
    }

    /// At least the width of one line in pixels.
    pub fn width(self, text: &str) -> f64 {
        let weight = if self.is_bold { BOLD } else { 1.0 };
        text.chars().map(advance).sum::<f64>() * self.size * SLACK * weight
    }

    /// The text in at most `most` lines no wider than `room`; the last ends in an ellipsis where words are left out.
    pub fn wrap(self, text: &str, room: f64, most: usize) -> Vec<String> {
        self.lines(text.split_whitespace().collect(), room, most)
    }

    /// The same for a list such as "meadow, alpha 0.16", which breaks after commas where it can.
    pub fn wrap_list(self, text: &str, room: f64, most: usize) -> Vec<String> {
        let items = text.split_inclusive(", ").map(str::trim);
        let pieces = items.flat_map(|item| match self.width(item) <= room {
            true => vec![item],
            false => item.split_whitespace().collect(),
        });
        self.lines(pieces.filter(|piece| !piece.is_empty()).collect(), room, most)
    }

    fn lines(self, pieces: Vec<&str>, room: f64, most: usize) -> Vec<String> {
        let mut lines: Vec<String> = Vec::new();
        let mut rest = pieces.into_iter().peekable();
        while rest.peek().is_some() {
            let mut line = String::new();
            let is_last = lines.len() + 1 >= most.max(1);
            while let Some(word) = rest.next_if(|word| is_last || line.is_empty() || self.fits(&line, word, room)) {
                if !line.is_empty() {
                    line.push(' ');
                }
                line += word;
            }
            lines.push(self.elide(&line, room));
        }
        lines
    }

    fn fits(self, line: &str, word: &str, room: f64) -> bool {
        self.width(line) + self.width(" ") + self.width(word) <= room
    }

    /// The text, or as much of its start as fits with an ellipsis.
    pub fn elide(self, text: &str, room: f64) -> String {
        if self.width(text) <= room {
            return text.to_owned();
        }
        let mut kept: Vec<char> = text.chars().collect();
        let mark = self.width("…");
        let mut width = self.width(text) + mark;
        while width > room
            && let Some(last) = kept.pop()
        {
            width -= self.width(last.encode_utf8(&mut [0; 4]));
        }
        let start: String = kept.into_iter().collect();
        format!("{}…", start.trim_end())
    }
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

/// The text for an element or a quoted attribute. Characters that XML forbids are replaced.
pub fn escape(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    for letter in text.chars() {
        match letter {
            '&' => escaped += "&amp;",
            '<' => escaped += "&lt;",
            '>' => escaped += "&gt;",
            '"' => escaped += "&quot;",
            '\'' => escaped += "&#39;",
            // In an attribute a parser would read them as blanks.
            '\t' | '\n' | '\r' => escaped.push(' '),
            '\0'..='\u{1f}' | '\u{fffe}' | '\u{ffff}' => escaped.push('\u{fffd}'),
            other => escaped.push(other),
        }
    }
    escaped
}

/// A coordinate with at most two decimals.
pub fn px(value: f64) -> String {
    let hundredths = (value * 100.0).round() as i64;
    let sign = if hundredths < 0 { "-" } else { "" };
    let (whole, part) = (hundredths.abs() / 100, hundredths.abs() % 100);
    match part {
        0 => format!("{sign}{whole}"),
        tenths if tenths % 10 == 0 => format!("{sign}{whole}.{}", tenths / 10),
        part => format!("{sign}{whole}.{part:02}"),
    }
}
