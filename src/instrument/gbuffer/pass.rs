//! The device pass that draws a scene into the four attachments.

use super::{ATTACHMENT_NAMES, Gbuffer, Surfaces, material_data, params, sphere_data};
use crate::base::glsl::layout::SharedStruct;
use crate::base::pixels::Pixels;
use crate::instrument::gpu::{
    Bind, Buffer, DrawCall, Filter, Format, Gpu, GpuError, GraphicsDescription, Image, Output,
    Recorder, Sampler, Targets, Wrap,
};
use crate::instrument::scene::{Camera, MaterialMaps, Mesh, Scene, Texture};
use std::ops::Range;

/// The timed pass that draws the g-buffer.
pub const GBUFFER_PASS: &str = "gbuffer";

/// A strip of four vertices, one instance per sphere.
const SPHERES: GraphicsDescription = GraphicsDescription {
    shaders: ["gbuffer/sphere.vert", "gbuffer/sphere.frag"],
    attributes: &[],
    strip: true,
    output: Output::Surfaces,
};
/// Position, normal, uv and tangent.
const MESHES: GraphicsDescription = GraphicsDescription {
    shaders: ["gbuffer/mesh.vert", "gbuffer/mesh.frag"],
    attributes: &[3, 3, 2, 4],
    strip: false,
    output: Output::Surfaces,
};

const PIPELINES: [GraphicsDescription; 2] = [SPHERES, MESHES];

pub fn shaders() -> impl Iterator<Item = &'static str> {
    PIPELINES
        .into_iter()
        .flat_map(|description| description.shaders)
}

pub struct SceneData {
    spheres: Buffer,
    sphere_count: u32,
    materials: Buffer,
    meshes: Vec<MeshData>,
    textures: Vec<(Image, Wrap)>,
    /// Replaces missing maps of factors.
    white: (Image, Wrap),
    /// Replaces missing normal maps.
    flat: (Image, Wrap),
}

struct MeshData {
    attributes: [Buffer; 4],
    indices: Buffer,
    index_count: u32,
    material: usize,
    material_maps: MaterialMaps,
    is_one_sided: bool,
}

/// What a g-buffer is drawn to. Without the last attachments the materials are dropped.
#[derive(Clone, Copy)]
pub struct Attachments<'a> {
    /// The first of [`ATTACHMENT_NAMES`].
    colors: &'a [Image],
    depth: &'a Image,
    size: [u32; 2],
}

/// The first attachments of a view, in the order of [`ATTACHMENT_NAMES`], and its depth.
#[derive(Clone)]
pub struct ViewImages<const COUNT: usize> {
    pub attachments: [Image; COUNT],
    depth: Image,
    pub size: [u32; 2],
}

pub type GbufferImages = ViewImages<4>;

/// Positions and normals of a view without its materials: half the memory of [`GbufferImages`].
pub type SurfaceImages = ViewImages<2>;

pub fn record(
    recorder: &mut Recorder,
    scene: &SceneData,
    camera: &Camera,
    target: Attachments<'_>,
) -> Result<(), GpuError> {
    assert!(
        scene.sphere_count > 0 || !scene.meshes.is_empty(),
        "a scene has at least one sphere or mesh"
    );
    let colors: Vec<&Image> = target.colors.iter().collect();
    let mut targets = Targets {
        colors: &colors,
        depth: target.depth,
        clear: true,
    };
    let push = |material: usize| params(camera, target.size, material).to_bytes();
    if scene.sphere_count > 0 {
        let call = DrawCall {
            vertex_buffers: &[],
            index_buffer: None,
            count: 4,
            instance_count: scene.sphere_count,
            is_one_sided: false,
        };
        recorder.draw(SPHERES, &scene.binds([None; 8]), &push(0), targets, call)?;
        targets.clear = false;
    }
    for mesh in &scene.meshes {
        let call = DrawCall {
            vertex_buffers: &mesh.attributes.each_ref(),
            index_buffer: Some(&mesh.indices),
            count: mesh.index_count,
            instance_count: 1,
            is_one_sided: mesh.is_one_sided,
        };
        recorder.draw(
            MESHES,
            &scene.binds(mesh.material_maps),
            &push(mesh.material),
            targets,
            call,
        )?;
        targets.clear = false;
    }
    Ok(())
}

impl SceneData {
    pub fn new(gpu: &Gpu, scene: &Scene) -> Result<Self, GpuError> {
        let bytes = |name: &str, bytes: Vec<u8>| gpu.buffer_from(name, &bytes);
        let spheres = sphere_data(scene)
            .iter()
            .flat_map(SharedStruct::to_bytes)
            .collect();
        let materials = material_data(scene)
            .iter()
            .flat_map(SharedStruct::to_bytes)
            .collect();
        let mesh = |mesh: &Mesh| {
            let material = &scene.materials[mesh.material];
            Ok(MeshData {
                attributes: [
                    gpu.buffer_from("positions", &mesh.positions)?,
                    gpu.buffer_from("normals", &mesh.normals)?,
                    gpu.buffer_from("uvs", &mesh.uvs)?,
                    gpu.buffer_from("tangents", &mesh.tangents)?,
                ],
                indices: gpu.buffer_from("indices", &mesh.indices)?,
                index_count: mesh.indices.len() as u32,
                material: mesh.material,
                material_maps: material.maps(),
                is_one_sided: material.is_one_sided,
            })
        };
        Ok(Self {
            spheres: bytes("spheres", spheres)?,
            sphere_count: scene.spheres.len() as u32,
            materials: bytes("materials", materials)?,
            meshes: scene
                .meshes
                .iter()
                .map(mesh)
                .collect::<Result<_, GpuError>>()?,
            textures: scene
                .textures
                .iter()
                .map(|map| texture(gpu, map))
                .collect::<Result<_, _>>()?,
            white: texture(
                gpu,
                &Texture::new(Pixels::filled(1, 1, [1.0; 3]), Wrap::REPEAT),
            )?,
            flat: texture(
                gpu,
                &Texture::new(Pixels::filled(1, 1, [0.0, 0.0, 1.0]), Wrap::REPEAT),
            )?,
        })
    }

