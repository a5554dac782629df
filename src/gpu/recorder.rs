//! Recording and submitting commands; barriers follow from tracked access.

use super::device::Shared;
use super::pipeline::Inner as Pipeline;
use super::sync::Access;
use super::{Buffer, ComputePipeline, Gpu, GpuError, GraphicsPipeline, Image, Sampler, Slot};
use ash::vk;
use std::any::Any;
use std::ffi::CString;
use std::ops::Range;
use std::sync::Arc;
use std::time::Instant;

/// Timed passes of one submission at most.
const PASS_LIMIT: u32 = 256;
/// Descriptor sets of one pool; a recorder adds pools as it needs them.
const SETS_PER_POOL: u32 = 32;

/// A resource bound to a slot, and how the shader uses it.
#[derive(Clone)]
pub enum Bind<'a> {
    /// All levels of an image through a sampler.
    Sample(&'a Image, &'a Sampler),
    /// One level of an image through a sampler; the shader sees it as level 0.
    SampleMip(&'a Image, &'a Sampler, u32),
    /// One level of an image, written only.
    StoreMip(&'a Image, u32),
    Read(&'a Buffer),
    /// Written only: whatever was in it is lost.
    Write(&'a Buffer),
    ReadWrite(&'a Buffer),
}

impl Bind<'_> {
    fn slot(&self) -> Slot {
        match self {
            Self::Sample(..) | Self::SampleMip(..) => Slot::Sampled,
            Self::StoreMip(..) => Slot::StorageImage,
            Self::Read(_) | Self::Write(_) | Self::ReadWrite(_) => Slot::Buffer,
        }
    }
}

/// One draw of a graphics pipeline.
#[derive(Clone, Copy)]
pub struct DrawCall<'a> {
    /// One buffer an attribute.
    pub vertex_buffers: &'a [&'a Buffer],
    /// u32 indices; without them vertices are drawn in order.
    pub index_buffer: Option<&'a Buffer>,
    /// Indices or vertices.
    pub count: u32,
    pub instance_count: u32,
}

/// Device time of one pass.
#[derive(Clone, Debug, PartialEq)]
pub struct PassTime {
    pub pass: &'static str,
    pub ms: f64,
}

/// What a submission took.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Report {
    /// In the order of recording.
    pub passes: Vec<PassTime>,
    /// Host time from submission to completion, ms.
    pub wall_ms: f64,
}

impl Report {
    /// Adds another submission's times; passes of the same name become one.
    pub fn add(&mut self, other: Report) {
        for time in other.passes {
            match self.passes.iter_mut().find(|known| known.pass == time.pass) {
                Some(known) => known.ms += time.ms,
                None => self.passes.push(time),
            }
        }
        self.wall_ms += other.wall_ms;
    }
}

/// Records one command buffer.
pub struct Recorder {
    gpu: Gpu,
    name: String,
    command_pool: vk::CommandPool,
    commands: vk::CommandBuffer,
    queries: vk::QueryPool,
    passes: Vec<&'static str>,
    descriptor_pools: Vec<vk::DescriptorPool>,
    sets_left: u32,
    /// Everything that the commands use.
    kept: Vec<Arc<dyn Any + Send + Sync>>,
}

impl Gpu {
    /// Starts recording; `name` is for the debugger and for errors.
    pub fn record(&self, name: &str) -> Result<Recorder, GpuError> {
        let device = &self.shared.raw;
        let mut recorder = Recorder {
            gpu: self.clone(),
            name: name.into(),
            command_pool: vk::CommandPool::null(),
            commands: vk::CommandBuffer::null(),
            queries: vk::QueryPool::null(),
            passes: Vec::new(),
            descriptor_pools: Vec::new(),
            sets_left: 0,
            kept: Vec::new(),
        };
        let pool = vk::CommandPoolCreateInfo::default()
            .queue_family_index(self.shared.queue_family)
            .flags(vk::CommandPoolCreateFlags::TRANSIENT);
        // SAFETY: the device is alive. One pool a recorder, so that recorders may live on different threads.
        recorder.command_pool =
            unsafe { device.create_command_pool(&pool, None) }.map_err(GpuError::call("vkCreateCommandPool", name))?;
        let allocate = vk::CommandBufferAllocateInfo::default()
            .command_pool(recorder.command_pool)
            .level(vk::CommandBufferLevel::PRIMARY)
            .command_buffer_count(1);
        // SAFETY: the pool was just made.
        recorder.commands = unsafe { device.allocate_command_buffers(&allocate) }
            .map_err(GpuError::call("vkAllocateCommandBuffers", name))?[0];
        self.shared.set_name(recorder.commands, name);
        let begin = vk::CommandBufferBeginInfo::default().flags(vk::CommandBufferUsageFlags::ONE_TIME_SUBMIT);
        // SAFETY: the command buffer is new.
        unsafe { device.begin_command_buffer(recorder.commands, &begin) }
            .map_err(GpuError::call("vkBeginCommandBuffer", name))?;
        Ok(recorder)
    }
}

