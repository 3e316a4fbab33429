//! A table: its columns by the names above it, and its numbers.
//!
//! ```text
//! bytes -> text (text_of) -> cells and rows (Sheet) -> names, units (Name) -> Table -> the reader of a kind of file
//! ```

use super::head::Head;
use super::names::Name;
use super::quantities::Quantity;
use super::sheet::{Row, Sheet};
use super::unclear::{UnclearColumn, UnclearColumns};
use super::units::{Unit, unit};
use super::{BadLine, must_be, shown, wrong};
use crate::quantity::nearest;

/// A column of a table.
#[derive(Debug, Clone, PartialEq)]
pub struct Column {
    /// Its name in the file, without comment marks; empty if it has none.
    pub name: String,
    said: Name,
}

impl Column {
    fn of(name: &str, unit_below: &str) -> Self {
        let mut said = Name::of(name);
        let unit_below = unit_below.trim_matches(['[', ']', '(', ')', ' ', '-']);
        if !unit_below.is_empty() {
            let below = (unit_below.to_owned(), unit(unit_below));
            match &said.unit {
                // Two units that differ are none.
                Some((_, is)) if *is != below.1 => said.unit = Some((below.0, None)),
                Some(_) => {}
                None => said.unit = Some(below),
            }
        }
        Self { name: shown(name), said }
    }

    /// Its unit and that in words, if it is known.
    #[must_use]
    pub fn unit(&self) -> Option<(Unit, String)> {
        self.said.unit.as_ref().and_then(|(text, unit)| Some(((*unit)?, text.clone())))
    }

    /// Whether its name leaves open that it is such a column.
    fn may_be(&self, is_wanted: &dyn Fn(Quantity) -> bool) -> bool {
        !self.said.is_clear || self.said.quantity.is_none_or(is_wanted)
    }

    fn has_unit_of(&self, is_wanted: &dyn Fn(Quantity) -> bool) -> bool {
        // A pure number belongs to nothing by itself.
        let belongs = |unit: Unit| unit != Unit::Linear(1.0, None);
        let all = [Quantity::Frequency, Quantity::Magnitude, Quantity::Phase, Quantity::Time];
        let of = |unit: Unit| all.into_iter().any(|of| is_wanted(of) && unit.suits(of));
        self.unit().is_some_and(|(unit, _)| {
            belongs(unit) && (of(unit) || unit == Unit::Decibels && is_wanted(Quantity::Level))
        })
    }
}

/// A column by the user's word: what it is, its number from 1, and its unit.
#[derive(Debug, Clone, PartialEq)]
pub struct Chosen {
    /// What it holds.
    pub quantity: Quantity,
    /// Its number, from 0.
    pub at: usize,
    /// Its unit and that in words; `None` for that of its name, or the usual one.
    pub unit: Option<(Unit, String)>,
}

/// What a user may choose a column to be, each with its unit.
pub const MEANINGS: [(Quantity, &str); 16] = [
    (Quantity::Frequency, "Hz"),
    (Quantity::Frequency, "kHz"),
    (Quantity::Frequency, "rad/s"),
    (Quantity::Level, "dB"),
    (Quantity::Magnitude, ""),
    (Quantity::Displacement, "m"),
    (Quantity::Displacement, "mm"),
    (Quantity::Velocity, "m/s"),
    (Quantity::Velocity, "mm/s"),
    (Quantity::Acceleration, "m/s^2"),
    (Quantity::Acceleration, "g"),
    (Quantity::Strain, ""),
    (Quantity::Phase, "deg"),
    (Quantity::Phase, "rad"),
    (Quantity::Real, ""),
    (Quantity::Imaginary, ""),
];

