//! The tone curve, the dynamic range, and the energy that is left.

use super::{DIGITS, left, table, words};
use crate::runner::tables::{DISPLAY_HEADLINE, HEADLINE};
use crate::study::answers::dynamic_range::growth;
use crate::study::answers::exposure::VISIBLE_FROM;
use crate::study::answers::{Answers, short};
use crate::table::markdown::{Align, significant};
use std::fmt::Write;

/// The visible difference by exposure and contrast.
pub(super) fn visibility(answers: &Answers) -> String {
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

pub(super) fn dynamic_range(answers: &Answers) -> String {
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

/// What is left of the light in a white furnace.
pub(super) fn energy(answers: &Answers) -> String {
    if answers.furnace.is_empty() {
        return String::new();
    }
    let mut header = left(&answers.case_axes);
    header.push(("method".to_owned(), Align::Left));
    header.push(("albedo".to_owned(), Align::Right));
    header.push(("95 %".to_owned(), Align::Left));
    header.extend(["least", "most"].map(|name| (name.to_owned(), Align::Right)));
    let mut rows = table(&header);
    for one in &answers.furnace {
        let number = |change: f64| format!("{:.4}", 1.0 + change);
        let mut cells = words(&answers.case_axes, &one.key);
        cells.extend([one.method.clone(), number(one.change)]);
        cells.push(one.interval.map_or_else(String::new, |ends| ends.map(number).join(" to ")));
        let end = |(change, [lo, hi]): (f64, [f64; 2])| format!("{:.3} at {lo} to {}", 1.0 + change, hi.min(1.0));
        cells.extend(one.extremes.map_or_else(|| [String::new(), String::new()], |ends| ends.map(end)));
        rows.row(&cells);
    }
    format!(
        "## Energy in a white furnace\n\nEnergy that leaves over energy that arrives, with the 95 % interval that the noise of what judges it \
         gives; least and most: the bins of n_dot_v with the extremes. Above 1 energy is created.\n\n{rows}\n"
    )
}
