//! Which tables does one ship: from which size on does no larger one err less?
//!
//! A *combination* is one value of each swept size and count of the tables. Only combinations that were tried are compared, and only with
//! *larger* ones, of which no value is smaller: a small table may err less by luck, where its fault and another cancel. A *condition* is one
//! setting of everything else. A combination with error e is *enough* where no larger one, with error e', gains more than [`GAIN`] in any
//! condition: 1 - e'/e. A loss in one light is not made up by a gain in another. Pairs of which both errors are within the reference's
//! noise tell nothing.
//!
//! Shipped is the smallest combination that is enough, by the sum over its tables of texels times levels times samples.

use super::prelude::*;
use crate::runner::value::Kind;

pub const QUESTION: Question = Question {
    name: "table-size",
    asks: "Which tables does one ship: from which size on does no larger one err less?",
    columns: &[
        column("larger", "The larger tables that err least; empty where none stand clear of the noise."),
        column("ratio", "Error over that with those; 1 where no larger ones err less."),
        column("is_enough", "1 where the larger ones gain no more than 5 % in this condition, else 0."),
    ],
    uses_times: false,
    lacks,
    answer,
};

/// Larger tables that take no more than this share off the error gain nothing.
pub const GAIN: f64 = 0.05;

fn lacks(shape: &Shape) -> Option<&'static str> {
    parameters(shape).is_empty().then_some("axes has no size or count of a table with two values")
}

/// The swept sizes and counts of tables.
fn parameters(shape: &Shape) -> Vec<usize> {
    let is_size = |axis: usize| matches!(AXES[axis].kind, Kind::Count { .. } | Kind::Pair { .. });
    let has_size = |axis: usize| is_size(axis) && shape.values[axis].iter().all(|value| size_of(value).is_some());
    (0..AXES.len()).filter(|&axis| AXES[axis].part == Part::Table && shape.is_swept(axis) && has_size(axis)).collect()
}

/// One combination in one condition.
struct Tried<'r, 'f> {
    row: &'r Row<'f>,
    /// Values of the parameters.
    tables: Key,
    /// Everything else.
    condition: Key,
    error: f64,
    /// The larger combination with the least error, and the error over that.
    larger: Option<(Key, f64)>,
}

impl Tried<'_, '_> {
    fn gain(&self) -> f64 {
        self.larger.as_ref().map_or(0.0, |(_, ratio)| 1.0 - 1.0 / ratio)
    }
}

fn is_larger(a: &Key, b: &Key) -> bool {
    a != b && a.iter().zip(b).all(|(a, b)| size_of(a) >= size_of(b))
}

/// Texels times levels times samples, over the tables that the parameters feed.
fn size(parameters: &[usize], tables: &Key) -> f64 {
    let by_table = grouped(parameters.iter().zip(tables), |(axis, _)| AXES[**axis].feeds);
    by_table.iter().map(|(_, own)| own.iter().filter_map(|(_, value)| size_of(value)).product::<f64>()).sum()
}

/// By method.
fn tried<'r, 'f>(frame: &Frame, images: &[&'r Row<'f>], parameters: &[usize]) -> Vec<(String, Vec<Tried<'r, 'f>>)> {
    let others: Vec<usize> =
        (0..AXES.len()).filter(|of| AXES[*of].changes_radiance() && !parameters.contains(of)).collect();
    let one = |&row: &&'r Row<'f>| {
        let (tables, condition) = (row.key(parameters), row.key(&others));
        let error = frame.error(row).filter(|error| error.is_finite() && *error > 0.0)?;
        let is_asked = tables.iter().any(|value| *value != Value::Unset);
        is_asked.then_some(Tried { row, tables, condition, error, larger: None })
    };
    let mut all: Vec<Tried> = images.iter().filter_map(one).collect();
    let best = |one: &Tried| {
        let is_rival = |other: &&Tried| {
            let tells = frame.is_resolved(one.row) || frame.is_resolved(other.row);
            tells && other.condition == one.condition && is_larger(&other.tables, &one.tables)
        };
        let best = all.iter().filter(is_rival).min_by(|a, b| a.error.total_cmp(&b.error))?;
        Some((best.tables.clone(), f64::max(1.0, one.error / best.error)))
    };
    let found: Vec<_> = all.iter().map(best).collect();
    all.iter_mut().zip(found).for_each(|(one, larger)| one.larger = larger);
    grouped(all, |one| frame.way(one.row))
}

/// What is shipped in some conditions.
struct Shipped {
    tables: Key,
    /// What the larger combination takes off the error, in the condition where it takes most; none where no larger one was tried.
    gain: Option<f64>,
    /// The next smaller combination, its error over that of the shipped one where that is most, and that condition in words.
    smaller: Option<(Key, f64, String)>,
}

