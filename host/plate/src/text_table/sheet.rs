//! A text as rows of cells: the separator under which most lines begin with numbers, those rows, and what stands above them.

use super::numbers::{Decimal, is_number};
use super::{BadLine, must_be, shown, wrong};
use std::borrow::Cow;

/// What separates cells; tried in this order where two separate as many rows.
const SEPARATORS: [Separator; 5] = [
    Separator::Sign(b'\t'),
    Separator::Sign(b';'),
    Separator::Sign(b','),
    Separator::Sign(b'|'),
    Separator::Blank,
];
/// What a line of comment may begin with.
pub(super) const COMMENT_MARKS: [char; 6] = ['*', '#', '%', ';', '!', '/'];

/// Largest number of cells: 350 000 rows of three columns, in some 50 MB.
const CELLS_MAX: usize = 1 << 20;

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Separator {
    Sign(u8),
    Blank,
}

/// The cells of a line, without blanks at their ends.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Row {
    /// Number of the line, from 1.
    pub line: usize,
    pub(crate) cells: Vec<String>,
}

impl Row {
    /// Its cells up to the last one that is not empty.
    pub(crate) fn filled(&self) -> &[String] {
        let end = self.cells.iter().rposition(|cell| !cell.is_empty()).map_or(0, |at| at + 1);
        &self.cells[..end]
    }

    /// The cell of a column; empty where the row is shorter.
    #[must_use]
    pub fn cell(&self, column: usize) -> &str {
        self.cells.get(column).map_or("", String::as_str)
    }

    fn is_comment(&self) -> bool {
        self.cell(0).starts_with(COMMENT_MARKS)
    }

    /// Whether the first two cells are numbers, or words for none.
    fn begins_with_numbers(&self) -> bool {
        let has_digit = |cell: &String| cell.contains(|letter: char| letter.is_ascii_digit());
        let first = self.cells.get(..2).unwrap_or(&[]);
        first.iter().any(has_digit) && first.iter().all(|cell| is_number(cell))
    }

    /// Why a line among the rows is none.
    fn is_no_row(&self) -> BadLine {
        let cells = self.filled();
        let what = match cells.iter().take(2).position(|cell| !is_number(cell)) {
            Some(at) => format!("column {}: \"{}\" is no number", at + 1, shown(&cells[at])),
            None => format!("{} cell", cells.len()),
        };
        wrong(
            self.line,
            format!("{what}, between or below the rows of numbers: correct it, or begin the line with #"),
        )
    }

    /// Whether most cells are numbers: a row that begins with a name or a time.
    fn is_mostly_numbers(&self) -> bool {
        let filled = || self.cells.iter().filter(|cell| !cell.is_empty());
        let numbers = filled().filter(|cell| is_number(cell)).count();
        numbers >= 2 && 2 * numbers > filled().count()
    }
}

/// The rows of a table.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Sheet {
    pub(super) separator: Separator,
    pub(super) decimal: Decimal,
    /// The lines above the rows, without empty ones.
    pub(super) above: Vec<Row>,
    /// At least one; none is empty.
    pub(super) rows: Vec<Row>,
}

/// Whether a line is a row of the table.
type IsRow = fn(&Row) -> bool;

/// What separates the rows of a text.
fn separator_of(text: &str) -> Option<(Vec<Row>, Separator, IsRow)> {
    for is_row in [Row::begins_with_numbers as IsRow, Row::is_mostly_numbers] {
        let mut best: Option<(usize, Vec<Row>, Separator)> = None;
        for separator in SEPARATORS {
            if matches!(separator, Separator::Sign(sign) if !text.as_bytes().contains(&sign)) {
                continue;
            }
            let found = split(text, separator);
            let rows = found.iter().filter(|row| is_row(row)).count();
            if rows > best.as_ref().map_or(0, |best| best.0) {
                best = Some((rows, found, separator));
            }
        }
        if let Some((_, found, separator)) = best {
            return Some((found, separator, is_row));
        }
    }
    None
}

