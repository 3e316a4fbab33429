//! Dataset 58 of a universal file, "function at nodal DOF" (I-DEAS; revision of 30 June 1999), as text or as bytes (58b).
//!
//! A dataset stands between lines of -1; its number is on its first line. Of its eleven header lines the sixth has
//! the function type, the seventh the data format, the eighth and ninth the kinds of abscissa and ordinate. Its numbers
//! stand in fixed columns, so that they may touch; [`binary`] reads those of dataset 58b.

mod binary;

use super::{FileError, Foreign, ForeignPoint, LEVEL};
use crate::calibrate::measurement::sensor::{Measurement, SensorKind};
use crate::quantity::{from_decibels, must_be};
use crate::text_table::{BadLine, ColumnRead, FINITE, Unit, number, shown, text_of, unit, wrong};
use num_complex::Complex64;
use std::borrow::Cow;
use std::fmt::Write;

/// Header lines.
const HEAD: usize = 11;
/// Function types that are a response over frequency: general, frequency response, transmissibility, spectrum.
const RESPONSES: [u32; 4] = [0, 4, 5, 12];
/// Function types that are none, and what they are.
const OTHERS: [(u32, &str); 8] = [
    (1, "a time response"),
    (2, "an auto spectrum"),
    (3, "a cross spectrum"),
    (6, "a coherence"),
    (7, "an auto-correlation"),
    (8, "a cross-correlation"),
    (9, "a power spectral density"),
    (10, "an energy spectral density"),
];
/// Largest number: its square must not overflow.
const LARGEST: f64 = 1e30;
/// Abscissa type of a frequency; 0 is unknown.
const FREQUENCY: u32 = 18;
/// Ordinate types of the four kinds of sensor.
const ORDINATES: [(SensorKind, u32, &str); 4] = [
    (SensorKind::Displacement, 8, "m"),
    (SensorKind::Velocity, 11, "m/s"),
    (SensorKind::Acceleration, 12, "m/s^2"),
    (SensorKind::Strain, 3, "m/m"),
];

/// A file's bytes, line by line.
struct Lines<'a> {
    bytes: &'a [u8],
    /// Offset of the next byte, and the number of the last line.
    at: usize,
    line: usize,
}

impl<'a> Lines<'a> {
    const fn of(bytes: &'a [u8]) -> Self {
        Self { bytes, at: 0, line: 0 }
    }

    /// The next line, without blanks at its end; it is ended by a line feed, a carriage return, or both.
    fn next(&mut self) -> Option<&'a [u8]> {
        let rest = self.bytes.get(self.at..).filter(|rest| !rest.is_empty())?;
        let length = rest.iter().position(|byte| matches!(byte, b'\n' | b'\r')).unwrap_or(rest.len());
        let end = if rest[length..].starts_with(b"\r\n") { 2 } else { 1 };
        self.at += length + end;
        self.line += 1;
        Some(rest[..length].trim_ascii_end())
    }

    fn skip(&mut self, count: usize) -> Option<&'a [u8]> {
        let taken = self.bytes.get(self.at..)?.get(..count)?;
        self.at += count;
        Some(taken)
    }

    /// Goes behind the next line of -1, to the first line of a dataset, and returns its number.
    fn dataset(&mut self) -> Option<Cow<'a, str>> {
        loop {
            while !is_mark(self.next()?) {}
            let mut first = self.next()?;
            while is_mark(first) {
                first = self.next()?;
            }
            if first.trim_ascii_start().first().is_some_and(u8::is_ascii_digit) {
                return Some(text_of(first));
            }
        }
    }
}

fn is_mark(line: &[u8]) -> bool {
    line.trim_ascii() == b"-1"
}

/// Whether a file has a dataset. Text may stand above the first one.
pub(super) fn is_one(bytes: &[u8]) -> bool {
    Lines::of(bytes).dataset().is_some_and(|number| {
        let word = number.split_whitespace().next().unwrap_or("");
        word.trim_end_matches(['b', 'B']).parse::<u16>().is_ok()
    })
}

/// The header lines of a dataset with the number of the first in the file.
struct Head {
    first: usize,
    lines: Vec<String>,
}

impl Head {
    /// Header line `at`, counted from 0, and its number in the file.
    fn line(&self, at: usize) -> Result<(usize, &str), BadLine> {
        let line = self.first + at;
        let content = self.lines.get(at).ok_or_else(|| wrong(line, "the dataset's head is cut off"))?;
        Ok((line, content))
    }

    /// The fields of header line `at`: in columns of these widths if they fill them, else separated by blanks.
    fn fields(&self, at: usize, widths: &[usize]) -> Result<(usize, Vec<&str>), BadLine> {
        let (line, content) = self.line(at)?;
        let words = || content.split_whitespace().collect();
        Ok((line, columns(content, widths).unwrap_or_else(words)))
    }
}

