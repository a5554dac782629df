//! Which images go into the page, at what size: all of them whole where they fit the budget, else a window of native texels
//! of each with a reduced overview. Reduced images are never compared: averaging texels would hide noise.
//!
//! Long because choosing, shrinking and packing share one budget.

use super::told::Told;
use crate::metrics::Comparison;
use crate::pixels::packed::{self, Encoded};
use crate::pixels::{Decoded, GrayImage, RgbImage, exr};
use crate::runner::value::Value;
use crate::study::finished::FinishedCell;
use crate::tonemap::ToneCurve;
use rayon::prelude::*;
use serde::Serialize;
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

/// A part of an image, texels from the top left corner.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct Window {
    pub x: u32,
    pub y: u32,
    pub width: u32,
    pub height: u32,
}

/// What of the images a report embeds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Choice {
    /// Whole images within the budget, else windows.
    Automatic,
    /// This window of every image.
    Crop(Window),
    None,
}

/// Bytes that a page may take. The images get what its tables and figures leave.
pub const BUDGET_BYTES: usize = 40_000_000;
/// Longest side of an overview, texels.
const OVERVIEW_SIDE: u32 = 96;
/// Windows are no smaller: below this they show noise only.
const WINDOW_SIDE_MIN: u32 = 48;
/// Share of the budget that estimates aim for; what an image compresses to is known only afterwards.
const AIM: f64 = 0.9;
/// Images that are read and encoded together.
const CHUNK: usize = 32;

/// One linear image of a run.
#[derive(Clone, Debug, Serialize)]
pub struct EmbeddedImage {
    pub run: usize,
    /// File name in `images/` of its run.
    pub file: String,
    /// Index of the reference's image; its own for a reference.
    pub reference: usize,
    /// Full size in texels.
    pub size: [u32; 2],
    /// What is embedded; `None` when nothing is.
    pub window: Option<Window>,
    /// Index into the payloads.
    pub payload: Option<usize>,
    /// Mask payload, on references only.
    pub mask: Option<usize>,
    /// Reduced image of the whole, where only a window is embedded: its size and payload.
    pub overview: Option<([u32; 2], usize)>,
    /// Channels above the half-float range, stored as its maximum.
    pub clamped_count: usize,
}

/// The images of a page.
#[derive(Debug, Default)]
pub struct ImageSet {
    pub images: Vec<EmbeddedImage>,
    /// Base64 texts.
    pub payloads: Vec<String>,
    /// What was left out or cut, one sentence each.
    pub notes: Vec<String>,
    /// By run and file name.
    pub index: BTreeMap<(usize, String), usize>,
}

/// A window that lies in no image of the runs.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "--crop {},{},{},{} reaches beyond the images, which are {sizes} texels; expected X + W and Y + H within them",
    .window.x, .window.y, .window.width, .window.height
)]
pub struct CropError {
    pub window: Window,
    /// Sizes that occur, "96 x 96 or 256 x 256".
    pub sizes: String,
}

/// Collects the images of all runs. A file that cannot be read is a note, not a failure; a crop that fits no image is one.
pub fn collect(runs: &[Told], choice: Choice, budget: usize) -> Result<ImageSet, CropError> {
    let mut set = list(runs);
    match choice {
        Choice::None => {
            set.notes.push("Images were left out (--no-images); the linear EXR files are linked.".to_owned())
        }
        Choice::Crop(window) => {
            let too_small = set.too_small_for(runs, window)?;
            set.embed(runs, budget, |index| (!too_small.contains(&index)).then_some(window));
            set.notes.push(format!(
                "Images are cut to {} x {} texels at ({}, {}) (--crop); error metrics are those of the whole images.",
                window.width, window.height, window.x, window.y
            ));
            if !too_small.is_empty() {
                set.notes.push(format!(
                    "{} of {} images end before the crop does and are left out; their EXR files are linked.",
                    too_small.len(),
                    set.images.len()
                ));
            }
        }
        Choice::Automatic => {
            let whole = Window { x: 0, y: 0, width: u32::MAX, height: u32::MAX };
            let mut used = set.embed(runs, budget, |_| Some(whole));
            let mut wanted: BTreeSet<usize> = (0..set.images.len()).collect();
            let first_sets = set.of_first_point_set(runs);
            if used.left_out > 0 && first_sets.len() < wanted.len() {
                // Other point sets show the same error with other noise: better fewer images than parts of all.
                wanted = first_sets;
                set.forget_payloads();
                used = set.embed(runs, budget, |index| wanted.contains(&index).then_some(whole));
            }
            if used.left_out > 0 {
                set.forget_payloads();
                set.embed_windows(runs, budget, used.bytes_per_texel, &wanted);
            }
            if wanted.len() < set.images.len() {
                set.notes.insert(
                    0,
                    "Not all images fit the page: of several point sets the images of the first are embedded; the EXR files \
                     of all are linked."
                        .to_owned(),
                );
            }
        }
    }
    if set.images.is_empty() && choice != Choice::None {
        set.notes.push("The run has no images.csv, so no image can be shown.".to_owned());
    }
    Ok(set)
}

