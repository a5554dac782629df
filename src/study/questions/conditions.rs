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
    let swept = frame.swept(&[Part::Case]);
    let other = swept.iter().copied().find(|known| *known != environment);
    let Some(width) = swept.iter().copied().find(|known| *known == alpha).or(other) else {
        return by_light(&[], vec![(Vec::new(), items.iter().collect())], row, cell);
    };
    let is_by_alpha = width == alpha;
    let widths = ascending(distinct_in_order(items.iter().map(|item| row(item).point.0[width].clone())));
    let first = |text: String, rough: Option<f64>| {
        let mut cells = vec![Cell::Text(text)];
        cells.extend(is_by_alpha.then(|| rough.into()));
        cells
    };
    let group = |value: &Value| {
        let own: Vec<&T> = items.iter().filter(|item| row(item).point.0[width] == *value).collect();
        (first(short(width, value), roughness(value)), own)
    };
    let mut rows: Vec<(Vec<Cell>, Vec<&T>)> = widths.iter().map(group).collect();
    if rows.len() > 1 {
        rows.push((first(ALL.to_owned(), None), items.iter().collect()));
    }
    let names = [AXES[width].name, ROUGHNESS];
    by_light(&names[..if is_by_alpha { 2 } else { 1 }], rows, row, cell)
}

/// A digest with one column an environment and the last over all, whose rows are groups with their first cells.
pub fn by_light<T>(
    names: &[&str],
    rows: Vec<(Vec<Cell>, Vec<&T>)>,
    row: impl Fn(&T) -> &Row,
    cell: impl Fn(&[&T]) -> Cell,
) -> Table {
    let environment = axis("environment");
    let light = |item: &T| row(item).point.0[environment].clone();
    let lights = distinct_in_order(rows.iter().flat_map(|(_, own)| own).map(|item| light(item)));
    let has_all = lights.len() > 1;
    let names = names.iter().map(|name| name.to_string());
    let names = names.chain(lights.iter().map(|value| short(environment, value)));
    let mut table = Table::with_names(names.chain(has_all.then(|| ALL.to_owned())).collect());
    let summed = |own: &[&T]| if own.is_empty() { Cell::Missing } else { cell(own) };
    for (mut cells, own) in rows {
        let under = |wanted: &Value| own.iter().copied().filter(|item| light(item) == *wanted).collect::<Vec<_>>();
        cells.extend(lights.iter().map(|wanted| summed(&under(wanted))));
        cells.extend(has_all.then(|| summed(&own)));
        table.row(cells);
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
        // Of equal ones the first.
        let least = groups.iter().cloned().reduce(|a, b| if b.1 < a.1 { b } else { a })?;
        let most = groups.into_iter().reduce(|a, b| if b.1 > a.1 { b } else { a })?;
        Some((of, [least, most]))
    };
    let change = |(_, [least, most]): &(usize, [(Value, f64); 2])| most.1 / least.1;
    let found = [axis("alpha"), axis("environment")].into_iter().filter_map(of_axis);
    let found = found.filter(|found| change(found) >= factor);
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
