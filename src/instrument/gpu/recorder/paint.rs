//! Paints layers over each other into the image of a window.

use super::Recorder;
use super::binding::interface;
use crate::instrument::gpu::sync::Access;
use crate::instrument::gpu::{Bind, GpuError, GraphicsDescription, Image, Output};
use ash::vk;
use std::ops::Range;

/// A layer: triangles whose vertices the shader makes of their numbers.
pub struct Painted<'a> {
    pub shaders: [&'a str; 2],
    /// Whether it replaces what is below it.
    pub is_opaque: bool,
    pub binds: Vec<Bind<'a>>,
    pub push: Vec<u8>,
    pub vertices: Range<u32>,
    /// Left, top, width and height of the part of the image that it may change, pixels.
    pub clip: [u32; 4],
}

impl Recorder {
    /// Fills `target` with a colour in [0, 1] and paints layers over it.
    pub fn paint(
        &mut self,
        target: &Image,
        ground: [f32; 4],
        layers: &[Painted<'_>],
    ) -> Result<(), GpuError> {
        for layer in layers {
            self.access_binds(&layer.binds);
        }
        self.access_image(target, 0..1, Access::COLOR);
        self.emit();
        let attachment = [vk::RenderingAttachmentInfo::default()
            .image_view(target.inner.view(0..1, false)?)
            .image_layout(Access::COLOR.layout)
            .load_op(vk::AttachmentLoadOp::CLEAR)
            .store_op(vk::AttachmentStoreOp::STORE)
            .clear_value(vk::ClearValue {
                color: vk::ClearColorValue { float32: ground },
            })];
        let [width, height] = target.inner.size;
        let area = vk::Rect2D {
            offset: vk::Offset2D::default(),
            extent: vk::Extent2D { width, height },
        };
        let rendering = vk::RenderingInfo::default()
            .render_area(area)
            .layer_count(1)
            .color_attachments(&attachment);
        // SAFETY: recording; the image is in its layout by the barrier above.
        unsafe { self.device().cmd_begin_rendering(self.commands, &rendering) };
        self.set_dynamic_state(area, false);
        let painted = layers
            .iter()
            .try_for_each(|layer| self.paint_layer(target, layer));
        // SAFETY: rendering was begun above.
        unsafe { self.device().cmd_end_rendering(self.commands) };
        painted
    }

    fn paint_layer(&mut self, target: &Image, layer: &Painted<'_>) -> Result<(), GpuError> {
        let description = GraphicsDescription {
            shaders: layer.shaders,
            attributes: &[],
            strip: false,
            output: if layer.is_opaque {
                Output::Opaque(target.inner.format)
            } else {
                Output::Blended(target.inner.format)
            },
        };
        let pipeline = self.gpu.shared.graphics_pipeline(
            description,
            1,
            interface(&layer.binds, &layer.push),
        )?;
        self.bind(
            &pipeline,
            vk::PipelineBindPoint::GRAPHICS,
            &layer.binds,
            &layer.push,
        )?;
        let [left, top, width, height] = layer.clip;
        let clip = vk::Rect2D {
            offset: vk::Offset2D {
                x: left as i32,
                y: top as i32,
            },
            extent: vk::Extent2D { width, height },
        };
        // SAFETY: rendering; the pipeline's scissor is dynamic.
        unsafe { self.device().cmd_set_scissor(self.commands, 0, &[clip]) };
        let Range { start, end } = layer.vertices;
        // SAFETY: rendering with everything bound.
        unsafe {
            self.device()
                .cmd_draw(self.commands, end - start, 1, start, 0)
        };
        Ok(())
    }

    /// Fills rows of an image of four bytes a texel.
    pub fn write_rows(
        &mut self,
        image: &Image,
        rows: Range<u32>,
        texels: &[[u8; 4]],
    ) -> Result<(), GpuError> {
        let staging = self.gpu.staging_from(&self.name, texels.as_flattened())?;
        self.copy_buffer_to_rows(&staging, image, 0, 0, rows);
        Ok(())
    }

    /// Leaves an image to the window's system.
    pub(in crate::instrument::gpu) fn release_to_window(&mut self, image: &Image) {
        self.access_image(image, 0..1, Access::PRESENT);
        self.emit();
    }
}
