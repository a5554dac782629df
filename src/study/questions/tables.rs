//! Which tables should a renderer ship?
//!
//! Tables are compared with what they approximate, the split sum with exact factors, `P(r, alpha)
//! (f0 A + B)` (method [`EXACT_SPLIT`]): against the truth an error of the tables may cancel one of
//! the split. In each *condition* (environment, model, alpha, f0, and on the scene `design` each
//! band of n·v: the split errs least facing the viewer, so tables matter most there):
//!
//! - `error`: the tables against the exact split, by which relative metrics also divide;
//! - `split_error`: the truth (method `reference`) against the exact split, in the same metric;
//! - `share`: the first over the second.
//!
//! A *combination* is one value of each swept setting of tables. It is *enough* at an alpha if its
//! share is at most [`enough`] in every condition: the split itself then causes the error. The
//! answer is the combination with the fewest texels that is enough from some alpha on, down to the
//! smallest alpha where one is; among equal ones the one with the fewest samples, then the smallest
//! worst share.

use super::prelude::*;
use crate::bake::plain::SETTINGS;
use crate::draw::markdown::significant;
use crate::instrument::metrics::ALL_VIEWS;
use crate::instrument::precompute::PrecomputeSettings;
use crate::instrument::shade::{EXACT_SPLIT, REFERENCE};
use std::collections::HashMap;

pub const QUESTION: Question = Question {
    name: "tables",
    asks: "Which tables should a renderer ship, and from which roughness on are they good enough?",
    columns: &[
        SEEN_FROM,
        SEEN_TO,
        column(
            "error",
            "Error against the split sum with exact factors; relative metrics divide by that \
             split.",
        ),
        column(
            "split_error",
            "Error of the truth against the same split: the cost of the split itself.",
        ),
        column("share", "`error` over `split_error`."),
        column(
            "is_enough",
            "1 if the share is at most 0.1 of a mean square, 0.32 of a mean magnitude, else 0.",
        ),
        column(
            "texels",
            "Texels of all levels and faces of the prefiltered map and of the DFG table.",
        ),
        column(
            "is_resolved",
            "1 if the error is resolved against the reference's noise, else 0.",
        ),
    ],
    lacks,
    answer,
    ..Question::PLAIN
};

/// Largest share of the split's mean square error for tables that are enough: they add at most 5 %
/// to its root.
const SHARE: f64 = 0.1;

/// The same share in the metric of the question: a third for an error that is not a square.
fn enough(frame: &Frame) -> f64 {
    SHARE.powf(0.5 * frame.metric.power)
}

const TABLED: &str = "split-sum";

fn lacks(shape: &Shape) -> Option<&'static str> {
    let draws_truth = shape.methods().any(|method| method.name == REFERENCE);
    match () {
        () if shape.reference_method != EXACT_SPLIT => Some(
            "reference.method is not ladder-view: tables are compared with the split sum with \
             exact factors",
        ),
        () if !draws_truth => {
            Some("axes.method has no `reference`, which gives the cost of the split itself")
        }
        () if !shape.methods().any(|method| method.name == TABLED) => {
            Some("axes.method has no `split-sum`")
        }
        () if shape
            .methods()
            .any(|method| method.uses_prefiltered() && method.name != TABLED) =>
        {
            Some(
                "axes.method has a split sum other than `split-sum`, whose limit `ladder-view` is \
                 not",
            )
        }
        () => parameters(shape)
            .is_empty()
            .then_some("no setting of a table has two values"),
    }
}

fn parameters(shape: &Shape) -> Vec<AxisId> {
    AXES.ids()
        .filter(|&axis| AXES[axis].part == Part::Table && shape.is_swept(axis))
        .collect()
}

struct Tried<'r, 'f> {
    row: &'r Row<'f>,
    seen: [f64; 2],
    /// Values of the parameters.
    tables: Key,
    error: f64,
    is_resolved: bool,
    split: f64,
}

impl Tried<'_, '_> {
    fn share(&self) -> f64 {
        self.error / self.split
    }

    fn texels(&self) -> f64 {
        texels(&self.row.point.settings().shading.precompute)
    }

    /// Samples of its prefiltered map; 0 for harmonics.
    fn samples(&self) -> f64 {
        self.row
            .point
            .settings()
            .shading
            .precompute
            .samples_of("prefilter")
            .unwrap_or(0.0)
    }
}

/// Texels of all levels and faces of the prefiltered map and of the DFG table.
fn texels(settings: &PrecomputeSettings) -> f64 {
    let [width, height] = settings.prefilter_size.map(f64::from);
    // Each level has a quarter of the texels of the one before.
    let levels = (0..settings.prefilter_level_count)
        .map(|level| 0.25_f64.powi(level as i32))
        .sum::<f64>();
    f64::from(settings.layout.face_count) * width * height * levels
        + f64::from(settings.dfg_size).powi(2)
}

