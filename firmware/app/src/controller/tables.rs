//! Tables: an uploaded table comes into force; the table in force is stored in flash or removed from it.

use embassy_sync::blocking_mutex::raw::RawMutex;
use slipline_protocol::event::StoredConfig;
use slipline_protocol::refusal::{Busy, Refusal};
use slipline_protocol::units::SampleIndex;

use super::Controller;
use super::drive::publish;
use crate::mailbox::Mailbox;
use crate::ports::{FlashPages, System};
use crate::store;

impl<F: FlashPages, S: System> Controller<F, S> {
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
        let at = publish(mailbox, &self.is_outrun, |view, lead| {
            let at = view.next.saturating_add(lead);
            self.planner(mailbox, is_stopped).swap(at, table, &view.motion)
        })?;
        self.table = Some(header);
        self.active = table;
        self.upload = None;
        Ok(at)
    }

    pub(super) fn store<M: RawMutex>(&mut self, mailbox: &Mailbox<M>) -> Result<SampleIndex, Refusal> {
        self.refuse_unless_storable(mailbox)?;
        let header = self.table.ok_or(Refusal::NoTable)?;
        let slot = self.active.slot;
        store::save(&mut self.flash, &header, |index| mailbox.slots().knot(slot, index))
            .map_err(|_| Refusal::StoreFailed)?;
        self.stored = StoredConfig::Loaded;
        Ok(mailbox.now())
    }

    pub(super) fn forget<M: RawMutex>(&mut self, mailbox: &Mailbox<M>) -> Result<SampleIndex, Refusal> {
        self.refuse_unless_storable(mailbox)?;
        store::forget(&mut self.flash).map_err(|_| Refusal::StoreFailed)?;
        self.stored = StoredConfig::Empty;
        Ok(mailbox.now())
    }

    /// Erasing flash stalls the processor: only when a repeated mid-scale does no harm.
    fn refuse_unless_storable<M: RawMutex>(&self, mailbox: &Mailbox<M>) -> Result<(), Refusal> {
        if self.flash.slot_len() < store::SLOT_BYTES {
            return Err(Refusal::NotSupported);
        }
        if mailbox.view().is_silent() { Ok(()) } else { Err(Refusal::Busy(Busy::DriveActive)) }
    }
}
