//! The list of all axes except the axes of layers ([`super::layers`]), of frames
//! ([`super::frames`]) and of tables ([`super::tables`]).

use super::frames::FRAME_AXES;
use super::layers::LAYER_AXES;
use super::plain::{ALPHA_KIND, IOR, LEVELS, PLAIN, ROUGHNESS, one_of, valued};
use super::tables::{PrecomputedTable, TABLE_AXES};
use super::{Axes, Axis, AxisId, Part, Setter, Sheet, Symbol};
use crate::base::math::sequence::{FramePoints, PixelPoints, Sequence};
use crate::base::names::Listed;
use crate::experiment::value::{IMAGE_SIZE, Kind, Range, Value};
use crate::instrument::brdf::{self, Compensation, MaskingShadowing};
use crate::instrument::environment::Placement;
use crate::instrument::shade::{Diffuse, Method, REFERENCE};

/// Every axis. Their order is the order of columns that an experiment does not name.
pub static AXES: Axes = Axes(LIST);

const LIST: &[Axis] = &{
    let mut list =
        [PLAIN; IMAGE_AXES.len() + LAYER_AXES.len() + FRAME_AXES.len() + TABLE_AXES.len()];
    let (image, rest) = list.split_at_mut(IMAGE_AXES.len());
    let (layers, rest) = rest.split_at_mut(LAYER_AXES.len());
    let (frames, tables) = rest.split_at_mut(FRAME_AXES.len());
    image.copy_from_slice(IMAGE_AXES);
    layers.copy_from_slice(LAYER_AXES);
    frames.copy_from_slice(FRAME_AXES);
    tables.copy_from_slice(TABLE_AXES);
    list
};

