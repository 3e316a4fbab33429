//! Why a plate is refused. Every variant carries the field and what is allowed as data; the sentences are in
//! [`super::wording`].

use crate::quantity::{Count, Range, WrongCount};
use std::fmt::Display;
use thiserror::Error;

/// Why a plate was refused. `Display` names the fields as a plate file does; [`PlateError::worded`] can use other names.
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
#[non_exhaustive]
pub enum PlateError {
    /// A number is outside its range (or not a number).
    OutOfRange {
        /// The field, as it is written in the plate file (`taper.half_width_m`).
        field: String,
        /// The value that was given, in the field's unit.
        value: f64,
        /// The range that is allowed, in the same unit.
        range: Range,
        /// The reason for the range, if it depends on other fields of the plate.
        origin: Option<Origin>,
    },
    /// A number is in its range, but a quantity that follows from it is not.
    Unfit {
        /// The field, as it is written in the plate file.
        field: String,
        /// The value that was given, in the field's unit.
        value: f64,
        /// What follows from it, and what is allowed of that.
        consequence: Consequence,
    },
    /// A field that this kind of taper, model or drive end needs is absent.
    Missing {
        /// The field, as it is written in the plate file.
        field: String,
        /// Which kind needs it, its meaning and its range, in words.
        needed: String,
    },
    /// A field is present that this kind of taper, model or drive end does not have.
    Unexpected {
        /// The field, as it is written in the plate file.
        field: String,
        /// Which fields belong here instead.
        reason: String,
    },
    /// A value of the wrong type, for instance a text for a number, or a word that is not one of the allowed ones.
    UnknownKind {
        /// The field, as it is written in the plate file.
        field: String,
        /// The value as in the file: a text with its quotes.
        value: String,
        /// What is allowed, in words.
        allowed: String,
    },
    /// A text or a list is too short or too long.
    WrongCount {
        /// The field, as it is written in the plate file.
        field: String,
        /// How many characters or points there are.
        count: usize,
        /// How many there may be, and of what.
        allowed: Count,
    },
    /// A text has a line break or another control character.
    ControlCharacter {
        /// The field, as it is written in the plate file.
        field: String,
        /// Which of the text's characters it is, from 0.
        place: usize,
        /// The character.
        character: char,
    },
    /// The taper does not narrow from one sampled point to the next.
    NotNarrowing {
        /// Index of the second of the two points, from 0.
        index: usize,
        /// Its position, metres.
        position_m: f64,
        /// Its half-width, metres.
        half_width_m: f64,
    },
}

/// Why a field has the range it has, where the range depends on other fields.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
pub enum Origin {
    /// The lowest frequency that enters the plate.
    Entry,
    /// The range goes from the lowest frequency that enters the plate, or the start of the band, to the highest that
    /// turns on the plate. The lower end itself is not allowed.
    Turning,
    /// The lowest frequency of the design's band, Hz.
    BandLow(f64),
    /// The driven end, where the taper begins.
    DrivenEnd,
    /// The plate's length, metres: the points must cover all of it.
    Length(f64),
    /// The half-width at the plate's end, metres, which would be too small.
    EndHalfWidth(f64),
    /// The actuator's peak travel, metres: at full scale it may move at most [`super::limits::TRAVEL_RATIO_MAX`] times
    /// as far.
    PeakTravel(f64),
    /// The frequencies of a measured curve rise from point to point.
    Rising,
}

/// The quantity that follows from a number and is out of its range.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
pub enum Consequence {
    /// The frequency of a boundary at this position, Hz, is outside [`super::limits::FREQUENCY`].
    Frequency(f64),
    /// The ratio of the frequencies at the span's end and start exceeds [`super::limits::BAND_RATIO_MAX`]; the values
    /// are the start's and the end's frequency, Hz.
    BandRatio(f64, f64),
    /// This number of wavelengths lies before the position, more than [`super::limits::WAVELENGTHS_MAX`].
    Wavelengths(f64),
    /// Here the plate does not narrow faster than the root of its thickness, so no wave turns.
    Turning {
        /// Where, metres from the driven end.
        place_m: f64,
    },
    /// At the farthest boundary the plate is so narrow for the stiffness of its film that the wavenumber is off by more than
    /// [`super::limits::FILM_PERCENT`].
    Film {
        /// The half-width there, metres.
        half_width_m: f64,
        /// What is missed of the wavenumber, %.
        percent: f64,
        /// The thickest film of the same material and wave speed that is allowed there, metres.
        thickest_m: f64,
    },
    /// The plate is so short that a design's edges would converge too steeply.
    Converging {
        /// The lowest frequency of the band, Hz: it turns where they are steepest.
        frequency_hz: f64,
    },
    /// The plate is too short for a design's margins.
    Margins {
        /// The band, Hz: its lowest frequency needs room for the peak, its highest for the tail.
        band_hz: (f64, f64),
        /// The sum of both margins, metres.
        margins_m: f64,
    },
}

