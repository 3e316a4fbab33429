//! The measurement of a drive's harmonics by the sensor of a plate.
//!
//! ```text
//! for each frequency f, a comb of f, 2f and 3f:
//!   f loud, 2f and 3f at the least level  -> what the sensor receives at 2f and 3f    \
//!   2f and 3f loud, f at the least level  -> the plate's own answers at 2f and 3f      -+-> harmonics of the drive, as codes
//! ```
//! A lock-in listens to a slot that sounds, so the upper two sound at the least level, 1/65535 of the table's, and their share is
//! subtracted. The quotient of both windows is the harmonic as a tone of the DAC, whatever the plate and the sensor are: the plate's
//! response need not be known. Products of the upper two fall on f, 4f, 5f and 6f.

mod drive_of_codes;
mod plan;

pub use drive_of_codes::MeasuredHarmonics;
pub use plan::{HARMONIC_POINTS, HarmonicsPlan};

use super::answers::{Sensor, Window};
use super::dialogue::Dialogue;
use super::error::MeasureError;
use super::loudness::Tone;
use super::measuring::{listened, sounding, windowed};
use super::plan::Comb;
use super::procedure::{Evaluation, Procedure, evaluated};
use super::setback::Tries;
use drive_of_codes::Received;
use slipline_link::DeviceTable;
use slipline_link::protocol::listen::InputsReport;
use slipline_plate::{Harmonics, Plate};
use std::sync::Arc;

/// The least level of a slot that sounds.
const LEAST: f64 = 1.0 / 65_535.0;
/// Level of the upper two while the plate's own answer is measured: each is a hundred times a harmonic of 0.2 %.
const UPPER: f64 = 0.2;

/// Which tones of a comb are loud.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Loud {
    /// None: the window shows the noise.
    Nothing,
    /// The fundamental.
    Fundamental,
    /// Its multiples.
    Upper,
}

/// A measurement of harmonics.
pub struct MeasuringHarmonics {
    plate: Plate,
    plan: HarmonicsPlan,
    table: Arc<DeviceTable>,
    sensor: Sensor,
    /// Factor on the level by which the tones stay within the DAC's linear part and the actuator's travel.
    scale: f64,
}

impl MeasuringHarmonics {
    /// A measurement with a device that must be armed and hold `table`, the table of `plate`; `inputs` is the device's report of its
    /// inputs.
    ///
    /// # Errors
    /// [`MeasureError::NoInputs`] if it does not have the sensor's input, or fewer than three lock-ins.
    pub fn new(
        plate: &Plate,
        plan: HarmonicsPlan,
        table: Arc<DeviceTable>,
        sensor: Sensor,
        inputs: &InputsReport,
    ) -> Result<Self, MeasureError> {
        sensor.lag_s(inputs, plan.rate_hz)?;
        if usize::from(inputs.lock_ins) < 1 + Harmonics::ORDERS.len() {
            return Err(MeasureError::NoInputs);
        }
        Ok(Self { plate: plate.clone(), plan, table, sensor, scale: 1.0 })
    }

    /// The tones of a comb.
    fn tones(&self, comb: &Comb, loud: Loud, scale: f64) -> Vec<Tone> {
        let rate_hz = self.plan.rate_hz;
        let tone = |(slot, frequency_hz): (usize, f64)| {
            let level = match (loud, slot) {
                (Loud::Fundamental, 0) => self.plan.level * scale,
                // The silent level of the whole comb makes them silent.
                (Loud::Nothing, _) => UPPER.min(self.plan.level) * scale,
                (Loud::Upper, 1..) => UPPER.min(self.plan.level) * scale,
                _ => LEAST,
            };
            let amplitude = level * self.table.gain_of_turns(frequency_hz / rate_hz);
            Tone { frequency_hz, level, phase_turns: 0.0, amplitude }
        };
        comb.frequencies_hz(rate_hz).enumerate().map(tone).collect()
    }

    /// Plays a comb and returns its window.
    async fn window(&mut self, dialogue: &Dialogue, comb: &Comb, loud: Loud) -> Result<Window, MeasureError> {
        let settle = if loud == Loud::Nothing { 0 } else { comb.settle_samples };
        let until_window = (comb.rise_s * self.plan.rate_hz).ceil() as u64 + settle;
        let mut tries = Tries::default();
        loop {
            dialogue.stop().await?;
            let (is_silent, mut scale) = (loud == Loud::Nothing, self.scale);
            let tones = |scale| self.tones(comb, loud, scale);
            let (tones, at) = sounding(dialogue, comb, is_silent, &mut tries, &mut scale, tones).await?;
            self.scale = scale;
            let heard = listened(dialogue, comb, self.sensor.input, Some(at + until_window), 1).await;
            match windowed(comb, 1, &tones, &heard)? {
                Some(window) if window.is_clipped() => return Err(MeasureError::Clipped),
                Some(window) => return Ok(window),
                None => tries.lost(&heard)?,
            }
        }
    }
}

impl Procedure for MeasuringHarmonics {
    type Found = MeasuredHarmonics;

    async fn carry_out(mut self, dialogue: Dialogue) -> Result<Evaluation<MeasuredHarmonics>, MeasureError> {
        self.scale = dialogue.linear_scale(self.plan.level);
        let combs = self.plan.combs.clone();
        let all = 2 * combs.len() as u64 + 1;
        let Some(first) = combs.first() else { return Err(MeasureError::Cancelled) };
        dialogue.mark(0, all, None);
        let quiet = self.window(&dialogue, first, Loud::Nothing).await?;
        let mut received = Vec::new();
        for (comb, done) in combs.iter().zip((1..).step_by(2)) {
            dialogue.mark(done, all, None);
            let loud = self.window(&dialogue, comb, Loud::Fundamental).await?;
            let scale = self.scale;
            dialogue.mark(done + 1, all, None);
            let upper = self.window(&dialogue, comb, Loud::Upper).await?;
            received.push(Received { loud, upper, scale });
        }
        dialogue.stop().await?;
        MeasuredHarmonics::of(&self.plate, self.plan.rate_hz, self.plan.level, &quiet, &received)
            .map(evaluated)
    }
}
