//! Colours of a figure: CSS custom properties for light and dark grounds, and colours of tiles.

use super::Ramp;
use crate::table::colormap::Palette;

/// Class, CSS property, custom property, and colours on a light and a dark ground.
type Ink = (&'static str, &'static str, &'static str, [&'static str; 2]);

pub const INKS: [Ink; 9] = [
    (".fig-ground", "fill", "--fig-ground", ["#ffffff", "#14161a"]),
    (".fig-ink", "fill", "--fig-ink", ["#1b1d21", "#ecebe8"]),
    (".fig-muted", "fill", "--fig-muted", ["#595d65", "#a6a9b0"]),
    (".fig-grid", "stroke", "--fig-grid", ["#e4e5e8", "#2b2e34"]),
    (".fig-axis", "stroke", "--fig-axis", ["#9a9da3", "#62666e"]),
    (".fig-plain", "color", "--fig-muted", ["#595d65", "#a6a9b0"]),
    (".fig-d,.fig-o", "stroke", "--fig-ground", ["#ffffff", "#14161a"]),
    (".fig-b", "fill", "--fig-ground", ["#ffffff", "#14161a"]),
    (".fig-none", "fill", "--fig-none", ["#eceded", "#24272c"]),
];

/// Colours of series on a light and a dark ground, after Okabe and Ito, with a contrast of at least 3:1: blue, vermilion, green, purple,
/// ochre, pink, sky, grey.
pub const SERIES: [[&str; 2]; 8] = [
    ["#0072b2", "#56a8e0"],
    ["#c94f00", "#ff8a4c"],
    ["#00805a", "#35c295"],
    ["#6f4bb2", "#b39af2"],
    ["#a06f00", "#e8b63e"],
    ["#b4487f", "#ec94c0"],
    ["#2f8fc6", "#9bd8f7"],
    ["#54575c", "#c2c3c6"],
];

/// The CSS class of a series, or of neutral ink.
pub fn class(series: Option<usize>) -> String {
    series.map_or_else(|| "fig-plain".to_owned(), |index| format!("fig-s{}", index % SERIES.len()))
}

/// The dashes of a series: solid lines differ by marker, dashed ones by pattern.
pub fn dashes(index: usize, is_dashed: bool) -> Option<&'static str> {
    const PATTERNS: [&str; 4] = ["6 4", "2 3", "9 3 2 3", "12 4"];
    is_dashed.then(|| PATTERNS[index % PATTERNS.len()])
}

const SHAPES: &str = include_str!("../../assets/report/figure.css");

/// The style sheet of a figure. Each colour is written twice, for programs without custom properties.
pub fn style() -> String {
    let inks = INKS.map(|(class, property, name, colors)| (class.to_owned(), property, name.to_owned(), colors));
    let series = SERIES.iter().enumerate();
    let series = series.map(|(i, colors)| (format!(".fig-s{i}"), "color", format!("--fig-s{i}"), *colors));
    let all: Vec<_> = inks.into_iter().chain(series).collect();
    let rules = |ground: usize| -> String {
        let rule = |(class, property, name, colors): &(String, &str, String, [&str; 2])| {
            let color = colors[ground];
            format!("{class}{{{property}:{color};{property}:var({name},{color})}}")
        };
        all.iter().map(rule).collect()
    };
    let dark = rules(1);
    format!("{}{}@media(prefers-color-scheme:dark){{{dark}}}", SHAPES.replace("\n", ""), rules(0))
}

/// The used part of one-sided colours, without black and near white.
const SEQUENTIAL: [f64; 2] = [0.12, 0.97];

impl Ramp {
    /// The place of a value on the palette, from 0 to 1.
    fn place(&self, value: f64) -> f64 {
        let f = |value: f64| value.max(f64::MIN_POSITIVE).ln();
        let [lo, hi, value] = [self.lo, self.hi, value].map(f);
        let place = match self.middle.map(f) {
            Some(middle) => 0.5 + 0.5 * (value - middle) / (hi - middle).max(middle - lo),
            None => (value - lo) / (hi - lo),
        };
        if place.is_nan() { 0.5 } else { place.clamp(0.0, 1.0) }
    }

    /// The sRGB-encoded colour.
    pub fn color(&self, value: f64) -> [u8; 3] {
        let place = self.place(value);
        match self.middle {
            Some(_) => Palette::BlueRed.color(place),
            None => Palette::Magma.color(SEQUENTIAL[0] + place * (SEQUENTIAL[1] - SEQUENTIAL[0])),
        }
    }
}

pub fn hex([r, g, b]: [u8; 3]) -> String {
    format!("#{r:02x}{g:02x}{b:02x}")
}

/// The class of black or white words on a colour, whichever has more contrast (WCAG 2).
pub fn words_on(color: [u8; 3]) -> &'static str {
    /// Luminance at which both have the same contrast.
    const EVEN: f64 = 0.179;
    let linear = color.map(|code| {
        let encoded = f64::from(code) / 255.0;
        if encoded <= 0.040_45 { encoded / 12.92 } else { ((encoded + 0.055) / 1.055).powf(2.4) }
    });
    let luminance = 0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2];
    if luminance > EVEN { "fig-dark" } else { "fig-pale" }
}
