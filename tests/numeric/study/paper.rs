//! Finished runs that were never rendered: the cells of a plan with scores by a formula, or rows
//! with given errors, bins, lights and times.

use crate::run::runs;
use splitsum::base::csv::Cell;
use splitsum::experiment::Plan;
use splitsum::experiment::axis::{AXES, AxisId, Point};
use splitsum::experiment::value::Value;
use splitsum::instrument::metrics::{METRICS, Weight};
use splitsum::run::provenance::Provenance;
use splitsum::run::tables::HEADLINE;
use splitsum::study::finished::{Bin, BinRange, Finished, FinishedCell, MetricValues};
use splitsum::study::frame::Frame;
use splitsum::study::questions::{Finding, question};
use splitsum::study::table::{Table, shown};
use std::sync::Arc;

/// f64 arithmetic of a few logarithms.
pub const F64: f64 = 1e-9;

fn empty(name: &str) -> Finished {
    Finished {
        dir: name.into(),
        provenance: Provenance {
            name: name.to_owned(),
            ..Provenance::default()
        },
        experiment: String::new(),
        config: None,
        cells: Vec::new(),
        lights: Vec::new(),
        timings: Vec::new(),
        recovered: Vec::new(),
        failures: Vec::new(),
        weights: vec![Weight::Picture, Weight::Uniform],
        weight: Weight::Uniform,
    }
}

fn cell_of(id: String, point: Point) -> FinishedCell {
    let none = MetricValues::from_fn(|_| None);
    let (reference, bins) = (None, Vec::new());
    FinishedCell {
        id: id.into(),
        point,
        is_failed: false,
        scores: None,
        noise_floors: none,
        steadiness: None,
        reference,
        bins: bins.into(),
        steps: Arc::default(),
        images: None,
    }
}

pub const HEAD: &str = "name = \"made\"\nsize = [16, 16]\nreference = { samples = 32, noise_share = 0 \
                        }\n[axes]\ndiffuse = [\"none\"]\n";

/// Synthetic data of a cell.
#[derive(Clone, Copy, Debug)]
pub struct Made {
    pub error: f64,
    pub floor: f64,
    pub flip: f64,
}

impl Made {
    /// An error far above the noise, with an invisible difference.
    pub fn error(error: f64) -> Self {
        Self {
            error,
            floor: 1e-12,
            flip: 0.01,
        }
    }
}

/// A finished run of an experiment with these lines of axes; `None` for a cell that failed.
pub fn finished(axes: &str, cell: impl Fn(&Point) -> Option<Made>) -> Finished {
    finished_of(&format!("{HEAD}{axes}"), cell)
}

pub fn finished_of(text: &str, cell: impl Fn(&Point) -> Option<Made>) -> Finished {
    let plan: Plan = runs::plan(text);
    let of = |planned: &splitsum::experiment::Cell| {
        let made = cell(&planned.point);
        let scores = |made: Made| {
            MetricValues::from_fn(|name| {
                Some(if name == "flip" {
                    made.flip
                } else {
                    made.error
                })
            })
        };
        FinishedCell {
            is_failed: made.is_none(),
            scores: made.map(scores),
            noise_floors: MetricValues::from_fn(|name| {
                made.filter(|_| name != "flip").map(|made| made.floor)
            }),
            ..cell_of(planned.id.to_string(), planned.point.clone())
        }
    };
    let cells = plan.cells.iter().map(of).collect();
    Finished {
        experiment: plan.config.text.clone(),
        cells,
        config: Some(plan.config),
        ..empty("made")
    }
}

/// Multiplies every number of the cells by a factor that depends on the point.
pub fn scaled(run: &mut Finished, factor: impl Fn(&Point) -> f64) {
    let names = || METRICS.iter().map(|metric| metric.name);
    for cell in &mut run.cells {
        let factor = factor(&cell.point);
        let by = |values: &MetricValues| {
            assert!(names().all(|name| {
                values
                    .get(name)
                    .is_none_or(|value| value >= 0.0 || name == "bias_rel")
            }));
            MetricValues::from_fn(|name| {
                values.get(name).map(|value| {
                    if name == "flip" {
                        value
                    } else {
                        value * factor
                    }
                })
            })
        };
        cell.scores = cell.scores.as_ref().map(by);
        let bins = cell.bins.iter().map(|bin| Bin {
            scores: by(&bin.scores),
            ..bin
        });
        cell.bins = bins.collect();
    }
}

