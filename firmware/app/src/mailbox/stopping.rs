//! How the thread side stops the drive.
//!
//! A stop begins with the next block. The block before it may have been rendered already while it still waits to be
//! played: it sounds for up to two blocks more. So a stop *at once* wakes the renderer, which lets the ramp begin in that
//! block if the DAC still takes a change of it. Where the ramp begins is known only then: the answer to the host reads it
//! by [`Mailbox::stopped_at`], which settles it.

use embassy_sync::blocking_mutex::raw::RawMutex;
use slipline_protocol::event::Fault;
use slipline_protocol::units::SampleIndex;

use super::shared::Shared;
use super::{Mailbox, Stop};
use crate::timing::BLOCK_SAMPLES;

impl<M: RawMutex> Mailbox<M> {
    /// Orders a ramp to silence, drops what is pending, and returns the index at which the ramp begins.
    pub fn stop(&self, stop: Stop) -> SampleIndex {
        self.shared.lock(|shared| shared.order(stop))
    }

    /// As [`Mailbox::stop`], but the ramp may begin in the block that was rendered last: [`Mailbox::stopped_at`] returns
    /// its index.
    pub fn stop_at_once(&self, stop: Stop) {
        self.shared.lock(|shared| shared.order_at_once(stop));
        self.stopped.signal(());
    }

    /// Where the last stop at once takes effect. One that the renderer has not taken by now begins with the next block.
    pub fn stopped_at(&self) -> SampleIndex {
        self.shared.lock(|shared| {
            shared.may_revise.set(false);
            shared.stopped_at.get()
        })
    }

    /// Orders a ramp to silence and then the mute; no drive begins until armed again.
    pub fn disarm(&self, stop: Stop) -> SampleIndex {
        self.shared.lock(|shared| {
            shared.armed.set(false);
            shared.order(stop)
        })
    }

    /// Latches a fault and disarms, with a ramp.
    pub fn fault(&self, fault: Fault, stop: Stop) -> SampleIndex {
        let at = self.disarm(stop);
        self.latch(fault);
        at
    }

    /// As [`Mailbox::fault`], at once.
    pub fn fault_at_once(&self, fault: Fault, stop: Stop) {
        self.shared.lock(|shared| {
            shared.armed.set(false);
            shared.order_at_once(stop);
        });
        self.latch(fault);
        self.stopped.signal(());
    }
}

impl Shared {
    /// A ramp to silence that begins with the next block, whose index is returned.
    fn order(&self, stop: Stop) -> SampleIndex {
        self.pending.set(None);
        self.may_revise.set(false);
        let next = self.next.get();
        // With what was pending gone, silence stays silence: there is nothing to ramp. The motion is asked, not the
        // report, which lags: the block that is being rendered may have begun to sound.
        if !self.outline().is_silent_from(next.saturating_sub(BLOCK_SAMPLES)) {
            self.stop.set(Some(stop.quicker(self.stop.get())));
        }
        next
    }

    fn order_at_once(&self, stop: Stop) {
        self.stopped_at.set(self.order(stop));
        self.may_revise.set(self.stop.get().is_some());
    }
}
