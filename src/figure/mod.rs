//! A description of a chart, and its SVG ([`svg`]).
//!
//! Marks are placed in data units. A mark may carry the words of its tip and the cell that it stands for.

mod dodge;
mod element;
mod head;
pub mod ink;
mod labels;
mod layout;
mod marks;
mod scale;
pub mod svg;
pub mod text;

/// A chart of one or more panels with one legend.
#[derive(Clone, Debug, PartialEq)]
pub struct Figure {
    pub title: String,
    /// One line below the title: what is shown, unit, scope.
    pub note: String,
    pub panels: Vec<Panel>,
    pub series: Vec<Series>,
    /// The colours of [`Shape::Tile`] marks.
    pub ramp: Option<Ramp>,
}

/// What a colour stands for.
#[derive(Clone, Debug, PartialEq)]
pub struct Series {
    pub name: String,
    /// Dashed: a bound, a floor, something that was not measured.
    pub is_dashed: bool,
}

/// One coordinate system.
#[derive(Clone, Debug, PartialEq)]
pub struct Panel {
    /// Empty for a single panel.
    pub title: String,
    pub x: Scale,
    pub y: Scale,
    pub marks: Vec<Mark>,
}

/// How data become lengths.
#[derive(Clone, Debug, PartialEq)]
pub struct Scale {
    /// With its unit; empty where the steps say it.
    pub label: String,
    pub kind: ScaleKind,
}

#[derive(Clone, Debug, PartialEq)]
pub enum ScaleKind {
    Linear {
        lo: f64,
        hi: f64,
    },
    Log {
        lo: f64,
        hi: f64,
    },
    /// Named steps; a mark's coordinate is the index of its step.
    Steps(Vec<String>),
}

/// What the colour of a tile says.
#[derive(Clone, Debug, PartialEq)]
pub struct Ramp {
    pub label: String,
    pub lo: f64,
    pub hi: f64,
    /// Logarithmic, of positive numbers.
    pub is_log: bool,
    /// A value in the middle at which the colours part, such as 1 for a ratio; nothing for one-sided colours.
    pub middle: Option<f64>,
}

/// One thing that is drawn.
#[derive(Clone, Debug, PartialEq)]
pub struct Mark {
    pub shape: Shape,
    /// Index into [`Figure::series`]; nothing for neutral ink.
    pub series: Option<usize>,
    /// Words for people who point at it; empty for a mark that is only drawn.
    pub tip: String,
    /// Id of the cell of the run that it stands for.
    pub cell: Option<String>,
}

/// The forms of marks.
#[derive(Clone, Debug, PartialEq)]
pub enum Shape {
    Line(Vec<[f64; 2]>),
    Dot([f64; 2]),
    /// From `base` to `to` along x at the step `y`.
    HorizontalBar {
        y: f64,
        base: f64,
        to: f64,
    },
    /// An interval, between two points on a vertical or horizontal line.
    Whisker([f64; 2], [f64; 2]),
    /// Across the panel at a y.
    HorizontalRule(f64),
    /// Across the panel at an x.
    VerticalRule(f64),
    /// A step of x and a step of y, coloured by a value, with a short text; nothing where there is no value.
    Tile {
        x: usize,
        y: usize,
        value: Option<f64>,
        text: String,
    },
}

impl Figure {
    fn marks(&self) -> impl Iterator<Item = &Mark> {
        self.panels.iter().flat_map(|panel| &panel.marks)
    }
}

impl Mark {
    /// A mark of a series, without tip or cell.
    pub fn new(shape: Shape, series: usize) -> Self {
        Self { series: Some(series), ..Self::neutral(shape) }
    }

    /// A mark in neutral ink.
    pub fn neutral(shape: Shape) -> Self {
        Self { shape, series: None, tip: String::new(), cell: None }
    }

    /// The same with words.
    pub fn tip(self, tip: impl Into<String>) -> Self {
        Self { tip: tip.into(), ..self }
    }

    /// The same with the cell that it stands for.
    pub fn cell(self, cell: impl Into<String>) -> Self {
        Self { cell: Some(cell.into()), ..self }
    }
}

impl Scale {
    /// A logarithmic scale around positive numbers, to whole decades' thirds; `None` without numbers.
    pub fn log(label: &str, values: impl IntoIterator<Item = f64>) -> Option<Self> {
        let (lo, hi) = ends(values.into_iter().filter(|value| *value > 0.0))?;
        let pad = ((hi / lo).ln() * 0.06).exp().max(1.15);
        Some(Self { label: label.to_owned(), kind: ScaleKind::Log { lo: lo / pad, hi: hi * pad } })
    }

    /// A linear scale around numbers; `None` without numbers.
    pub fn linear(label: &str, values: impl IntoIterator<Item = f64>) -> Option<Self> {
        let (lo, hi) = ends(values)?;
        let pad = if hi > lo { (hi - lo) * 0.06 } else { hi.abs().max(1.0) * 0.1 };
        Some(Self { label: label.to_owned(), kind: ScaleKind::Linear { lo: lo - pad, hi: hi + pad } })
    }

    pub fn steps(label: &str, names: Vec<String>) -> Self {
        Self { label: label.to_owned(), kind: ScaleKind::Steps(names) }
    }
}

fn ends(values: impl IntoIterator<Item = f64>) -> Option<(f64, f64)> {
    let finite: Vec<f64> = values.into_iter().filter(|value| value.is_finite()).collect();
    let lo = finite.iter().copied().reduce(f64::min)?;
    Some((lo, finite.into_iter().fold(lo, f64::max)))
}
