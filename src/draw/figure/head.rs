//! The head of a figure: title, note, legend.

use super::ends::ends_room;
use super::frame::{Layout, LegendEntry, PAD};
use super::text::{AXIS, Anchor, Font, MIDDLE, NOTE, TITLE, stack};
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
    /// Lays out title, note and legend.
    pub fn head(&mut self, figure: &Figure) {
        self.paragraph(&figure.title, TITLE, TITLE_LINES);
        self.paragraph(&figure.whole_note(), NOTE, NOTE_LINES);
        self.legend(figure);
    }

    /// Appends a paragraph of at most `most` lines.
    pub fn paragraph(&mut self, text: &str, font: Font, most: usize) {
        let lines = font.wrap(text, self.width - 2.0 * PAD, most);
        let baseline = self.height + font.line() - 0.25 * font.size;
        let position = [PAD, baseline];
        self.words
            .extend(stack(&lines, text, position, font, Anchor::Start));
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
        let mut x = PAD;
        let mut y = self.height + GAP + ENTRY_HEIGHT / 2.0 - 4.0;
        for (index, series) in figure.series.iter().enumerate() {
            if series.name.is_empty() {
                continue;
            }
            let name = [AXIS.elide(&series.name, self.width - 2.0 * PAD - indent)];
            let width = indent + AXIS.widest(&name);
            if x > PAD && x + width > self.width - PAD {
                x = PAD;
                y += ENTRY_HEIGHT;
            }
            self.entries.push(LegendEntry {
                series: index,
                position: [x, y],
            });
            let position = [x + indent, y + AXIS.size * MIDDLE];
            self.words
                .extend(stack(&name, &series.name, position, AXIS, Anchor::Start));
            x += width + ENTRY_GAP;
            self.height = y + ENTRY_HEIGHT / 2.0;
        }
    }
}
