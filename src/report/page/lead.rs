//! The leading answer of a run, and pictures of its leading case: the method, the reference and the error.

use super::images::{mask_of, read};
use super::model::{PageAxis, Role};
use super::told::Told;
use crate::experiment::axis::SCENE;
use crate::metrics::Comparison;
use crate::pixels::png::encode_rgb8;
use crate::pixels::{Rgb8Image, RgbImage};
use crate::scene::is_design;
use crate::study::frame::{Frame, Row};
use crate::study::questions::words::with_rms;
use crate::table::colormap::RELATIVE_ERROR;
use base64::Engine;
use base64::prelude::BASE64_STANDARD;
use serde_json::{Value as Json, json};

/// Longest side of a picture, pixels.
const SIDE: u32 = 256;

/// The index of the first answer that does not depend on times of a CPU driver.
pub fn leading(told: &Told) -> Option<usize> {
    told.answers.iter().position(|answer| !answer.question.rests_on_cpu_times(told.finished))
}

/// Pictures of the leading case; `None` without its images.
pub fn pictures(told: &Told, frame: &Frame, lead: Option<usize>, axes: &[PageAxis]) -> Option<Json> {
    let row = case(told, frame, lead)?;
    let files = row.cell.images.as_ref()?;
    let [own, reference] = [&files.radiance, &files.reference].map(|file| read(&told.finished.dir, file).ok());
    let (own, reference) = (own?, reference?);
    let mask = mask_of(&reference);
    let curve = row.cell.point.settings().curve;
    if !is_radiance(&own.rgb) || !is_radiance(&reference.rgb) {
        return None;
    }
    let comparison =
        Comparison::new(&own.rgb, &reference.rgb, &mask, curve, told.finished.epsilon(&row.cell.point)).ok()?;
    let map = RELATIVE_ERROR.image(&comparison.relative_error_map(), &mask);
    let [lo, .., hi] = RELATIVE_ERROR.ticks()[..] else { return None };
    let method = words(row, axes, Role::Variant);
    let method = if method.is_empty() { row.point.get("method").to_string() } else { method };
    let error = frame.error(row).map(|error| format!("{} {}", frame.metric_name(), with_rms(frame, error)));
    let shots = [
        shot(&method, &curve.apply_image(&own.rgb))?,
        shot("reference", &curve.apply_image(&reference.rgb))?,
        shot(&format!("relative error, {lo} (black) to {hi} (pale)"), &map)?,
    ];
    let case = words(row, axes, Role::Scene);
    Some(json!({ "case": case, "error": error.unwrap_or_default(), "cell": row.cell.id, "shots": shots }))
}

/// Whether all values are finite and not negative; a damaged file may contain anything.
pub fn is_radiance(image: &RgbImage) -> bool {
    image.data.iter().flatten().all(|x| x.is_finite() && *x >= 0.0)
}

/// The wanted picture with the largest error. Designs are not pictures.
pub fn worst_picture<'r, 'f>(frame: &'r Frame<'f>, wanted: &dyn Fn(&Row) -> bool) -> Option<&'r Row<'f>> {
    let is_picture = |row: &Row| row.cell.images.is_some() && !is_design(&row.text(SCENE));
    let own = frame.rows.iter().filter(|row| is_picture(row) && wanted(row));
    let scored = own.filter_map(|row| Some((row, frame.error(row)?)));
    scored.max_by(|a, b| a.1.total_cmp(&b.1)).map(|(row, _)| row)
}

/// The cell with the largest error: of the leading figure without samples, else of all without samples, else of all.
fn case<'r, 'f>(told: &Told, frame: &'r Frame<'f>, lead: Option<usize>) -> Option<&'r Row<'f>> {
    let figure = lead.and_then(|lead| told.answers[lead].finding.figure.as_ref());
    let marks = figure.into_iter().flat_map(|figure| &figure.panels).flat_map(|panel| &panel.marks);
    let shown: Vec<&str> = marks.filter_map(|mark| mark.cell.as_deref()).collect();
    let is_shown =
        |row: &Row| shown.contains(&row.cell.id.as_str()) || row.copies.iter().any(|copy| shown.contains(copy));
    let draws_none = |row: &Row| row.samples().is_none() && !row.has_no_method();
    let worst = |wanted: &dyn Fn(&Row) -> bool| worst_picture(frame, wanted);
    worst(&|row| is_shown(row) && draws_none(row)).or_else(|| worst(&draws_none)).or_else(|| worst(&|_| true))
}

pub fn words(row: &Row, axes: &[PageAxis], role: Role) -> String {
    let word = |axis: &PageAxis| {
        let text = axis.text(row.cell)?;
        let place = axis.values.iter().position(|value| *value == text)?;
        Some(axis.words[place].clone())
    };
    axes.iter().filter(|axis| axis.role == role).filter_map(word).collect::<Vec<_>>().join(" · ")
}

/// A picture as a data URL.
pub fn shot(label: &str, image: &Rgb8Image) -> Option<Json> {
    let factor = f64::from(image.width.max(image.height)) / f64::from(SIDE);
    let side = |length: u32| ((f64::from(length) / factor).round() as u32).max(1);
    let small = if factor > 1.0 { image.shrunk(side(image.width), side(image.height)) } else { image.clone() };
    let source = format!("data:image/png;base64,{}", BASE64_STANDARD.encode(encode_rgb8(&small).ok()?));
    Some(json!({ "label": label, "source": source, "size": [small.width, small.height] }))
}
