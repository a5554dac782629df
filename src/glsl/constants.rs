//! Every number that Rust and GLSL share. The build script writes `generated/constants.glsl` from [`ALL`].

/// Prefix of the name of a shader in a file of the user's; other names are paths below `shaders/`.
pub const FILE_PREFIX: &str = "file:";

/// A shared number as GLSL text needs it.
#[derive(Clone, Copy, Debug)]
pub enum Value {
    Float(f32),
    Uint(u32),
}

macro_rules! constants {
    ($($(#[$doc:meta])* $name:ident: $ty:tt = $value:expr;)*) => {
        $($(#[$doc])* pub const $name: $ty = $value;)*
        /// Every shared constant by name, in the order of this file.
        pub const ALL: &[(&str, Value)] = &[$((stringify!($name), constants!(@value $ty $name))),*];
    };
    (@value f32 $name:ident) => { Value::Float($name) };
    (@value u32 $name:ident) => { Value::Uint($name) };
}

constants! {
    /// π in f32.
    PI: f32 = std::f32::consts::PI;
    /// Smallest microfacet width that is shaded as a lobe; below it `alpha²` underflows the distributions in f32.
    ALPHA_MIN: f32 = 1e-3;
    /// Sine of the angle between view and normal below which f32 does not know their plane.
    TILT_MIN: f32 = 1e-5;
    /// Floor of a clamped cosine. 0 would divide by zero in `1/(4 n_dot_v)`; a larger floor darkens the rim visibly.
    COSINE_MIN: f32 = 1e-6;
    /// Luminance weights of linear Rec.709 RGB \[BT709\] item 3.2.
    LUMINANCE_RED: f32 = 0.2126;
    /// See `LUMINANCE_RED`.
    LUMINANCE_GREEN: f32 = 0.7152;
    /// See `LUMINANCE_RED`.
    LUMINANCE_BLUE: f32 = 0.0722;
    /// Floor of sin(theta) in a density per solid angle over an equirectangular map. At 0 the density would be infinite, and its product
    /// with a black pole NaN; below 1e-30 it would overflow f32. The balance heuristic gives such a sample no weight.
    ENVIRONMENT_SIN_THETA_MIN: f32 = 1e-9;
    /// Side of the square work group of image passes.
    GROUP_SIDE: u32 = 8;
    /// Invocations of a linear work group (reductions, probes).
    GROUP_LINEAR: u32 = 64;
    /// How far the level of a lookup in a cube map is softened at its edges: 1/sr of the squared difference of two components of a
    /// direction. By trial: 0 lets a lamp on a corner lose 11 % by 40 samples, 3 leaves 1 %.
    EDGE_SOFTNESS: f32 = 3.0;
    /// Cells of a filtered map's texel, a side, by which it takes the mean of the environment.
    RESAMPLE_SIDE: u32 = 4;
    /// Sample points that one dispatch reads: as a uniform block 16 KiB, the least that every device allows.
    POINTS_PER_DISPATCH: u32 = 1024;
    /// Independent scrambles of the reference. Fewer and longer nets have less noise at equal samples; their spread states a pixel's
    /// error with one degree of freedom less than there are scrambles.
    SCRAMBLE_COUNT: u32 = 4;
    /// Cells of an environment, by columns and by bands, among which the reference chooses by the lobe of each pixel.
    CELL_COLUMNS: u32 = 32;
    /// See `CELL_COLUMNS`.
    CELL_ROWS: u32 = 16;
    /// Added to the lobe's density (1/sr) at a cell to make its weight. At 0 a tail that the cell's mean direction misses is left to
    /// the lobe; 0.02 wastes a quarter of the samples of dark pixels.
    GUIDE_FLOOR: f32 = 0.002;
    /// Narrower lobes guide as if they were as wide as this: they fit between the mean directions of neighbouring cells.
    GUIDE_ALPHA_MIN: f32 = 0.15;
    /// Nodes of the table of lobe shapes, a side; see `precompute::lobe_shape`.
    LOBE_SHAPE_SIDE: u32 = 32;
    /// Its parts: first moments, widths of least squared error, widths of least relative error.
    LOBE_SHAPE_PARTS: u32 = 3;
    /// Number of real spherical harmonics up to degree 2.
    SH9_COUNT: u32 = 9;
    /// Width of the Hann window of `sh9-windowed`: degree 1 counts 0.933, degree 2 0.75.
    SH9_WINDOW: f32 = 6.0;
    /// Masking-shadowing variants; the order is that of `brdf::MaskingShadowing`.
    MASKING_SEPARABLE: u32 = 0;
    /// Height-correlated Smith.
    MASKING_CORRELATED: u32 = 1;
    /// Karis' Schlick-Smith with k = alpha/2.
    MASKING_SCHLICK: u32 = 2;
    /// Exact Smith masking of each model's own distribution.
    MASKING_SMITH_EXACT: u32 = 3;
    /// How a pixel comes by its points: as they are, the same for all pixels.
    PIXEL_POINTS_SHARED: u32 = 0;
    /// Scrambled by a hash of the pixel.
    PIXEL_POINTS_OWEN: u32 = 1;
    /// What gives back the light of several scatterings; the order is that of `brdf::Compensation`.
    COMPENSATION_NONE: u32 = 0;
    /// By scaling the single scattering.
    COMPENSATION_TURQUIN: u32 = 1;
    /// As irradiance.
    COMPENSATION_FDEZ_AGUERA: u32 = 2;
    /// By a lobe of its own.
    COMPENSATION_KULLA_CONTY: u32 = 3;
    /// The DFG table at fourth roots of n·v and alpha, outermost texels on the ends: ours.
    DFG_AXES_FOURTH_ROOTS: u32 = 0;
    /// At n·v and perceptual roughness of texel centres, as engines hold it.
    DFG_AXES_CENTRES: u32 = 1;
    /// Weights of the prefiltered map's mean (`precompute::prefilter::WEIGHTS`): n·l.
    PREFILTER_WEIGHT_COSINE: u32 = 0;
    /// G1(l).
    PREFILTER_WEIGHT_MASKING: u32 = 1;
    /// 1 above the horizon.
    PREFILTER_WEIGHT_NONE: u32 = 2;
    /// Light kinds; the order is that of `scene::LightKind`.
    LIGHT_DIRECTIONAL: u32 = 0;
    /// A point light.
    LIGHT_POINT: u32 = 1;
    /// Bit of `ShadeParams::flags`: the image has no specular term, so the diffuse one loses nothing to it.
    SHADE_FLAG_NO_SPECULAR: u32 = 1;
}
