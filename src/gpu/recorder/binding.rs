//! Binding resources: descriptor sets, and the barriers that each use of a resource needs.

use super::Recorder;
use crate::gpu::pipeline::Inner as Pipeline;
use crate::gpu::sync::Access;
use crate::gpu::{Buffer, GpuError, Image, Sampler, Slot};
use ash::vk;
use std::ops::Range;

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
    /// One level of an image, read and written.
    UpdateMip(&'a Image, u32),
    Read(&'a Buffer),
    /// Written only: whatever was in it is lost.
    Write(&'a Buffer),
    ReadWrite(&'a Buffer),
    /// Bytes of a buffer of [`crate::gpu::Gpu::uniform_from`], as many as the shader's block has.
    Uniform(&'a Buffer, Range<u64>),
}

impl Bind<'_> {
    fn slot(&self) -> Slot {
        match self {
            Self::Sample(..) | Self::SampleMip(..) => Slot::Sampled,
            Self::StoreMip(..) | Self::UpdateMip(..) => Slot::StorageImage,
            Self::Read(_) | Self::Write(_) | Self::ReadWrite(_) => Slot::Buffer,
            Self::Uniform(..) => Slot::Uniform,
        }
    }
}

#[derive(Default)]
pub(super) struct Barriers {
    images: Vec<vk::ImageMemoryBarrier2<'static>>,
    buffers: Vec<vk::BufferMemoryBarrier2<'static>>,
}

impl Recorder {
    pub(super) fn check(&self, pipeline: &Pipeline, binds: &[Bind<'_>], push: &[u8]) {
        let name = &pipeline.name;
        assert!(
            binds.iter().map(Bind::slot).eq(pipeline.slots.iter().copied()),
            "'{name}': bindings differ from its slots"
        );
        assert_eq!(push.len(), pipeline.push_size as usize, "'{name}': push constants");
    }

    pub(super) fn bind(
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
            let sizes = [Slot::Sampled, Slot::StorageImage, Slot::Buffer, Slot::Uniform]
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
                Bind::StoreMip(i, mip) | Bind::UpdateMip(i, mip) => {
                    image = image.image_view(i.inner.view(*mip..*mip + 1)?);
                    image.image_layout = Access::IMAGE_WRITE.layout;
                }
                Bind::Read(b) | Bind::Write(b) | Bind::ReadWrite(b) => {
                    buffer = buffer.buffer(b.inner.raw).range(vk::WHOLE_SIZE);
                }
                Bind::Uniform(b, bytes) => {
                    buffer = buffer.buffer(b.inner.raw).offset(bytes.start).range(bytes.end - bytes.start);
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
                    Slot::Buffer | Slot::Uniform => write.buffer_info(&buffers[binding as usize]),
                    Slot::Sampled | Slot::StorageImage => write.image_info(&images[binding as usize]),
                }
            })
            .collect();
        // SAFETY: the set is new and every handle is alive.
        unsafe { self.device().update_descriptor_sets(&writes, &[]) };
        Ok(Some(set))
    }

    pub(super) fn access_binds(&mut self, binds: &[Bind<'_>]) {
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
                Bind::UpdateMip(image, mip) => {
                    self.access_image(image, *mip..*mip + 1, Access::IMAGE_READ_WRITE, &mut barriers);
                }
                Bind::Uniform(buffer, _) => self.access_buffer(buffer, Access::UNIFORM_READ, &mut barriers),
                Bind::Read(buffer) => self.access_buffer(buffer, Access::BUFFER_READ, &mut barriers),
                Bind::Write(buffer) => self.access_buffer(buffer, Access::BUFFER_WRITE, &mut barriers),
                Bind::ReadWrite(buffer) => self.access_buffer(buffer, Access::BUFFER_READ_WRITE, &mut barriers),
            }
        }
        self.emit(&barriers);
    }

    pub(super) fn access_image(&mut self, image: &Image, mips: Range<u32>, access: Access, barriers: &mut Barriers) {
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

    pub(super) fn access_buffer(&mut self, buffer: &Buffer, access: Access, barriers: &mut Barriers) {
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
    pub(super) fn host_visible(&mut self, buffer: &Buffer) {
        let mut barriers = Barriers::default();
        self.access_buffer(buffer, Access::HOST_READ, &mut barriers);
        self.emit(&barriers);
    }

    pub(super) fn emit(&self, barriers: &Barriers) {
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
