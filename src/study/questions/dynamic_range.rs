//! How does the error grow with the dynamic range of the environment?
//!
//! The range is log2 of peak over mean luminance, in stops. `environment_clip_log2` cuts the peaks of one environment off at 2 to a power,
//! for a method and its reference alike, so that nothing but the peaks changes: each environment is a series of its own, at each alpha by
//! itself. Two environments differ in more than their range and make no trend. Over everything else the error is a geometric mean.
//!
//! The growth is the error at the widest range over that at the narrowest. The factor a stop is exp of the least-squares slope of
//! ln e over stops; it describes the path only where that is a line, and errors saturate: the range from which a series is level is
//! the first from which on its errors lie within a factor of [`LEVEL`], over at least [`LEVEL_SHARE`] of the range.

use super::prelude::*;
use crate::study::frame::line::Line;

pub const QUESTION: Question = Question {
    name: "dynamic-range",
    asks: "How does the error grow with the dynamic range of the environment?",
    columns: &[
        column("range_stops", "Dynamic range of the clipped environment: log2 of peak over mean luminance."),
        column("n", "Images behind the error."),
        column("error", "Error in the metric of the question, geometric mean over the images."),
    ],
    uses_times: false,
    uses_costs: false,
    lacks,
    answer,
};

/// Errors that lie within this factor of each other count as level.
const LEVEL: f64 = 1.5;
/// Over this share of the range at least: two neighbours are always close.
const LEVEL_SHARE: f64 = 1.0 / 3.0;
/// What makes a light.
const CONDITION: [usize; 2] = [ENVIRONMENT, ALPHA];

fn lacks(shape: &Shape) -> Option<&'static str> {
    (!shape.is_swept(ENVIRONMENT_CLIP)).then_some("axes.environment_clip_log2 has fewer than two clips")
}

/// A method in one light at one alpha, with lower and lower peaks.
struct Path<'r, 'f> {
    method: String,
    /// Environment and alpha.
    condition: Key,
    /// Ascending by range.
    points: Vec<Point<'r, 'f>>,
}

struct Point<'r, 'f> {
    range: f64,
    error: f64,
    rows: Vec<&'r Row<'f>>,
}

/// Those of two ranges or more, methods without samples first.
fn paths<'r, 'f>(frame: &'r Frame<'f>) -> Vec<Path<'r, 'f>> {
    let rows = frame.images().into_iter().filter(|row| !frame.is_nothing(row) && row.range_stops.is_some());
    let mut groups = grouped(rows, |row| (frame.way(row), row.key(&CONDITION)));
    groups.sort_by_key(|(_, rows)| rows[0].samples().is_some());
    let path = |((method, condition), rows): ((String, Key), Vec<&'r Row<'f>>)| {
        let point = |(range, rows): (u64, Vec<&'r Row<'f>>)| {
            let error = geometric_mean(&rows.iter().filter_map(|row| frame.error(row)).collect::<Vec<_>>());
            error.is_finite().then_some(Point { range: f64::from_bits(range), error, rows })
        };
        let by_range = grouped(rows, |row| row.range_stops.unwrap_or(f64::NAN).to_bits());
        let mut points: Vec<Point> = by_range.into_iter().filter_map(point).collect();
        points.sort_by(|a, b| a.range.total_cmp(&b.range));
        Path { method, condition, points }
    };
    groups.into_iter().map(path).filter(|path| path.points.len() > 1).collect()
}

impl Path<'_, '_> {
    fn ends(&self) -> [&Point<'_, '_>; 2] {
        [&self.points[0], &self.points[self.points.len() - 1]]
    }

    fn growth(&self) -> f64 {
        let [first, last] = self.ends();
        last.error / first.error
    }

    /// Factor of the error for each stop; `None` for fewer than three ranges.
    fn factor_a_stop(&self) -> Option<f64> {
        let logs: Vec<[f64; 2]> = self.points.iter().map(|point| [point.range, point.error.ln()]).collect();
        Line::of(&logs).map(|line| line.slope.exp()).filter(|factor| factor.is_finite())
    }