/// Why a plate file was refused, with the line if it is known.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum PlateFileError {
    /// The file exceeds [`crate::PLATE_FILE_BYTES_MAX`] and was not parsed.
    #[error(transparent)]
    TooBig(#[from] WrongCount),
    /// The text is not TOML.
    #[error("line {line}: {message}")]
    Syntax {
        /// Line of the fault, from 1.
        line: usize,
        /// The parser's message, preceded by the field's name if the line has one.
        message: String,
    },
    /// The text is TOML but does not describe a valid plate.
    #[error("{}{error}", .line.map(|line| format!("line {line}: ")).unwrap_or_default())]
    Plate {
        /// Line of the field, from 1; `None` if neither the field nor its section is in the text.
        line: Option<usize>,
        /// What is wrong with which field.
        error: PlateError,
    },
}

impl PlateFileError {
    /// The same without a line, for a text that the user did not write.
    #[must_use]
    pub fn without_line(self) -> Self {
        match self {
            Self::Plate { error, .. } => Self::Plate { line: None, error },
            other => other,
        }
    }
}

impl PlateError {
    /// The field that is wrong, as it is written in the plate file.
    pub fn field(&self) -> &str {
        match self {
            Self::OutOfRange { field, .. }
            | Self::Unfit { field, .. }
            | Self::Missing { field, .. }
            | Self::Unexpected { field, .. }
            | Self::UnknownKind { field, .. }
            | Self::ControlCharacter { field, .. }
            | Self::WrongCount { field, .. } => field,
            Self::NotNarrowing { .. } => "taper.points",
        }
    }

    pub(crate) fn unexpected(field: &str, reason: &str) -> Self {
        Self::Unexpected { field: field.to_owned(), reason: reason.to_owned() }
    }

    pub(crate) fn unfit(field: &str, value: f64, consequence: Consequence) -> Self {
        Self::Unfit { field: field.to_owned(), value, consequence }
    }
}

impl std::error::Error for PlateError {}

impl Range {
    /// Refuses a value outside the range; the error names the field.
    ///
    /// # Errors
    /// [`PlateError::OutOfRange`].
    pub fn check(self, field: impl Display, value: f64) -> Result<(), PlateError> {
        if self.contains(value) { Ok(()) } else { Err(self.refuse(&field.to_string(), value, None)) }
    }

    /// As [`Range::check`]; the error also carries the reason for the range.
    pub(crate) fn check_from(
        self,
        origin: Origin,
        field: impl Display,
        value: f64,
    ) -> Result<(), PlateError> {
        if self.contains(value) { Ok(()) } else { Err(self.refuse(&field.to_string(), value, Some(origin))) }
    }

    pub(crate) fn refuse(self, field: &str, value: f64, origin: Option<Origin>) -> PlateError {
        PlateError::OutOfRange { field: field.to_owned(), value, range: self, origin }
    }
}

impl Count {
    /// Refuses a text of the wrong length or with control characters; the error names the field.
    pub(crate) fn check_text(self, field: &str, text: &str) -> Result<(), PlateError> {
        match text.chars().position(char::is_control) {
            Some(place) => {
                let character = text.chars().nth(place).unwrap_or_default();
                Err(PlateError::ControlCharacter { field: field.to_owned(), place, character })
            }
            None if self.allows(text) => Ok(()),
            None => Err(self.refuse(field, text.chars().count())),
        }
    }

    /// Refuses a count that is not allowed; the error names the field.
    ///
    /// # Errors
    /// [`PlateError::WrongCount`].
    pub fn check(self, field: &str, count: usize) -> Result<(), PlateError> {
        if self.contains(count) { Ok(()) } else { Err(self.refuse(field, count)) }
    }

    fn refuse(self, field: &str, count: usize) -> PlateError {
        PlateError::WrongCount { field: field.to_owned(), count, allowed: self }
    }
}
