//! How fast errors fall.

use super::canvas::{MUTED, Marker, Stroke, name_color};
use super::figures::{PANELS_MAX, TRIED_LABELS, alpha_of, cut_off_note, distinct, facet};
use super::lines::{LineChart, Panel, Point, Rule, Series, Y};
use super::scale::{Kind, Scale};
use crate::study::answers::Answers;

/// The slope of plain Monte Carlo in squared error.
const MONTE_CARLO: f64 = -1.0;

/// Convergence slopes with their intervals over alpha, one panel a setting of the rest; `None` where alpha is not swept.
pub fn slopes(answers: &Answers) -> Option<LineChart> {
    let alpha = |key: &[String]| alpha_of(answers, key).parse::<f64>().ok();
    let fitted = || answers.curves.iter().filter_map(|curve| Some((curve, curve.slope?, alpha(&curve.key)?)));
    let alphas: Vec<f64> = fitted().map(|(_, _, alpha)| alpha).collect();
    if distinct(alphas.iter().map(|alpha| alpha.to_bits())).len() < 2 {
        return None;
    }
    let facets = distinct(fitted().map(|(curve, ..)| facet(answers, &curve.key)));
    let methods = distinct(fitted().map(|(curve, ..)| curve.method.as_str()));
    let panel = |name: &String| {
        let series = methods.iter().enumerate().map(|(index, method)| {
            let own = fitted().filter(|(curve, ..)| curve.method == *method && facet(answers, &curve.key) == *name);
            let mut points: Vec<Point> = own
                .map(|(_, slope, alpha)| Point {
                    x: alpha,
                    y: Y::At(slope.value),
                    interval: Some([slope.lo, slope.hi]),
                })
                .collect();
            points.sort_by(|a, b| a.x.total_cmp(&b.x));
            Series {
                label: method.to_string(),
                color: name_color(index),
                marker: Some(Marker::of(index)),
                stroke: Some([Stroke::Solid, Stroke::Dashed, Stroke::Dotted][index % 3]),
                points,
            }
        });
        Panel {
            title: if facets.len() > 1 { name.clone() } else { String::new() },
            series: series.filter(|series| !series.points.is_empty()).collect(),
            rules: vec![Rule {
                label: "plain Monte Carlo".to_owned(),
                color: MUTED,
                stroke: Stroke::Dashed,
                y: MONTE_CARLO,
            }],
        }
    };
    let panels: Vec<Panel> = facets.iter().take(PANELS_MAX).map(panel).collect();
    // One wild interval would press the rest together: the axis holds the slopes, and as far again on both sides.
    let values: Vec<f64> = fitted().map(|(_, slope, _)| slope.value).chain([MONTE_CARLO, 0.0]).collect();
    let (lo, hi) = values.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(lo, hi), x| (lo.min(*x), hi.max(*x)));
    let reach = 0.5 * (hi - lo);
    let ends = fitted().flat_map(|(_, slope, _)| [slope.lo, slope.hi].map(|end| end.clamp(lo - reach, hi + reach)));
    let mut notes = vec![
        "Slope of ln(relMSE) over ln(samples), fitted to the points above the reference's noise; bars: Student's 95 % interval, with an \
         arrow where an end leaves the drawing. A filtered method flattens at its bias."
            .to_owned(),
    ];
    notes.extend(cut_off_note(&facets));
    Some(LineChart {
        title: "How fast the error falls".to_owned(),
        notes,
        x_label: "α (microfacet width)".to_owned(),
        y_label: "convergence slope".to_owned(),
        x: Scale::of(Kind::Log, alphas.iter().copied())?.with_ticks(&alphas, TRIED_LABELS),
        y: Scale::of(Kind::Linear, values.iter().copied().chain(ends))?,
        bands: [None, None],
        is_aside: true,
        panels,
    })
}