    /// The range from which on the error is level.
    fn level_from(&self) -> Option<f64> {
        let [first, last] = self.ends();
        let is_level = |points: &[Point]| {
            let errors = || points.iter().map(|point| point.error);
            errors().fold(0.0, f64::max) <= LEVEL * errors().fold(f64::INFINITY, f64::min)
        };
        let is_long = |point: &Point| last.range - point.range >= LEVEL_SHARE * (last.range - first.range);
        let from = (0..self.points.len()).find(|&i| is_long(&self.points[i]) && is_level(&self.points[i..]))?;
        Some(self.points[from].range)
    }
}

fn answer(frame: &Frame) -> Option<Finding> {
    let paths = paths(frame);
    let lead = &paths.first()?.method;
    let axes = [&frame.way_axes()[..], &[ENVIRONMENT, ENVIRONMENT_CLIP, ALPHA]].concat();
    let mut table = Table::new(&axes, QUESTION.columns);
    for point in paths.iter().flat_map(|path| &path.points) {
        table.row([point.rows[0].cells(&axes), cells![point.range, point.rows.len(), point.error]].concat());
    }
    let own: Vec<&Path> = paths.iter().filter(|path| path.method == *lead).collect();
    let growths = growths(&own);
    let (sentence, digest) = match growths.is_summed() {
        true => (summed(frame, &growths, lead), by_method(frame, &paths)),
        false => (sentence(frame, &own), digest(&paths)),
    };
    Some(Finding { sentence, table, digest: Some(digest), figure: figure(frame, &paths, growths.is_summed()) })
}

/// The factor between the errors at the ends of each path.
fn growths<'r, 'f>(paths: &[&Path<'r, 'f>]) -> Numbers<'r, 'f> {
    Numbers::new(paths.iter().map(|path| (path.points[0].rows[0], path.growth())), Middle::Median)
}

/// The growth of many environments, at the ends of the alphas.
fn summed(frame: &Frame, growths: &Numbers, lead: &str) -> String {
    let alphas = growths.values(ALPHA);
    let ends = [alphas.first(), alphas.last().filter(|_| alphas.len() > 1)].into_iter().flatten();
    let mut told = ends.filter_map(|alpha| {
        let at = label(&[ALPHA], std::slice::from_ref(alpha));
        let growth = growths.at(ALPHA, alpha).estimate()?;
        let growth = format!("grows **{} times**{}", number(growth.value), interval_words(&growth, number));
        Some((at, growth))
    });
    let metric = frame.metric_name();
    let (at, growth) = told.next().unwrap_or_default();
    let at = if at.is_empty() { at } else { format!(" at {at}") };
    let first =
        format!("From the lowest clip to none the `{metric}` of `{lead}` {growth}{at}, in the median environment.");
    let rest = told.map(|(at, growth)| format!(" At {at} it {growth}."));
    std::iter::once(first).chain(rest).chain([growths.scope(&[ENVIRONMENT, ALPHA])]).collect()
}

/// The growth of each method by alpha.
fn by_method(frame: &Frame, paths: &[Path]) -> Table {
    let mut rows: Vec<(Vec<Cell>, Numbers)> = Vec::new();
    for (method, own) in grouped(paths, |path| path.method.clone()) {
        let own = growths(&own);
        let row =
            |alpha: &Value| (cells![method.as_str(), short(ALPHA, alpha), roughness(alpha)], own.at(ALPHA, alpha));
        rows.extend(own.values(ALPHA).iter().map(row));
    }
    let words = |growth: &Estimate| format!("{}×", number(growth.value)) + &interval_words(growth, number);
    by_light(frame, &[AXES[METHOD].name, AXES[ALPHA].name, ROUGHNESS], &rows, &words)
}

