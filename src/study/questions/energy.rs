//! Which model and masking loses energy, how much, and which creates some?
//!
//! A white furnace: a constant environment over a surface that reflects all it gets (F = 1, no metal, nothing left to a diffuse term), held
//! against a white Lambert surface, which shows exactly what arrives. With t the image and r that surface, the change of energy is
//! Σ (t - r) / Σ r, the metric `bias_rel`: below 0 a single scattering loses energy, above 0 it creates some. Its 95 % interval is
//! ± 1.96 standard errors of the noise in the image that judges (`bias_rel_noise_floor`). By n·v the extremes are those of the bins.

use super::n_dot_v::ends;
use super::prelude::*;
use crate::study::frame::line::NORMAL_95;

pub const QUESTION: Question = Question {
    name: "energy",
    asks: "Which model and masking loses energy, how much, and which creates some?",
    columns: &[
        column("change", "Energy that leaves over energy that arrives, minus 1, over the whole surface."),
        column("change_lo", "Lower end of its 95 % interval, by the noise of the image that judges."),
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
    ..Question::PLAIN
};

/// The metric of the change.
const CHANGE: &str = "bias_rel";
/// A bin of n·v that shows more than this above what arrives creates energy: less is within the noise of a bin.
const MEANT: f64 = 0.005;

/// Axes of a furnace with the one value that each must have, and what is said where it has another.
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
            "reference is not { method = \"none\", terms = \"all\" }: a furnace is judged by a white Lambert surface",
        );
    }
    let is = |axis: usize, wanted: &str| matches!(&shape.values[axis][..], [only] if only.to_string() == wanted);
    WHITE.iter().find(|(axis, wanted, _)| !is(*axis, wanted)).map(|(.., lack)| *lack)
}

/// The balance of one image.
struct Balance<'r, 'f> {
    row: &'r Row<'f>,
    /// What tells it apart, without the value on [`Frame::row_axis`]: "ggx · separable".
    name: String,
    width: Value,
    change: f64,
    /// Half its 95 % interval.
    half: Option<f64>,
    /// The change in the bin of n·v that loses most and in the one that creates most, with the bins' ends.
    least: (f64, [f64; 2]),
    most: (f64, [f64; 2]),
}

/// Swept axes that tell the ways of scattering apart, without that of the columns.
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

/// What is neither empty nor alone, joined: "ggx, separable, alpha 1".
fn place<const N: usize>(words: [&str; N]) -> String {
    words.into_iter().filter(|word| !word.is_empty()).collect::<Vec<_>>().join(", ").replace(" · ", ", ")
}

fn sentence(frame: &Frame, widths: &[Value], all: &[Balance]) -> Option<String> {
    let width = |value: &Value| frame.names.one(frame.row_axis(), value);
    let by_change = |a: &&Balance, b: &&Balance| a.change.total_cmp(&b.change);
    let named = |one: &Balance| match place([&one.name]) {
        name if name.is_empty() => percent(one.change),
        name => format!("{} ({name})", percent(one.change)),
    };
    let at = |value: &Value| {
        let own = || all.iter().filter(|one| one.width == *value);
        let (worst, best) = (own().min_by(by_change)?, own().max_by(by_change)?);
        let range = if own().count() == 1 { named(worst) } else { format!("{} to {}", named(worst), named(best)) };
        Some((if width(value).is_empty() { String::new() } else { format!(" at {}", width(value)) }, range))
    };
    // The ends of the sweep stand for it; the digest has all of it.
    let (last, range) = at(widths.last()?)?;
    let mut text = format!("In a white furnace{last} energy changes by {range}.");
    if let Some((first, range)) = widths.first().filter(|_| widths.len() > 1).and_then(at) {
        text += &format!(" It changes by {range}{first}.");
    }
    let strongest = all.iter().max_by(|a, b| a.most.0.total_cmp(&b.most.0))?;
    let (change, bin) = strongest.most;
    let bin = format!("n·v {}", ends(bin));
    let where_most = place([&strongest.name, &width(&strongest.width), &bin]);
    Some(match change > MEANT {
        true => text + &format!(" Most is created by {where_most}: {}.", percent(change)),
        false => text + " None creates energy at any n·v.",
    })
}

/// One row a way of scattering, one column a value of [`Frame::row_axis`], and what creates energy.
fn digest(frame: &Frame, widths: &[Value], all: &[Balance]) -> Table {
    let width = |value: &Value| frame.names.one(frame.row_axis(), value);
    let heads = widths.iter().map(width);
    let last = ["creates most", "where"].map(str::to_owned);
    let mut table = Table::with_names(std::iter::once("surface".to_owned()).chain(heads).chain(last));
    for (name, own) in grouped(all, |one| one.name.clone()) {
        let of = |value: &Value| own.iter().find(|one| one.width == *value).map(|one| with_half(one));
        let most = own.iter().max_by(|a, b| a.most.0.total_cmp(&b.most.0)).filter(|one| one.most.0 > MEANT);
        let bin = most.map(|one| format!("{} n·v {}", width(&one.width), ends(one.most.1)).trim().to_owned());
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

/// One panel a masking, one line a model: the change over [`Frame::row_axis`].
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
        note: "energy that leaves over energy that arrives, minus 1; above 0 energy is created".to_owned(),
        x: Along::Steps(names.name(of), widths.iter().map(|width| names.short(of, width)).collect()),
        y: Along::Linear("change of energy"),
        panels: grouped(all, |one| one.row.key(&rest)).into_iter().map(panel).collect(),
        series: models.clone(),
    }
    .figure()
}
