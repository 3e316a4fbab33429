//! Numbers of cells: decimal signs, group marks, minus signs of typesetters, and the words for no number.

use super::{BadLine, shown, wrong};
use std::borrow::Cow;
use std::collections::{BTreeMap, BTreeSet};

/// Marks between groups of three digits, beside the one of `.` and `,` that is not the decimal sign.
const GROUP_MARKS: [char; 5] = ['\u{a0}', '\u{202f}', '\u{2009}', '\'', '’'];
/// What programs write where they have no number, in lower case.
const NONE: &[&str] = &[
    "",
    "-",
    "--",
    "---",
    "n/a",
    "na",
    "null",
    "none",
    "#n/a",
    "#nv",
    "∞",
    "-∞",
    "+∞",
    "—",
    "…",
    "...",
    "n. def.",
    "n/d",
    "undef",
    "undefined",
];

/// Whether a cell, in lower case, is a word for no number: of the list, an error of a spreadsheet (#DIV/0!, Err:502) or of a
/// runtime library (-1.#IND00, nan(ind)).
fn is_none(cell: &str) -> bool {
    let unsigned = cell.trim_start_matches(['+', '-']);
    NONE.contains(&cell)
        || cell.starts_with('#') && cell.ends_with(['!', '?'])
        || ["1.#", "1,#", "nan(", "err:"].iter().any(|begin| unsigned.starts_with(begin))
}

/// The sign before the decimals of a table's numbers.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Decimal {
    Point,
    Comma,
}

impl Decimal {
    /// The decimal sign and the group mark.
    const fn signs(self) -> (char, char) {
        match self {
            Self::Point => ('.', ','),
            Self::Comma => (',', '.'),
        }
    }

    /// The number of a cell: not finite where the cell has a word for no number; `None` if it is neither.
    pub(crate) fn number(self, cell: &str) -> Option<f64> {
        let (sign, group) = self.signs();
        let cell: Cow<'_, str> = if cell.is_ascii() {
            cell.into()
        } else {
            cell.replace(['−', '–', '‐', '‑', '‒', '﹣', '－'], "-").into()
        };
        let unsigned = cell.trim_start_matches(['+', '-']);
        let may_be_word = !unsigned.starts_with(|letter: char| letter.is_ascii_digit()) || cell.contains('#');
        if may_be_word && is_none(&cell.to_lowercase()) {
            return Some(f64::NAN);
        }
        // A number that is too large for any is none; "inf" is a word.
        let fits =
            |number: &f64| number.is_finite() || !cell.contains(|letter: char| letter.is_ascii_digit());
        if self == Self::Point
            && let Ok(number) = cell.parse()
        {
            return Some(number).filter(fits);
        }
        let end = cell.find([sign, 'e', 'E', 'd', 'D']).unwrap_or(cell.len());
        let (whole, rest) = cell.split_at(end);
        let is_mark = |letter: char| letter == group || GROUP_MARKS.contains(&letter);
        if let Some(mark) = whole.chars().find(|&letter| is_mark(letter)) {
            let mut groups = whole.trim_start_matches(['+', '-']).split(mark);
            let is_first = groups
                .next()
                .is_some_and(|it| (1..=3).contains(&it.len()) && !it.starts_with('0') && all_digits(it));
            if !is_first || !groups.all(|it| it.len() == 3 && all_digits(it)) {
                return None;
            }
        }
        if rest == "," || rest.chars().any(is_mark) {
            return None;
        }
        let mut plain: String = whole.chars().filter(|&letter| !is_mark(letter)).collect();
        plain.extend(rest.chars().map(|letter| if letter == sign { '.' } else { letter }));
        // Fortran writes exponents with D.
        plain.parse().or_else(|_| plain.replace(['d', 'D'], "e").parse()).ok().filter(fits)
    }

    /// The decimal sign of cells, each with its line and column, from those that can be read in one way alone.
    ///
    /// # Errors
    /// A line with the other sign, or one that could have either.
    pub(crate) fn of<'a>(cells: impl Iterator<Item = (usize, usize, &'a str)>) -> Result<Self, BadLine> {
        let (mut sure, mut maybe) = ([None; 2], [None; 2]);
        // Columns with whole numbers, and the first cell of each that could have either sign.
        let (mut whole, mut either) = (BTreeSet::new(), BTreeMap::new());
        for (line, column, cell) in cells {
            if !cell.contains(['.', ',']) {
                if !cell.is_empty() && all_digits(cell.trim_start_matches(['+', '-'])) {
                    whole.insert(column);
                }
                continue;
            }
            let has_known = |way: usize, other: char| sure[way].is_some() && !cell.contains(other);
            if has_known(0, ',') || has_known(1, '.') {
                continue;
            }
            let ways =
                [Self::Point, Self::Comma].map(|decimal| decimal.number(cell).is_some_and(f64::is_finite));
            match ways {
                [true, false] => sure[0] = sure[0].or(Some(line)),
                [false, true] => sure[1] = sure[1].or(Some(line)),
                // Three digits behind the only sign: decimals, or a group.
                [true, true] => {
                    let way = usize::from(cell.contains(','));
                    maybe[way] = maybe[way].or(Some(line));
                    either.entry(column).or_insert((line, cell));
                }
                [false, false] => {}
            }
        }
        let both = "both a decimal point and a decimal comma are in use: write all numbers with a point";
        // Beside whole numbers the sign may stand between groups of digits.
        let group = either.iter().find(|(column, _)| whole.contains(column)).map(|it| it.1);
        if let (Some((line, cell)), [None, None]) = (group, sure) {
            let plain = cell.replace([',', '.'], "");
            return Err(wrong(
                *line,
                format!(
                    "\"{}\" could be {plain}, or have three decimals: write numbers without marks between groups",
                    shown(cell)
                ),
            ));
        }
        match (sure, maybe) {
            ([Some(point), Some(comma)], _) => Err(wrong(point.max(comma), both)),
            ([Some(_), None], _) | ([None, None], [_, None]) => Ok(Self::Point),
            ([None, Some(_)], _) | ([None, None], [None, _]) => Ok(Self::Comma),
            ([None, None], [Some(point), Some(comma)]) => Err(wrong(point.max(comma), both)),
        }
    }
}

fn all_digits(text: &str) -> bool {
    text.bytes().all(|byte| byte.is_ascii_digit())
}

/// Whether a cell is a number with either decimal sign, or a word for none.
pub(super) fn is_number(cell: &str) -> bool {
    Decimal::Point.number(cell).is_some() || Decimal::Comma.number(cell).is_some()
}
