//! Specialization constants shared by Rust and GLSL. The build script writes a file
//! `generated/specialization/<name>.glsl` for each entry of [`ALL`]; a shader includes the files of
//! the constants that it reads.
//!
//! The words of the entries are the `constant_id` 0, 1, ... In GLSL a constant has its name in
//! capitals. GLSL ES has no such constants, so there it is a uniform of the same name.

use super::constants as code;
use super::constants::Value;

/// A specialization constant as a shader declares it.
#[derive(Clone, Copy, Debug)]
pub struct SpecializationConstant {
    /// Name of the field of [`Specialization`].
    pub name: &'static str,
    /// Value in a pipeline that does not set it, of each element of an array.
    pub default: Value,
    /// Length of an array, 1 of a number: as many words.
    pub word_count: usize,
    pub is_array: bool,
}

macro_rules! specialization_constants {
    ($($(#[$doc:meta])* $name:ident: $ty:tt = $default:expr;)*) => {
        /// Values of all specialization constants. A shader ignores those that it does not declare.
        #[derive(Clone, Copy, Debug, PartialEq)]
        pub struct Specialization {
            $($(#[$doc])* pub $name: $ty,)*
        }

        impl Default for Specialization {
            fn default() -> Self {
                Self { $($name: $default,)* }
            }
        }

        impl Specialization {
            /// Returns the value of each `constant_id`, as the bits that the shader reads.
            pub fn words(&self) -> Vec<u32> {
                let mut words = Vec::with_capacity(WORD_COUNT);
                $(words.extend(specialization_constants!(@bits $ty self.$name));)*
                words
            }
        }

        /// All specialization constants in the order of their words.
        pub const ALL: &[SpecializationConstant] = &[$(SpecializationConstant {
            name: stringify!($name),
            default: specialization_constants!(@value $ty $default),
            word_count: size_of::<$ty>() / size_of::<u32>(),
            is_array: specialization_constants!(@is_array $ty),
        }),*];
    };
    (@bits u32 $value:expr) => { [$value] };
    (@bits f32 $value:expr) => { [$value.to_bits()] };
    (@bits [f32; $count:expr] $value:expr) => { $value.map(f32::to_bits) };
    (@value u32 $value:expr) => { Value::Uint($value) };
    (@value f32 $value:expr) => { Value::Float($value) };
    (@value [f32; $count:expr] $value:expr) => { Value::Float($value[0]) };
    (@is_array [f32; $count:expr]) => { true };
    (@is_array $number:tt) => { false };
}

specialization_constants! {
    /// Masking-shadowing of the model, one of `MASKING_*`.
    masking: u32 = code::MASKING_SEPARABLE;
    /// 1 if the driver's bilinear filter computes in f32, else 0.
    exact_filter: u32 = 0;
    /// Bend b in [0, 1] of the mapping from roughness to the levels of a prefiltered map.
    level_bend: f32 = 0.0;
    /// Perceptual roughness of each level of a prefiltered map, ascending; zeros if the bend maps
    /// them.
    level_roughnesses: [f32; code::LEVELS_MAX as usize] = [0.0; code::LEVELS_MAX as usize];
    /// Weight of a direction in a prefiltered texel, one of `PREFILTER_WEIGHT_*`.
    prefilter_weight: u32 = code::PREFILTER_WEIGHT_COSINE;
    /// Whether pixels share their points, or each scrambles or shifts them: one of
    /// `PIXEL_POINTS_*`.
    pixel_points: u32 = code::PIXEL_POINTS_SHARED;
    /// Compensation of the light that single scattering loses, one of `COMPENSATION_*`.
    compensation: u32 = code::COMPENSATION_NONE;
    /// F0 of the dielectrics whose exact Fresnel reflectance replaces Schlick's; `FRESNEL_SCHLICK`
    /// for none.
    fresnel_f0: f32 = code::FRESNEL_SCHLICK;
    /// Mean over cosines of the weight of f90 if `fresnel_f0` selects a dielectric.
    fresnel_mean: f32 = 0.0;
    /// Texel positions of the DFG table, one of `DFG_AXES_*`.
    dfg_axes: u32 = code::DFG_AXES_FOURTH_ROOTS;
    /// Whether lobes have two widths, and by which law: one of `ANISOTROPY_*`.
    anisotropy: u32 = code::ANISOTROPY_NONE;
    /// Lookup of a lobe of two widths: `BEND_PARAMETERS_* | BEND_NORMAL_* << 4 | BEND_TOWARD_* <<
    /// 8`; 1 << 12 reads A and B at the root mean square width.
    bend: u32 = code::BEND_PARAMETERS_SQUARE;
    /// Visibility of sheen in the reference, one of `SHEEN_VISIBILITY_*`.
    sheen_visibility: u32 = code::SHEEN_VISIBILITY_CHARLIE;
    /// Lookup of a sheen lobe: `SHEEN_TOWARD_* | SHEEN_LEVEL_* << 4`.
    sheen_lookup: u32 = code::SHEEN_TOWARD_MOMENT;
    /// Limits of hardware that all shaders emulate for tests, bits `EMULATE_*`. The device sets it.
    emulated_limits: u32 = 0;
}

/// Number of words of all constants.
pub const WORD_COUNT: usize = size_of::<Specialization>() / size_of::<u32>();

/// The `constant_id` of `emulated_limits`, the last.
pub const EMULATED_LIMITS_ID: usize = WORD_COUNT - 1;
