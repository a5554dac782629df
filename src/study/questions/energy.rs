//! Which model and masking loses or creates energy, and how much?
//!
//! A white furnace: a constant environment over a surface that reflects everything (F = 1, no metal, no diffuse rest), compared with a white
//! Lambert surface, which shows exactly what arrives. With t the image and r that surface, the change of energy is Σ (t - r) / Σ r, the metric
//! `bias_rel`: single scattering below 0 loses energy, above 0 it creates some. Its 95 % interval is ± 1.96 standard errors of the reference's
//! noise (`bias_rel_noise_floor`). By n·v the extremes come from the bins.

use super::prelude::*;
use crate::study::frame::line::NORMAL_95;

pub const QUESTION: Question = Question {
    name: "energy",
    asks: "Which model and masking loses or creates energy, and how much?",
    columns: &[
        column("change", "Outgoing over incoming energy, minus 1, over the whole surface."),
        column("change_lo", "Lower end of its 95 % interval, from the noise of the reference."),
        column("change_hi", super::UPPER),
        column("least", "The change in the bin of n·v that loses most."),
        column("least_n_dot_v_from", "Least n·v of that bin."),
        column("least_n_dot_v_to", "Largest n·v of that bin."),
        column("most", "The change in the bin of n·v that creates most."),
        column("most_n_dot_v_from", "Least n·v of that bin."),
        column("most_n_dot_v_to", "Largest n·v of that bin."),
    ],
    lacks,
    answer,
    is_weighted: false,
    ..Question::PLAIN
};

const CHANGE: &str = "bias_rel";
/// Smaller gains are within the noise of a bin.
const MEANT: f64 = 0.005;

/// Axes of a furnace, the value that each must have, and the fault if it has another.
const WHITE: [(usize, &str, &str); 5] = [
    (ENVIRONMENT, "builtin:constant", "axes.environment is not builtin:constant alone"),
    (ENVIRONMENT_SCALE, "1", "axes.environment_scale is not 1"),
    (F0, "1", "axes.f0 is not 1 alone"),
    (METALLIC, "0", "axes.metallic is not 0 alone"),
    (ALBEDO, "1", "axes.albedo is not 1 alone"),
];

fn lacks(shape: &Shape) -> Option<&'static str> {
    if shape.reference_method != NONE || !shape.judges_all_terms {
        return Some(
            "reference is not { method = \"none\", terms = \"all\" }: the reference of a furnace is a white Lambert surface",
        );
    }
    let is = |axis: usize, wanted: &str| matches!(&shape.values[axis][..], [only] if only.to_string() == wanted);
    WHITE.iter().find(|(axis, wanted, _)| !is(*axis, wanted)).map(|(.., lack)| *lack)
}

struct Balance<'r, 'f> {
    row: &'r Row<'f>,
    /// "ggx · separable".
    name: String,
    width: Value,
    change: f64,
    /// Half the 95 % interval.
    half: Option<f64>,
    /// The smallest and the largest change in a bin, and the ends of the bin.
    least: (f64, [f64; 2]),
    most: (f64, [f64; 2]),
}

/// Swept axes that distinguish surfaces, without [`Frame::row_axis`].
fn key_axes(frame: &Frame) -> Vec<usize> {
    let parts = [Part::Case, Part::Method, Part::Count, Part::Parameter, Part::Table];
    frame.swept(&parts).into_iter().filter(|known| *known != frame.row_axis()).collect()
}

fn answer(frame: &Frame) -> Option<Finding> {
    let (axes, of) = (key_axes(frame), frame.row_axis());
    let balance = |row| {
        let of_row: &Row = row;
        let bins = of_row.cell.bins.iter().filter_map(|bin| Some((bin.scores.get(CHANGE)?, [bin.lo, bin.hi])));
        let bins = || bins.clone().filter(|(change, _)| change.is_finite());
        Some(Balance {
            row,
            name: frame.names.label(&axes, &of_row.key(&axes)),
            width: of_row.point[of].clone(),
            change: of_row.score(CHANGE).filter(|change| change.is_finite())?,
            half: of_row.cell.noise_floors.get(CHANGE).map(|noise| NORMAL_95 * noise),
            least: bins().min_by(|a, b| a.0.total_cmp(&b.0))?,
            most: bins().max_by(|a, b| a.0.total_cmp(&b.0))?,
        })
    };
    let images = frame.images().into_iter().filter(|row| !row.has_no_method());
    let all: Vec<Balance> = images.filter_map(balance).collect();
    let columns = distinct_in_order([BRDF, MASKING].into_iter().chain(axes.iter().copied()).chain([of]));
    let mut table = Table::new(&columns, QUESTION.columns);
    for one in &all {
        let [lo, hi] = [-1.0, 1.0].map(|side| one.half.map(|half| one.change + side * half));
        let bins = [one.least, one.most].map(|(change, [lo, hi])| cells![change, lo, hi.min(1.0)]).concat();
        table.row([one.row.cells(&columns), cells![one.change, lo, hi], bins].concat());
    }
    let widths = values(all.iter().map(|one| one.row), of);
    let sentence = sentence(frame, &widths, &all)?;
    Some(Finding {
        sentence,
        table,
        digest: Some(digest(frame, &widths, &all)),
        figure: figure(frame, &axes, &widths, &all),
    })
}

