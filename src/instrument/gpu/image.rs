//! Images with mip levels, and samplers.

use super::device::{Memory, Shared, lock};
use super::sync::State;
use super::{Gpu, GpuError, Wrap};
use crate::base::pixels::lookup::Edge;
use ash::vk;
use gpu_allocator::MemoryLocation;
use half::f16;
use std::collections::HashMap;
use std::ops::Range;
use std::sync::{Arc, Mutex};

/// Texels written at a time: 64 MiB are copied, not a whole map.
const STAGED_TEXELS: u32 = 1 << 22;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// Four f32; sampled, stored and rendered to.
    Rgba32Float,
    /// Four halves; sampled, and written by the host only.
    Rgba16Float,
    /// Four bytes, [0, 1]; sampled, and written by the host; or an image of a window.
    Rgba8,
    /// [`Format::Rgba8`] in the order of most windows.
    Bgra8,
    /// f32 depth; rendered to only.
    Depth32Float,
}

impl Format {
    pub(super) fn raw(self) -> vk::Format {
        match self {
            Self::Rgba32Float => vk::Format::R32G32B32A32_SFLOAT,
            Self::Rgba16Float => vk::Format::R16G16B16A16_SFLOAT,
            Self::Rgba8 => vk::Format::R8G8B8A8_UNORM,
            Self::Bgra8 => vk::Format::B8G8R8A8_UNORM,
            Self::Depth32Float => vk::Format::D32_SFLOAT,
        }
    }

    pub(super) fn aspect(self) -> vk::ImageAspectFlags {
        match self {
            Self::Depth32Float => vk::ImageAspectFlags::DEPTH,
            _ => vk::ImageAspectFlags::COLOR,
        }
    }

    fn usage(self) -> vk::ImageUsageFlags {
        use vk::ImageUsageFlags as Usage;
        let sampled = Usage::SAMPLED | Usage::TRANSFER_SRC | Usage::TRANSFER_DST;
        match self {
            Self::Rgba32Float => sampled | Usage::STORAGE | Usage::COLOR_ATTACHMENT,
            Self::Rgba16Float | Self::Rgba8 | Self::Bgra8 => sampled,
            Self::Depth32Float => Usage::DEPTH_STENCIL_ATTACHMENT,
        }
    }
}

/// A two-dimensional image, or a cube of six faces in the order of Vulkan. Clones share it.
#[derive(Clone)]
pub struct Image {
    pub(super) inner: Arc<Inner>,
}

pub(super) struct Inner {
    pub(super) raw: vk::Image,
    pub(super) format: Format,
    pub(super) size: [u32; 2],
    pub(super) face_count: u32,
    pub(super) states: Mutex<Vec<State>>,
    name: String,
    views: Mutex<HashMap<(u32, u32, vk::ImageViewType), vk::ImageView>>,
    /// Freed after the image. `None` while it is made, and for an image of a window.
    memory: Option<Memory>,
    /// Whether the image is a swapchain's, which frees it.
    is_of_window: bool,
    device: Arc<Shared>,
}

impl Image {
    pub fn mip_size(&self, mip: u32) -> [u32; 2] {
        self.inner.size.map(|side| (side >> mip).max(1))
    }

    /// Images per level: 1, or 6 for a cube.
    pub fn face_count(&self) -> u32 {
        self.inner.face_count
    }

    pub fn bytes(&self) -> u64 {
        self.inner
            .memory
            .as_ref()
            .map_or(0, |memory| memory.allocation.size())
    }

    pub fn mip_count(&self) -> u32 {
        lock(&self.inner.states).len() as u32
    }
}

impl Inner {
    /// Returns a view of the levels `mips`, made once. With `is_array` its layers are the faces;
    /// otherwise it is a plane or a cube that the hardware filters across edges.
    pub(super) fn view(&self, mips: Range<u32>, is_array: bool) -> Result<vk::ImageView, GpuError> {
        let view_type = match (is_array, self.face_count) {
            (true, _) => vk::ImageViewType::TYPE_2D_ARRAY,
            (false, 6) => vk::ImageViewType::CUBE,
            (false, _) => vk::ImageViewType::TYPE_2D,
        };
        let mut views = lock(&self.views);
        let key = (mips.start, mips.end, view_type);
        if let Some(&view) = views.get(&key) {
            return Ok(view);
        }
        let info = vk::ImageViewCreateInfo::default()
            .image(self.raw)
            .view_type(view_type)
            .format(self.format.raw())
            .subresource_range(vk::ImageSubresourceRange {
                aspect_mask: self.format.aspect(),
                base_mip_level: mips.start,
                level_count: mips.end - mips.start,
                base_array_layer: 0,
                layer_count: self.face_count,
            });
        // SAFETY: the image is alive and has these levels.
        let view = unsafe { self.device.raw.create_image_view(&info, None) }
            .map_err(GpuError::call("vkCreateImageView", &self.name))?;
        self.device
            .set_name(view, &format!("{} {mips:?}", self.name));
        views.insert(key, view);
        Ok(view)
    }
}

