//! Compute and graphics pipelines, made on first use and kept until the device closes.

use super::device::{Shared, lock};
use super::kept_pipeline::{Interface, Pipeline};
use super::shader::code_of;
use super::{Format, GpuError};
use ash::vk;
use std::sync::Arc;

/// A draw: triangles, front counter-clockwise; viewport of the targets, culling of the call.
#[derive(Clone, Copy, Debug)]
pub struct GraphicsDescription<'a> {
    pub shaders: [&'a str; 2],
    /// Floats per vertex of each attribute; each attribute has its own tightly packed buffer.
    pub attributes: &'a [u32],
    /// Draws a triangle strip instead of a list.
    pub strip: bool,
    pub output: Output,
}

/// The images that a graphics pipeline draws into.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Output {
    /// Images of [`Format::Rgba32Float`]: opaque, the nearest surface by depth.
    Surfaces,
    /// One image of this format, without depth.
    Opaque(Format),
    /// The same; colours, times their alpha, cover earlier ones.
    Blended(Format),
}

impl Output {
    fn depth_format(self) -> vk::Format {
        match self {
            Self::Surfaces => Format::Depth32Float.raw(),
            Self::Opaque(_) | Self::Blended(_) => vk::Format::UNDEFINED,
        }
    }

    fn color_format(self) -> vk::Format {
        match self {
            Self::Surfaces => Format::Rgba32Float.raw(),
            Self::Opaque(format) | Self::Blended(format) => format.raw(),
        }
    }

    fn blend(self) -> vk::PipelineColorBlendAttachmentState {
        let all = vk::PipelineColorBlendAttachmentState::default()
            .color_write_mask(vk::ColorComponentFlags::RGBA);
        match self {
            Self::Surfaces | Self::Opaque(_) => all,
            Self::Blended(_) => all
                .blend_enable(true)
                .src_color_blend_factor(vk::BlendFactor::ONE)
                .dst_color_blend_factor(vk::BlendFactor::ONE_MINUS_SRC_ALPHA)
                .src_alpha_blend_factor(vk::BlendFactor::ONE)
                .dst_alpha_blend_factor(vk::BlendFactor::ONE_MINUS_SRC_ALPHA),
        }
    }
}

impl Pipeline {
    fn new(
        shared: &Shared,
        name: &str,
        interface: Interface,
        stages: vk::ShaderStageFlags,
    ) -> Result<Self, GpuError> {
        let push_size = interface.push_size as u32;
        let limit = shared.limits.max_push_constants_size;
        assert!(
            push_size <= 128 && push_size <= limit,
            "'{name}': {push_size} bytes of push constants"
        );
        let bindings: Vec<_> = (0..)
            .zip(&interface.kinds)
            .map(|(binding, kind)| {
                vk::DescriptorSetLayoutBinding::default()
                    .binding(binding)
                    .descriptor_type(*kind)
                    .descriptor_count(1)
                    .stage_flags(stages)
            })
            .collect();
        let (raw, layout, set_layout) = Default::default();
        let mut pipeline = Self {
            raw,
            layout,
            set_layout,
            stages,
            interface,
            device: shared.raw.clone(),
        };
        let set_info = vk::DescriptorSetLayoutCreateInfo::default().bindings(&bindings);
        // SAFETY: the device is alive and the description is complete.
        pipeline.set_layout = unsafe {
            pipeline
                .device
                .create_descriptor_set_layout(&set_info, None)
        }
        .map_err(GpuError::call("vkCreateDescriptorSetLayout", name))?;
        let ranges = [vk::PushConstantRange {
            stage_flags: stages,
            offset: 0,
            size: push_size,
        }];
        let set_layouts = [pipeline.set_layout];
        let info = vk::PipelineLayoutCreateInfo::default()
            .set_layouts(&set_layouts)
            .push_constant_ranges(if push_size > 0 { &ranges } else { &[] });
        // SAFETY: likewise.
        pipeline.layout = unsafe { pipeline.device.create_pipeline_layout(&info, None) }
            .map_err(GpuError::call("vkCreatePipelineLayout", name))?;
        Ok(pipeline)
    }

    /// Takes the pipeline that a call made. An error names the last shader.
    fn finish(
        mut self,
        shared: &Shared,
        (call, name): (&'static str, &str),
        made: Result<Vec<vk::Pipeline>, (Vec<vk::Pipeline>, vk::Result)>,
    ) -> Result<Self, GpuError> {
        self.raw = made.map_err(|(_, result)| GpuError::call(call, name)(result))?[0];
        shared.set_name(self.raw, name);
        Ok(self)
    }
}

/// A shader module, alive while its pipeline is made.
struct Module<'a> {
    raw: vk::ShaderModule,
    device: &'a Shared,
}

