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
        SEEN_FROM,
        SEEN_TO,
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
    match () {
        () if !shape.has_ladder => Some("the experiment has no section [ladder]"),
        () if !shape.methods().any(|method| method.has_ladder) => {
            Some("axes.method has no split-sum: only this method has steps")
        }
        () if !shape.values[SCENE]
            .iter()
            .any(|scene| is_design(&scene.to_string())) =>
        {
            Some(
                "no scene is design, where every view sees the whole map; add it beside pictures: \
                 design,my.obj",
            )
        }
        () if shape.reference_method != REFERENCE => {
            Some("reference.method is not reference: steps lead from the integral")
        }
        () => None,
    }
}

/// Significant digits, as in `steps.csv`.
const DIGITS: usize = 4;

/// Errors below this many times the reference's noise are ignored: under constant light the split
/// is exact.
const RESOLVED: f64 = 10.0;

const NOTHING: &str = "No error is above the reference's noise: there is nothing to attribute.";

/// One step of one image over a band of n·v.
#[derive(Clone, Copy)]
struct Resolved<'r, 'f> {
    row: &'r Row<'f>,
    step: &'f StepRow,
    error: f64,
}

fn resolved<'r, 'f>(images: &[&'r Row<'f>]) -> Vec<Resolved<'r, 'f>> {
    let of_image = |row: &'r Row<'f>| {
        let bands = grouped(&row.cell.steps, |step| step.seen.map(f64::to_bits));
        let of_band = |(_, steps): (_, Vec<&'f StepRow>)| {
            let error = steps.last().map_or(0.0, |last| last.rung_error);
            let is_resolved = steps.iter().all(|step| error > RESOLVED * step.noise);
            steps
                .into_iter()
                .filter(|_| is_resolved)
                .map(|step| Resolved { row, step, error })
                .collect::<Vec<_>>()
        };
        bands.into_iter().flat_map(of_band).collect::<Vec<_>>()
    };
    images.iter().flat_map(|row| of_image(row)).collect()
}

/// The images of one surface, at one value of [`Frame::row_axis`] and in one band of n·v.
struct Group<'r, 'f> {
    /// "ggx · F0 1".
    name: String,
    width: Value,
    /// "alpha 0.25 (roughness 0.5)".
    heading: String,
    seen: [f64; 2],
    own: Vec<Resolved<'r, 'f>>,
}

