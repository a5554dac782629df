//! The first answer of a run, and pictures of one case: the reference, a method without samples
//! that errs visibly, the best other method, and their errors.

use super::images::{mask_of, read};
use super::model::{PageAxis, Role};
use super::page_run::PageRun;
use crate::base::names::Listed;
use crate::base::pixels::png::encode_rgb8;
use crate::base::pixels::{GrayImage, Rgb8Image, RgbImage};
use crate::draw::colormap::RELATIVE_ERROR;
use crate::draw::variant::Variant;
use crate::experiment::axis::{AXES, METHOD, SCENE, SIZE};
use crate::instrument::metrics::Comparison;
use crate::instrument::scene::is_design;
use crate::instrument::shade::{Method, REFERENCE, Role as MethodRole};
use crate::instrument::tonemap::ToneCurve;
use crate::study::frame::{Frame, Row};
use crate::study::questions::words::{number, with_rms};
use base64::Engine;
use base64::prelude::BASE64_STANDARD;
use serde::Serialize;

/// Longest side of a picture, pixels.
const SIDE: u32 = 512;
/// Sampling is shown with the sample count nearest to this one.
const SAMPLES: f64 = 16.0;

/// The index of the first answer that does not depend on times of a CPU driver.
pub fn first_answer(page_run: &PageRun) -> Option<usize> {
    page_run
        .answers
        .iter()
        .position(|answer| !answer.question.rests_on_cpu_times(page_run.finished))
}

/// The pictures of a case, for the template.
#[derive(Debug, Serialize)]
pub struct Pictures {
    /// The case in words: "sky · alpha 0.5 (roughness 0.71)".
    case: String,
    /// Id of the cell of the first method.
    pub cell: String,
    reference: Picture,
    /// Samples a pixel of the reference.
    samples: Option<u64>,
    shots: Vec<Shot>,
}

#[derive(Debug, Serialize)]
struct Picture {
    label: String,
    /// A data URL.
    source: String,
    /// Pixels.
    size: [u32; 2],
}

/// A method's picture with its error.
#[derive(Debug, Serialize)]
struct Shot {
    #[serde(flatten)]
    picture: Picture,
    /// Name of the method, with its sample count.
    code: String,
    role: Option<MethodRole>,
    /// "relmse 0.012 (11 % rms) · flip 0.05".
    scores: String,
    /// Data URL of the error map, of the picture's size.
    map: String,
}

/// Pictures of the case in which a method without samples errs most visibly; `None` without its
/// images.
pub fn pictures(page_run: &PageRun, frame: &Frame, axes: &[PageAxis]) -> Option<Pictures> {
    let is_without_samples = |row: &Row| row.samples().is_none() && !row.has_no_method();
    let row = worst_picture(frame, |row| role(row) == Some(MethodRole::Textbook))
        .or_else(|| worst_picture(frame, is_without_samples))
        .or_else(|| worst_picture(frame, |row| role(row).is_some()))?;
    let other = best_other(frame, row);
    let case = Case::read(page_run, frame, row)?;
    let shots: Vec<Shot> = std::iter::once(row)
        .chain(other)
        .filter_map(|row| case.shot(row))
        .collect();
    if shots.is_empty() {
        return None;
    }
    let reference = case.curve.apply_image(&case.reference);
    Some(Pictures {
        case: case_in_words(row, axes),
        cell: row.cell.id.to_string(),
        reference: Picture::new(Method::listed(REFERENCE).title.to_owned(), &reference)?,
        samples: row.cell.reference.as_ref().map(|stop| stop.samples),
        shots,
    })
}

fn role(row: &Row) -> Option<MethodRole> {
    Method::by_name(&row.text(METHOD)).and_then(Method::role)
}

/// The corrected method with the least error in the case of `row`, else sampling; `None` if that is
/// `row` itself.
fn best_other<'r, 'f>(frame: &'r Frame<'f>, row: &Row) -> Option<&'r Row<'f>> {
    let scored = |wanted: MethodRole| {
        frame
            .rows
            .iter()
            .filter(move |other| is_same_case(other, row) && role(other) == Some(wanted))
            .filter_map(|other| Some((other, frame.error(other)?)))
    };
    let corrected = scored(MethodRole::Corrected).min_by(|(_, a), (_, b)| a.total_cmp(b));
    let sampled = || {
        scored(MethodRole::Sampling)
            .min_by(|(a, _), (b, _)| samples_apart(a).total_cmp(&samples_apart(b)))
    };
    let (other, _) = corrected.or_else(sampled)?;
    (other.cell.id != row.cell.id).then_some(other)
}

/// Whether two rows have one reference image and one tone curve.
fn is_same_case(a: &Row, b: &Row) -> bool {
    let (Some(a_images), Some(b_images)) = (&a.cell.images, &b.cell.images) else {
        return false;
    };
    a_images.reference.is_some()
        && a_images.reference == b_images.reference
        && a.cell.point.settings().curve == b.cell.point.settings().curve
}

