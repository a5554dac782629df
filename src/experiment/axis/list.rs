//! The list of all axes but those of tables, which are in [`super::tables`].

use super::{Axis, Part, Sheet, Spelling, Symbol, Used};
use crate::bakes::given::{CENTRES, OWN};
use crate::brdf::{self, Compensation, MaskingShadowing};
use crate::environment::Placement;
use crate::environment::layout::MapLayout;
use crate::experiment::value::{IMAGE_SIZE, Kind, PERCEPTUAL_ROUGHNESS_MIN, Range, Value, decimal};
use crate::math::sequence::{PixelPoints, Sequence};
use crate::precompute::prefilter::level_bias::LEVEL_BIASES;
use crate::precompute::prefilter::{LevelMapping, Weight};
use crate::precompute::{PrecomputeSettings, PrefilterBy, StorageFormat};
use crate::shade::Diffuse;
use crate::shade::Method;
use crate::shade::REFERENCE;
use crate::spelling::Listed;

/// Largest sample count of a precompute pass.
const PRECOMPUTE_SAMPLES_MAX: u32 = 1 << 20;
/// Largest side of a precomputed table: every Vulkan device supports it.
const SIDE_MAX: u32 = 4096;

const LEVELS: Range = Range::closed(-16.0, 16.0);

/// Names of tables, as in [`crate::precompute::table_of`].
pub const MIPS: &str = "mips";
pub const SH9: &str = "sh9";
pub const PREFILTER: &str = "prefilter";
pub const DFG: &str = "dfg";
pub const IRRADIANCE: &str = "irradiance";

/// Defaults that the entries override.
const PLAIN: Axis = Axis {
    name: "",
    about: "",
    plural: "",
    symbol: Symbol::None,
    part: Part::Case,
    sheet: Sheet::Row,
    frames_cost: false,
    tables_cost: false,
    is_compared: false,
    needs_memory: false,
    feeds: &[],
    is_key: false,
    flag: None,
    spelling: None,
    kind: Kind::Input,
    default: || Value::Unset,
    unset: None,
    used: |_| true,
    reference: |_, value| value.clone(),
    apply: |_, _| {},
};

fn first<T: Listed + ?Sized>() -> Value {
    Value::from(T::names()[0])
}

const TABLE_FILE: Kind = Kind::NameOrFile { what: "table", names: || vec![OWN] };

const TABLE: Axis = Axis { part: Part::Table, tables_cost: true, ..PLAIN };

/// Every axis. Their order is the order of columns that an experiment does not name.
pub static AXES: &[Axis] = LIST;