impl Sheet {
    /// The rows of a text; `None` if no line is a row of numbers.
    ///
    /// # Errors
    /// A line that interrupts the rows or follows them; rows with both decimal signs.
    pub(super) fn read(text: &str) -> Result<Option<Self>, BadLine> {
        let Some((mut lines, separator, is_row)) = separator_of(text) else { return Ok(None) };
        if lines.iter().map(|row| row.cells.len()).sum::<usize>() > CELLS_MAX {
            let line = lines.last().map_or(1, |row| row.line);
            return Err(wrong(
                line,
                must_be("the number of cells", format_args!("{CELLS_MAX} at most: leave rows out")),
            ));
        }
        lines.retain(|row| !row.filled().is_empty());
        let (mut longest, mut from) = (0..0, 0);
        let is_body = |row: &Row| is_row(row) || row.is_comment();
        for run in lines.split_inclusive(|row| !is_body(row)) {
            let rows = run.iter().filter(|row| is_row(row)).count();
            let (first, end) = (from, from + run.len());
            from = end;
            if rows > lines[longest.clone()].iter().filter(|row| is_row(row)).count() {
                longest = first..end;
            }
        }
        // A run ends with the line that interrupts it, and may begin with comments.
        if !lines[longest.clone()].last().is_none_or(is_body) {
            longest.end -= 1;
        }
        while !is_row(&lines[longest.start]) {
            longest.start += 1;
        }
        if let Some(after) = lines[longest.end..].iter().find(|row| !row.is_comment()) {
            return Err(after.is_no_row());
        }
        let is_swallowed = |row: &&Row| {
            let below = |cell: &String| {
                cell.split('\n').skip(1).flat_map(|line| split(line, separator)).any(|row| is_row(&row))
            };
            row.cells.iter().any(below)
        };
        if let Some(open) = lines.iter().find(is_swallowed) {
            return Err(wrong(open.line, "a quotation mark is not closed: rows of numbers follow it"));
        }
        let mut rows = lines.split_off(longest.start);
        rows.retain(is_row);
        let count = rows[0].filled().len();
        if let Some(before) = lines.iter().position(|row| is_row(row) && row.filled().len() == count) {
            return Err(lines[before..]
                .iter()
                .find(|row| !is_body(row))
                .unwrap_or(&lines[before])
                .is_no_row());
        }
        let numbered = rows.iter().flat_map(|row| row.cells.iter().map(|cell| (row.line, cell.as_str())));
        Ok(Some(Self { separator, decimal: Decimal::of(numbered)?, above: lines, rows }))
    }
}

/// The lines of a text as cells.
pub(super) fn split(text: &str, separator: Separator) -> Vec<Row> {
    let (sign, text) = match separator {
        Separator::Sign(sign) => {
            let text: Cow<'_, str> =
                if text.ends_with('\n') { text.into() } else { format!("{text}\n").into() };
            // A quotation mark may follow a blank behind the separator.
            let apart = format!("{} \"", char::from(sign));
            (
                sign,
                if text.contains(&apart) {
                    text.replace(&apart, &apart.replace(' ', "")).into()
                } else {
                    text
                },
            )
        }
        Separator::Blank => (b'\t', text.split('\n').map(tabbed).collect::<String>().into()),
    };
    let mut reader = csv::ReaderBuilder::new();
    let reader =
        reader.has_headers(false).flexible(true).delimiter(sign).terminator(csv::Terminator::Any(b'\n'));
    let mut reader = reader.from_reader(text.as_bytes());
    let mut record = csv::StringRecord::new();
    let (mut rows, mut count) = (Vec::new(), 0);
    // A text in memory has no errors of reading, and its cells are UTF-8.
    while count <= CELLS_MAX && reader.read_record(&mut record).unwrap_or(false) {
        count += record.len();
        let breaks: usize = record.iter().map(|cell| cell.matches('\n').count()).sum();
        let end = usize::try_from(reader.position().line()).unwrap_or(usize::MAX);
        let cells: Vec<String> =
            record.iter().map(|cell| cell.trim().trim_matches('"').trim().to_owned()).collect();
        // A cell that is not closed holds the end of the last line, too.
        let is_closed = !record.iter().next_back().is_some_and(|cell| cell.ends_with('\n'));
        rows.push(Row { line: end.saturating_sub(usize::from(is_closed) + breaks), cells });
    }
    rows
}

/// A line with a tab in place of each run of blanks that is not quoted.
fn tabbed(line: &str) -> String {
    let (mut is_quoted, mut is_blank) = (false, false);
    let mut tabbed = String::with_capacity(line.len() + 1);
    for letter in line.trim_matches([' ', '\t']).chars() {
        is_quoted ^= letter == '"';
        if !is_quoted && matches!(letter, ' ' | '\t') {
            is_blank = true;
            continue;
        }
        if std::mem::take(&mut is_blank) {
            tabbed.push('\t');
        }
        tabbed.push(letter);
    }
    tabbed.push('\n');
    tabbed
}
