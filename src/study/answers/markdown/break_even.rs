//! From how many samples on a sampling method wins.

use super::{ESTIMATE_DIGITS, NO_PIXELS, left, no_pixels_note, noise_note, scored, table, words};
use crate::runner::tables::HEADLINE;
use crate::study::answers::Answers;
use crate::study::answers::break_even::{BreakEven, interval_text, median, range_text};
use crate::study::answers::cases::{Case, Pair};
use crate::study::answers::curves::fits;
use crate::study::answers::study::{Row, Study};
use crate::table::markdown::{Align, significant};
use std::collections::BTreeSet;
use std::fmt::Write;

fn interval(case: &Case, pair: &Pair) -> String {
    case.whole.interval.map_or_else(String::new, |ends| interval_text(ends, pair.tried()))
}

/// For a method with samples against one without: the sample count from which the first wins.
pub(super) fn break_even(study: &Study, answers: &Answers, pair: &Pair) -> String {
    let (sampled, fixed) = (&pair.sampled, &pair.fixed);
    let results: Vec<BreakEven> = pair.cases.iter().map(|case| case.whole.break_even).collect();
    let Some(overall) = median(&results) else { return String::new() };
    let scope = match results.len() {
        1 => String::new(),
        rows => format!("Median over all {rows} rows: "),
    };
    let mut text = format!(
        "## From how many samples on does `{sampled}` beat `{fixed}`?\n\n{scope}**{overall}** samples a pixel.\n\n"
    );
    text += &medians_over_alpha(answers, pair);
    let is_timed = pair.cases.iter().any(|case| case.time.is_some());
    let mut header = left(&answers.case_axes);
    header.push((fixed.clone(), Align::Right));
    header.extend(pair.sample_counts.iter().map(|n| (format!("{sampled} {n}"), Align::Right)));
    header.extend(["break-even", "crossing"].map(|name| (name.to_owned(), Align::Right)));
    header.push(("95 %".to_owned(), Align::Left));
    if is_timed {
        header.push(("in equal time".to_owned(), Align::Right));
        header.push(("wins in equal time".to_owned(), Align::Left));
    }
    let mut rows = table(&header);
    for case in &pair.cases {
        let curve = &answers.curves[case.curve];
        let fixed_row = study.row(case.fixed_run, &case.fixed_cell);
        let mut cells = words(&answers.case_axes, &case.key);
        cells.push(scored(case.fixed_error, fixed_row.is_none_or(Row::is_resolved)));
        cells.extend(pair.sample_counts.iter().map(|n| {
            let point = curve.points.iter().find(|point| point.samples == *n);
            point.map_or_else(
                || missing(study, &case.key, sampled, *n).to_owned(),
                |point| scored(point.error, point.is_resolved),
            )
        }));
        cells.push(case.whole.break_even.to_string());
        cells.push(case.whole.crossing.map_or_else(String::new, |n| significant(n, ESTIMATE_DIGITS)));
        cells.push(interval(case, pair));
        if is_timed {
            let [smallest, largest] = pair.tried();
            cells.push(case.time.map_or_else(String::new, |time| match time.samples {
                0.0 => format!("< {smallest}"),
                n if n.is_infinite() => format!("> {largest}"),
                n => significant(n, ESTIMATE_DIGITS),
            }));
            cells.push(case.whole.at_equal_time.name().replace("sampled", sampled).replace("fixed", fixed));
        }
        rows.row(&cells);
    }
    for key in &pair.excluded {
        rows.row(&excluded_row(answers, key, header.len()));
    }
    let basis = pair.cases.iter().map(|case| case.whole.basis.name()).find(|name| !name.is_empty()).unwrap_or_default();
    let basis = match basis {
        "point-sets" => " The interval is Student's over the point sets, and errors are geometric means of them.",
        "n-dot-v-bins" => {
            " There is one point set only: the interval is that of a jackknife over the bins of n_dot_v, how far the answer hangs on \
             which parts of the surface are seen; luck of the point set stays outside it."
        }
        _ => "",
    };
    let _ = write!(
        text,
        "{HEADLINE} of each; break-even: the smallest of the tried sample counts from which on `{sampled}` stays below `{fixed}`; \
         crossing: where the curves meet by log-log interpolation, with its 95 % interval.{basis}\n\n{rows}\n"
    );
    text += noise_note(&rows.to_string());
    if is_timed {
        text += "In equal time: the samples a pixel whose frame takes as long as one of the other method. It wins there if its crossing lies \
                 below, both with their 95 % intervals.";
        text += match pair.cases.iter().any(|case| case.time.is_some_and(|time| time.is_cpu)) {
            true => " **The times are those of a CPU driver and say nothing about a GPU.**\n\n",
            false => "\n\n",
        };
    }
    text + &break_even_by_n_dot_v(answers, pair)
}

