//! The axes of anisotropy and of layers over the base. Cells without them keep their ids.

use super::plain::{ALPHA_KIND, PLAIN, ROUGHNESS, first, one_of};
use super::{Axis, Part, Spelling, Symbol};
use crate::base::names::Listed;
use crate::experiment::value::{Kind, Range};
use crate::instrument::brdf::{SHEEN_ALPHA_MIN, SheenVisibility, WidthLaw};
use crate::instrument::shade::bend::Bend;
use crate::instrument::shade::coat::{CoatLayering, CoatRenderer};
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
        apply: |s, v| s.material.anisotropy = Some(v.number() as f32),
        ..LAYER
    },
    Axis {
        name: "anisotropy_rotation_deg",
        label: "Tangent turn (°)",
        about: "turns the direction of the larger width from the tangent, counter-clockwise about \
                the normal",
        plural: "turns of the tangent",
        symbol: Symbol::After("deg", "degrees"),
        used: |u| u.has_anisotropy,
        kind: Kind::Number(Range::closed(-360.0, 360.0)),
        apply: |s, v| s.material.anisotropy_turn = Some(v.number().to_radians() as f32),
        ..LAYER
    },
    Axis {
        name: "anisotropy_widths",
        about: "law that turns alpha and the strength into two widths; docs/estimators.md",
        plural: "laws of widths",
        used: |u| u.has_anisotropy,
        apply: |s, v| s.shading.widths = *WidthLaw::listed(v.text()),
        ..one_of::<WidthLaw>(LAYER)
    },
    Axis {
        name: "bend",
        part: Part::Parameter,
        frames_cost: true,
        is_compared: true,
        about: "engine whose anisotropic lookup split-sum-bent uses; `splitsum list bends`",
        used: |u| u.method.uses_bend,
        reference: |_, _| first::<Bend>(),
        apply: |s, v| s.shading.bend = Bend::listed(v.text()),
        ..one_of::<Bend>(LAYER)
    },
    Axis {
        name: "coat",
        about: "weight of a clear coat on every material; 0 has none",
        plural: "coat weights",
        symbol: Symbol::Before("coat"),
        kind: Kind::Number(Range::closed(0.0, 1.0)),
        apply: |s, v| s.material.coat = Some(v.number() as f32),
        ..LAYER
    },
    Axis {
        name: "coat_alpha",
        about: "microfacet width of every coat",
        symbol: Symbol::Before("coat alpha"),
        used: |u| u.has_coat,
        kind: ALPHA_KIND,
        spelling: Some(Spelling {
            name: "coat_perceptual_roughness",
            label: "Coat roughness",
            about: "roughness of every coat, as in files; coat_alpha is its square",
            plural: "coat roughnesses",
            symbol: Symbol::Before("coat roughness"),
            ..ROUGHNESS
        }),
        apply: |s, v| s.material.coat_alpha = Some(v.number() as f32),
        ..LAYER
    },
    Axis {
        name: "coat_layering",
        about: "how base and coat add up, for the image and its reference; docs/coat.md",
        used: |u| u.has_coat,
        apply: |s, v| s.shading.coat_layering = *CoatLayering::listed(v.text()),
        ..one_of::<CoatLayering>(LAYER)
    },
    Axis {
        name: "coat_renderer",
        part: Part::Parameter,
        about: "whose way to shade a coat; `splitsum list coat-renderers`",
        used: |u| u.has_coat && !u.method.is_integrated(),
        reference: |_, _| first::<CoatRenderer>(),
        apply: |s, v| s.shading.coat_renderer = CoatRenderer::listed(v.text()),
        ..one_of::<CoatRenderer>(LAYER)
    },
    Axis {
        name: "sheen_color",
        about: "colour of a sheen of cloth on every material; 0 has none",
        symbol: Symbol::Before("sheen"),
        kind: Kind::Color(Range::closed(0.0, 1.0)),
        apply: |s, v| s.material.sheen_color = Some(v.color()),
        ..LAYER
    },
    Axis {
        name: "sheen_alpha",
        about: "microfacet width of every sheen",
        symbol: Symbol::Before("sheen alpha"),
        used: |u| u.has_sheen,
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
        apply: |s, v| s.material.sheen_alpha = Some(v.number() as f32),
        ..LAYER
    },
    Axis {
        name: "sheen_visibility",
        about: "visibility of the sheen lobe, for the image and its reference; docs/sheen.md",
        plural: "sheen visibilities",
        used: |u| u.has_sheen,
        apply: |s, v| s.shading.sheen_visibility = *SheenVisibility::listed(v.text()),
        ..one_of::<SheenVisibility>(LAYER)
    },
    Axis {
        name: "sheen_lookup",
        part: Part::Parameter,
        about: "whose way to look up sheen; `splitsum list sheen-lookups`",
        used: |u| u.has_sheen && u.method.has_pass(),
        reference: |_, _| first::<SheenLookup>(),
        apply: |s, v| s.shading.sheen_lookup = SheenLookup::listed(v.text()),
        ..one_of::<SheenLookup>(LAYER)
    },
];
