//! At which step does the error of the split sum arise?
//!
//! The approximations from an integral to the rendered image are steps (`crate::instrument::ladder`,
//! docs/estimators.md). The contribution of a step depends on the steps before it, so it has four
//! numbers: its covariance share in the ladder's order, the `relmse` that it adds first and removes
//! last, and its Shapley value, the mean over all orders (`ladder::attribution`).
//!
//! They are grouped by environment, model, alpha, f0 and n·v, from `steps.csv`. Means over
//! environments have Student's interval; if environments disagree about the sign, their range is
//! shown instead.

mod figure;
mod sentences;

use super::prelude::*;
use crate::base::numbers::round_to_significant;
use crate::instrument::ladder::BANDS;
use crate::instrument::metrics::ALL_VIEWS;
use crate::instrument::shade::REFERENCE;
use crate::study::finished::StepRow;
use figure::figure;
use sentences::sentences;

pub const QUESTION: Question = Question {
    name: "ladder",
    asks: "At which step does the error of the split sum arise?",
    columns: &[
        N_DOT_V_FROM,
        N_DOT_V_TO,
        column(
            "rung",
            "The approximation: see docs/estimators.md, \"The ladder\".",
        ),
        column(
            "share",
            "Covariance share of the error's `relmse`; shares of a case sum to 1, a negative one \
             cancels others. With \
             `environment` all: the mean over environments.",
        ),
        column(
            "share_lo",
            "Lower end of its 95 % interval over environments; empty for one environment.",
        ),
        column("share_hi", "Upper end of that interval."),
        column(
            "first_in",
            "`relmse` that the step adds if it comes first, after the steps that it needs.",
        ),
        column(
            "last_out",
            "`relmse` that vanishes if this step and the steps that need it become exact.",
        ),
        column(
            "shapley",
            "Mean of the step's added `relmse` over all legal orders; the numbers sum to the \
             error.",
        ),
        column(
            "error",
            "`relmse` after all steps. With `environment` all, all numbers are arithmetic means.",
        ),
        column(
            "step_error",
            "Relative standard error of the step: see `steps.csv`.",
        ),
    ],
    lacks,
    answer,
    is_weighted: false,
    ..Question::PLAIN
};

fn lacks(shape: &Shape) -> Option<&'static str> {
    let has_design = shape.values[SCENE]
        .iter()
        .any(|scene| is_design(&scene.to_string()));
    if !shape.has_ladder {
        Some("the experiment has no section [ladder]")
    } else if !shape.methods().any(|method| method.has_ladder) {
        Some("axes.method has no split-sum: only this method has steps")
    } else if !has_design {
        Some(
            "no scene is design, where every view sees the whole map; add it beside pictures: \
             design,my.obj",
        )
    } else if shape.reference_method != REFERENCE {
        Some("reference.method is not reference: steps lead from the integral")
    } else {
        None
    }
}

/// Significant digits, as in `steps.csv`.
const DIGITS: usize = 4;

/// Errors below this many times the reference's noise are ignored: under constant light the split
/// is exact.
const RESOLVED: f64 = 10.0;

const NOTHING: &str = "No error is above the reference's noise: there is nothing to attribute.";

/// The step that ignores the view: n = v = r.
const VIEW_STEP: &str = "view";

/// One step of one image over a band of n·v.
#[derive(Clone, Copy)]
struct Resolved<'r, 'f> {
    row: &'r Row<'f>,
    step: &'f StepRow,
    error: f64,
}

/// The steps of each band whose error is far above the noise of all its steps.
fn resolved<'r, 'f>(images: &[&'r Row<'f>]) -> Vec<Resolved<'r, 'f>> {
    let mut resolved = Vec::new();
    for row in images.iter().copied() {
        for (_, steps) in grouped(&*row.cell.steps, |step| step.n_dot_v.map(f64::to_bits)) {
            let error = steps.last().map_or(0.0, |last| last.rung_error);
            if steps.iter().all(|step| error > RESOLVED * step.noise) {
                resolved.extend(steps.into_iter().map(|step| Resolved { row, step, error }));
            }
        }
    }
    resolved
}

/// The images of one surface, at one value of [`Frame::row_axis`] and in one band of n·v.
struct Group<'r, 'f> {
    /// "ggx · F0 1".
    surface: String,
    /// "ggx, F0 1".
    surface_with_commas: String,
    row_value: Value,
    /// "alpha 0.25 (roughness 0.5)".
    heading: String,
    n_dot_v: [f64; 2],
    steps: Vec<Resolved<'r, 'f>>,
}

