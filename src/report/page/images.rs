//! Chooses the images of the page: as many as fit the budget. Images are never reduced: averaging
//! texels would hide noise.

use super::page_run::PageRun;
use crate::base::pixels::packed;
use crate::base::pixels::{Decoded, GrayImage, exr};
use crate::experiment::axis::SCENE;
use crate::experiment::value::Value;
use crate::instrument::metrics::Epsilon;
use crate::instrument::scene::is_design;
use crate::study::finished::FinishedCell;
use rayon::prelude::*;
use serde::Serialize;
use std::collections::{BTreeMap, BTreeSet, HashSet};
use std::path::Path;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Choice {
    /// As many as fit the budget.
    Automatic,
    None,
}

/// Largest page, bytes. The images get the rest of the tables and figures.
pub const BUDGET_BYTES: usize = 40_000_000;
/// Images that are read and encoded together.
const CHUNK: usize = 32;

/// In place of images without references.
const NO_REFERENCES: &str = "The run has no references to compare its images with; its linear EXR \
                             and PNG files are in images/.";
pub const DESIGN: &str = "each pixel is a separate surface, not part of a picture";

#[derive(Clone, Debug, Default, Serialize)]
pub struct EmbeddedImage {
    pub run: usize,
    /// File name in `images/` of its run.
    pub file: String,
    /// Index of its reference; its own index for a reference.
    pub reference: usize,
    /// [`Epsilon::mean`] of its light.
    pub light_mean: f64,
    /// Size in texels.
    pub size: [u32; 2],
    pub payload: Option<usize>,
    /// Index of the mask's payload, for references.
    pub mask: Option<usize>,
    /// Number of channels clamped to the half-float range.
    pub clamped_count: usize,
}

#[derive(Debug, Default)]
pub struct ImageSet {
    pub images: Vec<EmbeddedImage>,
    pub payloads: Vec<String>,
    pub notes: Vec<String>,
    /// By run and file name.
    pub index: BTreeMap<(usize, String), usize>,
}

/// Collects the images of all runs. An unreadable file becomes a note.
pub fn collect(runs: &[PageRun], choice: Choice, budget: usize) -> ImageSet {
    let mut set = ImageSet::list(runs);
    match choice {
        Choice::None => {
            set.notes.push(
                "Images are omitted (--no-images); the linear EXR files are linked.".to_owned(),
            );
        }
        Choice::Automatic => {
            let first = set.in_first_point_set(runs);
            let mut order: Vec<usize> = (0..set.images.len()).collect();
            // Further point sets only differ in noise.
            order.sort_by_key(|index| !first.contains(index));
            set.embed(runs, &order, budget);
        }
    }
    if set.images.is_empty() && choice != Choice::None {
        set.notes
            .push(if runs.iter().all(|run| !run.finished.is_scored()) {
                NO_REFERENCES.to_owned()
            } else if designs(runs).is_empty() {
                "The run has no images.csv, so there are no images.".to_owned()
            } else {
                format!(
                    "The run has only the scene design, of which there are no pictures: {DESIGN}."
                )
            });
    }
    set
}

fn designs(runs: &[PageRun]) -> HashSet<Value> {
    let scenes: HashSet<&Value> = runs
        .iter()
        .flat_map(|run| &run.finished.cells)
        .map(|cell| &cell.point[SCENE])
        .collect();
    scenes
        .into_iter()
        .filter(|scene| is_design(&scene.to_string()))
        .cloned()
        .collect()
}

/// An image before its payloads are stored.
struct Prepared {
    image: EmbeddedImage,
    texels: String,
    /// Of references.
    mask: Option<String>,
}

impl Prepared {
    fn bytes(&self) -> usize {
        self.texels.len() + self.mask.as_ref().map_or(0, String::len)
    }
}

impl ImageSet {
    /// The images of the cells, each once, without pixels and without designs.
    fn list(runs: &[PageRun]) -> Self {
        let mut set = Self::default();
        let designs = designs(runs);
        for (run, page_run) in runs.iter().enumerate() {
            let is_picture = |cell: &&FinishedCell| !designs.contains(&cell.point[SCENE]);
            for cell in page_run.finished.cells.iter().filter(is_picture) {
                let Some(files) = &cell.images else {
                    continue;
                };
                let light = page_run.finished.epsilon(&cell.point);
                // The page shows images beside their references.
                let Some(reference) = &files.reference else {
                    continue;
                };
                let reference = set.add(run, reference, None, light);
                set.add(run, &files.radiance, Some(reference), light);
            }
        }
        set
    }

