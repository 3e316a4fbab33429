//! Tables of frequency, level and optional phase, as measuring programs export them: REW's text, `.frd`,
//! spreadsheets.
//!
//! A line that does not begin with a number, or that begins with `*`, `#` or a quotation mark, is a comment above the
//! table; the last one that names a frequency, or has a cell for each column, is the head of the columns: level in dB or
//! magnitude with an optional phase, or real and imaginary part. A head that is not understood is refused. Without a head,
//! three columns are those of `.frd` (Hz, dB, degrees), and two are frequency and decibels if one of the levels is
//! negative.

use super::{FileError, Foreign, LEVEL};
use crate::calibrate::measurement::sensor::Measurement;
use crate::quantity::{Range, decibels, from_decibels, must_be};
use crate::text_table::{BadLine, FINITE, Row, Separator, cells, lines, wrong};
use num_complex::Complex64;
use std::fmt::Write;

/// Largest magnitude in a file: its square must not overflow.
const MAGNITUDE: Range = Range::new(0.0, 1e30, "");

/// Whether a line is a row of the table: its first two cells are numbers.
fn is_row(line: &str) -> bool {
    let cells = cells(line);
    cells.len() >= 2 && cells.iter().take(2).all(|cell| cell.parse::<f64>().is_ok())
}

fn is_comment(line: &str) -> bool {
    line.starts_with(['*', '#', '%', ';', '"']) && !is_row(line)
}

/// The columns of the response.
#[derive(Clone, Copy, PartialEq)]
enum Form {
    /// Level in dB, and phase.
    Decibel(usize, Option<usize>),
    /// Magnitude and phase.
    Magnitude(usize, Option<usize>),
    /// Real and imaginary part.
    Complex(usize, usize),
}

/// The columns of a table.
struct Columns {
    frequency: usize,
    form: Form,
    /// Hertz per unit of the frequency column.
    hertz: f64,
}

impl Columns {
    /// The columns named by the head of a table; `None` if a required one is missing.
    fn named(head: &str, separator: Separator) -> Option<Self> {
        let head = head.trim_start_matches(['*', '#', '%', ' ']);
        // In some of REW's texts the head is separated by commas and the rows by blanks.
        let cells = match separator {
            Separator::Blank if head.contains(',') => Separator::Comma.cells(head),
            separator => separator.cells(head),
        };
        let cells: Vec<String> = cells.iter().map(|cell| cell.to_lowercase()).collect();
        let find =
            |words: &[&str]| cells.iter().position(|cell| words.iter().any(|word| cell.contains(word)));
        let begins =
            |word: &str| cells.iter().position(|cell| cell.split([' ', '(', '[']).next() == Some(word));
        let part = |words: [&str; 3]| words.into_iter().find_map(begins);
        let frequency = find(&["freq", "hz"]).or_else(|| begins("f"))?;
        let phase = find(&["phase", "deg"]);
        let decibel = find(&["db", "spl", "level"]);
        let magnitude = find(&["magnitude", "amplitude", "linear", "abs"]);
        let parts = part(["re", "real", "h_re"]).zip(part(["im", "imag", "imaginary"]));
        let form = match (parts, decibel, magnitude) {
            (Some((re, im)), ..) => Form::Complex(re, im),
            (None, Some(level), _) => Form::Decibel(level, phase),
            (None, None, Some(level)) => Form::Magnitude(level, phase),
            (None, None, None) => return None,
        };
        let hertz = if cells[frequency].contains("khz") { 1e3 } else { 1.0 };
        Some(Self { frequency, form, hertz })
    }

