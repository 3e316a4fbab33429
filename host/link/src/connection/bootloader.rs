//! A device that was sent into its ROM bootloader: does it stay away, or is it back with the same program?
//!
//! It is back if its ROM has restarted it. The F407's ROM does so when it misses the crystal as it measures that (5 of 12
//! times on one board: CircuitPython's issue 11270): it is asked again. A G474, with two banks, may execute a bank that holds
//! a program, whatever the host requests (QMK's pull request 8778): asking again does not help there. A request that stayed in the
//! device's RAM would help neither: the restart by DFU's leave would end in the ROM, too.

use super::{Connection, Phase, SEEK_PERIOD};
use crate::log::Severity;
use crate::refusal::Refusal;
use crate::request::{Outcome, Request, Ticket};
use crate::transport::Opener;
use slipline_protocol::event::Identity;
use slipline_protocol::units::SampleIndex;
use std::sync::Arc;
use std::time::Duration;

/// A device that has not answered a hello for this long stays away. A restarted one is back on the bus in 0.2 s.
const STAYS_AWAY: Duration = Duration::from_secs(3);
/// How often a board that may enter its ROM the next time is asked again.
const ASKED_AGAIN: u32 = 5;
/// The board whose ROM may miss the crystal.
const MISSES_CRYSTAL: &str = "STM32F4DISCOVERY";

/// A device that has accepted to enter its bootloader.
pub(super) struct BootloaderEntry {
    ticket: Option<Ticket>,
    /// The index of its last sample before, for the outcome.
    at: SampleIndex,
    identity: Arc<Identity>,
    asked_again: u32,
    /// When it is known to stay away; `None` while it is back and asked again.
    until: Option<Duration>,
}

impl<O: Opener> Connection<O> {
    /// The device has accepted: closes the port, and looks whether the device comes back.
    pub(super) fn enter_bootloader(&mut self, ticket: Option<Ticket>, at: SampleIndex, now: Duration) {
        let before = self.entry.take().filter(|entry| entry.ticket == ticket);
        let identity = self.recorder.view.device.identity.clone();
        let is_leaving = self.leave.is_some();
        self.close(now);
        // A simulated device has no ROM. Another port may have been opened now.
        let is_watched = !is_leaving && matches!(self.phase, Phase::Closed);
        match identity.filter(|identity| is_watched && !identity.simulated) {
            Some(identity) => {
                let asked_again = before.map_or(0, |entry| entry.asked_again + 1);
                let until = Some(now + STAYS_AWAY);
                self.entry = Some(BootloaderEntry { ticket, at, identity, asked_again, until });
                self.phase = Phase::Seeking { next: now + SEEK_PERIOD };
            }
            None => self.recorder.finish(ticket, Outcome::Done { at }),
        }
    }

    /// When a device that has not come back is known to stay away.
    pub(super) fn entry_deadline(&self) -> Option<Duration> {
        self.entry.as_ref().and_then(|entry| entry.until)
    }

    /// Ends the search: the device stays away, or the user wants something else.
    pub(super) fn end_entry(&mut self) {
        if self.entry_deadline().is_some()
            && let Some(entry) = self.entry.take()
        {
            self.shut(&Outcome::NotConnected);
            self.recorder.forget_device(None);
            self.recorder.finish(entry.ticket, Outcome::Done { at: entry.at });
        }
    }

    /// Evaluates who answers, or that nobody does.
    pub(super) fn watch_entry(&mut self, now: Duration) {
        let Some(until) = self.entry_deadline() else { return };
        let identity = self.recorder.view.device.identity.clone();
        let (Some(identity), Phase::Open(open)) = (identity, &mut self.phase) else {
            if now >= until {
                self.end_entry();
            }
            return;
        };
        let Some(mut entry) = self.entry.take() else { return };
        if (identity.unit, &identity.build) != (entry.identity.unit, &entry.identity.build) {
            // It was flashed, or another device has come to its port.
            self.recorder.finish(entry.ticket, Outcome::Done { at: entry.at });
        } else if let Some(ticket) = entry.ticket
            && entry.asked_again < ASKED_AGAIN
            && identity.board == MISSES_CRYSTAL
        {
            self.recorder.log(Severity::Warning, "The device has restarted instead: asking again.");
            open.queue.request(ticket, Request::Bootloader, &mut self.recorder, now);
            entry.until = None;
            self.entry = Some(entry);
        } else {
            self.recorder.finish(entry.ticket, Outcome::Refused(Refusal::NotInBootloader));
        }
    }
}
