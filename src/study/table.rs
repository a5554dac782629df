//! Tables of answers, as CSV and as Markdown.

pub use crate::run::columns::{Column, column};

use crate::base::csv::{self, Cell};
use crate::draw::markdown::{Align, MarkdownTable, significant};
use crate::draw::variant::Variant;
use crate::draw::words::{Extent, Number, Quantity};
use crate::experiment::axis::Named;
use crate::experiment::axis::named::columns;
use crate::experiment::axis::{AxisId, METHOD};
use crate::experiment::value::Value;
use indexmap::IndexSet;
use std::collections::HashMap;

#[derive(Clone, Debug, Default, PartialEq)]
pub struct Table {
    /// The names of columns in files.
    pub columns: Vec<String>,
    /// Labels for readers of columns that have the name of a variant, by that name.
    pub labels: HashMap<String, String>,
    pub rows: Vec<Vec<Cell>>,
}

/// What the cells of a column are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ColumnKind {
    Texts,
    /// Numbers alone, which are comparable digit by digit.
    Numbers,
    /// Some cells are numbers with words, such as units and intervals, or some are texts.
    Mixed,
}

impl From<&Value> for Cell {
    fn from(value: &Value) -> Self {
        match value {
            Value::Unset => Self::Missing,
            Value::Number(number) => Self::Number(*number),
            Value::Count(count) => (*count).into(),
            Value::Text(text) => Self::Text(text.clone()),
            Value::Color(_) | Value::Pair(_) => value.to_string().into(),
        }
    }
}

impl From<Number> for Cell {
    fn from(number: Number) -> Self {
        Self::quantity(number.to_string())
    }
}

impl From<Extent> for Cell {
    fn from(extent: Extent) -> Self {
        Self::quantity(extent.to_string())
    }
}

impl From<Quantity> for Cell {
    fn from(quantity: Quantity) -> Self {
        Self::quantity(quantity.to_string())
    }
}

/// A value on an axis; a method has its label, too.
pub fn value_cell(axis: AxisId, value: &Value) -> Cell {
    if axis == METHOD && *value != Value::Unset {
        (&Variant::new(value.to_string())).into()
    } else {
        value.into()
    }
}

/// Cells of values on these axes, under the columns of [`Table::new`].
pub fn axis_cells(axes: &[AxisId], key: &[Value]) -> Vec<Cell> {
    let cells = |(&axis, value): (&AxisId, &Value)| {
        let usual = Named::usual(axis);
        [
            Some(value_cell(axis, value)),
            usual.is_second().then(|| (&usual.shown(value)).into()),
        ]
        .into_iter()
        .flatten()
    };
    axes.iter().zip(key).flat_map(cells).collect()
}

macro_rules! cells {
    ($($cell:expr),* $(,)?) => { vec![$(crate::base::csv::Cell::from($cell)),*] };
}
pub(super) use cells;

/// Significant digits in Markdown; CSV has all.
const DIGITS: usize = 3;

impl Table {
    /// An empty table: these axes by all their names, then further columns.
    pub fn new(axes: &[AxisId], more: &[Column]) -> Self {
        let axes = axes.iter().flat_map(|&axis| columns(axis));
        Self::with_names(axes.chain(more.iter().map(|column| column.name)))
    }

    pub fn with_names(columns: impl IntoIterator<Item: Into<String>>) -> Self {
        Self {
            columns: columns.into_iter().map(Into::into).collect(),
            ..Self::default()
        }
    }

