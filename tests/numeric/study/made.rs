//! Finished runs that were never rendered: the cells of a plan with scores by a formula.

use crate::runner::runs;
use splitsum::metrics::METRICS;
use splitsum::runner::Plan;
use splitsum::runner::axis::Point;
use splitsum::study::finished::{Finished, FinishedCell, Light, MetricValues};
use splitsum::study::questions::{Finding, question};
use splitsum::table::csv::Cell;

/// What an experiment file begins with.
pub const HEAD: &str = "name = \"made\"\nsize = [16, 16]\nreference = { samples = 32 }\n[axes]\ndiffuse = [\"none\"]\n";

/// What is made up about a cell.
#[derive(Clone, Copy, Debug)]
pub struct Made {
    pub error: f64,
    pub floor: f64,
    pub flip: f64,
    /// Squared bias and variance.
    pub bias_variance: Option<[f64; 2]>,
}

impl Made {
    /// An error far above the noise, with a difference that nobody sees.
    pub fn error(error: f64) -> Self {
        Self { error, floor: 1e-12, flip: 0.01, bias_variance: None }
    }
}

/// A finished run of an experiment with these lines of axes; nothing for a cell that failed.
pub fn finished(axes: &str, cell: impl Fn(&Point) -> Option<Made>) -> Finished {
    let plan: Plan = runs::plan(&format!("{HEAD}{axes}"));
    let of = |planned: &splitsum::runner::Cell| {
        let made = cell(&planned.point);
        let scores = |made: Made| MetricValues::of(|name| Some(if name == "flip" { made.flip } else { made.error }));
        FinishedCell {
            id: planned.id.clone(),
            point: planned.point.clone(),
            scores: made.map(scores),
            noise_floors: MetricValues::of(|name| made.filter(|_| name != "flip").map(|made| made.floor)),
            bias_variance: made.and_then(|made| made.bias_variance),
            reference: None,
            bins: Vec::new(),
            images: None,
        }
    };
    Finished {
        dir: "made".into(),
        provenance: serde_json::json!({ "name": "made", "sessions": [] }),
        experiment: plan.config.text.clone(),
        cells: plan.cells.iter().map(of).collect(),
        config: Some(plan.config),
        lights: Vec::<Light>::new(),
        timings: Vec::new(),
        failures: Vec::new(),
        is_under_way: false,
    }
}

/// Every number of the cells multiplied by a factor that hangs on the point.
pub fn scaled(run: &mut Finished, factor: impl Fn(&Point) -> f64) {
    let names = || METRICS.iter().map(|metric| metric.description().name);
    for cell in &mut run.cells {
        let factor = factor(&cell.point);
        let by = |values: &MetricValues| {
            assert!(
                names().all(|name| values
                    .get(name)
                    .is_none_or(|value| value >= 0.0 || name == "bias_rel" || name == "ssim"))
            );
            MetricValues::of(|name| values.get(name).map(|value| if name == "flip" { value } else { value * factor }))
        };
        cell.scores = cell.scores.as_ref().map(by);
        cell.bins.iter_mut().for_each(|bin| bin.scores = by(&bin.scores));
        cell.bias_variance = cell.bias_variance.map(|both| both.map(|value| value * factor));
    }
}

/// The answer to a question, by its name.
pub fn finding(run: &Finished, name: &str) -> Finding {
    let frame = splitsum::study::frame::Frame::new(run, None);
    let question = question(name).unwrap_or_else(|| panic!("no question {name}"));
    assert_eq!((question.lacks)(&frame.shape), None, "{name}");
    (question.answer)(&frame).unwrap_or_else(|| panic!("{name} is not answered"))
}

/// The column of that name of a finding's table.
pub fn column<'f>(finding: &'f Finding, name: &str) -> Vec<&'f Cell> {
    let place = finding.table.columns.iter().position(|column| column == name);
    let place = place.unwrap_or_else(|| panic!("no column {name} in {:?}", finding.table.columns));
    finding.table.rows.iter().map(|row| &row[place]).collect()
}

/// Its numbers; NaN for an empty cell.
pub fn numbers(finding: &Finding, name: &str) -> Vec<f64> {
    let number = |cell: &&Cell| match cell {
        Cell::Number(x) => *x,
        Cell::Integer(n) => *n as f64,
        Cell::Missing => f64::NAN,
        Cell::Text(text) => panic!("{name}: {text} is no number"),
    };
    column(finding, name).iter().map(number).collect()
}