impl Recorder {
    fn device(&self) -> &ash::Device {
        &self.gpu.shared.raw
    }

    /// Records `body` as one timed pass.
    ///
    /// Full barriers stand on both sides of each timestamp: lavapipe writes it into the wrong interval without the one behind,
    /// and the one before keeps passes from overlapping.
    pub fn pass(
        &mut self,
        name: &'static str,
        body: impl FnOnce(&mut Self) -> Result<(), GpuError>,
    ) -> Result<(), GpuError> {
        if self.queries == vk::QueryPool::null() {
            let info =
                vk::QueryPoolCreateInfo::default().query_type(vk::QueryType::TIMESTAMP).query_count(2 * PASS_LIMIT);
            // SAFETY: the device is alive.
            self.queries = unsafe { self.device().create_query_pool(&info, None) }
                .map_err(GpuError::call("vkCreateQueryPool", &self.name))?;
            // SAFETY: recording; the pool was just made and has this many queries.
            unsafe { self.device().cmd_reset_query_pool(self.commands, self.queries, 0, 2 * PASS_LIMIT) };
        }
        let index = self.passes.len() as u32;
        assert!(index < PASS_LIMIT, "'{}': more than {PASS_LIMIT} timed passes in one submission", self.name);
        self.passes.push(name);
        self.begin_label(name);
        self.timestamp(2 * index);
        let outcome = body(self);
        self.timestamp(2 * index + 1);
        self.end_label();
        outcome
    }

