//! Which tables does one ship: from which size on does no larger one err less?
//!
//! For two values a < b of an axis of the tables, with all else equal, let c(a, b) = e(a) / e(b) be what the smaller one costs; the larger
//! one gains 1 - 1/c. A *condition* is one alpha in one environment; over the rest c is the geometric mean. A value is *enough* where no
//! larger one gains more than [`GAIN`], in every condition by itself: a loss in one light is not made up by a gain in another.
//!
//! An axis is judged where the other axes of the tables stand at their base, the first value in the experiment, or above: beside a table
//! that is too small in one way, making it smaller in another costs nothing. What is shipped is the smallest tried combination of values
//! that are all enough. Pairs of which both errors are within the reference's noise tell nothing and are left out.

use super::words::{label, listed, number, percent, said, short};
use super::{Finding, Question};
use crate::runner::axis::{AXES, Part};
use crate::runner::value::Value;
use crate::study::figure::{Figure, Mark, Panel, Scale, Series, Shape as Form};
use crate::study::frame::estimate::geometric_mean;
use crate::study::frame::{Frame, Key, Row, Shape, ascending, axis, distinct_in_order, pair, size_of};
use crate::study::table::{Column, Table, value_cell};
use crate::table::csv::Cell;

pub const QUESTION: Question = Question {
    name: "table-size",
    asks: "Which tables does one ship: from which size on does no larger one err less?",
    columns: &[
        Column { name: "axis", about: "The axis of the tables that the two values are of." },
        Column { name: "value", about: "The smaller value." },
        Column { name: "against", about: "The larger value." },
        Column { name: "n", about: "Pairs of cells behind the ratio, which differ in this axis alone." },
        Column {
            name: "ratio",
            about: "Error with the smaller value over that with the larger one, geometric mean of the pairs.",
        },
        Column {
            name: "is_enough",
            about: "1 where in this condition no larger value gains more than 5 % over the smaller one, else 0.",
        },
    ],
    uses_times: false,
    lacks,
    answer,
};

/// A larger table that takes no more than this share off the error gains nothing.
pub const GAIN: f64 = 0.05;

fn lacks(shape: &Shape) -> Option<&'static str> {
    let has = |axis: &usize| AXES[*axis].part == Part::Table && Parameter::new(*axis, &shape.values[*axis]).is_some();
    let is_served = (0..AXES.len()).any(|axis| has(&axis));
    (!is_served).then_some("axes has no size or count of a table with two values")
}

/// A swept axis of the tables with its values, ascending.
struct Parameter {
    axis: usize,
    values: Vec<Value>,
    /// Size of the first value in the experiment.
    base: f64,
}

impl Parameter {
    fn new(axis: usize, values: &[Value]) -> Option<Self> {
        let base = size_of(values.first()?)?;
        let has_order = values.len() > 1 && values.iter().all(|value| size_of(value).is_some());
        has_order.then(|| Self { axis, values: ascending(values.to_vec()), base })
    }
}

/// What the smaller of two values costs in one condition.
struct Cost {
    axis: usize,
    /// The method that looks the tables up, in words and as cells of the table.
    method: String,
    way: Vec<Cell>,
    value: Value,
    against: Value,
    /// Alpha and environment.
    condition: Key,
    /// Error with the smaller value over that with the larger one.
    ratio: f64,
    n: usize,
}

impl Cost {
    /// What the larger value takes off the error.
    fn gain(&self) -> f64 {
        1.0 - 1.0 / self.ratio
    }
}

/// The axes whose values make a condition.
fn condition_axes() -> [usize; 2] {
    ["alpha", "environment"].map(axis)
}

fn costs(frame: &Frame, parameters: &[Parameter]) -> Vec<Cost> {
    let images = frame.images();
    let mut found: Vec<Cost> = Vec::new();
    for own in parameters {
        let is_large =
            |row: &Row, other: &Parameter| size_of(&row.point.0[other.axis]).is_none_or(|size| size >= other.base);
        let is_beside_large =
            |row: &&&Row| parameters.iter().all(|other| other.axis == own.axis || is_large(row, other));
        let rows: Vec<&Row> = images.iter().filter(is_beside_large).copied().collect();
        for against in &own.values {
            type Group = ((Value, String, Key), Vec<Cell>, Vec<f64>);
            let mut groups: Vec<Group> = Vec::new();
            for (row, base) in pair(&rows, own.axis, against) {
                let value = &row.point.0[own.axis];
                let ratio = frame.error(row).zip(frame.error(base)).map(|(of_row, of_base)| of_row / of_base);
                let tells = frame.is_resolved(row) || frame.is_resolved(base);
                let ratio = ratio.filter(|ratio| tells && ratio.is_finite() && *ratio > 0.0);
                let (true, Some(ratio)) = (size_of(value) < size_of(against), ratio) else { continue };
                let key = (value.clone(), frame.way(row), row.key(&condition_axes()));
                match groups.iter_mut().find(|(known, ..)| *known == key) {
                    Some((.., ratios)) => ratios.push(ratio),
                    None => groups.push((key, row.cells(&frame.way_axes()), vec![ratio])),
                }
            }
            found.extend(groups.into_iter().map(|((value, method, condition), way, ratios)| Cost {
                axis: own.axis,
                method,
                way,
                value,
                against: against.clone(),
                condition,
                ratio: geometric_mean(&ratios),
                n: ratios.len(),
            }));
        }
    }
    found
}

