//! Every number of a self-test: its step, its unit, and whether it is a count. A report may have these and no others.

use super::limits::step;

/// A number of a step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Quantity {
    /// The step.
    pub step: &'static str,
    /// The quantity.
    pub name: &'static str,
    /// Its unit; empty for a pure number or a count.
    pub unit: &'static str,
    /// Whether it is a count: a whole number from 0.
    pub is_count: bool,
}

impl Quantity {
    /// Whether the quantity can have this value.
    #[must_use]
    pub fn allows(&self, value: f64) -> bool {
        value.is_finite() && (!self.is_count || value >= 0.0 && value.fract() == 0.0)
    }
}

const fn number(step: &'static str, name: &'static str, unit: &'static str) -> Quantity {
    Quantity { step, name, unit, is_count: false }
}

const fn count(step: &'static str, name: &'static str) -> Quantity {
    Quantity { step, name, unit: "", is_count: true }
}

const QUANTITIES: &[Quantity] = &[
    number(step::CLOCKS, "rate error", "ppm"),
    number(step::CLOCKS, "rate error in a short time", "ppm"),
    number(step::CLOCKS, "cycle error", "ppm"),
    number(step::CLOCKS, "error by USB frames", "ppm"),
    number(step::SUPPLY, "VREF+", "V"),
    count(step::SUPPLY, "brown-out level unset"),
    count(step::SUPPLY, "brown-out level"),
    number(step::SUPPLY, "linear share", "%"),
    count(step::SUPPLY, "chip"),
    count(step::SUPPLY, "silicon revision"),
    count(step::SUPPLY, "kinds of RAM errors"),
    count(step::MUTE, "resistor missing"),
    count(step::MUTE, "pin high while muted"),
    count(step::MUTE_TIME, "timer leaves it high"),
    number(step::MUTE_TIME, "time to low", "ms"),
    count(step::MUTE_TIME, "break leaves it high"),
    number(step::MUTE_TIME, "time to low by a break", "ms"),
    number(step::DAC_TO_ADC, "slope", ""),
    number(step::DAC_TO_ADC, "offset", "codes"),
    number(step::DAC_TO_ADC, "nonlinearity", "codes"),
    count(step::DAC_TO_ADC, "lowest linear code"),
    count(step::DAC_TO_ADC, "highest linear code"),
    number(step::DELAY, "lag at 5 kHz", "us"),
    number(step::DELAY, "lag at 20 kHz", "us"),
    number(step::DELAY, "lag at 40 kHz", "us"),
    number(step::DELAY, "lag at 80 kHz", "us"),
    number(step::DELAY, "stated delay", "us"),
    number(step::NOISE, "noise at mid-scale", "codes"),
    number(step::NOISE, "SINAD at 1 kHz", "dB"),
    number(step::NOISE, "largest spur at 1 kHz", "dB"),
    number(step::NOISE, "change by a busy link at 1 kHz", "dB"),
    number(step::NOISE, "SINAD at 10 kHz", "dB"),
    number(step::NOISE, "largest spur at 10 kHz", "dB"),
    number(step::NOISE, "change by a busy link at 10 kHz", "dB"),
    number(step::NOISE, "SINAD at 40 kHz", "dB"),
    number(step::NOISE, "largest spur at 40 kHz", "dB"),
    number(step::LOAD, "worst block", "%"),
    count(step::LOAD, "lost blocks"),
    count(step::LOAD, "underruns"),
    count(step::LOAD, "drives in that time"),
    count(step::CODES, "windows that differ"),
    count(step::CODES, "windows"),
    number(step::CODES, "compared time", "s"),
    number(step::TRIGGER, "trigger delay", "samples"),
    number(step::LINK, "longest answer", "s"),
    count(step::LINK, "damaged frames"),
    count(step::LINK, "repeated commands"),
    count(step::LINK, "reopenings"),
    count(step::LINK, "reopenings without answer"),
    count(step::STORE, "profiles that differ"),
    number(step::STORE, "longest write", "s"),
    count(step::STALL, "stall unnoticed"),
    number(step::STALL, "trigger delay after a stall", "samples"),
    count(step::BUTTONS, "pressed unasked"),
    count(step::BUTTONS, "not pressed in time"),
    count(step::BUTTONS, "not released in time"),
    count(step::BUTTONS, "stop input not opened in time"),
    count(step::BUTTONS, "stop input not closed in time"),
    count(step::BOOTLOADER, "stays in the program"),
    count(step::BOOTLOADER, "not back in time"),
    count(step::BOOTLOADER, "differences after it"),
    count(step::FAULTS, "faults that end otherwise"),
    count(step::FAULTS, "faults without return"),
    count(step::FAULTS, "safe mode after them"),
    number(step::FAULTS, "time to mute in a hang", "ms"),
    number(step::FAULTS, "time to mute with interrupts masked", "ms"),
    number(step::FAULTS, "time to mute by a stack overflow", "ms"),
    number(step::AMPLIFIER, "tone over noise", "dB"),
    number(step::AMPLIFIER, "rise by unmuting", "dB"),
];

/// The numbers of a step.
pub fn of(step: &str) -> impl Iterator<Item = &'static Quantity> {
    QUANTITIES.iter().filter(move |quantity| quantity.step == step)
}

/// A step's number of this name.
#[must_use]
pub fn quantity(step: &str, name: &str) -> Option<&'static Quantity> {
    of(step).find(|quantity| quantity.name == name)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::selftest::limits::LIMITS;

    #[test]
    fn every_limit_is_that_of_a_known_number() {
        for limit in LIMITS {
            assert!(quantity(limit.step, limit.quantity).is_some(), "{}: {}", limit.step, limit.quantity);
        }
        for (at, one) in QUANTITIES.iter().enumerate() {
            let is_same = |other: &&Quantity| (other.step, other.name) == (one.step, one.name);
            assert_eq!(QUANTITIES.iter().position(|other| is_same(&other)), Some(at), "{one:?} stands once");
        }
    }

    #[test]
    fn a_count_is_whole_and_not_negative() {
        let lost = quantity(step::LOAD, "lost blocks").unwrap();
        assert!(lost.allows(0.0) && lost.allows(3.0) && !lost.allows(-1.0) && !lost.allows(0.5));
        let lag = quantity(step::DELAY, "lag at 5 kHz").unwrap();
        assert!(lag.allows(-0.05) && !lag.allows(f64::NAN));
    }
}
