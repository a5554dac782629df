//! The device with its one queue and the memory allocator.

use super::emulation::Emulation;
use super::inject::{Injector, Site};
use super::instance::Instance;
use super::kept_pipeline::Pipelines;
use super::slot::Slot;
use super::{DeviceInfo, GpuError, Options, Sampler, host_memory};
use ash::{ext, khr, vk};
use gpu_allocator::vulkan::{
    Allocation, AllocationCreateDesc, AllocationScheme, Allocator, AllocatorCreateDesc,
};
use gpu_allocator::{AllocationSizes, MemoryLocation};
use std::collections::HashMap;
use std::ffi::{CStr, CString};
use std::sync::atomic::AtomicBool;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// Locks a mutex. Panics cannot leave its contents half-changed: no call into Vulkan or the
/// allocator panics.
pub(crate) fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// An open device. Clones share it.
#[derive(Clone)]
pub struct Gpu {
    pub(super) shared: Arc<Shared>,
}

pub(super) struct Shared {
    pub(super) raw: ash::Device,
    pub(super) queue: vk::Queue,
    pub(super) queue_family: u32,
    /// One submission at a time: the queue is externally synchronised.
    pub(super) submission: Mutex<()>,
    pub(super) limits: vk::PhysicalDeviceLimits,
    pub(super) timestamp_mask: u64,
    pub(super) info: DeviceInfo,
    pub(super) injector: Injector,
    pub(super) emulation: Emulation,
    pub(super) is_interactive: bool,
    pub(super) interrupt: Mutex<Option<Arc<AtomicBool>>>,
    pub(super) pipelines: Pipelines,
    pub(super) samplers: Mutex<HashMap<Sampler, vk::Sampler>>,
    pub(super) slots: Mutex<Vec<Arc<Slot>>>,
    allocator: Mutex<Option<Allocator>>,
    pub(super) debug: Option<ext::debug_utils::Device>,
    /// Present if [`Options::executables`] is set.
    pub(super) executables: Option<khr::pipeline_executable_properties::Device>,
    #[cfg(feature = "view")]
    pub(super) physical: vk::PhysicalDevice,
    /// Whether swapchains are enabled.
    #[cfg(feature = "view")]
    pub(super) can_present: bool,
    /// Dropped last.
    pub(super) instance: Instance,
}

impl Gpu {
    /// Opens a device. The error names the missing feature.
    pub fn new(options: Options) -> Result<Self, GpuError> {
        host_memory::return_large_blocks();
        let injector = Injector::from_environment()?;
        let emulation = Emulation::from_environment()?;
        let instance = Instance::new(options.validation, options.is_presenting)?;
        let (physical, info) = instance.choose(options.device)?;
        let info = emulation.limited(info);
        let (queue_family, timestamp_mask) = queue_family(&instance, physical, &info)?;
        let extensions = extensions(&instance, physical, &info, options.executables)?;
        let raw = create_device(&instance, physical, &info, queue_family, &extensions)?;
        // SAFETY: the queue was asked for in `create_device`.
        let queue = unsafe { raw.get_device_queue(queue_family, 0) };
        let debug = instance
            .has_debug_utils
            .then(|| ext::debug_utils::Device::new(&instance.raw, &raw));
        // SAFETY: the physical device belongs to the instance.
        let limits = unsafe { instance.raw.get_physical_device_properties(physical) }.limits;

        // From here on `Shared` owns the device, and its drop frees it if a later step fails.
        let executables = options
            .executables
            .then(|| khr::pipeline_executable_properties::Device::new(&instance.raw, &raw));
        let mut shared = Shared {
            raw,
            queue,
            queue_family,
            submission: Mutex::new(()),
            limits,
            timestamp_mask,
            info,
            injector,
            emulation,
            is_interactive: options.is_interactive,
            interrupt: Mutex::default(),
            pipelines: Mutex::default(),
            samplers: Mutex::default(),
            slots: Mutex::default(),
            allocator: Mutex::new(None),
            debug,
            executables,
            #[cfg(feature = "view")]
            physical,
            #[cfg(feature = "view")]
            can_present: extensions.contains(&khr::swapchain::NAME),
            instance,
        };
        let allocator = Allocator::new(&AllocatorCreateDesc {
            instance: shared.instance.raw.clone(),
            device: shared.raw.clone(),
            physical_device: physical,
            debug_settings: Default::default(),
            buffer_device_address: false,
            allocation_sizes: block_sizes(),
        })
        .map_err(|source| GpuError::Memory {
            name: "allocator".into(),
            source,
        })?;
        shared.allocator = Mutex::new(Some(allocator));
        Ok(Self {
            shared: Arc::new(shared),
        })
    }

    pub fn info(&self) -> &DeviceInfo {
        &self.shared.info
    }

    /// Returns the messages of the validation layer since the device was opened; empty without
    /// validation.
    pub fn validation_messages(&self) -> Vec<String> {
        self.shared
            .instance
            .messages
            .lock()
            .map(|messages| messages.clone())
            .unwrap_or_default()
    }

