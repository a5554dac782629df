//! Axes by their names in files. An axis may have a second name with values of its own; a point
//! holds the axis's value.

use super::{AXES, Axis, AxisId, Symbol};
use crate::base::names::{in_words, nearest, suggestion};
use crate::experiment::value::{Kind, Raw, Value};

/// Where a user finds every axis.
pub const LISTED_AXES: &str = "a name of `splitsum list axes`";

/// A second name of an axis of numbers or colours, in another unit.
#[derive(Clone, Copy, Debug)]
pub struct Spelling {
    pub name: &'static str,
    pub label: &'static str,
    pub about: &'static str,
    pub plural: &'static str,
    pub symbol: Symbol,
    /// Whether users set this name rather than the axis's: the window has it, and tables have both.
    pub is_usual: bool,
    pub kind: Kind,
    /// Converts a number, or each channel of a colour, to the axis's unit.
    pub to_axis: fn(f64) -> f64,
    /// The inverse.
    pub from_axis: fn(f64) -> f64,
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
            std::iter::once(Self::primary(axis)).chain(second)
        })
    }

    pub fn primary(axis: AxisId) -> Self {
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

    /// Returns the name that users set.
    pub fn usual(axis: AxisId) -> Self {
        Self {
            axis,
            spelling: usual_spelling(axis),
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
        match self.spelling {
            Some(spelling) => converted(value.clone(), spelling.from_axis),
            None => value.clone(),
        }
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
        self.kind().parse(raw).map(|value| self.to_axis(value))
    }

    pub fn parse_text(self, text: &str) -> Result<Value, String> {
        self.kind()
            .parse_text(text)
            .map(|value| self.to_axis(value))
    }

    /// Converts a value of this name to the axis's.
    fn to_axis(self, value: Value) -> Value {
        match self.spelling {
            Some(spelling) => converted(value, spelling.to_axis),
            None => value,
        }
    }
}

/// Converts a number, or each channel of a colour.
fn converted(value: Value, unit: fn(f64) -> f64) -> Value {
    match value {
        Value::Number(number) => Value::Number(unit(number)),
        Value::Color(color) => Value::Color(color.map(|channel| unit(f64::from(channel)) as f32)),
        other => other,
    }
}

/// The second name of an axis, if users set that one.
fn usual_spelling(axis: AxisId) -> Option<&'static Spelling> {
    let spelling = AXES[axis].spelling.as_ref();
    spelling.filter(|spelling| spelling.is_usual)
}

/// Names the columns of an axis: its own name, and the one that users set.
pub fn columns(axis: AxisId) -> impl Iterator<Item = &'static str> {
    let second = usual_spelling(axis);
    std::iter::once(AXES[axis].name).chain(second.map(|spelling| spelling.name))
}

/// Returns the fields of a value in its [`columns`]; empty if unset.
pub fn fields(axis: AxisId, value: &Value) -> impl Iterator<Item = String> + use<> {
    let second = usual_spelling(axis).map(|_| Named::usual(axis).shown(value));
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

/// Names that users try, each with its correction.
pub fn ambiguous() -> impl Iterator<Item = &'static (&'static str, &'static str)> {
    AMBIGUOUS.iter()
}
