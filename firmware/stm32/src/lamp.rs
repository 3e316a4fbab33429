//! The patterns of the status lamp (the table in BOARDS.md).
//!
//! A pattern is eight steps of 100 ms, played again and again; a set bit is light, the highest bit comes first.

/// The lamp's patterns by urgency, the most urgent last.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Lamp {
    /// No fault, amplifier muted: one short flash.
    Muted,
    /// The amplifier is on: steady light.
    Sounding,
    /// The brown-out level is not set (BOARDS.md says how to set it): two short flashes.
    NoBrownOutLevel,
    /// The mute pin has no resistor, and the amplifier stays muted: three short flashes.
    NoMuteResistor,
    /// The clock that times the samples is absent, and the amplifier stays muted: one long flash.
    NoClock,
    /// The device started after repeated crashes and does not drive: fast blinking.
    SafeMode,
}

impl Lamp {
    /// The eight steps.
    pub(crate) const fn pattern(self) -> u8 {
        match self {
            Self::Muted => 0b1000_0000,
            Self::Sounding => 0b1111_1111,
            Self::NoBrownOutLevel => 0b1010_0000,
            Self::NoMuteResistor => 0b1010_1000,
            Self::NoClock => 0b1111_0000,
            Self::SafeMode => 0b1010_1010,
        }
    }

    /// Whether the lamp is lit in this step of 100 ms.
    pub(crate) const fn is_lit(self, step: u32) -> bool {
        self.pattern() >> (7 - step % 8) & 1 == 1
    }
}

#[cfg(test)]
mod tests {
    use super::Lamp;

    #[test]
    fn the_patterns_differ_in_their_number_of_flashes() {
        let flashes = |lamp: Lamp| (0..8).filter(|&n| lamp.is_lit(n) && !lamp.is_lit(n + 1)).count();
        assert_eq!(flashes(Lamp::Muted), 1);
        assert_eq!(flashes(Lamp::Sounding), 0);
        assert_eq!(flashes(Lamp::NoBrownOutLevel), 2);
        assert_eq!(flashes(Lamp::NoMuteResistor), 3);
        assert_eq!(flashes(Lamp::SafeMode), 4);
        assert!(Lamp::Sounding.is_lit(3));
        // Its one flash is long.
        assert_eq!(flashes(Lamp::NoClock), 1);
        assert!(Lamp::NoClock.is_lit(3) && !Lamp::Muted.is_lit(3));
    }
}