/// The fields of a line in columns of these widths; `None` unless each is filled up to its last letter.
fn columns<'a>(line: &'a str, widths: &[usize]) -> Option<Vec<&'a str>> {
    let mut at = 0;
    let field = |&width: &usize| {
        let field = line.get(at..at + width)?;
        at += width;
        let is_filled =
            !field.ends_with(char::is_whitespace) && !field.trim_start().contains(char::is_whitespace);
        is_filled.then(|| field.trim_start())
    };
    widths.iter().map(field).collect()
}

/// Hertz per unit of the abscissa, by its label; a frequency without a known unit is in hertz.
fn hertz(line: usize, kind: u32, label: &str, unit: Option<Unit>) -> Result<f64, BadLine> {
    let is_none = label.is_empty() || label.eq_ignore_ascii_case("none");
    match unit {
        Some(Unit::Hertz(size)) => Ok(size),
        None if is_none || kind == FREQUENCY && !label.to_lowercase().starts_with("order") => Ok(1.0),
        _ => {
            let given = format_args!("the abscissa's unit = {}", shown(label));
            Err(wrong(line, must_be(given, "of a frequency, such as Hz, kHz or rad/s")))
        }
    }
}

/// A whole number of a header line.
fn whole(line: usize, field: &str, word: Option<&&str>) -> Result<u32, BadLine> {
    let word = word.copied().unwrap_or("nothing");
    word.parse()
        .map_err(|_| wrong(line, must_be(format_args!("{field} = {}", shown(word)), "a whole number")))
}

/// Reads the only function of a universal file.
pub(super) fn read(bytes: &[u8]) -> Result<Foreign, FileError> {
    let mut lines = Lines::of(bytes);
    let (mut functions, mut others) = (Vec::new(), Vec::new());
    while let Some(kind) = lines.dataset() {
        let number = kind.split_whitespace().next().unwrap_or("").to_lowercase();
        match &*number {
            "58" => functions.push(of_dataset(&number, function(&mut lines))),
            "58b" => functions.push(of_dataset(&number, binary::function(&mut lines, &kind))),
            _ => {
                others.push(number);
                while lines.next().is_some_and(|line| !is_mark(line)) {}
            }
        }
    }
    match functions.len() {
        0 => {
            others.dedup();
            Err(FileError::NoFunction { others: others.join(", ") })
        }
        1 => Ok(functions.remove(0)?),
        _ => Err(FileError::ManyFunctions),
    }
}

/// A function, or the error with the dataset's number.
fn of_dataset(number: &str, function: Result<Foreign, BadLine>) -> Result<Foreign, BadLine> {
    function.map_err(|BadLine { line, reason }| wrong(line, format!("dataset {number}: {reason}")))
}

/// The eleven lines above a dataset's numbers.
fn head(lines: &mut Lines<'_>) -> Head {
    let first = lines.line + 1;
    let texts = (0..HEAD).map_while(|_| lines.next()).take_while(|line| !is_mark(line));
    Head { first, lines: texts.map(|line| text_of(line).into_owned()).collect() }
}

/// The format of a dataset's numbers, from its header.
struct Form {
    /// Line of the header with the data format.
    line: usize,
    count: usize,
    is_complex: bool,
    is_double: bool,
    /// Whether the abscissas are evenly spaced and not written.
    is_even: bool,
    start_hz: f64,
    step_hz: f64,
    sensor: Option<SensorKind>,
    /// Hertz per unit of the abscissa.
    hertz: f64,
    /// Whether the ordinates are levels in dB.
    is_level: bool,
    /// What abscissa and ordinate are called.
    names: [String; 2],
}

