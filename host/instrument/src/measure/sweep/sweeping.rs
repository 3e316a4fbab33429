//! The steps of a sweep.
//!
//! ```text
//! stop -> table of the sweep -> silent tone -> capture: the noise
//!      -> stop -> silent tone -> glide (at an index ahead) -> capture -> codes that were played -> next capture ...
//!      -> stop -> the device's own table
//! ```
//! The tone waits for the same number of samples before each glide, so that all sweeps have the same codes.

use super::plan::{SweepPlan, VALUES};
use super::recording::Recording;
use super::table;
use crate::measure::answers::{Measured, Sensor};
use crate::measure::codes::SILENT_S;
use crate::measure::dialogue::Dialogue;
use crate::measure::error::MeasureError;
use crate::measure::procedure::{Evaluation, Procedure};
use crate::measure::setback::{TRIES, Tries, ended_by, is_late};
use slipline_link::protocol::command::Apply;
use slipline_link::protocol::listen::InputsReport;
use slipline_link::{CaptureRequest, DeviceTable, DriveRequest, Outcome, Request, Sounding, ToneRequest};
use std::sync::Arc;

/// Time from the silent tone to the glide, seconds; the host sends two requests within it. A host that is too
/// late repeats with twice the time.
const LEAD_S: f64 = 0.25;

/// A sweep.
pub struct Sweeping {
    plan: SweepPlan,
    /// The plate's table.
    table: Arc<DeviceTable>,
    /// The sweep's table.
    sweep: Arc<DeviceTable>,
    sensor: Sensor,
    lag_s: f64,
    lead_s: f64,
    /// Factor on the level by which the tone stays within the DAC's linear part and the actuator's travel.
    scale: f64,
    tries: Tries,
    late: u32,
    captures: u16,
    recording: Recording,
}

impl Sweeping {
    /// A sweep with a device that must be armed and hold `table`; `inputs` is the device's report of its
    /// inputs.
    ///
    /// # Errors
    /// [`MeasureError::NoInputs`] if it does not have the sensor's input; the table of the sweep is not valid
    /// for a device.
    pub fn new(
        plan: SweepPlan,
        table: Arc<DeviceTable>,
        sensor: Sensor,
        inputs: &InputsReport,
    ) -> Result<Self, MeasureError> {
        let lag_s = sensor.lag_s(inputs, plan.chirp.rate_hz)?;
        let sweep = table::of(&plan.chirp, &table)?;
        Ok(Self {
            lead_s: LEAD_S + plan.glide_s,
            plan,
            table,
            sweep,
            sensor,
            lag_s,
            scale: 1.0,
            tries: Tries::default(),
            late: 0,
            captures: 0,
            recording: Recording::default(),
        })
    }

    /// Request of the tone at an end of the sweep's table.
    fn tone(&self, boundary_m: f64, glide_samples: u64, apply: Apply) -> Request {
        let level = self.plan.chirp.wanted.level * self.scale;
        let glide_s = glide_samples as f64 / self.plan.chirp.rate_hz;
        let tone = ToneRequest { slot: 0, boundary_m, level, phase_turns: 0.0 };
        Request::Play(Sounding::Drive(DriveRequest { glide_s, apply, ..DriveRequest::of(vec![tone]) }))
    }

    fn capture(&self, from: Option<u64>) -> Request {
        let (input, log2_codes) = (self.sensor.input, self.plan.log2_codes);
        Request::Capture(CaptureRequest { from, input, log2_codes, values: VALUES })
    }

    /// Restarts all sweeps.
    fn begin_anew(&mut self) {
        self.captures = 0;
        self.recording.codes.clear();
        self.recording.heard.clear();
    }

    /// Lowers the level if the tone exceeded the travel; any other outcome ends the procedure.
    fn too_loud(&mut self, outcome: &Outcome) -> Result<(), MeasureError> {
        self.scale *= self.tries.quieter(outcome)?;
        self.begin_anew();
        Ok(())
    }

