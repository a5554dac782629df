//! Which model and masking loses energy, how much, and which creates some?
//!
//! A white furnace: a constant environment over a surface that reflects all it gets (F = 1, no metal, nothing left to a diffuse term), held
//! against a white Lambert surface, which shows exactly what arrives. With t the image and r that surface, the change of energy is
//! Σ (t - r) / Σ r, the metric `bias_rel`: below 0 a single scattering loses energy, above 0 it creates some. Its 95 % interval is
//! ± 1.96 standard errors of the noise in the image that judges (`bias_rel_noise_floor`). By n·v the extremes are those of the bins.

use super::words::{label, number, percent, short};
use super::{Finding, Question};
use crate::runner::axis::Part;
use crate::runner::value::Value;
use crate::study::figure::{Figure, Mark, Panel, Scale, Series, Shape as Form};
use crate::study::frame::line::NORMAL_95;
use crate::study::frame::{Frame, Key, Row, Shape, ascending, axis, distinct_in_order};
use crate::study::table::{Column, Table};
use crate::table::csv::Cell;

pub const QUESTION: Question = Question {
    name: "energy",
    asks: "Which model and masking loses energy, how much, and which creates some?",
    columns: &[
        Column {
            name: "change",
            about: "Energy that leaves over energy that arrives, minus 1, over the whole surface.",
        },
        Column { name: "change_lo", about: "Lower end of its 95 % interval, by the noise of the image that judges." },
        Column { name: "change_hi", about: "Upper end of that interval." },
        Column { name: "least", about: "The change in the bin of n·v that loses most." },
        Column { name: "least_n_dot_v_from", about: "Least n·v of that bin." },
        Column { name: "least_n_dot_v_to", about: "Largest n·v of that bin." },
        Column { name: "most", about: "The change in the bin of n·v that creates most." },
        Column { name: "most_n_dot_v_from", about: "Least n·v of that bin." },
        Column { name: "most_n_dot_v_to", about: "Largest n·v of that bin." },
    ],
    uses_times: false,
    lacks,
    answer,
};

/// The metric of the change.
const CHANGE: &str = "bias_rel";
/// A bin of n·v that shows more than this above what arrives creates energy: less is within the noise of a bin.
const MEANT: f64 = 0.005;

/// Axes of a furnace with the one value that each must have, and what is said where it has another.
const WHITE: [(&str, &str, &str); 5] = [
    ("environment", "builtin:constant", "axes.environment is not builtin:constant alone"),
    ("environment_scale", "1", "axes.environment_scale is not 1"),
    ("f0", "1", "axes.f0 is not 1 alone"),
    ("metallic", "0", "axes.metallic is not 0 alone"),
    ("albedo", "1", "axes.albedo is not 1 alone"),
];

fn lacks(shape: &Shape) -> Option<&'static str> {
    if shape.reference_method != "none" || !shape.judges_all_terms {
        return Some(
            "reference is not { method = \"none\", terms = \"all\" }: a furnace is judged by a white Lambert surface",
        );
    }
    let is =
        |name: &str, wanted: &str| matches!(shape.values[axis(name)].as_slice(), [only] if only.to_string() == wanted);
    WHITE.iter().find(|(name, wanted, _)| !is(name, wanted)).map(|(.., lack)| *lack)
}

/// The change in one bin of n·v.
#[derive(Clone, Copy)]
struct BinChange {
    change: f64,
    ends: [f64; 2],
}

/// The balance of one image.
struct Balance<'r, 'f> {
    row: &'r Row<'f>,
    /// What tells it apart, without alpha.
    key: Key,
    alpha: Value,
    change: f64,
    /// Half its 95 % interval.
    half: Option<f64>,
    least: BinChange,
    most: BinChange,
}

/// Swept axes that tell the ways of scattering apart, without alpha.
fn key_axes(frame: &Frame) -> Vec<usize> {
    let parts = [Part::Case, Part::Method, Part::Count, Part::Parameter, Part::Table];
    frame.swept(&parts).into_iter().filter(|known| *known != axis("alpha")).collect()
}

