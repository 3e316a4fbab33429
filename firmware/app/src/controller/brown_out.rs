//! The level of the brown-out reset: written once per board, into the chip's option bytes.
//!
//! A wrong word of option bytes may lock the chip for ever, and a power cut inside the write costs the program on some chips. So it is
//! written where nothing is known that could go wrong, and only with a hand on the board.

use embassy_sync::blocking_mutex::raw::RawMutex;
use slipline_protocol::board::{BrownOut, BrownOutOrder};
use slipline_protocol::refusal::{Busy, Field, Refusal};

use super::Controller;
use super::tables::refuse_unless_muted;
use crate::mailbox::{Mailbox, View};
use crate::ports::{FlashPages, System};
use crate::range::in_range;

/// The byte of a chip without read protection, on all chips that are supported (RDP in the reference manuals).
const UNPROTECTED: u64 = 0xaa;
/// The least reference voltage, in mV: above every threshold that a board needs, by more than the error of the measurement.
const REFERENCE_MV: u64 = 2900;

impl<F: FlashPages, S: System> Controller<'_, F, S> {
    #[inline(never)]
    pub(super) fn brown_out<M: RawMutex>(
        &mut self,
        BrownOutOrder { is_written }: BrownOutOrder,
        mailbox: &Mailbox<M>,
    ) -> Result<BrownOut, Refusal> {
        let found = self.system.brown_out().ok_or(Refusal::NotSupported)?;
        if !is_written || found.level >= found.needed {
            return Ok(found);
        }
        if !mailbox.view().is_silent() {
            return Err(Refusal::Busy(Busy::DriveActive));
        }
        refuse_unless_muted(mailbox)?;
        in_range(Field::ReadProtection, UNPROTECTED, UNPROTECTED, found.read_protection.into())?;
        let reference_mv = self.system.analogue().reference_mv;
        in_range(Field::ReferenceVoltage, REFERENCE_MV, u16::MAX.into(), reference_mv.into())?;
        self.refuse_without_hand(mailbox)?;
        self.system.raise_brown_out_level().map_err(|_| Refusal::StoreFailed)?;
        self.restart_due = Some(mailbox.now());
        Ok(BrownOut { restarts: true, ..self.system.brown_out().unwrap_or(found) })
    }

    /// Restarts the device with its new level, two transmit time-outs after the write: the reply goes out first. It does so in whatever
    /// session comes meanwhile.
    pub(super) fn restart_if_due(&mut self, view: &View) {
        let is_due = |since| view.next.saturating_sub(since) >= self.timing.transmit.saturating_mul(2);
        if self.restart_due.is_some_and(is_due) && !view.armed && view.is_silent() {
            self.restart_due = None;
            self.system.restart();
        }
    }
}
