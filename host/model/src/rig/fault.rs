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
    /// A wire of the motor is open, or the amplifier is off: no force and no current.
    OpenMotor,
    /// The motor is shorted: no force, and a current of 60 dB more than its largest.
    ShortedMotor,
}

impl RigFault {
    /// How far a sensor may be off its mark.
    pub const OFF: Range = Range::new(-0.1, 0.1, "m");
    /// A gain of 60 dB.
    pub(super) const TOO_MUCH: f64 = 1000.0;

    /// Whether the motor moves the plate.
    pub(super) const fn drives(self) -> bool {
        !matches!(self, Self::OpenMotor | Self::ShortedMotor)
    }
}
