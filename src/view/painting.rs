//! What a painter gets, and why it may fail.

use super::canvas::Canvas;
use super::shown::Shown;
use crate::instrument::gpu::GpuError;
use softbuffer::SoftBufferError;

/// The content of a frame.
pub struct Painting<'a> {
    pub canvas: Canvas,
    pub shown: &'a Shown,
    pub shapes: &'a [egui::ClippedPrimitive],
    pub textures: &'a egui::TexturesDelta,
    pub pixels_per_point: f32,
}

/// Why a frame was not painted.
pub enum PaintError {
    /// The surface of the window; another one may work.
    Surface(String),
    /// The device, which no new surface brings back.
    Device(String),
}

impl From<SoftBufferError> for PaintError {
    fn from(error: SoftBufferError) -> Self {
        Self::Surface(error.to_string())
    }
}

impl From<GpuError> for PaintError {
    fn from(error: GpuError) -> Self {
        if error.is_transient() {
            Self::Device(error.to_string())
        } else {
            Self::Surface(error.to_string())
        }
    }
}
