//! Where on a surface, and on which surface, does a method err?
//!
//! The error of a method over the pixels with n·v in a bin, by bin and alpha: the median over everything else that is swept, of each method
//! at its leading count, the tried one nearest to the default of the axis.
//!
//! The scope is the view. Under one camera n·v is tied to the place on the map: with an orthographic camera v is the same everywhere, and
//! the mirror direction lies 2 acos(n·v) from it, so that each bin sees one ring of the map. Turning the map by 60 degrees moves a bin by up
//! to a factor of 440 (sky, alpha 0.1, n·v 0.3 to 0.4). From one view the figure shows where lamps are, not what grazing angles do.

use super::words::{count, number, short, with_interval};
use super::{Finding, Question};
use crate::runner::axis::{Part, by_name};
use crate::runner::value::Value;
use crate::study::figure::{Figure, Mark, Panel, Ramp, Scale, Shape as Form};
use crate::study::frame::estimate::{Estimate, estimate, median};
use crate::study::frame::{Frame, Row, Shape, ascending, axis, distinct_in_order};
use crate::study::table::{Column, Table, value_cell};
use crate::table::csv::Cell;

pub const QUESTION: Question = Question {
    name: "n-dot-v",
    asks: "Where on a surface, and on which surface, does a method err in this view?",
    columns: &[
        Column { name: "n_dot_v_from", about: "Least n·v of the bin." },
        Column { name: "n_dot_v_to", about: "Largest n·v of the bin." },
        Column { name: "n", about: "Images behind the error." },
        Column {
            name: "error",
            about: "Median over the images of the error over the bin's pixels, in the metric of the question.",
        },
        Column {
            name: "error_lo",
            about: "Lower end of its 95 % interval over environments; empty below six environments.",
        },
        Column { name: "error_hi", about: "Upper end of that interval." },
    ],
    uses_times: false,
    lacks,
    answer,
};

fn lacks(shape: &Shape) -> Option<&'static str> {
    (!shape.is_swept(axis("alpha"))).then_some("axes.alpha has fewer than two values")
}

/// The error of a method at one alpha in one bin.
struct Place {
    alpha: Value,
    bin: [f64; 2],
    error: Estimate,
}

/// The places of one method at its leading count.
struct Method<'r, 'f> {
    name: String,
    places: Vec<Place>,
    rows: Vec<&'r Row<'f>>,
}

/// Each method at the tried count nearest to the default, by ratio; those without samples first.
fn leading<'r, 'f>(frame: &'r Frame<'f>) -> Vec<(String, Vec<&'r Row<'f>>)> {
    let usual = f64::from((by_name("samples").default)().count());
    let images = frame.images();
    let rows: Vec<&Row> = images.into_iter().filter(|row| !row.cell.bins.is_empty()).collect();
    // Without any specular term the diffuse methods are asked about.
    let term = |row: &Row| frame.way(row).split(' ').next().unwrap_or_default().to_owned();
    let terms = distinct_in_order(rows.iter().map(|row| term(row)));
    let distance = |row: &&&Row| row.samples().map_or(0.0, |n| (f64::from(n) / usual).ln().abs());
    let mut found: Vec<(String, Vec<&Row>)> = terms
        .into_iter()
        .filter(|name| name != "none")
        .filter_map(|name| {
            let own = || rows.iter().filter(|row| term(row) == name);
            let way = frame.way(own().min_by(|a, b| distance(a).total_cmp(&distance(b)))?);
            let of_way = own().filter(|row| frame.way(row) == way).copied().collect();
            Some((way, of_way))
        })
        .collect();
    found.sort_by_key(|(_, rows)| rows.iter().any(|row| row.samples().is_some()));
    found
}

fn places(frame: &Frame, rows: &[&Row]) -> Vec<Place> {
    let (alpha, environment) = (axis("alpha"), axis("environment"));
    let alphas = rows.iter().map(|row| row.point.0[alpha].clone()).filter(|alpha| *alpha != Value::Unset);
    let mut bins: Vec<[f64; 2]> =
        rows.iter().flat_map(|row| row.cell.bins.iter().map(|bin| [bin.lo, bin.hi])).collect();
    bins.sort_by(|a, b| a[0].total_cmp(&b[0]));
    bins.dedup();
    let of = |at: &Value, bin: [f64; 2]| {
        let own = rows.iter().filter(|row| row.point.0[alpha] == *at);
        let errors = own.filter_map(|row| {
            let found = row.cell.bins.iter().find(|known| known.lo == bin[0])?;
            let error = frame.bin_error(found).filter(|error| error.is_finite())?;
            Some((row.point.0[environment].clone(), error))
        });
        estimate(&errors.collect::<Vec<_>>(), median)
    };
    let mut found = Vec::new();
    for at in ascending(distinct_in_order(alphas)) {
        let own = bins.iter().filter_map(|&bin| Some(Place { alpha: at.clone(), bin, error: of(&at, bin)? }));
        found.extend(own);
    }
    found
}

/// "0.3 to 0.4": the last bin ends above 1, so that 1 lies in it.
fn ends([lo, hi]: [f64; 2]) -> String {
    format!("{lo} to {}", hi.min(1.0))
}

