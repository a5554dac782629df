//! The answers as sections of `summary.md`.

use super::break_even::{BreakEven, interval_text, median};
use super::cases::{Case, Pair};
use super::curves::fits;
use super::dynamic_range::growth;
use super::exposure::VISIBLE_FROM;
use super::study::{Row, Study};
use super::{Answers, grouped, heat, short};
use crate::experiment::tables::{DISPLAY_HEADLINE, HEADLINE};
use crate::table::markdown::{Align, MarkdownTable, significant};
use std::collections::BTreeSet;
use std::fmt::Write;

/// Digits of a score in the summary; the CSV has all.
const DIGITS: usize = 3;
/// Digits of an estimate with an interval.
const ESTIMATE_DIGITS: usize = 2;
/// Stands after a score that the reference's own noise reaches.
const NOISE_MARK: &str = " ~";

/// All sections that the experiment has the axes for.
pub fn sections(study: &Study, answers: &Answers) -> String {
    let mut text: String = answers.pairs.iter().map(|pair| break_even(study, answers, pair)).collect();
    if answers.pairs.is_empty() {
        text += &errors(study);
    }
    text += &slopes(answers);
    text += &error_by_n_dot_v(answers);
    text += &visibility(answers);
    text += &dynamic_range(answers);
    text += &effects(answers);
    text
}

fn words(axes: &[String], key: &[String]) -> Vec<String> {
    axes.iter().zip(key).map(|(axis, value)| short(axis, value).into_owned()).collect()
}

fn scored(error: f64, is_resolved: bool) -> String {
    format!("{}{}", significant(error, DIGITS), if is_resolved { "" } else { NOISE_MARK })
}

fn noise_note(text: &str) -> &'static str {
    if text.contains(NOISE_MARK) {
        "`~`: within ten times what the reference's own noise would give; more reference samples would change it.\n\n"
    } else {
        ""
    }
}

/// Stands where no pixel of the image is in a bin.
const NO_PIXELS: &str = "–";

fn no_pixels_note(text: &str) -> &'static str {
    if text.contains(NO_PIXELS) { "–: no pixel of the image is in the bin.\n\n" } else { "" }
}

fn table(header: &[(String, Align)]) -> MarkdownTable {
    MarkdownTable::new(&header.iter().map(|(name, align)| (name.as_str(), *align)).collect::<Vec<_>>())
}

fn left(names: &[String]) -> Vec<(String, Align)> {
    names.iter().map(|name| (name.clone(), Align::Left)).collect()
}

fn interval(case: &Case, pair: &Pair) -> String {
    case.whole.interval.map_or_else(String::new, |ends| interval_text(ends, pair.tried()))
}

/// For a method with samples against one without: the sample count from which the first wins.
fn break_even(study: &Study, answers: &Answers, pair: &Pair) -> String {
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
            bin.map_or_else(|| NO_PIXELS.to_owned(), |bin| bin.crossing.break_even.to_string())
        }));
        rows.row(&cells);
    }
    for key in &pair.excluded {
        rows.row(&excluded_row(answers, key, header.len()));
    }
    let note = no_pixels_note(&rows.to_string());
    format!("The same over the pixels of each bin of n_dot_v, grazing angles on the left:\n\n{rows}\n{note}")
}

/// The headline error of every method in every row.
fn errors(study: &Study) -> String {
    let axes = study.case_axes();
    let names: Vec<String> = axes.iter().map(|&axis| study.axes[axis].name.clone()).collect();
    let mut labels: Vec<String> = Vec::new();
    for label in study.rows.iter().filter(|row| row.error.is_some()).map(|row| study.method_label(row)) {
        if !labels.contains(&label) {
            labels.push(label);
        }
    }
    if labels.is_empty() {
        return String::new();
    }
    let mut header = left(&names);
    header.extend(labels.iter().map(|label| (label.clone(), Align::Right)));
    let mut rows = table(&header);
    for (key, own) in grouped(study, &axes) {
        let mut cells = words(&names, &key);
        for label in &labels {
            let of_label = own.iter().filter(|row| study.method_label(row) == *label);
            let mut errors = of_label.clone().filter_map(|row| row.error);
            let is_resolved = of_label.clone().all(|row| row.is_resolved());
            cells.push(errors.next().map_or_else(String::new, |error| scored(error, is_resolved)));
        }
        rows.row(&cells);
    }
    let note = noise_note(&rows.to_string());
    format!("## Errors\n\n{HEADLINE} by method and sample count:\n\n{rows}\n{note}")
}

fn slopes(answers: &Answers) -> String {
    let curves: Vec<_> = answers.curves.iter().filter(|curve| curve.points.len() > 2).collect();
    if curves.is_empty() {
        return String::new();
    }
    let mut header = left(&answers.case_axes);
    header.push(("method".to_owned(), Align::Left));
    header.push(("slope".to_owned(), Align::Right));
    header.push(("95 %".to_owned(), Align::Left));
    header.push(("points".to_owned(), Align::Right));
    let mut rows = table(&header);
    for curve in curves {
        let mut cells = words(&answers.case_axes, &curve.key);
        let number = |x: f64| format!("{x:.2}");
        cells.push(curve.method.clone());
        cells.push(curve.slope.map_or_else(|| "no fit".to_owned(), |slope| number(slope.value)));
        cells.push(
            curve.slope.map_or_else(String::new, |slope| format!("{} to {}", number(slope.lo), number(slope.hi))),
        );
        let used = curve.points.iter().filter(|point| point.is_resolved).count();
        cells.push(format!("{used} of {}", curve.points.len()));
        rows.row(&cells);
    }
    format!(
        "## Convergence\n\nSlope of ln({HEADLINE}) over ln(samples), fitted to the points that lie above the reference's noise; plain Monte Carlo \
         has -1. A filtered method flattens at its bias.\n\n{rows}\n"
    )
}

