//! The surface of the window: input of a frame in, painted pixels out.

use super::overlay::Canvas;
use super::shown::Shown;
use super::theme;
use egui::ViewportId;
use egui_software_backend::{BufferMutRef, ColorFieldOrder, EguiSoftwareRender};
use softbuffer::SoftBufferError;
use std::num::NonZeroU32;
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

type Surface = softbuffer::Surface<Rc<Window>, Rc<Window>>;

fn surface_of(window: &Rc<Window>) -> Result<Surface, SoftBufferError> {
    Surface::new(&softbuffer::Context::new(window.clone())?, window.clone())
}

/// Returns winit's error without the place in its source.
fn error_text(error: &winit::error::OsError) -> String {
    let text = error.to_string();
    let place = text
        .strip_prefix("os error at ")
        .and_then(|rest| rest.split_once(": "));
    place.map_or(text.clone(), |(_, words)| words.to_owned())
}

pub struct Screen {
    pub window: Rc<Window>,
    /// From the last event: winit panics when asked about a destroyed window.
    pub size: PhysicalSize<u32>,
    opened: Instant,
    surface: Surface,
    pub input: egui_winit::State,
    painter: EguiSoftwareRender,
}

/// The content of a frame.
pub struct Painting<'a> {
    pub canvas: Canvas,
    pub shown: &'a Shown,
    pub shapes: &'a [egui::ClippedPrimitive],
    pub textures: &'a egui::TexturesDelta,
    pub pixels_per_point: f32,
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
        let surface = surface_of(&window).map_err(|error| error.to_string())?;
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
            opened: Instant::now(),
            window,
            surface,
            input,
            painter: EguiSoftwareRender::new(ColorFieldOrder::Bgra).with_caching(false),
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

    /// Paints a frame and shows it. Does nothing without pixels.
    pub fn present(&mut self, painting: &Painting) -> Result<(), SoftBufferError> {
        let PhysicalSize { width, height } = self.size;
        let (Some(columns), Some(rows)) = (NonZeroU32::new(width), NonZeroU32::new(height)) else {
            return Ok(());
        };
        self.surface.resize(columns, rows)?;
        let mut buffer = self.surface.buffer_mut()?;
        let [r, g, b, _] = theme::PAPER.to_array().map(u32::from);
        buffer.fill(r << 16 | g << 8 | b);
        let pixels: &mut [[u8; 4]] = bytemuck::cast_slice_mut(&mut buffer);
        let [left, top] = painting.canvas.corner;
        painting.canvas.paint(painting.shown, |x, y, colors| {
            let x = (left + x).min(width);
            let y = (top + y).min(height - 1);
            let row = &mut pixels[(y * width + x) as usize..((y + 1) * width) as usize];
            for (pixel, [r, g, b]) in row.iter_mut().zip(colors) {
                *pixel = [*b, *g, *r, 0];
            }
        });
        self.painter.render(
            &mut BufferMutRef::new(pixels, width as usize, height as usize),
            painting.shapes,
            painting.textures,
            painting.pixels_per_point,
        );
        self.window.pre_present_notify();
        buffer.present()
    }

    /// Creates the surface again.
    pub fn renew_surface(&mut self) -> Result<(), SoftBufferError> {
        self.surface = surface_of(&self.window)?;
        Ok(())
    }

    pub fn toggle_fullscreen(&self) {
        let is_full = self.window.fullscreen().is_some();
        let mode = (!is_full).then_some(Fullscreen::Borderless(None));
        self.window.set_fullscreen(mode);
    }
}
