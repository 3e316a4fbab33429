//! The DAC's ring of two halves: which half may be written, and what it holds until then.
//!
//! ```text
//! ring:   | half 0: one block | half 1: one block |      DMA reads round and round, one code per timer tick
//!              ^ written while      ^ played
//! ```
//! When the DMA leaves a half, its interrupt calls [`Halves::finish`] and fills that half with a straight ramp from
//! the last code of the half now playing to mid-scale ([`ramp`]). The renderer then writes its block over the ramp. If
//! it comes too late the DMA plays the ramp, then mid-scale: never an old block again. So a missed deadline is a short
//! controlled fade, and [`Halves::claim`] or [`Halves::commit`] reports it.
//!
//! Latency: a block is written while the other half plays, so it sounds after at most one block.

use core::sync::atomic::{AtomicU32, Ordering::Relaxed};

/// The DAC's mid-scale, 12 bit.
pub(crate) const MID_SCALE: u16 = 1 << 11;

/// The block came too late: the DMA had reached the half before it was written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Late;

/// Counts of halves, modulo 2^32; the half a count stands for is its lowest bit.
///
/// `played` is written by the DMA's interrupt alone (or while it is off), `written` by the renderer alone, and the
/// interrupt has the higher priority, so plain loads and stores are enough.
pub(crate) struct Halves {
    played: AtomicU32,
    written: AtomicU32,
}

impl Halves {
    /// A ring whose two halves both hold codes that may be played.
    pub(crate) const fn full() -> Self {
        Self { played: AtomicU32::new(0), written: AtomicU32::new(2) }
    }

    /// Back to [`Self::full`], while the DMA is off.
    #[cfg_attr(not(target_arch = "arm"), expect(dead_code, reason = "restarting is the hardware's part"))]
    pub(crate) fn refill(&self) {
        self.played.store(0, Relaxed);
        self.written.store(2, Relaxed);
    }

    /// The DMA has left a half; returns which one: it may be written now.
    pub(crate) fn finish(&self) -> usize {
        let played = self.played.load(Relaxed);
        self.played.store(played.wrapping_add(1), Relaxed);
        (played & 1) as usize
    }

    /// Whether both halves hold codes that have not been played: there is nothing to write. Changes nothing.
    pub(crate) fn is_full(&self) -> bool {
        self.written.load(Relaxed).wrapping_sub(self.played.load(Relaxed)) == 2
    }

    /// The half that is free to be written, or `None` while both hold codes that have not been played.
    ///
    /// # Errors
    /// [`Late`] if the DMA plays a half that was not written. The ring is in step again: the next claim waits for the
    /// half after the one that plays.
    pub(crate) fn claim(&self) -> Result<Option<usize>, Late> {
        let (played, written) = (self.played.load(Relaxed), self.written.load(Relaxed));
        // Halves that hold unplayed codes, the one that plays included.
        match written.wrapping_sub(played) {
            2 => Ok(None),
            1 => Ok(Some((written & 1) as usize)),
            _ => {
                self.written.store(played.wrapping_add(1), Relaxed);
                Err(Late)
            }
        }
    }

    /// The claimed half is written.
    ///
    /// # Errors
    /// [`Late`] if the DMA had entered it before it was whole; the ring is in step again.
    pub(crate) fn commit(&self) -> Result<(), Late> {
        let (played, written) = (self.played.load(Relaxed), self.written.load(Relaxed));
        if written.wrapping_sub(played) == 1 {
            self.written.store(written.wrapping_add(1), Relaxed);
            Ok(())
        } else {
            self.written.store(played.wrapping_add(1), Relaxed);
            Err(Late)
        }
    }

    /// Puts the counts in step with the DMA after interrupts were lost: `playing` is the half it reads now.
    pub(crate) fn resynchronise(&self, playing: usize) {
        let played = self.played.load(Relaxed).wrapping_add(2);
        let behind = u32::from((played & 1) as usize != playing);
        self.played.store(played.wrapping_add(behind), Relaxed);
    }
}

