//! Finished runs written on paper: errors, bins, lights and times of choice.

use splitsum::runner::axis::{AXES, Point};
use splitsum::runner::tables::HEADLINE;
use splitsum::runner::value::Value;
use splitsum::study::finished::{Bin, Finished, FinishedCell, Light, MetricValues};
use splitsum::study::frame::Frame;
use splitsum::study::questions::{Finding, question};
use splitsum::study::table::{Table, shown};

/// f64 arithmetic of a few logarithms.
pub const F64: f64 = 1e-9;

/// Rows with values on some axes; the others have their defaults.
pub struct Paper {
    axes: &'static [&'static str],
    pub run: Finished,
}

impl Paper {
    pub fn new(axes: &'static [&'static str]) -> Self {
        let run = Finished {
            dir: "paper".into(),
            provenance: serde_json::json!({ "name": "paper", "sessions": [] }),
            experiment: String::new(),
            config: None,
            cells: Vec::new(),
            lights: Vec::new(),
            timings: Vec::new(),
            failures: Vec::new(),
            is_under_way: false,
        };
        Self { axes, run }
    }

    /// A cell with this error in the headline metric, far above its noise; an empty text leaves an axis unset.
    pub fn add(&mut self, values: &[&str], error: f64) -> &mut FinishedCell {
        assert_eq!(values.len(), self.axes.len());
        let mut point = Point::default();
        for (name, text) in self.axes.iter().zip(values) {
            let axis = AXES.iter().find(|axis| axis.name == *name).unwrap_or_else(|| panic!("no axis {name}"));
            point.set(name, if text.is_empty() { Value::Unset } else { axis.kind.parse_text(text).unwrap() });
        }
        self.run.cells.push(FinishedCell {
            id: format!("{:04x}", self.run.cells.len()),
            point,
            scores: Some(MetricValues::of(|name| (name == HEADLINE).then_some(error))),
            noise_floors: MetricValues::of(|name| (name == HEADLINE).then_some(1e-9)),
            bias_variance: None,
            reference: None,
            bins: Vec::new(),
            images: None,
        });
        self.run.cells.last_mut().unwrap()
    }

    /// The light of builtin:sky clipped to this many stops.
    pub fn clip(&mut self, clip: &str, stops: f64) {
        let (environment, clip_log2) = ("builtin:sky".to_owned(), clip.to_owned());
        let light = Light { environment, clip_log2, mean: 1.0, peak: stops.exp2(), range_stops: Some(stops) };
        self.run.lights.push(light);
    }

    /// What the run lacks for a question.
    pub fn lacks(&self, name: &str) -> Option<&'static str> {
        (question(name).unwrap().lacks)(&Frame::new(&self.run, None).shape)
    }

    /// The answer to a question.
    pub fn finding(&self, name: &str) -> Finding {
        assert_eq!(self.lacks(name), None, "{name}");
        let question = question(name).unwrap_or_else(|| panic!("no question {name}"));
        let frame = Frame::new(&self.run, None);
        (question.answer)(&frame).unwrap_or_else(|| panic!("{name} is not answered"))
    }
}

/// Bins of a third each, with these values in a metric.
pub fn bins(metric: &str, values: &[f64]) -> Vec<Bin> {
    let width = 1.0 / values.len() as f64;
    let bin = |(i, value): (usize, &f64)| Bin {
        lo: i as f64 * width,
        hi: (i + 1) as f64 * width,
        pixel_count: 100,
        scores: MetricValues::of(|name| (name == metric).then_some(*value)),
    };
    values.iter().enumerate().map(bin).collect()
}

/// The cells of a column, as people read them.
pub fn column(table: &Table, name: &str) -> Vec<String> {
    let place = table.columns.iter().position(|column| column == name);
    let place = place.unwrap_or_else(|| panic!("no column {name} in {:?}", table.columns));
    table.rows.iter().map(|row| shown(&row[place])).collect()
}

/// The numbers of a column; NaN for an empty cell.
pub fn numbers(table: &Table, name: &str) -> Vec<f64> {
    use splitsum::table::csv::Cell;
    let place = table.columns.iter().position(|column| column == name);
    let place = place.unwrap_or_else(|| panic!("no column {name} in {:?}", table.columns));
    let number = |row: &Vec<Cell>| match &row[place] {
        Cell::Number(x) => *x,
        Cell::Integer(n) => *n as f64,
        Cell::Missing => f64::NAN,
        Cell::Text(text) => panic!("{name}: {text} is no number"),
    };
    table.rows.iter().map(number).collect()
}

/// The rows whose cells in these columns read so.
pub fn only(table: &Table, wanted: &[(&str, &str)]) -> Table {
    let columns: Vec<Vec<String>> = wanted.iter().map(|(name, _)| column(table, name)).collect();
    let is_it = |i: &usize| columns.iter().zip(wanted).all(|(column, (_, text))| column[*i] == *text);
    let rows = (0..table.rows.len()).filter(is_it).map(|i| table.rows[i].clone()).collect();
    Table { columns: table.columns.clone(), rows }
}