fn tried<'r, 'f>(
    frame: &Frame,
    images: &[&'r Row<'f>],
    parameters: &[AxisId],
) -> Vec<Tried<'r, 'f>> {
    let mut all = seen_at(frame, images, parameters, ALL_VIEWS);
    for (seen, run) in frame.views(images) {
        all.extend(seen_at(
            &frame.like(&run, frame.metric_name()),
            images,
            parameters,
            seen,
        ));
    }
    all
}

fn seen_at<'r, 'f>(
    frame: &Frame,
    images: &[&'r Row<'f>],
    parameters: &[AxisId],
    seen: [f64; 2],
) -> Vec<Tried<'r, 'f>> {
    // Of these views, while `images` has the scores of all.
    let own = |row: &Row| {
        Some((
            row.cell.id.clone(),
            (frame.error(row)?, frame.is_resolved(row)),
        ))
    };
    let errors: HashMap<String, (f64, bool)> = frame.rows.iter().filter_map(own).collect();
    let error = |row: &Row| errors.get(&row.cell.id).copied();
    let of_truth = |row: &Row, truth: &Row| {
        let is_case = |axis: &AxisId| AXES[*axis].part == Part::Case;
        AXES.ids()
            .filter(is_case)
            .all(|axis| fits(&row.key(&[axis]), &truth.key(&[axis])))
    };
    let truths: Vec<&&Row> = images
        .iter()
        .filter(|row| row.text(METHOD) == REFERENCE)
        .collect();
    let one = |&row: &&'r Row<'f>| {
        let tables = row.key(parameters);
        let (split, _) = error(truths.iter().find(|truth| of_truth(row, truth))?)?;
        let (error, is_resolved) = error(row)?;
        let is_asked = tables.iter().any(|value| *value != Value::Unset);
        is_asked.then_some(Tried {
            row,
            seen,
            tables,
            error,
            is_resolved,
            split,
        })
    };
    images
        .iter()
        .filter_map(one)
        .filter(|one| one.share().is_finite())
        .collect()
}

struct Combination<'t, 'r, 'f> {
    tables: Key,
    own: Vec<&'t Tried<'r, 'f>>,
}

impl Combination<'_, '_, '_> {
    fn worst(&self) -> &Tried<'_, '_> {
        self.own
            .iter()
            .max_by(|a, b| a.share().total_cmp(&b.share()))
            .expect("a group has a row")
    }

    /// Numbers over all views, at one value of an axis.
    fn numbers(&self, at: &Value, axis: AxisId, of: fn(&Tried) -> f64) -> Numbers<'_, '_> {
        let is_here = |one: &&&Tried| one.seen == ALL_VIEWS && one.row.point[axis] == *at;
        let all_views = self.own.iter().filter(is_here);
        Numbers::new(
            all_views.map(|one| (one.row, of(one))),
            Middle::GeometricMean,
        )
    }
}

/// The combinations that were tried in all conditions of these rows, the smallest first.
fn combinations<'t, 'r, 'f>(
    own: impl Iterator<Item = &'t Tried<'r, 'f>>,
) -> Vec<Combination<'t, 'r, 'f>> {
    let groups = grouped(own, |one| one.tables.clone());
    let most = groups.iter().map(|(_, own)| own.len()).max();
    let whole = groups
        .into_iter()
        .filter(|(_, own)| Some(own.len()) == most);
    let mut all: Vec<_> = whole
        .map(|(tables, own)| Combination { tables, own })
        .collect();
    let [texels, samples]: [fn(&Combination) -> f64; 2] =
        [|one| one.worst().texels(), |one| one.worst().samples()];
    let by_size = |a: &Combination, b: &Combination| {
        texels(a)
            .total_cmp(&texels(b))
            .then(samples(a).total_cmp(&samples(b)))
    };
    all.sort_by(|a, b| by_size(a, b).then(a.worst().share().total_cmp(&b.worst().share())));
    all
}

/// The smallest combination that is enough, else the one with the smallest worst share.
fn chosen<'c, 't, 'r, 'f>(
    enough: f64,
    all: &'c [Combination<'t, 'r, 'f>],
) -> Option<&'c Combination<'t, 'r, 'f>> {
    let by_worst =
        |a: &&Combination, b: &&Combination| a.worst().share().total_cmp(&b.worst().share());
    all.iter()
        .find(|one| one.worst().share() <= enough)
        .or_else(|| all.iter().min_by(by_worst))
}

