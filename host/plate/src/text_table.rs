//! Tables in texts: numbered lines, the cells of a row, their numbers, and the error that names a line. The meaning
//! of the columns is defined by the reader of each kind of file.
//!
//! Cells are separated by commas, semicolons, tabs or blanks. A number has a decimal point, or a decimal comma where
//! the cells are not separated by commas.

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

/// The lines of a text, without a byte order mark and without blanks at their ends, with their numbers from 1.
pub fn lines(text: &str) -> impl Iterator<Item = (usize, &str)> {
    (1..).zip(text.trim_start_matches('\u{feff}').lines().map(str::trim))
}

/// The lines of a table with their numbers from 1: those that are not empty and do not begin with `#`.
pub fn rows(text: &str) -> impl Iterator<Item = (usize, &str)> {
    lines(text).filter(|(_, line)| !line.is_empty() && !line.starts_with('#'))
}

/// The separator of a line's cells.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Separator {
    /// Semicolons or tabs; a comma is the decimal sign.
    Sign(char),
    /// Commas.
    Comma,
    /// Blanks; a comma is the decimal sign.
    Blank,
}

impl Separator {
    /// The separator used in a line.
    #[must_use]
    pub fn of(line: &str) -> Self {
        if let Some(sign) = line.chars().find(|sign| matches!(sign, ';' | '\t')) {
            return Self::Sign(sign);
        }
        let mut words = line.split_whitespace();
        let first = words.next().unwrap_or("");
        // "20, 65.01" and "20,65.01" are separated by commas, "20,5 65,01" by blanks.
        let has_more = words.next().is_some();
        if line.contains(',') && (first.ends_with(',') || !has_more) { Self::Comma } else { Self::Blank }
    }

    /// The cells of a line, without blanks and quotation marks at their ends and with a decimal point in numbers.
    #[must_use]
    pub fn cells(self, line: &str) -> Vec<String> {
        let point = |cell: &str| cell.trim().trim_matches('"').trim().replace(',', ".");
        match self {
            Self::Sign(sign) => line.split(sign).map(point).collect(),
            Self::Comma => line.split(',').map(point).collect(),
            Self::Blank => line.split_whitespace().map(point).collect(),
        }
    }
}

/// The cells of a line by its own separator.
#[must_use]
pub fn cells(line: &str) -> Vec<String> {
    Separator::of(line).cells(line)
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

/// The cells of a line.
pub(crate) struct Row<S> {
    pub(crate) line: usize,
    pub(crate) cells: Vec<S>,
}

impl<S: AsRef<str>> Row<S> {
    pub(crate) fn number(&self, at: usize, field: &str, allowed: Allowed) -> Result<f64, BadLine> {
        let cell = self.cells.get(at).ok_or_else(|| -> BadLine {
            let given = format_args!("the row has {} cells", self.cells.len());
            wrong(self.line, must_be(given, format_args!("at least {}", at + 1)))
        })?;
        number(self.line, field, cell.as_ref(), allowed)
    }
}
