//! Statistics and texts that the driver's compiler reports of a shader, through
//! VK_KHR_pipeline_executable_properties.
//!
//! Descriptors and push constants are read from the SPIR-V: no resources are needed, even no
//! executing device.

use super::kept_pipeline::Interface;
use super::{Gpu, GpuError, shader_code};
use ash::vk;
use rspirv_reflect::Reflection;
use rspirv_reflect::rspirv::dr::{Function, Instruction, Module, Operand};
use rspirv_reflect::spirv::Decoration;
use serde::{Deserialize, Serialize};
use std::collections::{BTreeMap, BTreeSet};
use std::ffi::{CStr, c_void};

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Executable {
    /// The driver's name for the stage.
    pub name: String,
    /// Lanes that share an instruction.
    pub subgroup_size: u32,
    pub statistics: Vec<(String, f64)>,
    /// Name and content of each text, such as the assembly.
    pub texts: Vec<(String, String)>,
}

impl Executable {
    pub fn statistic(&self, name: &str) -> Option<f64> {
        self.statistics
            .iter()
            .find(|(known, _)| known == name)
            .map(|(_, value)| *value)
    }

    pub fn text(&self, name: &str) -> Option<&str> {
        self.texts
            .iter()
            .find(|(known, _)| known == name)
            .map(|(_, text)| text.as_str())
    }
}

impl Gpu {
    /// Compiles the shader permutation `shader` with specialization constants 0, 1, ... set to
    /// `constants`.
    ///
    /// Panics if the device was opened without [`super::Options::executables`].
    pub fn executables(
        &self,
        shader: &str,
        constants: &[u32],
    ) -> Result<Vec<Executable>, GpuError> {
        let pipeline =
            self.shared
                .make_compute_pipeline(shader, constants, declared(shader)?, CAPTURE)?;
        let device = self
            .shared
            .executables
            .as_ref()
            .expect("the device was opened with `executables`");
        let info = vk::PipelineInfoKHR::default().pipeline(pipeline.raw);
        // SAFETY: the pipeline is alive.
        let stages = unsafe { device.get_pipeline_executable_properties(&info) }.map_err(
            GpuError::call("vkGetPipelineExecutablePropertiesKHR", shader),
        )?;
        let executable = |(index, stage): (u32, &vk::PipelineExecutablePropertiesKHR<'_>)| {
            let info = vk::PipelineExecutableInfoKHR::default()
                .pipeline(pipeline.raw)
                .executable_index(index);
            // SAFETY: the pipeline is alive, was made with CAPTURE, and has this stage.
            let statistics = unsafe { device.get_pipeline_executable_statistics(&info) }.map_err(
                GpuError::call("vkGetPipelineExecutableStatisticsKHR", shader),
            )?;
            Ok(Executable {
                name: text(stage.name_as_c_str()),
                subgroup_size: stage.subgroup_size,
                statistics: statistics.iter().map(statistic).collect(),
                texts: self.texts(&info, shader)?,
            })
        };
        (0..).zip(&stages).map(executable).collect()
    }

    fn texts(
        &self,
        info: &vk::PipelineExecutableInfoKHR<'_>,
        name: &str,
    ) -> Result<Vec<(String, String)>, GpuError> {
        let device = self
            .shared
            .executables
            .as_ref()
            .expect("checked by `executables`");
        let failed = || GpuError::call("vkGetPipelineExecutableInternalRepresentationsKHR", name);
        // SAFETY: the pipeline is alive and has this stage.
        let mut found = unsafe { device.get_pipeline_executable_internal_representations(info) }
            .map_err(|result| failed()(result))?;
        // The first call returned the sizes; the second one fills buffers of these sizes.
        let mut room: Vec<Vec<u8>> = found.iter().map(|text| vec![0; text.data_size]).collect();
        for (text, bytes) in found.iter_mut().zip(&mut room) {
            text.p_data = bytes.as_mut_ptr().cast::<c_void>();
        }
        let mut count = found.len() as u32;
        let ask = device
            .fp()
            .get_pipeline_executable_internal_representations_khr;
        // SAFETY: `found` has `count` entries, each with a buffer of the size that the first call
        // returned.
        unsafe { ask(device.device(), info, &mut count, found.as_mut_ptr()) }
            .result()
            .map_err(|result| failed()(result))?;
        let texts = found
            .iter()
            .zip(&room)
            .filter(|(found, _)| found.is_text == vk::TRUE);
        Ok(texts
            .map(|(found, bytes)| {
                (
                    text(found.name_as_c_str()),
                    text(CStr::from_bytes_until_nul(bytes)),
                )
            })
            .collect())
    }
}

