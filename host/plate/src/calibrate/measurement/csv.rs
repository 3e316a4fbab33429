//! A measurement as text: lines `# field = value`, then a table of frequencies.
//!
//! ```text
//! # place_m = 0.032
//! # sensor = acceleration
//! # sample_rate_hz = 400000
//! frequency_hz,re,im,noise,headroom_db
//! 87.1,0.0213,-0.0044,0.0002,18.2
//! 88.9,0.0231,-0.0039,0.0002,
//! ```
//!
//! `place_m` and `sensor` are required; `place_tolerance_m`, `unit_per_response`, `sensor_mass_kg` with
//! `sensor_width_m`, and `sample_rate_hz` are optional, and so are the column of the headroom and each number in it. A
//! spreadsheet may have saved it: with another separator, a decimal comma, and separators behind the fields.

use super::sensor::{MeasuredPoint, Measurement, POINTS, SensorKind};
use crate::calibrate::error::CalibrateError;
use crate::quantity::{WrongCount, must_be, nearest};
use crate::text_table::{ANY, BadLine, Row, Table, lines, number, shown, wrong};
use num_complex::Complex64;
use std::fmt::Write;
use thiserror::Error;

/// The table's columns; the last may be left out.
const COLUMNS: [&str; 5] = ["frequency_hz", "re", "im", "noise", "headroom_db"];
/// The fields above the table.
const FIELDS: [&str; 7] = [
    "place_m",
    "place_tolerance_m",
    "sensor",
    "unit_per_response",
    "sensor_mass_kg",
    "sensor_width_m",
    "sample_rate_hz",
];

