//! Execution of commands: checks a command, then refuses it or hands its effect over.
//!
//! ```text
//! Command --execute--> Ok(Event) or Err(Refusal)
//!            |  plan, publish, stop, arm ... --> Mailbox
//!            |  upload --> the slot that does not sound
//!            |  store  --> FlashPages
//! tick ------+  thermal model, drive time, time-outs, level hold
//! ```
//! A refused command has changed nothing that sounds or is kept.

#![cfg_attr(not(test), deny(clippy::arithmetic_side_effects))]

mod brown_out;
mod drive;
mod excursion;
mod fault_trial;
mod hold;
mod listening;
mod mute_pin;
mod profile;
mod status;
mod tables;

use core::cell::Cell;

use embassy_sync::blocking_mutex::raw::RawMutex;
use slipline_protocol::board::OrderedFault;
use slipline_protocol::command::{Command, DigestWindow, KeepAlive, TableHeader};
use slipline_protocol::event::{
    Accepted, Digest, Event, Fault, Faults, StoredConfig, TableReport, TriggerReport,
};
use slipline_protocol::limits;
use slipline_protocol::refusal::{Busy, Field, Refusal};
use slipline_protocol::timing::Timing;
use slipline_protocol::units::SampleIndex;

use crate::digest::DigestState;
use crate::listening::capture::Values;
use crate::mailbox::Mailbox;
use crate::mailbox::Stop;
use crate::planning::chord::Candidate;
use crate::ports::{FlashPages, System};
use crate::range::in_range;
use crate::safety::boot::Boot;
use crate::safety::bounds::Bounds;
use crate::safety::excursion::Excursion;
use crate::safety::thermal::Thermal;
use crate::slots::TableRef;
use crate::store::Budget;
use crate::timing::BLOCK_SAMPLES;
use crate::two_steps::TwoSteps;
use crate::upload::{self, Upload};

/// The facts about a device that never change.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Device {
    /// The board's name; what is longer than the protocol's limit is cut.
    pub board: &'static str,
    /// The commit or build; cut likewise.
    pub build: &'static str,
    /// The firmware's version.
    pub firmware: (u8, u8, u8),
    /// The chip's unique id.
    pub unit: [u8; 12],
    /// No real plate hangs on it.
    pub simulated: bool,
    /// Samples per second, in Hz.
    pub sample_rate_hz: u32,
}

/// The thread side's state: what commands change and what may take time.
pub struct Controller<'a, F, S> {
    device: Device,
    boot: Boot,
    timing: Timing,
    flash: F,
    system: S,
    stored: StoredConfig,
    /// Erasures of both slots, and of the profile's; 0 in safe mode, which does not read the flash.
    erasures: u32,
    profile_erasures: u32,
    stores: Budget,
    thermal: Thermal,
    /// The active table; its slot holds the knots.
    table: Option<TableHeader>,
    active: TableRef,
    upload: Option<Upload>,
    excursion: Excursion,
    bounds: Bounds,
    candidate: &'a mut Candidate,
    captured: &'a Values,
    holding: hold::Holding,
    last_keep_alive: Option<u32>,
    bootloader: TwoSteps,
    /// The fault on purpose that the two steps lead to.
    fault_order: TwoSteps,
    ordered_fault: OrderedFault,
    /// When the level of the brown-out reset was written: it is in force after a restart.
    restart_due: Option<SampleIndex>,
    /// Blocks that the renderer has begun while the last motion was planned.
    lead: Cell<u64>,
}

impl<'a, F: FlashPages, S: System> Controller<'a, F, S> {
    /// A controller that has not read the store yet. `candidate` lies elsewhere, because a firmware has no room for it on the
    /// stack on which it makes the controller. `captured` is where the listener puts what it captures.
    #[must_use]
    pub fn new(
        device: Device,
        boot: Boot,
        flash: F,
        system: S,
        candidate: &'a mut Candidate,
        captured: &'a Values,
    ) -> Self {
        Self {
            timing: Timing::at(device.sample_rate_hz),
            thermal: Thermal::new(boot.heat),
            device,
            boot,
            flash,
            system,
            stored: StoredConfig::Empty,
            erasures: 0,
            profile_erasures: 0,
            stores: Budget::FULL,
            table: None,
            active: TableRef::default(),
            upload: None,
            excursion: Excursion::unlimited(device.sample_rate_hz),
            bounds: Bounds::none(device.sample_rate_hz),
            candidate,
            captured,
            holding: hold::Holding::NONE,
            last_keep_alive: None,
            bootloader: TwoSteps::default(),
            fault_order: TwoSteps::default(),
            ordered_fault: OrderedFault::default(),
            restart_due: None,
            lead: Cell::new(0),
        }
    }