    /// The columns of a table without a head.
    fn guessed(line: usize, rows: &[Row<String>]) -> Result<Self, BadLine> {
        let has_phase = rows.first().is_some_and(|row| row.cells.len() >= 3);
        let is_negative = |row: &Row<String>| row.cells.get(1).is_some_and(|cell| cell.starts_with('-'));
        if has_phase || rows.iter().any(is_negative) {
            let phase = has_phase.then_some(2);
            return Ok(Self { frequency: 0, form: Form::Decibel(1, phase), hertz: 1.0 });
        }
        let allowed = "frequency_hz,level_db or frequency_hz,magnitude: nothing shows which it is";
        Err(wrong(line, must_be("the line above the first row", allowed)))
    }
}

pub(super) fn read(text: &str) -> Result<Foreign, FileError> {
    let (mut head, mut last) = (None, None);
    let mut separator = None;
    let mut rows: Vec<Row<String>> = Vec::new();
    for (line, content) in lines(text) {
        let is_above = rows.is_empty() && !is_row(content);
        if content.is_empty() || is_comment(content) || is_above {
            if is_above && content.to_lowercase().contains("freq") {
                head = Some((line, content));
            }
            if is_above && !content.is_empty() {
                last = Some((line, content));
            }
            continue;
        }
        let separator = *separator.get_or_insert_with(|| Separator::of(content));
        rows.push(Row { line, cells: separator.cells(content) });
    }
    let (Some(separator), Some(first)) = (separator, rows.first()) else { return Err(FileError::Empty) };
    // A line of as many cells as the rows names them, whatever its words are; blanks separate the words of a sentence, too.
    let names = |&(_, line): &(usize, &str)| {
        separator != Separator::Blank && separator.cells(line).len() == first.cells.len()
    };
    let columns = match head.or_else(|| last.filter(names)) {
        Some((line, content)) => Columns::named(content, separator).ok_or_else(|| {
            let allowed = "a frequency, and a level in dB, a magnitude, or real and imaginary part (re, im)";
            wrong::<FileError>(line, must_be("the head of the columns", allowed))
        })?,
        None => Columns::guessed(first.line, &rows)?,
    };
    let points = rows.iter().map(|row| point(row, &columns)).collect::<Result<_, _>>()?;
    Ok(Foreign { sensor: None, points })
}

fn point(row: &Row<String>, columns: &Columns) -> Result<(f64, Complex64), BadLine> {
    let cell = |at: usize, field: &str| row.number(at, field, FINITE);
    let frequency_hz = cell(columns.frequency, "frequency")? * columns.hertz;
    let within = |at: usize, field: &str, allowed: Range| {
        let value = cell(at, field)?;
        if allowed.contains(value) {
            Ok(value)
        } else {
            Err(wrong(row.line, must_be(format_args!("{field} = {value}"), allowed)))
        }
    };
    let (magnitude, phase) = match columns.form {
        Form::Complex(re, im) => {
            let part = |at, field| within(at, field, Range::new(-MAGNITUDE.high, MAGNITUDE.high, ""));
            return Ok((frequency_hz, Complex64::new(part(re, "real part")?, -part(im, "imaginary part")?)));
        }
        Form::Decibel(level, phase) => (from_decibels(within(level, "level", LEVEL)?), phase),
        Form::Magnitude(level, phase) => (within(level, "magnitude", MAGNITUDE)?, phase),
    };
    let degrees = phase.map_or(Ok(0.0), |at| cell(at, "phase"))?;
    Ok((frequency_hz, Complex64::from_polar(magnitude, -degrees.to_radians())))
}

pub(super) fn write(measurement: &Measurement) -> String {
    let place_m = measurement.place_m;
    let mut text = format!(
        "* {} at {place_m} m from the driven end, over the DAC's full scale\n",
        measurement.sensor.word()
    );
    text.push_str("* Freq(Hz) Level(dB) Phase(degrees)\n");
    for point in &measurement.points {
        let shown = measurement.shown(point);
        let level_db = decibels(shown.norm()).max(LEVEL.low);
        // Writing to a text cannot fail.
        let _ = writeln!(text, "{} {level_db} {}", point.frequency_hz, shown.arg().to_degrees());
    }
    text
}
