//! How a number found at a boundary becomes a light.

use super::prepared::Prepared;
use super::report::{Colour, Light};
use super::thresholds::Limits;
use crate::spec::plate::Plate;

/// A light and how bad it is within its colour, so that the worst of a span can be picked.
pub(super) struct Finding {
    pub(super) light: Light,
    pub(super) badness: f64,
}

/// One boundary, with what the groups of lights need of it.
pub(super) struct Site<'a> {
    pub(super) prepared: &'a Prepared,
    pub(super) plate: &'a Plate,
    pub(super) boundary_m: f64,
    pub(super) frequency_hz: f64,
}

impl Site<'_> {
    /// A light whose colour follows from `value` and `limits`; the larger, the worse.
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

    pub(super) fn judged(
        &self,
        name: &'static str,
        value: Option<f64>,
        unit: &'static str,
        colour: Colour,
        badness: f64,
        sentence: String,
    ) -> Finding {
        // JSON and a reader can do nothing with an infinite number: the sentence tells it.
        let value = value.filter(|value| value.is_finite());
        Finding { light: Light { name, value, unit, colour, sentence, boundary_m: self.boundary_m }, badness }
    }
}

/// The sentence that belongs to the colour.
pub(super) fn pick(colour: Colour, [green, amber, red]: [String; 3]) -> String {
    match colour {
        // What was not checked has no measure, so no colour of one.
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
