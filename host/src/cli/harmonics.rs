//! `slipline measure --harmonics`.

use super::destination::Destination;
use super::device::{self, LoadedDevice};
use super::failure::Failure;
use super::known_drive;
use super::measuring::ByDevice;
use super::output;
use serde_json::{Value, json};
use slipline_instrument::measure::{HarmonicsPlan, MeasuredHarmonics, MeasuringHarmonics, Sensor};
use slipline_instrument::rig::PreparedRig;
use slipline_plate::quantity::number_format::{significant, with_decimals};
use slipline_plate::quantity::{show_frequency, show_place};
use slipline_plate::{Harmonics, Plate, PlateSpec};

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
    let rate_hz = f64::from(device.identity()?.sample_rate_hz);
    let plan = HarmonicsPlan::new(plate, points, level, rate_hz).map_err(Failure::refused)?;
    let inputs = device.snapshot().device.inputs.unwrap_or_default();
    let measuring =
        MeasuringHarmonics::new(plate, plan, table.clone(), sensor, &inputs).map_err(Failure::failed)?;
    let bench = LoadedDevice::with(&device, plate, table)?;
    known_drive::check(&bench, by.request.known_with(rig))?;
    let found = device::run(&device, "harmonics", measuring)?;
    let spec = PlateSpec { harmonics: Some(found.harmonics.clone()), ..plate.spec().clone() };
    let measured = Plate::new(spec).map_err(Failure::refused)?;
    if let Some(out) = out {
        out.write_measured(&measured.to_toml())?;
    }
    output::print(as_json, &value(&measured, sensor, &found, out), |writer| {
        output::lines(writer, &lines(plate, sensor, &found, out))?;
        if out.is_none() {
            writeln!(writer)?;
            output::table(writer, &rows(&found.harmonics))?;
        }
        Ok(())
    })
}

fn value(plate: &Plate, sensor: Sensor, found: &MeasuredHarmonics, out: Option<&Destination>) -> Value {
    let of_order =
        |order: u8| found.harmonics.curve(order).map_or_else(Vec::new, |curve| curve.points.clone());
    json!({
        "plate": plate.name(),
        "place_m": sensor.place_m,
        "kind": sensor.kind.word(),
        "harmonic_level": found.harmonics.level,
        "harmonics": Harmonics::ORDERS.map(|order| {
            let points = of_order(order);
            let column = |number: usize| points.iter().map(|point| point[number]).collect::<Vec<f64>>();
            let number = usize::from(order - Harmonics::ORDERS[0]);
            json!({
                "order": order,
                "frequency_hz": column(0),
                "ratio_db": column(1),
                "lead_deg": column(2),
                "ratio_noise": found.noise[number],
                "unclear": found.unclear[number],
            })
        }),
        "warnings": warnings(found),
        "toml": plate.to_toml(),
        "files": Destination::names(out),
    })
}

/// What was not measured, as sentences.
fn warnings(found: &MeasuredHarmonics) -> Vec<String> {
    let of_order = |(order, unclear): (u8, usize)| {
        (unclear > 0).then(|| {
            format!(
                "At {unclear} frequencies the sensor does not receive {order} times the frequency clearly: they are left out."
            )
        })
    };
    Harmonics::ORDERS.into_iter().zip(found.unclear).filter_map(of_order).collect()
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
    for (order, noise) in Harmonics::ORDERS.into_iter().zip(found.noise) {
        let Some(curve) = found.harmonics.curve(order) else { continue };
        let percent = |db: f64| significant(100.0 * 10_f64.powf(0.05 * db), 2);
        let levels_db = || curve.points.iter().map(|point| point[1]);
        let (low, high) =
            (levels_db().fold(f64::INFINITY, f64::min), levels_db().fold(f64::NEG_INFINITY, f64::max));
        let name = if order == 2 { "Second harmonic" } else { "Third harmonic" };
        let noise = significant(100.0 * noise, 1);
        lines.push((
            name,
            format!("{} to {} % of the fundamental, noise {noise} %", percent(low), percent(high)),
        ));
    }
    lines.extend(warnings(found).into_iter().map(|sentence| ("Note", sentence)));
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
