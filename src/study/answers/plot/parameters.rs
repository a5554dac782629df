//! Pictures of what a parameter changes, and of time against error.

use super::canvas::{MUTED, Marker, Stroke, name_color};
use super::figures::{ERROR_LABEL, ERROR_NOTE, distinct};
use super::lines::{LineChart, Panel, Point, Rule, Series, Y};
use super::scale::{Kind, Scale};
use crate::runner::axis::by_name;
use crate::runner::statistics::spread;
use crate::study::answers::effects::Effect;
use crate::study::answers::sizes::size_of;
use crate::study::answers::study::Study;
use crate::study::answers::{Answers, short};

/// Longest part of a bar beside its mark that the axis makes room for, as a factor.
const BAR_FACTOR: f64 = 30.0;
/// Steps of an axis whose values are names.
const LABELS: usize = 12;

/// A chart for each parameter, with its name.
pub fn charts(answers: &Answers) -> Vec<(String, LineChart)> {
    let axes = distinct(answers.effects.iter().map(|effect| effect.axis.as_str()));
    axes.into_iter().filter_map(|axis| Some((axis.to_owned(), chart(answers, axis)?))).collect()
}

fn chart(answers: &Answers, axis: &str) -> Option<LineChart> {
    let own: Vec<&Effect> = answers.effects.iter().filter(|effect| effect.axis == axis).collect();
    let base = &own.first()?.base;
    // Of the axis `method` the values are series, and the sample counts run along x.
    let is_method = axis == "method" && own.iter().all(|effect| effect.method.parse::<f64>().is_ok());
    let x_text = |effect: &Effect| if is_method { effect.method.clone() } else { effect.value.clone() };
    let name = |effect: &Effect| if is_method { effect.value.clone() } else { effect.method.clone() };
    let mut texts = distinct(own.iter().map(|effect| x_text(effect)));
    if !is_method {
        texts.insert(0, base.clone());
    }
    // Pairs of sides are names, but have an order.
    let sizes: Option<Vec<(f64, String)>> = texts.iter().map(|text| Some((size_of(text)?, text.clone()))).collect();
    if let Some(mut sizes) = sizes {
        sizes.sort_by(|a, b| a.0.total_cmp(&b.0));
        texts = sizes.into_iter().map(|(_, text)| text).collect();
    }
    let numbers: Option<Vec<f64>> = texts.iter().map(|text| text.parse().ok()).collect();
    let x = match &numbers {
        Some(numbers) if is_method || (numbers.iter().all(|x| *x > 0.0) && spans_decades(numbers)) => {
            Scale::of(Kind::Log, numbers.iter().copied())?.with_ticks(numbers, LABELS)
        }
        Some(numbers) => Scale::of(Kind::Linear, numbers.iter().copied())?.with_ticks(numbers, LABELS),
        None => {
            let mut scale = Scale::of(Kind::Linear, [-0.4, texts.len() as f64 - 0.6])?;
            scale.ticks =
                texts.iter().enumerate().map(|(i, text)| (i as f64, short(axis, text).into_owned())).collect();
            scale
        }
    };
    let place = |text: &String| match &numbers {
        Some(_) => text.parse().unwrap_or(f64::NAN),
        None => texts.iter().position(|known| known == text).map_or(f64::NAN, |i| i as f64),
    };
    let alphas = distinct(own.iter().map(|effect| effect.alpha.clone()));
    let names = distinct(own.iter().map(|effect| name(effect)));
    let panel = |alpha: &Option<String>| {
        let series = names.iter().enumerate().map(|(index, label)| {
            let own = own.iter().filter(|effect| effect.alpha == *alpha && name(effect) == *label);
            let mut points: Vec<Point> = own
                .map(|effect| Point {
                    x: place(&x_text(effect)),
                    y: Y::At(effect.ratio),
                    interval: effect.interval[1].is_finite().then_some(effect.interval),
                })
                .collect();
            if !is_method {
                points.push(Point { x: place(base), y: Y::At(1.0), interval: None });
            }
            points.sort_by(|a, b| a.x.total_cmp(&b.x));
            Series {
                label: label.clone(),
                color: name_color(index),
                marker: Some(Marker::of(index)),
                // Between names there is nothing to join.
                stroke: numbers.as_ref().map(|_| Stroke::Solid),
                points,
            }
        });
        Panel {
            title: alpha.as_ref().map_or_else(
                || if alphas.len() > 1 { "all" } else { "" }.to_owned(),
                |alpha| format!("α {}", short("alpha", alpha)),
            ),
            series: series.collect(),
            rules: vec![Rule { label: format!("as {axis} {base}"), color: MUTED, stroke: Stroke::Dashed, y: 1.0 }],
        }
    };
    let panels: Vec<Panel> = alphas.iter().map(panel).collect();
    // Intervals over all alphas are shown whole, up to a size that would press the rest together.
    let over_all = own.iter().filter(|effect| effect.alpha.is_none());
    let ends = over_all
        .flat_map(|effect| effect.interval.map(|end| end.clamp(effect.ratio / BAR_FACTOR, effect.ratio * BAR_FACTOR)));
    Some(LineChart {
        title: format!("What {axis} changes"),
        notes: vec![
            "Geometric mean of the relMSE over that of the cell that differs in nothing else; bars: Student's 95 % interval, with an arrow \
             where an end leaves the drawing. Below 1 is better; a bar across 1 decides nothing."
                .to_owned(),
            format!("{axis}: {}.{}", by_name(axis).about.trim_end_matches('.'), presets(axis, &texts)),
        ],
        x_label: if is_method { "samples a pixel".to_owned() } else { axis.to_owned() },
        y_label: format!("relMSE over that of {}", short(axis, base)),
        x,
        y: Scale::of(Kind::Log, own.iter().map(|effect| effect.ratio).chain(ends).chain([1.0]))?,
        bands: [None, None],
        is_aside: true,
        panels,
    })
}

