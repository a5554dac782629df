//! `recovery.csv`: the material that each method recovers from photos, by `[recovery]` of the
//! experiment.
//!
//! Photos are the images of the method `reference`, pooled over `environment_orientation`. Each other
//! method is a candidate, with its images over a grid of widths and at two values of F0 or more, of
//! which the least and the largest count. Images are read back from `images/`.

mod cases;

use super::columns::{CELL, Columns, RecoveryColumns};
use super::results::Results;
use super::run_table::RunTable;
use super::store::{Store, StoreError};
use crate::base::csv::Cell as Field;
use crate::base::names::Listed;
use crate::base::pixels::{PixelsError, exr};
use crate::experiment::plan::Plan;
use crate::instrument::metrics::{ALL_VIEWS, Epsilon, VIEWS};
use crate::instrument::recovery::{Lines, Photo, Problem};
use crate::run::images::{N_DOT_V_LAYER, linear_file};
use cases::{Candidate, Case, Images, Surface, Truth, cases};
use rayon::prelude::*;
use std::collections::BTreeMap;

pub const RECOVERY_FILE: &str = "recovery.csv";
/// Most pixels of pooled photos in a fit; of more, every n-th counts.
const PIXELS_MAX: usize = 2048;
/// Fewest pixels of a band of n·v in a fit.
const BAND_PIXELS_MIN: usize = 32;
/// Channels of a pixel.
const CHANNELS: usize = 3;
/// Seconds of a fit, over all views and each band, where two cores fit at once.
const FIT_SECONDS: f64 = 0.012;

/// Fits every candidate to every truth. Cells without an image are left out.
pub fn recovered(
    plan: &Plan,
    results: &Results,
    store: &Store,
) -> Result<RunTable<Vec<Vec<Field>>>, StoreError> {
    let cases = cases(plan, results);
    let jobs: Vec<(&Case, &Candidate)> = cases
        .iter()
        .flat_map(|case| {
            case.candidates
                .iter()
                .map(move |candidate| (case, candidate))
        })
        .collect();
    let rows: Vec<Vec<Vec<Field>>> = jobs
        .par_iter()
        .map(|(case, candidate)| fits(plan, store, case, candidate))
        .collect::<Result<_, _>>()?;
    let columns = std::iter::once(CELL.name.to_owned());
    Ok(RunTable {
        columns: columns.chain(RecoveryColumns::names()).collect(),
        rows: rows.into_iter().flatten().collect(),
    })
}

/// Stated seconds of all fits of a plan, as in `estimate`.
pub fn seconds(plan: &Plan) -> f64 {
    let Some(losses) = &plan.config.recovery else {
        return 0.0;
    };
    let fits: usize = cases::planned(plan)
        .iter()
        .map(|case| case.candidates.len() * case.truths.len())
        .sum();
    (fits * losses.len()) as f64 * FIT_SECONDS
}

/// The rows of a candidate: one per truth, loss and band of n·v.
fn fits(
    plan: &Plan,
    store: &Store,
    case: &Case,
    candidate: &Candidate,
) -> Result<Vec<Vec<Field>>, StoreError> {
    let mut rows = Vec::new();
    for truth in &case.truths {
        let orientations: Vec<u32> = truth.photos.keys().copied().collect();
        let widths = candidate.widths(&orientations);
        let Some(pixels) = Pixels::of_photos(store, &truth.photos)?.filter(|_| widths.len() > 2)
        else {
            continue;
        };
        let mut lines = Vec::new();
        for (roughness, ends) in widths {
            let [a, b] =
                ends.map(|(f0, images)| Ok::<_, StoreError>((f0, pixels.values(store, images)?)));
            let ((f0_a, a), (f0_b, b)) = (a?, b?);
            lines.push(Lines::through(roughness, [(f0_a, &a), (f0_b, &b)]));
        }
        let photo = Photo::exposed(pixels.values(store, &truth.photos)?, epsilon(plan, truth));
        for band in std::iter::once(ALL_VIEWS).chain(VIEWS) {
            let indices = pixels.in_band(band);
            if indices.len() < CHANNELS * BAND_PIXELS_MIN {
                continue;
            }
            let lines: Vec<Lines> = lines.iter().map(|lines| lines.selected(&indices)).collect();
            let photo = photo.selected(&indices);
            for &loss in plan.config.recovery.iter().flatten() {
                let problem = Problem {
                    lines: &lines,
                    photo: &photo,
                    loss,
                };
                let columns = columns(&problem, truth, candidate, band);
                let mut row = vec![Field::from(truth.first_cell().id.to_string())];
                row.extend(columns.fields());
                rows.push(row);
            }
        }
    }
    Ok(rows)
}

