//! Renders each reference and each radiance once and has every cell scored.
//!
//! The device belongs to this thread; scores and files are made on a second one meanwhile, in the order of the work.

use super::{Progress, Run, RunError, cell_result, milliseconds};
use crate::experiment::axis::Point;
use crate::experiment::images;
use crate::experiment::plan::{Cell, Plan, ReferenceGroup};
use crate::experiment::renderer::Renderer;
use crate::experiment::scoring::{ReferenceImage, Rendered, ScoreFault};
use crate::experiment::store::{CellRecord, Store, StoreError};
use crate::metrics::{BiasVariance, Repeats};
use crate::pipeline::{DeviceInfo, Frame, RenderRequest};
use crate::pixels::Rgb8Image;
use crate::tonemap::ToneCurve;
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::mpsc::{Receiver, Sender, SyncSender, channel, sync_channel};
use std::time::Instant;

/// Rendered cells that may wait for their scores: enough to keep both threads busy, few enough to bound memory.
const QUEUE_LENGTH: usize = 4;

/// Host work that follows a render.
enum Job<'p> {
    /// Write a linear image.
    Keep { path: PathBuf, frame: Arc<Frame> },
    /// Score a cell whose images took `device_ms`.
    Score { rendered: Box<Rendered<'p>>, device_ms: f64 },
}

/// A cell that was scored, or the fault of a file.
type Answer<'p> = Result<(&'p Cell, Result<CellRecord, String>), StoreError>;

/// Where work is handed in and results come back.
struct Desk<'p> {
    jobs: SyncSender<Job<'p>>,
    answers: Receiver<Answer<'p>>,
}

/// The display images of a reference, by tone curve.
type ReferencePictures = Vec<(ToneCurve, Arc<Rgb8Image>)>;

impl<'p> Run<'p> {
    /// All cells that are not done.
    pub(super) fn cells(&mut self, renderer: &mut dyn Renderer, progress: &mut dyn Progress) -> Result<(), RunError> {
        let (plan, store, device) = (self.plan, self.store.clone(), renderer.device());
        std::thread::scope(|scope| {
            let (jobs, queue) = sync_channel(QUEUE_LENGTH);
            let (results, answers) = channel();
            scope.spawn(move || work_off(queue, &results, plan, &store, &device));
            let desk = Desk { jobs, answers };
            let result = plan.groups().iter().try_for_each(|group| self.group(group, renderer, &desk, progress));
            // Without its sender the second thread ends when all is scored. What was rendered is kept also when the device was lost.
            drop(desk.jobs);
            let rest = desk.answers.iter().try_for_each(|answer| self.keep(answer, progress));
            result.and(rest)
        })
    }

    /// All cells of one reference that are not done.
    fn group(
        &mut self,
        group: &ReferenceGroup<'p>,
        renderer: &mut dyn Renderer,
        desk: &Desk<'p>,
        progress: &mut dyn Progress,
    ) -> Result<(), RunError> {
        let started = Instant::now();
        let todo = group.radiances.iter().flat_map(|(_, cells)| cells).find(|cell| !self.is_done(cell));
        let (Some(first), false) = (todo.copied(), self.is_stopped()) else { return Ok(()) };
        let point = self.plan.reference_point(&first.point);
        let reference = match self.reference(group.id, &point, renderer, desk)? {
            Ok(reference) => Arc::new(reference),
            Err(reason) => {
                let cells: Vec<&Cell> = group.radiances.iter().flat_map(|(_, cells)| cells).copied().collect();
                return self.fail(&cells, &format!("its reference: {reason}"), progress);
            }
        };
        let mut reference_pictures = ReferencePictures::new();
        // Shared work is counted with the first cell that needs it.
        let mut device_ms = milliseconds(started);
        for (id, cells) in &group.radiances {
            let todo: Vec<&Cell> = cells.iter().copied().filter(|cell| !self.is_done(cell)).collect();
            let (Some(first), false) = (todo.first(), self.is_stopped()) else { continue };
            let started = Instant::now();
            let rendered = match reference.rendered.as_ref().filter(|_| *id == group.id) {
                Some(frame) => Ok((frame.clone(), None)),
                None => self.radiance(id, &first.point, &reference, renderer, desk)?,
            };
            device_ms += milliseconds(started);
            for cell in todo {
                if self.is_stopped() {
                    return Ok(());
                }
                let started = Instant::now();
                let job = match &rendered {
                    Ok((frame, bias_variance)) => self
                        .displays(cell, frame, &reference, &mut reference_pictures, renderer)?
                        .map(|pictures| Rendered {
                            cell,
                            frame: frame.clone(),
                            reference: reference.clone(),
                            pictures,
                            bias_variance: *bias_variance,
                        }),
                    Err(reason) => Err(reason.clone()),
                };
                device_ms += milliseconds(started);
                match job {
                    Ok(rendered) => desk.hand_in(Job::Score { rendered: Box::new(rendered), device_ms }),
                    Err(reason) => self.fail(&[cell], &reason, progress)?,
                }
                device_ms = 0.0;
                desk.answers.try_iter().try_for_each(|answer| self.keep(answer, progress))?;
                self.write_tables_sometimes()?;
            }
        }
        Ok(())
    }

    /// Renders a point. The outer error ends the run, the inner one fails the cells that need the image.
    fn render(
        &mut self,
        point: &Point,
        set: u32,
        renderer: &mut dyn Renderer,
    ) -> Result<Result<Frame, String>, RunError> {
        let request = self.plan.request(point);
        let request = if set == 0 { request } else { RenderRequest { point_set: set, ..request } };
        let started = Instant::now();
        let result = renderer.render(&request);
        self.device_ms += milliseconds(started);
        cell_result(result)
    }

