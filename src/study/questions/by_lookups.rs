//! The error of each method, over the error of the first split sum (the *base*), against the
//! lookups of an environment map per pixel ([`Method::lookups_of_pixel`]); lookups of small tables
//! do not count.

use super::numbers::middle_marks;
use super::prelude::*;
use crate::base::names::Listed;
use crate::instrument::shade::Method;

/// The surface axes that matter most.
pub const SURFACE: [AxisId; 3] = [ALPHA, BRDF, F0];

/// Lookups of an environment map per pixel; `None` for a shader in a file.
fn lookups(row: &Row) -> Option<f64> {
    Method::by_name(&row.text(METHOD))?
        .lookups_of_pixel(row.samples())
        .map(f64::from)
}

/// The images with their error over the base's in the same case, and the base: the first method
/// with a prefiltered map. `None` without a base.
pub fn ratios<'r, 'f>(
    frame: &Frame,
    images: &[&'r Row<'f>],
) -> Option<(Vec<(&'r Row<'f>, f64)>, Value)> {
    let axes = frame.case_axes();
    let is_base = |row: &&&Row| {
        Method::by_name(&row.text(METHOD)).is_some_and(|method| method.uses_prefiltered())
    };
    let base = images.iter().find(is_base)?.point[METHOD].clone();
    let bases = images.iter().filter(|row| row.point[METHOD] == base);
    let bases: Vec<(Key, &Row)> = bases.map(|row| (row.key(&axes), *row)).collect();
    let ratio = |row: &&'r Row<'f>| {
        let key = row.key(&axes);
        let (_, beside) = bases.iter().find(|(base, _)| fits(base, &key))?;
        let ratio = frame.error(row)? / frame.error(beside)?;
        (ratio.is_finite() && ratio > 0.0).then_some((*row, ratio))
    };
    Some((images.iter().filter_map(ratio).collect(), base))
}

/// One panel per value of [`Frame::row_axis`]; of other swept surfaces the first. A sampling method
/// is a line over its counts. Another method is a dot at its lookups, from which a dashed line
/// leads to the right: sampling wins where its line is below.
pub fn figure(frame: &Frame) -> Option<Figure> {
    let images = frame.images();
    let (all, base) = ratios(frame, &images)?;
    let (of, names) = (frame.row_axis(), &frame.names);
    let others: Vec<AxisId> = SURFACE
        .into_iter()
        .filter(|axis| *axis != of && frame.shape.is_swept(*axis))
        .collect();
    let lead = all.first()?.0.key(&others);
    let shown: Vec<(&Row, f64)> = all
        .iter()
        .copied()
        .filter(|(row, _)| row.key(&others) == lead)
        .collect();
    let ways = frame.swept(&[Part::Parameter, Part::Table]);
    // The word `sampled` alone also means a prefilter, so a figure leaves it as it is.
    let title = |row: &Row| {
        Method::by_name(&row.text(METHOD))
            .map_or_else(String::new, |method| method.title.to_owned())
    };
    let name = |row: &Row| commas([&title(row), &names.label(&ways, &row.key(&ways))]);
    let most = shown
        .iter()
        .filter_map(|(row, _)| lookups(row))
        .fold(0.0, f64::max);
    let mut series = distinct_in_order(
        shown
            .iter()
            .map(|(row, _)| (name(row), row.samples().is_none())),
    );
    series.sort_by_key(|(_, is_fixed)| !is_fixed);
    let marks = |(place, own): (usize, Vec<(&Row, f64)>)| -> Vec<Mark> {
        let dot = |(way, own): (String, Vec<(&Row, f64)>)| {
            let all = Numbers::new(own.iter().copied(), Middle::Median).estimate()?;
            let Some(x) = lookups(own[0].0) else {
                let rule = Mark::new(Form::HorizontalRule(all.value), place);
                return Some((rule.tip(format!("{way}: {}", with_interval(&all))), None));
            };
            let mark = middle_marks(&all, place, |y| [x, y], (&way, &with_interval)).swap_remove(0);
            Some((
                Mark {
                    cell: only(&own.iter().map(|(row, _)| *row).collect::<Vec<_>>()),
                    ..mark
                },
                Some([x, all.value]),
            ))
        };
        let (dots, at): (Vec<Mark>, Vec<_>) = grouped(own, |(row, _)| frame.way(row))
            .into_iter()
            .filter_map(dot)
            .unzip();
        match (series[place].1, at.first()) {
            (true, Some(Some([x, y]))) => {
                let line = Mark::new(Form::Line(vec![[*x, *y], [most, *y]]), place);
                std::iter::once(line).chain(dots).collect()
            }
            (true, _) => dots,
            (false, _) => joined(dots),
        }
    };
    let panel = |(value, own): (Value, Vec<(&Row, f64)>)| {
        let title = if frame.shape.is_swept(of) {
            names.heading(of, &value)
        } else {
            String::new()
        };
        let place = |row: &Row| {
            series
                .iter()
                .position(|(known, _)| *known == name(row))
                .unwrap_or(0)
        };
        (
            title,
            grouped(own, |(row, _)| place(row))
                .into_iter()
                .flat_map(marks)
                .collect(),
        )
    };
    let (metric, surface) = (frame.metric_name(), names.label(&others, &lead));
    let mut figure = Chart {
        title: "Error against map lookups per pixel",
        note: commas([
            metric,
            &format!("relative to {base}"),
            "median environment",
            &surface,
        ]) + "; dashed: without samples; sampling wins where its line is below",
        x: Along::Log("map lookups per pixel"),
        y: Along::Log(&format!("relative {metric}")),
        panels: grouped_ascending(shown, of, |(row, _)| row)
            .into_iter()
            .map(panel)
            .collect(),
        series: series.iter().map(|(name, _)| name.clone()).collect(),
    }
    .figure()?;
    figure
        .series
        .iter_mut()
        .zip(&series)
        .for_each(|(own, (_, is_fixed))| own.is_dashed = *is_fixed);
    Some(figure)
}
