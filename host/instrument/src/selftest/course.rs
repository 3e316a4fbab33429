//! What the steps share: the device's numbers, and the requests that several of them send.

use super::quantities::quantity;
use super::report::{Reading, StepResult};
use super::request::SelftestRequest;
use crate::measure::{Dialogue, MeasureError, ended_by, is_late};
use slipline_link::protocol::event::{Fault, Faults, State};
use slipline_link::protocol::listen::InputsReport;
use slipline_link::{
    CaptureRequest, Captured, CombRequest, DeviceTable, HarmonicRequest, Outcome, Request, Sounding,
};
use slipline_plate::truth::Random;
use std::cell::{Cell, RefCell};
use std::sync::Arc;

/// The sensor's input.
pub(super) const SENSOR: u8 = 0;
/// Time from a request to the sample at which it acts, seconds: over the slowest link, and in a short test, which tries again.
const AHEAD_S: f64 = 0.1;
const SHORT_AHEAD_S: f64 = 0.03;
/// Attempts at a request that arrives after the sample at which it acts.
pub(super) const TRIES: u32 = 4;
/// Time after a stop by which the replay knows that the device is silent, seconds.
const SILENT_S: f64 = 0.3;
/// Time between two looks at a device that is about to be silent, seconds.
const LOOK_S: f64 = 0.005;
/// Time in which a comb has risen, seconds.
const RISEN_S: f64 = 0.03;
/// Codes that are kept of the device, seconds.
const KEPT_S: f64 = 6.0;
/// Span of the table of the test, metres; its frequencies over the sample rate: any tone has a place in it.
pub(super) const SPAN_M: (f64, f64) = (0.0, 0.1);
const TURNS: (f64, f64) = (0.4, 0.0005);
const KNOTS: u16 = 65;

/// What the steps share.
pub(super) struct Course {
    pub(super) dialogue: Dialogue,
    pub(super) request: SelftestRequest,
    pub(super) rate_hz: f64,
    /// The largest sum of levels that the device allows, 0 to 1.
    pub(super) most: f64,
    /// The share of the half swing within which the DAC's output is linear.
    pub(super) linear: f64,
    pub(super) inputs: InputsReport,
    pub(super) random: RefCell<Random>,
    /// Why the device can no longer be driven.
    pub(super) obstacle: RefCell<Option<String>>,
    /// The latched faults that a step has reported.
    reported: Cell<Faults>,
}

impl Course {
    /// The numbers of the connected device.
    pub(super) fn new(dialogue: Dialogue, request: SelftestRequest) -> Result<Self, MeasureError> {
        let read = dialogue.seen(|snapshot| {
            let profile = snapshot.device.profile.as_ref().and_then(|report| report.profile.as_ref());
            let per_mille = |share: u16| f64::from(share) / 1000.0;
            Some((
                snapshot.sample_rate_hz()?,
                profile.map_or(1.0, |profile| per_mille(profile.max_sum_per_mille)),
                snapshot.device.analogue.map_or(1.0, |analogue| per_mille(analogue.linear_per_mille)),
                snapshot.device.inputs.unwrap_or_default(),
            ))
        });
        let (rate_hz, most, linear, inputs) = read.flatten().ok_or(MeasureError::Lost)?;
        let random = RefCell::new(Random::new(request.seed));
        Ok(Self {
            dialogue,
            request,
            rate_hz,
            most,
            linear,
            inputs,
            random,
            obstacle: RefCell::default(),
            reported: Cell::new(Faults::NONE),
        })
    }

    /// Whether the clocks are compared over the time of the test alone.
    pub(super) const fn is_short(&self) -> bool {
        self.request.is_short || self.request.is_amplifier_on
    }

    /// How long before the sample at which it acts a request is sent, at this attempt.
    pub(super) fn ahead_s(&self, tries: u32) -> f64 {
        let tries = f64::from(tries);
        if self.request.is_short { SHORT_AHEAD_S * tries * tries } else { AHEAD_S * tries }
    }

    pub(super) const fn samples(&self, time_s: f64) -> u64 {
        (time_s * self.rate_hz) as u64
    }