/// Codes of a straight line over `LENGTH` samples, from the sample after `from` to mid-scale exactly.
///
/// It runs in the DMA's interrupt once a block, so it is an addition and a shift a sample.
pub(crate) fn ramp<const LENGTH: u16>(from: u16) -> impl Iterator<Item = u16> {
    // Q16: the slope is cut by less than 2^-16 of a code, so the end is off by less than LENGTH * 2^-16, which the
    // rounding by half a code takes away: at most 2^15 / LENGTH of it would be left for LENGTH = 2^15.
    const { assert!(LENGTH > 0 && LENGTH < 1 << 15) };
    let rounding = 1 << 15;
    let slope = ((i32::from(MID_SCALE) - i32::from(from)) << 16) / i32::from(LENGTH);
    let mut level = (i32::from(from) << 16) + rounding;
    (0..LENGTH).map(move |_| {
        level += slope;
        // Between two 12-bit codes: it fits.
        (level >> 16) as u16
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn a_full_ring_is_written_only_after_the_dma_has_left_a_half() {
        let halves = Halves::full();
        assert_eq!(halves.claim(), Ok(None));
        assert_eq!(halves.finish(), 0);
        assert_eq!(halves.claim(), Ok(Some(0)));
        assert_eq!(halves.commit(), Ok(()));
        assert_eq!(halves.claim(), Ok(None));
        assert!(halves.is_full());
        assert_eq!(halves.finish(), 1);
        assert!(!halves.is_full());
        assert_eq!(halves.claim(), Ok(Some(1)));
    }

    #[test]
    fn a_half_entered_before_it_was_whole_is_late_and_the_next_one_is_in_step() {
        let halves = Halves::full();
        halves.finish();
        assert_eq!(halves.claim(), Ok(Some(0)));
        halves.finish();
        assert_eq!(halves.commit(), Err(Late));
        // The DMA plays half 0, so half 1 is the next to write.
        assert_eq!(halves.claim(), Ok(Some(1)));
        assert_eq!(halves.commit(), Ok(()));
    }

    #[test]
    fn looking_whether_there_is_room_does_not_hide_that_it_was_late() {
        let halves = Halves::full();
        halves.finish();
        halves.finish();
        assert!(!halves.is_full());
        assert_eq!(halves.claim(), Err(Late));
    }

    #[test]
    fn lost_interrupts_leave_the_ring_in_step_with_the_dma() {
        for (finished, playing) in [(1, 0), (1, 1), (2, 0), (2, 1)] {
            let halves = Halves::full();
            for _ in 0..finished {
                halves.finish();
            }
            halves.resynchronise(playing);
            assert_eq!(halves.claim(), Err(Late));
            assert_eq!(halves.claim(), Ok(Some(1 - playing)));
        }
    }

    #[test]
    fn every_ramp_is_monotonic_and_ends_at_mid_scale() {
        for from in 0..=4095u16 {
            let codes: Vec<_> = ramp::<128>(from).collect();
            assert_eq!((codes.len(), codes[127]), (128, MID_SCALE));
            let largest = (i32::from(from) - i32::from(MID_SCALE)).abs() / 128 + 2;
            let mut last = from;
            for code in codes {
                assert!((i32::from(code) - i32::from(last)).abs() <= largest);
                assert!((code >= last) == (from <= MID_SCALE) || code == last);
                last = code;
            }
        }
    }

    proptest! {
        /// A consumer that may outrun the writer at any point: whatever it plays was written in order, once, or was
        /// reported late.
        #[test]
        fn what_plays_was_written_in_order_or_reported_late(consume in prop::collection::vec(0..3usize, 1..400)) {
            let halves = Halves::full();
            let mut ring = [Some(0u32), Some(1)];
            let (mut playing, mut next) = (0, 2);
            let (mut heard, mut gaps, mut reports) = (vec![], 0, 0);
            for (step, &finished) in consume.iter().enumerate() {
                let claimed = halves.claim();
                let mut finish = |ring: &mut [Option<u32>; 2]| {
                    match ring[playing] {
                        Some(block) => heard.push(block),
                        None => gaps += 1,
                    }
                    prop_assert_eq!(halves.finish(), playing);
                    ring[playing] = None;
                    playing = 1 - playing;
                    Ok(())
                };
                match claimed {
                    Ok(Some(half)) => {
                        // Some of the consumer's steps fall between claim and commit.
                        let during = if step % 2 == 0 { finished } else { 0 };
                        for _ in 0..during {
                            finish(&mut ring)?;
                        }
                        match halves.commit() {
                            Ok(()) => { prop_assert_eq!(during, 0); ring[half] = Some(next); }
                            Err(Late) => reports += 1,
                        }
                        next += 1;
                        for _ in 0..finished - during {
                            finish(&mut ring)?;
                        }
                    }
                    Ok(None) => for _ in 0..finished { finish(&mut ring)?; },
                    Err(Late) => { reports += 1; for _ in 0..finished { finish(&mut ring)?; } }
                }
            }
            prop_assert!(heard.windows(2).all(|pair| pair[0] < pair[1]), "{heard:?}");
            prop_assert!(gaps == 0 || reports > 0 || halves.claim() == Err(Late));
        }
    }
}