    /// Doubles the time for requests after one that was too late; fails after [`TRIES`] repetitions.
    fn too_late(&mut self, outcome: &Outcome) -> Result<(), MeasureError> {
        self.late += 1;
        self.lead_s *= 2.0;
        if self.late > TRIES {
            return Err(ended_by(outcome));
        }
        self.begin_anew();
        Ok(())
    }

    /// Reports the progress, with the first sample of the capture under way.
    fn mark(&self, dialogue: &Dialogue, capture_from: Option<u64>) {
        let each = self.plan.capture_samples();
        let captures = u64::from(self.captures);
        let quiet = if self.recording.quiet.is_empty() { 0 } else { each };
        let done = captures * (captures + 1) / 2 * each + quiet;
        dialogue.mark(done, self.plan.samples(), capture_from.map(|from| (from, each * (captures + 1))));
    }

    /// Captures the noise or the next part of the sweep. The silent tone begins at `apply`. A step that
    /// failed temporarily is repeated by the next call.
    async fn go_on(&mut self, dialogue: &Dialogue, apply: Apply) -> Result<(), MeasureError> {
        self.mark(dialogue, None);
        let (first_m, last_m) = table::ENDS_M;
        let mut begun = dialogue.ask(self.tone(first_m, 0, apply)).await;
        // The planned time has already passed.
        if apply != Apply::Next && is_late(&begun) {
            begun = dialogue.ask(self.tone(first_m, 0, Apply::Next)).await;
        }
        let Outcome::Done { at } = begun else { return self.too_loud(&begun) };
        if self.recording.quiet.is_empty() {
            let mut captured = dialogue.ask(self.capture(Some(at))).await;
            if is_late(&captured) {
                captured = dialogue.ask(self.capture(None)).await;
            }
            let Outcome::Captured(captured) = &captured else { return self.tries.lost(&captured) };
            self.recording.quiet = captured.codes().collect();
            return Ok(());
        }
        let from = self.plan.chirp.after(at, self.lead_s);
        let glides = dialogue.ask(self.tone(last_m, self.plan.chirp.samples, Apply::At(from))).await;
        let Outcome::Done { at: from } = glides else {
            return if is_late(&glides) { self.too_late(&glides) } else { self.too_loud(&glides) };
        };
        self.mark(dialogue, Some(from));
        let each = self.plan.capture_samples();
        let captured = dialogue.ask(self.capture(Some(from + u64::from(self.captures) * each))).await;
        let Outcome::Captured(captured) = &captured else {
            return if is_late(&captured) { self.too_late(&captured) } else { self.tries.lost(&captured) };
        };
        self.recording.heard.truncate(usize::from(self.captures) * usize::from(VALUES));
        self.recording.heard.extend(captured.codes());
        self.captures += 1;
        self.mark(dialogue, None);
        let codes = dialogue.codes(from, u64::from(self.captures) * each).await?;
        if !codes.starts_with(&self.recording.codes) {
            self.begin_anew();
            return self.tries.again(MeasureError::TurnedDown);
        }
        self.recording.codes = codes;
        self.tries = Tries::default();
        Ok(())
    }
}

impl Procedure for Sweeping {
    type Found = Measured;

    async fn carry_out(mut self, dialogue: Dialogue) -> Result<Evaluation<Measured>, MeasureError> {
        let all = u64::from(self.plan.captures) * self.plan.capture_samples();
        // The sweep and a second of codes around it.
        dialogue.replay(all + self.plan.chirp.rate_hz as u64);
        self.scale = dialogue.linear_scale(self.plan.chirp.wanted.level);
        dialogue.stop().await?;
        let at = dialogue.lend(&self.sweep, &self.table).await?;
        let mut apply = Apply::At(self.plan.chirp.after(at, SILENT_S));
        while self.captures < self.plan.captures {
            self.go_on(&dialogue, std::mem::replace(&mut apply, Apply::Next)).await?;
            dialogue.stop().await?;
        }
        Ok(Box::new(move || {
            let level = self.plan.chirp.wanted.level * self.scale;
            self.recording.measured(&self.plan, &self.table, &self.sensor, self.lag_s, level)
        }))
    }
}
