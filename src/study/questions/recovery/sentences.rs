//! The sentences of the question.

use super::super::prelude::*;
use super::{Recovered, candidate_name, candidate_phrases, has_role, nearer_of_all};

/// The textbook where it errs most, beside the candidate that errs least over all roughness. Steps of
/// the ladder are not candidates that a renderer could use.
pub fn sentences(frame: &Frame, lead: &[&Recovered]) -> Option<Sentences> {
    let by_candidate = grouped(lead.iter().copied(), |one| {
        candidate_name(frame, one.candidate)
    });
    let (_, first) = by_candidate
        .iter()
        .find(|(_, fits)| fits[0].is_textbook())
        .or(by_candidate.first())?;
    let by_bias = |a: &&&Recovered, b: &&&Recovered| a.bias().abs().total_cmp(&b.bias().abs());
    let worst = first.iter().max_by(by_bias)?;
    let bias = |fits: &[&Recovered]| fits.iter().map(|one| one.bias().abs()).sum::<f64>();
    let others = by_candidate
        .iter()
        .filter(|(_, fits)| has_role(fits[0].candidate) && !fits[0].is_textbook());
    let best = others.min_by(|(_, a), (_, b)| bias(a).total_cmp(&bias(b)));
    let beside = best.and_then(|(_, fits)| {
        let alike = fits
            .iter()
            .find(|one| one.true_roughness() == worst.true_roughness())?;
        Some(statement!["; ", what(frame, alike)])
    });
    let headline = statement![
        "At roughness ",
        Number::rounded(worst.true_roughness()),
        " ",
        what(frame, worst),
        beside,
        "."
    ];
    let nearer = best.and_then(|(_, fits)| share_nearer(frame, fits));
    let n = Number::Count(worst.fits.len() as u64);
    let scope = statement![
        "Medians of ",
        n,
        if worst.fits.len() == 1 {
            " environment"
        } else {
            " environments"
        },
        ", loss ",
        Phrase::Code(worst.loss.to_owned()),
        ", light and shape known."
    ];
    Some(
        Sentences::new(headline)
            .with_details(nearer)
            .with_scope([scope]),
    )
}

/// "`split-sum-two` is nearer to the true roughness than the textbook in 50 of 60 fits, ..."
fn share_nearer(frame: &Frame, fits: &[&Recovered]) -> Option<Statement> {
    let nearer = nearer_of_all(fits)?;
    Some(statement![
        candidate_phrases(frame, fits[0].candidate),
        " is nearer to the true roughness than the textbook in ",
        Number::Count(nearer.roughness as u64),
        " of ",
        Number::Count(nearer.of as u64),
        " fits, to the true F0 in ",
        Number::Count(nearer.f0 as u64),
        "."
    ])
}

/// "`split-sum` recovers 0.89 and 1.6 times the F0".
fn what(frame: &Frame, one: &Recovered) -> Statement {
    statement![
        candidate_phrases(frame, one.candidate),
        " recovers ",
        Quantity::rounded(one.roughness.value),
        " and ",
        Quantity::rounded(one.f0_ratio.value).unit(" times"),
        " the F0"
    ]
}
