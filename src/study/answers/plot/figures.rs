//! Which pictures an experiment's answers make.

use super::canvas::{MUTED, Marker, PlotError, Rgb, Stroke, name_color};
use super::lines::{LineChart, Panel, Point, Rule, Series, Y};
use super::scale::{Kind, Scale};
use super::{Picture, light, maps, parameters, slopes};
use crate::study::answers::break_even::BreakEven;
use crate::study::answers::cases::{Case, Pair};
use crate::study::answers::exposure::{VISIBLE_FROM, Visibility};
use crate::study::answers::study::Study;
use crate::study::answers::{Answers, key_label, short};
use crate::table::colormap::Palette;
use crate::table::markdown::significant;

/// More panels than this do not fit on a page; the tables have the rest.
pub(super) const PANELS_MAX: usize = 24;
/// More names than this are not written below a picture.
const NAMES_MAX: usize = 12;
/// A noise floor this far below every error would press the curves together: it is written out instead.
const FLOOR_WITHIN: f64 = 100.0;
/// More series than this would hide each other behind their bars.
pub(super) const SERIES_WITH_BARS_MAX: usize = 6;
/// Labels on an axis of tried values.
pub(super) const TRIED_LABELS: usize = 9;

/// The headline error on an axis.
pub(super) const ERROR_LABEL: &str = "relMSE, ε = 0.01";
/// What it is; stands below every picture of it.
pub(super) const ERROR_NOTE: &str =
    "relMSE: mean of (image − reference)² / (reference² + 0.01), without a unit; 0 is equal.";

/// All pictures that the experiment has the axes for.
pub fn pictures(study: &Study, answers: &Answers) -> Result<Vec<Picture>, PlotError> {
    let mut pictures = Vec::new();
    let mut add = |name: &str, svg: Option<Result<String, PlotError>>| -> Result<(), PlotError> {
        if let Some(svg) = svg.transpose()? {
            pictures.push(Picture { name: name.to_owned(), svg });
        }
        Ok(())
    };
    add("convergence", convergence(answers).map(|chart| chart.svg()))?;
    add("convergence_slopes", slopes::slopes(answers).map(|chart| chart.svg()))?;
    for (index, pair) in answers.pairs.iter().enumerate() {
        // The first pair has the plain name: it is the one that the answer speaks of.
        let name = |stem: &str| match index {
            0 => stem.to_owned(),
            _ => format!("{stem}_{}_{}", pair.sampled, pair.fixed),
        };
        add(&name("break_even"), break_even(answers, pair).map(|chart| chart.svg()))?;
        add(&name("break_even_by_n_dot_v"), maps::break_even(answers, pair).map(|chart| chart.svg()))?;
    }
    add("error_by_n_dot_v_and_alpha", maps::error(answers).map(|chart| chart.svg()))?;
    add("exposure_and_contrast", visibility(answers).map(|chart| chart.svg()))?;
    add("dynamic_range", light::dynamic_range(answers).map(|chart| chart.svg()))?;
    add("energy", light::energy(answers).map(|chart| chart.svg()))?;
    for (axis, chart) in parameters::charts(answers) {
        add(&format!("effect_of_{axis}"), Some(chart.svg()))?;
    }
    add("time_and_error", parameters::time_and_error(study).map(|chart| chart.svg()))?;
    Ok(pictures)
}

/// Colours of ordered values: dark is small.
pub(super) fn ordinal(index: usize, count: usize) -> Rgb {
    const FROM: f64 = 0.08;
    const TO: f64 = 0.78;
    let place = if count < 2 { 0.3 } else { index as f64 / (count - 1) as f64 };
    Palette::Magma.color(FROM + (TO - FROM) * place)
}

/// Distinct values in their order.
pub(super) fn distinct<T: PartialEq>(values: impl IntoIterator<Item = T>) -> Vec<T> {
    let mut found: Vec<T> = Vec::new();
    for value in values {
        if !found.contains(&value) {
            found.push(value);
        }
    }
    found
}

pub(super) fn alpha_axis(answers: &Answers) -> Option<usize> {
    answers.case_axes.iter().position(|name| name == "alpha")
}

pub(super) fn alpha_of<'k>(answers: &Answers, key: &'k [String]) -> &'k str {
    alpha_axis(answers).map_or("", |axis| &key[axis])
}

/// Alpha as it is written into pictures.
pub(super) fn alpha_text(alpha: &str) -> String {
    short("alpha", alpha).into_owned()
}

/// What a panel shows: everything of a case but alpha.
pub(super) fn facet(answers: &Answers, key: &[String]) -> String {
    let kept = |of: &[String]| -> Vec<String> {
        let alpha = alpha_axis(answers);
        of.iter().enumerate().filter(|(i, _)| Some(*i) != alpha).map(|(_, text)| text.clone()).collect()
    };
    key_label(&kept(&answers.case_axes), &kept(key))
}

