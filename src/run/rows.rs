//! Groups cells that agree on some axes.
//!
//! A cell whose method ignores an axis has no value there. It belongs to every row that it does not contradict: the one `sampled` cell
//! is beside `split-sum` at each map size.

use crate::experiment::axis::Point;
use crate::experiment::value::Value;

/// Items in rows, each in the order of the items; a row has the order of its first item with all values.
pub fn rows<'i, T>(items: &'i [T], axes: &[usize], point: impl Fn(&T) -> &Point) -> Vec<Vec<&'i T>> {
    let key = |item: &'i T| axes.iter().map(|&axis| point(item)[axis].clone()).collect::<Vec<_>>();
    let mut keys: Vec<Vec<Value>> = Vec::new();
    for item in items {
        let key = key(item);
        if !keys.contains(&key) {
            keys.push(key);
        }
    }
    let whole: Vec<&Vec<Value>> =
        keys.iter().filter(|key| !keys.iter().any(|other| other != *key && fits(key, other))).collect();
    whole.into_iter().map(|row| items.iter().filter(|item| fits(&key(item), row)).collect()).collect()
}

/// Whether the set values of `key` are those of `row`.
fn fits(key: &[Value], row: &[Value]) -> bool {
    key.iter().zip(row).all(|(value, of_row)| *value == Value::Unset || value == of_row)
}

/// The first point of a row with a value on an axis, else its first point.
pub fn teller<'p>(row: impl IntoIterator<Item = &'p Point>, axis: usize) -> &'p Point {
    let mut points = row.into_iter();
    let first = points.next().expect("a row has at least one cell");
    let is_set = |point: &&Point| point[axis] != Value::Unset;
    std::iter::once(first).chain(points).find(is_set).unwrap_or(first)
}