    /// With the labels of columns that have the names of these variants.
    pub fn with_labels<'v>(mut self, variants: impl IntoIterator<Item = &'v Variant>) -> Self {
        let labels = variants.into_iter();
        self.labels
            .extend(labels.map(|variant| (variant.to_string(), variant.label())));
        self
    }

    /// The name of a column in words.
    pub fn label(&self, column: usize) -> String {
        let name = &self.columns[column];
        let label = self.labels.get(name).cloned();
        label.unwrap_or_else(|| name.replace('_', " "))
    }

    /// What the cells of a column are; empty ones count as any.
    pub fn kind(&self, column: usize) -> ColumnKind {
        let mut has_number = false;
        let mut has_quantity = false;
        let mut has_text = false;
        for row in &self.rows {
            match row[column] {
                Cell::Number(_) | Cell::Integer(_) => has_number = true,
                Cell::Quantity(_) => has_quantity = true,
                Cell::Text(_) | Cell::Named(_) => has_text = true,
                Cell::Missing => {}
            }
        }
        if !has_quantity && !has_text {
            ColumnKind::Numbers
        } else if !has_quantity && !has_number {
            ColumnKind::Texts
        } else {
            ColumnKind::Mixed
        }
    }

    /// The rows of several tables under the names of all their columns, each after the name of its
    /// table in a column `head`.
    pub fn united(head: &str, tables: Vec<(&str, Self)>) -> Self {
        let names = tables.iter().flat_map(|(_, table)| table.columns.clone());
        let names: IndexSet<String> = std::iter::once(head.to_owned()).chain(names).collect();
        let mut all = Self::with_names(names);
        for (name, table) in tables {
            let name = Cell::from(name);
            all.labels.extend(table.labels);
            // Where this table has each column.
            let indices: Vec<Option<usize>> = all
                .columns
                .iter()
                .skip(1)
                .map(|column| table.columns.iter().position(|known| known == column))
                .collect();
            for row in table.rows {
                let cells = indices
                    .iter()
                    .map(|index| index.map_or(Cell::Missing, |index| row[index].clone()));
                all.rows
                    .push(std::iter::once(name.clone()).chain(cells).collect());
            }
        }
        all
    }

    /// The table with at most so many rows.
    pub fn first(&self, most: usize) -> Self {
        Self {
            columns: self.columns.clone(),
            labels: self.labels.clone(),
            rows: self.rows.iter().take(most).cloned().collect(),
        }
    }

    /// Adds a row, as long as the columns.
    pub fn row(&mut self, cells: Vec<Cell>) {
        assert_eq!(
            cells.len(),
            self.columns.len(),
            "a row has a cell for each column"
        );
        self.rows.push(cells);
    }

    /// Removes columns that are empty in every row.
    pub fn without_empty(mut self) -> Self {
        let is_empty = |column: usize| self.rows.iter().all(|row| row[column] == Cell::Missing);
        for column in (0..self.columns.len())
            .rev()
            .filter(|&column| is_empty(column))
            .collect::<Vec<_>>()
        {
            self.columns.remove(column);
            self.rows
                .iter_mut()
                .for_each(|row| drop(row.remove(column)));
        }
        self
    }

    pub fn csv(&self) -> String {
        String::from_utf8_lossy(&csv::to_text(
            &self.columns,
            self.rows.iter().map(Vec::as_slice),
        ))
        .into_owned()
    }

    pub fn markdown(&self) -> String {
        let align = |column: usize| match self.kind(column) {
            ColumnKind::Numbers => Align::Right,
            ColumnKind::Texts | ColumnKind::Mixed => Align::Left,
        };
        let columns: Vec<(&str, Align)> = self
            .columns
            .iter()
            .enumerate()
            .map(|(column, name)| (name.as_str(), align(column)))
            .collect();
        let mut table = MarkdownTable::new(&columns);
        for row in &self.rows {
            table.row(&row.iter().map(shown).collect::<Vec<_>>());
        }
        table.to_string()
    }
}

/// A cell in Markdown, with the names that files have.
pub fn shown(cell: &Cell) -> String {
    match cell {
        Cell::Number(number) => significant(*number, DIGITS),
        Cell::Integer(integer) => integer.to_string(),
        Cell::Text(_) | Cell::Quantity(_) | Cell::Named(_) | Cell::Missing => {
            cell.text().unwrap_or_default().to_owned()
        }
    }
}

/// As [`shown`], with labels in place of code names.
pub fn labelled(cell: &Cell) -> String {
    match cell {
        Cell::Named(named) => named.label.clone(),
        other => shown(other),
    }
}