/// Which settings have no panel, by name.
pub(super) fn cut_off_note(names: &[String]) -> Option<String> {
    let left_out = names.get(PANELS_MAX..).filter(|names| !names.is_empty())?;
    let shown = left_out.iter().take(NAMES_MAX).map(String::as_str).collect::<Vec<_>>().join(", ");
    let more = left_out.len().saturating_sub(NAMES_MAX);
    let more = if more > 0 { format!(" and {more} more") } else { String::new() };
    Some(format!("Not drawn: {shown}{more}; the table beside the picture has them."))
}

/// Error over sample count with the reference's noise floor.
fn convergence(answers: &Answers) -> Option<LineChart> {
    let curves: Vec<_> = answers.curves.iter().filter(|curve| curve.points.len() > 1).collect();
    let facets = distinct(curves.iter().map(|curve| facet(answers, &curve.key)));
    let alphas = distinct(curves.iter().map(|curve| alpha_of(answers, &curve.key)));
    let methods = distinct(curves.iter().map(|curve| curve.method.as_str()));
    let fixed = distinct(answers.pairs.iter().map(|pair| pair.fixed.as_str()));
    let color = |alpha: &str, method: usize| match alphas.len() {
        0 | 1 => name_color(method),
        count => ordinal(alphas.iter().position(|known| *known == alpha).unwrap_or(0), count),
    };
    let counts: Vec<f64> = curves.iter().flat_map(|c| c.points.iter().map(|p| f64::from(p.samples))).collect();
    let lowest = curves.iter().flat_map(|c| c.points.iter().map(|p| p.error)).fold(f64::INFINITY, f64::min);
    let all_floors: Vec<f64> =
        curves.iter().filter_map(|curve| curve.noise_floor).filter(|floor| *floor > 0.0).collect();
    let is_near = |floor: &f64| *floor * FLOOR_WITHIN > lowest;
    let mut panels = Vec::new();
    for name in facets.iter().take(PANELS_MAX) {
        let own: Vec<_> = curves.iter().filter(|curve| facet(answers, &curve.key) == *name).collect();
        let mut series: Vec<Series> = Vec::new();
        for curve in &own {
            let method = methods.iter().position(|known| *known == curve.method).unwrap_or(0);
            let alpha = alpha_of(answers, &curve.key);
            let place = alphas.iter().position(|known| *known == alpha).unwrap_or(0);
            let label = match (alphas.len(), methods.len()) {
                (0 | 1, _) => curve.method.clone(),
                (_, 1) => format!("{} α {}", curve.method, alpha_text(alpha)),
                _ => format!("α {}, {}", alpha_text(alpha), curve.method),
            };
            let points = curve.points.iter().map(|point| Point {
                x: f64::from(point.samples),
                y: Y::At(point.error),
                interval: (point.errors.len() > 1).then(|| {
                    let end = |f: fn(f64, f64) -> f64| point.errors.iter().copied().reduce(f).unwrap_or(point.error);
                    [end(f64::min), end(f64::max)]
                }),
            });
            series.push(Series {
                label,
                color: color(alpha, method),
                marker: Some(Marker::of(if alphas.len() > 1 { place } else { method })),
                stroke: Some([Stroke::Solid, Stroke::Dashed, Stroke::Dotted][method % 3]),
                points: points.collect(),
            });
        }
        let mut rules: Vec<Rule> = answers
            .pairs
            .iter()
            .flat_map(|pair| pair.cases.iter().map(move |case| (pair, case)))
            .filter(|(_, case)| facet(answers, &case.key) == *name)
            .map(|(pair, case)| Rule {
                label: if alphas.len() > 1 { format!("{}, colour by α", pair.fixed) } else { pair.fixed.clone() },
                color: if alphas.len() > 1 { color(alpha_of(answers, &case.key), 0) } else { [0, 0, 0] },
                stroke: Stroke::Dotted,
                y: case.fixed_error,
            })
            .collect();
        let floor = own.iter().filter_map(|curve| curve.noise_floor).filter(is_near).reduce(f64::max);
        rules.extend(floor.map(|y| Rule {
            label: "reference noise floor (largest)".to_owned(),
            color: MUTED,
            stroke: Stroke::Dashed,
            y,
        }));
        panels.push(Panel { title: if facets.len() > 1 { name.clone() } else { String::new() }, series, rules });
    }
    let values = panels.iter().flat_map(|panel| {
        let points = panel.series.iter().flat_map(|series| &series.points);
        points
            .flat_map(|p| p.y.known().into_iter().chain(p.interval.into_iter().flatten()))
            .chain(panel.rules.iter().map(|r| r.y))
    });
    let y = Scale::of(Kind::Log, values)?;
    let x = Scale::of(Kind::Log, counts.iter().copied())?.with_ticks(&counts, TRIED_LABELS);
    let far = all_floors.iter().copied().filter(|floor| !is_near(floor)).reduce(f64::max);
    let mut notes: Vec<String> = cut_off_note(&facets).into_iter().collect();
    notes.push(ERROR_NOTE.to_owned());
    if curves.iter().any(|curve| curve.points.iter().any(|point| point.errors.len() > 1)) {
        notes.push("Points: geometric mean of the point sets; bars: from the best set to the worst.".to_owned());
    }
    notes.extend(far.map(|floor| {
        format!(
            "Reference noise floor: at most {}, below the drawing; an exact image would score that.",
            significant(floor, 2)
        )
    }));
    Some(LineChart {
        title: title("Convergence", &fixed),
        notes,
        x_label: "samples a pixel".to_owned(),
        y_label: ERROR_LABEL.to_owned(),
        x,
        y,
        bands: [None, None],
        is_aside: true,
        panels,
    })
}

