//! A number of each image of a group, and how it hangs on alpha, on the environment and on other axes of cases: digests, extremes, changes
//! of sign.

use super::words::{cases_sentence, label, listed, number, short};
use crate::runner::axis::{ALPHA, AXES, ENVIRONMENT, Part, SAMPLES};
use crate::runner::value::Value;
use crate::study::frame::estimate::{Estimate, estimate};
use crate::study::frame::{Frame, Row, values};
use crate::study::table::Table;
use crate::table::csv::Cell;

/// The name of the last row and column.
pub const ALL: &str = "all";

/// Groups by their value on an axis, ascending, each with its number.
pub type Along = Vec<(Value, f64)>;

/// A number of each image, summed up over any group of them by one statistic.
#[derive(Clone)]
pub struct Numbers<'r, 'f> {
    items: Vec<(&'r Row<'f>, f64)>,
    statistic: fn(&[f64]) -> f64,
}

impl<'r, 'f> Numbers<'r, 'f> {
    pub fn new(items: impl IntoIterator<Item = (&'r Row<'f>, f64)>, statistic: fn(&[f64]) -> f64) -> Self {
        Self { items: items.into_iter().collect(), statistic }
    }

    pub fn len(&self) -> usize {
        self.items.len()
    }

    /// How many of the numbers are of this kind.
    pub fn count(&self, is: impl Fn(f64) -> bool) -> usize {
        self.items.iter().filter(|(_, number)| is(*number)).count()
    }

    /// Of the images with this value on an axis.
    pub fn at(&self, of: usize, value: &Value) -> Self {
        let own = self.items.iter().copied().filter(|(row, _)| row.point[of] == *value);
        Self::new(own, self.statistic)
    }

    fn rows(&self) -> impl Iterator<Item = &'r Row<'f>> {
        self.items.iter().map(|(row, _)| *row)
    }

    /// The different values of an axis, ascending.
    pub fn values(&self, of: usize) -> Vec<Value> {
        values(self.rows(), of)
    }

    /// The number of the whole group; NaN for none.
    pub fn value(&self) -> f64 {
        (self.statistic)(&self.items.iter().map(|(_, number)| *number).collect::<Vec<_>>())
    }

    /// The same with its interval over environments; nothing for none.
    pub fn estimate(&self) -> Option<Estimate> {
        let values = self.items.iter().map(|(row, number)| (row.point[ENVIRONMENT].clone(), *number));
        estimate(&values.collect::<Vec<_>>(), self.statistic)
    }

    /// "The 30 cases: 2 environments ..."
    pub fn scope(&self, axes: &[usize]) -> String {
        cases_sentence(&self.rows().collect::<Vec<_>>(), axes)
    }

    /// ", under sky" of one case, ", in the median case" or the like of several.
    pub fn place(&self, several: &str) -> String {
        match self.items.as_slice() {
            [(only, _)] => format!(", under {}", short(ENVIRONMENT, &only.point[ENVIRONMENT])),
            _ => several.to_owned(),
        }
    }

    /// The number at each value of an axis.
    pub fn along(&self, of: usize) -> Along {
        self.values(of).into_iter().map(|value| (value.clone(), self.at(of, &value).value())).collect()
    }

    /// " By alpha it runs from 16 for alpha 0.5 to 64 for alpha 0.05.": the axis, alpha or environment, along which a positive number changes
    /// most; nothing where it changes by less than this factor along both.
    pub fn extremes(&self, subject: &str, factor: f64, words: impl Fn(f64) -> String) -> String {
        let of_axis = |of: usize| {
            let mut groups = self.along(of);
            groups.retain(|(_, number)| !number.is_nan());
            // Of equal ones the first.
            let least = groups.iter().cloned().reduce(|a, b| if b.1 < a.1 { b } else { a })?;
            let most = groups.into_iter().reduce(|a, b| if b.1 > a.1 { b } else { a })?;
            Some((most.1 / least.1, of, [least, most]))
        };
        let found = [ALPHA, ENVIRONMENT].into_iter().filter_map(of_axis).filter(|(change, ..)| *change >= factor);
        let Some((_, of, ends)) = found.reduce(|a, b| if b.0 > a.0 { b } else { a }) else { return String::new() };
        let [least, most] = ends.map(|(value, number)| format!("{} for {}", words(number), label(&[of], &[value])));
        format!(" By {} {subject} runs from {least} to {most}.", AXES[of].name)
    }

