use super::emulation::LIMITS;
use ash::vk;

#[derive(Debug, thiserror::Error)]
pub enum GpuError {
    #[error(
        "no Vulkan loader: {0}; install it (Debian: apt-get install libvulkan1 \
         mesa-vulkan-drivers) or put libvulkan.so.1 on the library path"
    )]
    NoLoader(String),
    #[error(
        "the Vulkan loader found no device; install a driver (Debian, without a GPU: apt-get \
         install mesa-vulkan-drivers) or check VK_DRIVER_FILES and VK_ICD_FILENAMES"
    )]
    NoDevice,
    #[error("no device of Mesa's RADV")]
    NoRadv,
    #[error("'{shader}': {what}")]
    Reflection { shader: String, what: String },
    #[error(
        "the Vulkan loader's {call} failed with {result:?}; the manifest of a driver or layer may \
         be damaged: check VK_DRIVER_FILES, VK_ICD_FILENAMES and VK_LAYER_PATH"
    )]
    Loader {
        call: &'static str,
        result: vk::Result,
    },
    #[error("device {index} does not exist: there are {count}; `splitsum devices` lists them")]
    NoSuchDevice { index: usize, count: usize },
    #[error("device '{device}' lacks {feature}, which splitsum needs")]
    MissingFeature { device: String, feature: String },
    #[error("device '{device}' cannot present in this window: {why}")]
    CannotPresent { device: String, why: String },
    #[error(
        "the validation layer VK_LAYER_KHRONOS_validation is not installed (Debian: apt-get \
         install vulkan-validationlayers)"
    )]
    NoValidationLayer,
    #[error("{what} '{name}' needs {needed}, the device's limit is {limit}")]
    Limit {
        what: &'static str,
        name: String,
        needed: u64,
        limit: u64,
    },
    #[error("out of device memory for '{name}'{}", bytes.map_or_else(String::new, |bytes| format!(", which needs {bytes} bytes")))]
    OutOfMemory { name: String, bytes: Option<u64> },
    #[error("the device was lost during '{during}'; a retry may succeed")]
    DeviceLost { during: String },
    #[error("interrupted")]
    Interrupted,
    #[error(
        "{variable}: unknown fault '{word}'; expected SITE:COUNT:FAULT, such as \
         submit:1:device-lost"
    )]
    UnknownTestFault {
        variable: &'static str,
        word: String,
    },
    #[error(
        "{variable}: unknown limit '{word}'; expected of: {}",
        names_of_limits()
    )]
    UnknownTestLimit {
        variable: &'static str,
        word: String,
    },
    #[error("no shader named '{0}' was built")]
    NoShader(String),
    #[error("{call} failed with {result:?} ('{name}')")]
    Call {
        call: &'static str,
        name: String,
        result: vk::Result,
    },
    #[error("memory for '{name}': {source}")]
    Memory {
        name: String,
        source: gpu_allocator::AllocationError,
    },
}

fn names_of_limits() -> String {
    LIMITS.map(|(name, _)| name).join(", ")
}

impl GpuError {
    /// Makes the error of a failed call on an object named `name`.
    pub(super) fn call(call: &'static str, name: &str) -> impl FnOnce(vk::Result) -> Self {
        let name = name.to_string();
        move |result| match result {
            vk::Result::ERROR_DEVICE_LOST => Self::DeviceLost { during: name },
            vk::Result::ERROR_OUT_OF_DEVICE_MEMORY | vk::Result::ERROR_OUT_OF_HOST_MEMORY => {
                Self::OutOfMemory { name, bytes: None }
            }
            result => Self::Call { call, name, result },
        }
    }

    pub fn is_out_of_memory(&self) -> bool {
        matches!(self, Self::OutOfMemory { .. })
    }

    /// Whether a retry on a fresh device may succeed.
    pub fn is_transient(&self) -> bool {
        matches!(self, Self::DeviceLost { .. })
    }
}