/// The values of an axis, of those in these pairs, that are enough in all their conditions, ascending. The largest always is.
fn enough<'c>(costs: &[&'c Cost]) -> Vec<&'c Value> {
    let mut tried: Vec<&Value> = distinct_in_order(costs.iter().flat_map(|cost| [&cost.value, &cost.against]));
    tried.sort_by(|a, b| size_of(a).partial_cmp(&size_of(b)).unwrap_or(std::cmp::Ordering::Equal));
    tried.retain(|value| costs.iter().filter(|cost| cost.value == **value).all(|cost| cost.gain() <= GAIN));
    tried
}

/// One axis of the tables of one method.
#[derive(Clone)]
struct Verdict<'c> {
    axis: usize,
    /// Of this axis and method.
    costs: Vec<&'c Cost>,
    /// The smallest value that is enough in every condition.
    least: Value,
    /// The value of the smallest tried combination in which every value is enough.
    shipped: Value,
}

impl<'c> Verdict<'c> {
    /// The pair with a larger value that gains most over the shipped one.
    fn beyond(&self) -> Option<&'c Cost> {
        let larger = self.costs.iter().copied().filter(|cost| cost.value == self.shipped);
        larger.max_by(|a, b| a.ratio.total_cmp(&b.ratio))
    }

    /// Of the next smaller value, the condition in which it costs most over the shipped one.
    fn below(&self) -> Option<&'c Cost> {
        let smaller = || self.costs.iter().copied().filter(|cost| cost.against == self.shipped);
        let next =
            smaller().map(|cost| size_of(&cost.value)).fold(None, |most, size| if size > most { size } else { most });
        smaller().filter(|cost| size_of(&cost.value) == next).max_by(|a, b| a.ratio.total_cmp(&b.ratio))
    }

    /// The smallest value that is enough at this alpha.
    fn least_at(&self, alpha: &Value) -> Option<&'c Value> {
        let own: Vec<&'c Cost> = self.costs.iter().copied().filter(|cost| cost.condition[0] == *alpha).collect();
        enough(&own).first().copied()
    }
}

/// The verdicts of one method, in the order of the axes.
fn verdicts<'c>(frame: &Frame, parameters: &[Parameter], costs: &'c [Cost], method: &str) -> Vec<Verdict<'c>> {
    let of = |axis: usize| -> Vec<&Cost> {
        costs.iter().filter(|cost| cost.axis == axis && cost.method == method).collect()
    };
    let own: Vec<(usize, Vec<&Cost>)> =
        parameters.iter().map(|one| (one.axis, of(one.axis))).filter(|(_, costs)| !costs.is_empty()).collect();
    let axes: Vec<usize> = own.iter().map(|(axis, _)| *axis).collect();
    let sets: Vec<Vec<&Value>> = own.iter().map(|(_, costs)| enough(costs)).collect();
    let rows = frame.images().into_iter().filter(|row| frame.way(row) == method);
    let keys =
        rows.map(|row| row.key(&axes)).filter(|key| key.iter().zip(&sets).all(|(value, set)| set.contains(&value)));
    let product = |key: &Key| key.iter().filter_map(size_of).product::<f64>();
    let smallest = keys.min_by(|a, b| product(a).total_cmp(&product(b)));
    own.into_iter()
        .zip(sets)
        .enumerate()
        .filter_map(|(i, ((axis, costs), set))| {
            let least = (*set.first()?).clone();
            let shipped = smallest.as_ref().map_or_else(|| least.clone(), |key| key[i].clone());
            Some(Verdict { axis, costs, least, shipped })
        })
        .collect()
}

