//! Buffers on the device and in host-visible memory.

use super::device::{Memory, Shared};
use super::inject::Site;
use super::sync::State;
use super::{Gpu, GpuError};
use ash::vk;
use bytemuck::Pod;
use gpu_allocator::MemoryLocation;
use std::sync::{Arc, Mutex};

/// A storage or uniform buffer. Clones share it.
#[derive(Clone)]
pub struct Buffer {
    pub(super) inner: Arc<Inner>,
}

pub(super) struct Inner {
    pub(super) raw: vk::Buffer,
    pub(super) size: u64,
    pub(super) state: Mutex<State>,
    name: String,
    /// Freed after the buffer. `None` only while it is made.
    memory: Option<Memory>,
    device: Arc<Shared>,
}

impl Buffer {
    /// Size in bytes.
    pub fn size(&self) -> u64 {
        self.inner.size
    }

    /// Copies the contents of a host-visible buffer.
    pub(super) fn host_copy<T: Pod>(&self) -> Vec<T> {
        let mapped = self
            .inner
            .memory
            .as_ref()
            .and_then(|memory| memory.allocation.mapped_slice());
        let bytes = &mapped.expect("GpuToCpu memory is mapped")[..self.inner.size as usize];
        bytemuck::pod_collect_to_vec(bytes)
    }
}

fn storage() -> vk::BufferUsageFlags {
    use vk::BufferUsageFlags as Usage;
    Usage::STORAGE_BUFFER
        | Usage::VERTEX_BUFFER
        | Usage::INDEX_BUFFER
        | Usage::TRANSFER_SRC
        | Usage::TRANSFER_DST
}

impl Gpu {
    /// Makes a device-local storage buffer of `size` bytes with undefined contents.
    pub fn buffer(&self, name: &str, size: u64) -> Result<Buffer, GpuError> {
        self.check_bound_at_once(name, size)?;
        self.buffer_bound_in_parts(name, size)
    }

    /// Makes a device-local storage buffer of `size` bytes with undefined contents, of which
    /// shaders see parts ([`super::Bind::ReadWritePart`]) of at most [`Self::max_buffer_bytes`].
    pub fn buffer_bound_in_parts(&self, name: &str, size: u64) -> Result<Buffer, GpuError> {
        let buffer = self.create_buffer(name, size, storage(), MemoryLocation::GpuOnly)?;
        if let Some(word) = self.shared.emulation.undefined_word() {
            let mut recorder = self.record(name)?;
            recorder.fill(&buffer, word);
            recorder.submit()?;
        }
        Ok(buffer)
    }

    pub fn buffer_from<T: Pod>(&self, name: &str, data: &[T]) -> Result<Buffer, GpuError> {
        self.check_bound_at_once(name, size_of_val(data) as u64)?;
        self.filled(name, bytemuck::cast_slice(data), storage())
    }

    /// Makes a storage buffer that holds `data` in memory of the host, for what is read once.
    #[cfg(feature = "view")]
    pub fn host_buffer_from<T: Pod>(&self, name: &str, data: &[T]) -> Result<Buffer, GpuError> {
        self.check_bound_at_once(name, size_of_val(data) as u64)?;
        self.mapped(
            name,
            bytemuck::cast_slice(data),
            vk::BufferUsageFlags::STORAGE_BUFFER,
        )
    }

    /// Makes a buffer that holds `data`, to be bound in parts as uniform blocks; storage limits do
    /// not apply.
    pub fn uniform_from<T: Pod>(&self, name: &str, data: &[T]) -> Result<Buffer, GpuError> {
        let usage = vk::BufferUsageFlags::UNIFORM_BUFFER | vk::BufferUsageFlags::TRANSFER_DST;
        self.filled(name, bytemuck::cast_slice(data), usage)
    }

    fn filled(
        &self,
        name: &str,
        bytes: &[u8],
        usage: vk::BufferUsageFlags,
    ) -> Result<Buffer, GpuError> {
        let buffer =
            self.create_buffer(name, bytes.len() as u64, usage, MemoryLocation::GpuOnly)?;
        self.write_buffer(&buffer, bytes)?;
        Ok(buffer)
    }

    /// Fills `buffer`, which must have the size of `bytes`.
    pub fn write_buffer(&self, buffer: &Buffer, bytes: &[u8]) -> Result<(), GpuError> {
        let name = &buffer.inner.name;
        let staging = self.staging_from(name, bytes)?;
        let mut recorder = self.record(name)?;
        recorder.copy_buffer(&staging, buffer)?;
        recorder.submit().map(|_| ())
    }

