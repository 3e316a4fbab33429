//! What the columns of a file were read as, for a report before their numbers are used.

use super::table::{Chosen, Table, chosen};
use super::unclear::UnclearColumn;
use serde::Serialize;

/// A column, and what it was read as.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct ColumnRead {
    /// Its name in the file; empty if it has none.
    pub name: String,
    /// What it was read as; `None` if it was left out.
    // JSON, text: What the column was read as; null where it is left out
    pub quantity: Option<&'static str>,
    /// The unit in which it was read.
    // JSON of calibrate and texture, text: Unit in which the column was read; null for a pure number or a column that is left
    // out
    pub unit: Option<String>,
}

impl ColumnRead {
    /// A column that was read as a quantity; an empty unit is none.
    #[must_use]
    pub fn new(name: String, quantity: &'static str, unit: &str) -> Self {
        Self { name, quantity: Some(quantity), unit: Some(unit.to_owned()).filter(|unit| !unit.is_empty()) }
    }

    /// What it was read as, in words.
    #[must_use]
    pub fn meaning(&self) -> Option<String> {
        let unit = self.unit.as_ref().map_or(String::new(), |unit| format!(" in {unit}"));
        Some(format!("{}{unit}", self.quantity?))
    }

    /// The choice of this column, number `at` from 0, for what it was read as.
    #[must_use]
    pub fn chosen(&self, at: usize) -> Option<Chosen> {
        let unit = self.unit.as_ref().map_or(String::new(), |unit| format!(":{unit}"));
        chosen(&format!("{}={}{unit}", self.quantity?, at + 1)).ok()?.pop()
    }
}

/// What columns were read as, in words: "*Displacement (m)* as displacement; *Coherence* left out".
#[must_use]
pub fn understood(columns: &[ColumnRead]) -> String {
    let name = |(number, column): (usize, &ColumnRead)| match &*column.name {
        "" => format!("column {number}"),
        name => format!("*{name}*"),
    };
    let numbered = || (1..).zip(columns);
    let read = numbered().filter_map(|(number, column)| {
        let unit = column.unit.as_ref().filter(|unit| !column.name.contains(unit.as_str()));
        let unit = unit.map_or(String::new(), |unit| format!(" in {unit}"));
        Some(format!("{} as {}{unit}", name((number, column)), column.quantity?))
    });
    let text = read.collect::<Vec<_>>().join(", ");
    let left_out: Vec<String> = numbered().filter(|it| it.1.quantity.is_none()).map(name).collect();
    if left_out.is_empty() { text } else { format!("{text}; {} left out", left_out.join(", ")) }
}

impl Table {
    /// Its columns, of which those at these places were read as a quantity in a unit.
    #[must_use]
    pub fn columns_read(&self, read: &[(usize, &'static str, &str)]) -> Vec<ColumnRead> {
        let column = |(at, name): (usize, String)| match read.iter().find(|it| it.0 == at) {
            Some((_, quantity, unit)) => ColumnRead::new(name, quantity, unit),
            None => ColumnRead { name, quantity: None, unit: None },
        };
        self.columns.iter().map(|column| column.name.clone()).enumerate().map(column).collect()
    }
}

impl UnclearColumn {
    /// The column, left out: without a name it is called by its first cell.
    #[must_use]
    pub fn left_out(&self) -> ColumnRead {
        let name = if self.name.is_empty() { self.by_cell() } else { self.name.clone() };
        ColumnRead { name, quantity: None, unit: None }
    }
}