    /// Binds spheres, materials and the maps of [`Material::maps`](crate::instrument::scene::Material::maps).
    fn binds(&self, maps: MaterialMaps) -> [Bind<'_>; 10] {
        let [
            albedo,
            metallic,
            roughness,
            normal,
            f0,
            specular,
            coat,
            coat_roughness,
        ] = maps;
        let map = |index: Option<usize>, missing| {
            let (image, wrap): &(Image, Wrap) =
                index.map_or(missing, |index| &self.textures[index]);
            Bind::Sample(image, Sampler(Filter::Linear, *wrap))
        };
        [
            Bind::Read(&self.spheres),
            Bind::Read(&self.materials),
            map(albedo, &self.white),
            map(metallic, &self.white),
            map(roughness, &self.white),
            map(normal, &self.flat),
            map(f0, &self.white),
            map(specular, &self.white),
            map(coat, &self.white),
            map(coat_roughness, &self.white),
        ]
    }
}

fn texture(gpu: &Gpu, texture: &Texture) -> Result<(Image, Wrap), GpuError> {
    let first = &texture.levels[0];
    let image = gpu.image(
        "map of a material",
        [first.width, first.height],
        texture.levels.len() as u32,
        Format::Rgba32Float,
    )?;
    for (level, pixels) in (0..).zip(&texture.levels) {
        let texels: Vec<[f32; 4]> = pixels
            .data
            .iter()
            .map(|&[r, g, b]| [r, g, b, 1.0])
            .collect();
        gpu.write_image(&image, level, &texels)?;
    }
    Ok((image, texture.wrap))
}

impl<const COUNT: usize> ViewImages<COUNT> {
    fn with(gpu: &Gpu, attachments: [Image; COUNT], size: [u32; 2]) -> Result<Self, GpuError> {
        Ok(Self {
            attachments,
            depth: gpu.image("depth", size, 1, Format::Depth32Float)?,
            size,
        })
    }

    pub fn all(&self) -> Attachments<'_> {
        Attachments {
            colors: &self.attachments,
            depth: &self.depth,
            size: self.size,
        }
    }

    /// Reads positions and normals.
    pub fn read_surfaces(&self, gpu: &Gpu) -> Result<Surfaces, GpuError> {
        self.read_surface_rows(gpu, 0..self.size[1])
    }

    /// Reads some rows of positions and normals.
    pub fn read_surface_rows(&self, gpu: &Gpu, rows: Range<u32>) -> Result<Surfaces, GpuError> {
        Ok(Surfaces {
            position_mask: read_rows(gpu, &self.attachments[0], rows.clone())?,
            normal_alpha: read_rows(gpu, &self.attachments[1], rows)?,
        })
    }
}

impl SurfaceImages {
    pub fn new(gpu: &Gpu, size: [u32; 2]) -> Result<Self, GpuError> {
        let image = |index| attachment(gpu, index, size);
        Self::with(gpu, [image(0)?, image(1)?], size)
    }
}

impl GbufferImages {
    pub fn new(gpu: &Gpu, size: [u32; 2]) -> Result<Self, GpuError> {
        let image = |index| attachment(gpu, index, size);
        Self::with(gpu, [image(0)?, image(1)?, image(2)?, image(3)?], size)
    }

    pub fn write(&self, gpu: &Gpu, texels: &Gbuffer<f32>) -> Result<(), GpuError> {
        let Gbuffer {
            position_mask,
            normal_alpha,
            albedo_metallic,
            f0_material,
        } = texels;
        let all = [position_mask, normal_alpha, albedo_metallic, f0_material];
        self.attachments
            .iter()
            .zip(all)
            .try_for_each(|(image, texels)| gpu.write_image(image, 0, &texels.data))
    }

    pub fn read(&self, gpu: &Gpu) -> Result<Gbuffer<f32>, GpuError> {
        let read = |image| read_rows(gpu, image, 0..self.size[1]);
        let [a, b, c, d] = &self.attachments;
        Ok([read(a)?, read(b)?, read(c)?, read(d)?].into())
    }
}

/// Makes the attachment of an index of [`ATTACHMENT_NAMES`].
fn attachment(gpu: &Gpu, index: usize, size: [u32; 2]) -> Result<Image, GpuError> {
    gpu.image(ATTACHMENT_NAMES[index], size, 1, Format::Rgba32Float)
}

fn read_rows(gpu: &Gpu, image: &Image, rows: Range<u32>) -> Result<Pixels<[f32; 4]>, GpuError> {
    let [width, _] = image.mip_size(0);
    let height = rows.end - rows.start;
    Ok(Pixels::new(width, height, gpu.read_rows(image, 0, rows)?))
}
