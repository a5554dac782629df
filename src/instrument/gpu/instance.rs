//! The instance, physical devices and their properties.

use super::processor;
use super::{GpuError, driver_cache};
use ash::{Entry, ext, khr, vk};
use std::ffi::{CStr, c_void};
use std::sync::{Arc, Mutex};

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum DeviceChoice {
    /// The first discrete GPU, else the first integrated or virtual one, else the first device (a
    /// CPU driver).
    #[default]
    Default,
    /// The device at this index of [`devices`].
    Index(usize),
    /// The first device of RADV, Mesa's driver for AMD GPUs.
    Radv,
}

#[derive(Clone, Copy, Debug, Default)]
pub struct Options {
    pub device: DeviceChoice,
    /// Enables the Khronos validation layer with synchronization validation; see
    /// [`super::Gpu::validation_messages`].
    pub validation: bool,
    /// Enables [`super::Gpu::executables`].
    pub executables: bool,
    /// Makes submissions short, so that [`super::Gpu::interrupt_by`] acts soon. Results are the
    /// same.
    pub is_interactive: bool,
    /// Enables what a window needs, as far as loader and device have it.
    pub is_presenting: bool,
}

#[derive(Clone, Debug, PartialEq)]
pub struct DeviceInfo {
    pub name: String,
    /// `cpu`, `discrete-gpu`, `integrated-gpu`, `virtual-gpu` or `other`.
    pub device_type: &'static str,
    /// Name and version, as the driver reports them.
    pub driver: String,
    /// The processor that the driver compiles for; `None` for a GPU.
    pub target: Option<String>,
    pub api_version: String,
    /// Length of a timestamp tick, ns.
    pub timestamp_period_ns: f32,
    /// Size of the largest device-local heap, bytes.
    pub memory_bytes: u64,
    /// Whether bilinear filters compute in f32 (lavapipe: error below 3e-6) instead of with 8-bit
    /// weights.
    pub has_exact_filter: bool,
    /// Whether compute shaders filter cubes across edges. SwiftShader returns black there.
    pub has_seamless_cubes: bool,
    pub is_radv: bool,
}

const VALIDATION_LAYER: &CStr = c"VK_LAYER_KHRONOS_validation";

/// Surfaces in general, and of each system with windows.
const SURFACE_EXTENSIONS: [&CStr; 6] = [
    khr::surface::NAME,
    khr::xlib_surface::NAME,
    khr::xcb_surface::NAME,
    khr::wayland_surface::NAME,
    khr::win32_surface::NAME,
    ext::metal_surface::NAME,
];

/// The instance and the messages of its validation layer.
pub(super) struct Instance {
    pub(super) raw: ash::Instance,
    messenger: Option<(ext::debug_utils::Instance, vk::DebugUtilsMessengerEXT)>,
    pub(super) messages: Arc<Mutex<Vec<String>>>,
    /// Objects get names only if a debugger can see them.
    pub(super) has_debug_utils: bool,
    /// [`SURFACE_EXTENSIONS`] that are enabled.
    pub(super) surface_extensions: Vec<&'static CStr>,
    pub(super) entry: Entry,
}

/// Whether a window may be on a display of this surface extension. With the one of Wayland, Mesa
/// connects to its display, and complains on standard error if there is none.
fn may_have_display(extension: &CStr) -> bool {
    let is_set = |name| std::env::var_os(name).is_some_and(|value| !value.is_empty());
    extension != khr::wayland_surface::NAME || is_set("WAYLAND_DISPLAY") || is_set("WAYLAND_SOCKET")
}

/// Creates an instance with the validation layer if `has_validation`.
fn create_instance(
    entry: &Entry,
    has_validation: bool,
    extensions: &[&CStr],
) -> Result<ash::Instance, GpuError> {
    let application = vk::ApplicationInfo::default()
        .application_name(c"splitsum")
        .api_version(vk::API_VERSION_1_3);
    let layer_names = if has_validation {
        vec![VALIDATION_LAYER.as_ptr()]
    } else {
        Vec::new()
    };
    let extension_names: Vec<_> = extensions.iter().map(|name| name.as_ptr()).collect();
    let enabled = [vk::ValidationFeatureEnableEXT::SYNCHRONIZATION_VALIDATION];
    let mut features = vk::ValidationFeaturesEXT::default().enabled_validation_features(&enabled);
    let mut info = vk::InstanceCreateInfo::default()
        .application_info(&application)
        .enabled_layer_names(&layer_names)
        .enabled_extension_names(&extension_names);
    if has_validation {
        info = info.push_next(&mut features);
    }
    // SAFETY: every pointer in `info` outlives the call.
    unsafe { entry.create_instance(&info, None) }.map_err(|result| match result {
        vk::Result::ERROR_INCOMPATIBLE_DRIVER => GpuError::NoDevice,
        result => GpuError::Loader {
            call: "vkCreateInstance",
            result,
        },
    })
}

