//! Requests to measure at the device's inputs, and the results.

use slipline_protocol::limits::{BLOCK, MAX_TONES};
pub use slipline_protocol::listen::WindowShape;
use slipline_protocol::listen::{self, ListenWindow};
use slipline_protocol::units::SampleIndex;

/// Codes of an input on each side of mid-scale.
const MID_SCALE: f64 = 2048.0;
/// The device's value of a sine of amplitude 1: see
/// [`InPhaseQuadrature`](slipline_protocol::listen::InPhaseQuadrature).
const BASIS_ONE: f64 = 16_383.0;

/// Measures an input's response to each tone over a window. It ends with the window, with
/// [`Outcome::Listened`](crate::Outcome::Listened). A newer request replaces one under way.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub struct ListenRequest {
    /// The window's first sample, rounded up to a block boundary; `None`: the next block.
    pub from: Option<SampleIndex>,
    /// Its length in blocks of 128 samples, at least 1.
    pub blocks: u16,
    /// The weights of its blocks.
    pub shape: WindowShape,
    /// Bit n: slot n is measured.
    pub slots: u16,
    /// The input, from 0.
    pub input: u8,
}

impl ListenRequest {
    pub(crate) const fn window(&self) -> ListenWindow {
        ListenWindow {
            from: self.from,
            blocks: self.blocks,
            shape: self.shape,
            slots: self.slots,
            input: Some(self.input),
        }
    }
}

/// An input's response to each tone.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Listened {
    /// The window's first sample.
    pub begin: SampleIndex,
    /// Its length in blocks.
    pub blocks: u16,
    /// For each slot `(re, im)` of `b exp(i s)`, where the input's code is `b sin(p + s)` about its mean and
    /// the tone's code is `a sin p`: `b` in codes. `None` for a slot that was not requested, or whose tone
    /// was interrupted. The device's delay
    /// ([`InputsReport::delay_ns`](slipline_protocol::listen::InputsReport)) is included in `s`.
    pub answers: [Option<(f64, f64)>; MAX_TONES],
    /// The input's lowest code: clipped where it is 0.
    pub lowest: u16,
    /// Its highest code: clipped where it is 4095, dead or stuck where it is the lowest.
    pub highest: u16,
}

impl Listened {
    pub(crate) const fn begun(begin: SampleIndex, blocks: u16) -> Self {
        Self { begin, blocks, answers: [None; MAX_TONES], lowest: 0, highest: 0 }
    }

    /// Stores the results of the slots from `first_slot` on.
    pub(crate) fn take(&mut self, first_slot: u8, report: &listen::Listened) {
        (self.lowest, self.highest) = (report.lowest, report.highest);
        let scale = 4.0 / (BASIS_ONE * BLOCK as f64 * f64::from(report.weight.max(1)));
        let slots = self.answers.iter_mut().enumerate().skip(first_slot.into());
        for ((slot, answer), sums) in slots.zip(&report.answers) {
            let is_followed = report.followed >> slot & 1 == 1;
            // Beyond 2^53 the rounding is 2^-53 of the sum, which is negligible.
            let part = |sum: i64| sum as f64 * scale;
            *answer = is_followed.then(|| (part(sums.in_phase), part(sums.quadrature)));
        }
    }
}

/// Captures the codes of an input. It ends when all values have arrived, with
/// [`Outcome::Captured`](crate::Outcome::Captured). A newer request replaces one under way.
pub use slipline_protocol::listen::CaptureWindow as CaptureRequest;

/// Captured codes of an input.
#[derive(Clone, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub struct Captured {
    /// The first code's index.
    pub from: SampleIndex,
    /// Binary logarithm of the number of codes that are summed to a value.
    pub log2_codes: u8,
    /// The sums.
    pub values: Vec<u32>,
}

impl Captured {
    /// The mean of each value's codes, as its distance from mid-scale, in codes.
    pub fn codes(&self) -> impl Iterator<Item = f64> + '_ {
        let codes = 2_f64.powi(self.log2_codes.into());
        self.values.iter().map(move |sum| f64::from(*sum) / codes - MID_SCALE)
    }
}
