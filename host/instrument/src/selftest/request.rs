//! What a self-test is asked to do.

use std::str::FromStr;

/// A wire between two pins of a board.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Wire {
    /// From the DAC's pin to the sensor's.
    DacToSensor,
    /// From the trigger output to the trigger input.
    Trigger,
}

impl Wire {
    /// All of them.
    pub const ALL: [Self; 2] = [Self::DacToSensor, Self::Trigger];

    /// As it is written: `dac=sensor` or `trigger=trigger-in`.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::DacToSensor => "dac=sensor",
            Self::Trigger => "trigger=trigger-in",
        }
    }
}

/// A text that names no wire.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("a wire is dac=sensor or trigger=trigger-in")]
pub struct NoSuchWire;

impl FromStr for Wire {
    type Err = NoSuchWire;

    fn from_str(text: &str) -> Result<Self, NoSuchWire> {
        Self::ALL.into_iter().find(|wire| wire.name() == text.trim()).ok_or(NoSuchWire)
    }
}

/// What a self-test is asked to do.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct SelftestRequest {
    /// A wire leads from the DAC's pin to the sensor's.
    pub has_sensor_wire: bool,
    /// A wire leads from the trigger output to the trigger input.
    pub has_trigger_wire: bool,
    /// The amplifier is unplugged: steps may take the mute pin high.
    pub is_amplifier_unplugged: bool,
    /// The amplifier is connected and on: it alone is tested, quietly, with what needs no drive.
    pub is_amplifier_on: bool,
    /// A person at the board presses its button when asked.
    pub asks: bool,
    /// In three seconds of the device's time: fewer codes, and the clocks over that time alone.
    pub is_short: bool,
    /// Seed of the random drives.
    pub seed: u64,
}

impl SelftestRequest {
    /// The same with these wires, and no others.
    #[must_use]
    pub fn with_wires(self, wires: &[Wire]) -> Self {
        let has = |wire| wires.contains(&wire);
        Self { has_sensor_wire: has(Wire::DacToSensor), has_trigger_wire: has(Wire::Trigger), ..self }
    }

    /// The fitted wires.
    pub fn wires(self) -> impl Iterator<Item = Wire> {
        let has = move |wire: &Wire| match wire {
            Wire::DacToSensor => self.has_sensor_wire,
            Wire::Trigger => self.has_trigger_wire,
        };
        Wire::ALL.into_iter().filter(has)
    }
}