    /// Returns a copy of a buffer, made on the device.
    pub fn copied(&self, buffer: &Buffer) -> Result<Buffer, GpuError> {
        let name = &buffer.inner.name;
        let copy = self.buffer(name, buffer.size())?;
        let mut recorder = self.record(name)?;
        recorder.copy_buffer(buffer, &copy)?;
        recorder.submit()?;
        Ok(copy)
    }

    /// Reads the contents of `buffer`, whose size must be a multiple of `T`'s.
    pub fn read_buffer<T: Pod>(&self, buffer: &Buffer) -> Result<Vec<T>, GpuError> {
        let staging = self.readback(&buffer.inner.name, buffer.size())?;
        let mut recorder = self.record(&buffer.inner.name)?;
        recorder.copy_buffer(buffer, &staging)?;
        recorder.submit()?;
        Ok(staging.host_copy())
    }

    fn check_bound_at_once(&self, name: &str, size: u64) -> Result<(), GpuError> {
        let limit = self.max_buffer_bytes();
        if size <= limit {
            return Ok(());
        }
        Err(GpuError::Limit {
            what: "storage buffer",
            name: name.into(),
            needed: size,
            limit,
        })
    }

    /// Makes a host-visible buffer to copy from.
    pub(super) fn staging_from(&self, name: &str, bytes: &[u8]) -> Result<Buffer, GpuError> {
        self.mapped(name, bytes, vk::BufferUsageFlags::TRANSFER_SRC)
    }

    /// Makes a host-visible buffer that holds `bytes`.
    fn mapped(
        &self,
        name: &str,
        bytes: &[u8],
        usage: vk::BufferUsageFlags,
    ) -> Result<Buffer, GpuError> {
        let mut buffer =
            self.create_buffer(name, bytes.len() as u64, usage, MemoryLocation::CpuToGpu)?;
        let memory = Arc::get_mut(&mut buffer.inner).and_then(|inner| inner.memory.as_mut());
        let mapped = memory.and_then(|memory| memory.allocation.mapped_slice_mut());
        mapped.expect("CpuToGpu memory is mapped")[..bytes.len()].copy_from_slice(bytes);
        Ok(buffer)
    }

    /// Counts how often the host read from the device, for tests.
    pub fn read_count(&self) -> u64 {
        self.shared.injector.count(Site::Read)
    }

    /// Makes a host-visible buffer to copy to.
    pub(super) fn readback(&self, name: &str, size: u64) -> Result<Buffer, GpuError> {
        let _counted = self.shared.injector.reach(Site::Read);
        self.create_buffer(
            name,
            size,
            vk::BufferUsageFlags::TRANSFER_DST,
            MemoryLocation::GpuToCpu,
        )
    }

    fn create_buffer(
        &self,
        name: &str,
        size: u64,
        usage: vk::BufferUsageFlags,
        location: MemoryLocation,
    ) -> Result<Buffer, GpuError> {
        let device = &self.shared;
        // Vulkan has no empty buffers; four bytes keep callers free of a special case.
        let size = size.max(4);
        let info = vk::BufferCreateInfo::default().size(size).usage(usage);
        // SAFETY: the device is alive and the description is complete.
        let raw = unsafe { device.raw.create_buffer(&info, None) }
            .map_err(GpuError::call("vkCreateBuffer", name))?;
        device.set_name(raw, name);
        let mut inner = Inner {
            raw,
            size,
            state: Mutex::new(State::NEW),
            name: name.to_owned(),
            memory: None,
            device: device.clone(),
        };
        // SAFETY: the buffer was just made.
        let requirements = unsafe { inner.device.raw.get_buffer_memory_requirements(raw) };
        let memory = inner
            .device
            .allocate(&inner.name, requirements, location, true)?;
        // SAFETY: the memory is not freed before its last resource.
        let raw_memory = unsafe { memory.allocation.memory() };
        // SAFETY: the allocation fits the requirements and nothing else uses its range.
        unsafe {
            inner
                .device
                .raw
                .bind_buffer_memory(raw, raw_memory, memory.allocation.offset())
        }
        .map_err(GpuError::call("vkBindBufferMemory", &inner.name))?;
        inner.memory = Some(memory);
        Ok(Buffer {
            inner: Arc::new(inner),
        })
    }
}

impl Drop for Inner {
    fn drop(&mut self) {
        // SAFETY: no pending command uses the buffer, because `submit` waits and recorders hold
        // what they record.
        unsafe { self.device.raw.destroy_buffer(self.raw, None) };
    }
}