impl Drop for Inner {
    fn drop(&mut self) {
        for view in lock(&self.views).values() {
            // SAFETY: no pending command uses the view, as for buffers.
            unsafe { self.device.raw.destroy_image_view(*view, None) };
        }
        if !self.is_of_window {
            // SAFETY: likewise.
            unsafe { self.device.raw.destroy_image(self.raw, None) };
        }
    }
}

impl Gpu {
    pub fn image(
        &self,
        name: &str,
        size: [u32; 2],
        mip_count: u32,
        format: Format,
    ) -> Result<Image, GpuError> {
        self.faced_image(name, size, 1, mip_count, format)
    }

    /// Makes an image of 1 face, or of the 6 faces of a cube, with undefined contents.
    pub fn faced_image(
        &self,
        name: &str,
        size: [u32; 2],
        face_count: u32,
        mip_count: u32,
        format: Format,
    ) -> Result<Image, GpuError> {
        let device = &self.shared;
        let limit = self.max_image_side();
        if let Some(&side) = size.iter().find(|&&side| side == 0 || side > limit) {
            return Err(GpuError::Limit {
                what: "image side of",
                name: name.into(),
                needed: side.into(),
                limit: limit.into(),
            });
        }
        assert!(
            mip_count >= 1 && mip_count <= 32 - size[0].max(size[1]).leading_zeros(),
            "'{name}': {mip_count} levels of a {size:?} image"
        );
        let flags = if face_count == 6 {
            vk::ImageCreateFlags::CUBE_COMPATIBLE
        } else {
            vk::ImageCreateFlags::empty()
        };
        let info = vk::ImageCreateInfo::default()
            .flags(flags)
            .image_type(vk::ImageType::TYPE_2D)
            .format(format.raw())
            .extent(vk::Extent3D {
                width: size[0],
                height: size[1],
                depth: 1,
            })
            .mip_levels(mip_count)
            .array_layers(face_count)
            .samples(vk::SampleCountFlags::TYPE_1)
            .usage(format.usage());
        // SAFETY: the device is alive and the description is complete.
        let raw = unsafe { device.raw.create_image(&info, None) }
            .map_err(GpuError::call("vkCreateImage", name))?;
        device.set_name(raw, name);
        let mut inner = Inner {
            raw,
            format,
            size,
            face_count,
            states: Mutex::new(vec![State::NEW; mip_count as usize]),
            name: name.into(),
            views: Mutex::new(HashMap::new()),
            memory: None,
            is_of_window: false,
            device: device.clone(),
        };
        inner.memory = Some(self.bind_image_memory(raw, name)?);
        let image = Image {
            inner: Arc::new(inner),
        };
        if let Some(word) = self.shared.emulation.undefined_word() {
            self.spoil_image(&image, word)?;
        }
        Ok(image)
    }

    /// Fills every level of a new floating-point image, so that a shader that reads a texel which
    /// nobody wrote is noticed. Only the host of a driver for tests does it.
    fn spoil_image(&self, image: &Image, word: u32) -> Result<(), GpuError> {
        let is_float = [Format::Rgba32Float, Format::Rgba16Float].contains(&image.inner.format);
        for mip in (0..image.mip_count()).filter(|_| is_float) {
            let [width, height] = image.mip_size(mip);
            let texel_count = width * height * image.face_count();
            let texels = vec![[f32::from_bits(word); 4]; texel_count as usize];
            self.write_image(image, mip, &texels)?;
        }
        Ok(())
    }

    /// Wraps an image of a swapchain, which must outlive it.
    #[cfg(feature = "view")]
    pub(super) fn window_image(&self, raw: vk::Image, size: [u32; 2], format: Format) -> Image {
        self.shared.set_name(raw, "window");
        Image {
            inner: Arc::new(Inner {
                raw,
                format,
                size,
                face_count: 1,
                states: Mutex::new(vec![State::NEW]),
                name: "window".into(),
                views: Mutex::new(HashMap::new()),
                memory: None,
                is_of_window: true,
                device: self.shared.clone(),
            }),
        }
    }

    /// Allocates memory for a new image and binds it.
    fn bind_image_memory(&self, raw: vk::Image, name: &str) -> Result<Memory, GpuError> {
        let device = &self.shared;
        // SAFETY: the image was just made.
        let requirements = unsafe { device.raw.get_image_memory_requirements(raw) };
        let memory = device.allocate(name, requirements, MemoryLocation::GpuOnly, false)?;
        // SAFETY: the memory is not freed before its last resource.
        let raw_memory = unsafe { memory.allocation.memory() };
        // SAFETY: the allocation fits the requirements and nothing else uses its range.
        unsafe {
            device
                .raw
                .bind_image_memory(raw, raw_memory, memory.allocation.offset())
        }
        .map_err(GpuError::call("vkBindImageMemory", name))?;
        Ok(memory)
    }

