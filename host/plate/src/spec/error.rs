//! What can be wrong with a plate: every variant names the field and what is allowed, in numbers. The words are in
//! [`super::wording`].

use crate::quantity::{Count, Range};
use thiserror::Error;

/// Why a plate was refused. Displayed in the words of a plate file; [`PlateError::told`] has others.
#[derive(Debug, Clone, PartialEq)]
pub enum PlateError {
    /// A number is outside its range (or not a number).
    OutOfRange {
        /// The field, as it is written in the plate file (`taper.half_width_m`).
        field: String,
        /// The value that was given, in the field's unit.
        value: f64,
        /// The range that is allowed, in the same unit.
        range: Range,
        /// What moves the range, where the plate's other numbers do and it does not go without saying.
        origin: Option<Origin>,
    },
    /// A number is in its own range, but what follows from it is not.
    Unfit {
        /// The field, as it is written in the plate file.
        field: String,
        /// The value that was given, in the field's unit.
        value: f64,
        /// What follows from it, and what is allowed of that.
        consequence: Consequence,
    },
    /// A field that this kind of taper, model or drive end needs is not there.
    Missing {
        /// The field, as it is written in the plate file.
        field: String,
        /// Who needs it and in which range.
        needed: String,
    },
    /// A field is there that this kind of taper, model or drive end does not have.
    Unexpected {
        /// The field, as it is written in the plate file.
        field: String,
        /// Which fields belong here instead.
        reason: String,
    },
    /// Something of another kind than is due: a word that is not one of the allowed ones, or a text for a number.
    UnknownKind {
        /// The field, as it is written in the plate file.
        field: String,
        /// What was given, as it stands in the file: a text with its quotes.
        value: String,
        /// What is allowed, in words.
        allowed: String,
    },
    /// A text or a list is too short or too long, or a text is not all on one line.
    WrongCount {
        /// The field, as it is written in the plate file.
        field: String,
        /// How many characters or points there are.
        count: usize,
        /// How many there may be, and of what.
        allowed: Count,
    },
    /// Two neighbouring points of a sampled taper do not narrow.
    NotNarrowing {
        /// Number of the offending point, from 0.
        index: usize,
        /// Its position, metres.
        position_m: f64,
        /// Its half-width, metres.
        half_width_m: f64,
    },
}

/// What moves the range of a field.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Origin {
    /// The lowest frequency that enters the plate.
    Entry,
    /// The lowest frequency that enters the plate (or the start of the band), itself not allowed, and the highest that
    /// turns on it.
    Turning,
    /// The lowest frequency of the design's band, Hz.
    BandLow(f64),
    /// The driven end, where the taper begins.
    DrivenEnd,
    /// The plate's length, metres, all of which has to have a width.
    Length(f64),
    /// The half-width at the plate's end, metres, which the taper would make too small.
    EndHalfWidth(f64),
}

/// What follows from a number and is not allowed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Consequence {
    /// The frequency that a boundary at this place needs, Hz, is outside [`super::limits::FREQUENCY`].
    Frequency(f64),
    /// The frequencies of the span's two ends, Hz, are more than [`super::limits::BAND_RATIO_MAX`] apart.
    BandRatio(f64, f64),
    /// So many wavelengths lie before this place, more than [`super::limits::WAVELENGTHS_MAX`].
    Wavelengths(f64),
    /// The plate is too short for a design's margins.
    Margins {
        /// The band whose peak and tail need them, Hz.
        band_hz: (f64, f64),
        /// Both together, metres.
        margins_m: f64,
    },
}

/// Why a plate file was refused, with the line where that is known.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum PlateFileError {
    /// The file is too big to be a plate; it was not parsed.
    #[error("the plate file has {bytes} bytes: must be at most {limit}")]
    TooBig {
        /// Size of the text, bytes.
        bytes: usize,
        /// Largest size that is read, bytes.
        limit: usize,
    },
    /// The text is not TOML, or holds a field no plate has.
    #[error("line {line}: {message}")]
    Syntax {
        /// Line of the fault, from 1.
        line: usize,
        /// The parser's sentence.
        message: String,
    },
    /// The text is TOML but no plate.
    #[error("{}{error}", .line.map(|line| format!("line {line}: ")).unwrap_or_default())]
    Plate {
        /// Line of the field, from 1, where it could be found.
        line: Option<usize>,
        /// What is wrong with which field.
        error: PlateError,
    },
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
            | Self::WrongCount { field, .. } => field,
            Self::NotNarrowing { .. } => "taper.points",
        }
    }

    pub(crate) fn unfit(field: &str, value: f64, consequence: Consequence) -> Self {
        Self::Unfit { field: field.to_owned(), value, consequence }
    }
}

impl std::error::Error for PlateError {}

impl Range {
    /// Refuses what is not allowed, naming the field.
    pub(crate) fn check(self, field: &str, value: f64) -> Result<(), PlateError> {
        if self.contains(value) { Ok(()) } else { Err(self.refuse(field, value, None)) }
    }

    /// As [`Range::check`], naming what moves the range too.
    pub(crate) fn check_from(self, origin: Origin, field: &str, value: f64) -> Result<(), PlateError> {
        if self.contains(value) { Ok(()) } else { Err(self.refuse(field, value, Some(origin))) }
    }

    pub(crate) fn refuse(self, field: &str, value: f64, origin: Option<Origin>) -> PlateError {
        PlateError::OutOfRange { field: field.to_owned(), value, range: self, origin }
    }
}

impl Count {
    /// Refuses a text that is not allowed, naming the field.
    pub(crate) fn check_text(self, field: &str, text: &str) -> Result<(), PlateError> {
        if self.allows(text) { Ok(()) } else { Err(self.refuse(field, text.chars().count())) }
    }

    pub(crate) fn refuse(self, field: &str, count: usize) -> PlateError {
        PlateError::WrongCount { field: field.to_owned(), count, allowed: self }
    }
}
