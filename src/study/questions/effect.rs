//! Is one method better than another, and where? The effect of any way to make an image on its error.
//!
//! For a swept axis of methods, of their parameters or of their tables, its first value is the base. Each image with another value is
//! paired with the image that has the base and agrees on all other axes ([`pair`]). The *effect* is the ratio of their errors: below 1 the
//! value is better than the base. It is told as the geometric mean over cases, by alpha and by environment; where it is below 1 here and
//! above 1 there, it is told along that axis and never averaged over it. A pair of which both errors are within the reference's noise
//! tells nothing and is left out of the mean.

use super::conditions::{along, by_width_and_light, change_of_sign, heading};
use super::words::{cases_sentence, listed, number, said, short, with_interval};
use super::{Finding, Question};
use crate::runner::axis::{AXES, METHOD, Part};
use crate::runner::value::Value;
use crate::shade::METHODS;
use crate::study::figure::{Figure, Mark, Panel, Scale, Series, Shape as Form};
use crate::study::frame::estimate::{Estimate, estimate, geometric_mean};
use crate::study::frame::{Frame, Row, Shape, ascending, axis, distinct_in_order, pair};
use crate::study::table::{Column, Table, value_cell};
use crate::table::csv::Cell;

pub const QUESTION: Question = Question {
    name: "effect",
    asks: "Is one way to make the image better than another, and where?",
    columns: &[
        Column { name: "axis", about: "The axis whose value changes." },
        Column { name: "value", about: "The value that is judged." },
        Column { name: "base", about: "The value that it is judged against: the first one of the axis." },
        Column { name: "ratio", about: "Error over that of the base; below 1 the value is closer to the reference." },
        Column {
            name: "is_resolved",
            about: "1 where an error of the two stands clear of the reference's noise, else 0.",
        },
    ],
    uses_times: false,
    lacks,
    answer,
};

/// Ways to make the image of a case.
const WAYS: [Part; 3] = [Part::Method, Part::Parameter, Part::Table];
/// Axes that the sentence tells of; the table has all.
const TOLD_MAX: usize = 2;

fn lacks(shape: &Shape) -> Option<&'static str> {
    // A method that samples has no partner among those that do not.
    let of_methods = |draws: bool| {
        let alike = METHODS.iter().filter(|method| method.uses_samples == draws && !method.is_none());
        alike.filter(|method| shape.has("method", &[method.name])).count() > 1
    };
    let is_way = |axis: usize| WAYS.contains(&AXES[axis].part) && axis != METHOD && shape.is_swept(axis);
    (!(0..AXES.len()).any(is_way) && !of_methods(true) && !of_methods(false))
        .then_some("no axis of methods, their parameters or their tables has two values")
}

/// An image beside the one with the base.
struct Effect<'r, 'f> {
    axis: usize,
    row: &'r Row<'f>,
    base: &'r Row<'f>,
    ratio: f64,
    is_resolved: bool,
}

impl Effect<'_, '_> {
    fn value(&self) -> &Value {
        &self.row.point.0[self.axis]
    }
}

fn effects<'r, 'f>(frame: &Frame, images: &[&'r Row<'f>], of: usize) -> Vec<Effect<'r, 'f>> {
    let Some(base) = frame.shape.values[of].first() else { return Vec::new() };
    let effect = |(row, base): (&'r Row<'f>, &'r Row<'f>)| {
        let ratio = frame.error(row)? / frame.error(base)?;
        let is_resolved = frame.is_resolved(row) || frame.is_resolved(base);
        ratio.is_finite().then_some(Effect { axis: of, row, base, ratio, is_resolved })
    };
    pair(images, of, base).into_iter().filter_map(effect).collect()
}

fn answer(frame: &Frame) -> Option<Finding> {
    let images = frame.images();
    let by_axis: Vec<Vec<Effect>> = frame.swept(&WAYS).into_iter().map(|of| effects(frame, &images, of)).collect();
    let by_axis: Vec<Vec<Effect>> = by_axis.into_iter().filter(|effects| !effects.is_empty()).collect();
    let lead = by_axis.first()?;
    let told: Vec<&Effect> = lead.iter().filter(|effect| effect.is_resolved).collect();
    let sentence = by_axis.iter().take(TOLD_MAX).map(|effects| sentence(frame, effects)).collect::<Vec<_>>().join(" ");
    let rows: Vec<&Row> = told.iter().map(|effect| effect.row).collect();
    Some(Finding {
        sentence: sentence + &cases_sentence(&rows, &frame.case_axes(), told.len()),
        table: table(frame, &by_axis),
        digest: digest(frame, &by_axis),
        figure: figure(frame, lead),
    })
}

