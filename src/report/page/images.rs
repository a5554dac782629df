//! Chooses the images of the page: all of them whole if they fit the budget, else a window of native texels of each. Images are never
//! reduced: averaging texels would hide noise.

use super::page_run::PageRun;
use crate::experiment::axis::SCENE;
use crate::experiment::value::Value;
use crate::metrics::{Comparison, Epsilon};
use crate::pixels::packed;
use crate::pixels::{Decoded, GrayImage, RgbImage, exr};
use crate::scene::is_design;
use crate::study::finished::FinishedCell;
use crate::tonemap::ToneCurve;
use rayon::prelude::*;
use serde::Serialize;
use std::collections::{BTreeMap, BTreeSet, HashSet};
use std::path::Path;

/// A part of an image, in texels from the top left corner.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct Window {
    pub x: u32,
    pub y: u32,
    pub width: u32,
    pub height: u32,
}

const WHOLE: Window = Window { x: 0, y: 0, width: u32::MAX, height: u32::MAX };

/// The embedded part of the images.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Choice {
    /// Whole images within the budget, else windows.
    Automatic,
    None,
}

/// Largest page, bytes. The images get the rest of the tables and figures.
pub const BUDGET_BYTES: usize = 40_000_000;
/// Smallest window: smaller ones would only show noise.
const WINDOW_SIDE_MIN: u32 = 48;
/// Sides of windows are multiples of this; their corners move by 1/8 of a side.
const WINDOW_STEP: u32 = 8;
/// Share of the budget that estimates aim for: the compressed size is known only afterwards.
const AIM: f64 = 0.9;
/// Images that are read and encoded together.
const CHUNK: usize = 32;

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
    /// Full size in texels.
    pub size: [u32; 2],
    /// The embedded part.
    pub window: Option<Window>,
    /// Index into the payloads.
    pub payload: Option<usize>,
    /// Index of the mask's payload, for references.
    pub mask: Option<usize>,
    /// Number of channels clamped to the half-float range.
    pub clamped_count: usize,
}

#[derive(Debug, Default)]
pub struct ImageSet {
    pub images: Vec<EmbeddedImage>,
    /// Base64 texts.
    pub payloads: Vec<String>,
    /// Omissions, one sentence each.
    pub notes: Vec<String>,
    /// By run and file name.
    pub index: BTreeMap<(usize, String), usize>,
}

/// Collects the images of all runs. An unreadable file becomes a note.
pub fn collect(runs: &[PageRun], choice: Choice, budget: usize) -> ImageSet {
    let mut set = ImageSet::list(runs);
    match choice {
        Choice::None => {
            set.notes.push("Images are omitted (--no-images); the linear EXR files are linked.".to_owned());
        }
        Choice::Automatic => {
            let mut wanted: BTreeSet<usize> = (0..set.images.len()).collect();
            let mut done = set.embed(runs, budget, |_| Some(WHOLE));
            let first_sets = set.of_first_point_set(runs);
            if done.is_err() && first_sets.len() < wanted.len() {
                // Further point sets only differ in noise: better fewer whole images than parts of all.
                wanted = first_sets;
                done = set.embed(runs, budget, |index| wanted.contains(&index).then_some(WHOLE));
            }
            if let Err(bytes_per_texel) = done {
                set.embed_windows(runs, budget, bytes_per_texel, &wanted);
            }
            if wanted.len() < set.images.len() {
                let note = "Not all images fit the page: only the images of the first point set are embedded; the EXR files of all are \
                            linked.";
                set.notes.insert(0, note.to_owned());
            }
        }
    }
    if set.images.is_empty() && choice != Choice::None {
        let why = match designs(runs).is_empty() {
            true => "The run has no images.csv, so there are no images.".to_owned(),
            false => format!("The run has only the scene design, of which there are no pictures: {DESIGN}."),
        };
        set.notes.push(why);
    }
    set
}

fn designs(runs: &[PageRun]) -> HashSet<Value> {
    let scenes: HashSet<&Value> =
        runs.iter().flat_map(|run| &run.finished.cells).map(|cell| &cell.point[SCENE]).collect();
    scenes.into_iter().filter(|scene| is_design(&scene.to_string())).cloned().collect()
}

/// An image, its encoded texels and its mask.
type Prepared = (EmbeddedImage, String, Option<String>);

