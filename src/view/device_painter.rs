//! Paints the window on the device that renders, into images that it presents.

use super::canvas::Half;
use super::painting::{PaintError, Painting};
use super::texels::Texels;
use super::theme;
use crate::base::glsl::layout::{SharedStruct, WindowMeshParams, WindowPictureParams};
use crate::instrument::gpu::{
    Bind, Buffer, Filter, Format, Gpu, GpuError, Image, Painted, Recorder, Sampler, Swapchain, Wrap,
};
use egui::epaint::{ImageDelta, Mesh, Primitive, Vertex};
use egui::{ClippedPrimitive, ImageData, TextureFilter, TextureId, TexturesDelta};
use std::collections::BTreeMap;
use std::ops::Range;
use std::rc::Rc;
use winit::window::Window;

const SQUARES: [&str; 2] = ["window/picture.vert", "window/squares.frag"];
const SMOOTH: [&str; 2] = ["window/picture.vert", "window/smooth.frag"];
const MESH: [&str; 2] = ["window/mesh.vert", "window/mesh.frag"];

pub struct DevicePainter {
    swapchain: Swapchain,
    textures: BTreeMap<TextureId, Texture>,
    window: Rc<Window>,
    gpu: Gpu,
}

impl DevicePainter {
    pub fn new(gpu: &Gpu, window: &Rc<Window>) -> Result<Self, GpuError> {
        Ok(Self {
            swapchain: gpu.swapchain(window.clone())?,
            textures: BTreeMap::new(),
            window: window.clone(),
            gpu: gpu.clone(),
        })
    }

    /// Makes the surface again.
    pub fn renew(&mut self) -> Result<(), GpuError> {
        self.swapchain.renew()
    }

    /// Paints a frame and shows it; `false` if the window took none.
    pub fn present(&mut self, size: [u32; 2], painting: &Painting) -> Result<bool, PaintError> {
        // A frame that is left out must not lose them.
        self.take_textures(painting.textures);
        let is_shown = self.paint(size, painting);
        for id in &painting.textures.free {
            self.textures.remove(id);
        }
        Ok(is_shown?)
    }

    fn paint(&mut self, size: [u32; 2], painting: &Painting) -> Result<bool, GpuError> {
        let Some(next) = self.swapchain.acquire(size)? else {
            return Ok(false);
        };
        let mut recorder = self.gpu.record_always("window")?;
        for texture in self.textures.values_mut() {
            texture.upload(&self.gpu, &mut recorder)?;
        }
        let target = next.image.mip_size(0);
        let meshes = Meshes::new(&self.gpu, painting, target)?;
        let mut layers: Vec<Painted> = painting
            .canvas
            .halves(painting.shown)
            .iter()
            .filter_map(|half| picture_layer(painting, half, target))
            .collect();
        layers.extend(meshes.layers(&self.textures, size, painting.pixels_per_point));
        let ground = theme::PAPER.to_array().map(|x| f32::from(x) / 255.0);
        recorder.paint(&next.image, ground, &layers)?;
        self.window.pre_present_notify();
        self.swapchain.present(recorder, &next)?;
        Ok(true)
    }

    fn take_textures(&mut self, changes: &TexturesDelta) {
        for (id, delta) in &changes.set {
            match delta.pos {
                None => drop(self.textures.insert(*id, Texture::new(delta))),
                Some(corner) => {
                    if let Some(texture) = self.textures.get_mut(id) {
                        texture.change(delta, corner);
                    }
                }
            }
        }
    }
}

/// Returns the layer of a half; `None` if its texels are not on the device.
fn picture_layer<'a>(
    painting: &Painting,
    half: &Half<'a>,
    [width, height]: [u32; 2],
) -> Option<Painted<'a>> {
    let Texels::Device(texels) = &half.shot.picture else {
        return None;
    };
    let [left, top] = painting.canvas.corner;
    let size = painting.canvas.size;
    let [across, down] = painting.canvas.texels_a_pixel(texels.size);
    let params = WindowPictureParams {
        left,
        top,
        texel_columns: texels.size[0],
        texel_rows: texels.size[1],
        brightness: half.brightness,
        across,
        down,
    };
    // The image may be smaller than the window that was laid out.
    let columns = [half.columns.start, half.columns.end].map(|x| (left + x).min(width));
    let rows = [top, top + size[1]].map(|y| y.min(height));
    Some(Painted {
        shaders: if half.is_smooth() { SMOOTH } else { SQUARES },
        is_opaque: true,
        binds: vec![Bind::Read(&texels.words)],
        push: params.to_bytes(),
        vertices: 0..3,
        clip: [
            columns[0],
            rows[0],
            columns[1] - columns[0],
            rows[1] - rows[0],
        ],
    })
}

/// The triangles of the controls.
struct Meshes {
    vertices: Buffer,
    indices: Buffer,
    draws: Vec<MeshDraw>,
}

struct MeshDraw {
    texture: TextureId,
    indices: Range<u32>,
    clip: [u32; 4],
}

