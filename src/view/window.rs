//! The window: events in, painted pixels out, files saved.
//!
//! Long because the events of a window and their handling are read together.

use super::file::quoted;
use super::overlay::composed;
use super::panel::Panel;
use super::state::{Side, State};
use super::theme;
use super::worker::{Shown, Status, Worker};
use crate::base::names::Listed;
use crate::base::pixels::png;
use crate::experiment::axis::{AXES, ENVIRONMENT, SCENE};
use crate::experiment::value::Value;
use crate::instrument::environment::LoadOptions;
use crate::instrument::pipeline::Options;
use crate::run::write_radiance;
use egui::ViewportId;
use egui_software_backend::{BufferMutRef, ColorFieldOrder, EguiSoftwareRender};
use std::collections::BTreeMap;
use std::num::NonZeroU32;
use std::path::{Path, PathBuf};
use std::rc::Rc;
use std::time::{Duration, Instant};
use winit::application::ApplicationHandler;
use winit::dpi::{LogicalSize, PhysicalSize};
use winit::event::{StartCause, WindowEvent};
use winit::event_loop::{ActiveEventLoop, ControlFlow, EventLoop, EventLoopProxy};
use winit::window::{Fullscreen, Window, WindowId};

#[derive(Debug, PartialEq, Eq)]
pub enum Windowed {
    Closed,
    NoDisplay(String),
    /// The device was lost; a new process may work.
    Lost(String),
    Failed(String),
}

/// Names a file for tests: places of the controls, and the shown state.
const TEST_WINDOW: &str = "SPLITSUM_TEST_WINDOW";
const SIZE: [f64; 2] = [1280.0, 800.0];
/// Distance of passes while the renderer is behind and the pointer moves.
const BEHIND: Duration = Duration::from_millis(50);
/// Fits the toolbar.
const SMALLEST: [f64; 2] = [800.0, 480.0];
/// Height that title bar and task bar take of a screen.
const BARS: f64 = 72.0;

#[derive(Debug)]
struct Arrived;

/// Opens the window, which saves states in the folder `out`, and runs until it is closed.
pub fn open(state: State, options: Options, load: LoadOptions, out: PathBuf) -> Windowed {
    let Ok(events) = EventLoop::<Arrived>::with_user_event().build() else {
        let why = "there is no display to open a window on: set DISPLAY or WAYLAND_DISPLAY";
        return Windowed::NoDisplay(why.to_owned());
    };
    let mut app = App::new(state, (options, load), out, events.create_proxy());
    if events.run_app(&mut app).is_err() {
        return Windowed::Lost("the display was lost".to_owned());
    }
    let shown = app.worker.as_mut().map(Worker::close);
    let messages = shown.map(|shown| shown.messages).unwrap_or_default();
    match app.ended {
        Windowed::Closed if !messages.is_empty() => Windowed::Failed(messages.join("\n")),
        ended => ended,
    }
}

fn earlier(a: Option<Instant>, b: Option<Instant>) -> Option<Instant> {
    [a, b].into_iter().flatten().min()
}

/// Returns winit's error without the place in its source.
fn words(error: &winit::error::OsError) -> String {
    let text = error.to_string();
    let place = text
        .strip_prefix("os error at ")
        .and_then(|rest| rest.split_once(": "));
    place.map_or(text.clone(), |(_, words)| words.to_owned())
}

type Surface = softbuffer::Surface<Rc<Window>, Rc<Window>>;

fn surface_of(window: &Rc<Window>) -> Result<Surface, softbuffer::SoftBufferError> {
    Surface::new(&softbuffer::Context::new(window.clone())?, window.clone())
}

struct Screen {
    window: Rc<Window>,
    /// From the last event: winit panics when asked about a destroyed window.
    size: PhysicalSize<u32>,
    opened: Instant,
    surface: Surface,
    input: egui_winit::State,
    painter: EguiSoftwareRender,
}

impl Screen {
    /// Collects input; `egui_winit` would ask the window for its size.
    fn egui_input(&mut self) -> egui::RawInput {
        let scale = self.window.scale_factor();
        let size = self.size.to_logical(scale);
        let input = self.input.egui_input_mut();
        input.time = Some(self.opened.elapsed().as_secs_f64());
        input.screen_rect = Some(egui::Rect::from_min_size(
            egui::Pos2::ZERO,
            egui::vec2(size.width, size.height),
        ));
        input
            .viewports
            .entry(ViewportId::ROOT)
            .or_default()
            .native_pixels_per_point = Some(scale as f32);
        input.take()
    }
}

