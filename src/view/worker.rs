//! The renderer's thread. It takes the newest state, shows it coarsely if the whole takes long, then whole, then
//! refines the reference until the state changes.

use super::picture::{Picture, of_frame, of_gbuffer, of_tables};
use super::state::{Image, Side, State};
use crate::environment::{Environment, LoadOptions};
use crate::experiment::axis::{AXES, Part, Point};
use crate::experiment::value::Value;
use crate::metrics::{Comparison, HEADLINE, Metric};
use crate::pipeline::{DeviceInfo, Frame, Options, Pipeline, PipelineError, Recent};
use crate::pixels::Rgb8Image;
use crate::scene::Scene;
use crate::spelling::Listed;
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

/// Time to show a changed state, ms.
const COARSE_MS: f64 = 60.0;
/// A first picture that takes longer, because of its tables, gives way to the next state.
const PATIENCE: Duration = Duration::from_secs(5);
/// Divisor of the coarsest resolution.
const COARSEST: u32 = 8;
/// Side of the first picture, before any time is known.
const FIRST_SIDE: f64 = 128.0;
/// Whole frames in memory.
const KEPT: usize = 8;
/// Texels of the largest level in a picture of tables.
const TABLE_TEXELS: u32 = 1 << 15;

#[derive(Clone, Debug)]
pub struct Shot {
    pub image: Image,
    pub frame: Arc<Frame>,
    pub picture: Arc<Rgb8Image>,
    /// Divisor of the state's resolution.
    pub scale: u32,
    /// The headline metric, once there is a reference.
    pub score: Option<f64>,
}

#[derive(Clone, Debug, Default, PartialEq)]
pub enum Standing {
    #[default]
    Busy,
    Done,
    /// The state cannot be shown; the previous picture stays.
    Refused(String),
    /// The renderer ended, but a new process may work.
    Lost(String),
    /// The renderer ended.
    Failed(String),
}

#[derive(Clone, Debug, Default)]
pub struct Shown {
    pub generation: u64,
    pub left: Option<Shot>,
    pub right: Option<Shot>,
    pub truth: Option<Shot>,
    /// A picture without halves.
    pub part: Option<Arc<Rgb8Image>>,
    /// Levels of the prefiltered map, if it was read.
    pub level_count: u32,
    pub standing: Standing,
    pub device: Option<DeviceInfo>,
    pub messages: Vec<String>,
}

impl Shown {
    pub fn side(&self, side: Side) -> Option<&Shot> {
        match side {
            Side::Left => self.left.as_ref(),
            Side::Right => self.right.as_ref(),
        }
    }
}

/// What both threads share.
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
}

fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// The window's side of the thread.
pub struct Worker {
    post: Arc<Post>,
    thread: Option<JoinHandle<()>>,
}

impl Worker {
    /// Starts the thread, which opens the device and calls `wake` at each update.
    pub fn start(options: Options, load: LoadOptions, wake: impl Fn() + Send + 'static) -> std::io::Result<Self> {
        let post = Arc::new(Post::default());
        let theirs = post.clone();
        let work = move || {
            let outcome =
                std::panic::catch_unwind(std::panic::AssertUnwindSafe(|| Renderer::run(&theirs, options, load, &wake)));
            let standing = match outcome {
                Ok(Ok(())) => return,
                Ok(Err(error)) if error.is_transient() => Standing::Lost(error.to_string()),
                Ok(Err(error)) => Standing::Failed(error.to_string()),
                Err(_) => Standing::Failed("the renderer failed because of a bug in splitsum".to_owned()),
            };
            lock(&theirs.shown).standing = standing;
            wake();
        };
        let thread = std::thread::Builder::new().name("renderer".to_owned()).spawn(work)?;
        Ok(Self { post, thread: Some(thread) })
    }

    /// Requests a state in place of the one before.
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

    pub fn shown(&self) -> Shown {
        lock(&self.post.shown).clone()
    }

