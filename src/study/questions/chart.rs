//! Figures of questions: panels with common scales.

use super::numbers::{Numbers, is_formula};
use super::words::count;
use crate::draw::figure::{Figure, Mark, Panel, Scale, Series, Shape as Form};
use crate::experiment::axis::{AXES, AxisId, ENVIRONMENT};
use crate::experiment::value::Value;
use crate::study::frame::{Frame, Row};

const PANELS_MAX: usize = 12;
/// Added to a note if marks have intervals.
pub const INTERVAL: &str = "; whiskers: 95 % over environments";

/// A direction of a chart, with its label.
pub enum Along<'n> {
    Log(&'n str),
    Linear(&'n str),
    Steps(&'n str, Vec<String>),
}

impl<'n> Along<'n> {
    /// One step per value of an axis.
    pub fn values(frame: &'n Frame, of: AxisId, values: &[Value]) -> Self {
        Self::Steps(
            frame.names.name(of),
            values
                .iter()
                .map(|value| frame.names.short(of, value))
                .collect(),
        )
    }

    fn scale(self, values: impl Iterator<Item = f64>) -> Option<Scale> {
        match self {
            Self::Log(label) => Scale::log(label, values),
            Self::Linear(label) => Scale::linear(label, values),
            Self::Steps(label, names) => Some(Scale::steps(label, names)),
        }
    }
}

pub struct Chart<'n> {
    pub title: &'n str,
    pub note: String,
    pub x: Along<'n>,
    pub y: Along<'n>,
    pub panels: Vec<(String, Vec<Mark>)>,
    pub series: Vec<String>,
}

impl Chart<'_> {
    /// `None` without marks.
    pub fn figure(mut self) -> Option<Figure> {
        let all = self.panels.len();
        self.panels.truncate(PANELS_MAX);
        if all > PANELS_MAX {
            self.note += &format!("; the first {PANELS_MAX} of {all} panels");
        }
        let ends = |i: usize| {
            self.panels
                .iter()
                .flat_map(|(_, marks)| marks)
                .flat_map(move |mark| reach(mark)[i].clone())
        };
        let [xs, ys] = [0, 1].map(|i| ends(i).collect::<Vec<f64>>());
        let (x, y) = (self.x.scale(xs.into_iter())?, self.y.scale(ys.into_iter())?);
        let panel = |(title, marks): (String, Vec<Mark>)| Panel {
            title,
            x: x.clone(),
            y: y.clone(),
            marks,
        };
        Some(Figure {
            title: self.title.to_owned(),
            note: self.note,
            panels: self.panels.into_iter().map(panel).collect(),
            series: self
                .series
                .into_iter()
                .map(|name| Series {
                    name,
                    is_dashed: false,
                    ink: None,
                })
                .collect(),
        })
    }
}

/// The coordinates of a mark, by direction.
fn reach(mark: &Mark) -> [Vec<f64>; 2] {
    match &mark.shape {
        Form::Line(points) => [0, 1].map(|i| points.iter().map(|point| point[i]).collect()),
        Form::Dot(at) => at.map(|x| vec![x]),
        Form::Whisker(a, b) => [0, 1].map(|i| vec![a[i], b[i]]),
        Form::HorizontalBar { y, base, to } => [vec![*base, *to], vec![*y]],
        Form::HorizontalRule(y) => [Vec::new(), vec![*y]],
        Form::VerticalRule(x) => [vec![*x], Vec::new()],
    }
}

/// A dot with a tip and a link to its image.
pub fn dot(at: [f64; 2], series: usize, tip: String, row: &Row) -> Mark {
    Mark::new(Form::Dot(at), series).tip(tip).cell(&row.cell.id)
}

/// The image that a mark links to, if it has a single one.
pub fn only(rows: &[&Row]) -> Option<String> {
    if let [only] = rows {
        Some(only.cell.id.clone())
    } else {
        None
    }
}

/// One panel per environment. If environments are averaged, a panel of the average comes first and
/// formulas come last.
pub fn light_panels(
    frame: &Frame,
    all: &Numbers,
    summed: impl Fn() -> Vec<Mark>,
    mut lights: Vec<(Value, Vec<Mark>)>,
) -> Vec<(String, Vec<Mark>)> {
    let first = all.estimate().filter(|_| all.is_summed());
    if first.is_some() {
        lights.sort_by_key(|(light, _)| is_formula(light));
    }
    let first = first.map(|all| (count(all.n, "", AXES[ENVIRONMENT].plural), summed()));
    let name = |light: &Value| {
        if *light == Value::Unset {
            String::new()
        } else {
            frame.names.short(ENVIRONMENT, light)
        }
    };
    first
        .into_iter()
        .chain(
            lights
                .into_iter()
                .map(|(light, marks)| (name(&light), marks)),
        )
        .collect()
}

/// Dots of one series, joined by a line.
pub fn joined(dots: Vec<Mark>) -> Vec<Mark> {
    let place = |mark: &Mark| {
        if let Form::Dot(at) = mark.shape {
            Some(at)
        } else {
            None
        }
    };
    let line = Mark {
        series: dots.first().and_then(|dot| dot.series),
        ..Mark::neutral(Form::Line(Vec::new()))
    };
    let points = dots.iter().filter_map(place).collect();
    std::iter::once(Mark {
        shape: Form::Line(points),
        ..line
    })
    .chain(dots)
    .collect()
}

/// The index of a value; NaN, which is not drawn, if it is missing.
pub fn step<T: PartialEq>(steps: &[T], value: &T) -> f64 {
    steps
        .iter()
        .position(|step| step == value)
        .map_or(f64::NAN, |place| place as f64)
}