fn sentence(frame: &Frame, widths: &[Value], all: &[Balance]) -> Option<String> {
    let width = |value: &Value| frame.names.one(frame.row_axis(), value);
    let by_change = |a: &&Balance, b: &&Balance| a.change.total_cmp(&b.change);
    let named = |one: &Balance| match commas([&one.name]) {
        name if name.is_empty() => percent(one.change),
        name => format!("{} ({name})", percent(one.change)),
    };
    let at = |value: &Value| {
        let own = || all.iter().filter(|one| one.width == *value);
        let (worst, best) = (own().min_by(by_change)?, own().max_by(by_change)?);
        let range = if own().count() == 1 { named(worst) } else { format!("{} to {}", named(worst), named(best)) };
        Some((if width(value).is_empty() { String::new() } else { format!(" at {}", width(value)) }, range))
    };
    // Only the ends of the sweep; the digest has all of it.
    let (last, range) = at(widths.last()?)?;
    let mut text = format!("In a white furnace{last}, the energy changes by {range}.");
    if let Some((first, range)) = widths.first().filter(|_| widths.len() > 1).and_then(at) {
        text += &format!(" It changes by {range}{first}.");
    }
    let strongest = all.iter().max_by(|a, b| a.most.0.total_cmp(&b.most.0))?;
    let (change, bin) = strongest.most;
    let place = commas([&strongest.name, &width(&strongest.width), &view(bin)]);
    Some(match change > MEANT {
        true => text + &format!(" The largest gain is {}: {place}.", percent(change)),
        false => text + " No surface creates energy at any n·v.",
    })
}

/// One row per surface, one column per value of [`Frame::row_axis`], and the largest gain.
fn digest(frame: &Frame, widths: &[Value], all: &[Balance]) -> Table {
    let width = |value: &Value| frame.names.one(frame.row_axis(), value);
    let heads = widths.iter().map(width);
    let last = ["creates most", "where"].map(str::to_owned);
    let mut table = Table::with_names(std::iter::once("surface".to_owned()).chain(heads).chain(last));
    for (name, own) in grouped(all, |one| one.name.clone()) {
        let of = |value: &Value| own.iter().find(|one| one.width == *value).map(|one| with_half(one));
        let most = own.iter().max_by(|a, b| a.most.0.total_cmp(&b.most.0)).filter(|one| one.most.0 > MEANT);
        let bin = most.map(|one| format!("{} {}", width(&one.width), view(one.most.1)).trim().to_owned());
        let row = std::iter::once(Cell::from(name)).chain(widths.iter().map(|value| of(value).into()));
        table.row(row.chain(cells![most.map(|one| percent(one.most.0)), bin]).collect());
    }
    table
}

/// "-40 % ± 0.20".
fn with_half(one: &Balance) -> String {
    let half = one.half.map_or_else(String::new, |half| format!(" ± {}", number(100.0 * half)));
    format!("{}{half}", percent(one.change))
}

/// One panel per masking, one line per model: the change over [`Frame::row_axis`].
fn figure(frame: &Frame, axes: &[usize], widths: &[Value], all: &[Balance]) -> Option<Figure> {
    let (of, names) = (frame.row_axis(), &frame.names);
    let rest: Vec<usize> = axes.iter().copied().filter(|axis| *axis != BRDF).collect();
    let models = distinct_in_order(all.iter().map(|one| one.row.text(BRDF)));
    let marks = |one: &&&Balance| {
        let (x, y) = (step(widths, &one.width), one.change);
        let series = step(&models, &one.row.text(BRDF)) as usize;
        let tip = format!("{} · {}: {}", one.name, names.one(of, &one.width), with_half(one));
        let whisker = |half| Mark::new(Form::Whisker([x, y - half], [x, y + half]), series);
        (dot([x, y], series, tip, one.row), one.half.map(whisker))
    };
    let panel = |(key, own): (Key, Vec<&Balance>)| {
        let mut found = vec![Mark::neutral(Form::HorizontalRule(0.0))];
        for (_, mut line) in grouped(&own, |one| one.name.clone()) {
            line.sort_by(|a, b| step(widths, &a.width).total_cmp(&step(widths, &b.width)));
            let (dots, whiskers): (Vec<Mark>, Vec<Option<Mark>>) = line.iter().map(marks).unzip();
            found.extend(joined(dots).into_iter().chain(whiskers.into_iter().flatten()));
        }
        (names.label(&rest, &key), found)
    };
    Chart {
        title: "Energy in a white furnace",
        note: "outgoing over incoming energy, minus 1; above 0 energy is created".to_owned(),
        x: Along::values(frame, of, widths),
        y: Along::Linear("change of energy"),
        panels: grouped(all, |one| one.row.key(&rest)).into_iter().map(panel).collect(),
        series: models.clone(),
    }
    .figure()
}
