//! Pipelines that the device keeps until it closes.

use ash::vk;
use std::collections::HashMap;
use std::sync::{Arc, Mutex};

/// Inputs of a pipeline: kinds of descriptor set 0 by binding number, and bytes of push constants.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Interface {
    pub(super) kinds: Vec<vk::DescriptorType>,
    pub(super) push_size: usize,
}

pub(super) struct Pipeline {
    pub(super) raw: vk::Pipeline,
    pub(super) layout: vk::PipelineLayout,
    pub(super) set_layout: vk::DescriptorSetLayout,
    pub(super) stages: vk::ShaderStageFlags,
    pub(super) interface: Interface,
    pub(super) device: ash::Device,
}

/// Pipelines of a device by their shaders, and by their specialization constants or the format of
/// their target.
pub(super) type Pipelines = Mutex<HashMap<(Vec<String>, Vec<u32>), Arc<Pipeline>>>;

impl Drop for Pipeline {
    fn drop(&mut self) {
        // SAFETY: no pending command uses these (or they are null): `submit` waits, and closing the
        // device comes last.
        unsafe { self.device.destroy_pipeline(self.raw, None) };
        // SAFETY: likewise.
        unsafe { self.device.destroy_pipeline_layout(self.layout, None) };
        // SAFETY: likewise.
        unsafe {
            self.device
                .destroy_descriptor_set_layout(self.set_layout, None)
        };
    }
}