impl<'a> Module<'a> {
    fn new(device: &'a Shared, name: &str) -> Result<Self, GpuError> {
        let code = code_of(name).ok_or_else(|| GpuError::NoShader(name.into()))?;
        let words: Vec<u32> = bytemuck::pod_collect_to_vec(code);
        let info = vk::ShaderModuleCreateInfo::default().code(&words);
        // SAFETY: the words are SPIR-V from the build script.
        let raw = unsafe { device.raw.create_shader_module(&info, None) }
            .map_err(GpuError::call("vkCreateShaderModule", name))?;
        Ok(Self { raw, device })
    }

    fn stage(&self, stage: vk::ShaderStageFlags) -> vk::PipelineShaderStageCreateInfo<'static> {
        vk::PipelineShaderStageCreateInfo::default()
            .stage(stage)
            .module(self.raw)
            .name(c"main")
    }
}

impl Drop for Module<'_> {
    fn drop(&mut self) {
        // SAFETY: pipelines do not need the module after creation.
        unsafe { self.device.raw.destroy_shader_module(self.raw, None) };
    }
}

impl Shared {
    /// Returns the compute pipeline of a permutation, with specialization constants 0, 1, ... set
    /// to `constants`.
    pub(super) fn compute_pipeline(
        &self,
        shader: &str,
        constants: &[u32],
        interface: Interface,
    ) -> Result<Arc<Pipeline>, GpuError> {
        self.pipeline(&[shader], constants, interface, |interface| {
            self.make_compute_pipeline(
                shader,
                constants,
                interface,
                vk::PipelineCreateFlags::DISPATCH_BASE,
            )
        })
    }

    pub(super) fn make_compute_pipeline(
        &self,
        shader: &str,
        constants: &[u32],
        interface: Interface,
        flags: vk::PipelineCreateFlags,
    ) -> Result<Pipeline, GpuError> {
        let pipeline = Pipeline::new(self, shader, interface, vk::ShaderStageFlags::COMPUTE)?;
        let module = Module::new(self, shader)?;
        let constants = self.emulation.added_to(constants);
        let entries = specialization_entries(&constants);
        let specialization = vk::SpecializationInfo::default()
            .map_entries(&entries)
            .data(bytemuck::cast_slice(&constants));
        let stage = module
            .stage(vk::ShaderStageFlags::COMPUTE)
            .specialization_info(&specialization);
        let info = [vk::ComputePipelineCreateInfo::default()
            .flags(flags)
            .stage(stage)
            .layout(pipeline.layout)];
        // SAFETY: module and layout are alive; the description is complete.
        let made = unsafe {
            self.raw
                .create_compute_pipelines(vk::PipelineCache::null(), &info, None)
        };
        pipeline.finish(self, ("vkCreateComputePipelines", shader), made)
    }

    /// Returns the graphics pipeline of a description for `color_count` colour targets.
    pub(super) fn graphics_pipeline(
        &self,
        description: GraphicsDescription<'_>,
        color_count: usize,
        interface: Interface,
    ) -> Result<Arc<Pipeline>, GpuError> {
        let format = description.output.color_format().as_raw() as u32;
        let targets = [format, color_count as u32];
        self.pipeline(&description.shaders, &targets, interface, |interface| {
            self.make_graphics_pipeline(description, color_count, interface)
        })
    }

    /// Returns the pipeline of these shaders and constants, made once.
    fn pipeline(
        &self,
        shaders: &[&str],
        constants: &[u32],
        interface: Interface,
        make: impl FnOnce(Interface) -> Result<Pipeline, GpuError>,
    ) -> Result<Arc<Pipeline>, GpuError> {
        let key = (
            shaders.iter().map(|shader| shader.to_string()).collect(),
            constants.to_vec(),
        );
        let mut known = lock(&self.pipelines);
        if let Some(pipeline) = known.get(&key) {
            assert_eq!(
                pipeline.interface, interface,
                "{shaders:?}: bound with another interface before"
            );
            return Ok(pipeline.clone());
        }
        let pipeline = Arc::new(make(interface)?);
        known.insert(key, pipeline.clone());
        Ok(pipeline)
    }