/// What stands in a row of a case that the experiment leaves out.
fn excluded_row(answers: &Answers, key: &[String], columns: usize) -> Vec<String> {
    let words = words(&answers.case_axes, key);
    let rest = columns - words.len();
    words.into_iter().chain(std::iter::repeat_n("excluded".to_owned(), rest)).collect()
}

/// Why a case has no error at a sample count.
fn missing(study: &Study, key: &[String], method: &str, samples: u32) -> &'static str {
    let (axes, count) = (study.case_axes(), samples.to_string());
    let is_it = |values: &[String]| {
        let of = |name: &str| study.axis(name).map_or("", |axis| &values[axis]);
        let own: Vec<String> = axes.iter().map(|&axis| values[axis].clone()).collect();
        of("method") == method && of("samples") == count && fits(&own, key)
    };
    match () {
        () if study.excluded.iter().any(|values| is_it(values)) => "excluded",
        () if study.rows.iter().any(|row| row.error.is_none() && is_it(&row.axes)) => "failed",
        () => "not tried",
    }
}

fn medians_over_alpha(answers: &Answers, pair: &Pair) -> String {
    let alpha = answers.case_axes.iter().position(|name| name == "alpha");
    let others: Vec<usize> = (0..answers.case_axes.len()).filter(|axis| Some(*axis) != alpha).collect();
    if alpha.is_none() || others.is_empty() {
        return String::new();
    }
    let key_of = |case: &Case| others.iter().map(|&axis| case.key[axis].clone()).collect::<Vec<_>>();
    let names: Vec<String> = others.iter().map(|&axis| answers.case_axes[axis].clone()).collect();
    let mut header = left(&names);
    header.push(("break-even".to_owned(), Align::Right));
    let mut rows = table(&header);
    let mut seen = BTreeSet::new();
    for key in pair.cases.iter().map(key_of) {
        if seen.insert(key.clone()) {
            let own = pair.cases.iter().filter(|case| key_of(case) == key).map(|case| case.whole.break_even);
            let middle = median(&own.collect::<Vec<_>>()).map_or_else(String::new, |m| m.to_string());
            rows.row(&words(&names, &key).into_iter().chain([middle]).collect::<Vec<_>>());
        }
    }
    format!("Median over alpha:\n\n{rows}\n")
}

fn break_even_by_n_dot_v(answers: &Answers, pair: &Pair) -> String {
    let mut bins: Vec<(f64, f64)> = pair.cases.iter().flat_map(|c| c.bins.iter().map(|bin| (bin.lo, bin.hi))).collect();
    bins.sort_by(|a, b| a.0.total_cmp(&b.0));
    bins.dedup();
    if bins.is_empty() {
        return String::new();
    }
    let mut header = left(&answers.case_axes);
    header.extend(bins.iter().map(|(lo, hi)| (format!("{lo} to {}", hi.min(1.0)), Align::Right)));
    let mut rows = table(&header);
    for case in &pair.cases {
        let mut cells = words(&answers.case_axes, &case.key);
        cells.extend(bins.iter().map(|(lo, _)| {
            let bin = case.bins.iter().find(|bin| bin.lo == *lo);
            bin.map_or_else(
                || NO_PIXELS.to_owned(),
                |bin| {
                    let range = bin.crossing.interval.map(|ends| range_text(ends, pair.tried()));
                    let range = range.map_or_else(String::new, |range| format!(" ({range})"));
                    format!("{}{range}", bin.crossing.break_even)
                },
            )
        }));
        rows.row(&cells);
    }
    for key in &pair.excluded {
        rows.row(&excluded_row(answers, key, header.len()));
    }
    let note = no_pixels_note(&rows.to_string());
    let has_ranges = pair.cases.iter().flat_map(|case| &case.bins).any(|bin| bin.crossing.interval.is_some());
    let ranges = match has_ranges {
        true => " In brackets the 95 % interval of the crossing; `?`: no tried count tells the two apart.",
        false => "",
    };
    format!("The same over the pixels of each bin of n_dot_v, grazing angles on the left.{ranges}\n\n{rows}\n{note}")
}