impl<'r, 'f> Group<'r, 'f> {
    fn numbers(&self, step: &str, of: fn(&Resolved) -> f64) -> Numbers<'r, 'f> {
        let own = self
            .own
            .iter()
            .filter(|resolved| resolved.step.step == step);
        Numbers::new(
            own.map(|resolved| (resolved.row, of(resolved))),
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

    /// Whether environments are enough for an interval.
    fn is_pooled(&self, step: &str) -> bool {
        self.share(step)
            .is_some_and(|share| share.interval.is_some())
    }

    fn place(&self) -> String {
        [&self.name, &self.heading]
            .into_iter()
            .filter(|word| !word.is_empty())
            .cloned()
            .collect::<Vec<_>>()
            .join(", ")
    }
}

fn groups<'r, 'f>(frame: &Frame, resolved: &[Resolved<'r, 'f>]) -> Vec<Group<'r, 'f>> {
    let of = frame.row_axis();
    let others: Vec<AxisId> = frame
        .case_axes()
        .into_iter()
        .filter(|other| ![of, ENVIRONMENT, SCENE].contains(other))
        .collect();
    let of_name = |(key, own): (Key, Vec<Resolved<'r, 'f>>)| {
        let name = frame.names.label(&others, &key);
        let by_width = grouped_ascending(own, of, |resolved| resolved.row).into_iter();
        by_width.flat_map(move |(width, own)| {
            let group = |seen: [f64; 2]| {
                let own: Vec<_> = own
                    .iter()
                    .filter(|resolved| resolved.step.seen == seen)
                    .copied()
                    .collect();
                let heading = frame.names.heading(of, &width);
                Group {
                    name: name.clone(),
                    width: width.clone(),
                    heading,
                    seen,
                    own,
                }
            };
            let all = std::iter::once(ALL_VIEWS).chain(BANDS).map(group);
            all.filter(|group| !group.own.is_empty())
                .collect::<Vec<_>>()
        })
    };
    grouped(resolved.iter().copied(), |resolved| {
        resolved.row.key(&others)
    })
    .into_iter()
    .flat_map(of_name)
    .collect()
}

fn answer(frame: &Frame) -> Option<Finding> {
    let images = frame.images();
    let resolved = resolved(&images);
    if resolved.is_empty() && images.iter().any(|row| !row.cell.steps.is_empty()) {
        let table = Table::new(&frame.table_axes(), QUESTION.columns);
        return Some(Finding {
            sentence: NOTHING.to_owned(),
            table,
            digest: None,
            figure: None,
        });
    }
    let groups = groups(frame, &resolved);
    let steps: Vec<&str> =
        distinct_in_order(resolved.iter().map(|resolved| resolved.step.step.as_str()));
    let axes = frame.table_axes();
    let mut table = Table::new(&axes, QUESTION.columns);
    // Each environment over all views; by view only without an average.
    for group in &groups {
        let own =
            |resolved: &&Resolved| group.seen == ALL_VIEWS || !group.is_pooled(&resolved.step.step);
        for Resolved { row, step, error } in group.own.iter().filter(own) {
            let interval = [Cell::Missing, Cell::Missing];
            let own = cells![step.seen[0], step.seen[1], step.step.as_str(), step.share];
            let rest = cells![
                step.first_in,
                step.last_out,
                step.shapley,
                *error,
                step.step_error
            ];
            table.row([row.cells(&axes), own, interval.to_vec(), rest].concat());
        }
    }
    // Averages over environments.
    for group in &groups {
        for step in &steps {
            let Some(Estimate {
                value,
                interval: Some([lo, hi]),
                ..
            }) = group.share(step)
            else {
                continue;
            };
            let mean = |of| {
                group
                    .numbers(step, of)
                    .estimate()
                    .map(|all| round_to_significant(all.value, DIGITS))
            };
            let [value, lo, hi] = [value, lo, hi].map(|share| round_to_significant(share, DIGITS));
            let mut key = group.own[0].row.key(&axes);
            axes.iter()
                .zip(&mut key)
                .filter(|(of, _)| **of == ENVIRONMENT)
                .for_each(|(_, value)| *value = ALL.into());
            let own = cells![group.seen[0], group.seen[1], *step, value, lo, hi];
            let rest = cells![
                mean(|resolved| resolved.step.first_in),
                mean(|resolved| resolved.step.last_out),
                mean(|resolved| resolved.step.shapley),
                mean(|resolved| resolved.error),
                mean(|resolved| resolved.step.step_error)
            ];
            table.row([axis_cells(&axes, &key), own, rest].concat());
        }
    }
    Some(Finding {
        sentence: sentence(frame, &groups, &steps, &resolved)?,
        digest: Some(digest(frame, &groups, &steps)),
        figure: figure(&groups, &steps),
        table,
    })
}

fn sentence(
    frame: &Frame,
    groups: &[Group],
    steps: &[&str],
    resolved: &[Resolved],
) -> Option<String> {
    let at = |seen: [f64; 2]| groups.iter().filter(move |group| group.seen == seen);
    let total = |step: &str| at(ALL_VIEWS).map(|group| group.mean(step)).sum::<f64>();
    let lead = *steps.iter().max_by(|a, b| total(a).total_cmp(&total(b)))?;
    let ends = |seen: [f64; 2], step: &str| {
        let least = at(seen).min_by(|a, b| a.mean(step).total_cmp(&b.mean(step)))?;
        let most = at(seen).max_by(|a, b| a.mean(step).total_cmp(&b.mean(step)))?;
        Some([least, most].map(|group| (percent(group.mean(step)), group)))
    };
    let [(least, place), (most, _)] = ends(ALL_VIEWS, lead)?;
    let share = if least == most {
        least
    } else {
        format!("{least} to {most}")
    };
    let at_least = if at(ALL_VIEWS).count() > 1 {
        ", least at "
    } else {
        " at "
    };
    let mut text = format!(
        "**The {} causes {share}** of the split sum's `relmse` on scene `design`{at_least}{}.",
        says(lead),
        place.place()
    );
    // The views at which it causes least of the error.
    let by_view = BANDS
        .into_iter()
        .filter_map(|seen| Some((seen, ends(seen, lead)?)));
    let weakest =
        by_view.min_by(|(_, [a, _]), (_, [b, _])| a.1.mean(lead).total_cmp(&b.1.mean(lead)));
    if let Some((seen, [(least, group), _])) = weakest {
        let other = steps.iter().filter(|step| **step != lead);
        let next = other.max_by(|a, b| group.mean(a).total_cmp(&group.mean(b)));
        let next = next.map_or(String::new(), |step| {
            format!(", {} {}", step, percent(group.mean(step)))
        });
        text += &format!(
            " At {} and {} it causes {least}{next}.",
            view(seen),
            group.place()
        );
    }
    let drawn = resolved
        .iter()
        .filter(|resolved| resolved.step.seen == ALL_VIEWS)
        .map(|resolved| resolved.step.share_error);
    let noise = 2.0 * drawn.fold(0.0, f64::max);
    if noise > 0.0 {
        text += &format!(
            " Sampling noise changes no share over all views by more than {}.",
            percent(noise)
        );
    }
    let lights = Numbers::new(
        resolved.iter().map(|resolved| (resolved.row, 1.0)),
        Middle::GeometricMean,
    );
    Some(text + &lights.scope(frame))
}

fn says(step: &str) -> String {
    if step == "view" {
        "step n = v = r".to_owned()
    } else {
        format!("step of {step}")
    }
}

/// Smaller shares are written as 0.
const NOISE: f64 = 5e-4;

/// "97 % ± 3", "-2.1 %"; if environments disagree about the sign, "-19 to 24 %".
fn share_words(share: &Estimate) -> String {
    let rounded = |share: f64| if share.abs() < NOISE { 0.0 } else { share };
    let [lo, hi] = share.ends.map(rounded);
    if lo < 0.0 && hi > 0.0 && hi - lo > 2.0 * NOISE {
        return range_words([lo, hi], |x| number(100.0 * x)) + " %";
    }
    let half = share
        .interval
        .map(|[lo, hi]| rounded(0.5 * (hi - lo)))
        .filter(|half| *half > 0.0);
    let half = half.map_or(String::new(), |half| format!(" ± {}", number(100.0 * half)));
    format!("{}{half}", percent(rounded(share.value)))
}

/// One row per value of [`Frame::row_axis`] over all views, then one per end of n·v with the range
/// over these values.
fn digest(frame: &Frame, groups: &[Group], steps: &[&str]) -> Table {
    let of = [frame.row_axis()];
    let rows = frame.names.heads(&of);
    let heads = std::iter::once("case")
        .chain(rows.iter().copied())
        .chain(["n·v"])
        .map(str::to_owned);
    let mut table = Table::with_names(heads.chain(steps.iter().map(|step| step.to_string())));
    for (name, own) in grouped(groups, |group| group.name.clone()) {
        for group in own.iter().filter(|group| group.seen == ALL_VIEWS) {
            let row = frame.names.head_of(of[0], &group.width);
            let head = [cells![name.as_str()], row, cells![ALL]].concat();
            let shares = steps
                .iter()
                .map(|step| Cell::from(group.share(step).as_ref().map(share_words)));
            table.row(head.into_iter().chain(shares).collect());
        }
        for seen in [BANDS[0], BANDS[BANDS.len() - 1]] {
            let band: Vec<_> = own.iter().filter(|group| group.seen == seen).collect();
            let range = |step: &&str| {
                let means = || {
                    band.iter()
                        .filter_map(|group| Some(group.share(step)?.value))
                };
                let ends = [
                    means().fold(f64::INFINITY, f64::min),
                    means().fold(f64::NEG_INFINITY, f64::max),
                ];
                let ends = ends.map(|share| if share.abs() < NOISE { 0.0 } else { share });
                Cell::from(
                    (means().next().is_some())
                        .then(|| range_words(ends, |x| number(100.0 * x)) + " %"),
                )
            };
            let seen = format!("{} to {}", seen[0], seen[1]);
            let head = [cells![name.as_str()], all_head(&rows), cells![seen]].concat();
            table.row(head.into_iter().chain(steps.iter().map(range)).collect());
        }
    }
    table.without_empty()
}

/// Bars of shares by [`Frame::row_axis`], one panel per surface: right of 0 steps add error, left
/// of 0 they cancel it. Over all views, which grazing ones dominate, then facing the viewer.
fn figure(groups: &[Group], steps: &[&str]) -> Option<Figure> {
    let widths = ascending(distinct_in_order(
        groups.iter().map(|group| group.width.clone()),
    ));
    let heading = |width: &Value| {
        let own = groups.iter().find(|group| group.width == *width);
        own.map_or_else(String::new, |group| group.heading.clone())
    };
    let marks = |group: &Group| {
        let (y, mut ends) = (step(&widths, &group.width), [0.0, 0.0]);
        let bar = |i: usize| {
            let share = group.share(steps[i])?;
            let end = &mut ends[usize::from(share.value < 0.0)];
            let base = *end;
            *end += share.value;
            let tip = format!("{}: {} · {}", steps[i], share_words(&share), group.heading);
            let bar = Mark::new(
                Form::HorizontalBar {
                    y,
                    base,
                    to: base + share.value,
                },
                i,
            )
            .tip(tip);
            let whisker = share
                .interval
                .map(|ends| ends.map(|share| [base + share, y]));
            Some((
                share.value,
                bar,
                whisker.map(|[lo, hi]| Mark::neutral(Form::Whisker(lo, hi))),
            ))
        };
        let bars: Vec<_> = (0..steps.len()).filter_map(bar).collect();
        // Only the interval of the longest bar: others would overlap it.
        let longest = bars
            .iter()
            .max_by(|a, b| a.0.total_cmp(&b.0))
            .and_then(|(.., whisker)| whisker.clone());
        bars.into_iter()
            .map(|(_, bar, _)| bar)
            .chain(longest)
            .collect::<Vec<_>>()
    };
    let views = [ALL_VIEWS, BANDS[BANDS.len() - 1]];
    let shown = views
        .into_iter()
        .flat_map(|seen| groups.iter().filter(move |group| group.seen == seen));
    let title = |group: &Group| match group.seen == ALL_VIEWS {
        true => group.name.clone(),
        false => commas([&group.name, &view(group.seen)]),
    };
    let panel = |(name, own): (String, Vec<&Group>)| {
        let rule = [
            Mark::neutral(Form::VerticalRule(0.0)),
            Mark::neutral(Form::VerticalRule(1.0)),
        ];
        (name, own.into_iter().flat_map(marks).chain(rule).collect())
    };
    let is_pooled = groups
        .iter()
        .any(|group| steps.iter().any(|step| group.is_pooled(step)));
    let [pooled, whiskers] = match is_pooled {
        true => [
            ", mean over environments",
            "; whiskers: 95 % of the longest",
        ],
        false => ["", ""],
    };
    Chart {
        title: "Where the split sum's error comes from",
        note: "share of relmse by step".to_owned()
            + pooled
            + "; left of 0 a step cancels error"
            + whiskers,
        x: Along::Linear("share of the error"),
        y: Along::Steps("", widths.iter().map(heading).collect()),
        panels: grouped(shown, |group| title(group))
            .into_iter()
            .map(panel)
            .collect(),
        series: steps
            .iter()
            .map(|step| {
                if *step == "view" {
                    "view (n = v = r)".to_owned()
                } else {
                    step.to_string()
                }
            })
            .collect(),
    }
    .figure()
}
