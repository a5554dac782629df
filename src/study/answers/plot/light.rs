//! Pictures of what the light does: error over its dynamic range, and what is left of it in a white furnace.

use super::canvas::{MUTED, Marker, Stroke, name_color};
use super::figures::{ERROR_LABEL, ERROR_NOTE, PANELS_MAX, SERIES_WITH_BARS_MAX, TRIED_LABELS, cut_off_note, distinct};
use super::lines::{LineChart, Panel, Point, Rule, Series, Y};
use super::scale::{Kind, Scale};
use crate::study::answers::dynamic_range::RangePoint;
use crate::study::answers::furnace::Furnace;
use crate::study::answers::{Answers, key_label, short};
use crate::table::markdown::significant;

/// A line through fewer lights than this would show a trend that nobody measured.
const TREND_MIN: usize = 3;

/// Error over the dynamic range of the light: along x where one light is cut off at several peaks, else light by light.
pub fn dynamic_range(answers: &Answers) -> Option<LineChart> {
    let points = &answers.dynamic_range;
    let is_clipped = points.iter().any(|point| !point.clip_log2.is_empty());
    let names = distinct(points.iter().map(|point| point.series.clone()));
    let methods = distinct(points.iter().map(|point| point.method.as_str()));
    // Ascending by range.
    let lights = distinct(points.iter().map(|point| (point.environment.as_str(), point.range)));
    let x_of = |point: &RangePoint| match is_clipped {
        true => point.range,
        false => {
            lights.iter().position(|light| *light == (&point.environment, point.range)).map_or(f64::NAN, |i| i as f64)
        }
    };
    let has_bars = methods.len() <= SERIES_WITH_BARS_MAX;
    let panel = |name: &String| Panel {
        title: if names.len() > 1 { name.clone() } else { String::new() },
        series: methods
            .iter()
            .enumerate()
            .map(|(index, method)| {
                let own = points.iter().filter(|point| point.series == *name && point.method == **method);
                let points: Vec<Point> = own
                    .map(|point| Point {
                        x: x_of(point),
                        y: Y::At(point.median),
                        interval: (has_bars && point.n > 1).then_some([point.lower_quartile, point.upper_quartile]),
                    })
                    .collect();
                Series {
                    label: method.to_string(),
                    color: name_color(index),
                    marker: Some(Marker::of(index)),
                    // A line joins one light cut off at several peaks, never different lights.
                    stroke: (is_clipped && points.len() >= TREND_MIN).then_some(Stroke::Solid),
                    points,
                }
            })
            .collect(),
        rules: Vec::new(),
    };
    let panels: Vec<Panel> = names.iter().take(PANELS_MAX).map(panel).collect();
    let x = match is_clipped {
        true => Scale::of(Kind::Linear, points.iter().map(|point| point.range))?,
        false => {
            let mut scale = Scale::of(Kind::Linear, [-0.4, lights.len() as f64 - 0.6])?;
            let text = |(name, range): &(&str, f64)| {
                format!("{}\n{} stops", short("environment", name), significant(*range, 3))
            };
            scale.ticks = lights.iter().enumerate().map(|(i, light)| (i as f64, text(light))).collect();
            scale
        }
    };
    let ends = points.iter().flat_map(|point| [point.lower_quartile, point.median, point.upper_quartile]);
    let mut notes = vec![format!(
        "Median over everything else that is swept{}.",
        if has_bars { "; bars: the middle half" } else { "" }
    )];
    if !is_clipped {
        notes.push("Each environment stands by itself: they differ in more than their range.".to_owned());
    }
    notes.push(ERROR_NOTE.to_owned());
    notes.extend(cut_off_note(&names));
    Some(LineChart {
        title: "Error over the dynamic range of the environment".to_owned(),
        notes,
        x_label: match is_clipped {
            true => "dynamic range, stops (log2 of peak over mean luminance)",
            false => "environment, by dynamic range (log2 of peak over mean luminance)",
        }
        .to_owned(),
        y_label: ERROR_LABEL.to_owned(),
        x,
        y: Scale::of(Kind::Log, ends)?,
        bands: [None, None],
        is_aside: !is_clipped,
        panels,
    })
}

/// What leaves over what arrives in a white furnace, over alpha.
pub fn energy(answers: &Answers) -> Option<LineChart> {
    let all = &answers.furnace;
    let axis = |name: &str| answers.case_axes.iter().position(|known| known == name);
    let alpha = axis("alpha")?;
    let model = axis("brdf");
    // Panels by model, series by the rest.
    let of_panel = |one: &Furnace| model.map_or_else(String::new, |axis| one.key[axis].clone());
    let of_series = |one: &Furnace| {
        let kept = |of: &[String]| -> Vec<String> {
            let is_kept = |(i, _): &(usize, &String)| *i != alpha && Some(*i) != model;
            of.iter().enumerate().filter(is_kept).map(|(_, text)| text.clone()).collect()
        };
        match key_label(&kept(&answers.case_axes), &kept(&one.key)).as_str() {
            "all" => one.method.clone(),
            label => label.to_owned(),
        }
    };
    let panels = distinct(all.iter().map(of_panel));
    let series = distinct(all.iter().map(of_series));
    let point = |one: &Furnace| {
        Some(Point {
            x: one.key[alpha].parse().ok()?,
            y: Y::At(1.0 + one.change),
            interval: one.extremes.map(|ends| ends.map(|(change, _)| 1.0 + change)),
        })
    };
    let panel = |name: &String| Panel {
        title: if panels.len() > 1 { name.clone() } else { String::new() },
        series: series
            .iter()
            .enumerate()
            .map(|(index, label)| Series {
                label: label.clone(),
                color: name_color(index),
                marker: Some(Marker::of(index)),
                stroke: Some([Stroke::Solid, Stroke::Dashed, Stroke::Dotted][index % 3]),
                points: all
                    .iter()
                    .filter(|one| of_panel(one) == *name && of_series(one) == *label)
                    .filter_map(point)
                    .collect(),
            })
            .filter(|series| !series.points.is_empty())
            .collect(),
        rules: vec![Rule { label: "all that arrives".to_owned(), color: MUTED, stroke: Stroke::Dashed, y: 1.0 }],
    };
    let drawn: Vec<Panel> = panels.iter().take(PANELS_MAX).map(panel).collect();
    let points = || drawn.iter().flat_map(|panel| &panel.series).flat_map(|series| &series.points);
    let ys = points().flat_map(|p| p.y.known().into_iter().chain(p.interval.into_iter().flatten()));
    let alphas: Vec<f64> = points().map(|point| point.x).collect();
    let (x, y) = (Scale::of(Kind::Linear, alphas.iter().copied())?, Scale::of(Kind::Linear, ys.chain([1.0]))?);
    Some(LineChart {
        title: "What is left of the light in a white furnace".to_owned(),
        notes: vec![
            "Energy that leaves over energy that arrives, over the whole sphere; bars: from the bin of n·v with the least to that with the most. \
             Above 1 energy is created."
                .to_owned(),
        ],
        x_label: "α (microfacet width)".to_owned(),
        y_label: "directional albedo".to_owned(),
        x: x.with_ticks(&alphas, TRIED_LABELS),
        y,
        bands: [None, None],
        is_aside: true,
        panels: drawn,
    })
}
