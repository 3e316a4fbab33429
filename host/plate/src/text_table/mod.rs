//! The one reader of tables that others wrote: their text, cells, names, units and numbers, and the error that names a line.
//! Which columns a kind of file needs is decided by its own reader.

mod column_read;
mod head;
mod names;
mod numbers;
mod quantities;
mod sheet;
mod table;
mod text;
mod unclear;
mod units;
mod words;

pub use column_read::{ColumnRead, understood};
pub use quantities::Quantity;
pub use sheet::Row;
pub use table::{Chosen, Column, MEANINGS, Table, chosen};
pub use text::text_of;
pub use unclear::{UnclearColumn, UnclearColumns};
pub use units::Unit;
pub(crate) use units::unit;

use crate::quantity::must_be;
use thiserror::Error;

/// A line that cannot be read.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
#[error("line {line}: {reason}")]
pub struct BadLine {
    /// Number of the line, from 1.
    pub line: usize,
    /// The mistake and the allowed values.
    pub reason: String,
}

pub(crate) fn wrong<E: From<BadLine>>(line: usize, reason: impl Into<String>) -> E {
    BadLine { line, reason: reason.into() }.into()
}

/// The allowed numbers of a cell, in words and as a condition.
pub(crate) type Allowed = (&'static str, fn(f64) -> bool);

pub(crate) const FINITE: Allowed = ("a finite number", f64::is_finite);
/// For a number whose range is checked later.
pub(crate) const ANY: Allowed = ("a number with a decimal point", |_| true);

/// The lines of a text without blanks at their ends, with their numbers from 1.
pub(crate) fn lines(text: &str) -> impl Iterator<Item = (usize, &str)> {
    (1..).zip(text.lines().map(str::trim))
}

/// The beginning of a text from a file, safe to display in a message.
pub(crate) fn shown(text: &str) -> String {
    text.chars().filter(|letter| !letter.is_control()).take(40).collect()
}

pub(crate) fn number(line: usize, field: &str, text: &str, allowed: Allowed) -> Result<f64, BadLine> {
    let (words, is_allowed) = allowed;
    let number = text.parse().ok().filter(|number| is_allowed(*number));
    number.ok_or_else(|| wrong(line, must_be(format_args!("{field} = {}", shown(text)), words)))
}