    /// Binds and dispatches; `push` are the push constants' bytes.
    pub fn dispatch(
        &mut self,
        pipeline: &ComputePipeline,
        binds: &[Bind<'_>],
        push: &[u8],
        groups: [u32; 3],
    ) -> Result<(), GpuError> {
        let inner = &pipeline.inner;
        self.check(inner, binds, push);
        let limits = self.gpu.shared.limits.max_compute_work_group_count;
        if let Some((&needed, &limit)) = groups.iter().zip(&limits).find(|(group, limit)| group > limit) {
            let name = inner.name.clone();
            return Err(GpuError::Limit { what: "work groups of", name, needed: needed.into(), limit: limit.into() });
        }
        self.access_binds(binds);
        self.bind(inner, vk::PipelineBindPoint::COMPUTE, binds, push)?;
        // SAFETY: recording, the pipeline with its set and constants is bound, and the counts are within the limits.
        unsafe { self.device().cmd_dispatch(self.commands, groups[0], groups[1], groups[2]) };
        self.kept.push(inner.clone());
        Ok(())
    }

    /// Draws into `colors` and `depth` (cleared first if `clear`: colours to 0, depth to 1).
    pub fn draw(
        &mut self,
        pipeline: &GraphicsPipeline,
        binds: &[Bind<'_>],
        push: &[u8],
        colors: &[&Image],
        depth: &Image,
        clear: bool,
        call: DrawCall<'_>,
    ) -> Result<(), GpuError> {
        let inner = &pipeline.inner;
        self.check(inner, binds, push);
        self.access_binds(binds);
        let mut barriers = Barriers::default();
        for image in colors {
            self.access_image(image, 0..1, Access::COLOR, &mut barriers);
        }
        self.access_image(depth, 0..1, Access::DEPTH, &mut barriers);
        for buffer in call.vertex_buffers {
            self.access_buffer(buffer, Access::VERTEX, &mut barriers);
        }
        if let Some(buffer) = call.index_buffer {
            self.access_buffer(buffer, Access::INDEX, &mut barriers);
        }
        self.emit(&barriers);

        let load = if clear { vk::AttachmentLoadOp::CLEAR } else { vk::AttachmentLoadOp::LOAD };
        let attachment = |view, layout, value| {
            vk::RenderingAttachmentInfo::default()
                .image_view(view)
                .image_layout(layout)
                .load_op(load)
                .store_op(vk::AttachmentStoreOp::STORE)
                .clear_value(value)
        };
        let mut color_infos = Vec::with_capacity(colors.len());
        for image in colors {
            let value = vk::ClearValue { color: vk::ClearColorValue { float32: [0.0; 4] } };
            color_infos.push(attachment(image.inner.view(0..1)?, Access::COLOR.layout, value));
        }
        let far = vk::ClearValue { depth_stencil: vk::ClearDepthStencilValue { depth: 1.0, stencil: 0 } };
        let depth_info = attachment(depth.inner.view(0..1)?, Access::DEPTH.layout, far);
        let [width, height] = depth.inner.size;
        let area = vk::Rect2D { offset: vk::Offset2D::default(), extent: vk::Extent2D { width, height } };
        let rendering = vk::RenderingInfo::default()
            .render_area(area)
            .layer_count(1)
            .color_attachments(&color_infos)
            .depth_attachment(&depth_info);
        let viewport =
            vk::Viewport { x: 0.0, y: 0.0, width: width as f32, height: height as f32, min_depth: 0.0, max_depth: 1.0 };
        // SAFETY: recording; attachments are in their layouts by the barriers above.
        unsafe { self.device().cmd_begin_rendering(self.commands, &rendering) };
        // SAFETY: recording; the pipeline's viewport is dynamic.
        unsafe { self.device().cmd_set_viewport(self.commands, 0, &[viewport]) };
        // SAFETY: likewise.
        unsafe { self.device().cmd_set_scissor(self.commands, 0, &[area]) };
        self.bind(inner, vk::PipelineBindPoint::GRAPHICS, binds, push)?;
        let vertex_buffers: Vec<_> = call.vertex_buffers.iter().map(|buffer| buffer.inner.raw).collect();
        if !vertex_buffers.is_empty() {
            let offsets = vec![0; vertex_buffers.len()];
            // SAFETY: recording; the buffers are kept alive below.
            unsafe { self.device().cmd_bind_vertex_buffers(self.commands, 0, &vertex_buffers, &offsets) };
        }
        if let Some(buffer) = call.index_buffer {
            // SAFETY: likewise.
            unsafe { self.device().cmd_bind_index_buffer(self.commands, buffer.inner.raw, 0, vk::IndexType::UINT32) };
            // SAFETY: inside rendering with everything bound.
            unsafe { self.device().cmd_draw_indexed(self.commands, call.count, call.instance_count, 0, 0, 0) };
        } else {
            // SAFETY: inside rendering with everything bound.
            unsafe { self.device().cmd_draw(self.commands, call.count, call.instance_count, 0, 0) };
        }
        // SAFETY: rendering was begun above.
        unsafe { self.device().cmd_end_rendering(self.commands) };
        self.kept.push(inner.clone());
        Ok(())
    }

    /// Fills a buffer with a 32-bit word.
    pub fn fill(&mut self, buffer: &Buffer, word: u32) {
        let mut barriers = Barriers::default();
        self.access_buffer(buffer, Access::FILL, &mut barriers);
        self.emit(&barriers);
        // SAFETY: recording; sizes are multiples of 4 and the buffer is kept alive.
        unsafe { self.device().cmd_fill_buffer(self.commands, buffer.inner.raw, 0, buffer.size() & !3, word) };
    }

    /// Copies a whole buffer to another of the same size.
    pub(super) fn copy_buffer(&mut self, from: &Buffer, to: &Buffer) -> Result<(), GpuError> {
        assert_eq!(from.size(), to.size(), "'{}': sizes of a copy", self.name);
        let mut barriers = Barriers::default();
        self.access_buffer(from, Access::COPY_READ, &mut barriers);
        self.access_buffer(to, Access::COPY_WRITE, &mut barriers);
        self.emit(&barriers);
        let region = [vk::BufferCopy { src_offset: 0, dst_offset: 0, size: from.size() }];
        // SAFETY: recording; both are kept alive and as large as the region.
        unsafe { self.device().cmd_copy_buffer(self.commands, from.inner.raw, to.inner.raw, &region) };
        self.host_visible(to);
        Ok(())
    }

    pub(super) fn copy_buffer_to_image(&mut self, from: &Buffer, image: &Image, mip: u32) {
        let mut barriers = Barriers::default();
        self.access_buffer(from, Access::COPY_READ, &mut barriers);
        self.access_image(image, mip..mip + 1, Access::COPY_WRITE, &mut barriers);
        self.emit(&barriers);
        let region = [image_region(image, mip)];
        let layout = Access::COPY_WRITE.layout;
        // SAFETY: recording; both are kept alive, the image is in its layout, the buffer holds the level.
        unsafe {
            self.device().cmd_copy_buffer_to_image(self.commands, from.inner.raw, image.inner.raw, layout, &region)
        };
    }

    pub(super) fn copy_image_to_buffer(&mut self, image: &Image, mip: u32, to: &Buffer) {
        let mut barriers = Barriers::default();
        self.access_image(image, mip..mip + 1, Access::COPY_READ, &mut barriers);
        self.access_buffer(to, Access::COPY_WRITE, &mut barriers);
        self.emit(&barriers);
        let region = [image_region(image, mip)];
        let layout = Access::COPY_READ.layout;
        // SAFETY: recording; both are kept alive, the image is in its layout, the buffer holds the level.
        unsafe {
            self.device().cmd_copy_image_to_buffer(self.commands, image.inner.raw, layout, to.inner.raw, &region)
        };
        self.host_visible(to);
    }

    /// Ends the recording, submits it, waits, and reads the timestamps.
    pub fn submit(self) -> Result<Report, GpuError> {
        let shared = &self.gpu.shared;
        // SAFETY: recording.
        unsafe { self.device().end_command_buffer(self.commands) }
            .map_err(GpuError::call("vkEndCommandBuffer", &self.name))?;
        let fence = Fence::new(shared, &self.name)?;
        let commands = [vk::CommandBufferSubmitInfo::default().command_buffer(self.commands)];
        let submit = [vk::SubmitInfo2::default().command_buffer_infos(&commands)];
        let started;
        {
            let _one_at_a_time = shared.submission.lock().unwrap_or_else(|poisoned| poisoned.into_inner());
            started = Instant::now();
            // SAFETY: the command buffer is complete and what it uses is kept alive until the fence is signalled.
            unsafe { self.device().queue_submit2(shared.queue, &submit, fence.raw) }
                .map_err(GpuError::call("vkQueueSubmit2", &self.name))?;
        }
        // SAFETY: the fence was just submitted.
        unsafe { self.device().wait_for_fences(&[fence.raw], true, u64::MAX) }
            .map_err(GpuError::call("vkWaitForFences", &self.name))?;
        let wall_ms = started.elapsed().as_secs_f64() * 1e3;
        Ok(Report { passes: self.pass_times()?, wall_ms })
    }

    fn pass_times(&self) -> Result<Vec<PassTime>, GpuError> {
        if self.passes.is_empty() {
            return Ok(Vec::new());
        }
        let mut ticks = vec![0u64; 2 * self.passes.len()];
        let flags = vk::QueryResultFlags::TYPE_64 | vk::QueryResultFlags::WAIT;
        // SAFETY: the queries were written by the submission that has completed.
        unsafe { self.device().get_query_pool_results(self.queries, 0, &mut ticks, flags) }
            .map_err(GpuError::call("vkGetQueryPoolResults", &self.name))?;
        let shared = &self.gpu.shared;
        let ms = |pair: &[u64]| {
            let elapsed = pair[1].wrapping_sub(pair[0]) & shared.timestamp_mask;
            elapsed as f64 * f64::from(shared.info.timestamp_period_ns) * 1e-6
        };
        Ok(self.passes.iter().zip(ticks.chunks_exact(2)).map(|(pass, pair)| PassTime { pass, ms: ms(pair) }).collect())
    }

    fn timestamp(&mut self, query: u32) {
        self.full_barrier();
        // SAFETY: recording; the query exists and was reset.
        unsafe {
            self.device().cmd_write_timestamp2(
                self.commands,
                vk::PipelineStageFlags2::ALL_COMMANDS,
                self.queries,
                query,
            )
        };
        self.full_barrier();
    }

    fn full_barrier(&self) {
        let all = vk::PipelineStageFlags2::ALL_COMMANDS;
        let any = vk::AccessFlags2::MEMORY_READ | vk::AccessFlags2::MEMORY_WRITE;
        let memory = [vk::MemoryBarrier2::default()
            .src_stage_mask(all)
            .src_access_mask(vk::AccessFlags2::MEMORY_WRITE)
            .dst_stage_mask(all)
            .dst_access_mask(any)];
        let info = vk::DependencyInfo::default().memory_barriers(&memory);
        // SAFETY: recording.
        unsafe { self.device().cmd_pipeline_barrier2(self.commands, &info) };
    }

    fn begin_label(&self, name: &str) {
        if let (Some(debug), Ok(name)) = (self.gpu.shared.debug(), CString::new(name)) {
            let label = vk::DebugUtilsLabelEXT::default().label_name(&name);
            // SAFETY: recording; the label is copied by the call.
            unsafe { debug.cmd_begin_debug_utils_label(self.commands, &label) };
        }
    }

    fn end_label(&self) {
        if let Some(debug) = self.gpu.shared.debug() {
            // SAFETY: recording; a label was begun.
            unsafe { debug.cmd_end_debug_utils_label(self.commands) };
        }
    }

    fn check(&self, pipeline: &Pipeline, binds: &[Bind<'_>], push: &[u8]) {
        let name = &pipeline.name;
        assert!(
            binds.iter().map(Bind::slot).eq(pipeline.slots.iter().copied()),
            "'{name}': bindings differ from its slots"
        );
        assert_eq!(push.len(), pipeline.push_size as usize, "'{name}': push constants");
    }

    fn bind(
        &mut self,
        pipeline: &Pipeline,
        point: vk::PipelineBindPoint,
        binds: &[Bind<'_>],
        push: &[u8],
    ) -> Result<(), GpuError> {
        let set = self.descriptor_set(pipeline, binds)?;
        let device = self.device();
        // SAFETY: recording; the pipeline is kept alive by the caller.
        unsafe { device.cmd_bind_pipeline(self.commands, point, pipeline.raw) };
        if let Some(set) = set {
            // SAFETY: the set was made for this layout.
            unsafe { device.cmd_bind_descriptor_sets(self.commands, point, pipeline.layout, 0, &[set], &[]) };
        }
        if !push.is_empty() {
            // SAFETY: the layout has a range of this size at offset 0.
            unsafe { device.cmd_push_constants(self.commands, pipeline.layout, pipeline.stages, 0, push) };
        }
        Ok(())
    }

    fn descriptor_set(
        &mut self,
        pipeline: &Pipeline,
        binds: &[Bind<'_>],
    ) -> Result<Option<vk::DescriptorSet>, GpuError> {
        if binds.is_empty() {
            return Ok(None);
        }
        let name = self.name.clone();
        if self.sets_left == 0 {
            // Room for sets of 16 bindings of each kind, more than any pass has.
            let sizes = [Slot::Sampled, Slot::StorageImage, Slot::Buffer]
                .map(|slot| vk::DescriptorPoolSize { ty: slot.raw(), descriptor_count: 16 * SETS_PER_POOL });
            let info = vk::DescriptorPoolCreateInfo::default().max_sets(SETS_PER_POOL).pool_sizes(&sizes);
            // SAFETY: the device is alive.
            let pool = unsafe { self.device().create_descriptor_pool(&info, None) }
                .map_err(GpuError::call("vkCreateDescriptorPool", &name))?;
            self.descriptor_pools.push(pool);
            self.sets_left = SETS_PER_POOL;
        }
        self.sets_left -= 1;
        let pool = *self.descriptor_pools.last().expect("a pool was just made if there was none");
        let layouts = [pipeline.set_layout];
        let allocate = vk::DescriptorSetAllocateInfo::default().descriptor_pool(pool).set_layouts(&layouts);
        // SAFETY: the pool has room for this set.
        let set = unsafe { self.device().allocate_descriptor_sets(&allocate) }
            .map_err(GpuError::call("vkAllocateDescriptorSets", &name))?[0];

        let mut images = Vec::with_capacity(binds.len());
        let mut buffers = Vec::with_capacity(binds.len());
        for bind in binds {
            let (mut image, mut buffer) = (vk::DescriptorImageInfo::default(), vk::DescriptorBufferInfo::default());
            match bind {
                Bind::Sample(i, sampler) => {
                    image = image.sampler(sampler.inner.raw).image_view(i.inner.view(0..i.mip_count())?);
                    image.image_layout = Access::SAMPLE.layout;
                }
                Bind::SampleMip(i, sampler, mip) => {
                    image = image.sampler(sampler.inner.raw).image_view(i.inner.view(*mip..*mip + 1)?);
                    image.image_layout = Access::SAMPLE.layout;
                }
                Bind::StoreMip(i, mip) => {
                    image = image.image_view(i.inner.view(*mip..*mip + 1)?);
                    image.image_layout = Access::IMAGE_WRITE.layout;
                }
                Bind::Read(b) | Bind::Write(b) | Bind::ReadWrite(b) => {
                    buffer = buffer.buffer(b.inner.raw).range(vk::WHOLE_SIZE);
                }
            }
            images.push([image]);
            buffers.push([buffer]);
        }
        let writes: Vec<_> = binds
            .iter()
            .zip(0..)
            .map(|(bind, binding)| {
                let write = vk::WriteDescriptorSet::default()
                    .dst_set(set)
                    .dst_binding(binding)
                    .descriptor_type(bind.slot().raw());
                match bind.slot() {
                    Slot::Buffer => write.buffer_info(&buffers[binding as usize]),
                    Slot::Sampled | Slot::StorageImage => write.image_info(&images[binding as usize]),
                }
            })
            .collect();
        // SAFETY: the set is new and every handle is alive.
        unsafe { self.device().update_descriptor_sets(&writes, &[]) };
        Ok(Some(set))
    }

    fn access_binds(&mut self, binds: &[Bind<'_>]) {
        let mut barriers = Barriers::default();
        for bind in binds {
            match bind {
                Bind::Sample(image, sampler) => {
                    self.access_image(image, 0..image.mip_count(), Access::SAMPLE, &mut barriers);
                    self.kept.push(sampler.inner.clone());
                }
                Bind::SampleMip(image, sampler, mip) => {
                    self.access_image(image, *mip..*mip + 1, Access::SAMPLE, &mut barriers);
                    self.kept.push(sampler.inner.clone());
                }
                Bind::StoreMip(image, mip) => {
                    self.access_image(image, *mip..*mip + 1, Access::IMAGE_WRITE, &mut barriers);
                }
                Bind::Read(buffer) => self.access_buffer(buffer, Access::BUFFER_READ, &mut barriers),
                Bind::Write(buffer) => self.access_buffer(buffer, Access::BUFFER_WRITE, &mut barriers),
                Bind::ReadWrite(buffer) => self.access_buffer(buffer, Access::BUFFER_READ_WRITE, &mut barriers),
            }
        }
        self.emit(&barriers);
    }

    fn access_image(&mut self, image: &Image, mips: Range<u32>, access: Access, barriers: &mut Barriers) {
        let mut states = image.inner.states.lock().unwrap_or_else(|poisoned| poisoned.into_inner());
        for mip in mips {
            let Some(barrier) = states[mip as usize].advance(access, true) else { continue };
            let range = vk::ImageSubresourceRange {
                aspect_mask: image.inner.format.aspect(),
                base_mip_level: mip,
                level_count: 1,
                base_array_layer: 0,
                layer_count: 1,
            };
            barriers.images.push(
                vk::ImageMemoryBarrier2::default()
                    .src_stage_mask(barrier.src_stage)
                    .src_access_mask(barrier.src_access)
                    .dst_stage_mask(barrier.dst.stage)
                    .dst_access_mask(barrier.dst.access)
                    .old_layout(barrier.old_layout)
                    .new_layout(barrier.dst.layout)
                    .src_queue_family_index(vk::QUEUE_FAMILY_IGNORED)
                    .dst_queue_family_index(vk::QUEUE_FAMILY_IGNORED)
                    .image(image.inner.raw)
                    .subresource_range(range),
            );
        }
        self.kept.push(image.inner.clone());
    }

    fn access_buffer(&mut self, buffer: &Buffer, access: Access, barriers: &mut Barriers) {
        let mut state = buffer.inner.state.lock().unwrap_or_else(|poisoned| poisoned.into_inner());
        if let Some(barrier) = state.advance(access, false) {
            barriers.buffers.push(
                vk::BufferMemoryBarrier2::default()
                    .src_stage_mask(barrier.src_stage)
                    .src_access_mask(barrier.src_access)
                    .dst_stage_mask(barrier.dst.stage)
                    .dst_access_mask(barrier.dst.access)
                    .src_queue_family_index(vk::QUEUE_FAMILY_IGNORED)
                    .dst_queue_family_index(vk::QUEUE_FAMILY_IGNORED)
                    .buffer(buffer.inner.raw)
                    .size(vk::WHOLE_SIZE),
            );
        }
        self.kept.push(buffer.inner.clone());
    }

    /// Makes what a copy wrote visible to the host, in case the target is mapped.
    fn host_visible(&mut self, buffer: &Buffer) {
        let mut barriers = Barriers::default();
        self.access_buffer(buffer, Access::HOST_READ, &mut barriers);
        self.emit(&barriers);
    }

    fn emit(&self, barriers: &Barriers) {
        if barriers.images.is_empty() && barriers.buffers.is_empty() {
            return;
        }
        let info = vk::DependencyInfo::default()
            .image_memory_barriers(&barriers.images)
            .buffer_memory_barriers(&barriers.buffers);
        // SAFETY: recording; every handle is kept alive.
        unsafe { self.device().cmd_pipeline_barrier2(self.commands, &info) };
    }
}

impl Drop for Recorder {
    fn drop(&mut self) {
        // SAFETY: the submission (if any) has been waited for; null handles are ignored.
        unsafe { self.device().destroy_command_pool(self.command_pool, None) };
        // SAFETY: likewise.
        unsafe { self.device().destroy_query_pool(self.queries, None) };
        for pool in &self.descriptor_pools {
            // SAFETY: likewise.
            unsafe { self.device().destroy_descriptor_pool(*pool, None) };
        }
    }
}

#[derive(Default)]
struct Barriers {
    images: Vec<vk::ImageMemoryBarrier2<'static>>,
    buffers: Vec<vk::BufferMemoryBarrier2<'static>>,
}

fn image_region(image: &Image, mip: u32) -> vk::BufferImageCopy {
    let [width, height] = image.mip_size(mip);
    vk::BufferImageCopy {
        image_subresource: vk::ImageSubresourceLayers {
            aspect_mask: image.inner.format.aspect(),
            mip_level: mip,
            base_array_layer: 0,
            layer_count: 1,
        },
        image_extent: vk::Extent3D { width, height, depth: 1 },
        ..Default::default()
    }
}

struct Fence<'a> {
    raw: vk::Fence,
    device: &'a Shared,
}

impl<'a> Fence<'a> {
    fn new(device: &'a Shared, name: &str) -> Result<Self, GpuError> {
        // SAFETY: the device is alive.
        let raw = unsafe { device.raw.create_fence(&vk::FenceCreateInfo::default(), None) }
            .map_err(GpuError::call("vkCreateFence", name))?;
        Ok(Self { raw, device })
    }
}

impl Drop for Fence<'_> {
    fn drop(&mut self) {
        // SAFETY: the fence has been waited for, or was never submitted.
        unsafe { self.device.raw.destroy_fence(self.raw, None) };
    }
}
