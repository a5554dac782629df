//! Which tables should a renderer ship?
//!
//! Tables are compared with what they approximate, the split sum with exact factors, `P(r, alpha) (f0 A + B)` (method [`EXACT_SPLIT`]): against
//! the truth an error of the tables may cancel one of the split. In each *condition* (environment, model, alpha, f0, and on the scene `design`
//! each band of n·v: the split errs least facing the viewer, so tables matter most there):
//!
//! - `error`: the tables against the exact split, which is also what relative metrics divide by;
//! - `split_error`: the truth (method `reference`) against the exact split, in the same metric;
//! - `share`: the first over the second.
//!
//! A *combination* is one value of each swept setting of tables. It is *enough* at an alpha if its share is at most [`enough`] in every
//! condition: the split itself then causes the error. The answer is the combination with the fewest texels that is enough at every alpha; among
//! equal ones the one with the fewest samples, then the smallest worst share.

use super::prelude::*;
use crate::metrics::ALL_VIEWS;
use crate::precompute::PrecomputeSettings;
use crate::shade::{EXACT_SPLIT, REFERENCE};
use crate::table::markdown::significant;
use std::collections::HashMap;
use std::ops::Range;

pub const QUESTION: Question = Question {
    name: "tables",
    asks: "Which tables should a renderer ship, and from which roughness do better tables not help?",
    columns: &[
        SEEN_FROM,
        SEEN_TO,
        column(
            "error",
            "Error of the tables against the split sum with exact factors, in the metric of the question; relative metrics divide by that split.",
        ),
        column("split_error", "Error of the truth against the same split: the cost of the split itself."),
        column("share", "The first over the second."),
        column("is_enough", "1 where the share is at most 0.1 of a mean square, 0.32 of a mean magnitude, else 0."),
        column("texels", "Texels of all levels and faces of the prefiltered map and of the DFG table."),
        column("is_resolved", "1 if the error is resolved against the reference's noise, else 0."),
    ],
    lacks,
    answer,
    ..Question::PLAIN
};

/// Largest share of the split's mean square error for tables that are enough: they add at most 5 % to its root.
const SHARE: f64 = 0.1;

/// The same share in the metric of the question: a third for an error that is not a square.
fn enough(frame: &Frame) -> f64 {
    SHARE.powf(0.5 * frame.metric.power)
}

fn lacks(shape: &Shape) -> Option<&'static str> {
    let draws_truth = shape.methods().any(|method| method.name == REFERENCE);
    match () {
        () if shape.reference_method != EXACT_SPLIT => {
            Some("reference.method is not ladder-view: tables are compared with the split sum with exact factors")
        }
        () if !draws_truth => Some("axes.method has no `reference`, which gives the cost of the split itself"),
        () if !shape.methods().any(|method| method.uses_prefiltered()) => Some("axes.method has no method with tables"),
        () => parameters(shape).is_empty().then_some("no setting of a table has two values"),
    }
}

fn parameters(shape: &Shape) -> Vec<usize> {
    (0..AXES.len()).filter(|&axis| AXES[axis].part == Part::Table && shape.is_swept(axis)).collect()
}

struct Tried<'r, 'f> {
    row: &'r Row<'f>,
    seen: [f64; 2],
    /// Values of the parameters.
    tables: Key,
    error: f64,
    split: f64,
}

impl Tried<'_, '_> {
    fn share(&self) -> f64 {
        self.error / self.split
    }

    /// Texels of the tables of the row.
    fn texels(&self) -> f64 {
        texels(&self.row.point.settings().shading.precompute)
    }

    /// Samples of its prefiltered map; 0 for harmonics.
    fn samples(&self) -> f64 {
        self.row.point.settings().shading.precompute.samples_of("prefilter").unwrap_or(0.0)
    }
}