    fn add(&mut self, run: usize, file: &str, reference: Option<usize>, light: Epsilon) -> usize {
        let next = self.images.len();
        let index = *self.index.entry((run, file.to_owned())).or_insert(next);
        if index == next {
            self.images.push(EmbeddedImage {
                run,
                file: file.to_owned(),
                reference: reference.unwrap_or(next),
                light_mean: light.mean(),
                ..EmbeddedImage::default()
            });
        }
        index
    }

    fn references(&self) -> impl Iterator<Item = usize> {
        (0..self.images.len()).filter(|&index| self.images[index].reference == index)
    }

    /// References, and images of the first point set or without one.
    fn in_first_point_set(&self, runs: &[PageRun]) -> BTreeSet<usize> {
        let mut indices: BTreeSet<usize> = self.references().collect();
        for (run, page_run) in runs.iter().enumerate() {
            let cells = &page_run.finished.cells;
            let first_set = cells
                .iter()
                .map(|cell| cell.point.get("point_set"))
                .find(|set| **set != Value::Unset)
                .unwrap_or(&Value::Unset);
            for cell in cells {
                let set = cell.point.get("point_set");
                let is_in_first = *set == Value::Unset || set == first_set;
                if let Some(files) = cell.images.as_ref().filter(|_| is_in_first) {
                    indices.extend(self.index.get(&(run, files.radiance.clone())));
                }
            }
        }
        indices
    }

    /// Embeds images in this order, as many as fit the budget.
    fn embed(&mut self, runs: &[PageRun], order: &[usize], budget: usize) {
        let mut bytes = 0;
        let mut done_count = 0;
        for chunk in order.chunks(CHUNK) {
            let prepared: Vec<Result<Prepared, String>> = chunk
                .into_par_iter()
                .map(|index| self.prepare(runs, *index))
                .collect();
            for (index, prepared) in chunk.iter().zip(prepared) {
                match prepared {
                    Err(note) => self.notes.push(note),
                    Ok(prepared) => {
                        bytes += prepared.bytes();
                        if bytes > budget {
                            self.notes.push(format!(
                                "{} of {} images exceed the {} MB for images; their EXR files are \
                                 linked.",
                                order.len() - done_count,
                                order.len(),
                                budget / 1_000_000
                            ));
                            return;
                        }
                        self.images[*index] = EmbeddedImage {
                            payload: Some(self.store(prepared.texels)),
                            mask: prepared.mask.map(|mask| self.store(mask)),
                            ..prepared.image
                        };
                    }
                }
                done_count += 1;
            }
        }
    }

    fn prepare(&self, runs: &[PageRun], index: usize) -> Result<Prepared, String> {
        let image = self.images[index].clone();
        let decoded = read(&runs[image.run].finished.dir, &image.file)?;
        let encoded = packed::texels(&decoded.rgb);
        let is_reference = image.reference == index;
        Ok(Prepared {
            image: EmbeddedImage {
                size: [decoded.rgb.width, decoded.rgb.height],
                clamped_count: encoded.clamped_count,
                ..image
            },
            texels: encoded.base64,
            mask: is_reference.then(|| packed::mask(&mask_of(&decoded))),
        })
    }

    /// The index of a payload; equal small ones, such as masks, are stored once.
    pub(super) fn store(&mut self, text: String) -> usize {
        let known = self
            .payloads
            .iter()
            .position(|known| text.len() < 4096 && *known == text);
        known.unwrap_or_else(|| {
            self.payloads.push(text);
            self.payloads.len() - 1
        })
    }
}

/// A linear image of the run in `dir`.
pub fn read(dir: &Path, file: &str) -> Result<Decoded, String> {
    let images = dir.join("images");
    // A foreign folder may name any file of this computer.
    if Path::new(file).file_name() != Some(file.as_ref()) {
        return Err(format!(
            "{file:?} in images.csv is not the name of a file in {}",
            images.display()
        ));
    }
    exr::read(&images.join(file)).map_err(|error| error.to_string())
}

/// The mask of an image; everywhere 1 without alpha.
pub fn mask_of(image: &Decoded) -> GrayImage {
    image
        .alpha
        .clone()
        .unwrap_or_else(|| GrayImage::filled(image.rgb.width, image.rgb.height, 1.0))
}
