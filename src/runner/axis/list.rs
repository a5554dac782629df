//! The list of all axes.

use super::{Axis, Part, REFERENCE, Used, diffuse, method};
use crate::brdf::{self, MaskingShadowing};
use crate::math::sequence::{SEQUENCES, sequence_by_name};
use crate::precompute::{PrecomputeSettings, StorageFormat};
use crate::runner::value::{IMAGE_SIZE, Kind, Range, Value};
use crate::shade::level_bias::LEVEL_BIASES;
use crate::shade::{DIFFUSE, METHODS};

/// Sample counts of precompute passes stop here: more only costs time.
const PRECOMPUTE_SAMPLES_MAX: u32 = 1 << 20;
/// Sides of precomputed tables stop at the size every Vulkan device supports.
const SIDE_MAX: u32 = 4096;

/// What most axes share; entries override what differs.
const PLAIN: Axis = Axis {
    name: "",
    plural: "",
    said: ["", ""],
    about: "",
    part: Part::Case,
    kind: Kind::Input,
    default: || Value::Unset,
    used: |_| true,
    reference: |_, value| value.clone(),
    apply: |_, _| {},
};

/// Every axis, in the order of the columns that an experiment does not name itself.
pub static AXES: &[Axis] = &[
    Axis {
        name: "size",
        plural: "sizes",
        about: "width and height of the image; also a key of the file beside [axes]",
        kind: IMAGE_SIZE,
        default: || Value::Pair([256, 256]),
        apply: |s, v| s.size = v.pair(),
        ..PLAIN
    },
    Axis {
        name: "environment",
        plural: "environments",
        about: "the light: a builtin formula or an .hdr or .exr file (FILE.exr#NAME: a layer or part of it)",
        default: || Value::Text("builtin:sky".to_owned()),
        apply: |s, v| s.environment = v.text().to_owned(),
        ..PLAIN
    },
    Axis {
        name: "scene",
        plural: "scenes",
        about: "sphere, spheres, plane or an .obj file",
        default: || Value::Text("sphere".to_owned()),
        apply: |s, v| s.scene = v.text().to_owned(),
        ..PLAIN
    },
    Axis {
        name: "brdf",
        plural: "BRDF models",
        about: "microfacet model",
        kind: Kind::Name { what: "BRDF model", names: || brdf::MODELS.iter().map(|m| m.name()).collect() },
        default: || Value::Text("ggx".to_owned()),
        apply: |s, v| s.brdf = brdf::by_name(v.text()).expect("the plan checked the model's name"),
        ..PLAIN
    },
    Axis {
        name: "method",
        plural: "methods",
        part: Part::Method,
        about: "how the specular term is computed",
        kind: Kind::Name { what: "method", names: || METHODS.iter().map(|m| m.name).collect() },
        default: || Value::Text("sampled".to_owned()),
        reference: |r, v| if r.leaves_out(v) { v.clone() } else { Value::Text(r.method.clone()) },
        apply: |s, v| s.method = method(v.text()),
        ..PLAIN
    },
    Axis {
        name: "diffuse",
        plural: "diffuse methods",
        part: Part::Method,
        about: "how the diffuse term is computed",
        kind: Kind::Name { what: "diffuse method", names: || DIFFUSE.iter().map(|d| d.name).collect() },
        default: || Value::Text("sh9".to_owned()),
        used: |u| u.has_diffuse_surface,
        reference: |r, v| if r.leaves_out(v) { v.clone() } else { Value::Text(REFERENCE.to_owned()) },
        apply: |s, v| s.diffuse = diffuse(v.text()),
        ..PLAIN
    },
    Axis {
        name: "samples",
        plural: "sample counts",
        part: Part::Count,
        about: "samples a pixel; methods that draw none have one cell, with an empty field",
        kind: Kind::Count { min: 1, max: 1 << 24 },
        default: || Value::Count(40),
        used: |u| u.method.uses_samples,
        reference: |r, _| Value::Count(r.samples),
        apply: |s, v| s.samples = v.count(),
        ..PLAIN
    },
    Axis {
        name: "sequence",
        plural: "sequences",
        part: Part::Parameter,
        about: "where a sampled method takes its points from; `splitsum list sequences`",
        kind: Kind::Name { what: "sequence", names: || SEQUENCES.iter().map(|s| s.name).collect() },
        default: || Value::Text(SEQUENCES[0].name.to_owned()),
        used: |u| u.method.uses_point_set,
        apply: |s, v| s.sequence = sequence_by_name(v.text()).expect("the plan checked the sequence's name"),
        ..PLAIN
    },
    Axis {
        name: "point_set",
        plural: "point sets",
        part: Part::Luck,
        about: "set of the sequence: 0 the plain one, k > 0 randomised copies",
        kind: Kind::Count { min: 0, max: 1 << 20 },
        default: || Value::Count(0),
        used: |u| u.method.uses_point_set,
        apply: |s, v| s.point_set = v.count(),
        ..PLAIN
    },
    Axis {
        name: "alpha",
        plural: "alphas",
        about: "microfacet width of every material",
        kind: Kind::Alpha,
        apply: |s, v| s.material.alpha = Some(v.number() as f32),
        ..PLAIN
    },
    Axis {
        name: "f0",
        plural: "values of f0",
        about: "reflectance at normal incidence of every dielectric",
        used: |u| u.has_dielectric,
        kind: Kind::Color(Range::closed(0.0, 1.0)),
        apply: |s, v| s.material.f0 = Some(v.color()),
        ..PLAIN
    },
    Axis {
        name: "albedo",
        plural: "albedos",
        about: "albedo of every material",
        kind: Kind::Color(Range::closed(0.0, 1.0)),
        apply: |s, v| s.material.albedo = Some(v.color()),
        ..PLAIN
    },
    Axis {
        name: "metallic",
        plural: "values of metallic",
        about: "0 dielectric, 1 metal",
        kind: Kind::Number(Range::closed(0.0, 1.0)),
        apply: |s, v| s.material.metallic = Some(v.number() as f32),
        ..PLAIN
    },
    Axis {
        name: "exposure",
        plural: "exposures",
        part: Part::Display,
        about: "factor before the tone curve",
        kind: Kind::Number(Range::above(0.0, 1e9)),
        default: || Value::Number(1.0),
        apply: |s, v| s.curve.exposure = v.number() as f32,
        ..PLAIN
    },
    Axis {
        name: "contrast",
        plural: "contrasts",
        part: Part::Display,
        about: "exponent of the tone curve times 2.2",
        kind: Kind::Number(Range::above(0.0, 100.0)),
        default: || Value::Number(1.0),
        apply: |s, v| s.curve.contrast = v.number() as f32,
        ..PLAIN
    },
    Axis {
        name: "environment_rotation_deg",
        plural: "rotations",
        about: "turns the environment about +y",
        kind: Kind::Number(Range::closed(-360.0, 360.0)),
        default: || Value::Number(0.0),
        apply: |s, v| s.environment_rotation_deg = v.number(),
        ..PLAIN
    },
    Axis {
        name: "environment_scale",
        plural: "scales",
        about: "multiplies the environment's radiance",
        kind: Kind::Number(Range::above(0.0, 1e9)),
        default: || Value::Number(1.0),
        apply: |s, v| s.environment_scale = v.number() as f32,
        ..PLAIN
    },
    Axis {
        name: "environment_clip_log2",
        plural: "clips",
        about: "cuts the environment's radiance off at 2 to this power, for the reference too: less dynamic range",
        kind: Kind::Number(Range::closed(-30.0, 60.0)),
        apply: |s, v| s.environment_clip_log2 = Some(v.number()),
        ..PLAIN
    },
    Axis {
        name: "masking",
        plural: "maskings",
        about: "masking-shadowing; the same in a cell and its reference",
        kind: Kind::Name {
            what: "masking-shadowing",
            names: || MaskingShadowing::ALL.iter().map(|(name, _)| *name).collect(),
        },
        default: || Value::Text("separable".to_owned()),
        apply: |s, v| {
            let named = MaskingShadowing::ALL.iter().find(|(name, _)| *name == v.text());
            s.masking_shadowing = named.expect("the plan checked the masking's name").1;
        },
        ..PLAIN
    },
    Axis {
        name: "lod_bias",
        plural: "level biases",
        part: Part::Parameter,
        about: "added to the mip level of filtered samples; names are those of `splitsum list level-biases`",
        used: |u| u.method.uses_lod_bias,
        kind: Kind::NumberOrName {
            range: Range::closed(-16.0, 16.0),
            what: "level bias",
            named: || LEVEL_BIASES.iter().map(|bias| (bias.name, bias.levels)).collect(),
        },
        default: || Value::Number(0.0),
        reference: |_, _| Value::Number(0.0),
        apply: |s, v| s.lod_bias = v.number() as f32,
        ..PLAIN
    },
    Axis {
        name: "prefilter_size",
        plural: "prefilter sizes",
        said: ["{}", "{}"],
        part: Part::Table,
        about: "width and height of the prefiltered map's first level",
        used: |u| u.method.uses_prefiltered,
        kind: Kind::Pair { min: 8, max: SIDE_MAX },
        default: || Value::Pair(PrecomputeSettings::default().prefilter_size),
        reference: |_, _| Value::Pair(PrecomputeSettings::default().prefilter_size),
        apply: |s, v| s.precompute.prefilter_size = v.pair(),
        ..PLAIN
    },
    Axis {
        name: "prefilter_level_count",
        plural: "level counts",
        said: ["{} levels", "{} lv"],
        part: Part::Table,
        about: "levels of the prefiltered map",
        used: |u| u.method.uses_prefiltered,
        kind: Kind::Count { min: 2, max: 12 },
        default: || Value::Count(PrecomputeSettings::default().prefilter_level_count),
        reference: |_, _| Value::Count(PrecomputeSettings::default().prefilter_level_count),
        apply: |s, v| s.precompute.prefilter_level_count = v.count(),
        ..PLAIN
    },
    Axis {
        name: "prefilter_sample_count",
        plural: "prefilter sample counts",
        said: ["{} samples", "{} spp"],
        part: Part::Table,
        about: "samples a texel of the prefiltered map",
        used: |u| u.method.uses_prefiltered,
        kind: Kind::Count { min: 1, max: PRECOMPUTE_SAMPLES_MAX },
        default: || Value::Count(PrecomputeSettings::default().prefilter_sample_count),
        reference: |_, _| Value::Count(PrecomputeSettings::default().prefilter_sample_count),
        apply: |s, v| s.precompute.prefilter_sample_count = v.count(),
        ..PLAIN
    },
    Axis {
        name: "dfg_size",
        plural: "DFG sizes",
        said: ["DFG {}", "DFG {}"],
        part: Part::Table,
        about: "side of the DFG table",
        used: Used::needs_dfg,
        kind: Kind::Count { min: 2, max: SIDE_MAX },
        default: || Value::Count(PrecomputeSettings::default().dfg_size),
        reference: |_, _| Value::Count(PrecomputeSettings::default().dfg_size),
        apply: |s, v| s.precompute.dfg_size = v.count(),
        ..PLAIN
    },
    Axis {
        name: "dfg_sample_count",
        plural: "DFG sample counts",
        said: ["{} DFG samples", "DFG {} spp"],
        part: Part::Table,
        about: "samples a texel of the DFG table",
        used: Used::needs_dfg,
        kind: Kind::Count { min: 1, max: PRECOMPUTE_SAMPLES_MAX },
        default: || Value::Count(PrecomputeSettings::default().dfg_sample_count),
        reference: |_, _| Value::Count(PrecomputeSettings::default().dfg_sample_count),
        apply: |s, v| s.precompute.dfg_sample_count = v.count(),
        ..PLAIN
    },
    Axis {
        name: "irradiance_size",
        plural: "irradiance sizes",
        said: ["{}", "{}"],
        part: Part::Table,
        about: "width and height of the irradiance map",
        used: |u| u.has_diffuse_surface && u.diffuse.uses_irradiance_map,
        kind: Kind::Pair { min: 2, max: SIDE_MAX },
        default: || Value::Pair(PrecomputeSettings::default().irradiance_size),
        reference: |_, _| Value::Pair(PrecomputeSettings::default().irradiance_size),
        apply: |s, v| s.precompute.irradiance_size = v.pair(),
        ..PLAIN
    },
    Axis {
        name: "irradiance_sample_count",
        plural: "irradiance sample counts",
        said: ["{} samples", "{} spp"],
        part: Part::Table,
        about: "azimuth and polar samples a texel of the irradiance map",
        used: |u| u.has_diffuse_surface && u.diffuse.uses_irradiance_map,
        kind: Kind::Pair { min: 1, max: SIDE_MAX },
        default: || Value::Pair(PrecomputeSettings::default().irradiance_sample_count),
        reference: |_, _| Value::Pair(PrecomputeSettings::default().irradiance_sample_count),
        apply: |s, v| s.precompute.irradiance_sample_count = v.pair(),
        ..PLAIN
    },
    Axis {
        name: "storage_format",
        plural: "storage formats",
        said: ["{}", "{}"],
        part: Part::Table,
        about: "numbers of the prefiltered map, the DFG table and the irradiance map on the device; f16 ends at 65504",
        used: |u| {
            let has_irradiance_map = u.has_diffuse_surface && u.diffuse.uses_irradiance_map;
            u.method.uses_prefiltered || u.needs_dfg() || has_irradiance_map
        },
        kind: Kind::Name { what: "format", names: || StorageFormat::ALL.iter().map(|(name, _)| *name).collect() },
        default: || Value::Text(StorageFormat::ALL[0].0.to_owned()),
        reference: |_, _| Value::Text(StorageFormat::ALL[0].0.to_owned()),
        apply: |s, v| {
            let named = StorageFormat::ALL.iter().find(|(name, _)| *name == v.text());
            s.precompute.storage = named.expect("the plan checked the format's name").1;
        },
        ..PLAIN
    },
];