fn table(frame: &Frame, by_axis: &[Vec<Effect>]) -> Table {
    let mut axes = frame.case_axes();
    axes.extend(
        [axis("method"), axis("samples"), axis("point_set")]
            .into_iter()
            .filter(|known| !axes.contains(known))
            .collect::<Vec<_>>(),
    );
    let mut table = Table::new(&axes, QUESTION.columns);
    for effect in by_axis.iter().flatten() {
        let mut row: Vec<Cell> = effect.row.key(&axes).iter().map(value_cell).collect();
        row.push(Cell::from(AXES[effect.axis].name));
        row.extend([effect.value(), &effect.base.point.0[effect.axis]].map(value_cell));
        row.extend([effect.ratio.into(), Cell::Integer(effect.is_resolved.into())]);
        table.row(row);
    }
    table
}

fn mean(effects: &[&Effect]) -> Option<Estimate> {
    let environment = axis("environment");
    let values = effects.iter().map(|effect| (effect.row.point.0[environment].clone(), effect.ratio));
    estimate(&values.collect::<Vec<_>>(), geometric_mean)
}

fn mean_value(effects: &[&&Effect]) -> f64 {
    geometric_mean(&effects.iter().map(|effect| effect.ratio).collect::<Vec<_>>())
}

/// Of the values of an axis the one that errs least, base included, and its closest rival.
fn sentence(frame: &Frame, effects: &[Effect]) -> String {
    let Some(first) = effects.first() else { return String::new() };
    let (of, base) = (first.axis, &first.base.point.0[first.axis]);
    let resolved: Vec<&Effect> = effects.iter().filter(|effect| effect.is_resolved).collect();
    let values = distinct_in_order(resolved.iter().map(|effect| effect.value().clone()));
    let own = |value: &Value| -> Vec<&Effect> { resolved.iter().copied().filter(|e| e.value() == value).collect() };
    let mut means: Vec<(Value, Estimate)> =
        values.iter().filter_map(|value| Some((value.clone(), mean(&own(value))?))).collect();
    means.sort_by(|a, b| a.1.value.total_cmp(&b.1.value));
    let (name, metric) = (|value: &Value| format!("`{}`", said(of, value)), frame.metric_name());
    let Some((value, ratio)) = means.first() else {
        return format!("`{}` changes nothing that stands clear of the reference's noise.", AXES[of].name);
    };
    let of_value = own(value);
    if let Some((along_axis, groups)) = change_of_sign(frame, &of_value, |effect| effect.row, mean_value) {
        let better = |is: fn(f64) -> bool| {
            let own = groups.iter().filter(|(_, ratio)| is(*ratio));
            listed(
                &own.map(|(value, ratio)| format!("{} ({})", short(along_axis, value), number(*ratio)))
                    .collect::<Vec<_>>(),
            )
        };
        let axis_name = AXES[along_axis].name;
        return format!(
            "{} has less `{metric}` than {} at {axis_name} {}, and more at {}.",
            name(value),
            name(base),
            better(|ratio| ratio < 1.0),
            better(|ratio| ratio >= 1.0)
        );
    }
    let wins = of_value.iter().filter(|effect| effect.ratio < 1.0).count();
    match means.len() {
        1 => format!(
            "{} has **{} times** the `{metric}` of {}: less in {wins} of {} cases.",
            name(value),
            with_interval(ratio),
            name(base),
            of_value.len()
        ),
        n if ratio.value < 1.0 => format!(
            "Of {} {} {} errs least: it has {} times the `{metric}` of {}, less in {wins} of {} cases.",
            n + 1,
            AXES[of].plural,
            name(value),
            with_interval(ratio),
            name(base),
            of_value.len()
        ),
        n => format!(
            "Of {} {} the base {} errs least; the next, {}, has {} times its `{metric}`.",
            n + 1,
            AXES[of].plural,
            name(base),
            name(value),
            with_interval(ratio)
        ),
    }
}

