//! Estimates whether a request fits the device, before anything is allocated.

use super::antialias::points_size;
use super::{PipelineError, RenderRequest};
use crate::instrument::gpu::Gpu;
use crate::instrument::shade::reference_pass::SUM_BYTES_PER_PIXEL;

/// Bytes per texel of four f32.
const VEC4: u64 = 16;

/// Largest storage buffer of any device (`maxStorageBufferRange` is a u32), bytes.
pub const BUFFER_BYTES_MAX: u64 = u32::MAX as u64;
/// The storage buffer that every Vulkan device allows, bytes; software drivers allow no more.
pub const BUFFER_BYTES_EVERYWHERE: u64 = 1 << 27;

/// Returns the bytes of the buffer through which an image of that size is read and written.
pub fn image_buffer_bytes([width, height]: [u32; 2]) -> u64 {
    u64::from(width) * u64::from(height) * VEC4
}

/// One resource, or several of one size and kind.
struct Need {
    what: String,
    size: [u32; 2],
    bytes: u64,
    buffer_bytes: u64,
    /// Whether the side limit of images applies.
    has_images: bool,
}

fn texels([width, height]: [u32; 2]) -> u64 {
    u64::from(width) * u64::from(height)
}

/// Bytes of texels with a mip chain, which takes a third more.
fn with_mips(texels: u64) -> u64 {
    texels * VEC4 * 4 / 3
}

fn image(what: &str, size: [u32; 2], bytes: u64) -> Need {
    Need {
        what: what.to_owned(),
        size,
        bytes,
        buffer_bytes: 0,
        has_images: true,
    }
}

/// Returns the memory of a reference's sums and of the distribution of its environment.
fn reference_need(request: &RenderRequest) -> Need {
    let map = &request.environment.image;
    // Starts and guide entries of the distribution, rounded up to powers of two.
    let words = u64::from(map.height + 2)
        * (u64::from(map.width) + u64::from(map.width).next_power_of_two() + 2);
    let pixels = texels(request.size);
    Need {
        what: format!("reference under {}", request.environment.name),
        size: request.size,
        // Sums, their copy for the host, squared error.
        bytes: pixels * (2 * SUM_BYTES_PER_PIXEL + VEC4) + 4 * words,
        buffer_bytes: (4 * words).max(pixels * VEC4),
        has_images: false,
    }
}

/// Lists the memory that `request` needs besides pipelines and geometry.
fn needs(request: &RenderRequest) -> Vec<Need> {
    let map = &request.environment.image;
    let size = request.size;
    let map_size = [map.width, map.height];
    let pixels = texels(size);
    let map_texels = texels(map_size);
    // Reads and writes go through host-visible copies, one at a time.
    let mut needs = vec![
        // Four attachments, depth, radiance, a copy.
        Need {
            buffer_bytes: image_buffer_bytes(size),
            ..image("image", size, pixels * (6 * VEC4 + 4))
        },
        image(
            &format!("environment {}", request.environment.name),
            map_size,
            with_mips(map_texels) + map_texels * VEC4,
        ),
    ];
    if request.is_antialiased() {
        // Two attachments and depth.
        let size = points_size(size);
        needs.push(image(
            "points of edges",
            size,
            texels(size) * (2 * VEC4 + 4),
        ));
    }
    if request.has_reference_term() {
        needs.push(reference_need(request));
    }
    needs.extend(table_needs(request));
    needs
}

/// Lists the memory of the tables that `request` reads.
fn table_needs(request: &RenderRequest) -> Vec<Need> {
    let mut needs = Vec::new();
    let map = &request.environment.image;
    let settings = &request.shading.precompute;
    let layout = settings.layout;
    let face_texels = |size| u64::from(layout.face_count) * texels(size);
    if request.reads_filtered_levels() && !layout.is_environments() {
        let size = (layout.finest_size)([map.width, map.height]);
        needs.push(image(
            "filtered environment",
            size,
            with_mips(face_texels(size)),
        ));
    }
    if request.shading.method.uses_prefiltered() {
        let size = settings.prefilter_size;
        needs.push(image("prefiltered map", size, with_mips(face_texels(size))));
    }
    if request.needs_dfg() {
        let side = [settings.dfg_size; 2];
        needs.push(image("DFG table", side, VEC4 * texels(side)));
    }
    if request.shading.diffuse.uses_irradiance_map {
        let size = settings.irradiance_size;
        needs.push(image("irradiance map", size, VEC4 * face_texels(size)));
    }
    needs
}

/// Refuses a request that cannot be allocated, naming the number that is too large.
pub(super) fn check(gpu: &Gpu, request: &RenderRequest) -> Result<(), PipelineError> {
    if request.shading.precompute.layout.face_count == 6
        && request.reads_filtered_levels()
        && !gpu.info().has_seamless_cubes
    {
        return Err(PipelineError::OpenCubes);
    }
    let needs = needs(request);
    let refused = |need: &Need, needed: String, limit: String| {
        let part = format!("the {} of {}x{}", need.what, need.size[0], need.size[1]);
        Err(PipelineError::TooLarge {
            part,
            needed,
            limit,
        })
    };
    let side_limit = gpu.max_image_side();
    let buffer_limit = gpu.max_buffer_bytes();
    for need in needs.iter().filter(|need| need.has_images) {
        let side = need.size[0].max(need.size[1]);
        if side > side_limit {
            return refused(
                need,
                format!("{side} texels on a side"),
                format!("{side_limit} texels"),
            );
        }
    }
    if let Some(need) = needs.iter().find(|need| need.buffer_bytes > buffer_limit) {
        let needed = format!("a buffer of {}", mebibytes(need.buffer_bytes));
        return refused(need, needed, mebibytes(buffer_limit));
    }
    let total = needs.iter().map(|need| need.bytes).sum::<u64>();
    if total > gpu.info().memory_bytes {
        let parts = needs.iter().map(
            |Need {
                 what, size, bytes, ..
             }| format!("{what} of {}x{} {}", size[0], size[1], mebibytes(*bytes)),
        );
        return Err(PipelineError::TooLarge {
            part: "the request".to_owned(),
            needed: format!(
                "about {} of memory ({})",
                mebibytes(total),
                parts.collect::<Vec<_>>().join(", ")
            ),
            limit: mebibytes(gpu.info().memory_bytes),
        });
    }
    Ok(())
}

fn mebibytes(bytes: u64) -> String {
    format!("{} MiB", bytes.div_ceil(1 << 20))
}
