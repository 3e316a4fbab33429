//! What every command does: checks it, may refuse it, and hands the effect over.
//!
//! ```text
//! Command --execute--> Ok(Event) or Err(Refusal)
//!            |  plan, publish, stop, arm ... --> Crossing
//!            |  upload --> the slot that does not sound
//!            |  store  --> FlashPages
//! tick ------+  thermal model, drive time, time-outs
//! ```
//! A refused command has changed nothing.

#![cfg_attr(not(test), deny(clippy::arithmetic_side_effects))]

use embassy_sync::blocking_mutex::raw::RawMutex;
use heapless::String;
use slipline_protocol::command::{Apply, Command, DigestWindow, Drive, KeepAlive, TableHeader};
use slipline_protocol::event::{
    Accepted, Counters, Digest, Event, Fault, Faults, Identity, State, Status, StoredConfig, TableReport,
};
use slipline_protocol::limits;
use slipline_protocol::refusal::{Busy, Field, Refusal};
use slipline_protocol::units::SampleIndex;
use slipline_protocol::version::Version;

use crate::bank::{BLOCK, TONES};
use crate::boot::Boot;
use crate::bootloader::BootloaderDoor;
use crate::digest::DigestState;
use crate::headroom::per_mille;
use crate::mailbox::{Crossing, NotPublished};
use crate::motion::Motion;
use crate::orders::{Stop, View};
use crate::ports::{FlashPages, System};
use crate::program::{plan, plan_swap};
use crate::ramp::RampShape;
use crate::slots::TableRef;
use crate::store;
use crate::thermal::Thermal;
use crate::timing::{BLOCK_SAMPLES, Timing, block_at_or_after};
use crate::upload::{self, Upload};

/// Bits of a DAC code.
const DAC_BITS: u8 = 12;

/// How many blocks later each further attempt to publish a program begins, should planning take longer than a block.
const LEADS: [u64; 5] = [0, 1, 4, 16, 64];

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

/// The half of the application that may refuse and take time.
pub struct Controller<F, S> {
    device: Device,
    boot: Boot,
    timing: Timing,
    shape: RampShape,
    flash: F,
    system: S,
    stored: StoredConfig,
    thermal: Thermal,
    /// The active table; its slot holds the knots.
    table: Option<TableHeader>,
    active: TableRef,
    upload: Option<Upload>,
    last_beat: Option<u32>,
    user_acted_at: SampleIndex,
    door: BootloaderDoor,
}

impl<F: FlashPages, S: System> Controller<F, S> {
    /// A controller that has not read the store yet.
    #[must_use]
    pub fn new(device: Device, boot: Boot, flash: F, system: S) -> Self {
        Self {
            timing: Timing::at(device.sample_rate_hz),
            thermal: Thermal::new(boot.heat),
            device,
            boot,
            shape: RampShape::new(),
            flash,
            system,
            stored: StoredConfig::Empty,
            table: None,
            active: TableRef::default(),
            upload: None,
            last_beat: None,
            user_acted_at: 0,
            door: BootloaderDoor::default(),
        }
    }

    /// The times in samples.
    #[must_use]
    pub const fn timing(&self) -> &Timing {
        &self.timing
    }

    /// Latches what the reset was, and loads the kept table. Once, before the first command.
    pub fn start<M: RawMutex>(&mut self, crossing: &Crossing<M>) {
        if let Some(fault) = self.boot.fault() {
            crossing.latch(fault);
        }
        // Before anything can sound: a coil that may be hot is never driven at full scale.
        crossing.set_limit(self.thermal.limit_per_mille());
        let slot = self.active.slot.other();
        let knot = |index| crossing.slots().knot(slot, index);
        let loaded = store::load(&mut self.flash, self.timing.sample_rate_hz, |index, knot| {
            crossing.write_knot(slot, index, knot);
        })
        .and_then(|header| {
            if store::is_sound(&header, knot) { Ok(header) } else { Err(StoredConfig::Damaged) }
        });
        self.stored = match loaded {
            Ok(header) => {
                self.table = Some(header);
                self.active = TableRef { slot, knots: header.knots };
                StoredConfig::Loaded
            }
            Err(other) => other,
        };
        if self.stored == StoredConfig::Damaged {
            crossing.latch(Fault::StoreDamaged);
        }
    }

    /// A new session: ramps to silence, disarms, and forgets what the last one had begun.
    pub fn begin_session<M: RawMutex>(&mut self, crossing: &Crossing<M>) {
        crossing.disarm(Stop::Normal);
        crossing.drop_digest();
        self.upload = None;
        self.door.close();
        self.last_beat = None;
    }

