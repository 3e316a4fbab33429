//! Faults, which stay latched until a command clears them: one fault, and the set of all that are latched.

use crate::minor::Minor;
use crate::schema::{Shape, Wire, choices};
use serde::{Deserialize, Serialize};

choices! {
    /// One kind of fault: its bit in a set is its number.
    pub enum Fault {
        /// The host fell silent while the device was driving.
        0 since 0 HostLost,
        /// The emergency stop was used.
        1 since 0 EmergencyStop,
        /// The DAC ran out of samples.
        2 since 0 Underrun,
        /// The coil's computed temperature reached its limit.
        3 since 0 Overheat,
        /// The device drove for the longest allowed time without a command from the user.
        4 since 0 DriveTime,
        /// The watchdog reset the device.
        5 since 0 Watchdog,
        /// The program had panicked or faulted.
        6 since 0 Crash,
        /// The supply voltage had dipped.
        7 since 0 BrownOut,
        /// The stored configuration was damaged.
        8 since 0 StoreDamaged,
        /// One of the two places of the kept table is torn or has decayed; the table in the other is in use, and may be
        /// an older one. A host of 1.0 gets `StoreDamaged`.
        9 since 1 StoreFellBack or Self::StoreDamaged,
        /// The stop on the desk was used: the board's button, or the stop input. It can be cleared 2 s after the button was
        /// released. A host of 1.2 gets `EmergencyStop`.
        10 since 3 DeskStop or Self::EmergencyStop,
        /// The newest copy of the actuator's profile is damaged; the older one is in force. It stands until it is cleared, or a
        /// profile is written, with the board's user button held. A host of 1.2 gets `StoreFellBack`.
        11 since 3 ProfileFellBack or Self::StoreFellBack,
    }
}

impl Fault {
    /// Every fault, in the order of the bits.
    pub const ALL: &'static [Self] = &[
        Self::HostLost,
        Self::EmergencyStop,
        Self::Underrun,
        Self::Overheat,
        Self::DriveTime,
        Self::Watchdog,
        Self::Crash,
        Self::BrownOut,
        Self::StoreDamaged,
        Self::StoreFellBack,
        Self::DeskStop,
        Self::ProfileFellBack,
    ];

    /// What happened, as a user reads it.
    #[must_use]
    pub const fn text(self) -> &'static str {
        match self {
            Self::HostLost => "the host fell silent while driving",
            Self::EmergencyStop => "emergency stop",
            Self::Underrun => "the DAC ran out of samples",
            Self::Overheat => "the actuator is too hot",
            Self::DriveTime => "10 minutes without a command",
            Self::Watchdog => "the watchdog reset the device",
            Self::Crash => "the firmware crashed",
            Self::BrownOut => "the supply voltage dipped",
            Self::StoreDamaged => "the stored configuration was damaged",
            Self::StoreFellBack => {
                "one copy of the stored table was damaged, the other is in use and may be older; store the table again"
            }
            Self::DeskStop => {
                "stopped at the device, by its button or its stop input; it can be cleared 2 s after the button is released"
            }
            Self::ProfileFellBack => {
                "the newest copy of the actuator's profile is damaged, an older one is in force: hold the board's user \
                 button and clear the fault, or write the profile again"
            }
        }
    }
}

/// A set of latched faults; bit `n` is the fault numbered `n`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Faults(pub u32);

impl Faults {
    /// No fault.
    pub const NONE: Self = Self(0);

    /// This set and one more.
    #[must_use]
    pub const fn with(self, fault: Fault) -> Self {
        Self(self.0 | 1 << fault as u8)
    }

    /// This set without one.
    #[must_use]
    pub const fn without(self, fault: Fault) -> Self {
        Self(self.0 & !(1 << fault as u8))
    }

    /// Whether a fault is in the set.
    #[must_use]
    pub const fn contains(self, fault: Fault) -> bool {
        self.0 & (1 << fault as u8) != 0
    }

    /// Whether there is none.
    #[must_use]
    pub const fn is_empty(self) -> bool {
        self.0 == 0
    }

    /// The faults in the set, in the order of their bits.
    pub fn iter(self) -> impl Iterator<Item = Fault> {
        Fault::ALL.iter().copied().filter(move |&fault| self.contains(fault))
    }
}

impl Wire for Faults {
    const SHAPE: &'static Shape = &Shape::U32;

    fn lowered(&self, minor: Minor) -> Self {
        self.iter().fold(*self, |set, fault| set.without(fault).with(fault.lowered(minor)))
    }
}

impl core::fmt::Display for Faults {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        if self.is_empty() {
            return f.write_str("none");
        }
        for (i, fault) in self.iter().enumerate() {
            if i > 0 {
                f.write_str(", ")?;
            }
            f.write_str(fault.text())?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;

    #[test]
    fn the_text_of_the_drive_time_fault_reports_its_limit() {
        let minutes = crate::limits::MAX_DRIVE_MS / 60_000;
        assert!(Fault::DriveTime.text().starts_with(&std::format!("{minutes} minutes ")));
    }
}