    /// Returns how many bits of a pixel's fraction the rasteriser keeps of a vertex position: at
    /// least 4.
    pub fn sub_pixel_precision_bits(&self) -> u32 {
        self.shared.limits.sub_pixel_precision_bits
    }

    /// Returns the most bytes of a storage buffer that a shader may see at once.
    pub fn max_buffer_bytes(&self) -> u64 {
        let of_device = self.shared.limits.max_storage_buffer_range;
        self.shared.emulation.max_storage_bytes(of_device).into()
    }

    pub fn max_image_side(&self) -> u32 {
        self.shared.limits.max_image_dimension2_d
    }
}

/// Sizes of the blocks that resources share. Blocks start small, since a run of small images fills
/// a few megabytes of each kind of memory, and double with each further one.
fn block_sizes() -> AllocationSizes {
    const MB: u64 = 1 << 20;
    AllocationSizes::new(8 * MB, 4 * MB)
        .with_max_device_memblock_size(64 * MB)
        .with_max_host_memblock_size(16 * MB)
}

impl Shared {
    pub(super) fn set_name<T: vk::Handle>(&self, handle: T, name: &str) {
        if let (Some(debug), Ok(name)) = (&self.debug, CString::new(name)) {
            let info = vk::DebugUtilsObjectNameInfoEXT::default()
                .object_handle(handle)
                .object_name(&name);
            // SAFETY: the handle is alive. A failure costs only the name.
            let _ = unsafe { debug.set_debug_utils_object_name(&info) };
        }
    }

    pub(super) fn allocate(
        self: &Arc<Self>,
        name: &str,
        requirements: vk::MemoryRequirements,
        location: MemoryLocation,
        linear: bool,
    ) -> Result<Memory, GpuError> {
        if requirements.size > self.info.memory_bytes {
            return Err(GpuError::OutOfMemory {
                name: name.into(),
                bytes: Some(requirements.size),
            });
        }
        self.injector
            .reach(Site::Allocate)
            .map_err(GpuError::call("vkAllocateMemory", name))?;
        let mut allocator = lock(&self.allocator);
        let allocator = allocator
            .as_mut()
            .expect("the allocator lives as long as the device");
        let description = AllocationCreateDesc {
            name,
            requirements,
            location,
            linear,
            allocation_scheme: AllocationScheme::GpuAllocatorManaged,
        };
        let allocation = allocator
            .allocate(&description)
            .map_err(|source| match source {
                gpu_allocator::AllocationError::OutOfMemory => GpuError::OutOfMemory {
                    name: name.into(),
                    bytes: Some(requirements.size),
                },
                source => GpuError::Memory {
                    name: name.into(),
                    source,
                },
            })?;
        Ok(Memory {
            allocation,
            device: self.clone(),
        })
    }
}

/// Memory of one resource. The resource must be destroyed first.
pub(super) struct Memory {
    pub(super) allocation: Allocation,
    device: Arc<Shared>,
}

impl Drop for Memory {
    fn drop(&mut self) {
        if let Some(allocator) = lock(&self.device.allocator).as_mut() {
            // An error here would mean a foreign allocation, which `allocate` rules out.
            let _ = allocator.free(std::mem::take(&mut self.allocation));
        }
    }
}

impl Drop for Shared {
    fn drop(&mut self) {
        // SAFETY: every submission has been waited for; waiting again covers one that failed
        // midway.
        let _ = unsafe { self.raw.device_wait_idle() };
        lock(&self.pipelines).clear();
        for (_, sampler) in lock(&self.samplers).drain() {
            // SAFETY: no command is left that could use it.
            unsafe { self.raw.destroy_sampler(sampler, None) };
        }
        lock(&self.slots).clear();
        drop(lock(&self.allocator).take());
        // SAFETY: every resource holds this struct, so none is left.
        unsafe { self.raw.destroy_device(None) };
    }
}

/// Lists the extensions of the device to enable: swapchains if instance and device have them, and
/// the properties of executables if they are asked for, which the device must have.
fn extensions(
    instance: &Instance,
    physical: vk::PhysicalDevice,
    info: &DeviceInfo,
    has_executables: bool,
) -> Result<Vec<&'static CStr>, GpuError> {
    let mut names = Vec::new();
    if has_executables {
        let name = khr::pipeline_executable_properties::NAME;
        if !has_extension(instance, physical, info, name)? {
            return Err(missing(info, &name.to_string_lossy()));
        }
        names.push(name);
    }
    if instance.surface_extensions.contains(&khr::surface::NAME)
        && has_extension(instance, physical, info, khr::swapchain::NAME)?
    {
        names.push(khr::swapchain::NAME);
    }
    Ok(names)
}

