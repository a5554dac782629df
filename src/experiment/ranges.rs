//! Ranges in place of a list of values: `{ pow2 = [0, 8] }`, `{ linspace = [0, 1, 5] }`,
//! `{ logspace = [0.01, 1, 9] }`.

use super::fault::{Faults, Location};
use super::number::number;
use super::toml_tree::{entries, raw, unknown_key};
use super::value::{Kind, Raw};
use crate::base::numbers::round_to_significant;
use toml::Spanned;
use toml::de::DeTable;

const POWER_MAX: i64 = 60;
/// Most values of a range.
const STEPS_MAX: i64 = 10_000;
/// Significant digits of the values between the ends of `linspace` and `logspace`: enough to place
/// them, and few enough to read.
const STEP_DIGITS: usize = 6;

/// A way to write a range.
struct RangeForm {
    name: &'static str,
    /// Its items, for messages.
    items: &'static str,
    /// Expands the items; the error says what was expected of them.
    expand: fn(&[Raw]) -> Result<Vec<f64>, String>,
}

const FORMS: [RangeForm; 3] = [
    RangeForm {
        name: "pow2",
        items: "[from, to]",
        expand: powers_of_two,
    },
    RangeForm {
        name: "linspace",
        items: "[from, to, count]",
        expand: even_steps,
    },
    RangeForm {
        name: "logspace",
        items: "[from, to, count]",
        expand: even_ratios,
    },
];

/// Lists the values of the range at `location`, whole for axes of whole numbers; empty after a
/// fault.
pub(super) fn range_values(
    name: &str,
    kind: Kind,
    range: &DeTable,
    location: &Location,
    faults: &mut Faults,
) -> Vec<(Raw, Location)> {
    let known = FORMS.map(|form| form.name);
    let mut unknown = entries(range);
    unknown.retain(|(key, ..)| !known.contains(key));
    for (key, _, location) in &unknown {
        unknown_key(location, &format!("{name}."), key, &known, faults);
    }
    if !unknown.is_empty() {
        return Vec::new();
    }
    match expanded(kind, range) {
        Ok(values) => values
            .into_iter()
            .map(|value| (value, location.clone()))
            .collect(),
        Err(fault) => {
            faults.add(location, format!("{name}: {fault}"));
            Vec::new()
        }
    }
}

fn expanded(kind: Kind, range: &DeTable) -> Result<Vec<Raw>, String> {
    let is_whole = matches!(kind, Kind::Count { .. });
    let is_number = matches!(
        kind,
        Kind::Number(_) | Kind::NumberOrName { .. } | Kind::Color(_)
    );
    if !is_number && !is_whole {
        return Err("a range needs an axis of numbers; expected a list of values".to_owned());
    }
    let [(name, value, _)] = &entries(range)[..] else {
        return Err(expected());
    };
    let (Some(form), Raw::Array(items)) = (form(name), raw(value)) else {
        return Err(expected());
    };
    let values =
        (form.expand)(&items).map_err(|fault| format!("{name} = {}; {fault}", written(value)))?;
    if !is_whole {
        return Ok(values.into_iter().map(Raw::Float).collect());
    }
    let counts: Vec<i64> = values.iter().map(|value| value.round() as i64).collect();
    match counts.windows(2).find(|pair| pair[0] == pair[1]) {
        Some(pair) => Err(format!(
            "{name} = {} rounds two values to {}; expected fewer values",
            written(value),
            pair[0]
        )),
        None => Ok(counts.into_iter().map(Raw::Integer).collect()),
    }
}

fn form(name: &str) -> Option<&'static RangeForm> {
    FORMS.iter().find(|form| form.name == name)
}

/// A value on one line, as TOML writes it.
fn written(value: &Spanned<toml::de::DeValue>) -> String {
    raw(value).to_string()
}

fn expected() -> String {
    let forms = FORMS.map(|form| format!("{{ {} = {} }}", form.name, form.items));
    format!("expected a list of values, or {}", forms.join(" or "))
}

/// `[from, to]`: 2 to each whole power.
fn powers_of_two(items: &[Raw]) -> Result<Vec<f64>, String> {
    match items {
        [Raw::Integer(from), Raw::Integer(to)]
            if from <= to && *from >= -POWER_MAX && *to <= POWER_MAX =>
        {
            Ok((*from..=*to).map(|power| (power as f64).exp2()).collect())
        }
        _ => Err(format!(
            "expected two powers, ascending, from -{POWER_MAX} to {POWER_MAX}"
        )),
    }
}

/// `[from, to, count]`: equal differences.
fn even_steps(items: &[Raw]) -> Result<Vec<f64>, String> {
    let (ends, count) = ends_and_count(items, f64::MIN)?;
    Ok(between(ends, count, |share| {
        ends[0] + (ends[1] - ends[0]) * share
    }))
}

/// `[from, to, count]`: equal ratios.
fn even_ratios(items: &[Raw]) -> Result<Vec<f64>, String> {
    let (ends, count) = ends_and_count(items, 0.0)?;
    Ok(between(ends, count, |share| {
        ends[0] * (ends[1] / ends[0]).powf(share)
    }))
}

/// Reads two ends above `least`, ascending, and a count.
fn ends_and_count(items: &[Raw], least: f64) -> Result<([f64; 2], i64), String> {
    if let [from, to, Raw::Integer(count)] = items
        && let (Some(from), Some(to)) = (number(from), number(to))
        && least < from
        && from < to
        && to.is_finite()
        && (2..=STEPS_MAX).contains(count)
    {
        return Ok(([from, to], *count));
    }
    let above = if least == 0.0 { " above 0" } else { "" };
    Err(format!(
        "expected two numbers{above}, ascending, and a count from 2 to {STEPS_MAX}"
    ))
}

/// `count` values from end to end; `value` maps a share from 0 to 1.
fn between(ends: [f64; 2], count: i64, value: impl Fn(f64) -> f64) -> Vec<f64> {
    let last = count - 1;
    let inner =
        (1..last).map(|step| round_to_significant(value(step as f64 / last as f64), STEP_DIGITS));
    std::iter::once(ends[0])
        .chain(inner)
        .chain([ends[1]])
        .collect()
}
