//! Tables of frequency and response, as measuring programs export them: REW's text, `.frd`, spreadsheets.
//!
//! A response is a level in dB or a magnitude with an optional phase, or real and imaginary part. Without a head, three
//! columns are those of `.frd` (Hz, dB, degrees), and two are frequency and decibels if one of the levels is negative.

use super::{FileError, Foreign, ForeignPoint, LEVEL};
use crate::calibrate::measurement::sensor::{Measurement, SensorKind};
use crate::quantity::{Range, decibels, from_decibels, must_be};
use crate::text_table::{BadLine, Chosen, Quantity, Row, Table, UnclearColumns, Unit, wrong};
use num_complex::Complex64;
use std::f64::consts::{PI, TAU};
use std::fmt::Write;

/// Largest magnitude in a file: its square must not overflow.
const MAGNITUDE: Range = Range::new(0.0, 1e30, "");

/// Beyond this, a phase without a unit is in degrees.
const PHASE_CLEAR: f64 = 8.0 * TAU;

/// The columns of a response, each with its unit.
struct Columns(Vec<(Quantity, usize, Unit, String)>);

impl Columns {
    /// The columns that the head names.
    fn named(table: &Table) -> Result<Self, UnclearColumns> {
        let find = |what: &str, of: fn(Quantity) -> bool| table.find(what, &of);
        let frequency = find("frequency", |of| of == Quantity::Frequency)?;
        let frequency =
            frequency.ok_or_else(|| table.unclear("no column is named as the frequency".to_owned()))?;
        let parts = find("real part", |of| of == Quantity::Real)?
            .zip(find("imaginary part", |of| of == Quantity::Imaginary)?);
        let mut all = vec![(Quantity::Frequency, frequency)];
        if let Some((real, imaginary)) = parts {
            all.extend([(Quantity::Real, real), (Quantity::Imaginary, imaginary)]);
        } else {
            let level = find("level", Quantity::is_level)?;
            let missing =
                "no column is named as a level in dB, a magnitude, or both a real and an imaginary part";
            let level = level.ok_or_else(|| table.unclear(missing.to_owned()))?;
            let by_unit = if matches!(table.columns[level].unit(), Some((Unit::Decibels, _))) {
                Quantity::Level
            } else {
                Quantity::Magnitude
            };
            all.push((table.quantity(level).unwrap_or(by_unit), level));
            all.extend(find("phase", |of| of == Quantity::Phase)?.map(|at| (Quantity::Phase, at)));
        }
        all.into_iter()
            .map(|(of, at)| unit_of(table, of, at).map(|(unit, text)| (of, at, unit, text)))
            .collect::<Result<_, _>>()
            .map(Self)
    }

    /// The columns that the user names.
    fn chosen(table: &Table, chosen: &[Chosen]) -> Result<Self, UnclearColumns> {
        let has = |of: fn(Quantity) -> bool| chosen.iter().any(|it| of(it.quantity));
        let is_whole = has(Quantity::is_level)
            != (has(|of| of == Quantity::Real) && has(|of| of == Quantity::Imaginary));
        if !has(|of| of == Quantity::Frequency) || !is_whole {
            let why = "a frequency is needed, and either a level or magnitude, or both a real and an imaginary part";
            return Err(table.unclear(why.to_owned()));
        }
        if let Some(it) = chosen.iter().find(|it| it.at >= table.columns.len()) {
            return Err(table.unclear(format!("there is no column {}", it.at + 1)));
        }
        let column = |it: &Chosen| {
            let named = || table.columns[it.at].unit().filter(|(unit, _)| unit.suits(it.quantity));
            let (unit, text) = it.unit.clone().or_else(named).unwrap_or_else(|| usual(it.quantity));
            (it.quantity, it.at, unit, text)
        };
        Ok(Self(chosen.iter().map(column).collect()))
    }

    /// The columns of a table without a head.
    fn guessed(table: &Table) -> Result<Self, UnclearColumns> {
        let is_negative = |row: &Row| table.number(row, 1).is_ok_and(|level| level < 0.0);
        let usual = [Quantity::Frequency, Quantity::Level, Quantity::Phase].map(|of| (of, usual(of)));
        let columns = usual.into_iter().enumerate().map(|(at, (of, (unit, text)))| (of, at, unit, text));
        match table.columns.len() {
            3 if is_numbered(table) => {
                let why = "no line names the columns: the first may count the rows, and the second be the frequency";
                Err(table.unclear(why.to_owned()))
            }
            3 => Ok(Self(columns.collect())),
            2 if table.rows().iter().any(is_negative) => Ok(Self(columns.take(2).collect())),
            2 => Err(table.unclear(
                "no line names the columns, and nothing shows whether the second is in dB".to_owned(),
            )),
            many => Err(table.unclear(format!("no line names the {many} columns"))),
        }
    }

    fn of(&self, wanted: Quantity) -> Option<(usize, Unit)> {
        self.0.iter().find(|it| it.0 == wanted).map(|it| (it.1, it.2))
    }

    fn level(&self) -> Option<(usize, Unit)> {
        self.0.iter().find(|it| it.0.is_level()).map(|it| (it.1, it.2))
    }

