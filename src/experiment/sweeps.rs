//! `[axes]` and `[[zip]]`: lists, ranges, and axes that vary together.

use super::axis::{AXES, ENVIRONMENT, Named, Point};
use super::config::{AXIS, Config, Located, Sweep, Zip, axis_names};
use super::fault::{Faults, Location};
use super::inputs::short_names;
use super::ranges::range_values;
use super::toml_tree::{checked, list, raw, section, start_of, table, unknown_key};
use super::value::{Kind, Raw};
use std::collections::{BTreeMap, HashSet};
use toml::Spanned;
use toml::de::DeValue;

/// Largest number of combinations; planning them takes about ten seconds on one core.
pub(super) const COMBINATIONS_MAX: u64 = 200_000;

impl Config {
    pub(super) fn read_axes(&mut self, value: &Spanned<DeValue>, faults: &mut Faults) {
        for (key, value, location) in table(value, "axes", faults) {
            let Some(named) = Named::find(key) else {
                unknown_key(&location, "axes.", key, &axis_names(), faults);
                continue;
            };
            let name = format!("axes.{key}");
            let axis = named.axis;
            if self.sweep(axis).is_some() {
                let second = AXES[axis].spelling.as_ref();
                faults.add(
                    &location,
                    format!(
                        "{name}: {} and {} are two names of one axis; expected one of them",
                        AXES[axis].name,
                        second.map_or("", |second| second.name)
                    ),
                );
                continue;
            }
            let items = written_values(&name, named.kind(), value, faults);
            let written = items.len();
            let mut values = Vec::new();
            for (item, location) in items {
                match named.parse(&item) {
                    Ok(value) => values.push(Located { value, location }),
                    Err(fault) => faults.add(&location, format!("{name}: {fault}")),
                }
            }
            self.axes.push(Sweep {
                axis,
                named,
                values,
                written,
            });
        }
    }

    pub(super) fn read_zips(&mut self, value: &Spanned<DeValue>, faults: &mut Faults) {
        for item in list(value, "zip", faults) {
            let mut zip = Zip {
                axes: Vec::new(),
                location: start_of(item),
            };
            let mut written = 0;
            for (_, value, location) in section(item, "zip", &["axes"], faults) {
                zip.location = location;
                for name in value.get_ref().as_array().into_iter().flatten() {
                    written += 1;
                    let named =
                        checked(AXIS, "zip.axes", name, faults).and_then(|v| Named::find(v.text()));
                    zip.axes.extend(named.map(|named| named.axis));
                }
            }
            // An unknown name has its own fault.
            if written < 2 {
                faults.add(
                    &zip.location,
                    "zip: needs axes = [...] with at least two axes",
                );
            }
            self.zips.push(zip);
        }
    }

    /// Checks that zipped axes are swept, have one length and belong to one zip. Runs after
    /// `--set`.
    pub(super) fn check_zips(&self, faults: &mut Faults) {
        let mut known = Vec::new();
        for zip in &self.zips {
            let mut lengths = Vec::new();
            for &axis in &zip.axes {
                let name = AXES[axis].name;
                if known.contains(&axis) {
                    faults.add(&zip.location, format!("zip: {name} is listed twice"));
                    continue;
                }
                known.push(axis);
                match self.axes.iter().find(|sweep| sweep.axis == axis) {
                    Some(sweep) => lengths.push((name, sweep.written)),
                    None => faults.add(&zip.location, format!("zip: {name} is not in [axes]")),
                }
            }
            // An axis that could not be read has its own fault.
            lengths.retain(|(_, n)| *n > 0);
            if lengths.windows(2).any(|pair| pair[0].1 != pair[1].1) {
                let value = |n: usize| if n == 1 { "value" } else { "values" };
                let lengths: Vec<String> = lengths
                    .iter()
                    .map(|(name, n)| format!("{name} has {n} {}", value(*n)))
                    .collect();
                faults.add(
                    &zip.location,
                    format!("zip: {}; expected as many for each", lengths.join(", ")),
                );
            }
        }
    }

