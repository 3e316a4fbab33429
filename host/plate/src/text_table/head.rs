//! The lines above a table: which one names its columns, and which one has their units.

use super::names::{Name, without_brackets};
use super::numbers::is_number;
use super::quantities::Quantity;
use super::sheet::{COMMENT_MARKS, Row, Separator, Sheet, has_digit, split};
use super::units::{Unit, unit};

/// What stands above the rows of a table.
pub(super) struct Head {
    /// The line of the names; `None` if there is none; an error is a line of names for another number of columns.
    pub(super) line: Result<Option<usize>, usize>,
    /// The names, or the units if there are no names.
    pub(super) names: Vec<String>,
    /// The cells of a row of units below the names.
    pub(super) units: Vec<String>,
    /// Number of columns.
    pub(super) width: usize,
}

impl Head {
    /// Searches upwards from the rows.
    pub(super) fn above(sheet: &Sheet, text: &str) -> Self {
        let width = sheet.rows.iter().map(|row| row.filled().len()).max().unwrap_or(0);
        // A column may have a name and no number.
        let most = sheet.rows.iter().map(|row| row.cells.len()).min().unwrap_or(0).max(width);
        let lines: Vec<&str> = text.split('\n').collect();
        let mut head = Self { line: Ok(None), names: Vec::new(), units: Vec::new(), width };
        let (mut misfit, mut has_other_units) = (None, false);
        let has_words =
            |row: &&Row| row.cells.iter().any(|it| it.contains(|it: char| it.is_alphanumeric() || it == '°'));
        for (number, row) in sheet.above.iter().rev().filter(has_words).enumerate() {
            let line = lines.get(row.line.wrapping_sub(1)).copied().unwrap_or("");
            let line = line.trim().trim_start_matches(COMMENT_MARKS);
            let Some(cells) = cells(row, line, sheet.separator, width..=most) else {
                if head.names.is_empty() {
                    has_other_units |= without_brackets(line).1.iter().any(|it| unit(it).is_some());
                    has_other_units |= row.filled().iter().all(|cell| unit(cell).is_some());
                    if has_other_units || names_frequency(line, number == 0) {
                        misfit = misfit.or(Some(row.line));
                    }
                }
                continue;
            };
            let said: Vec<Name> = cells.iter().map(|cell| Name::of(cell)).collect();
            let is_unit = |it: &Name| it.is_clear && matches!(it.unit, Some((_, Some(_))));
            let is_names = said.iter().any(|it| it.quantity == Some(Quantity::Frequency) && it.is_clear);
            let is_known = said.iter().any(|it| it.unit.is_some() || it.quantity.is_some());
            if head.names.is_empty()
                && said.iter().all(|it| it.quantity.is_none())
                && said.iter().any(is_unit)
            {
                // If no line above has the names, these are all there is.
                (head.line, head.names) = (Ok(Some(row.line)), cells);
                continue;
            }
            if is_names && !head.names.is_empty() {
                head.units = std::mem::take(&mut head.names);
            }
            // Names that are not known are those of the columns as well, but blanks separate the words of a sentence, too.
            if head.names.is_empty() && (is_names || is_known || sheet.separator != Separator::Blank) {
                (head.line, head.names) = (Ok(Some(row.line)), cells);
            }
            if !head.names.is_empty() {
                break;
            }
        }
        head.take_units_above(&has_words, sheet, &lines, width..=most);
        if head.leaves_a_column_of_numbers_unnamed(sheet) {
            misfit = head.line.ok().flatten();
            head.names.clear();
        }
        if let Some(line) = misfit.filter(|_| head.line.is_ok() && (head.names.is_empty() || has_other_units))
        {
            (head.line, head.names) = (Err(line), Vec::new());
        }
        head.width = head.names.len().max(width);
        head
    }
}

impl Head {
    /// Takes the units of the line above the names, if these state none of the frequency; a line that has units, and more, is
    /// an error.
    fn take_units_above(
        &mut self,
        has_words: &dyn Fn(&&Row) -> bool,
        sheet: &Sheet,
        lines: &[&str],
        width: std::ops::RangeInclusive<usize>,
    ) {
        let Ok(Some(at)) = self.line else { return };
        let has_frequency = |name: &String| {
            let said = Name::of(name);
            let is_known = matches!(said.unit, Some((_, Some(Unit::Hertz(_)))));
            !said.is_other && (is_known || said.quantity == Some(Quantity::Frequency) && said.unit.is_some())
        };
        if !self.units.is_empty() || self.names.iter().any(has_frequency) {
            return;
        }
        let above = sheet.above.iter().rev().filter(has_words).find(|row| row.line < at);
        let Some(row) = above else { return };
        let line = lines.get(row.line.wrapping_sub(1)).copied().unwrap_or("");
        let line = line.trim().trim_start_matches(COMMENT_MARKS);
        let cells = cells(row, line, sheet.separator, width);
        let are_units = |all: &[String], least: usize| {
            let filled: Vec<&String> = all.iter().filter(|cell| !cell.is_empty()).collect();
            filled.len() >= least && filled.iter().all(|cell| unit(cell).is_some())
        };
        if let Some(cells) = cells.as_ref().filter(|cells| are_units(cells, 1)) {
            self.units.clone_from(cells);
            return;
        }
        let with_unit = |cell: &&String| matches!(Name::of(cell).unit, Some((_, Some(_))));
        let is_sentence = !line.contains(|letter: char| letter.is_ascii_digit());
        if is_sentence && cells.iter().flatten().filter(with_unit).count() > 1
            || are_units(&without_brackets(line).1, 2)
            || are_units(row.filled(), 2)
            || has_other_frequency(line)
        {
            (self.line, self.names) = (Err(row.line), Vec::new());
        }
    }

