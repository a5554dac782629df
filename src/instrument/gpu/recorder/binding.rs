//! Binds resources: descriptor sets, and the barriers that each use needs.

use super::Recorder;
use crate::instrument::gpu::device::lock;
use crate::instrument::gpu::kept_pipeline::{Interface, Pipeline};
use crate::instrument::gpu::sync::Access;
use crate::instrument::gpu::{Buffer, GpuError, Image, Sampler};
use ash::vk::{self, DescriptorType as Kind};
use std::mem::take;
use std::ops::Range;

/// Descriptor sets per pool; a recorder adds pools on demand.
const SETS_PER_POOL: u32 = 32;

/// A resource bound to a slot, and how the shader uses it.
#[derive(Clone)]
pub enum Bind<'a> {
    /// All levels of an image.
    Sample(&'a Image, Sampler),
    /// One level of an image; the shader sees it as level 0.
    SampleMip(&'a Image, Sampler, u32),
    /// The faces of one level as layers.
    SampleFaces(&'a Image, Sampler, u32),
    /// One level of an image, written only.
    StoreMip(&'a Image, u32),
    /// The faces of one level as layers, written only.
    StoreFaces(&'a Image, u32),
    /// The faces of one level as layers, read and written.
    UpdateFaces(&'a Image, u32),
    Read(&'a Buffer),
    /// Written only: earlier contents are lost.
    Write(&'a Buffer),
    ReadWrite(&'a Buffer),
    /// A range of bytes of a buffer of [`crate::instrument::gpu::Gpu::uniform_from`], as large as the shader's
    /// block.
    Uniform(&'a Buffer, Range<u64>),
}

enum Resource<'a> {
    Image {
        image: &'a Image,
        mips: Range<u32>,
        /// Whether the shader sees the faces as layers.
        is_array: bool,
        sampler: Option<Sampler>,
    },
    Buffer(&'a Buffer, Range<u64>),
}

impl<'a> Bind<'a> {
    /// Returns the descriptor type, the access and the resource.
    fn parts(&self) -> (Kind, Access, Resource<'a>) {
        let whole = |buffer| Resource::Buffer(buffer, 0..vk::WHOLE_SIZE);
        let sampled = |image, mips, is_array, sampler| {
            let resource = Resource::Image {
                image,
                mips,
                is_array,
                sampler: Some(sampler),
            };
            (Kind::COMBINED_IMAGE_SAMPLER, Access::SAMPLE, resource)
        };
        let stored = |image, mip: u32, is_array, access| {
            (
                Kind::STORAGE_IMAGE,
                access,
                Resource::Image {
                    image,
                    mips: mip..mip + 1,
                    is_array,
                    sampler: None,
                },
            )
        };
        match *self {
            Self::Sample(image, sampler) => sampled(image, 0..image.mip_count(), false, sampler),
            Self::SampleMip(image, sampler, mip) => sampled(image, mip..mip + 1, false, sampler),
            Self::SampleFaces(image, sampler, mip) => sampled(image, mip..mip + 1, true, sampler),
            Self::StoreMip(image, mip) => stored(image, mip, false, Access::STORE),
            Self::StoreFaces(image, mip) => stored(image, mip, true, Access::STORE),
            Self::UpdateFaces(image, mip) => stored(image, mip, true, Access::UPDATE),
            Self::Read(buffer) => (Kind::STORAGE_BUFFER, Access::LOAD, whole(buffer)),
            Self::Write(buffer) => (Kind::STORAGE_BUFFER, Access::STORE, whole(buffer)),
            Self::ReadWrite(buffer) => (Kind::STORAGE_BUFFER, Access::UPDATE, whole(buffer)),
            Self::Uniform(buffer, ref bytes) => (
                Kind::UNIFORM_BUFFER,
                Access::UNIFORM,
                Resource::Buffer(buffer, bytes.clone()),
            ),
        }
    }
}

/// Returns the interface of a shader with these binds and push constants.
pub(super) fn interface(binds: &[Bind<'_>], push: &[u8]) -> Interface {
    Interface {
        kinds: binds.iter().map(|bind| bind.parts().0).collect(),
        push_size: push.len(),
    }
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
        unsafe {
            device.cmd_bind_descriptor_sets(self.commands, point, pipeline.layout, 0, &[set], &[])
        };
        if !push.is_empty() {
            // SAFETY: the layout has a range of this size at offset 0.
            unsafe {
                device.cmd_push_constants(self.commands, pipeline.layout, pipeline.stages, 0, push)
            };
        }
        Ok(())
    }

    fn descriptor_set(
        &mut self,
        pipeline: &Pipeline,
        binds: &[Bind<'_>],
    ) -> Result<vk::DescriptorSet, GpuError> {
        if self.sets_left == 0 {
            // Room for 16 bindings of each kind per set, more than any pass has.
            let kinds = [
                Kind::COMBINED_IMAGE_SAMPLER,
                Kind::STORAGE_IMAGE,
                Kind::STORAGE_BUFFER,
                Kind::UNIFORM_BUFFER,
            ];
            let sizes = kinds.map(|ty| vk::DescriptorPoolSize {
                ty,
                descriptor_count: 16 * SETS_PER_POOL,
            });
            let info = vk::DescriptorPoolCreateInfo::default()
                .max_sets(SETS_PER_POOL)
                .pool_sizes(&sizes);
            // SAFETY: the device is alive.
            let pool = unsafe { self.device().create_descriptor_pool(&info, None) }
                .map_err(GpuError::call("vkCreateDescriptorPool", &self.name))?;
            self.descriptor_pools.push(pool);
            self.sets_left = SETS_PER_POOL;
        }
        self.sets_left -= 1;
        let pool = *self
            .descriptor_pools
            .last()
            .expect("a pool was just made if there was none");
        let layouts = [pipeline.set_layout];
        let allocate = vk::DescriptorSetAllocateInfo::default()
            .descriptor_pool(pool)
            .set_layouts(&layouts);
        // SAFETY: the pool has room for this set.
        let set = unsafe { self.device().allocate_descriptor_sets(&allocate) }
            .map_err(GpuError::call("vkAllocateDescriptorSets", &self.name))?[0];

        // The kind of a bind decides which of the two is read.
        let mut images = vec![[vk::DescriptorImageInfo::default()]; binds.len()];
        let mut buffers = vec![[vk::DescriptorBufferInfo::default()]; binds.len()];
        for ((bind, [image_info]), [buffer_info]) in binds.iter().zip(&mut images).zip(&mut buffers)
        {
            match bind.parts() {
                (
                    _,
                    access,
                    Resource::Image {
                        image,
                        mips,
                        is_array,
                        sampler,
                    },
                ) => {
                    let sampler = sampler
                        .map(|sampler| self.gpu.shared.sampler(sampler))
                        .transpose()?;
                    let (image_view, image_layout) =
                        (image.inner.view(mips, is_array)?, access.layout);
                    let sampler = sampler.unwrap_or_default();
                    *image_info = vk::DescriptorImageInfo {
                        sampler,
                        image_view,
                        image_layout,
                    };
                }
                (_, _, Resource::Buffer(buffer, bytes)) => {
                    *buffer_info = buffer_info
                        .buffer(buffer.inner.raw)
                        .offset(bytes.start)
                        .range(bytes.end - bytes.start);
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

    pub(super) fn access_binds(&mut self, binds: &[Bind<'_>]) {
        for bind in binds {
            match bind.parts() {
                (_, access, Resource::Image { image, mips, .. }) => {
                    self.access_image(image, mips, access)
                }
                (_, access, Resource::Buffer(buffer, _)) => self.access_buffer(buffer, access),
            }
        }
    }

    /// Tracks the next access of levels of an image; [`Self::emit`] records the barrier.
    pub(super) fn access_image(&mut self, image: &Image, mips: Range<u32>, access: Access) {
        let mut states = lock(&image.inner.states);
        for mip in mips {
            let Some(barrier) = states[mip as usize].advance(access, true) else {
                continue;
            };
            let range = vk::ImageSubresourceRange {
                aspect_mask: image.inner.format.aspect(),
                base_mip_level: mip,
                level_count: 1,
                base_array_layer: 0,
                layer_count: image.face_count(),
            };
            self.image_barriers.push(
                vk::ImageMemoryBarrier2::default()
                    .src_stage_mask(barrier.src_stage)
                    .src_access_mask(barrier.src_access)
                    .dst_stage_mask(barrier.dst.stage)
                    .dst_access_mask(barrier.dst.access)
                    .old_layout(barrier.old_layout)
                    .new_layout(barrier.dst.layout)
                    .image(image.inner.raw)
                    .subresource_range(range),
            );
        }
        self.kept.push(image.inner.clone());
    }

    pub(super) fn access_buffer(&mut self, buffer: &Buffer, access: Access) {
        let mut state = lock(&buffer.inner.state);
        if let Some(barrier) = state.advance(access, false) {
            self.buffer_barriers.push(
                vk::BufferMemoryBarrier2::default()
                    .src_stage_mask(barrier.src_stage)
                    .src_access_mask(barrier.src_access)
                    .dst_stage_mask(barrier.dst.stage)
                    .dst_access_mask(barrier.dst.access)
                    .buffer(buffer.inner.raw)
                    .size(vk::WHOLE_SIZE),
            );
        }
        self.kept.push(buffer.inner.clone());
    }

    /// Records the barriers of all accesses since the last call.
    pub(super) fn emit(&mut self) {
        let (images, buffers) = (
            take(&mut self.image_barriers),
            take(&mut self.buffer_barriers),
        );
        if images.is_empty() && buffers.is_empty() {
            return;
        }
        let info = vk::DependencyInfo::default()
            .image_memory_barriers(&images)
            .buffer_memory_barriers(&buffers);
        // SAFETY: recording; every handle is kept alive.
        unsafe { self.device().cmd_pipeline_barrier2(self.commands, &info) };
    }
}