    /// Reports repeated values of an axis and repeated rows of a zip. Runs after `--set`.
    pub(super) fn check_twice(&self, faults: &mut Faults) {
        for Dimension { members, steps } in self.dimensions() {
            let mut known = HashSet::new();
            for step in 0..steps {
                let row: Vec<&Located> = members
                    .iter()
                    .map(|&member| &self.axes[member].values[step])
                    .collect();
                if !known.insert(row.iter().map(|located| &located.value).collect::<Vec<_>>()) {
                    let values: Vec<String> = members
                        .iter()
                        .zip(&row)
                        .map(|(&member, located)| {
                            let axis = self.axes[member].axis;
                            format!("axes.{}: {}", AXES[axis].name, located.value)
                        })
                        .collect();
                    let values = values.join(", ");
                    let verb = if row.len() == 1 {
                        "is listed twice"
                    } else {
                        "are listed together twice"
                    };
                    faults.add(&row[0].location, format!("{values} {verb}"));
                }
            }
        }
    }

    /// Counts combinations before exclusions.
    pub fn combination_count(&self) -> u64 {
        self.dimensions()
            .iter()
            .map(|dimension| dimension.steps as u64)
            .fold(1, u64::saturating_mul)
    }

    /// Lists every combination over the base point, the last axis fastest; zipped axes step
    /// together.
    pub fn combinations(&self) -> impl Iterator<Item = Point> + '_ {
        let dimensions = self.dimensions();
        let count: usize = dimensions.iter().map(|dimension| dimension.steps).product();
        (0..count).map(move |index| {
            let mut point = self.base.clone();
            let mut rest = index;
            for Dimension { members, steps } in dimensions.iter().rev() {
                for sweep in members.iter().map(|&member| &self.axes[member]) {
                    point[sweep.axis] = sweep.values[rest % steps].value.clone();
                }
                rest /= steps;
            }
            point
        })
    }

    pub fn environment_names(&self) -> BTreeMap<String, String> {
        short_names(self.values(ENVIRONMENT).map(|(value, _)| value.text()))
    }

    /// Groups axes that vary together.
    fn dimensions(&self) -> Vec<Dimension> {
        let mut dimensions: Vec<Dimension> = Vec::new();
        for (index, sweep) in self.axes.iter().enumerate() {
            let zip = self.zips.iter().find(|zip| zip.axes.contains(&sweep.axis));
            let is_zipped_with = |dimension: &&mut Dimension| {
                let mut members = dimension.members.iter();
                zip.is_some_and(|zip| {
                    members.any(|&member| zip.axes.contains(&self.axes[member].axis))
                })
            };
            match dimensions.iter_mut().find(is_zipped_with) {
                // Lengths differ only if there is a fault.
                Some(dimension) => {
                    dimension.members.push(index);
                    dimension.steps = dimension.steps.min(sweep.values.len());
                }
                None => dimensions.push(Dimension {
                    members: vec![index],
                    steps: sweep.values.len(),
                }),
            }
        }
        dimensions
    }
}

/// Axes that vary together: one, or the axes of a zip.
struct Dimension {
    /// Indices into [`Config::axes`].
    members: Vec<usize>,
    steps: usize,
}

/// Lists the values of a sweep as written, a range expanded, each with its location.
fn written_values(
    name: &str,
    kind: Kind,
    value: &Spanned<DeValue>,
    faults: &mut Faults,
) -> Vec<(Raw, Location)> {
    match value.get_ref() {
        DeValue::Array(items) => {
            if items.is_empty() {
                faults.add(
                    &start_of(value),
                    format!("{name}: an axis needs at least one value"),
                );
            }
            items
                .iter()
                .map(|item| (raw(item), start_of(item)))
                .collect()
        }
        DeValue::Table(range) => range_values(name, kind, range, &start_of(value), faults),
        _ => {
            faults.add(
                &start_of(value),
                format!("{name}: {} is not a list of values", raw(value)),
            );
            Vec::new()
        }
    }
}