    /// Ends the thread and returns its last update.
    pub fn close(&mut self) -> Shown {
        {
            let _held = lock(&self.post.state);
            for flag in [&self.post.is_closed, &*self.post.interrupt, &*self.post.is_overdue] {
                flag.store(true, Ordering::Relaxed);
            }
            self.post.arrived.notify_one();
        }
        // A panic was reported already.
        self.thread.take().map(JoinHandle::join);
        self.shown()
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
    pipeline: Pipeline,
    load: LoadOptions,
    environment: Option<(String, Option<f64>, Arc<Environment>)>,
    scene: Option<(String, Arc<Scene>)>,
    kept: Recent<Image, Arc<Frame>>,
    shown: Shown,
    /// Time per pixel of the last coarse picture, ms, and the point that it depends on.
    pixel_ms: Option<(Point, f64)>,
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
    fn run(post: &'a Post, options: Options, load: LoadOptions, wake: &'a dyn Fn()) -> Result<(), PipelineError> {
        let pipeline = Pipeline::new(Options { is_interactive: true, ..options })?;
        let shown = Shown { device: Some(pipeline.device().clone()), ..Shown::default() };
        let kept = Recent::weighed(KEPT, |frame: &Arc<Frame>| frame.bytes());
        let (environment, scene) = (None, None);
        let mut renderer = Self { post, wake, pipeline, load, environment, scene, kept, shown, pixel_ms: None };
        while let Some((generation, state)) = renderer.next() {
            renderer.shown.generation = generation;
            let standing = match renderer.show(&state) {
                Ok(()) => Standing::Done,
                Err(Stop::Refused(why)) => Standing::Refused(why),
                Err(Stop::Broken(error)) if error.is_interrupted() => continue,
                Err(Stop::Broken(error)) if error.is_transient() => return Err(error),
                Err(Stop::Broken(error)) => Standing::Refused(error.to_string()),
            };
            renderer.tell(standing);
        }
        renderer.tell(Standing::Done);
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
            state = self.post.arrived.wait(state).unwrap_or_else(PoisonError::into_inner);
        }
    }

    fn tell(&mut self, standing: Standing) {
        self.shown.standing = standing;
        self.shown.messages = self.pipeline.validation_messages();
        lock(&self.post.shown).clone_from(&self.shown);
        (self.wake)();
    }

    fn show(&mut self, state: &State) -> Result<(), Stop> {
        let (environment, scene) = self.inputs(state)?;
        if let Some(why) = state.view.lights.iter().find_map(|light| light.fault_in(&scene)) {
            return Err(Stop::Refused(why));
        }
        self.pipeline.interrupt_by(Some(self.post.is_overdue.clone()));
        let counts = state.counts();
        if self.shown.truth.as_ref().is_some_and(|shot| !counts.iter().any(|&count| state.truth(count) == shot.image)) {
            self.shown.truth = None;
        }
        if state.picture.has_sides() {
            self.shown.part = None;
        } else if state.picture != Picture::Difference {
            self.show_part(state, (&environment, &scene), counts[0])?;
        }
        let is_there = |side| self.kept.get(&state.image(side, counts[0])).is_some();
        let is_there = [Side::Left, Side::Right].into_iter().all(is_there);
        let scale = if is_there { 1 } else { self.scale(state) };
        if scale > 1 {
            let started = Instant::now();
            let coarse = state.scaled(scale);
            let made = self.shoot(&coarse, state, (&environment, &scene), counts[0], scale)?;
            self.tell(Standing::Busy);
            let [width, height] = coarse.size().map(f64::from);
            // Tables are made once.
            if !made {
                self.pixel_ms = Some((cost_of(state), started.elapsed().as_secs_f64() * 1e3 / (width * height)));
            }
        }
        // Only a first picture is finished before the next state.
        if is_there || scale > 1 {
            self.pipeline.interrupt_by(Some(self.post.interrupt.clone()));
        }
        for count in counts {
            self.shoot(state, state, (&environment, &scene), count, 1)?;
            self.pipeline.interrupt_by(Some(self.post.interrupt.clone()));
            self.refine(state, (&environment, &scene), count)?;
            self.tell(Standing::Busy);
        }
        Ok(())
    }

    /// Loads the environment and scene, unless they are the last ones.
    fn inputs(&mut self, state: &State) -> Result<(Arc<Environment>, Arc<Scene>), Stop> {
        let settings = state.point.settings();
        settings.shading.precompute.validate().map_err(|error| Stop::Refused(error.to_string()))?;
        let (name, clip, here) = (&settings.environment, settings.environment_clip_log2, Path::new(""));
        if self.environment.as_ref().is_none_or(|(known, at, _)| known != name || *at != clip) {
            let whole = Environment::load(name, here, &self.load).map_err(|error| Stop::Refused(error.to_string()))?;
            let environment = clip.map_or_else(|| whole.clone(), |power| whole.clipped(power.exp2() as f32));
            self.environment = Some((name.clone(), clip, Arc::new(environment)));
            self.kept.clear();
        }
        if self.scene.as_ref().is_none_or(|(known, _)| *known != settings.scene) {
            let scene = Scene::load(&settings.scene, here).map_err(|error| Stop::Refused(error.to_string()))?;
            self.scene = Some((settings.scene.clone(), Arc::new(scene)));
            self.kept.clear();
        }
        let environment = self.environment.as_ref().map(|(.., environment)| environment.clone());
        let scene = self.scene.as_ref().map(|(_, scene)| scene.clone());
        Ok((environment.expect("loaded above"), scene.expect("loaded above")))
    }

