//! Vulkan: device, memory, pipelines, recording, timestamps. The only unsafe code.
//!
//! Buffers and images are handles that share a Vulkan object and free it with the last clone.
//! Pipelines and samplers are made on first use and live as long as the device. A [`Recorder`]
//! keeps what it records alive and derives barriers and layouts from the tracked access of each
//! buffer and mip level. `submit` waits.
#![allow(unsafe_code, reason = "Vulkan is a C interface")]

mod bounded;
mod buffer;
mod device;
mod driver_cache;
mod emulation;
mod error;
mod executable;
mod host_memory;
mod image;
mod inject;
mod instance;
mod kept_pipeline;
mod pipeline;
pub mod processor;
mod recorder;
mod shader;
mod slot;
#[cfg(feature = "view")]
mod swapchain;
mod sync;
mod variant;

pub use crate::base::pixels::lookup::Wrap;
pub use bounded::{Groups, Part, face_groups, image_groups};
pub use buffer::Buffer;
pub use device::Gpu;
#[cfg(feature = "view")]
pub(crate) use device::lock;
pub use emulation::LIMITS;
pub use error::GpuError;
pub use executable::Executable;
pub use image::{Filter, Format, Image, Sampler};
pub use instance::{DeviceChoice, DeviceInfo, Options, chosen_device, devices};
pub use pipeline::{GraphicsDescription, Output};
#[cfg(feature = "view")]
pub use recorder::Painted;
pub use recorder::{Bind, DrawCall, PassTime, Recorder, Report, Targets};
pub use shader::{
    EditedShaders, HOST_FILES, HOST_HASH, add_shader, added_shader, build_hash, code_hash,
    has_edited_shaders, has_shader, names_read, shader_code, shader_names, shader_sources,
};
#[cfg(feature = "view")]
pub use swapchain::{Acquired, Swapchain};
pub use variant::ShaderVariant;