/// In percent; with a third digit if it is not enough, so that 10.5 % does not read as 10 %.
fn share_text(enough: f64, share: f64) -> String {
    if share > enough {
        format!("{} %", significant(100.0 * share, 3))
    } else {
        percent(share)
    }
}

/// "qwantani, alpha 0.1, n·v 0.8 to 1".
fn place(frame: &Frame, one: &Tried, axes: &[AxisId]) -> String {
    let label = frame.names.label(axes, &one.row.key(axes));
    let seen = (one.seen != ALL_VIEWS).then(|| view(one.seen));
    [label]
        .into_iter()
        .filter(|label| !label.is_empty())
        .chain(seen)
        .collect::<Vec<_>>()
        .join(", ")
}

/// "64x64, 6 levels".
fn words(frame: &Frame, parameters: &[AxisId], tables: &Key) -> String {
    let set = parameters
        .iter()
        .zip(tables)
        .filter(|(_, value)| **value != Value::Unset);
    set.map(|(&axis, value)| frame.names.said(axis, value))
        .collect::<Vec<_>>()
        .join(", ")
}

fn answer(frame: &Frame) -> Option<Finding> {
    let (parameters, images) = (parameters(&frame.shape), frame.images());
    let scope: Vec<AxisId> = frame
        .case_axes()
        .into_iter()
        .filter(|axis| !parameters.contains(axis))
        .collect();
    let tried = tried(frame, &images, &parameters);
    let columns = frame
        .table_axes()
        .into_iter()
        .filter(|axis| !parameters.contains(axis));
    let axes: Vec<AxisId> = std::iter::once(METHOD)
        .chain(columns)
        .chain(parameters.iter().copied())
        .collect();
    let mut table = Table::new(&axes, QUESTION.columns);
    for one in &tried {
        let is_enough = one.share() <= enough(frame);
        let own = cells![
            one.seen[0],
            one.seen[1],
            one.error,
            one.split,
            one.share(),
            is_enough,
            one.texels()
        ];
        let own = [own, cells![one.is_resolved]].concat();
        table.row([one.row.cells(&axes), own].concat());
    }
    let all: Vec<&Tried> = tried.iter().collect();
    let rows = grouped_ascending(all.iter().copied(), frame.row_axis(), |one| one.row);
    let tails: Vec<Tail> = (0..rows.len())
        .map(|place| Tail {
            from: rows[place].0.clone(),
            all: combinations(
                rows[place..]
                    .iter()
                    .flat_map(|(_, own)| own.iter().copied()),
            ),
        })
        .collect();
    Some(Finding {
        sentence: sentence(frame, &parameters, &tails)?,
        digest: Some(digest(frame, &parameters, &scope, &tails)),
        figure: figure(frame, &parameters, &all),
        table,
    })
}

/// Combinations over one value of [`Frame::row_axis`] and all greater ones. A renderer ships one
/// set of tables for all widths, and a level that happens to lie at one width must not decide.
struct Tail<'t, 'r, 'f> {
    from: Value,
    all: Vec<Combination<'t, 'r, 'f>>,
}

fn sentence(frame: &Frame, parameters: &[AxisId], tails: &[Tail]) -> Option<String> {
    let (metric, enough) = (frame.metric_name(), enough(frame));
    let best = chosen(enough, &tails.first()?.all)?;
    let words = |one: &Combination| words(frame, parameters, &one.tables);
    // A share within the reference's noise is an upper bound.
    let reached = |one: &Combination| {
        let worst = one.worst();
        let bound = if worst.is_resolved { "" } else { "at most " };
        let place = place(
            frame,
            worst,
            &distinct_in_order([ENVIRONMENT, frame.row_axis()]),
        );
        format!("{bound}{} ({place})", share_text(enough, worst.share()))
    };
    let shipped = |tail: &Tail| {
        tail.all
            .iter()
            .position(|one| one.worst().share() <= enough)
    };
    let first = tails
        .iter()
        .enumerate()
        .find_map(|(place, tail)| Some((place, &tail.all[shipped(tail)?])));
    let (text, ship) = match first {
        Some((0, one)) => (
            format!(
                "Ship **{}**: their `{metric}` is at most {} of the split's own.",
                words(one),
                reached(one)
            ),
            one,
        ),
        Some((place, one)) => {
            let from = frame.names.heading(frame.row_axis(), &tails[place].from);
            let share = share_text(enough, one.worst().share());
            let ship = format!(
                "From {from} on, ship **{}**: at most {share} of the split's `{metric}`.",
                words(one)
            );
            (
                format!(
                    "{ship} Below that, the best tables add {}: {}.",
                    reached(best),
                    words(best)
                ),
                one,
            )
        }
        None => {
            let part = if frame.metric.power == 2.0 {
                "a tenth"
            } else {
                "a third"
            };
            let none =
                format!("No tried tables err by {part} of the split's own `{metric}` or less.");
            (
                format!("{none} The best add {}: {}.", reached(best), words(best)),
                best,
            )
        }
    };
    Some(format!(
        "{text} To bake them: {}.",
        command(parameters, &ship.tables)
    ))
}

