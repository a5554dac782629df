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
//!
//! Long because a question's numbers, sentences, digest and figure stand together.

use super::prelude::*;
use crate::base::numbers::round_to_significant;
use crate::instrument::ladder::BANDS;
use crate::instrument::metrics::ALL_VIEWS;
use crate::instrument::shade::REFERENCE;
use crate::study::finished::StepRow;

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
        for (_, steps) in grouped(&row.cell.steps, |step| step.seen.map(f64::to_bits)) {
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
                steps.retain(|resolved| resolved.step.seen == n_dot_v);
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
                step.seen[0],
                step.seen[1],
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

/// The groups in a band of n·v in which a step has its least and its largest mean share.
struct Ends<'g, 'r, 'f> {
    least: &'g Group<'r, 'f>,
    most: &'g Group<'r, 'f>,
}

impl<'g, 'r, 'f> Ends<'g, 'r, 'f> {
    fn of(groups: &'g [Group<'r, 'f>], n_dot_v: [f64; 2], step: &str) -> Option<Self> {
        let band = || groups.iter().filter(|group| group.n_dot_v == n_dot_v);
        let by_mean = |a: &&Group, b: &&Group| a.mean(step).total_cmp(&b.mean(step));
        Some(Self {
            least: band().min_by(by_mean)?,
            most: band().max_by(by_mean)?,
        })
    }
}

fn sentences(
    frame: &Frame,
    groups: &[Group],
    steps: &[&str],
    resolved: &[Resolved],
) -> Option<Sentences> {
    let over_all_views = || groups.iter().filter(|group| group.is_over_all_views());
    let total = |step: &str| over_all_views().map(|group| group.mean(step)).sum::<f64>();
    let largest = *steps.iter().max_by(|a, b| total(a).total_cmp(&total(b)))?;
    let ends = Ends::of(groups, ALL_VIEWS, largest)?;
    let share = Extent {
        least: Number::share(ends.least.mean(largest)),
        most: Number::share(ends.most.mean(largest)),
    };
    let name = if largest == VIEW_STEP {
        "step n = v = r".to_owned()
    } else {
        format!("step of {largest}")
    };
    let at_least = if over_all_views().count() > 1 {
        ", least at "
    } else {
        " at "
    };
    let headline = statement![
        statement![format!("The {name} causes "), Quantity::new(share)].strong(),
        " of the split sum's ",
        Phrase::Metric("relmse"),
        " on scene ",
        Phrase::Code("design".to_owned()),
        at_least,
        ends.least.condition(),
        "."
    ];
    let details = weakest_view(groups, steps, largest)
        .into_iter()
        .chain(noise(resolved));
    let lights = Numbers::new(
        resolved.iter().map(|resolved| (resolved.row, 1.0)),
        Middle::GeometricMean,
    );
    Some(
        Sentences::new(headline)
            .with_details(details)
            .with_scope(lights.scope(frame)),
    )
}

/// The band of n·v in which a step causes least of the error, with the largest other step there.
fn weakest_view(groups: &[Group], steps: &[&str], largest: &str) -> Option<Statement> {
    let weakest = BANDS
        .into_iter()
        .filter_map(|n_dot_v| Some(Ends::of(groups, n_dot_v, largest)?.least))
        .min_by(|a, b| a.mean(largest).total_cmp(&b.mean(largest)))?;
    let next = steps
        .iter()
        .filter(|step| **step != largest)
        .max_by(|a, b| weakest.mean(a).total_cmp(&weakest.mean(b)));
    let next = next.map(|step| {
        let share = Number::share(weakest.mean(step));
        statement![format!(", {step} "), share]
    });
    Some(statement![
        format!(
            "At {} and {} it causes ",
            n_dot_v_words(weakest.n_dot_v),
            weakest.condition()
        ),
        Number::share(weakest.mean(largest)),
        next,
        "."
    ])
}