struct App {
    opened: Option<(Options, LoadOptions)>,
    proxy: EventLoopProxy<Arrived>,
    state: State,
    asked: Option<State>,
    generation: u64,
    /// The last environment and scene that loaded.
    accepted: Option<[Value; 2]>,
    out: PathBuf,
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
    /// Whether no pass has seen a pressed button yet.
    is_press_unseen: bool,
    heard: Heard,
    reported: Option<(PathBuf, String)>,
}

#[derive(Default)]
struct Heard {
    /// Presses and releases.
    inputs: u64,
    pointer: [f64; 2],
    /// States with a picture.
    pictures: u64,
    /// Passes with a dimmed half.
    dimmed: u64,
}

impl Heard {
    fn hear(&mut self, event: &WindowEvent) {
        match event {
            WindowEvent::KeyboardInput {
                event,
                is_synthetic: false,
                ..
            } if !event.repeat => self.inputs += 1,
            WindowEvent::MouseInput { .. } => self.inputs += 1,
            WindowEvent::CursorMoved { position, .. } => self.pointer = [position.x, position.y],
            _ => {}
        }
    }
}

impl App {
    fn new(
        state: State,
        opened: (Options, LoadOptions),
        out: PathBuf,
        proxy: EventLoopProxy<Arrived>,
    ) -> Self {
        let context = egui::Context::default();
        theme::apply(&context);
        // A slow frame must not turn a click into a drag.
        context.options_mut(|options| options.input_options.max_click_duration = f64::INFINITY);
        Self {
            opened: Some(opened),
            proxy,
            state,
            asked: None,
            generation: 0,
            accepted: None,
            out,
            worker: None,
            shown: Shown::default(),
            panel: Panel::default(),
            context,
            screen: None,
            ended: Windowed::Closed,
            is_renewed: false,
            wakes_at: None,
            painted: Instant::now(),
            is_press_unseen: false,
            heard: Heard::default(),
            reported: std::env::var_os(TEST_WINDOW).map(|path| (path.into(), String::new())),
        }
    }

    fn open_screen(&self, events: &ActiveEventLoop) -> Result<Screen, String> {
        let size = |[width, height]: [f64; 2]| LogicalSize::new(width, height);
        let monitor = events
            .primary_monitor()
            .or_else(|| events.available_monitors().next());
        let room = monitor.map_or(size(SIZE), |monitor| {
            monitor.size().to_logical(monitor.scale_factor())
        });
        let first = size([
            SIZE[0].min(room.width),
            SIZE[1].min(room.height - BARS).max(SMALLEST[1]),
        ]);
        let attributes = Window::default_attributes()
            .with_title("splitsum view")
            .with_inner_size(first)
            .with_min_inner_size(size(SMALLEST));
        let window = Rc::new(
            events
                .create_window(attributes)
                .map_err(|error| words(&error))?,
        );
        let surface = surface_of(&window).map_err(|error| error.to_string())?;
        let input = egui_winit::State::new(
            self.context.clone(),
            ViewportId::ROOT,
            &window,
            Some(window.scale_factor() as f32),
            None,
            None,
        );
        Ok(Screen {
            size: window.inner_size(),
            opened: Instant::now(),
            window,
            surface,
            input,
            painter: EguiSoftwareRender::new(ColorFieldOrder::Bgra).with_caching(false),
        })
    }

    fn end(&mut self, events: &ActiveEventLoop, ended: Windowed) {
        self.ended = ended;
        events.exit();
    }