    /// Estimates the divisor of the resolution that can be shown in time.
    fn scale(&self, state: &State) -> u32 {
        let [width, height] = state.size().map(f64::from);
        let pixels = match &self.pixel_ms {
            Some((point, ms)) if *point == cost_of(state) => COARSE_MS / ms,
            _ => FIRST_SIDE * FIRST_SIDE,
        };
        let fits = |scale: &u32| width * height / f64::from(scale * scale) <= pixels;
        [1, 2, 4].into_iter().find(fits).unwrap_or(COARSEST)
    }

    /// Shows both halves, and the reference if needed. Returns whether it made a table.
    fn shoot(
        &mut self,
        state: &State,
        whole: &State,
        inputs: (&Arc<Environment>, &Scene),
        count: u32,
        scale: u32,
    ) -> Result<bool, Stop> {
        let mut made = false;
        let truth = match state.picture {
            Picture::Difference => Some(self.frame(&state.image(Side::Right, count), inputs)?),
            picture if picture.scale().is_some() => Some(self.frame(&state.truth(count), inputs)?),
            _ => None,
        };
        for side in [Side::Left, Side::Right] {
            let image = state.image(side, count);
            let frame = self.frame(&image, inputs)?;
            made |= !frame.timings.precompute.is_empty();
            let epsilon = image.request(inputs.0, inputs.1).epsilon();
            let picture = of_frame(&mut self.pipeline, whole.look(), &frame, truth.as_deref(), epsilon)?;
            let picture = Arc::new(picture.expect("the reference has the size of the halves"));
            if (state.picture, side) == (Picture::Difference, Side::Left) {
                self.shown.part = Some(picture.clone());
            }
            let shot = Some(Shot { image, frame, picture, scale, score: None });
            match side {
                Side::Left => self.shown.left = shot,
                Side::Right => self.shown.right = shot,
            }
            if scale == 1 && count == state.counts()[0] {
                self.tell(Standing::Busy);
            }
        }
        Ok(made)
    }

    /// Renders the reference with `count` samples per pixel and scores the halves.
    fn refine(&mut self, state: &State, inputs: (&Arc<Environment>, &Scene), count: u32) -> Result<(), Stop> {
        let image = state.truth(count);
        let truth = self.frame(&image, inputs)?;
        let request = image.request(inputs.0, inputs.1);
        let headline = Metric::listed(HEADLINE);
        for shot in [&mut self.shown.left, &mut self.shown.right].into_iter().flatten() {
            let curve = state.point.settings().curve;
            let (test, mask) = (&shot.frame.radiance, &truth.mask);
            let comparison = Comparison::new(test, &truth.radiance, mask, curve, request.epsilon());
            let is_other = !Arc::ptr_eq(&shot.frame, &truth);
            shot.score = comparison.ok().filter(|_| is_other).map(|comparison| comparison.evaluate(&[headline])[0].1);
        }
        let picture = Arc::new(Rgb8Image::filled(1, 1, [0; 3]));
        self.shown.truth = Some(Shot { image, frame: truth, picture, scale: 1, score: None });
        Ok(())
    }

    fn show_part(&mut self, state: &State, inputs: (&Arc<Environment>, &Scene), count: u32) -> Result<(), Stop> {
        let request = state.image(Side::Left, count).request(inputs.0, inputs.1);
        let picture = match state.picture {
            Picture::Part(part) => {
                of_gbuffer(part, &self.pipeline.gbuffer(&request)?, &request.camera, request.scene.bounds())
            }
            _ => {
                let tables = self.pipeline.light_tables(&request, TABLE_TEXELS)?;
                self.shown.level_count = tables.prefiltered.len() as u32;
                of_tables(state.look(), &tables)
            }
        };
        self.shown.part = Some(Arc::new(picture));
        self.tell(Standing::Busy);
        Ok(())
    }

    /// Renders an image unless its frame is in memory.
    fn frame(&mut self, image: &Image, (environment, scene): (&Arc<Environment>, &Scene)) -> Result<Arc<Frame>, Stop> {
        let render = || Ok(Arc::new(self.pipeline.render(&image.request(environment, scene))?));
        self.kept.get_or_make(image.clone(), render)
    }
}

/// Keeps the values that the time of a pixel depends on.
fn cost_of(state: &State) -> Point {
    let mut point = state.image(Side::Left, 1).point;
    for (axis, value) in AXES.iter().zip(&mut point.0) {
        if !axis.frames_cost && axis.part != Part::Count {
            *value = Value::Unset;
        }
    }
    point
}
