//! What may be wrong at a rig.

use slipline_plate::quantity::Range;

/// Something wrong at the rig.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum RigFault {
    /// The sensor's plug is out: its input sees noise alone.
    Unplugged,
    /// The sensor's amplifier is set 60 dB too high: the input clips.
    Clipped,
    /// The sensor stands so many metres farther from the driven end than its mark (-0.1 to 0.1); within the plate.
    OffItsMark(f64),
    /// The input's converter gives the same code for ever (0 to 4095).
    Stuck(u16),
    /// A wire of the motor is open: no force and no current.
    OpenMotor,
    /// The amplifier has no gain: a fiftieth of its voltage reaches the motor.
    NoAmplifier,
    /// Another motor of the same kind, which takes so many times the current at rest (0.01 to 100): a coil of a fraction of
    /// the resistance, a piezo of a multiple of the capacitance. It pushes with as many times the force.
    WrongMotor(f64),
    /// The motor is shorted: no force, and a current of 60 dB more than its largest.
    ShortedMotor,
}

impl RigFault {
    /// How far a sensor may be off its mark.
    pub const OFF: Range = Range::new(-0.1, 0.1, "m");
    /// How many times the current of the told motor another one takes.
    pub const OTHER: Range = Range::new(0.01, 100.0, "");
    /// What is left of the voltage without an amplifier.
    const LEAK: f64 = 0.02;
    /// A gain of 60 dB.
    pub(super) const TOO_MUCH: f64 = 1000.0;

    /// The voltage of the motor over that of the healthy rig; a motor of another force counts as one at another voltage.
    pub(super) const fn drive(self) -> f64 {
        match self {
            Self::OpenMotor | Self::ShortedMotor => 0.0,
            Self::NoAmplifier => Self::LEAK,
            Self::WrongMotor(times) => times,
            Self::Unplugged | Self::Clipped | Self::OffItsMark(_) | Self::Stuck(_) => 1.0,
        }
    }
}
