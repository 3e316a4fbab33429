//! What can be wrong with a plate: every variant names the field and what is allowed.

use crate::numeral::typed;
use crate::range::Range;
use thiserror::Error;

/// Why a plate was refused.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum PlateError {
    /// A number is outside its range (or not a number).
    #[error("{field} = {}: must be {allowed}", typed(*.value))]
    OutOfRange {
        /// The field, as it is written in the plate file (`taper.half_width_m`).
        field: String,
        /// The value that was given, in the field's unit.
        value: f64,
        /// The range that is allowed, in words, with its unit.
        allowed: String,
    },
    /// A field that this kind of taper, model or drive end needs is not there.
    #[error("{field} is missing: {needed}")]
    Missing {
        /// The field, as it is written in the plate file.
        field: String,
        /// Who needs it and in which range.
        needed: String,
    },
    /// A field is there that this kind of taper, model or drive end does not have.
    #[error("{field} does not belong here: {reason}")]
    Unexpected {
        /// The field, as it is written in the plate file.
        field: String,
        /// Which fields belong here instead.
        reason: String,
    },
    /// Something of another kind than is due: a word that is not one of the allowed ones, or a text for a number.
    #[error("{field} = {value}: must be {allowed}")]
    UnknownKind {
        /// The field, as it is written in the plate file.
        field: String,
        /// What was given, as it stands in the file: a text with its quotes.
        value: String,
        /// What is allowed, in words.
        allowed: String,
    },
    /// A text is longer than allowed.
    #[error("{field} has {length} {unit}: must be {allowed}")]
    TooLong {
        /// The field, as it is written in the plate file.
        field: String,
        /// How long it is.
        length: usize,
        /// What the length counts.
        unit: &'static str,
        /// How long it may be, in words.
        allowed: String,
    },
    /// Two neighbouring points of a sampled taper do not narrow.
    #[error(
        "taper.points[{index}] = [{position_m}, {half_width_m}]: positions must increase and half-widths must \
         decrease from point to point"
    )]
    NotNarrowing {
        /// Number of the offending point, from 0.
        index: usize,
        /// Its position, metres.
        position_m: f64,
        /// Its half-width, metres.
        half_width_m: f64,
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
    pub(crate) fn field(&self) -> &str {
        match self {
            Self::OutOfRange { field, .. }
            | Self::Missing { field, .. }
            | Self::Unexpected { field, .. }
            | Self::UnknownKind { field, .. }
            | Self::TooLong { field, .. } => field,
            Self::NotNarrowing { .. } => "taper.points",
        }
    }
}

/// Refuses a value that is not in `low..=high`, naming the field, the range and the unit.
pub(crate) fn within(
    field: &str,
    value: f64,
    low: f64,
    high: f64,
    unit: &'static str,
) -> Result<(), PlateError> {
    Range::new(low, high, unit).check(field, value)
}
