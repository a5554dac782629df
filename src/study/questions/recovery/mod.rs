//! Which material does each method recover from photos?
//!
//! Photos are exact images of a known material. A method explains them by its own images of another
//! roughness and F0 (`instrument::recovery`); the difference is the bias that an inverse renderer
//! with this method has. The environment is the unit of evidence: each has one fit of a surface,
//! pooled over its orientations.

mod figure;
mod sentences;

use super::prelude::*;
use crate::base::names::Listed;
use crate::instrument::metrics::ALL_VIEWS;
use crate::instrument::shade::{Method, Role};
use crate::study::finished::RecoveredRow;
use std::collections::HashMap;

pub const QUESTION: Question = Question {
    name: "recovery",
    asks: "Which material does each method recover from photos?",
    columns: &[
        column("loss", "The loss of the fit: docs/recovery.md, \"Losses\"."),
        super::N_DOT_V_FROM,
        super::N_DOT_V_TO,
        column("n", "Number of environments, each with one fit."),
        column(
            "recovered_roughness",
            "Recovered perceptual roughness, median over environments.",
        ),
        column("recovered_roughness_lo", "Lower end of its 95 % interval."),
        column("recovered_roughness_hi", super::UPPER),
        column(
            "new_roughness_lo",
            "Lower end of the 95 % prediction of the recovered roughness under one new environment.",
        ),
        column("new_roughness_hi", "Upper end of that prediction."),
        column("bias", "Recovered minus true roughness, of the median."),
        column(
            "least_roughness",
            "Least recovered roughness of an environment.",
        ),
        column(
            "most_roughness",
            "Largest recovered roughness of an environment.",
        ),
        column(
            "f0_ratio",
            "Recovered over true F0, median over environments.",
        ),
        column("f0_ratio_lo", "Lower end of its 95 % interval."),
        column("f0_ratio_hi", super::UPPER),
        column(
            "new_f0_ratio_lo",
            "Lower end of the 95 % prediction of this ratio under one new environment.",
        ),
        column("new_f0_ratio_hi", "Upper end of that prediction."),
        column(
            "nearer_roughness",
            "Environments whose roughness is nearer to the truth than the textbook's; empty for the \
             textbook.",
        ),
        column(
            "nearer_f0",
            "Environments whose F0 is nearer to the truth than the textbook's; empty for the textbook.",
        ),
        column(
            "at_limit",
            "Environments whose fit ends at the least or largest width or F0.",
        ),
    ],
    needs_scores: false,
    is_weighted: false,
    has_rows: false,
    lacks: |shape| (!shape.has_recovery).then_some("the experiment has no [recovery]"),
    answer,
    ..Question::PLAIN
};

/// The fits of a method to one surface, over environments.
struct Recovered<'r, 'f> {
    truth: &'r Row<'f>,
    candidate: &'r Row<'f>,
    loss: &'f str,
    n_dot_v: [f64; 2],
    fits: Vec<LightFit<'f>>,
    roughness: Estimate,
    f0_ratio: Estimate,
    /// How many fits are nearer than the textbook's; `None` for the textbook.
    nearer: Option<Nearer>,
}

/// The fit under one environment.
struct LightFit<'f> {
    light: Value,
    row: &'f RecoveredRow,
}

#[derive(Clone, Copy, Default)]
struct Nearer {
    roughness: usize,
    f0: usize,
    /// Compared fits.
    of: usize,
}

impl Recovered<'_, '_> {
    fn true_roughness(&self) -> f64 {
        self.fits[0].row.true_roughness
    }

    /// Recovered minus true roughness.
    fn bias(&self) -> f64 {
        self.roughness.value - self.true_roughness()
    }

    fn at_limit_count(&self) -> usize {
        self.fits.iter().filter(|fit| fit.row.is_at_limit).count()
    }

    fn is_textbook(&self) -> bool {
        is_textbook(self.candidate)
    }
}

