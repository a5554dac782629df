//! Recorded commands: dispatches, draws, fills, copies.

use super::binding::interface;
use super::{Bind, Recorder};
use crate::instrument::gpu::sync::Access;
use crate::instrument::gpu::{Buffer, GpuError, GraphicsDescription, Groups, Image};
use ash::vk;
use std::ops::Range;

#[derive(Clone, Copy)]
pub struct DrawCall<'a> {
    pub vertex_buffers: &'a [&'a Buffer],
    /// u32 indices; without them vertices are drawn in order.
    pub index_buffer: Option<&'a Buffer>,
    /// Number of indices, or of vertices without an index buffer.
    pub count: u32,
    pub instance_count: u32,
    pub is_one_sided: bool,
}

#[derive(Clone, Copy)]
pub struct Targets<'a> {
    pub colors: &'a [&'a Image],
    pub depth: &'a Image,
    /// Clears first: colours to 0, depth to 1.
    pub clear: bool,
}

impl Recorder {
    /// Dispatches a shader permutation with specialization constants 0, 1, ...; `push` are push
    /// constants' bytes.
    pub fn dispatch(
        &mut self,
        shader: &str,
        constants: &[u32],
        binds: &[Bind<'_>],
        push: &[u8],
        groups: impl Into<Groups>,
    ) -> Result<(), GpuError> {
        let shared = &self.gpu.shared;
        let pipeline = shared.compute_pipeline(shader, constants, interface(binds, push))?;
        let limits = shared.limits.max_compute_work_group_count;
        let Groups {
            first: [x, y, z],
            count: [columns, rows, layers],
        } = groups.into();
        let ends = [x + columns, y + rows, z + layers];
        if let Some((needed, &limit)) = ends
            .into_iter()
            .zip(&limits)
            .find(|(end, limit)| end > *limit)
        {
            return Err(GpuError::Limit {
                what: "work groups of",
                name: shader.to_owned(),
                needed: needed.into(),
                limit: limit.into(),
            });
        }
        self.access_binds(binds);
        self.emit();
        self.bind(&pipeline, vk::PipelineBindPoint::COMPUTE, binds, push)?;
        // SAFETY: recording; the pipeline with its set and constants is bound and takes a first
        // group; the groups are within the limits.
        unsafe {
            self.device()
                .cmd_dispatch_base(self.commands, x, y, z, columns, rows, layers)
        };
        self.shaders.insert(shader.to_owned());
        Ok(())
    }

    pub fn draw(
        &mut self,
        description: GraphicsDescription<'_>,
        binds: &[Bind<'_>],
        push: &[u8],
        targets: Targets<'_>,
        call: DrawCall<'_>,
    ) -> Result<(), GpuError> {
        let interface = interface(binds, push);
        let pipeline =
            self.gpu
                .shared
                .graphics_pipeline(description, targets.colors.len(), interface)?;
        self.access_binds(binds);
        self.access_targets(targets);
        for buffer in call.vertex_buffers {
            self.access_buffer(buffer, Access::VERTEX);
        }
        if let Some(buffer) = call.index_buffer {
            self.access_buffer(buffer, Access::INDEX);
        }
        self.emit();
        self.begin_rendering(targets, call.is_one_sided)?;
        self.bind(&pipeline, vk::PipelineBindPoint::GRAPHICS, binds, push)?;
        self.draw_vertices(call);
        // SAFETY: rendering was begun above.
        unsafe { self.device().cmd_end_rendering(self.commands) };
        self.shaders.extend(description.shaders.map(str::to_owned));
        Ok(())
    }

    fn access_targets(&mut self, targets: Targets<'_>) {
        for image in targets.colors {
            self.access_image(image, 0..1, Access::COLOR);
        }
        self.access_image(targets.depth, 0..1, Access::DEPTH);
    }

    /// Begins rendering to whole targets and sets the dynamic state.
    fn begin_rendering(&self, targets: Targets<'_>, is_one_sided: bool) -> Result<(), GpuError> {
        let Targets {
            colors,
            depth,
            clear,
        } = targets;
        let load = if clear {
            vk::AttachmentLoadOp::CLEAR
        } else {
            vk::AttachmentLoadOp::LOAD
        };
        let attachment = |view, layout, value| {
            vk::RenderingAttachmentInfo::default()
                .image_view(view)
                .image_layout(layout)
                .load_op(load)
                .store_op(vk::AttachmentStoreOp::STORE)
                .clear_value(value)
        };
        let black = vk::ClearValue {
            color: vk::ClearColorValue { float32: [0.0; 4] },
        };
        let far = vk::ClearValue {
            depth_stencil: vk::ClearDepthStencilValue {
                depth: 1.0,
                stencil: 0,
            },
        };
        let mut color_infos = Vec::with_capacity(colors.len());
        for image in colors {
            let view = image.inner.view(0..1, false)?;
            color_infos.push(attachment(view, Access::COLOR.layout, black));
        }
        let depth_info = attachment(depth.inner.view(0..1, false)?, Access::DEPTH.layout, far);
        let [width, height] = depth.inner.size;
        let area = vk::Rect2D {
            offset: vk::Offset2D::default(),
            extent: vk::Extent2D { width, height },
        };
        let rendering = vk::RenderingInfo::default()
            .render_area(area)
            .layer_count(1)
            .color_attachments(&color_infos)
            .depth_attachment(&depth_info);
        // SAFETY: recording; attachments are in their layouts by the barriers of the caller.
        unsafe { self.device().cmd_begin_rendering(self.commands, &rendering) };
        self.set_dynamic_state(area, is_one_sided);
        Ok(())
    }

    pub(super) fn set_dynamic_state(&self, area: vk::Rect2D, is_one_sided: bool) {
        let viewport = vk::Viewport {
            x: 0.0,
            y: 0.0,
            width: area.extent.width as f32,
            height: area.extent.height as f32,
            min_depth: 0.0,
            max_depth: 1.0,
        };
        // SAFETY: recording; the pipeline's viewport is dynamic.
        unsafe {
            self.device()
                .cmd_set_viewport(self.commands, 0, &[viewport])
        };
        // SAFETY: likewise.
        unsafe { self.device().cmd_set_scissor(self.commands, 0, &[area]) };
        let culled = if is_one_sided {
            vk::CullModeFlags::BACK
        } else {
            vk::CullModeFlags::NONE
        };
        // SAFETY: likewise.
        unsafe { self.device().cmd_set_cull_mode(self.commands, culled) };
    }

    /// Draws the vertices of a call; the pipeline is bound.
    fn draw_vertices(&self, call: DrawCall<'_>) {
        let vertex_buffers: Vec<_> = call
            .vertex_buffers
            .iter()
            .map(|buffer| buffer.inner.raw)
            .collect();
        if !vertex_buffers.is_empty() {
            let offsets = vec![0; vertex_buffers.len()];
            // SAFETY: recording; `access_buffer` keeps the buffers alive.
            unsafe {
                self.device()
                    .cmd_bind_vertex_buffers(self.commands, 0, &vertex_buffers, &offsets)
            };
        }
        if let Some(buffer) = call.index_buffer {
            // SAFETY: likewise.
            unsafe {
                self.device().cmd_bind_index_buffer(
                    self.commands,
                    buffer.inner.raw,
                    0,
                    vk::IndexType::UINT32,
                )
            };
            // SAFETY: inside rendering with everything bound.
            unsafe {
                self.device().cmd_draw_indexed(
                    self.commands,
                    call.count,
                    call.instance_count,
                    0,
                    0,
                    0,
                )
            };
        } else {
            // SAFETY: inside rendering with everything bound.
            unsafe {
                self.device()
                    .cmd_draw(self.commands, call.count, call.instance_count, 0, 0)
            };
        }
    }

    pub fn fill(&mut self, buffer: &Buffer, word: u32) {
        self.access_buffer(buffer, Access::FILL);
        self.emit();
        // SAFETY: recording; sizes are multiples of 4 and the buffer is kept alive.
        unsafe {
            self.device().cmd_fill_buffer(
                self.commands,
                buffer.inner.raw,
                0,
                buffer.size() & !3,
                word,
            )
        };
    }

    /// Copies a whole buffer to another of the same size.
    pub(in crate::instrument::gpu) fn copy_buffer(
        &mut self,
        from: &Buffer,
        to: &Buffer,
    ) -> Result<(), GpuError> {
        assert_eq!(from.size(), to.size(), "'{}': sizes of a copy", self.name);
        self.access_buffer(from, Access::COPY_READ);
        self.access_buffer(to, Access::COPY_WRITE);
        self.emit();
        let region = [vk::BufferCopy {
            src_offset: 0,
            dst_offset: 0,
            size: from.size(),
        }];
        // SAFETY: recording; both are kept alive and as large as the region.
        unsafe {
            self.device()
                .cmd_copy_buffer(self.commands, from.inner.raw, to.inner.raw, &region)
        };
        // The target may be mapped.
        self.access_buffer(to, Access::HOST_READ);
        self.emit();
        Ok(())
    }

    /// Fills rows of one face of a level from a buffer that holds just these rows.
    pub(in crate::instrument::gpu) fn copy_buffer_to_rows(
        &mut self,
        from: &Buffer,
        image: &Image,
        face: u32,
        mip: u32,
        rows: Range<u32>,
    ) {
        self.access_buffer(from, Access::COPY_READ);
        self.access_image(image, mip..mip + 1, Access::COPY_WRITE);
        self.emit();
        let region = [image_region(image, mip, face..face + 1, rows)];
        let layout = Access::COPY_WRITE.layout;
        // SAFETY: recording; both are kept alive, the image is in its layout, the buffer holds the
        // rows.
        unsafe {
            self.device().cmd_copy_buffer_to_image(
                self.commands,
                from.inner.raw,
                image.inner.raw,
                layout,
                &region,
            )
        };
    }

    /// Fills a buffer with rows of a level, face by face.
    pub(in crate::instrument::gpu) fn copy_rows_to_buffer(
        &mut self,
        image: &Image,
        mip: u32,
        rows: Range<u32>,
        to: &Buffer,
    ) {
        self.access_image(image, mip..mip + 1, Access::COPY_READ);
        self.access_buffer(to, Access::COPY_WRITE);
        self.emit();
        let region = [image_region(image, mip, 0..image.face_count(), rows)];
        let layout = Access::COPY_READ.layout;
        // SAFETY: recording; both are kept alive, the image is in its layout, the buffer holds the
        // rows.
        unsafe {
            self.device().cmd_copy_image_to_buffer(
                self.commands,
                image.inner.raw,
                layout,
                to.inner.raw,
                &region,
            )
        };
        // The target may be mapped.
        self.access_buffer(to, Access::HOST_READ);
        self.emit();
    }
}

/// Describes rows of faces of a level.
fn image_region(
    image: &Image,
    mip: u32,
    faces: Range<u32>,
    rows: Range<u32>,
) -> vk::BufferImageCopy {
    let [width, _] = image.mip_size(mip);
    vk::BufferImageCopy {
        image_subresource: vk::ImageSubresourceLayers {
            aspect_mask: image.inner.format.aspect(),
            mip_level: mip,
            base_array_layer: faces.start,
            layer_count: faces.end - faces.start,
        },
        image_offset: vk::Offset3D {
            x: 0,
            y: rows.start as i32,
            z: 0,
        },
        image_extent: vk::Extent3D {
            width,
            height: rows.end - rows.start,
            depth: 1,
        },
        ..Default::default()
    }
}
