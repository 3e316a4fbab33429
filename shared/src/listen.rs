//! Measuring the inputs: the bodies of the commands that order a measurement or a capture, and of the events with the
//! results.

use crate::limits::{CAPTURED_VALUES, LISTENED_TONES, MAX_CAPTURE_LOG2, MAX_CAPTURE_VALUES};
use crate::schema::{body, choices};
use crate::units::SampleIndex;
use heapless::Vec;

body! {
    /// The body of [`Event::Inputs`](crate::Event::Inputs).
    #[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
    pub struct InputsReport {
        /// Number of inputs: 1 is the sensor, 2 the sensor and the drive current's shunt, in this order; 0 none.
        pub inputs: u8 [""],
        /// Tones that can be measured at once at one input. Of several inputs at once: this number divided by theirs.
        pub lock_ins: u8 [""],
        /// How long after DAC code n is at its pin an input is held for its code n; negative if before. Filters outside the chip
        /// add to it.
        pub delay_ns: i64 ["ns"],
        /// Blocks of codes that were lost since the reset; stops at its largest value.
        pub lost_blocks: u32 ["blocks"],
        /// The index of the next block to be rendered.
        pub now: SampleIndex ["samples"],
    }
}

choices! {
    /// The weights of a window's blocks.
    pub enum WindowShape {
        /// Equal weights.
        0 since 0 Rectangular,
        /// Hann: `1/2 - 1/2 cos(2 pi (b + 1/2) / blocks)` for block b.
        1 since 0 Hann,
    }
}

body! {
    /// The body of [`Command::Listen`](crate::Command::Listen).
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub struct ListenWindow {
        /// The first sample, rounded up to a block boundary; none: the next block.
        pub from: Option<SampleIndex> ["samples"],
        /// The length.
        pub blocks: u16 ["blocks", 1, u16::MAX],
        /// The weights of its blocks.
        pub shape: WindowShape [""],
        /// Bit n: slot n is measured. At most as many as the device can measure at once.
        pub slots: u16 ["bits"],
        /// The input that is measured, from 0; none: all at once.
        pub input: Option<u8> [""],
    }
}

body! {
    /// The body of [`Command::ListenRead`](crate::Command::ListenRead).
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub struct ListenPart {
        /// The input, from 0.
        pub input: u8 [""],
        /// The first of the eight slots to be read.
        pub first_slot: u8 ["", 0, crate::limits::MAX_TONES - 1],
    }
}

choices! {
    /// Progress of a measurement or a capture.
    #[derive(Default)]
    pub enum Progress {
        /// None has been started, or it was dropped.
        #[default]
        0 since 0 Idle,
        /// It waits for its first sample, or is under way.
        1 since 0 Running,
        /// It is complete.
        2 since 0 Finished,
        /// It ended early: a block was lost, or it was stopped. What came before can be read.
        3 since 0 Broken {
            /// The first sample that is missing.
            at: SampleIndex ["samples"],
        },
    }
}

body! {
    /// How an input answers one tone. With x the input's codes less their mean, w the weight of their block, and p the phase at
    /// which the device renders the tone there, `I = 16383/2 sum w x sin p` and `Q = 16383/2 sum w x cos p`. An answer
    /// `b sin(p + s)`, b in codes, gives `b exp(i s) = 4 (I + i Q) / (16383 * 128 * weight)`.
    #[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
    pub struct InPhaseQuadrature {
        /// I: along the tone's sine.
        pub in_phase: i64 [""],
        /// Q: along its cosine, a quarter of a turn ahead.
        pub quadrature: i64 [""],
    }
}

body! {
    /// The body of [`Event::Listened`](crate::Event::Listened).
    #[derive(Clone, Debug, Default, PartialEq, Eq)]
    pub struct Listened {
        /// Progress of the measurement.
        pub progress: Progress [""],
        /// The window's first sample.
        pub begin: SampleIndex ["samples"],
        /// The blocks that have been taken.
        pub blocks: u16 ["blocks"],
        /// The sum of their weights, each 32768 at most.
        pub weight: u32 [""],
        /// Bit n: slot n was asked for, sounded in every block, and its phase ran on without a jump. The answers of other slots
        /// are 0, and all are of an input that was not measured.
        pub followed: u16 ["bits"],
        /// The input's lowest code: clipped where it is 0, unless the input was not measured.
        pub lowest: u16 ["codes"],
        /// Its highest code: clipped where it is 4095, dead or stuck where it is the lowest.
        pub highest: u16 ["codes"],
        /// The answers of up to eight slots, from the one asked for on. None while the measurement is under way.
        pub answers: Vec<InPhaseQuadrature, LISTENED_TONES> [""],
    }
}

body! {
    /// The body of [`Command::Capture`](crate::Command::Capture).
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub struct CaptureWindow {
        /// The first code's index; none: the next block's first.
        pub from: Option<SampleIndex> ["samples"],
        /// The input, from 0.
        pub input: u8 [""],
        /// The binary logarithm of the number of codes that a value sums up.
        pub log2_codes: u8 ["", 0, MAX_CAPTURE_LOG2],
        /// The number of values.
        pub values: u16 ["", 1, MAX_CAPTURE_VALUES],
    }
}

body! {
    /// The body of [`Command::CaptureRead`](crate::Command::CaptureRead).
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub struct CapturePart {
        /// The number of the first value to be read, from 0.
        pub first: u16 [""],
    }
}

body! {
    /// The body of [`Event::Captured`](crate::Event::Captured).
    #[derive(Clone, Debug, Default, PartialEq, Eq)]
    pub struct Captured {
        /// Progress of the capture.
        pub progress: Progress [""],
        /// The index of the first code of value 0.
        pub from: SampleIndex ["samples"],
        /// The number of values captured so far.
        pub captured: u16 [""],
        /// The number of the first of `values`, from 0.
        pub first: u16 [""],
        /// The values, as many as there are and fit: sums of codes.
        pub values: Vec<u32, CAPTURED_VALUES> [""],
    }
}
