//! Binding resources: descriptor sets, and the barriers that each use of a resource needs.

use super::Recorder;
use crate::gpu::device::lock;
use crate::gpu::kept_pipeline::{Interface, Pipeline};
use crate::gpu::sync::Access;
use crate::gpu::{Buffer, GpuError, Image, Sampler};
use ash::vk::{self, DescriptorType as Kind};
use std::ops::Range;

/// Descriptor sets of one pool; a recorder adds pools as it needs them.
const SETS_PER_POOL: u32 = 32;

/// A resource bound to a slot, and how the shader uses it.
#[derive(Clone)]
pub enum Bind<'a> {
    /// All levels of an image through a sampler.
    Sample(&'a Image, Sampler),
    /// One level of an image through a sampler; the shader sees it as level 0.
    SampleMip(&'a Image, Sampler, u32),
    /// The faces of one level as layers, through a sampler.
    SampleFaces(&'a Image, Sampler, u32),
    /// One level of an image, written only.
    StoreMip(&'a Image, u32),
    /// The faces of one level as layers, written only.
    StoreFaces(&'a Image, u32),
    /// The faces of one level as layers, read and written.
    UpdateFaces(&'a Image, u32),
    Read(&'a Buffer),
    /// Written only: whatever was in it is lost.
    Write(&'a Buffer),
    ReadWrite(&'a Buffer),
    /// Bytes of a buffer of [`crate::gpu::Gpu::uniform_from`], as many as the shader's block has.
    Uniform(&'a Buffer, Range<u64>),
}

/// What a bind names.
enum Resource<'a> {
    Image(&'a Image, Range<u32>, Option<Sampler>),
    /// The faces of one level as layers.
    Faces(&'a Image, u32, Option<Sampler>),
    Buffer(&'a Buffer, Range<u64>),
}

impl<'a> Bind<'a> {
    /// What the bind is to the shader, what the shader does with it, and what it names.
    fn parts(&self) -> (Kind, Access, Resource<'a>) {
        let whole = |buffer| Resource::Buffer(buffer, 0..vk::WHOLE_SIZE);
        match *self {
            Self::Sample(image, sampler) => (
                Kind::COMBINED_IMAGE_SAMPLER,
                Access::SAMPLE,
                Resource::Image(image, 0..image.mip_count(), Some(sampler)),
            ),
            Self::SampleMip(image, sampler, mip) => {
                (Kind::COMBINED_IMAGE_SAMPLER, Access::SAMPLE, Resource::Image(image, mip..mip + 1, Some(sampler)))
            }
            Self::SampleFaces(image, sampler, mip) => {
                (Kind::COMBINED_IMAGE_SAMPLER, Access::SAMPLE, Resource::Faces(image, mip, Some(sampler)))
            }
            Self::StoreMip(image, mip) => {
                (Kind::STORAGE_IMAGE, Access::STORE, Resource::Image(image, mip..mip + 1, None))
            }
            Self::StoreFaces(image, mip) => (Kind::STORAGE_IMAGE, Access::STORE, Resource::Faces(image, mip, None)),
            Self::UpdateFaces(image, mip) => (Kind::STORAGE_IMAGE, Access::UPDATE, Resource::Faces(image, mip, None)),
            Self::Read(buffer) => (Kind::STORAGE_BUFFER, Access::LOAD, whole(buffer)),
            Self::Write(buffer) => (Kind::STORAGE_BUFFER, Access::STORE, whole(buffer)),
            Self::ReadWrite(buffer) => (Kind::STORAGE_BUFFER, Access::UPDATE, whole(buffer)),
            Self::Uniform(buffer, ref bytes) => {
                (Kind::UNIFORM_BUFFER, Access::UNIFORM, Resource::Buffer(buffer, bytes.clone()))
            }
        }
    }
}

/// What a shader is given by these binds and push constants.
pub(super) fn interface(binds: &[Bind<'_>], push: &[u8]) -> Interface {
    Interface { kinds: binds.iter().map(|bind| bind.parts().0).collect(), push_size: push.len() }
}

#[derive(Default)]
pub(super) struct Barriers {
    images: Vec<vk::ImageMemoryBarrier2<'static>>,
    buffers: Vec<vk::BufferMemoryBarrier2<'static>>,
}

impl Recorder {
    pub(super) fn bind(
        &mut self,
        pipeline: &Pipeline,
        point: vk::PipelineBindPoint,
        binds: &[Bind<'_>],
        push: &[u8],
    ) -> Result<(), GpuError> {
        let set = self.descriptor_set(pipeline, binds)?;
        let device = self.device();
        // SAFETY: recording; the pipeline lives as long as the device.
        unsafe { device.cmd_bind_pipeline(self.commands, point, pipeline.raw) };
        // SAFETY: the set was made for this layout.
        unsafe { device.cmd_bind_descriptor_sets(self.commands, point, pipeline.layout, 0, &[set], &[]) };
        if !push.is_empty() {
            // SAFETY: the layout has a range of this size at offset 0.
            unsafe { device.cmd_push_constants(self.commands, pipeline.layout, pipeline.stages, 0, push) };
        }
        Ok(())
    }

    fn descriptor_set(&mut self, pipeline: &Pipeline, binds: &[Bind<'_>]) -> Result<vk::DescriptorSet, GpuError> {
        if self.sets_left == 0 {
            // Room for sets of 16 bindings of each kind, more than any pass has.
            let kinds = [Kind::COMBINED_IMAGE_SAMPLER, Kind::STORAGE_IMAGE, Kind::STORAGE_BUFFER, Kind::UNIFORM_BUFFER];
            let sizes = kinds.map(|ty| vk::DescriptorPoolSize { ty, descriptor_count: 16 * SETS_PER_POOL });
            let info = vk::DescriptorPoolCreateInfo::default().max_sets(SETS_PER_POOL).pool_sizes(&sizes);
            // SAFETY: the device is alive.
            let pool = unsafe { self.device().create_descriptor_pool(&info, None) }
                .map_err(GpuError::call("vkCreateDescriptorPool", &self.name))?;
            self.descriptor_pools.push(pool);
            self.sets_left = SETS_PER_POOL;
        }
        self.sets_left -= 1;
        let pool = *self.descriptor_pools.last().expect("a pool was just made if there was none");
        let layouts = [pipeline.set_layout];
        let allocate = vk::DescriptorSetAllocateInfo::default().descriptor_pool(pool).set_layouts(&layouts);
        // SAFETY: the pool has room for this set.
        let set = unsafe { self.device().allocate_descriptor_sets(&allocate) }
            .map_err(GpuError::call("vkAllocateDescriptorSets", &self.name))?[0];

        // Of each bind the one that its kind reads.
        let mut images = vec![[vk::DescriptorImageInfo::default()]; binds.len()];
        let mut buffers = vec![[vk::DescriptorBufferInfo::default()]; binds.len()];
        for ((bind, [image_info]), [buffer_info]) in binds.iter().zip(&mut images).zip(&mut buffers) {
            match bind.parts() {
                (_, access, Resource::Image(image, mips, sampler)) => {
                    *image_info = self.image_info(image.inner.view(mips)?, access, sampler)?;
                }
                (_, access, Resource::Faces(image, mip, sampler)) => {
                    *image_info = self.image_info(image.inner.faces(mip)?, access, sampler)?;
                }
                (_, _, Resource::Buffer(buffer, bytes)) => {
                    *buffer_info =
                        buffer_info.buffer(buffer.inner.raw).offset(bytes.start).range(bytes.end - bytes.start);
                }
            }
        }
        let infos = (0..).zip(binds).zip(images.iter().zip(&buffers));
        let writes: Vec<_> = infos
            .map(|((binding, bind), (image, buffer))| {
                vk::WriteDescriptorSet::default()
                    .dst_set(set)
                    .dst_binding(binding)
                    .descriptor_type(bind.parts().0)
                    .image_info(image)
                    .buffer_info(buffer)
            })
            .collect();
        // SAFETY: the set is new and every handle is alive.
        unsafe { self.device().update_descriptor_sets(&writes, &[]) };
        Ok(set)
    }

    fn image_info(
        &self,
        view: vk::ImageView,
        access: Access,
        sampler: Option<Sampler>,
    ) -> Result<vk::DescriptorImageInfo, GpuError> {
        let sampler = sampler.map(|sampler| self.gpu.shared.sampler(sampler)).transpose()?.unwrap_or_default();
        Ok(vk::DescriptorImageInfo { sampler, image_view: view, image_layout: access.layout })
    }

    pub(super) fn access_binds(&mut self, binds: &[Bind<'_>]) {
        let mut barriers = Barriers::default();
        for bind in binds {
            match bind.parts() {
                (_, access, Resource::Image(image, mips, _)) => self.access_image(image, mips, access, &mut barriers),
                (_, access, Resource::Faces(image, mip, _)) => {
                    self.access_image(image, mip..mip + 1, access, &mut barriers);
                }
                (_, access, Resource::Buffer(buffer, _)) => self.access_buffer(buffer, access, &mut barriers),
            }
        }
        self.emit(&barriers);
    }

    pub(super) fn access_image(&mut self, image: &Image, mips: Range<u32>, access: Access, barriers: &mut Barriers) {
        let mut states = lock(&image.inner.states);
        for mip in mips {
            let Some(barrier) = states[mip as usize].advance(access, true) else { continue };
            let range = vk::ImageSubresourceRange {
                aspect_mask: image.inner.format.aspect(),
                base_mip_level: mip,
                level_count: 1,
                base_array_layer: 0,
                layer_count: image.face_count(),
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
        let mut state = lock(&buffer.inner.state);
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
