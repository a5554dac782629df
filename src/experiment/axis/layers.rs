//! The axes of anisotropy, of layers over the base and of direct lights. Cells without them keep
//! their ids.

use super::plain::{ALPHA_KIND, PLAIN, ROUGHNESS, first, one_of, valued};
use super::tables::PrecomputedTable;
use super::{Axis, Layer, Part, Setter, Spelling, Symbol};
use crate::base::names::Listed;
use crate::experiment::value::{Kind, Range, Value};
use crate::instrument::brdf::{Fresnel, SHEEN_ALPHA_MIN, SheenVisibility, WidthLaw};
use crate::instrument::shade::bend::Bend;
use crate::instrument::shade::coat::{CoatLayering, CoatRenderer};
use crate::instrument::shade::metallic::MetallicMix;
use crate::instrument::shade::occlusion::SpecularOcclusion;
use crate::instrument::shade::sheen::SheenLookup;

pub(super) const LAYER: Axis = Axis {
    is_layer: true,
    ..PLAIN
};

pub(super) const LAYER_AXES: &[Axis] = &[
    Axis {
        name: "anisotropy",
        about: "strength of the anisotropy of every material, by anisotropy_widths; 0 has one \
                width",
        plural: "anisotropies",
        symbol: Symbol::Before("anisotropy"),
        kind: Kind::Number(Range::closed(0.0, 1.0)),
        set: Setter::Number(|settings, number| settings.material.anisotropy = Some(number as f32)),
        ..LAYER
    },
    Axis {
        name: "anisotropy_rotation_deg",
        layer: Some(Layer::Anisotropy),
        label: "Tangent turn (°)",
        about: "turns the direction of the larger width from the tangent, counter-clockwise about \
                the normal",
        plural: "turns of the tangent",
        symbol: Symbol::After("deg", "degrees"),
        used: |used| used.has_anisotropy,
        kind: Kind::Number(Range::closed(-360.0, 360.0)),
        set: Setter::Number(|settings, number| {
            settings.material.anisotropy_turn = Some(number.to_radians() as f32)
        }),
        ..LAYER
    },
    Axis {
        name: "anisotropy_widths",
        layer: Some(Layer::Anisotropy),
        about: "law that turns alpha and the strength into two widths; docs/estimators.md",
        plural: "laws of widths",
        used: |used| used.has_anisotropy,
        set: Setter::Name(|settings, name| settings.shading.widths = *WidthLaw::listed(name)),
        ..one_of::<WidthLaw>(LAYER)
    },
    Axis {
        name: "bend",
        part: Part::Parameter,
        frames_cost: true,
        is_compared: true,
        about: "engine whose anisotropic lookup split-sum-bent uses; `splitsum list bends`",
        used: |used| used.method.uses_bend,
        reference: |_, _| first::<Bend>(),
        set: Setter::Name(|settings, name| settings.shading.bend = Bend::listed(name)),
        ..one_of::<Bend>(LAYER)
    },
    Axis {
        name: "coat",
        about: "weight of a clear coat on every material; 0 has none",
        plural: "coat weights",
        symbol: Symbol::Before("coat"),
        kind: Kind::Number(Range::closed(0.0, 1.0)),
        set: Setter::Number(|settings, number| settings.material.coat = Some(number as f32)),
        ..LAYER
    },
    Axis {
        name: "coat_alpha",
        layer: Some(Layer::Coat),
        about: "microfacet width of every coat",
        symbol: Symbol::Before("coat alpha"),
        used: |used| used.has_coat,
        kind: ALPHA_KIND,
        spelling: Some(Spelling {
            name: "coat_perceptual_roughness",
            label: "Coat roughness",
            about: "roughness of every coat, as in files; coat_alpha is its square",
            plural: "coat roughnesses",
            symbol: Symbol::Before("coat roughness"),
            ..ROUGHNESS
        }),
        set: Setter::Number(|settings, number| settings.material.coat_alpha = Some(number as f32)),
        ..LAYER
    },
    Axis {
        name: "coat_layering",
        layer: Some(Layer::Coat),
        about: "how base and coat add up, for the image and its reference; docs/coat.md",
        used: |used| used.has_coat,
        set: Setter::Name(|settings, name| {
            settings.shading.coat_layering = *CoatLayering::listed(name)
        }),
        ..one_of::<CoatLayering>(LAYER)
    },
    Axis {
        name: "coat_renderer",
        layer: Some(Layer::Coat),
        part: Part::Parameter,
        about: "whose way to shade a coat; `splitsum list coat-renderers`",
        used: |used| used.has_coat && !used.method.is_integrated(),
        reference: |_, _| first::<CoatRenderer>(),
        set: Setter::Name(|settings, name| {
            settings.shading.coat_renderer = CoatRenderer::listed(name)
        }),
        ..one_of::<CoatRenderer>(LAYER)
    },
    Axis {
        name: "sheen_color",
        about: "colour of a sheen of cloth on every material; 0 has none",
        symbol: Symbol::Before("sheen"),
        kind: Kind::Color(Range::closed(0.0, 1.0)),
        set: Setter::Color(|settings, color| settings.material.sheen_color = Some(color)),
        ..LAYER
    },
    Axis {
        name: "sheen_alpha",
        layer: Some(Layer::Sheen),
        about: "microfacet width of every sheen",
        symbol: Symbol::Before("sheen alpha"),
        used: |used| used.has_sheen,
        kind: Kind::Number(Range::closed(SHEEN_ALPHA_MIN, 1.0)),
        spelling: Some(Spelling {
            name: "sheen_perceptual_roughness",
            label: "Sheen roughness",
            about: "roughness of every sheen, as in files; sheen_alpha is its square",
            plural: "sheen roughnesses",
            symbol: Symbol::Before("sheen roughness"),
            kind: Kind::Number(Range::closed(0.1, 1.0)),
            ..ROUGHNESS
        }),
        set: Setter::Number(|settings, number| settings.material.sheen_alpha = Some(number as f32)),
        ..LAYER
    },
    Axis {
        name: "sheen_visibility",
        layer: Some(Layer::Sheen),
        about: "visibility of the sheen lobe, for the image and its reference; docs/sheen.md",
        plural: "sheen visibilities",
        used: |used| used.has_sheen,
        set: Setter::Name(|settings, name| {
            settings.shading.sheen_visibility = *SheenVisibility::listed(name)
        }),
        ..one_of::<SheenVisibility>(LAYER)
    },
    Axis {
        name: "sheen_lookup",
        layer: Some(Layer::Sheen),
        part: Part::Parameter,
        about: "whose way to look up sheen; `splitsum list sheen-lookups`",
        used: |used| used.has_sheen && used.method.has_pass(),
        reference: |_, _| first::<SheenLookup>(),
        set: Setter::Name(|settings, name| {
            settings.shading.sheen_lookup = SheenLookup::listed(name)
        }),
        ..one_of::<SheenLookup>(LAYER)
    },
    Axis {
        name: "fresnel",
        about: "Fresnel reflectance of dielectrics, for the image and its reference: Schlick's, or \
                exact for the index of F0",
        plural: "Fresnel reflectances",
        feeds: &[PrecomputedTable::Dfg],
        used: |used| used.has_dielectric && !used.method.is_none(),
        set: Setter::Name(|settings, name| settings.shading.fresnel = *Fresnel::listed(name)),
        ..one_of::<Fresnel>(LAYER)
    },
    Axis {
        name: "metallic_mix",
        about: "what metallic between 0 and 1 mixes, for the image and its reference: F0 of one \
                lobe, or two BRDFs as glTF",
        plural: "metallic mixtures",
        used: |used| {
            let has_both = !used.method.is_none() && !used.diffuse.is_none();
            has_both && used.has_diffuse_surface && used.has_dielectric
        },
        set: Setter::Name(|settings, name| {
            settings.shading.metallic_mix = *MetallicMix::listed(name)
        }),
        ..one_of::<MetallicMix>(LAYER)
    },
    Axis {
        name: "specular_occlusion",
        about: "factor of the specular term from an occlusion map, for the image and its \
                reference; docs/estimators.md",
        plural: "specular occlusions",
        used: |used| used.has_occlusion && !used.method.is_none(),
        set: Setter::Name(|settings, name| {
            settings.shading.specular_occlusion = *SpecularOcclusion::listed(name)
        }),
        ..one_of::<SpecularOcclusion>(LAYER)
    },
    Axis {
        name: "light_intensity",
        label: "Direct lights (×)",
        about: "multiplies all direct lights; 0 turns them off",
        plural: "intensities of the lights",
        symbol: Symbol::After("× light", "times the light"),
        set: Setter::Number(|settings, number| settings.light_intensity = number),
        ..valued(
            Kind::Number(Range::closed(0.0, 1e9)),
            || Value::Number(1.0),
            LAYER,
        )
    },
    Axis {
        name: "light_turn_deg",
        layer: Some(Layer::Lights),
        label: "Turn of direct lights (°)",
        about: "turns all direct lights around +y, counter-clockwise from above",
        plural: "turns of the lights",
        symbol: Symbol::After("deg", "degrees"),
        set: Setter::Number(|settings, number| settings.light_turn_deg = number),
        ..valued(
            Kind::Number(Range::closed(-360.0, 360.0)),
            || Value::Number(0.0),
            LAYER,
        )
    },
];