    /// Who the device is.
    #[must_use]
    pub fn identity(&self) -> Identity {
        Identity {
            version: Version::OURS,
            firmware: self.device.firmware,
            board: cut(self.device.board),
            build: cut(self.device.build),
            unit: self.device.unit,
            simulated: self.device.simulated,
            sample_rate_hz: self.device.sample_rate_hz,
            block: small(BLOCK),
            dac_bits: DAC_BITS,
            tones: small(TONES).to_le_bytes()[0],
            max_knots: small(limits::MAX_KNOTS),
            min_glide: self.timing.min_glide,
            max_glide: self.timing.max_glide,
            dead_man_ms: limits::DEAD_MAN_MS,
            reset: self.boot.reset,
            stored: self.stored,
            crash: self.boot.crash.clone(),
        }
    }

    /// How the device is; `counters` has the link's part.
    pub fn status<M: RawMutex>(&self, crossing: &Crossing<M>, counters: Counters) -> Status {
        let view = crossing.view();
        let first = view.faults.first();
        Status {
            state: self.state(&view),
            faults: view.faults.set(),
            first_fault: first.map(|(fault, _)| fault),
            first_fault_at: first.map_or(0, |(_, at)| at),
            now: view.next,
            sum_per_mille: per_mille(view.report.sum),
            heat_per_mille: self.thermal.per_mille(),
            // What sounds by; before the first block, what it will sound by.
            foldback_per_mille: view.report.limit_per_mille.unwrap_or(self.thermal.limit_per_mille()),
            table_crc: self.table.map_or(0, |table| table.crc),
            counters: Counters {
                underruns: view.report.underruns,
                clips: view.report.clips,
                max_cycles: view.report.max_cycles,
                ..counters
            },
        }
    }

    fn state(&self, view: &View) -> State {
        if self.boot.safe_mode {
            State::SafeMode
        } else if !view.faults.set().is_empty() {
            State::Fault
        } else if view.stopping || (!view.armed && !view.is_silent()) {
            State::Stopping
        } else if !view.armed {
            State::Idle
        } else if view.is_silent() {
            State::Armed
        } else {
            State::Driving
        }
    }

    /// Feeds the dead-man if the beat is a new one.
    pub fn keep_alive<M: RawMutex>(&mut self, keep_alive: KeepAlive, crossing: &Crossing<M>) {
        if self.last_beat.is_none_or(|last| keep_alive.beat > last) {
            self.last_beat = Some(keep_alive.beat);
            crossing.feed();
        }
    }

    /// Does a numbered command.
    ///
    /// # Errors
    /// The refusal; nothing has changed then.
    pub fn execute<M: RawMutex>(
        &mut self,
        command: &Command,
        crossing: &Crossing<M>,
    ) -> Result<Event, Refusal> {
        match command {
            Command::Arm => self.arm(crossing).map(accepted),
            Command::Disarm => Ok(accepted(crossing.disarm(Stop::Normal))),
            Command::Drive(drive) => self.drive(drive, crossing).map(accepted),
            Command::ClearFaults => {
                let standing =
                    if self.thermal.is_warm() { Faults::NONE.with(Fault::Overheat) } else { Faults::NONE };
                crossing.clear_faults(standing);
                Ok(accepted(crossing.now()))
            }
            Command::TableBegin(header) => {
                let slot = self.active.slot.other();
                if !crossing.slot_is_free(slot) {
                    return Err(Refusal::Busy(Busy::TableInUse));
                }
                let now = crossing.now();
                self.upload = Some(Upload::begin(header, slot, self.timing.sample_rate_hz, now)?);
                Ok(accepted(now))
            }
            Command::TableChunk(chunk) => {
                let now = crossing.now();
                self.upload.as_mut().ok_or(Refusal::NoUpload)?.take(chunk, crossing, now)?;
                Ok(accepted(now))
            }
            Command::TableCommit => self.commit_table(crossing).map(accepted),
            Command::TableAbort => {
                self.upload = None;
                Ok(accepted(crossing.now()))
            }
            Command::TableDigest => Ok(Event::Table(TableReport {
                active: self.table.map(|table| TableHeader {
                    crc: upload::digest(&table, self.active.slot, crossing),
                    ..table
                }),
                staged: self.upload.as_ref().map_or(0, Upload::received),
            })),
            Command::DigestStart(window) => self.start_digest(*window, crossing).map(accepted),
            Command::DigestRead => match crossing.digest() {
                DigestState::None => Err(Refusal::NoDigest),
                DigestState::Waiting(DigestWindow { from, count }) => {
                    Ok(Event::Digest(Digest { from, count, crc: None }))
                }
                DigestState::Done(DigestWindow { from, count }, crc) => {
                    Ok(Event::Digest(Digest { from, count, crc: Some(crc) }))
                }
            },
            Command::Store => self.store(crossing).map(accepted),
            Command::Forget => self.forget(crossing).map(accepted),
            Command::BootloaderToken => {
                self.refuse_unless_leavable(crossing)?;
                Ok(Event::BootloaderToken(self.door.give_token(&self.device.unit, crossing.now())))
            }
            Command::BootloaderEnter(token) => {
                self.refuse_unless_leavable(crossing)?;
                let now = crossing.now();
                self.door.show_token(*token, now, &self.timing)?;
                Ok(accepted(now))
            }
            // The session answers these itself; should one come here, it is as unknown as a new one.
            Command::Hello(_)
            | Command::KeepAlive(_)
            | Command::Status
            | Command::Stop
            | Command::EmergencyStop => Err(Refusal::UnknownMessage { id: command.id() }),
        }
    }