/// The smallest combination that was tried and is enough in all conditions of these rows.
fn shipped(parameters: &[usize], scope: &[usize], own: &[&Tried]) -> Option<Shipped> {
    let conditions = grouped(own, |one| one.condition.clone()).len();
    let by_tables = grouped(own.iter().copied(), |one| one.tables.clone());
    let size = |tables: &Key| size(parameters, tables);
    let most = |own: &[&Tried]| own.iter().map(|one| one.gain()).fold(0.0, f64::max);
    let enough = by_tables.iter().filter(|(_, own)| own.len() == conditions && most(own) <= GAIN);
    let (tables, best) = enough.min_by(|a, b| size(&a.0).total_cmp(&size(&b.0)))?;
    let smaller = by_tables.iter().filter(|(other, _)| is_larger(tables, other));
    let cost = |(other, own): &(Key, Vec<&Tried>)| {
        let base = |one: &Tried| best.iter().find(|base| base.condition == one.condition).map(|base| base.error);
        let ratios = own.iter().filter_map(|one| Some((one.error / base(one)?, one.row)));
        let (ratio, row) = ratios.max_by(|a, b| a.0.total_cmp(&b.0))?;
        Some((other.clone(), ratio, label(scope, &row.key(scope))))
    };
    let smaller = smaller.max_by(|a, b| size(&a.0).total_cmp(&size(&b.0))).and_then(cost);
    let gain = best.iter().any(|one| one.larger.is_some()).then(|| most(best));
    Some(Shipped { tables: tables.clone(), gain, smaller })
}

/// "512x256, 6 levels".
fn words(parameters: &[usize], tables: &Key) -> String {
    let set = parameters.iter().zip(tables).filter(|(_, value)| **value != Value::Unset);
    set.map(|(&axis, value)| said(axis, value)).collect::<Vec<_>>().join(", ")
}

fn answer(frame: &Frame) -> Option<Finding> {
    let (parameters, images) = (parameters(&frame.shape), frame.images());
    let scope: Vec<usize> = frame.case_axes().into_iter().filter(|axis| !parameters.contains(axis)).collect();
    let methods = tried(frame, &images, &parameters);
    let axes = [&[METHOD, SAMPLES], &scope[..], &parameters].concat();
    let mut table = Table::new(&axes, QUESTION.columns);
    for one in methods.iter().flat_map(|(_, own)| own) {
        let larger = one.larger.as_ref().map(|(tables, _)| words(&parameters, tables));
        let own = cells![larger, one.larger.as_ref().map(|(_, ratio)| *ratio), one.gain() <= GAIN];
        table.row([one.row.cells(&axes), own].concat());
    }
    // Nothing is claimed where nothing tells.
    let (method, own) = methods.iter().find(|(_, own)| own.iter().any(|one| one.larger.is_some()))?;
    let own: Vec<&Tried> = own.iter().collect();
    let found = shipped(&parameters, &scope, &own);
    Some(Finding {
        sentence: sentence(frame, method, &parameters, found.as_ref(), &by_alpha(&parameters, &scope, &own)),
        table,
        digest: Some(digest(&parameters, &scope, &methods)),
        figure: found.and_then(|found| figure(frame, &parameters, &own, &found.tables)),
    })
}

/// What is shipped at each alpha by itself.
fn by_alpha(parameters: &[usize], scope: &[usize], own: &[&Tried]) -> Vec<(Value, Option<Shipped>)> {
    let mut groups = grouped(own.iter().copied(), |one| one.row.point[ALPHA].clone());
    groups.sort_by(|(a, _), (b, _)| size_of(a).partial_cmp(&size_of(b)).unwrap_or(std::cmp::Ordering::Equal));
    groups.into_iter().map(|(alpha, own)| (alpha, shipped(parameters, scope, &own))).collect()
}

