//! Colours of a figure: CSS custom properties for light and dark grounds.

use super::Figure;

/// A CSS rule that colours the elements of some classes.
struct Rule {
    selector: String,
    property: &'static str,
    /// The custom property that a page may set.
    variable: String,
    on_light: &'static str,
    on_dark: &'static str,
}

/// A colour on a light and a dark ground.
type Pair = [&'static str; 2];

const GROUND: Pair = ["#fafaf8", "#101214"];
const MUTED: Pair = ["#575b62", "#a6acb3"];

impl Rule {
    fn new(
        selector: impl Into<String>,
        property: &'static str,
        variable: impl Into<String>,
        [on_light, on_dark]: Pair,
    ) -> Self {
        Self {
            selector: selector.into(),
            property,
            variable: variable.into(),
            on_light,
            on_dark,
        }
    }

    /// The rule with one of its colours. The colour is written twice, for programs without custom
    /// properties.
    fn css(&self, color: &str) -> String {
        let Self {
            selector,
            property,
            variable,
            ..
        } = self;
        format!("{selector}{{{property}:{color};{property}:var({variable},{color})}}")
    }
}

/// All rules, in the order of the style sheet.
fn rules() -> Vec<Rule> {
    let mut rules = vec![
        Rule::new(".fig-ground", "fill", "--fig-ground", GROUND),
        Rule::new(".fig-ink", "fill", "--fig-ink", ["#15171a", "#edeeee"]),
        Rule::new(".fig-muted", "fill", "--fig-muted", MUTED),
        Rule::new(".fig-grid", "stroke", "--fig-grid", ["#dcdcd7", "#31363b"]),
        Rule::new(".fig-axis", "stroke", "--fig-axis", ["#85888d", "#7d848b"]),
        Rule::new(".fig-plain", "color", "--fig-muted", MUTED),
        Rule::new(".fig-d,.fig-o", "stroke", "--fig-ground", GROUND),
        Rule::new(".fig-b", "fill", "--fig-ground", GROUND),
    ];
    for (i, colors) in SERIES.iter().enumerate() {
        let selector = format!(".fig-s{i}");
        let variable = format!("--fig-s{i}");
        rules.push(Rule::new(selector, "color", variable, *colors));
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
    let rules = rules();
    let light: String = rules.iter().map(|rule| rule.css(rule.on_light)).collect();
    let dark: String = rules.iter().map(|rule| rule.css(rule.on_dark)).collect();
    let shapes = SHAPES.replace('\n', "");
    format!("{shapes}{light}@media(prefers-color-scheme:dark){{{dark}}}")
}