    /// Control-rate work: the thermal model, the drive time, the time-outs.
    pub fn tick<M: RawMutex>(&mut self, crossing: &Crossing<M>) {
        let view = crossing.view();
        let now = view.next;
        self.thermal.advance(now, view.report.energy, self.timing.sample_rate_hz);
        crossing.set_limit(self.thermal.limit_per_mille());
        if self.thermal.is_over() && !view.faults.set().contains(Fault::Overheat) {
            crossing.fault(Fault::Overheat, Stop::Normal);
        }
        let sounds = view.armed && !view.is_silent();
        if sounds && now.saturating_sub(self.user_acted_at) >= self.timing.max_drive {
            crossing.fault(Fault::DriveTime, Stop::Normal);
        }
        if self.upload.as_ref().is_some_and(|upload| upload.is_stale(now, self.timing.staging)) {
            self.upload = None;
        }
        if self.door.is_passed(now, &self.timing) {
            self.system.enter_bootloader();
        }
        crossing.pulse_safety();
    }

    fn arm<M: RawMutex>(&mut self, crossing: &Crossing<M>) -> Result<SampleIndex, Refusal> {
        let view = crossing.view();
        self.refuse_if_unfit(&view)?;
        if view.armed {
            return Ok(view.ready_at.max(view.next));
        }
        // What may be pending while disarmed is a table swap, which sounds nothing.
        if !view.report.silent || view.stopping {
            return Err(Refusal::Busy(Busy::DriveActive));
        }
        self.user_acted_at = view.next;
        Ok(crossing.arm())
    }

    fn refuse_if_unfit(&self, view: &View) -> Result<(), Refusal> {
        if self.boot.safe_mode {
            return Err(Refusal::SafeMode);
        }
        let faults = view.faults.set();
        if faults.is_empty() { Ok(()) } else { Err(Refusal::Faulted { faults }) }
    }

    fn drive<M: RawMutex>(&mut self, drive: &Drive, crossing: &Crossing<M>) -> Result<SampleIndex, Refusal> {
        let view = crossing.view();
        self.refuse_if_unfit(&view)?;
        if !view.armed {
            return Err(Refusal::NotArmed);
        }
        let at = publish(crossing, |view, lead| {
            let earliest = view.next.max(view.ready_at);
            let at = match drive.apply {
                Apply::Next => earliest.saturating_add(lead),
                Apply::At(at) => {
                    let latest = view.next.saturating_add(self.timing.max_apply_ahead);
                    in_range(Field::ApplyAt, earliest, latest, at)?;
                    block_at_or_after(at)
                }
            };
            plan(drive, at, self.active, &view.motion, crossing.slots(), &self.shape, &self.timing)
        })?;
        self.user_acted_at = self.user_acted_at.max(at);
        Ok(at)
    }

    fn commit_table<M: RawMutex>(&mut self, crossing: &Crossing<M>) -> Result<SampleIndex, Refusal> {
        let upload = self.upload.ok_or(Refusal::NoUpload)?;
        if let Err(refusal) = upload.check(crossing) {
            // What is missing may still come; what is wrong stays wrong.
            if !matches!(refusal, Refusal::UploadIncomplete { .. }) {
                self.upload = None;
            }
            return Err(refusal);
        }
        let table = upload.table();
        let at = publish(crossing, |view, lead| {
            let at = view.next.saturating_add(lead);
            plan_swap(at, table, &view.motion, crossing.slots(), &self.shape, &self.timing)
        })?;
        self.table = Some(*upload.header());
        self.active = table;
        self.upload = None;
        Ok(at)
    }

