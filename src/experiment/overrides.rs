//! `--set axis=v1,v2`: values from the command line.

use super::axis::{AXES, Named};
use super::config::{
    Config, KEYS, Located, METRIC_KEY, NOISE_SHARE_KEY, NOISE_SHARE_KIND, Sweep, axis_names,
};
use super::fault::{Faults, Location};
use super::toml_tree::unknown_key;
use super::value::{Kind, Value};
use crate::instrument::environment::BUILTIN_PREFIX;
use std::path::Path;

impl Config {
    /// Replaces or adds axes by `--set` texts, and sets the noise share of references.
    pub(super) fn apply_overrides(&mut self, faults: &mut Faults) {
        let mut set: Vec<Named> = Vec::new();
        let mut is_share_set = false;
        for text in self.overrides.clone() {
            let Some((name, list)) = text.split_once('=') else {
                faults.add(
                    &Location::Set(text.clone()),
                    "is not axis=value or axis=value,value",
                );
                continue;
            };
            let name = name.trim();
            let location = Location::Set(name.to_owned());
            if name == NOISE_SHARE_KEY {
                if std::mem::replace(&mut is_share_set, true) {
                    faults.add(&location, "is set twice; give it once");
                }
                match NOISE_SHARE_KIND.parse_text(list) {
                    Ok(share) => self.set_noise_share(share.number(), location),
                    Err(fault) => faults.add(&location, format!("reference.{name}: {fault}")),
                }
                continue;
            }
            let Some(named) = Named::find(name) else {
                refuse_name(name, &location, faults);
                continue;
            };
            if let Some(earlier) = set.iter().find(|other| other.axis == named.axis) {
                let earlier = earlier.name();
                let fault = if earlier == name {
                    format!("is set twice; give all values at once: --set {name}=v1,v2")
                } else {
                    format!("is the axis of --set {earlier} in another unit; give one of them")
                };
                faults.add(&location, fault);
                continue;
            }
            set.push(named);
            let sweep = read_sweep(named, list, &location, faults);
            match self.axes.iter_mut().find(|old| old.axis == named.axis) {
                Some(old) => self.set_aside.push(std::mem::replace(old, sweep)),
                None => self.axes.push(sweep),
            }
        }
    }

    /// Returns the folder of `--set` paths, if any value of `--set` is a file there.
    pub fn set_files_dir(&self) -> Option<&Path> {
        let set = self
            .inputs()
            .filter(|(_, location)| matches!(location, Location::Set(_)));
        set.into_iter()
            .any(|(value, _)| self.set_dir.join(value).is_file())
            .then_some(&self.set_dir)
    }

    /// Returns the folder of the file's paths, if any value of the file is a file there.
    pub fn files_dir(&self) -> Option<&Path> {
        let dir = self.file_dir();
        let written = self
            .inputs()
            .filter(|(_, location)| matches!(location, Location::File(_)));
        written
            .into_iter()
            .any(|(value, _)| dir.join(value).is_file())
            .then_some(dir)
    }

    /// Returns the folder of a path written at `location`.
    pub fn dir_of(&self, location: &Location) -> &Path {
        match location {
            Location::Set(_) => &self.set_dir,
            Location::File(_) | Location::Default => self.file_dir(),
        }
    }

    pub fn file_dir(&self) -> &Path {
        self.file_dir
            .as_deref()
            .unwrap_or_else(|| self.path.parent().unwrap_or(Path::new("")))
    }

    /// Lists every value that may be a file, with its location.
    fn inputs(&self) -> impl Iterator<Item = (&str, &Location)> {
        AXES.entries().flat_map(|(axis, entry)| {
            let texts = self
                .values(axis)
                .filter(|(value, _)| matches!(value, Value::Text(_)));
            texts
                .filter_map(|(value, location)| Some((entry.kind.path_in(value.text())?, location)))
        })
    }
}

/// Reports a name without an axis.
fn refuse_name(name: &str, location: &Location, faults: &mut Faults) {
    if !KEYS.iter().any(|(key, _)| *key == name) {
        return unknown_key(location, "axes.", name, &axis_names(), faults);
    }
    let or_flag = if name == METRIC_KEY {
        ", or give --metric to `splitsum answers`"
    } else {
        ""
    };
    let fault =
        format!("is a key of the experiment, not an axis; write {name} = ... in the file{or_flag}");
    faults.add(location, fault);
}

/// Reads the values of one `--set`.
fn read_sweep(named: Named, list: &str, location: &Location, faults: &mut Faults) -> Sweep {
    let items = items(named.kind(), list);
    let written = items.len();
    let mut values = Vec::new();
    for item in items {
        match named.parse_text(&item) {
            Ok(value) => values.push(Located {
                value,
                location: location.clone(),
            }),
            Err(fault) => faults.add(location, format!("axes.{}: {fault}", named.name())),
        }
    }
    Sweep {
        axis: named.axis,
        named,
        values,
        written,
    }
}

/// The items of a list with commas. A comma between the parameters of a formula ends no item:
/// `builtin:cap:half_angle_deg=10,radiance=100,builtin:sky` are two.
fn items(kind: Kind, list: &str) -> Vec<String> {
    let mut items: Vec<String> = Vec::new();
    for part in list.split(',') {
        let has_parameters = |item: &String| {
            item.trim_start()
                .strip_prefix(BUILTIN_PREFIX)
                .is_some_and(|formula| formula.contains(':'))
        };
        let is_assignment = part.split_once('=').is_some_and(|(key, _)| {
            let key = key.trim();
            !key.is_empty() && key.chars().all(|c| c.is_ascii_alphanumeric() || c == '_')
        });
        match items.last_mut() {
            Some(item) if matches!(kind, Kind::Input) && is_assignment && has_parameters(item) => {
                item.push(',');
                item.push_str(part);
            }
            _ => items.push(part.to_owned()),
        }
    }
    items
}
