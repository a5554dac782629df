//! Figures of questions: panels with common scales.

use super::numbers::{Numbers, is_formula};
use super::words::count;
use crate::draw::figure::ink;
use crate::draw::figure::{Figure, Mark, Panel, Scale, Series, Shape as Form};
use crate::experiment::axis::{AXES, AxisId, ENVIRONMENT};
use crate::experiment::value::Value;
use crate::study::frame::{Frame, Row};

const PANELS_MAX: usize = 12;
/// Added to a note if marks have intervals.
pub const INTERVAL: &str = "; whiskers: 95 % over environments";

/// A direction of a chart, with its label.
pub enum ChartAxis<'n> {
    Log(&'n str),
    Linear(&'n str),
    Steps(&'n str, Vec<String>),
}

impl<'n> ChartAxis<'n> {
    /// One step per value of an axis.
    pub fn values(frame: &'n Frame, axis: AxisId, values: &[Value]) -> Self {
        let names = values.iter().map(|value| frame.names.short(axis, value));
        Self::Steps(frame.names.name(axis), names.collect())
    }

    fn scale(self, values: impl Iterator<Item = f64>) -> Option<Scale> {
        match self {
            Self::Log(label) => Scale::log(label, values),
            Self::Linear(label) => Scale::linear(label, values),
            Self::Steps(label, names) => Some(Scale::steps(label, names)),
        }
    }
}

/// A panel without its scales, which all panels share.
pub struct ChartPanel {
    /// Empty for a single panel.
    pub title: String,
    pub marks: Vec<Mark>,
}

pub struct Chart<'n> {
    pub title: &'n str,
    pub note: String,
    pub x: ChartAxis<'n>,
    pub y: ChartAxis<'n>,
    pub panels: Vec<ChartPanel>,
    pub series: Vec<Series>,
}

impl Chart<'_> {
    /// `None` without marks.
    pub fn figure(mut self) -> Option<Figure> {
        let count = self.panels.len();
        self.panels.truncate(PANELS_MAX);
        if count > PANELS_MAX {
            self.note += &format!("; the first {PANELS_MAX} of {count} panels");
        }
        let mut xs = Vec::new();
        let mut ys = Vec::new();
        for mark in self.panels.iter().flat_map(|panel| &panel.marks) {
            let Coordinates { x, y } = coordinates(mark);
            xs.extend(x);
            ys.extend(y);
        }
        let x = self.x.scale(xs.into_iter())?;
        let y = self.y.scale(ys.into_iter())?;
        let panels = self.panels.into_iter().map(|panel| Panel {
            title: panel.title,
            x: x.clone(),
            y: y.clone(),
            marks: panel.marks,
        });
        Some(Figure {
            title: self.title.to_owned(),
            note: self.note,
            panels: panels.collect(),
            series: self.series,
        })
    }
}

/// A series of measured values.
pub fn solid(name: impl Into<String>) -> Series {
    Series {
        name: name.into(),
        is_dashed: false,
        ink: None,
    }
}

/// The series of a method, in its colour. Methods without samples are dashed, as floors are.
pub fn method_series(name: impl Into<String>, method: &str, is_dashed: bool) -> Series {
    Series {
        is_dashed,
        ink: ink::method_ink(method),
        ..solid(name)
    }
}

/// The coordinates of a mark that scales must contain.
struct Coordinates {
    x: Vec<f64>,
    y: Vec<f64>,
}

fn coordinates(mark: &Mark) -> Coordinates {
    match &mark.shape {
        Form::Line(points) => Coordinates {
            x: points.iter().map(|[x, _]| *x).collect(),
            y: points.iter().map(|[_, y]| *y).collect(),
        },
        Form::Dot([x, y]) => Coordinates {
            x: vec![*x],
            y: vec![*y],
        },
        Form::Whisker(a, b) => Coordinates {
            x: vec![a[0], b[0]],
            y: vec![a[1], b[1]],
        },
        Form::HorizontalBar { y, base, to } => Coordinates {
            x: vec![*base, *to],
            y: vec![*y],
        },
        Form::HorizontalRule(y) => Coordinates {
            x: Vec::new(),
            y: vec![*y],
        },
        Form::VerticalRule(x) => Coordinates {
            x: vec![*x],
            y: Vec::new(),
        },
    }
}

/// A dot with a tip and a link to its image.
pub fn dot(position: [f64; 2], series: usize, tip: String, row: &Row) -> Mark {
    Mark::new(Form::Dot(position), series)
        .tip(tip)
        .cell(&*row.cell.id)
}

/// The image that a mark links to, if it has a single one.
pub fn only(rows: &[&Row]) -> Option<String> {
    if let [only] = rows {
        Some(only.cell.id.to_string())
    } else {
        None
    }
}

/// The marks under one environment; unset for a single panel without a title.
pub struct LightMarks {
    pub light: Value,
    pub marks: Vec<Mark>,
}

/// One panel per environment. If environments are averaged, a panel of the average comes first and
/// formulas come last.
pub fn light_panels(
    frame: &Frame,
    all: &Numbers,
    average: impl FnOnce() -> Vec<Mark>,
    mut lights: Vec<LightMarks>,
) -> Vec<ChartPanel> {
    let mut panels = Vec::new();
    if let Some(all) = all.estimate().filter(|_| all.has_interval()) {
        lights.sort_by_key(|one| is_formula(&one.light));
        panels.push(ChartPanel {
            title: count(all.n, "", AXES[ENVIRONMENT].plural),
            marks: average(),
        });
    }
    for LightMarks { light, marks } in lights {
        let title = if light == Value::Unset {
            String::new()
        } else {
            frame.names.short(ENVIRONMENT, &light)
        };
        panels.push(ChartPanel { title, marks });
    }
    panels
}

/// Dots of one series, joined by a line.
pub fn joined(dots: Vec<Mark>) -> Vec<Mark> {
    let points = dots.iter().filter_map(|mark| match mark.shape {
        Form::Dot(point) => Some(point),
        _ => None,
    });
    let line = Mark {
        series: dots.first().and_then(|dot| dot.series),
        ..Mark::neutral(Form::Line(points.collect()))
    };
    std::iter::once(line).chain(dots).collect()
}

/// The index of a value; NaN, which is not drawn, if it is missing.
pub fn step<T: PartialEq>(steps: &[T], value: &T) -> f64 {
    steps
        .iter()
        .position(|step| step == value)
        .map_or(f64::NAN, |index| index as f64)
}
