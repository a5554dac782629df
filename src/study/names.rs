//! Axes and their values as people read them: by the names that an experiment uses.

use super::finished::Finished;
use crate::environment::BUILTIN_PREFIX;
use crate::experiment::axis::{AXES, ENVIRONMENT, Named};
use crate::experiment::value::Value;
use crate::run::images::short_value;
use crate::table::csv::Cell;
use crate::table::markdown::significant;

/// Digits of a number beside another one.
const DIGITS: usize = 2;

/// Each axis by the name that an experiment uses: `alpha` or `perceptual_roughness`.
#[derive(Clone, Debug)]
pub struct Names(Vec<Named>);

impl Names {
    /// The names in the experiment of a run; the axes' own if the experiment is not known.
    pub fn of(run: &Finished) -> Self {
        let named = |axis| run.config.as_ref().map_or(Named::own(axis), |config| config.named(axis));
        Self((0..AXES.len()).map(named).collect())
    }

    pub fn named(&self, axis: usize) -> Named {
        self.0[axis]
    }

    pub fn name(&self, axis: usize) -> &'static str {
        self.0[axis].name()
    }

    /// The word for several values.
    pub fn plural(&self, axis: usize) -> &'static str {
        self.0[axis].plural()
    }

    /// The value that its name writes, for a scale.
    pub fn shown(&self, axis: usize, value: &Value) -> Value {
        self.0[axis].shown(value)
    }

    /// A value as people say it: builtins without prefix, numbers short. Tables name environments shortly already: a folder that is left
    /// tells two files of one stem apart.
    pub fn short(&self, axis: usize, value: &Value) -> String {
        let text = self.shown(axis, value).to_string();
        match axis == ENVIRONMENT && !text.starts_with(BUILTIN_PREFIX) {
            true => text,
            false => short_value(&AXES[axis], &text).into_owned(),
        }
    }

    /// "6 levels", "256x128": a value in a sentence.
    pub fn said(&self, axis: usize, value: &Value) -> String {
        self.0[axis].symbol().said(&self.short(axis, value))
    }

    /// "alpha 0.1 · sky · ggx", "256x128 · 5 lv": values on axes, each saying what it is.
    pub fn label(&self, axes: &[usize], key: &[Value]) -> String {
        let set = axes.iter().zip(key).filter(|(_, value)| **value != Value::Unset);
        set.map(|(&axis, value)| self.one(axis, value)).collect::<Vec<_>>().join(" · ")
    }

    /// "alpha 0.1", "sky"; empty for an unset value.
    pub fn one(&self, axis: usize, value: &Value) -> String {
        if *value == Value::Unset { String::new() } else { self.0[axis].symbol().label(&self.short(axis, value)) }
    }

    /// "alpha 0.05 (roughness 0.22)", "sky".
    pub fn heading(&self, axis: usize, value: &Value) -> String {
        match self.beside(axis).map(|second| (second, second.shown(value).size())) {
            Some((second, Some(size))) => {
                format!("{} ({})", self.one(axis, value), second.symbol().label(&significant(size, DIGITS)))
            }
            _ => self.one(axis, value),
        }
    }

    /// The columns of a digest whose rows are values on these axes: alpha has the perceptual roughness beside it.
    pub fn heads(&self, axes: &[usize]) -> Vec<&'static str> {
        let names = |&axis: &usize| std::iter::once(self.name(axis)).chain(self.beside(axis).map(Named::name));
        axes.iter().flat_map(names).collect()
    }

    /// The cells of a row under [`Self::heads`].
    pub fn head(&self, axes: &[usize], key: &[Value]) -> Vec<Cell> {
        let cells = |(&axis, value): (&usize, &Value)| {
            let beside = self.beside(axis).map(|second| Cell::from(&second.shown(value)));
            std::iter::once(Cell::from(self.short(axis, value))).chain(beside).collect::<Vec<_>>()
        };
        axes.iter().zip(key).flat_map(cells).collect()
    }

    /// The other name of an axis's values, if the experiment uses the axis's own.
    fn beside(&self, axis: usize) -> Option<Named> {
        Some(Named::usual(axis)).filter(|usual| usual.is_second() && !self.0[axis].is_second())
    }
}
