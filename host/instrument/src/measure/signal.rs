//! Present signal of an input: its level, and whether anything is connected to it.

use slipline_link::protocol::listen::InputsReport;
use slipline_link::{BLOCK, ListenRequest, Listened, Request, WindowShape};
use slipline_plate::check::Colour;
use slipline_plate::quantity::decibels;
use slipline_plate::quantity::number_format::with_decimals;

/// Half of an input's range, codes.
const HALF_RANGE: f64 = 2047.5;
/// The highest code.
const HIGHEST: u16 = 4095;
/// Length of one capture, seconds: long enough for a tap on the plate, short enough to follow it.
const LOOK_S: f64 = 0.12;

/// The lowest and the highest code of an input within one capture.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Signal {
    /// The lowest code.
    pub lowest: u16,
    /// The highest code.
    pub highest: u16,
}

impl Signal {
    /// The request for a short capture of an input without tones; `None` if the device does not have this
    /// input.
    #[must_use]
    pub fn look(inputs: &InputsReport, input: u8, rate_hz: f64) -> Option<Request> {
        let blocks = (LOOK_S * rate_hz / BLOCK as f64).clamp(1.0, f64::from(u16::MAX)) as u16;
        (input < inputs.inputs).then_some(Request::Listen(ListenRequest {
            from: None,
            blocks,
            shape: WindowShape::Rectangular,
            slots: 0,
            input,
        }))
    }

    /// The signal of a capture.
    #[must_use]
    pub const fn of(listened: &Listened) -> Self {
        Self { lowest: listened.lowest, highest: listened.highest }
    }

    /// Half of the span over half of the range (0 to 1).
    #[must_use]
    pub fn share(&self) -> f64 {
        f64::from(self.highest.saturating_sub(self.lowest)) / (2.0 * HALF_RANGE)
    }

    /// The same in dB of full scale; minus infinity for an input whose code does not change.
    #[must_use]
    pub fn level_db(&self) -> f64 {
        decibels(self.share())
    }

    /// Red for an input whose code does not change or that is clipped, green otherwise.
    #[must_use]
    pub fn colour(&self) -> Colour {
        if self.is_stuck() || self.is_clipped() { Colour::Red } else { Colour::Green }
    }

    const fn is_stuck(self) -> bool {
        self.highest <= self.lowest
    }

    const fn is_clipped(self) -> bool {
        self.lowest == 0 || self.highest == HIGHEST
    }

    /// The signal described in a sentence.
    #[must_use]
    pub fn sentence(&self) -> String {
        if self.is_stuck() {
            return "The input shows one code alone: nothing is connected to it, or its amplifier is off."
                .to_owned();
        }
        let level = format!("{} dB of full scale", with_decimals(self.level_db(), 0));
        if self.is_clipped() {
            return format!("{level}: the input is clipped, lower its gain.");
        }
        format!("{level}. Tap the plate: the level should jump.")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_code_is_no_signal_and_the_ends_of_the_range_are_clipped() {
        for (lowest, highest, colour, words) in [
            (2048, 2048, Colour::Red, "one code alone"),
            (0, 2500, Colour::Red, "clipped"),
            (1500, 4095, Colour::Red, "clipped"),
            (2047, 2049, Colour::Green, "-66 dB of full scale. Tap"),
            (1, 4094, Colour::Green, "dB of full scale. Tap"),
        ] {
            let signal = Signal { lowest, highest };
            let sentence = signal.sentence();
            assert!(signal.colour() == colour && sentence.contains(words), "{lowest} {highest}: {sentence}");
        }
        assert_eq!(Signal { lowest: 0, highest: 4095 }.level_db(), 0.0);
    }

    #[test]
    fn a_look_asks_for_codes_alone_and_only_of_an_existing_input() {
        let inputs = InputsReport { inputs: 1, lock_ins: 16, delay_ns: 0, lost_blocks: 0, now: 0 };
        let Some(Request::Listen(look)) = Signal::look(&inputs, 0, 400e3) else { panic!("a look") };
        assert_eq!((look.slots, look.blocks, look.from), (0, 375, None));
        assert!(Signal::look(&inputs, 1, 400e3).is_none());
    }
}
