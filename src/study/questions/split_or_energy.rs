//! Which is larger, the error of a split sum or the energy that its model loses?
//!
//! Image and reference have what facets reflect to each other given back by a factor k on the specular term ([`Compensation::factor`]), so
//! that the error of a method is that of its lookups. A single scattering, exact but for that light, shows 1/k of the truth: its `relmse` is
//! `(1 - 1/k)²`, less where ε counts. Its mean over n·v, evenly as the scene `design` has it, is the *missing energy*, an upper bound. It
//! hangs on model, masking, alpha and F0, not on light.

use super::break_even::{by_condition, conditions};
use super::prelude::*;
use crate::brdf::Compensation;
use crate::math::quadrature::GaussLegendre;
use crate::metrics::HEADLINE;
use crate::precompute::dfg::reference::dfg_within;
use glam::{DVec2, DVec3, Vec3};
use std::collections::HashMap;

pub const QUESTION: Question = Question {
    name: "split-or-energy",
    asks: "Which is larger, the error of a split sum or the energy that its model loses?",
    columns: &[
        column("missing_energy", "Mean over n·v of (1 - 1/k)², k the factor that gives the lost energy back."),
        column("error", "Error of the method with that factor, against a reference that has it, too."),
        column("ratio", "Error over missing energy: above 1 the split is the larger."),
    ],
    uses_times: false,
    uses_costs: false,
    lacks,
    answer,
};

fn lacks(shape: &Shape) -> Option<&'static str> {
    let gives_back =
        |value: &Value| Compensation::ALL.iter().any(|(name, way)| *name == value.to_string() && scales(*way));
    match () {
        () if !shape.values[COMPENSATION].iter().any(gives_back) => {
            Some("axes.compensation has no way that scales the specular term")
        }
        () if !shape.methods().any(|method| method.uses_prefiltered()) => {
            Some("axes.method has no method that looks the prefiltered map up")
        }
        () => None,
    }
}

/// Whether all that it gives back is a factor on the specular term.
fn scales(way: Compensation) -> bool {
    way.factor(DVec3::ONE, DVec2::splat(0.25)) != DVec3::ONE
}

/// Nodes along √(n·v), and the relative error of each.
const NODES: usize = 12;
const WITHIN: f64 = 1e-4;

/// The missing energy at the axes of a row.
fn missing(row: &Row) -> f64 {
    let settings = row.point.settings();
    let (alpha, f0) = (row.point[ALPHA].number(), Vec3::from_array(row.point[F0].color()).as_dvec3());
    let at = |root: f64| {
        let pair = dfg_within(settings.shading.brdf, settings.shading.masking_shadowing, root * root, alpha, WITHIN);
        let factor = settings.shading.compensation.factor(f0, DVec2::new(pair.f0_scale, pair.f90_scale));
        let missing = 1.0 - factor.recip();
        2.0 * root * (missing * missing).element_sum() / 3.0
    };
    GaussLegendre::<NODES>::new().integrate(0.0, 1.0, at)
}

fn answer(frame: &Frame) -> Option<Finding> {
    // Missing energy is a relative mean square.
    let frame = &Frame::new(frame.run, Some(HEADLINE));
    let axes = frame.case_axes();
    let is_told = |row: &&Row| {
        let settings = row.point.settings();
        scales(settings.shading.compensation) && settings.shading.method.uses_prefiltered()
    };
    let mut known: HashMap<Key, f64> = HashMap::new();
    let mut table = Table::new(&[&axes[..], &[METHOD]].concat(), QUESTION.columns);
    let mut all: Vec<(&Row, [f64; 2])> = Vec::new();
    let images = frame.images();
    for row in images.iter().copied().filter(is_told) {
        let Some(error) = frame.error(row) else { continue };
        let missing = *known.entry(row.key(&[BRDF, MASKING, COMPENSATION, ALPHA, F0])).or_insert_with(|| missing(row));
        let own = cells![missing, error, error / missing];
        table.row([row.cells(&axes), row.cells(&[METHOD]), own].concat());
        if error > 0.0 && missing > 0.0 {
            all.push((row, [missing, error]));
        }
    }
    let missing = Numbers::ratios(all.iter().map(|(row, [missing, _])| (*row, *missing)));
    let missing = by_condition(frame, missing);
    let ways: Vec<Way> = grouped(all.iter().copied(), |(row, _)| row.text(METHOD))
        .into_iter()
        .map(|(name, own)| way(frame, name, &own))
        .collect();
    Some(Finding {
        sentence: sentence(frame, &ways)? + &Numbers::ratios(all.iter().map(|(row, _)| (*row, 1.0))).scope(&axes),
        digest: Some(digest(frame, &missing, &ways)),
        figure: figure(frame, &missing, &ways),
        table,
    })
}

/// A method with its errors over the missing energy, and its errors, by condition.
type Way<'r, 'f> = (String, Vec<(Key, Numbers<'r, 'f>)>, Vec<(Key, Numbers<'r, 'f>)>);