impl ImageSet {
    /// The images of the cells, each once, without pixels and without designs.
    fn list(runs: &[PageRun]) -> Self {
        let mut set = Self::default();
        let designs = designs(runs);
        for (run, page_run) in runs.iter().enumerate() {
            let is_picture = |cell: &&FinishedCell| !designs.contains(&cell.point[SCENE]);
            for cell in page_run.finished.cells.iter().filter(is_picture) {
                let (Some(files), light) = (&cell.images, page_run.finished.epsilon(&cell.point)) else { continue };
                let reference = set.add(run, &files.reference, None, light);
                set.add(run, &files.radiance, Some(reference), light);
            }
        }
        set
    }

    fn add(&mut self, run: usize, file: &str, reference: Option<usize>, light: Epsilon) -> usize {
        let next = self.images.len();
        let index = *self.index.entry((run, file.to_owned())).or_insert(next);
        if index == next {
            let (file, reference) = (file.to_owned(), reference.unwrap_or(next));
            self.images.push(EmbeddedImage {
                run,
                file,
                reference,
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
    fn of_first_point_set(&self, runs: &[PageRun]) -> BTreeSet<usize> {
        let mut found: BTreeSet<usize> = self.references().collect();
        for (run, page_run) in runs.iter().enumerate() {
            let cells = &page_run.finished.cells;
            let set = |cell: &FinishedCell| cell.point.get("point_set").clone();
            let first = cells.iter().map(set).find(|value| *value != Value::Unset).unwrap_or(Value::Unset);
            let own = cells.iter().filter(|cell| [&first, &Value::Unset].contains(&&set(cell)));
            let files = own.filter_map(|cell| cell.images.as_ref());
            found.extend(files.filter_map(|files| self.index.get(&(run, files.radiance.clone()))));
        }
        found
    }

    /// Embeds the window of each image (`None`: nothing). If the images exceed the budget, the error is the bytes per texel.
    fn embed(&mut self, runs: &[PageRun], budget: usize, window: impl Fn(usize) -> Option<Window>) -> Result<(), f64> {
        (self.payloads, self.notes) = (Vec::new(), Vec::new());
        for image in &mut self.images {
            (image.window, image.payload, image.mask) = (None, None, None);
        }
        let wanted: Vec<(usize, Window)> =
            (0..self.images.len()).filter_map(|index| Some((index, window(index)?))).collect();
        let (mut bytes, mut texels, mut done) = (0, 0, 0);
        for chunk in wanted.chunks(CHUNK) {
            let prepared: Vec<Result<Prepared, String>> =
                chunk.into_par_iter().map(|(index, window)| self.prepare(runs, *index, *window)).collect();
            for ((index, _), prepared) in chunk.iter().zip(prepared) {
                let (image, text, mask) = match prepared {
                    Ok(prepared) => prepared,
                    Err(note) => {
                        self.notes.push(note);
                        done += 1;
                        continue;
                    }
                };
                bytes += text.len() + mask.as_ref().map_or(0, String::len);
                texels += image.window.map_or(0, |window| u64::from(window.width) * u64::from(window.height));
                if bytes > budget {
                    self.notes.push(format!(
                        "{} of {} images exceed the {} MB for images; their EXR files are linked.",
                        wanted.len() - done,
                        self.images.len(),
                        budget / 1_000_000
                    ));
                    return Err(bytes as f64 / texels as f64);
                }
                let (payload, mask) = (Some(self.store(text)), mask.map(|mask| self.store(mask)));
                self.images[*index] = EmbeddedImage { payload, mask, ..image };
                done += 1;
            }
        }
        Ok(())
    }

    /// Reads an image and encodes the window.
    fn prepare(&self, runs: &[PageRun], index: usize, wanted: Window) -> Result<Prepared, String> {
        let mut image = self.images[index].clone();
        let decoded = read_image(runs, &image)?;
        image.size = [decoded.rgb.width, decoded.rgb.height];
        let [full_width, full_height] = image.size;
        let window = match wanted {
            WHOLE => Window { width: full_width, height: full_height, ..WHOLE },
            window => window,
        };
        let Window { x, y, width, height } = window;
        let encoded = packed::texels(&RgbImage::from_fn(width, height, |i, j| decoded.rgb.get(x + i, y + j)));
        let mask = (image.reference == index).then(|| {
            let mask = mask_of(&decoded);
            packed::mask(&GrayImage::from_fn(width, height, |i, j| mask.get(x + i, y + j)))
        });
        (image.window, image.clamped_count) = (Some(window), encoded.clamped_count);
        Ok((image, encoded.base64, mask))
    }

    /// The index of a payload; equal small ones, such as masks, are stored once.
    fn store(&mut self, text: String) -> usize {
        let known = self.payloads.iter().position(|known| text.len() < 4096 && *known == text);
        known.unwrap_or_else(|| {
            self.payloads.push(text);
            self.payloads.len() - 1
        })
    }

    /// Embeds windows of one size, where the methods of each reference err most.
    fn embed_windows(&mut self, runs: &[PageRun], budget: usize, bytes_per_texel: f64, wanted: &BTreeSet<usize>) {
        let texels = budget as f64 * AIM / bytes_per_texel / wanted.len() as f64;
        let side = (texels.sqrt() as u32 / WINDOW_STEP * WINDOW_STEP).max(WINDOW_SIDE_MIN);
        let references: Vec<usize> = self.references().collect();
        let worst = |index| Some((index, self.worst_window(runs, index, side)?));
        let places: BTreeMap<usize, Window> = references.into_par_iter().filter_map(worst).collect();
        let reference_of: Vec<usize> = self.images.iter().map(|image| image.reference).collect();
        let place = |index: usize| places.get(&reference_of[index]).filter(|_| wanted.contains(&index)).copied();
        // Overflow of the budget becomes a note.
        let _ = self.embed(runs, budget, place);
        let note = format!(
            "The images exceed {} MB: each is cropped to {side} x {side} native texels where the methods of its scene err most. Metrics \
             are of the whole images; the full EXR files are linked.",
            budget / 1_000_000
        );
        self.notes.insert(0, note);
    }

    /// The window of a reference with the largest sum of relative errors of its images; `None` if it cannot be read.
    fn worst_window(&self, runs: &[PageRun], reference: usize, side: u32) -> Option<Window> {
        let truth = read_image(runs, &self.images[reference]).ok()?;
        let [width, height] = [truth.rgb.width, truth.rgb.height];
        let window = Window { x: 0, y: 0, width: side.min(width), height: side.min(height) };
        let (mask, epsilon) = (mask_of(&truth), Epsilon::of_light(self.images[reference].light_mean));
        let mut errors = vec![0.0; (width * height) as usize];
        let tests = (0..self.images.len()).filter(|&i| i != reference && self.images[i].reference == reference);
        for test in tests.filter_map(|i| read_image(runs, &self.images[i]).ok()) {
            if let Ok(comparison) = Comparison::new(&test.rgb, &truth.rgb, &mask, ToneCurve::default(), epsilon) {
                let map = comparison.relative_error_map();
                errors.iter_mut().zip(&map.data).for_each(|(sum, error)| *sum += error);
            }
        }
        let sum = |[x, y]: [u32; 2]| -> f32 {
            let row = |row: u32| &errors[(row * width + x) as usize..][..window.width as usize];
            (y..y + window.height).flat_map(row).sum()
        };
        let starts = |length: u32| (0..=length - side.min(length)).step_by((side / WINDOW_STEP) as usize);
        let corners = starts(height).flat_map(|y| starts(width).map(move |x| [x, y]));
        let worst = corners.map(|corner| (sum(corner), corner)).max_by(|a, b| a.0.total_cmp(&b.0));
        worst.map(|(_, [x, y])| Window { x, y, ..window })
    }
}

/// A linear image of the run in `dir`.
pub fn read(dir: &Path, file: &str) -> Result<Decoded, String> {
    let images = dir.join("images");
    // A foreign folder may name any file of this computer.
    if Path::new(file).file_name() != Some(file.as_ref()) {
        return Err(format!("{file:?} in images.csv is not the name of a file in {}", images.display()));
    }
    exr::read(&images.join(file)).map_err(|error| error.to_string())
}

fn read_image(runs: &[PageRun], image: &EmbeddedImage) -> Result<Decoded, String> {
    read(&runs[image.run].finished.dir, &image.file)
}

/// The mask of an image; everywhere 1 without alpha.
pub fn mask_of(image: &Decoded) -> GrayImage {
    image.alpha.clone().unwrap_or_else(|| GrayImage::filled(image.rgb.width, image.rgb.height, 1.0))
}
