//! Renders each reference and each radiance once and has every cell scored.
//!
//! The device belongs to this thread. Scores and files are made by others meanwhile, in any order; what they did is kept in the order of
//! the work, so that a record never comes before the images it stands for.
//!
//! Long because rendering, the queue and what comes back share one order, which is easiest checked in one place.

use super::{Progress, Run, RunError, milliseconds, of_cell};
use crate::files::content_hash;
use crate::metrics::{BiasVariance, Repeats};
use crate::pipeline::{DeviceInfo, Frame, FrameTimings, RenderRequest};
use crate::pixels::Rgb8Image;
use crate::runner::axis::Point;
use crate::runner::images;
use crate::runner::plan::{Cell, Plan, ReferenceGroup};
use crate::runner::renderer::Renderer;
use crate::runner::scoring::{CellFault, ReferenceImage, Rendered};
use crate::runner::store::{CellRecord, Spent, Store, StoreError};
use crate::tonemap::ToneCurve;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, Sender, SyncSender, channel, sync_channel};
use std::sync::{Arc, Mutex, OnceLock, PoisonError};
use std::time::Instant;

/// Pixels of rendered cells that may wait for their scores, some 30 bytes each: enough that the device goes on to the next reference,
/// few enough to bound memory.
const QUEUE_PIXELS: u64 = 1 << 22;
/// Cells that may wait, whatever their size.
const QUEUE_LENGTHS: std::ops::RangeInclusive<u64> = 4..=256;

/// Host work that follows a render.
enum Job<'p> {
    /// Write a linear image.
    Keep { path: PathBuf, frame: Arc<Frame> },
    /// Take the hash of a linear image that an earlier invocation wrote.
    Known { path: PathBuf },
    /// Score a cell whose images took `spent`.
    Score { rendered: Box<Rendered<'p>>, spent: Spent },
}

/// The result of a job.
enum Done<'p> {
    /// Name and content hash of an image that is there now.
    Kept(String, String),
    /// Name of an image that could not be written, for a reason of its own place, and the reason.
    Unwritten(String, String),
    /// A cell that was scored, or why it cannot be.
    Scored(&'p Cell, Box<Result<CellRecord, String>>),
}

/// The result of a job, or the fault of a file.
type Answer<'p> = Result<Done<'p>, StoreError>;