/// "`splitsum bake MAP --out DIR --set prefilter_size=64x64`".
fn command(parameters: &[AxisId], tables: &Key) -> String {
    let set = parameters
        .iter()
        .zip(tables)
        .filter(|(axis, value)| SETTINGS.contains(&AXES[**axis].name) && **value != Value::Unset);
    let set: String = set
        .map(|(&axis, value)| format!(" --set {}={value}", AXES[axis].name))
        .collect();
    format!("`splitsum bake MAP --out DIR{set}`")
}

/// One row per value of [`Frame::row_axis`]: the smallest tables that are enough there and at all
/// greater values, their error and the split's there, and their largest share.
fn digest(frame: &Frame, parameters: &[AxisId], scope: &[AxisId], tails: &[Tail]) -> Table {
    let of = frame.row_axis();
    let heads = frame.names.heads(&[of]);
    let names = [
        "smallest tables that are enough from here on",
        "their error here, geometric mean over all n·v",
        "the split's own error, the same mean",
        "share at most, from here on",
        "where",
    ];
    let mut table = Table::with_names(heads.iter().copied().chain(names));
    let enough = enough(frame);
    for Tail { from, all } in tails {
        let Some(best) = chosen(enough, all) else {
            continue;
        };
        let worst = best.worst();
        let mean_text = |number| {
            best.numbers(from, of, number)
                .estimate()
                .map(|mean| with_rms(frame, mean.value))
        };
        let tables = words(frame, parameters, &best.tables);
        let tables = if worst.share() <= enough {
            tables
        } else {
            format!("none; best {tables}")
        };
        let errors = cells![mean_text(|one| one.error), mean_text(|one| one.split)];
        let worst = cells![
            share_text(enough, worst.share()),
            self::place(frame, worst, scope)
        ];
        let head = if *from == Value::Unset {
            all_head(&heads)
        } else {
            frame.names.head_of(of, from)
        };
        table.row([head, cells![tables], errors, worst].concat());
    }
    table
}

/// One panel per value of [`Frame::row_axis`], one dot per combination at its worst condition; dots
/// of one kind are joined.
fn figure(frame: &Frame, parameters: &[AxisId], all: &[&Tried]) -> Option<Figure> {
    let is_kind = |axis: &AxisId| {
        frame.shape.values[*axis]
            .iter()
            .all(|value| matches!(value, Value::Text(_)))
    };
    let kinds: Vec<AxisId> = parameters.iter().copied().filter(is_kind).collect();
    let kind = |one: &Tried| {
        let words: Vec<String> = kinds
            .iter()
            .map(|&axis| frame.names.short(axis, &one.row.point[axis]))
            .collect();
        words.join(" · ")
    };
    let series = distinct_in_order(all.iter().map(|one| kind(one)));
    let panel = |(width, own): (Value, Vec<&Tried>)| {
        let mut marks = vec![Mark::neutral(Form::HorizontalRule(enough(frame)))];
        let all = combinations(own.iter().copied());
        for (place, name) in series.iter().enumerate() {
            let mut of_kind: Vec<&Tried> = all
                .iter()
                .map(Combination::worst)
                .filter(|worst| kind(worst) == *name)
                .collect();
            // Of tables that differ by their small levels or DFG, the best.
            let size = |one: &Tried| one.texels().log2().round();
            of_kind.sort_by(|a, b| {
                size(a)
                    .total_cmp(&size(b))
                    .then(a.share().total_cmp(&b.share()))
            });
            of_kind.dedup_by_key(|one| size(one));
            let dots = of_kind.into_iter().map(|worst| {
                let share = percent(worst.share());
                let at = self::place(frame, worst, &[ENVIRONMENT]);
                let tip = format!(
                    "{}: {share} of the split's error · {at}",
                    words(frame, parameters, &worst.tables)
                );
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
            "{} of the best tables of each size over the error of the split itself, worst \
             condition; below the line the split dominates",
            frame.metric_name()
        ),
        x: Along::Log("texels"),
        y: Along::Log("share of the split's error"),
        panels: by_width.into_iter().map(panel).collect(),
        series,
    }
    .figure()
}