fn columns(
    problem: &Problem,
    truth: &Truth,
    candidate: &Candidate,
    [lo, hi]: [f64; 2],
) -> RecoveryColumns {
    let fit = problem.solve();
    let Surface { roughness, f0 } = truth.surface;
    RecoveryColumns {
        candidate: candidate.first_cell().id.to_string(),
        photos: truth.photos.len(),
        loss: problem.loss.name(),
        n_dot_v_from: lo,
        n_dot_v_to: hi,
        true_roughness: roughness,
        true_f0: f0,
        roughness: fit.roughness,
        f0: fit.f0,
        is_at_limit: u64::from(problem.is_at_limit(&fit)),
        loss_at_fit: fit.loss,
        loss_at_truth: problem.loss_of(roughness, f0),
    }
}

/// The ε of relative metrics under the light of a truth.
fn epsilon(plan: &Plan, truth: &Truth) -> Epsilon {
    let settings = truth.first_cell().point.settings();
    let luminance = plan.inputs.environment(&settings.environment).luminance;
    Epsilon::of_light(luminance.mean * f64::from(settings.shading.environment_scale))
}

/// The pixels of the photos that count, by orientation.
struct Pixels {
    /// Index of a texel with its n·v.
    by_orientation: BTreeMap<u32, Vec<(usize, f64)>>,
}

impl Pixels {
    /// Every n-th pixel of the masks; `None` without any.
    fn of_photos(store: &Store, photos: &Images) -> Result<Option<Self>, PixelsError> {
        let mut by_orientation = BTreeMap::new();
        for (orientation, cell) in photos {
            let path = store.image_path(&linear_file(cell));
            let n_dot_v = exr::read_layer(&path, Some(N_DOT_V_LAYER))?.rgb;
            let mask = exr::read(&path)?.alpha;
            let is_inside =
                |index: &usize| mask.as_ref().is_none_or(|mask| mask.data[*index] > 0.5);
            let inside = (0..n_dot_v.data.len()).filter(is_inside);
            let pixels: Vec<(usize, f64)> = inside
                .map(|index| (index, f64::from(n_dot_v.data[index][0])))
                .collect();
            by_orientation.insert(*orientation, pixels);
        }
        let count: usize = by_orientation.values().map(Vec::len).sum();
        let step = count.div_ceil(PIXELS_MAX).max(1);
        for pixels in by_orientation.values_mut() {
            *pixels = pixels.iter().copied().step_by(step).collect();
        }
        Ok((count > 0).then_some(Self { by_orientation }))
    }

    /// The linear values of images at the pixels, three a pixel, by orientation.
    fn values(&self, store: &Store, images: &Images) -> Result<Vec<f64>, PixelsError> {
        let mut values = Vec::new();
        for (orientation, pixels) in &self.by_orientation {
            let image = exr::read(&store.image_path(&linear_file(images[orientation])))?.rgb;
            let texels = pixels.iter().map(|(index, _)| image.data[*index]);
            values.extend(texels.flat_map(|texel| texel.map(f64::from)));
        }
        Ok(values)
    }

    /// Indices of the values whose n·v is in a band; the last one holds 1.
    fn in_band(&self, [lo, hi]: [f64; 2]) -> Vec<usize> {
        let hi = if hi == ALL_VIEWS[1] {
            f64::INFINITY
        } else {
            hi
        };
        let pixels = self.by_orientation.values().flatten().enumerate();
        pixels
            .filter(|(_, (_, n_dot_v))| (lo..hi).contains(n_dot_v))
            .flat_map(|(pixel, _)| CHANNELS * pixel..CHANNELS * (pixel + 1))
            .collect()
    }
}