fn balances<'r, 'f>(frame: &'r Frame<'f>) -> Vec<Balance<'r, 'f>> {
    let axes = key_axes(frame);
    let balance = |row: &'r Row<'f>| {
        let change = frame.score_in(row, CHANGE).filter(|change| change.is_finite())?;
        let of_bin = |bin: &crate::study::finished::Bin| {
            Some(BinChange { change: bin.scores.get(CHANGE)?, ends: [bin.lo, bin.hi] })
        };
        let bins = || row.cell.bins.iter().filter_map(of_bin).filter(|bin| bin.change.is_finite());
        Some(Balance {
            row,
            key: row.key(&axes),
            alpha: row.point.0[axis("alpha")].clone(),
            change,
            half: row.cell.noise_floors.get(CHANGE).map(|noise| NORMAL_95 * noise),
            least: bins().min_by(|a, b| a.change.total_cmp(&b.change))?,
            most: bins().max_by(|a, b| a.change.total_cmp(&b.change))?,
        })
    };
    frame.images().into_iter().filter(|row| !row.has_no_method()).filter_map(balance).collect()
}

fn answer(frame: &Frame) -> Option<Finding> {
    let all = balances(frame);
    let axes = [key_axes(frame), vec![axis("alpha")]].concat();
    let mut table = Table::new(&axes, QUESTION.columns);
    for one in &all {
        let mut row = one.row.cells(&axes);
        let [lo, hi] = [-1.0, 1.0].map(|side| one.half.map(|half| one.change + side * half));
        row.extend([one.change.into(), lo.into(), hi.into()]);
        for bin in [one.least, one.most] {
            row.extend([bin.change, bin.ends[0], bin.ends[1].min(1.0)].map(Cell::Number));
        }
        table.row(row);
    }
    let sentence = sentence(&key_axes(frame), &all)?;
    Some(Finding { sentence, table, digest: Some(digest(&key_axes(frame), &all)), figure: figure(frame, &all) })
}

/// "ggx, separable".
fn name(axes: &[usize], one: &Balance) -> String {
    label(axes, &one.key).replace(" · ", ", ")
}

fn alphas(all: &[Balance]) -> Vec<Value> {
    ascending(distinct_in_order(all.iter().map(|one| one.alpha.clone())))
}

fn sentence(axes: &[usize], all: &[Balance]) -> Option<String> {
    let by_change = |a: &&Balance, b: &&Balance| a.change.total_cmp(&b.change);
    let named = |one: &Balance| match name(axes, one) {
        name if name.is_empty() => percent(one.change),
        name => format!("{} ({name})", percent(one.change)),
    };
    let at = |alpha: &Value| {
        let own = || all.iter().filter(|one| one.alpha == *alpha);
        let (worst, best) = (own().min_by(by_change)?, own().max_by(by_change)?);
        let range = if own().count() == 1 { named(worst) } else { format!("{} to {}", named(worst), named(best)) };
        let place = label(&[axis("alpha")], std::slice::from_ref(alpha));
        Some((if place.is_empty() { place } else { format!(" at {place}") }, range))
    };
    let alphas = alphas(all);
    // The ends of the sweep stand for it; the digest has all of it.
    let ends = match alphas.as_slice() {
        [first, .., last] => vec![at(last)?, at(first)?],
        few => few.iter().filter_map(at).collect(),
    };
    let (place, range) = ends.first()?;
    let mut text = format!("In a white furnace{place} energy changes by {range}.");
    if let Some((place, range)) = ends.get(1) {
        text += &format!(" It changes by {range}{place}.");
    }
    let strongest = all.iter().max_by(|a, b| a.most.change.total_cmp(&b.most.change))?;
    let creators = distinct_in_order(all.iter().filter(|one| one.most.change > MEANT).map(|one| one.key.clone()));
    let BinChange { change, ends: [lo, hi] } = strongest.most;
    let place = [name(axes, strongest), label(&[axis("alpha")], std::slice::from_ref(&strongest.alpha))];
    let place = place.into_iter().filter(|word| !word.is_empty()).collect::<Vec<_>>().join(", ");
    let place = if place.is_empty() { place } else { format!("{place}, ") };
    text += &match creators.len() {
        0 => " None creates energy at any n·v.".to_owned(),
        _ => format!(" Most is created by {place}n·v {lo} to {}: {}.", hi.min(1.0), percent(change)),
    };
    Some(text)
}