/// Texels of all levels and faces of the prefiltered map and of the DFG table.
fn texels(settings: &PrecomputeSettings) -> f64 {
    let [width, height] = settings.prefilter_size.map(f64::from);
    // Each level has a quarter of the texels of the one before.
    let levels = (0..settings.prefilter_level_count).map(|level| 0.25_f64.powi(level as i32)).sum::<f64>();
    f64::from(settings.layout.face_count) * width * height * levels + f64::from(settings.dfg_size).powi(2)
}

fn tried<'r, 'f>(frame: &Frame, images: &[&'r Row<'f>], parameters: &[usize]) -> Vec<Tried<'r, 'f>> {
    let mut all = seen_at(frame, images, parameters, ALL_VIEWS);
    for (seen, run) in frame.views(images) {
        all.extend(seen_at(&frame.like(&run, frame.metric_name()), images, parameters, seen));
    }
    all
}

fn seen_at<'r, 'f>(frame: &Frame, images: &[&'r Row<'f>], parameters: &[usize], seen: [f64; 2]) -> Vec<Tried<'r, 'f>> {
    let errors: HashMap<&str, f64> =
        frame.rows.iter().filter_map(|row| Some((row.cell.id.as_str(), frame.error(row)?))).collect();
    let error = |row: &Row| errors.get(row.cell.id.as_str()).copied();
    let of_truth = |row: &Row, truth: &Row| {
        let is_case = |axis: &usize| AXES[*axis].part == Part::Case;
        (0..AXES.len()).filter(is_case).all(|axis| fits(&row.key(&[axis]), &truth.key(&[axis])))
    };
    let truths: Vec<&&Row> = images.iter().filter(|row| row.text(METHOD) == REFERENCE).collect();
    let one = |&row: &&'r Row<'f>| {
        let tables = row.key(parameters);
        let split = error(truths.iter().find(|truth| of_truth(row, truth))?)?;
        let is_asked = tables.iter().any(|value| *value != Value::Unset);
        is_asked.then_some(Tried { row, seen, tables, error: error(row)?, split })
    };
    images.iter().filter_map(one).filter(|one| one.share().is_finite()).collect()
}

struct Combination<'t, 'r, 'f> {
    tables: Key,
    own: Vec<&'t Tried<'r, 'f>>,
}

impl Combination<'_, '_, '_> {
    fn worst(&self) -> &Tried<'_, '_> {
        self.own.iter().max_by(|a, b| a.share().total_cmp(&b.share())).expect("a group has a row")
    }

    fn numbers(&self, of: fn(&Tried) -> f64) -> Numbers<'_, '_> {
        let all_views = self.own.iter().filter(|one| one.seen == ALL_VIEWS);
        Numbers::new(all_views.map(|one| (one.row, of(one))), Middle::GeometricMean)
    }
}

/// The combinations that were tried in all conditions of these rows, the smallest first.
fn combinations<'t, 'r, 'f>(own: impl Iterator<Item = &'t Tried<'r, 'f>>) -> Vec<Combination<'t, 'r, 'f>> {
    let groups = grouped(own, |one| one.tables.clone());
    let most = groups.iter().map(|(_, own)| own.len()).max();
    let whole = groups.into_iter().filter(|(_, own)| Some(own.len()) == most);
    let mut all: Vec<_> = whole.map(|(tables, own)| Combination { tables, own }).collect();
    let [texels, samples]: [fn(&Combination) -> f64; 2] = [|one| one.worst().texels(), |one| one.worst().samples()];
    let by_size =
        |a: &Combination, b: &Combination| texels(a).total_cmp(&texels(b)).then(samples(a).total_cmp(&samples(b)));
    all.sort_by(|a, b| by_size(a, b).then(a.worst().share().total_cmp(&b.worst().share())));
    all
}