/// What embedding cost.
struct Used {
    bytes_per_texel: f64,
    left_out: usize,
}

/// A decoded image with its encoded window.
struct Prepared {
    size: [u32; 2],
    window: Window,
    payload: Encoded,
    overview: Option<(RgbImage, Encoded)>,
    mask: Option<String>,
}

fn list(runs: &[Told]) -> ImageSet {
    let mut set = ImageSet::default();
    for (run, told) in runs.iter().enumerate() {
        for images in told.finished.cells.iter().filter_map(|cell| cell.images.as_ref()) {
            let reference = set.add(run, &images.reference, None);
            set.add(run, &images.radiance, Some(reference));
        }
    }
    set
}

impl ImageSet {
    fn add(&mut self, run: usize, file: &str, reference: Option<usize>) -> usize {
        let next = self.images.len();
        let index = *self.index.entry((run, file.to_owned())).or_insert(next);
        if index == next {
            self.images.push(EmbeddedImage {
                run,
                file: file.to_owned(),
                reference: reference.unwrap_or(next),
                size: [0, 0],
                window: None,
                payload: None,
                mask: None,
                overview: None,
                clamped_count: 0,
            });
        }
        index
    }

    /// Images that do not hold the whole window, by the sizes of their references; an error where none of them does.
    fn too_small_for(&self, runs: &[Told], window: Window) -> Result<BTreeSet<usize>, CropError> {
        let references: Vec<usize> = (0..self.images.len()).filter(|&i| self.images[i].reference == i).collect();
        let sizes: BTreeMap<usize, [u32; 2]> = references
            .into_par_iter()
            .filter_map(|index| {
                read_image(runs, &self.images[index]).ok().map(|i| (index, [i.rgb.width, i.rgb.height]))
            })
            .collect();
        let ends = |start: u32, length: u32| u64::from(start) + u64::from(length);
        let (right, bottom) = (ends(window.x, window.width), ends(window.y, window.height));
        let holds = |size: &[u32; 2]| right <= u64::from(size[0]) && bottom <= u64::from(size[1]);
        if !sizes.is_empty() && !sizes.values().any(holds) {
            let found: BTreeSet<&[u32; 2]> = sizes.values().collect();
            let found: Vec<String> = found.into_iter().map(|[width, height]| format!("{width} x {height}")).collect();
            return Err(CropError { window, sizes: found.join(" or ") });
        }
        let is_small = |image: &EmbeddedImage| sizes.get(&image.reference).is_some_and(|size| !holds(size));
        Ok((0..self.images.len()).filter(|&i| is_small(&self.images[i])).collect())
    }

    fn forget_payloads(&mut self) {
        self.payloads.clear();
        self.notes.clear();
        for image in &mut self.images {
            (image.window, image.payload, image.mask, image.overview) = (None, None, None, None);
        }
    }

    /// Images of cells with the first point set of their run, or none, and all references.
    fn of_first_point_set(&self, runs: &[Told]) -> BTreeSet<usize> {
        let mut found: BTreeSet<usize> = (0..self.images.len()).filter(|&i| self.images[i].reference == i).collect();
        for (run, told) in runs.iter().enumerate() {
            let cells = &told.finished.cells;
            let set = |cell: &FinishedCell| cell.point.get("point_set").clone();
            let first = cells.iter().map(set).find(|value| *value != Value::Unset).unwrap_or(Value::Unset);
            let own = cells.iter().filter(|cell| [&first, &Value::Unset].contains(&&set(cell)));
            let files = own.filter_map(|cell| cell.images.as_ref());
            found.extend(files.filter_map(|files| self.index.get(&(run, files.radiance.clone()))));
        }
        found
    }