const IMAGE_AXES: &[Axis] = &[
    Axis {
        name: "size",
        label: "Size (px)",
        about: "width and height of the image",
        sheet: Sheet::Page,
        needs_memory: true,
        is_key: true,
        set: Setter::Pair(|settings, pair| settings.size = pair),
        ..valued(IMAGE_SIZE, || Value::Pair([256, 256]), PLAIN)
    },
    Axis {
        name: "environment",
        about: "the light: builtin:NAME (`splitsum list environments`), or an .hdr or .exr file \
                (FILE.exr#NAME for a layer)",
        plural: "environments",
        sheet: Sheet::Page,
        needs_memory: true,
        feeds: &[
            PrecomputedTable::Mips,
            PrecomputedTable::Sh9,
            PrecomputedTable::Prefilter,
            PrecomputedTable::Irradiance,
        ],
        default: || Value::from("builtin:sky"),
        set: Setter::Name(|settings, name| settings.environment = name.to_owned()),
        ..PLAIN
    },
    Axis {
        name: "scene",
        label: "Model",
        about: "the scene: a name of `splitsum list scenes`, or an .obj, .glb or .gltf file",
        sheet: Sheet::Page,
        frames_cost: true,
        is_key: true,
        default: || Value::from("sphere"),
        set: Setter::Name(|settings, name| settings.scene = name.to_owned()),
        ..PLAIN
    },
    Axis {
        name: "brdf",
        label: "BRDF",
        about: "microfacet model",
        plural: "BRDF models",
        sheet: Sheet::Page,
        frames_cost: true,
        tables_cost: true,
        feeds: &[PrecomputedTable::Prefilter, PrecomputedTable::Dfg],
        set: Setter::Name(|settings, name| settings.shading.brdf = <dyn brdf::Brdf>::listed(name)),
        ..valued(
            Kind::one_of::<dyn brdf::Brdf>(),
            || Value::from("ggx"),
            PLAIN,
        )
    },
    Axis {
        name: "method",
        part: Part::Method,
        about: "specular method: `splitsum list methods`, or your GLSL",
        sheet: Sheet::Column,
        frames_cost: true,
        tables_cost: true,
        is_compared: true,
        needs_memory: true,
        reference: |reference, value| {
            if reference.leaves_out(value) {
                value.clone()
            } else {
                Value::from(reference.method.as_str())
            }
        },
        set: Setter::Name(|settings, name| settings.shading.method = Method::listed(name)),
        ..valued(
            Kind::NameOrFile {
                what: Method::WHAT,
                names: Method::names,
                listed_in: Method::LISTED_IN,
            },
            || Value::from("sampled"),
            PLAIN,
        )
    },
    Axis {
        name: "diffuse",
        part: Part::Method,
        about: "diffuse method; `splitsum list diffuse`",
        plural: "diffuse methods",
        sheet: Sheet::Column,
        frames_cost: true,
        tables_cost: true,
        needs_memory: true,
        used: |used| used.has_diffuse_surface,
        reference: |reference, value| {
            if reference.leaves_out(value) {
                value.clone()
            } else {
                Value::from(REFERENCE)
            }
        },
        set: Setter::Name(|settings, name| settings.shading.diffuse = Diffuse::listed(name)),
        ..valued(Kind::one_of::<Diffuse>(), || Value::from("sh9"), PLAIN)
    },
    Axis {
        name: "samples",
        label: "Samples a pixel",
        part: Part::Count,
        about: "samples per pixel of sampled methods",
        plural: "sample counts",
        symbol: Symbol::After("samples", "samples"),
        sheet: Sheet::Column,
        frames_cost: true,
        is_compared: true,
        used: |used| used.method.uses_samples,
        reference: |reference, _| Value::Count(reference.samples),
        set: Setter::Count(|settings, count| settings.shading.samples = count),
        ..valued(
            Kind::Count {
                min: 1,
                max: 1 << 24,
            },
            || Value::Count(40),
            PLAIN,
        )
    },
    Axis {
        name: "sequence",
        part: Part::Parameter,
        about: "point sequence of sampled methods; `splitsum list sequences`",
        used: |used| {
            used.method.uses_point_set
                && used
                    .frames
                    .is_none_or(|frames| frames.points != FramePoints::R2)
        },
        set: Setter::Name(|settings, name| settings.shading.sequence = Sequence::listed(name)),
        ..one_of::<Sequence>(PLAIN)
    },
    Axis {
        name: "point_set",
        part: Part::Luck,
        about: "set of points: 0 is the plain sequence, k > 0 a randomised copy",
        symbol: Symbol::Before("set"),
        used: |used| used.method.uses_point_set,
        set: Setter::Count(|settings, count| settings.shading.point_set = count),
        ..valued(
            Kind::Count {
                min: 0,
                max: 1 << 20,
            },
            || Value::Count(0),
            PLAIN,
        )
    },
    Axis {
        name: "pixel_points",
        part: Part::Parameter,
        about: "points of each pixel: shared by all pixels, or scrambled for each (owen)",
        plural: "point assignments",
        symbol: Symbol::After("points", "points"),
        frames_cost: true,
        is_compared: true,
        used: |used| used.method.uses_point_set && used.frames.is_none(),
        set: Setter::Name(|settings, name| {
            settings.shading.pixel_points = *PixelPoints::listed(name)
        }),
        ..one_of::<PixelPoints>(PLAIN)
    },
    Axis {
        name: "alpha",
        about: "microfacet width of every material",
        symbol: Symbol::Before("alpha"),
        kind: ALPHA_KIND,
        spelling: Some(ROUGHNESS),
        set: Setter::Number(|settings, number| settings.material.alpha = Some(number as f32)),
        ..PLAIN
    },
    Axis {
        name: "f0",
        label: "F0",
        about: "reflectance at normal incidence of every dielectric; a metal's is its albedo",
        plural: "values of F0",
        symbol: Symbol::Before("F0"),
        used: |used| used.has_dielectric,
        kind: Kind::Color(Range::closed(0.0, 1.0)),
        spelling: Some(IOR),
        set: Setter::Color(|settings, color| settings.material.f0 = Some(color)),
        ..PLAIN
    },
    Axis {
        name: "albedo",
        about: "albedo of every material",
        symbol: Symbol::Before("albedo"),
        kind: Kind::Color(Range::closed(0.0, 1.0)),
        set: Setter::Color(|settings, color| settings.material.albedo = Some(color)),
        ..PLAIN
    },
    Axis {
        name: "metallic",
        about: "0 dielectric, 1 metal",
        plural: "values of metallic",
        symbol: Symbol::Before("metallic"),
        kind: Kind::Number(Range::closed(0.0, 1.0)),
        set: Setter::Number(|settings, number| settings.material.metallic = Some(number as f32)),
        ..PLAIN
    },
    Axis {
        name: "exposure",
        label: "Exposure (×)",
        part: Part::Display,
        about: "factor before the tone curve",
        symbol: Symbol::Before("exposure"),
        set: Setter::Number(|settings, number| settings.curve.exposure = number as f32),
        ..valued(
            Kind::Number(Range::above(0.0, 1e9)),
            || Value::Number(1.0),
            PLAIN,
        )
    },
    Axis {
        name: "contrast",
        part: Part::Display,
        about: "exponent of the tone curve, times 2.2",
        symbol: Symbol::Before("contrast"),
        set: Setter::Number(|settings, number| settings.curve.contrast = number as f32),
        ..valued(
            Kind::Number(Range::above(0.0, 100.0)),
            || Value::Number(1.0),
            PLAIN,
        )
    },
    Axis {
        name: "environment_orientation",
        label: "Orientation",
        about: "rotates the map by the k-th of a fixed even set of 3D rotations; 0 keeps it",
        symbol: Symbol::Before("orientation"),
        flag: Some("orientation"),
        set: Setter::Count(|settings, count| settings.shading.placement.orientation = count),
        ..valued(
            Kind::Count {
                min: 0,
                max: Placement::ORIENTATION_MAX,
            },
            || Value::Count(0),
            PLAIN,
        )
    },
    Axis {
        name: "environment_rotation_deg",
        label: "Light turn (°)",
        about: "rotates the map around +y, after environment_orientation",
        plural: "rotations",
        symbol: Symbol::After("deg", "degrees"),
        flag: Some("rotate"),
        set: Setter::Number(|settings, number| settings.shading.placement.rotation_deg = number),
        ..valued(
            Kind::Number(Range::closed(-360.0, 360.0)),
            || Value::Number(0.0),
            PLAIN,
        )
    },
    Axis {
        name: "environment_scale",
        label: "Brightness (×)",
        about: "multiplies the environment's radiance",
        symbol: Symbol::Before("scale"),
        flag: Some("scale"),
        set: Setter::Number(|settings, number| settings.shading.environment_scale = number as f32),
        ..valued(
            Kind::Number(Range::above(0.0, 1e9)),
            || Value::Number(1.0),
            PLAIN,
        )
    },
    Axis {
        name: "masking",
        about: "masking-shadowing of the image and its reference",
        plural: "masking-shadowing functions",
        frames_cost: true,
        tables_cost: true,
        feeds: &[PrecomputedTable::Prefilter, PrecomputedTable::Dfg],
        set: Setter::Name(|settings, name| {
            settings.shading.masking_shadowing = *MaskingShadowing::listed(name)
        }),
        ..valued(
            Kind::one_of::<MaskingShadowing>(),
            || Value::from("separable"),
            PLAIN,
        )
    },
    Axis {
        name: "compensation",
        about: "multiple-scattering compensation, for the image and its reference; fdez-aguera and \
                kulla-conty add it to the diffuse term",
        frames_cost: true,
        used: |used| !used.method.is_none(),
        set: Setter::Name(|settings, name| {
            settings.shading.compensation = *Compensation::listed(name)
        }),
        ..one_of::<Compensation>(PLAIN)
    },
    Axis {
        name: "lod_bias",
        label: "Mip bias (levels)",
        part: Part::Parameter,
        about: "added to the mip level of filtered samples",
        plural: "level biases",
        symbol: Symbol::Before("bias"),
        used: |used| used.method.uses_lod_bias,
        set: Setter::Number(|settings, number| settings.shading.lod_bias = number as f32),
        ..valued(Kind::Number(LEVELS), || Value::Number(0.0), PLAIN)
    },
];

