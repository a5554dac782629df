//! A chart, described in data units, and its SVG ([`svg`]).

mod crowd;
mod dodge;
mod element;
mod ends;
mod frame;
mod head;
pub mod ink;
mod labels;
mod layout;
mod marks;
mod scale;
pub mod sheet;
pub mod svg;
pub mod text;

/// Panels with a common legend.
#[derive(Clone, Debug, PartialEq)]
pub struct Figure {
    pub title: String,
    /// Below the title: quantity, unit, scope.
    pub note: String,
    pub panels: Vec<Panel>,
    pub series: Vec<Series>,
}

#[derive(Clone, Debug, PartialEq)]
pub struct Series {
    pub name: String,
    /// For bounds, floors and other unmeasured values.
    pub is_dashed: bool,
    /// Its preferred colour, an index of [`ink::SERIES`].
    pub ink: Option<usize>,
}

#[derive(Clone, Debug, PartialEq)]
pub struct Panel {
    /// Empty for a single panel.
    pub title: String,
    pub x: Scale,
    pub y: Scale,
    pub marks: Vec<Mark>,
}

#[derive(Clone, Debug, PartialEq)]
pub struct Scale {
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

#[derive(Clone, Debug, PartialEq)]
pub struct Mark {
    pub shape: Shape,
    /// Index into [`Figure::series`]; `None` for neutral ink.
    pub series: Option<usize>,
    /// Tooltip; may be empty.
    pub tip: String,
    /// Id of a cell of the run, for a link.
    pub cell: Option<String>,
}

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
    /// A vertical or horizontal interval.
    Whisker([f64; 2], [f64; 2]),
    /// Across the panel at a y.
    HorizontalRule(f64),
    /// Across the panel at an x.
    VerticalRule(f64),
}

impl Figure {
    fn marks(&self) -> impl Iterator<Item = &Mark> {
        self.panels.iter().flat_map(|panel| &panel.marks)
    }
}

impl Mark {
    pub fn new(shape: Shape, series: usize) -> Self {
        Self {
            series: Some(series),
            ..Self::neutral(shape)
        }
    }

    pub fn neutral(shape: Shape) -> Self {
        Self {
            shape,
            series: None,
            tip: String::new(),
            cell: None,
        }
    }

    pub fn tip(self, tip: impl Into<String>) -> Self {
        Self {
            tip: tip.into(),
            ..self
        }
    }

    pub fn cell(self, cell: impl Into<String>) -> Self {
        Self {
            cell: Some(cell.into()),
            ..self
        }
    }
}

impl Scale {
    /// A logarithmic scale around positive numbers; `None` without numbers.
    pub fn log(label: &str, values: impl IntoIterator<Item = f64>) -> Option<Self> {
        let [lo, hi] = finite_range(values.into_iter().filter(|value| *value > 0.0))?;
        let pad = ((hi / lo).ln() * 0.06).exp().max(1.15);
        Some(Self {
            label: label.to_owned(),
            kind: ScaleKind::Log {
                lo: lo / pad,
                hi: hi * pad,
            },
        })
    }

    /// A linear scale around numbers; `None` without numbers.
    pub fn linear(label: &str, values: impl IntoIterator<Item = f64>) -> Option<Self> {
        let [lo, hi] = finite_range(values)?;
        let pad = if hi > lo {
            (hi - lo) * 0.06
        } else {
            hi.abs().max(1.0) * 0.1
        };
        Some(Self {
            label: label.to_owned(),
            kind: ScaleKind::Linear {
                lo: lo - pad,
                hi: hi + pad,
            },
        })
    }

    pub fn steps(label: &str, names: Vec<String>) -> Self {
        Self {
            label: label.to_owned(),
            kind: ScaleKind::Steps(names),
        }
    }
}

/// The least and the largest finite value.
fn finite_range(values: impl IntoIterator<Item = f64>) -> Option<[f64; 2]> {
    let finite: Vec<f64> = values
        .into_iter()
        .filter(|value| value.is_finite())
        .collect();
    let lo = finite.iter().copied().reduce(f64::min)?;
    let hi = finite.into_iter().fold(lo, f64::max);
    Some([lo, hi])
}