    /// Embeds the window that `window` names for each image (`None`: nothing), clipped to the image, until the budget is used up.
    fn embed(&mut self, runs: &[Told], budget: usize, window: impl Fn(usize) -> Option<Window> + Sync) -> Used {
        let (mut bytes, mut texels, mut done) = (0usize, 0u64, 0);
        while done < self.images.len() {
            let chunk = done..(done + CHUNK).min(self.images.len());
            let prepared: Vec<(usize, Result<Prepared, String>)> = chunk
                .into_par_iter()
                .filter_map(|index| Some((index, window(index)?)))
                .map(|(index, window)| (index, prepare(runs, &self.images, index, window)))
                .collect();
            for (index, prepared) in prepared {
                match prepared {
                    Ok(prepared) => {
                        bytes += prepared.payload.base64.len();
                        bytes += prepared.mask.as_ref().map_or(0, String::len);
                        bytes += prepared.overview.as_ref().map_or(0, |(_, encoded)| encoded.base64.len());
                        texels += u64::from(prepared.window.width) * u64::from(prepared.window.height);
                        if bytes > budget {
                            let left_out = (index..self.images.len()).filter(|&i| window(i).is_some()).count();
                            self.notes.push(format!(
                                "{left_out} of {} images do not fit the {} MB that the page has for them; their EXR files are linked.",
                                self.images.len(),
                                budget / 1_000_000
                            ));
                            return Used { bytes_per_texel: bytes as f64 / texels as f64, left_out };
                        }
                        self.store(index, prepared);
                    }
                    Err(note) => self.notes.push(note),
                }
            }
            done += CHUNK;
        }
        Used { bytes_per_texel: bytes as f64 / texels.max(1) as f64, left_out: 0 }
    }

    fn store(&mut self, index: usize, prepared: Prepared) {
        let mut payload = |text: String| match self.payloads.iter().position(|known| *known == text) {
            Some(known) if text.len() < 4096 => known,
            _ => {
                self.payloads.push(text);
                self.payloads.len() - 1
            }
        };
        let image = &mut self.images[index];
        image.size = prepared.size;
        image.window = Some(prepared.window);
        image.clamped_count = prepared.payload.clamped_count;
        image.payload = Some(payload(prepared.payload.base64));
        image.mask = prepared.mask.map(&mut payload);
        image.overview =
            prepared.overview.map(|(small, encoded)| ([small.width, small.height], payload(encoded.base64)));
    }

    /// Windows of the same side everywhere, each where the methods of its reference err most.
    fn embed_windows(&mut self, runs: &[Told], budget: usize, bytes_per_texel: f64, wanted: &BTreeSet<usize>) {
        let overviews = wanted.len() as f64 * f64::from(OVERVIEW_SIDE * OVERVIEW_SIDE) * bytes_per_texel;
        let texels = (budget as f64 * AIM - overviews) / bytes_per_texel / wanted.len() as f64;
        let side = (texels.max(0.0).sqrt() as u32 / 8 * 8).max(WINDOW_SIDE_MIN);
        let references: Vec<usize> = (0..self.images.len()).filter(|&i| self.images[i].reference == i).collect();
        let places: BTreeMap<usize, Window> =
            references.into_par_iter().map(|index| (index, self.worst_window(runs, index, side))).collect();
        let reference_of: Vec<usize> = self.images.iter().map(|image| image.reference).collect();
        self.embed(runs, budget, |index| places.get(&reference_of[index]).filter(|_| wanted.contains(&index)).copied());
        self.notes.insert(
            0,
            format!(
                "The images would not fit {} MB: of each a window of {side} x {side} native texels is embedded, where the \
                 methods of its scene err most, with a reduced overview. Metrics are those of the whole images; the full EXR \
                 files are linked.",
                budget / 1_000_000
            ),
        );
    }