/// Why a text is no measurement.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum CsvError {
    /// A line that cannot be read.
    #[error(transparent)]
    Line(#[from] BadLine),
    /// A required field is absent.
    #[error("{field} is missing: write a line \"# {field} = ...\" above the table")]
    Missing {
        /// The field.
        field: &'static str,
    },
    /// A number is out of its range.
    #[error(transparent)]
    Value(#[from] CalibrateError),
}

/// Whether a text is in this format: it has a required field, or the head of the table.
pub(crate) fn is_own(text: &str) -> bool {
    lines(text).any(|(_, line)| match field(line) {
        Some((name, _)) => ["place_m", "sensor"].contains(&name),
        None => {
            let cells: Vec<&str> =
                line.split([',', ';', '\t']).map(|cell| cell.trim().trim_matches('"')).collect();
            is_head(&cells)
        }
    })
}

/// The name and the value of a line `# name = value`. A spreadsheet ends it with the separators of empty cells.
fn field(line: &str) -> Option<(&str, &str)> {
    let line = line.trim_end_matches([',', ';', '\t', ' ']).trim_matches('"');
    let (name, value) = line.strip_prefix('#')?.split_once('=')?;
    Some((name.trim(), value.trim()))
}

/// Whether these are the names of the columns of the table.
fn is_head(cells: &[&str]) -> bool {
    let end = cells.iter().rposition(|cell| !cell.is_empty()).map_or(0, |at| at + 1);
    end >= 4 && COLUMNS.starts_with(&cells[..end])
}

impl Measurement {
    /// Reads a measurement from text in the format of this module.
    ///
    /// # Errors
    /// [`CsvError`] with the line, the field, and the allowed values. No text makes this function panic.
    pub fn from_csv(text: &str) -> Result<Self, CsvError> {
        let text = text.trim_start_matches('\u{feff}');
        let mut numbers = [None; FIELDS.len()];
        let mut sensor = None;
        for (line, content) in lines(text) {
            // A comment has no equals sign.
            let Some((name, value)) = field(content) else { continue };
            let Some(at) = FIELDS.iter().position(|field| *field == name) else {
                let meant = nearest(name, FIELDS).map_or(String::new(), |it| format!(", did you mean {it}?"));
                return Err(wrong(line, format!("a measurement has no field {:?}{meant}", shown(name))));
            };
            if FIELDS[at] == "sensor" {
                let kind = SensorKind::ALL.into_iter().find(|kind| kind.word() == value);
                let words = SensorKind::ALL.map(SensorKind::word).join(", ");
                let refused = must_be("sensor", format_args!("one of {words}"));
                sensor = Some(kind.ok_or_else(|| -> CsvError { wrong(line, refused) })?);
            } else {
                numbers[at] = Some(number(line, name, value, ANY)?);
            }
        }
        let table = Table::read(text)?;
        let count = table.as_ref().map_or(0, |table| table.rows().len());
        if count > POINTS.most {
            let wrong = WrongCount { field: "the measurement", count, allowed: POINTS };
            return Err(CalibrateError::from(wrong).into());
        }
        let points = table.map_or(Ok(Vec::new()), |table| points(&table))?;
        let [place_m, place_tolerance_m, _, unit_per_response, mass_kg, width_m, sample_rate_hz] = numbers;
        let place_m = place_m.ok_or(CsvError::Missing { field: "place_m" })?;
        let sensor = sensor.ok_or(CsvError::Missing { field: "sensor" })?;
        let default = Self::at(place_m, sensor, points);
        let place_tolerance_m = place_tolerance_m.unwrap_or(default.place_tolerance_m);
        let measurement = Self {
            place_tolerance_m,
            unit_per_response,
            sensor_mass_kg: mass_kg.unwrap_or(0.0),
            sensor_width_m: width_m.unwrap_or(0.0),
            sample_rate_hz,
            ..default
        };
        measurement.check()?;
        Ok(measurement)
    }

    /// The measurement as text; [`Measurement::from_csv`] reads it back to the same measurement.
    #[must_use]
    pub fn to_csv(&self) -> String {
        let mut text =
            format!("# place_m = {}\n# place_tolerance_m = {}\n", self.place_m, self.place_tolerance_m);
        // Writing to a text cannot fail.
        let _ = writeln!(text, "# sensor = {}", self.sensor.word());
        let weighing = |value: f64| (value > 0.0).then_some(value);
        for (field, value) in [
            ("unit_per_response", self.unit_per_response),
            ("sensor_mass_kg", weighing(self.sensor_mass_kg)),
            ("sensor_width_m", weighing(self.sensor_width_m)),
            ("sample_rate_hz", self.sample_rate_hz),
        ] {
            if let Some(value) = value {
                let _ = writeln!(text, "# {field} = {value}");
            }
        }
        let _ = writeln!(text, "{}", COLUMNS.join(","));
        for point in &self.points {
            let Complex64 { re, im } = point.response;
            let headroom = point.headroom_db.map_or(String::new(), |headroom| headroom.to_string());
            let _ = writeln!(text, "{},{re},{im},{},{headroom}", point.frequency_hz, point.noise);
        }
        text
    }
}

fn points(table: &Table) -> Result<Vec<MeasuredPoint>, BadLine> {
    let names: Vec<&str> = table.columns.iter().map(|column| &*column.name).collect();
    if !is_head(&names) {
        let line = table.head().ok().flatten().unwrap_or(table.rows()[0].line);
        return Err(wrong(line, must_be("the table's first line", COLUMNS.join(","))));
    }
    table.rows().iter().map(|row| point(table, row)).collect()
}

fn point(table: &Table, row: &Row) -> Result<MeasuredPoint, BadLine> {
    let count = row.filled().len();
    if !(4..=COLUMNS.len()).contains(&count) {
        return Err(wrong(row.line, must_be(format_args!("the row has {count} numbers"), "4 or 5")));
    }
    let cell = |at: usize| table.number(row, at);
    Ok(MeasuredPoint {
        frequency_hz: cell(0)?,
        response: Complex64::new(cell(1)?, cell(2)?),
        noise: cell(3)?,
        headroom_db: (count > 4).then(|| cell(4)).transpose()?,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const GOOD: &str = "# place_m = 0.03\n# sensor = velocity\n# a comment\n\nfrequency_hz;re;im;noise\n";

    fn rows(count: usize) -> String {
        (0..count).map(|i| format!("{};1e-3;-2.5;0.001\n", 100 + i)).collect()
    }

    #[test]
    fn what_is_left_out_has_its_default_and_bad_lines_are_named() {
        let good = Measurement::from_csv(&(GOOD.to_owned() + &rows(9))).expect("a measurement");
        assert_eq!((good.points.len(), good.sensor), (9, SensorKind::Velocity));
        assert_eq!(good.points[3].response, Complex64::new(1e-3, -2.5));
        assert_eq!((good.points[3].headroom_db, good.sample_rate_hz), (None, None));
        let refused = |from: &str, to: &str| {
            let text = (GOOD.to_owned() + &rows(9)).replace(from, to);
            Measurement::from_csv(&text).expect_err(to).to_string()
        };
        for (from, to, wanted) in [
            (
                "velocity",
                "speed",
                "line 2: sensor: must be one of displacement, velocity, acceleration, strain",
            ),
            (
                "# place_m = 0.03\n",
                "",
                "place_m is missing: write a line \"# place_m = ...\" above the table",
            ),
            ("place_m", "plase_m", "line 1: a measurement has no field \"plase_m\", did you mean place_m?"),
            (
                "re;im",
                "im;re",
                "line 5: the table's first line: must be frequency_hz,re,im,noise,headroom_db",
            ),
            ("102;1e-3", "102;x", "line 8: column 2: \"x\" is no number"),
            ("102;1e-3;-2.5;0.001", "102;1", "line 8: 2 cells, but most rows have 4"),
            ("103;", "101;", "frequency_hz = 101 Hz: must be 102.01 to 1e7 Hz"),
            ("0.03", "nan", "place_m = NaN m"),
        ] {
            let found = refused(from, to);
            assert!(found.starts_with(wanted), "{to}: {found}");
        }
        let few = Measurement::from_csv(GOOD).expect_err("no points").to_string();
        assert!(few.starts_with("the measurement has 0 points"), "{few}");
        let many = Measurement::from_csv(&(GOOD.to_owned() + &rows(10_001))).expect_err("many").to_string();
        assert!(many.starts_with("the measurement has 10001 points"), "{many}");
    }

    #[test]
    fn what_a_spreadsheet_saved_of_a_file_is_the_same_measurement() {
        let text = "# place_m = 0.03\n# sensor = velocity\nfrequency_hz,re,im,noise,headroom_db\n".to_owned()
            + &(0..9).map(|i| format!("{}.5,0.001,-2.5,0.0625,\n", 100 + i)).collect::<String>();
        let good = Measurement::from_csv(&text).expect("a measurement");
        let padded = text.replace("0.03\n", "0.03,,,,\r\n").replace("velocity\n", "velocity,,,,\r\n");
        let quoted =
            text.replace("# place_m = 0.03", "\"# place_m = 0.03\",,,,").replace("100.5", "\"100.5\"");
        let (fields, rows) = text.split_at(text.find("frequency").expect("a head"));
        let german = fields.replace('\n', ";;;;\n") + &rows.replace(',', ";").replace('.', ",");
        for saved in [padded, quoted, german] {
            assert_eq!(Measurement::from_csv(&saved), Ok(good.clone()), "{saved}");
        }
    }

    proptest! {
        #[test]
        fn what_is_written_is_read_back_to_the_last_bit(
            place_m in 0.0..1.0_f64, tolerance in 0.0..0.01_f64, kind in 0..4_usize,
            unit in proptest::option::of(1e-9..1e9_f64), body in proptest::option::of((1e-9..0.1_f64, 6e-4..0.1_f64)), rate in proptest::option::of(1e3..1e6_f64),
            points in prop::collection::vec((-1e9..1e9_f64, -1e-9..1e-9_f64, 1e-12..1.0_f64, proptest::option::of(-10.0..90.0_f64)), 8..20),
        ) {
            let points = points.into_iter().enumerate().map(|(i, (re, im, noise, headroom_db))| MeasuredPoint {
                frequency_hz: 100.1 * (1.0 + i as f64), response: Complex64::new(re, im), noise, headroom_db,
            });
            let measurement = Measurement {
                place_tolerance_m: tolerance, unit_per_response: unit, sample_rate_hz: rate,
                sensor_mass_kg: body.map_or(0.0, |body| body.0), sensor_width_m: body.map_or(0.0, |body| body.1),
                ..Measurement::at(place_m, SensorKind::ALL[kind], points.collect())
            };
            prop_assert_eq!(Measurement::from_csv(&measurement.to_csv()), Ok(measurement));
        }

        #[test]
        fn no_text_makes_the_reader_panic(text in "(# |place_m|sensor|=|,|;|[0-9.e-]|frequency_hz,re,im,noise\n|\n| ){0,60}") {
            prop_assert!(Measurement::from_csv(&text).is_err());
        }
    }
}
