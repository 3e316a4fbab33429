//! The result of a window: the sums of each tone and input.

use super::basis::{CONSTANT, Sums};
use super::fold::Span;
use crate::bank::{BLOCK, TONES};

/// The sums of one tone and one input; their unit is in the [module's](super) equations.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[repr(C)]
pub struct InPhaseQuadrature {
    /// `I`: along the tone's sine.
    pub in_phase: i64,
    /// `Q`: along its cosine, a quarter of a turn ahead.
    pub quadrature: i64,
}

impl InPhaseQuadrature {
    pub(super) const NONE: Self = Self { in_phase: 0, quadrature: 0 };

    /// Adds a block's sums, which are eighths, times eight times its weight. The [module](super) shows that 63 bits hold
    /// the longest window.
    pub(super) fn add(&mut self, sums: Sums, weight: i32) {
        let times = |sum: i32| i64::from(sum).wrapping_mul(weight.into());
        self.in_phase = self.in_phase.wrapping_add(times(sums.in_phase));
        self.quadrature = self.quadrature.wrapping_add(times(sums.quadrature));
    }
}

/// The sums of a window so far.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Reading<const INPUTS: usize> {
    /// The sums of each input's tones, the input's offset not taken away.
    pub sums: [[InPhaseQuadrature; TONES]; INPUTS],
    /// The sums of the constant, [`CONSTANT`] codes.
    pub constant: [InPhaseQuadrature; TONES],
    /// Each input's codes less mid-scale, summed up by the same weights.
    pub codes: [i64; INPUTS],
    /// The sum of the weights of the blocks that have been taken.
    pub weight: u32,
    /// Blocks that have been taken.
    pub blocks: u16,
    /// Bit `n`: slot `n` was asked for, sounded in every block, and its phase ran on without a jump. The sums of other
    /// slots mean nothing.
    pub followed: u16,
    /// The lowest and the highest code of each input: an input is clipped where one of them is at an end of the range,
    /// and dead or stuck where they are equal. `None` for an input that was not measured.
    pub spans: [Option<Span>; INPUTS],
}

impl<const INPUTS: usize> Reading<INPUTS> {
    pub(super) const NONE: Self = Self {
        sums: [[InPhaseQuadrature::NONE; TONES]; INPUTS],
        constant: [InPhaseQuadrature::NONE; TONES],
        codes: [0; INPUTS],
        weight: 0,
        blocks: 0,
        followed: 0,
        spans: [None; INPUTS],
    };

    /// `I` and `Q` of a tone and an input, with the input's offset taken away. `None` for a slot that was not followed, an
    /// input that does not exist, or an empty window.
    ///
    /// Not for an interrupt: it divides numbers of 128 bits.
    #[must_use]
    pub fn answer(&self, input: usize, slot: usize) -> Option<InPhaseQuadrature> {
        self.spans.get(input).copied().flatten()?;
        if self.followed & 1_u16.checked_shl(u32::try_from(slot).ok()?)? == 0 {
            return None;
        }
        let sum = *self.sums.get(input)?.get(slot)?;
        without_offset(sum, *self.constant.get(slot)?, *self.codes.get(input)?, self.weight)
    }
}

/// A tone's sums less what the input's offset has added to them: `constant` are the tone's sums of a constant input of
/// [`CONSTANT`] codes, `codes` the sum of the input's codes, `weight` that of the blocks' weights. `None` for an empty window.
#[must_use]
pub fn without_offset(
    sum: InPhaseQuadrature,
    constant: InPhaseQuadrature,
    codes: i64,
    weight: u32,
) -> Option<InPhaseQuadrature> {
    let scale = i128::from(weight) * (BLOCK as i128 * i128::from(CONSTANT));
    let less = |sum: i64, constant: i64| {
        let share = i128::from(codes).wrapping_mul(constant.into()).checked_div(scale)?;
        i64::try_from(i128::from(sum) - share).ok()
    };
    Some(InPhaseQuadrature {
        in_phase: less(sum.in_phase, constant.in_phase)?,
        quadrature: less(sum.quadrature, constant.quadrature)?,
    })
}
