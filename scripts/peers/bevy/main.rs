//! Bevy without a window, for scripts/check-clients.sh. Writes texels raw.
//!
//! ```text
//! bevy-peer sphere SPECULAR.ktx2 DIFFUSE.ktx2 SIZE ortho|perspective ROUGHNESS OUT    the unit sphere, a white metal, RGBA f32
//! bevy-peer sphere ... OUT FOLDER              the same sphere in three colours, by FOLDER/taps.wgsl and taps.ktx2 of a bake
//! bevy-peer filter CUBE.ktx2 OUT                        GeneratedEnvironmentMapLight: each level's six faces, RGBA f16
//! ```

use bevy::app::PluginsState;
use bevy::asset::{RenderAssetUsages, uuid_handle};
use bevy::camera::{Exposure, Hdr, RenderTarget, ScalingMode};
use bevy::core_pipeline::tonemapping::Tonemapping;
use bevy::image::{CompressedImageFormats, ImageSampler, ImageType};
use bevy::light::{EnvironmentMapLight, GeneratedEnvironmentMapLight};
use bevy::pbr::{ExtendedMaterial, MaterialExtension};
use bevy::prelude::*;
use bevy::render::RenderApp;
use bevy::render::render_asset::RenderAssets;
use bevy::render::render_resource::*;
use bevy::render::renderer::{RenderDevice, RenderQueue};
use bevy::render::texture::GpuImage;
use bevy::shader::{Shader, ShaderRef};
use bevy::window::ExitCondition;

/// Frames until shaders are compiled and images are on the device.
const FRAMES: u32 = 20;

const PASTED: Handle<Shader> = uuid_handle!("5e5d0c5e-3f0b-4d5c-9f0e-2b7c3c1f6a10");

/// The standard material with the lookups of a bake.
#[derive(Asset, AsBindGroup, TypePath, Clone)]
struct Taps {
    #[texture(100)]
    #[sampler(101)]
    taps: Handle<Image>,
}

impl MaterialExtension for Taps {
    fn fragment_shader() -> ShaderRef {
        ShaderRef::Handle(PASTED)
    }
}

/// A fragment shader with the functions and lines of `taps.wgsl`. Bevy's cubes are left-handed: it
/// negates z.
fn pasted(text: &str) -> String {
    let (functions, lines) = text.split_once("// Replaces ").expect("a taps.wgsl");
    let lines: Vec<&str> = lines.lines().filter_map(|line| line.strip_prefix("//     ")).collect();
    let of = |map: &str| {
        lines.join("\n").replace("(map,", &format!("({map},")).replace("trilinear", "view::environment_map_sampler")
    };
    format!(
        "#import bevy_pbr::{{
            forward_io::VertexOutput, lighting::F_AB, mesh_view_bindings as view, \
            pbr_fragment::pbr_input_from_standard_material,
        }}
        @group(#{{MATERIAL_BIND_GROUP}}) @binding(100) var taps: texture_2d<f32>;
        @group(#{{MATERIAL_BIND_GROUP}}) @binding(101) var bilinear: sampler;
        {functions}
        @fragment
        fn fragment(in: VertexOutput, @builtin(front_facing) is_front: bool) -> @location(0) vec4f \
        {{
            let input = pbr_input_from_standard_material(in, is_front);
            let roughness = input.material.perceptual_roughness;
            let f0 = input.material.base_color.rgb;
            let n_dot_v = max(dot(input.N, input.V), 1e-4);
            let dfg = F_AB(roughness, n_dot_v);
            let n = input.N * vec3f(1.0, 1.0, -1.0);
            let v = input.V * vec3f(1.0, 1.0, -1.0);
            #ifdef MULTIPLE_LIGHT_PROBES_IN_ARRAY
            {}
            #else
            {}
            #endif
            return vec4f(specular, 1.0);
        }}",
        of("view::specular_environment_maps[view::light_probes.view_cubemap_index]"),
        of("view::specular_environment_map")
    )
}