/// Environments of a sentence; the digest has all.
const TOLD: usize = 3;

/// One sentence an environment, at the ends of the alphas.
fn sentence(frame: &Frame, paths: &[&Path]) -> String {
    let say = |(light, own): (Value, Vec<&&Path>)| {
        let alphas = ascending(own.iter().map(|path| path.condition[1].clone()).collect());
        let ends = [alphas.first(), alphas.last().filter(|_| alphas.len() > 1)];
        let told = ends.into_iter().flatten().filter_map(|alpha| own.iter().find(|path| path.condition[1] == *alpha));
        let mut metric = format!("{} ", frame.metric_name());
        let way = |path: &&&Path| {
            let [first, last] = path.ends().map(|point| number(point.error));
            let at = label(&[ALPHA], &path.condition[1..]);
            let at = if at.is_empty() { at } else { format!(" at {at}") };
            format!("from {}{first} to {last}{at}", std::mem::take(&mut metric))
        };
        let ways: Vec<String> = told.map(way).collect();
        let [from, to] = own[0].ends().map(|point| number(point.range));
        let (light, method) = (short(ENVIRONMENT, &light), &own[0].method);
        format!("In {light}, {from} to {to} stops, `{method}` goes {}.", ways.join(", "))
    };
    let lights = grouped(paths, |path| path.condition[0].clone()).into_iter();
    lights.take(TOLD).map(say).collect::<Vec<_>>().join(" ")
}

/// One row a method, environment and alpha.
fn digest(paths: &[Path]) -> Table {
    let mut table = Table::with_names([
        AXES[METHOD].name,
        AXES[ENVIRONMENT].name,
        AXES[ALPHA].name,
        "from stops",
        "to stops",
        "error there",
        "error here",
        "growth",
        "factor a stop",
        "level from stops",
    ]);
    for path in paths {
        let [light, alpha] = [0, 1].map(|i| short(CONDITION[i], &path.condition[i]));
        let [first, last] = path.ends();
        let mut row = cells![path.method.as_str(), light, alpha, first.range, last.range, first.error, last.error];
        row.extend(cells![path.growth(), path.factor_a_stop(), path.level_from()]);
        table.row(row);
    }
    table
}

/// One panel an environment and alpha, one line a method; of many environments one panel a method and alpha, one line an environment.
fn figure(frame: &Frame, paths: &[Path], is_summed: bool) -> Option<Figure> {
    let methods = distinct_in_order(paths.iter().map(|path| path.method.clone()));
    let line = |path: &&Path| {
        let series = methods.iter().position(|method| *method == path.method).unwrap_or(0);
        let dots = path.points.iter().map(|point| {
            let light = short(ENVIRONMENT, &path.condition[0]);
            let tip = format!("{} · {light} · {} stops: {}", path.method, number(point.range), number(point.error));
            Mark { cell: only(&point.rows), ..Mark::new(Form::Dot([point.range, point.error]), series).tip(tip) }
        });
        joined(dots.collect())
    };
    let title = |path: &&Path| match is_summed {
        true => format!("{} · {}", path.method, label(&[ALPHA], &path.condition[1..])),
        false => label(&CONDITION, &path.condition),
    };
    let panel = |(title, own): (String, Vec<&Path>)| (title, own.iter().flat_map(line).collect());
    let mut shown: Vec<&Path> = paths.iter().collect();
    if is_summed {
        shown.sort_by_key(|path| methods.iter().position(|method| *method == path.method));
    }
    Chart {
        title: "Error over the dynamic range of the environment",
        note: format!(
            "{}; the same light with its peaks cut off{}",
            frame.metric_name(),
            if is_summed { "; each line is an environment" } else { "" }
        ),
        x: Along::Linear("dynamic range, stops"),
        y: Along::Log(frame.metric_name()),
        panels: grouped(shown, title).into_iter().map(panel).collect(),
        series: methods.clone(),
    }
    .figure()
}
