//! The sentences about tables.

use super::{Combination, Tail, chosen, enough, share_number, words};
use crate::bake::plain::SETTINGS;
use crate::study::questions::prelude::*;

pub(super) fn sentences(frame: &Frame, parameters: &[AxisId], tails: &[Tail]) -> Option<Sentences> {
    let metric = Phrase::Metric(frame.metric_name());
    let enough = enough(frame);
    let best = chosen(enough, &tails.first()?.all)?;
    let words = |one: &Combination| words(frame, parameters, &one.tables);
    let best_add = |before: &'static str| {
        let worst = worst_share(frame, best);
        statement![before, worst, format!(": {}.", words(best))]
    };
    let first_enough = tails.iter().enumerate().find_map(|(index, tail)| {
        let shipped = tail.all.iter().find(|one| one.is_enough(enough))?;
        Some((index, shipped))
    });
    let (headline, detail, shipped) = match first_enough {
        Some((0, shipped)) => {
            let tables = Statement::from(words(shipped)).strong();
            let most = worst_share(frame, shipped);
            let their_error = statement![": their ", metric, " is at most ", most];
            let headline = statement!["Ship ", tables, their_error, " of the split's own."];
            (headline, None, shipped)
        }
        Some((index, shipped)) => {
            let from = frame
                .names
                .heading_phrase(frame.row_axis(), &tails[index].from);
            let tables = Statement::from(words(shipped)).strong();
            let most = share_number(enough, shipped.worst().share());
            let their_error = statement![": at most ", most, " of the split's ", metric, "."];
            let headline = statement!["From ", from, " on, ship ", tables, their_error];
            let detail = best_add("Below that, the best tables add ");
            (headline, Some(detail), shipped)
        }
        None => {
            let part = part_words(frame);
            let none = format!("No tried tables err by {part} of the split's own ");
            let headline = statement![none, metric, " or less."];
            (headline, Some(best_add("The best add ")), best)
        }
    };
    let command = Phrase::Code(command(parameters, &shipped.tables));
    let details = detail
        .into_iter()
        .chain([statement!["To bake them: ", command, "."]]);
    Some(Sentences::new(headline).with_details(details))
}

/// [`enough`] in words.
fn part_words(frame: &Frame) -> &'static str {
    if frame.metric.power == 2.0 {
        "a tenth"
    } else {
        "a third"
    }
}

/// "at most 12 % (qwantani, alpha 0.1)": a share within the reference's noise is an upper bound.
fn worst_share(frame: &Frame, one: &Combination) -> Statement {
    let worst = one.worst();
    let axes = distinct_in_order([ENVIRONMENT, frame.row_axis()]);
    statement![
        if worst.is_resolved { "" } else { "at most " },
        share_number(enough(frame), worst.share()),
        format!(" ({})", worst.condition(frame, &axes))
    ]
}

/// "splitsum bake MAP --out DIR --set prefilter_size=64x64".
fn command(parameters: &[AxisId], tables: &Key) -> String {
    let mut command = "splitsum bake MAP --out DIR".to_owned();
    for (&axis, value) in parameters.iter().zip(tables) {
        let name = AXES[axis].name;
        if SETTINGS.contains(&name) && *value != Value::Unset {
            command += &format!(" --set {name}={value}");
        }
    }
    command
}
