//! Defaults of the axes.

use super::{Axis, Part, Sheet, Symbol};
use crate::experiment::value::{Kind, Range, Value};
use crate::spelling::Listed;

pub(super) const LEVELS: Range = Range::closed(-16.0, 16.0);

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
    flag: None,
    spelling: None,
    kind: Kind::Input,
    default: || Value::Unset,
    unset: None,
    used: |_| true,
    reference: |_, value| value.clone(),
    apply: |_, _| {},
};

pub(super) fn first<T: Listed + ?Sized>() -> Value {
    Value::from(T::names()[0])
}