impl<'r, 'f> Group<'r, 'f> {
    fn numbers(&self, step: &str, number: fn(&Resolved) -> f64) -> Numbers<'r, 'f> {
        let steps = self
            .steps
            .iter()
            .filter(|resolved| resolved.step.step == step);
        Numbers::new(
            steps.map(|resolved| (resolved.row, number(resolved))),
            Middle::Mean,
        )
    }

    fn share(&self, step: &str) -> Option<Estimate> {
        self.numbers(step, |resolved| resolved.step.share)
            .estimate()
    }

    fn mean(&self, step: &str) -> f64 {
        self.share(step).map_or(0.0, |share| share.value)
    }

    /// The mean of a number over environments, with the digits of `steps.csv`.
    fn rounded_mean(&self, step: &str, number: fn(&Resolved) -> f64) -> Option<f64> {
        let mean = self.numbers(step, number).estimate()?;
        Some(round_to_significant(mean.value, DIGITS))
    }

    /// Whether environments are enough for an interval.
    fn is_pooled(&self, step: &str) -> bool {
        self.share(step)
            .is_some_and(|share| share.interval.is_some())
    }

    fn is_over_all_views(&self) -> bool {
        self.n_dot_v == ALL_VIEWS
    }

    /// "ggx · F0 1, alpha 0.25 (roughness 0.5)".
    fn condition(&self) -> String {
        commas([&self.surface, &self.heading])
    }

    /// Of a panel of the figure.
    fn title(&self) -> String {
        if self.is_over_all_views() {
            self.surface.clone()
        } else {
            commas([&self.surface_with_commas, &n_dot_v_words(self.n_dot_v)])
        }
    }
}

fn groups<'r, 'f>(frame: &Frame, resolved: &[Resolved<'r, 'f>]) -> Vec<Group<'r, 'f>> {
    let row_axis = frame.row_axis();
    let mut surface_axes = frame.case_axes();
    surface_axes.retain(|axis| ![row_axis, ENVIRONMENT, SCENE].contains(axis));
    let mut groups = Vec::new();
    let by_surface = grouped(resolved.iter().copied(), |one| one.row.key(&surface_axes));
    for (surface, steps) in by_surface {
        for (row_value, steps) in grouped_ascending(steps, row_axis, |one| one.row) {
            for n_dot_v in std::iter::once(ALL_VIEWS).chain(BANDS) {
                let mut steps = steps.clone();
                steps.retain(|resolved| resolved.step.n_dot_v == n_dot_v);
                if steps.is_empty() {
                    continue;
                }
                groups.push(Group {
                    surface: frame.names.label(&surface_axes, &surface),
                    surface_with_commas: frame.names.comma_label(&surface_axes, &surface),
                    row_value: row_value.clone(),
                    heading: frame.names.heading(row_axis, &row_value),
                    n_dot_v,
                    steps,
                });
            }
        }
    }
    groups
}

fn answer(frame: &Frame) -> Option<Finding> {
    let images = frame.images();
    let resolved = resolved(&images);
    if resolved.is_empty() && images.iter().any(|row| !row.cell.steps.is_empty()) {
        return Some(Finding {
            sentences: Sentences::new(NOTHING.into()),
            table: Table::new(&frame.table_axes(), QUESTION.columns),
            digest: None,
            figure: None,
        });
    }
    let groups = groups(frame, &resolved);
    let steps = resolved.iter().map(|one| one.step.step.as_str());
    let steps: Vec<&str> = distinct_in_order(steps);
    Some(Finding {
        sentences: sentences(frame, &groups, &steps, &resolved)?,
        table: table(frame, &groups, &steps),
        digest: Some(digest(frame, &groups, &steps)),
        figure: figure(&groups, &steps),
    })
}

