//! Which split sum errs least for its lookups? The error of each way to shade against its lookups of an environment map per pixel
//! (`Method::lookups_of_pixel`); lookups of small tables do not count.
//!
//! Errors are divided by those of the first method of the experiment, the *base*, in the same case, and averaged geometrically over
//! environments. A way is on the *front* if no other with as few lookups has a smaller mean over all cases.

use super::front::{Ratios, instructions, lookups};
use super::prelude::*;

pub const QUESTION: Question = Question {
    name: "which-split-sum",
    asks: "Which split sum errs least for its lookups?",
    columns: &[
        column("lookups", "Lookups of an environment map per pixel."),
        column(
            "instructions",
            "Vector instructions per pixel of the compiled pass; empty without `costs.csv`, which `splitsum cost --out` writes.",
        ),
        column("base", "The first method of the experiment."),
        column("ratio", "Error over the error of the base; below 1 the way is closer to the reference."),
        column("is_on_front", "1 if no way with as few lookups has a smaller mean ratio over all cases, else 0."),
    ],
    lacks,
    answer,
    ..Question::PLAIN
};

fn lacks(shape: &Shape) -> Option<&'static str> {
    let count = shape.methods().filter(|method| method.uses_prefiltered()).count();
    (count < 2).then_some("axes.method has fewer than two methods with a prefiltered map")
}

/// A method at a sample count.
struct Way<'r, 'f> {
    name: String,
    lookups: u32,
    ratios: Numbers<'r, 'f>,
    mean: Estimate,
    is_on_front: bool,
}

/// Ordered by lookups, then by mean ratio.
fn ways<'r, 'f>(frame: &Frame, ratios: &[(&'r Row<'f>, f64)]) -> Vec<Way<'r, 'f>> {
    let way = |(name, own): (String, Vec<&(&'r Row<'f>, f64)>)| {
        let ratios = Numbers::ratios(own.iter().copied().copied());
        let mean = ratios.estimate()?;
        Some(Way { name, lookups: lookups(own[0].0)?, ratios, mean, is_on_front: false })
    };
    let mut ways: Vec<Way> = grouped(ratios, |(row, _)| frame.way(row)).into_iter().filter_map(way).collect();
    ways.sort_by(|a, b| (a.lookups, a.mean.value).partial_cmp(&(b.lookups, b.mean.value)).expect("finite means"));
    let mut least = f64::INFINITY;
    for way in &mut ways {
        way.is_on_front = way.mean.value < least;
        least = least.min(way.mean.value);
    }
    ways
}

fn answer(frame: &Frame) -> Option<Finding> {
    let images: Vec<&Row> = frame.images().into_iter().filter(|row| lookups(row).is_some()).collect();
    let Ratios { base, all: ratios } = Ratios::new(frame, &images)?;
    let ways = ways(frame, &ratios);
    let columns = [&frame.table_axes()[..], &[METHOD, SAMPLES]].concat();
    let mut table = Table::new(&columns, QUESTION.columns);
    for (row, ratio) in &ratios {
        let name = frame.way(row);
        let Some(way) = ways.iter().find(|way| way.name == name) else { continue };
        let own = cells![way.lookups, instructions(frame, row), &base, *ratio, way.is_on_front];
        table.row([row.cells(&columns), own].concat());
    }
    let is_shown = |row: &Row| {
        let way = ways.iter().find(|way| way.name == frame.way(row));
        way.is_some_and(|way| way.is_on_front || row.samples().is_some() || row.point[METHOD] == base)
    };
    let (sentence, digest) = (sentence(frame, &ways, &base)?, Some(digest(frame, &ways)));
    let shown = ratios.iter().copied().filter(|(row, _)| is_shown(row)).collect();
    let figure = Ratios { all: shown, base }.figure(frame, Middle::GeometricMean);
    Some(Finding { sentence, digest, table, figure })
}

fn sentence(frame: &Frame, ways: &[Way], base: &Value) -> Option<String> {
    let mut front = ways.iter().filter(|way| way.is_on_front);
    let (first, metric) = (front.next()?, frame.metric_name());
    let times = |way: &Way| format!("{} times{}", number(way.mean.value), interval_words(&way.mean, number));
    let many = if first.lookups == 1 { "lookup" } else { "lookups" };
    let first_words = match first.name == base.to_string() {
        true => format!("With **{} {many}** per pixel, `{base}` has the least `{metric}`.", first.lookups),
        false => format!(
            "With **{} {many}** per pixel, `{}` errs least: it has {} the `{metric}` of `{base}`.",
            first.lookups,
            first.name,
            times(first)
        ),
    };
    let next = front
        .next()
        .map(|way| format!(" With **{}**, `{}` has {}.", way.lookups, way.ratios.first_method(), times(way)));
    let all = ways.last()?;
    Some(first_words + &next.unwrap_or_default() + &all.ratios.scope(frame))
}

fn row_axes(frame: &Frame) -> Vec<usize> {
    distinct_in_order([F0, frame.row_axis()]).into_iter().filter(|axis| frame.shape.is_swept(*axis)).collect()
}

/// By F0 and [`Frame::row_axis`] the ways of the front with one lookup or more; the last rows are the mean and the worst image.
fn digest(frame: &Frame, ways: &[Way]) -> Table {
    let by_axes = row_axes(frame);
    let shown: Vec<&Way> = ways.iter().filter(|way| way.is_on_front || way.lookups == 1).collect();
    let heads = if by_axes.is_empty() { vec!["images"] } else { frame.names.heads(&by_axes) };
    let names = shown.iter().map(|way| format!("{} ({})", way.name, way.lookups));
    let mut table = Table::with_names(heads.iter().map(|head| head.to_string()).chain(names));
    for (key, _) in by(&rows(&shown), &by_axes).into_iter().filter(|_| !by_axes.is_empty()) {
        let cells =
            shown.iter().map(|way| at(&way.ratios, &by_axes, &key).estimate().as_ref().map(with_interval).into());
        table.row(frame.names.head(&by_axes, &key).into_iter().chain(cells).collect());
    }
    let labelled = |label: &str, mut cells: Vec<Cell>| {
        let mut row = all_head(&heads);
        row[0] = label.into();
        row.append(&mut cells);
        row
    };
    table.row(labelled(ALL, shown.iter().map(|way| Cell::from(with_interval(&way.mean))).collect()));
    if shown.iter().any(|way| way.ratios.rows().count() > 1) {
        table.row(labelled("worst image", shown.iter().map(|way| Cell::from(number(way.ratios.most()))).collect()));
    }
    table.without_empty()
}

fn rows<'r, 'f>(ways: &[&Way<'r, 'f>]) -> Vec<&'r Row<'f>> {
    ways.iter().flat_map(|way| way.ratios.rows()).collect()
}

fn at<'r, 'f>(numbers: &Numbers<'r, 'f>, axes: &[usize], key: &[Value]) -> Numbers<'r, 'f> {
    axes.iter().zip(key).fold(numbers.clone(), |own, (axis, value)| own.at(*axis, value))
}
