//! Numbers shared by Rust and GLSL. The build script writes `generated/constants.glsl` from
//! [`ALL`].

/// Prefix of shader names for files of the user; other names are paths below `shaders/`.
pub const FILE_PREFIX: &str = "file:";

#[derive(Clone, Copy, Debug)]
pub enum Value {
    Float(f32),
    Uint(u32),
}

macro_rules! constants {
    ($($(#[$doc:meta])* $name:ident: $ty:tt = $value:expr;)*) => {
        $($(#[$doc])* pub const $name: $ty = $value;)*
        /// All shared constants by name, in the order of this file.
        pub const ALL: &[(&str, Value)] = &[$((stringify!($name), constants!(@value $ty $name))),*];
    };
    (@value f32 $name:ident) => { Value::Float($name) };
    (@value u32 $name:ident) => { Value::Uint($name) };
}

constants! {
    /// π in f32.
    PI: f32 = std::f32::consts::PI;
    /// Squared distance below which a point light is not nearer (`scene::light`).
    LIGHT_DISTANCE2_MIN: f32 = 1e-12;
    /// Smallest microfacet width shaded as a lobe; below it `alpha²` underflows the distributions
    /// in f32.
    ALPHA_MIN: f32 = 1e-3;
    /// Sine of the angle between view and normal below which f32 cannot represent their plane.
    TILT_MIN: f32 = 1e-5;
    /// Floor of a clamped cosine. 0 would divide by zero in `1/(4 n_dot_v)`; a larger floor visibly
    /// darkens the rim.
    COSINE_MIN: f32 = 1e-6;
    /// Luminance weights of linear Rec.709 RGB \[BT709\] item 3.2.
    LUMINANCE_RED: f32 = 0.2126;
    LUMINANCE_GREEN: f32 = 0.7152;
    LUMINANCE_BLUE: f32 = 0.0722;
    /// Floor of sin(theta) in a density per solid angle over an equirectangular map. At 0 the
    /// density would be infinite, and its product with a black pole NaN; below 1e-30 it would
    /// overflow f32. Such samples get no weight.
    ENVIRONMENT_SIN_THETA_MIN: f32 = 1e-9;
    /// Most levels of a prefiltered map that the program makes.
    LEVELS_MAX: u32 = 11;
    /// Side of the square work group of image passes.
    GROUP_SIDE: u32 = 8;
    /// Invocations of a linear work group (reductions, probes).
    GROUP_LINEAR: u32 = 64;
    /// Softness of a cube lookup's level at the edges: 1/sr of the squared difference of two
    /// components of a direction. Found by trial: with 0, 40 samples lose 11 % of a lamp on a
    /// corner, with 3, 1 %.
    EDGE_SOFTNESS: f32 = 3.0;
    /// Cells per side of a filtered map's texel, over which the environment is averaged.
    RESAMPLE_SIDE: u32 = 4;
    /// Sample points that a dispatch reads: 16 KiB as a uniform block, the least that every device
    /// allows.
    POINTS_PER_DISPATCH: u32 = 1024;
    /// Independent scrambles of the reference. Fewer and longer nets have less noise at equal
    /// samples; a pixel's error is estimated from their spread with one degree of freedom less.
    SCRAMBLE_COUNT: u32 = 4;
    /// Cells of an environment, by columns and bands, among which the reference chooses by each
    /// pixel's lobe.
    CELL_COLUMNS: u32 = 32;
    CELL_ROWS: u32 = 16;
    /// Added to the lobe's density (1/sr) in a cell's weight. With 0, tails that miss the cell's
    /// mean direction are left to the lobe; 0.02 wastes a quarter of the samples of dark pixels.
    GUIDE_FLOOR: f32 = 0.002;
    /// Narrower lobes guide with this width: they fit between the mean directions of neighbouring
    /// cells.
    GUIDE_ALPHA_MIN: f32 = 0.15;
    /// Number of real spherical harmonics up to degree 2.
    SH9_COUNT: u32 = 9;
    /// Integrals of the harmonics over texels, in the order of `precompute::sh9::Projection`: exact.
    SH9_OVER_TEXELS: u32 = 0;
    /// Values at texel centres.
    SH9_AT_CENTRES: u32 = 1;
    /// Masking-shadowing variants; in the order of `brdf::MaskingShadowing`.
    MASKING_SEPARABLE: u32 = 0;
    /// Height-correlated Smith.
    MASKING_CORRELATED: u32 = 1;
    /// Karis' Schlick-Smith with k = alpha/2.
    MASKING_SCHLICK: u32 = 2;
    /// Exact Smith masking of each model's own distribution.
    MASKING_SMITH_EXACT: u32 = 3;
    /// How pixels get their points: all share the set.
    PIXEL_POINTS_SHARED: u32 = 0;
    /// Scrambled by a hash of the pixel.
    PIXEL_POINTS_OWEN: u32 = 1;
    /// Shifted on the torus by the buffer of shifts.
    PIXEL_POINTS_SHIFTED: u32 = 2;
    /// Compensations; in the order of `brdf::Compensation`.
    COMPENSATION_NONE: u32 = 0;
    /// Scales single scattering.
    COMPENSATION_TURQUIN: u32 = 1;
    /// Adds irradiance.
    COMPENSATION_FDEZ_AGUERA: u32 = 2;
    /// Adds a lobe.
    COMPENSATION_KULLA_CONTY: u32 = 3;
    /// Scales single scattering by the share that `kulla-conty` returns, as Cycles does.
    COMPENSATION_CYCLES: u32 = 4;
    /// The specialization constant `fresnel_f0` of Schlick's reflectance.
    FRESNEL_SCHLICK: f32 = -1.0;
    /// DFG table over fourth roots of n·v and alpha, outermost texels on the ends: ours.
    DFG_AXES_FOURTH_ROOTS: u32 = 0;
    /// Over n·v and perceptual roughness at texel centres, as in engines.
    DFG_AXES_CENTRES: u32 = 1;
    /// Weights in the prefiltered map's mean (`precompute::prefilter::WEIGHTS`): n·l.
    PREFILTER_WEIGHT_COSINE: u32 = 0;
    /// G1(l).
    PREFILTER_WEIGHT_MASKING: u32 = 1;
    /// 1 above the horizon.
    PREFILTER_WEIGHT_NONE: u32 = 2;
    /// Limits of hardware that shaders emulate (`gpu::emulation`), a bit each: 8-bit weights of
    /// texels.
    EMULATE_TEXEL_WEIGHTS: u32 = 1;
    /// 8-bit fractions between levels.
    EMULATE_LEVEL_FRACTIONS: u32 = 2;
    /// No filter across the edges of a cube's faces.
    EMULATE_CUBE_SEAMS: u32 = 4;
    /// Lookups rounded to f16.
    EMULATE_HALF_LOOKUPS: u32 = 8;
    /// 8-bit weights of texels, rounded down.
    EMULATE_TEXEL_WEIGHTS_DOWN: u32 = 64;
    /// The missing texel of a cube's corner taken from the nearest face, not averaged from three.
    EMULATE_CUBE_CORNERS: u32 = 128;
    /// Any limit of lookups: a lookup that is not the driver's.
    EMULATE_LOOKUPS: u32 = 207;
    /// Elementary functions as coarse as Vulkan allows.
    EMULATE_ELEMENTARY: u32 = 16;
    /// Vertices on a grid of 1/256 pixel.
    EMULATE_VERTEX_GRID: u32 = 32;
    /// NaN in new images and buffers, whose contents Vulkan leaves undefined; the host writes it.
    EMULATE_UNDEFINED_MEMORY: u32 = 256;
    /// Storage buffers of a few MiB; the host makes no larger ones.
    EMULATE_SMALL_BUFFERS: u32 = 512;
    /// Whether lobes have two widths, and how alpha and a strength make them; in the order of
    /// `brdf::Anisotropy`.
    ANISOTROPY_NONE: u32 = 0;
    ANISOTROPY_GLTF: u32 = 1;
    ANISOTROPY_KULLA: u32 = 2;
    ANISOTROPY_DISNEY: u32 = 3;
    ANISOTROPY_OPENPBR: u32 = 4;
    /// Lookups of a lobe of two widths; in the order of `shade::bend`.
    BEND_PARAMETERS_NARROW: u32 = 0;
    BEND_PARAMETERS_MEAN: u32 = 1;
    BEND_PARAMETERS_GEOMETRIC: u32 = 2;
    BEND_PARAMETERS_SQUARE: u32 = 3;
    BEND_NORMAL_PLAIN: u32 = 0;
    BEND_NORMAL_LINEAR: u32 = 1;
    BEND_NORMAL_QUARTIC: u32 = 2;
    BEND_NORMAL_QUARTIC_UNIT: u32 = 3;
    BEND_NORMAL_QUARTIC_ALPHA: u32 = 4;
    BEND_NORMAL_ROOT: u32 = 5;
    BEND_NORMAL_CAP: u32 = 6;
    BEND_NORMAL_QUARTIC_ROOT: u32 = 7;
    BEND_NORMAL_STRENGTH: u32 = 8;
    BEND_TOWARD_MIRROR: u32 = 0;
    BEND_TOWARD_NORMAL: u32 = 1;
    BEND_TOWARD_BENT: u32 = 2;
    BEND_TOWARD_BENT_LESS: u32 = 3;
    BEND_TOWARD_TWICE: u32 = 4;
    BEND_TOWARD_UNITY: u32 = 5;
    BEND_TOWARD_CAP: u32 = 6;
    /// F0 of every coat: index of refraction 1.5.
    COAT_F0: f32 = 0.04;
    /// Index of refraction of every coat.
    COAT_IOR: f32 = 1.5;
    /// Roughness of the base under a coat, in the order of `brdf::RoughnessUnderCoat`: unchanged.
    UNDER_COAT_SAME: u32 = 0;
    /// At least the roughness of the coat.
    UNDER_COAT_AT_LEAST_COAT: u32 = 1;
    /// Widened by refraction.
    UNDER_COAT_REFRACTED: u32 = 2;
    /// Visibilities of sheen; in the order of `brdf::SheenVisibility`.
    SHEEN_VISIBILITY_CHARLIE: u32 = 0;
    SHEEN_VISIBILITY_ASHIKHMIN: u32 = 1;
    SHEEN_ALPHA_MIN: f32 = 0.01;
    /// Lookups of sheen; in the order of `shade::sheen`.
    SHEEN_TOWARD_NORMAL: u32 = 0;
    SHEEN_TOWARD_MIRROR: u32 = 1;
    SHEEN_TOWARD_MOMENT: u32 = 2;
    SHEEN_LEVEL_ALPHA: u32 = 0;
    SHEEN_LEVEL_ROUGHEST: u32 = 1;
    /// What scales a sheen's lookup, or its base's loss (`shade::sheen::SheenAlbedo`): nothing.
    SHEEN_ALBEDO_ONE: u32 = 0;
    /// The exact albedo.
    SHEEN_ALBEDO_EXACT: u32 = 1;
    /// Fits of renderers.
    SHEEN_ALBEDO_THREE: u32 = 2;
    SHEEN_ALBEDO_PLAYCANVAS: u32 = 3;
    SHEEN_ALBEDO_MATERIALX: u32 = 4;
    /// The constant `SHEEN_LOSS`.
    SHEEN_ALBEDO_CONSTANT: u32 = 5;
    /// What the base loses to a sheen in PlayCanvas.
    SHEEN_LOSS: f32 = 0.157;
    /// What scales a coat, or its base's loss (`shade::coat::CoatWeight`): nothing.
    COAT_WEIGHT_ONE: u32 = 0;
    /// Fresnel's reflectance.
    COAT_WEIGHT_FRESNEL: u32 = 1;
    /// The albedo.
    COAT_WEIGHT_ALBEDO: u32 = 2;
    /// Both.
    COAT_WEIGHT_FRESNEL_TIMES_ALBEDO: u32 = 3;
    /// Factor of an occluded specular term (`shade::occlusion::SpecularOcclusion`): the map's value.
    SPECULAR_OCCLUSION_AO: u32 = 0;
    /// 1.
    SPECULAR_OCCLUSION_NONE: u32 = 1;
    /// Lagarde's.
    SPECULAR_OCCLUSION_LAGARDE: u32 = 2;
    /// The common part of two cones.
    SPECULAR_OCCLUSION_CONE: u32 = 3;
    /// Terms of an image that is occluded: those that take the factor of the diffuse term.
    OCCLUDED_REST: u32 = 0;
    /// The specular term.
    OCCLUDED_SPECULAR: u32 = 1;
    /// Both, of which a second image has the specular one alone.
    OCCLUDED_BOTH: u32 = 2;
    /// Nodes of a lobe's directional albedo by √(n·v).
    ALBEDO_NODES: u32 = 65;
    /// √(n·v) of the first node.
    ALBEDO_ROOT_MIN: f32 = 0.01;
    /// Levels of perceptual roughness above 0 of a layer with a map, which has 8 bits.
    LAYER_LEVELS: u32 = 255;
    /// In place of the first level of a layer's albedos: they have a row for each material.
    ALBEDOS_BY_MATERIAL: u32 = 0xffff_ffff;
    /// Of the strips of `split-sum-strips-*`: length and breadth over their share of the widths,
    /// and how far the outermost reach.
    STRIP_LENGTH: f32 = 0.5;
    STRIP_BREADTH: f32 = 0.9;
    STRIP_REACH: f32 = 0.95;
    /// Width of each lookup of `split-sum-major-*` over its share of the major axis.
    MAJOR_SPACING: f32 = 2.3;
    /// Bit of `ShadeParams::flags`: the image has no specular term, so the diffuse one loses
    /// nothing to it.
    SHADE_FLAG_NO_SPECULAR: u32 = 1;
    /// The diffuse term lies under the dielectric of a mixture of two BRDFs, not under one lobe of
    /// mixed F0.
    SHADE_FLAG_MIX_BRDFS: u32 = 2;
}
