//! The report of a check: lights, each with a number, a colour and a sentence.

use super::interval;
use super::stretch::Stretch;
use super::thresholds::Limits;
use crate::StaticText;
use crate::quantity::number_format::{significant, typed, with_decimals};
use serde::Serialize;

/// Colour of a light, in rising order of concern.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, serde::Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Colour {
    /// The plate file lacks an input of this check.
    Unchecked,
    /// No concern.
    Green,
    /// Usable with the limitation that the sentence states.
    Amber,
    /// Not usable or not reliable.
    Red,
}

impl Colour {
    /// The colour as a word: `unchecked`, `green`, `amber` or `red`.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Unchecked => "unchecked",
            Self::Green => "green",
            Self::Amber => "amber",
            Self::Red => "red",
        }
    }
}

/// The limits of a light's number.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, serde::Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Limit {
    /// Green and amber up to these values; red above.
    AtMost(Limits),
    /// Green and amber from these values on; red below.
    AtLeast(Limits),
}

impl Limit {
    /// In words, with the unit of the light's number: `green up to 1 dB, amber up to 6.02 dB`.
    #[must_use]
    pub fn words(self, unit: &str) -> String {
        let shown = |value: f64| format!("{} {unit}", typed(value)).trim_end().to_owned();
        match self {
            Self::AtMost(Limits { green, amber }) => {
                format!("green up to {}, amber up to {}", shown(green), shown(amber))
            }
            Self::AtLeast(Limits { green, amber }) => {
                format!("green from {}, amber from {}", shown(green), shown(amber))
            }
        }
    }
}

/// One validity light.
#[derive(Debug, Clone, PartialEq, Serialize, serde::Deserialize)]
pub struct Light {
    /// The check; the same words for every plate.
    #[serde(with = "crate::static_text")]
    pub name: StaticText,
    /// The number behind the light; `None` where there is none (no ghost boundary, no second tone).
    // JSON, in `unit`, or SI: The number; null where there is none
    pub value: Option<f64>,
    /// The lowest `value` at the ends of the intervals of a calibrated plate; `None` for an uncalibrated one, and
    /// where the number does not depend on the measurement.
    // JSON, unit of `value`: Lower end of the 95 % interval; null where there is none
    pub low: Option<f64>,
    /// The highest `value` at these ends.
    // JSON, unit of `value`: Upper end of the 95 % interval; null where there is none
    pub high: Option<f64>,
    /// Unit of `value`; empty for a plain number.
    // JSON, text: Unit of `value`; empty for a pure number
    #[serde(with = "crate::static_text")]
    pub unit: StaticText,
    /// Limits of `value`; `None` where the colour does not follow from `value` alone.
    pub limit: Option<Limit>,
    /// The result.
    // JSON, text: unchecked, green, amber or red
    pub colour: Colour,
    /// One sentence: the meaning of the result and, unless it is green, a remedy.
    // JSON, text: Meaning of the light, and a remedy
    pub sentence: String,
    /// The boundary of this result, metres; over a span the one with the worst result.
    #[serde(rename = "turning_point_m")]
    pub boundary_m: f64,
    /// The parts of the plate where the check fails; empty if the light is green or unchecked, and for a check
    /// without a place on the plate (steps of the DAC, sound level).
    pub stretches: Vec<Stretch>,
}

impl Light {
    /// The number with its unit and, where it is known, its interval: `0.31 fingertips (0.30 to 0.32)`. `None` without a
    /// number.
    #[must_use]
    pub fn number(&self) -> Option<String> {
        let number = format!("{} {}", significant(self.value?, 3), self.unit).trim_end().to_owned();
        let range = self.low.zip(self.high).and_then(|(low, high)| range(low, high));
        Some(range.map_or(number.clone(), |range| format!("{number} ({range})")))
    }
}

/// An interval with three digits, `0.30 to 0.32`; `None` where three digits do not separate its ends.
pub(super) fn range(low: f64, high: f64) -> Option<String> {
    let (low, high) = (significant(low, 3), significant(high, 3));
    (low != high).then(|| format!("{low} to {high}"))
}

/// All lights of a plate at one boundary or over its span.
#[derive(Debug, Clone, PartialEq, Serialize, serde::Deserialize)]
pub struct Report {
    /// Name of the plate.
    pub plate: String,
    /// The boundary, metres; `None` over the span.
    #[serde(rename = "turning_point_m")]
    pub boundary_m: Option<f64>,
    /// Half of the 95 % interval of the boundary, the largest over the checked ones, metres; `None` for an
    /// uncalibrated plate.
    #[serde(rename = "turning_point_tolerance_m")]
    pub boundary_tolerance_m: Option<f64>,
    /// Half of the 95 % interval of the peak level, dB; `None` where no levels were measured.
    pub level_tolerance_db: Option<f64>,
    /// Lowest and highest frequency of the checked boundaries, Hz.
    // JSON `band_hz`: Lowest and highest frequency of the check
    #[serde(rename = "band_hz")]
    pub frequency_hz: (f64, f64),
    /// The lights, always in the same order.
    pub lights: Vec<Light>,
}

impl Report {
    /// The accuracy of boundary and level after a calibration, in words; `None` for an uncalibrated plate.
    #[must_use]
    pub fn known(&self) -> Option<String> {
        let boundary = interval::boundary_words(self.boundary_tolerance_m?);
        let level = self
            .level_tolerance_db
            .map(|db| format!(", the level of the peak to ±{} dB", with_decimals(db, 2)));
        Some(format!("{boundary}{}", level.unwrap_or_default()))
    }

    /// The worst colour of all lights; green if there is none.
    pub fn worst(&self) -> Colour {
        self.lights.iter().map(|light| light.colour).max().unwrap_or(Colour::Green)
    }

    /// The light called `name`; `None` if there is none.
    pub fn light(&self, name: &str) -> Option<&Light> {
        self.lights.iter().find(|light| light.name == name)
    }
}
