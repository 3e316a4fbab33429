//! Faults on purpose, by which a board shows that each of them mutes. They are reported as any other, and do not count towards safe
//! mode: [`decide`](crate::safety::boot::decide).

use embassy_sync::blocking_mutex::raw::RawMutex;
use slipline_protocol::board::{FaultOrder, FaultTrial, PinLevel};
use slipline_protocol::refusal::Refusal;
use slipline_protocol::units::SampleIndex;

use super::Controller;
use crate::mailbox::{Mailbox, View};
use crate::ports::{FlashPages, System};

impl<F: FlashPages, S: System> Controller<'_, F, S> {
    /// Gives the token of the second step, and reports how the last ordered fault ended.
    #[inline(never)]
    pub(super) fn fault_token<M: RawMutex>(&mut self, mailbox: &Mailbox<M>) -> Result<FaultTrial, Refusal> {
        if self.system.mute_level() == PinLevel::NoPin {
            return Err(Refusal::NotSupported);
        }
        let token = self.fault_order.give_token(&self.device.unit, mailbox.now());
        Ok(FaultTrial { token, last: self.system.fault_end() })
    }

    /// Orders a fault, where the mute pin is high and nothing sounds: else it would not show that the fault mutes.
    #[inline(never)]
    pub(super) fn order_fault<M: RawMutex>(
        &mut self,
        FaultOrder { fault, token }: FaultOrder,
        mailbox: &Mailbox<M>,
    ) -> Result<SampleIndex, Refusal> {
        self.refuse_unless_unmuted(&mailbox.view(), mailbox)?;
        if self.system.mute_level() != PinLevel::High {
            return Err(Refusal::NotSupported);
        }
        let now = mailbox.now();
        self.fault_order.show_token(token, now, &self.timing)?;
        self.ordered_fault = fault;
        Ok(now)
    }

    /// Fails as ordered, unless something has ended the state that the order needs.
    pub(super) fn fail_if_due<M: RawMutex>(&mut self, view: &View, mailbox: &Mailbox<M>) {
        if self.fault_order.is_passed(view.next, &self.timing)
            && self.refuse_unless_unmuted(view, mailbox).is_ok()
        {
            self.system.fail(self.ordered_fault);
        }
    }
}