    /// Fills level `mip` of a colour image, face by face. Halves are rounded to nearest, ties to
    /// even.
    pub fn write_image(
        &self,
        image: &Image,
        mip: u32,
        texels: &[[f32; 4]],
    ) -> Result<(), GpuError> {
        let [width, height] = image.mip_size(mip);
        let face_texels = width as usize * height as usize;
        assert_eq!(
            texels.len(),
            face_texels * image.face_count() as usize,
            "texels of '{}'",
            image.inner.name
        );
        let rows_at_a_time = (STAGED_TEXELS / width).clamp(1, height);
        let bands = texels
            .chunks(face_texels)
            .zip(0..)
            .flat_map(|(texels, face)| {
                let rows = (0..height).step_by(rows_at_a_time as usize);
                rows.zip(texels.chunks(rows_at_a_time as usize * width as usize))
                    .map(move |band| (face, band))
            });
        for (face, (first, texels)) in bands {
            let halves: Vec<[u16; 4]>;
            let bytes = match image.inner.format {
                Format::Rgba16Float => {
                    halves = texels
                        .iter()
                        .map(|texel| texel.map(|value| f16::from_f32(value).to_bits()))
                        .collect();
                    bytemuck::cast_slice(&halves)
                }
                _ => bytemuck::cast_slice(texels),
            };
            let staging = self.staging_from(&image.inner.name, bytes)?;
            let mut recorder = self.record(&image.inner.name)?;
            let rows = first..(first + rows_at_a_time).min(height);
            recorder.copy_buffer_to_rows(&staging, image, face, mip, rows);
            recorder.submit()?;
        }
        Ok(())
    }

    /// Reads the texels of level `mip` of a colour image, face by face and row by row.
    pub fn read_image(&self, image: &Image, mip: u32) -> Result<Vec<[f32; 4]>, GpuError> {
        let [_, height] = image.mip_size(mip);
        self.read_rows(image, mip, 0..height)
    }

    /// Reads rows of level `mip` of a colour image, face by face and row by row.
    pub fn read_rows(
        &self,
        image: &Image,
        mip: u32,
        rows: Range<u32>,
    ) -> Result<Vec<[f32; 4]>, GpuError> {
        let [width, _] = image.mip_size(mip);
        let is_half = image.inner.format == Format::Rgba16Float;
        let texel_bytes = if is_half { 8 } else { 16 };
        let row_count = u64::from(rows.end - rows.start);
        let texel_count = u64::from(width) * row_count * u64::from(image.face_count());
        let staging = self.readback(&image.inner.name, texel_bytes * texel_count)?;
        let mut recorder = self.record(&image.inner.name)?;
        recorder.copy_rows_to_buffer(image, mip, rows, &staging);
        recorder.submit()?;
        if is_half {
            let bits: Vec<[u16; 4]> = staging.host_copy();
            return Ok(bits
                .iter()
                .map(|texel| texel.map(|half| f16::from_bits(half).to_f32()))
                .collect());
        }
        Ok(staging.host_copy())
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Filter {
    Nearest,
    Linear,
}

/// How shaders look an image up, over all levels. Anisotropy stays off: it breaks `textureLod` in
/// Mesa 22.3.6.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Sampler(pub Filter, pub Wrap);

impl Sampler {
    /// Trilinear, for maps of the sphere in every layout. u repeats; cubes and the octahedral
    /// filter ignore that.
    pub const MAP: Self = Self(Filter::Linear, Wrap::EQUIRECT);
    /// For shaders that fetch texels.
    pub const TEXELS: Self = Self(Filter::Nearest, Wrap::CLAMP);
}

impl Shared {
    /// Returns the Vulkan object of a sampler, made once.
    pub(super) fn sampler(&self, sampler: Sampler) -> Result<vk::Sampler, GpuError> {
        let mut known = lock(&self.samplers);
        if let Some(&raw) = known.get(&sampler) {
            return Ok(raw);
        }
        let (within, between) = match sampler.0 {
            Filter::Nearest => (vk::Filter::NEAREST, vk::SamplerMipmapMode::NEAREST),
            Filter::Linear => (vk::Filter::LINEAR, vk::SamplerMipmapMode::LINEAR),
        };
        let mode = |edge: Edge| match edge {
            Edge::Clamp => vk::SamplerAddressMode::CLAMP_TO_EDGE,
            Edge::Repeat => vk::SamplerAddressMode::REPEAT,
            Edge::Mirror => vk::SamplerAddressMode::MIRRORED_REPEAT,
        };
        let Wrap(u, v) = sampler.1;
        let info = vk::SamplerCreateInfo::default()
            .mag_filter(within)
            .min_filter(within)
            .mipmap_mode(between)
            .address_mode_u(mode(u))
            .address_mode_v(mode(v))
            .address_mode_w(vk::SamplerAddressMode::CLAMP_TO_EDGE)
            .max_lod(vk::LOD_CLAMP_NONE);
        // SAFETY: the device is alive and the description is complete.
        let raw = unsafe { self.raw.create_sampler(&info, None) }
            .map_err(GpuError::call("vkCreateSampler", "sampler"))?;
        known.insert(sampler, raw);
        Ok(raw)
    }
}
