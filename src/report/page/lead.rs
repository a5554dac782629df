//! The leading answer of a run, and pictures of its leading case: reference, textbook, the best
//! other method, errors.

use super::images::{mask_of, read};
use super::model::{PageAxis, Role};
use super::page_run::PageRun;
use crate::base::names::Listed;
use crate::base::pixels::png::encode_rgb8;
use crate::base::pixels::{Rgb8Image, RgbImage};
use crate::draw::colormap::RELATIVE_ERROR;
use crate::experiment::axis::{AXES, METHOD, SCENE, SIZE};
use crate::instrument::metrics::Comparison;
use crate::instrument::scene::is_design;
use crate::instrument::shade::{Method, REFERENCE, Role as MethodRole};
use crate::study::frame::{Frame, Row};
use crate::study::questions::words::{number, with_rms};
use base64::Engine;
use base64::prelude::BASE64_STANDARD;
use serde_json::{Value as Json, json};

/// Longest side of a picture, pixels.
const SIDE: u32 = 512;
/// Sampling is shown with the sample count nearest to this one.
const SAMPLES: f64 = 16.0;

/// The index of the first answer that does not depend on times of a CPU driver.
pub fn leading(page_run: &PageRun) -> Option<usize> {
    page_run
        .answers
        .iter()
        .position(|answer| !answer.question.rests_on_cpu_times(page_run.finished))
}

/// Pictures of the case in which a method without samples errs most visibly; `None` without its
/// images.
pub fn pictures(page_run: &PageRun, frame: &Frame, axes: &[PageAxis]) -> Option<Json> {
    let role = |row: &Row| Method::by_name(&row.text(METHOD)).and_then(Method::role);
    let is_fixed = |row: &Row| row.samples().is_none() && !row.has_no_method();
    let worst = |wanted: &dyn Fn(&Row) -> bool| worst_picture(frame, wanted);
    let row = worst(&|row| role(row) == Some(MethodRole::Textbook))
        .or_else(|| worst(&is_fixed))
        .or_else(|| worst(&|row| role(row).is_some()))?;
    let files = row.cell.images.as_ref()?;
    let beside = |own: &&Row| {
        let is_alike = own
            .cell
            .images
            .as_ref()
            .is_some_and(|own| own.reference == files.reference);
        is_alike && own.cell.point.settings().curve == row.cell.point.settings().curve
    };
    let others = || {
        frame
            .rows
            .iter()
            .filter(beside)
            .filter_map(|own| Some((own, role(own)?, frame.error(own)?)))
    };
    let corrected = others()
        .filter(|(_, role, _)| *role == MethodRole::Corrected)
        .min_by(|a, b| a.2.total_cmp(&b.2));
    let distance = |row: &Row| {
        row.samples()
            .map_or(f64::INFINITY, |n| (f64::from(n) / SAMPLES).ln().abs())
    };
    let sampled = others().filter(|(_, role, _)| *role == MethodRole::Sampling);
    let sampled = sampled.min_by(|a, b| distance(a.0).total_cmp(&distance(b.0)));
    let other = corrected
        .or(sampled)
        .map(|(own, ..)| own)
        .filter(|own| own.cell.id != row.cell.id);

    let reference = read(&page_run.finished.dir, &files.reference)
        .ok()
        .filter(|image| is_radiance(&image.rgb))?;
    let (mask, curve) = (mask_of(&reference), row.cell.point.settings().curve);
    let of_method = |own: &Row| {
        let image = read(&page_run.finished.dir, &own.cell.images.as_ref()?.radiance)
            .ok()
            .filter(|i| is_radiance(&i.rgb))?;
        let epsilon = page_run.finished.epsilon(&own.cell.point);
        let comparison = Comparison::new(&image.rgb, &reference.rgb, &mask, curve, epsilon).ok()?;
        let method = Method::by_name(&own.text(METHOD))?;
        let samples = own.samples().map(|count| count.to_string());
        let flip = own.flip().filter(|_| frame.metric_name() != "flip");
        let scores = [
            frame
                .error(own)
                .map(|error| format!("{} {}", frame.metric_name(), with_rms(frame, error))),
            flip.map(|flip| format!("flip {}", number(flip))),
        ];
        let mut shot = shot(
            &method.words(samples.as_deref()),
            &curve.apply_image(&image.rgb),
        )?;
        shot["code"] = format!("{} {}", method.name, samples.unwrap_or_default())
            .trim_end()
            .into();
        shot["role"] = json!(method.role());
        shot["scores"] = scores
            .into_iter()
            .flatten()
            .collect::<Vec<_>>()
            .join(" · ")
            .into();
        shot["map"] = self::shot(
            "",
            &RELATIVE_ERROR.image(&comparison.relative_error_map(), &mask),
        )?["source"]
            .take();
        Some(shot)
    };
    let shots: Vec<Json> = [Some(row), other]
        .into_iter()
        .flatten()
        .filter_map(of_method)
        .collect();
    let samples = row
        .cell
        .reference
        .as_ref()
        .map(|reference| reference.samples);
    Some(json!({
        "case": words(row, axes),
        "cell": row.cell.id,
        "reference": shot(Method::listed(REFERENCE).title, &curve.apply_image(&reference.rgb))?,
        "samples": samples,
        "shots": (!shots.is_empty()).then_some(shots)?,
    }))
}

/// Whether all values are finite and not negative; a damaged file may contain anything.
fn is_radiance(image: &RgbImage) -> bool {
    image
        .data
        .iter()
        .flatten()
        .all(|x| x.is_finite() && *x >= 0.0)
}

/// The wanted picture with the most visible error, with the default tone curve if possible. Designs
/// are not pictures.
fn worst_picture<'r, 'f>(
    frame: &'r Frame<'f>,
    wanted: &dyn Fn(&Row) -> bool,
) -> Option<&'r Row<'f>> {
    let is_picture = |row: &Row| row.cell.images.is_some() && !is_design(&row.text(SCENE));
    let own = frame
        .rows
        .iter()
        .filter(|row| is_picture(row) && wanted(row));
    let scored = own.filter_map(|row| {
        Some((
            row,
            (row.has_plain_curve(), row.flip().or(frame.error(row))?),
        ))
    });
    let order = |a: &(bool, f64), b: &(bool, f64)| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1));
    scored.max_by(|a, b| order(&a.1, &b.1)).map(|(row, _)| row)
}

/// Describes a picture: "sky · alpha 0.5 (roughness 0.71)".
fn words(row: &Row, axes: &[PageAxis]) -> String {
    let word = |axis: &PageAxis| {
        let text = axis.text(row.cell)?;
        let place = axis.values.iter().position(|value| *value == text)?;
        Some(axis.words[place].clone())
    };
    let named = axes
        .iter()
        .filter(|axis| axis.role == Role::Scene && axis.name != AXES[SIZE].name);
    named.filter_map(word).collect::<Vec<_>>().join(" · ")
}

fn shot(label: &str, image: &Rgb8Image) -> Option<Json> {
    let factor = f64::from(image.width.max(image.height)) / f64::from(SIDE);
    let side = |length: u32| ((f64::from(length) / factor).round() as u32).max(1);
    let small = if factor > 1.0 {
        image.shrunk(side(image.width), side(image.height))
    } else {
        image.clone()
    };
    let source = format!(
        "data:image/png;base64,{}",
        BASE64_STANDARD.encode(encode_rgb8(&small).ok()?)
    );
    Some(json!({ "label": label, "source": source, "size": [small.width, small.height] }))
}
