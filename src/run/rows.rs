//! Groups items that agree on some axes.
//!
//! An item whose method ignores an axis has no value there. It belongs to every group that it does
//! not contradict: the one `sampled` cell is in the group of `split-sum` at each map size.

use crate::experiment::axis::{AxisId, Point};
use crate::experiment::value::Value;
use indexmap::IndexMap;
use std::collections::{HashMap, HashSet};

/// Values on some axes.
pub type Key = Vec<Value>;

/// Groups with their keys, in the order of their first item with all values; each in the order of
/// the items.
pub fn rows<T: Copy>(items: &[T], key: impl Fn(T) -> Key) -> Vec<(Key, Vec<T>)> {
    let mut groups: IndexMap<Key, Vec<usize>> = IndexMap::new();
    for (index, item) in items.iter().enumerate() {
        groups.entry(key(*item)).or_default().push(index);
    }
    let (keys, members): (Vec<Key>, Vec<Vec<usize>>) = groups.into_iter().unzip();
    let partial_keys = PartialKeys::new(keys.iter());
    // The groups whose keys each group's key extends.
    let extended: Vec<Vec<usize>> = keys
        .iter()
        .enumerate()
        .map(|(group, key)| {
            let mut found = partial_keys.extended_by(key);
            found.retain(|other| *other != group);
            found
        })
        .collect();
    let is_extended: HashSet<usize> = extended.iter().flatten().copied().collect();
    let mut rows = Vec::new();
    for (group, key) in keys.into_iter().enumerate() {
        if is_extended.contains(&group) {
            continue;
        }
        let mut indices = members[group].clone();
        for other in &extended[group] {
            indices.extend(&members[*other]);
        }
        indices.sort_unstable();
        indices.dedup();
        rows.push((key, indices.into_iter().map(|index| items[index]).collect()));
    }
    rows
}

/// The keys that lack a value, by which axes are set and then by the values: there may be a key for
/// each item, so that a search among all is slow.
struct PartialKeys<'k> {
    groups: HashMap<Vec<bool>, HashMap<Vec<&'k Value>, usize>>,
}

impl<'k> PartialKeys<'k> {
    fn new(keys: impl Iterator<Item = &'k Key>) -> Self {
        let mut groups: HashMap<Vec<bool>, HashMap<Vec<&Value>, usize>> = HashMap::new();
        for (group, key) in keys.enumerate() {
            let is_set: Vec<bool> = key.iter().map(|value| *value != Value::Unset).collect();
            if is_set.contains(&false) {
                let values = set_values(key, &is_set);
                groups.entry(is_set).or_default().insert(values, group);
            }
        }
        Self { groups }
    }

    /// The groups whose set values `key` has, too.
    fn extended_by(&self, key: &Key) -> Vec<usize> {
        self.groups
            .iter()
            .filter_map(|(is_set, by_values)| by_values.get(&set_values(key, is_set)).copied())
            .collect()
    }
}

/// The values of a key on the axes that are set.
fn set_values<'k>(key: &'k Key, is_set: &[bool]) -> Vec<&'k Value> {
    key.iter()
        .zip(is_set)
        .filter(|(_, is_set)| **is_set)
        .map(|(value, _)| value)
        .collect()
}

/// The first point of a row with a value on an axis, else its first point.
pub fn representative<'p>(row: impl IntoIterator<Item = &'p Point>, axis: AxisId) -> &'p Point {
    let mut points = row.into_iter();
    let first = points.next().expect("a row has at least one cell");
    std::iter::once(first)
        .chain(points)
        .find(|point| point[axis] != Value::Unset)
        .unwrap_or(first)
}
