//! The window: its events, and what they change.

use super::painter::{Paint, Painter};
use super::painting::{PaintError, Painting};
use super::panel::Panel;
use super::save::save;
use super::screen::Screen;
use super::shown::{Shown, Status};
use super::state::{Side, State};
use super::test_report::{Counts, Snapshot, TestReport};
use super::theme;
use super::worker::Worker;
use crate::experiment::axis::{ENVIRONMENT, SCENE};
use crate::experiment::value::Value;
use crate::instrument::environment::LoadOptions;
use crate::instrument::pipeline::Options;
use egui::ViewportId;
use std::path::PathBuf;
use std::time::{Duration, Instant};
use winit::application::ApplicationHandler;
use winit::event::{StartCause, WindowEvent};
use winit::event_loop::{ActiveEventLoop, ControlFlow, EventLoop, EventLoopProxy};
use winit::window::WindowId;

#[derive(Debug, PartialEq, Eq)]
pub enum Windowed {
    Closed,
    NoDisplay(String),
    /// The device was lost; a new process may work.
    Lost(String),
    Failed(String),
}

/// Least time between passes while the renderer is behind and the pointer moves.
const BEHIND: Duration = Duration::from_millis(50);
/// A longer delay of egui means that nothing is to be repainted.
const DELAY_MAX: Duration = Duration::from_secs(3600);

/// The renderer has an update.
#[derive(Debug)]
struct Arrived;

/// What a window is opened with.
pub struct WindowOptions {
    pub device: Options,
    pub load: LoadOptions,
    /// Folder of saved states.
    pub out: PathBuf,
    pub paint: Paint,
    /// Logs a line.
    pub warn: fn(&str),
}

/// Opens the window and runs until it is closed.
pub fn open(state: State, options: WindowOptions) -> Windowed {
    let Ok(events) = EventLoop::<Arrived>::with_user_event().build() else {
        let why = "there is no display to open a window on: set DISPLAY or WAYLAND_DISPLAY";
        return Windowed::NoDisplay(why.to_owned());
    };
    let mut app = App::new(state, options, events.create_proxy());
    if events.run_app(&mut app).is_err() {
        return Windowed::Lost("the display was lost".to_owned());
    }
    // The validation layer watches the end of both users of the device.
    app.screen = None;
    let messages = app.worker.as_mut().map(Worker::close).unwrap_or_default();
    match app.ended {
        Windowed::Closed if !messages.is_empty() => Windowed::Failed(messages.join("\n")),
        ended => ended,
    }
}

fn earlier(a: Option<Instant>, b: Option<Instant>) -> Option<Instant> {
    [a, b].into_iter().flatten().min()
}

struct App {
    options: WindowOptions,
    proxy: EventLoopProxy<Arrived>,
    state: State,
    asked: Option<State>,
    generation: u64,
    /// The last environment and scene that loaded.
    accepted: Option<[Value; 2]>,
    worker: Option<Worker>,
    shown: Shown,
    panel: Panel,
    context: egui::Context,
    screen: Option<Screen>,
    ended: Windowed,
    /// Whether the surface was created again since it last worked.
    is_renewed: bool,
    wakes_at: Option<Instant>,
    painted: Instant,
    /// How long the last frame took.
    painting_time: Duration,
    /// Whether no pass has seen a pressed button yet.
    is_press_unseen: bool,
    counts: Counts,
    test_report: Option<TestReport>,
}

impl App {
    fn new(state: State, options: WindowOptions, proxy: EventLoopProxy<Arrived>) -> Self {
        let context = egui::Context::default();
        theme::apply(&context);
        // A slow frame must not turn a click into a drag.
        context.options_mut(|options| options.input_options.max_click_duration = f64::INFINITY);
        Self {
            options,
            proxy,
            state,
            asked: None,
            generation: 0,
            accepted: None,
            worker: None,
            shown: Shown::default(),
            panel: Panel::default(),
            context,
            screen: None,
            ended: Windowed::Closed,
            is_renewed: false,
            wakes_at: None,
            painted: Instant::now(),
            painting_time: Duration::ZERO,
            is_press_unseen: false,
            counts: Counts::default(),
            test_report: TestReport::from_environment(),
        }
    }

    fn end(&mut self, events: &ActiveEventLoop, ended: Windowed) {
        self.ended = ended;
        events.exit();
    }

