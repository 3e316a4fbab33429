//! A stop that begins in a block that has been rendered already.
//!
//! A block waits for as long as the one before it plays. A stop that comes meanwhile need not wait for it: the ramp is
//! multiplied into its samples. With `s` the ramp's share at the block's end, sample `n` of 128 becomes
//! ```text
//! sample * (1 - s n / 128)
//! ```
//! as if all amplitudes had been led along this line from the start: the way in which every block goes from one of its
//! ends to the other. The phases and steps stay as they are, and the next blocks follow the ramp. So all that the stop
//! changes is known from where it began, and a mirror does the same.

use embassy_sync::blocking_mutex::raw::RawMutex;
use slipline_dds::bank::{BLOCK, code};
use slipline_protocol::units::Gain;

use super::Renderer;
use crate::mailbox::Mailbox;
use crate::motion::outline::Outline;
use crate::planning::ramp::ONE;
use crate::timing::BLOCK_SAMPLES;

impl Renderer {
    /// Lets a stop at once begin in the block that was rendered last, whose codes these are, and hands the changed codes
    /// over; returns whether there was such a stop. The block must not have begun to play.
    ///
    /// A stop that may not begin there begins with the next block: nothing sounds there any more, or a ramp that ends
    /// sooner is under way.
    ///
    /// # Errors
    /// What `hand_over` says.
    // Rare: it takes no room among what every block runs.
    #[cold]
    pub fn revise<M: RawMutex, E>(
        &mut self,
        mailbox: &Mailbox<M>,
        codes: &mut [u16; BLOCK],
        hand_over: impl FnOnce(&[u16; BLOCK]) -> Result<(), E>,
    ) -> Result<bool, E> {
        let first = self.index.saturating_sub(BLOCK_SAMPLES);
        let Some(stop) = mailbox.stop_in_last_block(first, |stop| self.may_fade(first, self.ramp(stop)))
        else {
            return Ok(false);
        };
        // First what the DAC waits for; for the rest there is time.
        let ramp = Outline::fading(&self.here, first, self.ramp(stop), self.outline.table);
        self.lead_to(ramp.share_left(self.index));
        let code::Conversion { clipped, energy } = code::codes(&self.samples, codes);
        let handed_over = hand_over(codes);

        self.fade_from(first, self.ramp(stop), mailbox);
        self.end_at_the_ramp(mailbox);
        self.report.clips = self.report.clips.saturating_sub(self.clipped).saturating_add(clipped);
        self.clipped = clipped;
        let change = u64::from(energy).wrapping_sub(self.energy.into());
        self.report.energy = self.report.energy.wrapping_add(change);
        self.energy = energy;
        if let Some(state) = self.digester.retake(mailbox.digest(), first, codes) {
            mailbox.set_digest(state);
        }
        self.report.silent = self.outline.is_silent_from(self.index);
        self.report.stopping = self.stop_ends.is_some_and(|end| self.index < end);
        mailbox.end_block(self.report);
        handed_over.map(|()| true)
    }

    /// Leads the block's samples to a share of themselves, Q1.31, at its end.
    #[expect(clippy::cast_possible_truncation, reason = "a share of a 32-bit number")]
    fn lead_to(&mut self, left: u32) {
        let mut share = ONE;
        let step = ONE.saturating_sub(left) >> BLOCK.ilog2();
        for sample in &mut self.samples {
            // The product of a 32-bit number and at most 2^31 fits.
            *sample = (i64::from(*sample).wrapping_mul(share.into()) >> 31) as i32;
            share = share.wrapping_sub(step);
        }
    }

    /// The next block begins where the ramp is by now.
    fn end_at_the_ramp<M: RawMutex>(&mut self, mailbox: &Mailbox<M>) {
        mailbox.place(&self.outline, self.index, &mut self.here);
        let mut sum: u64 = 0;
        for (tone, here) in self.tones.iter_mut().zip(&self.here) {
            tone.amplitude_end = here.amplitude().times(Gain(self.limit)).0;
            // Sixteen 32-bit numbers: far from the end of 64 bits.
            sum = sum.wrapping_add(tone.amplitude_end.into());
        }
        self.report.sum = sum;
        self.is_steady = false;
    }
}