    /// The times in samples.
    #[must_use]
    pub const fn timing(&self) -> &Timing {
        &self.timing
    }

    /// Latches the fault of the last reset, if any, and loads the stored table. Once, before the first command.
    pub fn start<M: RawMutex>(&mut self, mailbox: &Mailbox<M>) {
        if let Some(fault) = self.boot.fault() {
            mailbox.latch(fault);
        }
        // Before anything can sound: the coil may be hot and must not be driven at full scale then.
        mailbox.set_limit(self.thermal.limit_per_mille());
        if self.boot.safe_mode {
            // The stored table may have crashed the last runs.
            return;
        }
        self.load(mailbox);
        self.load_profile(mailbox);
    }

    /// Begins a session: ramps to silence, disarms, and drops what the last session had begun.
    pub fn begin_session<M: RawMutex>(&mut self, mailbox: &Mailbox<M>) {
        mailbox.disarm(Stop::Normal);
        mailbox.drop_digest();
        mailbox.drop_listening();
        self.holding.clear();
        self.upload = None;
        self.excursion.clear();
        self.bootloader.close();
        self.fault_order.close();
        self.last_keep_alive = None;
    }

    /// Feeds the dead-man if this keep-alive is newer than the last.
    pub fn keep_alive<M: RawMutex>(&mut self, keep_alive: KeepAlive, mailbox: &Mailbox<M>) {
        if self.last_keep_alive.is_none_or(|last| keep_alive.beat > last) {
            self.last_keep_alive = Some(keep_alive.beat);
            mailbox.feed();
        }
    }

