//! Steps of a level hold that is switched on: the next request to the device, and the conditions that end it.

use super::end::HoldEnd;
use super::standing::Standing;
use super::{HoldError, HoldPlan};
use crate::measure::is_late;
use slipline_link::protocol::event::State;
use slipline_link::protocol::hold::Held;
use slipline_link::protocol::refusal::{Busy, Refusal as DeviceRefusal};
use slipline_link::{HoldProgress, HoldState, Listened, Outcome, Refusal, Request, Snapshot, Ticket};
use slipline_model::sounding::{SoundingDrive, sounding};
use slipline_plate::Plate;
use std::sync::Arc;

/// Attempts to listen while the device is temporarily unable to.
const ATTEMPTS: u8 = 3;

/// A hold that is switched on.
#[derive(Debug)]
pub(super) struct Course {
    plate: Arc<Plate>,
    max_rise_db: f64,
    since: Since,
    /// The digest of the device's table.
    table: Option<u32>,
    stage: Stage,
    attempts: u8,
}

/// From when the sensor can be listened to.
#[derive(Clone, Copy, Debug)]
enum Since {
    /// From the first status after this one; `None` if no status has been seen.
    NextStatus(Option<u64>),
    /// From this sample index.
    Index(u64),
}

#[derive(Debug)]
enum Stage {
    Waiting(Wait),
    Listening(Asked),
    Ordered(Asked),
    /// With the index of the first sample of its first window.
    Holding(Asked, u64),
}

/// The event that the hold waits for.
#[derive(Clone, Copy, Debug)]
enum Wait {
    Device,
    Sound,
    Rest,
}

/// A request to listen or hold.
#[derive(Debug)]
struct Asked {
    plan: HoldPlan,
    /// The journal number of the drive.
    number: u64,
    /// Its tones: slot and frequency in Hz.
    tones: Vec<(u8, f64)>,
    ticket: Option<Ticket>,
}

impl Course {
    pub(super) fn new(plate: &Arc<Plate>, max_rise_db: f64, since: Option<u64>) -> Self {
        Self {
            plate: Arc::clone(plate),
            max_rise_db,
            since: since.map_or(Since::NextStatus(None), Since::Index),
            table: None,
            stage: Stage::Waiting(Wait::Device),
            attempts: 0,
        }
    }

    /// Whether the device holds, or may hold because of a pending request.
    pub(super) const fn may_hold(&self) -> bool {
        matches!(self.stage, Stage::Ordered(_) | Stage::Holding(..))
    }

