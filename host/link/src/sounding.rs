//! A drive, chord or comb to be played, in metres, shares and seconds: tones by their places, or by their
//! multiples of a base frequency.

use crate::chord::ChordRequest;
use crate::comb::CombRequest;
use crate::drive::{DriveError, DriveRequest};
use slipline_protocol::Command;
use slipline_protocol::command::{Apply, TableHeader, TravelLimit};
use slipline_protocol::event::Identity;

/// A drive, chord or comb to be played; a newer one replaces it.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub enum Sounding {
    /// Tones at places.
    Drive(DriveRequest),
    /// Multiples of one base frequency, starting from silence.
    Chord(ChordRequest),
    /// Multiples of one low base frequency, starting from silence.
    Comb(CombRequest),
}

impl From<DriveRequest> for Sounding {
    fn from(drive: DriveRequest) -> Self {
        Self::Drive(drive)
    }
}

impl Sounding {
    /// The same with another beginning.
    #[must_use]
    pub fn beginning(self, apply: Apply) -> Self {
        match self {
            Self::Drive(drive) => Self::Drive(DriveRequest { apply, ..drive }),
            Self::Chord(chord) => Self::Chord(ChordRequest { apply, ..chord }),
            Self::Comb(comb) => Self::Comb(CombRequest { apply, ..comb }),
        }
    }

    /// The command in a device's own units.
    pub(crate) fn for_device(
        &self,
        identity: &Identity,
        table: Option<&TableHeader>,
        travel: Option<&TravelLimit>,
    ) -> Result<Command, DriveError> {
        Ok(match self {
            Self::Drive(drive) => Command::Drive(drive.for_device(identity, table, travel)?),
            Self::Chord(chord) => Command::Chord(chord.for_device(identity, travel)?),
            Self::Comb(comb) => Command::Comb(comb.for_device(identity, travel)?),
        })
    }
}
