//! A pipeline as the device keeps it, until it closes.

use ash::vk;
use std::collections::HashMap;
use std::sync::{Arc, Mutex};

/// What a shader is given: the kinds of descriptor set 0, where the index is the binding's number, and bytes of push constants.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Interface {
    pub(super) kinds: Vec<vk::DescriptorType>,
    pub(super) push_size: usize,
}

/// A pipeline with its layout.
pub(super) struct Pipeline {
    pub(super) raw: vk::Pipeline,
    pub(super) layout: vk::PipelineLayout,
    pub(super) set_layout: vk::DescriptorSetLayout,
    pub(super) stages: vk::ShaderStageFlags,
    pub(super) interface: Interface,
    pub(super) device: ash::Device,
}

/// The pipelines of a device by their shaders and specialization constants.
pub(super) type Pipelines = Mutex<HashMap<(Vec<String>, Vec<u32>), Arc<Pipeline>>>;

impl Drop for Pipeline {
    fn drop(&mut self) {
        // SAFETY: no pending command uses these (or they are null), because `submit` waits and the device's close is the last use.
        unsafe { self.device.destroy_pipeline(self.raw, None) };
        // SAFETY: likewise.
        unsafe { self.device.destroy_pipeline_layout(self.layout, None) };
        // SAFETY: likewise.
        unsafe { self.device.destroy_descriptor_set_layout(self.set_layout, None) };
    }
}
