//! Compute and graphics pipelines.

use super::device::Shared;
use super::shader::spirv;
use super::{Format, Gpu, GpuError};
use ash::vk;
use std::sync::Arc;

/// Kind of one binding of descriptor set 0; the index in the list is the binding's number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Slot {
    /// `sampler2D`.
    Sampled,
    /// `image2D`.
    StorageImage,
    /// `buffer`.
    Buffer,
    /// `uniform` block.
    Uniform,
}

impl Slot {
    pub(super) fn raw(self) -> vk::DescriptorType {
        match self {
            Self::Sampled => vk::DescriptorType::COMBINED_IMAGE_SAMPLER,
            Self::StorageImage => vk::DescriptorType::STORAGE_IMAGE,
            Self::Buffer => vk::DescriptorType::STORAGE_BUFFER,
            Self::Uniform => vk::DescriptorType::UNIFORM_BUFFER,
        }
    }
}

/// Layout, pipeline and what they need to be freed.
pub(super) struct Inner {
    pub(super) raw: vk::Pipeline,
    pub(super) layout: vk::PipelineLayout,
    pub(super) set_layout: vk::DescriptorSetLayout,
    pub(super) slots: Vec<Slot>,
    pub(super) push_size: u32,
    pub(super) stages: vk::ShaderStageFlags,
    /// The last shader's.
    pub(super) name: String,
    pub(super) shaders: Vec<String>,
    device: Arc<Shared>,
}

/// A compute pipeline. Clones share it.
#[derive(Clone)]
pub struct ComputePipeline {
    pub(super) inner: Arc<Inner>,
}

/// A graphics pipeline with dynamic rendering. Clones share it.
#[derive(Clone)]
pub struct GraphicsPipeline {
    pub(super) inner: Arc<Inner>,
}

/// What a graphics pipeline draws: opaque triangles, counter-clockwise in front, depth test (less), no culling, viewport and scissor of
/// the targets.
#[derive(Clone, Copy, Debug)]
pub struct GraphicsDescription<'a> {
    /// The vertex and the fragment shader.
    pub shaders: [&'a str; 2],
    pub slots: &'a [Slot],
    pub push_size: usize,
    /// Floats of each vertex attribute, one tightly packed buffer an attribute.
    pub attributes: &'a [u32],
    pub color_count: usize,
    /// Triangle strip instead of a list.
    pub strip: bool,
}

impl Inner {
    fn new(
        gpu: &Gpu,
        shaders: &[&str],
        slots: &[Slot],
        push_size: usize,
        stages: vk::ShaderStageFlags,
    ) -> Result<Self, GpuError> {
        let name = shaders.last().copied().unwrap_or_default();
        let device = &gpu.shared;
        let limit = device.limits.max_push_constants_size;
        assert!(push_size <= 128 && push_size as u32 <= limit, "'{name}': {push_size} bytes of push constants");
        let mut inner = Self {
            raw: vk::Pipeline::null(),
            layout: vk::PipelineLayout::null(),
            set_layout: vk::DescriptorSetLayout::null(),
            slots: slots.to_vec(),
            push_size: push_size as u32,
            stages,
            name: name.into(),
            shaders: shaders.iter().map(|shader| shader.to_string()).collect(),
            device: device.clone(),
        };
        let bindings: Vec<_> = slots
            .iter()
            .zip(0..)
            .map(|(slot, binding)| {
                vk::DescriptorSetLayoutBinding::default()
                    .binding(binding)
                    .descriptor_type(slot.raw())
                    .descriptor_count(1)
                    .stage_flags(stages)
            })
            .collect();
        let set_info = vk::DescriptorSetLayoutCreateInfo::default().bindings(&bindings);
        // SAFETY: the device is alive and the description is complete.
        inner.set_layout = unsafe { device.raw.create_descriptor_set_layout(&set_info, None) }
            .map_err(GpuError::call("vkCreateDescriptorSetLayout", name))?;
        let ranges = [vk::PushConstantRange { stage_flags: stages, offset: 0, size: push_size as u32 }];
        let set_layouts = [inner.set_layout];
        let info = vk::PipelineLayoutCreateInfo::default()
            .set_layouts(&set_layouts)
            .push_constant_ranges(if push_size > 0 { &ranges } else { &[] });
        // SAFETY: likewise.
        inner.layout = unsafe { device.raw.create_pipeline_layout(&info, None) }
            .map_err(GpuError::call("vkCreatePipelineLayout", name))?;
        Ok(inner)
    }
}

