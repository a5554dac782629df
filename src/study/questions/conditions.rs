//! How a number hangs on alpha, on the environment and on other axes of cases: a digest by the two, the extremes along one, changes of
//! sign.

use super::words::{label, short};
use crate::runner::axis::{AXES, Part};
use crate::runner::value::Value;
use crate::study::frame::{Frame, Row, ascending, axis, distinct_in_order};
use crate::study::table::Table;
use crate::table::csv::Cell;

/// The name of the last row and column.
const ALL: &str = "all";

/// Groups of items by their value on an axis, ascending, each with its number.
pub type Along = Vec<(Value, f64)>;

/// A digest: one row a value of alpha, with perceptual roughness beside it, one column an environment; the last ones over all. Without
/// alpha the rows are those of the first other axis that tells cases apart.
pub fn by_width_and_light<T>(
    frame: &Frame,
    items: &[T],
    row: impl Fn(&T) -> &Row,
    cell: impl Fn(&[&T]) -> Cell,
) -> Table {
    let (alpha, environment) = (axis("alpha"), axis("environment"));
    let others = frame.swept(&[Part::Case]).into_iter().filter(|known| *known != environment);
    let width = if frame.shape.is_swept(alpha) { Some(alpha) } else { others.into_iter().next() };
    let values = |of: usize| ascending(distinct_in_order(items.iter().map(|item| row(item).point.0[of].clone())));
    let lights = values(environment);
    let widths = width.map_or_else(|| vec![Value::Unset], values);
    let is_by_alpha = width == Some(alpha);
    let mut names: Vec<String> = width.iter().map(|of| AXES[*of].name.to_owned()).collect();
    names.extend(is_by_alpha.then(|| ROUGHNESS.to_owned()));
    names.extend(lights.iter().map(|value| short(environment, value)));
    names.extend((lights.len() > 1).then(|| ALL.to_owned()));
    let mut table = Table::with_names(names);
    let of_row = |value: Option<&Value>| {
        let mut cells: Vec<Cell> =
            width.iter().map(|of| Cell::Text(value.map_or(ALL.to_owned(), |value| short(*of, value)))).collect();
        if is_by_alpha {
            cells.push(value.and_then(roughness).into());
        }
        let all = (lights.len() > 1).then_some(None);
        for light in lights.iter().map(Some).chain(all) {
            let is_own = |item: &&T| {
                let point = &row(item).point.0;
                width.zip(value).is_none_or(|(of, value)| point[of] == *value)
                    && light.is_none_or(|light| point[environment] == *light)
            };
            let own: Vec<&T> = items.iter().filter(is_own).collect();
            cells.push(if own.is_empty() { Cell::Missing } else { cell(&own) });
        }
        cells
    };
    widths.iter().for_each(|value| table.row(of_row(Some(value))));
    if widths.len() > 1 {
        table.row(of_row(None));
    }
    table
}

/// The column beside alpha.
pub const ROUGHNESS: &str = "perceptual_roughness";

/// The perceptual roughness of an alpha.
pub fn roughness(alpha: &Value) -> Option<f64> {
    match alpha {
        Value::Number(alpha) => Some(alpha.sqrt()),
        _ => None,
    }
}

/// "alpha 0.05 (roughness 0.22)", "sky".
pub fn heading(of: usize, value: &Value) -> String {
    let name = label(&[of], std::slice::from_ref(value));
    match (of == axis("alpha"), roughness(value)) {
        (true, Some(rough)) => format!("{name} (roughness {})", super::words::number(rough)),
        _ => name,
    }
}

/// A number of the items at each value of an axis.
pub fn along<T>(items: &[T], row: impl Fn(&T) -> &Row, of: usize, number: impl Fn(&[&T]) -> f64) -> Along {
    let value = |item: &T| row(item).point.0[of].clone();
    let values = ascending(distinct_in_order(items.iter().map(value)));
    let group = |wanted: Value| {
        let own: Vec<&T> = items.iter().filter(|item| value(item) == wanted).collect();
        (wanted, number(&own))
    };
    values.into_iter().map(group).collect()
}

/// The axis, alpha or environment, along which a positive number changes most, and where it is least and most; nothing where it changes by
/// less than this factor along both.
pub fn extremes<T>(
    items: &[T],
    row: impl Fn(&T) -> &Row,
    number: impl Fn(&[&T]) -> f64,
    factor: f64,
) -> Option<(usize, [(Value, f64); 2])> {
    let of_axis = |of: usize| {
        let mut groups = along(items, &row, of, &number);
        groups.retain(|(_, number)| !number.is_nan());
        groups.sort_by(|a, b| a.1.total_cmp(&b.1));
        let (least, most) = (groups.first()?.clone(), groups.last()?.clone());
        Some((of, [least, most]))
    };
    let change = |(_, [least, most]): &(usize, [(Value, f64); 2])| most.1 / least.1;
    let found = [axis("alpha"), axis("environment")].into_iter().filter_map(of_axis);
    let found = found.filter(|found| change(found) >= factor);
    // Of equal ones the first.
    found.reduce(|a, b| if change(&b) > change(&a) { b } else { a })
}

/// Ratios nearer to 1 than this are on neither side of it.
const SAME: f64 = 0.05;

/// The first axis of cases along which a ratio is below 1 here and above it there, with the ratio at each of its values.
pub fn change_of_sign<T>(
    frame: &Frame,
    items: &[T],
    row: impl Fn(&T) -> &Row,
    ratio: impl Fn(&[&T]) -> f64,
) -> Option<(usize, Along)> {
    let first = [axis("alpha"), axis("environment")];
    let others = frame.swept(&[Part::Case]).into_iter().filter(|of| !first.contains(of));
    let axes = first.into_iter().chain(others);
    axes.map(|of| (of, along(items, &row, of, &ratio))).find(|(_, groups)| {
        let has = |is: fn(f64) -> bool| groups.iter().any(|(_, ratio)| is(*ratio));
        has(|ratio| ratio < 1.0 / (1.0 + SAME)) && has(|ratio| ratio > 1.0 + SAME)
    })
}