fn sentence(
    frame: &Frame,
    method: &str,
    parameters: &[usize],
    found: Option<&Shipped>,
    alphas: &[(Value, Option<Shipped>)],
) -> String {
    let Some(found) = found else { return format!("No tried tables of `{method}` are enough in every case.") };
    let words = |tables: &Key| words(parameters, tables);
    let mut text = format!("Ship {} for `{method}`.", words(&found.tables));
    let metric = frame.metric_name();
    text += &match found.gain {
        None => " No larger tables were tried".to_owned(),
        Some(gain) if gain > 0.0 => format!(" Larger ones that were tried gain at most {} in {metric}", percent(gain)),
        Some(_) => format!(" Larger ones that were tried gain nothing in {metric}"),
    };
    if let Some((tables, ratio, place)) = found.smaller.as_ref().filter(|(_, ratio, _)| *ratio > 1.0) {
        // What differs says which.
        let differs = parameters.iter().zip(tables).zip(&found.tables).filter(|((_, a), b)| a != b);
        let smaller: Vec<String> = differs.map(|((&axis, value), _)| said(axis, value)).collect();
        let place = if place.is_empty() { String::new() } else { format!(" ({place})") };
        text += &format!("; {} cost up to {}{place}", listed(&smaller), percent(ratio - 1.0));
    }
    let least = alphas.iter().filter_map(|(_, own)| Some(&own.as_ref()?.tables));
    let least = least.min_by(|a, b| size(parameters, a).total_cmp(&size(parameters, b)));
    let end = least.filter(|least| **least != found.tables).map_or_else(String::new, |least| {
        let own = alphas.iter().filter(|(_, own)| own.as_ref().is_some_and(|own| own.tables == *least));
        let own: Vec<String> = own.map(|(alpha, _)| short(ALPHA, alpha)).collect();
        format!(" At alpha {} {} would do.", listed(&own), words(least))
    });
    format!("{text}.{end}")
}

/// One row an alpha, the last over all: what to ship, what larger tables gain, what the next smaller ones cost.
fn digest(parameters: &[usize], scope: &[usize], methods: &[(String, Vec<Tried>)]) -> Table {
    let heads = [METHOD, ALPHA].iter().chain(parameters).map(|&axis| AXES[axis].name);
    let mut table = Table::with_names(heads.chain(["larger gains at most", "next smaller", "costs up to", "where"]));
    for (method, own) in methods {
        let own: Vec<&Tried> = own.iter().collect();
        let mut rows = by_alpha(parameters, scope, &own);
        rows.retain(|(alpha, _)| *alpha != Value::Unset);
        let rows = rows.into_iter().map(|(alpha, found)| (short(ALPHA, &alpha), found));
        for (alpha, found) in rows.chain([(ALL.to_owned(), shipped(parameters, scope, &own))]) {
            let mut row = cells![method.as_str(), alpha];
            let (gain, smaller, tables) = found.map_or((None, None, vec![Value::Unset; parameters.len()]), |found| {
                (Some(found.gain.map_or("none tried".to_owned(), percent)), found.smaller, found.tables)
            });
            row.extend(parameters.iter().zip(&tables).map(|(&axis, value)| Cell::from(short(axis, value))));
            let smaller = smaller.map(|(tables, ratio, place)| {
                [words(parameters, &tables), percent(ratio - 1.0), place].map(Cell::from)
            });
            row.push(gain.into());
            row.extend(smaller.unwrap_or([Cell::Missing, Cell::Missing, Cell::Missing]));
            table.row(row);
        }
    }
    table
}

/// One panel an environment, one dot a combination and condition: the error over that with the shipped tables, coloured by alpha.
fn figure(frame: &Frame, parameters: &[usize], own: &[&Tried], shipped: &Key) -> Option<Figure> {
    let alphas = ascending(distinct_in_order(own.iter().map(|one| one.row.point[ALPHA].clone())));
    let mark = |one: &&Tried| {
        let base = own.iter().find(|base| base.tables == *shipped && base.condition == one.condition)?;
        let series = alphas.iter().position(|alpha| *alpha == one.row.point[ALPHA])?;
        let (ratio, alpha) = (one.error / base.error, label(&[ALPHA], &[one.row.point[ALPHA].clone()]));
        let tip = format!("{}: {} times · {alpha}", words(parameters, &one.tables), number(ratio));
        Some(dot([size(parameters, &one.tables), ratio], series, tip, one.row))
    };
    let panel = |(light, own): (Value, Vec<&Tried>)| {
        let rules =
            [Mark::neutral(Form::HorizontalRule(1.0)), Mark::neutral(Form::VerticalRule(size(parameters, shipped)))];
        (short(ENVIRONMENT, &light), rules.into_iter().chain(own.iter().filter_map(mark)).collect())
    };
    let by_light = grouped(own.iter().copied(), |one| one.row.point[ENVIRONMENT].clone());
    Chart {
        title: "What smaller tables cost",
        note: format!("{}; over that of the shipped tables: {}", frame.metric_name(), words(parameters, shipped)),
        x: Along::Log("texels times levels times samples"),
        y: Along::Log("ratio of errors"),
        panels: by_light.into_iter().map(panel).collect(),
        series: alphas.iter().map(|alpha| label(&[ALPHA], std::slice::from_ref(alpha))).collect(),
    }
    .figure()
}
