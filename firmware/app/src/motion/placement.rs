//! Where a tone is at one sample index.

use slipline_protocol::table::Setting;
use slipline_protocol::units::{FinePosition, Gain, PhaseStep};

/// Where a tone is at one index.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Placement {
    /// Its place on the table.
    pub position: FinePosition,
    /// Its step and gain.
    pub setting: Setting,
    /// Its level.
    pub level: Gain,
}

impl Placement {
    /// The placement of a tone that has never sounded.
    pub(crate) const NOWHERE: Self = Self {
        position: FinePosition::saturating(0),
        setting: Setting { step: PhaseStep(0), gain: Gain(0) },
        level: Gain(0),
    };

    /// Whether its level is 0.
    #[must_use]
    pub const fn is_silent(&self) -> bool {
        self.level.0 == 0
    }

    /// Its amplitude, Q1.31.
    #[must_use]
    pub const fn amplitude(&self) -> Gain {
        self.setting.gain.times(self.level)
    }
}

/// How a tone begins that starts from silence.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Onset {
    /// Its phase; 2^64 = one turn.
    pub phase: u64,
    /// Its step.
    pub step: PhaseStep,
}