/// The smallest combination that is enough, else the one with the smallest worst share.
fn chosen<'c, 't, 'r, 'f>(enough: f64, all: &'c [Combination<'t, 'r, 'f>]) -> Option<&'c Combination<'t, 'r, 'f>> {
    let by_worst = |a: &&Combination, b: &&Combination| a.worst().share().total_cmp(&b.worst().share());
    all.iter().find(|one| one.worst().share() <= enough).or_else(|| all.iter().min_by(by_worst))
}

/// In percent; with a third digit if it is not enough, so that 10.5 % does not read as 10 %.
fn told_share(enough: f64, share: f64) -> String {
    if share > enough { format!("{} %", significant(100.0 * share, 3)) } else { percent(share) }
}

/// "qwantani, alpha 0.1, n·v 0.8 to 1".
fn place(frame: &Frame, one: &Tried, axes: &[usize]) -> String {
    let label = frame.names.label(axes, &one.row.key(axes));
    let seen = (one.seen != ALL_VIEWS).then(|| view(one.seen));
    [label].into_iter().filter(|label| !label.is_empty()).chain(seen).collect::<Vec<_>>().join(", ")
}

/// "64x64, 6 levels".
fn words(frame: &Frame, parameters: &[usize], tables: &Key) -> String {
    let set = parameters.iter().zip(tables).filter(|(_, value)| **value != Value::Unset);
    set.map(|(&axis, value)| frame.names.said(axis, value)).collect::<Vec<_>>().join(", ")
}

fn answer(frame: &Frame) -> Option<Finding> {
    let (parameters, images) = (parameters(&frame.shape), frame.images());
    let scope: Vec<usize> = frame.case_axes().into_iter().filter(|axis| !parameters.contains(axis)).collect();
    let tried = tried(frame, &images, &parameters);
    let columns = frame.table_axes().into_iter().filter(|axis| !parameters.contains(axis));
    let axes: Vec<usize> = std::iter::once(METHOD).chain(columns).chain(parameters.iter().copied()).collect();
    let mut table = Table::new(&axes, QUESTION.columns);
    for one in &tried {
        let is_enough = one.share() <= enough(frame);
        let own = cells![one.seen[0], one.seen[1], one.error, one.split, one.share(), is_enough, one.texels()];
        let own = [own, cells![frame.is_resolved(one.row)]].concat();
        table.row([one.row.cells(&axes), own].concat());
    }
    let all: Vec<&Tried> = tried.iter().collect();
    let rows = grouped_ascending(all.iter().copied(), frame.row_axis(), |one| one.row);
    let by_width: Vec<_> = rows.iter().map(|(width, own)| (width.clone(), combinations(own.iter().copied()))).collect();
    let whole = combinations(all.iter().copied());
    Some(Finding {
        sentence: sentence(frame, &parameters, &rows, &by_width, &whole)?,
        digest: Some(digest(frame, &parameters, &scope, &by_width, &whole)),
        figure: figure(frame, &parameters, &all),
        table,
    })
}

type ByWidth<'t, 'r, 'f> = [(Value, Vec<Combination<'t, 'r, 'f>>)];
type Rows<'t, 'r, 'f> = [(Value, Vec<&'t Tried<'r, 'f>>)];

/// The longest run of neighbouring values of [`Frame::row_axis`] with one combination that is enough; of equally long runs the last.
fn longest<'t, 'r, 'f>(enough: f64, rows: &Rows<'t, 'r, 'f>) -> Option<(Range<usize>, Combination<'t, 'r, 'f>)> {
    let ranges =
        (1..=rows.len()).rev().flat_map(|length| (length..=rows.len()).rev().map(move |end| end - length..end));
    ranges.into_iter().find_map(|range| {
        let all = combinations(rows[range.clone()].iter().flat_map(|(_, own)| own.iter().copied()));
        Some((range, all.into_iter().find(|one| one.worst().share() <= enough)?))
    })
}