    fn start_digest<M: RawMutex>(
        &self,
        window: DigestWindow,
        crossing: &Crossing<M>,
    ) -> Result<SampleIndex, Refusal> {
        let next = crossing.now();
        let latest = next.saturating_add(self.timing.max_apply_ahead);
        in_range(Field::DigestCount, 1, u64::from(limits::MAX_DIGEST_SAMPLES), u64::from(window.count))?;
        in_range(Field::ApplyAt, next, latest, window.from)?;
        if matches!(crossing.digest(), DigestState::Waiting(_)) {
            return Err(Refusal::Busy(Busy::DigestPending));
        }
        crossing.start_digest(window);
        Ok(window.from)
    }

    fn store<M: RawMutex>(&mut self, crossing: &Crossing<M>) -> Result<SampleIndex, Refusal> {
        self.refuse_unless_storable(crossing)?;
        let header = self.table.ok_or(Refusal::NoTable)?;
        let slot = self.active.slot;
        store::save(&mut self.flash, &header, |index| crossing.slots().knot(slot, index))
            .map_err(|_| Refusal::StoreFailed)?;
        self.stored = StoredConfig::Loaded;
        Ok(crossing.now())
    }

    fn forget<M: RawMutex>(&mut self, crossing: &Crossing<M>) -> Result<SampleIndex, Refusal> {
        self.refuse_unless_storable(crossing)?;
        store::forget(&mut self.flash).map_err(|_| Refusal::StoreFailed)?;
        self.stored = StoredConfig::Empty;
        Ok(crossing.now())
    }

    /// Erasing flash stalls the processor: only when a repeated mid-scale does no harm.
    fn refuse_unless_storable<M: RawMutex>(&self, crossing: &Crossing<M>) -> Result<(), Refusal> {
        if self.flash.slot_len() < store::SLOT_BYTES {
            return Err(Refusal::NotSupported);
        }
        if crossing.view().is_silent() { Ok(()) } else { Err(Refusal::Busy(Busy::DriveActive)) }
    }

    fn refuse_unless_leavable<M: RawMutex>(&self, crossing: &Crossing<M>) -> Result<(), Refusal> {
        if !self.system.has_bootloader() {
            return Err(Refusal::NotSupported);
        }
        let view = crossing.view();
        if view.armed || !view.is_silent() { Err(Refusal::Armed) } else { Ok(()) }
    }
}

/// Makes a motion and hands it over, anew with a later index if the renderer was faster.
fn publish<M: RawMutex>(
    crossing: &Crossing<M>,
    make: impl Fn(&View, u64) -> Result<Motion, Refusal>,
) -> Result<SampleIndex, Refusal> {
    for lead in LEADS {
        let view = crossing.view();
        if view.stopping {
            return Err(Refusal::Busy(Busy::DriveActive));
        }
        if view.pending.is_some() {
            break;
        }
        let motion = make(&view, lead.saturating_mul(BLOCK_SAMPLES))?;
        match crossing.publish(motion, &view) {
            Ok(()) => return Ok(motion.start()),
            Err(NotPublished::Pending) => break,
            Err(NotPublished::Late) => {}
        }
    }
    Err(Refusal::Busy(Busy::CommitPending))
}

fn in_range(field: Field, min: u64, max: u64, got: u64) -> Result<(), Refusal> {
    if (min..=max).contains(&got) {
        return Ok(());
    }
    // An index beyond 2^63 is 730 000 years away.
    let signed = |value| i64::try_from(value).unwrap_or(i64::MAX);
    Err(Refusal::OutOfRange { field, min: signed(min), max: signed(max), got: signed(got) })
}

/// A constant that the protocol carries in 16 bits.
#[expect(clippy::cast_possible_truncation, reason = "block and knots are far below 65 536")]
const fn small(constant: usize) -> u16 {
    constant as u16
}

const fn accepted(at: SampleIndex) -> Event {
    Event::Accepted(Accepted { at })
}

fn cut<const N: usize>(text: &str) -> String<N> {
    let mut short = String::new();
    for c in text.chars() {
        if short.push(c).is_err() {
            break;
        }
    }
    short
}