/// Names each axis that the code refers to.
macro_rules! axis_ids {
    ($($index:ident = $name:literal;)*) => { $(pub const $index: AxisId = find($name);)* };
}

axis_ids! {
    SIZE = "size";
    ENVIRONMENT = "environment";
    SCENE = "scene";
    BRDF = "brdf";
    METHOD = "method";
    DIFFUSE_METHOD = "diffuse";
    SAMPLES = "samples";
    POINT_SET = "point_set";
    ALPHA = "alpha";
    ALBEDO = "albedo";
    COAT = "coat";
    SHEEN_COLOR = "sheen_color";
    ANISOTROPY = "anisotropy";
    FRAMES = "frames";
    MOTION = "motion";
    METALLIC = "metallic";
    METALLIC_MIX = "metallic_mix";
    EXPOSURE = "exposure";
    CONTRAST = "contrast";
    ENVIRONMENT_ORIENTATION = "environment_orientation";
    ENVIRONMENT_ROTATION = "environment_rotation_deg";
    ENVIRONMENT_SCALE = "environment_scale";
    F0 = "f0";
    LIGHT_INTENSITY = "light_intensity";
    LIGHT_TURN = "light_turn_deg";
    LAYOUT = "layout";
    COMPENSATION = "compensation";
    FRESNEL = "fresnel";
    PREFILTERED = "prefiltered";
    DFG_TABLE = "dfg";
    PREFILTER_SIZE = "prefilter_size";
    PREFILTER_LEVEL_COUNT = "prefilter_level_count";
    PREFILTER_WEIGHT = "prefilter_weight";
    PREFILTER_BY = "prefilter";
    MASKING = "masking";
    DFG_SIZE = "dfg_size";
    IRRADIANCE_SIZE = "irradiance_size";
}

/// Finds an axis while the program compiles; an unknown name does not compile.
const fn find(name: &str) -> AxisId {
    let mut position = 0;
    while !is_equal(LIST[position].name.as_bytes(), name.as_bytes()) {
        position += 1;
    }
    AxisId::from_position(position)
}

const fn is_equal(a: &[u8], b: &[u8]) -> bool {
    let mut equal = 0;
    while equal < a.len() && equal < b.len() && a[equal] == b[equal] {
        equal += 1;
    }
    equal == a.len() && equal == b.len()
}
