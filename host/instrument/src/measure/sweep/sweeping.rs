//! The steps of a sweep.
//!
//! ```text
//! stop -> table of the sweep -> silent tone -> capture: the noise
//!      -> stop -> silent tone -> glide (at an index ahead) -> capture -> codes that were played -> next capture ...
//!      -> stop -> the device's own table
//! ```
//! The tone always waits for the same number of samples before it glides, so that every sweep has the same codes.

use super::codes::{Codes, SILENT_S};
use super::plan::{SweepPlan, VALUES};
use super::recording::Recording;
use super::table;
use crate::measure::answers::{Measured, Sensor};
use crate::measure::error::MeasureError;
use crate::measure::procedure::{self, Procedure, Step};
use slipline_link::protocol::command::Apply;
use slipline_link::protocol::listen::InputsReport;
use slipline_link::{
    CaptureRequest, DeviceTable, DriveRequest, Outcome, Refusal, Request, Snapshot, ToneRequest,
};
use std::sync::Arc;

/// How often the same capture is tried.
const TRIES: u32 = 4;
/// How often the device is asked how far it is until its codes are known.
const LOOKS: u32 = 200;
/// From the silent tone to the glide, seconds: in this time the host sends two requests. A host that is too late for it tries
/// again with twice the time.
const LEAD_S: f64 = 0.25;

/// Where a sweep stands.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Stage {
    /// Whatever sounds is stopped.
    Silence,
    /// The device gets the table of the sweep.
    Table,
    /// The silent tone begins, at an index if one is given.
    Tone {
        at: Option<u64>,
    },
    /// The noise is captured, from an index on if one is given: not before the silent tone begins.
    Quiet {
        from: Option<u64>,
    },
    /// The tone is to glide from this index on.
    Glide {
        from: u64,
    },
    /// The capture of a sweep that begins here.
    Capture {
        from: u64,
    },
    /// The codes that were played from here on are awaited.
    Codes {
        from: u64,
        looks: u32,
    },
    /// The last stop.
    Ending,
    /// The device gets its table back.
    Restore,
    Ended,
}

/// A sweep under way.
pub struct Sweeping {
    plan: SweepPlan,
    /// The plate's own.
    table: Arc<DeviceTable>,
    /// The sweep's.
    sweep: Arc<DeviceTable>,
    sensor: Sensor,
    lag_s: f64,
    stage: Stage,
    is_asked: bool,
    /// Whether the device may hold the sweep's table.
    is_changed: bool,
    lead_s: f64,
    /// What the travel leaves of the level.
    scale: f64,
    tries: u32,
    late: u32,
    captures: u16,
    replay: Codes,
    recording: Recording,
    error: Option<MeasureError>,
}

impl Sweeping {
    /// A sweep that begins with the next step. The device must be armed and hold `table`; it has told `inputs`.
    ///
    /// # Errors
    /// [`MeasureError::NoInputs`] if it has not as many inputs; a table that no device takes.
    pub fn new(
        plan: SweepPlan,
        table: Arc<DeviceTable>,
        sensor: Sensor,
        inputs: &InputsReport,
    ) -> Result<Self, MeasureError> {
        let lag_s = sensor.lag_s(inputs, plan.chirp.rate_hz)?;
        let sweep = table::of(&plan.chirp, &table)?;
        let all = u64::from(plan.captures) * plan.capture_samples();
        // Beside the sweep a second of what was before and after it.
        let replay = Codes::new(all + plan.chirp.rate_hz as u64);
        Ok(Self {
            lead_s: LEAD_S + plan.glide_s,
            plan,
            table,
            sweep,
            sensor,
            lag_s,
            stage: Stage::Silence,
            is_asked: false,
            is_changed: false,
            scale: 1.0,
            tries: 0,
            late: 0,
            captures: 0,
            replay,
            recording: Recording::default(),
            error: None,
        })
    }

