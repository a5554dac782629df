//! The renderer's thread. It takes the newest state, shows it coarsely if the whole takes long,
//! then whole, then refines the reference until the state changes.

mod shoot;

use super::shown::{Shot, Shown, Status};
use super::state::{Image, Inputs, Side, State};
use crate::experiment::axis::motion_fault;
use crate::instrument::environment::{Environment, LoadOptions};
use crate::instrument::gpu::{Gpu, lock};
use crate::instrument::pipeline::{Frame, Options, Pipeline, PipelineError, Recent};
use crate::instrument::scene::{Camera, CameraKind, MaterialOverride, Scene};
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Condvar, Mutex, OnceLock, PoisonError};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

/// Times between which the resolution of a moving picture stays, ms; half the side takes a quarter
/// of the time.
const COARSE_MS: std::ops::Range<f64> = 15.0..120.0;
/// A first picture that takes longer, because of its tables, is dropped for the next state.
const PATIENCE: Duration = Duration::from_secs(5);
/// Divisor of the coarsest resolution.
const COARSEST: u32 = 8;
/// Frames that are kept in memory.
const KEPT: usize = 8;

#[derive(Default)]
struct Post {
    state: Mutex<Option<(u64, State)>>,
    shown: Mutex<Shown>,
    is_closed: AtomicBool,
    arrived: Condvar,
    /// Start of work on the current state.
    begun: Mutex<Option<Instant>>,
    /// Ends refinement.
    interrupt: Arc<AtomicBool>,
    /// Ends first pictures, too.
    is_overdue: Arc<AtomicBool>,
    /// The device, once it is open.
    gpu: OnceLock<Gpu>,
    /// Whether pictures stay on the device.
    is_painted_on_device: AtomicBool,
}

pub struct Worker {
    post: Arc<Post>,
    thread: Option<JoinHandle<()>>,
}

impl Worker {
    /// Starts the thread, which opens the device and calls `wake` at each update.
    pub fn start(
        options: Options,
        load: LoadOptions,
        wake: impl Fn() + Send + 'static,
    ) -> std::io::Result<Self> {
        let post = Arc::new(Post::default());
        let theirs = post.clone();
        let work = move || {
            let outcome = std::panic::catch_unwind(std::panic::AssertUnwindSafe(|| {
                Renderer::run(&theirs, options, load, &wake)
            }));
            let status = match outcome {
                Ok(Ok(())) => return,
                Ok(Err(error)) if error.is_transient() => Status::Lost(error.to_string()),
                Ok(Err(error)) => Status::Failed(error.to_string()),
                Err(_) => {
                    Status::Failed("the renderer failed because of a bug in splitsum".to_owned())
                }
            };
            lock(&theirs.shown).status = status;
            wake();
        };
        let thread = std::thread::Builder::new()
            .name("renderer".to_owned())
            .spawn(work)?;
        Ok(Self {
            post,
            thread: Some(thread),
        })
    }

    pub fn ask(&self, generation: u64, state: State) {
        // The renderer takes the state and lowers the flags under the same lock.
        let mut held = lock(&self.post.state);
        *held = Some((generation, state));
        self.post.interrupt.store(true, Ordering::Relaxed);
        if lock(&self.post.begun).is_some_and(|begun| begun.elapsed() > PATIENCE) {
            self.post.is_overdue.store(true, Ordering::Relaxed);
        }
        self.post.arrived.notify_one();
    }

    /// Returns the device, once it is open.
    pub fn gpu(&self) -> Option<&Gpu> {
        self.post.gpu.get()
    }

    /// Leaves the pictures of all later states on the device.
    pub fn paint_on_device(&self) {
        self.post
            .is_painted_on_device
            .store(true, Ordering::Relaxed);
    }

    pub fn shown(&self) -> Shown {
        lock(&self.post.shown).clone()
    }

    /// Ends the thread. Returns the messages of the validation layer, if it was asked for.
    pub fn close(&mut self) -> Vec<String> {
        {
            let _held = lock(&self.post.state);
            for flag in [
                &self.post.is_closed,
                &*self.post.interrupt,
                &*self.post.is_overdue,
            ] {
                flag.store(true, Ordering::Relaxed);
            }
            self.post.arrived.notify_one();
        }
        // A panic was reported already.
        self.thread.take().map(JoinHandle::join);
        self.gpu().map(Gpu::validation_messages).unwrap_or_default()
    }
}

