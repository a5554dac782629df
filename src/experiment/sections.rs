//! Sections beside the axes: questions, exclusions, timing, ladder, tables.

use super::axis::{AXES, Named, SAMPLES, is_precompute};
use super::config::{AXIS, Ask, Condition, Config, Exclusion, Located, Timing, axis_names};
use super::fault::Faults;
use super::toml_tree::{
    checked, checked_as, list, raw, section, start_of, table, text, unknown_key,
};
use super::value::{Kind, Raw};
use crate::base::names::Listed;
use crate::instrument::metrics::Weight;
use crate::instrument::recovery::Loss;
use crate::instrument::shade::reference_pass::pair_count;
use toml::Spanned;
use toml::de::DeValue;

/// Keeps the noise of drawn steps far below the steps.
const LADDER_SAMPLES_DEFAULT: u32 = 2048;

impl Config {
    /// `asks = ["break-even", { question = "effect", by = "f0" }]`
    pub(super) fn read_asks(&mut self, value: &Spanned<DeValue>, faults: &mut Faults) {
        let Some(items) = value.get_ref().as_array().filter(|items| !items.is_empty()) else {
            faults.add(
                &start_of(value),
                format!("asks: {} is not a list of at least one name", raw(value)),
            );
            return;
        };
        for item in items {
            let mut ask = Ask {
                question: String::new(),
                location: start_of(item),
                by: None,
            };
            if item.get_ref().is_table() {
                let entries = section(item, "asks", &["question", "by"], faults);
                if entries.iter().all(|(key, ..)| *key != "question") {
                    faults.add(&ask.location, "asks.question is missing");
                }
                for (key, value, _) in entries {
                    if key == "question" {
                        ask.question = text("asks.question", value, faults);
                        ask.location = start_of(value);
                    } else if let Some(name) = checked(AXIS, "asks.by", value, faults) {
                        ask.by =
                            Named::find(name.text()).map(|named| (named.axis, start_of(value)));
                    }
                }
            } else if let Raw::String(question) = raw(item) {
                ask.question = question;
            } else {
                let fault = format!(
                    "asks: {} is neither a name nor {{ question = ..., by = ... }}",
                    raw(item)
                );
                faults.add(&start_of(item), fault);
            }
            if self.asks.iter().any(|known| known.question == ask.question) {
                faults.add(
                    &ask.location,
                    format!("asks: {} is listed twice", ask.question),
                );
            } else if !ask.question.is_empty() {
                self.asks.push(ask);
            }
        }
    }

    pub(super) fn read_weights(&mut self, value: &Spanned<DeValue>, faults: &mut Faults) {
        let Some(items) = value.get_ref().as_array().filter(|items| !items.is_empty()) else {
            faults.add(
                &start_of(value),
                format!("weights: {} is not a list of at least one name", raw(value)),
            );
            return;
        };
        for item in items {
            let name = text("weights", item, faults);
            let weight = Weight::of_name(&name);
            if self.weights.iter().any(|(known, _)| *known == weight) {
                faults.add(&start_of(item), format!("weights: {name} is listed twice"));
            } else if !name.is_empty() {
                self.weights.push((weight, start_of(item)));
            }
        }
    }

    pub(super) fn read_exclusions(&mut self, value: &Spanned<DeValue>, faults: &mut Faults) {
        for item in list(value, "exclude", faults) {
            self.exclusions.push(read_exclusion(item, faults));
        }
    }

    pub(super) fn read_timing(&mut self, value: &Spanned<DeValue>, faults: &mut Faults) {
        let mut timing = Timing {
            warmup: 3,
            rounds: 15,
        };
        for (key, value, _) in section(value, "timing", &["rounds", "warmup"], faults) {
            let (number, max) = if key == "warmup" {
                (&mut timing.warmup, 10_000)
            } else {
                (&mut timing.rounds, 100_000)
            };
            let count = checked(
                Kind::Count { min: 1, max },
                &format!("timing.{key}"),
                value,
                faults,
            );
            *number = count.map_or(*number, |v| v.count());
        }
        self.timing = Some(timing);
    }