impl Drop for Inner {
    fn drop(&mut self) {
        // SAFETY: no pending command uses these (or they are null), because `submit` waits and recorders hold what they record.
        unsafe { self.device.raw.destroy_pipeline(self.raw, None) };
        // SAFETY: likewise.
        unsafe { self.device.raw.destroy_pipeline_layout(self.layout, None) };
        // SAFETY: likewise.
        unsafe { self.device.raw.destroy_descriptor_set_layout(self.set_layout, None) };
    }
}

/// A shader module that lives while its pipeline is made.
struct Module<'a> {
    raw: vk::ShaderModule,
    device: &'a Shared,
}

impl<'a> Module<'a> {
    fn new(device: &'a Shared, name: &str) -> Result<Self, GpuError> {
        let words = spirv(name)?;
        let info = vk::ShaderModuleCreateInfo::default().code(&words);
        // SAFETY: the words are SPIR-V from the build script.
        let raw = unsafe { device.raw.create_shader_module(&info, None) }
            .map_err(GpuError::call("vkCreateShaderModule", name))?;
        Ok(Self { raw, device })
    }
}

impl Drop for Module<'_> {
    fn drop(&mut self) {
        // SAFETY: pipelines do not need the module once they are made.
        unsafe { self.device.raw.destroy_shader_module(self.raw, None) };
    }
}

impl Gpu {
    /// The compute pipeline of the shader permutation `shader`, with specialization constants 0, 1, ... set to `constants`.
    pub fn compute_pipeline(
        &self,
        shader: &str,
        slots: &[Slot],
        push_size: usize,
        constants: &[u32],
    ) -> Result<ComputePipeline, GpuError> {
        let device = &self.shared;
        let mut inner = Inner::new(self, &[shader], slots, push_size, vk::ShaderStageFlags::COMPUTE)?;
        let module = Module::new(device, shader)?;
        let entries: Vec<_> = (0..constants.len() as u32)
            .map(|id| vk::SpecializationMapEntry { constant_id: id, offset: 4 * id, size: 4 })
            .collect();
        let specialization =
            vk::SpecializationInfo::default().map_entries(&entries).data(bytemuck::cast_slice(constants));
        let stage = vk::PipelineShaderStageCreateInfo::default()
            .stage(vk::ShaderStageFlags::COMPUTE)
            .module(module.raw)
            .name(c"main")
            .specialization_info(&specialization);
        let info = vk::ComputePipelineCreateInfo::default().stage(stage).layout(inner.layout);
        // SAFETY: module and layout are alive; the description is complete.
        let made = unsafe { device.raw.create_compute_pipelines(vk::PipelineCache::null(), &[info], None) };
        let pipelines = made.map_err(|(_, result)| GpuError::call("vkCreateComputePipelines", shader)(result))?;
        inner.raw = pipelines[0];
        device.set_name(inner.raw, shader);
        Ok(ComputePipeline { inner: Arc::new(inner) })
    }