fn answer(frame: &Frame) -> Option<Finding> {
    let methods: Vec<Method> = leading(frame)
        .into_iter()
        .map(|(name, rows)| Method { name, places: places(frame, &rows), rows })
        .filter(|method| !method.places.is_empty())
        .collect();
    let lead = methods.first()?;
    let ways = frame.way_axes();
    let mut table = Table::new(&[ways.clone(), vec![axis("alpha")]].concat(), QUESTION.columns);
    for (method, place) in methods.iter().flat_map(|method| method.places.iter().map(move |place| (method, place))) {
        let [lo, hi] = place.error.interval.map_or([None; 2], |ends| ends.map(Some));
        let mut row = method.rows.first()?.cells(&ways);
        row.extend([
            value_cell(&place.alpha),
            place.bin[0].into(),
            place.bin[1].min(1.0).into(),
            Cell::Integer(place.error.n as u64),
            place.error.value.into(),
            lo.into(),
            hi.into(),
        ]);
        table.row(row);
    }
    Some(Finding {
        sentence: sentence(frame, lead)?,
        table,
        digest: Some(digest(&methods)),
        figure: figure(frame, &methods),
    })
}

fn sentence(frame: &Frame, lead: &Method) -> Option<String> {
    let by_error = |a: &&Place, b: &&Place| a.error.value.total_cmp(&b.error.value);
    let (most, least) = (lead.places.iter().max_by(by_error)?, lead.places.iter().min_by(by_error)?);
    let place = |place: &Place| format!("n·v {}, alpha {}", ends(place.bin), short(axis("alpha"), &place.alpha));
    let over = match most.error.n {
        1 => String::new(),
        n => format!(", the median of {}", count(n, "image", "images")),
    };
    let turns = ["environment_rotation_deg", "scene"].iter().any(|name| frame.shape.is_swept(axis(name)));
    let view = if turns { "In these views" } else { "In this view" };
    let mut text = format!(
        "{view} `{}` errs most at {}: {} {}{over}. It errs least at {}: {}.",
        lead.name,
        place(most),
        frame.metric_name(),
        number(most.error.value),
        place(least),
        number(least.error.value)
    );
    if !turns {
        text += " Each n·v sees one part of the map, so this says where lamps stand as much as where the method fails.";
    }
    Some(text)
}

/// Bins by alpha of the leading method.
fn digest(methods: &[Method]) -> Table {
    let places = || methods.iter().flat_map(|method| &method.places);
    let mut bins: Vec<[f64; 2]> = places().map(|place| place.bin).collect();
    bins.sort_by(|a, b| a[0].total_cmp(&b[0]));
    bins.dedup();
    let names =
        ["method", "alpha"].map(str::to_owned).into_iter().chain(bins.iter().map(|bin| format!("n·v {}", ends(*bin))));
    let mut table = Table::with_names(names.collect());
    for method in methods {
        for alpha in distinct_in_order(method.places.iter().map(|place| place.alpha.clone())) {
            let of = |bin: &[f64; 2]| method.places.iter().find(|place| place.alpha == alpha && place.bin == *bin);
            let cell = |bin| of(bin).map_or(Cell::Missing, |place| Cell::Text(with_interval(&place.error)));
            let first = [Cell::Text(method.name.clone()), Cell::Text(short(axis("alpha"), &alpha))];
            table.row(first.into_iter().chain(bins.iter().map(cell)).collect());
        }
    }
    table
}

/// One panel a method: n·v over alpha.
fn figure(frame: &Frame, methods: &[Method]) -> Option<Figure> {
    let all = || methods.iter().flat_map(|method| &method.places);
    let mut bins: Vec<[f64; 2]> = all().map(|place| place.bin).collect();
    bins.sort_by(|a, b| a[0].total_cmp(&b[0]));
    bins.dedup();
    let alphas = ascending(distinct_in_order(all().map(|place| place.alpha.clone())));
    let panel = |method: &Method| {
        let marks = method.places.iter().filter_map(|place| {
            let x = bins.iter().position(|bin| *bin == place.bin)?;
            let y = alphas.iter().position(|alpha| *alpha == place.alpha)?;
            let text = number(place.error.value);
            let tip = format!(
                "{} · alpha {} · n·v {}: {}",
                method.name,
                place.alpha,
                ends(place.bin),
                with_interval(&place.error)
            );
            let mark = Mark::neutral(Form::Tile { x, y, value: Some(place.error.value), text }).tip(tip);
            // A tile of one image leads to it.
            let mut own = method.rows.iter().filter(|row| row.point.0[axis("alpha")] == place.alpha);
            Some(match (own.next(), own.next()) {
                (Some(only), None) => mark.cell(&only.cell.id),
                _ => mark,
            })
        });
        Panel {
            title: method.name.clone(),
            x: Scale::steps("n·v", bins.iter().map(|bin| bin[0].to_string()).collect()),
            y: Scale::steps("alpha", alphas.iter().map(|alpha| short(axis("alpha"), alpha)).collect()),
            marks: marks.collect(),
        }
    };
    let values: Vec<f64> = all().map(|place| place.error.value).filter(|value| *value > 0.0).collect();
    let (lo, hi) = (values.iter().copied().reduce(f64::min)?, values.iter().copied().reduce(f64::max)?);
    let scope = frame.swept(&[Part::Case]).len() > 1;
    Some(Figure {
        title: "Error by n·v and alpha in this view".to_owned(),
        note: format!(
            "{}{}; bins by their least n·v",
            frame.metric_name(),
            if scope { ", median over the rest" } else { "" }
        ),
        panels: methods.iter().map(panel).collect(),
        series: Vec::new(),
        ramp: Some(Ramp { label: frame.metric_name().to_owned(), lo, hi, is_log: true, middle: None }),
    })
}