/// Which of the values have names, as those of engines.
fn presets(axis: &str, values: &[String]) -> String {
    let name = |value: &String| by_name(axis).kind.name_of(value).map(|name| format!("{} {name}", short(axis, value)));
    let named: Vec<String> = values.iter().filter_map(name).collect();
    if named.is_empty() { String::new() } else { format!(" Of the tried values: {}.", named.join(", ")) }
}

fn spans_decades(numbers: &[f64]) -> bool {
    const FACTOR: f64 = 8.0;
    let (lo, hi) = numbers.iter().fold((f64::INFINITY, 0.0f64), |(lo, hi), x| (lo.min(*x), hi.max(*x)));
    hi / lo >= FACTOR
}

/// Median frame time and error of every method and sample count.
pub fn time_and_error(study: &Study) -> Option<LineChart> {
    let timed: Vec<_> =
        study.images().into_iter().filter(|row| row.frame_ms.is_some() && row.error.is_some()).collect();
    let methods = distinct(timed.iter().map(|row| study.value(row, "method")));
    let series: Vec<Series> = methods
        .iter()
        .enumerate()
        .map(|(index, method)| {
            let own = timed.iter().filter(|row| study.value(row, "method") == *method);
            let counts = distinct(own.clone().map(|row| study.value(row, "samples")));
            let point = |count: &&str| {
                let at = own.clone().filter(|row| study.value(row, "samples") == *count);
                let times: Vec<f64> = at.clone().filter_map(|row| Some(row.frame_ms?.median)).collect();
                let error = spread(&at.filter_map(|row| row.error).collect::<Vec<_>>())?;
                let interval = (error.n > 1).then_some([error.lower_quartile, error.upper_quartile]);
                Some(Point { x: spread(&times)?.median, y: Y::At(error.median), interval })
            };
            Series {
                label: method.to_string(),
                color: name_color(index),
                marker: Some(Marker::of(index)),
                stroke: Some(Stroke::Solid),
                points: counts.iter().filter_map(point).collect(),
            }
        })
        .collect();
    let points = || series.iter().flat_map(|series| &series.points);
    let x = Scale::of(Kind::Log, points().map(|point| point.x))?;
    let y =
        Scale::of(Kind::Log, points().flat_map(|p| p.y.known().into_iter().chain(p.interval.into_iter().flatten())))?;
    Some(LineChart {
        title: "Frame time against error".to_owned(),
        notes: vec![
            "One mark a sample count: medians over everything else that is swept; bars: the middle half of the errors. A CPU driver's times say \
             nothing about a GPU."
                .to_owned(),
            ERROR_NOTE.to_owned(),
        ],
        x_label: "frame time, ms".to_owned(),
        y_label: ERROR_LABEL.to_owned(),
        x,
        y,
        bands: [None, None],
        is_aside: false,
        panels: vec![Panel { title: String::new(), series, rules: Vec::new() }],
    })
}