fn title(start: &str, fixed: &[&str]) -> String {
    if fixed.is_empty() { start.to_owned() } else { format!("{start}, with {}", fixed.join(" and ")) }
}

/// Break-even of every case over alpha: at equal error, and what fits into the other's time.
fn break_even(answers: &Answers, pair: &Pair) -> Option<LineChart> {
    let alphas: Vec<f64> = pair.cases.iter().filter_map(|case| alpha_of(answers, &case.key).parse().ok()).collect();
    if distinct(alphas.iter().map(|alpha| alpha.to_bits())).len() < 2 {
        return None;
    }
    let facets = distinct(pair.cases.iter().map(|case| facet(answers, &case.key)));
    let [smallest, largest] = pair.tried().map(f64::from);
    let crossing = |case: &Case| match (case.whole.crossing, case.whole.break_even) {
        (Some(crossing), _) => Y::At(crossing),
        (None, BreakEven::From(_)) => Y::Below,
        (None, BreakEven::Above(_)) => Y::Above,
    };
    let mut panels = Vec::new();
    for name in facets.iter().take(PANELS_MAX) {
        let mut own: Vec<(f64, &Case)> = pair
            .cases
            .iter()
            .filter(|case| facet(answers, &case.key) == *name)
            .filter_map(|case| Some((alpha_of(answers, &case.key).parse().ok()?, case)))
            .collect();
        own.sort_by(|a, b| a.0.total_cmp(&b.0));
        let equal_error =
            own.iter().map(|(alpha, case)| Point { x: *alpha, y: crossing(case), interval: case.whole.interval });
        let equal_time = own.iter().filter_map(|(alpha, case)| {
            let time = case.time?;
            let y = match time.samples {
                n if n < smallest => Y::Below,
                n if n > largest => Y::Above,
                n => Y::At(n),
            };
            Some(Point { x: *alpha, y, interval: time.interval })
        });
        let series = [
            Series {
                label: format!("equal error: {} is better above", pair.sampled),
                color: name_color(0),
                marker: Some(Marker::Circle),
                stroke: Some(Stroke::Solid),
                points: equal_error.collect(),
            },
            Series {
                label: format!("equal time: {} is cheaper below", pair.sampled),
                color: name_color(1),
                marker: Some(Marker::Square),
                stroke: Some(Stroke::Dashed),
                points: equal_time.collect(),
            },
        ];
        panels.push(Panel {
            title: if facets.len() > 1 { name.clone() } else { String::new() },
            series: series.into_iter().filter(|series| !series.points.is_empty()).collect(),
            rules: Vec::new(),
        });
    }
    let counts: Vec<f64> = pair.sample_counts.iter().map(|n| f64::from(*n)).collect();
    let mut notes = vec!["Bars: 95 % intervals; an arrow is an end beyond the counts that were tried.".to_owned()];
    let is_there =
        |wanted: Y| panels.iter().flat_map(|p: &Panel| &p.series).flat_map(|s| &s.points).any(|p| p.y == wanted);
    let bands = [(Y::Below, format!("< {smallest}")), (Y::Above, format!("> {largest}"))]
        .map(|(y, text)| is_there(y).then_some(text));
    if bands[0].is_some() {
        notes.push(format!("Hollow arrow down: at or below {smallest}, the fewest samples that were tried."));
    }
    if bands[1].is_some() {
        notes.push(format!("Hollow arrow up: never up to {largest} samples, the most that were tried."));
    }
    if pair.cases.iter().any(|case| case.time.is_some()) {
        notes.push(format!("Where the squares lie above the circles, {} wins in equal frame time.", pair.sampled));
    }
    if pair.cases.iter().any(|case| case.time.is_some_and(|time| time.is_cpu)) {
        notes.push("Times of a CPU driver: they say nothing about a GPU.".to_owned());
    }
    notes.extend(cut_off_note(&facets));
    Some(LineChart {
        title: format!("Break-even of {} with {}", pair.sampled, pair.fixed),
        notes,
        x_label: "α (microfacet width)".to_owned(),
        y_label: "samples a pixel".to_owned(),
        x: Scale::of(Kind::Log, alphas.iter().copied())?.with_ticks(&alphas, TRIED_LABELS),
        y: Scale::of(Kind::Log, counts.iter().copied())?.with_ticks(&counts, 2 * TRIED_LABELS),
        bands,
        is_aside: true,
        panels,
    })
}