    pub(super) fn standing<'a>(&self, snapshot: &'a Snapshot) -> Standing<'a> {
        match &self.stage {
            Stage::Waiting(Wait::Device) | Stage::Ordered(_) => Standing::Waiting,
            Stage::Waiting(Wait::Sound) => Standing::Silent,
            Stage::Waiting(Wait::Rest) => Standing::Changing,
            Stage::Listening(asked) => Standing::Listening(asked.plan.listening_s()),
            Stage::Holding(_, begin) => Standing::Holding(held_since(snapshot, *begin)),
        }
    }

    /// The frequency of the held tone in a slot, in Hz.
    pub(super) fn frequency_hz(&self, slot: u8) -> Option<f64> {
        let Stage::Holding(asked, _) = &self.stage else { return None };
        asked.tones.iter().find(|(of, _)| *of == slot).map(|(_, hertz)| *hertz)
    }

    /// Stores the ticket of the last request.
    pub(super) const fn sent(&mut self, ticket: Ticket) {
        if let Stage::Listening(asked) | Stage::Ordered(asked) = &mut self.stage {
            asked.ticket = Some(ticket);
        }
    }

    /// Ends the hold if the plate, table or device state for which it was switched on has changed.
    pub(super) fn check(&mut self, snapshot: &Snapshot, plate: &Arc<Plate>) -> Result<(), HoldEnd> {
        if !snapshot.is_connected() {
            return Err(HoldEnd::LinkLost);
        }
        if !snapshot.can_listen() {
            return Err(HoldEnd::Cannot(HoldError::NoInputs));
        }
        match snapshot.drive.status.map(|status| (status.state, status.faults)) {
            Some((State::Fault | State::SafeMode, faults)) => return Err(HoldEnd::Fault(faults)),
            Some((State::Idle, _)) => return Err(HoldEnd::Disarmed),
            _ => {}
        }
        let table = snapshot.table.report.active.map(|header| header.crc);
        let is_same = self.table.is_none_or(|before| Some(before) == table);
        if !is_same || !Arc::ptr_eq(&self.plate, plate) {
            return Err(HoldEnd::OtherPlate);
        }
        self.table = table;
        Ok(())
    }

    /// The next request to the device.
    pub(super) fn turn(&mut self, snapshot: &Snapshot, rests: bool) -> Result<Option<Request>, HoldEnd> {
        let Some(since) = self.since(snapshot) else { return Ok(self.wait(Wait::Device)) };
        let Some(sounding) = sounding(snapshot) else { return Ok(self.wait(Wait::Sound)) };
        let number = match &self.stage {
            Stage::Waiting(_) => None,
            Stage::Listening(asked) | Stage::Ordered(asked) | Stage::Holding(asked, _) => Some(asked.number),
        };
        if number.is_some_and(|number| number != sounding.number) {
            // Pending requests belong to the previous drive and no longer count. The device has ended its
            // hold. Listening begins with the next turn, so that callers first see that nothing is held.
            self.attempts = 0;
            return Ok(self.wait(Wait::Rest));
        }
        match &self.stage {
            Stage::Waiting(_) if !rests => Ok(self.wait(Wait::Rest)),
            Stage::Waiting(_) => self.listen(snapshot, &sounding, since),
            Stage::Listening(asked) | Stage::Ordered(asked) => {
                match asked.ticket.and_then(|ticket| snapshot.outcome(ticket)).cloned() {
                    Some(outcome) => self.take(&outcome, snapshot, &sounding, since),
                    None => Ok(None),
                }
            }
            Stage::Holding(_, begin) => held_since(snapshot, *begin).map_or(Ok(None), goes_on),
        }
    }

    fn wait(&mut self, wait: Wait) -> Option<Request> {
        self.stage = Stage::Waiting(wait);
        None
    }

    /// The index from which the sensor can be listened to, once it is known.
    fn since(&mut self, snapshot: &Snapshot) -> Option<u64> {
        let now = snapshot.drive.status.map(|status| status.now);
        match (self.since, now) {
            (Since::Index(since), _) => Some(since),
            (Since::NextStatus(Some(before)), Some(now)) if now != before => {
                self.since = Since::Index(now);
                Some(now)
            }
            (Since::NextStatus(before), now) => {
                self.since = Since::NextStatus(before.or(now));
                None
            }
        }
    }

    /// Requests a window of the sounding tones.
    fn listen(
        &mut self,
        snapshot: &Snapshot,
        sounding: &SoundingDrive,
        since: u64,
    ) -> Result<Option<Request>, HoldEnd> {
        let rate_hz = snapshot.sample_rate_hz().unwrap_or_default();
        let lock_ins = snapshot.device.inputs.map_or(0, |inputs| usize::from(inputs.lock_ins));
        let audible = sounding.tones.iter().filter(|tone| tone.peak_m > 0.0);
        let tones: Vec<(u8, f64)> = audible.map(|tone| (tone.slot, tone.frequency_hz)).collect();
        let plan = HoldPlan::new(&self.plate, &tones, rate_hz, lock_ins, self.max_rise_db)
            .map_err(HoldEnd::Cannot)?;
        let request = Request::Listen(plan.listen(Some(sounding.reached.max(since))));
        self.stage = Stage::Listening(Asked { plan, number: sounding.number, tones, ticket: None });
        Ok(Some(request))
    }

    /// Handles the outcome of the last request.
    fn take(
        &mut self,
        outcome: &Outcome,
        snapshot: &Snapshot,
        sounding: &SoundingDrive,
        since: u64,
    ) -> Result<Option<Request>, HoldEnd> {
        match (std::mem::replace(&mut self.stage, Stage::Waiting(Wait::Device)), outcome) {
            (Stage::Listening(asked), Outcome::Listened(listened)) => self.order(asked, listened),
            // The plate has settled meanwhile.
            (Stage::Listening(asked), outcome) if is_late(outcome) => {
                let request = Request::Listen(asked.plan.listen(None));
                self.stage = Stage::Listening(Asked { ticket: None, ..asked });
                Ok(Some(request))
            }
            (Stage::Ordered(asked), Outcome::Done { at }) => {
                self.attempts = 0;
                self.stage = Stage::Holding(asked, *at);
                Ok(None)
            }
            (_, outcome) if is_for_now(outcome) && self.attempts < ATTEMPTS => {
                self.attempts += 1;
                self.listen(snapshot, sounding, since)
            }
            (_, Outcome::Refused(refusal)) => Err(HoldEnd::Refused(refusal.clone())),
            (_, Outcome::DeviceTooOld) => Err(HoldEnd::TooOld),
            (_, Outcome::NotConnected) => Err(HoldEnd::LinkLost),
            _ => Err(HoldEnd::Disturbed),
        }
    }

    /// Requests the hold of the measured amplitudes.
    fn order(&mut self, asked: Asked, listened: &Listened) -> Result<Option<Request>, HoldEnd> {
        let request = asked.plan.hold(listened).map_err(HoldEnd::Cannot)?;
        self.stage = Stage::Ordered(Asked { ticket: None, ..asked });
        Ok(Some(Request::Hold(request)))
    }
}

/// The reported state of the hold whose first window began at this index; reports on earlier holds are
/// ignored.
fn held_since(snapshot: &Snapshot, begin: u64) -> Option<&Held> {
    snapshot.drive.hold.as_deref().filter(|held| held.begin >= begin)
}

/// Whether the device reports that the hold continues.
fn goes_on(held: &Held) -> Result<Option<Request>, HoldEnd> {
    match held.progress {
        HoldProgress::On => Ok(None),
        HoldProgress::Off | HoldProgress::Ended => Err(HoldEnd::Disturbed),
        HoldProgress::Lost => {
            let losses = held.tones.iter().filter_map(|tone| match tone.state {
                HoldState::Lost(loss) => Some(loss),
                HoldState::Settling | HoldState::Held | HoldState::AtLimit(_) => None,
            });
            Err(HoldEnd::lost(losses))
        }
    }
}

/// Whether the failure was temporary, so that another attempt is worthwhile: codes were lost, another change
/// intervened, or another client has listened.
const fn is_for_now(outcome: &Outcome) -> bool {
    matches!(
        outcome,
        Outcome::Superseded
            | Outcome::Refused(
                Refusal::InputLost { .. }
                    | Refusal::Device(DeviceRefusal::Busy(Busy::CommitPending | Busy::Holding))
            )
    )
}
