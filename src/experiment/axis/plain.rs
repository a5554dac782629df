//! Defaults of the axes.

use super::{Axis, Part, Setter, Sheet, Spelling, Symbol};
use crate::base::names::Listed;
use crate::base::numbers::round_to_significant;
use crate::experiment::value::{ALPHA_MIN, Kind, PERCEPTUAL_ROUGHNESS_MIN, Range, Value, decimal};
use crate::instrument::brdf;

pub(super) const LEVELS: Range = Range::closed(-16.0, 16.0);
pub(super) const ALPHA_KIND: Kind = Kind::Number(Range::closed(ALPHA_MIN, 1.0));

/// Defaults that the entries override.
pub(super) const PLAIN: Axis = Axis {
    name: "",
    label: "",
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
    is_layer: false,
    layer: None,
    flag: None,
    spelling: None,
    kind: Kind::Input,
    default: || Value::Unset,
    unset: None,
    used: |_| true,
    reference: |_, value| value.clone(),
    set: Setter::Nothing,
};

pub(super) fn first<T: Listed + ?Sized>() -> Value {
    Value::from(T::names()[0])
}

/// An axis whose values are the names of a list; the first is the default.
pub(super) const fn one_of<T: Listed + ?Sized>(base: Axis) -> Axis {
    Axis {
        kind: Kind::one_of::<T>(),
        default: first::<T>,
        ..base
    }
}

/// An axis of a kind, with its default.
pub(super) const fn valued(kind: Kind, default: fn() -> Value, base: Axis) -> Axis {
    Axis {
        kind,
        default,
        ..base
    }
}

pub(super) const ROUGHNESS: Spelling = Spelling {
    name: "perceptual_roughness",
    label: "Roughness",
    about: "roughness of every material, as in files; alpha is its square",
    plural: "roughnesses",
    symbol: Symbol::Before("roughness"),
    is_usual: true,
    kind: Kind::Number(Range::closed(PERCEPTUAL_ROUGHNESS_MIN, 1.0)),
    to_axis: |roughness| decimal(brdf::alpha_from_perceptual_roughness(roughness)),
    from_axis: |alpha| decimal(brdf::perceptual_roughness_from_alpha(alpha)),
};

/// Significant digits of an index that is shown: F0 is stored as f32.
const IOR_DIGITS: usize = 6;

pub(super) const IOR: Spelling = Spelling {
    name: "ior",
    label: "Index",
    about: "index of refraction n of every dielectric; F0 is ((1 - n)/(1 + n))^2",
    plural: "indices",
    symbol: Symbol::Before("index"),
    is_usual: false,
    kind: Kind::Color(Range::closed(1.0, brdf::IOR_MAX)),
    to_axis: brdf::f0_from_ior,
    from_axis: |f0| round_to_significant(brdf::ior_from_f0(f0), IOR_DIGITS),
};