fn error_by_n_dot_v(answers: &Answers) -> String {
    if answers.heat.is_empty() {
        return String::new();
    }
    let mut text = format!("## Error by alpha and n_dot_v\n\nMedian {HEADLINE}; grazing angles on the left.\n\n");
    for one in heat::shown(&answers.heat) {
        let mut header = vec![("alpha".to_owned(), Align::Right)];
        header.extend(one.bins.iter().map(|(lo, hi)| (format!("{lo} to {}", hi.min(1.0)), Align::Right)));
        let mut rows = table(&header);
        for (alpha, errors) in one.alphas.iter().zip(&one.errors) {
            let number = |e| significant(e, ESTIMATE_DIGITS);
            let cells = errors.iter().map(|error| error.map_or_else(|| NO_PIXELS.to_owned(), number));
            let alpha = short("alpha", &alpha.to_string()).into_owned();
            rows.row(&[alpha].into_iter().chain(cells).collect::<Vec<_>>());
        }
        let note = no_pixels_note(&rows.to_string());
        let _ = write!(text, "`{}`:\n\n{rows}\n{note}", one.label());
    }
    text
}

/// The visible difference by exposure and contrast.
fn visibility(answers: &Answers) -> String {
    let visibility = &answers.visibility;
    if visibility.is_empty() {
        return String::new();
    }
    let mut labels: Vec<&str> = Vec::new();
    let mut settings: Vec<(f64, f64)> = Vec::new();
    for one in visibility {
        if !labels.contains(&one.method.as_str()) {
            labels.push(&one.method);
        }
        settings.push((one.contrast, one.exposure));
    }
    settings.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1)));
    settings.dedup();
    let mut header = ["contrast", "exposure"].map(|name| (name.to_owned(), Align::Right)).to_vec();
    header.extend(labels.iter().map(|label| (label.to_string(), Align::Right)));
    let mut rows = table(&header);
    for (contrast, exposure) in settings {
        let mut cells = vec![contrast.to_string(), exposure.to_string()];
        for label in &labels {
            let one = visibility
                .iter()
                .find(|one| one.method == *label && (one.contrast, one.exposure) == (contrast, exposure));
            cells.push(one.map_or_else(String::new, |one| {
                let text = significant(one.median, DIGITS);
                if one.is_visible() { format!("**{text}**") } else { text }
            }));
        }
        rows.row(&cells);
    }
    format!(
        "## After the tone curve\n\nMedian {DISPLAY_HEADLINE} (0 is equal) over everything else that is swept. **Bold**: at least {VISIBLE_FROM}, \
         taken as visible; the rest is hidden by the curve.\n\n{rows}\n"
    )
}

fn dynamic_range(answers: &Answers) -> String {
    let points = &answers.dynamic_range;
    if points.is_empty() {
        return String::new();
    }
    let mut labels: Vec<&str> = Vec::new();
    let mut lights: Vec<(&str, &str, &str, f64)> = Vec::new();
    for point in points {
        if !labels.contains(&point.method.as_str()) {
            labels.push(&point.method);
        }
        let light = (point.series.as_str(), point.environment.as_str(), point.clip_log2.as_str(), point.range);
        if !lights.contains(&light) {
            lights.push(light);
        }
    }
    lights.sort_by(|a, b| a.0.cmp(b.0).then(a.3.total_cmp(&b.3)));
    let mut header = vec![("environment".to_owned(), Align::Left)];
    header.extend(["clip, log2", "range, stops"].map(|name| (name.to_owned(), Align::Right)));
    header.extend(labels.iter().map(|label| (label.to_string(), Align::Right)));
    let mut rows = table(&header);
    for (series, environment, clip, range) in lights {
        let name = short("environment", environment).into_owned();
        let mut cells = vec![name, clip.to_owned(), format!("{range:.1}")];
        for label in &labels {
            let point = points.iter().find(|point| {
                point.method == *label
                    && point.series == series
                    && point.environment == environment
                    && point.clip_log2 == clip
            });
            cells.push(point.map_or_else(String::new, |point| significant(point.median, DIGITS)));
        }
        rows.row(&cells);
    }
    let mut text = format!(
        "## Dynamic range\n\nMedian {HEADLINE} over everything else that is swept; range: log2 of peak over mean luminance.\n\n{rows}\n"
    );
    let growth = growth(points);
    if !growth.is_empty() {
        let mut header = left(&["series", "method"].map(str::to_owned));
        header.push(("factor a stop".to_owned(), Align::Right));
        header.push(("95 %".to_owned(), Align::Left));
        let mut rows = table(&header);
        for one in growth {
            let ends = [one.fit.lo, one.fit.hi].map(|end| significant(end.exp(), DIGITS)).join(" to ");
            rows.row(&[one.series, one.method, significant(one.fit.value.exp(), DIGITS), ends]);
        }
        let _ = write!(text, "What a stop more does to the error (fit of ln of these medians over stops):\n\n{rows}\n");
    }
    text
}

/// What each parameter changes.
fn effects(answers: &Answers) -> String {
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
