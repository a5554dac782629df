//! References that are as exact as the images that they judge need.
//!
//! The images of a group come first, each by itself. A reference of 64 samples judges an image; if
//! its noise is too large beside the image's error, one of 128 does, then one of 256, and so on.
//! The first count that suffices is the *need* of the image. The reference of the group has the
//! largest need of its images.
//!
//! A need depends on the image and on the references alone, and the group's count on all its
//! images in the plan. So a stopped, split or continued run takes the same count as a whole one:
//! needs are kept with the reference's record, and cells that another count has judged are opened
//! again.

use super::{Progress, Run};
use crate::experiment::axis::{FRAMES, Point};
use crate::experiment::id::Id;
use crate::experiment::plan::{Cell, ReferenceGroup};
use crate::experiment::value::Value;
use crate::instrument::pipeline::Frame;
use crate::run::cell_fault::CellFault;
use crate::run::reference_image::ReferenceImage;
use crate::run::renderer::Renderer;
use crate::run::store::{CELLS_FOLDER, ReferenceRecord, StoreError};
use std::collections::{BTreeMap, HashMap};
use std::sync::Arc;

/// Memory for images that wait for their reference, bytes. The others are rendered again.
const HELD_BYTES: u64 = 64 << 20;

/// Largest power of the sample count with which the variance of a reference may fall: rounds that
/// are too noisy even so are left out. Scrambled nets reach 1.4 to 1.6 (measured).
const VARIANCE_EXPONENT_MAX: f64 = 2.0;

/// Images of a group that were rendered before its reference.
#[derive(Default)]
pub(super) struct Held<'p> {
    frames: HashMap<Id, Arc<Frame>>,
    bytes: u64,
    failures: HashMap<Id, String>,
    /// The cell and the reason of the failure that ends the run.
    pub(super) fatal: Option<(&'p Cell, String)>,
}

impl<'p> Held<'p> {
    fn keep(&mut self, id: Id, frame: Arc<Frame>) {
        let bytes = frame.bytes();
        if self.bytes + bytes <= HELD_BYTES {
            self.bytes += bytes;
            self.frames.insert(id, frame);
        }
    }

    /// Takes the image of that id out, or the reason of its failure; `None` if it must be rendered.
    pub(super) fn take(&mut self, id: Id) -> Option<Result<Arc<Frame>, String>> {
        let frame = self.frames.remove(&id).map(Ok);
        frame.or_else(|| self.failures.remove(&id).map(Err))
    }
}

/// The references of a group by sample count, each rendered when an image first needs it.
struct Rounds {
    id: Id,
    point: Point,
    /// Ascending.
    counts: Vec<u32>,
    /// Largest noise over error.
    share: f64,
    images: BTreeMap<u32, Arc<ReferenceImage>>,
}

impl Rounds {
    /// The samples of an exact reference.
    fn last(&self) -> u32 {
        self.counts[self.counts.len() - 1]
    }

    /// Returns the next count worth a try after `count` left `excess` times too much noise.
    fn after(&self, count: u32, excess: f64) -> u32 {
        let is_worth = |next: &&u32| {
            let ratio = f64::from(**next) / f64::from(count);
            **next > count && ratio.powf(VARIANCE_EXPONENT_MAX) >= excess
        };
        let next = self.counts.iter().find(is_worth);
        next.copied().unwrap_or(self.last())
    }
}

impl<'p> Run<'p> {
    /// Renders the reference of a group or reads it back; `None` if the run was stopped. Images
    /// that had to be rendered for it are in `held`.
    pub(super) fn group_reference(
        &mut self,
        id: Id,
        group: &ReferenceGroup<'p>,
        held: &mut Held<'p>,
        renderer: &mut dyn Renderer,
        progress: &mut dyn Progress,
    ) -> Result<Option<Arc<ReferenceImage>>, CellFault> {
        let Some(first) = group.cells().next() else {
            return Ok(None);
        };
        let point = self.plan.reference_point(&first.point);
        let counts = self.plan.reference_counts(&point);
        let (Some(share), [_, _, ..]) = (self.plan.config.reference.noise_share(), &counts[..])
        else {
            let samples = self.plan.config.reference.samples;
            return self.reference(id, &point, samples, renderer).map(Some);
        };
        let mut rounds = Rounds {
            id,
            point,
            counts,
            share,
            images: BTreeMap::new(),
        };
        let Some(needs) = self.needs(group, &mut rounds, held, renderer)? else {
            return Ok(None);
        };
        let of_group = group.radiances.iter();
        let samples = of_group
            .filter_map(|radiance| needs.get(&radiance.id).copied())
            .max()
            .unwrap_or(rounds.counts[0]);
        let image = self.round(&mut rounds, samples, renderer)?;
        self.open_again(group, samples, progress)?;
        if let Some(stop) = image.stop.clone() {
            self.store
                .write_reference(id, &ReferenceRecord { stop, needs })?;
        }
        Ok(Some(image))
    }

