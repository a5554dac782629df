//! Which way of making the image errs least.

use super::{Answer, ERROR_DIGITS};
use crate::runner::axis::REFERENCE;
use crate::study::answers::study::{Role, Study};
use crate::table::markdown::significant;
use std::collections::BTreeMap;

/// Without a pair to break even: which way of making the image has the lowest median error.
pub(super) fn from_variants(study: &Study) -> Answer {
    let axes: Vec<usize> = (0..study.axes.len())
        .filter(|&axis| study.axes[axis].role == Role::Variant && study.axes[axis].name != "point_set")
        .collect();
    let mut errors: BTreeMap<Vec<&str>, Vec<f64>> = BTreeMap::new();
    // The image without a specular term is there for scale; it is no way to make one.
    for row in study.images().into_iter().filter(|row| study.value(row, "method") != "none") {
        // An image that is its own reference errs by nothing and answers nothing.
        if let Some(error) = row.error.filter(|error| *error > 0.0) {
            errors.entry(axes.iter().map(|&axis| row.axes[axis].as_str()).collect()).or_default().push(error);
        }
    }
    let mut ranked: Vec<(f64, String, Vec<f64>)> = errors
        .into_iter()
        .map(|(words, mut errors)| {
            errors.sort_by(f64::total_cmp);
            let words: Vec<&str> = words.into_iter().filter(|word| !word.is_empty()).collect();
            (errors[errors.len() / 2], words.join(" "), errors)
        })
        .collect();
    ranked.sort_by(|a, b| a.0.total_cmp(&b.0));
    let Some((error, name, errors)) = ranked.first() else {
        return Answer {
            number: String::new(),
            unit: String::new(),
            sentence: "No cell is done yet, so there is no answer.".to_owned(),
            facts: Vec::new(),
        };
    };
    let text = |error: f64| significant(error, ERROR_DIGITS);
    let at = |p: f64| text(errors[(p * (errors.len() - 1) as f64).round() as usize]);
    let spread = if errors.first() != errors.last() {
        format!(" (median of {} cells, the middle half from {} to {})", errors.len(), at(0.25), at(0.75))
    } else {
        String::new()
    };
    if ranked.len() == 1 {
        return Answer {
            number: text(*error),
            unit: "relative squared error against the reference".to_owned(),
            sentence: match name.as_str() {
                REFERENCE => format!(
                    "What the reference method renders differs from what judges it by a relMSE of {}{spread}.",
                    text(*error)
                ),
                _ => format!("{name} differs from its reference by a relMSE of {}{spread}.", text(*error)),
            },
            facts: Vec::new(),
        };
    }
    let facts = ranked.iter().skip(1).take(3).map(|(e, n, _)| format!("Next: {n} with {}.", text(*e)));
    Answer {
        number: text(*error),
        unit: format!("relative squared error of {name}, the lowest of {}", ranked.len()),
        sentence: format!("{name} comes closest to the reference: relMSE {}{spread}.", text(*error)),
        facts: facts.collect(),
    }
}
