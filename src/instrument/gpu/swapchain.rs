//! Presents images of the device in a window.
//!
//! An image is acquired, painted by one submission and presented. The submission waits for the
//! semaphore of the acquisition and signals one of the image; the host waits for the submission, so
//! the first semaphore is free again, and the second one when its image is acquired again.

use super::device::lock;
use super::inject::Site;
use super::sync::State;
use super::{Format, Gpu, GpuError, Image, Recorder};
use ash::{khr, vk};
use raw_window_handle::{HasDisplayHandle, HasWindowHandle};
use std::ffi::CStr;
use std::rc::Rc;

/// Longest wait for a free image, ns: a window that is hidden may give none.
const PATIENCE_NS: u64 = 100_000_000;
/// How often an image of an outdated chain is asked for again before a frame is left out.
const TRIES: u32 = 3;

/// Anything with a window and its display.
pub trait Window: HasWindowHandle + HasDisplayHandle {}
impl<T: HasWindowHandle + HasDisplayHandle> Window for T {}

/// Images that a window shows, as large as the window.
pub struct Swapchain {
    /// `None` before the first image, and while the window has no pixels. Dropped before the
    /// surface.
    chain: Option<Chain>,
    acquired: Semaphore,
    surface: Surface,
    format: Format,
    mode: vk::PresentModeKHR,
    loader: khr::swapchain::Device,
    gpu: Gpu,
}

/// An image that may be painted, then presented.
pub struct Acquired {
    pub image: Image,
    index: u32,
}

impl Gpu {
    /// Prepares to present in a window.
    ///
    /// [`GpuError::CannotPresent`] if display, driver or queue cannot: then nothing was made.
    pub fn swapchain(&self, window: Rc<dyn Window>) -> Result<Swapchain, GpuError> {
        if !self.shared.can_present {
            return Err(self.cannot_present("there is no VK_KHR_swapchain"));
        }
        let surface = Surface::new(self, window)?;
        Ok(Swapchain {
            chain: None,
            acquired: Semaphore::new(self)?,
            format: surface.format()?,
            mode: surface.present_mode()?,
            surface,
            loader: khr::swapchain::Device::new(&self.shared.instance.raw, &self.shared.raw),
            gpu: self.clone(),
        })
    }

    fn cannot_present(&self, why: impl Into<String>) -> GpuError {
        GpuError::CannotPresent {
            device: self.info().name.clone(),
            why: why.into(),
        }
    }
}

impl Swapchain {
    /// Returns an image to paint. `size` is the window's in pixels, which the image's may differ
    /// from for a moment. `None` if the window has no pixels, or no image gets free.
    pub fn acquire(&mut self, size: [u32; 2]) -> Result<Option<Acquired>, GpuError> {
        for _ in 0..TRIES {
            if self.chain.as_ref().is_none_or(|chain| !chain.is_for(size)) {
                self.make_chain(size)?;
            }
            let Some(chain) = &mut self.chain else {
                return Ok(None);
            };
            // SAFETY: the semaphore is unsignalled: the submission that waited for it has ended.
            let next = unsafe {
                self.loader.acquire_next_image(
                    chain.raw,
                    PATIENCE_NS,
                    self.acquired.raw,
                    vk::Fence::null(),
                )
            };
            match next {
                Ok((index, is_suboptimal)) => {
                    chain.is_outdated |= is_suboptimal;
                    let image = chain.images[index as usize].clone();
                    *lock(&image.inner.states) = vec![State::ACQUIRED];
                    return Ok(Some(Acquired { image, index }));
                }
                Err(vk::Result::ERROR_OUT_OF_DATE_KHR) => chain.is_outdated = true,
                Err(vk::Result::TIMEOUT | vk::Result::NOT_READY) => return Ok(None),
                Err(result) => {
                    return Err(GpuError::call("vkAcquireNextImageKHR", "window")(result));
                }
            }
        }
        Ok(None)
    }

    /// Submits what paints an image, waits for it, and presents the image.
    pub fn present(&mut self, mut recorder: Recorder, next: &Acquired) -> Result<(), GpuError> {
        let Some(chain) = &mut self.chain else {
            return Ok(());
        };
        recorder.release_to_window(&next.image);
        let painted = &chain.painted[next.index as usize];
        let wait = vk::SemaphoreSubmitInfo::default()
            .semaphore(self.acquired.raw)
            .stage_mask(vk::PipelineStageFlags2::COLOR_ATTACHMENT_OUTPUT);
        let signal = vk::SemaphoreSubmitInfo::default()
            .semaphore(painted.raw)
            .stage_mask(vk::PipelineStageFlags2::ALL_COMMANDS);
        recorder.submit_between(&[wait], &[signal])?;
        let semaphores = [painted.raw];
        let chains = [chain.raw];
        let indices = [next.index];
        let info = vk::PresentInfoKHR::default()
            .wait_semaphores(&semaphores)
            .swapchains(&chains)
            .image_indices(&indices);
        let shared = &self.gpu.shared;
        let _one_at_a_time = lock(&shared.submission);
        // SAFETY: the queue is this thread's; the submission signals the semaphore.
        let presented = unsafe { self.loader.queue_present(shared.queue, &info) };
        let injected = shared.injector.reach(Site::Present);
        match injected.and(presented) {
            Ok(is_suboptimal) => chain.is_outdated |= is_suboptimal,
            Err(vk::Result::ERROR_OUT_OF_DATE_KHR) => chain.is_outdated = true,
            Err(result) => return Err(GpuError::call("vkQueuePresentKHR", "window")(result)),
        }
        Ok(())
    }

