//! State of a level hold, as the user who has switched it on sees it.

use super::end::HoldEnd;
use slipline_link::HoldState;
use slipline_link::protocol::hold::Held;
use std::fmt;

/// State of the level hold.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Standing<'a> {
    /// Off; with the reason if it has ended by itself.
    Off(Option<&'a HoldEnd>),
    /// Waiting for the device's next status.
    Waiting,
    /// No tone sounds.
    Silent,
    /// The drive still changes; listening begins once it rests.
    Changing,
    /// Listening to the untouched plate; the total time in seconds.
    Listening(f64),
    /// The device holds the levels; `None` until it has reported their state.
    Holding(Option<&'a Held>),
}

impl fmt::Display for Standing<'_> {
    /// A sentence without a full stop.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Off(None) => f.write_str("Off"),
            Self::Off(Some(end)) => write!(f, "Not held any more: {end}"),
            Self::Waiting => f.write_str("Waiting for the device"),
            Self::Silent => f.write_str("Waiting: nothing sounds"),
            Self::Changing => f.write_str("Waiting until nothing is changed: then the levels are held again"),
            Self::Listening(for_s) => {
                write!(f, "Listening for {for_s:.1} s: leave the plate untouched")
            }
            Self::Holding(None) => f.write_str("Holding begins"),
            Self::Holding(Some(held)) => f.write_str(match worst(held) {
                HoldState::Lost(_) => "Holding, but not every tone",
                HoldState::AtLimit(_) => "Holding, at a limit",
                HoldState::Settling => "Holding, on the way",
                HoldState::Held => "Holding: the plate may be touched",
            }),
        }
    }
}

/// The state of the tone in the worst state.
fn worst(held: &Held) -> HoldState {
    let rank = |state: &HoldState| match state {
        HoldState::Held => 0,
        HoldState::Settling => 1,
        HoldState::AtLimit(_) => 2,
        HoldState::Lost(_) => 3,
    };
    held.tones.iter().map(|tone| tone.state).max_by_key(rank).unwrap_or(HoldState::Settling)
}
