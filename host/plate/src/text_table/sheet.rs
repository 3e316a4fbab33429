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
        begin_with_numbers(self.cells.iter().map(String::as_str))
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

/// Whether the first two cells are numbers, or words for none.
fn begin_with_numbers<'a>(mut cells: impl Iterator<Item = &'a str>) -> bool {
    let Some(first) = cells.next().zip(cells.next()) else { return false };
    (has_digit(first.0) || has_digit(first.1)) && is_number(first.0) && is_number(first.1)
}

pub(super) fn has_digit(cell: &str) -> bool {
    cell.bytes().any(|byte| byte.is_ascii_digit())
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

/// A row with fewer cells than most rows: nothing shows which cell is missing.
fn short(rows: &[Row], separator: Separator) -> Option<BadLine> {
    let usual = match separator {
        Separator::Blank => rows.first()?.cells.len(),
        // The last cells of most rows may be missing, such as a note.
        Separator::Sign(_) => {
            let mut counts: Vec<usize> = rows.iter().map(|row| row.cells.len()).collect();
            counts.sort_unstable();
            let most = rows.iter().map(|row| row.filled().len()).max()?;
            counts[counts.len() / 2].min(most)
        }
    };
    let is_other = |row: &&Row| match separator {
        Separator::Blank => row.cells.len() != usual,
        Separator::Sign(_) => row.cells.len() < usual,
    };
    let row = rows.iter().find(is_other)?;
    let count = row.cells.len();
    let why = format!(
        "{count} cells, but most rows have {usual}: write all of them, with a separator for an empty one"
    );
    Some(wrong(row.line, why))
}

/// What separates the rows of a text.
fn separator_of(text: &str) -> Option<(Separator, IsRow)> {
    let has_sign = |it: &Separator| !matches!(it, Separator::Sign(sign) if !text.as_bytes().contains(sign));
    let separators: Vec<Separator> = SEPARATORS.into_iter().filter(has_sign).collect();
    // The first of those that separate the most rows.
    let best = |rows: &dyn Fn(Separator) -> usize| {
        let mut best = (0, None);
        for &separator in &separators {
            let rows = rows(separator);
            if rows > best.0 {
                best = (rows, Some(separator));
            }
        }
        best.1
    };
    // Two cells of a line decide in most files, so only these are looked at first.
    let begin = |separator| {
        let mut rows = 0;
        read(text, separator, |record, _| {
            rows += usize::from(begin_with_numbers(record.iter().map(trimmed)));
        });
        rows
    };
    let are_mostly = |separator| split(text, separator).iter().filter(|row| row.is_mostly_numbers()).count();
    let found = best(&begin).map(|it| (it, Row::begins_with_numbers as IsRow));
    found.or_else(|| best(&are_mostly).map(|it| (it, Row::is_mostly_numbers as IsRow)))
}

impl Sheet {
    /// The rows of a text; `None` if no line is a row of numbers.
    ///
    /// # Errors
    /// A line that interrupts the rows or follows them; rows with both decimal signs.
    pub(super) fn read(text: &str) -> Result<Option<Self>, BadLine> {
        let Some((separator, is_row)) = separator_of(text) else { return Ok(None) };
        let mut lines = split(text, separator);
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
        if let Some(short) = short(&rows, separator) {
            return Err(short);
        }
        let numbered = rows
            .iter()
            .flat_map(|row| (0..).zip(&row.cells).map(|(column, cell)| (row.line, column, cell.as_str())));
        Ok(Some(Self { separator, decimal: Decimal::of(numbered)?, above: lines, rows }))
    }
}

/// The lines of a text as cells.
pub(super) fn split(text: &str, separator: Separator) -> Vec<Row> {
    let mut rows = Vec::new();
    read(text, separator, |record, end| {
        let breaks: usize = record.iter().map(|cell| cell.matches('\n').count()).sum();
        let cells: Vec<String> = record.iter().map(|cell| trimmed(cell).to_owned()).collect();
        // A cell that is not closed holds the end of the last line, too.
        let is_closed = !record.iter().next_back().is_some_and(|cell| cell.ends_with('\n'));
        rows.push(Row { line: end.saturating_sub(usize::from(is_closed) + breaks), cells });
    });
    rows
}

/// A cell without blanks and quotation marks around it.
fn trimmed(cell: &str) -> &str {
    cell.trim().trim_matches('"').trim()
}

/// Hands on the cells of each line, with the number of the line behind it.
fn read(text: &str, separator: Separator, mut row: impl FnMut(&csv::StringRecord, usize)) {
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
    let mut count = 0;
    // A text in memory has no errors of reading, and its cells are UTF-8.
    while count <= CELLS_MAX && reader.read_record(&mut record).unwrap_or(false) {
        count += record.len();
        row(&record, usize::try_from(reader.position().line()).unwrap_or(usize::MAX));
    }
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