    /// Makes the surface of the window again, after it was lost.
    pub fn renew(&mut self) -> Result<(), GpuError> {
        self.chain = None;
        // An acquisition that nothing waited for may have signalled it.
        self.acquired = Semaphore::new(&self.gpu)?;
        self.surface = Surface::new(&self.gpu, self.surface.window.clone())?;
        Ok(())
    }

    /// Makes the chain for a window of `size`; none without pixels.
    fn make_chain(&mut self, size: [u32; 2]) -> Result<(), GpuError> {
        let capabilities = self.surface.capabilities()?;
        let extent = match capabilities.current_extent {
            // The window is as large as its images.
            vk::Extent2D {
                width: u32::MAX, ..
            } => size,
            vk::Extent2D { width, height } => [width, height],
        };
        if let Some(chain) = &mut self.chain
            && !chain.is_outdated
            && chain.extent == extent
        {
            chain.size = size;
            return Ok(());
        }
        // A window has one chain at a time.
        self.chain = None;
        if extent.contains(&0) {
            return Ok(());
        }
        let chain = Chain {
            images: Vec::new(),
            painted: Vec::new(),
            raw: self.raw_chain(&capabilities, extent)?,
            size,
            extent,
            is_outdated: false,
            loader: self.loader.clone(),
            gpu: self.gpu.clone(),
        };
        self.chain = Some(chain.with_images(self.format)?);
        Ok(())
    }

    fn raw_chain(
        &self,
        capabilities: &vk::SurfaceCapabilitiesKHR,
        extent: [u32; 2],
    ) -> Result<vk::SwapchainKHR, GpuError> {
        // One more than the system needs, so that one is free; 0 means any number.
        let most = capabilities.max_image_count.wrapping_sub(1);
        let alphas = capabilities.supported_composite_alpha;
        let alpha = if alphas.contains(vk::CompositeAlphaFlagsKHR::OPAQUE) {
            vk::CompositeAlphaFlagsKHR::OPAQUE
        } else {
            vk::CompositeAlphaFlagsKHR::INHERIT
        };
        let info = vk::SwapchainCreateInfoKHR::default()
            .surface(self.surface.raw)
            .min_image_count(capabilities.min_image_count.min(most) + 1)
            .image_format(self.format.raw())
            .image_color_space(vk::ColorSpaceKHR::SRGB_NONLINEAR)
            .image_extent(vk::Extent2D {
                width: extent[0],
                height: extent[1],
            })
            .image_array_layers(1)
            .image_usage(vk::ImageUsageFlags::COLOR_ATTACHMENT)
            .pre_transform(capabilities.current_transform)
            .composite_alpha(alpha)
            .present_mode(self.mode)
            .clipped(true);
        // SAFETY: the surface is alive and has no chain; the description is complete.
        unsafe { self.loader.create_swapchain(&info, None) }
            .map_err(GpuError::call("vkCreateSwapchainKHR", "window"))
    }
}

/// Images of one size.
struct Chain {
    images: Vec<Image>,
    /// Signalled when an image is painted.
    painted: Vec<Semaphore>,
    raw: vk::SwapchainKHR,
    /// The size of the window that asked for it.
    size: [u32; 2],
    extent: [u32; 2],
    is_outdated: bool,
    loader: khr::swapchain::Device,
    gpu: Gpu,
}

impl Chain {
    fn is_for(&self, size: [u32; 2]) -> bool {
        !self.is_outdated && self.size == size
    }

    fn with_images(mut self, format: Format) -> Result<Self, GpuError> {
        // SAFETY: the chain is alive.
        let images = unsafe { self.loader.get_swapchain_images(self.raw) }
            .map_err(GpuError::call("vkGetSwapchainImagesKHR", "window"))?;
        for raw in images {
            let image = self.gpu.window_image(raw, self.extent, format);
            self.images.push(image);
            self.painted.push(Semaphore::new(&self.gpu)?);
        }
        Ok(self)
    }
}

impl Drop for Chain {
    fn drop(&mut self) {
        let shared = &self.gpu.shared;
        {
            let _one_at_a_time = lock(&shared.submission);
            // SAFETY: the queue is this thread's. A lost device waits for nothing.
            let _ = unsafe { shared.raw.queue_wait_idle(shared.queue) };
        }
        self.images.clear();
        // SAFETY: nothing uses the images: all submissions have ended and their views are gone.
        unsafe { self.loader.destroy_swapchain(self.raw, None) };
    }
}

/// A surface, and the window that it belongs to.
struct Surface {
    raw: vk::SurfaceKHR,
    loader: khr::surface::Instance,
    window: Rc<dyn Window>,
    gpu: Gpu,
}