impl Form {
    fn of(head: &Head) -> Result<Self, BadLine> {
        let (line, words) = head.fields(5, &[5, 10])?;
        let kind = whole(line, "the function's type", words.first())?;
        if !RESPONSES.contains(&kind) {
            let allowed = "0, 4, 5 or 12: a response over the frequency";
            let called = OTHERS.iter().find(|it| it.0 == kind);
            let called = called.map_or(String::new(), |it| format!(" ({})", it.1));
            return Err(wrong(line, must_be(format_args!("the function's type = {kind}{called}"), allowed)));
        }
        let (line, abscissa) = head.fields(7, &[10, 5])?;
        let is_frequency = whole(line, "the abscissa's type", abscissa.first())?;
        if ![0, FREQUENCY].contains(&is_frequency) {
            let given = format_args!("the abscissa's type = {is_frequency}");
            return Err(wrong(line, must_be(given, "18: a frequency")));
        }
        let (line, ordinate) = head.fields(8, &[10, 5])?;
        let ordinate = whole(line, "the ordinate's type", ordinate.first())?;
        let label = |at: usize, from: usize| -> Result<String, BadLine> {
            let text: String = head.line(at)?.1.chars().skip(from).take(20).collect();
            Ok(text.trim().to_owned())
        };
        let of_abscissa = label(7, 47)?;
        let hertz = hertz(head.line(7)?.0, is_frequency, &of_abscissa, unit(&of_abscissa))?;
        let is_level = unit(&label(8, 47)?) == Some(Unit::Decibels);
        let names = [shown(&label(7, 26)?), shown(&label(8, 26)?)];
        let (line, form) = head.fields(6, &[10, 10, 10, 13, 13])?;
        let (is_complex, is_double) = match whole(line, "the data's form", form.first())? {
            2 => (false, false),
            4 => (false, true),
            5 => (true, false),
            6 => (true, true),
            other => {
                let allowed = "2, 4, 5 or 6: real or complex numbers";
                return Err(wrong(line, must_be(format_args!("the data's form = {other}"), allowed)));
            }
        };
        let real = |at: usize, field: &str| {
            number(line, field, &fortran_number(form.get(at).copied().unwrap_or("0")), FINITE)
        };
        Ok(Self {
            line,
            count: whole(line, "the number of points", form.get(1))? as usize,
            is_complex,
            is_double,
            is_even: whole(line, "the abscissa's spacing", form.get(2))? == 1,
            start_hz: real(3, "the lowest abscissa")?,
            step_hz: real(4, "the abscissa's increment")?,
            sensor: ORDINATES.iter().find(|(_, number, _)| *number == ordinate).map(|it| it.0),
            hertz,
            is_level,
            names,
        })
    }

    /// Numbers of a point, without its abscissa.
    const fn ordinates(&self) -> usize {
        if self.is_complex { 2 } else { 1 }
    }

    /// The widths of the columns of a line of the text.
    const fn widths(&self) -> &'static [usize] {
        match (self.is_double, self.is_even, self.is_complex) {
            (false, ..) => &[13; 6],
            (true, true, _) => &[20; 4],
            (true, false, true) => &[13, 20, 20],
            (true, false, false) => &[13, 20, 13, 20],
        }
    }

    /// The function with these numbers, each with its line.
    fn points(&self, values: &[(usize, f64)]) -> Result<Foreign, BadLine> {
        let width = usize::from(!self.is_even) + self.ordinates();
        let wanted = self.count.checked_mul(width).filter(|wanted| *wanted <= values.len());
        // The last line may be filled with zeros.
        let (values, padding) = values.split_at(wanted.unwrap_or(0));
        let last = values.last().map_or(0, |value| value.0);
        if wanted.is_none() || padding.iter().any(|&(line, value)| line != last || value != 0.0) {
            let count = values.len() + padding.len();
            let given = format_args!("the dataset of {} points has {count} numbers", self.count);
            return Err(wrong(self.line, must_be(given, format!("{width} for each point"))));
        }
        // Bytes in the other order are numbers of any size.
        if let Some((line, value)) = values.iter().find(|it| it.1.abs() > LARGEST) {
            let allowed = format_args!("-{LARGEST:e} to {LARGEST:e}: is the order of the bytes right?");
            return Err(wrong(*line, must_be(format_args!("the value = {value:e}"), allowed)));
        }
        let point = |(i, row): (usize, &[(usize, f64)])| -> Result<ForeignPoint, BadLine> {
            let line = row.first().map_or(self.line, |it| it.0);
            let (frequency, row) = match row {
                [(_, frequency), rest @ ..] if !self.is_even => (*frequency, rest),
                row => (self.start_hz + self.step_hz * i as f64, row),
            };
            let response = match row {
                [(_, re), (_, im), ..] => Complex64::new(*re, -im),
                &[(line, value)] => self.magnitude(line, value)?.into(),
                [] => Complex64::ZERO,
            };
            Ok(ForeignPoint { line, frequency_hz: frequency * self.hertz, response: Some(response) })
        };
        let points = values.chunks_exact(width).enumerate().map(point).collect::<Result<_, _>>()?;
        let [abscissa, ordinate] = self.names.clone();
        let unit = if self.is_level && !self.is_complex { "dB" } else { "" };
        let of_response =
            self.sensor.map_or(if self.is_complex { "response" } else { "magnitude" }, SensorKind::word);
        let columns =
            vec![ColumnRead::new(abscissa, "frequency", "Hz"), ColumnRead::new(ordinate, of_response, unit)];
        Ok(Foreign { sensor: self.sensor, points, columns, is_table: false })
    }

    /// A magnitude by its real ordinate.
    fn magnitude(&self, line: usize, value: f64) -> Result<f64, BadLine> {
        if self.is_level {
            let refused = || wrong(line, must_be(format_args!("the level = {value}"), LEVEL));
            return Some(value).filter(|it| LEVEL.contains(*it)).map(from_decibels).ok_or_else(refused);
        }
        if value < 0.0 {
            let given = format_args!("the magnitude = {value}");
            return Err(wrong(line, must_be(given, "0 or above: save complex numbers, or magnitudes")));
        }
        Ok(value)
    }
}