/// How far sampling noise changes a share over all views.
fn noise(resolved: &[Resolved]) -> Option<Statement> {
    let errors = resolved
        .iter()
        .filter(|resolved| resolved.step.seen == ALL_VIEWS)
        .map(|resolved| resolved.step.share_error);
    let noise = 2.0 * errors.fold(0.0, f64::max);
    (noise > 0.0).then(|| {
        statement![
            "Sampling noise changes no share over all views by more than ",
            Number::share(noise),
            "."
        ]
    })
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
                row.push(group.share(step).as_ref().map(share_words).into());
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
            row.push(format!("{} to {}", n_dot_v[0], n_dot_v[1]).into());
            for step in steps {
                row.push(mean_range(&band, step).into());
            }
            table.row(row);
        }
    }
    table.without_empty()
}

/// "12 to 24 %": the least and the largest mean share of a step.
fn mean_range(groups: &[&Group], step: &str) -> Option<String> {
    let mut least = f64::INFINITY;
    let mut most = f64::NEG_INFINITY;
    let mut is_known = false;
    for share in groups.iter().filter_map(|group| group.share(step)) {
        least = f64::min(least, share.value);
        most = f64::max(most, share.value);
        is_known = true;
    }
    is_known.then(|| percent_extent([least, most].map(without_noise)).to_string())
}

/// Bars of shares by [`Frame::row_axis`], one panel per surface: right of 0 steps add error, left
/// of 0 they cancel it. Over all views, which grazing ones dominate, then facing the viewer.
fn figure(groups: &[Group], steps: &[&str]) -> Option<Figure> {
    let row_values = groups.iter().map(|group| group.row_value.clone());
    let row_values = ascending(distinct_in_order(row_values));
    let heading = |value: &Value| {
        let group = groups.iter().find(|group| group.row_value == *value);
        group.map_or_else(String::new, |group| group.heading.clone())
    };
    let shown = [ALL_VIEWS, BANDS[BANDS.len() - 1]]
        .into_iter()
        .flat_map(|n_dot_v| groups.iter().filter(move |group| group.n_dot_v == n_dot_v));
    let mut panels = Vec::new();
    for (title, groups) in grouped(shown, |group| group.title()) {
        let mut marks = Vec::new();
        for group in groups {
            marks.extend(bars(group, steps, step(&row_values, &group.row_value)));
        }
        marks.push(Mark::neutral(Form::VerticalRule(0.0)));
        marks.push(Mark::neutral(Form::VerticalRule(1.0)));
        panels.push(ChartPanel { title, marks });
    }
    let is_pooled = groups
        .iter()
        .any(|group| steps.iter().any(|step| group.is_pooled(step)));
    let note = if is_pooled {
        "share of relmse by step, mean over environments; left of 0 a step cancels error; \
         whiskers: 95 % of the longest"
    } else {
        "share of relmse by step; left of 0 a step cancels error"
    };
    let series = steps.iter().map(|step| {
        if *step == VIEW_STEP {
            solid("view (n = v = r)")
        } else {
            solid(*step)
        }
    });
    Chart {
        title: "Where the split sum's error comes from",
        note: note.to_owned(),
        x: ChartAxis::Linear("share of the error"),
        y: ChartAxis::Steps("", row_values.iter().map(heading).collect()),
        panels,
        series: series.collect(),
    }
    .figure()
}

/// The bars of a group, stacked to both sides of 0, and the interval of the longest bar alone:
/// others would overlap it.
fn bars(group: &Group, steps: &[&str], y: f64) -> Vec<Mark> {
    let mut marks = Vec::new();
    let mut positive_end = 0.0;
    let mut negative_end = 0.0;
    let mut longest: Option<(f64, Option<Mark>)> = None;
    for (series, step) in steps.iter().enumerate() {
        let Some(share) = group.share(step) else {
            continue;
        };
        let end = if share.value < 0.0 {
            &mut negative_end
        } else {
            &mut positive_end
        };
        let base = *end;
        *end += share.value;
        let bar = Form::HorizontalBar {
            y,
            base,
            to: base + share.value,
        };
        let tip = format!("{step}: {} · {}", share_words(&share), group.heading);
        marks.push(Mark::new(bar, series).tip(tip));
        let is_longest = longest
            .as_ref()
            .is_none_or(|(value, _)| share.value.total_cmp(value).is_ge());
        if is_longest {
            let whisker = share
                .interval
                .map(|[lo, hi]| Mark::neutral(Form::Whisker([base + lo, y], [base + hi, y])));
            longest = Some((share.value, whisker));
        }
    }
    marks.extend(longest.and_then(|(_, whisker)| whisker));
    marks
}
