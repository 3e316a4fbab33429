//! The allowed range of a field's number, and of the length of a text or a list.

use super::number_format::{at_least, at_most, typed};
use crate::StaticText;
use std::fmt;

/// The allowed range of a number, both ends included; an infinite end sets no limit. Displayed as `0.005 to 10 m`,
/// each end as a user would type it: rounded inwards to five digits, so that the displayed ends are allowed.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Range {
    /// Lower end.
    pub low: f64,
    /// Upper end.
    pub high: f64,
    /// Unit of both; empty for a pure number.
    #[serde(with = "crate::static_text")]
    pub unit: StaticText,
}

impl Range {
    /// A range from `low` to `high` in a unit.
    pub const fn new(low: f64, high: f64, unit: &'static str) -> Self {
        Self { low, high, unit }
    }

    /// A range from `low` upwards.
    pub const fn at_least(low: f64, unit: &'static str) -> Self {
        Self::new(low, f64::INFINITY, unit)
    }

    /// A range up to `high`.
    pub const fn at_most(high: f64, unit: &'static str) -> Self {
        Self::new(f64::NEG_INFINITY, high, unit)
    }

    /// The same range with its ends rounded inwards to five digits, as in messages.
    #[must_use]
    pub fn rounded(self) -> Self {
        Self { low: at_least(self.low, 5), high: at_most(self.high, 5), unit: self.unit }
    }

    /// The range in words without its unit; `number` formats each finite end.
    pub fn in_words(self, number: impl Fn(f64) -> String) -> String {
        let Self { low, high, .. } = self;
        match (low.is_finite(), high.is_finite()) {
            (false, true) => format!("at most {}", number(high)),
            (true, false) => format!("at least {}", number(low)),
            _ => format!("{} to {}", number(low), number(high)),
        }
    }

    /// Whether a number is allowed; NaN is not.
    pub fn contains(self, value: f64) -> bool {
        (self.low..=self.high).contains(&value)
    }
}

impl fmt::Display for Range {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.rounded().in_words(typed))?;
        if self.unit.is_empty() { Ok(()) } else { write!(f, " {}", self.unit) }
    }
}

/// The allowed length of a text or a list, both ends included. Displayed as `1 to 80`, or `at most 80`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub struct Count {
    /// Smallest count.
    pub least: usize,
    /// Largest count.
    pub most: usize,
    /// The counted items.
    pub of: Counted,
}

/// The items that a [`Count`] counts.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub enum Counted {
    /// Characters of a text on one line, without control characters.
    Characters,
    /// Points of a list.
    Points,
    /// Bytes of a file.
    Bytes,
    /// Cells of a grid.
    Cells,
    /// Tones of a drive.
    Tones,
    /// Fields of a file.
    Fields,
}

impl Count {
    /// A count from `least` to `most`.
    pub const fn new(least: usize, most: usize, of: Counted) -> Self {
        Self { least, most, of }
    }

    /// A count up to `most`.
    pub const fn at_most(most: usize, of: Counted) -> Self {
        Self::new(0, most, of)
    }

    /// The range with its items: `1 to 80 characters`.
    #[must_use]
    pub fn with_unit(self) -> String {
        format!("{self} {}", self.of)
    }

    /// Whether this number is allowed.
    pub fn contains(self, count: usize) -> bool {
        (self.least..=self.most).contains(&count)
    }

    /// Whether a text has an allowed length and is on one line.
    pub fn allows(self, text: &str) -> bool {
        self.contains(text.chars().count()) && !text.chars().any(char::is_control)
    }
}

impl fmt::Display for Count {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.least {
            0 => write!(f, "at most {}", self.most),
            least => write!(f, "{least} to {}", self.most),
        }
    }
}

impl Counted {
    /// Further conditions on the items, as the end of a sentence.
    pub(super) const fn rule(self) -> &'static str {
        match self {
            Self::Characters => ", on one line, without control characters",
            Self::Points | Self::Bytes | Self::Cells | Self::Tones | Self::Fields => "",
        }
    }
}

impl fmt::Display for Counted {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Characters => "characters",
            Self::Points => "points",
            Self::Bytes => "bytes",
            Self::Cells => "cells",
            Self::Tones => "tones",
            Self::Fields => "fields",
        })
    }
}
