//! How fast the output is ramped to silence.

/// The way to silence.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stop {
    /// [`STOP_RAMP_MS`](slipline_protocol::limits::STOP_RAMP_MS).
    Normal,
    /// [`DEAD_MAN_RAMP_MS`](slipline_protocol::limits::DEAD_MAN_RAMP_MS).
    HostLost,
    /// [`EMERGENCY_RAMP_MS`](slipline_protocol::limits::EMERGENCY_RAMP_MS).
    Emergency,
}

impl Stop {
    /// The quicker of two.
    #[must_use]
    pub(crate) const fn quicker(self, other: Option<Self>) -> Self {
        match (self, other) {
            (Self::Emergency, _) | (_, Some(Self::Emergency)) => Self::Emergency,
            (Self::Normal, _) | (_, Some(Self::Normal)) => Self::Normal,
            (Self::HostLost, _) => Self::HostLost,
        }
    }
}
