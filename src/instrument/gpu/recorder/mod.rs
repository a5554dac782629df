//! Recording and submitting commands; barriers follow from tracked access.

mod binding;
mod commands;
#[cfg(feature = "view")]
mod paint;

pub use binding::Bind;
pub use commands::{DrawCall, Targets};
#[cfg(feature = "view")]
pub use paint::Painted;

use super::device::lock;
use super::inject::Site;
use super::slot::{PASS_LIMIT, Slot};
use super::{Gpu, GpuError};
use ash::vk;
use std::any::Any;
use std::collections::BTreeSet;
use std::ffi::CString;
use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::time::Instant;

#[derive(Clone, Debug, PartialEq)]
pub struct PassTime {
    pub pass: &'static str,
    pub ms: f64,
}

#[derive(Clone, Debug, Default, PartialEq)]
pub struct Report {
    /// In the order of recording.
    pub passes: Vec<PassTime>,
    /// Host time from submission to completion, ms.
    pub wall_ms: f64,
    pub shaders: BTreeSet<String>,
}

impl Report {
    /// Adds another submission. Passes of the same name are merged.
    pub fn add(&mut self, other: Report) {
        for time in other.passes {
            match self.passes.iter_mut().find(|known| known.pass == time.pass) {
                Some(known) => known.ms += time.ms,
                None => self.passes.push(time),
            }
        }
        self.wall_ms += other.wall_ms;
        self.shaders.extend(other.shaders);
    }
}

pub struct Recorder {
    /// Dropped before the device.
    slot: Arc<Slot>,
    gpu: Gpu,
    name: String,
    commands: vk::CommandBuffer,
    fence: vk::Fence,
    passes: Vec<&'static str>,
    shaders: BTreeSet<String>,
    descriptor_pools: Vec<vk::DescriptorPool>,
    sets_left: u32,
    /// Barriers not yet recorded.
    image_barriers: Vec<vk::ImageMemoryBarrier2<'static>>,
    buffer_barriers: Vec<vk::BufferMemoryBarrier2<'static>>,
    /// All resources that the commands use.
    kept: Vec<Arc<dyn Any + Send + Sync>>,
}

impl Gpu {
    /// Starts recording; `name` appears in the debugger and in errors.
    pub fn record(&self, name: &str) -> Result<Recorder, GpuError> {
        if lock(&self.shared.interrupt)
            .as_ref()
            .is_some_and(|flag| flag.load(Ordering::Relaxed))
        {
            return Err(GpuError::Interrupted);
        }
        self.record_always(name)
    }

    /// [`Gpu::record`] for work that no flag interrupts.
    pub fn record_always(&self, name: &str) -> Result<Recorder, GpuError> {
        let device = &self.shared.raw;
        let free = lock(&self.shared.slots).pop();
        let slot = free.map_or_else(
            || Slot::new(device, self.shared.queue_family, name).map(Arc::new),
            Ok,
        )?;
        let recorder = Recorder {
            gpu: self.clone(),
            name: name.into(),
            commands: slot.commands,
            slot,
            fence: vk::Fence::null(),
            passes: Vec::new(),
            shaders: BTreeSet::new(),
            descriptor_pools: Vec::new(),
            sets_left: 0,
            image_barriers: Vec::new(),
            buffer_barriers: Vec::new(),
            kept: Vec::new(),
        };
        // SAFETY: the slot is this recorder's alone, and the submission before has been waited for.
        unsafe {
            device.reset_command_pool(
                recorder.slot.command_pool,
                vk::CommandPoolResetFlags::empty(),
            )
        }
        .map_err(GpuError::call("vkResetCommandPool", name))?;
        self.shared.set_name(recorder.commands, name);
        let begin = vk::CommandBufferBeginInfo::default()
            .flags(vk::CommandBufferUsageFlags::ONE_TIME_SUBMIT);
        // SAFETY: the command buffer is empty.
        unsafe { device.begin_command_buffer(recorder.commands, &begin) }
            .map_err(GpuError::call("vkBeginCommandBuffer", name))?;
        Ok(recorder)
    }
}

impl Recorder {
    fn device(&self) -> &ash::Device {
        &self.gpu.shared.raw
    }

    /// Records `body` as one timed pass.
    ///
    /// Each timestamp has a full barrier on both sides: the one before keeps passes from
    /// overlapping; without the one behind, lavapipe writes the timestamp into the wrong interval.
    pub fn pass(
        &mut self,
        name: &'static str,
        body: impl FnOnce(&mut Self) -> Result<(), GpuError>,
    ) -> Result<(), GpuError> {
        let index = self.passes.len() as u32;
        assert!(
            index < PASS_LIMIT,
            "'{}': more than {PASS_LIMIT} timed passes in one submission",
            self.name
        );
        // SAFETY: recording; the slot has this many queries.
        unsafe {
            self.device()
                .cmd_reset_query_pool(self.commands, self.slot.queries, 2 * index, 2)
        };
        self.passes.push(name);
        self.begin_label(name);
        self.timestamp(2 * index);
        let outcome = body(self);
        self.timestamp(2 * index + 1);
        self.end_label();
        outcome
    }

