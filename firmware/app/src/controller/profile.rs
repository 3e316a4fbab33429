//! The actuator's profile: read at the start, written with the user's hand on the board, in force for every motion.

use embassy_sync::blocking_mutex::raw::RawMutex;
use slipline_protocol::command::ProfileSetting;
use slipline_protocol::event::{Event, StoredConfig};
use slipline_protocol::refusal::{Busy, Refusal};
use slipline_protocol::units::SampleIndex;

use super::tables::{refuse_unless_muted, unchanged};
use super::{Controller, accepted};
use crate::mailbox::Mailbox;
use crate::motion::Motion;
use crate::ports::{FlashPages, FlashSlot, System, UserButton};
use crate::safety::bounds;
use crate::slots::TableRef;
use crate::store;
use crate::upload::Upload;

impl<F: FlashPages, S: System> Controller<'_, F, S> {
    /// Reads the profile and puts it in force, and latches a fault if something of it was lost. Call it after the table is
    /// loaded: the profile's limits need the table's travels.
    #[inline(never)]
    pub(super) fn load_profile<M: RawMutex>(&mut self, mailbox: &Mailbox<M>) {
        let (profile, mut stored) = store::load_profile(&mut self.flash);
        self.profile_erasures = store::erasures(&mut self.flash, FlashSlot::ProfileA);
        let tables = self.tables();
        if self.bounds.set(profile, tables, mailbox.slots()).is_err() {
            stored = StoredConfig::Damaged;
        }
        self.bounds.found(stored);
        self.apply_profile();
        if let Some(fault) = self.bounds.fault() {
            mailbox.latch(fault);
        }
    }

    /// Refuses what a host alone must not do: the board's user button is pressed, and was not for too long. A guard against mistakes,
    /// not a lock: anyone who can press the button can do it.
    pub(super) fn refuse_without_hand<M: RawMutex>(&self, mailbox: &Mailbox<M>) -> Result<(), Refusal> {
        let is_pressed = self.system.board().user_button == UserButton::Pressed;
        let is_fresh = |since: SampleIndex| mailbox.now().saturating_sub(since) < self.timing.hand;
        if is_pressed && mailbox.hand().since.is_some_and(is_fresh) {
            Ok(())
        } else {
            Err(Refusal::HoldButton)
        }
    }

    fn apply_profile(&mut self) {
        self.thermal.set_constants(self.bounds.coil());
        self.system.fit_stop_input(self.bounds.has_stop_input());
    }

    /// The table in force, and the one that is being uploaded.
    pub(super) fn tables(&self) -> [TableRef; 2] {
        let coming = TableRef { slot: self.active.slot.other(), knots: 0 };
        [self.active, self.upload.as_ref().map_or(coming, Upload::written)]
    }

    #[inline(never)]
    pub(super) fn write_profile<M: RawMutex>(
        &mut self,
        ProfileSetting { profile }: &ProfileSetting,
        mailbox: &Mailbox<M>,
    ) -> Result<Event, Refusal> {
        if self.flash.slot_len(FlashSlot::ProfileA) < store::SLOT_BYTES {
            return Err(Refusal::NotSupported);
        }
        profile.as_ref().map_or(Ok(()), bounds::check)?;
        if !mailbox.view().is_silent() {
            return Err(Refusal::Busy(Busy::DriveActive));
        }
        refuse_unless_muted(mailbox)?;
        self.refuse_without_hand(mailbox)?;
        let is_kept = store::holds_profile(&mut self.flash, profile.as_ref());
        if !is_kept {
            store::save_profile(&mut self.flash, profile.as_ref()).map_err(|_| Refusal::StoreFailed)?;
        }
        let tables = self.tables();
        self.bounds.set(profile.clone(), tables, mailbox.slots())?;
        self.profile_erasures = store::erasures(&mut self.flash, FlashSlot::ProfileA);
        self.bounds.found(if profile.is_some() { StoredConfig::Loaded } else { StoredConfig::Empty });
        self.apply_profile();
        Ok(if is_kept { unchanged(mailbox.now()) } else { accepted(mailbox.now()) })
    }

    /// Checks a motion against what the session's host and the actuator's profile allow. A chord's sum is not checked, whose peak is
    /// proven.
    pub(super) fn check_motion<M: RawMutex>(
        &self,
        motion: &Motion,
        is_proven: bool,
        mailbox: &Mailbox<M>,
    ) -> Result<(), Refusal> {
        let slots = mailbox.slots();
        self.excursion.check(motion, slots)?;
        if !is_proven {
            self.bounds.check_sum(motion, slots)?;
        }
        self.bounds.travel.check(motion, slots)
    }
}
