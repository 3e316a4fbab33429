//! The simulated device in real time.
//!
//! The device sends only replies, and its samples are known from the mirror. So a host cannot distinguish a
//! device that renders its samples in time from one that renders them at the next command. This one renders
//! at the next command: it needs no thread and no timer, and at rest it works only for the keep-alives.
//!
//! Where a host has sent it into its bootloader it restarts, as a board that is not flashed there.

use super::device::SimulatedDevice;
use crate::clock::Clock;
use crate::transport::{Transport, Waker, read_received};
use slipline_app::BLOCK;
use slipline_protocol::event::ResetCause;
use slipline_protocol::units::SampleIndex;
use std::io;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

/// Longest time that is rendered at once. After a longer pause between commands (the computer slept) the
/// device skips the rest. Two seconds include the dead-man, which needs one second and its ramp; further
/// cooling of the coil is neglected.
const LONGEST_CATCH_UP: Duration = Duration::from_secs(2);

/// A rendering that takes less is never too slow: the clock may be coarse, and the system may do other things.
const NOTABLE: Duration = Duration::from_millis(100);

/// A simulated device and its present time.
pub struct RealtimeDevice {
    device: SimulatedDevice,
    clock: Clock,
    /// The clock's time when the device was started.
    since: Duration,
    /// Blocks rendered since then.
    blocks: u64,
}

impl RealtimeDevice {
    /// Starts a device's time now, by this clock.
    #[must_use]
    pub fn new(device: SimulatedDevice, clock: Clock) -> Self {
        let since = clock();
        Self { device, clock, since, blocks: 0 }
    }

    /// Raises its trigger input briefly.
    pub fn raise_trigger(&mut self) {
        self.catch_up();
        self.device.raise_trigger();
    }

    /// Presses its user button, or lets it go.
    pub fn press_button(&mut self, is_pressed: bool) {
        self.catch_up();
        self.device.press_button(is_pressed);
    }

    /// Opens or closes the stop input, see [`SimulatedDevice::open_stop_input`].
    pub fn open_stop_input(&mut self, is_open: bool) {
        self.catch_up();
        self.device.open_stop_input(is_open);
    }

    /// Whether a drive waits for its trigger input.
    #[must_use]
    pub fn waits_for_trigger(&self) -> bool {
        self.device.waits_for_trigger()
    }

    /// The index of the next code to leave for the DAC, at the last command or trigger.
    #[must_use]
    pub const fn now(&self) -> SampleIndex {
        self.device.now()
    }

    /// Renders what is due, which the next command would render otherwise.
    pub fn catch_up(&mut self) {
        let rate = u64::from(self.device.sample_rate_hz());
        let blocks_in =
            |time: Duration| (time.as_micros() as u64).saturating_mul(rate) / (1_000_000 * BLOCK as u64);
        let began = (self.clock)();
        let due = blocks_in(began.saturating_sub(self.since)).saturating_sub(self.blocks);
        let rendered = due.min(blocks_in(LONGEST_CATCH_UP));
        self.device.advance(rendered, |_| {});
        self.blocks += due;
        // What senses its plate may take longer than the time that it renders, on a slow computer. The device would owe
        // more at each command, and obey a stop later and later; so its time stands still meanwhile.
        let took = (self.clock)().saturating_sub(began);
        if took > NOTABLE && blocks_in(took) > rendered {
            self.blocks += blocks_in(took);
        }
        if self.device.is_in_bootloader() {
            // Nothing is flashed, so the chip starts the same image again.
            self.device.restart(ResetCause::Software);
        }
    }
}

/// The line to a simulated device.
pub struct RealtimeLine {
    device: Arc<Mutex<RealtimeDevice>>,
    received: Vec<u8>,
    waker: Waker,
}

impl RealtimeLine {
    /// A line to this device; `waker` is called when it has replied.
    #[must_use]
    pub const fn new(device: Arc<Mutex<RealtimeDevice>>, waker: Waker) -> Self {
        Self { device, received: Vec::new(), waker }
    }

    /// Passes bytes to the device and appends its replies to `replies`.
    pub fn exchange(&mut self, bytes: &[u8], replies: &mut Vec<u8>) {
        let mut paced = self.device.lock().unwrap_or_else(PoisonError::into_inner);
        paced.catch_up();
        paced.device.feed(bytes);
        paced.device.take(replies);
    }
}

impl Transport for RealtimeLine {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        read_received(&mut self.received, buffer)
    }

    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let mut received = std::mem::take(&mut self.received);
        self.exchange(bytes, &mut received);
        self.received = received;
        if !self.received.is_empty() {
            self.waker.wake();
        }
        Ok(bytes.len())
    }
}

#[cfg(test)]
mod tests {
    use super::super::Options;
    use super::*;

    /// The device's time in ms after commands, by a clock that is read at its start, and before and after each rendering.
    fn device_ms(clock_ms: &'static [u64]) -> u64 {
        let read = Mutex::new(clock_ms.iter());
        let clock: Clock = Arc::new(move || Duration::from_millis(*read.lock().unwrap().next().unwrap()));
        let mut paced = RealtimeDevice::new(SimulatedDevice::new(Options::default()), clock);
        let rate = u64::from(paced.device.sample_rate_hz());
        (0..clock_ms.len() / 2).for_each(|_| paced.catch_up());
        (paced.now() + BLOCK as u64 / 2) * 1000 / rate
    }

    #[test]
    fn a_rendering_that_is_slower_than_time_is_not_owed_at_the_next_command() {
        // The second command meets what a quick rendering of the first took: all of it is rendered.
        assert_eq!(device_ms(&[0, 1000, 1900, 1900, 1900]), 1900);
        // A second that took two: they are left out, and the device renders the 500 ms after them.
        assert_eq!(device_ms(&[0, 1000, 3000, 3500, 3500]), 1500);
        // So short a rendering may have been interrupted.
        assert_eq!(device_ms(&[0, 10, 90, 90, 90]), 90);
    }
}
