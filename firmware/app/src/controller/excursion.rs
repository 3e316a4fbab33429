//! The command that limits the actuator's travel.

use embassy_sync::blocking_mutex::raw::RawMutex;
use slipline_protocol::Event;
use slipline_protocol::command::TravelSetting;
use slipline_protocol::refusal::{Busy, Refusal};

use super::Controller;
use crate::mailbox::Mailbox;
use crate::ports::{FlashPages, System};

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
        let tables = self.tables();
        self.excursion.set(setting.limit, tables, mailbox.slots())?;
        Ok(self.travel_limit())
    }

    pub(super) fn travel_limit(&self) -> Event {
        Event::TravelLimit(TravelSetting { limit: self.excursion.limit() })
    }
}
