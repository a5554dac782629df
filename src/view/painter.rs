//! Ways to paint the window: images of a swapchain on the device that renders, or pixels on the
//! CPU.

use super::cpu_painter::CpuPainter;
use super::device_painter::DevicePainter;
use super::painting::{PaintError, Painting};
use crate::base::names::listed;
use crate::instrument::gpu::Gpu;
use softbuffer::SoftBufferError;
use std::rc::Rc;
use winit::window::Window;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Paint {
    /// By the faster way: a swapchain, unless the device is itself a CPU.
    Auto,
    /// By images of the device, which never leave it.
    Swapchain,
    Cpu,
}

listed!(Paint, "way to paint", { "auto": Auto, "swapchain": Swapchain, "cpu": Cpu });

pub enum Painter {
    Swapchain(DevicePainter),
    Cpu(CpuPainter),
}

impl Painter {
    /// Paints by a swapchain of `gpu` if that is wanted. If it cannot present, paints on the CPU,
    /// and returns why.
    pub fn new(
        paint: Paint,
        gpu: &Gpu,
        window: &Rc<Window>,
    ) -> Result<(Self, Option<String>), SoftBufferError> {
        let is_swapchain = match paint {
            Paint::Auto => gpu.info().device_type != "cpu",
            Paint::Swapchain => true,
            Paint::Cpu => false,
        };
        let mut why = None;
        if is_swapchain {
            match DevicePainter::new(gpu, window) {
                Ok(painter) => return Ok((Self::Swapchain(painter), None)),
                Err(error) => why = Some(format!("{error}; the window is painted on the CPU")),
            }
        }
        Ok((Self::Cpu(CpuPainter::new(window)?), why))
    }

    pub fn kind(&self) -> Paint {
        match self {
            Self::Swapchain(_) => Paint::Swapchain,
            Self::Cpu(_) => Paint::Cpu,
        }
    }

    /// Paints a window of `size` and shows it. Returns `false` if the window took no frame; a later
    /// one must follow.
    pub fn present(&mut self, size: [u32; 2], painting: &Painting) -> Result<bool, PaintError> {
        match self {
            Self::Swapchain(painter) => painter.present(size, painting),
            Self::Cpu(painter) => painter.present(size, painting).map(|()| true),
        }
    }

    /// Makes the surface again.
    pub fn renew(&mut self) -> Result<(), PaintError> {
        match self {
            Self::Swapchain(painter) => Ok(painter.renew()?),
            Self::Cpu(painter) => Ok(painter.renew()?),
        }
    }
}
