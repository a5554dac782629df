//! Heat maps over alpha and `n_dot_v`: break-even and error.

use super::figures::{
    ERROR_LABEL, ERROR_NOTE, PANELS_MAX, alpha_axis, alpha_of, alpha_text, cut_off_note, distinct, facet,
};
use super::grid::{Gap, HeatCell, HeatChart, HeatPanel};
use super::scale::{Kind, Scale};
use crate::study::answers::break_even::{BreakEven, range_text};
use crate::study::answers::cases::{Case, Pair};
use crate::study::answers::{Answers, heat};
use crate::table::markdown::significant;

/// `0–0.1` of a bin.
fn bin_name((lo, hi): (f64, f64)) -> String {
    format!("{lo}–{}", hi.min(1.0))
}

/// Break-even by alpha and `n_dot_v`.
pub fn break_even(answers: &Answers, pair: &Pair) -> Option<HeatChart> {
    let facets = distinct(pair.cases.iter().map(|case| facet(answers, &case.key)));
    let mut bins = distinct(pair.cases.iter().flat_map(|case| case.bins.iter().map(|bin| (bin.lo, bin.hi))));
    bins.sort_by(|a, b| a.0.total_cmp(&b.0));
    if bins.is_empty() {
        return None;
    }
    let [smallest, largest] = pair.tried().map(f64::from);
    let never = 2.0 * largest;
    let panel = |name: &String| {
        let is_own = |key: &[String]| facet(answers, key) == *name;
        let cell = |case: &Case, lo: f64| {
            let bin = case.bins.iter().find(|bin| bin.lo == lo).ok_or(Gap::NoPixels)?;
            let value = match bin.crossing.break_even {
                BreakEven::From(n) => f64::from(n),
                BreakEven::Above(_) => never,
            };
            let range = bin.crossing.interval.map_or_else(String::new, |ends| range_text(ends, pair.tried()));
            Ok(HeatCell { value, text: bin.crossing.break_even.to_string(), range })
        };
        let mut rows: Vec<(&str, Vec<Result<HeatCell, Gap>>)> = Vec::new();
        for case in pair.cases.iter().filter(|case| is_own(&case.key)) {
            rows.push((alpha_of(answers, &case.key), bins.iter().map(|(lo, _)| cell(case, *lo)).collect()));
        }
        for key in pair.excluded.iter().filter(|key| is_own(key)) {
            rows.push((alpha_of(answers, key), vec![Err(Gap::Excluded); bins.len()]));
        }
        let number = |alpha: &str| alpha.parse::<f64>().unwrap_or(f64::NAN);
        rows.sort_by(|a, b| number(a.0).total_cmp(&number(b.0)));
        let (alphas, cells): (Vec<&str>, Vec<_>) = rows.into_iter().unzip();
        HeatPanel {
            title: if facets.len() > 1 { name.clone() } else { String::new() },
            rows: alphas.into_iter().map(alpha_text).collect(),
            columns: bins.iter().map(|bin| bin_name(*bin)).collect(),
            cells,
        }
    };
    let panels: Vec<HeatPanel> = facets.iter().take(PANELS_MAX).map(panel).collect();
    let mut notes = vec![format!(
        "Smallest tried sample count from which on {} stays below the error of {} over the pixels of the bin; > {largest}: never up to \
         there.",
        pair.sampled, pair.fixed
    )];
    let mut cells = panels.iter().flat_map(|panel| panel.cells.iter().flatten().flatten());
    if cells.any(|cell| !cell.range.is_empty()) {
        notes.push("Below it the 95 % interval of the crossing; ?: no tried count tells the two apart.".to_owned());
    }
    notes.extend(gap_notes(&panels));
    notes.extend(cut_off_note(&facets));
    Some(HeatChart {
        title: format!("Break-even of {} with {} by α and n·v", pair.sampled, pair.fixed),
        notes,
        row_label: if alpha_axis(answers).is_some() { "α".to_owned() } else { String::new() },
        column_label: "n·v: grazing to facing the viewer".to_owned(),
        color_label: "samples a pixel".to_owned(),
        range: [smallest, never],
        color_ticks: pair
            .sample_counts
            .iter()
            .map(|n| (f64::from(*n), n.to_string()))
            .chain([(never, format!("> {largest}"))])
            .collect(),
        panels,
    })
}

/// What the places without a value mean, where there are some.
fn gap_notes(panels: &[HeatPanel]) -> Vec<String> {
    let has = |gap| panels.iter().flat_map(|panel| panel.cells.iter().flatten()).any(|cell| *cell == Err(gap));
    let excluded = "Hatched: the experiment leaves these combinations out.";
    let no_pixels = "–: no pixel of the image is in the bin.";
    let notes = [(Gap::Excluded, excluded), (Gap::NoPixels, no_pixels)];
    notes.into_iter().filter(|(gap, _)| has(*gap)).map(|(_, note)| note.to_owned()).collect()
}

fn heat_cell(error: heat::HeatError) -> HeatCell {
    let text = |x: f64| significant(x, 2);
    let range = error.interval.map_or_else(String::new, |[lo, hi]| format!("{}–{}", text(lo), text(hi)));
    HeatCell { value: error.median, text: text(error.median), range }
}

/// Error by alpha and `n_dot_v`.
pub fn error(answers: &Answers) -> Option<HeatChart> {
    let shown = heat::shown(&answers.heat);
    let errors = shown.iter().flat_map(|table| table.errors.iter().flatten().flatten());
    let (mut lo, mut hi) = (f64::INFINITY, 0.0f64);
    let values = errors.clone().map(|error| error.median).filter(|error| *error > 0.0);
    values.for_each(|error| (lo, hi) = (lo.min(error), hi.max(error)));
    if lo > hi {
        return None;
    }
    let intervals: Vec<String> = errors
        .into_iter()
        .any(|error| error.interval.is_some())
        .then(|| "Below it the interval that holds the median over cases with 95 %.".to_owned())
        .into_iter()
        .collect();
    // One value has no range: a decade about it is as good as any.
    let range = if hi > lo { [lo, hi] } else { [lo / 3.0, hi * 3.0] };
    let panel = |table: &&heat::HeatTable| HeatPanel {
        title: table.label(),
        rows: table.alphas.iter().map(|alpha| alpha_text(&alpha.to_string())).collect(),
        columns: table.bins.iter().map(|bin| bin_name(*bin)).collect(),
        cells: table
            .errors
            .iter()
            .map(|row| row.iter().map(|e| e.map(heat_cell).ok_or(Gap::NoPixels)).collect())
            .collect(),
    };
    Some(HeatChart {
        title: "Error by α and n·v".to_owned(),
        notes: [vec!["Median over everything else that is swept.".to_owned()], intervals, vec![ERROR_NOTE.to_owned()]]
            .concat(),
        row_label: "α".to_owned(),
        column_label: "n·v: grazing to facing the viewer".to_owned(),
        color_label: ERROR_LABEL.to_owned(),
        range,
        color_ticks: Scale::of(Kind::Log, range)?.ticks,
        panels: shown.iter().map(panel).collect(),
    })
}