/// Reads a choice of columns: `frequency=1,level=3:dB,phase=4:rad`, with numbers from 1 and optional units.
///
/// # Errors
/// A sentence with the part that is wrong and what is allowed.
pub fn chosen(text: &str) -> Result<Vec<Chosen>, String> {
    let mut quantities = MEANINGS.map(|meaning| meaning.0).to_vec();
    quantities.dedup();
    let words: Vec<&str> = quantities.iter().map(|of| of.word()).collect();
    let each = text.split(',').map(|part| {
        let (name, rest) = part.split_once('=').unwrap_or((part, ""));
        let name = name.trim();
        let quantity = quantities.iter().copied().find(|it| it.word() == name).ok_or_else(|| {
            let meant = nearest(name, words.iter().copied())
                .map_or(String::new(), |it| format!(", did you mean {it}?"));
            let given = format_args!("a measurement has no column {:?}{meant}", shown(name));
            must_be(given, format_args!("one of {}", words.join(", ")))
        })?;
        let (number, of) = rest.split_once(':').map_or((rest, None), |(number, of)| (number, Some(of)));
        let at = number.trim().parse::<usize>().ok().and_then(|number| number.checked_sub(1));
        let at = at.ok_or_else(|| {
            must_be(format_args!("{name} = {}", shown(number)), "the number of a column, from 1")
        })?;
        let suits = |of: &str| Some((unit(of).filter(|unit| unit.suits(quantity))?, of.trim().to_owned()));
        let unknown = |of: &str| {
            must_be(
                format_args!("the unit of {name} = {}", shown(of)),
                "one of this quantity, such as Hz, kHz, rad/s, dB, mm/s, deg or rad",
            )
        };
        let unit = of.map(|of| suits(of).ok_or_else(|| unknown(of))).transpose()?;
        Ok(Chosen { quantity, at, unit })
    });
    let all = each.collect::<Result<Vec<_>, String>>()?;
    for (i, one) in all.iter().enumerate() {
        if all[..i].iter().any(|other| other.at == one.at || other.quantity == one.quantity) {
            return Err(format!("column {} or {} is there twice", one.at + 1, one.quantity.word()));
        }
    }
    Ok(all)
}

/// A table of numbers.
#[derive(Debug, Clone, PartialEq)]
pub struct Table {
    sheet: Sheet,
    /// The line of the names, or of names that are not those of the columns.
    head: Result<Option<usize>, usize>,
    /// Its columns.
    pub columns: Vec<Column>,
}

impl Table {
    /// Reads the table of a text; `None` if no line is a row of two numbers or more.
    ///
    /// # Errors
    /// A line that interrupts the rows, or two decimal signs in use.
    pub fn read(text: &str) -> Result<Option<Self>, BadLine> {
        let Some(sheet) = Sheet::read(text)? else { return Ok(None) };
        let Head { line, names, units, width } = Head::above(&sheet, text);
        let cell = |cells: &[String], at: usize| cells.get(at).cloned().unwrap_or_default();
        let columns = (0..width).map(|at| Column::of(&cell(&names, at), &cell(&units, at))).collect();
        Ok(Some(Self { sheet, head: line, columns }))
    }

    /// The line of the names; `None` if there is none.
    ///
    /// # Errors
    /// A line that names another number of columns.
    pub fn head(&self) -> Result<Option<usize>, UnclearColumns> {
        self.head.map_err(|line| {
            let why = format!(
                "the names are not those of {} columns, as many as the rows have",
                self.columns.len()
            );
            UnclearColumns { line, ..self.unclear(why) }
        })
    }

    /// Its rows: at least one.
    #[must_use]
    pub fn rows(&self) -> &[Row] {
        &self.sheet.rows
    }

    /// The number in a column of a row; not finite where the cell is empty or has a word for no number.
    ///
    /// # Errors
    /// The line and the column of a cell that is no number.
    pub fn number(&self, row: &Row, column: usize) -> Result<f64, BadLine> {
        let cell = row.cell(column);
        self.sheet.decimal.number(cell).ok_or_else(|| self.no_number(row, column))
    }

