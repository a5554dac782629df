//! The sentences about a break-even.

use super::{Ends, Pair};
use crate::study::frame::curve::{Methods, without_samples};
use crate::study::questions::prelude::*;

/// The range of the first pair of methods, by each metric. Then its ends, or the ranges against the
/// method without samples that errs least.
pub(super) fn sentences(frame: &Frame, axes: &[AxisId], all: &[Pair]) -> Option<Sentences> {
    let images = frame.images();
    let fixed = without_samples(&images);
    let first = all.first()?;
    let same: Vec<&Pair> = all
        .iter()
        .filter(|pair| pair.methods == first.methods && pair.metric == first.metric)
        .collect();
    let is_single = same.len() == 1;

    let target = Target {
        unit: Unit::SAMPLES_PER_PIXEL,
        end: statement![
            " to beat ",
            Phrase::Method(Variant::new(&first.methods.fixed))
        ],
    };
    let needs = needs(all, &first.methods, is_single, &target);
    let light = if first.crossing.n == 1 {
        let light = &fixed.first()?.point[ENVIRONMENT];
        let light = frame.names.short_phrase(ENVIRONMENT, light);
        statement![", under ", light]
    } else {
        Statement::default()
    };
    let headline = statement![
        Phrase::Method(Variant::new(&first.methods.sampled)),
        " needs ",
        needs,
        light,
        "."
    ];

    let best = least_error(frame, &fixed)?;
    let ends = Ends::find(&same)?;
    let detail = if best != first.methods.fixed {
        Some(needs_to_beat_best(all, &first.methods, best, is_single))
    } else if ends.least.number() != ends.most.number() {
        Some(statement![
            "Fewest: ",
            ends.least.statement(frame, axes),
            "; most: ",
            ends.most.statement(frame, axes),
            "."
        ])
    } else {
        None
    };
    let scope = (first.crossing.n != 1).then(|| {
        let lights = Number::Count(first.crossing.n as u64);
        let plural = AXES[ENVIRONMENT].plural;
        statement!["Medians over ", lights, format!(" {plural}.")]
    });
    Some(
        Sentences::new(headline)
            .with_details(detail)
            .with_scope(scope),
    )
}

/// The method without samples with the least mean error.
fn least_error(frame: &Frame, fixed: &[&Row]) -> Option<String> {
    let mean = |rows: &[&Row]| {
        let errors = rows.iter().filter_map(|row| frame.error(row));
        geometric_mean(&errors.collect::<Vec<_>>())
    };
    grouped(fixed.iter().copied(), |row| row.text(METHOD))
        .into_iter()
        .min_by(|(_, a), (_, b)| mean(a).total_cmp(&mean(b)))
        .map(|(method, _)| method)
}

/// What sampling needs to beat the method without samples that errs least.
fn needs_to_beat_best(all: &[Pair], methods: &Methods, best: String, is_single: bool) -> Statement {
    let methods = Methods {
        sampled: methods.sampled.clone(),
        fixed: best,
    };
    statement![
        "To beat ",
        Phrase::Method(Variant::new(&methods.fixed)),
        ", which errs least, it needs ",
        needs(all, &methods, is_single, &Target::default()),
        "."
    ]
}

/// What a count of samples is for, after the count in the first metric.
#[derive(Default)]
struct Target {
    unit: Unit,
    end: Statement,
}

/// "**8 to 16 samples per pixel** to beat `split-sum` in `relmse` and 4 in `flip`": the counts by
/// metric; with their interval if each is of one condition.
fn needs(all: &[Pair], methods: &Methods, is_single: bool, target: &Target) -> Statement {
    let pairs = all.iter().filter(|pair| pair.methods == *methods);
    let mut by_metric = Vec::new();
    for (metric, pairs) in grouped(pairs, |pair| pair.metric) {
        let ends = Ends::find(&pairs).expect("a group has a pair");
        // Both ends are rounded up to the counts of the first condition.
        let tried = &pairs[0].tried;
        let extent = Extent {
            least: tried.number(ends.least.crossing.value),
            most: tried.number(ends.most.crossing.value),
        };
        let count = Quantity::new(extent).interval(is_single.then(|| pairs[0].interval()));
        by_metric.push(if by_metric.is_empty() {
            statement![
                count.unit(target.unit).strong(),
                target.end.clone(),
                " in ",
                Phrase::Metric(metric)
            ]
        } else {
            statement![count, " in ", Phrase::Metric(metric)]
        });
    }
    Statement::joined(by_metric, " and ")
}
