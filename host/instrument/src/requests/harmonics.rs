//! The answer of a measurement of a drive's harmonics.

use crate::measure::{MeasuredHarmonics, Sensor};
use serde::Serialize;
use slipline_plate::quantity::from_decibels;
use slipline_plate::quantity::number_format::significant;
use slipline_plate::{Harmonics, Plate, PlateError, PlateSpec};

/// The fields of `slipline measure --harmonics --json`.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct HarmonicsAnswer {
    /// Name of the plate.
    pub plate: String,
    /// JSON: Place of the sensor
    pub place_m: f64,
    /// JSON, text: What the sensor measures: displacement, velocity, acceleration or strain; null of a current
    pub kind: &'static str,
    /// JSON, 1: Level of the tones at which the harmonics were measured, over the table's full scale
    pub harmonic_level: f64,
    /// The second and the third harmonic.
    pub harmonics: [HarmonicAnswer; 2],
    /// JSON, text: Warnings, as sentences
    pub warnings: Vec<String>,
    /// The plate file with the harmonics.
    pub toml: String,
}

/// One harmonic.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct HarmonicAnswer {
    /// JSON, count: Frequency of the harmonic over that of its tone
    pub order: u8,
    /// Frequency of the tone or of each answer.
    pub frequency_hz: Vec<f64>,
    /// JSON: Harmonic of the drive over its fundamental
    pub ratio_db: Vec<f64>,
    /// JSON, degrees: By how much the harmonic leads `order` times the fundamental's phase
    pub lead_deg: Vec<f64>,
    /// JSON, 1: Largest standard deviation of the harmonic over its fundamental, by the noise of the input
    pub ratio_noise: f64,
    /// JSON, count: Frequencies at which the sensor does not receive the harmonic's frequency clearly, which are left out
    pub unclear: usize,
}

impl HarmonicsAnswer {
    /// The fields of what a sensor found, on the plate that states it ([`MeasuredHarmonics::on`]).
    #[must_use]
    pub fn of(plate: &Plate, sensor: &Sensor, found: &MeasuredHarmonics) -> Self {
        let harmonic = |order: u8| {
            let points = found.harmonics.curve(order).map_or(&[][..], |curve| &curve.points);
            let column = |number: usize| points.iter().map(|point| point[number]).collect();
            let number = usize::from(order - Harmonics::ORDERS[0]);
            HarmonicAnswer {
                order,
                frequency_hz: column(0),
                ratio_db: column(1),
                lead_deg: column(2),
                ratio_noise: found.noise[number],
                unclear: found.unclear[number],
            }
        };
        Self {
            plate: plate.name().to_owned(),
            place_m: sensor.place_m,
            kind: sensor.kind.word(),
            harmonic_level: found.harmonics.level,
            harmonics: Harmonics::ORDERS.map(harmonic),
            warnings: found.warnings(),
            toml: plate.to_toml(),
        }
    }
}

impl MeasuredHarmonics {
    /// The measured plate with these harmonics.
    ///
    /// # Errors
    /// Those of [`Plate::new`].
    pub fn on(&self, plate: &Plate) -> Result<Plate, PlateError> {
        Plate::new(PlateSpec { harmonics: Some(self.harmonics.clone()), ..plate.spec().clone() })
    }

    /// What was not measured, as sentences.
    #[must_use]
    pub fn warnings(&self) -> Vec<String> {
        let of_order = |(order, unclear): (u8, usize)| {
            (unclear > 0).then(|| {
                format!(
                    "At {unclear} frequencies the sensor does not receive {order} times the frequency clearly: they are left out."
                )
            })
        };
        Harmonics::ORDERS.into_iter().zip(self.unclear).filter_map(of_order).collect()
    }

    /// What was found of the second and the third harmonic, as sentences.
    #[must_use]
    pub fn words(&self) -> Vec<(&'static str, String)> {
        let percent = |share: f64, digits| significant(100.0 * share, digits);
        let of_order = |(order, noise): (u8, f64)| {
            let levels = || self.harmonics.curve(order).into_iter().flat_map(|curve| &curve.points);
            let shares = levels().map(|point| from_decibels(point[1]));
            let low = shares.clone().reduce(f64::min)?;
            let high = shares.fold(low, f64::max);
            let name = if order == 2 { "Second harmonic" } else { "Third harmonic" };
            let [low, high, noise] = [percent(low, 2), percent(high, 2), percent(noise, 1)];
            Some((name, format!("{low} to {high} % of the fundamental, noise {noise} %")))
        };
        Harmonics::ORDERS.into_iter().zip(self.noise).filter_map(of_order).collect()
    }
}
