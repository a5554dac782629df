//! What the parameters of a method change, how large its tables must be, and whether the claimed counts suffice.

use super::{DIGITS, ESTIMATE_DIGITS, left, table};
use crate::runner::tables::HEADLINE;
use crate::study::answers::effects::Effect;
use crate::study::answers::exposure::VISIBLE_FROM;
use crate::study::answers::{Answers, short};
use crate::table::markdown::{Align, significant};
use std::fmt::Write;

/// What each parameter changes.
pub(super) fn effects(answers: &Answers) -> String {
    let mut axes: Vec<(&str, &str)> = Vec::new();
    for effect in &answers.effects {
        if !axes.contains(&(effect.axis.as_str(), effect.base.as_str())) {
            axes.push((&effect.axis, &effect.base));
        }
    }
    let mut text = String::new();
    for (axis, base) in axes {
        let own = || answers.effects.iter().filter(move |effect| effect.axis == axis);
        let is_method = axis == "method";
        let mut alphas: Vec<Option<&str>> = Vec::new();
        own().for_each(|effect| {
            if !alphas.contains(&effect.alpha.as_deref()) {
                alphas.push(effect.alpha.as_deref());
            }
        });
        let mut header = left(&[axis.to_owned(), if is_method { "samples" } else { "method" }.to_owned()]);
        header.extend([("ratio".to_owned(), Align::Right), ("95 %".to_owned(), Align::Left)]);
        header.push(("better in".to_owned(), Align::Right));
        header.extend(alphas.iter().flatten().map(|alpha| (format!("alpha {}", short("alpha", alpha)), Align::Right)));
        let mut rows = table(&header);
        for effect in own().filter(|effect| effect.alpha.is_none()) {
            let number = |x: f64| significant(x, DIGITS);
            let ends = match effect.interval[1].is_finite() {
                true => effect.interval.map(number).join(" to "),
                false => String::new(),
            };
            let value = short(axis, &effect.value).into_owned();
            let mut cells = vec![value, effect.method.clone(), number(effect.ratio), ends];
            cells.push(format!("{} of {}", effect.better, effect.n));
            cells.extend(alphas.iter().flatten().map(|alpha| {
                let one = own().find(|other| {
                    other.alpha.as_deref() == Some(alpha)
                        && other.value == effect.value
                        && other.method == effect.method
                });
                one.map_or_else(String::new, |one| number(one.ratio))
            }));
            rows.row(&cells);
        }
        let _ = write!(
            text,
            "## What `{axis}` changes\n\n{HEADLINE} over that with {axis} {base}, geometric mean over the pairs of cells that differ in nothing \
             else, with Student's 95 % interval; below 1 is better.\n\n{rows}\n"
        );
    }
    text
}

/// `1.41 (1.2 to 1.6)`.
fn ratio(effect: &Effect) -> String {
    let number = |x: f64| significant(x, ESTIMATE_DIGITS);
    let interval = match effect.interval[1].is_finite() {
        true => format!(" ({})", effect.interval.map(number).join(" to ")),
        false => String::new(),
    };
    format!("{}: {}{interval}", short(&effect.axis, &effect.value), significant(effect.ratio, DIGITS))
}

/// From which size on a larger table gains nothing.
pub(super) fn sizes(answers: &Answers) -> String {
    if answers.enough.is_empty() {
        return String::new();
    }
    let mut header = left(
        &["table", "method", "enough", "together", "the larger that does most (95 %)", "the next smaller (95 %)"]
            .map(str::to_owned),
    );
    header.push(("pairs".to_owned(), Align::Right));
    let mut rows = table(&header);
    for one in &answers.enough {
        let cell = |effect: &Option<Effect>| effect.as_ref().map_or_else(|| "not tried".to_owned(), ratio);
        let pairs = one.beyond.as_ref().or(one.below.as_ref()).map_or(0, |effect| effect.n);
        let cells = [&one.axis, &one.method, &one.value, &one.together].map(String::clone);
        let cells = cells.into_iter().chain([cell(&one.beyond), cell(&one.below), pairs.to_string()]);
        rows.row(&cells.collect::<Vec<_>>());
    }
    format!(
        "## How large must the tables be?\n\n{HEADLINE} over that with what is enough, beside other parameters at their first value or larger. Enough \
         is the smallest value from which on no larger one takes more than {} % off; together: the smallest tried combination that has enough of \
         each.\n\n{rows}\n",
        100.0 * crate::study::answers::sizes::GAIN
    )
}

/// Whether the claimed counts suffice, by model.
pub(super) fn sufficiency(answers: &Answers) -> String {
    if answers.sufficiency.is_empty() {
        return String::new();
    }
    let mut header = left(&["brdf", "method"].map(str::to_owned));
    header.push(("samples".to_owned(), Align::Right));
    header.extend([HEADLINE, "over fixed"].map(|name| (name.to_owned(), Align::Right)));
    header.push(("95 %".to_owned(), Align::Left));
    header.extend(["better in", "mean FLIP", "visible in"].map(|name| (name.to_owned(), Align::Right)));
    let mut rows = table(&header);
    for one in &answers.sufficiency {
        let number = |x: f64| significant(x, ESTIMATE_DIGITS);
        let model = one.model.clone().unwrap_or_else(|| "all".to_owned());
        let mut cells = vec![model, one.method.clone(), one.samples.to_string(), significant(one.error.median, DIGITS)];
        cells.extend(one.against.as_ref().map_or_else(
            || [const { String::new() }; 3],
            |against| {
                let ends = if against.interval[1].is_finite() {
                    against.interval.map(number).join(" to ")
                } else {
                    String::new()
                };
                [number(against.ratio), ends, format!("{} of {}", against.better, against.n)]
            },
        ));
        cells.push(one.flip.map_or_else(String::new, |flip| number(flip.median)));
        cells.push(one.flip.map_or_else(String::new, |flip| format!("{} of {}", one.visible, flip.n)));
        rows.row(&cells);
    }
    let fixed = answers.sufficiency.iter().find_map(|one| Some(one.against.as_ref()?.fixed.clone()));
    let fixed = fixed.map_or_else(String::new, |fixed| {
        format!(" Over fixed: geometric mean of the error over that of {fixed} in the same case, with Student's 95 % interval.")
    });
    format!(
        "## Do 30 to 40 samples suffice?\n\nMedians over the cases, at the plain tone curve. Visible: a mean FLIP of at least {VISIBLE_FROM}.{fixed}\n\n{rows}\n"
    )
}