/// The function of a dataset of text, up to the line of -1 behind it.
fn function(lines: &mut Lines<'_>) -> Result<Foreign, BadLine> {
    let head = head(lines);
    let form = Form::of(&head);
    let mut values = Vec::new();
    let mut bad = None;
    while let Some(line) = lines.next().filter(|line| !is_mark(line)) {
        let (Ok(form), None) = (&form, &bad) else { continue };
        let text = text_of(line);
        for word in numbers(&text, form.widths()) {
            match number(lines.line, "the value", &fortran_number(&word), FINITE) {
                Ok(value) => values.push((lines.line, value)),
                Err(error) => bad = bad.or(Some(error)),
            }
        }
    }
    let form = form?;
    bad.map_or_else(|| form.points(&values), Err)
}

/// The numbers of a line: in its columns if they fill them, else separated by blanks, or by the sign of the next one.
fn numbers(line: &str, widths: &[usize]) -> Vec<String> {
    let in_columns = |count: usize| {
        columns(line, &widths[..count]).filter(|_| widths[..count].iter().sum::<usize>() == line.len())
    };
    if let Some(fields) = (1..=widths.len()).rev().find_map(in_columns) {
        return fields.into_iter().map(str::to_owned).collect();
    }
    let mut words: Vec<String> = Vec::new();
    let mut before = ' ';
    for letter in line.chars() {
        if letter.is_whitespace() {
            before = ' ';
            continue;
        }
        let is_sign = matches!(letter, '+' | '-') && !matches!(before, 'e' | 'E' | 'd' | 'D');
        if before == ' ' || is_sign {
            words.push(String::new());
        }
        if let Some(word) = words.last_mut() {
            word.push(letter);
        }
        before = letter;
    }
    words
}

/// A number whose exponent may be written with Fortran's D, or without a letter if it has three digits.
fn fortran_number(word: &str) -> String {
    let word = word.replace(['d', 'D'], "E");
    match word.rfind(['+', '-']) {
        Some(at) if at > 0 && !word.contains(['e', 'E']) => format!("{}E{}", &word[..at], &word[at..]),
        _ => word,
    }
}

/// A number in Fortran's format E.
fn fortran(value: f64, width: usize, digits: usize) -> String {
    let text = format!("{value:.digits$e}");
    let (mantissa, exponent) = text.split_once('e').unwrap_or((&text, "0"));
    let (sign, exponent) = exponent.strip_prefix('-').map_or(('+', exponent), |rest| ('-', rest));
    format!("{:>width$}", format!("{mantissa}E{sign}{exponent:0>2}"))
}

pub(super) fn write(measurement: &Measurement) -> String {
    let mut text = String::from("    -1\n    58\n");
    let word = measurement.sensor.word();
    let what = format!("{word} at {} m over the DAC's full scale", measurement.place_m);
    for line in [what.as_str(), "NONE", "NONE", "NONE", "NONE"] {
        // Writing to a text cannot fail.
        let _ = writeln!(text, "{line:<80}");
    }
    let _ = writeln!(
        text,
        "{:>5}{:>10}{:>5}{:>10} {:<10}{:>10}{:>4} {:<10}{:>10}{:>4}",
        4, 0, 0, 0, "NONE", 1, 3, "NONE", 0, 0
    );
    let zero = fortran(0.0, 13, 5);
    let _ = writeln!(text, "{:>10}{:>10}{:>10}{zero}{zero}{zero}", 6, measurement.points.len(), 0);
    let mut axis = |kind: u32, label: &str, unit: &str| {
        let _ = writeln!(text, "{kind:>10}{:>5}{:>5}{:>5} {label:<20} {unit:<20}", 0, 0, 0);
    };
    let ordinate = ORDINATES.iter().find(|(sensor, ..)| *sensor == measurement.sensor);
    let (kind, unit) = ordinate.map_or((0, "NONE"), |(_, kind, unit)| (*kind, *unit));
    axis(FREQUENCY, "Frequency", "Hz");
    axis(kind, word, measurement.unit_per_response.map_or("NONE", |_| unit));
    axis(0, "NONE", "NONE");
    axis(0, "NONE", "NONE");
    for point in &measurement.points {
        let shown = measurement.shown(point);
        let (re, im) = (fortran(shown.re, 20, 12), fortran(shown.im, 20, 12));
        let _ = writeln!(text, "{}{re}{im}", fortran(point.frequency_hz, 13, 5));
    }
    text.push_str("    -1\n");
    text
}
