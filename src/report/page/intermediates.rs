//! The pictures of what images are made of, from [`INTERMEDIATES_FILE`], as far as they fit.

use super::images::ImageSet;
use super::page_run::PageRun;
use crate::base::files::read_regular;
use crate::instrument::pipeline::Encoding;
use crate::report::intermediates::{INTERMEDIATES_FILE, IntermediateRecord};
use serde::Serialize;
use std::collections::BTreeMap;

/// Share of the page's bytes that the pictures may add.
const PAGE_SHARE: f64 = 0.1;
const FILE_BYTES_MAX: u64 = 64 << 20;
/// Follows a sentence about missing pictures.
const HELP: &str = "`splitsum render --show NAME` draws one with the settings of an image.";

#[derive(Debug, Default, Serialize)]
pub struct PageIntermediates {
    pub pictures: Vec<EmbeddedIntermediate>,
    /// Indices of the pictures of what an image is made of.
    pub sets: Vec<Vec<usize>>,
    /// Missing pictures and why, one sentence each.
    pub notes: Vec<String>,
    /// Of each run, the set of each cell by its id.
    #[serde(skip)]
    pub cells: Vec<BTreeMap<String, usize>>,
}

#[derive(Debug, Serialize)]
pub struct EmbeddedIntermediate {
    /// As `render --show` takes it.
    pub name: String,
    /// Whether it has a pixel for each pixel of the image.
    pub is_attachment: bool,
    /// Size in texels.
    pub size: [u32; 2],
    pub payload: usize,
    /// Index of the mask's payload; `None` if there are values everywhere.
    pub mask: Option<usize>,
    pub clamped_count: usize,
    pub encoding: Encoding,
}

impl PageIntermediates {
    /// Embeds the pictures of all runs in `images`, in the order of the cells, as far as they add
    /// at most a tenth to the `page_bytes` of the rest of the page.
    pub fn collect(runs: &[PageRun], images: &mut ImageSet, page_bytes: usize) -> Self {
        let mut page = Self::default();
        let mut room = Room {
            bytes: (PAGE_SHARE * page_bytes as f64) as usize,
            omitted_count: 0,
        };
        for run in runs {
            let record = read(run).unwrap_or_else(|note| {
                page.notes.push(note);
                IntermediateRecord::default()
            });
            page.add(record, images, &mut room);
        }
        if room.omitted_count > 0 {
            page.notes.push(format!(
                "{} more pictures of what images are made of would add more than a tenth to this \
                 page. {HELP}",
                room.omitted_count
            ));
        }
        page
    }

    fn add(&mut self, record: IntermediateRecord, images: &mut ImageSet, room: &mut Room) {
        room.omitted_count += record.left_out;
        let pictures = record.pictures.into_iter().map(|picture| {
            if !room.take(picture.texels.len() + picture.mask.len()) {
                return None;
            }
            self.pictures.push(EmbeddedIntermediate {
                name: picture.name,
                is_attachment: picture.is_attachment,
                size: picture.size,
                payload: images.store(picture.texels),
                mask: (!picture.mask.is_empty()).then(|| images.store(picture.mask)),
                clamped_count: picture.clamped_count,
                encoding: picture.encoding,
            });
            Some(self.pictures.len() - 1)
        });
        // By index in the record.
        let places: Vec<Option<usize>> = pictures.collect();
        let first_set = self.sets.len();
        let place = |index: usize| places.get(index).copied().flatten();
        let sets = record.sets.into_iter();
        self.sets
            .extend(sets.map(|set| set.into_iter().filter_map(place).collect()));
        let cells = record.cells.into_iter();
        self.cells
            .push(cells.map(|(cell, set)| (cell, first_set + set)).collect());
    }

    /// The index of a cell's set.
    pub fn set_of(&self, run: usize, cell: &str) -> Option<usize> {
        let set = *self.cells.get(run)?.get(cell)?;
        (set < self.sets.len()).then_some(set)
    }
}

/// Bytes that are left for pictures.
struct Room {
    bytes: usize,
    omitted_count: usize,
}

impl Room {
    /// Whether a picture fits; the room is then smaller.
    fn take(&mut self, bytes: usize) -> bool {
        let fits = bytes <= self.bytes;
        if fits {
            self.bytes -= bytes;
        } else {
            self.omitted_count += 1;
        }
        fits
    }
}

/// The record of a run; the error is a sentence for the page.
fn read(run: &PageRun) -> Result<IntermediateRecord, String> {
    let path = run.finished.dir.join(INTERMEDIATES_FILE);
    let text = read_regular(&path, FILE_BYTES_MAX).map_err(|error| match error.kind() {
        std::io::ErrorKind::NotFound => format!(
            "{} has no {INTERMEDIATES_FILE}, so this page does not show what images are made of: \
             the run was stopped early, or made by an older version. {HELP}",
            run.label
        ),
        _ => format!("{}: {error}", path.display()),
    })?;
    serde_json::from_slice(&text).map_err(|error| {
        format!(
            "{}: {error}; delete it and run the experiment again",
            path.display()
        )
    })
}
