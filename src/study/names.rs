//! Axes and values in words, by the names that an experiment uses.

use super::finished::Finished;
use crate::base::csv::Cell;
use crate::draw::markdown::significant;
use crate::experiment::axis::{AXES, AxisId, ENVIRONMENT, Named, PerAxis};
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
    pub fn of(run: &Finished) -> Self {
        let named = |axis| {
            run.config
                .as_ref()
                .map_or(Named::own(axis), |config| config.named(axis))
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
        match axis == ENVIRONMENT && !text.starts_with(BUILTIN_PREFIX) {
            true => text,
            false => short_value(&AXES[axis], &text).into_owned(),
        }
    }

    /// "6 levels", "256x128": a value in a sentence.
    pub fn said(&self, axis: AxisId, value: &Value) -> String {
        self.0[axis].symbol().in_sentence(&self.short(axis, value))
    }

    /// "alpha 0.1 · sky · ggx", "256x128 · 5 lv".
    pub fn label(&self, axes: &[AxisId], key: &[Value]) -> String {
        self.label_where(axes, key, |_| true)
    }

    /// As [`Self::label`], for the axes with `is_shown`.
    pub fn label_where(
        &self,
        axes: &[AxisId],
        key: &[Value],
        is_shown: impl Fn(AxisId) -> bool,
    ) -> String {
        let shown = axes
            .iter()
            .zip(key)
            .filter(|(axis, value)| **value != Value::Unset && is_shown(**axis));
        shown
            .map(|(&axis, value)| self.one(axis, value))
            .collect::<Vec<_>>()
            .join(" · ")
    }

    /// "alpha 0.1", "sky"; empty for an unset value.
    pub fn one(&self, axis: AxisId, value: &Value) -> String {
        if *value == Value::Unset {
            String::new()
        } else {
            self.0[axis].symbol().label(&self.short(axis, value))
        }
    }

    /// "alpha 0.05 (roughness 0.22)", "sky".
    pub fn heading(&self, axis: AxisId, value: &Value) -> String {
        match self
            .beside(axis)
            .map(|second| (second, second.shown(value).size()))
        {
            Some((second, Some(size))) => {
                format!(
                    "{} ({})",
                    self.one(axis, value),
                    second.symbol().label(&significant(size, DIGITS))
                )
            }
            _ => self.one(axis, value),
        }
    }

    /// Column heads of values on these axes: alpha also shows the perceptual roughness.
    pub fn heads(&self, axes: &[AxisId]) -> Vec<&'static str> {
        let names = |&axis: &AxisId| {
            std::iter::once(self.name(axis)).chain(self.beside(axis).map(Named::name))
        };
        axes.iter().flat_map(names).collect()
    }

    /// Cells under [`Self::heads`].
    pub fn head(&self, axes: &[AxisId], key: &[Value]) -> Vec<Cell> {
        let cells = |(&axis, value): (&AxisId, &Value)| {
            let beside = self
                .beside(axis)
                .map(|second| Cell::from(&second.shown(value)));
            std::iter::once(Cell::from(self.short(axis, value)))
                .chain(beside)
                .collect::<Vec<_>>()
        };
        axes.iter().zip(key).flat_map(cells).collect()
    }

    /// As [`Self::head`], for one axis.
    pub fn head_of(&self, axis: AxisId, value: &Value) -> Vec<Cell> {
        self.head(&[axis], std::slice::from_ref(value))
    }

    /// The second name of an axis, if the experiment uses the first.
    fn beside(&self, axis: AxisId) -> Option<Named> {
        Some(Named::usual(axis)).filter(|usual| usual.is_second() && !self.0[axis].is_second())
    }
}
