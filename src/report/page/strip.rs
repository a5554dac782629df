//! The rungs of a ladder as pictures to flip through, each with the change of its step.

use super::images::{mask_of, read};
use super::lead::{is_radiance, shot, words, worst_picture};
use super::model::{PageAxis, Role};
use super::told::Told;
use crate::color::luminance;
use crate::experiment::axis::METHOD;
use crate::ladder::SPLIT_SUM;
use crate::ladder::attribution::covariance_share;
use crate::metrics::{Epsilon, signed_step};
use crate::pixels::{GrayImage, RgbImage};
use crate::shade::REFERENCE;
use crate::study::frame::{Frame, Row};
use crate::study::questions::words::percent;
use crate::table::colormap::SIGNED_ERROR;
use crate::tonemap::ToneCurve;
use glam::DVec3;
use serde_json::{Value as Json, json};

/// The picture whose last rung errs most, rung by rung from the reference; the largest step is shown first. `None` below two rungs.
pub fn strip(told: &Told, frame: &Frame, axes: &[PageAxis]) -> Option<Json> {
    let rungs: Vec<&str> = SPLIT_SUM.steps.iter().filter_map(|step| Some(step.rung?.name)).collect();
    let method = |row: &Row| row.text(METHOD);
    let last = worst_picture(frame, &|row| Some(&method(row).as_str()) == rungs.last())?;
    let files = last.cell.images.as_ref()?;
    // Rungs of one picture have one reference.
    let of_rung = |rung: &&str| {
        let is_own = |row: &&Row| row.cell.images.as_ref().is_some_and(|own| own.reference == files.reference);
        frame.rows.iter().find(|row| is_own(row) && method(row) == *rung)
    };
    let rows: Vec<&Row> = rungs.iter().filter_map(of_rung).collect();
    let image = |file: &str| read(&told.finished.dir, file).ok().filter(|image| is_radiance(&image.rgb));
    let reference = image(&files.reference)?;
    let (mask, curve) = (mask_of(&reference), last.cell.point.settings().curve);
    let stops = stops_to_grey(&reference.rgb, &mask, curve);
    let curve = ToneCurve { exposure: curve.exposure * stops.exp2(), ..curve };
    let epsilon = told.finished.epsilon(&last.cell.point);
    let mut frames = vec![json!({ "name": REFERENCE, "image": shot(REFERENCE, &curve.apply_image(&reference.rgb))? })];
    let radiance = |row: &&Row| Some(image(&row.cell.images.as_ref()?.radiance)?.rgb);
    let images: Vec<RgbImage> = rows.iter().map(radiance).collect::<Option<_>>()?;
    let is_alike = |own: &RgbImage| [own.width, own.height] == [reference.rgb.width, reference.rgb.height];
    let end = images.last().filter(|_| images.len() > 1 && images.iter().all(is_alike))?.clone();
    let (mut before, mut largest) = (reference.rgb.clone(), (0.0, 0));
    for (row, own) in rows.into_iter().zip(images) {
        let share = share_of_image([&own, &before, &end, &reference.rgb], &mask, epsilon);
        let step = signed_step([&own, &before, &reference.rgb], epsilon);
        let size: f32 = step.data.iter().map(|x| x * x).sum();
        if size > largest.0 {
            largest = (size, frames.len());
        }
        let step = SIGNED_ERROR.image(&step, &mask);
        let of_step = format!("this step causes {} of the picture's relmse", percent(share));
        let error = frame.error(row).map(|error| format!("{} {error:.2e}; {of_step}", frame.metric_name()));
        frames.push(json!({
            "name": method(row).trim_start_matches("ladder-"),
            "image": shot(&method(row), &curve.apply_image(&own))?,
            "step": shot("change of this step, over the reference", &step)?,
            "error": error,
        }));
        before = own;
    }
    let [lo, .., hi] = SIGNED_ERROR.ticks()[..] else { return None };
    frames[largest.1]["is_shown"] = true.into();
    let exposed = if stops == 0.0 { String::new() } else { format!(" · {stops:+} stops") };
    let case = words(last, axes, Role::Scene) + &exposed;
    Some(json!({ "case": case, "frames": frames, "ends": [lo.to_string(), hi.to_string()] }))
}

/// The covariance share of a step in the error of the last image.
fn share_of_image([own, before, end, reference]: [&RgbImage; 4], mask: &GrayImage, epsilon: Epsilon) -> f64 {
    let seen = mask.data.iter().enumerate().filter(|(_, mask)| **mask > 0.0);
    covariance_share(seen.map(|(i, _)| {
        let [own, before, end, r] =
            [own, before, end, reference].map(|image| DVec3::from_array(image.data[i].map(f64::from)));
        [epsilon.weight(r), own - before, end - r]
    }))
}

/// Whole stops that bring the mean to middle grey, if it is far off: dielectrics would be black.
fn stops_to_grey(image: &RgbImage, mask: &GrayImage, curve: ToneCurve) -> f32 {
    let seen = image.data.iter().zip(&mask.data).filter(|(_, mask)| **mask > 0.0).map(|(rgb, _)| luminance(*rgb));
    let (sum, count) = seen.fold((0.0, 0.0), |(sum, count), y| (sum + y, count + 1.0));
    let stops = (0.18 * count / (sum * f64::from(curve.exposure))).log2().round() as f32;
    if stops.is_finite() && stops.abs() >= 2.0 { stops } else { 0.0 }
}
