//! `slipline measure --harmonics`.

use super::destination::Destination;
use super::device::{self, LoadedDevice};
use super::failure::Failure;
use super::known_drive;
use super::measuring::{self, ByDevice};
use super::output;
use super::schema::with_files;
use serde_json::json;
use slipline_instrument::measure::{MeasuredHarmonics, Sensor};
use slipline_instrument::requests::HarmonicsAnswer;
use slipline_instrument::rig::PreparedRig;
use slipline_plate::quantity::number_format::{significant, with_decimals};
use slipline_plate::quantity::{show_frequency, show_place};
use slipline_plate::{Harmonics, Plate};

/// What is to be measured.
pub(super) struct Wanted<'a> {
    pub(super) plate: &'a Plate,
    pub(super) sensor: Sensor,
    pub(super) points: usize,
    pub(super) level: f64,
    pub(super) out: Option<&'a Destination>,
}

/// Measures the harmonics of the drive and writes the plate file with them.
pub(super) fn run(
    wanted: &Wanted<'_>,
    by: &ByDevice<'_>,
    rig: Option<&PreparedRig>,
    as_json: bool,
) -> Result<(), Failure> {
    let &Wanted { plate, sensor, points, level, out } = wanted;
    let device = by.connect(rig)?;
    let table = device.make_table(plate)?;
    let measuring =
        device.measuring_harmonics(plate, &table, (points, level), sensor).map_err(measuring::refused)?;
    let bench = LoadedDevice::with(&device, plate, table)?;
    known_drive::check(&bench, by.request.known_with(rig))?;
    let found = device::run(&device, "harmonics", measuring)?;
    let measured = found.on(plate).map_err(Failure::refused)?;
    if let Some(out) = out {
        out.write_measured(&measured.to_toml())?;
    }
    let answer = HarmonicsAnswer::of(&measured, &sensor, &found);
    output::print(as_json, &with_files(json!(answer), Destination::names(out)), |writer| {
        output::lines(writer, &lines(plate, sensor, &found, out))?;
        if out.is_none() {
            writeln!(writer)?;
            output::table(writer, &rows(&found.harmonics))?;
        }
        Ok(())
    })
}

fn lines(
    plate: &Plate,
    sensor: Sensor,
    found: &MeasuredHarmonics,
    out: Option<&Destination>,
) -> Vec<(&'static str, String)> {
    let mut lines = vec![
        ("Plate", plate.name().to_owned()),
        ("Sensor", format!("{} at {}", sensor.kind.word(), show_place(sensor.place_m))),
        ("Level", significant(found.harmonics.level, 3)),
    ];
    lines.extend(found.words());
    lines.extend(found.warnings().into_iter().map(|sentence| ("Note", sentence)));
    lines.extend(out.map(|out| ("Written to", out.path().display().to_string())));
    lines
}

/// The points of both harmonics as a table.
fn rows(harmonics: &Harmonics) -> Vec<Vec<String>> {
    let mut rows = vec![["Order", "Fundamental", "Level", "Phase"].map(str::to_owned).to_vec()];
    for order in Harmonics::ORDERS {
        let points = harmonics.curve(order).map_or(&[][..], |curve| &curve.points);
        rows.extend(points.iter().map(|[hertz, db, degrees]| {
            vec![
                order.to_string(),
                show_frequency(*hertz),
                format!("{} dB", with_decimals(*db, 1)),
                format!("{}°", with_decimals(*degrees, 0)),
            ]
        }));
    }
    rows
}