    /// The first axis of cases along which a ratio is below 1 here and above it there, with the ratio at each of its values.
    pub fn change_of_sign(&self, frame: &Frame) -> Option<(usize, Along)> {
        let first = [ALPHA, ENVIRONMENT];
        let others = frame.swept(&[Part::Case]).into_iter().filter(|of| !first.contains(of));
        first.into_iter().chain(others).map(|of| (of, self.along(of))).find(|(_, groups)| {
            let has = |is: fn(f64) -> bool| groups.iter().any(|(_, ratio)| is(*ratio));
            has(|ratio| ratio < 1.0 / (1.0 + SAME)) && has(|ratio| ratio > 1.0 + SAME)
        })
    }

    /// The estimate in words, as a cell.
    pub fn cell(&self, words: &dyn Fn(&Estimate) -> String) -> Cell {
        self.estimate().map(|estimate| words(&estimate)).into()
    }

    /// A digest: one row a value of alpha, with perceptual roughness beside it, one column an environment; the last ones over all. Without
    /// alpha the rows are those of the first other axis that tells cases apart.
    pub fn digest(&self, frame: &Frame, words: &dyn Fn(&Estimate) -> String) -> Table {
        let swept = frame.swept(&[Part::Case]);
        let other = swept.iter().copied().find(|of| *of != ENVIRONMENT);
        let Some(width) = swept.iter().copied().find(|of| *of == ALPHA).or(other) else {
            return by_light(&[], &[(Vec::new(), self.clone())], words);
        };
        let columns = if width == ALPHA { 2 } else { 1 };
        let head = |name: String, rough: Option<f64>| [Cell::from(name), rough.into()][..columns].to_vec();
        let values = self.values(width);
        let row = |value: &Value| (head(short(width, value), roughness(value)), self.at(width, value));
        let mut rows: Vec<(Vec<Cell>, Self)> = values.iter().map(row).collect();
        rows.extend((values.len() > 1).then(|| (head(ALL.to_owned(), None), self.clone())));
        by_light(&[AXES[width].name, ROUGHNESS][..columns], &rows, words)
    }
}

/// "0.25 (0.50) and 0.5 (0.25)": the values with a ratio below 1, and those with one above.
pub fn sides(of: usize, groups: &Along) -> [String; 2] {
    let (less, more): (Vec<_>, Vec<_>) = groups.iter().partition(|(_, ratio)| *ratio < 1.0);
    let words = |(at, ratio): &(Value, f64)| format!("{} ({})", short(of, at), number(*ratio));
    [less, more].map(|own| listed(&own.into_iter().map(words).collect::<Vec<_>>()))
}

/// A digest with one column an environment and the last over all, whose rows are groups with their first cells.
pub fn by_light(names: &[&str], rows: &[(Vec<Cell>, Numbers)], words: &dyn Fn(&Estimate) -> String) -> Table {
    let lights = values(rows.iter().flat_map(|(_, own)| own.rows()), ENVIRONMENT);
    let has_all = lights.len() > 1;
    let names = names.iter().map(|name| name.to_string());
    let names = names.chain(lights.iter().map(|light| short(ENVIRONMENT, light)));
    let mut table = Table::with_names(names.chain(has_all.then(|| ALL.to_owned())));
    for (head, own) in rows {
        let cells = lights.iter().map(|light| own.at(ENVIRONMENT, light).cell(words));
        table.row(head.iter().cloned().chain(cells).chain(has_all.then(|| own.cell(words))).collect());
    }
    table
}

/// How far a sample count is from the default, by ratio.
pub fn from_usual(samples: u32) -> f64 {
    (f64::from(samples) / f64::from((AXES[SAMPLES].default)().count())).ln().abs()
}

/// The column beside alpha.
pub const ROUGHNESS: &str = "perceptual_roughness";

/// The perceptual roughness of an alpha.
pub fn roughness(alpha: &Value) -> Option<f64> {
    if let Value::Number(alpha) = alpha { Some(alpha.sqrt()) } else { None }
}

/// "alpha 0.05 (roughness 0.22)", "sky".
pub fn heading(of: usize, value: &Value) -> String {
    let name = label(&[of], std::slice::from_ref(value));
    match roughness(value).filter(|_| of == ALPHA) {
        Some(rough) => format!("{name} (roughness {})", number(rough)),
        None => name,
    }
}

/// Ratios nearer to 1 than this are on neither side of it.
const SAME: f64 = 0.05;
