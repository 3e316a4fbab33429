//! `slipline drive --hold`: the device holds the level of each tone at a sensor.

use super::argument::{self, Typed};
use super::device::Device;
use super::failure::Failure;
use super::input_lines::Wake;
use super::output;
use super::rig::PortArgument;
use clap::Args;
use serde_json::{Value, json};
use slipline_instrument::hold::{HoldPlan, Holding, MAX_RISE, USUAL_RISE_DB, progress_words, words};
use slipline_instrument::rig::{PreparedRig, RigOptions};
use slipline_link::protocol::hold::{Held, HoldProgress};
use slipline_link::{DeviceTable, DriveRequest, Snapshot, ToneRequest};
use slipline_plate::Plate;
use slipline_plate::quantity::number_format::signed;
use slipline_plate::quantity::show_place;
use std::sync::Arc;
use std::sync::mpsc::Receiver;

/// Change of a correction that is printed, dB.
const PRINTED_STEP_DB: f64 = 0.5;
/// Default place of the simulated sensor, as a share of the plate's length.
const SENSOR_SHARE: f64 = 0.1;

/// Whether the levels are held.
#[derive(Debug, Args)]
#[command(next_help_heading = "Level hold")]
pub(super) struct HoldArgument {
    /// Hold each tone at the level that a sensor on the plate measures first, independent of the absorption
    /// of a finger. Touch the plate only when the levels are held. Not with a setup file.
    #[arg(long, conflicts_with = "setup")]
    hold: bool,
    /// Largest rise of a held tone above its level, 0 to 20 dB.
    #[arg(long, value_name = "DB", value_parser = argument::decibels(MAX_RISE.low, MAX_RISE.high), allow_hyphen_values = true, default_value_t = USUAL_RISE_DB, requires = "hold")]
    max_rise: f64,
    /// Place of the simulated device's sensor, from the driven end (30mm); by default, at a tenth of the
    /// plate's length.
    #[arg(long, value_name = "PLACE", value_parser = argument::place, allow_hyphen_values = true, requires = "hold")]
    sensor: Option<Typed<f64>>,
}

impl HoldArgument {
    /// The rig of the simulated device, with a sensor if the levels are to be held.
    pub(super) fn rig(&self, port: &PortArgument, plate: &Plate) -> Result<Option<PreparedRig>, Failure> {
        if !self.hold {
            return port.rig(Some(plate));
        }
        let place_m = match &self.sensor {
            Some(place) => place.of_sensor(plate)?,
            None => SENSOR_SHARE * plate.length_m(),
        };
        port.rig_with_sensor(plate, &RigOptions { place_m, ..RigOptions::default() })
    }

    /// The hold for the tones of a drive, if it is requested.
    pub(super) fn holder(
        &self,
        device: &Device,
        plate: &Arc<Plate>,
        table: &DeviceTable,
        drive: &DriveRequest,
    ) -> Result<Option<Holder>, Failure> {
        if !self.hold {
            return Ok(None);
        }
        let rate_hz = f64::from(device.identity()?.sample_rate_hz);
        let lock_ins = device.snapshot().device.inputs.map_or(0, |inputs| usize::from(inputs.lock_ins));
        let frequency =
            |tone: &ToneRequest| Some((tone.slot, table.frequency_hz(table.position(tone.boundary_m)?)));
        let frequencies: Vec<(u8, f64)> = drive.tones.iter().filter_map(frequency).collect();
        // Refused before the drive begins.
        let plan =
            HoldPlan::new(plate, &frequencies, rate_hz, lock_ins, self.max_rise).map_err(Failure::failed)?;
        let turning_points_m = drive.tones.iter().map(|tone| (tone.slot, tone.boundary_m)).collect();
        let (plate, holding) = (Arc::clone(plate), Holding::default());
        Ok(Some(Holder { plan, plate, holding, turning_points_m, latest: None, printed: Vec::new() }))
    }
}

/// The hold of a drive.
pub(super) struct Holder {
    plan: HoldPlan,
    plate: Arc<Plate>,
    holding: Holding,
    turning_points_m: Vec<(u8, f64)>,
    latest: Option<Arc<Held>>,
    /// Text and correction of each tone as printed last.
    printed: Vec<(&'static str, f64)>,
}

impl Holder {
    /// Measures the tones of the drive that begins at this index, and holds these levels. Returns whether
    /// they are held: `false` if the user interrupts.
    pub(super) fn begin(
        &mut self,
        device: &Device,
        interruption: &Receiver<Wake>,
        at: u64,
    ) -> Result<bool, Failure> {
        let goes_on = || interruption.try_recv().is_err();
        Ok(device.hold(&mut self.holding, &self.plate, self.plan.max_rise_db, Some(at), goes_on)?)
    }

    /// Prints changes of the hold.
    pub(super) fn watch(&mut self, snapshot: &Snapshot, as_json: bool) -> Result<(), Failure> {
        let Some(held) = &snapshot.drive.hold else { return Ok(()) };
        let before = self.latest.replace(held.clone()).map(|held| held.progress);
        let tones: Vec<(&'static str, f64)> =
            words(held).map(|tone| (tone.words, tone.correction_db)).collect();
        let is_new = |(place, now): (usize, &(&str, f64))| {
            self.printed
                .get(place)
                .is_none_or(|last| last.0 != now.0 || (last.1 - now.1).abs() >= PRINTED_STEP_DB)
        };
        let has_ended = held.progress != HoldProgress::On && before != Some(held.progress);
        if as_json || !(has_ended || tones.iter().enumerate().any(is_new)) {
            return Ok(());
        }
        self.printed = tones;
        output::print(false, &json!(null), |out| {
            for tone in words(held) {
                let place = self.turning_point_m(tone.slot).map_or_else(String::new, show_place);
                let correction = signed(tone.correction_db, 1);
                writeln!(out, "Turning point at {place}: {}, {correction} dB.", tone.words)?;
            }
            if has_ended { writeln!(out, "{}.", progress_words(held.progress)) } else { Ok(()) }
        })
    }

    fn turning_point_m(&self, slot: u8) -> Option<f64> {
        self.turning_points_m.iter().find(|(of, _)| *of == slot).map(|(_, place_m)| *place_m)
    }

    /// The latest state of the hold, as JSON.
    pub(super) fn value(&self) -> Value {
        let tones = self.latest.iter().flat_map(|held| words(held)).map(|tone| {
            json!({
                // JSON, count: Slot of the tone, from 0
                "slot": tone.slot,
                "turning_point_m": self.turning_point_m(tone.slot),
                // JSON of drive, text: State of the held tone
                "state": tone.words,
                // JSON: Rise of the tone by the hold
                "correction_db": tone.correction_db,
                // JSON, codes: Amplitude at the sensor, in codes of the input
                "amplitude_codes": tone.amplitude_codes,
            })
        });
        json!({
            // JSON: Length of a window
            "window_s": self.plan.window_s(),
            // JSON: Time constant of the hold
            "time_constant_s": self.plan.time_constant_s,
            // JSON, count: Windows that the hold has measured
            "measured_windows": self.latest.as_ref().map(|held| held.windows),
            "tones": tones.collect::<Vec<_>>(),
        })
    }
}
