//! Faults of a rig.

use slipline_plate::quantity::Range;

/// A fault of the rig.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
pub enum RigFault {
    /// The sensor is unplugged: its input samples noise only.
    Unplugged,
    /// The sensor's amplifier is set 60 dB too high: the input clips.
    Clipped,
    /// The sensor stands this distance beyond its mark, metres (-0.1 to 0.1); within the plate.
    OffItsMark(f64),
    /// The input's converter always gives this code (0 to 4095).
    Stuck(u16),
    /// A wire of the motor is open: no force and no current.
    OpenMotor,
    /// The amplifier has no gain: a fiftieth of its voltage reaches the motor.
    NoAmplifier,
    /// Another motor of the same kind, with this multiple of the current at rest (0.01 to 100): a coil with a
    /// fraction of the resistance, or a piezo with a multiple of the capacitance. Its force has the same
    /// factor.
    WrongMotor(f64),
    /// The motor is shorted: no force, and a current 60 dB above its largest.
    ShortedMotor,
}

impl RigFault {
    /// Allowed distance of a sensor from its mark.
    pub const OFF: Range = Range::new(-0.1, 0.1, "m");
    /// Allowed factor of another motor's current.
    pub(crate) const OTHER: Range = Range::new(0.01, 100.0, "");
    /// Share of the voltage without an amplifier.
    const LEAK: f64 = 0.02;
    /// A gain of 60 dB.
    pub(super) const TOO_MUCH: f64 = 1000.0;

    /// Voltage of the motor over that of the healthy rig; a motor of another force is treated as one at
    /// another voltage.
    pub(super) const fn drive(self) -> f64 {
        match self {
            Self::OpenMotor | Self::ShortedMotor => 0.0,
            Self::NoAmplifier => Self::LEAK,
            Self::WrongMotor(times) => times,
            Self::Unplugged | Self::Clipped | Self::OffItsMark(_) | Self::Stuck(_) => 1.0,
        }
    }
}