fn answer(frame: &Frame) -> Option<Finding> {
    let swept = frame.swept(&[Part::Table]).into_iter();
    let parameters: Vec<Parameter> = swept.filter_map(|axis| Parameter::new(axis, &frame.shape.values[axis])).collect();
    let costs = costs(frame, &parameters);
    let methods = distinct_in_order(costs.iter().map(|cost| cost.method.clone()));
    let all: Vec<(String, Vec<Verdict>)> = methods
        .into_iter()
        .map(|method| {
            let found = verdicts(frame, &parameters, &costs, &method);
            (method, found)
        })
        .collect();
    let (method, lead) = all.first()?;
    Some(Finding {
        sentence: sentence(frame, method, lead),
        table: table(frame, &costs),
        digest: Some(digest(&all)),
        figure: figure(frame, method, lead),
    })
}

/// Alphas of the pairs, ascending; none where they have none.
fn alphas(verdicts: &[Verdict]) -> Vec<Value> {
    let all = verdicts.iter().flat_map(|one| &one.costs).map(|cost| cost.condition[0].clone());
    ascending(distinct_in_order(all.filter(|alpha| *alpha != Value::Unset)))
}

fn sentence(frame: &Frame, method: &str, verdicts: &[Verdict]) -> String {
    let shipped: Vec<String> = verdicts.iter().map(|one| said(one.axis, &one.shipped)).collect();
    let mut text = format!("Ship {} for `{method}`.", shipped.join(", "));
    let gain = verdicts.iter().filter_map(|one| one.beyond()).max_by(|a, b| a.ratio.total_cmp(&b.ratio));
    let loss = verdicts.iter().filter_map(|one| one.below()).max_by(|a, b| a.ratio.total_cmp(&b.ratio));
    let gain = match gain {
        None => "No larger ones were tried".to_owned(),
        Some(cost) if cost.gain() <= 0.0 => format!("Larger tables gain nothing in {}", frame.metric_name()),
        Some(cost) => format!("Larger tables gain at most {} in {}", percent(cost.gain()), frame.metric_name()),
    };
    let loss = loss.filter(|cost| cost.ratio > 1.0).map(|cost| {
        let place = label(&condition_axes(), &cost.condition);
        let place = if place.is_empty() { place } else { format!(" ({place})") };
        format!("; {} cost up to {}{place}", said(cost.axis, &cost.value), percent(cost.ratio - 1.0))
    });
    text += &format!(" {gain}{}.", loss.unwrap_or_default());
    text + &by_alpha(verdicts)
}

/// Where alphas need different tables: those that need least.
fn by_alpha(verdicts: &[Verdict]) -> String {
    let needs = |alpha: &Value| -> Vec<Option<&Value>> { verdicts.iter().map(|one| one.least_at(alpha)).collect() };
    let all: Vec<(Value, Vec<Option<&Value>>)> =
        alphas(verdicts).into_iter().map(|alpha| (alpha.clone(), needs(&alpha))).collect();
    let differing: Vec<usize> =
        (0..verdicts.len()).filter(|&i| all.iter().any(|(_, key)| key[i] != all[0].1[i])).collect();
    let size = |key: &[Option<&Value>]| differing.iter().filter_map(|&i| size_of(key[i]?)).product::<f64>();
    let Some((_, least)) =
        all.iter().min_by(|a, b| size(&a.1).total_cmp(&size(&b.1))).filter(|_| !differing.is_empty())
    else {
        return String::new();
    };
    let own: Vec<String> =
        all.iter().filter(|(_, key)| key == least).map(|(alpha, _)| short(axis("alpha"), alpha)).collect();
    let words: Vec<String> = differing.iter().filter_map(|&i| Some(said(verdicts[i].axis, least[i]?))).collect();
    format!(" At alpha {} {} would do.", listed(&own), listed(&words))
}

fn table(frame: &Frame, costs: &[Cost]) -> Table {
    let mut table = Table::new(&[frame.way_axes(), condition_axes().to_vec()].concat(), QUESTION.columns);
    for cost in costs {
        let is_rival = |other: &&Cost| {
            (other.axis, &other.method, &other.value, &other.condition)
                == (cost.axis, &cost.method, &cost.value, &cost.condition)
        };
        let is_enough = costs.iter().filter(is_rival).all(|other| other.gain() <= GAIN);
        let mut row = cost.way.clone();
        row.extend(cost.condition.iter().map(value_cell));
        row.push(AXES[cost.axis].name.into());
        row.extend([&cost.value, &cost.against].map(|value| Cell::Text(value.to_string())));
        row.extend([Cell::Integer(cost.n as u64), cost.ratio.into(), Cell::Integer(is_enough.into())]);
        table.row(row);
    }
    table
}

