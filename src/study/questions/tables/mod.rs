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

mod figure;
mod sentences;

use super::prelude::*;
use crate::instrument::metrics::ALL_VIEWS;
use crate::instrument::precompute::PrecomputeSettings;
use crate::instrument::shade::{EXACT_SPLIT, REFERENCE};
use figure::figure;
use sentences::sentences;
use std::collections::HashMap;

pub const QUESTION: Question = Question {
    name: "tables",
    asks: "Which tables should a renderer ship, and from which roughness on are they good enough?",
    columns: &[
        N_DOT_V_FROM,
        N_DOT_V_TO,
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
    let has_method = |name: &str| shape.methods().any(|method| method.name == name);
    let has_other_split = shape
        .methods()
        .any(|method| method.uses_prefiltered() && method.name != TABLED);
    if shape.reference_method != EXACT_SPLIT {
        Some(
            "reference.method is not ladder-view: tables are compared with the split sum with \
             exact factors",
        )
    } else if !has_method(REFERENCE) {
        Some("axes.method has no `reference`, which gives the cost of the split itself")
    } else if !has_method(TABLED) {
        Some("axes.method has no `split-sum`")
    } else if has_other_split {
        Some(
            "axes.method has a split sum other than `split-sum`, whose limit `ladder-view` is \
             not",
        )
    } else if parameters(shape).is_empty() {
        Some("no setting of a table has two values")
    } else {
        None
    }
}

fn parameters(shape: &Shape) -> Vec<AxisId> {
    AXES.ids()
        .filter(|&axis| AXES[axis].part == Part::Table && shape.is_swept(axis))
        .collect()
}

/// Tables in one condition.
struct Measured<'r, 'f> {
    row: &'r Row<'f>,
    /// The band of n·v.
    n_dot_v: [f64; 2],
    /// Values of the parameters.
    tables: Key,
    error: f64,
    is_resolved: bool,
    split_error: f64,
}

impl Measured<'_, '_> {
    fn share(&self) -> f64 {
        self.error / self.split_error
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

    /// "qwantani, alpha 0.1, n·v 0.8 to 1".
    fn condition(&self, frame: &Frame, axes: &[AxisId]) -> String {
        let label = frame.names.label(axes, &self.row.key(axes));
        if self.n_dot_v == ALL_VIEWS {
            label
        } else {
            commas([&label, &n_dot_v_words(self.n_dot_v)])
        }
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

/// Every table in every condition: over all views, then band by band.
fn measured<'r, 'f>(
    frame: &Frame,
    images: &[&'r Row<'f>],
    parameters: &[AxisId],
) -> Vec<Measured<'r, 'f>> {
    let mut all = measured_in(frame, images, parameters, ALL_VIEWS);
    for (n_dot_v, run) in frame.runs_by_n_dot_v(images) {
        let frame = frame.like(&run, frame.metric_name());
        all.extend(measured_in(&frame, images, parameters, n_dot_v));
    }
    all
}

/// The tables in one band of n·v, of whose pixels `frame` has the scores, while `images` has the
/// scores of all pixels.
fn measured_in<'r, 'f>(
    frame: &Frame,
    images: &[&'r Row<'f>],
    parameters: &[AxisId],
    n_dot_v: [f64; 2],
) -> Vec<Measured<'r, 'f>> {
    let rows: HashMap<&str, &Row> = frame.rows.iter().map(|row| (&*row.cell.id, row)).collect();
    let error = |row: &Row| frame.error(rows.get(&*row.cell.id)?);
    let truths: Vec<&Row> = images
        .iter()
        .copied()
        .filter(|row| row.text(METHOD) == REFERENCE)
        .collect();
    let one = |row: &'r Row<'f>| {
        let tables = row.key(parameters);
        if tables.iter().all(|value| *value == Value::Unset) {
            return None;
        }
        let truth = truths.iter().find(|truth| is_same_case(row, truth))?;
        Some(Measured {
            row,
            n_dot_v,
            tables,
            error: error(row)?,
            is_resolved: frame.is_resolved(rows.get(&*row.cell.id)?),
            split_error: error(truth)?,
        })
    };
    images
        .iter()
        .filter_map(|row| one(row))
        .filter(|one| one.share().is_finite())
        .collect()
}

/// Whether two rows agree on all axes of cases.
fn is_same_case(row: &Row, truth: &Row) -> bool {
    let mut axes = AXES.ids().filter(|axis| AXES[*axis].part == Part::Case);
    axes.all(|axis| agree(&row.key(&[axis]), &truth.key(&[axis])))
}

/// One value of each parameter.
struct Combination<'t, 'r, 'f> {
    tables: Key,
    /// One for each condition; at least one.
    measured: Vec<&'t Measured<'r, 'f>>,
}

impl Combination<'_, '_, '_> {
    fn worst(&self) -> &Measured<'_, '_> {
        self.measured
            .iter()
            .max_by(|a, b| a.share().total_cmp(&b.share()))
            .expect("a group has a row")
    }

    /// Whether its share is at most `enough` in every condition.
    fn is_enough(&self, enough: f64) -> bool {
        self.worst().share() <= enough
    }

    /// Numbers over all views, at one value of an axis.
    fn numbers(
        &self,
        axis: AxisId,
        value: &Value,
        number: fn(&Measured) -> f64,
    ) -> Numbers<'_, '_> {
        let measured = self.measured.iter();
        let measured =
            measured.filter(|one| one.n_dot_v == ALL_VIEWS && one.row.point[axis] == *value);
        Numbers::new(
            measured.map(|one| (one.row, number(one))),
            Middle::GeometricMean,
        )
    }

    /// By texels, then samples, then the worst share.
    fn by_size(&self, other: &Self) -> std::cmp::Ordering {
        let [a, b] = [self.worst(), other.worst()];
        a.texels()
            .total_cmp(&b.texels())
            .then(a.samples().total_cmp(&b.samples()))
            .then(a.share().total_cmp(&b.share()))
    }
}

/// The combinations that were tried in all conditions of these rows, the smallest first.
fn combinations<'t, 'r, 'f>(
    measured: impl Iterator<Item = &'t Measured<'r, 'f>>,
) -> Vec<Combination<'t, 'r, 'f>> {
    let groups = grouped(measured, |one| one.tables.clone());
    let most = groups.iter().map(|(_, measured)| measured.len()).max();
    let mut all: Vec<Combination> = groups
        .into_iter()
        .filter(|(_, measured)| Some(measured.len()) == most)
        .map(|(tables, measured)| Combination { tables, measured })
        .collect();
    all.sort_by(Combination::by_size);
    all
}

