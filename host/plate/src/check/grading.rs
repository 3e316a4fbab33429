//! Turns a number found at a boundary into a light with a colour and a sentence.

use super::levels::SiteLevels;
use super::prepared::Prepared;
use super::report::{Colour, Light};
use super::thresholds::Limits;
use crate::frequency::Response;
use crate::spec::plate::Plate;

/// A light and its severity within its colour; over a span the light with the highest severity is kept.
pub(super) struct Finding {
    pub(super) light: Light,
    pub(super) severity: f64,
}

/// One boundary on a prepared plate and what was computed there: the input of every light.
pub(super) struct Site<'a> {
    pub(super) prepared: &'a Prepared,
    pub(super) plate: &'a Plate,
    pub(super) boundary_m: f64,
    pub(super) frequency_hz: f64,
    /// The amplitude over the plate at that frequency.
    pub(super) response: Response,
    pub(super) levels: SiteLevels,
}

impl Site<'_> {
    /// A light whose colour follows from `value` and `limits`, where larger is worse.
    pub(super) fn graded(
        &self,
        name: &'static str,
        value: f64,
        unit: &'static str,
        limits: Limits,
        sentences: [String; 3],
    ) -> Finding {
        let colour = colour(value, limits);
        self.judged(name, Some(value), unit, colour, value, pick(colour, sentences))
    }

    /// A light whose colour is known.
    pub(super) fn judged(
        &self,
        name: &'static str,
        value: Option<f64>,
        unit: &'static str,
        colour: Colour,
        severity: f64,
        sentence: String,
    ) -> Finding {
        // JSON cannot represent an infinite number; the sentence says it in words.
        let value = value.filter(|value| value.is_finite());
        Finding {
            light: Light { name, value, unit, colour, sentence, boundary_m: self.boundary_m },
            severity,
        }
    }
}

/// The sentence that belongs to the colour.
pub(super) fn pick(colour: Colour, [green, amber, red]: [String; 3]) -> String {
    match colour {
        // An unchecked light has no value to grade; it does not come here.
        Colour::Green | Colour::Unchecked => green,
        Colour::Amber => amber,
        Colour::Red => red,
    }
}

/// Green up to the first limit, amber up to the second; NaN is red.
pub(super) fn colour(measure: f64, limits: Limits) -> Colour {
    if measure <= limits.green {
        Colour::Green
    } else if measure <= limits.amber {
        Colour::Amber
    } else {
        Colour::Red
    }
}