fn way<'r, 'f>(frame: &Frame, name: String, own: &[(&'r Row<'f>, [f64; 2])]) -> Way<'r, 'f> {
    let numbers =
        |of: fn([f64; 2]) -> f64| by_condition(frame, Numbers::ratios(own.iter().map(|(row, pair)| (*row, of(*pair)))));
    (name, numbers(|[missing, error]| error / missing), numbers(|[_, error]| error))
}

/// Of the first method and of the last the least and the largest ratio, with their places.
fn sentence(frame: &Frame, ways: &[Way]) -> Option<String> {
    let of: Vec<usize> = conditions(frame).collect();
    let at = |key: &Key| match label(&of, key).replace(" · ", ", ") {
        place if place.is_empty() => place,
        place => format!(" at {place}"),
    };
    let told = |(name, ratios, _): &Way| {
        let all = || ratios.iter().filter_map(|(key, own)| Some((key, own.estimate()?.value)));
        let least = all().reduce(|a, b| if b.1 < a.1 { b } else { a })?;
        let most = all().reduce(|a, b| if b.1 > a.1 { b } else { a })?;
        let ends = if least.0 == most.0 { String::new() } else { format!(", {} times{}", number(most.1), at(most.0)) };
        Some(format!("`{name}` errs by **{} times** the missing energy{}{ends}.", number(least.1), at(least.0)))
    };
    let (first, last) = (ways.first()?, ways.last()?);
    let last = (first.0 != last.0).then(|| told(last)).flatten().map_or(String::new(), |text| format!(" {text}"));
    Some(told(first)? + &last)
}

/// A row a condition: the missing energy, and by method the error over it.
fn digest(frame: &Frame, missing: &[(Key, Numbers)], ways: &[Way]) -> Table {
    let of: Vec<usize> = conditions(frame).collect();
    let heads = of.iter().flat_map(|of| [Some(AXES[*of].name), (*of == ALPHA).then_some(ROUGHNESS)]).flatten();
    let names = ways.iter().map(|(name, ..)| format!("{name}, times"));
    let mut table = Table::with_names(heads.map(str::to_owned).chain(["missing energy".to_owned()]).chain(names));
    for (key, own) in missing {
        let head = of.iter().zip(key).flat_map(|(of, value)| {
            [Some(Cell::from(short(*of, value))), (*of == ALPHA).then(|| roughness(value).into())].into_iter().flatten()
        });
        let of_way = |(_, ratios, _): &Way| {
            let own = ratios.iter().find(|(own, _)| own == key);
            Cell::from(own.and_then(|(_, own)| own.estimate()).as_ref().map(with_interval))
        };
        let energy = Cell::from(own.estimate().map(|all| number(all.value)));
        table.row(head.chain([energy]).chain(ways.iter().map(of_way)).collect());
    }
    table
}

/// A panel a condition but alpha: the missing energy and the error of each method over alpha.
fn figure(frame: &Frame, missing: &[(Key, Numbers)], ways: &[Way]) -> Option<Figure> {
    let of: Vec<usize> = conditions(frame).collect();
    let widths = values(missing.iter().flat_map(|(_, own)| own.rows()), ALPHA);
    let series: Vec<String> = std::iter::once("missing energy")
        .chain(ways.iter().map(|(name, ..)| name.as_str()))
        .map(str::to_owned)
        .collect();
    let lines = std::iter::once(missing).chain(ways.iter().map(|(.., errors)| &errors[..])).enumerate();
    let marks = lines.flat_map(|(place, line)| {
        let name = series[place].clone();
        line.iter().map(move |(key, own)| (key, place, name.clone(), own))
    });
    let rest = |key: &Key| {
        let (axes, values): (Vec<usize>, Vec<Value>) =
            of.iter().copied().zip(key.iter().cloned()).filter(|(axis, _)| *axis != ALPHA).unzip();
        label(&axes, &values).replace(" · ", ", ")
    };
    let panel = |(title, own): (String, Vec<(&Key, usize, String, &Numbers)>)| {
        let line = |(_, own): (usize, Vec<(&Key, usize, String, &Numbers)>)| {
            let marks = own.into_iter().flat_map(|(key, place, name, numbers)| {
                let x = of.iter().zip(key).find(|(axis, _)| **axis == ALPHA);
                let x = x.map_or(0.0, |(_, width)| step(&widths, width));
                numbers.marks(place, move |y| [x, y], (&format!("{name}, {}", label(&of, key)), &with_interval))
            });
            joined(marks.collect())
        };
        (title, grouped(own, |(_, place, ..)| *place).into_iter().flat_map(line).collect())
    };
    Chart {
        title: "Error of a split sum and missing energy",
        note: format!("{}, geometric mean{INTERVAL}", frame.metric_name()),
        x: Along::Steps(AXES[ALPHA].name, widths.iter().map(|width| short(ALPHA, width)).collect()),
        y: Along::Log(frame.metric_name()),
        panels: grouped(marks, |(key, ..)| rest(key)).into_iter().map(panel).collect(),
        series: series.clone(),
    }
    .figure()
}