    /// Finds the needs of the images of a group, by id, and of images that are not in the plan any
    /// more; `None` if the run was stopped.
    fn needs(
        &mut self,
        group: &ReferenceGroup<'p>,
        rounds: &mut Rounds,
        held: &mut Held<'p>,
        renderer: &mut dyn Renderer,
    ) -> Result<Option<BTreeMap<Id, u32>>, CellFault> {
        let record = self.store.reference(rounds.id)?;
        let mut needs = record.map_or_else(BTreeMap::new, |record| record.needs);
        for radiance in &group.radiances {
            if needs.contains_key(&radiance.id) {
                continue;
            }
            if self.is_stopped() {
                return Ok(None);
            }
            let point = &radiance.cells[0].point;
            let frame = match self.frame(point, renderer) {
                Ok(frame) => frame,
                Err(CellFault::Cell(reason)) => {
                    let mut cells = radiance.cells.iter();
                    let open = cells.find(|cell| !self.is_done(cell));
                    if let Some(cell) = open.filter(|_| self.options.fail_fast) {
                        held.fatal = Some((cell, reason));
                        return Ok(None);
                    }
                    held.failures.insert(radiance.id, reason);
                    continue;
                }
                Err(fault) => return Err(fault),
            };
            let need = if is_sequence(point) {
                // Its score without noise may be far below its score.
                rounds.last()
            } else {
                self.need(&frame, rounds, renderer)?
            };
            held.keep(radiance.id, frame);
            needs.insert(radiance.id, need);
        }
        Ok(Some(needs))
    }

    /// Returns the first count that is exact enough for an image.
    fn need(
        &mut self,
        frame: &Frame,
        rounds: &mut Rounds,
        renderer: &mut dyn Renderer,
    ) -> Result<u32, CellFault> {
        let mut count = rounds.counts[0];
        while count < rounds.last() {
            let reference = self.round(rounds, count, renderer)?;
            // An image without scores fails later.
            let Ok(excess) = reference.excess_noise(&frame.radiance, rounds.share) else {
                break;
            };
            if excess <= 1.0 {
                break;
            }
            count = rounds.after(count, excess);
        }
        Ok(count)
    }

    fn round(
        &mut self,
        rounds: &mut Rounds,
        samples: u32,
        renderer: &mut dyn Renderer,
    ) -> Result<Arc<ReferenceImage>, CellFault> {
        if let Some(known) = rounds.images.get(&samples) {
            return Ok(known.clone());
        }
        let image = self.reference(rounds.id, &rounds.point, samples, renderer)?;
        rounds.images.insert(samples, image.clone());
        Ok(image)
    }

    /// Opens the cells that a reference with other samples has judged.
    fn open_again(
        &mut self,
        group: &ReferenceGroup,
        samples: u32,
        progress: &mut dyn Progress,
    ) -> Result<(), StoreError> {
        let mut stale_count = 0;
        for cell in group.cells() {
            if !self.results.is_done(cell) {
                continue;
            }
            let record = self.store.cell(cell.id)?;
            let stop = record.and_then(|record| record.judgement.reference);
            if stop.is_some_and(|stop| stop.samples != u64::from(samples)) {
                self.store.remove_record(CELLS_FOLDER, cell.id)?;
                self.results.forget(cell);
                stale_count += 1;
            }
        }
        if stale_count > 0 {
            progress.open_again(stale_count);
        }
        Ok(())
    }
}

/// Whether the image of a point is the last of a sequence of frames.
fn is_sequence(point: &Point) -> bool {
    ![Value::Unset, Value::Count(1)].contains(&point[FRAMES])
}
