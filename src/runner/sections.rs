//! The sections of an experiment file beside its axes: exclusions, timing, bias and variance, tables.

use super::axis::{AXES, Named, index_of, is_precompute};
use super::config::{Config, Exclusion, Placed, Timing, Warmup, unknown_axis};
use super::fault::{Faults, Place};
use super::toml_tree::{checked, checked_as, list, raw, table, unknown_key};
use super::value::{Kind, Raw};
use toml::Spanned;
use toml::de::DeValue;

/// Enough for a variance within about 40 % at two sigma of one pixel, and far better over an image.
const REPEATS_DEFAULT: u32 = 16;

impl Config {
    pub(super) fn read_exclusions(&mut self, value: &Spanned<DeValue>, faults: &mut Faults) {
        for item in list(value, "exclude", faults) {
            let place = Place::File(item.span().start);
            let mut exclusion = Exclusion { conditions: Vec::new(), why: String::new(), place };
            let mut has_why = false;
            for (key, value, place) in table(item, "exclude", faults) {
                let at = Place::File(value.span().start);
                if key == "why" {
                    has_why = true;
                    match raw(value.get_ref()) {
                        Raw::Text(why) if !why.is_empty() => exclusion.why = why,
                        other => faults.add(
                            &at,
                            format!("exclude.why: {other} is not text that says why these cells are left out"),
                        ),
                    }
                    continue;
                }
                let Some(named) = Named::find(key) else {
                    unknown_axis(&place, "exclude.", key, &["why"], faults);
                    continue;
                };
                let name = format!("exclude.{key}");
                // A colour or a pair is itself a list: only a list of what the axis takes is a list of values.
                let one = named.parse(&raw(value.get_ref()));
                let values = match (one, value.get_ref().as_array()) {
                    (Ok(value), _) => vec![Placed { value, place: at }],
                    (Err(_), Some(items)) => {
                        let placed = |item: &Spanned<DeValue>| {
                            let value = checked_as(|raw| named.parse(raw), &name, item, faults)?;
                            Some(Placed { value, place: Place::File(item.span().start) })
                        };
                        items.iter().filter_map(placed).collect()
                    }
                    (Err(fault), None) => {
                        faults.add(&at, format!("{name}: {fault}"));
                        Vec::new()
                    }
                };
                exclusion.conditions.push((named.axis, values));
            }
            if !has_why {
                faults.add(&exclusion.place, "exclude.why is missing: say why these cells are left out");
            }
            if exclusion.conditions.is_empty() {
                faults.add(&exclusion.place, "exclude: names no axis, so it would leave out every cell");
            }
            self.exclusions.push(exclusion);
        }
    }

    pub(super) fn read_timing(&mut self, value: &Spanned<DeValue>, faults: &mut Faults) {
        let mut timing = Timing { warmup: Warmup::Stable, rounds: 15 };
        for (key, value, place) in table(value, "timing", faults) {
            match key {
                "warmup" => {
                    let kind = Kind::Count { min: 1, max: 10_000 };
                    timing.warmup = match raw(value.get_ref()) {
                        Raw::Text(text) if text == "stable" => Warmup::Stable,
                        _ => checked(kind, "timing.warmup", value, faults)
                            .map_or(timing.warmup, |v| Warmup::Frames(v.count())),
                    };
                }
                "rounds" => {
                    let kind = Kind::Count { min: 1, max: 100_000 };
                    timing.rounds = checked(kind, "timing.rounds", value, faults).map_or(timing.rounds, |v| v.count());
                }
                _ => unknown_key(&place, "timing.", key, &["rounds", "warmup"], faults),
            }
        }
        self.timing = Some(timing);
    }

    pub(super) fn read_bias_variance(&mut self, value: &Spanned<DeValue>, faults: &mut Faults) {
        let mut repeats = REPEATS_DEFAULT;
        for (key, value, place) in table(value, "bias_variance", faults) {
            match key {
                "repeats" => {
                    let kind = Kind::Count { min: 2, max: 4096 };
                    repeats = checked(kind, "bias_variance.repeats", value, faults).map_or(repeats, |v| v.count());
                }
                _ => unknown_key(&place, "bias_variance.", key, &["repeats"], faults),
            }
        }
        self.repeats = Some(repeats);
    }

    pub(super) fn read_precompute(&mut self, value: &Spanned<DeValue>, faults: &mut Faults) {
        for (key, value, place) in table(value, "precompute", faults) {
            match index_of(key).filter(|&axis| is_precompute(&AXES[axis])) {
                Some(axis) => {
                    if let Some(v) = checked(AXES[axis].kind, &format!("precompute.{key}"), value, faults) {
                        self.set_base(axis, v, place);
                    }
                }
                None => {
                    let names: Vec<&str> = AXES.iter().filter(|a| is_precompute(a)).map(|a| a.name).collect();
                    unknown_key(&place, "precompute.", key, &names, faults);
                }
            }
        }
    }
}