    #[expect(
        clippy::too_many_lines,
        reason = "one Vulkan description, whose parts borrow from each other"
    )]
    fn make_graphics_pipeline(
        &self,
        description: GraphicsDescription<'_>,
        color_count: usize,
        interface: Interface,
    ) -> Result<Pipeline, GpuError> {
        const STAGES: [vk::ShaderStageFlags; 2] =
            [vk::ShaderStageFlags::VERTEX, vk::ShaderStageFlags::FRAGMENT];
        let GraphicsDescription {
            shaders: [vertex_shader, name],
            attributes,
            strip,
            output,
        } = description;
        let pipeline = Pipeline::new(self, name, interface, STAGES[0] | STAGES[1])?;
        let modules = [Module::new(self, vertex_shader)?, Module::new(self, name)?];
        let constants = self.emulation.added_to(&[]);
        let entries = specialization_entries(&constants);
        let specialization = vk::SpecializationInfo::default()
            .map_entries(&entries)
            .data(bytemuck::cast_slice(&constants));
        let stages = [0, 1].map(|index| {
            let stage = modules[index].stage(STAGES[index]);
            stage.specialization_info(&specialization)
        });
        let (bindings, locations) = vertex_layout(attributes);
        let vertex_input = vk::PipelineVertexInputStateCreateInfo::default()
            .vertex_binding_descriptions(&bindings)
            .vertex_attribute_descriptions(&locations);
        let topology = if strip {
            vk::PrimitiveTopology::TRIANGLE_STRIP
        } else {
            vk::PrimitiveTopology::TRIANGLE_LIST
        };
        let assembly = vk::PipelineInputAssemblyStateCreateInfo::default().topology(topology);
        let viewport = vk::PipelineViewportStateCreateInfo::default()
            .viewport_count(1)
            .scissor_count(1);
        let raster = vk::PipelineRasterizationStateCreateInfo::default()
            .front_face(vk::FrontFace::COUNTER_CLOCKWISE)
            .line_width(1.0);
        let samples = vk::PipelineMultisampleStateCreateInfo::default()
            .rasterization_samples(vk::SampleCountFlags::TYPE_1);
        let has_depth = output == Output::Surfaces;
        let depth = vk::PipelineDepthStencilStateCreateInfo::default()
            .depth_test_enable(has_depth)
            .depth_write_enable(has_depth)
            .depth_compare_op(vk::CompareOp::LESS);
        let blends = vec![output.blend(); color_count];
        let blend = vk::PipelineColorBlendStateCreateInfo::default().attachments(&blends);
        let dynamic_states = [
            vk::DynamicState::VIEWPORT,
            vk::DynamicState::SCISSOR,
            vk::DynamicState::CULL_MODE,
        ];
        let dynamic = vk::PipelineDynamicStateCreateInfo::default().dynamic_states(&dynamic_states);
        let formats = vec![output.color_format(); color_count];
        let mut rendering = vk::PipelineRenderingCreateInfo::default()
            .color_attachment_formats(&formats)
            .depth_attachment_format(output.depth_format());
        let info = [vk::GraphicsPipelineCreateInfo::default()
            .stages(&stages)
            .vertex_input_state(&vertex_input)
            .input_assembly_state(&assembly)
            .viewport_state(&viewport)
            .rasterization_state(&raster)
            .multisample_state(&samples)
            .depth_stencil_state(&depth)
            .color_blend_state(&blend)
            .dynamic_state(&dynamic)
            .layout(pipeline.layout)
            .push_next(&mut rendering)];
        // SAFETY: modules and layout are alive; the description is complete.
        let made = unsafe {
            self.raw
                .create_graphics_pipelines(vk::PipelineCache::null(), &info, None)
        };
        pipeline.finish(self, ("vkCreateGraphicsPipelines", name), made)
    }
}

/// Describes words that are the specialization constants 0, 1, ...
fn specialization_entries(constants: &[u32]) -> Vec<vk::SpecializationMapEntry> {
    (0..constants.len() as u32)
        .map(|id| vk::SpecializationMapEntry {
            constant_id: id,
            offset: 4 * id,
            size: 4,
        })
        .collect()
}

/// Describes attributes of that many floats per vertex, each in a tightly packed buffer of its own.
fn vertex_layout(
    attributes: &[u32],
) -> (
    Vec<vk::VertexInputBindingDescription>,
    Vec<vk::VertexInputAttributeDescription>,
) {
    let binding = |(binding, &floats): (u32, &u32)| vk::VertexInputBindingDescription {
        binding,
        stride: 4 * floats,
        input_rate: vk::VertexInputRate::VERTEX,
    };
    let location = |(binding, &floats): (u32, &u32)| vk::VertexInputAttributeDescription {
        location: binding,
        binding,
        format: match floats {
            2 => vk::Format::R32G32_SFLOAT,
            3 => vk::Format::R32G32B32_SFLOAT,
            _ => vk::Format::R32G32B32A32_SFLOAT,
        },
        offset: 0,
    };
    (
        (0..).zip(attributes).map(binding).collect(),
        (0..).zip(attributes).map(location).collect(),
    )
}
