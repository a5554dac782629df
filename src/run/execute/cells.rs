//! Renders each reference and each image once and scores every cell.
//!
//! The device belongs to this thread. Other threads make scores and files, in any order; the record
//! of a cell is written after its files.

use super::references::Held;
use super::{Progress, Run, RunError, of_cell};
use crate::base::files::content_hash;
use crate::base::pixels::Rgb8Image;
use crate::experiment::axis::Point;
use crate::experiment::id::Id;
use crate::experiment::plan::{Cell, Plan, ReferenceGroup};
use crate::instrument::ladder::BANDS;
use crate::instrument::pipeline::{DeviceInfo, Frame};
use crate::instrument::tonemap::ToneCurve;
use crate::run::cell_fault::CellFault;
use crate::run::images;
use crate::run::reference_image::ReferenceImage;
use crate::run::renderer::Renderer;
use crate::run::scoring::{Judge, Rendered};
use crate::run::store::{CellRecord, ReferenceRecord, StepRecord, StopReason, Store, StoreError};
use std::collections::BTreeMap;
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, Sender, SyncSender, channel, sync_channel};
use std::sync::{Arc, Mutex, PoisonError};

/// Most pixels of rendered cells that wait for their scores, about 30 bytes each.
const QUEUE_PIXELS: u64 = 1 << 22;
/// Limits of the number of waiting cells.
const QUEUE_LENGTHS: std::ops::RangeInclusive<u64> = 4..=256;

type Scored<'p> = (&'p Cell, Result<CellRecord, CellFault>);

/// The channels to and from the threads that score.
struct Desk<'p> {
    /// `None` at the end.
    jobs: Option<SyncSender<Rendered<'p>>>,
    answers: Receiver<Scored<'p>>,
}

struct Made {
    frame: Arc<Frame>,
    steps: Arc<Vec<StepRecord>>,
}

/// The reference of a group of cells.
struct GroupReference {
    image: Arc<ReferenceImage>,
    /// Its display images by tone curve.
    pictures: Vec<(ToneCurve, Arc<Rgb8Image>)>,
}

impl<'p> Run<'p> {
    pub(super) fn cells(
        &mut self,
        renderer: &mut dyn Renderer,
        progress: &mut dyn Progress,
    ) -> Result<(), RunError> {
        let plan = self.plan;
        let store = self.store.clone();
        let device = renderer.device();
        let is_over = AtomicBool::new(false);
        let (jobs, queue) = sync_channel(queue_length(plan));
        let queue = Mutex::new(queue);
        let worker = Worker {
            queue: &queue,
            plan,
            store: &store,
            device: &device,
            stop: self.options.stop,
            is_over: &is_over,
        };
        std::thread::scope(|scope| {
            let (results, answers) = channel();
            for _ in 0..std::thread::available_parallelism().map_or(1, usize::from) {
                let results = results.clone();
                scope.spawn(move || worker.work_off(&results));
            }
            drop(results);
            let mut desk = Desk {
                jobs: Some(jobs),
                answers,
            };
            let result = plan
                .groups()
                .iter()
                .try_for_each(|group| self.group(group, renderer, &mut desk, progress));
            is_over.store(
                self.is_stopped() || matches!(result, Err(RunError::Store(_))),
                Ordering::Relaxed,
            );
            // Without the sender the workers end. Rendered cells are kept even if the device was
            // lost.
            desk.jobs = None;
            let rest = self.collect(&mut desk, true, progress);
            result.and(rest)
        })
    }

    /// Renders the open cells of one reference, or of one image without reference.
    fn group(
        &mut self,
        group: &ReferenceGroup<'p>,
        renderer: &mut dyn Renderer,
        desk: &mut Desk<'p>,
        progress: &mut dyn Progress,
    ) -> Result<(), RunError> {
        let cells: Vec<&Cell> = group.cells().collect();
        if self.open_cells(&cells).is_empty() || self.is_stopped() {
            return Ok(());
        }
        let mut held = Held::default();
        let mut reference = None;
        if let Some(id) = group.reference {
            match of_cell(self.group_reference(id, group, &mut held, renderer, progress))? {
                Ok(Some(image)) => {
                    let pictures = Vec::new();
                    reference = Some(GroupReference { image, pictures });
                }
                Ok(None) => {
                    let fatal = held.fatal.take();
                    return fatal.map_or(Ok(()), |(cell, reason)| {
                        self.fail(&[cell], &reason, progress)
                    });
                }
                Err(reason) => {
                    return self.fail(&cells, &format!("its reference: {reason}"), progress);
                }
            }
        }
        for radiance in &group.radiances {
            let open = self.open_cells(&radiance.cells);
            let Some(first) = open.first() else {
                continue;
            };
            if self.is_stopped() {
                return Ok(());
            }
            let of_group = reference
                .as_ref()
                .and_then(|reference| reference.image.rendered.as_ref());
            let rendered = match of_group.filter(|_| Some(radiance.id) == group.reference) {
                Some(frame) => Ok(Made {
                    frame: frame.clone(),
                    steps: Arc::default(),
                }),
                None => {
                    let known = held.take(radiance.id);
                    of_cell(self.made(&first.point, known, renderer))?
                }
            };
            self.image(
                &open,
                &rendered,
                reference.as_mut(),
                renderer,
                desk,
                progress,
            )?;
        }
        Ok(())
    }

