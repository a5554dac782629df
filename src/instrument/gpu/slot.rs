//! Reusable command buffers: the validation layer (1.3.239) leaks 60 KiB per destroyed one.

use super::GpuError;
use ash::vk;

/// Most timed passes of one submission.
pub(super) const PASS_LIMIT: u32 = 256;

/// A command buffer in its own pool, so that recorders can live on different threads, and its
/// timestamps.
pub(super) struct Slot {
    pub(super) command_pool: vk::CommandPool,
    pub(super) commands: vk::CommandBuffer,
    pub(super) queries: vk::QueryPool,
    device: ash::Device,
}

impl Slot {
    pub(super) fn new(
        device: &ash::Device,
        queue_family: u32,
        name: &str,
    ) -> Result<Self, GpuError> {
        let pool = vk::CommandPoolCreateInfo::default()
            .queue_family_index(queue_family)
            .flags(vk::CommandPoolCreateFlags::TRANSIENT);
        // SAFETY: the device is alive.
        let command_pool = unsafe { device.create_command_pool(&pool, None) }
            .map_err(GpuError::call("vkCreateCommandPool", name))?;
        let mut slot = Self {
            command_pool,
            commands: vk::CommandBuffer::null(),
            queries: vk::QueryPool::null(),
            device: device.clone(),
        };
        let allocate = vk::CommandBufferAllocateInfo::default()
            .command_pool(command_pool)
            .level(vk::CommandBufferLevel::PRIMARY)
            .command_buffer_count(1);
        // SAFETY: the pool was just made.
        slot.commands = unsafe { device.allocate_command_buffers(&allocate) }
            .map_err(GpuError::call("vkAllocateCommandBuffers", name))?[0];
        let info = vk::QueryPoolCreateInfo::default()
            .query_type(vk::QueryType::TIMESTAMP)
            .query_count(2 * PASS_LIMIT);
        // SAFETY: the device is alive.
        slot.queries = unsafe { device.create_query_pool(&info, None) }
            .map_err(GpuError::call("vkCreateQueryPool", name))?;
        Ok(slot)
    }
}

impl Drop for Slot {
    fn drop(&mut self) {
        // SAFETY: no submission uses it (or it is null): `submit` waits, and closing the device is
        // the last use.
        unsafe { self.device.destroy_command_pool(self.command_pool, None) };
        // SAFETY: likewise.
        unsafe { self.device.destroy_query_pool(self.queries, None) };
    }
}