    /// Runs one pass of the controls and paints the window.
    fn frame(&mut self, events: &ActiveEventLoop) {
        let Some(screen) = &mut self.screen else {
            return;
        };
        if !screen.has_pixels() || screen.painter.is_none() {
            return;
        }
        let input = screen.egui_input();
        self.painted = Instant::now();
        self.is_press_unseen = false;
        for file in &input.dropped_files {
            if let Some(path) = &file.path {
                self.panel.open(path, &mut self.state);
            }
        }
        let panel = &mut self.panel;
        let state = &mut self.state;
        let output = self
            .context
            .run_ui(input, |ui| panel.ui(ui, state, &self.shown));
        screen
            .input
            .handle_platform_output(&screen.window, output.platform_output);
        let delay = output
            .viewport_output
            .get(&ViewportId::ROOT)
            .map(|viewport| viewport.repaint_delay);
        let repaints_at = delay
            .filter(|delay| *delay < DELAY_MAX)
            .map(|delay| Instant::now() + delay);
        self.wakes_at = earlier(repaints_at, self.panel.dims_at(self.painted));
        let shapes = self
            .context
            .tessellate(output.shapes, output.pixels_per_point);
        let presented = screen.present(&Painting {
            canvas: self.panel.canvas,
            shown: &self.shown,
            shapes: &shapes,
            textures: &output.textures_delta,
            pixels_per_point: output.pixels_per_point,
        });
        self.painting_time = self.painted.elapsed();
        match presented {
            Ok(true) => {
                self.is_renewed = false;
                self.counts.frames += 1;
            }
            Ok(false) => self.wakes_at = earlier(self.wakes_at, Some(self.painted + BEHIND)),
            Err(PaintError::Device(why)) => return self.end(events, Windowed::Lost(why)),
            Err(PaintError::Surface(why)) => return self.renew_surface(events, &why),
        }
        self.counts.dimmed += u64::from(self.panel.canvas.is_stale.contains(&true));
        self.ask();
        self.write_test_report(delay.is_none_or(|delay| delay > Duration::ZERO));
        self.serve_panel();
    }

    /// Does what the controls asked for beyond another picture.
    fn serve_panel(&mut self) {
        if std::mem::take(&mut self.panel.wants_save) {
            self.save();
        }
        if std::mem::take(&mut self.panel.wants_fullscreen)
            && let Some(screen) = &self.screen
        {
            screen.toggle_fullscreen();
        }
    }

    /// Creates a lost surface again once, then gives up.
    fn renew_surface(&mut self, events: &ActiveEventLoop, error: &str) {
        let was_renewed = std::mem::replace(&mut self.is_renewed, true);
        if let Some(screen) = &mut self.screen
            && let Some(painter) = &mut screen.painter
            && !was_renewed
            && painter.renew().is_ok()
        {
            screen.window.request_redraw();
            return;
        }
        let why = format!("the window's surface was lost: {error}");
        self.end(events, Windowed::Lost(why));
    }

    /// Asks the renderer for the state, if it changed.
    fn ask(&mut self) {
        self.state.name_files();
        // The wipe is the window's own.
        let wanted = State {
            wipe: 0.0,
            ..self.state.clone()
        };
        if self.asked.as_ref() == Some(&wanted) {
            return;
        }
        self.generation += 1;
        self.panel.ask(self.generation);
        if let Some(worker) = &self.worker {
            worker.ask(self.generation, wanted.clone());
        }
        self.shown.status = Status::Busy;
        self.wakes_at = earlier(self.wakes_at, self.panel.dims_at(self.painted));
        self.asked = Some(wanted);
    }

    /// Decides how to paint, once the device is open.
    fn choose_painter(&mut self, events: &ActiveEventLoop) {
        let (Some(screen), Some(worker)) = (&mut self.screen, &self.worker) else {
            return;
        };
        let (None, Some(gpu)) = (&screen.painter, worker.gpu()) else {
            return;
        };
        let (painter, why) = match Painter::new(self.options.paint, gpu, &screen.window) {
            Ok(made) => made,
            Err(error) => {
                let why = format!("cannot open a window: {error}");
                return self.end(events, Windowed::NoDisplay(why));
            }
        };
        if painter.kind() == Paint::Swapchain {
            worker.paint_on_device();
        }
        screen.painter = Some(painter);
        if let Some(why) = why {
            (self.options.warn)(&why);
            self.panel.report(Ok(why));
        }
    }

    /// Takes an update of the renderer.
    fn arrive(&mut self, events: &ActiveEventLoop) {
        self.choose_painter(events);
        let Some(worker) = &self.worker else { return };
        let shown = worker.shown();
        self.counts.pictures += u64::from(shown.generation != self.shown.generation);
        self.shown = shown;
        self.panel.arrive(&self.shown);
        let is_current = self.asked.is_some() && self.shown.generation == self.generation;
        let inputs = [ENVIRONMENT, SCENE].map(|axis| self.state.point[axis].clone());
        match self.shown.status.clone() {
            Status::Refused(why) if is_current => self.return_to_accepted(&inputs, why),
            Status::Lost(why) => self.end(events, Windowed::Lost(why)),
            Status::Failed(why) => self.end(events, Windowed::Failed(why)),
            _ if is_current => self.accepted = Some(inputs),
            _ => {}
        }
        if let Some(screen) = &self.screen {
            screen.window.request_redraw();
        }
    }

