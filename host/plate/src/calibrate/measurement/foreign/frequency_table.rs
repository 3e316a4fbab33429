//! Tables of frequency, level and optional phase, as measuring programs export them: REW's text, `.frd`,
//! spreadsheets.
//!
//! A line that does not begin with a number, or that begins with `*`, `#` or a quotation mark, is a comment above the
//! table; the last one that names a frequency is the head of the columns. Without a head, three columns are those of
//! `.frd` (Hz, dB, degrees), and two are frequency and decibels if one of the levels is negative.

use super::{FileError, Foreign, LEVEL};
use crate::calibrate::measurement::sensor::Measurement;
use crate::quantity::{Range, must_be};
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

/// Unit of the level column.
#[derive(Clone, Copy, PartialEq)]
enum Level {
    Decibel,
    Magnitude,
}

/// The columns of a table.
struct Columns {
    frequency: usize,
    level: usize,
    unit: Level,
    phase: Option<usize>,
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
        let frequency = find(&["freq", "hz"])?;
        let phase = find(&["phase", "deg"]);
        let decibel = find(&["db", "spl", "level"]);
        let magnitude = find(&["magnitude", "amplitude", "linear", "abs"]);
        let (level, unit) = match (decibel, magnitude) {
            (Some(level), _) => (level, Level::Decibel),
            (None, Some(level)) => (level, Level::Magnitude),
            (None, None) => return None,
        };
        let hertz = if cells[frequency].contains("khz") { 1e3 } else { 1.0 };
        Some(Self { frequency, level, unit, phase, hertz })
    }

    /// The columns of a table without a head.
    fn guessed(line: usize, rows: &[Row<String>]) -> Result<Self, BadLine> {
        let has_phase = rows.first().is_some_and(|row| row.cells.len() >= 3);
        let is_negative = |row: &Row<String>| row.cells.get(1).is_some_and(|cell| cell.starts_with('-'));
        if has_phase || rows.iter().any(is_negative) {
            let phase = has_phase.then_some(2);
            return Ok(Self { frequency: 0, level: 1, unit: Level::Decibel, phase, hertz: 1.0 });
        }
        let allowed = "frequency_hz,level_db or frequency_hz,magnitude: nothing shows which it is";
        Err(wrong(line, must_be("the line above the first row", allowed)))
    }
}

pub(super) fn read(text: &str) -> Result<Foreign, FileError> {
    let mut head = None;
    let mut separator = None;
    let mut rows: Vec<Row<String>> = Vec::new();
    for (line, content) in lines(text) {
        let is_above = rows.is_empty() && !is_row(content);
        if content.is_empty() || is_comment(content) || is_above {
            if is_above && content.to_lowercase().contains("freq") {
                head = Some(content);
            }
            continue;
        }
        let separator = *separator.get_or_insert_with(|| Separator::of(content));
        rows.push(Row { line, cells: separator.cells(content) });
    }
    let (Some(separator), Some(first)) = (separator, rows.first()) else { return Err(FileError::Empty) };
    let columns = match head.and_then(|head| Columns::named(head, separator)) {
        Some(columns) => columns,
        None => Columns::guessed(first.line, &rows)?,
    };
    let points = rows.iter().map(|row| point(row, &columns)).collect::<Result<_, _>>()?;
    Ok(Foreign { sensor: None, points })
}

fn point(row: &Row<String>, columns: &Columns) -> Result<(f64, Complex64), BadLine> {
    let cell = |at: usize, field: &str| row.number(at, field, FINITE);
    let frequency_hz = cell(columns.frequency, "frequency")? * columns.hertz;
    let (field, allowed) = match columns.unit {
        Level::Decibel => ("level", LEVEL),
        Level::Magnitude => ("magnitude", MAGNITUDE),
    };
    let value = cell(columns.level, field)?;
    if !allowed.contains(value) {
        return Err(wrong(row.line, must_be(format_args!("{field} = {value}"), allowed)));
    }
    let magnitude = match columns.unit {
        Level::Decibel => 10_f64.powf(value / 20.0),
        Level::Magnitude => value,
    };
    let degrees = columns.phase.map_or(Ok(0.0), |at| cell(at, "phase"))?;
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
        let level_db = (20.0 * shown.norm().log10()).max(LEVEL.low);
        // Writing to a text cannot fail.
        let _ = writeln!(text, "{} {level_db:.6} {:.6}", point.frequency_hz, shown.arg().to_degrees());
    }
    text
}
