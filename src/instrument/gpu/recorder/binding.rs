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
    /// A range of bytes of a buffer of
    /// [`crate::instrument::gpu::Gpu::buffer_bound_in_parts`], from a multiple of 256 on.
    ReadWritePart(&'a Buffer, Range<u64>),
    /// A range of bytes of a buffer of [`crate::instrument::gpu::Gpu::uniform_from`], as large as
    /// the shader's block.
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

/// What a descriptor needs to know of a bind.
struct Binding<'a> {
    kind: Kind,
    access: Access,
    resource: Resource<'a>,
}

impl<'a> Bind<'a> {
    fn binding(&self) -> Binding<'a> {
        match *self {
            Self::Sample(image, sampler) => sampled(image, sampler, 0..image.mip_count(), false),
            Self::SampleMip(image, sampler, mip) => sampled(image, sampler, mip..mip + 1, false),
            Self::SampleFaces(image, sampler, mip) => sampled(image, sampler, mip..mip + 1, true),
            Self::StoreMip(image, mip) => stored(image, mip, false, Access::STORE),
            Self::StoreFaces(image, mip) => stored(image, mip, true, Access::STORE),
            Self::UpdateFaces(image, mip) => stored(image, mip, true, Access::UPDATE),
            Self::Read(buffer) => storage(buffer, WHOLE, Access::LOAD),
            Self::Write(buffer) => storage(buffer, WHOLE, Access::STORE),
            Self::ReadWrite(buffer) => storage(buffer, WHOLE, Access::UPDATE),
            Self::ReadWritePart(buffer, ref bytes) => {
                storage(buffer, bytes.clone(), Access::UPDATE)
            }
            Self::Uniform(buffer, ref bytes) => Binding {
                kind: Kind::UNIFORM_BUFFER,
                access: Access::UNIFORM,
                resource: Resource::Buffer(buffer, bytes.clone()),
            },
        }
    }
}

fn sampled(image: &Image, sampler: Sampler, mips: Range<u32>, is_array: bool) -> Binding<'_> {
    Binding {
        kind: Kind::COMBINED_IMAGE_SAMPLER,
        access: Access::SAMPLE,
        resource: Resource::Image {
            image,
            mips,
            is_array,
            sampler: Some(sampler),
        },
    }
}

fn stored(image: &Image, mip: u32, is_array: bool, access: Access) -> Binding<'_> {
    Binding {
        kind: Kind::STORAGE_IMAGE,
        access,
        resource: Resource::Image {
            image,
            mips: mip..mip + 1,
            is_array,
            sampler: None,
        },
    }
}

const WHOLE: Range<u64> = 0..vk::WHOLE_SIZE;

fn storage(buffer: &Buffer, bytes: Range<u64>, access: Access) -> Binding<'_> {
    Binding {
        kind: Kind::STORAGE_BUFFER,
        access,
        resource: Resource::Buffer(buffer, bytes),
    }
}

/// Returns the interface of a shader with these binds and push constants.
pub(super) fn interface(binds: &[Bind<'_>], push: &[u8]) -> Interface {
    Interface {
        kinds: binds.iter().map(|bind| bind.binding().kind).collect(),
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
        let set = self.allocate_descriptor_set(pipeline)?;
        // The kind of a bind decides which of the two is read.
        let mut images = vec![[vk::DescriptorImageInfo::default()]; binds.len()];
        let mut buffers = vec![[vk::DescriptorBufferInfo::default()]; binds.len()];
        for ((bind, [image_info]), [buffer_info]) in binds.iter().zip(&mut images).zip(&mut buffers)
        {
            let binding = bind.binding();
            match binding.resource {
                Resource::Image {
                    image,
                    mips,
                    is_array,
                    sampler,
                } => {
                    let sampler = match sampler {
                        Some(sampler) => self.gpu.shared.sampler(sampler)?,
                        None => vk::Sampler::default(),
                    };
                    *image_info = vk::DescriptorImageInfo {
                        sampler,
                        image_view: image.inner.view(mips, is_array)?,
                        image_layout: binding.access.layout,
                    };
                }
                Resource::Buffer(buffer, bytes) => {
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
                    .descriptor_type(bind.binding().kind)
                    .image_info(image)
                    .buffer_info(buffer)
            })
            .collect();
        // SAFETY: the set is new and every handle is alive.
        unsafe { self.device().update_descriptor_sets(&writes, &[]) };
        Ok(set)
    }

    /// Takes a set from the last pool, or from a new one if that is used up.
    fn allocate_descriptor_set(
        &mut self,
        pipeline: &Pipeline,
    ) -> Result<vk::DescriptorSet, GpuError> {
        if self.sets_left == 0 {
            let pool = self.make_descriptor_pool()?;
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
        let sets = unsafe { self.device().allocate_descriptor_sets(&allocate) }
            .map_err(GpuError::call("vkAllocateDescriptorSets", &self.name))?;
        Ok(sets[0])
    }

    fn make_descriptor_pool(&self) -> Result<vk::DescriptorPool, GpuError> {
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
        unsafe { self.device().create_descriptor_pool(&info, None) }
            .map_err(GpuError::call("vkCreateDescriptorPool", &self.name))
    }

    pub(super) fn access_binds(&mut self, binds: &[Bind<'_>]) {
        for bind in binds {
            let binding = bind.binding();
            match binding.resource {
                Resource::Image { image, mips, .. } => {
                    self.access_image(image, mips, binding.access)
                }
                Resource::Buffer(buffer, _) => self.access_buffer(buffer, binding.access),
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
        let images = take(&mut self.image_barriers);
        let buffers = take(&mut self.buffer_barriers);
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
