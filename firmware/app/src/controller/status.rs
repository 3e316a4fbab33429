//! The device's identity and status.

use embassy_sync::blocking_mutex::raw::RawMutex;
use heapless::String;
use slipline_dds::bank::{BLOCK, TONES};
use slipline_protocol::event::{Counters, Identity, Maintenance, State, Status, Wear};
use slipline_protocol::limits;
use slipline_protocol::units::{SampleIndex, per_mille};
use slipline_protocol::version::Version;

use super::Controller;
use crate::mailbox::Mailbox;
use crate::mailbox::View;
use crate::ports::{FlashPages, FlashSlot, System};
use crate::safety::foldback::Foldback;
use crate::store;

/// Bits of a DAC code.
const DAC_BITS: u8 = 12;

impl<F: FlashPages, S: System> Controller<'_, F, S> {
    /// The device's identity, the answer to a hello.
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

    /// The device's status; `counters` are the link's, to which the renderer's are added.
    pub fn status<M: RawMutex>(&self, mailbox: &Mailbox<M>, counters: Counters) -> Status {
        let view = mailbox.view();
        let first = view.faults.first();
        // The limit in force; before the first block, the one that will be.
        let foldback = view.report.foldback.unwrap_or(Foldback::first(self.thermal.limit_per_mille()));
        Status {
            state: self.state(&view),
            faults: view.faults.set(),
            first_fault: first.map(|(fault, _)| fault),
            first_fault_at: first.map_or(0, |(_, at)| at),
            now: view.next,
            sum_per_mille: per_mille(view.report.sum),
            heat_per_mille: self.thermal.per_mille(),
            foldback_per_mille: foldback.per_mille,
            foldback_before_per_mille: foldback.before_per_mille,
            foldback_changes: foldback.changes,
            table_crc: self.table.map_or(0, |table| table.crc),
            counters: Counters {
                underruns: view.report.underruns,
                clips: view.report.clips,
                max_cycles: view.report.max_cycles,
                ..counters
            },
        }
    }

    /// The data of maintenance: wear of the flash, brown-out guard.
    pub(super) fn maintenance(&self) -> Maintenance {
        Maintenance {
            erasures: self.erasures,
            // There are two slots.
            erasures_promised: self.flash.endurance().saturating_mul(2),
            brown_out_guarded: self.system.is_brown_out_guarded(),
        }
    }

    /// What [`Command::Maintenance`](slipline_protocol::Command::Maintenance) leaves out.
    pub(super) fn wear(&mut self, now: SampleIndex) -> Wear {
        let places = if self.flash.slot_len(FlashSlot::ProfileA) < store::SLOT_BYTES { 0 } else { 2 };
        Wear {
            profile_erasures: self.profile_erasures,
            profile_erasures_promised: self.flash.endurance().saturating_mul(places),
            stores_left: self.stores.left(now, &self.timing),
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
        } else if view.waits() {
            State::Waiting
        } else if view.is_silent() {
            State::Armed
        } else {
            State::Driving
        }
    }
}

/// A constant that the protocol carries in 16 bits.
#[expect(clippy::cast_possible_truncation, reason = "block and knots are far below 65 536")]
const fn small(constant: usize) -> u16 {
    constant as u16
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