fn table(frame: &Frame, groups: &[Group], steps: &[&str]) -> Table {
    let axes = frame.table_axes();
    let mut table = Table::new(&axes, QUESTION.columns);
    // Each environment over all views; by view only without an average.
    for group in groups {
        for Resolved { row, step, error } in &group.steps {
            if !group.is_over_all_views() && group.is_pooled(&step.step) {
                continue;
            }
            let mut cells = row.cells(&axes);
            cells.extend(cells![
                step.n_dot_v[0],
                step.n_dot_v[1],
                step.step.as_str(),
                step.share,
                Cell::Missing,
                Cell::Missing,
                step.first_in,
                step.last_out,
                step.shapley,
                *error,
                step.step_error
            ]);
            table.row(cells);
        }
    }
    // Averages over environments.
    for group in groups {
        for step in steps {
            let Some((value, [lo, hi])) = group
                .share(step)
                .and_then(|share| Some((share.value, share.interval?)))
            else {
                continue;
            };
            let mut key = group.steps[0].row.key(&axes);
            for (axis, value) in axes.iter().zip(&mut key) {
                if *axis == ENVIRONMENT {
                    *value = ALL.into();
                }
            }
            let mut cells = axis_cells(&axes, &key);
            cells.extend(cells![
                group.n_dot_v[0],
                group.n_dot_v[1],
                *step,
                round_to_significant(value, DIGITS),
                round_to_significant(lo, DIGITS),
                round_to_significant(hi, DIGITS),
                group.rounded_mean(step, |resolved| resolved.step.first_in),
                group.rounded_mean(step, |resolved| resolved.step.last_out),
                group.rounded_mean(step, |resolved| resolved.step.shapley),
                group.rounded_mean(step, |resolved| resolved.error),
                group.rounded_mean(step, |resolved| resolved.step.step_error)
            ]);
            table.row(cells);
        }
    }
    table
}

/// Smaller shares are written as 0.
const NOISE: f64 = 5e-4;

fn without_noise(share: f64) -> f64 {
    if share.abs() < NOISE { 0.0 } else { share }
}

/// "97 % ± 3", "-2.1 %"; if environments disagree about the sign, "-19 to 24 %".
fn share_words(share: &Estimate) -> String {
    let [lo, hi] = share.ends.map(without_noise);
    if lo < 0.0 && hi > 0.0 && hi - lo > 2.0 * NOISE {
        return percent_extent([lo, hi]).to_string();
    }
    let mean = percent(without_noise(share.value));
    let half = share
        .interval
        .map(|[lo, hi]| without_noise(0.5 * (hi - lo)))
        .filter(|half| *half > 0.0);
    match half {
        Some(half) => format!("{mean} ± {}", number(100.0 * half)),
        None => mean,
    }
}

/// One row per value of [`Frame::row_axis`] over all views, then one per end of n·v with the range
/// over these values.
fn digest(frame: &Frame, groups: &[Group], steps: &[&str]) -> Table {
    let row_axis = frame.row_axis();
    let row_heads = frame.names.heads(&[row_axis]);
    let mut heads = vec!["case"];
    heads.extend(&row_heads);
    heads.push("n·v");
    heads.extend(steps);
    let mut table = Table::with_names(heads);
    for (surface, groups) in grouped(groups, |group| group.surface.clone()) {
        for group in groups.iter().filter(|group| group.is_over_all_views()) {
            let mut row = cells![surface.as_str()];
            row.extend(frame.names.head_of(row_axis, &group.row_value));
            row.push(ALL.into());
            for step in steps {
                row.push(
                    group
                        .share(step)
                        .map(|share| Cell::quantity(share_words(&share)))
                        .into(),
                );
            }
            table.row(row);
        }
        for n_dot_v in [BANDS[0], BANDS[BANDS.len() - 1]] {
            let band: Vec<&Group> = groups
                .iter()
                .copied()
                .filter(|group| group.n_dot_v == n_dot_v)
                .collect();
            let mut row = cells![surface.as_str()];
            row.extend(all_head(&row_heads));
            row.push(Cell::quantity(format!("{} to {}", n_dot_v[0], n_dot_v[1])));
            for step in steps {
                row.push(mean_range(&band, step).into());
            }
            table.row(row);
        }
    }
    table.without_empty()
}

/// "12 to 24 %": the least and the largest mean share of a step.
fn mean_range(groups: &[&Group], step: &str) -> Option<Quantity> {
    let mut least = f64::INFINITY;
    let mut most = f64::NEG_INFINITY;
    let mut is_known = false;
    for share in groups.iter().filter_map(|group| group.share(step)) {
        least = f64::min(least, share.value);
        most = f64::max(most, share.value);
        is_known = true;
    }
    is_known.then(|| percent_extent([least, most].map(without_noise)))
}
