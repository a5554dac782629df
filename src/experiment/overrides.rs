//! `--set axis=v1,v2`: axes replaced from the command line.

use super::axis::{AXES, index_of};
use super::config::{Config, Placed, Sweep, axis_names, push_new};
use super::fault::{Faults, Place};
use super::toml_tree::unknown_key;
use super::value::Kind;

/// What a formula's name begins with; its parameters are written with commas.
const BUILTIN_PREFIX: &str = "builtin:";

impl Config {
    /// Replaces axes by `--set` texts; an axis the file does not have is added.
    pub(super) fn apply_overrides(&mut self, faults: &mut Faults) {
        let mut seen: Vec<usize> = Vec::new();
        for text in self.overrides.clone() {
            let Some((name, list)) = text.split_once('=') else {
                faults.add(&Place::Set(text.clone()), "is not axis=value or axis=value,value");
                continue;
            };
            let name = name.trim();
            let place = Place::Set(name.to_owned());
            let Some(axis) = index_of(name) else {
                unknown_key(&place, "axes.", name, &axis_names(), faults);
                continue;
            };
            if seen.contains(&axis) {
                faults.add(&place, format!("stands twice; give all values at once: --set {name}=v1,v2"));
                continue;
            }
            seen.push(axis);
            let kind = AXES[axis].kind;
            let items = items(kind, list);
            let (mut values, written) = (Vec::new(), items.len());
            for item in items {
                match kind.parse_text(&item) {
                    Ok(value) => {
                        push_new(&mut values, Placed { value, place: place.clone() }, &format!("axes.{name}"), faults)
                    }
                    Err(fault) => faults.add(&place, format!("axes.{name}: {fault}")),
                }
            }
            match self.axes.iter_mut().find(|sweep| sweep.axis == axis) {
                Some(sweep) => *sweep = Sweep { axis, values, written },
                None => self.axes.push(Sweep { axis, values, written }),
            }
        }
    }
}

/// The items of a list with commas. A comma between the parameters of a formula ends no item:
/// `builtin:cap:half_angle_deg=10,radiance=100,builtin:sky` are two.
fn items(kind: Kind, list: &str) -> Vec<String> {
    let mut items: Vec<String> = Vec::new();
    for part in list.split(',') {
        let has_parameters =
            |item: &String| item.trim_start().strip_prefix(BUILTIN_PREFIX).is_some_and(|formula| formula.contains(':'));
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