    /// Whether the last column has numbers and no name, but the first one has a name: the names may be those of the columns
    /// beside them.
    fn leaves_a_column_of_numbers_unnamed(&self, sheet: &Sheet) -> bool {
        let is_unnamed = |at: usize| self.names.get(at).is_none_or(String::is_empty);
        let Some(last) =
            sheet.rows.iter().map(|row| row.filled().len()).max().and_then(|it| it.checked_sub(1))
        else {
            return false;
        };
        let numbers = sheet.rows.iter().filter(|row| has_digit(row.cell(last)) && is_number(row.cell(last)));
        !self.names.is_empty() && !is_unnamed(0) && is_unnamed(last) && 2 * numbers.count() > sheet.rows.len()
    }
}

/// The words of a line.
fn words(line: &str) -> impl Iterator<Item = &str> {
    line.split([' ', '\t', ',', ';', '|', '"', '(', '[', ')', ']', '=', ':']).filter(|it| !it.is_empty())
}

/// Whether a line has a unit of frequency other than hertz, and not behind a number: "# MHz S MA R 50".
fn has_other_frequency(line: &str) -> bool {
    let is_number = |word: &str| word.chars().all(|it| it.is_ascii_digit() || matches!(it, '.' | '-' | '+'));
    let mut before = "";
    words(line).any(|word| {
        let before = std::mem::replace(&mut before, word);
        let is_behind_number = !before.is_empty() && is_number(before);
        matches!(unit(word), Some(Unit::Hertz(size)) if size != 1.0) && !is_behind_number
    })
}

/// Whether a line has a word for a frequency, or a unit of one that is not behind a number, or that is in the nearest line
/// above the rows: it may be the head of other columns.
fn names_frequency(line: &str, is_nearest: bool) -> bool {
    words(line).any(|word| {
        let of_frequency = matches!(unit(word), Some(Unit::Hertz(_)));
        of_frequency && (is_nearest || !line.contains(|it: char| it.is_ascii_digit()))
            || Name::of(word).quantity == Some(Quantity::Frequency)
    })
}

/// The cells of a line above the table, if there are as many as columns: by the table's separator, or by another.
fn cells(
    row: &Row,
    line: &str,
    separator: Separator,
    width: std::ops::RangeInclusive<usize>,
) -> Option<Vec<String>> {
    let without_mark = |cells: &[String]| {
        let mut cells = cells.to_vec();
        if let Some(first) = cells.first_mut() {
            *first = first.trim_start_matches(COMMENT_MARKS).trim().trim_matches('"').trim().to_owned();
        }
        cells
    };
    let fits = |cells: &[String]| width.contains(&cells.len());
    let others = [b'\t', b';', b',', b'|'].map(Separator::Sign).into_iter();
    let cells = |separator| split(line, separator).first().map(|row| without_mark(row.filled()));
    if separator == Separator::Blank {
        let apart: Vec<String> = line
            .split("  ")
            .map(|it| it.trim().trim_matches('"').trim().to_owned())
            .filter(|it| !it.is_empty())
            .collect();
        let own = [apart, grouped(line), named_by_units(line)].into_iter();
        return own.chain(others.filter_map(cells)).find(|cells| fits(cells));
    }
    // Its last cells may be empty.
    let end = row.filled().len().max(row.cells.len().min(*width.start()));
    let own = std::iter::once(without_mark(&row.cells[..end]));
    own.chain(others.filter_map(cells)).find(|cells| fits(cells))
}

/// Words that are no name by themselves: where they begin a cell, a name of several words was divided.
const CONTINUED: [&str; 8] = ["of", "the", "and", "part", "teil", "response", "function", "pressure"];

/// Words separated by blanks; what begins with a bracket belongs to the word before it, unless all words do. Empty if a name
/// of several words is among them.
fn grouped(line: &str) -> Vec<String> {
    let mut cells: Vec<String> = Vec::new();
    let mut depth = 0_usize;
    let of_units = !without_brackets(line).0.contains(char::is_alphanumeric);
    for word in split(line, Separator::Blank).first().map_or(&[][..], Row::filled) {
        let begins = depth == 0 && (of_units || !word.starts_with(['[', '(']));
        match cells.last_mut() {
            Some(cell) if !begins => {
                cell.push(' ');
                cell.push_str(word);
            }
            _ => cells.push(word.clone()),
        }
        depth += word.matches(['[', '(']).count();
        depth = depth.saturating_sub(word.matches([']', ')']).count());
    }
    let is_divided = cells.iter().any(|cell| {
        let word = cell.split(|letter: char| !letter.is_alphabetic()).next().unwrap_or("").to_lowercase();
        CONTINUED.contains(&&*word)
    });
    if is_divided { Vec::new() } else { cells }
}

/// Names of several known words that each end in a unit in brackets.
fn named_by_units(line: &str) -> Vec<String> {
    let (mut names, mut depth) = (vec![String::new()], 0_usize);
    for letter in line.trim().chars() {
        let opens = matches!(letter, '(' | '[');
        if depth == 0 && !opens && names.last().is_some_and(|name| name.ends_with([')', ']'])) {
            names.push(String::new());
        }
        depth = if opens { depth + 1 } else { depth - usize::from(depth > 0 && matches!(letter, ')' | ']')) };
        if let Some(name) = names.last_mut() {
            name.push(letter);
        }
    }
    let is_name = |name: &str| {
        name.ends_with([')', ']']) && name.starts_with(char::is_alphabetic) && Name::of(name).is_clear
    };
    let names: Vec<String> = names.iter().map(|name| name.trim().to_owned()).collect();
    if names.iter().all(|name| is_name(name)) { names } else { Vec::new() }
}
