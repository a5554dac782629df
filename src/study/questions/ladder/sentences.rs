//! The sentences about the steps of an error.

use super::{Group, Resolved, VIEW_STEP};
use crate::instrument::ladder::BANDS;
use crate::instrument::metrics::ALL_VIEWS;
use crate::study::questions::prelude::*;

/// The groups in a band of n·v in which a step has its least and its largest mean share.
struct Ends<'g, 'r, 'f> {
    least: &'g Group<'r, 'f>,
    most: &'g Group<'r, 'f>,
}

impl<'g, 'r, 'f> Ends<'g, 'r, 'f> {
    fn find(groups: &'g [Group<'r, 'f>], n_dot_v: [f64; 2], step: &str) -> Option<Self> {
        let band = || groups.iter().filter(|group| group.n_dot_v == n_dot_v);
        let by_mean = |a: &&Group, b: &&Group| a.mean(step).total_cmp(&b.mean(step));
        Some(Self {
            least: band().min_by(by_mean)?,
            most: band().max_by(by_mean)?,
        })
    }
}

pub(super) fn sentences(
    frame: &Frame,
    groups: &[Group],
    steps: &[&str],
    resolved: &[Resolved],
) -> Option<Sentences> {
    let over_all_views = || groups.iter().filter(|group| group.is_over_all_views());
    let total = |step: &str| over_all_views().map(|group| group.mean(step)).sum::<f64>();
    let largest = *steps.iter().max_by(|a, b| total(a).total_cmp(&total(b)))?;
    let ends = Ends::find(groups, ALL_VIEWS, largest)?;
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
        .filter_map(|n_dot_v| Some(Ends::find(groups, n_dot_v, largest)?.least))
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
        .filter(|resolved| resolved.step.n_dot_v == ALL_VIEWS)
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
