//! A table to write, before it is a file.

use crate::base::csv::Cell;

#[derive(Clone, Debug)]
pub struct RunTable<R> {
    pub columns: Vec<String>,
    pub rows: R,
}

impl RunTable<Vec<Vec<Cell>>> {
    /// As a table whose rows might fail, as rows that are read while they are written may.
    pub fn into_results<E>(self) -> RunTable<impl Iterator<Item = Result<Vec<Cell>, E>>> {
        RunTable {
            columns: self.columns,
            rows: self.rows.into_iter().map(Ok),
        }
    }
}