    /// Ends the recording, submits it, waits and reads the timestamps.
    pub fn submit(self) -> Result<Report, GpuError> {
        self.submit_between(&[], &[])
    }

    /// [`Recorder::submit`], whose colour output waits for semaphores and which signals others.
    pub(super) fn submit_between(
        mut self,
        waits: &[vk::SemaphoreSubmitInfo<'_>],
        signals: &[vk::SemaphoreSubmitInfo<'_>],
    ) -> Result<Report, GpuError> {
        // SAFETY: recording.
        unsafe { self.device().end_command_buffer(self.commands) }
            .map_err(GpuError::call("vkEndCommandBuffer", &self.name))?;
        // SAFETY: the device is alive.
        self.fence = unsafe {
            self.device()
                .create_fence(&vk::FenceCreateInfo::default(), None)
        }
        .map_err(GpuError::call("vkCreateFence", &self.name))?;
        let shared = &self.gpu.shared;
        let commands = [vk::CommandBufferSubmitInfo::default().command_buffer(self.commands)];
        let submit = [vk::SubmitInfo2::default()
            .wait_semaphore_infos(waits)
            .command_buffer_infos(&commands)
            .signal_semaphore_infos(signals)];
        let started;
        {
            let _one_at_a_time = lock(&shared.submission);
            started = Instant::now();
            let call = || GpuError::call("vkQueueSubmit2", &self.name);
            shared.injector.reach(Site::Submit).map_err(call())?;
            // SAFETY: the command buffer is complete and what it uses is kept alive until the fence
            // is signalled.
            unsafe {
                self.device()
                    .queue_submit2(shared.queue, &submit, self.fence)
            }
            .map_err(call())?;
        }
        // SAFETY: the fence was just submitted.
        unsafe { self.device().wait_for_fences(&[self.fence], true, u64::MAX) }
            .map_err(GpuError::call("vkWaitForFences", &self.name))?;
        let waited = started.elapsed();
        let wall_ms = waited.as_secs_f64() * 1e3;
        Ok(Report {
            passes: self.pass_times()?,
            wall_ms,
            shaders: self.shaders.clone(),
        })
    }

    fn pass_times(&self) -> Result<Vec<PassTime>, GpuError> {
        if self.passes.is_empty() {
            return Ok(Vec::new());
        }
        let mut ticks = vec![0u64; 2 * self.passes.len()];
        let flags = vk::QueryResultFlags::TYPE_64 | vk::QueryResultFlags::WAIT;
        // SAFETY: the queries were written by the submission that has completed.
        unsafe {
            self.device()
                .get_query_pool_results(self.slot.queries, 0, &mut ticks, flags)
        }
        .map_err(GpuError::call("vkGetQueryPoolResults", &self.name))?;
        let shared = &self.gpu.shared;
        let ms = |pair: &[u64]| {
            let elapsed = pair[1].wrapping_sub(pair[0]) & shared.timestamp_mask;
            elapsed as f64 * f64::from(shared.info.timestamp_period_ns) * 1e-6
        };
        Ok(self
            .passes
            .iter()
            .zip(ticks.chunks_exact(2))
            .map(|(pass, pair)| PassTime { pass, ms: ms(pair) })
            .collect())
    }

    fn timestamp(&mut self, query: u32) {
        self.full_barrier();
        // SAFETY: recording; the query exists and was reset.
        unsafe {
            self.device().cmd_write_timestamp2(
                self.commands,
                vk::PipelineStageFlags2::ALL_COMMANDS,
                self.slot.queries,
                query,
            )
        };
        self.full_barrier();
    }

    fn full_barrier(&self) {
        let all = vk::PipelineStageFlags2::ALL_COMMANDS;
        let any = vk::AccessFlags2::MEMORY_READ | vk::AccessFlags2::MEMORY_WRITE;
        let memory = [vk::MemoryBarrier2::default()
            .src_stage_mask(all)
            .src_access_mask(vk::AccessFlags2::MEMORY_WRITE)
            .dst_stage_mask(all)
            .dst_access_mask(any)];
        let info = vk::DependencyInfo::default().memory_barriers(&memory);
        // SAFETY: recording.
        unsafe { self.device().cmd_pipeline_barrier2(self.commands, &info) };
    }

    fn begin_label(&self, name: &str) {
        if let (Some(debug), Ok(name)) = (&self.gpu.shared.debug, CString::new(name)) {
            let label = vk::DebugUtilsLabelEXT::default().label_name(&name);
            // SAFETY: recording; the label is copied by the call.
            unsafe { debug.cmd_begin_debug_utils_label(self.commands, &label) };
        }
    }

    fn end_label(&self) {
        if let Some(debug) = &self.gpu.shared.debug {
            // SAFETY: recording; a label was begun.
            unsafe { debug.cmd_end_debug_utils_label(self.commands) };
        }
    }
}

impl Drop for Recorder {
    fn drop(&mut self) {
        lock(&self.gpu.shared.slots).push(self.slot.clone());
        // SAFETY: the submission (if any) has been waited for; null handles are ignored.
        unsafe { self.device().destroy_fence(self.fence, None) };
        for pool in &self.descriptor_pools {
            // SAFETY: likewise.
            unsafe { self.device().destroy_descriptor_pool(*pool, None) };
        }
    }
}