    fn frame(&mut self, events: &ActiveEventLoop) {
        let Some(screen) = &mut self.screen else {
            return;
        };
        let PhysicalSize { width, height } = screen.size;
        // A minimised window may have no pixels.
        let (Some(columns), Some(rows)) = (NonZeroU32::new(width), NonZeroU32::new(height)) else {
            return;
        };
        let input = screen.egui_input();
        self.painted = Instant::now();
        self.is_press_unseen = false;
        for file in input
            .dropped_files
            .iter()
            .filter_map(|file| file.path.clone())
        {
            self.panel.open(&file, &mut self.state);
        }
        let (panel, state, shown) = (&mut self.panel, &mut self.state, &self.shown);
        let output = self.context.run_ui(input, |ui| panel.ui(ui, state, shown));
        screen
            .input
            .handle_platform_output(&screen.window, output.platform_output);
        let delay = output
            .viewport_output
            .get(&ViewportId::ROOT)
            .map(|viewport| viewport.repaint_delay);
        let repaints_at = delay
            .filter(|delay| *delay < Duration::from_secs(3600))
            .map(|delay| Instant::now() + delay);
        self.wakes_at = earlier(repaints_at, self.panel.dims_at(self.painted));
        let shapes = self
            .context
            .tessellate(output.shapes, output.pixels_per_point);
        let presented = screen.surface.resize(columns, rows).and_then(|()| {
            let mut buffer = screen.surface.buffer_mut()?;
            let [r, g, b, _] = theme::PAPER.to_array().map(u32::from);
            buffer.fill(r << 16 | g << 8 | b);
            let pixels: &mut [[u8; 4]] = bytemuck::cast_slice_mut(&mut buffer);
            let canvas = self.panel.canvas;
            let [left, top] = canvas.corner;
            canvas.paint(shown, |x, y, row| {
                let (x, y) = ((left + x).min(width), (top + y).min(height - 1));
                let places = &mut pixels[(y * width + x) as usize..((y + 1) * width) as usize];
                places
                    .iter_mut()
                    .zip(row)
                    .for_each(|(place, [r, g, b])| *place = [*b, *g, *r, 0]);
            });
            let target = &mut BufferMutRef::new(pixels, width as usize, height as usize);
            screen.painter.render(
                target,
                &shapes,
                &output.textures_delta,
                output.pixels_per_point,
            );
            screen.window.pre_present_notify();
            buffer.present()
        });
        if let Err(error) = presented {
            // Creates a lost surface again once, then gives up.
            let again = std::mem::replace(&mut self.is_renewed, true);
            match surface_of(&screen.window) {
                Ok(surface) if !again => {
                    screen.surface = surface;
                    screen.window.request_redraw();
                }
                _ => self.end(
                    events,
                    Windowed::Lost(format!("the window's surface was lost: {error}")),
                ),
            }
            return;
        }
        self.is_renewed = false;
        self.heard.dimmed += u64::from(self.panel.canvas.is_stale.contains(&true));
        self.ask();
        self.write_report(delay.is_none_or(|delay| delay > Duration::ZERO));
        if std::mem::take(&mut self.panel.wants_save) {
            self.save();
        }
        if std::mem::take(&mut self.panel.wants_fullscreen)
            && let Some(screen) = &self.screen
        {
            let is_full = screen.window.fullscreen().is_some();
            screen
                .window
                .set_fullscreen((!is_full).then_some(Fullscreen::Borderless(None)));
        }
    }

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