impl Drop for Worker {
    fn drop(&mut self) {
        self.close();
    }
}

struct Renderer<'a> {
    post: &'a Post,
    wake: &'a dyn Fn(),
    gpu: Gpu,
    pipeline: Pipeline,
    load: LoadOptions,
    environment: Option<Loaded<Environment>>,
    scene: Option<Loaded<Scene>>,
    framed: Option<FramedScene>,
    kept: Recent<Image, Arc<Frame>>,
    shown: Shown,
    /// Divisor of the resolution while the state changes.
    coarse: u32,
}

/// An environment or scene with its name.
struct Loaded<T> {
    name: String,
    content: Arc<T>,
}

/// The scene with a material, and its camera before it orbits.
#[derive(Clone)]
struct FramedScene {
    framing: Framing,
    scene: Arc<Scene>,
    camera: Camera,
}

/// The settings that a [`FramedScene`] depends on.
#[derive(Clone, PartialEq)]
struct Framing {
    material: MaterialOverride,
    camera: CameraKind,
    size: [u32; 2],
}

enum Stop {
    Refused(String),
    Broken(PipelineError),
}

impl From<PipelineError> for Stop {
    fn from(error: PipelineError) -> Self {
        Self::Broken(error)
    }
}

impl<'a> Renderer<'a> {
    fn run(
        post: &'a Post,
        options: Options,
        load: LoadOptions,
        wake: &'a dyn Fn(),
    ) -> Result<(), PipelineError> {
        let gpu = Gpu::new(Options {
            is_interactive: true,
            ..options
        })?;
        let gpu = post.gpu.get_or_init(|| gpu).clone();
        wake();
        let pipeline = Pipeline::on(gpu.clone())?;
        let shown = Shown {
            device: Some(pipeline.device().clone()),
            ..Shown::default()
        };
        let kept = Recent::weighed(KEPT, |frame: &Arc<Frame>| frame.bytes());
        let mut renderer = Self {
            post,
            wake,
            gpu,
            pipeline,
            load,
            environment: None,
            scene: None,
            framed: None,
            kept,
            shown,
            coarse: COARSEST,
        };
        while let Some((generation, state)) = renderer.next() {
            renderer.shown.generation = generation;
            let status = match renderer.show(&state) {
                Ok(()) => Status::Done,
                Err(Stop::Refused(why)) => Status::Refused(why),
                Err(Stop::Broken(error)) if error.is_interrupted() => continue,
                Err(Stop::Broken(error)) if error.is_transient() => return Err(error),
                Err(Stop::Broken(error)) => Status::Refused(error.to_string()),
            };
            renderer.set_status(status);
        }
        renderer.set_status(Status::Done);
        Ok(())
    }

    /// Waits for the next state; `None` if the window is closed.
    fn next(&self) -> Option<(u64, State)> {
        let mut state = lock(&self.post.state);
        loop {
            if self.post.is_closed.load(Ordering::Relaxed) {
                self.pipeline.interrupt_by(None);
                return None;
            }
            if let Some(next) = state.take() {
                self.post.interrupt.store(false, Ordering::Relaxed);
                self.post.is_overdue.store(false, Ordering::Relaxed);
                *lock(&self.post.begun) = Some(Instant::now());
                return Some(next);
            }
            state = self
                .post
                .arrived
                .wait(state)
                .unwrap_or_else(PoisonError::into_inner);
        }
    }

    fn set_status(&mut self, status: Status) {
        self.shown.status = status;
        lock(&self.post.shown).clone_from(&self.shown);
        (self.wake)();
    }

    fn show(&mut self, state: &State) -> Result<(), Stop> {
        let inputs = &self.inputs(state)?;
        if let Some(fault) = motion_fault(&state.point.collapsed(), false) {
            return Err(Stop::Refused(format!("motion: {fault}")));
        }
        self.pipeline
            .interrupt_by(Some(self.post.is_overdue.clone()));
        let counts = state.counts();
        self.forget_other_truth(state, &counts);
        // Continues from the most samples in memory.
        let known = counts.iter().rposition(|&count| self.has(state, count));
        let counts = &counts[known.unwrap_or(0)..];
        if known.is_none() {
            self.show_coarsely(state, inputs, counts[0])?;
        }
        self.pipeline
            .interrupt_by(Some(self.post.interrupt.clone()));
        for &count in counts {
            self.shoot(state, inputs, count, 1)?;
            self.refine(state, inputs, count)?;
            self.set_status(Status::Busy);
        }
        Ok(())
    }