/// Where work is handed in and results come back, numbered in the order of the work.
struct Desk<'p> {
    /// Gone when all is handed in.
    jobs: Option<SyncSender<(usize, Job<'p>)>>,
    answers: Receiver<(usize, Answer<'p>)>,
    handed_in: usize,
    kept: usize,
    /// Answers that came before an earlier one.
    early: BTreeMap<usize, Done<'p>>,
}

/// The display images of a reference, by tone curve.
type ReferencePictures = Vec<(ToneCurve, Arc<Rgb8Image>)>;

impl<'p> Run<'p> {
    /// All cells that are not done.
    pub(super) fn cells(&mut self, renderer: &mut dyn Renderer, progress: &mut dyn Progress) -> Result<(), RunError> {
        let (plan, store, device) = (self.plan, self.store.clone(), renderer.device());
        let is_over = AtomicBool::new(false);
        let (jobs, queue) = sync_channel(queue_length(plan));
        let queue = Mutex::new(queue);
        let worker =
            Worker { queue: &queue, plan, store: &store, device: &device, stop: self.options.stop, is_over: &is_over };
        std::thread::scope(|scope| {
            let (results, answers) = channel();
            for _ in 0..std::thread::available_parallelism().map_or(1, usize::from) {
                let results = results.clone();
                scope.spawn(move || worker.work_off(&results));
            }
            drop(results);
            let mut desk = Desk { jobs: Some(jobs), answers, handed_in: 0, kept: 0, early: BTreeMap::new() };
            let result = plan.groups().iter().try_for_each(|group| self.group(group, renderer, &mut desk, progress));
            is_over.store(self.is_stopped() || matches!(result, Err(RunError::Store(_))), Ordering::Relaxed);
            // Without their sender the workers end when all is scored. What was rendered is kept also when the device was lost.
            desk.jobs = None;
            let rest = self.collect(&mut desk, true, progress);
            result.and(rest)
        })
    }

    /// All cells of one reference that are not done.
    fn group(
        &mut self,
        group: &ReferenceGroup<'p>,
        renderer: &mut dyn Renderer,
        desk: &mut Desk<'p>,
        progress: &mut dyn Progress,
    ) -> Result<(), RunError> {
        let todo = group.radiances.iter().flat_map(|(_, cells)| cells).find(|cell| !self.is_done(cell));
        let (Some(first), false) = (todo.copied(), self.is_stopped()) else { return Ok(()) };
        let point = self.plan.reference_point(&first.point);
        // Shared work is counted with the first cell that needs it.
        let mut spent = Spent::default();
        let reference = match of_cell(self.reference(group.id, &point, renderer, desk, &mut spent))? {
            Ok(reference) => Arc::new(reference),
            Err(reason) => {
                let cells: Vec<&Cell> = group.radiances.iter().flat_map(|(_, cells)| cells).copied().collect();
                return self.fail(&cells, &format!("its reference: {reason}"), progress);
            }
        };
        let mut reference_pictures = ReferencePictures::new();
        for (id, cells) in &group.radiances {
            let todo: Vec<&Cell> = cells.iter().copied().filter(|cell| !self.is_done(cell)).collect();
            let (Some(first), false) = (todo.first(), self.is_stopped()) else { continue };
            let rendered = match reference.rendered.as_ref().filter(|_| *id == group.id) {
                Some(frame) => Ok((frame.clone(), None)),
                None => of_cell(self.radiance(id, &first.point, &reference, renderer, desk, &mut spent))?,
            };
            let linear = Arc::new(OnceLock::new());
            for cell in todo {
                if self.is_stopped() {
                    return Ok(());
                }
                let started = Instant::now();
                let job = match &rendered {
                    Ok((frame, bias_variance)) => {
                        let pictures = self.displays(cell, frame, &reference, &mut reference_pictures, renderer);
                        of_cell(pictures)?.map(|pictures| Rendered {
                            cell,
                            frame: frame.clone(),
                            reference: reference.clone(),
                            pictures,
                            bias_variance: *bias_variance,
                            linear: linear.clone(),
                        })
                    }
                    Err(reason) => Err(reason.clone()),
                };
                spent.display_ms = milliseconds(started);
                let spent = std::mem::take(&mut spent);
                match job {
                    Ok(rendered) => desk.hand_in(Job::Score { rendered: Box::new(rendered), spent }),
                    Err(reason) => self.fail(&[cell], &reason, progress)?,
                }
                self.collect(desk, false, progress)?;
                self.write_tables_sometimes()?;
            }
        }
        Ok(())
    }

    /// The image of a cell's point with a set of the sequence.
    fn render(&self, point: &Point, set: u32, renderer: &mut dyn Renderer) -> Result<Frame, CellFault> {
        Ok(renderer.render(&RenderRequest { point_set: set, ..self.plan.request(point) })?)
    }

    /// The image of a point, and its bias and variance where the experiment asks for them.
    fn radiance(
        &mut self,
        id: &str,
        point: &Point,
        reference: &ReferenceImage,
        renderer: &mut dyn Renderer,
        desk: &mut Desk<'p>,
        spent: &mut Spent,
    ) -> Result<(Arc<Frame>, Option<BiasVariance>), CellFault> {
        let started = Instant::now();
        let frame = Arc::new(self.render(point, point.settings().point_set, renderer)?);
        spent.add(|spent| &mut spent.image_ms, &frame.timings, milliseconds(started));
        let path = self.store.image_path(&images::radiance_name(self.plan, point, id));
        desk.hand_in(Job::Keep { path, frame: frame.clone() });
        let started = Instant::now();
        let Some(repeats) = self.plan.repeats_of(point) else { return Ok((frame, None)) };
        let mut images = Repeats::new(&reference.mask)?;
        for set in 1..=repeats {
            images.add(&self.render(point, set, renderer)?.radiance)?;
        }
        let parts = images.finish(&reference.radiance, reference.standard_error.as_ref())?;
        spent.add(|spent| &mut spent.image_ms, &FrameTimings::default(), milliseconds(started));
        Ok((frame, parts))
    }

    /// Whether the image of a reference is what a finished cell was judged against, byte for byte. Without such a cell nothing vouches for
    /// the image, so that it is made again.
    fn is_as_recorded(&self, reference: &str, name: &str, path: &Path) -> Result<bool, StoreError> {
        for cell in self.plan.cells.iter().filter(|cell| cell.reference == reference) {
            if let Some(hash) = self.store.cell(&cell.id)?.and_then(|record| record.files.get(name).cloned()) {
                return Ok(content_hash(path).is_ok_and(|found| found == hash));
            }
        }
        Ok(false)
    }

    /// The reference of a group: read back where an earlier invocation left it, else rendered.
    fn reference(
        &mut self,
        id: &str,
        point: &Point,
        renderer: &mut dyn Renderer,
        desk: &mut Desk<'p>,
        spent: &mut Spent,
    ) -> Result<ReferenceImage, CellFault> {
        let name = images::radiance_name(self.plan, point, id);
        let path = self.store.image_path(&name);
        let request = self.plan.reference_request(point);
        let stop = self.store.reference(id)?;
        if self.is_as_recorded(id, &name, &path)?
            && let Some(reference) = ReferenceImage::read(&path, request.size, request.has_reference_term(), stop)
        {
            self.references_read += 1;
            desk.hand_in(Job::Known { path });
            return Ok(reference);
        }
        let started = Instant::now();
        let frame = Arc::new(renderer.render(&request)?);
        // One from the cache has no times: what it costs to make is not known from it.
        if !frame.timings.frame.is_empty() {
            spent.add(|spent| &mut spent.reference_ms, &frame.timings, milliseconds(started));
        }
        desk.hand_in(Job::Keep { path, frame: frame.clone() });
        let reference = ReferenceImage::of_frame(frame, request.reference_error);
        if let Some(stop) = &reference.stop {
            self.store.write_reference(id, stop)?;
        }
        Ok(reference)
    }

    /// The display images of a cell and its reference.
    fn displays(
        &mut self,
        cell: &Cell,
        frame: &Frame,
        reference: &ReferenceImage,
        reference_pictures: &mut ReferencePictures,
        renderer: &mut dyn Renderer,
    ) -> Result<[Arc<Rgb8Image>; 2], CellFault> {
        let curve = cell.point.settings().curve;
        let test = Arc::new(renderer.tonemap(&frame.radiance, curve)?);
        if let Some((_, picture)) = reference_pictures.iter().find(|(known, _)| *known == curve) {
            return Ok([test, picture.clone()]);
        }
        let of_reference = Arc::new(renderer.tonemap(&reference.radiance, curve)?);
        reference_pictures.push((curve, of_reference.clone()));
        Ok([test, of_reference])
    }

    /// Keeps what came back, in the order of the work; `to_the_end` waits until the workers are gone.
    fn collect(&mut self, desk: &mut Desk<'p>, to_the_end: bool, progress: &mut dyn Progress) -> Result<(), RunError> {
        loop {
            let answer = if to_the_end { desk.answers.recv().ok() } else { desk.answers.try_recv().ok() };
            let Some((number, answer)) = answer else { return Ok(()) };
            desk.early.insert(number, answer?);
            while let Some(done) = desk.early.remove(&desk.kept) {
                desk.kept += 1;
                self.keep(done, progress)?;
            }
        }
    }

    /// Keeps a cell. After a stop it is dropped, so that the user never waits for more than the current one.
    fn keep(&mut self, done: Done<'p>, progress: &mut dyn Progress) -> Result<(), RunError> {
        let (cell, scored) = match done {
            Done::Kept(name, hash) => {
                self.file_hashes.insert(name, hash);
                return Ok(());
            }
            Done::Unwritten(name, reason) => {
                self.unwritten.insert(name, reason);
                return Ok(());
            }
            Done::Scored(cell, scored) => (cell, scored),
        };
        if self.is_stopped() {
            return Ok(());
        }
        match *scored {
            Ok(mut record) => {
                // Images come before the first cell that they belong to, and the cells of a reference together: other names are over.
                let linear = images::linear_files(self.plan, cell);
                if let Some(reason) = linear.iter().find_map(|name| self.unwritten.get(name).cloned()) {
                    return self.fail(&[cell], &reason, progress);
                }
                self.file_hashes.retain(|name, _| linear.contains(name));
                record.files.extend(self.file_hashes.clone());
                self.store.write_cell(&record)?;
                self.remember(record);
                progress.step(&self.plan.label(cell), None);
                Ok(())
            }
            Err(reason) => self.fail(&[cell], &reason, progress),
        }
    }
}

impl<'p> Desk<'p> {
    /// Waits while the queue is full. Workers that are gone have panicked, and the scope passes that on.
    fn hand_in(&mut self, job: Job<'p>) {
        let _ = self.jobs.as_ref().map(|jobs| jobs.send((self.handed_in, job)));
        self.handed_in += 1;
    }
}

fn queue_length(plan: &Plan) -> usize {
    let pixels = |cell: &Cell| plan.size_of(cell).iter().map(|&side| u64::from(side)).product::<u64>();
    let largest = plan.cells.iter().map(pixels).max().unwrap_or(1);
    (QUEUE_PIXELS / largest).clamp(*QUEUE_LENGTHS.start(), *QUEUE_LENGTHS.end()) as usize
}

/// The state of each of the other threads.
#[derive(Clone, Copy)]
struct Worker<'w, 'p> {
    queue: &'w Mutex<Receiver<(usize, Job<'p>)>>,
    plan: &'p Plan,
    store: &'w Store,
    device: &'w DeviceInfo,
    stop: &'w AtomicBool,
    /// Set when a file could not be written: then the run ends.
    is_over: &'w AtomicBool,
}

