//! Environments from formulas, which need no download.

mod cap;
mod checker;
mod constant;
mod gradient;
mod hosek_wilkie;
mod raster;
mod sky;
mod studio;

use super::error::{EnvironmentError, unusable};
use crate::base::names;
use crate::base::pixels::{ENVIRONMENT_TEXELS_MAX, RgbImage};

/// Prefix of the spec of a formula.
pub const BUILTIN_PREFIX: &str = "builtin:";

#[derive(Debug)]
pub struct Parameter {
    pub name: &'static str,
    /// Meaning and unit.
    pub about: &'static str,
    pub default: f64,
    pub min: f64,
    pub max: f64,
}

const fn parameter(
    name: &'static str,
    about: &'static str,
    default: f64,
    [min, max]: [f64; 2],
) -> Parameter {
    Parameter {
        name,
        about,
        default,
        min,
        max,
    }
}

#[derive(Debug)]
pub struct Builtin {
    pub name: &'static str,
    pub about: &'static str,
    pub parameters: &'static [Parameter],
    make: fn(&Values, [u32; 2]) -> RgbImage,
}

/// Every builtin. To add one: its file here and a line here.
pub static BUILTINS: &[&Builtin] = &[
    &constant::CONSTANT,
    &gradient::GRADIENT,
    &sky::SKY,
    &studio::STUDIO,
    &checker::CHECKER,
    &cap::CAP,
];

struct Values(Vec<(&'static str, f64)>);

impl Values {
    fn get(&self, name: &str) -> f64 {
        let found = self.0.iter().find(|(known, _)| *known == name);
        found
            .map(|&(_, value)| value)
            .expect("a formula reads only its own parameters")
    }

    fn set(&mut self, name: &str, value: f64) {
        let entry = self.0.iter_mut().find(|(known, _)| *known == name);
        entry.expect("every parameter has a value").1 = value;
    }
}

/// Returns the builtin whose name resembles `word`.
pub(super) fn nearest(word: &str) -> Option<&'static str> {
    names::nearest(
        word,
        &BUILTINS
            .iter()
            .map(|builtin| builtin.name)
            .collect::<Vec<_>>(),
    )
}

/// Makes the map of `formula` (`NAME` or `NAME:PARAMETER=VALUE,...`), which is `spec` without its
/// prefix.
pub(super) fn make(
    spec: &str,
    formula: &str,
    size: [u32; 2],
) -> Result<RgbImage, EnvironmentError> {
    let fault = |what: String| unusable(spec, what);
    let (name, assignments) = formula.split_once(':').unwrap_or((formula, ""));
    let builtin = BUILTINS
        .iter()
        .find(|builtin| builtin.name == name)
        .ok_or_else(|| {
            let names: Vec<_> = BUILTINS.iter().map(|builtin| builtin.name).collect();
            fault(names::not_one_of("built-in environment", name, &names, ""))
        })?;
    check_size(size).map_err(fault)?;
    let values = builtin.values(assignments).map_err(fault)?;
    Ok((builtin.make)(&values, size))
}

fn check_size([width, height]: [u32; 2]) -> Result<(), String> {
    let texels = u64::from(width) * u64::from(height);
    if (1..=ENVIRONMENT_TEXELS_MAX).contains(&texels) {
        return Ok(());
    }
    Err(unexpected(
        "the size of a builtin's map",
        &format!("{width}x{height}"),
        &format!("1 to {ENVIRONMENT_TEXELS_MAX} texels"),
    ))
}

fn unexpected(subject: &str, value: &str, expected: &str) -> String {
    format!("{subject} is {value:?}; expected {expected}")
}

impl Builtin {
    /// Parses `PARAMETER=VALUE,...`; the others have their defaults.
    fn values(&self, assignments: &str) -> Result<Values, String> {
        let defaults = self.parameters.iter().map(|p| (p.name, p.default));
        let mut values = Values(defaults.collect());
        let mut assigned = Vec::new();
        for assignment in assignments
            .split(',')
            .filter(|text| !text.trim().is_empty())
        {
            let (key, text) = assignment.split_once('=').ok_or_else(|| {
                let form = format!(
                    "PARAMETER=VALUE, as in {BUILTIN_PREFIX}cap:half_angle_deg=10,radiance=100"
                );
                unexpected("an assignment", assignment, &form)
            })?;
            let key = key.trim();
            let text = text.trim();
            let parameter = self.parameter(key)?;
            if assigned.contains(&key) {
                return Err(unexpected(key, text, "one value for each parameter"));
            }
            assigned.push(key);
            values.set(parameter.name, parameter.parse(text)?);
        }
        Ok(values)
    }

    fn parameter(&self, key: &str) -> Result<&'static Parameter, String> {
        self.parameters
            .iter()
            .find(|parameter| parameter.name == key)
            .ok_or_else(|| {
                let names: Vec<_> = self.parameters.iter().map(|p| p.name).collect();
                names::not_one_of(&format!("parameter of {}", self.name), key, &names, "")
            })
    }
}

impl Parameter {
    fn parse(&self, text: &str) -> Result<f64, String> {
        text.parse::<f64>()
            .ok()
            .filter(|value| (self.min..=self.max).contains(value))
            .ok_or_else(|| {
                let range = format!("a number from {} to {}", self.min, self.max);
                unexpected(self.name, text, &range)
            })
    }
}