/// FLIP over exposure, one panel a contrast; over contrast where only that is swept.
fn visibility(answers: &Answers) -> Option<LineChart> {
    let visibility = &answers.visibility;
    let exposures = distinct(visibility.iter().map(|one| one.exposure));
    let contrasts = distinct(visibility.iter().map(|one| one.contrast));
    let methods = distinct(visibility.iter().map(|one| one.method.as_str()));
    let over_exposure = exposures.len() > 1;
    let x_of = |one: &Visibility| {
        if over_exposure { one.exposure } else { one.contrast }
    };
    let mut panels = Vec::new();
    let panel_values: Vec<Option<f64>> =
        if over_exposure { contrasts.iter().copied().map(Some).collect() } else { vec![None] };
    let is_drawn = |contrast: &Option<f64>| {
        let own = visibility.iter().filter(|one| contrast.is_none_or(|contrast| one.contrast == contrast));
        distinct(own.map(|one| x_of(one).to_bits())).len() > 1
    };
    for contrast in panel_values.into_iter().filter(is_drawn).take(PANELS_MAX) {
        let series = methods.iter().enumerate().map(|(index, method)| {
            let own = visibility
                .iter()
                .filter(|one| one.method == **method && contrast.is_none_or(|contrast| one.contrast == contrast));
            let half = |one: &Visibility| [one.lower_quartile, one.upper_quartile];
            let has_bars = methods.len() <= SERIES_WITH_BARS_MAX;
            let interval = |one: &Visibility| (has_bars && one.n > 1).then(|| half(one));
            let mut points: Vec<Point> =
                own.map(|one| Point { x: x_of(one), y: Y::At(one.median), interval: interval(one) }).collect();
            points.sort_by(|a, b| a.x.total_cmp(&b.x));
            Series {
                label: method.to_string(),
                color: name_color(index),
                marker: Some(Marker::of(index)),
                stroke: Some([Stroke::Solid, Stroke::Dashed, Stroke::Dotted][index / 7 % 3]),
                points,
            }
        });
        panels.push(Panel {
            title: contrast.map_or_else(String::new, |contrast| format!("contrast {contrast}")),
            series: series.filter(|series| !series.points.is_empty()).collect(),
            rules: vec![Rule {
                label: format!("{VISIBLE_FROM}: hidden below"),
                color: MUTED,
                stroke: Stroke::Dashed,
                y: VISIBLE_FROM,
            }],
        });
    }
    let xs = if over_exposure { exposures } else { contrasts };
    let drawn = panels.iter().flat_map(|panel: &Panel| panel.series.iter().flat_map(|series| &series.points));
    let drawn = drawn.flat_map(|point| point.y.known().into_iter().chain(point.interval.into_iter().flatten()));
    let y = Scale::of(Kind::Linear, drawn.chain([0.0, VISIBLE_FROM]))?;
    let cuts = distinct(answers.visibility.iter().map(|one| one.contrast.to_bits())).len() > panels.len();
    let notes = (over_exposure && cuts)
        .then(|| "Contrasts that were tried at one exposure only are in the table alone.".to_owned());
    (!panels.is_empty()).then_some(())?;
    Some(LineChart {
        title: "What the tone curve shows and hides".to_owned(),
        notes: ["Median FLIP over everything else that is swept, bars: the middle half; 0: no visible difference."
            .to_owned()]
        .into_iter()
        .chain(notes)
        .collect(),
        x_label: if over_exposure { "exposure" } else { "contrast" }.to_owned(),
        y_label: "mean FLIP".to_owned(),
        x: Scale::of(Kind::Log, xs.iter().copied())?.with_ticks(&xs, TRIED_LABELS),
        y,
        bands: [None, None],
        is_aside: true,
        panels,
    })
}
