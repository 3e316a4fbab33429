//! Tables: an uploaded table comes into force; the table in force is stored in flash or removed from it.

use embassy_sync::blocking_mutex::raw::RawMutex;
use slipline_protocol::event::{Accepted, AcceptedUntil, Event, Fault, StoredConfig};
use slipline_protocol::refusal::{Busy, Refusal};
use slipline_protocol::units::SampleIndex;

use super::drive::publish;
use super::{Controller, accepted};
use crate::mailbox::Mailbox;
use crate::ports::{FlashPages, FlashSlot, System};
use crate::slots::TableRef;
use crate::store;

// What makes a motion, and what reads and writes the flash, is never inlined: it would lie on the stack under every other command.
impl<F: FlashPages, S: System> Controller<'_, F, S> {
    #[inline(never)]
    pub(super) fn commit_table<M: RawMutex>(
        &mut self,
        is_stopped: &mut dyn FnMut() -> bool,
        mailbox: &Mailbox<M>,
    ) -> Result<SampleIndex, Refusal> {
        let upload = self.upload.as_ref().ok_or(Refusal::NoUpload)?;
        let (table, header) = (upload.table(), *upload.header());
        if let Err(refusal) = upload.check() {
            // A missing chunk may still come; a wrong table stays wrong.
            if !matches!(refusal, Refusal::UploadIncomplete { .. }) {
                self.upload = None;
            }
            return Err(refusal);
        }
        let AcceptedUntil { at, .. } = publish(mailbox, &self.lead, Mailbox::publish_swap, |view, lead| {
            if view.waits() {
                // It was planned by the table in force.
                return Err(Refusal::Busy(Busy::CommitPending));
            }
            let at = view.next.saturating_add(lead);
            let motion = self.planner(mailbox, is_stopped).swap(at, table, &view.motion)?;
            self.check_motion(&motion, false, mailbox)?;
            Ok(motion)
        })?;
        self.end_hold(mailbox);
        self.table = Some(header);
        self.active = table;
        self.upload = None;
        Ok(at)
    }

    /// Loads the stored table, and latches a fault if something of the store was lost.
    #[inline(never)]
    pub(super) fn load<M: RawMutex>(&mut self, mailbox: &Mailbox<M>) {
        let slot = self.active.slot.other();
        let knot = |index| mailbox.slots().knot(slot, index);
        let loaded = store::load(&mut self.flash, self.timing.sample_rate_hz, |index, knot| {
            mailbox.write_knot(slot, index, knot);
        })
        .and_then(|header| {
            if store::is_sound(&header, knot) { Ok(header) } else { Err(StoredConfig::Damaged) }
        });
        let has_lost_a_copy = store::has_lost_a_copy(&mut self.flash, FlashSlot::A);
        self.erasures = store::erasures(&mut self.flash, FlashSlot::A);
        self.stored = match loaded {
            Ok(header) => {
                self.table = Some(header);
                self.active = TableRef { slot, knots: header.knots };
                if has_lost_a_copy { StoredConfig::FellBack } else { StoredConfig::Loaded }
            }
            // What was lost may have been a table.
            Err(StoredConfig::Empty) if has_lost_a_copy => StoredConfig::Damaged,
            Err(other) => other,
        };
        match self.stored {
            StoredConfig::Damaged => mailbox.latch(Fault::StoreDamaged),
            StoredConfig::FellBack => mailbox.latch(Fault::StoreFellBack),
            StoredConfig::Empty | StoredConfig::Loaded | StoredConfig::WrongVersion => {}
        }
    }

    #[inline(never)]
    pub(super) fn store<M: RawMutex>(&mut self, mailbox: &Mailbox<M>) -> Result<Event, Refusal> {
        self.refuse_unless_silent(mailbox)?;
        let header = self.table.ok_or(Refusal::NoTable)?;
        refuse_unless_muted(mailbox)?;
        let slot = self.active.slot;
        let knot = |index| mailbox.slots().knot(slot, index);
        if store::holds(&mut self.flash, &header, knot) {
            return Ok(unchanged(mailbox.now()));
        }
        self.take_store(mailbox)?;
        let saved = store::save(&mut self.flash, &header, knot);
        self.erasures = store::erasures(&mut self.flash, FlashSlot::A);
        saved.map_err(|_| Refusal::StoreFailed)?;
        self.stored = StoredConfig::Loaded;
        Ok(accepted(mailbox.now()))
    }

    #[inline(never)]
    pub(super) fn forget<M: RawMutex>(&mut self, mailbox: &Mailbox<M>) -> Result<Event, Refusal> {
        self.refuse_unless_silent(mailbox)?;
        refuse_unless_muted(mailbox)?;
        if store::holds_nothing(&mut self.flash) {
            return Ok(unchanged(mailbox.now()));
        }
        self.take_store(mailbox)?;
        let forgotten = store::forget(&mut self.flash);
        self.erasures = store::erasures(&mut self.flash, FlashSlot::A);
        forgotten.map_err(|_| Refusal::StoreFailed)?;
        self.stored = StoredConfig::Empty;
        Ok(accepted(mailbox.now()))
    }

    fn take_store<M: RawMutex>(&mut self, mailbox: &Mailbox<M>) -> Result<(), Refusal> {
        self.stores.take(mailbox.now(), &self.timing).map_err(|wait_s| Refusal::StoresSpent { wait_s })
    }

    fn refuse_unless_silent<M: RawMutex>(&self, mailbox: &Mailbox<M>) -> Result<(), Refusal> {
        if self.flash.slot_len(FlashSlot::A) < store::SLOT_BYTES {
            return Err(Refusal::NotSupported);
        }
        if mailbox.view().is_silent() { Ok(()) } else { Err(Refusal::Busy(Busy::DriveActive)) }
    }
}

/// Erasing flash stalls the processor for seconds, in which no stop is served: only with the amplifier off, where a
/// repeated mid-scale is not felt.
pub(super) fn refuse_unless_muted<M: RawMutex>(mailbox: &Mailbox<M>) -> Result<(), Refusal> {
    let view = mailbox.view();
    if view.armed {
        Err(Refusal::DisarmFirst)
    } else if !view.report.muted {
        // Some blocks of mid-scale are on their way before it is switched off.
        Err(Refusal::Busy(Busy::DriveActive))
    } else {
        Ok(())
    }
}

pub(super) const fn unchanged(at: SampleIndex) -> Event {
    Event::Unchanged(Accepted { at })
}
