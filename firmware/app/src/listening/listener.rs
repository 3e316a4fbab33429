//! The listener: hands the ADC's blocks to the lock-ins and the capture, with the index of each, and counts what is lost.
//!
//! ```text
//! renderer --block_is_rendered--> History --+
//!                                           v
//! SenseStream --catch_up--> block ------> lock-ins, capture
//!                                           |  ^
//!                       progress, reading   v  |  orders
//!                                          Mailbox
//! ```
//! A listener that measures nothing takes the blocks and drops them, which costs next to nothing.

use crate::listening::capture::{Capture, Progress, Values};
use crate::mailbox::{CaptureReport, ListenOrders, Mailbox, Order};
use crate::ports::{INPUTS, Overrun, SenseStream};
use crate::timing::BLOCK_SAMPLES;
use core::ops::Range;
use embassy_sync::blocking_mutex::raw::RawMutex;
use slipline_dds::bank::{BLOCK, TONES, ToneBlock};
use slipline_dds::lock_in::{History, LockIn, State};
use slipline_protocol::units::SampleIndex;

/// Measurement and capture of the inputs.
#[derive(Clone, Debug)]
pub struct Listener<'a> {
    /// How the blocks were rendered that the ADC has yet to sample.
    pub history: History,
    /// The lock-ins of the tones.
    pub lock_in: LockIn<INPUTS>,
    /// The capture.
    pub capture: Capture<'a>,
    next: SampleIndex,
    lost_blocks: u32,
    /// Which results have not been reported to the thread side.
    owes_reading: bool,
    owes_capture: bool,
    codes: [[u16; BLOCK]; INPUTS],
}

impl<'a> Listener<'a> {
    /// A listener whose first block begins at `index`, a multiple of 128: that of the DAC's first code. What it captures will
    /// be in `values`.
    #[must_use]
    pub const fn starting_at(index: SampleIndex, values: &'a Values) -> Self {
        Self {
            history: History::new(),
            lock_in: LockIn::new(),
            capture: Capture::new(values),
            next: index,
            lost_blocks: 0,
            owes_reading: false,
            owes_capture: false,
            codes: [[0; BLOCK]; INPUTS],
        }
    }

    /// The first sample of the next block.
    #[must_use]
    pub const fn next(&self) -> SampleIndex {
        self.next
    }

    /// Blocks that were lost since the start; stays at `u32::MAX` once there.
    #[must_use]
    pub const fn lost_blocks(&self) -> u32 {
        self.lost_blocks
    }

    /// Takes the thread side's orders, and remembers how a block is rendered, while a lock-in may need it: its first sample,
    /// every tone's phase there, and the tones. For every block, before the DAC plays it.
    pub fn block_is_rendered<M: RawMutex>(
        &mut self,
        index: SampleIndex,
        phases: &[u64; TONES],
        tones: &[ToneBlock; TONES],
        mailbox: &Mailbox<M>,
    ) {
        if let Some(orders) = mailbox.take_listen_orders() {
            self.obey(orders);
        }
        if self.lock_in.state() == State::Measuring {
            self.history.record(index, phases, tones);
        }
    }

    /// Takes the blocks that have been sampled, but at most one that the lock-ins work on: two would cost more time than
    /// a block has. One that waits is taken at the next turn.
    ///
    /// Reports the progress of measurement and capture to the thread side.
    pub fn catch_up<M: RawMutex>(&mut self, stream: &mut impl SenseStream, mailbox: &Mailbox<M>) {
        let lost_blocks = self.lost_blocks;
        let has_worked = loop {
            let is_dear = self.lock_in.works_at(self.next);
            if !self.listen(stream) {
                break false;
            }
            if is_dear {
                break true;
            }
        };
        if self.lost_blocks != lost_blocks {
            mailbox.set_lost_blocks(self.lost_blocks);
        }
        if self.owes_reading {
            self.report_reading(has_worked, mailbox);
        }
        if self.owes_capture {
            let progress = self.capture.progress();
            self.owes_capture = progress == Progress::Running;
            let (begin, filled) = (self.capture.begin(), self.capture.filled());
            mailbox.set_captured(CaptureReport { progress, begin, filled });
        }
    }