impl Surface {
    fn new(gpu: &Gpu, window: Rc<dyn Window>) -> Result<Self, GpuError> {
        let refuse = |why: &dyn std::fmt::Display| gpu.cannot_present(why.to_string());
        let display = window.display_handle().map_err(|error| refuse(&error))?;
        let handle = window.window_handle().map_err(|error| refuse(&error))?;
        let instance = &gpu.shared.instance;
        let needed = ash_window::enumerate_required_extensions(display.as_raw())
            .map_err(|result| refuse(&format!("its display is unknown ({result:?})")))?;
        for name in needed {
            // SAFETY: the names are constants of ash.
            let name = unsafe { CStr::from_ptr(*name) };
            if !instance.surface_extensions.contains(&name) {
                return Err(refuse(&format!("there is no {}", name.to_string_lossy())));
            }
        }
        let failed = |result: vk::Result| refuse(&format!("its surface failed with {result:?}"));
        let injector = &gpu.shared.injector;
        injector.reach(Site::Surface).map_err(failed)?;
        // SAFETY: the extensions are enabled; the surface keeps window, instance and loader alive.
        let raw = unsafe {
            ash_window::create_surface(
                &instance.entry,
                &instance.raw,
                display.as_raw(),
                handle.as_raw(),
                None,
            )
        }
        .map_err(failed)?;
        let surface = Self {
            raw,
            loader: khr::surface::Instance::new(&instance.entry, &instance.raw),
            window: window.clone(),
            gpu: gpu.clone(),
        };
        if !surface.is_shown_by_queue()? {
            return Err(refuse(&"its queue cannot"));
        }
        Ok(surface)
    }

    fn is_shown_by_queue(&self) -> Result<bool, GpuError> {
        let shared = &self.gpu.shared;
        // SAFETY: the surface is alive and the queue is the device's.
        unsafe {
            self.loader.get_physical_device_surface_support(
                shared.physical,
                shared.queue_family,
                self.raw,
            )
        }
        .map_err(GpuError::call(
            "vkGetPhysicalDeviceSurfaceSupportKHR",
            "window",
        ))
    }

    fn capabilities(&self) -> Result<vk::SurfaceCapabilitiesKHR, GpuError> {
        // SAFETY: the surface is alive.
        unsafe {
            self.loader
                .get_physical_device_surface_capabilities(self.gpu.shared.physical, self.raw)
        }
        .map_err(GpuError::call(
            "vkGetPhysicalDeviceSurfaceCapabilitiesKHR",
            "window",
        ))
    }

    /// Chooses a format that keeps display values as they are: it must not encode them again.
    fn format(&self) -> Result<Format, GpuError> {
        // SAFETY: the surface is alive.
        let offered = unsafe {
            self.loader
                .get_physical_device_surface_formats(self.gpu.shared.physical, self.raw)
        }
        .map_err(GpuError::call(
            "vkGetPhysicalDeviceSurfaceFormatsKHR",
            "window",
        ))?;
        let is_offered = |format: &Format| {
            offered.iter().any(|known| {
                known.format == format.raw()
                    && known.color_space == vk::ColorSpaceKHR::SRGB_NONLINEAR
            })
        };
        [Format::Bgra8, Format::Rgba8]
            .into_iter()
            .find(is_offered)
            .ok_or_else(|| {
                self.gpu
                    .cannot_present("there is no format of 8 bits a channel")
            })
    }

    /// Chooses the newest image at each refresh, which never blocks; every device has the other
    /// mode.
    fn present_mode(&self) -> Result<vk::PresentModeKHR, GpuError> {
        // SAFETY: the surface is alive.
        let offered = unsafe {
            self.loader
                .get_physical_device_surface_present_modes(self.gpu.shared.physical, self.raw)
        }
        .map_err(GpuError::call(
            "vkGetPhysicalDeviceSurfacePresentModesKHR",
            "window",
        ))?;
        Ok(if offered.contains(&vk::PresentModeKHR::MAILBOX) {
            vk::PresentModeKHR::MAILBOX
        } else {
            vk::PresentModeKHR::FIFO
        })
    }
}

impl Drop for Surface {
    fn drop(&mut self) {
        // SAFETY: its chain is gone, since it is dropped first.
        unsafe { self.loader.destroy_surface(self.raw, None) };
    }
}

struct Semaphore {
    raw: vk::Semaphore,
    gpu: Gpu,
}

impl Semaphore {
    fn new(gpu: &Gpu) -> Result<Self, GpuError> {
        // SAFETY: the device is alive.
        let raw = unsafe {
            gpu.shared
                .raw
                .create_semaphore(&vk::SemaphoreCreateInfo::default(), None)
        }
        .map_err(GpuError::call("vkCreateSemaphore", "window"))?;
        Ok(Self {
            raw,
            gpu: gpu.clone(),
        })
    }
}

impl Drop for Semaphore {
    fn drop(&mut self) {
        // SAFETY: the queue is idle: the chain waits for it before its semaphores are dropped, and
        // the submission that waited for an acquisition has ended.
        unsafe { self.gpu.shared.raw.destroy_semaphore(self.raw, None) };
    }
}