impl Instance {
    /// Creates an instance, with the surfaces of windows if `is_presenting`.
    pub(super) fn new(validation: bool, is_presenting: bool) -> Result<Self, GpuError> {
        // A loader that cannot parse a manifest reports that memory ran out.
        let failed = |call| move |result| GpuError::Loader { call, result };
        driver_cache::disable_without_room();
        // SAFETY: the loader is a well-behaved library that has no preconditions on being opened.
        let entry = unsafe { Entry::load() }.map_err(|e| GpuError::NoLoader(e.to_string()))?;
        // SAFETY: the entry is loaded; the call only reads.
        let layers = unsafe { entry.enumerate_instance_layer_properties() }
            .map_err(failed("vkEnumerateInstanceLayerProperties"))?;
        if validation
            && !layers
                .iter()
                .any(|layer| layer.layer_name_as_c_str() == Ok(VALIDATION_LAYER))
        {
            return Err(GpuError::NoValidationLayer);
        }
        // SAFETY: as above.
        let extensions = unsafe { entry.enumerate_instance_extension_properties(None) }
            .map_err(failed("vkEnumerateInstanceExtensionProperties"))?;
        let is_offered = |name: &&'static CStr| {
            extensions
                .iter()
                .any(|extension| extension.extension_name_as_c_str() == Ok(*name))
        };
        let has_debug_utils = is_offered(&ext::debug_utils::NAME);
        let surface_extensions: Vec<_> = SURFACE_EXTENSIONS
            .into_iter()
            .filter(|name| is_presenting && is_offered(name) && may_have_display(name))
            .collect();
        let mut enabled = surface_extensions.clone();
        enabled.extend(has_debug_utils.then_some(ext::debug_utils::NAME));
        let raw = create_instance(&entry, validation, &enabled)?;
        let messages = Arc::new(Mutex::new(Vec::new()));
        let mut instance = Self {
            raw,
            messenger: None,
            messages,
            has_debug_utils,
            surface_extensions,
            entry,
        };
        if validation && has_debug_utils {
            instance.messenger = Some(instance.install_messenger()?);
        }
        Ok(instance)
    }

    fn install_messenger(
        &self,
    ) -> Result<(ext::debug_utils::Instance, vk::DebugUtilsMessengerEXT), GpuError> {
        let loader = ext::debug_utils::Instance::new(&self.entry, &self.raw);
        let info = vk::DebugUtilsMessengerCreateInfoEXT::default()
            .message_severity(
                vk::DebugUtilsMessageSeverityFlagsEXT::ERROR
                    | vk::DebugUtilsMessageSeverityFlagsEXT::WARNING,
            )
            .message_type(
                vk::DebugUtilsMessageTypeFlagsEXT::VALIDATION
                    | vk::DebugUtilsMessageTypeFlagsEXT::PERFORMANCE,
            )
            .pfn_user_callback(Some(on_message))
            .user_data(Arc::as_ptr(&self.messages) as *mut c_void);
        // SAFETY: the user data is the mutex that `self.messages` keeps alive, and the messenger
        // dies before it.
        let messenger = unsafe { loader.create_debug_utils_messenger(&info, None) }.map_err(
            GpuError::call("vkCreateDebugUtilsMessengerEXT", "messenger"),
        )?;
        Ok((loader, messenger))
    }

    /// Lists every physical device in the loader's order.
    pub(super) fn physical_devices(
        &self,
    ) -> Result<Vec<(vk::PhysicalDevice, DeviceInfo)>, GpuError> {
        // SAFETY: the instance is alive; the calls only read.
        let all = unsafe { self.raw.enumerate_physical_devices() }
            .map_err(GpuError::call("vkEnumeratePhysicalDevices", "instance"))?;
        Ok(all
            .into_iter()
            .map(|device| (device, self.info(device)))
            .collect())
    }

    fn info(&self, device: vk::PhysicalDevice) -> DeviceInfo {
        let mut driver = vk::PhysicalDeviceDriverProperties::default();
        let mut properties = vk::PhysicalDeviceProperties2::default().push_next(&mut driver);
        // SAFETY: `device` comes from this instance; the chain outlives the call.
        unsafe {
            self.raw
                .get_physical_device_properties2(device, &mut properties)
        };
        let core = properties.properties;
        let driver_id = driver.driver_id;
        // SAFETY: as above.
        let memory = unsafe { self.raw.get_physical_device_memory_properties(device) };
        let heaps = &memory.memory_heaps[..memory.memory_heap_count as usize];
        let local = heaps
            .iter()
            .filter(|heap| heap.flags.contains(vk::MemoryHeapFlags::DEVICE_LOCAL));
        let text = |bytes: Result<&CStr, _>| {
            bytes.map_or_else(|_| "?".into(), |s| s.to_string_lossy().into_owned())
        };
        DeviceInfo {
            name: text(core.device_name_as_c_str()),
            device_type: match core.device_type {
                vk::PhysicalDeviceType::CPU => "cpu",
                vk::PhysicalDeviceType::DISCRETE_GPU => "discrete-gpu",
                vk::PhysicalDeviceType::INTEGRATED_GPU => "integrated-gpu",
                vk::PhysicalDeviceType::VIRTUAL_GPU => "virtual-gpu",
                _ => "other",
            },
            driver: format!(
                "{} {}",
                text(driver.driver_name_as_c_str()),
                text(driver.driver_info_as_c_str())
            ),
            target: (core.device_type == vk::PhysicalDeviceType::CPU)
                .then(|| processor::target().to_owned()),
            api_version: format!(
                "{}.{}.{}",
                vk::api_version_major(core.api_version),
                vk::api_version_minor(core.api_version),
                vk::api_version_patch(core.api_version)
            ),
            timestamp_period_ns: core.limits.timestamp_period,
            has_exact_filter: driver_id == vk::DriverId::MESA_LLVMPIPE,
            has_seamless_cubes: driver_id != vk::DriverId::GOOGLE_SWIFTSHADER,
            is_radv: driver_id == vk::DriverId::MESA_RADV,
            memory_bytes: local.map(|heap| heap.size).max().unwrap_or(0),
        }
    }

    pub(super) fn choose(
        &self,
        choice: DeviceChoice,
    ) -> Result<(vk::PhysicalDevice, DeviceInfo), GpuError> {
        let mut all = self.physical_devices()?;
        let count = all.len();
        let index = match choice {
            DeviceChoice::Index(index) if index < count => index,
            DeviceChoice::Index(index) => return Err(GpuError::NoSuchDevice { index, count }),
            DeviceChoice::Radv => all
                .iter()
                .position(|(_, info)| info.is_radv)
                .ok_or(GpuError::NoRadv)?,
            DeviceChoice::Default => {
                let rank = |info: &DeviceInfo| match info.device_type {
                    "discrete-gpu" => 0,
                    "integrated-gpu" | "virtual-gpu" => 1,
                    _ => 2,
                };
                (0..count)
                    .min_by_key(|&i| (rank(&all[i].1), i))
                    .ok_or(GpuError::NoDevice)?
            }
        };
        Ok(all.swap_remove(index))
    }
}

