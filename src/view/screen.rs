//! The window on the screen: input of a frame in, painted frames out.

use super::painter::Painter;
use super::painting::{PaintError, Painting};
use egui::ViewportId;
use std::rc::Rc;
use std::time::Instant;
use winit::dpi::{LogicalSize, PhysicalSize};
use winit::event_loop::ActiveEventLoop;
use winit::window::{Fullscreen, Window};

/// Logical pixels.
const SIZE: [f64; 2] = [1280.0, 800.0];
/// Leaves room for the toolbar.
const SMALLEST: [f64; 2] = [800.0, 480.0];
/// Height that title bar and task bar take of a screen.
const BARS: f64 = 72.0;

/// Returns winit's error without the place in its source.
fn error_text(error: &winit::error::OsError) -> String {
    let text = error.to_string();
    let place = text
        .strip_prefix("os error at ")
        .and_then(|rest| rest.split_once(": "));
    place.map_or(text.clone(), |(_, words)| words.to_owned())
}

pub struct Screen {
    /// `None` until the device is open, which decides how the window is painted.
    pub painter: Option<Painter>,
    pub window: Rc<Window>,
    /// From the last event: winit panics when asked about a destroyed window.
    pub size: PhysicalSize<u32>,
    opened: Instant,
    pub input: egui_winit::State,
}

impl Screen {
    /// Opens a window of [`SIZE`], or as large as the monitor has room for.
    pub fn open(context: &egui::Context, events: &ActiveEventLoop) -> Result<Self, String> {
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
        let window = events
            .create_window(attributes)
            .map_err(|error| error_text(&error))?;
        let window = Rc::new(window);
        let input = egui_winit::State::new(
            context.clone(),
            ViewportId::ROOT,
            &window,
            Some(window.scale_factor() as f32),
            None,
            None,
        );
        Ok(Self {
            size: window.inner_size(),
            painter: None,
            opened: Instant::now(),
            window,
            input,
        })
    }

    /// Whether the window has pixels; a minimised one may have none.
    pub fn has_pixels(&self) -> bool {
        self.size.width > 0 && self.size.height > 0
    }

    /// Collects input; `egui_winit` would ask the window for its size.
    pub fn egui_input(&mut self) -> egui::RawInput {
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

    /// Paints a frame and shows it. Returns `false` if the window took none.
    pub fn present(&mut self, painting: &Painting) -> Result<bool, PaintError> {
        let size = self.size.into();
        match &mut self.painter {
            Some(painter) => painter.present(size, painting),
            None => Ok(false),
        }
    }

    pub fn toggle_fullscreen(&self) {
        let is_full = self.window.fullscreen().is_some();
        let mode = (!is_full).then_some(Fullscreen::Borderless(None));
        self.window.set_fullscreen(mode);
    }
}