    /// Drops a reference of another state.
    fn forget_other_truth(&mut self, state: &State, counts: &[u32]) {
        let is_of_state =
            |shot: &Shot| counts.iter().any(|&count| state.truth(count) == shot.image);
        if !self.shown.truth.as_ref().is_some_and(is_of_state) {
            self.shown.truth = None;
        }
    }

    /// Whether all images of a state are in memory.
    fn has(&mut self, state: &State, count: u32) -> bool {
        let halves = [Side::Left, Side::Right].map(|side| state.image(side, count));
        let truth = state.picture.scale().map(|_| state.truth(count));
        halves
            .iter()
            .chain(&truth)
            .all(|image| self.kept.get(image).is_some())
    }

    /// Shows a first picture at a resolution that takes about [`COARSE_MS`], then half the
    /// resolution.
    fn show_coarsely(&mut self, state: &State, inputs: &Inputs, count: u32) -> Result<(), Stop> {
        let started = Instant::now();
        let scale = self.coarse;
        let has_made_table = self.sketch(state, inputs, count, scale)?;
        let ms = started.elapsed().as_secs_f64() * 1e3;
        // A table is made once, so its time says nothing about the next picture.
        if !has_made_table && ms < COARSE_MS.start {
            self.coarse = (scale / 2).max(1);
        } else if !has_made_table && ms >= COARSE_MS.end {
            self.coarse = (scale * 2).min(COARSEST);
        }
        // Only a first picture is finished before the next state.
        self.pipeline
            .interrupt_by(Some(self.post.interrupt.clone()));
        if scale > 2 {
            self.sketch(state, inputs, count, 2)?;
        }
        Ok(())
    }

    /// Loads the environment and scene, unless they are the last ones.
    fn inputs(&mut self, state: &State) -> Result<Inputs, Stop> {
        let settings = state.point.settings();
        settings
            .shading
            .precompute
            .validate()
            .map_err(|error| Stop::Refused(error.to_string()))?;
        let environment = self.load_environment(&settings.environment)?;
        let scene = self.load_scene(&settings.scene)?;
        let framing = Framing {
            material: settings.material,
            camera: state.view.camera,
            size: settings.size,
        };
        let framed = match self.framed.take() {
            Some(framed) if framed.framing == framing => framed,
            _ => {
                let scene = Arc::new(scene.apply(&framing.material));
                let camera = Camera::for_scene(framing.camera, &scene, framing.size);
                FramedScene {
                    framing,
                    scene,
                    camera,
                }
            }
        };
        self.framed = Some(framed.clone());
        Ok(Inputs {
            environment,
            camera: framed.camera.orbited(state.view.orbit, &framed.scene),
            scene: framed.scene,
        })
    }

    fn load_environment(&mut self, name: &str) -> Result<Arc<Environment>, Stop> {
        if let Some(loaded) = self.environment.as_ref().filter(|known| known.name == name) {
            return Ok(loaded.content.clone());
        }
        let environment = Environment::load(name, Path::new(""), &self.load)
            .map_err(|error| Stop::Refused(error.to_string()))?;
        let content = Arc::new(environment);
        self.environment = Some(Loaded {
            name: name.to_owned(),
            content: content.clone(),
        });
        self.kept.clear();
        Ok(content)
    }

    fn load_scene(&mut self, name: &str) -> Result<Arc<Scene>, Stop> {
        if let Some(loaded) = self.scene.as_ref().filter(|known| known.name == name) {
            return Ok(loaded.content.clone());
        }
        let scene =
            Scene::load(name, Path::new("")).map_err(|error| Stop::Refused(error.to_string()))?;
        let content = Arc::new(scene);
        self.scene = Some(Loaded {
            name: name.to_owned(),
            content: content.clone(),
        });
        self.framed = None;
        self.kept.clear();
        Ok(content)
    }
}