    /// Does a numbered command. One that takes long asks `is_stopped` now and then whether a stop has come: a drive, a chord and
    /// a commit of a table start nothing after one; a chunk of a table and its digest go on, since they start nothing anyway.
    ///
    /// # Errors
    /// The refusal; nothing has changed then.
    pub fn execute<M: RawMutex>(
        &mut self,
        command: &Command,
        is_stopped: &mut dyn FnMut() -> bool,
        mailbox: &Mailbox<M>,
    ) -> Result<Event, Refusal> {
        match command {
            Command::Arm => self.arm(false, mailbox).map(accepted),
            Command::ArmFor(lease) => self.arm_for(*lease, false, mailbox).map(accepted),
            Command::Bench(lease) => self.arm_for(*lease, true, mailbox).map(accepted),
            Command::Disarm => Ok(accepted(mailbox.disarm(Stop::Normal))),
            Command::Drive(drive) => {
                let waited = self.hold_back_levels(mailbox);
                let answer = self.drive(drive, is_stopped, mailbox);
                self.go_on_if_refused(waited, answer.is_err(), is_stopped, mailbox);
                answer.map(|published| drive::answer(published, drive.glide))
            }
            Command::Chord(chord) => self.chord(chord, is_stopped, mailbox).map(accepted),
            Command::Comb(comb) => self.comb(comb, is_stopped, mailbox).map(accepted),
            Command::ClearFaults => {
                self.clear_faults(mailbox);
                Ok(accepted(mailbox.now()))
            }
            Command::SetTravelLimit(setting) => self.set_travel_limit(*setting, mailbox),
            Command::TravelLimit => Ok(self.travel_limit()),
            Command::Trigger => {
                let (waits, began) = mailbox.trigger();
                Ok(Event::Trigger(TriggerReport { waits, began }))
            }
            Command::TableBegin(header) => {
                let slot = self.active.slot.other();
                if !mailbox.slot_is_free(slot) {
                    return Err(Refusal::Busy(Busy::TableInUse));
                }
                let now = mailbox.now();
                self.upload = Some(Upload::begin(header, slot, self.timing.sample_rate_hz, now)?);
                self.excursion.begin(slot);
                self.bounds.travel.begin(slot);
                Ok(accepted(now))
            }
            Command::TableChunk(chunk) => {
                let now = mailbox.now();
                let upload = self.upload.as_mut().ok_or(Refusal::NoUpload)?;
                upload.take(chunk, mailbox, now, |written, first| {
                    self.excursion.written(written, first, mailbox.slots());
                    self.bounds.travel.written(written, first, mailbox.slots());
                    is_stopped();
                })?;
                Ok(accepted(now))
            }
            Command::TableCommit => self.commit_table(is_stopped, mailbox).map(accepted),
            Command::TableAbort => {
                self.upload = None;
                Ok(accepted(mailbox.now()))
            }
            Command::TableDigest => Ok(Event::Table(TableReport {
                active: self.table.map(|table| TableHeader {
                    crc: upload::digest(&table, self.active.slot, mailbox, || {
                        is_stopped();
                    }),
                    ..table
                }),
                staged: self.upload.as_ref().map_or(0, Upload::received),
            })),
            Command::DigestStart(window) => self.start_digest(*window, mailbox).map(accepted),
            Command::DigestRead => match mailbox.digest() {
                DigestState::None => Err(Refusal::NoDigest),
                DigestState::Waiting(DigestWindow { from, count }) => {
                    Ok(Event::Digest(Digest { from, count, crc: None }))
                }
                DigestState::Done(DigestWindow { from, count }, crc) => {
                    // A stop may still begin in the block that was rendered last.
                    let end = from.saturating_add(count.into()).saturating_add(BLOCK_SAMPLES);
                    Ok(Event::Digest(Digest { from, count, crc: (end <= mailbox.now()).then_some(crc) }))
                }
            },
            Command::Store => self.store(mailbox),
            Command::Forget => self.forget(mailbox),
            Command::Maintenance => Ok(Event::Maintenance(self.maintenance())),
            Command::Wear => Ok(Event::Wear(self.wear(mailbox.now()))),
            Command::Board => Ok(Event::Board(self.system.board())),
            Command::Analogue => Ok(Event::Analogue(self.system.analogue())),
            Command::MutePin(step) => self.mute_pin(*step, mailbox).map(Event::MutePin),
            Command::Clock => Ok(Event::Clock(self.system.clock(&|| mailbox.now()))),
            Command::Stall => self.stall(mailbox).map(accepted),
            Command::Profile => Ok(Event::Profile(self.bounds.report())),
            Command::WriteProfile(setting) => self.write_profile(setting, mailbox),
            Command::BrownOut(order) => self.brown_out(*order, mailbox).map(Event::BrownOut),
            Command::BootloaderToken => {
                self.refuse_unless_leavable(mailbox)?;
                Ok(Event::BootloaderToken(self.bootloader.give_token(&self.device.unit, mailbox.now())))
            }
            Command::BootloaderEnter(token) => {
                self.refuse_unless_leavable(mailbox)?;
                if self.bounds.is_kept() {
                    // Another firmware knows nothing of the profile.
                    self.refuse_without_hand(mailbox)?;
                }
                let now = mailbox.now();
                self.bootloader.show_token(*token, now, &self.timing)?;
                Ok(accepted(now))
            }
            Command::FaultToken => self.fault_token(mailbox).map(Event::FaultTrial),
            Command::FaultOrder(order) => self.order_fault(*order, mailbox).map(accepted),
            Command::Inputs => Ok(listening::inputs(mailbox)),
            Command::Listen(window) => self.listen(window, mailbox).map(accepted),
            Command::ListenRead(part) => listening::listened(*part, mailbox),
            Command::ListenStop => {
                self.refresh_hold(mailbox);
                self.refuse_if_holding()?;
                mailbox.drop_measurement();
                Ok(accepted(mailbox.now()))
            }
            Command::Capture(window) => self.capture(window, mailbox).map(accepted),
            Command::CaptureRead(part) => self.captured(*part, mailbox),
            Command::CaptureStop => {
                mailbox.stop_capture();
                Ok(accepted(mailbox.now()))
            }
            Command::Hold(setting) => self.hold(setting, is_stopped, mailbox).map(accepted),
            Command::HoldRead => self.held(mailbox),
            // The session answers these itself; one that comes here is refused like an unknown message.
            Command::Hello(_)
            | Command::KeepAlive(_)
            | Command::Status
            | Command::Stop
            | Command::EmergencyStop => Err(Refusal::UnknownMessage { id: command.id() }),
        }
    }