/// "From alpha 0.25 (roughness 0.5) on".
fn range_words(frame: &Frame, rows: &Rows, range: &Range<usize>) -> String {
    let (of, names) = (frame.row_axis(), &frame.names);
    let [first, last] = [range.start, range.end - 1].map(|place| names.heading(of, &rows[place].0));
    let end = |place: usize| names.one(of, &rows[place].0);
    match (range.len(), range.start == 0, range.end == rows.len()) {
        (1, ..) => format!("At {first}"),
        (_, _, true) => format!("From {first} on"),
        (_, true, _) => format!("Up to {last}"),
        _ => format!("From {} to {}", end(range.start), end(range.end - 1)),
    }
}

fn sentence(
    frame: &Frame,
    parameters: &[usize],
    rows: &Rows,
    by_width: &ByWidth,
    whole: &[Combination],
) -> Option<String> {
    let (metric, enough) = (frame.metric_name(), enough(frame));
    let (of, best) = (frame.row_axis(), chosen(enough, whole)?);
    let words = |tables: &Key| words(frame, parameters, tables);
    let place = |one: &Tried| place(frame, one, &distinct_in_order([ENVIRONMENT, of]));
    // A share within the reference's noise is an upper bound.
    let share = |one: &Tried| {
        let bound = if frame.is_resolved(one.row) { "" } else { "at most " };
        format!("{bound}{}", told_share(enough, one.share()))
    };
    let mut text = match longest(enough, rows) {
        Some((range, one)) if range.len() < rows.len() => {
            let ship = format!(
                "{}, ship **{}**: at most {} of the split's `{metric}`.",
                range_words(frame, rows, &range),
                words(&one.tables),
                told_share(enough, one.worst().share()),
            );
            let outside = by_width.iter().enumerate().filter(|(place, _)| !range.contains(place));
            let best = outside.filter_map(|(_, (width, all))| Some((width, chosen(enough, all)?.worst())));
            let (do_too, fail): (Vec<_>, Vec<_>) = best.partition(|(_, worst)| worst.share() <= enough);
            let at = |widths: &[(&Value, &Tried)]| {
                let widths: Vec<String> = widths.iter().map(|(width, _)| frame.names.short(of, width)).collect();
                format!("{} {}", frame.names.name(of), widths.join(", "))
            };
            let fail_worst = fail.iter().map(|(_, worst)| *worst).max_by(|a, b| a.share().total_cmp(&b.share()));
            let none = fail_worst.map(|worst| {
                format!(
                    " At {}, no tables are enough. The best, {}, reach {}: a `{metric}` of {} under {}.",
                    at(&fail),
                    words(&worst.tables),
                    share(worst),
                    with_rms(frame, worst.error),
                    place(worst),
                )
            });
            let others =
                (!do_too.is_empty()).then(|| format!(" At {}, other tables are enough: see the rows.", at(&do_too)));
            [Some(ship), none, others].into_iter().flatten().collect()
        }
        Some((_, one)) => format!(
            "Ship **{}**: their `{metric}` is at most {} of the split's own ({}).",
            words(&one.tables),
            told_share(enough, one.worst().share()),
            place(one.worst())
        ),
        None => format!(
            "No tried tables err by {} of the split's own `{metric}` or less. The best, {}, reach {} ({}).",
            if frame.metric.power == 2.0 { "a tenth" } else { "a third" },
            words(&best.tables),
            share(best.worst()),
            place(best.worst())
        ),
    };
    // The values from which on the smallest tables are enough.
    let is_enough = |all: &[Combination]| all.first().is_some_and(|least| least.worst().share() <= enough);
    let rest = by_width.iter().rposition(|(_, all)| !is_enough(all)).map_or(0, |last| last + 1);
    if let Some((width, all)) = by_width.get(rest)
        && *width != Value::Unset
        && by_width.len() > 1
    {
        let from = match rest {
            0 => format!("At every {}", frame.names.name(of)),
            _ => format!("From {} on", frame.names.heading(of, width)),
        };
        let own = all[0].numbers(|one| one.split).estimate().map_or(String::new(), |mean| with_rms(frame, mean.value));
        text += &format!(
            " {from}, the smallest tables are enough: the split itself has a `{metric}` of {own} at {}.",
            frame.names.one(of, width)
        );
    }
    Some(text)
}