fn role(row: &Row) -> Option<Role> {
    Method::by_name(&row.text(METHOD)).and_then(Method::role)
}

fn is_textbook(row: &Row) -> bool {
    role(row) == Some(Role::Textbook)
}

/// Whether a renderer could use the candidate: not a step of the ladder.
fn has_role(row: &Row) -> bool {
    role(row).is_some()
}

/// The axes of a surface and its light, besides the environments.
fn truth_axes(frame: &Frame) -> Vec<AxisId> {
    let mut axes = vec![ALPHA, F0];
    let pooled = [ENVIRONMENT, ENVIRONMENT_ORIENTATION];
    axes.extend(frame.swept(&[Part::Case]));
    axes.retain(|axis| !pooled.contains(axis));
    distinct_in_order(axes)
}

/// The axes of a candidate.
fn candidate_axes(frame: &Frame) -> Vec<AxisId> {
    let mut axes = vec![METHOD];
    axes.extend(frame.swept(&[Part::Method, Part::Parameter, Part::Table]));
    distinct_in_order(axes)
}

/// The swept axes of a candidate besides its methods.
fn parameter_axes(frame: &Frame) -> Vec<AxisId> {
    let mut axes = candidate_axes(frame);
    axes.retain(|axis| ![METHOD, DIFFUSE_METHOD].contains(axis));
    axes
}

/// The candidate in words: its method and swept parameters.
fn candidate_name(frame: &Frame, row: &Row) -> String {
    commas([&row.text(METHOD), &parameters(frame, row)])
}

/// As [`candidate_name`], with the method's title for readers.
fn candidate_cell(frame: &Frame, row: &Row) -> Cell {
    let title = Variant::new(row.text(METHOD)).label();
    let name = NameAndLabel {
        name: candidate_name(frame, row),
        label: commas([&title, &parameters(frame, row)]),
    };
    name.into()
}

fn parameters(frame: &Frame, row: &Row) -> String {
    let axes = parameter_axes(frame);
    frame.names.comma_label(&axes, &row.key(&axes))
}

/// As [`candidate_name`], in a statement.
fn candidate_phrases(frame: &Frame, row: &Row) -> Statement {
    let axes = parameter_axes(frame);
    let method = statement![Phrase::Method(Variant::new(row.text(METHOD)))];
    let parameters = frame.names.comma_phrases(&axes, &row.key(&axes));
    let phrases = [method, parameters].into_iter();
    Statement::joined(phrases.filter(|phrase| !phrase.is_empty()), ", ")
}

/// What the fits of one [`Recovered`] share.
#[derive(PartialEq, Eq, Hash)]
struct Shared<'f> {
    truth: Key,
    candidate: Key,
    loss: &'f str,
    /// Bits of the ends.
    n_dot_v: [u64; 2],
}

fn all_recovered<'r, 'f>(frame: &'r Frame<'f>) -> Vec<Recovered<'r, 'f>> {
    let mut row_of: HashMap<&str, &Row> = HashMap::new();
    for row in &frame.rows {
        for id in std::iter::once(&*row.cell.id).chain(row.copies.iter().copied()) {
            row_of.insert(id, row);
        }
    }
    let (truth_axes, candidate_axes) = (truth_axes(frame), candidate_axes(frame));
    let rows = frame.run.recovered.iter().filter_map(|row| {
        let truth = *row_of.get(row.truth.as_str())?;
        let candidate = *row_of.get(row.candidate.as_str())?;
        Some((row, truth, candidate))
    });
    let shared = |(row, truth, candidate): &(&'f RecoveredRow, &Row, &Row)| Shared {
        truth: truth.key(&truth_axes),
        candidate: candidate.key(&candidate_axes),
        loss: &row.loss,
        n_dot_v: row.n_dot_v.map(f64::to_bits),
    };
    let mut all = Vec::new();
    for (shared, rows) in grouped(rows, shared) {
        let (_, truth, candidate) = rows[0];
        let fits = rows.into_iter().map(|(row, truth, _)| LightFit {
            light: truth.point[ENVIRONMENT].clone(),
            row,
        });
        all.extend(recovered(shared, truth, candidate, fits.collect()));
    }
    count_nearer(&mut all, &truth_axes);
    all
}