    /// The window of a reference with the largest sum of relative errors over all images that are compared with it.
    fn worst_window(&self, runs: &[Told], reference: usize, side: u32) -> Window {
        let corner = Window { x: 0, y: 0, width: side, height: side };
        let Ok(truth) = read_image(runs, &self.images[reference]) else { return corner };
        let [width, height] = [truth.rgb.width as usize, truth.rgb.height as usize];
        let mask = mask_of(&truth);
        // One row and column of zeros before the first.
        let mut sums = vec![0.0f64; (width + 1) * (height + 1)];
        let tests = (0..self.images.len()).filter(|&i| i != reference && self.images[i].reference == reference);
        for test in tests.filter_map(|i| read_image(runs, &self.images[i]).ok()) {
            if let Ok(comparison) = Comparison::new(&test.rgb, &truth.rgb, &mask, ToneCurve::default()) {
                let map = comparison.relative_error_map();
                map.data.iter().enumerate().for_each(|(i, error)| {
                    sums[(i / width + 1) * (width + 1) + i % width + 1] += f64::from(*error);
                });
            }
        }
        for y in 1..=height {
            for x in 1..=width {
                let at = y * (width + 1) + x;
                sums[at] += sums[at - 1] + sums[at - width - 1] - sums[at - width - 2];
            }
        }
        let [w, h] = [(side as usize).min(width), (side as usize).min(height)];
        let sum = |x: usize, y: usize| {
            let at = |x: usize, y: usize| sums[y * (width + 1) + x];
            at(x + w, y + h) - at(x, y + h) - at(x + w, y) + at(x, y)
        };
        let corners = (0..=height - h).flat_map(|y| (0..=width - w).map(move |x| (x, y)));
        let worst = corners.max_by(|a, b| sum(a.0, a.1).total_cmp(&sum(b.0, b.1)));
        let (x, y) = worst.unwrap_or((0, 0));
        Window { x: x as u32, y: y as u32, width: side, height: side }
    }
}

/// A linear image of the run in `dir`.
pub fn read(dir: &Path, file: &str) -> Result<Decoded, String> {
    let images = dir.join("images");
    // A folder that someone sent may name any file of this computer.
    if Path::new(file).file_name() != Some(file.as_ref()) {
        return Err(format!("{file:?} in images.csv is not the name of a file in {}", images.display()));
    }
    exr::read(&images.join(file)).map_err(|error| error.to_string())
}

fn read_image(runs: &[Told], image: &EmbeddedImage) -> Result<Decoded, String> {
    read(&runs[image.run].finished.dir, &image.file)
}

/// Where an image has pixels: everywhere without alpha.
pub fn mask_of(image: &Decoded) -> GrayImage {
    image.alpha.clone().unwrap_or_else(|| GrayImage::filled(image.rgb.width, image.rgb.height, 1.0))
}

fn prepare(runs: &[Told], images: &[EmbeddedImage], index: usize, wanted: Window) -> Result<Prepared, String> {
    let decoded = read_image(runs, &images[index])?;
    let size = [decoded.rgb.width, decoded.rgb.height];
    // Clipped, and moved inside where it starts beyond the image.
    let clip = |start: u32, length: u32, full: u32| {
        let start = start.min(full - length.min(full));
        (start, length.min(full - start))
    };
    let ((x, width), (y, height)) = (clip(wanted.x, wanted.width, size[0]), clip(wanted.y, wanted.height, size[1]));
    let window = Window { x, y, width, height };
    let part = RgbImage::from_fn(width, height, |i, j| decoded.rgb.get(x + i, y + j));
    let mask = (images[index].reference == index).then(|| mask_of(&decoded));
    let is_whole = [width, height] == size;
    let overview = (!is_whole).then(|| {
        let small = reduced(&decoded.rgb, OVERVIEW_SIDE);
        let encoded = packed::radiance(&small);
        (small, encoded)
    });
    Ok(Prepared {
        size,
        window,
        payload: packed::radiance(&part),
        overview,
        mask: mask.map(|mask| packed::mask(&GrayImage::from_fn(width, height, |i, j| mask.get(x + i, y + j)))),
    })
}

/// Means of square blocks, so that no side is longer than `side`.
fn reduced(image: &RgbImage, side: u32) -> RgbImage {
    let block = image.width.max(image.height).div_ceil(side).max(1);
    RgbImage::from_fn(image.width.div_ceil(block), image.height.div_ceil(block), |i, j| {
        let xs = (i * block)..((i + 1) * block).min(image.width);
        let ys = (j * block)..((j + 1) * block).min(image.height);
        let count = (xs.len() * ys.len()) as f32;
        let texels = ys.flat_map(|y| xs.clone().map(move |x| image.get(x, y)));
        texels.fold([0.0; 3], |sum, texel| std::array::from_fn(|c| sum[c] + texel[c] / count))
    })
}