fn app_without_window() -> App {
    let mut app = App::new();
    let window = WindowPlugin { primary_window: None, exit_condition: ExitCondition::DontExit, ..default() };
    app.add_plugins(DefaultPlugins.set(window));
    app.add_plugins(MaterialPlugin::<ExtendedMaterial<StandardMaterial, Taps>>::default());
    while app.plugins_state() == PluginsState::Adding {
        bevy::tasks::tick_global_task_pools_on_main_thread();
    }
    app.finish();
    app.cleanup();
    app
}

/// The texture of a KTX 2 file, decoded by Bevy.
fn texture(app: &mut App, path: &str) -> Handle<Image> {
    let bytes = std::fs::read(path).unwrap_or_else(|error| panic!("{path}: {error}"));
    let format = ImageType::Extension("ktx2");
    let usage = RenderAssetUsages::all();
    let image = Image::from_buffer(&bytes, format, CompressedImageFormats::NONE, false, ImageSampler::linear(), usage);
    app.world_mut().resource_mut::<Assets<Image>>().add(image.unwrap_or_else(|error| panic!("{path}: {error}")))
}

fn run_frames(app: &mut App) {
    (0..FRAMES).for_each(|_| app.update());
    let device = app.sub_app(RenderApp).world().resource::<RenderDevice>();
    device.poll(PollType::wait_indefinitely()).expect("a device that answers");
}

/// All texels of an image on the device: levels, each with its layers, rows without padding.
fn texels(app: &App, image: &Handle<Image>) -> Vec<u8> {
    let world = app.sub_app(RenderApp).world();
    let (device, queue) = (world.resource::<RenderDevice>(), world.resource::<RenderQueue>());
    let image = world.resource::<RenderAssets<GpuImage>>().get(image).expect("the image on the device");
    let descriptor = &image.texture_descriptor;
    let texel = descriptor.format.block_copy_size(None).expect("a plain format") as usize;
    let mut texels = Vec::new();
    for level in 0..descriptor.mip_level_count {
        let [width, height] = [descriptor.size.width, descriptor.size.height].map(|side| (side >> level).max(1));
        let row = RenderDevice::align_copy_bytes_per_row(texel * width as usize);
        for layer in 0..descriptor.size.depth_or_array_layers {
            let buffer = device.create_buffer(&BufferDescriptor {
                label: None,
                size: (row * height as usize) as u64,
                usage: BufferUsages::COPY_DST | BufferUsages::MAP_READ,
                mapped_at_creation: false,
            });
            let mut encoder = device.create_command_encoder(&CommandEncoderDescriptor::default());
            let from = TexelCopyTextureInfo {
                texture: &image.texture,
                mip_level: level,
                origin: Origin3d { x: 0, y: 0, z: layer },
                aspect: TextureAspect::All,
            };
            let layout = TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(row as u32), rows_per_image: None };
            let extent = Extent3d { width, height, depth_or_array_layers: 1 };
            encoder.copy_texture_to_buffer(from, TexelCopyBufferInfo { buffer: &buffer, layout }, extent);
            queue.submit([encoder.finish()]);
            let slice = buffer.slice(..);
            slice.map_async(MapMode::Read, |result| result.expect("a mapped buffer"));
            device.poll(PollType::wait_indefinitely()).expect("a device that answers");
            slice
                .get_mapped_range()
                .chunks(row)
                .for_each(|row| texels.extend_from_slice(&row[..texel * width as usize]));
        }
    }
    texels
}