    /// The tone at an end of the sweep's table.
    fn tone(&self, boundary_m: f64, glide_samples: u64, apply: Apply) -> Request {
        let level = self.plan.chirp.wanted.level * self.scale;
        let glide_s = glide_samples as f64 / self.plan.chirp.rate_hz;
        let tone = ToneRequest { slot: 0, boundary_m, level, phase_turns: 0.0 };
        Request::Drive(DriveRequest { glide_s, apply, ..DriveRequest::of(vec![tone]) })
    }

    fn capture(&self, from: Option<u64>) -> Request {
        let (input, log2_codes) = (self.sensor.input, self.plan.log2_codes);
        Request::Capture(CaptureRequest { from, input, log2_codes, values: VALUES })
    }

    /// The first sample of the capture that is next, of a sweep that begins at `from`.
    fn captured_from(&self, from: u64) -> u64 {
        from + u64::from(self.captures) * self.plan.capture_samples()
    }

    /// All sweeps are played again.
    fn begin_anew(&mut self) {
        self.captures = 0;
        self.recording.codes.clear();
        self.recording.heard.clear();
        self.stage = Stage::Silence;
    }

    /// A request came after the index that it names: there must be more time before the next one's.
    fn too_late(&mut self, outcome: &Outcome) {
        self.late += 1;
        self.lead_s *= 2.0;
        if self.late > TRIES {
            self.fail(procedure::ended_by(outcome));
        } else {
            self.begin_anew();
        }
    }

    /// The capture is tried again.
    fn again(&mut self, error: MeasureError) {
        self.tries += 1;
        if self.tries >= TRIES {
            self.fail(error);
        } else {
            self.stage = Stage::Silence;
        }
    }

    /// Takes the codes of the sweep up to the end of its last capture.
    fn codes(&mut self, from: u64, looks: u32) {
        let count = self.captured_from(from) - from;
        let Some(codes) = self.replay.played(from, count) else {
            if looks >= LOOKS {
                self.fail(MeasureError::Unknown);
            } else {
                self.stage = Stage::Codes { from, looks: looks + 1 };
            }
            return;
        };
        if !codes.starts_with(&self.recording.codes) {
            self.begin_anew();
            return self.again(MeasureError::TurnedDown);
        }
        self.recording.codes = codes;
        self.tries = 0;
        self.stage = if self.captures < self.plan.captures { Stage::Silence } else { Stage::Ending };
    }

    fn fail(&mut self, error: MeasureError) {
        self.error.get_or_insert(error);
        self.stage = Stage::Ending;
        self.is_asked = false;
    }

    /// Whether it only tidies up.
    const fn is_ending(&self) -> bool {
        matches!(self.stage, Stage::Ending | Stage::Restore | Stage::Ended)
    }
}

impl Procedure for Sweeping {
    type Found = Measured;

    fn step(&mut self) -> Step {
        if let (Stage::Codes { from, looks }, false) = (self.stage, self.is_asked) {
            self.codes(from, looks);
        }
        if self.stage == Stage::Ended {
            return Step::Ended;
        }
        if std::mem::replace(&mut self.is_asked, true) {
            return Step::Wait;
        }
        let (first_m, last_m) = table::ENDS_M;
        Step::Ask(match self.stage {
            Stage::Silence | Stage::Ending | Stage::Ended => Request::Stop,
            Stage::Table => {
                self.is_changed = true;
                Request::Upload(self.sweep.clone())
            }
            Stage::Tone { at } => self.tone(first_m, 0, at.map_or(Apply::Next, Apply::At)),
            Stage::Quiet { from } => self.capture(from),
            Stage::Glide { from } => self.tone(last_m, self.plan.chirp.samples, Apply::At(from)),
            Stage::Capture { from } => self.capture(Some(self.captured_from(from))),
            Stage::Codes { .. } => Request::Refresh,
            Stage::Restore => Request::Upload(self.table.clone()),
        })
    }

