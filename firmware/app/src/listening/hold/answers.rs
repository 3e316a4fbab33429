//! The result of a window: each tone's amplitude at one input.

use slipline_dds::bank::TONES;
use slipline_dds::lock_in::{BASIS_ONE, InPhaseQuadrature, Span};

/// The highest code.
const HIGHEST_CODE: u16 = 0x0FFF;

/// The answers of one input over a whole window.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Answers {
    /// The lowest and the highest code.
    pub span: Span,
    /// Each slot's amplitude in 1/256 code ([`amplitude`]); `None` for one that was not followed.
    pub amplitudes: [Option<u32>; TONES],
}

/// Why an input's answers are rejected.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Untrusted {
    Stuck,
    Clipped,
}

impl Answers {
    /// The answers of a finished reading. `None` if the board has no such input.
    #[cfg(test)]
    pub(super) fn of(
        reading: &slipline_dds::lock_in::Reading<{ crate::ports::INPUTS }>,
        input: usize,
    ) -> Option<Self> {
        let span = reading.spans.get(input).copied().flatten()?;
        let amplitudes = core::array::from_fn(|slot| {
            reading.answer(input, slot).and_then(|answer| amplitude(answer, reading.weight))
        });
        Some(Self { span, amplitudes })
    }

    /// Rejects an input that clips or does not move. A clipped input understates a strong tone, so the loop would raise
    /// it further.
    pub(super) const fn check(&self) -> Result<(), Untrusted> {
        let Span { lowest, highest } = self.span;
        if lowest == highest {
            Err(Untrusted::Stuck)
        } else if lowest == 0 || highest >= HIGHEST_CODE {
            Err(Untrusted::Clipped)
        } else {
            Ok(())
        }
    }
}

/// An answer's amplitude `b` in 1/256 code, rounded down, by the [lock-in's](slipline_dds::lock_in) equation:
/// `256 b = 256 * 4 |I + iQ| / (BASIS_ONE * 128 * W) = 8 |I + iQ| / (BASIS_ONE * W)`. `weight` is `W`; `None` if it is 0.
#[must_use]
pub fn amplitude(answer: InPhaseQuadrature, weight: u32) -> Option<u32> {
    let square = |sum: i64| u128::from(sum.unsigned_abs()) * u128::from(sum.unsigned_abs());
    // Two squares of at most 2^126, and eight times a root below 2^64.
    let length = (square(answer.in_phase) + square(answer.quadrature)).isqrt();
    let scale = u128::from(BASIS_ONE.unsigned_abs()) * u128::from(weight);
    let amplitude = (length << 3).checked_div(scale)?;
    Some(u32::try_from(amplitude).unwrap_or(u32::MAX))
}