    /// The graphics pipeline of a description.
    pub fn graphics_pipeline(&self, description: GraphicsDescription<'_>) -> Result<GraphicsPipeline, GpuError> {
        let device = &self.shared;
        let [vertex_shader, fragment_shader] = description.shaders;
        let name = fragment_shader;
        let stages = vk::ShaderStageFlags::VERTEX | vk::ShaderStageFlags::FRAGMENT;
        let mut inner = Inner::new(self, &description.shaders, description.slots, description.push_size, stages)?;
        let vertex = Module::new(device, vertex_shader)?;
        let fragment = Module::new(device, fragment_shader)?;
        let shader_stages = [(vk::ShaderStageFlags::VERTEX, &vertex), (vk::ShaderStageFlags::FRAGMENT, &fragment)].map(
            |(stage, module)| {
                vk::PipelineShaderStageCreateInfo::default().stage(stage).module(module.raw).name(c"main")
            },
        );
        let attribute_format = |floats: u32| match floats {
            2 => vk::Format::R32G32_SFLOAT,
            3 => vk::Format::R32G32B32_SFLOAT,
            _ => vk::Format::R32G32B32A32_SFLOAT,
        };
        let bindings: Vec<_> = (0..)
            .zip(description.attributes)
            .map(|(binding, floats)| vk::VertexInputBindingDescription {
                binding,
                stride: 4 * floats,
                input_rate: vk::VertexInputRate::VERTEX,
            })
            .collect();
        let attributes: Vec<_> = (0..)
            .zip(description.attributes)
            .map(|(location, &floats)| vk::VertexInputAttributeDescription {
                location,
                binding: location,
                format: attribute_format(floats),
                offset: 0,
            })
            .collect();
        let vertex_input = vk::PipelineVertexInputStateCreateInfo::default()
            .vertex_binding_descriptions(&bindings)
            .vertex_attribute_descriptions(&attributes);
        let topology = match description.strip {
            true => vk::PrimitiveTopology::TRIANGLE_STRIP,
            false => vk::PrimitiveTopology::TRIANGLE_LIST,
        };
        let assembly = vk::PipelineInputAssemblyStateCreateInfo::default().topology(topology);
        let viewport = vk::PipelineViewportStateCreateInfo::default().viewport_count(1).scissor_count(1);
        let raster = vk::PipelineRasterizationStateCreateInfo::default()
            .front_face(vk::FrontFace::COUNTER_CLOCKWISE)
            .line_width(1.0);
        let samples =
            vk::PipelineMultisampleStateCreateInfo::default().rasterization_samples(vk::SampleCountFlags::TYPE_1);
        let depth = vk::PipelineDepthStencilStateCreateInfo::default()
            .depth_test_enable(true)
            .depth_write_enable(true)
            .depth_compare_op(vk::CompareOp::LESS);
        let blends = vec![
            vk::PipelineColorBlendAttachmentState::default()
                .color_write_mask(vk::ColorComponentFlags::RGBA);
            description.color_count
        ];
        let blend = vk::PipelineColorBlendStateCreateInfo::default().attachments(&blends);
        let dynamic_states = [vk::DynamicState::VIEWPORT, vk::DynamicState::SCISSOR];
        let dynamic = vk::PipelineDynamicStateCreateInfo::default().dynamic_states(&dynamic_states);
        let formats = vec![Format::Rgba32Float.raw(); description.color_count];
        let mut rendering = vk::PipelineRenderingCreateInfo::default()
            .color_attachment_formats(&formats)
            .depth_attachment_format(Format::Depth32Float.raw());
        let info = vk::GraphicsPipelineCreateInfo::default()
            .stages(&shader_stages)
            .vertex_input_state(&vertex_input)
            .input_assembly_state(&assembly)
            .viewport_state(&viewport)
            .rasterization_state(&raster)
            .multisample_state(&samples)
            .depth_stencil_state(&depth)
            .color_blend_state(&blend)
            .dynamic_state(&dynamic)
            .layout(inner.layout)
            .push_next(&mut rendering);
        // SAFETY: modules and layout are alive; the description is complete.
        let made = unsafe { device.raw.create_graphics_pipelines(vk::PipelineCache::null(), &[info], None) };
        let pipelines = made.map_err(|(_, result)| GpuError::call("vkCreateGraphicsPipelines", name)(result))?;
        inner.raw = pipelines[0];
        device.set_name(inner.raw, name);
        Ok(GraphicsPipeline { inner: Arc::new(inner) })
    }
}
