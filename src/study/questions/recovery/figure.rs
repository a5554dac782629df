//! The figure of the question: recovered against true roughness.

use super::super::prelude::*;
use super::{Recovered, candidate_name, leading};

/// One panel per loss, one line per candidate, of the first surface seen whole; on the diagonal the
/// recovered roughness is the true one.
pub fn figure(frame: &Frame, all: &[Recovered]) -> Option<Figure> {
    let names = distinct_in_order(all.iter().map(|one| candidate_name(frame, one.candidate)));
    let mut panels = Vec::new();
    for loss in distinct_in_order(all.iter().map(|one| one.loss)) {
        let lead = leading(frame, all, loss);
        let truths = lead.iter().map(|one| one.true_roughness());
        let [least, most] = [
            truths.clone().fold(f64::NAN, f64::min),
            truths.fold(f64::NAN, f64::max),
        ];
        let diagonal = Form::Line(vec![[least, least], [most, most]]);
        let mut marks = vec![Mark::neutral(diagonal)];
        for (name, fits) in grouped(lead, |one| candidate_name(frame, one.candidate)) {
            let series = step(&names, &name) as usize;
            marks.extend(fits.iter().filter_map(|one| whisker(one, series)));
            marks.extend(joined(
                fits.iter().map(|one| mark(&name, one, series)).collect(),
            ));
        }
        panels.push(ChartPanel {
            title: format!("loss {loss}"),
            marks,
        });
    }
    Chart {
        title: "Recovered against true roughness",
        note: format!("median environment{INTERVAL}; diagonal: the truth"),
        x: ChartAxis::Linear("true perceptual roughness"),
        y: ChartAxis::Linear("recovered"),
        panels,
        series: names
            .iter()
            .map(|name| {
                let first = all
                    .iter()
                    .find(|one| candidate_name(frame, one.candidate) == *name);
                let method = first.map_or_else(String::new, |one| one.candidate.text(METHOD));
                method_series(name.clone(), &method, false)
            })
            .collect(),
    }
    .figure()
}

fn mark(name: &str, one: &Recovered, series: usize) -> Mark {
    let tip = format!(
        "{name} · true {}: {}, {} times the F0",
        number(one.true_roughness()),
        with_interval(&one.roughness),
        with_interval(&one.f0_ratio)
    );
    let at = [one.true_roughness(), one.roughness.value];
    Mark::new(Form::Dot(at), series).tip(tip)
}

fn whisker(one: &Recovered, series: usize) -> Option<Mark> {
    let ends = one.roughness.interval?;
    let [lo, hi] = ends.map(|end| [one.true_roughness(), end]);
    Some(Mark::new(Form::Whisker(lo, hi), series))
}
