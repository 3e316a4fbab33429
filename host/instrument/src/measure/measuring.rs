//! The steps of a measurement, without a clock and without a port: it asks for requests and takes their outcomes.
//!
//! ```text
//! stop -> comb, silent (-96 dB) -> window: the noise
//!      -> stop -> comb -> settle -> window -> stop -> next comb ... -> stop
//! ```
//! A window that lost samples is measured again. Whatever goes wrong, the last request is a stop.

use super::answers::{Measured, Sensor, Window};
use super::error::MeasureError;
use super::loudness::{self, Tone};
use super::plan::{Comb, Plan};
use super::procedure::{self, Procedure, Step};
use slipline_link::protocol::listen::InputsReport;
use slipline_link::{
    CombRequest, CombToneRequest, DeviceTable, ListenRequest, Listened, Outcome, Refusal, Request, Snapshot,
    WindowShape,
};
use slipline_plate::Complex64;
use std::sync::Arc;

/// The master level of a comb that is not heard: its amplitude is far below a code, and its phases run.
const SILENT_DB: f64 = -96.0;
/// How often a comb is tried.
const TRIES: u32 = 4;
/// Where a measurement stands.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Stage {
    /// Whatever sounds is stopped.
    Silence,
    /// A comb begins; the first one is silent.
    Begin,
    /// It is measured, from this sample on.
    Listen {
        from: u64,
    },
    /// The last stop.
    Ending,
    Ended,
}

/// A measurement under way.
pub struct Measuring {
    plan: Plan,
    table: Arc<DeviceTable>,
    sensor: Sensor,
    lag_s: f64,
    stage: Stage,
    is_asked: bool,
    /// Whether the window's beginning had passed when it was asked for: a host that asks slowly measures from now on.
    is_late: bool,
    /// The tones of the comb under way.
    tones: Vec<Tone>,
    /// What the travel leaves of the level.
    scale: f64,
    tries: u32,
    quiet: Option<Window>,
    windows: Vec<Window>,
    error: Option<MeasureError>,
}

impl Measuring {
    /// A measurement that begins with the next step. The device must be armed and hold `table`; it has told `inputs`.
    ///
    /// # Errors
    /// [`MeasureError::NoInputs`] if it has not as many inputs.
    pub fn new(
        plan: Plan,
        table: Arc<DeviceTable>,
        sensor: Sensor,
        inputs: &InputsReport,
    ) -> Result<Self, MeasureError> {
        let lag_s = sensor.lag_s(inputs, plan.rate_hz)?;
        Ok(Self {
            plan,
            table,
            sensor,
            lag_s,
            stage: Stage::Silence,
            is_asked: false,
            is_late: false,
            tones: Vec::new(),
            scale: 1.0,
            tries: 0,
            quiet: None,
            windows: Vec::new(),
            error: None,
        })
    }

    /// The comb under way; the silent one is the first.
    fn comb(&self) -> Option<&Comb> {
        self.plan.combs.get(self.windows.len())
    }

    /// Samples from the beginning of a comb to its window.
    fn until_window(&self) -> u64 {
        let Some(comb) = self.comb() else { return 0 };
        let rise = self.plan.rise_samples(comb);
        // Silence need not settle.
        if self.quiet.is_none() { rise } else { rise + comb.settle_samples }
    }

    fn listened(&mut self, listened: &Listened) {
        let Some(comb) = self.comb() else { return };
        let answers: Vec<Complex64> = listened
            .answers
            .iter()
            .take(self.tones.len())
            .flatten()
            .map(|&(re, im)| Complex64::new(re, im))
            .collect();
        if answers.len() < self.tones.len() {
            self.fail(MeasureError::Stopped);
            return;
        }
        let window = Window {
            tones: self.tones.clone(),
            answers,
            samples: comb.window_samples(),
            span: (listened.lowest, listened.highest),
        };
        match &self.quiet {
            None => self.quiet = Some(window),
            Some(_) => self.windows.push(window),
        }
        self.tries = 0;
        self.stage = Stage::Silence;
    }

    fn fail(&mut self, error: MeasureError) {
        self.error.get_or_insert(error);
        self.stage = Stage::Ending;
        self.is_asked = false;
    }
}

impl Procedure for Measuring {
    type Found = Measured;

