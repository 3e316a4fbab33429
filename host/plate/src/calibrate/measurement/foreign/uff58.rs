//! Dataset 58 of a universal file, "function at nodal DOF" (I-DEAS; revision of 30 June 1999), as text.
//!
//! A dataset stands between lines of -1; its number is on its first line. Of its eleven header lines the sixth has
//! the function type, the seventh the data format, the eighth and ninth the kinds of abscissa and ordinate.
//! [`binary`] reads the numbers of dataset 58b.

pub(super) mod binary;

use super::{FileError, Foreign};
use crate::calibrate::measurement::sensor::{Measurement, SensorKind};
use crate::quantity::must_be;
use crate::text_table::{BadLine, FINITE, number, shown, wrong};
use num_complex::Complex64;
use std::fmt::Write;

/// A line of -1 begins and ends a dataset.
const MARK: &str = "-1";
/// Function types that are a response over frequency: general, frequency response, transmissibility, spectrum.
const RESPONSES: [u32; 4] = [0, 4, 5, 12];
/// Abscissa type of a frequency; 0 is unknown.
const FREQUENCY: u32 = 18;
/// Ordinate types of the four kinds of sensor.
const ORDINATES: [(SensorKind, u32, &str); 4] = [
    (SensorKind::Displacement, 8, "m"),
    (SensorKind::Velocity, 11, "m/s"),
    (SensorKind::Acceleration, 12, "m/s^2"),
    (SensorKind::Strain, 3, "m/m"),
];

pub(super) fn is_one(text: &str) -> bool {
    text.lines().map(str::trim).find(|line| !line.is_empty()) == Some(MARK)
}

/// The lines of a dataset with their numbers in the file.
struct Dataset<'a> {
    first: usize,
    lines: Vec<&'a str>,
}

impl<'a> Dataset<'a> {
    /// The words of header line `at`, counted from 0, and its number in the file.
    fn words(&self, at: usize) -> Result<(usize, Vec<&'a str>), BadLine> {
        let line = self.first + at;
        let content = self.lines.get(at).ok_or_else(|| wrong(line, "the dataset's head is cut off"))?;
        Ok((line, content.split_whitespace().collect()))
    }
}

/// A whole number of a header line.
fn whole(line: usize, field: &str, word: Option<&&str>) -> Result<u32, BadLine> {
    let word = word.copied().unwrap_or("nothing");
    word.parse()
        .map_err(|_| wrong(line, must_be(format_args!("{field} = {}", shown(word)), "a whole number")))
}

/// Whether the first line of a dataset has this number.
fn is_number(line: &str, number: &str) -> bool {
    line.split_whitespace().next().is_some_and(|word| word.eq_ignore_ascii_case(number))
}

/// All datasets with the number 58.
fn datasets(text: &str) -> Result<Vec<Dataset<'_>>, FileError> {
    let mut found = Vec::new();
    let mut lines = (1..).zip(text.lines());
    while let Some((_, line)) = lines.next() {
        if line.trim() != MARK {
            continue;
        }
        let Some((at, kind)) = lines.next() else { break };
        let content: Vec<&str> =
            lines.by_ref().map(|(_, line)| line).take_while(|line| line.trim() != MARK).collect();
        if is_number(kind, "58") {
            found.push(Dataset { first: at + 1, lines: content });
        }
    }
    Ok(found)
}

pub(super) fn read(text: &str) -> Result<Foreign, FileError> {
    let datasets = datasets(text)?;
    match &datasets[..] {
        [] => Err(FileError::NoFunction),
        [dataset] => Ok(function(dataset)?),
        _ => Err(FileError::ManyFunctions),
    }
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
}

impl Form {
    fn of(dataset: &Dataset<'_>) -> Result<Self, BadLine> {
        let (line, words) = dataset.words(5)?;
        let kind = whole(line, "the function's type", words.first())?;
        if !RESPONSES.contains(&kind) {
            let allowed = "0, 4, 5 or 12: a response over the frequency";
            return Err(wrong(line, must_be(format_args!("the function's type = {kind}"), allowed)));
        }
        let (line, abscissa) = dataset.words(7)?;
        let is_frequency = whole(line, "the abscissa's type", abscissa.first())?;
        if ![0, FREQUENCY].contains(&is_frequency) {
            let given = format_args!("the abscissa's type = {is_frequency}");
            return Err(wrong(line, must_be(given, "18: a frequency")));
        }
        let (line, ordinate) = dataset.words(8)?;
        let ordinate = whole(line, "the ordinate's type", ordinate.first())?;
        let (line, form) = dataset.words(6)?;
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
            number(line, field, &exponent(form.get(at).copied().unwrap_or("0")), FINITE)
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
        })
    }

    /// Numbers of a point, without its abscissa.
    const fn ordinates(&self) -> usize {
        if self.is_complex { 2 } else { 1 }
    }

    /// The function with these numbers.
    fn points(&self, values: &[f64]) -> Result<Foreign, BadLine> {
        let width = usize::from(!self.is_even) + self.ordinates();
        if Some(values.len()) != self.count.checked_mul(width) {
            let given = format_args!("the dataset of {} points has {} numbers", self.count, values.len());
            return Err(wrong(self.line, must_be(given, format!("{width} for each point"))));
        }
        let point = |(i, row): (usize, &[f64])| {
            let (frequency_hz, row) = match row {
                [frequency_hz, rest @ ..] if !self.is_even => (*frequency_hz, rest),
                row => (self.start_hz + self.step_hz * i as f64, row),
            };
            let response = match row {
                [re, im, ..] => Complex64::new(*re, -im),
                [magnitude] => Complex64::new(magnitude.abs(), 0.0),
                [] => Complex64::ZERO,
            };
            (frequency_hz, response)
        };
        let points = values.chunks_exact(width).enumerate().map(point).collect();
        Ok(Foreign { sensor: self.sensor, points })
    }
}

fn function(dataset: &Dataset<'_>) -> Result<Foreign, BadLine> {
    let form = Form::of(dataset)?;
    let mut values = Vec::new();
    for (at, content) in dataset.lines.iter().enumerate().skip(11) {
        for word in apart(content) {
            values.push(number(dataset.first + at, "the value", &exponent(&word), FINITE)?);
        }
    }
    form.points(&values)
}

/// The numbers of a line. A Fortran field fills its whole width, so a sign may touch the number before it.
fn apart(line: &str) -> Vec<String> {
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

/// A number whose exponent may be written with Fortran's D.
fn exponent(word: &str) -> String {
    word.replace(['d', 'D'], "E")
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
