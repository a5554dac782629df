//! Placed words, and the room that they take.

use super::text::{ASCENT, DESCENT, Font};

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Anchor {
    Start,
    Middle,
    End,
}

/// One line of text at a place.
#[derive(Clone, Debug, PartialEq)]
pub struct Words {
    pub text: String,
    /// All of it where `text` is cut short.
    pub full: Option<String>,
    /// Of the anchor, on the baseline.
    pub at: [f64; 2],
    pub font: Font,
    pub anchor: Anchor,
    /// Reads from bottom to top.
    pub is_upright: bool,
    pub class: &'static str,
}

impl Words {
    pub fn new(text: impl Into<String>, at: [f64; 2], font: Font, class: &'static str) -> Self {
        Self { text: text.into(), full: None, at, font, anchor: Anchor::Start, is_upright: false, class }
    }

    pub fn anchor(self, anchor: Anchor) -> Self {
        Self { anchor, ..self }
    }

    pub fn upright(self) -> Self {
        Self { is_upright: true, ..self }
    }

    /// With the whole text where some of it is missing.
    pub fn of(self, full: &str) -> Self {
        let is_cut = self.text.ends_with('…') && !full.contains(&self.text);
        Self { full: is_cut.then(|| full.to_owned()), ..self }
    }

    /// Left, top, right and bottom.
    pub fn area(&self) -> [f64; 4] {
        let width = self.font.width(&self.text);
        let before = match self.anchor {
            Anchor::Start => 0.0,
            Anchor::Middle => width / 2.0,
            Anchor::End => width,
        };
        let ([x, y], up, down) = (self.at, self.font.size * ASCENT, self.font.size * DESCENT);
        match self.is_upright {
            true => [x - up, y + before - width, x + down, y + before],
            false => [x - before, y - up, x - before + width, y + down],
        }
    }
}

/// Whether two areas share more than a border.
pub fn overlap(a: [f64; 4], b: [f64; 4]) -> bool {
    a[0] < b[2] && b[0] < a[2] && a[1] < b[3] && b[1] < a[3]
}
