//! Axes by their names in files. An axis may have a second name with values of its own; a point
//! holds the axis's value.

use super::AxisId;
use super::{AXES, Axis, Symbol};
use crate::base::names::{in_words, nearest, suggestion};
use crate::experiment::value::{Kind, Raw, Value};

/// Where a user finds every axis.
pub const LISTED_AXES: &str = "a name of `splitsum list axes`";

/// A second name of an axis, with its own values.
#[derive(Clone, Copy, Debug)]
pub struct Spelling {
    pub name: &'static str,
    pub label: &'static str,
    pub about: &'static str,
    pub plural: &'static str,
    pub symbol: Symbol,
    pub kind: Kind,
    /// Converts a value to the axis's own.
    pub to_axis: fn(&Value) -> Value,
    /// The inverse.
    pub of_axis: fn(&Value) -> Value,
}

/// An axis by one of its names.
#[derive(Clone, Copy, Debug)]
pub struct Named {
    /// Index into [`AXES`].
    pub axis: AxisId,
    spelling: Option<&'static Spelling>,
}

impl Named {
    /// Lists every name: each axis, then its second name.
    pub fn all() -> impl Iterator<Item = Self> {
        AXES.entries().flat_map(|(axis, entry)| {
            let second = entry.spelling.as_ref().map(|spelling| Self {
                axis,
                spelling: Some(spelling),
            });
            std::iter::once(Self::own(axis)).chain(second)
        })
    }

    pub fn own(axis: AxisId) -> Self {
        Self {
            axis,
            spelling: None,
        }
    }

    pub fn find(name: &str) -> Option<Self> {
        Self::all().find(|named| named.name() == name)
    }

    pub fn entry(self) -> &'static Axis {
        &AXES[self.axis]
    }

    pub fn is_second(self) -> bool {
        self.spelling.is_some()
    }

    pub fn name(self) -> &'static str {
        self.spelling
            .map_or(self.entry().name, |spelling| spelling.name)
    }

    /// Labels its control: `Roughness`, `Map size (px)`.
    pub fn label(self) -> String {
        let label = self
            .spelling
            .map_or(self.entry().label, |spelling| spelling.label);
        if label.is_empty() {
            in_words(self.name())
        } else {
            label.to_owned()
        }
    }

    /// Returns the name that users set: the second one, if there is one.
    pub fn usual(axis: AxisId) -> Self {
        Self {
            axis,
            spelling: AXES[axis].spelling.as_ref(),
        }
    }

    pub fn plural(self) -> String {
        let plural = self
            .spelling
            .map_or(self.entry().plural, |spelling| spelling.plural);
        if plural.is_empty() {
            self.name().replace('_', " ") + "s"
        } else {
            plural.to_owned()
        }
    }

    pub fn symbol(self) -> Symbol {
        self.spelling
            .map_or(self.entry().symbol, |spelling| spelling.symbol)
    }

    /// Converts an axis's value to this name's.
    pub fn shown(self, value: &Value) -> Value {
        let spelling = self.spelling.filter(|_| *value != Value::Unset);
        spelling.map_or_else(|| value.clone(), |spelling| (spelling.of_axis)(value))
    }

    /// Returns the flag of `render` without its dashes: `lod-bias` for `lod_bias`.
    pub fn flag(self) -> String {
        let name = if self.is_second() {
            self.name()
        } else {
            self.entry().flag.unwrap_or(self.name())
        };
        name.replace('_', "-")
    }

    pub fn about(self) -> &'static str {
        self.spelling
            .map_or(self.entry().about, |spelling| spelling.about)
    }

    pub fn kind(self) -> Kind {
        self.spelling
            .map_or(self.entry().kind, |spelling| spelling.kind)
    }

    /// Parses a value of this name; the error names the expected values.
    pub fn parse(self, raw: &Raw) -> Result<Value, String> {
        self.kind().parse(raw).map(|value| self.of_axis(value))
    }

    pub fn parse_text(self, text: &str) -> Result<Value, String> {
        self.kind()
            .parse_text(text)
            .map(|value| self.of_axis(value))
    }

    fn of_axis(self, value: Value) -> Value {
        self.spelling
            .map_or_else(|| value.clone(), |spelling| (spelling.to_axis)(&value))
    }
}

/// Names the columns of an axis: its own name, and the second one.
pub fn columns(axis: AxisId) -> impl Iterator<Item = &'static str> {
    let second = AXES[axis].spelling.as_ref();
    std::iter::once(AXES[axis].name).chain(second.map(|spelling| spelling.name))
}

/// Returns the fields of a value in its [`columns`]; empty if unset.
pub fn fields(axis: AxisId, value: &Value) -> impl Iterator<Item = String> + use<> {
    let second = AXES[axis]
        .spelling
        .as_ref()
        .map(|_| Named::usual(axis).shown(value));
    [value.to_string()]
        .into_iter()
        .chain(second.map(|value| value.to_string()))
}

/// Names that users try, with the correction.
const AMBIGUOUS: &[(&str, &str)] = &[(
    "roughness",
    "write perceptual_roughness (what materials store), or alpha, which is its square",
)];

/// Ends a sentence about an unknown name with the likely one of `names`.
pub fn hint(name: &str, names: &[&str]) -> String {
    let known: Vec<&str> = names
        .iter()
        .copied()
        .chain(AMBIGUOUS.iter().map(|(known, _)| *known))
        .collect();
    let near = nearest(name, &known);
    let is_axis = names.is_empty() || names.contains(&"alpha");
    match AMBIGUOUS
        .iter()
        .find(|(known, _)| *known == name || is_axis && near == Some(known))
    {
        Some((_, hint)) => format!("; {hint}"),
        None => suggestion(name, names),
    }
}

pub fn ambiguous() -> impl Iterator<Item = &'static str> {
    AMBIGUOUS.iter().map(|(name, _)| *name)
}