impl<'p> Worker<'_, 'p> {
    /// Does jobs until there are none or the run ends.
    fn work_off(&self, answers: &Sender<(usize, Answer<'p>)>) {
        loop {
            let job = self.queue.lock().unwrap_or_else(PoisonError::into_inner).recv();
            let Ok((number, job)) = job else { return };
            // Answers after a stop would be dropped: nobody waits for them.
            if self.stop.load(Ordering::Relaxed) || self.is_over.load(Ordering::Relaxed) {
                continue;
            }
            let answer = self.answer(job);
            if answer.is_err() {
                self.is_over.store(true, Ordering::Relaxed);
            }
            if answers.send((number, answer)).is_err() {
                return;
            }
        }
    }

    /// Whether a fault is that of the place of one of a cell's pictures, so that others can be written.
    fn is_of_a_picture(&self, error: &StoreError, cell: &Cell) -> bool {
        let mut pictures = images::pictures(self.plan, cell).into_iter().map(|name| self.store.image_path(&name));
        pictures.any(|path| error.is_of_one_place(&path))
    }

    fn answer(&self, job: Job<'p>) -> Answer<'p> {
        match job {
            Job::Keep { path, frame } => match images::write_radiance(&path, &frame).map_err(StoreError::from) {
                Ok(()) => hashed(path),
                Err(error) if error.is_of_one_place(&path) => Ok(Done::Unwritten(file_name(&path), error.to_string())),
                Err(error) => Err(error),
            },
            Job::Known { path } => hashed(path),
            Job::Score { rendered, mut spent } => {
                let started = Instant::now();
                let scored = match rendered.score(self.plan, self.store, self.device) {
                    Ok(record) => {
                        spent.score_ms = milliseconds(started);
                        Ok(CellRecord { spent, ..record })
                    }
                    Err(CellFault::Cell(reason) | CellFault::Lost(reason)) => Err(reason),
                    Err(CellFault::Store(error)) => match self.is_of_a_picture(&error, rendered.cell) {
                        true => Err(error.to_string()),
                        false => return Err(error),
                    },
                };
                Ok(Done::Scored(rendered.cell, Box::new(scored)))
            }
        }
    }
}

fn file_name(path: &Path) -> String {
    path.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default()
}

fn hashed<'p>(path: PathBuf) -> Answer<'p> {
    match content_hash(&path) {
        Ok(hash) => Ok(Done::Kept(file_name(&path), hash)),
        Err(error) => Err(StoreError::Io { path, error }),
    }
}