    fn take(&mut self, outcome: &Outcome) {
        self.is_asked = false;
        match (self.stage, outcome) {
            (Stage::Ending, _) if self.is_changed => self.stage = Stage::Restore,
            (Stage::Ending | Stage::Restore | Stage::Ended, other) => {
                if !matches!(other, Outcome::Done { .. }) {
                    self.error.get_or_insert(procedure::ended_by(other));
                }
                self.stage = Stage::Ended;
            }
            (Stage::Silence, Outcome::Done { .. }) => {
                self.stage = if self.is_changed { Stage::Tone { at: None } } else { Stage::Table };
            }
            (Stage::Table, Outcome::Done { at }) => {
                self.stage = Stage::Tone { at: Some(self.plan.chirp.after(*at, SILENT_S)) };
            }
            // So much time has passed by itself.
            (Stage::Tone { at: Some(_) }, late) if procedure::is_late(late) => {
                self.stage = Stage::Tone { at: None };
            }
            (Stage::Quiet { from: Some(_) }, late) if procedure::is_late(late) => {
                self.stage = Stage::Quiet { from: None };
            }
            (Stage::Tone { .. }, Outcome::Done { at }) => {
                let from = self.plan.chirp.after(*at, self.lead_s);
                let is_quiet = self.recording.quiet.is_empty();
                self.stage = if is_quiet { Stage::Quiet { from: Some(*at) } } else { Stage::Glide { from } };
            }
            (Stage::Quiet { .. }, Outcome::Captured(captured)) => {
                self.recording.quiet = captured.codes().collect();
                self.stage = Stage::Silence;
            }
            (Stage::Glide { .. }, Outcome::Done { at }) => self.stage = Stage::Capture { from: *at },
            (Stage::Capture { from }, Outcome::Captured(captured)) => {
                let known = usize::from(self.captures) * usize::from(VALUES);
                self.recording.heard.truncate(known);
                self.recording.heard.extend(captured.codes());
                self.captures += 1;
                self.stage = Stage::Codes { from, looks: 0 };
            }
            // The next step looks whether they are known.
            (Stage::Codes { .. }, Outcome::Done { .. }) => {}
            (Stage::Glide { .. } | Stage::Capture { .. }, late) if procedure::is_late(late) => {
                self.too_late(late);
            }
            (Stage::Tone { .. } | Stage::Glide { .. }, Outcome::Refused(_))
                if procedure::quieter(outcome).is_some() && self.tries < TRIES =>
            {
                self.tries += 1;
                self.scale *= procedure::quieter(outcome).unwrap_or(1.0);
                self.begin_anew();
            }
            (Stage::Quiet { .. } | Stage::Capture { .. }, Outcome::Refused(Refusal::InputLost { .. })) => {
                self.again(MeasureError::Overrun { tries: self.tries + 1 });
            }
            (_, other) => self.fail(procedure::ended_by(other)),
        }
    }

    fn watch(&mut self, snapshot: &Snapshot) {
        self.replay.follow(snapshot);
        let trouble = procedure::trouble(&mut self.error, snapshot);
        if let Some(trouble) = trouble.filter(|_| !self.is_ending()) {
            self.fail(trouble);
        }
    }

    fn cancel(&mut self) {
        if !self.is_ending() {
            self.fail(MeasureError::Cancelled);
        }
    }

    fn progress(&self, now: u64) -> f64 {
        if self.is_ending() {
            return 1.0;
        }
        let each = self.plan.capture_samples();
        let captures = u64::from(self.captures);
        let mut done = captures * (captures + 1) / 2 * each;
        if !self.recording.quiet.is_empty() {
            done += each;
        }
        if let Stage::Capture { from } = self.stage {
            done += now.saturating_sub(from).min(each * (captures + 1));
        }
        (done as f64 / self.plan.samples() as f64).min(1.0)
    }

    fn finish(self) -> Result<Measured, MeasureError> {
        if let Some(error) = self.error {
            return Err(error);
        }
        if self.captures < self.plan.captures {
            return Err(MeasureError::Cancelled);
        }
        let level = self.plan.chirp.wanted.level * self.scale;
        self.recording.measured(&self.plan, &self.table, &self.sensor, self.lag_s, level)
    }
}