    /// The number in a column of a row.
    ///
    /// # Errors
    /// The line and the column of a cell that is no finite number.
    pub fn finite(&self, row: &Row, column: usize) -> Result<f64, BadLine> {
        let value = self.number(row, column)?;
        if value.is_finite() { Ok(value) } else { Err(self.no_number(row, column)) }
    }

    fn no_number(&self, row: &Row, column: usize) -> BadLine {
        wrong(
            row.line,
            must_be(format_args!("{} = {}", self.shown(column), shown(row.cell(column))), "a number"),
        )
    }

    /// A column in a message: its number from 1, and its name.
    pub(crate) fn shown(&self, column: usize) -> String {
        match self.columns.get(column).map_or("", |column| &*column.name) {
            "" => format!("column {}", column + 1),
            name => format!("column {} *{name}*", column + 1),
        }
    }

    /// The error that lists the columns.
    #[must_use]
    pub fn unclear(&self, reason: String) -> UnclearColumns {
        let first = &self.sheet.rows[0];
        let line = self.head.ok().flatten().unwrap_or(first.line);
        let unclear = |(at, column): (usize, &Column)| UnclearColumn {
            name: column.name.clone(),
            first: shown(first.cell(at)),
        };
        UnclearColumns { line, reason, columns: self.columns.iter().enumerate().map(unclear).collect() }
    }

    /// The column of a quantity by its name, or by its unit where it has no other name; `None` if there is none.
    ///
    /// # Errors
    /// Two columns, or one that is not clear.
    pub fn find(
        &self,
        what: &str,
        is_wanted: &dyn Fn(Quantity) -> bool,
    ) -> Result<Option<usize>, UnclearColumns> {
        let names = |at: &[usize]| {
            at.iter().map(|&at| format!("*{}*", self.columns[at].name)).collect::<Vec<_>>().join(", ")
        };
        let all = |is: &dyn Fn(&Column) -> bool| -> Vec<usize> {
            (0..self.columns.len())
                .filter(|&at| is(&self.columns[at]) && !self.columns[at].said.is_other)
                .collect()
        };
        let by_unit = |it: &Column| it.said.quantity.is_none() && it.has_unit_of(is_wanted);
        let candidates =
            all(&|it| it.said.quantity.is_some_and(is_wanted) || it.said.is_clear && by_unit(it));
        let unknown = all(&|it| !it.said.is_clear && by_unit(it));
        match (&candidates[..], &unknown[..]) {
            ([], []) => Ok(None),
            ([], more) => {
                Err(self
                    .unclear(format!("by its unit {} may be the {what}; its name is not known", names(more))))
            }
            (&[at], others) => {
                let column = &self.columns[at];
                let suits = |unit: Unit| column.said.quantity.is_none_or(|of| unit.suits(of));
                match &column.said.unit {
                    Some((text, unit)) if !unit.is_some_and(suits) => {
                        let why = format!(
                            "*{}* has the unit {}, which is not known of the {what}",
                            column.name,
                            shown(text)
                        );
                        Err(self.unclear(why))
                    }
                    // It is the only one that can be meant if all others are something else.
                    unit if !column.said.is_clear
                        && (unit.is_none()
                            || column.said.is_changed
                            || !others.is_empty()
                            || !all(&|it| it != column && it.may_be(is_wanted)).is_empty()) =>
                    {
                        let why = if column.said.is_changed {
                            format!("by its words *{}* is not the {what} itself", column.name)
                        } else {
                            format!("not all words of *{}* are known: it may be another {what}", column.name)
                        };
                        Err(self.unclear(why))
                    }
                    _ => Ok(Some(at)),
                }
            }
            (more, _) => {
                Err(self.unclear(format!("{} columns may be the {what}: {}", more.len(), names(more))))
            }
        }
    }

    /// What the column's name says.
    #[must_use]
    pub fn quantity(&self, at: usize) -> Option<Quantity> {
        self.columns.get(at).and_then(|column| column.said.quantity)
    }
}