    fn step(&mut self) -> Step {
        if self.stage == Stage::Ended {
            return Step::Ended;
        }
        if std::mem::replace(&mut self.is_asked, true) {
            return Step::Wait;
        }
        let Some(comb) = self.comb().cloned() else { return Step::Ask(Request::Stop) };
        Step::Ask(match self.stage {
            Stage::Silence | Stage::Ending | Stage::Ended => Request::Stop,
            Stage::Begin => {
                let level = self.plan.level * self.scale;
                self.tones = loudness::tones(&comb, &self.table, self.plan.rate_hz, level);
                let tones = comb.harmonics.iter().zip(&self.tones).map(|(&harmonic, tone)| CombToneRequest {
                    harmonic,
                    level: tone.level,
                    phase_turns: tone.phase_turns,
                });
                Request::Comb(CombRequest {
                    master_db: if self.quiet.is_none() { SILENT_DB } else { 0.0 },
                    glide_s: comb.rise_s,
                    ..CombRequest::of(comb.period_blocks, tones.collect())
                })
            }
            Stage::Listen { from } => Request::Listen(ListenRequest {
                from: (!self.is_late).then_some(from),
                blocks: comb.period_blocks,
                shape: WindowShape::Rectangular,
                // As many bits as tones, 16 at most.
                slots: u16::MAX >> (16 - comb.harmonics.len().clamp(1, 16)),
                input: self.sensor.input,
            }),
        })
    }

    fn take(&mut self, outcome: &Outcome) {
        self.is_asked = false;
        match (self.stage, outcome) {
            (Stage::Ending | Stage::Ended, _) => self.stage = Stage::Ended,
            (Stage::Silence, Outcome::Done { .. }) => {
                let is_over = self.comb().is_none();
                self.stage = if is_over { Stage::Ended } else { Stage::Begin };
            }
            (Stage::Begin, Outcome::Done { at }) => {
                let from = at + self.until_window();
                self.stage = Stage::Listen { from };
                self.is_late = false;
            }
            (Stage::Listen { .. }, Outcome::Listened(listened)) => self.listened(listened),
            (Stage::Begin, Outcome::Refused(_))
                if procedure::quieter(outcome).is_some() && self.tries < TRIES =>
            {
                self.tries += 1;
                self.scale *= procedure::quieter(outcome).unwrap_or(1.0);
            }
            (Stage::Listen { .. }, Outcome::Refused(Refusal::InputLost { .. })) => {
                self.tries += 1;
                if self.tries >= TRIES {
                    self.fail(MeasureError::Overrun { tries: self.tries });
                } else {
                    self.stage = Stage::Silence;
                }
            }
            // All tones had settled at that sample, so they have now.
            (Stage::Listen { .. }, late) if procedure::is_late(late) && !self.is_late => self.is_late = true,
            (_, other) => self.fail(procedure::ended_by(other)),
        }
    }

    fn watch(&mut self, snapshot: &Snapshot) {
        let trouble = procedure::trouble(&mut self.error, snapshot);
        if let Some(trouble) = trouble.filter(|_| !matches!(self.stage, Stage::Ending | Stage::Ended)) {
            self.fail(trouble);
        }
    }

    fn cancel(&mut self) {
        if self.stage != Stage::Ended {
            self.fail(MeasureError::Cancelled);
        }
    }

    fn progress(&self, now: u64) -> f64 {
        if self.stage == Stage::Ended {
            return 1.0;
        }
        let combs = self.plan.combs.iter().take(self.windows.len());
        let mut done: u64 = combs.map(|comb| self.plan.samples_of(comb)).sum();
        if self.quiet.is_some() {
            done += self.plan.quiet_samples();
        }
        if let (Stage::Listen { from }, Some(comb)) = (self.stage, self.comb()) {
            let begin = from.saturating_sub(self.until_window());
            done += now.saturating_sub(begin).min(self.until_window() + comb.window_samples());
        }
        (done as f64 / self.plan.samples().max(1) as f64).min(1.0)
    }

    fn finish(self) -> Result<Measured, MeasureError> {
        if let Some(error) = self.error {
            return Err(error);
        }
        let quiet = self.quiet.filter(|_| self.windows.len() == self.plan.combs.len());
        let quiet = quiet.ok_or(MeasureError::Cancelled)?;
        let measured = Measured::of(&self.sensor, self.plan.rate_hz, self.lag_s, &quiet, &self.windows);
        measured.measurement.check()?;
        Ok(measured)
    }
}

#[cfg(test)]
mod tests;