    /// The image of a point, and its bias and variance where the experiment asks for them.
    #[allow(clippy::type_complexity, reason = "two levels of failure: the run's and the cell's")]
    fn radiance(
        &mut self,
        id: &str,
        point: &Point,
        reference: &ReferenceImage,
        renderer: &mut dyn Renderer,
        desk: &Desk<'p>,
    ) -> Result<Result<(Arc<Frame>, Option<BiasVariance>), String>, RunError> {
        let frame = match self.render(point, point.settings().point_set, renderer)? {
            Ok(frame) => Arc::new(frame),
            Err(reason) => return Ok(Err(reason)),
        };
        let path = self.store.image_path(&images::radiance_name(self.plan, point, id));
        desk.hand_in(Job::Keep { path, frame: frame.clone() });
        let Some(repeats) = self.plan.repeats_of(point) else { return Ok(Ok((frame, None))) };
        let mut images = match Repeats::new(&reference.mask) {
            Ok(images) => images,
            Err(error) => return Ok(Err(error.to_string())),
        };
        for set in 1..=repeats {
            let added = match self.render(point, set, renderer)? {
                Ok(frame) => images.add(&frame.radiance).map_err(|error| error.to_string()),
                Err(reason) => Err(reason),
            };
            if let Err(reason) = added {
                return Ok(Err(reason));
            }
        }
        let parts = images.finish(&reference.radiance, reference.standard_error.as_ref());
        Ok(parts.map(|parts| (frame, parts)).map_err(|error| error.to_string()))
    }

    /// The reference of a group: read back where an earlier invocation left it, else rendered.
    fn reference(
        &mut self,
        id: &str,
        point: &Point,
        renderer: &mut dyn Renderer,
        desk: &Desk<'p>,
    ) -> Result<Result<ReferenceImage, String>, RunError> {
        let path = self.store.image_path(&images::radiance_name(self.plan, point, id));
        let request = self.plan.request(point);
        let stop = self.store.reference(id)?;
        if let Some(reference) = ReferenceImage::read(&path, request.size, request.has_reference_term(), stop) {
            self.references_read += 1;
            return Ok(Ok(reference));
        }
        let frame = match self.render(point, 0, renderer)? {
            Ok(frame) => Arc::new(frame),
            Err(reason) => return Ok(Err(reason)),
        };
        desk.hand_in(Job::Keep { path, frame: frame.clone() });
        let reference = ReferenceImage::of_frame(frame, request.reference_error);
        if let Some(stop) = &reference.stop {
            self.store.write_reference(id, stop)?;
        }
        Ok(Ok(reference))
    }

    /// The display images of a cell and its reference.
    fn displays(
        &mut self,
        cell: &Cell,
        frame: &Frame,
        reference: &ReferenceImage,
        reference_pictures: &mut ReferencePictures,
        renderer: &mut dyn Renderer,
    ) -> Result<Result<[Arc<Rgb8Image>; 2], String>, RunError> {
        let curve = cell.point.settings().curve;
        let started = Instant::now();
        let mut picture = |radiance| cell_result(renderer.tonemap(radiance, curve)).map(|r| r.map(Arc::new));
        let test = picture(&frame.radiance)?;
        let of_reference = match reference_pictures.iter().find(|(known, _)| *known == curve) {
            Some((_, picture)) => Ok(picture.clone()),
            None => picture(&reference.radiance)?,
        };
        self.device_ms += milliseconds(started);
        Ok(test.and_then(|test| {
            let of_reference = of_reference?;
            if reference_pictures.iter().all(|(known, _)| *known != curve) {
                reference_pictures.push((curve, of_reference.clone()));
            }
            Ok([test, of_reference])
        }))
    }

    /// Keeps what came back. After a stop it is dropped, so that the user never waits for more than the current cell.
    fn keep(&mut self, answer: Answer<'p>, progress: &mut dyn Progress) -> Result<(), RunError> {
        let (cell, scored) = answer?;
        if self.is_stopped() {
            return Ok(());
        }
        match scored {
            Ok(record) => {
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
    /// Waits while the queue is full. A second thread that is gone has panicked, and the scope passes that on.
    fn hand_in(&self, job: Job<'p>) {
        let _ = self.jobs.send(job);
    }
}

/// The second thread: does the jobs in order, until a file cannot be written.
fn work_off<'p>(
    queue: Receiver<Job<'p>>,
    answers: &Sender<Answer<'p>>,
    plan: &Plan,
    store: &Store,
    device: &DeviceInfo,
) {
    for job in queue {
        let answer = match job {
            Job::Keep { path, frame } => match images::write_radiance(&path, &frame) {
                Ok(()) => continue,
                Err(error) => Err(error.into()),
            },
            Job::Score { rendered, device_ms } => {
                let started = Instant::now();
                match rendered.score(plan, store, device) {
                    Ok(record) => {
                        let wall_ms = device_ms + milliseconds(started);
                        Ok((rendered.cell, Ok(CellRecord { wall_ms, ..record })))
                    }
                    Err(ScoreFault::Cell(reason)) => Ok((rendered.cell, Err(reason))),
                    Err(ScoreFault::Store(error)) => Err(error),
                }
            }
        };
        let is_over = answer.is_err();
        if answers.send(answer).is_err() || is_over {
            return;
        }
    }
}
