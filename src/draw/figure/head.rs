//! The head of a figure: title, note, legend.

use super::layout::{Layout, PAD, ends_room};
use super::text::{AXIS, Font, MIDDLE, NOTE, TITLE, stack};
use super::{Figure, Shape};

const TITLE_LINES: usize = 4;
const NOTE_LINES: usize = 6;
/// Between blocks, pixels.
const GAP: f64 = 8.0;
/// Widths in a legend, pixels.
const SWATCH: f64 = 22.0;
const MARKER: f64 = 9.0;
const SWATCH_GAP: f64 = 6.0;
const ENTRY_GAP: f64 = 16.0;
const ENTRY_HEIGHT: f64 = 18.0;

impl Layout {
    pub fn head(&mut self, figure: &Figure) {
        self.paragraph(&figure.title, TITLE, TITLE_LINES);
        self.paragraph(&figure.note, NOTE, NOTE_LINES);
        self.legend(figure);
    }

    pub fn paragraph(&mut self, text: &str, font: Font, most: usize) {
        let lines = font.wrap(text, self.width - 2.0 * PAD, most);
        let at = [PAD, self.height + font.line() - 0.25 * font.size];
        self.words.extend(stack(&lines, text, at, font, "start"));
        self.height += lines.len() as f64 * font.line() + 2.0;
    }

    /// Names the series next to their marks, unless they are named at the ends of their lines.
    fn legend(&mut self, figure: &Figure) {
        if ends_room(figure, self.width).is_some() {
            return;
        }
        let mut marks = figure.marks().filter(|mark| mark.series.is_some());
        let is_small = |shape: &Shape| matches!(shape, Shape::Dot(_) | Shape::Whisker(..));
        self.swatch = if marks.all(|mark| is_small(&mark.shape)) {
            MARKER
        } else {
            SWATCH
        };
        let indent = self.swatch + SWATCH_GAP;
        let (mut x, mut y) = (PAD, self.height + GAP + ENTRY_HEIGHT / 2.0 - 4.0);
        for (index, series) in figure
            .series
            .iter()
            .enumerate()
            .filter(|(_, series)| !series.name.is_empty())
        {
            let name = [AXIS.elide(&series.name, self.width - 2.0 * PAD - indent)];
            let wide = indent + AXIS.widest(&name);
            if x > PAD && x + wide > self.width - PAD {
                (x, y) = (PAD, y + ENTRY_HEIGHT);
            }
            self.entries.push((index, [x, y]));
            self.words.extend(stack(
                &name,
                &series.name,
                [x + indent, y + AXIS.size * MIDDLE],
                AXIS,
                "start",
            ));
            x += wide + ENTRY_GAP;
            self.height = y + ENTRY_HEIGHT / 2.0;
        }
    }
}
