//! Axes and values in words, by the names that an experiment uses.

use super::finished::Finished;
use super::table::value_cell;
use crate::base::csv::Cell;
use crate::draw::markdown::significant;
use crate::draw::words::{Phrase, Statement};
use crate::experiment::axis::{AXES, AxisId, ENVIRONMENT, METHOD, Named, PerAxis};
use crate::experiment::value::Value;
use crate::instrument::environment::BUILTIN_PREFIX;
use crate::run::images::short_value;

/// Digits of a number next to another one.
const DIGITS: usize = 2;

/// The name that an experiment uses for each axis: `alpha` or `perceptual_roughness`.
#[derive(Clone, Debug)]
pub struct Names(PerAxis<Named>);

impl Names {
    /// The names of a run's experiment; the axes' own if it is unknown.
    pub fn new(run: &Finished) -> Self {
        let named = |axis| {
            run.config
                .as_ref()
                .map_or(Named::primary(axis), |config| config.named(axis))
        };
        Self(AXES.ids().map(named).collect())
    }

    pub fn named(&self, axis: AxisId) -> Named {
        self.0[axis]
    }

    pub fn name(&self, axis: AxisId) -> &'static str {
        self.0[axis].name()
    }

    pub fn plural(&self, axis: AxisId) -> String {
        self.0[axis].plural()
    }

    /// The value under that name.
    pub fn shown(&self, axis: AxisId, value: &Value) -> Value {
        self.0[axis].shown(value)
    }

    /// A short value: builtins without prefix, numbers with few digits. Environments of files are
    /// short already; a folder distinguishes equal file names.
    pub fn short(&self, axis: AxisId, value: &Value) -> String {
        let text = self.shown(axis, value).to_string();
        let is_file = axis == ENVIRONMENT && !text.starts_with(BUILTIN_PREFIX);
        if is_file {
            text
        } else {
            short_value(&AXES[axis], &text).into_owned()
        }
    }

    /// As [`Self::short`], in a table for readers.
    pub fn short_cell(&self, axis: AxisId, value: &Value) -> Cell {
        if axis == METHOD {
            return value_cell(axis, value);
        }
        let text = self.short(axis, value);
        match value {
            Value::Number(_) | Value::Count(_) | Value::Color(_) | Value::Pair(_) => {
                Cell::quantity(text)
            }
            Value::Unset | Value::Text(_) => text.into(),
        }
    }

    /// As [`Self::short`], in a statement.
    pub fn short_phrase(&self, axis: AxisId, value: &Value) -> Phrase {
        Phrase::AxisValue {
            axis: self.name(axis),
            label: self.short(axis, value),
        }
    }

    /// "6 levels", "256x128": a value in a sentence.
    pub fn in_sentence(&self, axis: AxisId, value: &Value) -> String {
        self.0[axis].symbol().in_sentence(&self.short(axis, value))
    }

    /// "alpha 0.1 · sky · ggx", "256x128 · 5 lv".
    pub fn label(&self, axes: &[AxisId], key: &[Value]) -> String {
        self.labels(axes, key).join(" · ")
    }

    /// "alpha 0.1, sky, ggx".
    pub fn comma_label(&self, axes: &[AxisId], key: &[Value]) -> String {
        self.labels(axes, key).join(", ")
    }

    /// As [`Self::comma_label`], in a statement.
    pub fn comma_phrases(&self, axes: &[AxisId], key: &[Value]) -> Statement {
        let phrases = set_values(axes, key).map(|(axis, value)| self.phrase(axis, value).into());
        Statement::joined(phrases, ", ")
    }

    fn labels(&self, axes: &[AxisId], key: &[Value]) -> Vec<String> {
        set_values(axes, key)
            .map(|(axis, value)| self.value_label(axis, value))
            .collect()
    }

    /// "alpha 0.1", "sky"; empty for an unset value.
    pub fn value_label(&self, axis: AxisId, value: &Value) -> String {
        if *value == Value::Unset {
            String::new()
        } else {
            self.0[axis].symbol().label(&self.short(axis, value))
        }
    }

    /// As [`Self::value_label`], in a statement.
    pub fn phrase(&self, axis: AxisId, value: &Value) -> Phrase {
        Phrase::AxisValue {
            axis: self.name(axis),
            label: self.value_label(axis, value),
        }
    }

    /// "alpha 0.05 (roughness 0.22)", "sky".
    pub fn heading(&self, axis: AxisId, value: &Value) -> String {
        let label = self.value_label(axis, value);
        let Some(second) = self.second_name(axis) else {
            return label;
        };
        match second.shown(value).size() {
            Some(size) => {
                let second = second.symbol().label(&significant(size, DIGITS));
                format!("{label} ({second})")
            }
            None => label,
        }
    }

    /// As [`Self::heading`], in a statement.
    pub fn heading_phrase(&self, axis: AxisId, value: &Value) -> Phrase {
        Phrase::AxisValue {
            axis: self.name(axis),
            label: self.heading(axis, value),
        }
    }

    /// Column heads of values on these axes: alpha also shows the perceptual roughness.
    pub fn heads(&self, axes: &[AxisId]) -> Vec<&'static str> {
        let mut heads = Vec::new();
        for &axis in axes {
            heads.push(self.name(axis));
            heads.extend(self.second_name(axis).map(Named::name));
        }
        heads
    }

    /// Cells under [`Self::heads`].
    pub fn head(&self, axes: &[AxisId], key: &[Value]) -> Vec<Cell> {
        let mut cells = Vec::new();
        for (&axis, value) in axes.iter().zip(key) {
            cells.push(self.short_cell(axis, value));
            let second = self.second_name(axis);
            cells.extend(second.map(|second| Cell::from(&second.shown(value))));
        }
        cells
    }

    /// As [`Self::head`], for one axis.
    pub fn head_of(&self, axis: AxisId, value: &Value) -> Vec<Cell> {
        self.head(&[axis], std::slice::from_ref(value))
    }

    /// The second name of an axis, if the experiment uses the first.
    fn second_name(&self, axis: AxisId) -> Option<Named> {
        Some(Named::usual(axis)).filter(|usual| usual.is_second() && !self.0[axis].is_second())
    }
}

fn set_values<'v>(
    axes: &'v [AxisId],
    key: &'v [Value],
) -> impl Iterator<Item = (AxisId, &'v Value)> {
    axes.iter()
        .copied()
        .zip(key)
        .filter(|(_, value)| **value != Value::Unset)
}