    /// What the sensor shows, by the name or the unit of the response.
    fn sensor(&self) -> Option<SensorKind> {
        let kind = |of: Quantity| SensorKind::ALL.into_iter().find(|kind| kind.word() == of.word());
        let by_unit = |unit: Unit| if let Unit::Linear(_, of) = unit { of } else { None };
        let each = self.0.iter().map(|(of, _, unit, _)| kind(*of).or_else(|| by_unit(*unit).and_then(kind)));
        each.flatten().next()
    }
}

/// Whether the first column counts the rows from 0 or 1, and the second one rises.
fn is_numbered(table: &Table) -> bool {
    let column = |at: usize| table.rows().iter().map(move |row| table.number(row, at).unwrap_or(f64::NAN));
    let first = column(0).next().unwrap_or(f64::NAN);
    let counts = (0..).zip(column(0)).all(|(row, number)| number == first + f64::from(row));
    (first == 0.0 || first == 1.0) && counts && column(1).is_sorted_by(|a, b| a < b)
}

/// The unit of a quantity that states none.
fn usual(of: Quantity) -> (Unit, String) {
    let (unit, text) = match of {
        Quantity::Frequency => (Unit::Hertz(1.0), "Hz"),
        Quantity::Level => (Unit::Decibels, "dB"),
        Quantity::Phase => (Unit::Radians(PI / 180.0), "degrees"),
        _ => (Unit::Linear(1.0, None), ""),
    };
    (unit, text.to_owned())
}

/// The unit of a column by its name, or the usual one where the numbers allow no other.
fn unit_of(table: &Table, of: Quantity, at: usize) -> Result<(Unit, String), UnclearColumns> {
    if let Some(unit) = table.columns[at].unit() {
        return Ok(unit);
    }
    let values =
        || table.rows().iter().filter_map(|row| table.number(row, at).ok()).filter(|it| it.is_finite());
    let (low, high) =
        values().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), it| (low.min(it), high.max(it)));
    let name = &table.columns[at].name;
    let is_like_levels = low >= 10.0 && high < 200.0 && high < 10.0 * low;
    let unclear = match of {
        // A phase that is not wrapped may be many turns of radians.
        Quantity::Phase if low < high && low >= -PHASE_CLEAR && high <= PHASE_CLEAR => {
            "in degrees or in radians"
        }
        // Levels of sound are some ten decibels above 0, and a level below 10 may be a magnitude.
        Quantity::Level if low >= 0.0 && high < 10.0 => "in dB",
        Quantity::Magnitude if low < 0.0 || (20.0..200.0).contains(&high) || is_like_levels => "in dB",
        of if of.is_level() && (low < 0.0 || is_like_levels) && of != Quantity::Level => "in dB",
        of => return Ok(usual(of)),
    };
    Err(table.unclear(format!("nothing shows whether *{name}* is {unclear}")))
}

/// Reads a table; no choice of columns leaves it to the head.
pub(super) fn read(text: &str, chosen: &[Chosen]) -> Result<Foreign, FileError> {
    let table = Table::read(text)?.ok_or(FileError::Empty)?;
    let columns = if !chosen.is_empty() {
        Columns::chosen(&table, chosen)?
    } else if table.head()?.is_some() {
        Columns::named(&table)?
    } else {
        Columns::guessed(&table)?
    };
    let points = table.rows().iter().map(|row| point(&table, row, &columns)).collect::<Result<_, _>>()?;
    let read: Vec<_> = columns.0.iter().map(|(of, at, _, unit)| (*at, of.word(), &**unit)).collect();
    Ok(Foreign { sensor: columns.sensor(), points, columns: table.columns_read(&read), is_table: true })
}

fn point(table: &Table, row: &Row, columns: &Columns) -> Result<ForeignPoint, BadLine> {
    let value = |(at, unit): (usize, Unit), allowed: Range| {
        let value = table.number(row, at)?;
        if value.is_finite() && !allowed.contains(value) {
            return Err(wrong(row.line, must_be(format_args!("{} = {value}", table.shown(at)), allowed)));
        }
        // The logarithm of nothing is no number.
        let value = if value.is_finite() { value } else { f64::NAN };
        Ok(value * unit.size())
    };
    let any = Range::new(-MAGNITUDE.high, MAGNITUDE.high, "");
    let frequency_hz = columns.of(Quantity::Frequency).map_or(Ok(f64::NAN), |it| value(it, any))?;
    let part = |of: Quantity| columns.of(of).map_or(Ok(0.0), |it| value(it, any));
    let response = match columns.level() {
        None => Complex64::new(part(Quantity::Real)?, -part(Quantity::Imaginary)?),
        Some(level) => {
            let magnitude = match level.1 {
                Unit::Decibels => from_decibels(value(level, LEVEL)?),
                _ => value(level, MAGNITUDE)?,
            };
            Complex64::from_polar(magnitude, -part(Quantity::Phase)?)
        }
    };
    Ok(ForeignPoint { line: row.line, frequency_hz, response: Some(response).filter(|it| it.is_finite()) })
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