const CAPTURE: vk::PipelineCreateFlags = vk::PipelineCreateFlags::from_raw(
    vk::PipelineCreateFlags::CAPTURE_STATISTICS_KHR.as_raw()
        | vk::PipelineCreateFlags::CAPTURE_INTERNAL_REPRESENTATIONS_KHR.as_raw(),
);

fn text(name: Result<&CStr, impl Sized>) -> String {
    name.map_or_else(
        |_| String::new(),
        |name| name.to_string_lossy().into_owned(),
    )
}

fn statistic(found: &vk::PipelineExecutableStatisticKHR<'_>) -> (String, f64) {
    use vk::PipelineExecutableStatisticFormatKHR as Format;
    // SAFETY: every member of the union is plain bits, all of which are initialised.
    let bits = unsafe { found.value.u64 };
    let value = match found.format {
        Format::BOOL32 => f64::from(bits as u32),
        Format::INT64 => bits as i64 as f64,
        Format::FLOAT64 => f64::from_bits(bits),
        _ => bits as f64,
    };
    (text(found.name_as_c_str()), value)
}

/// Reads the descriptors of set 0 and the push constants that a shader declares.
fn declared(shader: &str) -> Result<Interface, GpuError> {
    let fault = |what: rspirv_reflect::ReflectError| GpuError::Reflection {
        shader: shader.to_owned(),
        what: what.to_string(),
    };
    let mut reflection = Reflection::new_from_spirv(shader_code(shader)).map_err(fault)?;
    keep_one_a_binding(&mut reflection.0);
    let push = reflection.get_push_constant_range().map_err(fault)?;
    let push_size = push.map_or(0, |push| (push.offset + push.size) as usize);
    let mut kinds = Vec::new();
    for (binding, found) in reflection
        .get_descriptor_sets()
        .map_err(fault)?
        .remove(&0)
        .unwrap_or_default()
    {
        let place = binding as usize;
        if kinds.len() <= place {
            // A binding that the shader does not declare still takes a number.
            kinds.resize(place + 1, vk::DescriptorType::UNIFORM_BUFFER);
        }
        kinds[place] = vk::DescriptorType::from_raw(found.ty.0 as i32);
    }
    Ok(Interface { kinds, push_size })
}

/// Removes variables that share a binding, except the one that the shader reads: the reflection
/// panics on them.
fn keep_one_a_binding(module: &mut Module) {
    let instructions = module.functions.iter().flat_map(Function::all_inst_iter);
    let used: BTreeSet<u32> = instructions
        .flat_map(|instruction| instruction.operands.iter().filter_map(Operand::id_ref_any))
        .collect();
    let binding = |instruction: &Instruction| match instruction.operands[..] {
        [
            Operand::IdRef(id),
            Operand::Decoration(Decoration::Binding),
            Operand::LiteralBit32(place),
        ] => Some((place, id)),
        _ => None,
    };
    let mut by_place: BTreeMap<u32, Vec<u32>> = BTreeMap::new();
    for (place, id) in module.annotations.iter().filter_map(binding) {
        by_place.entry(place).or_default().push(id);
    }
    let others = by_place.values().flat_map(|ids| {
        let kept = ids.iter().find(|id| used.contains(id)).unwrap_or(&ids[0]);
        ids.iter().filter(move |id| *id != kept)
    });
    let others: BTreeSet<u32> = others.copied().collect();
    module
        .types_global_values
        .retain(|instruction| instruction.result_id.is_none_or(|id| !others.contains(&id)));
}