fn recovered<'r, 'f>(
    shared: Shared<'f>,
    truth: &'r Row<'f>,
    candidate: &'r Row<'f>,
    fits: Vec<LightFit<'f>>,
) -> Option<Recovered<'r, 'f>> {
    let of = |number: fn(&RecoveredRow) -> f64| {
        let numbers = fits.iter().map(|fit| (fit.light.clone(), number(fit.row)));
        estimate(&numbers.collect::<Vec<_>>(), Middle::Median)
    };
    Some(Recovered {
        truth,
        candidate,
        loss: shared.loss,
        n_dot_v: shared.n_dot_v.map(f64::from_bits),
        roughness: of(|row| row.roughness)?,
        f0_ratio: of(|row| row.f0 / row.true_f0)?,
        nearer: None,
        fits,
    })
}

/// Compares each fit with the textbook's of the same photos.
fn count_nearer(all: &mut [Recovered], truth_axes: &[AxisId]) {
    let place = |one: &Recovered| {
        let bits = one.n_dot_v.map(f64::to_bits);
        (one.truth.key(truth_axes), one.loss.to_owned(), bits)
    };
    let mut textbook: HashMap<_, HashMap<Value, &RecoveredRow>> = HashMap::new();
    for one in all.iter().filter(|one| one.is_textbook()) {
        let fits = one.fits.iter().map(|fit| (fit.light.clone(), fit.row));
        textbook.entry(place(one)).or_insert_with(|| fits.collect());
    }
    for one in all.iter_mut().filter(|one| !one.is_textbook()) {
        let Some(rivals) = textbook.get(&place(one)) else {
            continue;
        };
        let mut nearer = Nearer::default();
        for fit in &one.fits {
            let Some(rival) = rivals.get(&fit.light) else {
                continue;
            };
            let [own, other] = [fit.row, rival];
            let roughness_error = |row: &RecoveredRow| (row.roughness - row.true_roughness).abs();
            let f0_error = |row: &RecoveredRow| (row.f0 - row.true_f0).abs();
            nearer.roughness += usize::from(roughness_error(own) < roughness_error(other));
            nearer.f0 += usize::from(f0_error(own) < f0_error(other));
            nearer.of += 1;
        }
        one.nearer = Some(nearer);
    }
}

/// The fits that sentences and digest show: to whole photos of the first surface at every
/// roughness, by the first loss. Roughness ascending within each candidate.
fn leading<'a, 'r, 'f>(
    frame: &Frame,
    all: &'a [Recovered<'r, 'f>],
    loss: &str,
) -> Vec<&'a Recovered<'r, 'f>> {
    let mut axes = truth_axes(frame);
    axes.retain(|axis| *axis != ALPHA);
    let surface = all.first().map(|one| one.truth.key(&axes));
    let is_leading = |one: &&Recovered| {
        one.loss == loss && one.n_dot_v == ALL_VIEWS && Some(one.truth.key(&axes)) == surface
    };
    let by_candidate = grouped(all.iter().filter(is_leading), |one| {
        candidate_name(frame, one.candidate)
    });
    let mut found = Vec::new();
    for (_, mut fits) in by_candidate {
        fits.sort_by(|a, b| a.true_roughness().total_cmp(&b.true_roughness()));
        found.extend(fits);
    }
    found
}

fn answer(frame: &Frame) -> Option<Finding> {
    let all = all_recovered(frame);
    let lead = leading(frame, &all, all.first()?.loss);
    Some(Finding {
        sentences: sentences::sentences(frame, &lead)?,
        table: table(frame, &all),
        digest: Some(digest(frame, &lead)),
        figure: figure::figure(frame, &all),
    })
}