const LIST: &[Axis] = &[
    Axis {
        name: "size",
        about: "width and height of the image",
        plural: "image sizes",
        sheet: Sheet::Page,
        needs_memory: true,
        is_key: true,
        kind: IMAGE_SIZE,
        default: || Value::Pair([256, 256]),
        apply: |s, v| s.size = v.pair(),
        ..PLAIN
    },
    Axis {
        name: "environment",
        about: "the light: builtin:NAME (`splitsum list environments`), or an .hdr or .exr file; FILE.exr#NAME for a layer or part of it",
        plural: "environments",
        sheet: Sheet::Page,
        needs_memory: true,
        feeds: &[MIPS, SH9, PREFILTER, IRRADIANCE],
        default: || Value::from("builtin:sky"),
        apply: |s, v| s.environment = v.text().to_owned(),
        ..PLAIN
    },
    Axis {
        name: "scene",
        about: "what is seen: a name of `splitsum list scenes`, or an .obj, .glb or .gltf file",
        plural: "scenes",
        sheet: Sheet::Page,
        frames_cost: true,
        is_key: true,
        default: || Value::from("sphere"),
        apply: |s, v| s.scene = v.text().to_owned(),
        ..PLAIN
    },
    Axis {
        name: "brdf",
        about: "microfacet model",
        plural: "BRDF models",
        sheet: Sheet::Page,
        frames_cost: true,
        tables_cost: true,
        feeds: &[PREFILTER, DFG],
        kind: Kind::one_of::<dyn brdf::Brdf>(),
        default: || Value::from("ggx"),
        apply: |s, v| s.shading.brdf = <dyn brdf::Brdf>::listed(v.text()),
        ..PLAIN
    },
    Axis {
        name: "method",
        part: Part::Method,
        about: "how the specular term is computed: `splitsum list methods`, or GLSL of yours",
        plural: "methods",
        sheet: Sheet::Column,
        frames_cost: true,
        tables_cost: true,
        is_compared: true,
        needs_memory: true,
        kind: Kind::NameOrFile { what: Method::WHAT, names: Method::names },
        default: || Value::from("sampled"),
        reference: |r, v| if r.leaves_out(v) { v.clone() } else { Value::from(r.method.as_str()) },
        apply: |s, v| s.shading.method = Method::listed(v.text()),
        ..PLAIN
    },
    Axis {
        name: "diffuse",
        part: Part::Method,
        about: "how the diffuse term is computed; `splitsum list diffuse`",
        plural: "diffuse methods",
        sheet: Sheet::Column,
        frames_cost: true,
        tables_cost: true,
        needs_memory: true,
        kind: Kind::one_of::<Diffuse>(),
        default: || Value::from("sh9"),
        used: |u| u.has_diffuse_surface,
        reference: |r, v| if r.leaves_out(v) { v.clone() } else { Value::from(REFERENCE) },
        apply: |s, v| s.shading.diffuse = Diffuse::listed(v.text()),
        ..PLAIN
    },
    Axis {
        name: "samples",
        part: Part::Count,
        about: "samples a pixel, for methods that draw some",
        plural: "sample counts",
        symbol: Symbol::After("samples", "samples"),
        sheet: Sheet::Column,
        frames_cost: true,
        is_compared: true,
        kind: Kind::Count { min: 1, max: 1 << 24 },
        default: || Value::Count(40),
        used: |u| u.method.uses_samples,
        reference: |r, _| Value::Count(r.samples),
        apply: |s, v| s.shading.samples = v.count(),
        ..PLAIN
    },
    Axis {
        name: "sequence",
        part: Part::Parameter,
        about: "where a sampled method takes its points from; `splitsum list sequences`",
        plural: "sequences",
        kind: Kind::one_of::<Sequence>(),
        default: first::<Sequence>,
        used: |u| u.method.uses_point_set,
        apply: |s, v| s.shading.sequence = Sequence::listed(v.text()),
        ..PLAIN
    },
    Axis {
        name: "point_set",
        part: Part::Luck,
        about: "set of the sequence: 0 the plain one, k > 0 randomised copies",
        plural: "point sets",
        symbol: Symbol::Before("set"),
        kind: Kind::Count { min: 0, max: 1 << 20 },
        default: || Value::Count(0),
        used: |u| u.method.uses_point_set,
        apply: |s, v| s.shading.point_set = v.count(),
        ..PLAIN
    },
    Axis {
        name: "pixel_points",
        part: Part::Parameter,
        about: "how a pixel comes by the points of a set: shared has the same for all pixels, owen scrambles them for each by hash",
        plural: "ways to points of pixels",
        symbol: Symbol::After("points", "points"),
        frames_cost: true,
        is_compared: true,
        kind: Kind::one_of::<PixelPoints>(),
        default: first::<PixelPoints>,
        used: |u| u.method.uses_point_set,
        apply: |s, v| s.shading.pixel_points = *PixelPoints::listed(v.text()),
        ..PLAIN
    },
    Axis {
        name: "alpha",
        about: "microfacet width of every material",
        plural: "alphas",
        symbol: Symbol::Before("alpha"),
        kind: Kind::Alpha,
        spelling: Some(Spelling {
            name: "perceptual_roughness",
            about: "roughness of every material as files store it; alpha is its square",
            plural: "roughnesses",
            symbol: Symbol::Before("roughness"),
            kind: Kind::Number(Range::closed(PERCEPTUAL_ROUGHNESS_MIN, 1.0)),
            to_axis: |v| Value::Number(decimal(brdf::alpha_from_perceptual_roughness(v.number()))),
            of_axis: Some(|v| Value::Number(decimal(brdf::perceptual_roughness_from_alpha(v.number())))),
        }),
        apply: |s, v| s.material.alpha = Some(v.number() as f32),
        ..PLAIN
    },
    Axis {
        name: "f0",
        about: "reflectance at normal incidence of every dielectric",
        plural: "values of F0",
        symbol: Symbol::Before("F0"),
        used: |u| u.has_dielectric,
        kind: Kind::Color(Range::closed(0.0, 1.0)),
        spelling: Some(Spelling {
            name: "ior",
            about: "index of refraction of every dielectric; it gives f0",
            plural: "indices of refraction",
            symbol: Symbol::Before("ior"),
            kind: Kind::Number(Range::closed(1.0, 10.0)),
            to_axis: |v| Value::Color([brdf::f0_from_ior(v.number()) as f32; 3]),
            of_axis: None,
        }),
        apply: |s, v| s.material.f0 = Some(v.color()),
        ..PLAIN
    },
    Axis {
        name: "albedo",
        about: "albedo of every material",
        plural: "albedos",
        symbol: Symbol::Before("albedo"),
        kind: Kind::Color(Range::closed(0.0, 1.0)),
        apply: |s, v| s.material.albedo = Some(v.color()),
        ..PLAIN
    },
    Axis {
        name: "metallic",
        about: "0 dielectric, 1 metal",
        plural: "values of metallic",
        symbol: Symbol::Before("metallic"),
        kind: Kind::Number(Range::closed(0.0, 1.0)),
        apply: |s, v| s.material.metallic = Some(v.number() as f32),
        ..PLAIN
    },
    Axis {
        name: "exposure",
        part: Part::Display,
        about: "factor before the tone curve",
        plural: "exposures",
        symbol: Symbol::Before("exposure"),
        kind: Kind::Number(Range::above(0.0, 1e9)),
        default: || Value::Number(1.0),
        apply: |s, v| s.curve.exposure = v.number() as f32,
        ..PLAIN
    },
    Axis {
        name: "contrast",
        part: Part::Display,
        about: "exponent of the tone curve, times 2.2",
        plural: "contrasts",
        symbol: Symbol::Before("contrast"),
        kind: Kind::Number(Range::above(0.0, 100.0)),
        default: || Value::Number(1.0),
        apply: |s, v| s.curve.contrast = v.number() as f32,
        ..PLAIN
    },
    Axis {
        name: "environment_orientation",
        about: "turns the map before environment_rotation_deg does: 0 leaves it as the file has it, k > 0 is the k-th of a fixed set of \
                rotations that fills SO(3) evenly",
        plural: "orientations",
        symbol: Symbol::Before("orientation"),
        flag: Some("orientation"),
        kind: Kind::Count { min: 0, max: Placement::ORIENTATION_MAX },
        default: || Value::Count(0),
        apply: |s, v| s.shading.placement.orientation = v.count(),
        ..PLAIN
    },
    Axis {
        name: "environment_rotation_deg",
        about: "turns the environment about +y in the world, after environment_orientation",
        plural: "rotations",
        symbol: Symbol::After("deg", "degrees"),
        flag: Some("rotate"),
        kind: Kind::Number(Range::closed(-360.0, 360.0)),
        default: || Value::Number(0.0),
        apply: |s, v| s.shading.placement.rotation_deg = v.number(),
        ..PLAIN
    },
    Axis {
        name: "environment_scale",
        about: "multiplies the environment's radiance",
        plural: "radiance scales",
        symbol: Symbol::Before("scale"),
        flag: Some("scale"),
        kind: Kind::Number(Range::above(0.0, 1e9)),
        default: || Value::Number(1.0),
        apply: |s, v| s.shading.environment_scale = v.number() as f32,
        ..PLAIN
    },
    Axis {
        name: "environment_clip_log2",
        about: "cuts the environment's radiance off at 2 to this power, for the reference too: less dynamic range",
        plural: "clips",
        symbol: Symbol::Before("clip 2^"),
        feeds: &[MIPS, SH9, PREFILTER, IRRADIANCE],
        kind: Kind::Number(Range::closed(-30.0, 60.0)),
        apply: |s, v| s.environment_clip_log2 = Some(v.number()),
        ..PLAIN
    },
    Axis {
        name: "masking",
        about: "masking-shadowing, of the image and of its reference",
        plural: "masking-shadowing functions",
        frames_cost: true,
        tables_cost: true,
        feeds: &[PREFILTER, DFG],
        kind: Kind::one_of::<MaskingShadowing>(),
        default: || Value::from("separable"),
        apply: |s, v| s.shading.masking_shadowing = *MaskingShadowing::listed(v.text()),
        ..PLAIN
    },
    Axis {
        name: "compensation",
        about: "what gives back the light that facets reflect to each other, in the image and in its reference; the part of fdez-aguera and \
                kulla-conty comes with the diffuse term",
        plural: "compensations",
        frames_cost: true,
        used: |u| !u.method.is_none(),
        kind: Kind::one_of::<Compensation>(),
        default: first::<Compensation>,
        apply: |s, v| s.shading.compensation = *Compensation::listed(v.text()),
        ..PLAIN
    },
    Axis {
        name: "lod_bias",
        part: Part::Parameter,
        about: "added to the mip level of filtered samples",
        plural: "level biases",
        symbol: Symbol::Before("bias"),
        used: |u| u.method.uses_lod_bias,
        kind: Kind::Number(LEVELS),
        default: || Value::Number(0.0),
        apply: |s, v| s.shading.lod_bias = v.number() as f32,
        ..PLAIN
    },
    Axis {
        name: "layout",
        about: "how the maps that are looked up filtered lie in texels; `splitsum list layouts`",
        plural: "layouts",
        frames_cost: true,
        is_compared: true,
        needs_memory: true,
        feeds: &[MIPS, PREFILTER, IRRADIANCE],
        used: |u| u.method.uses_lod_bias || u.method.uses_prefiltered() || u.uses_irradiance_map(),
        kind: Kind::one_of::<MapLayout>(),
        default: first::<MapLayout>,
        apply: |s, v| s.shading.precompute.layout = MapLayout::listed(v.text()),
        ..TABLE
    },
    Axis {
        name: "prefiltered",
        about: "the prefiltered map: own, or that of another tool as file:PATH#PRESET, a cube (docs/bakes.md)",
        plural: "prefiltered maps",
        symbol: Symbol::Before("map"),
        needs_memory: true,
        feeds: &[PREFILTER],
        kind: TABLE_FILE,
        used: |u| u.method.uses_prefiltered(),
        default: || Value::from(OWN),
        apply: |s, v| s.prefiltered = v.text().to_owned(),
        ..TABLE
    },
    Axis {
        name: "dfg",
        about: "the DFG table: own; centres, ours laid out as engines do; or that of another tool as file:PATH#PRESET, square (docs/bakes.md)",
        plural: "DFG tables",
        symbol: Symbol::Before("table"),
        needs_memory: true,
        feeds: &[DFG],
        kind: Kind::NameOrFile { what: "table", names: || vec![OWN, CENTRES] },
        used: Used::needs_dfg,
        default: || Value::from(OWN),
        apply: |s, v| s.dfg = v.text().to_owned(),
        ..TABLE
    },
    Axis {
        name: "prefilter_size",
        about: "width and height of a face of the prefiltered map's first level; left out, it has about 100,000 texels in all: \
                128x128 by layout cube, 320x320 by octahedral, 448x224 by equirect",
        plural: "prefilter sizes",
        needs_memory: true,
        feeds: &[PREFILTER],
        used: Used::makes_prefiltered,
        kind: Kind::Pair { min: 8, max: SIDE_MAX },
        unset: Some(|layout| Value::Pair(layout.prefilter_size)),
        apply: |s, v| s.shading.precompute.prefilter_size = v.pair(),
        ..TABLE
    },
    Axis {
        name: "prefilter_level_count",
        about: "levels of the prefiltered map",
        plural: "level counts",
        symbol: Symbol::After("lv", "levels"),
        feeds: &[PREFILTER],
        used: |u| u.makes_prefiltered() || u.method.uses_levels,
        kind: Kind::Count { min: 2, max: 11 },
        default: || Value::Count(PrecomputeSettings::default().prefilter_level_count),
        apply: |s, v| s.shading.precompute.prefilter_level_count = v.count(),
        ..TABLE
    },
    Axis {
        name: "prefilter",
        about: "how the prefiltered map and the irradiance map are made: by convolution in spherical harmonics, without noise, or by \
                samples on the device",
        plural: "ways to prefilter",
        symbol: Symbol::After("prefilter", "prefilter"),
        feeds: &[PREFILTER, IRRADIANCE],
        used: |u| u.method.prefilter.is_none() && (u.makes_prefiltered() || u.uses_irradiance_map()),
        kind: Kind::one_of::<PrefilterBy>(),
        default: first::<PrefilterBy>,
        apply: |s, v| s.shading.precompute.prefilter = *PrefilterBy::listed(v.text()),
        ..TABLE
    },
    Axis {
        name: "prefilter_sample_count",
        about: "samples a texel of the prefiltered map, where prefilter is sampled",
        plural: "prefilter sample counts",
        symbol: Symbol::After("spp", "samples"),
        feeds: &[PREFILTER],
        used: |u| u.makes_prefiltered() && u.has_sampled_tables,
        kind: Kind::Count { min: 1, max: PRECOMPUTE_SAMPLES_MAX },
        default: || Value::Count(PrecomputeSettings::default().prefilter_sample_count),
        apply: |s, v| s.shading.precompute.prefilter_sample_count = v.count(),
        ..TABLE
    },
    Axis {
        name: "level_mapping",
        about: "which perceptual roughness each level of the prefiltered map holds; `splitsum list level-mappings`",
        plural: "level mappings",
        symbol: Symbol::After("mapping", "mapping"),
        feeds: &[PREFILTER],
        used: |u| u.makes_prefiltered() || u.method.uses_levels,
        kind: Kind::one_of::<LevelMapping>(),
        default: first::<LevelMapping>,
        apply: |s, v| {
            s.shading.precompute.level_mapping = LevelMapping::listed(v.text());
        },
        ..TABLE
    },
    Axis {
        name: "prefilter_weight",
        part: Part::Parameter,
        about: "what a direction counts in the mean that a prefiltered texel is; `splitsum list prefilter-weights`",
        plural: "prefilter weights",
        symbol: Symbol::Before("weight"),
        feeds: &[PREFILTER],
        used: |u| u.makes_prefiltered() || u.method.uses_weight,
        kind: Kind::one_of::<Weight>(),
        default: first::<Weight>,
        apply: |s, v| {
            s.shading.precompute.prefilter_weight = Weight::listed(v.text());
        },
        ..TABLE
    },
    Axis {
        name: "prefilter_lod_bias",
        about: "added to the mip level of each lookup that makes a sampled prefiltered map; names are those of `splitsum list level-biases`",
        plural: "prefilter level biases",
        symbol: Symbol::Before("prefilter bias"),
        feeds: &[PREFILTER],
        used: |u| u.makes_prefiltered() && u.has_sampled_tables,
        kind: Kind::NumberOrName {
            range: LEVELS,
            what: "level bias",
            named: || LEVEL_BIASES.iter().map(|bias| (bias.name, bias.levels)).collect(),
        },
        default: || Value::Number(0.0),
        apply: |s, v| s.shading.precompute.prefilter_lod_bias = v.number() as f32,
        ..TABLE
    },
    Axis {
        name: "dfg_size",
        about: "side of the DFG table",
        plural: "DFG sizes",
        symbol: Symbol::Before("DFG"),
        needs_memory: true,
        feeds: &[DFG],
        used: Used::makes_dfg,
        kind: Kind::Count { min: 2, max: SIDE_MAX },
        default: || Value::Count(PrecomputeSettings::default().dfg_size),
        apply: |s, v| s.shading.precompute.dfg_size = v.count(),
        ..TABLE
    },
    Axis {
        name: "dfg_sample_count",
        about: "samples a texel of the DFG table",
        plural: "DFG sample counts",
        symbol: Symbol::After("DFG spp", "DFG samples"),
        feeds: &[DFG],
        used: Used::makes_dfg,
        kind: Kind::Count { min: 1, max: PRECOMPUTE_SAMPLES_MAX },
        default: || Value::Count(PrecomputeSettings::default().dfg_sample_count),
        apply: |s, v| s.shading.precompute.dfg_sample_count = v.count(),
        ..TABLE
    },
    Axis {
        name: "irradiance_size",
        about: "width and height of a face of the irradiance map; left out, it has about 2,000 texels in all: 18x18 by layout \
                cube, 45x45 by octahedral, 64x32 by equirect",
        plural: "irradiance map sizes",
        symbol: Symbol::Before("irradiance"),
        needs_memory: true,
        feeds: &[IRRADIANCE],
        used: Used::uses_irradiance_map,
        kind: Kind::Pair { min: 2, max: SIDE_MAX },
        unset: Some(|layout| Value::Pair(layout.irradiance_size)),
        apply: |s, v| s.shading.precompute.irradiance_size = v.pair(),
        ..TABLE
    },
    Axis {
        name: "irradiance_sample_count",
        about: "azimuth and polar samples a texel of the irradiance map, where prefilter is sampled",
        plural: "irradiance sample counts",
        symbol: Symbol::After("irradiance spp", "irradiance samples"),
        feeds: &[IRRADIANCE],
        used: |u| u.uses_irradiance_map() && u.has_sampled_tables,
        kind: Kind::Pair { min: 1, max: SIDE_MAX },
        default: || Value::Pair(PrecomputeSettings::default().irradiance_sample_count),
        apply: |s, v| s.shading.precompute.irradiance_sample_count = v.pair(),
        ..TABLE
    },
    Axis {
        name: "storage_format",
        about: "numbers of the prefiltered map, the DFG table and the irradiance map on the device; f16 ends at 65504",
        plural: "storage formats",
        frames_cost: true,
        is_compared: true,
        feeds: &[PREFILTER, DFG, IRRADIANCE],
        used: |u| {
            u.method.storage.is_none() && (u.method.uses_prefiltered() || u.needs_dfg() || u.uses_irradiance_map())
        },
        kind: Kind::one_of::<StorageFormat>(),
        default: first::<StorageFormat>,
        apply: |s, v| s.shading.precompute.storage = *StorageFormat::listed(v.text()),
        ..TABLE
    },
];

/// Defines an index into [`AXES`] for each axis that the code refers to.
macro_rules! indices {
    ($($index:ident = $name:literal;)*) => { $(pub const $index: usize = index($name);)* };
}

indices! {
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
    METALLIC = "metallic";
    EXPOSURE = "exposure";
    CONTRAST = "contrast";
    ENVIRONMENT_CLIP = "environment_clip_log2";
    ENVIRONMENT_ORIENTATION = "environment_orientation";
    ENVIRONMENT_ROTATION = "environment_rotation_deg";
    ENVIRONMENT_SCALE = "environment_scale";
    F0 = "f0";
    LAYOUT = "layout";
    COMPENSATION = "compensation";
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

/// Finds the index of a name at compile time.
const fn index(name: &str) -> usize {
    let mut at = 0;
    while !is_equal(LIST[at].name.as_bytes(), name.as_bytes()) {
        at += 1;
    }
    at
}

const fn is_equal(a: &[u8], b: &[u8]) -> bool {
    let mut at = 0;
    while at < a.len() && at < b.len() && a[at] == b[at] {
        at += 1;
    }
    at == a.len() && at == b.len()
}