/// The camera of `splitsum render`: 4 from the centre along +z, a square of half side 1.05, or 32
/// degrees.
fn sphere([specular, diffuse, size, camera, roughness, out]: [String; 6], bake: Option<&str>) {
    let mut app = app_without_window();
    let [specular_map, diffuse_map] = [specular, diffuse].map(|path| texture(&mut app, &path));
    let size = size.parse().expect("SIZE is a number");
    let mut target = Image::new_target_texture(size, size, TextureFormat::Rgba32Float, None);
    target.texture_descriptor.usage |= TextureUsages::COPY_SRC;
    let target = app.world_mut().resource_mut::<Assets<Image>>().add(target);
    let mesh = app.world_mut().resource_mut::<Assets<Mesh>>().add(Sphere::new(1.0).mesh().uv(512, 256));
    let base = StandardMaterial {
        base_color: if bake.is_some() { Color::linear_rgb(1.0, 0.5, 0.2) } else { Color::WHITE },
        metallic: 1.0,
        perceptual_roughness: roughness.parse().expect("ROUGHNESS is a number"),
        ..default()
    };
    let body = app.world_mut().spawn(Mesh3d(mesh)).id();
    match bake {
        None => {
            let material = app.world_mut().resource_mut::<Assets<StandardMaterial>>().add(base);
            app.world_mut().entity_mut(body).insert(MeshMaterial3d(material));
        }
        Some(folder) => {
            let text = std::fs::read_to_string(format!("{folder}/taps.wgsl")).expect("FOLDER has taps.wgsl");
            let shader = Shader::from_wgsl(pasted(&text), "pasted.wgsl");
            app.world_mut().resource_mut::<Assets<Shader>>().insert(&PASTED, shader).expect("a fixed name");
            let extension = Taps { taps: texture(&mut app, &format!("{folder}/taps.ktx2")) };
            let material = app
                .world_mut()
                .resource_mut::<Assets<ExtendedMaterial<StandardMaterial, Taps>>>()
                .add(ExtendedMaterial { base, extension });
            app.world_mut().entity_mut(body).insert(MeshMaterial3d(material));
        }
    }
    let projection = match camera.as_str() {
        "ortho" => Projection::Orthographic(OrthographicProjection {
            scaling_mode: ScalingMode::Fixed { width: 2.1, height: 2.1 },
            near: 2.0,
            far: 6.0,
            ..OrthographicProjection::default_3d()
        }),
        "perspective" => Projection::Perspective(PerspectiveProjection { fov: 32_f32.to_radians(), ..default() }),
        _ => panic!("{camera}: ortho or perspective"),
    };
    app.world_mut().insert_resource(ClearColor(Color::NONE));
    app.world_mut().insert_resource(GlobalAmbientLight::NONE);
    app.world_mut().spawn((
        Camera3d::default(),
        RenderTarget::from(target.clone()),
        Hdr,
        Msaa::Off,
        Tonemapping::None,
        projection,
        Transform::from_xyz(0.0, 0.0, 4.0),
        Exposure::default(),
        EnvironmentMapLight {
            diffuse_map,
            specular_map,
            intensity: Exposure::default().exposure().recip(),
            ..default()
        },
    ));
    run_frames(&mut app);
    std::fs::write(&out, texels(&app, &target)).unwrap_or_else(|error| panic!("{out}: {error}"));
}

fn filter([source, out]: [String; 2]) {
    let mut app = app_without_window();
    let environment_map = texture(&mut app, &source);
    let probe = app.world_mut().spawn(GeneratedEnvironmentMapLight { environment_map, ..default() }).id();
    app.update();
    let specular = app.world().get::<EnvironmentMapLight>(probe).expect("maps of the probe").specular_map.clone();
    app.world_mut().resource_mut::<Assets<Image>>().get_mut(&specular).expect("the map").texture_descriptor.usage |=
        TextureUsages::COPY_SRC;
    run_frames(&mut app);
    std::fs::write(&out, texels(&app, &specular)).unwrap_or_else(|error| panic!("{out}: {error}"));
}

fn main() {
    let mut words = std::env::args().skip(1);
    let task = words.next();
    let mut words: Vec<String> = words.collect();
    match task.as_deref() {
        Some("sphere") => {
            let bake = (words.len() == 7).then(|| words.remove(6));
            sphere(
                words.try_into().expect("sphere SPECULAR DIFFUSE SIZE CAMERA ROUGHNESS OUT \
                                         [FOLDER]"),
                bake.as_deref(),
            );
        }
        Some("filter") => filter(words.try_into().expect("filter CUBE OUT")),
        _ => panic!("sphere or filter"),
    }
}