    /// The highest sum of levels at which tones stay within the linear share.
    pub(super) fn clean(&self) -> f64 {
        (0.95 * self.linear).min(self.most)
    }

    /// The table of the test: frequencies from 0.4 to 0.0005 of the sample rate, each at full gain.
    pub(super) fn table(&self) -> Result<Arc<DeviceTable>, MeasureError> {
        let (first, last) = TURNS;
        let knots = (0..KNOTS).map(|knot| {
            let share = f64::from(knot) / f64::from(KNOTS - 1);
            (self.rate_hz * first * (last / first).powf(share), 1.0)
        });
        Ok(Arc::new(DeviceTable::from_knots(SPAN_M, self.rate_hz, knots, 1e-6)?))
    }

    /// Takes the device onto the bench with the table of the test, silent for so long that its codes are known.
    pub(super) async fn begin(&self) -> Result<(), MeasureError> {
        let own = self.dialogue.seen(|snapshot| snapshot.table.confirmed.clone()).flatten();
        let table = self.table()?;
        match own {
            Some(own) if own.crc() != table.crc() => self.dialogue.lend(&table, &own).await?,
            _ => self.dialogue.done(Request::Upload(table)).await?,
        };
        self.dialogue.replay(self.samples(KEPT_S));
        self.idle().await?;
        self.dialogue.arm(false).await?;
        self.dialogue.stop().await?;
        self.dialogue.past(self.dialogue.now() + self.samples(SILENT_S)).await
    }

    /// Waits until a device that was disarmed is silent, for as long as a stop takes at most: before, it refuses to be armed.
    pub(super) async fn idle(&self) -> Result<(), MeasureError> {
        self.dialogue.done(Request::Refresh).await?;
        let end = self.dialogue.now() + self.samples(SILENT_S);
        while self.dialogue.now() < end {
            let state = self.dialogue.seen(|snapshot| snapshot.drive.status.map(|status| status.state));
            if state.flatten() == Some(State::Idle) {
                break;
            }
            self.dialogue.past(self.dialogue.now() + self.samples(LOOK_S)).await?;
            self.dialogue.done(Request::Refresh).await?;
        }
        Ok(())
    }

    /// The latched faults.
    pub(super) fn faults(&self) -> Faults {
        let read = self.dialogue.seen(|snapshot| snapshot.drive.status.map(|status| status.faults));
        read.flatten().unwrap_or(Faults::NONE)
    }

    /// Carries a step out. What the device refuses, or a fault that it latches, makes the step red; after a fault the device
    /// can no longer be driven. A lost or stopped device ends the test.
    pub(super) async fn step(
        &self,
        name: &str,
        step: impl Future<Output = Result<StepResult, MeasureError>>,
    ) -> Result<StepResult, MeasureError> {
        let done = step.await;
        if matches!(done, Err(MeasureError::Lost | MeasureError::Cancelled | MeasureError::Stopped)) {
            return done;
        }
        // What ended the step may be a fault that the latest status does not show yet.
        self.dialogue.done(Request::Refresh).await?;
        let faults = self.faults();
        if faults.contains(Fault::DeskStop) {
            // A person at the desk has stopped it: that says nothing of the board.
            return Err(MeasureError::Fault(faults.to_string()));
        }
        if faults != self.reported.replace(faults) {
            let sentence = format!("The device stopped: {faults}.");
            *self.obstacle.borrow_mut() = Some(format!("Not shown: {name} ended with a fault."));
            return Ok(StepResult::failed(name, sentence));
        }
        Ok(match done {
            Ok(result) => result,
            Err(MeasureError::TooOld) => {
                StepResult::skipped(name, "The device's firmware is older than protocol 1.3.")
            }
            Err(error) => {
                self.dialogue.stop().await?;
                StepResult::failed(name, format!("It was not carried out: {error}."))
            }
        })
    }