/// By alpha and environment where one value is judged; else one row a value.
fn digest(frame: &Frame, by_axis: &[Vec<Effect>]) -> Option<Table> {
    let lead = by_axis.first()?;
    let resolved: Vec<&Effect> = lead.iter().filter(|effect| effect.is_resolved).collect();
    let values = distinct_in_order(lead.iter().map(|effect| effect.value().clone()));
    let cell = |own: &[&&Effect]| {
        let own: Vec<&Effect> = own.iter().map(|effect| **effect).collect();
        mean(&own).map_or(Cell::Missing, |estimate| Cell::Text(with_interval(&estimate)))
    };
    if by_axis.len() == 1 && values.len() == 1 {
        return Some(by_width_and_light(frame, &resolved, |effect| effect.row, cell));
    }
    let alpha = axis("alpha");
    let all: Vec<&Effect> = by_axis.iter().flatten().filter(|effect| effect.is_resolved).collect();
    let widths = ascending(distinct_in_order(all.iter().map(|effect| effect.row.point.0[alpha].clone())));
    let mut names = vec!["axis".to_owned(), "value".to_owned(), "base".to_owned()];
    names.extend(widths.iter().map(|width| heading(alpha, width)));
    names.extend(["all", "wins", "cases"].map(str::to_owned));
    let mut table = Table::with_names(names);
    for effects in by_axis {
        for value in distinct_in_order(effects.iter().map(|effect| effect.value().clone())) {
            let own: Vec<&Effect> = effects.iter().filter(|e| e.is_resolved && *e.value() == value).collect();
            let Some(first) = own.first() else { continue };
            let of = first.axis;
            let mut row = vec![Cell::from(AXES[of].name), Cell::Text(short(of, &value))];
            row.push(Cell::Text(short(of, &first.base.point.0[of])));
            for width in &widths {
                let at: Vec<&&Effect> = own.iter().filter(|effect| effect.row.point.0[alpha] == *width).collect();
                row.push(if at.is_empty() { Cell::Missing } else { cell(&at) });
            }
            row.push(cell(&own.iter().collect::<Vec<_>>()));
            let wins = own.iter().filter(|effect| effect.ratio < 1.0).count();
            row.extend([wins, own.len()].map(|n| Cell::Integer(n as u64)));
            table.row(row);
        }
    }
    Some(table)
}

/// One panel an environment: the ratio by alpha, a colour a value.
fn figure(frame: &Frame, effects: &[Effect]) -> Option<Figure> {
    let (alpha, environment) = (axis("alpha"), axis("environment"));
    let of = effects.first()?.axis;
    let values = distinct_in_order(effects.iter().map(|effect| effect.value().clone()));
    let lights = distinct_in_order(effects.iter().map(|effect| effect.row.point.0[environment].clone()));
    let widths = ascending(distinct_in_order(effects.iter().map(|effect| effect.row.point.0[alpha].clone())));
    let scale = Scale::log(
        &format!("{} over that of the base", frame.metric_name()),
        effects.iter().map(|e| e.ratio).chain([1.0]),
    )?;
    let panel = |light: &Value| {
        let mut marks = vec![Mark::neutral(Form::HorizontalRule(1.0))];
        for (series, value) in values.iter().enumerate() {
            let is_own = |effect: &&Effect| effect.row.point.0[environment] == *light && effect.value() == value;
            let own: Vec<&Effect> = effects.iter().filter(is_own).collect();
            let line = along(&own, |effect| effect.row, alpha, |own| mean_value(own));
            let place = |width: &Value| widths.iter().position(|known| known == width).map_or(f64::NAN, |i| i as f64);
            let points: Vec<[f64; 2]> = line.iter().map(|(width, ratio)| [place(width), *ratio]).collect();
            for ((width, ratio), point) in line.iter().zip(&points) {
                let cell = own.iter().find(|effect| effect.row.point.0[alpha] == *width);
                let tip = format!("{}, {}: {} times", said(of, value), said(alpha, width), number(*ratio));
                let mark = Mark::new(Form::Dot(*point), series).tip(tip);
                marks.push(match cell {
                    Some(effect) => mark.cell(&effect.row.cell.id),
                    None => mark,
                });
            }
            marks.push(Mark::new(Form::Line(points), series));
        }
        let names = widths.iter().map(|width| short(alpha, width)).collect();
        Panel { title: short(environment, light), x: Scale::steps("alpha", names), y: scale.clone(), marks }
    };
    Some(Figure {
        title: format!("Effect of {}", AXES[of].name),
        note: format!("Error over that of `{}`; below 1 is better", short(of, &effects.first()?.base.point.0[of])),
        panels: lights.iter().map(panel).collect(),
        series: values.iter().map(|value| Series { name: said(of, value), is_dashed: false }).collect(),
        ramp: None,
    })
}
