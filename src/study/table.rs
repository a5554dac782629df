//! Tables of answers, as CSV and as Markdown.

pub use crate::run::columns::{Column, column};

use crate::base::csv::{self, Cell};
use crate::draw::markdown::{Align, MarkdownTable, significant};
use crate::experiment::axis::AxisId;
use crate::experiment::axis::Named;
use crate::experiment::axis::named::columns;
use crate::experiment::value::Value;
use indexmap::IndexSet;

#[derive(Clone, Debug, Default, PartialEq)]
pub struct Table {
    pub columns: Vec<String>,
    pub rows: Vec<Vec<Cell>>,
}

impl From<&Value> for Cell {
    fn from(value: &Value) -> Self {
        match value {
            Value::Unset => Self::Missing,
            Value::Number(number) => Self::Number(*number),
            Value::Count(count) => (*count).into(),
            other => other.to_string().into(),
        }
    }
}

/// Cells of values on these axes, under the columns of [`Table::new`].
pub fn axis_cells(axes: &[AxisId], key: &[Value]) -> Vec<Cell> {
    let cells = |(&axis, value): (&AxisId, &Value)| {
        let usual = Named::usual(axis);
        [
            Some(value.into()),
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
            rows: Vec::new(),
        }
    }

    /// The rows of several tables under the names of all their columns, each after the name of its
    /// table in a column `head`.
    pub fn united(head: &str, tables: Vec<(&str, Self)>) -> Self {
        let names = tables.iter().flat_map(|(_, table)| table.columns.clone());
        let names: IndexSet<String> = std::iter::once(head.to_owned()).chain(names).collect();
        let mut all = Self::with_names(names);
        for (name, table) in tables {
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
                    .push(std::iter::once(name.into()).chain(cells).collect());
            }
        }
        all
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
        let is_number = |column: usize| {
            self.rows
                .iter()
                .all(|row| !matches!(row[column], Cell::Text(_)))
        };
        let align = |column: usize| {
            if is_number(column) {
                Align::Right
            } else {
                Align::Left
            }
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

pub fn shown(cell: &Cell) -> String {
    match cell {
        Cell::Text(text) => text.clone(),
        Cell::Number(number) => significant(*number, DIGITS),
        Cell::Integer(integer) => integer.to_string(),
        Cell::Missing => String::new(),
    }
}