/// Rows with values on some axes; the others have their defaults.
pub struct Paper {
    axes: &'static [&'static str],
    pub run: Finished,
}

impl Paper {
    pub fn new(axes: &'static [&'static str]) -> Self {
        Self {
            axes,
            run: empty("paper"),
        }
    }

    /// A cell with this error in the headline metric, far above its noise; an empty text leaves an
    /// axis unset.
    pub fn add(&mut self, values: &[&str], error: f64) -> &mut FinishedCell {
        assert_eq!(values.len(), self.axes.len());
        let mut point = Point::default();
        for (name, text) in self.axes.iter().zip(values) {
            let axis = AxisId::find(name).unwrap_or_else(|| panic!("no axis {name}"));
            point[axis] = if text.is_empty() {
                Value::Unset
            } else {
                AXES[axis].kind.parse_text(text).unwrap()
            };
        }
        self.run.cells.push(FinishedCell {
            scores: Some(MetricValues::from_fn(|name| {
                (name == HEADLINE).then_some(error)
            })),
            noise_floors: MetricValues::from_fn(|name| (name == HEADLINE).then_some(1e-9)),
            ..cell_of(format!("{:04x}", self.run.cells.len()), point)
        });
        self.run.cells.last_mut().unwrap()
    }

    /// The missing part of the run for a question.
    pub fn lacks(&self, name: &str) -> Option<&'static str> {
        question(name)
            .unwrap()
            .lack(&Frame::new(&self.run, None).shape)
    }

    pub fn finding(&self, name: &str) -> Finding {
        finding(&self.run, name)
    }
}

pub fn finding(run: &Finished, name: &str) -> Finding {
    let (frame, question) = (
        Frame::new(run, None),
        question(name).unwrap_or_else(|| panic!("no question {name}")),
    );
    assert_eq!(question.lack(&frame.shape), None, "{name}");
    (question.answer)(&frame).unwrap_or_else(|| panic!("{name} is not answered"))
}

pub fn bins(metric: &str, values: &[f64]) -> Vec<Bin> {
    let width = 1.0 / values.len() as f64;
    let of = |(i, value): (usize, &f64)| {
        bin([i as f64 * width, (i + 1) as f64 * width], |name| {
            (name == metric).then_some(*value)
        })
    };
    values.iter().enumerate().map(of).collect()
}

pub fn bin([lo, hi]: [f64; 2], scores: impl Fn(&'static str) -> Option<f64>) -> Bin {
    Bin {
        range: BinRange {
            lo,
            hi,
            pixel_count: 100,
        },
        reference_mean: None,
        scores: MetricValues::from_fn(scores),
        noise_floors: MetricValues::from_fn(|_| None),
    }
}

fn cells<'t>(table: &'t Table, name: &str) -> impl Iterator<Item = &'t Cell> {
    let place = table.columns.iter().position(|column| column == name);
    let place = place.unwrap_or_else(|| panic!("no column {name} in {:?}", table.columns));
    table.rows.iter().map(move |row| &row[place])
}

/// As text; numbers with all their digits.
pub fn column(table: &Table, name: &str) -> Vec<String> {
    cells(table, name)
        .map(|cell| {
            if let Cell::Number(x) = cell {
                x.to_string()
            } else {
                shown(cell)
            }
        })
        .collect()
}

/// The numbers of a column; NaN for an empty cell.
pub fn numbers(table: &Table, name: &str) -> Vec<f64> {
    let number = |cell: &Cell| match cell {
        Cell::Number(x) => *x,
        Cell::Integer(n) => *n as f64,
        Cell::Missing => f64::NAN,
        Cell::Text(_) | Cell::Quantity(_) | Cell::Named(_) => {
            panic!("{name}: {cell:?} is not a number")
        }
    };
    cells(table, name).map(number).collect()
}

pub fn only(table: &Table, wanted: &[(&str, &str)]) -> Table {
    let columns: Vec<Vec<String>> = wanted.iter().map(|(name, _)| column(table, name)).collect();
    let is_it = |i: &usize| {
        columns
            .iter()
            .zip(wanted)
            .all(|(column, (_, text))| column[*i] == *text)
    };
    let rows = (0..table.rows.len())
        .filter(is_it)
        .map(|i| table.rows[i].clone())
        .collect();
    Table {
        rows,
        ..table.clone()
    }
}
