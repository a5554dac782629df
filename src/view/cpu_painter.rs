//! Paints the window's pixels on the CPU and hands them to the display.

use super::painting::{PaintError, Painting};
use super::theme;
use egui_software_backend::{BufferMutRef, ColorFieldOrder, EguiSoftwareRender};
use softbuffer::SoftBufferError;
use std::num::NonZeroU32;
use std::rc::Rc;
use winit::window::Window;

type Surface = softbuffer::Surface<Rc<Window>, Rc<Window>>;

fn surface_of(window: &Rc<Window>) -> Result<Surface, SoftBufferError> {
    Surface::new(&softbuffer::Context::new(window.clone())?, window.clone())
}

pub struct CpuPainter {
    surface: Surface,
    controls: EguiSoftwareRender,
}

impl CpuPainter {
    pub fn new(window: &Rc<Window>) -> Result<Self, SoftBufferError> {
        Ok(Self {
            surface: surface_of(window)?,
            controls: EguiSoftwareRender::new(ColorFieldOrder::Bgra).with_caching(false),
        })
    }

    /// Paints a frame and shows it. Does nothing without pixels.
    pub fn present(
        &mut self,
        [width, height]: [u32; 2],
        painting: &Painting,
    ) -> Result<(), PaintError> {
        let (Some(columns), Some(rows)) = (NonZeroU32::new(width), NonZeroU32::new(height)) else {
            return Ok(());
        };
        self.surface.resize(columns, rows)?;
        let window = self.surface.window().clone();
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
        })?;
        self.controls.render(
            &mut BufferMutRef::new(pixels, width as usize, height as usize),
            painting.shapes,
            painting.textures,
            painting.pixels_per_point,
        );
        window.pre_present_notify();
        Ok(buffer.present()?)
    }

    /// Creates the surface again.
    pub fn renew(&mut self) -> Result<(), SoftBufferError> {
        self.surface = surface_of(&self.surface.window().clone())?;
        Ok(())
    }
}