    /// Hands in the cells that share an image, or notes that they failed.
    fn image(
        &mut self,
        cells: &[&'p Cell],
        rendered: &Result<Made, String>,
        mut reference: Option<&mut GroupReference>,
        renderer: &mut dyn Renderer,
        desk: &mut Desk<'p>,
        progress: &mut dyn Progress,
    ) -> Result<(), RunError> {
        let linear = Arc::default();
        for &cell in cells {
            if self.is_stopped() {
                return Ok(());
            }
            let Made { frame, steps } = match rendered {
                Ok(made) => made,
                Err(reason) => {
                    self.fail(&[cell], reason, progress)?;
                    continue;
                }
            };
            let pictures = self.displays(cell, frame, reference.as_deref_mut(), renderer);
            match of_cell(pictures)? {
                Ok((picture, judge)) => desk.hand_in(Rendered {
                    cell,
                    frame: frame.clone(),
                    picture,
                    judge,
                    steps: steps.clone(),
                    linear: Arc::clone(&linear),
                }),
                Err(reason) => self.fail(&[cell], &reason, progress)?,
            }
            self.collect(desk, false, progress)?;
        }
        Ok(())
    }

    fn open_cells(&self, cells: &[&'p Cell]) -> Vec<&'p Cell> {
        let open = cells.iter().copied().filter(|cell| !self.is_done(cell));
        open.collect()
    }

    /// Renders a point.
    pub(super) fn frame(
        &self,
        point: &Point,
        renderer: &mut dyn Renderer,
    ) -> Result<Arc<Frame>, CellFault> {
        Ok(Arc::new(renderer.render(&self.plan.request(point))?))
    }

    /// Renders a point, unless its frame or why it failed is `known`, with its ladder if the
    /// experiment asks for it.
    fn made(
        &self,
        point: &Point,
        known: Option<Result<Arc<Frame>, String>>,
        renderer: &mut dyn Renderer,
    ) -> Result<Made, CellFault> {
        let frame = match known {
            Some(frame) => frame.map_err(CellFault::Cell)?,
            None => self.frame(point, renderer)?,
        };
        let mut made = Made {
            frame,
            steps: Arc::default(),
        };
        if let Some(samples) = self.plan.ladder_of(point) {
            let request = self.plan.request(point);
            let steps = renderer.attributions(&request, samples, &BANDS)?;
            made.steps = Arc::new(StepRecord::of_attributions(&steps));
        }
        Ok(made)
    }

    /// Whether the image of a reference is the one that a finished cell was compared with, byte for
    /// byte. Without such a cell it is rendered again.
    fn is_as_recorded(&self, reference: Id, name: &str, path: &Path) -> Result<bool, StoreError> {
        for cell in self
            .plan
            .cells
            .iter()
            .filter(|cell| cell.reference == Some(reference))
        {
            if let Some(hash) = self
                .store
                .cell(cell.id)?
                .and_then(|record| record.files.get(name).cloned())
            {
                return Ok(content_hash(path).is_ok_and(|found| found == hash));
            }
        }
        Ok(false)
    }

    /// Reads a reference with at most `samples` a pixel back, or renders it. The record of an exact
    /// one is written.
    pub(super) fn reference(
        &mut self,
        id: Id,
        point: &Point,
        samples: u32,
        renderer: &mut dyn Renderer,
    ) -> Result<Arc<ReferenceImage>, CellFault> {
        let name = images::radiance_name(point, id);
        let path = self.store.image_path(&name);
        let request = self.plan.reference_round(point, samples);
        let is_exact = self.plan.reference_counts(point).len() == 1;
        let record = self.store.reference(id)?;
        let stop = record.map(|record| record.stop);
        let has_samples = stop
            .as_ref()
            .is_some_and(|stop| stop.samples == u64::from(samples));
        if (is_exact || has_samples)
            && self.is_as_recorded(id, &name, &path)?
            && let Some(reference) = ReferenceImage::read(&path, &request, stop)
        {
            return Ok(Arc::new(reference));
        }
        let frame = Arc::new(renderer.render(&request)?);
        let mut reference = ReferenceImage::of_frame(frame, &request);
        if let Some(stop) = &mut reference.stop {
            let stated = self.plan.config.reference.samples;
            if !is_exact && samples < stated {
                stop.stopped_by = StopReason::NoiseShare;
            }
            if is_exact {
                let needs = BTreeMap::new();
                let stop = stop.clone();
                self.store
                    .write_reference(id, &ReferenceRecord { stop, needs })?;
            }
        }
        Ok(Arc::new(reference))
    }

    /// The display image of a cell, and the reference with its own.
    fn displays(
        &mut self,
        cell: &Cell,
        frame: &Frame,
        reference: Option<&mut GroupReference>,
        renderer: &mut dyn Renderer,
    ) -> Result<(Arc<Rgb8Image>, Option<Judge>), CellFault> {
        let curve = cell.point.settings().curve;
        let picture = Arc::new(renderer.tonemap(&frame.radiance, curve)?);
        let Some(reference) = reference else {
            return Ok((picture, None));
        };
        let mut known = reference.pictures.iter();
        let reference_picture = match known.find(|(known, _)| *known == curve) {
            Some((_, reference_picture)) => reference_picture.clone(),
            None => {
                let made = Arc::new(renderer.tonemap(&reference.image.radiance, curve)?);
                reference.pictures.push((curve, made.clone()));
                made
            }
        };
        let judge = Judge {
            image: reference.image.clone(),
            picture: reference_picture,
        };
        Ok((picture, Some(judge)))
    }

    /// Stores scored cells; `to_the_end` waits until the workers end.
    fn collect(
        &mut self,
        desk: &mut Desk<'p>,
        to_the_end: bool,
        progress: &mut dyn Progress,
    ) -> Result<(), RunError> {
        loop {
            let answer = if to_the_end {
                desk.answers.recv().ok()
            } else {
                desk.answers.try_recv().ok()
            };
            let Some((cell, scored)) = answer else {
                return Ok(());
            };
            let scored = of_cell(scored)?;
            // Dropped after a stop: the user waits for the current cell only.
            if self.is_stopped() {
                continue;
            }
            match scored {
                Ok(record) => {
                    self.store.write_cell(&record)?;
                    self.remember(cell);
                    progress.step(&self.plan.label(cell), None, self.ahead());
                }
                Err(reason) => self.fail(&[cell], &reason, progress)?,
            }
        }
    }
}

impl<'p> Desk<'p> {
    /// Waits while the queue is full. If the workers panicked, the scope propagates it.
    fn hand_in(&self, rendered: Rendered<'p>) {
        if let Some(jobs) = &self.jobs {
            let _ = jobs.send(rendered);
        }
    }
}

fn queue_length(plan: &Plan) -> usize {
    let pixels = |cell: &Cell| {
        plan.size_of(cell)
            .iter()
            .map(|&side| u64::from(side))
            .product::<u64>()
    };
    let largest = plan.cells.iter().map(pixels).max().unwrap_or(1);
    (QUEUE_PIXELS / largest).clamp(*QUEUE_LENGTHS.start(), *QUEUE_LENGTHS.end()) as usize
}

/// A thread that scores.
#[derive(Clone, Copy)]
struct Worker<'w, 'p> {
    queue: &'w Mutex<Receiver<Rendered<'p>>>,
    plan: &'p Plan,
    store: &'w Store,
    device: &'w DeviceInfo,
    stop: &'w AtomicBool,
    /// Set if a file could not be written: the run ends.
    is_over: &'w AtomicBool,
}

impl<'p> Worker<'_, 'p> {
    fn work_off(&self, answers: &Sender<Scored<'p>>) {
        loop {
            let rendered = self
                .queue
                .lock()
                .unwrap_or_else(PoisonError::into_inner)
                .recv();
            let Ok(rendered) = rendered else { return };
            if self.stop.load(Ordering::Relaxed) || self.is_over.load(Ordering::Relaxed) {
                continue;
            }
            let scored = rendered.score(self.plan, self.store, self.device);
            if matches!(scored, Err(CellFault::Store(_))) {
                self.is_over.store(true, Ordering::Relaxed);
            }
            if answers.send((rendered.cell, scored)).is_err() {
                return;
            }
        }
    }
}
