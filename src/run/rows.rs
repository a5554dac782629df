//! Groups items that agree on some axes.
//!
//! An item whose method ignores an axis has no value there. It belongs to every group that it does
//! not contradict: the one `sampled` cell is beside `split-sum` at each map size.

use crate::experiment::axis::AxisId;
use crate::experiment::axis::Point;
use crate::experiment::value::Value;
use indexmap::IndexMap;
use std::collections::{HashMap, HashSet};

/// Values on some axes.
pub type Key = Vec<Value>;

/// Groups with their keys, in the order of their first item with all values; each in the order of
/// the items.
pub fn rows<T: Copy>(items: &[T], key: impl Fn(T) -> Key) -> Vec<(Key, Vec<T>)> {
    let mut groups: IndexMap<Key, Vec<usize>> = IndexMap::new();
    (0..items.len()).for_each(|item| groups.entry(key(items[item])).or_default().push(item));
    // Keys by their set axes and values, to look up the keys within a key: there may be a key per
    // item.
    let mut partial: HashMap<Vec<bool>, HashMap<Vec<&Value>, usize>> = HashMap::new();
    for (place, key) in groups.keys().enumerate() {
        let is_set: Vec<bool> = key.iter().map(|value| *value != Value::Unset).collect();
        let values = key.iter().filter(|value| **value != Value::Unset).collect();
        partial.entry(is_set).or_default().insert(values, place);
    }
    partial.retain(|is_set, _| is_set.contains(&false));
    let within = |(of, key): (usize, &Key)| -> Vec<usize> {
        let own = partial.iter().filter_map(|(is_set, places)| {
            let values: Vec<&Value> = key
                .iter()
                .zip(is_set)
                .filter(|(_, is)| **is)
                .map(|(value, _)| value)
                .collect();
            places.get(&values).copied()
        });
        own.filter(|&place| place != of).collect()
    };
    let within: Vec<Vec<usize>> = groups.keys().enumerate().map(within).collect();
    let is_part: HashSet<usize> = within.iter().flatten().copied().collect();
    let group = |(of, (key, own)): (usize, (&Key, &Vec<usize>))| {
        let mut all: Vec<usize> = within[of]
            .iter()
            .flat_map(|part| &groups[*part])
            .chain(own)
            .copied()
            .collect();
        all.sort_unstable();
        all.dedup();
        (
            key.clone(),
            all.into_iter().map(|item| items[item]).collect(),
        )
    };
    groups
        .iter()
        .enumerate()
        .filter(|(place, _)| !is_part.contains(place))
        .map(group)
        .collect()
}

/// The first point of a row with a value on an axis, else its first point.
pub fn teller<'p>(row: impl IntoIterator<Item = &'p Point>, axis: AxisId) -> &'p Point {
    let mut points = row.into_iter();
    let first = points.next().expect("a row has at least one cell");
    let is_set = |point: &&Point| point[axis] != Value::Unset;
    std::iter::once(first)
        .chain(points)
        .find(is_set)
        .unwrap_or(first)
}