/// How far a row's sample count is from [`SAMPLES`]: the magnitude of the logarithm of their ratio.
fn samples_apart(row: &Row) -> f64 {
    row.samples()
        .map_or(f64::INFINITY, |n| (f64::from(n) / SAMPLES).ln().abs())
}

/// The reference of a case, and how its pictures are made.
struct Case<'a> {
    page_run: &'a PageRun<'a>,
    frame: &'a Frame<'a>,
    reference: RgbImage,
    mask: GrayImage,
    curve: ToneCurve,
}

impl<'a> Case<'a> {
    /// `None` if the reference of the row cannot be shown.
    fn read(page_run: &'a PageRun, frame: &'a Frame, row: &Row) -> Option<Self> {
        let files = row.cell.images.as_ref()?;
        let image = read(&page_run.finished.dir, files.reference.as_ref()?).ok()?;
        let mask = mask_of(&image);
        is_radiance(&image.rgb).then(|| Self {
            page_run,
            frame,
            reference: image.rgb,
            mask,
            curve: row.cell.point.settings().curve,
        })
    }

    /// `None` if the image of the row cannot be shown.
    fn shot(&self, row: &Row) -> Option<Shot> {
        let files = row.cell.images.as_ref()?;
        let image = read(&self.page_run.finished.dir, &files.radiance).ok()?.rgb;
        if !is_radiance(&image) {
            return None;
        }
        let epsilon = self.page_run.finished.epsilon(&row.cell.point);
        let comparison =
            Comparison::new(&image, &self.reference, &self.mask, self.curve, epsilon).ok()?;
        let method = Method::by_name(&row.text(METHOD))?;
        let variant = Variant {
            method: method.name.to_owned(),
            samples: row.samples(),
        };
        let map = RELATIVE_ERROR.image(&comparison.relative_error_map(), &self.mask);
        let title = variant.title();
        Some(Shot {
            picture: Picture::new(title, &self.curve.apply_image(&image))?,
            code: variant.to_string(),
            role: method.role(),
            scores: self.scores(row),
            map: Picture::new(String::new(), &map)?.source,
        })
    }

    /// The score by the metric of the answers, and by FLIP.
    fn scores(&self, row: &Row) -> String {
        let metric = self.frame.metric_name();
        let mut scores = Vec::new();
        if let Some(error) = self.frame.error(row) {
            scores.push(format!("{metric} {}", with_rms(self.frame, error)));
        }
        if let Some(flip) = row.flip().filter(|_| metric != "flip") {
            scores.push(format!("flip {}", number(flip)));
        }
        scores.join(" · ")
    }
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
    is_wanted: impl Fn(&Row) -> bool,
) -> Option<&'r Row<'f>> {
    struct Scored<'r, 'f> {
        row: &'r Row<'f>,
        has_plain_curve: bool,
        error: f64,
    }
    let is_picture = |row: &Row| row.cell.images.is_some() && !is_design(&row.text(SCENE));
    let scored = frame
        .rows
        .iter()
        .filter(|row| is_picture(row) && is_wanted(row))
        .filter_map(|row| {
            Some(Scored {
                row,
                has_plain_curve: row.has_plain_curve(),
                error: row.flip().or(frame.error(row))?,
            })
        });
    let worst = scored.max_by(|a, b| {
        let by_curve = a.has_plain_curve.cmp(&b.has_plain_curve);
        by_curve.then(a.error.total_cmp(&b.error))
    });
    worst.map(|scored| scored.row)
}

/// Describes the case of a picture: "sky · alpha 0.5 (roughness 0.71)".
fn case_in_words(row: &Row, axes: &[PageAxis]) -> String {
    let mut words = Vec::new();
    for axis in axes {
        let is_named = axis.role == Role::Scene && axis.name != AXES[SIZE].name;
        let index = axis.text(row.cell).and_then(|text| axis.index_of(&text));
        if let Some(index) = index.filter(|_| is_named) {
            words.push(axis.words[index].as_str());
        }
    }
    words.join(" · ")
}

impl Picture {
    /// A picture of at most [`SIDE`] pixels; `None` if it cannot be encoded.
    fn new(label: String, image: &Rgb8Image) -> Option<Self> {
        let factor = f64::from(image.width.max(image.height)) / f64::from(SIDE);
        let side = |length: u32| ((f64::from(length) / factor).round() as u32).max(1);
        let small = if factor > 1.0 {
            image.shrunk(side(image.width), side(image.height))
        } else {
            image.clone()
        };
        let base64 = BASE64_STANDARD.encode(encode_rgb8(&small).ok()?);
        Some(Self {
            label,
            source: format!("data:image/png;base64,{base64}"),
            size: [small.width, small.height],
        })
    }
}
