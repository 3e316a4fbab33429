//! The error of columns whose meaning is not clear, which lists them all.

use thiserror::Error;

/// Columns whose meaning is not clear.
#[derive(Debug, Clone, PartialEq, Error)]
#[error("line {line}: {reason}. {}", listed(.columns))]
pub struct UnclearColumns {
    /// The line of the names, or the first row.
    pub line: usize,
    /// The unclear point.
    pub reason: String,
    /// All columns of the table.
    pub columns: Vec<UnclearColumn>,
}

/// A column of a table with unclear columns.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct UnclearColumn {
    /// Its name in the file; empty if it has none.
    pub name: String,
    /// Its first cell.
    pub first: String,
}

impl UnclearColumn {
    /// What a column without a name is called by: its first cell.
    pub(super) fn by_cell(&self) -> String {
        format!("({} ..)", self.first)
    }
}

fn listed(columns: &[UnclearColumn]) -> String {
    let name = |column: &UnclearColumn| match &*column.name {
        "" => column.by_cell(),
        name => format!("*{name}*"),
    };
    let each = (1..).zip(columns).map(|(number, column)| format!("{number} {}", name(column)));
    format!("Its columns: {}", each.collect::<Vec<_>>().join(", "))
}