    /// Reports a finished reading. That takes as long as two tones, so it waits for the first turn without lock-in work.
    fn report_reading<M: RawMutex>(&mut self, has_worked: bool, mailbox: &Mailbox<M>) {
        let (state, reading) = (self.lock_in.state(), self.lock_in.reading());
        if has_worked || state == State::Measuring {
            mailbox.set_measured_blocks(reading.blocks);
            return;
        }
        self.owes_reading = false;
        mailbox.set_reading(state, self.lock_in.begin(), reading);
    }

    /// The orders have been checked where they were given, for an index that was not rendered yet.
    // Rare: it takes no room among what every block runs.
    #[cold]
    #[inline(never)]
    fn obey(&mut self, orders: ListenOrders) {
        match orders.measurement {
            Some(Order::Start(window)) => {
                if self.lock_in.start(window, self.next).is_err() {
                    self.lock_in.stop();
                }
                self.owes_reading = true;
            }
            Some(Order::Stop | Order::Drop) => {
                self.lock_in.stop();
                self.owes_reading = false;
            }
            None => {}
        }
        match orders.capture {
            Some(Order::Start(recipe)) => {
                if self.capture.start(recipe, self.next, INPUTS).is_err() {
                    self.capture.forget();
                }
                self.owes_capture = true;
            }
            Some(Order::Stop) => {
                self.capture.stop();
                self.owes_capture = true;
            }
            Some(Order::Drop) => {
                self.capture.forget();
                self.owes_capture = false;
            }
            None => {}
        }
    }

    /// The inputs for whose codes a measurement or a capture waits; one between two of them is among them.
    fn wanted_inputs(&self) -> Range<usize> {
        let (measured, captured) = (self.lock_in.wanted_inputs(), self.capture.wanted_inputs());
        match (measured.is_empty(), captured.is_empty()) {
            (true, _) => captured,
            (_, true) => measured,
            _ => measured.start.min(captured.start)..measured.end.max(captured.end),
        }
    }

    /// Takes one block, if one has been sampled; returns whether there was one. Blocks that were lost take up their
    /// indices: a measurement over them [breaks](slipline_dds::lock_in::State::Broken), all others go on.
    pub fn listen(&mut self, stream: &mut impl SenseStream) -> bool {
        let wanted = self.wanted_inputs();
        let is_heard = !wanted.is_empty();
        let taken = if is_heard { stream.take_block(wanted, &mut self.codes) } else { stream.skip_block() };
        match taken {
            None => return false,
            Some(Err(Overrun { blocks })) => {
                self.lost_blocks = self.lost_blocks.saturating_add(blocks);
                self.next = self.next.saturating_add(BLOCK_SAMPLES * u64::from(blocks));
                // What waited for one of them breaks now: another may never come.
                let last = self.next.saturating_sub(BLOCK_SAMPLES);
                self.lock_in.take_block(last, &[], None);
                self.capture.take_block(last, &[]);
            }
            Some(Ok(())) if !is_heard => self.next = self.next.saturating_add(BLOCK_SAMPLES),
            Some(Ok(())) => {
                let inputs = self.codes.get(..stream.inputs().min(INPUTS)).unwrap_or_default();
                self.lock_in.take_block(self.next, inputs, self.history.at(self.next));
                // A needless call would cost every measured block some ten cycles.
                if self.capture.progress() == Progress::Running {
                    self.capture.take_block(self.next, inputs);
                }
                // 64 bits of samples last for a million years.
                self.next = self.next.wrapping_add(BLOCK_SAMPLES);
            }
        }
        true
    }
}

#[cfg(test)]
mod tests;