impl Drop for Instance {
    fn drop(&mut self) {
        if let Some((loader, messenger)) = self.messenger.take() {
            // SAFETY: created from this instance, used by no one else.
            unsafe { loader.destroy_debug_utils_messenger(messenger, None) };
        }
        // SAFETY: the device holds the instance, so nothing made from it is left.
        unsafe { self.raw.destroy_instance(None) };
    }
}

/// Lists every device in the order of [`DeviceChoice::Index`].
pub fn devices() -> Result<Vec<DeviceInfo>, GpuError> {
    Ok(Instance::new(false, false)?
        .physical_devices()?
        .into_iter()
        .map(|(_, info)| info)
        .collect())
}

/// Returns the device that `choice` would open, without opening it.
pub fn chosen_device(choice: DeviceChoice) -> Result<DeviceInfo, GpuError> {
    Ok(Instance::new(false, false)?.choose(choice)?.1)
}

/// SAFETY: called by the loader with a valid message and the user data of
/// [`Instance::install_messenger`].
unsafe extern "system" fn on_message(
    _severity: vk::DebugUtilsMessageSeverityFlagsEXT,
    _kind: vk::DebugUtilsMessageTypeFlagsEXT,
    data: *const vk::DebugUtilsMessengerCallbackDataEXT<'_>,
    user: *mut c_void,
) -> vk::Bool32 {
    // SAFETY: the loader passes a valid message.
    let data = unsafe { &*data };
    // SAFETY: its text is null or ends in a zero.
    let message = unsafe { data.message_as_c_str() };
    let text = message.map_or_else(String::new, |s| s.to_string_lossy().into_owned());
    // SAFETY: the user data points to the mutex that the instance keeps alive longer than the
    // messenger.
    let messages = unsafe { &*(user as *const Mutex<Vec<String>>) };
    if let Ok(mut messages) = messages.lock() {
        messages.push(text);
    }
    vk::FALSE
}
