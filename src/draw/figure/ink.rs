//! Colours of a figure: CSS custom properties for light and dark grounds.

use super::Figure;

/// A colour on a light and a dark ground.
pub type Pair = [&'static str; 2];

const GROUND: Pair = ["#fafaf8", "#101214"];
const MUTED: Pair = ["#575b62", "#a6acb3"];

/// A CSS rule that colours the elements of some classes.
pub struct Ink {
    pub selector: &'static str,
    property: &'static str,
    /// The custom property that a page may set.
    variable: &'static str,
    pub colors: Pair,
}

const fn ink(
    selector: &'static str,
    property: &'static str,
    variable: &'static str,
    colors: Pair,
) -> Ink {
    Ink {
        selector,
        property,
        variable,
        colors,
    }
}

pub const INKS: [Ink; 8] = [
    ink(".fig-ground", "fill", "--fig-ground", GROUND),
    ink(".fig-ink", "fill", "--fig-ink", ["#15171a", "#edeeee"]),
    ink(".fig-muted", "fill", "--fig-muted", MUTED),
    ink(".fig-grid", "stroke", "--fig-grid", ["#dcdcd7", "#31363b"]),
    ink(".fig-axis", "stroke", "--fig-axis", ["#85888d", "#7d848b"]),
    ink(".fig-plain", "color", "--fig-muted", MUTED),
    ink(".fig-d,.fig-o", "stroke", "--fig-ground", GROUND),
    ink(".fig-b", "fill", "--fig-ground", GROUND),
];

/// A CSS rule. The colour is written twice, for programs without custom properties.
fn rule(selector: &str, property: &str, variable: &str, color: &str) -> String {
    format!("{selector}{{{property}:{color};{property}:var({variable},{color})}}")
}

/// The rules of all inks and series on one ground: 0 is light, 1 dark.
fn rules(ground: usize) -> String {
    let mut rules = String::new();
    for ink in &INKS {
        let color = ink.colors[ground];
        rules += &rule(ink.selector, ink.property, ink.variable, color);
    }
    for (i, colors) in SERIES.iter().enumerate() {
        let selector = format!(".fig-s{i}");
        let variable = format!("--fig-s{i}");
        rules += &rule(&selector, "color", &variable, colors[ground]);
    }
    rules
}

/// Colours of series on a light and a dark ground, with a contrast of at least 4.5:1. The first
/// four are for methods: orange, teal, violet, blue. The others are pink, ochre, sky, grey, olive,
/// brown.
pub const SERIES: [Pair; 10] = [
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
/// Methods in the order of [`SERIES`]: each has one colour in all figures.
const METHODS: [&str; 10] = [
    "split-sum",
    "split-sum-two",
    "sampled",
    "sampled-vndf",
    "split-sum-cap",
    "split-sum-one",
    "split-sum-unity",
    "split-sum-frostbite",
    "split-sum-four",
    "sampled-unfiltered",
];

/// The colour of a method by its name, an index of [`SERIES`]; `None` for methods without one.
pub fn method_ink(name: &str) -> Option<usize> {
    METHODS.iter().position(|method| *method == name)
}

/// Colours of series without a preference, in their order.
const OTHERS: [usize; 10] = [3, 4, 5, 6, 7, 8, 9, 1, 2, 0];

impl Figure {
    /// The colour of a series: the preferred one if it is free, else the next free one. `None` for
    /// neutral ink.
    pub fn ink(&self, series: Option<usize>) -> Option<usize> {
        let mut taken: Vec<usize> = Vec::new();
        for series in &self.series[..=series.filter(|index| *index < self.series.len())?] {
            let next = OTHERS.into_iter().find(|ink| !taken.contains(ink));
            let preferred = series.ink.filter(|ink| !taken.contains(ink));
            taken.push(preferred.or(next).unwrap_or(taken.len() % OTHERS.len()));
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

/// The style sheet of a figure.
pub fn style() -> String {
    let shapes = SHAPES.replace('\n', "");
    let light = rules(0);
    let dark = rules(1);
    format!("{shapes}{light}@media(prefers-color-scheme:dark){{{dark}}}")
}