/// One row a way of scattering, one column an alpha, and what creates energy.
fn digest(axes: &[usize], all: &[Balance]) -> Table {
    let alphas = alphas(all);
    let heads = alphas.iter().map(|alpha| label(&[axis("alpha")], std::slice::from_ref(alpha)));
    let names =
        std::iter::once("surface".to_owned()).chain(heads).chain(["creates most".to_owned(), "where".to_owned()]);
    let mut table = Table::with_names(names.collect());
    for key in distinct_in_order(all.iter().map(|one| one.key.clone())) {
        let own: Vec<&Balance> = all.iter().filter(|one| one.key == key).collect();
        let mut row = vec![Cell::Text(label(axes, &key))];
        row.extend(alphas.iter().map(|alpha| match own.iter().find(|one| one.alpha == *alpha) {
            None => Cell::Missing,
            Some(one) => Cell::Text(with_half(one)),
        }));
        let most = own.iter().max_by(|a, b| a.most.change.total_cmp(&b.most.change));
        row.extend(match most.filter(|one| one.most.change > MEANT) {
            None => [Cell::Missing, Cell::Missing],
            Some(one) => {
                let [lo, hi] = one.most.ends;
                let alpha = label(&[axis("alpha")], std::slice::from_ref(&one.alpha));
                [percent(one.most.change), format!("{alpha} n·v {lo} to {}", hi.min(1.0)).trim().to_owned()]
                    .map(Cell::Text)
            }
        });
        table.row(row);
    }
    table
}

/// "-40 % ± 0.20".
fn with_half(one: &Balance) -> String {
    let half = one.half.map_or_else(String::new, |half| format!(" ± {}", number(100.0 * half)));
    format!("{}{half}", percent(one.change))
}

/// One panel a masking, one line a model: the change over alpha.
fn figure(frame: &Frame, all: &[Balance]) -> Option<Figure> {
    let axes = key_axes(frame);
    let series_axis = axes.iter().position(|known| *known == axis("brdf"));
    let names = series_axis.map_or_else(Vec::new, |i| distinct_in_order(all.iter().map(|one| one.key[i].clone())));
    let rest =
        |key: &Key| -> Key { (0..key.len()).filter(|i| Some(*i) != series_axis).map(|i| key[i].clone()).collect() };
    let rest_axes: Vec<usize> = (0..axes.len()).filter(|i| Some(*i) != series_axis).map(|i| axes[i]).collect();
    let alphas = alphas(all);
    let changes =
        || all.iter().flat_map(|one| [one.change - one.half.unwrap_or(0.0), one.change + one.half.unwrap_or(0.0)]);
    let panel = |of: Key| {
        let mut marks = vec![Mark::neutral(Form::HorizontalRule(0.0))];
        for key in distinct_in_order(all.iter().filter(|one| rest(&one.key) == of).map(|one| one.key.clone())) {
            let series = series_axis.and_then(|i| names.iter().position(|name| *name == key[i])).unwrap_or(0);
            let place = |one: &Balance| alphas.iter().position(|alpha| *alpha == one.alpha).unwrap_or(0) as f64;
            let mut own: Vec<&Balance> = all.iter().filter(|one| one.key == key).collect();
            own.sort_by(|a, b| place(a).total_cmp(&place(b)));
            marks.push(Mark::new(Form::Line(own.iter().map(|one| [place(one), one.change]).collect()), series));
            for one in own {
                let x = place(one);
                if let Some(half) = one.half {
                    marks.push(Mark::new(Form::Whisker([x, one.change - half], [x, one.change + half]), series));
                }
                let tip =
                    format!("{} · alpha {}: {}", label(&axes, &key), short(axis("alpha"), &one.alpha), with_half(one));
                marks.push(Mark::new(Form::Dot([x, one.change]), series).tip(tip).cell(&one.row.cell.id));
            }
        }
        Some(Panel {
            title: label(&rest_axes, &of),
            x: Scale::steps("alpha", alphas.iter().map(|alpha| short(axis("alpha"), alpha)).collect()),
            y: Scale::linear("change of energy", changes().chain([0.0]))?,
            marks,
        })
    };
    let panels = distinct_in_order(all.iter().map(|one| rest(&one.key)));
    let series =
        if names.is_empty() { vec!["energy".to_owned()] } else { names.iter().map(Value::to_string).collect() };
    Some(Figure {
        title: "Energy in a white furnace".to_owned(),
        note: "energy that leaves over energy that arrives, minus 1; above 0 energy is created".to_owned(),
        panels: panels.into_iter().filter_map(panel).collect(),
        series: series.into_iter().map(|name| Series { name, is_dashed: false }).collect(),
        ramp: None,
    })
}
