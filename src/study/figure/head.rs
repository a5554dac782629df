//! The head of a figure: title, note, legend and the bar of tile colours.

use super::labels::FONT;
use super::scale::{Axis, ticks};
use super::text::{Font, LINE, MIDDLE};
use super::words::{Anchor, Words};
use super::{Figure, Ramp, ScaleKind, Shape};

/// Around everything, pixels.
pub const PAD: f64 = 12.0;
const TITLE: Font = Font::bold(15.0);
const NOTE: Font = Font::new(12.0);
const NOTE_LINES: usize = 6;
const TITLE_LINES: usize = 4;
/// Between blocks.
const GAP: f64 = 8.0;
/// Room of a legend's line or bar, of a lone marker, and between two entries.
const SWATCH: f64 = 22.0;
const MARKER: f64 = 9.0;
const SWATCH_GAP: f64 = 6.0;
const ENTRY_GAP: f64 = 16.0;
const ENTRY_HEIGHT: f64 = 18.0;
/// Size of the bar of tile colours.
const BAR: [f64; 2] = [220.0, 10.0];
/// Between two labels of the bar.
const BAR_LABELS: f64 = 8.0;

/// Places of the head's parts.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Head {
    pub words: Vec<Words>,
    /// Series with the left end and the middle height of its mark.
    pub entries: Vec<(usize, [f64; 2])>,
    /// The width of these marks.
    pub swatch: f64,
    /// Left, top, width and height of the colour bar, and its ticks.
    pub bar: Option<([f64; 4], Vec<f64>)>,
    pub bottom: f64,
}

/// How a ramp runs, as a scale.
pub fn ramp_kind(ramp: &Ramp) -> ScaleKind {
    match ramp.is_log {
        true => ScaleKind::Log { lo: ramp.lo, hi: ramp.hi },
        false => ScaleKind::Linear { lo: ramp.lo, hi: ramp.hi },
    }
}

impl Head {
    pub fn new(figure: &Figure, width: f64) -> Self {
        let mut head = Self { bottom: PAD, ..Self::default() };
        let room = width - 2.0 * PAD;
        head.paragraph(&figure.title, TITLE, room, TITLE_LINES, "fig-ink fig-title");
        head.paragraph(&figure.note, NOTE, room, NOTE_LINES, "fig-muted fig-note");
        head.legend(figure, width);
        if let Some(ramp) = &figure.ramp {
            head.ramp(ramp, room);
        }
        head
    }

    fn paragraph(&mut self, text: &str, font: Font, room: f64, lines: usize, class: &'static str) {
        for line in font.wrap(text, room, lines) {
            self.bottom += font.size * LINE;
            let at = [PAD, self.bottom - 0.25 * font.size];
            self.words.push(Words::new(line, at, font, class).of(text));
        }
        self.bottom += 2.0;
    }

    fn legend(&mut self, figure: &Figure, width: f64) {
        let names = figure.series.iter().enumerate().filter(|(_, series)| !series.name.is_empty());
        let is_small =
            |shape: &Shape| matches!(shape, Shape::Dot(_) | Shape::Whisker(..) | Shape::Text(..) | Shape::Tile { .. });
        let mut marks = figure.panels.iter().flat_map(|panel| &panel.marks).filter(|mark| mark.series.is_some());
        self.swatch = if marks.all(|mark| is_small(&mark.shape)) { MARKER } else { SWATCH };
        let indent = self.swatch + SWATCH_GAP;
        let (mut x, mut y) = (PAD, self.bottom + GAP + ENTRY_HEIGHT / 2.0 - 4.0);
        for (index, series) in names {
            let name = NOTE.elide(&series.name, width - 2.0 * PAD - indent);
            let wide = indent + NOTE.width(&name);
            if x > PAD && x + wide > width - PAD {
                (x, y) = (PAD, y + ENTRY_HEIGHT);
            }
            self.entries.push((index, [x, y]));
            let at = [x + indent, y + NOTE.size * MIDDLE];
            self.words.push(Words::new(name, at, NOTE, "fig-ink fig-note").of(&series.name));
            x += wide + ENTRY_GAP;
            self.bottom = y + ENTRY_HEIGHT / 2.0;
        }
    }

    fn ramp(&mut self, ramp: &Ramp, room: f64) {
        let wide = BAR[0].min(room - 2.0 * BAR_LABELS);
        let top = self.bottom + GAP + NOTE.size * LINE;
        let label = NOTE.elide(&ramp.label, room);
        let at = [PAD, top - 0.4 * NOTE.size];
        self.words.push(Words::new(label, at, NOTE, "fig-ink fig-note").of(&ramp.label));
        let kind = ramp_kind(ramp);
        let axis = Axis::new(&kind, PAD, PAD + wide);
        let half = |label: &str| FONT.width(label) / 2.0;
        // A label at an end stays below the bar.
        let middle = |value: f64, label: &str| {
            let at = axis.open(value).unwrap_or(PAD);
            at.min(PAD + wide - half(label)).max(PAD + half(label))
        };
        let found = ticks(&kind, &[], |all| {
            let ends = all.iter().map(|tick| (middle(tick.value, &tick.label), half(&tick.label)));
            let ends: Vec<(f64, f64)> = ends.collect();
            ends.windows(2).all(|pair| pair[0].0 + pair[0].1 + BAR_LABELS <= pair[1].0 - pair[1].1)
        });
        let y = top + BAR[1] + 4.0 + FONT.size * ASCENT_OF_DIGITS;
        for tick in &found {
            let words = Words::new(&tick.label, [middle(tick.value, &tick.label), y], FONT, "fig-muted");
            self.words.push(words.anchor(Anchor::Middle));
        }
        let places = found.iter().filter_map(|tick| axis.open(tick.value)).collect();
        self.bar = Some(([PAD, top, wide, BAR[1]], places));
        self.bottom = y + 4.0;
    }
}

/// Digits have no parts above or below this.
const ASCENT_OF_DIGITS: f64 = 0.75;