    /// Returns to the last environment and scene that loaded, if `inputs` are others.
    fn return_to_accepted(&mut self, inputs: &[Value; 2], why: String) {
        let Some(accepted) = self.accepted.clone().filter(|known| known != inputs) else {
            return;
        };
        self.panel.report(Err(why));
        let [environment, scene] = accepted;
        self.state.point[ENVIRONMENT] = environment;
        self.state.point[SCENE] = scene;
    }

    fn save(&mut self) {
        let saved = self
            .saved()
            .map(|folder| format!("Saved in {}", folder.display()));
        self.panel
            .report(saved.map_err(|why| format!("Not saved: {why}")));
        if let Some(screen) = &self.screen {
            screen.window.request_redraw();
        }
    }

    fn saved(&self) -> Result<PathBuf, String> {
        let is_whole = |side| {
            let shot = self.shown.side(side);
            shot.is_some_and(|shot| shot.scale == 1 && shot.frame.is_some())
        };
        let is_current = self.shown.generation == self.generation;
        if !is_current || !is_whole(Side::Left) || !is_whole(Side::Right) {
            return Err("the picture is still coarse; try again in a moment".to_owned());
        }
        save(&self.options.out, &self.state, &self.shown)
    }

    fn write_test_report(&mut self, is_still: bool) {
        if let Some(report) = &mut self.test_report {
            report.write(&Snapshot {
                panel: &self.panel,
                paint: self
                    .screen
                    .as_ref()
                    .and_then(|screen| Some(screen.painter.as_ref()?.kind())),
                state: &self.state,
                shown: &self.shown,
                counts: &self.counts,
                generation: self.generation,
                pixels_per_point: self.context.pixels_per_point(),
                is_still,
            });
        }
    }
}

impl ApplicationHandler<Arrived> for App {
    fn resumed(&mut self, events: &ActiveEventLoop) {
        if self.screen.is_some() {
            return;
        }
        match Screen::open(&self.context, events) {
            Ok(screen) => self.screen = Some(screen),
            Err(why) => {
                let why = format!("cannot open a window: {why}");
                return self.end(events, Windowed::NoDisplay(why));
            }
        }
        if self.worker.is_none() {
            let proxy = self.proxy.clone();
            // The window may be gone.
            let wake = move || drop(proxy.send_event(Arrived));
            let device = Options {
                is_presenting: self.options.paint != Paint::Cpu,
                ..self.options.device
            };
            match Worker::start(device, self.options.load.clone(), wake) {
                Ok(worker) => self.worker = Some(worker),
                Err(error) => self.end(events, Windowed::Failed(format!("no thread: {error}"))),
            }
        }
    }

    fn user_event(&mut self, events: &ActiveEventLoop, _: Arrived) {
        self.arrive(events);
    }

    fn new_events(&mut self, _: &ActiveEventLoop, cause: StartCause) {
        if let (StartCause::ResumeTimeReached { .. }, Some(screen)) = (cause, &self.screen) {
            self.wakes_at = None;
            screen.window.request_redraw();
        }
    }

    fn about_to_wait(&mut self, events: &ActiveEventLoop) {
        events.set_control_flow(
            self.wakes_at
                .map_or(ControlFlow::Wait, ControlFlow::WaitUntil),
        );
    }

    fn window_event(&mut self, events: &ActiveEventLoop, _: WindowId, event: WindowEvent) {
        // A slider needs a pass between press and release.
        if let WindowEvent::MouseInput { state, .. } = event {
            if self.is_press_unseen && !state.is_pressed() {
                self.frame(events);
            }
            self.is_press_unseen = state.is_pressed();
        }
        self.counts.count(&event);
        let Some(screen) = &mut self.screen else {
            return;
        };
        let response = screen.input.on_window_event(&screen.window, &event);
        match event {
            WindowEvent::Resized(size) => {
                screen.size = size;
                screen.window.request_redraw();
            }
            WindowEvent::CloseRequested => {
                // The renderer may take a moment to end.
                screen.window.set_visible(false);
                events.exit();
            }
            WindowEvent::Destroyed => {
                self.screen = None;
                self.end(
                    events,
                    Windowed::Lost("the window was taken away".to_owned()),
                );
            }
            WindowEvent::RedrawRequested => self.frame(events),
            // Leaves the processor to a renderer that is behind.
            WindowEvent::CursorMoved { .. } if self.shown.generation != self.generation => {
                let pause = BEHIND.max(2 * self.painting_time);
                self.wakes_at = earlier(self.wakes_at, Some(self.painted + pause));
            }
            _ if response.repaint => screen.window.request_redraw(),
            _ => {}
        }
    }
}
