//! What the driver's compiler made of a shader: its statistics and texts, through VK_KHR_pipeline_executable_properties.
//!
//! Descriptors and push constants are read from the SPIR-V, so that no resource is needed: a device that executes nothing compiles as well.

use super::kept_pipeline::{Interface, Pipeline};
use super::{Gpu, GpuError, GraphicsDescription, shader_code};
use ash::vk;
use rspirv_reflect::Reflection;
use serde::{Deserialize, Serialize};
use std::ffi::{CStr, c_void};

/// One compiled stage.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Executable {
    /// The driver's word for it.
    pub name: String,
    /// Lanes that execute one instruction together.
    pub subgroup_size: u32,
    pub statistics: Vec<Statistic>,
    /// Name and content of each text, such as the assembly.
    pub texts: Vec<(String, String)>,
}

/// One number that the driver tells of a stage.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Statistic {
    pub name: String,
    pub value: f64,
}

impl Executable {
    /// The statistic of that name.
    pub fn statistic(&self, name: &str) -> Option<f64> {
        self.statistics.iter().find(|statistic| statistic.name == name).map(|statistic| statistic.value)
    }

    /// The text of that name.
    pub fn text(&self, name: &str) -> Option<&str> {
        self.texts.iter().find(|(known, _)| known == name).map(|(_, text)| text.as_str())
    }
}

impl Gpu {
    /// Compiles the shader permutation `shader` with specialization constants 0, 1, ... set to `constants`.
    ///
    /// Panics on a device without [`super::Options::executables`].
    pub fn executables(&self, shader: &str, constants: &[u32]) -> Result<Vec<Executable>, GpuError> {
        let interface = declared(&[shader])?;
        self.tell(&self.shared.make_compute_pipeline(shader, constants, interface, CAPTURE)?, shader)
    }

    /// The same for the two stages of a draw into `color_count` targets.
    pub fn graphics_executables(
        &self,
        description: GraphicsDescription<'_>,
        color_count: usize,
    ) -> Result<Vec<Executable>, GpuError> {
        let interface = declared(&description.shaders)?;
        let pipeline = self.shared.make_graphics_pipeline(description, color_count, interface, CAPTURE)?;
        self.tell(&pipeline, description.shaders[1])
    }

    fn tell(&self, pipeline: &Pipeline, name: &str) -> Result<Vec<Executable>, GpuError> {
        let device = self.shared.executables.as_ref().expect("the device was opened to tell of its pipelines");
        let info = vk::PipelineInfoKHR::default().pipeline(pipeline.raw);
        // SAFETY: the pipeline is alive.
        let stages = unsafe { device.get_pipeline_executable_properties(&info) }
            .map_err(GpuError::call("vkGetPipelineExecutablePropertiesKHR", name))?;
        let tell = |(index, stage): (u32, &vk::PipelineExecutablePropertiesKHR<'_>)| {
            let info = vk::PipelineExecutableInfoKHR::default().pipeline(pipeline.raw).executable_index(index);
            // SAFETY: the pipeline is alive, was made to be told of, and has this stage.
            let statistics = unsafe { device.get_pipeline_executable_statistics(&info) }
                .map_err(GpuError::call("vkGetPipelineExecutableStatisticsKHR", name))?;
            Ok(Executable {
                name: text(stage.name_as_c_str()),
                subgroup_size: stage.subgroup_size,
                statistics: statistics.iter().map(statistic).collect(),
                texts: self.texts(&info, name)?,
            })
        };
        (0..).zip(&stages).map(tell).collect()
    }

    /// Every text of a stage.
    fn texts(&self, info: &vk::PipelineExecutableInfoKHR<'_>, name: &str) -> Result<Vec<(String, String)>, GpuError> {
        let device = self.shared.executables.as_ref().expect("asked by `tell`");
        let failed = || GpuError::call("vkGetPipelineExecutableInternalRepresentationsKHR", name);
        // SAFETY: the pipeline is alive and has this stage.
        let mut found = unsafe { device.get_pipeline_executable_internal_representations(info) }
            .map_err(|result| failed()(result))?;
        // The first call told the sizes; the second one fills the room that is made for them.
        let mut room: Vec<Vec<u8>> = found.iter().map(|text| vec![0; text.data_size]).collect();
        for (text, bytes) in found.iter_mut().zip(&mut room) {
            text.p_data = bytes.as_mut_ptr().cast::<c_void>();
        }
        let mut count = found.len() as u32;
        let ask = device.fp().get_pipeline_executable_internal_representations_khr;
        // SAFETY: `found` has `count` entries, each with the room that the first call asked for.
        unsafe { ask(device.device(), info, &mut count, found.as_mut_ptr()) }
            .result()
            .map_err(|result| failed()(result))?;
        let texts = found.iter().zip(&room).filter(|(found, _)| found.is_text == vk::TRUE);
        Ok(texts.map(|(found, bytes)| (text(found.name_as_c_str()), until_zero(bytes))).collect())
    }
}

const CAPTURE: vk::PipelineCreateFlags = vk::PipelineCreateFlags::from_raw(
    vk::PipelineCreateFlags::CAPTURE_STATISTICS_KHR.as_raw()
        | vk::PipelineCreateFlags::CAPTURE_INTERNAL_REPRESENTATIONS_KHR.as_raw(),
);

fn text(name: Result<&CStr, impl Sized>) -> String {
    name.map_or_else(|_| String::new(), |name| name.to_string_lossy().into_owned())
}

fn until_zero(bytes: &[u8]) -> String {
    let end = bytes.iter().position(|byte| *byte == 0).unwrap_or(bytes.len());
    String::from_utf8_lossy(&bytes[..end]).into_owned()
}

fn statistic(told: &vk::PipelineExecutableStatisticKHR<'_>) -> Statistic {
    use vk::PipelineExecutableStatisticFormatKHR as Format;
    // SAFETY: every member of the union is plain bits, all of which are initialised.
    let bits = unsafe { told.value.u64 };
    let value = match told.format {
        Format::BOOL32 => f64::from(bits as u32),
        Format::INT64 => bits as i64 as f64,
        Format::FLOAT64 => f64::from_bits(bits),
        _ => bits as f64,
    };
    Statistic { name: text(told.name_as_c_str()), value }
}

/// What the shaders of one pipeline declare: descriptors of set 0, push constants.
fn declared(shaders: &[&str]) -> Result<Interface, GpuError> {
    let mut interface = Interface { kinds: Vec::new(), push_size: 0 };
    for shader in shaders {
        let fault = |what: rspirv_reflect::ReflectError| GpuError::Reflection {
            shader: shader.to_string(),
            what: what.to_string(),
        };
        let reflection = Reflection::new_from_spirv(shader_code(shader)).map_err(fault)?;
        let push = reflection.get_push_constant_range().map_err(fault)?;
        interface.push_size = interface.push_size.max(push.map_or(0, |push| (push.offset + push.size) as usize));
        for (binding, found) in reflection.get_descriptor_sets().map_err(fault)?.remove(&0).unwrap_or_default() {
            let place = binding as usize;
            if interface.kinds.len() <= place {
                // A binding that no stage declares is still a place.
                interface.kinds.resize(place + 1, vk::DescriptorType::UNIFORM_BUFFER);
            }
            interface.kinds[place] = vk::DescriptorType::from_raw(found.ty.0 as i32);
        }
    }
    Ok(interface)
}
