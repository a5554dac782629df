//! Colours of a figure: CSS custom properties for light and dark grounds.

use super::Figure;

/// Class, CSS property, custom property, and colours on a light and a dark ground.
type Ink = (&'static str, &'static str, &'static str, [&'static str; 2]);

pub const INKS: [Ink; 8] = [
    (
        ".fig-ground",
        "fill",
        "--fig-ground",
        ["#fafaf8", "#101214"],
    ),
    (".fig-ink", "fill", "--fig-ink", ["#15171a", "#edeeee"]),
    (".fig-muted", "fill", "--fig-muted", ["#575b62", "#a6acb3"]),
    (".fig-grid", "stroke", "--fig-grid", ["#dcdcd7", "#31363b"]),
    (".fig-axis", "stroke", "--fig-axis", ["#85888d", "#7d848b"]),
    (".fig-plain", "color", "--fig-muted", ["#575b62", "#a6acb3"]),
    (
        ".fig-d,.fig-o",
        "stroke",
        "--fig-ground",
        ["#fafaf8", "#101214"],
    ),
    (".fig-b", "fill", "--fig-ground", ["#fafaf8", "#101214"]),
];

/// Colours of series on a light and a dark ground, with a contrast of at least 4.5:1. The first
/// four are for methods: orange, teal, violet, blue. The others are pink, ochre, sky, grey, olive,
/// brown.
pub const SERIES: [[&str; 2]; 10] = [
    ["#b3400a", "#ff9a62"],
    ["#007167", "#45cdb7"],
    ["#6446b0", "#bba8ff"],
    ["#0b5cad", "#7ab8f5"],
    ["#a83a73", "#ec94c0"],
    ["#7d5a00", "#e8b63e"],
    ["#1f7091", "#9bd8f7"],
    ["#54575c", "#c2c3c6"],
    ["#56700c", "#b5d24a"],
    ["#7a4f2a", "#d9b48c"],
];
/// Colours of series without a preference, in their order.
const OTHERS: [usize; 10] = [3, 4, 5, 6, 7, 8, 9, 1, 2, 0];

impl Figure {
    /// The colour of a series: the preferred one if it is free, else the next free one. `None` for
    /// neutral ink.
    pub fn ink(&self, series: Option<usize>) -> Option<usize> {
        let mut taken: Vec<usize> = Vec::new();
        for series in &self.series[..=series.filter(|index| *index < self.series.len())?] {
            let next = OTHERS.into_iter().find(|ink| !taken.contains(ink));
            let own = series.ink.filter(|ink| !taken.contains(ink));
            taken.push(own.or(next).unwrap_or(taken.len() % OTHERS.len()));
        }
        taken.last().copied()
    }
}

/// The CSS class of an ink of [`SERIES`], or of neutral ink.
pub fn class(ink: Option<usize>) -> String {
    ink.map_or_else(|| "fig-plain".to_owned(), |ink| format!("fig-s{ink}"))
}

/// The dashes of a series: solid lines differ by marker, dashed ones by pattern.
pub fn dashes(index: usize, is_dashed: bool) -> Option<&'static str> {
    const PATTERNS: [&str; 4] = ["6 4", "2 3", "9 3 2 3", "12 4"];
    is_dashed.then(|| PATTERNS[index % PATTERNS.len()])
}

const SHAPES: &str = include_str!("../../../assets/report/figure.css");

/// The style sheet of a figure. Each colour is written twice, for programs without custom
/// properties.
pub fn style() -> String {
    let inks = INKS.map(|(class, property, name, colors)| {
        (class.to_owned(), property, name.to_owned(), colors)
    });
    let series = SERIES.iter().enumerate();
    let series = series.map(|(i, colors)| {
        (
            format!(".fig-s{i}"),
            "color",
            format!("--fig-s{i}"),
            *colors,
        )
    });
    let all: Vec<_> = inks.into_iter().chain(series).collect();
    let rules = |ground: usize| -> String {
        let rule = |(class, property, name, colors): &(String, &str, String, [&str; 2])| {
            let color = colors[ground];
            format!("{class}{{{property}:{color};{property}:var({name},{color})}}")
        };
        all.iter().map(rule).collect()
    };
    let dark = rules(1);
    format!(
        "{}{}@media(prefers-color-scheme:dark){{{dark}}}",
        SHAPES.replace("\n", ""),
        rules(0)
    )
}