    fn arrive(&mut self, events: &ActiveEventLoop) {
        let Some(worker) = &self.worker else { return };
        let shown = worker.shown();
        self.heard.pictures += u64::from(shown.generation != self.shown.generation);
        self.shown = shown;
        self.panel.arrive(&self.shown);
        let inputs = [ENVIRONMENT, SCENE].map(|axis| self.state.point[axis].clone());
        match self.shown.status.clone() {
            // Returns to the last file that loaded.
            Status::Refused(why) if self.shown.generation == self.generation => {
                if let Some(before) = self.accepted.clone().filter(|before| *before != inputs) {
                    self.panel.report(Err(why));
                    for (axis, value) in [ENVIRONMENT, SCENE].into_iter().zip(before) {
                        self.state.point[axis] = value;
                    }
                }
            }
            Status::Lost(why) => self.end(events, Windowed::Lost(why)),
            Status::Failed(why) => self.end(events, Windowed::Failed(why)),
            _ if self.shown.generation == self.generation => self.accepted = Some(inputs),
            _ => {}
        }
        if let Some(screen) = &self.screen {
            screen.window.request_redraw();
        }
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
        let is_whole = |side| self.shown.side(side).is_some_and(|shot| shot.scale == 1);
        if self.shown.generation != self.generation
            || !(is_whole(Side::Left) && is_whole(Side::Right))
        {
            return Err("the picture is still coarse; try again in a moment".to_owned());
        }
        let free = |number: &u32| !self.out.join(format!("view-{number}")).exists();
        let number = (1..).find(free).expect("a free number");
        let folder = self.out.join(format!("view-{number}"));
        let fault =
            |path: &Path, error: &dyn std::fmt::Display| format!("{}: {error}", path.display());
        std::fs::create_dir_all(&folder).map_err(|error| fault(&folder, &error))?;
        let program = std::env::current_exe()
            .ok()
            .and_then(|file| Some(file.parent()?.display().to_string()));
        let search = format!("PATH=$PATH:{}", quoted(&program.unwrap_or_default()));
        let mut commands =
            format!("#!/bin/sh\n# Renders the halves of this state again.\n{search}\n");
        for (name, side) in [("left", Side::Left), ("right", Side::Right)] {
            let shot = self.shown.side(side).expect("asked above");
            let path = folder.join(format!("{name}.exr"));
            write_radiance(&path, &shot.frame).map_err(|error| error.to_string())?;
            commands += &(self
                .state
                .render_command(&shot.image, &format!("{name}-again.exr"))
                + "\n");
        }
        let picture =
            composed(&self.shown, self.state.shown_wipe()).ok_or("there is no picture yet")?;
        png::write_rgb8(&folder.join("picture.png"), &picture)
            .map_err(|error| error.to_string())?;
        let texts = [
            ("render.sh", commands),
            (
                "view.sh",
                format!(
                    "#!/bin/sh\n# Opens this state again.\n{search}\n{}\n",
                    self.state.view_command()
                ),
            ),
        ];
        for (name, text) in texts {
            let path = folder.join(name);
            std::fs::write(&path, text).map_err(|error| fault(&path, &error))?;
        }
        Ok(folder)
    }

    /// Writes the file for tests.
    fn write_report(&mut self, is_still: bool) {
        let Some((path, before)) = &mut self.reported else {
            return;
        };
        let scale = f64::from(self.context.pixels_per_point());
        let place = |rect: &egui::Rect| {
            [rect.left(), rect.top(), rect.width(), rect.height()].map(|x| f64::from(x) * scale)
        };
        let controls: BTreeMap<_, _> = self
            .panel
            .controls
            .places
            .iter()
            .map(|(name, rect)| (name, place(rect)))
            .collect();
        let scales =
            [Side::Left, Side::Right].map(|side| self.shown.side(side).map(|shot| shot.scale));
        let text = serde_json::json!({
            "controls": controls,
            "inputs": self.heard.inputs,
            "pointer": self.heard.pointer,
            "pictures": self.heard.pictures,
            "is_still": is_still,
            "asked": self.generation,
            "shown": self.shown.generation,
            "is_done": self.shown.status == Status::Done,
            "status": format!("{:?}", self.shown.status),
            "scales": scales,
            "stale": self.panel.canvas.is_stale,
            "dimmed": self.heard.dimmed,
            "reference": self.shown.truth.as_ref().map(|shot| shot.image.view.reference_samples),
            "notice": self.panel.notice,
            "state": {
                "axes": AXES.iter().zip(&self.state.point.0).map(|(axis, value)| (axis.name, value.to_string())).collect::<BTreeMap<_, _>>(),
                "right": self.state.right.to_string(),
                "orbit": self.state.view.orbit.numbers(),
                "picture": self.state.picture.name(),
                "wipe": self.state.wipe,
            },
        })
        .to_string();
        if text != *before {
            // Replaces the file in one step.
            let part = path.with_extension("part");
            let _ = std::fs::write(&part, &text).and_then(|()| std::fs::rename(&part, &*path));
            *before = text;
        }
    }
}

impl ApplicationHandler<Arrived> for App {
    fn resumed(&mut self, events: &ActiveEventLoop) {
        if self.screen.is_some() {
            return;
        }
        match self.open_screen(events) {
            Ok(screen) => self.screen = Some(screen),
            Err(why) => {
                return self.end(
                    events,
                    Windowed::NoDisplay(format!("cannot open a window: {why}")),
                );
            }
        }
        if let Some((options, load)) = self.opened.take() {
            let proxy = self.proxy.clone();
            // The window may be gone.
            let wake = move || drop(proxy.send_event(Arrived));
            match Worker::start(options, load, wake) {
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
        self.heard.hear(&event);
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
                self.wakes_at = earlier(self.wakes_at, Some(self.painted + BEHIND));
            }
            _ if response.repaint => screen.window.request_redraw(),
            _ => {}
        }
    }
}