/// One row per value of [`Frame::row_axis`], the last over all: the smallest tables that are enough, their error, and the split's error.
fn digest(frame: &Frame, parameters: &[usize], scope: &[usize], by_width: &ByWidth, whole: &[Combination]) -> Table {
    let of = frame.row_axis();
    let heads = frame.names.heads(&[of]);
    let names = [
        "tables",
        "their error, geometric mean over all n·v",
        "the split's own error, the same mean",
        "share at most",
        "where",
    ];
    let mut table = Table::with_names(heads.iter().copied().chain(names));
    let enough = enough(frame);
    let rows = by_width.iter().filter(|(width, _)| *width != Value::Unset);
    let rows = rows.map(|(width, all)| (Some(width), &all[..]));
    for (width, all) in rows.chain([(None, whole)]) {
        let Some(best) = chosen(enough, all) else { continue };
        let worst = best.worst();
        let told = |of| best.numbers(of).estimate().map(|mean| with_rms(frame, mean.value));
        let tables = words(frame, parameters, &best.tables);
        let tables = if worst.share() <= enough { tables } else { format!("none; best {tables}") };
        let place: Vec<usize> = scope.iter().copied().filter(|axis| width.is_none() || *axis != of).collect();
        let errors = cells![told(|one| one.error), told(|one| one.split)];
        let worst = cells![told_share(enough, worst.share()), self::place(frame, worst, &place)];
        let head = width.map_or_else(|| all_head(&heads), |width| frame.names.head_of(of, width));
        table.row([head, cells![tables], errors, worst].concat());
    }
    table
}

/// One panel per value of [`Frame::row_axis`], one dot per combination at its worst condition; dots of one kind are joined.
fn figure(frame: &Frame, parameters: &[usize], all: &[&Tried]) -> Option<Figure> {
    let is_kind = |axis: &usize| frame.shape.values[*axis].iter().all(|value| matches!(value, Value::Text(_)));
    let kinds: Vec<usize> = parameters.iter().copied().filter(is_kind).collect();
    let kind = |one: &Tried| {
        let words: Vec<String> = kinds.iter().map(|&axis| frame.names.short(axis, &one.row.point[axis])).collect();
        words.join(" · ")
    };
    let series = distinct_in_order(all.iter().map(|one| kind(one)));
    let panel = |(width, own): (Value, Vec<&Tried>)| {
        let mut marks = vec![Mark::neutral(Form::HorizontalRule(enough(frame)))];
        let all = combinations(own.iter().copied());
        for (place, name) in series.iter().enumerate() {
            let of_kind = all.iter().map(Combination::worst).filter(|worst| kind(worst) == *name);
            let dots = of_kind.map(|worst| {
                let share = percent(worst.share());
                let at = self::place(frame, worst, &[ENVIRONMENT]);
                let tip = format!("{}: {share} of the split's error · {at}", words(frame, parameters, &worst.tables));
                dot([worst.texels(), worst.share()], place, tip, worst.row)
            });
            let dots: Vec<Mark> = dots.collect();
            marks.extend(if dots.len() > 1 { joined(dots) } else { dots });
        }
        (frame.names.heading(frame.row_axis(), &width), marks)
    };
    let by_width = grouped_ascending(all.iter().copied(), frame.row_axis(), |one| one.row);
    Chart {
        title: "Error of tables and of the split",
        note: format!(
            "{} of tables over that of the split itself, in the worst condition; below the line the split dominates",
            frame.metric_name()
        ),
        x: Along::Log("texels"),
        y: Along::Log("share of the split's error"),
        panels: by_width.into_iter().map(panel).collect(),
        series,
    }
    .figure()
}