    /// As [`driven`](Self::driven), of a step in which the device restarts, and may be gone at its end.
    pub(super) async fn restarting(
        &self,
        name: &str,
        step: impl Future<Output = Result<StepResult, MeasureError>>,
    ) -> Result<StepResult, MeasureError> {
        let obstacle = self.obstacle.borrow().clone();
        if let Some(obstacle) = obstacle {
            return Ok(StepResult::skipped(name, obstacle));
        }
        match step.await {
            Ok(done) if self.obstacle.borrow().is_some() => Ok(done),
            done => self.step(name, async { done }).await,
        }
    }

    /// As [`step`](Self::step), of a step that drives; skipped after a fault.
    pub(super) async fn driven(
        &self,
        name: &str,
        step: impl Future<Output = Result<StepResult, MeasureError>>,
    ) -> Result<StepResult, MeasureError> {
        let obstacle = self.obstacle.borrow().clone();
        match obstacle {
            Some(obstacle) => Ok(StepResult::skipped(name, obstacle)),
            None => self.step(name, step).await,
        }
    }

    /// Lets multiples of `rate / (128 period_blocks)` rise from silence, each (multiple, level); returns the sample by which
    /// they have risen.
    pub(super) async fn comb(
        &self,
        period_blocks: u16,
        tones: impl IntoIterator<Item = (u16, f64)>,
    ) -> Result<u64, MeasureError> {
        self.dialogue.stop().await?;
        let tone = |(harmonic, level)| HarmonicRequest { harmonic, level, phase_turns: 0.0 };
        let comb = CombRequest::of(period_blocks, tones.into_iter().map(tone).collect());
        let at = self.dialogue.done(Request::Play(Sounding::Comb(comb))).await?;
        Ok(at + self.samples(RISEN_S))
    }

    /// Asks for what begins at a block's first sample, not before `earliest`. A request that arrives after it is repeated, farther
    /// ahead. `samples`: with requests as fast as the device answers them, until so many later.
    pub(super) async fn in_time(
        &self,
        earliest: u64,
        samples: Option<u64>,
        request: impl Fn(u64) -> Request,
    ) -> Result<Outcome, MeasureError> {
        let mut tries = 1;
        loop {
            self.dialogue.done(Request::Refresh).await?;
            let from = earliest.max(self.dialogue.now() + self.samples(self.ahead_s(tries)));
            let from = from.next_multiple_of(slipline_link::BLOCK as u64);
            let outcome = if let Some(samples) = samples {
                self.dialogue.begin(request(from));
                let end = from + samples + self.samples(KEPT_S);
                self.dialogue.ended(end).await?.ok_or(MeasureError::Unknown)?
            } else {
                self.dialogue.ask(request(from)).await
            };
            if !is_late(&outcome) || tries == TRIES {
                return Ok(outcome);
            }
            tries += 1;
        }
    }

    /// Captures the sensor's input, as [`capture_of`](Self::capture_of).
    pub(super) async fn capture(
        &self,
        earliest: u64,
        log2_codes: u8,
        values: u16,
        is_busy: bool,
    ) -> Result<Arc<Captured>, MeasureError> {
        self.capture_of(SENSOR, earliest, log2_codes, values, is_busy).await
    }

    /// Captures an input, not before a sample. `is_busy`: with requests as fast as the device answers them meanwhile.
    pub(super) async fn capture_of(
        &self,
        input: u8,
        earliest: u64,
        log2_codes: u8,
        values: u16,
        is_busy: bool,
    ) -> Result<Arc<Captured>, MeasureError> {
        let samples = is_busy.then_some(u64::from(values) << log2_codes);
        let request = |from| Request::Capture(CaptureRequest { from: Some(from), input, log2_codes, values });
        let outcome = self.in_time(earliest, samples, request).await?;
        if let Outcome::Captured(captured) = outcome { Ok(captured) } else { Err(ended_by(&outcome)) }
    }
}

/// The reading of a step's quantity.
pub(super) fn reading(step: &str, name: &str, value: f64) -> Reading {
    let known = quantity(step, name);
    debug_assert!(known.is_some_and(|known| known.allows(value)), "{step}: {name} = {value}");
    Reading::new(step, name, value, known.map_or("", |known| known.unit))
}