    pub(super) fn read_ladder(&mut self, value: &Spanned<DeValue>, faults: &mut Faults) {
        let entries = section(value, "ladder", &["samples"], faults);
        let count =
            |value| checked(AXES[SAMPLES].kind, "ladder.samples", value, faults).map(|v| v.count());
        let samples = entries
            .into_iter()
            .map(|(_, value, _)| value)
            .find_map(count)
            .unwrap_or(LADDER_SAMPLES_DEFAULT);
        if let Err(error) = pair_count(samples) {
            faults.add(&start_of(value), format!("ladder.samples: {error}"));
        }
        self.ladder = Some(samples);
    }

    /// `[recovery]` with `losses`, by default all.
    pub(super) fn read_recovery(&mut self, value: &Spanned<DeValue>, faults: &mut Faults) {
        let mut losses = Vec::new();
        for (key, value, _) in section(value, "recovery", &["losses"], faults) {
            let key = format!("recovery.{key}");
            let Some(items) = value.get_ref().as_array() else {
                let fault = format!("{key}: {} is not a list of names", raw(value));
                faults.add(&start_of(value), fault);
                continue;
            };
            for item in items {
                if let Some(name) = checked(Kind::one_of::<Loss>(), &key, item, faults) {
                    losses.push(*Loss::listed(name.text()));
                }
            }
        }
        if losses.is_empty() {
            losses = Loss::all().copied().collect();
        }
        self.recovery = Some(losses);
    }

    pub(super) fn read_precompute(&mut self, value: &Spanned<DeValue>, faults: &mut Faults) {
        let axes = || AXES.entries().filter(|(_, axis)| is_precompute(axis));
        let names: Vec<&str> = axes().map(|(_, axis)| axis.name).collect();
        for (key, value, location) in section(value, "precompute", &names, faults) {
            let Some((axis, entry)) = axes().find(|(_, axis)| axis.name == key) else {
                continue;
            };
            if let Some(v) = checked(entry.kind, &format!("precompute.{key}"), value, faults) {
                self.set_base(axis, v, location);
            }
        }
    }
}

fn read_exclusion(item: &Spanned<DeValue>, faults: &mut Faults) -> Exclusion {
    let mut exclusion = Exclusion {
        conditions: Vec::new(),
        why: String::new(),
        location: start_of(item),
    };
    let mut has_why = false;
    for (key, value, location) in table(item, "exclude", faults) {
        if key == "why" {
            has_why = true;
            exclusion.why = checked_as(parse_why, "exclude.why", value, faults).unwrap_or_default();
        } else if let Some(named) = Named::find(key) {
            let values = read_condition(named, key, value, faults);
            exclusion.conditions.push(Condition {
                axis: named.axis,
                values,
            });
        } else {
            let known = [&axis_names()[..], &["why"]].concat();
            unknown_key(&location, "exclude.", key, &known, faults);
        }
    }
    if !has_why {
        faults.add(
            &exclusion.location,
            "exclude.why is missing: say why these cells are left out",
        );
    }
    if exclusion.conditions.is_empty() {
        faults.add(
            &exclusion.location,
            "exclude: names no axis, so it would leave out every cell",
        );
    }
    exclusion
}

fn parse_why(raw: &Raw) -> Result<String, String> {
    match raw.as_str() {
        Some(why) if !why.is_empty() => Ok(why.to_owned()),
        _ => Err(format!(
            "{raw} is not text that says why these cells are left out"
        )),
    }
}

/// Reads the values of an axis that match: one, or a list. A colour or a pair is itself a list.
fn read_condition(
    named: Named,
    key: &str,
    value: &Spanned<DeValue>,
    faults: &mut Faults,
) -> Vec<Located> {
    let is_value = named.parse(&raw(value)).is_ok();
    let items: Vec<_> = match value.get_ref().as_array() {
        Some(items) if !is_value => items.iter().collect(),
        _ => vec![value],
    };
    let name = format!("exclude.{key}");
    let mut values = Vec::new();
    for item in items {
        if let Some(value) = checked_as(|raw| named.parse(raw), &name, item, faults) {
            values.push(Located {
                value,
                location: start_of(item),
            });
        }
    }
    values
}