impl Meshes {
    fn new(gpu: &Gpu, painting: &Painting, target: [u32; 2]) -> Result<Self, GpuError> {
        let mut vertices: Vec<[u32; 5]> = Vec::new();
        let mut indices: Vec<u32> = Vec::new();
        let mut draws = Vec::new();
        for ClippedPrimitive {
            clip_rect,
            primitive,
        } in painting.shapes
        {
            let Primitive::Mesh(Mesh {
                indices: corners,
                vertices: points,
                texture_id,
            }) = primitive
            else {
                continue;
            };
            let clip = clip_of(*clip_rect, painting.pixels_per_point, target);
            if clip[2] == 0 || clip[3] == 0 {
                continue;
            }
            let first_vertex = vertices.len() as u32;
            let first_index = indices.len() as u32;
            vertices.extend(points.iter().map(words));
            indices.extend(corners.iter().map(|index| first_vertex + index));
            draws.push(MeshDraw {
                texture: *texture_id,
                indices: first_index..indices.len() as u32,
                clip,
            });
        }
        Ok(Self {
            vertices: gpu.host_buffer_from("vertices of the window", &vertices)?,
            indices: gpu.host_buffer_from("indices of the window", &indices)?,
            draws,
        })
    }

    /// Returns the layers of a window of `size` pixels.
    fn layers<'a>(
        &'a self,
        textures: &'a BTreeMap<TextureId, Texture>,
        size: [u32; 2],
        pixels_per_point: f32,
    ) -> impl Iterator<Item = Painted<'a>> {
        let [width, height] = size.map(|side| side as f32 / pixels_per_point);
        let push = WindowMeshParams { width, height }.to_bytes();
        self.draws.iter().filter_map(move |draw| {
            let texture = textures.get(&draw.texture)?;
            let image = texture.image.as_ref()?;
            Some(Painted {
                shaders: MESH,
                is_opaque: false,
                binds: vec![
                    Bind::Read(&self.vertices),
                    Bind::Read(&self.indices),
                    Bind::Sample(image, texture.sampler),
                ],
                push: push.clone(),
                vertices: draw.indices.clone(),
                clip: draw.clip,
            })
        })
    }
}

/// The words of a vertex in `shaders/window/mesh.vert`.
fn words(vertex: &Vertex) -> [u32; 5] {
    let Vertex { pos, uv, color } = vertex;
    [
        pos.x.to_bits(),
        pos.y.to_bits(),
        uv.x.to_bits(),
        uv.y.to_bits(),
        u32::from_le_bytes(color.to_array()),
    ]
}

/// Left, top, width and height of a rectangle in points, in pixels of the image.
fn clip_of(rect: egui::Rect, pixels_per_point: f32, [width, height]: [u32; 2]) -> [u32; 4] {
    // The cast makes negative numbers 0.
    let pixel = |point: f32, most: u32| ((pixels_per_point * point).round() as u32).min(most);
    let [left, right] = [rect.left(), rect.right()].map(|x| pixel(x, width));
    let [top, bottom] = [rect.top(), rect.bottom()].map(|y| pixel(y, height));
    [
        left,
        top,
        right.saturating_sub(left),
        bottom.saturating_sub(top),
    ]
}

/// A texture of the controls.
struct Texture {
    size: [u32; 2],
    /// Colours times their alpha.
    texels: Vec<[u8; 4]>,
    sampler: Sampler,
    /// Rows that the image lacks.
    changed: Range<u32>,
    /// `None` before the first upload.
    image: Option<Image>,
}

impl Texture {
    fn new(delta: &ImageDelta) -> Self {
        let ImageData::Color(image) = &delta.image;
        let size = image.size.map(|side| side as u32);
        let filter = match delta.options.magnification {
            TextureFilter::Nearest => Filter::Nearest,
            TextureFilter::Linear => Filter::Linear,
        };
        Self {
            size,
            texels: image.pixels.iter().map(|color| color.to_array()).collect(),
            sampler: Sampler(filter, Wrap::CLAMP),
            changed: 0..size[1],
            image: None,
        }
    }

    /// Changes a rectangle.
    fn change(&mut self, delta: &ImageDelta, [left, top]: [usize; 2]) {
        let ImageData::Color(image) = &delta.image;
        let [columns, rows] = image.size;
        let width = self.size[0] as usize;
        for (row, colors) in image.pixels.chunks_exact(columns.max(1)).enumerate() {
            let line = &mut self.texels[(top + row) * width + left..][..columns];
            for (texel, color) in line.iter_mut().zip(colors) {
                *texel = color.to_array();
            }
        }
        let [first, end] = [top as u32, (top + rows) as u32];
        self.changed = if self.changed.is_empty() {
            first..end
        } else {
            self.changed.start.min(first)..self.changed.end.max(end)
        };
    }

    /// Records a copy of what changed to the device.
    fn upload(&mut self, gpu: &Gpu, recorder: &mut Recorder) -> Result<(), GpuError> {
        if self.changed.is_empty() {
            return Ok(());
        }
        let image = match self.image.take() {
            Some(image) => image,
            None => gpu.image("texture of the window", self.size, 1, Format::Rgba8)?,
        };
        let width = self.size[0] as usize;
        let rows = std::mem::take(&mut self.changed);
        let texels = &self.texels[rows.start as usize * width..rows.end as usize * width];
        recorder.write_rows(&image, rows, texels)?;
        self.image = Some(image);
        Ok(())
    }
}
