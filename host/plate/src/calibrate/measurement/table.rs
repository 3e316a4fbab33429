//! Tables in texts: numbered lines, rows of cells, their numbers, and the error that names a line. What the columns are is
//! a matter of [`super::csv`] and [`super::foreign`].

use crate::quantity::must_be;
use thiserror::Error;

/// A line that cannot be read.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
#[error("line {line}: {reason}")]
pub struct LineError {
    /// The line, from 1.
    pub line: usize,
    /// What is wrong, and what is allowed.
    pub reason: String,
}

pub(crate) fn wrong<E: From<LineError>>(line: usize, reason: impl Into<String>) -> E {
    LineError { line, reason: reason.into() }.into()
}

/// The numbers that a cell may hold, in words and as a condition.
pub(crate) type Allowed = (&'static str, fn(f64) -> bool);

pub(crate) const FINITE: Allowed = ("a finite number", f64::is_finite);
/// Its range is checked later.
pub(crate) const ANY: Allowed = ("a number with a decimal point", |_| true);

/// The lines of a text without the blanks at their ends, with their numbers.
pub(crate) fn lines(text: &str) -> impl Iterator<Item = (usize, &str)> {
    (1..).zip(text.lines().map(str::trim))
}

/// The beginning of a text from a file, as a message can show it.
pub(crate) fn shown(text: &str) -> String {
    text.chars().filter(|letter| !letter.is_control()).take(40).collect()
}

pub(crate) fn number(line: usize, field: &str, text: &str, allowed: Allowed) -> Result<f64, LineError> {
    let (words, is_allowed) = allowed;
    let number = text.parse().ok().filter(|number| is_allowed(*number));
    number.ok_or_else(|| wrong(line, must_be(format_args!("{field} = {}", shown(text)), words)))
}

/// The cells of a line.
pub(crate) struct Row<S> {
    pub(crate) line: usize,
    pub(crate) cells: Vec<S>,
}

impl<S: AsRef<str>> Row<S> {
    pub(crate) fn number(&self, at: usize, field: &str, allowed: Allowed) -> Result<f64, LineError> {
        let cell = self.cells.get(at).ok_or_else(|| -> LineError {
            let given = format_args!("the row has {} cells", self.cells.len());
            wrong(self.line, must_be(given, format_args!("at least {}", at + 1)))
        })?;
        number(self.line, field, cell.as_ref(), allowed)
    }
}
