//! The command that limits the actuator's travel.

use embassy_sync::blocking_mutex::raw::RawMutex;
use slipline_protocol::Event;
use slipline_protocol::command::TravelSetting;
use slipline_protocol::refusal::{Busy, Refusal};

use super::Controller;
use crate::mailbox::Mailbox;
use crate::ports::{FlashPages, System};
use crate::slots::TableRef;
use crate::upload::Upload;

impl<F: FlashPages, S: System> Controller<'_, F, S> {
    /// Puts a limit in force, or none. What sounds was judged by the limit before, so it must have ended. Judging two
    /// tables takes the thread some milliseconds, in which there is nothing to stop.
    pub(super) fn set_travel_limit<M: RawMutex>(
        &mut self,
        setting: TravelSetting,
        mailbox: &Mailbox<M>,
    ) -> Result<Event, Refusal> {
        if !mailbox.view().is_silent() {
            return Err(Refusal::Busy(Busy::DriveActive));
        }
        let coming = TableRef { slot: self.active.slot.other(), knots: 0 };
        let coming = self.upload.as_ref().map_or(coming, Upload::written);
        self.excursion.set(setting.limit, [self.active, coming], mailbox.slots())?;
        Ok(self.travel_limit())
    }

    pub(super) fn travel_limit(&self) -> Event {
        Event::TravelLimit(TravelSetting { limit: self.excursion.limit() })
    }
}