/// The smallest combination that is enough, else the one with the smallest worst share.
fn chosen<'c, 't, 'r, 'f>(
    enough: f64,
    all: &'c [Combination<'t, 'r, 'f>],
) -> Option<&'c Combination<'t, 'r, 'f>> {
    all.iter().find(|one| one.is_enough(enough)).or_else(|| {
        all.iter()
            .min_by(|a, b| a.worst().share().total_cmp(&b.worst().share()))
    })
}

/// In percent; with a third digit if it is not enough, so that 10.5 % does not read as 10 %.
fn share_number(enough: f64, share: f64) -> Number {
    if share > enough {
        Number::Share { share, digits: 3 }
    } else {
        Number::share(share)
    }
}

/// "64x64, 6 levels".
fn words(frame: &Frame, parameters: &[AxisId], tables: &Key) -> String {
    let mut words = Vec::new();
    for (&axis, value) in parameters.iter().zip(tables) {
        if *value != Value::Unset {
            words.push(frame.names.in_sentence(axis, value));
        }
    }
    words.join(", ")
}

fn answer(frame: &Frame) -> Option<Finding> {
    let parameters = parameters(&frame.shape);
    let images = frame.images();
    let measured = measured(frame, &images, &parameters);
    let all: Vec<&Measured> = measured.iter().collect();
    let rows = grouped_ascending(all.iter().copied(), frame.row_axis(), |one| one.row);
    let tails: Vec<Tail> = (0..rows.len())
        .map(|start| {
            let tail = rows[start..].iter().flat_map(|(_, measured)| measured);
            Tail {
                from: rows[start].0.clone(),
                all: combinations(tail.copied()),
            }
        })
        .collect();
    let mut scope = frame.case_axes();
    scope.retain(|axis| !parameters.contains(axis));
    Some(Finding {
        sentences: sentences(frame, &parameters, &tails)?,
        table: table(frame, &parameters, &measured),
        digest: Some(digest(frame, &parameters, &scope, &tails)),
        figure: figure(frame, &parameters, &all),
    })
}

fn table(frame: &Frame, parameters: &[AxisId], measured: &[Measured]) -> Table {
    let mut axes = frame.table_axes();
    axes.retain(|axis| !parameters.contains(axis));
    axes.insert(0, METHOD);
    axes.extend(parameters);
    let mut table = Table::new(&axes, QUESTION.columns);
    for one in measured {
        let mut row = one.row.cells(&axes);
        row.extend(cells![
            one.n_dot_v[0],
            one.n_dot_v[1],
            one.error,
            one.split_error,
            one.share(),
            one.share() <= enough(frame),
            one.texels(),
            one.is_resolved
        ]);
        table.row(row);
    }
    table
}

/// Combinations over one value of [`Frame::row_axis`] and all greater ones. A renderer ships one
/// set of tables for all widths, and a level that happens to lie at one width must not decide.
struct Tail<'t, 'r, 'f> {
    from: Value,
    all: Vec<Combination<'t, 'r, 'f>>,
}

/// One row per value of [`Frame::row_axis`]: the smallest tables that are enough there and at all
/// greater values, their error and the split's there, and their largest share.
fn digest(frame: &Frame, parameters: &[AxisId], scope: &[AxisId], tails: &[Tail]) -> Table {
    let row_axis = frame.row_axis();
    let heads = frame.names.heads(&[row_axis]);
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
        let mean = |number| {
            let mean = best.numbers(row_axis, from, number).estimate()?;
            Some(Cell::quantity(with_rms(frame, mean.value)))
        };
        let tables = words(frame, parameters, &best.tables);
        let mut row = if *from == Value::Unset {
            all_head(&heads)
        } else {
            frame.names.head_of(row_axis, from)
        };
        row.extend(cells![
            if best.is_enough(enough) {
                tables
            } else {
                format!("none; best {tables}")
            },
            mean(|one| one.error),
            mean(|one| one.split_error),
            share_number(enough, worst.share()),
            worst.condition(frame, scope)
        ]);
        table.row(row);
    }
    table
}
