//! The proof of a chord's peak: one period of it, rendered but not played.

use slipline_dds::bank::code::code_of;
use slipline_dds::bank::{BLOCK, FULL_SCALE, SteadyBank};
use slipline_protocol::refusal::{Busy, Refusal};
use slipline_protocol::units::{Gain, per_mille};

use super::ChordTones;
use crate::timing::BLOCK_SAMPLES;

/// Tones that are prepared between two looks for a stop: together they take about as long as a block.
const TONES_AT_ONCE: usize = 4;

/// Lowest and highest sample of a signal, in units of 1/[`FULL_SCALE`] of half the DAC's swing.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Extent {
    /// The lowest sample.
    pub lowest: i32,
    /// The highest sample.
    pub highest: i32,
}

impl Extent {
    fn with(self, samples: &[i32; BLOCK]) -> Self {
        samples.iter().fold(self, |extent, &sample| Self {
            lowest: extent.lowest.min(sample),
            highest: extent.highest.max(sample),
        })
    }

    /// The largest magnitude.
    #[must_use]
    pub fn peak(&self) -> u32 {
        self.lowest.unsigned_abs().max(self.highest.unsigned_abs())
    }

    /// The largest magnitude, Q1.31 of full scale.
    const fn peak_q31(peak: u32) -> u64 {
        // From 27 fractional bits to 31.
        (peak as u64) << 4
    }

    /// The lowest and the highest DAC code.
    #[must_use]
    pub fn codes(&self) -> (u16, u16) {
        (code_of(self.lowest), code_of(self.highest))
    }

    /// The peak in per mille of full scale, rounded up.
    #[must_use]
    pub fn peak_per_mille(&self) -> u16 {
        per_mille(Self::peak_q31(self.peak()))
    }
}

/// Working memory of a proof.
#[derive(Clone, Debug)]
pub struct Proof {
    bank: SteadyBank,
    samples: [i32; BLOCK],
}

impl Proof {
    /// Before the first proof.
    #[must_use]
    pub const fn new() -> Self {
        Self { bank: SteadyBank::new(), samples: [0; BLOCK] }
    }

    /// Checks that a chord stays within full scale: by the sum of its amplitudes, or else by its samples. A look for a stop
    /// comes after each block, since a long period takes the time of many.
    ///
    /// # Errors
    /// [`Refusal::Headroom`] if no phases could help, [`Refusal::Peak`], [`Busy::DriveActive`] if a stop has come.
    pub fn check(&mut self, tones: &ChordTones, is_stopped: &mut dyn FnMut() -> bool) -> Result<(), Refusal> {
        self.check_within(Gain::FULL, tones, is_stopped)
    }

    /// As [`Proof::check`], within a part of full scale. Never inlined, so that it needs no stack of its own beside planning.
    ///
    /// # Errors
    /// As [`Proof::check`].
    #[inline(never)]
    pub(crate) fn check_within(
        &mut self,
        ceiling: Gain,
        tones: &ChordTones,
        is_stopped: &mut dyn FnMut() -> bool,
    ) -> Result<(), Refusal> {
        if tones.sum() <= u64::from(ceiling.0) {
            return Ok(());
        }
        tones.check_sum()?;
        let extent = self.extent(tones, is_stopped)?;
        // Full scale is 27 fractional bits.
        if extent.peak() > (ceiling.0 >> 4).min(FULL_SCALE.unsigned_abs()) {
            return Err(Refusal::Peak { peak_per_mille: extent.peak_per_mille() });
        }
        Ok(())
    }

    /// Renders one period. The tones must have passed [`ChordTones::check_sum`]: larger samples wrap.
    ///
    /// # Errors
    /// [`Busy::DriveActive`] if a stop has come.
    pub fn extent(
        &mut self,
        tones: &ChordTones,
        is_stopped: &mut dyn FnMut() -> bool,
    ) -> Result<Extent, Refusal> {
        let mut refuse_if_stopped =
            || if is_stopped() { Err(Refusal::Busy(Busy::DriveActive)) } else { Ok(()) };
        self.bank.silence();
        for (number, (slot, step, phase, amplitude)) in tones.sounding().enumerate() {
            if number % TONES_AT_ONCE == TONES_AT_ONCE - 1 {
                refuse_if_stopped()?;
            }
            self.bank.set(slot, step.0, phase, amplitude.0);
        }
        let mut extent = Extent::default();
        for _ in 0..u64::from(tones.period()) / BLOCK_SAMPLES {
            refuse_if_stopped()?;
            self.bank.render(&mut self.samples);
            extent = extent.with(&self.samples);
        }
        refuse_if_stopped()?;
        Ok(extent)
    }
}

/// A chord on its way to be accepted: 6 KiB, which a firmware keeps in a static, because its stack has no room for them.
#[derive(Clone, Debug)]
pub struct Candidate {
    pub(crate) tones: ChordTones,
    pub(crate) proof: Proof,
}

impl Candidate {
    /// No chord.
    #[must_use]
    pub const fn new() -> Self {
        Self { tones: ChordTones::NONE, proof: Proof::new() }
    }

    /// As [`Proof::check`].
    pub(crate) fn check(
        &mut self,
        ceiling: Gain,
        is_stopped: &mut dyn FnMut() -> bool,
    ) -> Result<(), Refusal> {
        self.proof.check_within(ceiling, &self.tones, is_stopped)
    }
}