    /// Clears all faults but those whose cause stands.
    fn clear_faults<M: RawMutex>(&mut self, mailbox: &Mailbox<M>) {
        if self.refuse_without_hand(mailbox).is_ok() {
            self.bounds.accept_older();
        }
        let has_rested = |last: SampleIndex| mailbox.now().saturating_sub(last) >= self.timing.desk_stop;
        let is_stopped = self.is_stopped_on_the_desk() || !mailbox.hand().last.is_none_or(has_rested);
        let causes = [
            self.thermal.is_warm().then_some(Fault::Overheat),
            is_stopped.then_some(Fault::DeskStop),
            self.bounds.fault(),
        ];
        mailbox.clear_faults(causes.into_iter().flatten().fold(Faults::NONE, Faults::with));
    }

    /// Control-rate work: the thermal model, the drive time, the time-outs, the level hold. That may take as long as a drive, so
    /// it asks `is_stopped` now and then whether a stop has come, and starts nothing after one.
    pub fn tick<M: RawMutex>(&mut self, is_stopped: &mut dyn FnMut() -> bool, mailbox: &Mailbox<M>) {
        let view = mailbox.view();
        let now = view.next;
        self.thermal.advance(now, view.report.energy, self.timing.sample_rate_hz);
        mailbox.set_limit(self.thermal.limit_per_mille());
        if self.thermal.is_over() && !view.faults.set().contains(Fault::Overheat) {
            mailbox.fault(Fault::Overheat, Stop::Normal);
        }
        // A table swap that is pending is no drive.
        let sounds = view.armed && !view.report.silent;
        if sounds && now.saturating_sub(mailbox.drive_began()) >= self.bounds.max_drive(&self.timing) {
            mailbox.fault(Fault::DriveTime, Stop::Normal);
        }
        if self.upload.as_ref().is_some_and(|upload| upload.is_stale(now, self.timing.staging)) {
            self.upload = None;
        }
        // A device that was armed after the token was shown stays.
        if self.bootloader.is_passed(now, &self.timing) && !view.armed && view.is_silent() {
            self.system.enter_bootloader();
        }
        self.restart_if_due(&view);
        self.fail_if_due(&view, mailbox);
        mailbox.pulse_safety();
        self.turn_hold(is_stopped, mailbox);
    }

    fn start_digest<M: RawMutex>(
        &self,
        window: DigestWindow,
        mailbox: &Mailbox<M>,
    ) -> Result<SampleIndex, Refusal> {
        in_range(Field::DigestCount, 1, u64::from(limits::MAX_DIGEST_SAMPLES), u64::from(window.count))?;
        mailbox.start_digest(window, |next, state| {
            let latest = next.saturating_add(self.timing.max_apply_ahead);
            in_range(Field::ApplyAt, next, latest, window.from)?;
            if matches!(state, DigestState::Waiting(_)) {
                return Err(Refusal::Busy(Busy::DigestPending));
            }
            Ok(window.from)
        })
    }

    fn refuse_unless_leavable<M: RawMutex>(&self, mailbox: &Mailbox<M>) -> Result<(), Refusal> {
        if !self.system.has_bootloader() {
            return Err(Refusal::NotSupported);
        }
        let view = mailbox.view();
        if view.armed || !view.is_silent() { Err(Refusal::Armed) } else { Ok(()) }
    }
}

const fn accepted(at: SampleIndex) -> Event {
    Event::Accepted(Accepted { at })
}

#[cfg(test)]
mod tests;