fn table(frame: &Frame, all: &[Recovered]) -> Table {
    let (truth_axes, candidate_axes) = (truth_axes(frame), candidate_axes(frame));
    // The diffuse method of photos is a reference, too.
    let axes = [&truth_axes[..], &candidate_axes[..]].concat();
    let mut table = Table::new(&axes, QUESTION.columns);
    for one in all {
        let mut row = one.truth.cells(&truth_axes);
        row.extend(one.candidate.cells(&candidate_axes));
        row.extend(cells![
            one.loss,
            one.n_dot_v[0],
            one.n_dot_v[1],
            one.fits.len()
        ]);
        row.push(one.roughness.value.into());
        row.extend(ends(one.roughness.interval));
        row.extend(ends(one.roughness.prediction));
        row.extend(cells![
            one.bias(),
            one.roughness.ends[0],
            one.roughness.ends[1]
        ]);
        row.push(one.f0_ratio.value.into());
        row.extend(ends(one.f0_ratio.interval));
        row.extend(ends(one.f0_ratio.prediction));
        row.extend(cells![
            one.nearer.map(|nearer| nearer.roughness),
            one.nearer.map(|nearer| nearer.f0),
            one.at_limit_count()
        ]);
        table.row(row);
    }
    table
}

/// Missing with too few environments.
fn ends(interval: Option<[f64; 2]>) -> [Cell; 2] {
    match interval {
        Some(ends) => ends.map(Cell::from),
        None => [Cell::Missing, Cell::Missing],
    }
}

/// One row per candidate and true roughness, and one over all.
fn digest(frame: &Frame, lead: &[&Recovered]) -> Table {
    let mut heads = vec![AXES[METHOD].name];
    heads.extend(frame.names.heads(&[ALPHA]));
    heads.extend([
        "recovered roughness",
        "F0, times the true",
        "nearer roughness",
        "nearer F0",
        "at a limit",
    ]);
    let alpha_columns = frame.names.heads(&[ALPHA]).len();
    let mut table = Table::with_names(heads);
    let by_candidate = grouped(lead.iter().copied(), |one| {
        candidate_name(frame, one.candidate)
    });
    for (_, fits) in by_candidate {
        let name = candidate_cell(frame, fits[0].candidate);
        for one in &fits {
            let mut row = cells![name.clone()];
            row.extend(frame.names.head_of(ALPHA, &one.truth.point[ALPHA]));
            row.extend(cells![estimated(&one.roughness), estimated(&one.f0_ratio)]);
            row.extend(counts(one.nearer, one.at_limit_count(), one.fits.len()));
            table.row(row);
        }
        let mut row = cells![name, ALL];
        row.resize(1 + alpha_columns, Cell::Missing);
        row.extend([Cell::Missing, Cell::Missing]);
        let [at_limit, of] = [
            fits.iter().map(|one| one.at_limit_count()).sum(),
            fits.iter().map(|one| one.fits.len()).sum(),
        ];
        row.extend(counts(nearer_of_all(&fits), at_limit, of));
        table.row(row);
    }
    table.without_empty()
}

/// "9 of 10" nearer in roughness and in F0, and at a limit.
fn counts(nearer: Option<Nearer>, at_limit: usize, of: usize) -> [Cell; 3] {
    let words = |count: usize, of: usize| Cell::quantity(format!("{count} of {of}"));
    [
        nearer.map_or(Cell::Missing, |nearer| words(nearer.roughness, nearer.of)),
        nearer.map_or(Cell::Missing, |nearer| words(nearer.f0, nearer.of)),
        words(at_limit, of),
    ]
}

/// The sum over surfaces; `None` for the textbook.
fn nearer_of_all(fits: &[&Recovered]) -> Option<Nearer> {
    let all: Option<Vec<Nearer>> = fits.iter().map(|one| one.nearer).collect();
    Some(all?.into_iter().fold(Nearer::default(), |a, b| Nearer {
        roughness: a.roughness + b.roughness,
        f0: a.f0 + b.f0,
        of: a.of + b.of,
    }))
}