/// Finds the first queue family with graphics, compute and timestamps; returns index and mask of
/// timestamp bits.
fn queue_family(
    instance: &Instance,
    physical: vk::PhysicalDevice,
    info: &DeviceInfo,
) -> Result<(u32, u64), GpuError> {
    // SAFETY: the physical device belongs to the instance.
    let families = unsafe {
        instance
            .raw
            .get_physical_device_queue_family_properties(physical)
    };
    let wanted = vk::QueueFlags::GRAPHICS | vk::QueueFlags::COMPUTE;
    let (index, family) = families
        .iter()
        .enumerate()
        .find(|(_, family)| family.queue_flags.contains(wanted) && family.timestamp_valid_bits > 0)
        .ok_or_else(|| GpuError::MissingFeature {
            device: info.name.clone(),
            feature: "a queue with graphics, compute and timestamps".into(),
        })?;
    Ok((index as u32, u64::MAX >> (64 - family.timestamp_valid_bits)))
}

fn create_device(
    instance: &Instance,
    physical: vk::PhysicalDevice,
    info: &DeviceInfo,
    family: u32,
    extensions: &[&CStr],
) -> Result<ash::Device, GpuError> {
    check_features(instance, physical, info)?;
    let priorities = [1.0];
    let queues = [vk::DeviceQueueCreateInfo::default()
        .queue_family_index(family)
        .queue_priorities(&priorities)];
    let mut features = vk::PhysicalDeviceVulkan13Features::default()
        .dynamic_rendering(true)
        .synchronization2(true)
        .maintenance4(true)
        .shader_demote_to_helper_invocation(true);
    let names: Vec<_> = extensions.iter().map(|name| name.as_ptr()).collect();
    let mut create = vk::DeviceCreateInfo::default()
        .queue_create_infos(&queues)
        .enabled_extension_names(&names)
        .push_next(&mut features);
    let mut report = vk::PhysicalDevicePipelineExecutablePropertiesFeaturesKHR::default()
        .pipeline_executable_info(true);
    if extensions.contains(&khr::pipeline_executable_properties::NAME) {
        create = create.push_next(&mut report);
    }
    // SAFETY: every pointer outlives the call, and every feature was checked above, every extension by the
    // caller.
    unsafe { instance.raw.create_device(physical, &create, None) }
        .map_err(GpuError::call("vkCreateDevice", &info.name))
}

fn missing(info: &DeviceInfo, feature: &str) -> GpuError {
    GpuError::MissingFeature {
        device: info.name.clone(),
        feature: feature.into(),
    }
}

/// Checks what every device needs; the error names what is missing.
fn check_features(
    instance: &Instance,
    physical: vk::PhysicalDevice,
    info: &DeviceInfo,
) -> Result<(), GpuError> {
    // SAFETY: the physical device belongs to the instance.
    let version = unsafe { instance.raw.get_physical_device_properties(physical) }.api_version;
    if version < vk::API_VERSION_1_3 {
        return Err(missing(
            info,
            &format!("Vulkan 1.3 (it offers {})", info.api_version),
        ));
    }
    let mut offered = vk::PhysicalDeviceVulkan13Features::default();
    let mut query = vk::PhysicalDeviceFeatures2::default().push_next(&mut offered);
    // SAFETY: as above; the chain outlives the call.
    unsafe {
        instance
            .raw
            .get_physical_device_features2(physical, &mut query)
    };
    for (has, feature) in [
        (offered.dynamic_rendering, "dynamicRendering"),
        (offered.synchronization2, "synchronization2"),
        (offered.maintenance4, "maintenance4"),
        // Fragment shaders that discard compile to demote in SPIR-V 1.6.
        (
            offered.shader_demote_to_helper_invocation,
            "shaderDemoteToHelperInvocation",
        ),
    ] {
        if has == vk::FALSE {
            return Err(missing(info, feature));
        }
    }
    let needed = vk::FormatFeatureFlags::SAMPLED_IMAGE
        | vk::FormatFeatureFlags::SAMPLED_IMAGE_FILTER_LINEAR
        | vk::FormatFeatureFlags::STORAGE_IMAGE
        | vk::FormatFeatureFlags::COLOR_ATTACHMENT;
    // SAFETY: as above.
    let format = unsafe {
        instance
            .raw
            .get_physical_device_format_properties(physical, vk::Format::R32G32B32A32_SFLOAT)
    };
    if !format.optimal_tiling_features.contains(needed) {
        return Err(missing(
            info,
            "linearly filtered, storable and renderable R32G32B32A32_SFLOAT images",
        ));
    }
    Ok(())
}

fn has_extension(
    instance: &Instance,
    physical: vk::PhysicalDevice,
    info: &DeviceInfo,
    name: &CStr,
) -> Result<bool, GpuError> {
    // SAFETY: the physical device belongs to the instance.
    let extensions =
        unsafe { instance.raw.enumerate_device_extension_properties(physical) }.map_err(
            GpuError::call("vkEnumerateDeviceExtensionProperties", &info.name),
        )?;
    Ok(extensions
        .iter()
        .any(|extension| extension.extension_name_as_c_str() == Ok(name)))
}
