//! Axes by the names that people write. An axis may have a second name, whose values stand for its own: a point holds the axis's value only.

use super::{AXES, Axis, Symbol};
use crate::experiment::value::{Kind, Raw, Value};
use crate::spelling::suggestion;

/// A second name of an axis, with values of its own.
#[derive(Debug)]
pub struct Spelling {
    pub name: &'static str,
    /// One phrase, as [`Axis::about`].
    pub about: &'static str,
    /// Word for several values.
    pub plural: &'static str,
    /// Word beside a value in labels.
    pub symbol: Symbol,
    pub kind: Kind,
    /// The axis's value that a value stands for.
    pub to_axis: fn(&Value) -> Value,
    /// The way back, for the column beside that of the axis; `None` where not every value has one.
    pub of_axis: Option<fn(&Value) -> Value>,
}

/// An axis by one of its names.
#[derive(Clone, Copy, Debug)]
pub struct Named {
    /// Index into [`AXES`].
    pub axis: usize,
    spelling: Option<&'static Spelling>,
}

impl Named {
    /// Every name: each axis, followed by its second name.
    pub fn all() -> impl Iterator<Item = Self> {
        AXES.iter().enumerate().flat_map(|(axis, entry)| {
            let second = entry.spelling.as_ref().map(|spelling| Self { axis, spelling: Some(spelling) });
            std::iter::once(Self::own(axis)).chain(second)
        })
    }

    /// The axis by its own name.
    pub fn own(axis: usize) -> Self {
        Self { axis, spelling: None }
    }

    /// The axis of that name.
    pub fn find(name: &str) -> Option<Self> {
        Self::all().find(|named| named.name() == name)
    }

    /// The axis.
    pub fn entry(self) -> &'static Axis {
        &AXES[self.axis]
    }

    /// Whether this is the second name.
    pub fn is_second(self) -> bool {
        self.spelling.is_some()
    }

    /// The name.
    pub fn name(self) -> &'static str {
        self.spelling.map_or(self.entry().name, |spelling| spelling.name)
    }

    /// The name by which people set an axis: the second one, if every value has one.
    pub fn usual(axis: usize) -> Self {
        Self { axis, spelling: AXES[axis].spelling.as_ref() }.invertible()
    }

    /// This name if it can write every value of the axis, else the axis's own.
    pub fn invertible(self) -> Self {
        Self { spelling: self.spelling.filter(|spelling| spelling.of_axis.is_some()), ..self }
    }

    /// Word for several values.
    pub fn plural(self) -> &'static str {
        self.spelling.map_or(self.entry().plural, |spelling| spelling.plural)
    }

    /// Word beside a value in labels.
    pub fn symbol(self) -> Symbol {
        self.spelling.map_or(self.entry().symbol, |spelling| spelling.symbol)
    }

    /// An axis's value as this name writes it.
    pub fn shown(self, value: &Value) -> Value {
        let of_axis = self.spelling.and_then(|spelling| spelling.of_axis).filter(|_| *value != Value::Unset);
        of_axis.map_or_else(|| value.clone(), |of_axis| of_axis(value))
    }

    /// The flag of `render` without its dashes: `lod-bias` sets `lod_bias`.
    pub fn flag(self) -> String {
        let name = if self.is_second() { self.name() } else { self.entry().flag.unwrap_or(self.name()) };
        name.replace('_', "-")
    }

    /// One phrase for help texts.
    pub fn about(self) -> &'static str {
        self.spelling.map_or(self.entry().about, |spelling| spelling.about)
    }

    /// Values that the name accepts.
    pub fn kind(self) -> Kind {
        self.spelling.map_or(self.entry().kind, |spelling| spelling.kind)
    }

    /// The axis's value that `raw` stands for, or a sentence that says what was expected.
    pub fn parse(self, raw: &Raw) -> Result<Value, String> {
        self.kind().parse(raw).map(|value| self.of_axis(value))
    }

    /// As [`Named::parse`], of text on the command line.
    pub fn parse_text(self, text: &str) -> Result<Value, String> {
        self.kind().parse_text(text).map(|value| self.of_axis(value))
    }

    fn of_axis(self, value: Value) -> Value {
        self.spelling.map_or_else(|| value.clone(), |spelling| (spelling.to_axis)(&value))
    }
}

/// The names of the columns of an axis: its own, and its second one where every value has such.
pub fn columns(axis: usize) -> impl Iterator<Item = &'static str> {
    let second = AXES[axis].spelling.as_ref().filter(|spelling| spelling.of_axis.is_some());
    std::iter::once(AXES[axis].name).chain(second.map(|spelling| spelling.name))
}

/// The fields of a value in the [`columns`] of its axis; empty for an unset one.
pub fn fields(axis: usize, value: &Value) -> impl Iterator<Item = String> + use<> {
    let second = AXES[axis].spelling.as_ref().and_then(|spelling| spelling.of_axis);
    let of_second = second.map(|of_axis| if *value == Value::Unset { Value::Unset } else { of_axis(value) });
    [value.to_string()].into_iter().chain(of_second.map(|value| value.to_string()))
}

/// Names that people try, each with what to write instead.
const AMBIGUOUS: &[(&str, &str)] =
    &[("roughness", "write perceptual_roughness (what materials store), or alpha, which is its square")];

/// The likely meaning of an unknown name among `names`, as the end of a sentence.
pub fn hint(name: &str, names: &[&str]) -> String {
    match AMBIGUOUS.iter().find(|(known, _)| *known == name) {
        Some((_, hint)) => format!("; {hint}"),
        None => suggestion(name, names),
    }
}

/// The names that only have a hint.
pub fn ambiguous() -> impl Iterator<Item = &'static str> {
    AMBIGUOUS.iter().map(|(name, _)| *name)
}
