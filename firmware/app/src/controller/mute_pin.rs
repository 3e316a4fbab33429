//! The mute pin, read back and tried; and the DAC, stopped for a moment on the bench.

use embassy_sync::blocking_mutex::raw::RawMutex;
use slipline_protocol::board::{MutePin, MuteStep, MuteTrial, PinLevel};
use slipline_protocol::refusal::{Busy, Refusal};
use slipline_protocol::units::SampleIndex;

use super::Controller;
use crate::mailbox::{Mailbox, Stop, View};
use crate::ports::{FlashPages, System};

impl<F: FlashPages, S: System> Controller<'_, F, S> {
    /// Reads the pin; takes it low, in a trial, and disarms then: what has muted the amplifier must not let it on again.
    ///
    /// Never inlined: the view would lie on the stack under every other command.
    #[inline(never)]
    pub(super) fn mute_pin<M: RawMutex>(
        &mut self,
        MuteStep { trial }: MuteStep,
        mailbox: &Mailbox<M>,
    ) -> Result<MutePin, Refusal> {
        let (is_on_bench, level) = (mailbox.is_on_bench(), self.system.mute_level());
        let read = MutePin { level, is_on_bench, fall: None };
        if trial == MuteTrial::Read {
            return Ok(read);
        }
        if level == PinLevel::NoPin {
            return Err(Refusal::NotSupported);
        }
        self.refuse_unless_unmuted(&mailbox.view(), mailbox)?;
        let fall = if level == PinLevel::High { self.system.try_mute(trial) } else { None };
        mailbox.disarm(Stop::Normal);
        Ok(MutePin { fall, ..read })
    }

    /// Refuses unless the amplifier has been switched on and nothing sounds.
    pub(super) fn refuse_unless_unmuted<M: RawMutex>(
        &self,
        view: &View,
        mailbox: &Mailbox<M>,
    ) -> Result<(), Refusal> {
        self.refuse_unless_armed(view.armed && !mailbox.is_on_bench(), view.faults)?;
        // The amplifier is switched on at `ready_at`; nothing may begin to sound meanwhile.
        if view.next <= view.ready_at || !view.is_silent() || view.stopping || view.waits() {
            return Err(Refusal::Busy(Busy::DriveActive));
        }
        Ok(())
    }

    /// Stops the DAC's DMA, on the bench alone: there nothing moves the plate.
    #[inline(never)]
    pub(super) fn stall<M: RawMutex>(&mut self, mailbox: &Mailbox<M>) -> Result<SampleIndex, Refusal> {
        let view = mailbox.view();
        self.refuse_unless_armed(view.armed && mailbox.is_on_bench(), view.faults)?;
        if self.system.stall() { Ok(mailbox.now()) } else { Err(Refusal::NotSupported) }
    }
}
