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
    let bad = |parameter: &str, value: &str, expected: String| {
        unusable(
            spec,
            format!("{parameter} is {value:?}; expected {expected}"),
        )
    };
    let (name, assignments) = formula.split_once(':').unwrap_or((formula, ""));
    let builtin = BUILTINS
        .iter()
        .find(|builtin| builtin.name == name)
        .ok_or_else(|| {
            let names: Vec<_> = BUILTINS.iter().map(|builtin| builtin.name).collect();
            unusable(
                spec,
                names::not_one_of("built-in environment", name, &names, ""),
            )
        })?;
    let texels = u64::from(size[0]) * u64::from(size[1]);
    if texels == 0 || texels > ENVIRONMENT_TEXELS_MAX {
        let size = format!("{}x{}", size[0], size[1]);
        return Err(bad(
            "the size of a builtin's map",
            &size,
            format!("1 to {ENVIRONMENT_TEXELS_MAX} texels"),
        ));
    }
    let mut values = Values(
        builtin
            .parameters
            .iter()
            .map(|p| (p.name, p.default))
            .collect(),
    );
    let mut given = Vec::new();
    for assignment in assignments
        .split(',')
        .filter(|text| !text.trim().is_empty())
    {
        let (key, text) = assignment.split_once('=').ok_or_else(|| {
            let form = format!(
                "PARAMETER=VALUE, as in {BUILTIN_PREFIX}cap:half_angle_deg=10,radiance=100"
            );
            bad("an assignment", assignment, form)
        })?;
        let key = key.trim();
        let text = text.trim();
        let parameter = builtin
            .parameters
            .iter()
            .find(|p| p.name == key)
            .ok_or_else(|| {
                let names: Vec<_> = builtin.parameters.iter().map(|p| p.name).collect();
                unusable(
                    spec,
                    names::not_one_of(&format!("parameter of {name}"), key, &names, ""),
                )
            })?;
        if given.contains(&key) {
            return Err(bad(key, text, "one value for each parameter".to_owned()));
        }
        given.push(key);
        let value = text
            .parse::<f64>()
            .ok()
            .filter(|value| (parameter.min..=parameter.max).contains(value));
        let value = value.ok_or_else(|| {
            bad(
                key,
                text,
                format!("a number from {} to {}", parameter.min, parameter.max),
            )
        })?;
        let slot = values
            .0
            .iter_mut()
            .find(|(known, _)| *known == parameter.name);
        slot.expect("every parameter has a slot").1 = value;
    }
    Ok((builtin.make)(&values, size))
}