/// One row an axis: what to ship, what more gains, what less costs, what each alpha needs.
fn digest(all: &[(String, Vec<Verdict>)]) -> Table {
    let alphas = alphas(&all.iter().flat_map(|(_, verdicts)| verdicts).cloned().collect::<Vec<_>>());
    let names =
        ["table", "method", "ship", "enough alone", "larger gains at most", "next smaller", "costs up to", "where"];
    let of_alphas = alphas.iter().map(|alpha| format!("alpha {}", short(axis("alpha"), alpha)));
    let mut table = Table::with_names(names.map(str::to_owned).into_iter().chain(of_alphas).collect());
    for (method, verdict) in all.iter().flat_map(|(method, verdicts)| verdicts.iter().map(move |one| (method, one))) {
        let value = |value: &Value| said(verdict.axis, value);
        let (beyond, below) = (verdict.beyond(), verdict.below());
        let gain = beyond.map_or("no larger one tried".to_owned(), |cost| percent(cost.gain().max(0.0)));
        let mut row = vec![
            AXES[verdict.axis].name.to_owned(),
            method.clone(),
            value(&verdict.shipped),
            value(&verdict.least),
            gain,
        ];
        row.push(below.map_or("none tried".to_owned(), |cost| value(&cost.value)));
        row.push(below.map_or(String::new(), |cost| percent(cost.ratio - 1.0)));
        row.push(below.map_or(String::new(), |cost| label(&condition_axes(), &cost.condition)));
        row.extend(alphas.iter().map(|alpha| verdict.least_at(alpha).map_or(String::new(), &value)));
        table.row(row.into_iter().map(Cell::Text).collect());
    }
    table
}

/// One panel an axis: the error over that with the shipped value, one line an alpha and environment.
fn figure(frame: &Frame, method: &str, verdicts: &[Verdict]) -> Option<Figure> {
    let alphas = alphas(verdicts);
    let mut panels = Vec::new();
    for verdict in verdicts {
        let of_condition = |condition: &Key| -> Vec<(Value, f64)> {
            let own = || verdict.costs.iter().filter(|cost| cost.condition == *condition);
            let smaller =
                own().filter(|cost| cost.against == verdict.shipped).map(|cost| (cost.value.clone(), cost.ratio));
            let larger =
                own().filter(|cost| cost.value == verdict.shipped).map(|cost| (cost.against.clone(), 1.0 / cost.ratio));
            let mut points: Vec<(Value, f64)> = smaller.chain([(verdict.shipped.clone(), 1.0)]).chain(larger).collect();
            points.sort_by(|a, b| size_of(&a.0).partial_cmp(&size_of(&b.0)).unwrap_or(std::cmp::Ordering::Equal));
            points
        };
        let conditions = distinct_in_order(verdict.costs.iter().map(|cost| cost.condition.clone()));
        let curves: Vec<(&Key, Vec<(Value, f64)>)> =
            conditions.iter().map(|condition| (condition, of_condition(condition))).collect();
        let steps = ascending(distinct_in_order(
            curves.iter().flat_map(|(_, curve)| curve.iter().map(|point| point.0.clone())),
        ));
        let mut marks = vec![Mark::neutral(Form::HorizontalRule(1.0))];
        for (condition, curve) in &curves {
            let series = alphas.iter().position(|alpha| *alpha == condition[0]).unwrap_or(0);
            let place = |value: &Value| steps.iter().position(|step| step == value).unwrap_or(0) as f64;
            let points: Vec<[f64; 2]> = curve.iter().map(|(value, ratio)| [place(value), *ratio]).collect();
            marks.push(Mark::new(Form::Line(points), series));
            for (value, ratio) in curve {
                let tip = format!(
                    "{} · {}: {}",
                    label(&condition_axes(), condition),
                    said(verdict.axis, value),
                    number(*ratio)
                );
                marks.push(Mark::new(Form::Dot([place(value), *ratio]), series).tip(tip));
            }
        }
        let ratios = curves.iter().flat_map(|(_, curve)| curve.iter().map(|point| point.1));
        panels.push(Panel {
            title: AXES[verdict.axis].name.to_owned(),
            x: Scale::steps("", steps.iter().map(|value| short(verdict.axis, value)).collect()),
            y: Scale::log("error over that of the shipped table", ratios)?,
            marks,
        });
    }
    let series = match alphas.is_empty() {
        true => vec!["all".to_owned()],
        false => alphas.iter().map(|alpha| label(&[axis("alpha")], std::slice::from_ref(alpha))).collect(),
    };
    let shared: Vec<Value> = verdicts.iter().map(|one| one.shipped.clone()).collect();
    let axes: Vec<usize> = verdicts.iter().map(|one| one.axis).collect();
    Some(Figure {
        title: "What smaller tables cost".to_owned(),
        note: format!(
            "{}, `{method}`; shipped: {}; one line an alpha and environment",
            frame.metric_name(),
            label(&axes, &shared)
        ),
        panels,
        series: series.into_iter().map(|name| Series { name, is_dashed: false }).collect(),
        ramp: None,
    })
}
