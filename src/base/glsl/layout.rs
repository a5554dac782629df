//! Structs shared by Rust and GLSL. The build script writes `generated/layout.glsl` from [`ALL`].
//!
//! Members: 16-byte vectors, then 4-byte scalars; no vec3, arrays or bool: std430, scalar and Rust
//! layouts agree.

/// A shared struct as a shader declares it.
#[derive(Clone, Copy, Debug)]
pub struct Struct {
    pub name: &'static str,
    pub members: &'static [Member],
}

/// A member of a shared struct. `ty` is a type of GLSL.
#[derive(Clone, Copy, Debug)]
pub struct Member {
    pub ty: &'static str,
    pub name: &'static str,
}

/// A shared struct that can be passed to a shader.
pub trait SharedStruct {
    /// Returns the bytes as the shader reads them.
    fn to_bytes(&self) -> Vec<u8>;
}

macro_rules! shared_structs {
    ($($(#[$doc:meta])* $name:ident { $($(#[$mdoc:meta])* $member:ident: $ty:ident,)* })*) => {
        $(
            $(#[$doc])*
            #[derive(Clone, Copy, Debug, Default, PartialEq)]
            pub struct $name { $($(#[$mdoc])* pub $member: shared_structs!(@rust $ty),)* }
            impl SharedStruct for $name {
                fn to_bytes(&self) -> Vec<u8> {
                    let mut bytes = Vec::new();
                    $(shared_structs!(@push $ty bytes self.$member);)*
                    // std430 rounds the size of a struct up to its largest alignment.
                    let alignment = [$(shared_structs!(@alignment $ty)),*].into_iter().max();
                    bytes.resize(bytes.len().next_multiple_of(alignment.unwrap_or(1)), 0);
                    bytes
                }
            }
        )*
        /// All shared structs, in the order of this file.
        pub const ALL: &[Struct] = &[$(Struct {
            name: stringify!($name),
            members: &[$(Member {
                ty: stringify!($ty),
                name: stringify!($member),
            }),*],
        }),*];
    };
    (@rust vec4) => { [f32; 4] };
    (@rust uvec4) => { [u32; 4] };
    (@rust float) => { f32 };
    (@rust uint) => { u32 };
    (@alignment vec4) => { 16 };
    (@alignment uvec4) => { 16 };
    (@alignment float) => { 4 };
    (@alignment uint) => { 4 };
    (@push vec4 $bytes:ident $value:expr) => { shared_structs!(@push_vector $bytes $value); };
    (@push uvec4 $bytes:ident $value:expr) => { shared_structs!(@push_vector $bytes $value); };
    (@push_vector $bytes:ident $value:expr) => {
        for x in $value {
            $bytes.extend_from_slice(&x.to_ne_bytes());
        }
    };
    (@push float $bytes:ident $value:expr) => { $bytes.extend_from_slice(&$value.to_ne_bytes()); };
    (@push uint $bytes:ident $value:expr) => { $bytes.extend_from_slice(&$value.to_ne_bytes()); };
}

shared_structs! {
    /// Push constants of the mip downsample: one level from the level above.
    MipsParams {
        source_width: uint,
        source_height: uint,
        width: uint,
        height: uint,
    }
    /// Push constants of the finest level of a filtered map.
    ResampleParams {
        source_width: uint,
        source_height: uint,
        width: uint,
        height: uint,
        first_row: uint,
    }
    /// Push constants of the projection on spherical harmonics, and of the sum of its groups.
    Sh9Params {
        width: uint,
        height: uint,
        group_count: uint,
        /// One of `constants::SH9_*`.
        projection: uint,
    }
    /// Push constants of the irradiance map.
    IrradianceParams {
        width: uint,
        height: uint,
        /// Samples in azimuth of the numerical integration.
        phi_count: uint,
        /// Samples in polar angle of the numerical integration.
        theta_count: uint,
        source_width: uint,
        source_height: uint,
        first_row: uint,
    }
    /// Push constants of one level of a prefiltered map.
    PrefilterParams {
        width: uint,
        height: uint,
        source_width: uint,
        source_height: uint,
        sample_count: uint,
        alpha: float,
        lod_bias: float,
        /// First row of this dispatch: long levels are split over several submissions.
        first_row: uint,
        /// First of the `point_count` points of this dispatch. Point 0 starts the sums, the last
        /// finishes them.
        first_point: uint,
        point_count: uint,
    }
    /// Push constants of the DFG table.
    DfgParams {
        width: uint,
        height: uint,
        sample_count: uint,
        first_row: uint,
    }
    /// Push constants of the g-buffer pass: the camera (see `gbuffer::params`).
    GbufferParams {
        /// Unit vector to the image's right; w = half width of the image plane.
        right: vec4,
        /// Unit vector to the image's top; w = half height of the image plane.
        up: vec4,
        /// Unit viewing direction; w = scale of the depth.
        forward: vec4,
        /// Position of the camera; w = 1 for a perspective camera, 0 for an orthographic one.
        eye: vec4,
        depth_offset: float,
        width: uint,
        height: uint,
        /// Index of the mesh's material; spheres carry their own.
        material: uint,
    }
    /// A material as the g-buffer pass reads it. `f0` is the dielectric reflectance; metals take
    /// `albedo` instead.
    MaterialData {
        albedo_metallic: vec4,
        f0_alpha: vec4,
        /// Cosine and sine of the turn of the tangent, strength of the anisotropy; w = 1 where
        /// tangents replace normals.
        tangent: vec4,
        /// x: the share of the dielectric interface that reflects.
        specular: vec4,
        /// The coat that changes the base: weight, alpha, one of `constants::UNDER_COAT_*`. A
        /// weight of 0 changes nothing.
        coat: vec4,
        /// Coefficients of the base's f0 under that coat, a polynomial of f0, lowest power first.
        f0_under_coat: vec4,
    }
    /// A sphere as the g-buffer pass reads it: centre and radius; index of its material in x.
    SphereData {
        center_radius: vec4,
        material: uvec4,
    }
    /// A direct light (`scene::light`). A light without a cone has the axis 0 and terms that never
    /// dim it.
    LightData {
        /// Position (w = 1), or unit vector to a directional light (w = 0).
        place: vec4,
        /// Intensity, or irradiance of a directional light; w = 1 / range, 0 without one.
        color: vec4,
        /// Unit vector along the axis; w = 1 / (cos inner - cos outer).
        axis: vec4,
        /// 1 - cos outer.
        outer_versine: float,
    }
    /// Push constants of all shading passes. The rows rotate a world direction into the
    /// environment's frame.
    ShadeParams {
        environment_from_world_0: vec4,
        environment_from_world_1: vec4,
        environment_from_world_2: vec4,
        /// Eye position (w = 1) or direction to the viewer (w = 0).
        eye: vec4,
        width: uint,
        height: uint,
        environment_width: uint,
        environment_height: uint,
        /// Samples a pixel (except for the reference).
        sample_count: uint,
        /// First pair of samples of this dispatch in each scramble's net (reference only). Pair 0
        /// resets the sums.
        first_pair: uint,
        first_row: uint,
        prefilter_level_count: uint,
        environment_scale: float,
        lod_bias: float,
        /// Bits: `constants::SHADE_FLAG_*`.
        flags: uint,
        /// Chooses the points of the reference; the set of a sampled method.
        seed: uint,
        /// Pairs of samples of this dispatch in each scramble's net; all pairs when the sums are
        /// resolved (reference only).
        pair_count: uint,
        /// Sample points of this dispatch (except for the reference): its share of `sample_count`.
        point_count: uint,
        /// Slots of the environment's distribution (reference only).
        slot_count: uint,
        /// Direct lights (their pass only).
        light_count: uint,
    }
    /// Push constants of the background pass. `right` and `up` reach from the image's centre to its
    /// edges at distance 1 along `forward` (0 for an orthographic camera); all three are in the
    /// environment's frame.
    BackgroundParams {
        right: vec4,
        up: vec4,
        forward: vec4,
        width: uint,
        height: uint,
        first_row: uint,
        environment_scale: float,
    }
    /// Push constants of the passes that put images of layers together.
    LayerParams {
        /// Eye position (w = 1) or direction to the viewer (w = 0).
        eye: vec4,
        width: uint,
        height: uint,
        /// Level of perceptual roughness of the first row of albedos;
        /// `constants::ALBEDOS_BY_MATERIAL` if rows are by material.
        first_level: uint,
        /// What scales the layer: one of `constants::COAT_WEIGHT_*` or `SHEEN_ALBEDO_*`.
        scale: uint,
        /// What the base loses to it, of the same list.
        loss: uint,
        /// 1 if a coat's image is a lookup times its albedo for F = 1, by which it is divided.
        is_lookup: uint,
        /// Powers of what a coat leaves of the terms of its base.
        specular_power: uint,
        diffuse_power: uint,
        /// One of `constants::SPECULAR_OCCLUSION_*`.
        specular_occlusion: uint,
        /// One of `constants::OCCLUDED_*`.
        occluded: uint,
    }
    /// Push constants of the probes, the shaders that tests run.
    ProbeParams {
        count: uint,
    }
    /// Push constants of the tone curve.
    TonemapParams {
        width: uint,
        height: uint,
        exposure: float,
        contrast: float,
    }
    /// Push constants of a half in the window.
    WindowPictureParams {
        /// Corner of the picture in the window, pixels.
        left: uint,
        top: uint,
        /// Size of the half's image, texels.
        texel_columns: uint,
        texel_rows: uint,
        /// Of 256.
        brightness: uint,
        /// Texels a pixel.
        across: float,
        down: float,
    }
    /// Push constants of the window's controls.
    WindowMeshParams {
        /// Size of the window, points.
        width: float,
        height: float,
    }
}
